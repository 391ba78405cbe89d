//! The techniques common to path tracing and bidirectional path tracing: a camera subpath whose vertices
//! hit lights (s = 0) or are connected to lights by next event estimation, directly (s = 1) or through delta
//! vertices (1*).

use glam::Vec2;

use super::{Workspace, max_edges};
use crate::path::{dimensions, trace_camera_subpath};
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::technique::{
    Connection, Hit, NextEvent, PathContribution, Technique, TechniqueSet, has_specular,
    hit_environment, hit_light, specular_next_event, specular_term,
};

/// Traces a camera subpath and calls `visit` for every path of techniques s = 0, s = 1 and 1* that carries
/// light. The first two are weighted by `weigh_hit` and `weigh_next_event`, which depend on the techniques that a method
/// combines. Returns the film position of the subpath.
#[inline]
pub(super) fn camera_paths<S: Sampler>(
    scene: &Scene,
    set: TechniqueSet,
    sampler: &mut S,
    workspace: &mut Workspace,
    weigh_hit: impl Fn(&Hit) -> Connection,
    weigh_next_event: impl Fn(&NextEvent) -> Connection,
    visit: &mut impl FnMut(PathContribution),
) -> Vec2 {
    let edges = max_edges(scene);
    let Workspace {
        camera,
        rays,
        candidates,
        ..
    } = workspace;
    let film = Vec2::from(sampler.get::<2>(dimensions::FILM));
    trace_camera_subpath(scene, film, edges, sampler, rays, camera);
    let camera = &*camera;
    let mut previous = camera.start;
    for (i, z) in (1..).zip(&camera.vertices) {
        let term = || specular_term(scene, camera, i, set, candidates, rays);
        if let Some(hit) = hit_light(scene, z, i, previous, term) {
            let technique = Technique::Hit { t: i + 1 };
            visit(PathContribution::new(technique, film, weigh_hit(&hit)));
        }
        if i < edges
            && let Some(next_event) = NextEvent::sample(scene, z, i, sampler, rays)
        {
            let technique = Technique::NextEvent { t: i + 1 };
            let connection = weigh_next_event(&next_event);
            visit(PathContribution::new(technique, film, connection));
        }
        if i + 1 < edges && has_specular(scene, z, set) {
            specular_next_event(scene, z, i, set, sampler, candidates, rays, |found| {
                let (t, n) = (i + 1, found.length);
                if t + n <= edges {
                    let technique = Technique::Specular { t, n };
                    visit(PathContribution::new(technique, film, found.connection));
                }
            });
        }
        previous = z.position();
    }
    let i = camera.vertices.len() + 1;
    if i <= edges
        && let Some(vertex) = &camera.environment
        && let Some(hit) = hit_environment(scene, vertex, i, || {
            specular_term(scene, camera, i, set, candidates, rays)
        })
    {
        let technique = Technique::Hit { t: i + 1 };
        visit(PathContribution::new(technique, film, weigh_hit(&hit)));
    }
    film
}
