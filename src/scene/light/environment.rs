//! Radiance by direction from a latitude-longitude image.
//!
//! Mitsuba 3's map: theta = pi v from +y, phi = 2 pi u, direction
//! (sin phi sin theta, cos theta, -cos phi sin theta). Columns are centred at u = (i + 1/2)/width and
//! repeat; rows lie at v = j/(rows - 1), the first and last at the poles. Radiance is interpolated
//! bilinearly between them.

use std::f32::consts::{FRAC_1_PI, TAU};
use std::f64::consts::PI;

use glam::{Vec2, Vec3A};

use crate::math::{Rgb, luminance};
use crate::sampling::{Cell, Distribution2D};

/// Share of the mean of a row that each patch of it gets at least, if any light comes from there: a
/// density of 0 or nearly 0 under rounding would lose the light of faint patches beside a sun.
const FLOOR: f64 = 1e-3;

/// An image seen from inside the sphere that it is wrapped around.
///
/// Directions are sampled by patches between four pixels, with one density per steradian for each:
/// proportional to the mean of its pixels, so that it is positive wherever the interpolation is.
#[derive(Debug)]
pub struct EnvironmentMap {
    width: usize,
    pixels: Vec<[f32; 3]>,
    /// Over patches, uniform in phi and cos theta within each.
    patches: Distribution2D,
    /// Cosines of the polar angles of the rows of pixels.
    cosines: Vec<f64>,
    integral: Rgb,
}

/// A place between four pixels.
struct Patch {
    column: usize,
    row: usize,
    /// Fractions of the way to the next column and row.
    right: f32,
    down: f32,
}

impl EnvironmentMap {
    /// The map of `pixels`, in rows of `width`; `None` if they are not rows of at least 2 pixels, at
    /// least 2 of them.
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
            raise_to_floor(&mut weights[first..]);
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

    /// A unit direction from which light arrives, with the density that [`Self::evaluate`] tells.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3A {
        let Cell {
            column,
            row,
            within: [x, y],
        } = self.patches.sample(u.to_array());
        let (top, bottom) = (self.cosines[row], self.cosines[row + 1]);
        let cos = top + (bottom - top) * f64::from(y);
        // Not from the rounded cosine, which near the poles knows little of the angle.
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

/// The four pixels around a patch: both of its upper row, then both of its lower.
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

/// Raises positive weights to [`FLOOR`] of their mean.
fn raise_to_floor(weights: &mut [f64]) {
    let floor = FLOOR * weights.iter().sum::<f64>() / weights.len() as f64;
    for weight in weights.iter_mut().filter(|weight| **weight > 0.0) {
        *weight = weight.max(floor);
    }
}
