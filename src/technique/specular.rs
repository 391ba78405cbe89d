//! 1*: next event estimation through delta vertices (specular next event estimation). A point y on an emitter
//! is connected to the camera vertex D by the chains x_n ... x_1 of delta vertices that a deterministic finder
//! returns for (D, y).
//!
//! With T = |dw_D / dA_y| along a chain, and the weights rho_j and probabilities P_j of its lobes,
//!
//!   value = alpha_E(D) f_s |w . N_s| (prod rho_j) T L_e(y) / p_d(y),                         (1)
//!   p_*   = p_d(y),   p_0 = p_w(D -> x_n) (prod P_j) T,                                      (2)
//!
//! where p_0 is the density with which technique s = 0 samples y given D. The singularity of T at a caustic
//! cancels in the weight. Light subpaths that go through a chain have the term (4) of [`crate::path::mis`].
//! Membership makes this unbiased for any deterministic finder: a path belongs to technique 1* if and only if the finder returns its
//! chain for its D and y, so s = 0 asks the finder before it takes its weight.

use glam::Vec2;

use super::{Connection, TechniqueSet};
use crate::math::Rgb;
use crate::path::mis::{h, weight};
use crate::path::specular::{hit_over_specular, specular_over_hit, subpath_over_specular};
use crate::path::{Subpath, Vertex, dimensions};
use crate::sampling::Sampler;
use crate::scene::specular::Candidate;
use crate::scene::{RayCounts, Scene, TransportMode};

/// A path of technique 1*.
#[derive(Clone, Copy, Debug)]
pub struct SpecularNextEvent {
    /// n: number of delta vertices.
    pub length: usize,
    /// The path and its weight.
    pub connection: Connection,
}

/// True if technique 1* samples paths whose last vertex before the chain is `vertex`: in bidirectional path
/// tracing, unless [`Casters::everywhere`](crate::scene::Casters::everywhere), only where all other techniques but
/// s = 0 end at delta vertices.
#[inline]
pub fn has_specular(scene: &Scene, vertex: &Vertex, set: TechniqueSet) -> bool {
    let lacks_others = match set {
        TechniqueSet::Path => true,
        TechniqueSet::Bidirectional => scene.casters.everywhere() || !vertex.mis.has_connection(),
        TechniqueSet::Light => false,
    };
    lacks_others && scene.has_chains() && vertex.is_connectible(scene)
}

/// Samples a point on an emitter for camera vertex z_i and calls `visit` with every path to it through delta
/// vertices. `candidates` is memory for the finder.
#[inline]
pub fn specular_next_event<S: Sampler>(
    scene: &Scene,
    vertex: &Vertex,
    i: usize,
    set: TechniqueSet,
    sampler: &mut S,
    candidates: &mut Vec<Candidate>,
    counts: &mut RayCounts,
    mut visit: impl FnMut(SpecularNextEvent),
) {
    let [u_light, u_primitive, x, y] = sampler.get::<4>(dimensions::specular(i));
    let u = Vec2::new(x, y);
    let Some(end) = scene.emitters.sample_chain_end(u_light, u_primitive, u) else {
        return;
    };
    let start = vertex.position().as_dvec3();
    counts.chain_searches += 1;
    scene.casters.chains(start, &end.end, candidates);
    for candidate in candidates.iter() {
        let direction = candidate.direction.as_vec3a();
        let scatter = vertex.scatter(scene, direction, TransportMode::Radiance);
        if scatter.value == Rgb::ZERO {
            continue;
        }
        let Some(chain) = candidate.follow(scene, &vertex.surface, &end.end, counts) else {
            continue;
        };
        let value = vertex.throughput
            * scatter.value
            * chain.throughput
            * end.radiance_against(chain.to_end)
            * (chain.jacobian / end.pdf) as f32;
        if value == Rgb::ZERO {
            continue;
        }
        let origin = chain.last.ray_origin(chain.to_end);
        let target = end.target(chain.last.position, chain.to_end);
        if !scene.geometry.visible(origin, target, counts) {
            continue;
        }
        let hit = if end.delta {
            0.0
        } else {
            h(hit_over_specular(&scatter, &chain, &end))
        };
        let camera = match set {
            TechniqueSet::Bidirectional => {
                let light = subpath_over_specular(&chain, &end);
                vertex.mis.sum(light, f64::from(scatter.pdf_reverse))
            }
            TechniqueSet::Path | TechniqueSet::Light => 0.0,
        };
        visit(SpecularNextEvent {
            length: chain.length,
            connection: Connection {
                value,
                weight: weight(hit, camera),
            },
        });
    }
}

/// The term of technique 1* in the weight of s = 0, where a camera subpath hits an emitter at its vertex z_i:
/// [`specular_over_hit`].
#[inline]
pub fn specular_term(
    scene: &Scene,
    subpath: &Subpath,
    i: usize,
    set: TechniqueSet,
    candidates: &mut Vec<Candidate>,
    counts: &mut RayCounts,
) -> f64 {
    if !scene.has_chains() {
        return 0.0;
    }
    let wanted = |vertex: &Vertex| has_specular(scene, vertex, set);
    let environment = subpath.environment.as_ref();
    let vertices = &subpath.vertices[..];
    specular_over_hit(scene, vertices, environment, i, wanted, candidates, counts)
}
