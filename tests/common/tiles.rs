//! Means over tiles of images, and their moments over independent seeds.

use metrolight::render::{Settings, Unobserved, render};
use metrolight::scene::Scene;
use metrolight::statistics::Moments;

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
        let tiles = tile_means(&image.pixels, image.width, [side; 2]);
        moments.resize(tiles.len(), Moments::default());
        for (m, mean) in moments.iter_mut().zip(tiles) {
            m.add(mean);
        }
    }
    moments
}
