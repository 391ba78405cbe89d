//! Independent samples of the pixels of an image.

use super::pixel_count;
use crate::film::FilmSampler;
use crate::path::dimensions;
use crate::sampling::seeds::Purpose;
use crate::sampling::{Dimension, IndependentSampler, Sampler};
use crate::scene::Scene;

/// An independent sample whose film position is distributed by the filter of its pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSampler {
    /// Film position, which replaces the dimensions of [`dimensions::FILM`].
    film: [f32; 2],
    sample: IndependentSampler,
}

impl PixelSampler {
    /// The film position.
    #[inline]
    pub fn film(&self) -> [f32; 2] {
        self.film
    }
}

impl Sampler for PixelSampler {
    #[inline]
    fn get<const N: usize>(&mut self, first: Dimension) -> [f32; N] {
        let mut values = self.sample.get::<N>(first);
        if first.stream == dimensions::FILM.stream && first.index < 2 {
            for (value, film) in values.iter_mut().zip(&self.film[first.index..]) {
                *value = *film;
            }
        }
        values
    }
}

/// The samples of a render, addressed by pass and pixel: one for every pixel in each pass.
#[derive(Clone, Debug)]
pub(super) struct PixelSamples {
    seed: u64,
    pixels: u64,
    film: FilmSampler,
}

impl PixelSamples {
    /// The samples of a render of `scene` under `seed`.
    pub fn new(scene: &Scene, seed: u64) -> Self {
        let film = &scene.film;
        Self {
            seed,
            pixels: pixel_count(scene),
            film: FilmSampler::new(film.width, film.height, film.filter),
        }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> u64 {
        self.pixels
    }

    /// The sample of `pixel` (in rows from the top) in a pass.
    #[inline]
    pub fn sample(&self, pass: u64, pixel: u64) -> PixelSampler {
        let index = pass * self.pixels + pixel;
        let mut sample = IndependentSampler::new(self.seed, Purpose::Pixels, index);
        let u = sample.get(dimensions::FILM);
        PixelSampler {
            film: self.film.pixel_position(pixel as usize, u),
            sample,
        }
    }
}
