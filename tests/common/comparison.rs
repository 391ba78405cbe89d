//! Compares independent renderings of one scene by two programs: are their means equal, and how large a
//! difference would have been detected?
//!
//! For each tile and channel, and for each channel of the whole image, z = (a - b) / sqrt(var a + var
//! b), where both variances are those of means over independent renderings. As these are few (16 to
//! 32), z is corrected by Welch's test, so that it is standard normal under the null hypothesis of equal
//! means; uncorrected, |z| > 4 would be about ten times as frequent as the normal distribution says. Two
//! verdicts follow:
//!
//! - Holm's correction over all tests of one image: is any tile or the whole image wrong?
//! - The distribution of the p-values P(Z < z) over all tests of many images: are they uniform? Small
//!   differences everywhere, or wrong variances, are detected here before any single tile is significant.

use metrolight::render::Settings;
use metrolight::scene::Scene;
use metrolight::statistics::{
    Moments, distance_from_uniform, holm, normal_two_sided, smallest_detectable, welch_score,
};
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

use super::renders::renderings;
use super::tiles::tile_means;

/// Relative standard error below which a tile counts as noiseless: it shows almost a single colour, and
/// its noise may be rounding, which is not normal.
const NOISELESS: f64 = 1e-4;

/// Relative difference allowed for such a tile.
const NEGLIGIBLE: f64 = 5e-4;

/// Probability of detecting a bias of the stated size.
pub const POWER: f64 = 0.9;

/// Independent renderings, each as the means of its tiles, then of the whole image, three channels each.
pub struct Renderings {
    rows: Vec<Vec<f64>>,
    moments: Vec<Moments>,
}

impl Renderings {
    /// Reduces images of `width` to tiles of `size` (width, height).
    pub fn new<'a>(
        images: impl IntoIterator<Item = &'a [[f32; 3]]>,
        width: usize,
        size: [usize; 2],
    ) -> Self {
        let row = |pixels: &[[f32; 3]]| {
            let mut row = tile_means(pixels, width, size);
            row.extend(tile_means(pixels, width, [width, pixels.len() / width]));
            row
        };
        let rows: Vec<Vec<f64>> = images.into_iter().map(row).collect();
        let column = |j: usize| rows.iter().map(|row| row[j]).collect();
        let moments = (0..rows[0].len()).map(column).collect();
        Self { rows, moments }
    }

    /// Ours, one for each of `seeds`; `settings` gives everything else.
    pub fn render(
        scene: &Scene,
        settings: &Settings,
        seeds: std::ops::Range<u64>,
        size: [usize; 2],
    ) -> Self {
        let images: Vec<Vec<[f32; 3]>> = renderings(scene, settings, seeds)
            .map(|rendering| rendering.image.pixels)
            .collect();
        let images = images.iter().map(Vec::as_slice);
        Self::new(images, scene.film.width as usize, size)
    }

    /// Moments over the renderings of all tiles and of the whole image.
    pub fn moments(&self) -> &[Moments] {
        &self.moments
    }

    /// Relative standard error of the median tile.
    pub fn error(&self) -> f64 {
        let tiles = &self.moments[..self.moments.len() - 3];
        let errors = tiles.iter().map(|m| m.standard_error() / m.mean.abs());
        median(errors.filter(|e| !e.is_nan()).collect())
    }

    /// Deviations of the rows from their mean in column `j`, scaled so that their sum with standard
    /// normal factors has the estimated variance of the mean.
    fn deviations(&self, j: usize) -> impl Iterator<Item = f64> {
        let n = self.rows.len() as f64;
        let scale = 1.0 / (n * (n - 1.0)).sqrt();
        let mean = self.moments[j].mean;
        self.rows.iter().map(move |row| (row[j] - mean) * scale)
    }
}

/// Our renderings against a reference.
pub struct Comparison {
    /// Adjusted p-values: of each tile, then of the whole image, three channels each.
    pub adjusted: Vec<f64>,
    /// z of the tests that have noise.
    scores: Vec<f64>,
    /// For each of these, the deviations of our renderings and of the reference's, over the standard
    /// error of the difference.
    deviations: [Vec<Vec<f64>>; 2],
    /// Identifiers of our renderings and of the reference.
    names: [u64; 2],
    /// Smallest relative bias that each test detects with probability [`POWER`].
    catchable: Vec<f64>,
    /// Relative excess of our whole image's green channel, which dominates luminance, and its standard
    /// error.
    pub excess: [f64; 2],
}

