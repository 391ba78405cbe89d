//! The image that a pass loop accumulates.
//!
//! The camera samples of a pixel are distributed by its reconstruction filter and averaged. Splats of
//! technique t = 1 may land on any pixel, and are divided by the number of samples of the whole film (Veach
//! 1997, section 10.3.4).

use super::clock::Clock;
use super::error::{ErrorEstimate, PassVariance};
use super::passes::{Tile, TileBuffer};
use super::{
    Method, NonFinite, Rendering, SampleId, Settings, Statistics, Warning, pixel_count, warnings,
};
use crate::film::{Film, Image, SplatLog};
use crate::integrators::SplatList;
use crate::math::color::to_pixel;
use crate::scene::{RayCounts, Scene};

/// The splats of a tile's samples.
#[derive(Default)]
pub(super) struct TileSplats {
    /// Splats of the last sample.
    pub last: SplatList,
    /// Light of techniques t > 1, one value for each pixel of the tile.
    pixels: Vec<[f64; 3]>,
    /// Splats of technique t = 1.
    light_image: SplatLog,
    /// Pixels whose sample had contributions that were not finite, and their number.
    non_finite: Vec<(u64, u64)>,
}

impl TileBuffer for TileSplats {
    fn clear(&mut self) {
        self.pixels.clear();
        self.light_image.clear();
        self.non_finite.clear();
    }
}

impl TileSplats {
    /// Adds the splats in `last`, which belong to the sample of `pixel`.
    #[inline]
    pub fn add_last(&mut self, pixel: u64) {
        self.pixels.push(self.last.pixel.as_dvec3().to_array());
        for splat in &self.last.light_image {
            self.light_image.push(*splat);
        }
        if self.last.non_finite > 0 {
            self.non_finite.push((pixel, self.last.non_finite));
        }
    }
}

/// Sums of all passes.
pub(super) struct ImageEstimate {
    size: [usize; 2],
    film: Film,
    /// Present if the error is requested.
    variance: Option<PassVariance>,
    pub non_finite: NonFinite,
}

impl ImageEstimate {
    /// A black image.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        let [width, height] = [scene.film.width, scene.film.height];
        let variance = || PassVariance::new(pixel_count(scene));
        Self {
            size: [width as usize, height as usize],
            film: Film::new(width, height, scene.film.filter),
            variance: settings.wants_error().then(variance),
            non_finite: NonFinite::default(),
        }
    }

    /// Adds the samples of `tiles`, in their order.
    pub fn add<'t>(&mut self, tiles: impl Iterator<Item = (&'t Tile, &'t TileSplats)>) {
        let mut logs = Vec::new();
        for (tile, splats) in tiles {
            for (pixel, sum) in tile.pixels.clone().zip(&splats.pixels) {
                self.film.add_samples(pixel as usize, *sum, 1);
            }
            let pass = tile.pass;
            for &(pixel, count) in &splats.non_finite {
                self.non_finite.add(count, SampleId::Pixel { pass, pixel });
            }
            logs.push(&splats.light_image);
        }
        self.film.apply(&logs);
    }

    /// The estimate of a pixel after `samples` samples of the film.
    #[inline]
    pub fn value(&self, pixel: usize, samples: u64) -> [f64; 3] {
        self.film.value(pixel, 1.0 / samples.max(1) as f64)
    }

    /// Records a pass for the error, if requested. `value` returns a pixel of the image so far.
    pub fn end_pass(&mut self, value: impl Fn(&Self, usize) -> [f64; 3] + Sync) {
        if let Some(mut variance) = self.variance.take() {
            variance.add(|pixel| value(self, pixel));
            self.variance = Some(variance);
        }
    }

    /// The image whose pixels are given by `value`.
    pub fn image(&self, value: impl Fn(usize) -> [f64; 3]) -> Image {
        let [width, height] = self.size;
        Image {
            width,
            height,
            pixels: (0..width * height).map(|i| to_pixel(value(i))).collect(),
        }
    }

    /// The error of `image`, if it is requested and can be estimated.
    pub fn error(&self, image: &Image) -> Option<ErrorEstimate> {
        self.variance.as_ref()?.estimate(image)
    }

    /// The result of a render: `image`, which `samples` samples and `rays` rays have made, with its error,
    /// statistics and warnings.
    pub fn rendering(
        &self,
        scene: &Scene,
        settings: &Settings,
        clock: &Clock,
        image: Image,
        samples: u64,
        rays: RayCounts,
    ) -> Rendering {
        let error = self.error(&image);
        let warnings = self.warnings(settings, samples, error.as_ref());
        let seconds = [clock.elapsed(); 2];
        let found = self.non_finite.clone();
        Rendering {
            image,
            error,
            statistics: Statistics::new(scene, settings, seconds, samples, rays, found),
            interrupted: clock.was_cancelled(samples),
            warnings,
        }
    }

    /// Warnings about an image of `samples` samples.
    fn warnings(
        &self,
        settings: &Settings,
        samples: u64,
        error: Option<&ErrorEstimate>,
    ) -> Vec<Warning> {
        // Every sample of light tracing may contribute to every pixel, so no pixel needs its own.
        let pixels = self.size[0] as u64 * self.size[1] as u64;
        let unsampled = match settings.method() {
            Method::Light => None,
            _ => warnings::unsampled(samples, pixels),
        };
        warnings::non_finite(&self.non_finite)
            .into_iter()
            .chain(unsampled)
            .chain(warnings::error(settings, error))
            .chain(warnings::rare_contributions(error))
            .collect()
    }
}
