//! Clamping: the light of every path is divided between independent samples and Markov chains.
//!
//! Let F be the weighted contribution of one technique at one point of the hypercube, and l = lum(F) / m
//! its luminance in units of the importance map m at its film position. With a threshold tau
//!
//!   F = F min(1, tau/l) + F max(0, 1 - tau/l).                                               (1)
//!
//! Independent samples estimate the first term, the clamped part; chains estimate the second, the residual.
//! The clamped part is at most tau m, so bright paths cause no outliers in the image of the independent
//! samples. The residual is zero for all paths below the threshold, so chains spend no mutation on light
//! that independent samples find well. The sum of both is F for any map and threshold: neither adds bias.
//!
//! Map and threshold determine the error at equal time. Relative to the map, for one independent sample
//! per pixel, the clamped part has the second moment V(tau) = E[min(l, tau)^2] and costs c_p rays. The
//! residual has the energy E(tau) = E[(l - tau)+]. If each mutation splats the energy e, it takes E/e
//! mutations of c_m rays and has the second moment eta e E, where eta mutations are equivalent to one
//! independent path. Error times cost is
//!
//!   (V + eta e E) (c_p + c_m E/e),                                                           (2)
//!
//! which is minimal for e^2 = V c_m / (eta c_p). The square root of the minimum is
//!
//!   sqrt(V(tau) c_p) + sqrt(eta c_m) E(tau).                                                 (3)
//!
//! The chosen tau is the greatest for which (3) is close to its minimum (`SCORE_TOLERANCE`). An infinite
//! tau is bidirectional path tracing.

use super::MmltSettings;
use super::importance::ImportanceMap;
use super::pilot::Pilot;
use crate::fault::{Fault, planted};
use crate::film::Splat;
use crate::math::color::is_light;
use crate::math::luminance;

/// eta of (2): number of mutations that are equivalent to one independent path. On the scenes of the
/// repository, values from 10 to 400 give about the same errors.
const CORRELATION: f64 = 50.0;

/// c_m of (2): rays of a mutation, measured on the scenes of the repository.
const RAYS_PER_MUTATION: f64 = 4.5;

/// Scores within this factor of the minimum are treated as equal: (3) is optimistic when bright paths are
/// scattered, because it assumes that chains explore all of them.
const SCORE_TOLERANCE: f64 = 1.3;

/// Maximum number of edges of paths that are not clamped if direct light is separate: directly visible
/// lights, and direct lighting.
const DIRECT_EDGES: usize = 2;

/// The rule (1), and the energy of a mutation.
#[derive(Clone, Debug, PartialEq)]
pub struct Clamp {
    /// m.
    map: ImportanceMap,
    /// tau, in units of the map; infinite if there is no residual.
    pub threshold: f32,
    /// Paths with at most this many edges are not clamped.
    unclamped_edges: usize,
    /// e of (2).
    pub energy: f64,
    /// (3) without chains (infinite tau) over (3) with them. Its square is the expected ratio of errors at
    /// equal time.
    pub gain: f64,
}

impl Clamp {
    /// The best clamp by (3) for a film of `size` pixels, as estimated from `pilot`. `settings` may fix its
    /// threshold.
    pub fn new(size: [u32; 2], pilot: &Pilot, settings: &MmltSettings) -> Self {
        let splats: Vec<Splat> = pilot.found.iter().map(|found| found.splat).collect();
        let map = if settings.importance_map {
            ImportanceMap::new(&splats, pilot.samples, size)
        } else {
            ImportanceMap::uniform(ImportanceMap::mean(&splats, pilot.samples))
        };
        let mut clamp = Self {
            map,
            threshold: f32::INFINITY,
            unclamped_edges: if settings.separate_direct {
                DIRECT_EDGES
            } else {
                0
            },
            energy: 1.0,
            gain: 1.0,
        };
        let moments = Moments::new(&clamp, pilot);
        let unclamped = moments.score(f64::INFINITY);
        let best = match settings.threshold {
            Some(threshold) => f64::from(threshold),
            None => moments.best(),
        };
        clamp.threshold = best as f32;
        clamp.energy = moments.energy(best);
        let best = moments.score(best);
        clamp.gain = if best > 0.0 { unclamped / best } else { 1.0 };
        clamp
    }

