//! Light tracing: every vertex of a light subpath, the point on the emitter included, is joined to
//! the lens. Technique t = 1 alone, so no weights; what is seen through smooth surfaces is missing.

use glam::Vec2;

use super::{Splats, Workspace, max_edges};
use crate::math::{Coordinates, Rgb, Stream};
use crate::path::connect::lens_point;
use crate::path::{Heuristic, dimensions, to_lens, walk_light};
use crate::scene::Scene;

/// Samples one light subpath.
#[inline]
pub fn sample<C: Coordinates>(
    scene: &Scene,
    point: &mut C,
    workspace: &mut Workspace,
    splats: &mut Splats,
) {
    let edges = max_edges(scene);
    let heuristic = Heuristic::default();
    let Workspace { light, rays, .. } = workspace;
    walk_light(
        scene,
        heuristic,
        edges.saturating_sub(1),
        point,
        rays,
        light,
    );
    if edges > 0 {
        visible_emitter(scene, point, workspace, splats);
    }
    let Workspace { light, rays, .. } = workspace;
    for (i, y) in (1..).zip(&light.vertices) {
        if let Some(connection) = to_lens(scene, heuristic, y, i, point, rays) {
            splats.add(connection.film, connection.value);
        }
    }
}

/// Technique (1, 1): an emitter that is seen directly, sampled for the lens. A point light or a
/// directional one has no extent on the film and stays invisible.
fn visible_emitter<C: Coordinates>(
    scene: &Scene,
    point: &mut C,
    workspace: &mut Workspace,
    splats: &mut Splats,
) {
    let [choose, part, u, v] = point.read::<4>(Stream::Connection, dimensions::to_light(0));
    let lens = lens_point(scene, 0, point);
    let from = scene.camera.lens_position(lens);
    let direct = scene
        .emitters
        .sample_direct(from, choose, part, Vec2::new(u, v));
    let Some(direct) = direct.filter(|direct| !direct.delta) else {
        return;
    };
    let Some(film) = scene.camera.film_position(direct.direction, lens) else {
        return;
    };
    let emission = &direct.emission;
    // The lens measures radiance with importance p_w per steradian.
    let importance = scene.camera.direction_pdf(direct.direction);
    let value = emission.radiance * (importance * direct.geometry / emission.pdf_direct);
    let Some((near, far)) = scene
        .camera
        .visible_segment(from, direct.direction, direct.target)
    else {
        return;
    };
    if value != Rgb::ZERO && scene.geometry.visible(near, far, &mut workspace.rays) {
        splats.add(Some(film), value);
    }
}
