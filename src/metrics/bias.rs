//! A test of bias: do two images with known standard errors have the same expectation?
//!
//! Both images are cut into square tiles, and Welch's test compares the means of each tile and
//! channel; Holm's correction over all of them keeps the probability of any false alarm at the level
//! of the whole test. The variance of a tile's mean follows from those of its n pixels, s_i^2, and from
//! their correlation:
//!
//! - independent pixels (path tracing, where each has its own samples): sum of s_i^2 / n^2;
//! - any correlation: at most (sum of s_i / n)^2, by the Cauchy-Schwarz inequality, with equality if all
//!   errors are fully correlated.
//!
//! One splat contributes to all pixels that its reconstruction filter reaches, a light subpath makes
//! several splats, a Markov chain stays in a neighbourhood, and b is common to the whole image. Pixels of
//! all methods but path tracing are thus correlated, by an amount that the file does not state, and only
//! a test with the second variance keeps its level.

use std::ops::Range;

use serde::Serialize;

use crate::statistics::{Moments, holm, smallest_detectable, welch};

/// Side of a tile in pixels.
pub const TILE: usize = 8;

/// Probability of a false alarm of the whole test.
pub const LEVEL: f64 = 0.01;

/// Probability with which the smallest detectable difference is detected.
pub const POWER: f64 = 0.9;

/// Differences of tile means below this, relative to the reference, are ignored: images without variance
/// differ by rounding.
const NEGLIGIBLE: f64 = 1e-5;

/// An image with its standard errors.
#[derive(Clone, Copy, Debug)]
pub struct Estimate<'a> {
    /// Its pixels, in rows from the top.
    pub pixels: &'a [[f32; 3]],
    /// The standard error of each.
    pub standard_errors: &'a [[f32; 3]],
    /// Number of independent parts of the samples that the standard errors come from, which have one degree
    /// of freedom less. `None` if unknown: they are then taken as exact.
    pub parts: Option<u64>,
    /// True if the errors of pixels are known to be independent.
    pub independent_pixels: bool,
}

/// The verdict of the test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BiasVerdict {
    /// Some tile differs by more than the errors allow for any correlation of the pixels.
    Differs,
    /// Some tile differs by more than independent pixels allow, but not by more than fully correlated ones.
    Unclear,
    /// No tile differs by more than independent pixels allow.
    NoneFound,
}

/// The result of a test of two images.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BiasTest {
    /// The verdict.
    pub verdict: BiasVerdict,
    /// Number of tiles; each has three channels.
    pub tiles: usize,
    /// Smallest p-value after Holm's correction, valid for any correlation of the pixels.
    pub smallest_p: f64,
    /// The same for independent pixels.
    pub smallest_p_if_independent: f64,
    /// Number of tiles with a channel whose corrected p-value, for any correlation, is below [`LEVEL`].
    pub differing_tiles: usize,
    /// Columns and rows of the tile with the smallest p-value (the first of equal ones).
    pub worst_tile: [Range<usize>; 2],
    /// Median over tiles and channels of the smallest difference that the first step of Holm's procedure
    /// detects with probability [`POWER`], over the reference's mean; `None` if that is 0.
    pub smallest_detectable: Option<f64>,
}

/// Tests the null hypothesis that `image` and `reference`, both of `width` pixels per row and equal height,
/// have the same expectation. They must be independent; with common random numbers, whose errors are
/// positively correlated, the test has less power and no more false alarms.
pub fn test_bias(image: &Estimate, reference: &Estimate, width: usize) -> BiasTest {
    let tiles = tiles(width, image.pixels.len() / width);
    let p_values = |independent: bool| {
        let p = |[a, b]: [Moments; 2]| {
            let negligible = (a.mean - b.mean).abs() <= NEGLIGIBLE * b.mean.abs();
            if negligible { 1.0 } else { welch(&a, &b) }
        };
        let pairs = pairs(&tiles, [image, reference], width, independent);
        holm(&pairs.into_iter().map(p).collect::<Vec<_>>())
    };
    let [correlated, independent] = [false, true].map(p_values);
    let smallest = |p: &[f64]| p.iter().copied().fold(1.0, f64::min);
    let [smallest_p, smallest_p_if_independent] = [&correlated, &independent].map(|p| smallest(p));
    // Holm's correction makes ties; the p-values for independent pixels have fewer.
    let by_p = |a: &usize, b: &usize| independent[*a].total_cmp(&independent[*b]);
    let worst = (0..independent.len()).min_by(by_p).unwrap_or(0) / 3;
    BiasTest {
        verdict: if smallest_p < LEVEL {
            BiasVerdict::Differs
        } else if smallest_p_if_independent < LEVEL {
            BiasVerdict::Unclear
        } else {
            BiasVerdict::NoneFound
        },
        tiles: tiles.len(),
        smallest_p,
        smallest_p_if_independent,
        differing_tiles: correlated
            .chunks(3)
            .filter(|tile| smallest(tile) < LEVEL)
            .count(),
        worst_tile: tiles[worst].clone(),
        smallest_detectable: relative_detectable(&pairs(&tiles, [image, reference], width, false)),
    }
}

