//! Light tracing: every vertex of a light subpath, the point on the light included, is connected to the
//! lens. It uses only technique t = 1, so there are no MIS weights. Light seen through or reflected by
//! smooth surfaces is missing.

use super::{PathSampler, Workspace, max_edges};
use crate::path::trace_light_subpath;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::technique::camera::{connect_to_camera, visible_light};
use crate::technique::{Connection, PathContribution, Technique};

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
