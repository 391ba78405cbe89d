//! Bidirectional path tracing (Veach 1997, chapter 10): all techniques (s, t) with t >= 1, for one pair of
//! subpaths.

use super::camera_paths::camera_paths;
use super::{PathSampler, Workspace, max_edges};
use crate::path::trace_light_subpath;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::technique::{
    PathContribution, Technique, TechniqueSet, connect_to_camera, connect_vertices,
};

/// Bidirectional path tracing.
#[derive(Clone, Copy, Debug, Default)]
pub struct BidirectionalPathTracer;

impl PathSampler for BidirectionalPathTracer {
    #[inline]
    fn sample_paths<S: Sampler>(
        &self,
        scene: &Scene,
        sampler: &mut S,
        workspace: &mut Workspace,
        mut visit: impl FnMut(PathContribution),
    ) {
        // s = 0, s = 1 and 1*.
        let film = camera_paths(
            scene,
            TechniqueSet::Bidirectional,
            sampler,
            workspace,
            |hit| hit.connection(),
            |next_event| next_event.connection(),
            &mut visit,
        );

        // s >= 2: light subpath vertices, connected to the lens and to camera subpath vertices.
        let edges = max_edges(scene);
        let Workspace {
            camera,
            light,
            rays,
            ..
        } = workspace;
        trace_light_subpath(scene, edges.saturating_sub(1), sampler, rays, light);
        for (j, y) in (1..).zip(&light.vertices) {
            if !y.is_connectible(scene) {
                continue;
            }
            if let Some((film, connection)) = connect_to_camera(scene, y, j, sampler, rays) {
                let technique = Technique::Camera { s: j + 1 };
                visit(PathContribution::new(technique, film, connection));
            }
            // The path through y_j and z_i has i + j + 1 edges.
            let reachable = edges.saturating_sub(j + 1).min(camera.vertices.len());
            for (i, z) in (1..).zip(&camera.vertices[..reachable]) {
                if z.is_connectible(scene)
                    && let Some(connection) = connect_vertices(scene, y, z, rays)
                {
                    let technique = Technique::Join { s: j + 1, t: i + 1 };
                    visit(PathContribution::new(technique, film, connection));
                }
            }
        }
    }
}
