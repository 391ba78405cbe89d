//! Means over tiles of images: their moments over seeds, and the test that two images are the same.

use std::ops::Range;

use metrolight::render::{Method, Settings};
use metrolight::scene::Scene;
use metrolight::statistics::{Moments, holm, welch};

use super::renders::{renderings, settings};

/// Means of `pixels` over tiles of `size` (width, height), three channels each.
pub fn tile_means(pixels: &[[f32; 3]], width: usize, size: [usize; 2]) -> Vec<f64> {
    let columns = width.div_ceil(size[0]);
    let rows = (pixels.len() / width).div_ceil(size[1]);
    let mut sums = vec![(0.0, 0); columns * rows * 3];
    for (i, pixel) in pixels.iter().enumerate() {
        let tile = i / width / size[1] * columns + i % width / size[0];
        for (c, &value) in pixel.iter().enumerate() {
            sums[tile * 3 + c].0 += f64::from(value);
            sums[tile * 3 + c].1 += 1;
        }
    }
    let mean = |(sum, count): (f64, u32)| sum / f64::from(count);
    sums.into_iter().map(mean).collect()
}

/// Moments over `seeds` of the means of all tiles; `settings` gives everything but the seed.
pub fn tile_moments(
    scene: &Scene,
    settings: &Settings,
    seeds: Range<u64>,
    side: usize,
) -> Vec<Moments> {
    let mut moments = Vec::new();
    for rendering in renderings(scene, settings, seeds) {
        let image = &rendering.image;
        let tiles = tile_means(&image.pixels, image.width, [side; 2]);
        moments.resize(tiles.len(), Moments::default());
        for (m, mean) in moments.iter_mut().zip(tiles) {
            m.add(mean);
        }
    }
    moments
}

/// [`tile_moments`] with [`settings`]; calls with different `group` share no random number.
pub fn tiles(
    scene: &Scene,
    integrator: Method,
    spp: u64,
    (group, seeds): (u64, u64),
    side: usize,
) -> Vec<Moments> {
    let first = 1000 * group;
    tile_moments(
        scene,
        &settings(integrator, spp),
        first..first + seeds,
        side,
    )
}

/// Null hypothesis, for each tile and channel: both scenes have the same mean. Welch's test for
/// each, Holm's correction over all; rejected at `alpha`. Relative differences of less than `negligible`
/// do not count. Returns the smallest corrected p-value.
pub fn assert_same_image(name: &str, [a, b]: [&[Moments]; 2], negligible: f64, alpha: f64) -> f64 {
    assert_eq!(a.len(), b.len(), "{name}");
    let p_value = |(a, b): (&Moments, &Moments)| {
        if (a.mean - b.mean).abs() <= negligible * a.mean.abs() {
            1.0
        } else {
            welch(a, b)
        }
    };
    let adjusted = holm(&a.iter().zip(b).map(p_value).collect::<Vec<_>>());
    let (tile, &p) = adjusted
        .iter()
        .enumerate()
        .min_by(|x, y| x.1.total_cmp(y.1))
        .expect("some tiles");
    let (x, y) = (&a[tile], &b[tile]);
    assert!(
        p > alpha,
        "{name}: {} +- {} and {} +- {} differ in tile {}, channel {}: adjusted p = {p:e}",
        x.mean,
        x.standard_error(),
        y.mean,
        y.standard_error(),
        tile / 3,
        tile % 3
    );
    p
}