impl Comparison {
    /// Compares at level `alpha`. `names` identify our renderings and the reference: comparisons with the
    /// same second number share their reference.
    pub fn new(ours: &Renderings, reference: &Renderings, alpha: f64, names: [u64; 2]) -> Self {
        let mut all = Self {
            adjusted: Vec::new(),
            scores: Vec::new(),
            deviations: [Vec::new(), Vec::new()],
            names,
            catchable: Vec::new(),
            excess: [0.0; 2],
        };
        let pairs: Vec<_> = ours.moments.iter().zip(&reference.moments).collect();
        let level = alpha / pairs.len() as f64;
        for (j, (a, b)) in pairs.iter().enumerate() {
            let error = a.standard_error().hypot(b.standard_error());
            let brightness = b.mean.abs();
            if j + 2 == pairs.len() {
                all.excess = [a.mean - b.mean, error].map(|x| x / brightness);
            }
            if error <= NOISELESS * brightness {
                let same = (a.mean - b.mean).abs() <= NEGLIGIBLE * brightness;
                all.adjusted.push(if same { 1.0 } else { 0.0 });
                all.catchable.push(NEGLIGIBLE);
                continue;
            }
            let score = welch_score(a, b);
            all.adjusted.push(normal_two_sided(score));
            all.scores.push(score);
            let size = smallest_detectable(a, b, level, POWER);
            all.catchable.push(size / brightness);
            for (side, renderings) in all.deviations.iter_mut().zip([ours, reference]) {
                side.push(renderings.deviations(j).map(|d| d / error).collect());
            }
        }
        all.adjusted = holm(&all.adjusted);
        all
    }

    /// The smallest adjusted p-value, and its index.
    pub fn smallest(&self) -> (f64, usize) {
        let p_values = self.adjusted.iter().copied().zip(0..);
        p_values
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .expect("some tests")
    }

    /// The smallest relative bias detected with probability [`POWER`]: in the median tile, in the worst
    /// tile, and in the whole image.
    pub fn catches(&self) -> [f64; 3] {
        let (tiles, image) = self.catchable.split_at(self.catchable.len() - 3);
        let worst = |sizes: &[f64]| sizes.iter().copied().fold(0.0, f64::max);
        [median(tiles.to_vec()), worst(tiles), worst(image)]
    }

    /// The p-values P(Z < z) of the tests that have noise.
    pub fn p_values(&self) -> impl Iterator<Item = f64> {
        self.scores.iter().map(|&z| Normal::standard().cdf(z))
    }

    /// Appends scores simulated under the null hypothesis: normal, with the correlations of the
    /// renderings over tiles, channels and comparisons.
    fn simulate_null(&self, replicate: u64, scores: &mut Vec<f64>) {
        let [ours, reference] = [0, 1].map(|side: usize| {
            let stream = (replicate << 32) | (self.names[side] << 1) | side as u64;
            let count = self.deviations[side].first().map_or(0, Vec::len);
            normals(&mut Xoshiro256PlusPlus::seed_from_u64(stream), count)
        });
        let sum = |deviations: &[f64], factors: &[f64]| -> f64 {
            deviations.iter().zip(factors).map(|(d, f)| d * f).sum()
        };
        let [a, b] = &self.deviations;
        let pairs = a.iter().zip(b);
        scores.extend(pairs.map(|(a, b)| sum(a, &ours) - sum(b, &reference)));
    }
}

/// Kolmogorov and Smirnov's test that P(Z < z) is uniform over all tests of `comparisons`. Null
/// hypothesis: all renderings have the same means as their references. Tiles, channels and comparisons
/// with the same reference are correlated, so that Kolmogorov's distribution does not hold: the
/// distance is compared with those of `replicates` simulations, whose deviations are those of the
/// renderings times normal factors (the wild bootstrap; Wu 1986, "Jackknife, bootstrap and other
/// resampling methods"). The smallest possible p-value is 1 / (replicates + 1).
pub fn uniformity<'a>(
    comparisons: impl IntoIterator<Item = &'a Comparison>,
    replicates: u64,
) -> f64 {
    let comparisons: Vec<&Comparison> = comparisons.into_iter().collect();
    let mut p_values: Vec<f64> = comparisons.iter().flat_map(|c| c.p_values()).collect();
    let found = distance_from_uniform(&mut p_values);
    let is_as_far = |replicate: u64| {
        let mut scores = Vec::new();
        comparisons
            .iter()
            .for_each(|c| c.simulate_null(replicate, &mut scores));
        scores
            .iter_mut()
            .for_each(|z| *z = Normal::standard().cdf(*z));
        distance_from_uniform(&mut scores) >= found
    };
    let as_far = (0..replicates).into_par_iter().filter(|&r| is_as_far(r));
    (as_far.count() + 1) as f64 / (replicates + 1) as f64
}

/// Standard normal numbers.
pub fn normals(rng: &mut impl Rng, count: usize) -> Vec<f64> {
    rng.sample_iter(StandardNormal).take(count).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
