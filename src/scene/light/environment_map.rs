//! Environment maps: radiance by direction from a latitude-longitude image.
//!
//! The mapping is Mitsuba 3's: theta = pi v from +y, phi = 2 pi u, direction
//! (sin phi sin theta, cos theta, -cos phi sin theta). Columns are centred at u = (i + 1/2)/width and
//! repeat; rows are at v = j/(rows - 1), the first and last at the poles. Radiance is interpolated
//! bilinearly between them.

use std::f32::consts::{FRAC_1_PI, TAU};
use std::f64::consts::PI;

use glam::{Vec2, Vec3A};

use crate::math::{Rgb, luminance};
use crate::sampling::{Cell, Distribution2D};

/// Minimum weight of a patch from which any light comes, relative to the mean of its row. Without it
/// the probability of faint patches in the row of a sun could be rounded to 0, and their light be lost.
const MIN_RELATIVE_WEIGHT: f64 = 1e-3;

/// An image that surrounds the scene.
///
/// Directions are sampled by patches between four pixels. The density per steradian is constant over a
/// patch and proportional to the mean of the four, so that it is positive wherever the radiance is.
#[derive(Debug)]
pub struct EnvironmentMap {
    width: usize,
    pixels: Vec<[f32; 3]>,
    /// Probabilities of the patches; directions are uniform in phi and cos theta within each.
    patches: Distribution2D,
    /// Cosines of the polar angles of the rows of pixels.
    cosines: Vec<f64>,
    integral: Rgb,
}

/// A position between four pixels.
struct Patch {
    column: usize,
    row: usize,
    /// Offsets, from 0 to 1, toward the next column and row.
    right: f32,
    down: f32,
}

impl EnvironmentMap {
    /// The map of `pixels`, in rows of `width`; `None` unless they form at least 2 rows of at least 2
    /// pixels.
    pub fn new(width: usize, pixels: Vec<[f32; 3]>) -> Option<Self> {
        if width < 2 || !pixels.len().is_multiple_of(width) || pixels.len() < 2 * width {
            return None;
        }
        let rows = pixels.len() / width - 1;
        let cosines: Vec<f64> = (0..=rows)
            .map(|row| (PI * row as f64 / rows as f64).cos())
            .collect();
        let mut weights = Vec::with_capacity(rows * width);
        let mut integral = Rgb::ZERO;
        for row in 0..rows {
            let solid_angle = (cosines[row] - cosines[row + 1]) * 2.0 * PI / width as f64;
            let first = weights.len();
            for column in 0..width {
                let mean = corners(&pixels, width, column, row)
                    .into_iter()
                    .sum::<Rgb>()
                    / 4.0;
                integral += mean * solid_angle as f32;
                weights.push(f64::from(luminance(mean)) * solid_angle);
            }
            raise_to_minimum(&mut weights[first..]);
        }
        let patches = Distribution2D::new(&weights, width)
            .or_else(|| Distribution2D::new(&vec![1.0; weights.len()], width))?;
        Some(Self {
            width,
            pixels,
            patches,
            cosines,
            integral,
        })
    }

    /// Integral of radiance over all directions.
    pub fn integral(&self) -> Rgb {
        self.integral
    }

    fn rows(&self) -> usize {
        self.pixels.len() / self.width - 1
    }

    /// Radiance from a unit direction and the density per steradian with which it is sampled.
    #[inline]
    pub fn evaluate(&self, direction: Vec3A) -> (Rgb, f32) {
        let patch = self.patch(direction);
        let [a, b, c, d] = corners(&self.pixels, self.width, patch.column, patch.row);
        let radiance = a
            .lerp(b, patch.right)
            .lerp(c.lerp(d, patch.right), patch.down);
        (radiance, self.density(patch.column, patch.row))
    }

    /// Samples a unit direction from which light arrives, with the density that [`Self::evaluate`] returns.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3A {
        let Cell {
            column,
            row,
            within: [x, y],
        } = self.patches.sample(u.to_array());
        let (top, bottom) = (self.cosines[row], self.cosines[row + 1]);
        let cos = top + (bottom - top) * f64::from(y);
        // In f64, since near the poles a cosine rounded to f32 does not resolve the angle.
        let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt() as f32;
        let (sin_phi, cos_phi) = (TAU * ((column as f32 + x + 0.5) / self.width as f32)).sin_cos();
        Vec3A::new(sin_phi * sin, cos as f32, -cos_phi * sin)
    }

    /// Density per steradian of directions in a patch.
    #[inline]
    fn density(&self, column: usize, row: usize) -> f32 {
        let height = self.cosines[row] - self.cosines[row + 1];
        let solid_angle = height * 2.0 * PI / self.width as f64;
        (f64::from(self.patches.probability(column, row)) / solid_angle) as f32
    }

    #[inline]
    fn patch(&self, d: Vec3A) -> Patch {
        let u = d.x.atan2(-d.z) / TAU - 0.5 / self.width as f32;
        let x = (u - u.floor()) * self.width as f32;
        let column = (x as usize).min(self.width - 1);
        let theta = d.x.hypot(d.z).atan2(d.y);
        let y = theta * FRAC_1_PI * self.rows() as f32;
        let row = (y as usize).min(self.rows() - 1);
        Patch {
            column,
            row,
            right: x - column as f32,
            down: y - row as f32,
        }
    }
}

/// The four pixels around a patch: two of the upper row, then two of the lower row.
#[inline]
fn corners(pixels: &[[f32; 3]], width: usize, column: usize, row: usize) -> [Rgb; 4] {
    let next = if column + 1 == width { 0 } else { column + 1 };
    let pixel = |column: usize, row: usize| Rgb::from_array(pixels[row * width + column]);
    [
        pixel(column, row),
        pixel(next, row),
        pixel(column, row + 1),
        pixel(next, row + 1),
    ]
}

/// Raises positive weights to [`MIN_RELATIVE_WEIGHT`] of their mean.
fn raise_to_minimum(weights: &mut [f64]) {
    let min = MIN_RELATIVE_WEIGHT * weights.iter().sum::<f64>() / weights.len() as f64;
    for weight in weights.iter_mut().filter(|weight| **weight > 0.0) {
        *weight = weight.max(min);
    }
}
