//! One technique alone: the paths of multiplexed Metropolis (Hachisuka, Kaplanyan and Dachsbacher
//! 2014, "Multiplexed Metropolis light transport", section 4).
//!
//! The coordinates are those of bidirectional path tracing, so that technique (s, t) makes of a point
//! of the hypercube the path that [`super::bdpt`] makes of it by this technique. It walks no further
//! than that path needs.

use glam::Vec2;

use super::{Technique, Workspace};
use crate::path::{Heuristic, walk_camera, walk_light};
use crate::sampling::Coordinates;
use crate::scene::Scene;
use crate::technique::{Connection, emitted, escaped, join, to_lens, to_light};

impl Technique {
    /// The techniques of paths with `edges` >= 1 edges, in the order of s. Paths of one edge, emitters
    /// in view, have (0, 2) alone.
    pub fn count(edges: usize) -> usize {
        if edges == 1 { 1 } else { edges + 1 }
    }

    /// Technique number `s` of paths with `edges` edges.
    pub fn of(edges: usize, s: usize) -> Self {
        Self {
            s,
            t: edges + 1 - s,
        }
    }

    /// Number of edges of its paths.
    pub fn edges(self) -> usize {
        self.s + self.t - 1
    }
}

/// The path that technique (s, t) makes of `point`, its camera subpath beginning at `film`; `None` if
/// it carries no light.
#[inline]
pub fn connection<C: Coordinates>(
    scene: &Scene,
    heuristic: Heuristic,
    technique: Technique,
    film: Vec2,
    point: &mut C,
    workspace: &mut Workspace,
) -> Option<Connection> {
    let Technique { s, t } = technique;
    let Workspace {
        camera,
        light,
        rays,
    } = workspace;
    // The light subpath first: it ends early more often than the camera's, by leaving the scene.
    let mut y = None;
    if s >= 2 {
        walk_light(scene, heuristic, s - 1, point, rays, light);
        let last = light.vertices.get(s - 2)?;
        if !last.is_connectible(scene) {
            return None;
        }
        if t == 1 {
            return to_lens(scene, heuristic, last, s - 1, point, rays);
        }
        y = Some(last);
    }
    walk_camera(scene, heuristic, film, t - 1, point, rays, camera);
    let Some(z) = camera.vertices.get(t - 2) else {
        let escape = camera.escape.as_ref()?;
        let met = s == 0 && camera.vertices.len() == t - 2;
        return if met {
            escaped(scene, heuristic, escape, t - 1)
        } else {
            None
        };
    };
    match y {
        Some(y) if z.is_connectible(scene) => join(scene, heuristic, y, z, rays),
        Some(_) => None,
        None if s == 0 => {
            let previous = match t {
                2 => camera.start,
                _ => camera.vertices[t - 3].surface.position,
            };
            emitted(scene, heuristic, z, t - 1, previous)
        }
        None => to_light(scene, heuristic, z, t - 1, point, rays),
    }
}
