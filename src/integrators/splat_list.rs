//! The splats of one sample.

use glam::Vec2;

use crate::film::Splat;
use crate::math::{Rgb, color, luminance};
use crate::technique::Technique;

/// The splats that a path sampler maps one point of the hypercube to.
#[derive(Debug, Default)]
pub struct SplatList {
    /// Film position of the camera subpath, in [0, 1)^2.
    pub film: Vec2,
    /// Sum of the contributions there: techniques t > 1.
    pub pixel: Rgb,
    /// Contributions at other positions: technique t = 1.
    pub light_image: Vec<Splat>,
    /// Number of contributions left out because they were NaN, infinite or negative.
    pub non_finite: u64,
}

impl SplatList {
    /// Removes all splats.
    pub fn clear(&mut self) {
        self.film = Vec2::ZERO;
        self.pixel = Rgb::ZERO;
        self.light_image.clear();
        self.non_finite = 0;
    }

    /// Adds the weighted contribution of a path that `technique` sampled.
    #[inline]
    pub fn add(&mut self, technique: Technique, splat: Splat) {
        if !color::is_light(splat.value) {
            self.non_finite += 1;
        } else if technique.is_light_image() {
            if splat.value != Rgb::ZERO {
                self.light_image.push(splat);
            }
        } else {
            self.film = splat.position.into();
            self.pixel = color::saturated(self.pixel + splat.value);
        }
    }

    /// All splats that are not black.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = Splat> + '_ {
        let pixel = Splat {
            position: self.film.into(),
            value: self.pixel,
        };
        let pixel = (self.pixel != Rgb::ZERO).then_some(pixel);
        pixel.into_iter().chain(self.light_image.iter().copied())
    }

    /// Total luminance: the scalar contribution I(u) of Kelemen et al. (2002, section 2), positive if there
    /// is any splat. NaN if a contribution was left out.
    #[inline]
    pub fn luminance(&self) -> f64 {
        if self.non_finite > 0 {
            return f64::NAN;
        }
        self.iter()
            .map(|splat| f64::from(luminance(splat.value)))
            .sum()
    }
}
