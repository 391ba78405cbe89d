//! 1*: next event estimation through delta vertices (specular next event estimation). A point y on an emitter
//! is connected to the camera vertex D by the chains x_n ... x_1 of delta vertices that a deterministic finder
//! returns for (D, y).
//!
//! With T = |dw_D / dA_y| along a chain, and the weights rho_j and probabilities P_j of its lobes,
//!
//!   value = alpha_E(D) f_s |w . N_s| (prod rho_j) T L_e(y) / p_d(y),                         (1)
//!   p_*   = p_d(y),   p_0 = p_w(D -> x_n) (prod P_j) T,                                      (2)
//!
//! where p_0 is the density with which technique s = 0 samples y given D. Where no other technique can sample
//! the path, the weights are those of (2); the singularity of T at a caustic cancels. Membership makes this
//! unbiased for any deterministic finder: a path belongs to technique 1* if and only if the finder returns its
//! chain for its D and y, so s = 0 asks the finder before it takes its weight.

use glam::{Vec2, Vec3A};

use super::{Connection, TechniqueSet};
use crate::math::Rgb;
use crate::path::mis::{h, weight};
use crate::path::{Scatter, Subpath, Vertex, dimensions};
use crate::sampling::Sampler;
use crate::scene::specular::{Candidate, Chain, Endpoint, Lobes};
use crate::scene::{ChainEnd, DeltaLobe, RayCounts, Scene, TransportMode};

/// Distance of unit vectors below which the direction of a chain and that of a subpath are the same: the
/// rounding of f32, magnified by the chain.
const SAME_DIRECTION: f32 = 2e-3;

/// A path of technique 1*.
#[derive(Clone, Copy, Debug)]
pub struct SpecularNextEvent {
    /// n: number of delta vertices.
    pub length: usize,
    /// The path and its weight among s = 0 and 1*.
    pub connection: Connection,
}

/// True if technique 1* samples paths whose last vertex before the chain is `vertex`: in bidirectional path
/// tracing only where all other techniques but s = 0 end at delta vertices.
#[inline]
pub fn has_specular(scene: &Scene, vertex: &Vertex, set: TechniqueSet) -> bool {
    let lacks_others = match set {
        TechniqueSet::Path => true,
        TechniqueSet::Bidirectional => !vertex.mis.has_connection(),
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
            hit_over_specular(&scatter, &chain, &end)
        };
        visit(SpecularNextEvent {
            length: chain.length,
            connection: Connection {
                value,
                weight: weight(h(hit), 0.0),
            },
        });
    }
}

/// p_0 / p_* of (2).
#[inline]
fn hit_over_specular(scatter: &Scatter, chain: &Chain, end: &ChainEnd) -> f64 {
    f64::from(scatter.pdf_forward) * chain.probability * chain.jacobian / end.pdf
}

/// The term of technique 1* in the weight of s = 0, h(p_* / p_0), where the camera subpath hits an emitter at
/// its vertex z_i, or leaves the scene after z_{i-1}. 0 if 1* does not sample the path.
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
    let mut term = || {
        let chain = ChainOfSubpath::before(scene, subpath, i)?;
        if !has_specular(scene, chain.start, set) {
            return None;
        }
        let end = match subpath.vertices.get(i - 1) {
            Some(vertex) => scene.emitters.chain_end_on(&vertex.surface)?,
            None => scene
                .emitters
                .chain_end_at(subpath.environment.as_ref()?.direction)?,
        };
        if end.pdf == 0.0 {
            return None;
        }
        let found = chain.find(scene, &end.end, candidates, counts)?;
        let scatter = chain
            .start
            .scatter(scene, found.direction, TransportMode::Radiance);
        let hit = hit_over_specular(&scatter, &found, &end);
        (hit > 0.0).then(|| h(1.0 / hit))
    };
    term().unwrap_or(0.0)
}

/// The delta vertices of a camera subpath before its end on an emitter.
struct ChainOfSubpath<'a> {
    /// D.
    start: &'a Vertex,
    /// From D to the first delta vertex.
    direction: Vec3A,
    lobes: Lobes,
    shape: u32,
}

impl<'a> ChainOfSubpath<'a> {
    /// The chain before z_i; `None` if there is none that a finder could return.
    #[inline]
    fn before(scene: &Scene, subpath: &'a Subpath, i: usize) -> Option<Self> {
        let vertices = &subpath.vertices;
        let end = i - 1;
        let end_mis = match vertices.get(end) {
            Some(vertex) => &vertex.mis,
            None => &subpath.environment.as_ref()?.mis,
        };
        if end_mis.connectible {
            return None;
        }
        // The last vertex whose predecessor scatters by a lobe with a density.
        let first = (0..end).rev().find(|&k| vertices[k].mis.connectible)?;
        let length = end - first;
        if first == 0 || length > scene.casters.max_length() {
            return None;
        }
        let shape = vertices[first].surface.shape;
        let mut lobes = [DeltaLobe::Reflection; 4];
        for (k, lobe) in (first..end).zip(&mut lobes) {
            let vertex = &vertices[k];
            if vertex.surface.shape != shape {
                return None;
            }
            let next = match vertices.get(k + 1) {
                Some(next) => -next.to_previous,
                None => subpath.environment.as_ref()?.direction,
            };
            let normal = vertex.surface.shading.n;
            if normal.dot(next) * normal.dot(vertex.to_previous) < 0.0 {
                *lobe = DeltaLobe::Transmission;
            }
        }
        Some(Self {
            start: &vertices[first - 1],
            direction: -vertices[first].to_previous,
            lobes: Lobes::new(&lobes[..length]),
            shape,
        })
    }

    /// The chain as the finder returns it; `None` if the finder misses it.
    #[inline]
    fn find(
        &self,
        scene: &Scene,
        end: &Endpoint,
        candidates: &mut Vec<Candidate>,
        counts: &mut RayCounts,
    ) -> Option<Chain> {
        let start = self.start.position().as_dvec3();
        scene.casters.chains(start, end, candidates);
        let distance =
            |candidate: &Candidate| (candidate.direction.as_vec3a() - self.direction).length();
        let nearest = candidates
            .iter()
            .filter(|candidate| candidate.shape == self.shape && candidate.lobes == self.lobes)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|candidate| distance(candidate) < SAME_DIRECTION)?;
        nearest.follow(scene, &self.start.surface, end, counts)
    }
}