/// Columns and rows of each tile; tiles at the right and bottom borders may be smaller.
fn tiles(width: usize, height: usize) -> Vec<[Range<usize>; 2]> {
    let cut = |size: usize| {
        let starts = (0..size).step_by(TILE);
        starts.map(move |start| start..size.min(start + TILE))
    };
    let rows = cut(height);
    rows.flat_map(|rows| cut(width).map(move |columns| [columns, rows.clone()]))
        .collect()
}

/// For each tile and channel, the moments of its mean in both images.
fn pairs(
    tiles: &[[Range<usize>; 2]],
    images: [&Estimate; 2],
    width: usize,
    independent: bool,
) -> Vec<[Moments; 2]> {
    let channels = tiles.iter().flat_map(|tile| [0, 1, 2].map(|c| (tile, c)));
    channels
        .map(|(tile, c)| images.map(|image| image.tile(tile, width, c, independent)))
        .collect()
}

fn relative_detectable(pairs: &[[Moments; 2]]) -> Option<f64> {
    let level = LEVEL / pairs.len() as f64;
    let differences = pairs
        .iter()
        .map(|[a, b]| smallest_detectable(a, b, level, POWER));
    let mut differences: Vec<f64> = differences.collect();
    differences.sort_by(f64::total_cmp);
    // Tiles have equal weights, so up to the smaller tiles at the borders this is the mean of the image.
    let mean = pairs.iter().map(|[_, b]| b.mean).sum::<f64>() / pairs.len() as f64;
    (mean > 0.0).then(|| differences[differences.len() / 2] / mean)
}

