//! Accumulation of samples and splats.
//!
//! The value of pixel j is the integral over the film of L(x) h(x - x_j) / W_j, where x_j is the pixel's
//! centre and W_j the integral of h(x - x_j) over the film: at the border a filter is normalised by the
//! part of it that the film covers.

use super::splats::{Splat, SplatFilm, SplatLog, add};
use super::{Filter, Image};
use crate::math::color::to_pixel;

/// An image under construction: samples of each pixel, and splats.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Per pixel, the sum and the number of samples distributed by the filter.
    samples: Vec<([f64; 3], u64)>,
    splats: SplatFilm,
}

impl Film {
    /// A black film of `width` x `height` pixels, both at least 1.
    pub fn new(width: u32, height: u32, filter: Filter) -> Self {
        Self {
            samples: vec![([0.0; 3], 0); width as usize * height as usize],
            splats: SplatFilm::new(width, height, filter),
        }
    }

    /// Adds `count` samples whose values sum to `sum` to a pixel (index in rows from the top).
    /// Their positions must come from [`super::FilmSampler`]: the pixel is their mean.
    pub fn add_samples(&mut self, pixel: usize, sum: [f64; 3], count: u64) {
        let (total, samples) = &mut self.samples[pixel];
        add(total, sum);
        *samples += count;
    }

    /// Adds a splat to every pixel whose filter reaches its position.
    pub fn splat(&mut self, splat: &Splat) {
        self.splats.splat(splat);
    }

    /// Adds all splats of `logs`, as [`SplatFilm::apply`] does.
    pub fn apply(&mut self, logs: &[&SplatLog]) {
        self.splats.apply(logs);
    }

    /// Value of a pixel: the mean of its samples (0 if there are none), plus its splats times
    /// `splat_scale`, which is 1 over the number of samples that made all splats.
    #[inline]
    pub fn value(&self, pixel: usize, splat_scale: f64) -> [f64; 3] {
        let (sum, count) = self.samples[pixel];
        let splats = self.splats.sum(pixel);
        let mean_scale = if count == 0 { 0.0 } else { 1.0 / count as f64 };
        std::array::from_fn(|c| sum[c] * mean_scale + splats[c] * splat_scale)
    }

    /// Resolves the image: [`Self::value`] of all pixels.
    pub fn resolve(&self, splat_scale: f64) -> Image {
        let pixels = 0..self.samples.len();
        let [width, height] = self.splats.size();
        Image {
            width,
            height,
            pixels: pixels
                .map(|pixel| to_pixel(self.value(pixel, splat_scale)))
                .collect(),
        }
    }
}
