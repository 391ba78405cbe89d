//! Light tracing: every vertex of a light subpath, the point on the emitter included, is joined to
//! the lens. Technique t = 1 alone, so no weights; what is seen through smooth surfaces is missing.

use glam::Vec2;

use super::{Technique, Workspace, max_edges};
use crate::math::Rgb;
use crate::path::{Heuristic, dimensions, walk_light};
use crate::sampling::{Coordinates, Stream};
use crate::scene::{RayCounts, Scene};
use crate::technique::connect::lens_point;
use crate::technique::{Connection, to_lens};

/// Samples one light subpath and hands every connection that carries light to `visit`.
#[inline]
pub fn connections<C: Coordinates>(
    scene: &Scene,
    heuristic: Heuristic,
    point: &mut C,
    workspace: &mut Workspace,
    mut visit: impl FnMut(Technique, Connection),
) {
    let edges = max_edges(scene);
    let Workspace { light, rays, .. } = workspace;
    walk_light(
        scene,
        heuristic,
        edges.saturating_sub(1),
        point,
        rays,
        light,
    );
    if edges > 0
        && let Some(connection) = visible_emitter(scene, point, rays)
    {
        visit(Technique { s: 1, t: 1 }, connection);
    }
    for (i, y) in (1..).zip(&light.vertices) {
        if let Some(connection) = to_lens(scene, heuristic, y, i, point, rays) {
            let alone = Connection {
                weight: 1.0,
                ..connection
            };
            visit(Technique { s: i + 1, t: 1 }, alone);
        }
    }
}

/// Technique (1, 1): an emitter that is seen directly, sampled for the lens. A point light or a
/// directional one has no extent on the film and stays invisible.
fn visible_emitter<C: Coordinates>(
    scene: &Scene,
    point: &mut C,
    rays: &mut RayCounts,
) -> Option<Connection> {
    let [choose, part, u, v] = point.read::<4>(Stream::Connection, dimensions::to_light(0));
    let lens = lens_point(scene, 0, point);
    let from = scene.camera.lens_position(lens);
    let direct = scene
        .emitters
        .sample_direct(from, choose, part, Vec2::new(u, v))
        .filter(|direct| !direct.delta)?;
    let film = scene.camera.film_position(direct.direction, lens)?;
    let emission = &direct.emission;
    // The lens measures radiance with importance p_w per steradian.
    let importance = scene.camera.direction_pdf(direct.direction);
    let value = emission.radiance * (importance * direct.jacobian_direction / emission.pdf_direct);
    let (near, far) = scene
        .camera
        .visible_segment(from, direct.direction, direct.target)?;
    let seen = value != Rgb::ZERO && scene.geometry.visible(near, far, rays);
    seen.then_some(Connection {
        value,
        weight: 1.0,
        film: Some(film),
    })
}
