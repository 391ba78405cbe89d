//! Means over tiles of images, and their moments over independent seeds.

use metrolight::render::{Settings, Unobserved, render};
use metrolight::scene::Scene;
use metrolight::statistics::Moments;

/// Sums of `pixels` over tiles of `side` x `side`, three channels each, with the number of pixels.
pub fn tile_sums(pixels: &[[f32; 3]], width: usize, side: usize) -> Vec<(f64, u32)> {
    let columns = width.div_ceil(side);
    let rows = (pixels.len() / width).div_ceil(side);
    let mut sums = vec![(0.0, 0); columns * rows * 3];
    for (i, pixel) in pixels.iter().enumerate() {
        let tile = i / width / side * columns + i % width / side;
        for (c, &value) in pixel.iter().enumerate() {
            sums[tile * 3 + c].0 += f64::from(value);
            sums[tile * 3 + c].1 += 1;
        }
    }
    sums
}

/// Moments over `seeds` of the means of all tiles; `settings` names everything but the seed.
pub fn tile_moments(
    scene: &Scene,
    settings: &Settings,
    seeds: std::ops::Range<u64>,
    side: usize,
) -> Vec<Moments> {
    let mut moments = Vec::new();
    for seed in seeds {
        let settings = Settings {
            seed,
            ..settings.clone()
        };
        let image = render(scene, &settings, &Unobserved)
            .expect("threads")
            .image;
        let tiles = tile_sums(&image.pixels, image.width, side);
        moments.resize(tiles.len(), Moments::default());
        for (m, (sum, count)) in moments.iter_mut().zip(tiles) {
            m.add(sum / f64::from(count));
        }
    }
    moments
}
