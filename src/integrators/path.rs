//! Unidirectional path tracing with next event estimation: techniques s = 0 and s = 1, weighted
//! against each other (Veach 1997, section 9.2). It shares the camera subpath with bidirectional path
//! tracing, but not the recursive MIS weights, so a comparison of the two tests those weights.

use super::camera_paths::camera_paths;
use super::{PathSampler, Workspace};
use crate::path::mis::{h, weight};
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::technique::{Connection, Hit, NextEvent, PathContribution, TechniqueSet};

/// Path tracing.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathTracer;

impl PathSampler for PathTracer {
    #[inline]
    fn sample_paths<S: Sampler>(
        &self,
        scene: &Scene,
        sampler: &mut S,
        workspace: &mut Workspace,
        mut visit: impl FnMut(PathContribution),
    ) {
        let set = TechniqueSet::Path;
        camera_paths(scene, set, sampler, workspace, hit, next_event, &mut visit);
    }
}

/// Weighs a path of technique s = 0 against s = 1.
#[inline]
fn hit(hit: &Hit) -> Connection {
    // Next event estimation samples neither paths of one edge nor connections of a delta vertex.
    let next_event = if hit.edges == 1 || !hit.mis.connectible {
        0.0
    } else {
        h(f64::from(hit.emission.pdf_direct) / hit.mis.forward)
    };
    hit.weighted(weight(0.0, next_event + hit.specular))
}

/// Weighs a path of technique s = 1 against s = 0.
#[inline]
fn next_event(next_event: &NextEvent) -> Connection {
    next_event.weighted(weight(next_event.hit_term(), 0.0))
}
