//! Bidirectional path tracing (Veach 1997, chapter 10): all techniques (s, t) with t >= 1 over one
//! pair of subpaths.

use glam::Vec2;

use super::{Workspace, max_edges};
use crate::path::{Heuristic, walk_camera, walk_light};
use crate::sampling::Coordinates;
use crate::scene::Scene;
use crate::technique::{Connection, emitted, escaped, join, to_lens, to_light};

/// Numbers of vertices that each subpath gives to a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Technique {
    /// Vertices of the light subpath, the point on the emitter included.
    pub s: usize,
    /// Vertices of the camera subpath, the point on the lens included.
    pub t: usize,
}

/// Samples one pair of subpaths and hands every connection that carries light to `visit`.
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
    let Workspace {
        camera,
        light,
        rays,
    } = workspace;
    walk_camera(scene, heuristic, film, edges, point, rays, camera);
    walk_light(
        scene,
        heuristic,
        edges.saturating_sub(1),
        point,
        rays,
        light,
    );

    // s = 0 and s = 1: light that the camera subpath meets or samples.
    let mut previous = camera.start;
    for (i, z) in (1..).zip(&camera.vertices) {
        if let Some(connection) = emitted(scene, heuristic, z, i, previous) {
            visit(Technique { s: 0, t: i + 1 }, connection);
        }
        if i < edges
            && let Some(connection) = to_light(scene, heuristic, z, i, point, rays)
        {
            visit(Technique { s: 1, t: i + 1 }, connection);
        }
        previous = z.surface.position;
    }
    if let Some(escape) = &camera.escape {
        let i = camera.vertices.len() + 1;
        if i <= edges
            && let Some(connection) = escaped(scene, heuristic, escape, i)
        {
            visit(Technique { s: 0, t: i + 1 }, connection);
        }
    }

    // s >= 2: light subpath vertices, joined to the lens and to camera subpath vertices.
    for (j, y) in (1..).zip(&light.vertices) {
        if !y.is_connectible(scene) {
            continue;
        }
        if let Some(connection) = to_lens(scene, heuristic, y, j, point, rays) {
            visit(Technique { s: j + 1, t: 1 }, connection);
        }
        // The path over y_j and z_i has i + j + 1 edges.
        let reachable = edges.saturating_sub(j + 1).min(camera.vertices.len());
        for (i, z) in (1..).zip(&camera.vertices[..reachable]) {
            if z.is_connectible(scene)
                && let Some(connection) = join(scene, heuristic, y, z, rays)
            {
                visit(Technique { s: j + 1, t: i + 1 }, connection);
            }
        }
    }
}
