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

/// eta of (2): how many mutations of a chain tell as much as one independent path. On the scenes of the
/// repository anything from 10 to 400 gives about the same errors.
const CORRELATION: f64 = 50.0;

/// c_m of (2): rays of a mutation, as they are on the scenes of the repository.
const RAYS_PER_MUTATION: f64 = 4.5;

/// Scores up to this many times the least are as good: (3) takes chains to explore all there is, which flatters
/// them where bright paths lie in many places.
const ABOUT_THE_LEAST: f64 = 1.3;

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
    /// The best division for a film of `size` pixels, as far as `pilot` can tell.
    pub fn new(size: [u32; 2], pilot: &Pilot, settings: DivisionSettings) -> Self {
        let splats: Vec<Splat> = pilot.found.iter().map(|found| found.splat).collect();
        let map = if settings.importance {
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

    /// The share of plain sampling in a path of `edges` edges that brings `value` to `position`; the
    /// chains have the rest.
    #[inline]
    pub fn plain_share(&self, edges: usize, value: Rgb, position: [f32; 2]) -> f32 {
        if edges <= self.plain_edges {
            return 1.0;
        }
        let brightness = self.brightness(value, position);
        if brightness > self.threshold {
            self.threshold / brightness
        } else {
            1.0
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

    /// The greatest threshold whose score is about the least, among powers of the square root of 2. Not
    /// much more than the brightest path of the pilot: what it has not met may be brighter, and is then
    /// for the chains.
    fn best(&self) -> f64 {
        let brightest = self.bright.iter().copied().fold(1.0, f64::max);
        let steps = (2.0 * brightest.log2()).ceil() as i32;
        let thresholds = (0..=steps).map(|i| (0.5 * f64::from(i)).exp2());
        let scored: Vec<_> = thresholds.map(|t| (t, self.score(t))).collect();
        let scores = scored.iter().map(|(_, score)| *score);
        let enough = ABOUT_THE_LEAST * scores.fold(f64::INFINITY, f64::min);
        let good = scored.iter().rev().find(|(_, score)| *score <= enough);
        good.map_or(1.0, |(threshold, _)| *threshold)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::render::pilot::Found;
    use crate::scene::RayCounts;

    /// A pilot of `n` samples that have each found a grey path of three edges and this brightness.
    fn pilot(n: u64, brightness: impl Fn(u64) -> f32) -> Pilot {
        let found = |i: u64| Found {
            edges: 3,
            splat: Splat {
                position: [i % 64, i / 64 % 64].map(|cell| (cell as f32 + 0.5) / 64.0),
                value: Rgb::splat(brightness(i)),
            },
        };
        Pilot {
            samples: n,
            found: (0..n).map(found).collect(),
            rays: RayCounts {
                closest_hit: 8 * n,
                shadow: 8 * n,
            },
        }
    }

    fn division(pilot: &Pilot, settings: DivisionSettings) -> Division {
        Division::new([64, 48], pilot, settings)
    }

    #[test]
    fn plain_samples_are_bounded_and_chains_have_the_rest() {
        let division = division(&pilot(1 << 12, |_| 2.0), DivisionSettings::default());
        for brightness in [1e-3, 1.0, 30.0, 1e6f32] {
            let value = Rgb::splat(brightness);
            let position = [0.3, 0.7];
            let share = division.plain_share(5, value, position);
            let plain = division.brightness(value * share, position);
            assert!(plain <= division.threshold * (1.0 + 1e-5), "{plain}");
            assert!(share > 0.0 && share <= 1.0, "{share}");
            assert_eq!(division.plain_share(2, value, position), 1.0);
        }
    }

    #[test]
    fn joint_direct_light_may_go_to_chains() {
        let settings = DivisionSettings {
            separate_direct: false,
            threshold: Some(1.0),
            ..DivisionSettings::default()
        };
        let division = division(&pilot(1 << 12, |_| 2.0), settings);
        let share = division.plain_share(1, Rgb::splat(200.0), [0.5, 0.5]);
        assert!((share - 0.01).abs() < 1e-3, "{share}");
    }

    /// Where all paths are alike chains gain nothing; where one path in a thousand has half of the light
    /// they gain much, and the threshold lies between the two kinds.
    #[test]
    fn chains_pay_where_few_paths_have_much_light() {
        let even = division(&pilot(1 << 14, |_| 1.0), DivisionSettings::default());
        assert!((even.gain - 1.0).abs() < 1e-3, "{}", even.gain);
        let rare = |i: u64| if i.is_multiple_of(1000) { 1000.0 } else { 1.0 };
        let uneven = division(&pilot(1 << 14, rare), DivisionSettings::default());
        assert!(uneven.gain > 2.0, "{}", uneven.gain);
        assert!(
            (1.0..400.0).contains(&uneven.threshold),
            "{}",
            uneven.threshold
        );
    }

    #[test]
    fn darkness_is_divided_too() {
        let dark = division(&pilot(1 << 12, |_| 0.0), DivisionSettings::default());
        assert!(dark.threshold.is_finite() && dark.energy > 0.0 && dark.gain == 1.0);
    }
}
