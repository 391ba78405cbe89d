//! Unidirectional path tracing with next event estimation: techniques s = 0 and s = 1, weighted
//! against each other (Veach 1997, section 9.2). Shares the surface walk with bidirectional path
//! tracing but none of its recursive weights, and so checks them.

use glam::Vec2;

use super::{Technique, Workspace, max_edges};
use crate::path::{Carried, Heuristic, walk_camera};
use crate::sampling::Coordinates;
use crate::scene::Scene;
use crate::technique::{Connection, connect};

/// Samples one camera subpath and hands every connection that carries light to `visit`.
#[inline]
pub fn connections<C: Coordinates>(
    scene: &Scene,
    heuristic: Heuristic,
    film: Vec2,
    point: &mut C,
    workspace: &mut Workspace,
    mut visit: impl FnMut(Technique, Connection),
) {
    let edges = max_edges(scene);
    let Workspace { camera, rays, .. } = workspace;
    walk_camera(scene, heuristic, film, edges, point, rays, camera);
    let mut arrive = |s, i, value, weight| {
        let connection = Connection {
            value,
            weight,
            film: None,
        };
        visit(Technique { s, t: i + 1 }, connection);
    };
    let mut previous = camera.start;
    for (i, z) in (1..).zip(&camera.vertices) {
        if let Some(emission) = scene.emitters.evaluate_surface(&z.surface, previous) {
            let weight = hit_weight(heuristic, &z.carried, f64::from(emission.pdf_direct), i);
            arrive(0, i, z.throughput * emission.radiance, weight);
        }
        if i < edges
            && let Some(light) = connect::sample_light(scene, z, i, point, rays)
        {
            let hit = if light.direct.delta {
                0.0
            } else {
                light.hit_ratio()
            };
            let weight = (1.0 / (1.0 + heuristic.power(hit))) as f32;
            arrive(1, i, light.value, weight);
        }
        previous = z.surface.position;
    }
    let i = camera.vertices.len() + 1;
    if i <= edges
        && let Some(escape) = &camera.escape
        && let Some(emission) = scene.emitters.evaluate_environment(escape.direction)
    {
        let pdf_direct = f64::from(emission.pdf_direct);
        let weight = hit_weight(heuristic, &escape.carried, pdf_direct, i);
        arrive(0, i, escape.throughput * emission.radiance, weight);
    }
}

/// Weight of having hit an emitter that next event estimation finds with density `pdf_direct`; i is
/// the number of edges.
#[inline]
fn hit_weight(heuristic: Heuristic, carried: &Carried, pdf_direct: f64, i: usize) -> f32 {
    if i == 1 || !carried.joinable {
        return 1.0;
    }
    (1.0 / (1.0 + heuristic.power(pdf_direct / carried.forward))) as f32
}
