//! Who carries what: the light of every path is divided between plain sampling and the chains.
//!
//! Let F be what one technique contributes at one point of the hypercube, weighted, and l = lum(F) / m
//! its brightness in units of what the importance map m expects where it lands. With a threshold tau
//!
//!   F = F min(1, tau/l) + F max(0, 1 - tau/l).                                               (1)
//!
//! Plain sampling carries the first part, the chains the second. The first is bounded by tau m, so
//! that no bright path disturbs the plain image. The second is nothing at all but for such paths, so
//! that the chains waste no mutation on light that plain sampling finds with ease. Both together are
//! F, whatever map and threshold are: neither makes any bias.
//!
//! What they are decides on the error at equal time. Take it relative to the map, for one plain sample
//! per pixel: the plain part has the second moment V(tau) = E[min(l, tau)^2] and costs c_p rays. The
//! excess has the energy E(tau) = E[(l - tau)+]; if each mutation splats the energy e, it takes E/e
//! mutations of c_m rays and has the second moment eta e E, where eta mutations tell as much as one
//! independent path. Error times cost is
//!
//!   (V + eta e E) (c_p + c_m E/e),                                                           (2)
//!
//! least for e^2 = V c_m / (eta c_p), where its square root is
//!
//!   sqrt(V(tau) c_p) + sqrt(eta c_m) E(tau),                                                 (3)
//!
//! of which tau is the minimum. An infinite tau is bidirectional path tracing.

use super::importance::ImportanceMap;
use super::pilot::Pilot;
use crate::film::Splat;
use crate::math::{Rgb, luminance};
use crate::scene::Scene;

/// eta of (2): how many mutations of a chain tell as much as one independent path. On the scenes of the
/// repository anything from 10 to 400 gives about the same errors.
const CORRELATION: f64 = 50.0;

/// c_m of (2): rays of a mutation, as they are on the scenes of the repository.
const RAYS_PER_MUTATION: f64 = 4.5;

/// Lengths up to this one are left to plain sampling where direct light is separate: emitters in view,
/// and light that comes straight from them.
const DIRECT: usize = 2;

/// The rule (1), and the energy of a mutation.
#[derive(Clone, Debug)]
pub struct Division {
    /// m.
    map: ImportanceMap,
    /// tau, in units of the map; infinity leaves everything to plain sampling.
    pub threshold: f32,
    /// Plain sampling carries all paths with so many edges or fewer.
    plain_edges: usize,
    /// e of (2).
    pub energy: f64,
    /// The square root of (2) without chains, over that with them: squared, how much less error the
    /// chains are expected to leave at equal time.
    pub gain: f64,
}

/// What the user may say about the division.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DivisionSettings {
    /// Direct light is left to plain sampling.
    pub separate_direct: bool,
    /// Use an importance map; else all regions of the image count by their brightness.
    pub importance: bool,
    /// tau; `None` for the best.
    pub threshold: Option<f32>,
}

impl Default for DivisionSettings {
    fn default() -> Self {
        Self {
            separate_direct: true,
            importance: true,
            threshold: None,
        }
    }
}

impl Division {
    /// The best division as far as `pilot` can tell.
    pub fn new(scene: &Scene, pilot: &Pilot, settings: DivisionSettings) -> Self {
        let splats: Vec<Splat> = pilot.found.iter().map(|found| found.splat).collect();
        let map = if settings.importance {
            let size = [scene.film.width, scene.film.height];
            ImportanceMap::new(&splats, pilot.samples, size)
        } else {
            ImportanceMap::uniform(ImportanceMap::mean(&splats, pilot.samples) as f32)
        };
        let mut division = Self {
            map,
            threshold: f32::INFINITY,
            plain_edges: if settings.separate_direct { DIRECT } else { 0 },
            energy: 1.0,
            gain: 1.0,
        };
        let moments = Moments::new(&division, pilot);
        let plain = moments.score(f64::INFINITY);
        let best = match settings.threshold {
            Some(threshold) => f64::from(threshold),
            None => moments.best(),
        };
        division.threshold = best as f32;
        division.energy = moments.energy(best);
        let best = moments.score(best);
        division.gain = if best > 0.0 { plain / best } else { 1.0 };
        division
    }

    /// The share of the chains in a path of `edges` edges that brings `value` to `position`.
    #[inline]
    pub fn chain_share(&self, edges: usize, value: Rgb, position: [f32; 2]) -> f32 {
        if edges <= self.plain_edges {
            return 0.0;
        }
        let brightness = self.brightness(value, position);
        if brightness > self.threshold {
            1.0 - self.threshold / brightness
        } else {
            0.0
        }
    }

    /// l: how bright `value` is at `position`, in units of the map.
    #[inline]
    pub fn brightness(&self, value: Rgb, position: [f32; 2]) -> f32 {
        luminance(value) / self.map.at(position)
    }
}

/// What (3) is made of.
struct Moments {
    /// Brightness of what the chains may carry.
    bright: Vec<f64>,
    /// Second moment of what they may not.
    rest: f64,
    samples: f64,
    /// c_p.
    rays: f64,
}

impl Moments {
    fn new(division: &Division, pilot: &Pilot) -> Self {
        let samples = pilot.samples.max(1) as f64;
        let (mut bright, mut rest) = (Vec::new(), 0.0);
        for found in &pilot.found {
            let Splat { position, value } = found.splat;
            let brightness = f64::from(division.brightness(value, position));
            if found.edges > division.plain_edges {
                bright.push(brightness);
            } else {
                rest += brightness * brightness / samples;
            }
        }
        Self {
            bright,
            rest,
            samples,
            rays: pilot.rays.total() as f64 / samples,
        }
    }

    /// V(tau).
    fn second_moment(&self, threshold: f64) -> f64 {
        let bounded = self.bright.iter().map(|l| l.min(threshold).powi(2));
        self.rest + bounded.sum::<f64>() / self.samples
    }

    /// E(tau).
    fn excess(&self, threshold: f64) -> f64 {
        let excess = self.bright.iter().map(|l| (l - threshold).max(0.0));
        excess.sum::<f64>() / self.samples
    }

    /// (3).
    fn score(&self, threshold: f64) -> f64 {
        let plain = (self.second_moment(threshold) * self.rays).sqrt();
        plain + (CORRELATION * RAYS_PER_MUTATION).sqrt() * self.excess(threshold)
    }

    /// The best energy of a mutation.
    fn energy(&self, threshold: f64) -> f64 {
        let second_moment = self.second_moment(threshold);
        let energy = (second_moment * RAYS_PER_MUTATION / (CORRELATION * self.rays)).sqrt();
        // A pilot that has met no light says nothing.
        if energy > 0.0 { energy } else { 1.0 }
    }

    /// The threshold with the least score, among powers of the square root of 2. Never infinite: what
    /// the pilot has not met may be brighter than all that it has.
    fn best(&self) -> f64 {
        let thresholds = (0..=28).map(|i| (0.5 * f64::from(i)).exp2());
        let scored = thresholds.map(|threshold| (threshold, self.score(threshold)));
        scored
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(f64::INFINITY, |(threshold, _)| threshold)
    }
}
