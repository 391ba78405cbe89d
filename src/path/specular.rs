//! Specular chains of subpaths: is the chain of delta vertices between a vertex D and an emitter, which a subpath
//! has sampled, one that the finder returns for D and the point on the emitter?

use arrayvec::ArrayVec;
use glam::Vec3A;

use super::environment::EnvironmentVertex;
use super::mis::h;
use super::vertex::{Scatter, Vertex};
use crate::fault::{Fault, planted};
use crate::scene::specular::{Candidate, Chain, Lobes, Route};
use crate::scene::{ChainEnd, DeltaLobe, RayCounts, Scene, TransportMode};

/// p_0 / p_*: density with which a camera subpath samples the end of a chain given D, over that of technique 1*.
/// `scatter` is that of D in the direction of the chain.
#[inline]
pub fn hit_over_specular(scatter: &Scatter, chain: &Chain, end: &ChainEnd) -> f64 {
    f64::from(scatter.pdf_forward) * chain.probability * chain.jacobian / end.pdf
}

/// F / p_d: density with which a light subpath samples the end of a chain and D, per unit area at D, over that
/// with which technique 1* samples the end.
#[inline]
pub fn subpath_over_specular(chain: &Chain, end: &ChainEnd) -> f64 {
    end.pdf_position * end.pdf_direction(chain.to_end) * chain.probability * chain.reverse_jacobian
        / end.pdf
}

/// The term of technique 1* in the weight of s = 0, h(p_* / p_0), where a camera subpath of these vertices hits an
/// emitter at its vertex z_i, or leaves the scene after z_{i-1} to `environment`; `wanted` is true for the vertices D that the technique has. 0 if
/// it does not sample the path.
#[inline]
pub fn specular_over_hit(
    scene: &Scene,
    vertices: &[Vertex],
    environment: Option<&EnvironmentVertex>,
    i: usize,
    wanted: impl Fn(&Vertex) -> bool,
    candidates: &mut Vec<Candidate>,
    counts: &mut RayCounts,
) -> f64 {
    if planted(Fault::MembershipSkipped) {
        return 0.0;
    }
    let mut term = || {
        let last = i - 1;
        let (mis, after) = match vertices.get(last) {
            Some(vertex) => (&vertex.mis, -vertex.to_previous),
            None => {
                let environment = environment?;
                (&environment.mis, environment.direction)
            }
        };
        if mis.connectible {
            return None;
        }
        // The vertex after the last one that scatters by a lobe with a density.
        let first = (0..last).rev().find(|&k| vertices[k].mis.connectible)?;
        let start = vertices.get(first.checked_sub(1)?)?;
        let delta = &vertices[first..last];
        if !wanted(start) {
            return None;
        }
        let next = |k: usize| delta.get(k + 1).map_or(after, |next| -next.to_previous);
        let lobes = |k: usize| lobe(&delta[k], next(k));
        let end = match vertices.get(last) {
            Some(vertex) => scene.emitters.chain_end_on(&vertex.surface)?,
            None => scene.emitters.chain_end_at(after)?,
        };
        let route = route(scene, delta.iter(), lobes, -delta[0].to_previous)?;
        let chain = find(scene, start, &end, &route, candidates, counts)?;
        let scatter = start.scatter(scene, chain.direction, TransportMode::Radiance);
        let hit = hit_over_specular(&scatter, &chain, &end);
        (hit > 0.0).then(|| h(1.0 / hit))
    };
    term().unwrap_or(0.0)
}

/// v* of [`super::mis`] at a light subpath's first vertex `start` after the delta vertices `delta`, which follow
/// the point `end` on an emitter; `forward` is f_i. 0 if technique 1* does not sample the path.
#[inline]
pub fn specular_over_subpath(
    scene: &Scene,
    start: &Vertex,
    delta: &[Vertex],
    end: &ChainEnd,
    candidates: &mut Vec<Candidate>,
    counts: &mut RayCounts,
) -> f64 {
    if planted(Fault::ChainTermLeftOut) {
        return 0.0;
    }
    let mut term = || {
        // From D to the emitter.
        let reversed = |k: usize| {
            let i = delta.len() - 1 - k;
            let next = delta.get(i + 1).unwrap_or(start);
            lobe(&delta[i], -next.to_previous)
        };
        let route = route(scene, delta.iter().rev(), reversed, start.to_previous)?;
        let chain = find(scene, start, end, &route, candidates, counts)?;
        let ratio = subpath_over_specular(&chain, end);
        (ratio > 0.0).then(|| h(start.mis.forward / ratio))
    };
    term().unwrap_or(0.0)
}

/// The lobe by which a delta vertex scatters toward the unit vector `next`.
#[inline]
fn lobe(vertex: &Vertex, next: Vec3A) -> DeltaLobe {
    let normal = vertex.surface.shading.n;
    if normal.dot(next) * normal.dot(vertex.to_previous) < 0.0 {
        DeltaLobe::Transmission
    } else {
        DeltaLobe::Reflection
    }
}

/// The route of `delta` from D on, with the k-th lobe `lobe(k)`, which leaves D along the unit vector `direction`;
/// `None` if no finder returns such chains.
#[inline]
fn route<'a>(
    scene: &Scene,
    delta: impl ExactSizeIterator<Item = &'a Vertex>,
    lobe: impl Fn(usize) -> DeltaLobe,
    direction: Vec3A,
) -> Option<Route> {
    if delta.len() > scene.casters.max_length() {
        return None;
    }
    let lobes = Lobes::collect(delta.len(), lobe);
    let mut shape = None;
    let mut primitives = ArrayVec::new();
    for vertex in delta {
        let surface = &vertex.surface;
        if *shape.get_or_insert(surface.shape) != surface.shape {
            return None;
        }
        primitives.push(surface.primitive);
    }
    Some(Route {
        shape: shape?,
        lobes,
        primitives,
        direction,
    })
}

/// The chain along `route` from `start` to `end`, if technique 1* samples it.
#[inline]
fn find(
    scene: &Scene,
    start: &Vertex,
    end: &ChainEnd,
    route: &Route,
    candidates: &mut Vec<Candidate>,
    counts: &mut RayCounts,
) -> Option<Chain> {
    if end.pdf == 0.0 {
        return None;
    }
    let (from, end) = (start.position().as_dvec3(), &end.end);
    let candidate = scene.casters.find(from, end, route, candidates)?;
    candidate.follow(scene, &start.surface, end, counts)
}
