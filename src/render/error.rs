//! Standard errors of an image, from the spread of independent parts of its samples, and the check of a
//! target error.

use std::ops::Range;

use rayon::prelude::*;

use super::Settings;
use crate::film::{Image, SplatFilm, SplatLog};
use crate::math::color::to_pixel;
use crate::metrics::expected_relative_mse;
use crate::statistics::Moments;

/// The error of an image as estimated from its own samples.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Standard error of every pixel and channel, in the unit of the image.
    pub standard_errors: Vec<[f32; 3]>,
    /// Expected [`relative_mse()`](crate::metrics::relative_mse()) of the image.
    pub relative_mse: f64,
    /// Number of independent parts of the samples whose spread was measured: passes over all pixels, or
    /// groups of chains. The standard errors have `parts` - 1 degrees of freedom.
    pub parts: u64,
    /// Share of pixels whose variance comes almost entirely from one part. The paths that this part found
    /// are so rare that similar paths are probably still missing, and the true errors are larger.
    pub dominated_share: f64,
}

/// Variance of a pixel, per channel.
struct PixelVariance {
    variance: [f64; 3],
    /// The largest share of the variance, summed over channels, that one part has.
    largest_share: f64,
}

impl ErrorEstimate {
    /// Maximum of [`Self::dominated_share`] without a warning. If it is exceeded, errors are probably larger than
    /// estimated.
    pub const MAX_DOMINATED_SHARE: f64 = 0.05;

    /// A part with more than this share of the variance dominates it: of 16 normal deviates, the largest
    /// has a greater share with probability 10^-8.
    const MAX_SHARE: f64 = 0.8;

    fn new(image: &Image, pixels: &[PixelVariance], parts: u64) -> Self {
        let error = |pixel: &PixelVariance| to_pixel(pixel.variance.map(f64::sqrt));
        let standard_errors: Vec<[f32; 3]> = pixels.iter().map(error).collect();
        let dominated = pixels
            .iter()
            .filter(|pixel| pixel.largest_share > Self::MAX_SHARE);
        Self {
            relative_mse: expected_relative_mse(&image.pixels, &standard_errors),
            standard_errors,
            parts,
            dominated_share: dominated.count() as f64 / pixels.len() as f64,
        }
    }
}

/// When to check the error, and whether it is small enough.
pub(super) struct TargetError {
    /// The target relMSE.
    error: Option<f64>,
    pixels: u64,
    /// Samples at which to check next.
    next: u64,
}

impl TargetError {
    /// Samples per pixel before the first check. With fewer samples, an image that lacks its rare bright
    /// paths would seem converged.
    const FIRST_CHECK: u64 = 16;

    pub fn new(settings: &Settings, pixels: u64) -> Self {
        Self {
            error: settings.target_error,
            pixels,
            next: Self::FIRST_CHECK * pixels,
        }
    }

    /// True if the error is to be checked after `done` samples. The number of samples grows by a tenth
    /// between checks: frequent checks make it more likely to stop at an estimate that is too low.
    pub fn is_due(&self, done: u64) -> bool {
        self.error.is_some() && done >= self.next
    }

    /// Checks the error after `done` samples; `None` if it could not be estimated. Returns the estimated
    /// fraction of the work that is done: 1 if the target is reached, otherwise target over relMSE, because
    /// relMSE falls as one over the number of samples.
    pub fn check(&mut self, done: u64, estimate: Option<&ErrorEstimate>) -> f64 {
        self.next = (done + done / 10).max(done + self.pixels);
        match (self.error, estimate) {
            (Some(error), Some(estimate)) if estimate.relative_mse > error => {
                error / estimate.relative_mse
            }
            (Some(_), Some(_)) => 1.0,
            _ => 0.0,
        }
    }
}

/// Variance of the pixels of a Monte Carlo image, from its passes. A pass samples every pixel once, so
/// passes are independent, identically distributed images. The contribution of a pass to a pixel is the sum
/// of its camera sample and of all splats there, so that their covariance is included.
pub(super) struct PassVariance {
    /// Number of passes.
    count: u64,
    pixels: Vec<PassSums>,
}

/// Contributions of the passes to a pixel.
#[derive(Clone, Copy, Default)]
struct PassSums {
    sum: [f64; 3],
    /// Sum of squared deviations from the mean.
    squares: [f64; 3],
    /// The greatest contribution of a pass, summed over channels.
    greatest: f64,
}

impl PassSums {
    fn variance(&self, n: f64) -> PixelVariance {
        let [sum, squares] = [self.sum, self.squares].map(|v| v.iter().sum::<f64>());
        PixelVariance {
            variance: self.squares.map(|s| s.max(0.0) / (n * (n - 1.0))),
            largest_share: share((self.greatest - sum / n).powi(2) / 3.0, squares),
        }
    }
}

/// `part` over `whole`, where 0/0 = 0: no part has a share of zero variance.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

impl PassVariance {
    pub fn new(pixels: u64) -> Self {
        Self {
            count: 0,
            pixels: vec![PassSums::default(); pixels as usize],
        }
    }