impl Estimate<'_> {
    /// Degrees of freedom for exactly known standard errors.
    const EXACT: f64 = 1e9;

    /// The mean of channel `c` in a tile, as moments with its standard error. Unless pixels are known to be
    /// independent, or `independent` treats them so, they count as fully correlated.
    fn tile(
        &self,
        [columns, rows]: &[Range<usize>; 2],
        width: usize,
        c: usize,
        independent: bool,
    ) -> Moments {
        let indices = || {
            let rows = rows.clone();
            rows.flat_map(|row| columns.clone().map(move |column| row * width + column))
        };
        let n = indices().count() as f64;
        let mean = indices().map(|i| f64::from(self.pixels[i][c])).sum::<f64>() / n;
        let freedom = self.parts.map_or(Self::EXACT, |parts| parts as f64 - 1.0);
        let errors = || indices().map(|i| f64::from(self.standard_errors[i][c]));
        let (variance, freedom) = if independent || self.independent_pixels {
            // Satterthwaite (1946): degrees of freedom of a sum of estimated variances.
            let squares = errors().map(|s| s * s).sum::<f64>();
            let fourths = errors().map(|s| s.powi(4)).sum::<f64>();
            let alike = if fourths > 0.0 {
                squares * squares / fourths
            } else {
                1.0
            };
            (squares / (n * n), freedom * alike)
        } else {
            ((errors().sum::<f64>() / n).powi(2), freedom)
        };
        let count = freedom.clamp(1.0, Self::EXACT) + 1.0;
        Moments::from_summary(count as u64, mean, variance * count.floor())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256PlusPlus;

    const WIDTH: usize = 24;
    const HEIGHT: usize = 20;
    const PARTS: usize = 16;

    /// An image and standard errors from parts of mean 1 and deviation 0.5, of which the fraction
    /// `common` is common to all pixels of a tile.
    fn measured(rng: &mut Xoshiro256PlusPlus, common: f64) -> [Vec<[f32; 3]>; 2] {
        let mut normal = || rng.sample::<f64, _>(StandardNormal);
        let mut pixels = vec![[Moments::default(); 3]; WIDTH * HEIGHT];
        for _ in 0..PARTS {
            let shared: Vec<f64> = (0..WIDTH * HEIGHT / 64 + 9).map(|_| normal()).collect();
            for (i, pixel) in pixels.iter_mut().enumerate() {
                let tile = i / WIDTH / TILE * WIDTH / TILE + i % WIDTH / TILE;
                for channel in pixel.iter_mut() {
                    let own = (1.0 - common * common).sqrt() * normal();
                    channel.add(1.0 + 0.5 * (common * shared[tile] + own));
                }
            }
        }
        let map = |f: fn(&Moments) -> f64| {
            let pixels = pixels.iter();
            pixels
                .map(|p| std::array::from_fn(|c| f(&p[c]) as f32))
                .collect()
        };
        [map(|m| m.mean), map(Moments::standard_error)]
    }

    fn estimate(measured: &[Vec<[f32; 3]>; 2], independent_pixels: bool) -> Estimate<'_> {
        Estimate {
            pixels: &measured[0],
            standard_errors: &measured[1],
            parts: Some(PARTS as u64),
            independent_pixels,
        }
    }

    #[test]
    fn a_tile_by_hand() {
        let pixels = [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [9.0; 3]];
        let standard_errors = [[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [9.0; 3]];
        let mut image = Estimate {
            pixels: &pixels,
            standard_errors: &standard_errors,
            parts: Some(11),
            independent_pixels: false,
        };
        let error = |m: Moments| (m.variance() / m.count as f64).sqrt();
        let tile = [0..2, 0..1];
        let together = image.tile(&tile, 3, 0, false);
        assert_eq!((together.mean, together.count), (1.5, 11));
        assert!((error(together) - 3.5).abs() < 1e-12);
        // 10 * 25^2 / (81 + 256) degrees of freedom.
        let apart = image.tile(&tile, 3, 0, true);
        assert_eq!((apart.mean, apart.count), (1.5, 19));
        assert!((error(apart) - 2.5).abs() < 1e-12);
        image.independent_pixels = true;
        assert_eq!(image.tile(&tile, 3, 0, false), apart);
        image.parts = None;
        assert_eq!(image.tile(&tile, 3, 0, false).count, 1_000_000_001);
        assert_eq!(tiles(9, 8), [[0..8, 0..8], [8..9, 0..8]]);
    }

    /// Under the null hypothesis, of 200 tests at level 0.01, 2 +- 1.4 raise an alarm. With errors common
    /// to a tile, tests that treat pixels as independent nearly always do, and the verdict does not.
    #[test]
    fn no_more_false_alarms_than_the_level() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
        let mut alarms = |common: f64, independent: bool, runs: usize| {
            let mut count = [0; 2];
            for _ in 0..runs {
                let [a, b] = [(); 2].map(|()| measured(&mut rng, common));
                let [a, b] = [&a, &b].map(|side| estimate(side, independent));
                let test = test_bias(&a, &b, WIDTH);
                count[0] += usize::from(test.smallest_p < LEVEL);
                count[1] += usize::from(test.smallest_p_if_independent < LEVEL);
            }
            count
        };
        let apart = alarms(0.0, true, 200);
        assert!(apart[0] <= 8 && apart[0] == apart[1], "{apart:?}");
        let together = alarms(0.9, false, 50);
        assert!(together[0] <= 3 && together[1] > 45, "{together:?}");
    }

    #[test]
    fn a_difference_of_the_detectable_size_is_detected() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
        let reference = measured(&mut rng, 0.0);
        let mut image = measured(&mut rng, 0.0);
        let test = |image: &[Vec<[f32; 3]>; 2], known: bool| {
            test_bias(&estimate(image, known), &estimate(&reference, known), WIDTH)
        };
        let size = test(&image, true).smallest_detectable.unwrap();
        assert_eq!(test(&image, true).verdict, BiasVerdict::NoneFound);
        for row in 8..16 {
            for column in 16..24 {
                image[0][row * WIDTH + column][1] += 1.4 * size as f32;
            }
        }
        let found = test(&image, true);
        assert_eq!(found.verdict, BiasVerdict::Differs);
        assert_eq!((found.tiles, found.differing_tiles), (9, 1));
        assert_eq!(found.worst_tile, [16..24, 8..16]);
        // If errors may be fully correlated, such a difference is not significant.
        assert_eq!(test(&image, false).verdict, BiasVerdict::Unclear);
    }

    /// Without variance, the test compares for equality, up to rounding.
    #[test]
    fn exact_images_are_compared_exactly() {
        let zero = [[0.0; 3]; 64];
        let exact = |pixels| Estimate {
            pixels,
            standard_errors: &zero,
            parts: Some(2),
            independent_pixels: false,
        };
        let (one, two) = ([[1.0; 3]; 64], [[2.0; 3]; 64]);
        let equal = test_bias(&exact(&one), &exact(&one), 8);
        assert_eq!(
            (equal.verdict, equal.smallest_p),
            (BiasVerdict::NoneFound, 1.0)
        );
        assert_eq!(equal.smallest_detectable, Some(0.0));
        let rounded = test_bias(&exact(&[[1.000_001; 3]; 64]), &exact(&one), 8);
        assert_eq!(rounded.verdict, BiasVerdict::NoneFound);
        let test = test_bias(&exact(&two), &exact(&one), 8);
        assert_eq!((test.verdict, test.smallest_p), (BiasVerdict::Differs, 0.0));
    }
}