    /// Divides the weighted contribution of a path of `edges` edges into the clamped part and the residual.
    #[inline]
    pub fn split(&self, edges: usize, splat: Splat) -> [Splat; 2] {
        let Splat { position, value } = splat;
        let share = self.share(edges, splat);
        let mut residual = 1.0 - share;
        if planted(Fault::ResidualUnclamped) && residual > 0.0 {
            residual = 1.0;
        }
        [share, residual].map(|share| Splat {
            position,
            value: value * share,
        })
    }

    /// The share of the clamped part: min(1, tau/l), or 1 for paths that are not clamped.
    #[inline]
    fn share(&self, edges: usize, splat: Splat) -> f32 {
        if edges <= self.unclamped_edges {
            return 1.0;
        }
        let luminance = self.luminance(splat);
        if luminance > self.threshold {
            self.threshold / luminance
        } else {
            1.0
        }
    }

    /// The density of chains at a residual: its [`Self::luminance`]; `None` if chains have nothing to sample.
    #[inline]
    pub fn residual_density(&self, residual: Splat) -> Option<f64> {
        let density = f64::from(self.luminance(residual));
        (density > 0.0 && density.is_finite() && is_light(residual.value)).then_some(density)
    }

    /// l: the luminance of a splat in units of the map.
    #[inline]
    pub fn luminance(&self, splat: Splat) -> f32 {
        luminance(splat.value) / self.map.at(splat.position)
    }
}

/// The moments in (3).
struct Moments {
    /// l of the paths that may be clamped.
    clampable: Vec<f64>,
    /// Second moment of all other paths.
    rest: f64,
    /// Number of samples of the pilot.
    samples: f64,
    /// c_p.
    cost: f64,
}

impl Moments {
    fn new(clamp: &Clamp, pilot: &Pilot) -> Self {
        let samples = pilot.samples.max(1) as f64;
        let (mut clampable, mut rest) = (Vec::new(), 0.0);
        for found in &pilot.found {
            let luminance = f64::from(clamp.luminance(found.splat));
            if found.technique.edges() > clamp.unclamped_edges {
                clampable.push(luminance);
            } else {
                rest += luminance * luminance / samples;
            }
        }
        Self {
            clampable,
            rest,
            samples,
            cost: pilot.cost / samples,
        }
    }

    /// V(tau).
    fn second_moment(&self, threshold: f64) -> f64 {
        let bounded = self.clampable.iter().map(|l| l.min(threshold).powi(2));
        self.rest + bounded.sum::<f64>() / self.samples
    }

    /// E(tau).
    fn residual(&self, threshold: f64) -> f64 {
        let residuals = self.clampable.iter().map(|l| (l - threshold).max(0.0));
        residuals.sum::<f64>() / self.samples
    }

    /// (3).
    fn score(&self, threshold: f64) -> f64 {
        let independent = (self.second_moment(threshold) * self.cost).sqrt();
        independent + (CORRELATION * RAYS_PER_MUTATION).sqrt() * self.residual(threshold)
    }

    /// The energy of a mutation that minimises (2).
    fn energy(&self, threshold: f64) -> f64 {
        let second_moment = self.second_moment(threshold);
        let energy = (second_moment * RAYS_PER_MUTATION / (CORRELATION * self.cost)).sqrt();
        // Without light in the pilot there is nothing to optimise.
        if energy > 0.0 { energy } else { 1.0 }
    }