    /// Adds the next pass; `mean` returns a pixel of the image so far. The contribution of the pass is the
    /// difference from the previous sum, with the same rounding errors as the sums of the film. Squared
    /// deviations are updated by Welford's recurrence (Welford 1962).
    pub fn add(&mut self, mean: impl Fn(usize) -> [f64; 3] + Sync) {
        self.count += 1;
        let n = self.count as f64;
        let pixels = self.pixels.par_iter_mut().enumerate();
        pixels.for_each(|(i, pixel)| {
            let mean = mean(i);
            let mut contribution = 0.0;
            for (c, mean) in mean.into_iter().enumerate() {
                let value = n * mean - pixel.sum[c];
                if n > 1.0 {
                    pixel.squares[c] += (value - pixel.sum[c] / (n - 1.0)) * (value - mean);
                }
                pixel.sum[c] = n * mean;
                contribution += value;
            }
            pixel.greatest = pixel.greatest.max(contribution);
        });
    }

    /// The error of `image`; `None` before the second pass. Samples of an incomplete pass are ignored, so
    /// the estimate is then slightly high.
    pub fn estimate(&self, image: &Image) -> Option<ErrorEstimate> {
        if self.count < 2 {
            return None;
        }
        let n = self.count as f64;
        let pixels: Vec<PixelVariance> = self.pixels.iter().map(|p| p.variance(n)).collect();
        Some(ErrorEstimate::new(image, &pixels, self.count))
    }
}

/// Independent groups of Markov chains. The spread of their images gives the error of the image, for any
/// correlation of the states within a chain.
///
/// Group g with m_g of all M mutations has the image s_g/m_g, s_g being its splats with the weights
/// (c + l)/(I/b_0 + p). It also has its own estimate b_g of b, from its part of the bootstrap and its
/// own large steps. The final image has the factor b/b_0 on its chain part A (see
/// [`super::pssmlt`]), so to first order the image of group g is
///
///   X_g = s_g/m_g + A (b_g - b_0)/b_0,
///
/// and the final image is their mean, weighted by w_g = m_g/M. Its variance is estimated by
/// G/(G - 1) sum_g w_g^2 (X_g - mean)^2.
#[derive(Clone)]
pub(super) struct Groups {
    films: Vec<SplatFilm>,
}

/// The work of a group of chains.
pub(super) struct GroupWork {
    /// m_g.
    pub mutations: u64,
    /// Densities of its uniform samples, whose mean is b_g.
    pub uniform: Moments,
}

impl Groups {
    /// Maximum number of groups: the standard errors have 15 degrees of freedom, at the cost of the memory
    /// of 16 films.
    const MAX: usize = 16;

    /// Groups for `chains` chains. `film` is a black film, which is copied for each group.
    pub fn new(chains: usize, film: &SplatFilm) -> Self {
        Self {
            films: vec![film.clone(); chains.min(Self::MAX)],
        }
    }

    /// Number of groups.
    pub fn len(&self) -> usize {
        self.films.len()
    }

    /// The chains of group `g`, out of all `chains`. They are neighbours: neighbouring chains start at
    /// neighbouring bootstrap samples, so chains with the same start are in the same group if possible.
    pub fn chains_of(&self, g: usize, chains: usize) -> Range<usize> {
        chains * g / self.len()..chains * (g + 1) / self.len()
    }

    /// Adds the splats of some of `all` chains: `logs` has two for each chain.
    pub fn apply(&mut self, all: usize, chains: Range<usize>, logs: &[[&SplatLog; 2]]) {
        for g in 0..self.len() {
            let group = self.chains_of(g, all);
            let begin = group.start.clamp(chains.start, chains.end) - chains.start;
            let end = group.end.clamp(chains.start, chains.end) - chains.start;
            if begin < end {
                self.films[g].apply(logs[begin..end].as_flattened());
            }
        }
    }

    /// The error of `image`. `chain_part` is A per pixel, `b_0` the constant in the weights. `None`
    /// if fewer than two groups have made mutations.
    pub fn estimate(
        &self,
        image: &Image,
        work: &[GroupWork],
        b_0: f64,
        chain_part: impl Fn(usize) -> [f64; 3] + Sync,
    ) -> Option<ErrorEstimate> {
        let active = || {
            let films = self.films.iter().zip(work);
            films.filter(|(_, work)| work.mutations > 0)
        };
        let groups = active().count() as f64;
        if groups < 2.0 {
            return None;
        }
        let all: u64 = work.iter().map(|work| work.mutations).sum();
        let pixel = |i: usize| {
            let (chain, mut parts) = (chain_part(i), [[0.0; 3]; Self::MAX]);
            let mut mean = [0.0; 3];
            let mut weights = [0.0; Self::MAX];
            for ((part, weight), (film, work)) in parts.iter_mut().zip(&mut weights).zip(active()) {
                let (sum, mutations) = (film.sum(i), work.mutations as f64);
                *weight = mutations / all as f64;
                for c in 0..3 {
                    part[c] = sum[c] / mutations + chain[c] * (work.uniform.mean / b_0 - 1.0);
                    mean[c] += *weight * part[c];
                }
            }
            let squares = parts.iter().zip(weights).map(|(part, weight)| {
                std::array::from_fn::<f64, 3, _>(|c| (weight * (part[c] - mean[c])).powi(2))
            });
            let total = squares.clone().fold([0.0; 3], |total, square| {
                std::array::from_fn(|c| total[c] + square[c])
            });
            let largest = squares.map(|s| s.iter().sum()).fold(0.0, f64::max);
            PixelVariance {
                variance: total.map(|v| v * groups / (groups - 1.0)),
                largest_share: share(largest, total.iter().sum()),
            }
        };
        let pixels: Vec<PixelVariance> =
            (0..image.pixels.len()).into_par_iter().map(pixel).collect();
        Some(ErrorEstimate::new(image, &pixels, groups as u64))
    }
}
