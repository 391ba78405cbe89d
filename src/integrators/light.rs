//! Light tracing: every vertex of a light subpath, the point on the light included, is connected to the
//! lens. It uses only technique t = 1, so there are no MIS weights. Light seen through or reflected by
//! smooth surfaces is missing.

use glam::Vec2;

use super::{PathSampler, Workspace, max_edges};
use crate::math::Rgb;
use crate::path::{dimensions, trace_light_subpath};
use crate::sampling::Sampler;
use crate::scene::{RayCounts, Scene};
use crate::technique::camera::lens_point;
use crate::technique::{Connection, PathContribution, Technique, connect_to_camera};

/// Light tracing.
#[derive(Clone, Copy, Debug, Default)]
pub struct LightTracer;

impl PathSampler for LightTracer {
    #[inline]
    fn sample_paths<S: Sampler>(
        &self,
        scene: &Scene,
        sampler: &mut S,
        workspace: &mut Workspace,
        mut visit: impl FnMut(PathContribution),
    ) {
        let edges = max_edges(scene);
        let Workspace { light, rays, .. } = workspace;
        trace_light_subpath(scene, edges.saturating_sub(1), sampler, rays, light);
        let mut add = |s, film, connection: Connection| {
            let unweighted = Connection {
                weight: 1.0,
                ..connection
            };
            let technique = Technique::Camera { s };
            visit(PathContribution::new(technique, film, unweighted));
        };
        if edges > 0
            && let Some((film, connection)) = visible_light(scene, sampler, rays)
        {
            add(1, film, connection);
        }
        for (i, y) in (1..).zip(&light.vertices) {
            if let Some((film, connection)) = connect_to_camera(scene, y, i, sampler, rays) {
                add(i + 1, film, connection);
            }
        }
    }
}

/// Technique (1, 1): a directly visible light, sampled for the lens. Point and directional lights have no
/// extent on the film and are invisible.
fn visible_light<S: Sampler>(
    scene: &Scene,
    sampler: &mut S,
    rays: &mut RayCounts,
) -> Option<(Vec2, Connection)> {
    let [u_light, u_primitive, x, y] = sampler.get::<4>(dimensions::next_event(0));
    let lens = lens_point(scene, 0, sampler);
    let from = scene.camera.lens_position(lens);
    let direct = scene
        .emitters
        .sample_direct(from, u_light, u_primitive, Vec2::new(x, y))
        .filter(|direct| !direct.delta)?;
    let film = scene.camera.film_position(direct.direction, lens)?;
    let emission = &direct.emission;
    // The lens measures the integral of radiance times p_w, the density of its directions per steradian.
    let importance = scene.camera.direction_pdf(direct.direction);
    let value = emission.radiance * (importance * direct.jacobian_direction / emission.pdf_direct);
    let (near, far) = scene
        .camera
        .visible_segment(from, direct.direction, direct.target)?;
    let visible = value != Rgb::ZERO && scene.geometry.visible(near, far, rays);
    visible.then_some((film, Connection { value, weight: 1.0 }))
}