    /// The greatest threshold whose score is close to the minimum, among powers of the square root of 2 up
    /// to about the brightest path of the pilot. Brighter paths, which the pilot has not found, are left to
    /// the chains.
    fn best(&self) -> f64 {
        let brightest = self.clampable.iter().copied().fold(1.0, f64::max);
        let steps = (2.0 * brightest.log2()).ceil() as i32;
        let thresholds = (0..=steps).map(|i| (0.5 * f64::from(i)).exp2());
        let scored: Vec<_> = thresholds.map(|t| (t, self.score(t))).collect();
        let scores = scored.iter().map(|(_, score)| *score);
        let acceptable = SCORE_TOLERANCE * scores.fold(f64::INFINITY, f64::min);
        let good = scored.iter().rev().find(|(_, score)| *score <= acceptable);
        good.map_or(1.0, |(threshold, _)| *threshold)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::render::plan::pilot::Found;
    use crate::scene::RayCounts;
    use crate::technique::Technique;

    /// A pilot of `n` samples, each of which has found a grey path of three edges with this luminance.
    fn pilot(n: u64, luminance: impl Fn(u64) -> f32) -> Pilot {
        let found = |i: u64| Found {
            technique: Technique::Hit { t: 4 },
            splat: Splat {
                position: [i % 64, i / 64 % 64].map(|cell| (cell as f32 + 0.5) / 64.0),
                value: Rgb::splat(luminance(i)),
            },
        };
        Pilot {
            samples: n,
            found: (0..n).map(found).collect(),
            rays: RayCounts::default(),
            cost: 16.0 * n as f64,
        }
    }

    fn clamp(pilot: &Pilot) -> Clamp {
        Clamp::new([64, 48], pilot, &MmltSettings::default())
    }

    fn grey(value: f32, position: [f32; 2]) -> Splat {
        let value = Rgb::splat(value);
        Splat { position, value }
    }

    #[test]
    fn the_clamped_part_is_bounded_and_the_residual_is_the_rest() {
        let clamp = clamp(&pilot(1 << 12, |_| 2.0));
        for value in [1e-3, 1.0, 30.0, 1e6f32] {
            let splat = grey(value, [0.3, 0.7]);
            let [clamped, residual] = clamp.split(5, splat);
            assert!(clamp.luminance(clamped) <= clamp.threshold * (1.0 + 1e-5));
            let sum = clamped.value.x + residual.value.x;
            assert!((sum - value).abs() <= 1e-6 * value, "{sum}");
            assert!(clamped.value.x > 0.0 && residual.value.x >= 0.0);
            assert_eq!(clamp.split(2, splat)[0], splat);
        }
    }

    #[test]
    fn direct_light_is_clamped_unless_separate() {
        let settings = MmltSettings {
            separate_direct: false,
            threshold: Some(1.0),
            ..MmltSettings::default()
        };
        let clamp = Clamp::new([64, 48], &pilot(1 << 12, |_| 2.0), &settings);
        let [clamped, _] = clamp.split(1, grey(200.0, [0.5, 0.5]));
        assert!((clamped.value.x - 2.0).abs() < 0.2, "{}", clamped.value);
    }

    /// If all paths are equally bright, chains gain nothing. If one path in a thousand has half of the
    /// light, they gain much, and the threshold lies between the two luminances.
    #[test]
    fn chains_reduce_the_error_if_few_paths_have_much_light() {
        let even = clamp(&pilot(1 << 14, |_| 1.0));
        assert!((even.gain - 1.0).abs() < 1e-3, "{}", even.gain);
        let rare = |i: u64| if i.is_multiple_of(1000) { 1000.0 } else { 1.0 };
        let uneven = clamp(&pilot(1 << 14, rare));
        assert!(uneven.gain > 2.0, "{}", uneven.gain);
        assert!(
            (1.0..400.0).contains(&uneven.threshold),
            "{}",
            uneven.threshold
        );
    }

    #[test]
    fn a_black_pilot_gives_a_clamp() {
        for importance_map in [true, false] {
            let settings = MmltSettings {
                importance_map,
                ..MmltSettings::default()
            };
            let dark = Clamp::new([64, 48], &pilot(1 << 12, |_| 0.0), &settings);
            assert!(dark.threshold.is_finite() && dark.energy > 0.0 && dark.gain == 1.0);
            let [clamped, residual] = dark.split(5, grey(1.0, [0.5, 0.5]));
            assert_eq!(clamped.value.x + residual.value.x, 1.0);
        }
    }
}
