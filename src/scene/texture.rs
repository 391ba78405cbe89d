//! Textures: colours that may vary over a surface.

use glam::{Affine2, IVec2, Vec2, Vec3A};

use crate::math::{Rgb, luminance};

/// A colour as a function of texture coordinates.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb),
    /// An image.
    Bitmap(Bitmap),
    /// Two by two squares on every unit square, as Mitsuba 3's `checkerboard`.
    Checkerboard {
        /// Where both coordinates are in the same half of their unit interval.
        color0: Rgb,
        /// Elsewhere.
        color1: Rgb,
        /// Transform of the texture coordinates.
        to_uv: Affine2,
    },
}

/// A texture at texture coordinates, evaluated on demand.
#[derive(Clone, Copy)]
pub(super) struct TextureAt<'a> {
    pub texture: &'a Texture,
    pub uv: Vec2,
}

impl TextureAt<'_> {
    /// The value.
    #[inline]
    pub fn color(&self) -> Rgb {
        self.texture.evaluate(self.uv)
    }

    /// The luminance of the value: that of textures which stand for a number.
    #[inline]
    pub fn luminance(&self) -> f32 {
        scalar(self.color())
    }

    /// Derivative of the luminance with respect to the texture coordinates.
    pub fn gradient(&self) -> Vec2 {
        match self.texture {
            Texture::Constant(_) | Texture::Checkerboard { .. } => Vec2::ZERO,
            Texture::Bitmap(bitmap) => bitmap.gradient(self.uv),
        }
    }
}

/// The luminance of a colour, exactly its value if it is grey.
#[inline]
fn scalar(color: Rgb) -> f32 {
    if color.x == color.y && color.y == color.z {
        color.x
    } else {
        luminance(color)
    }
}

/// Interpolation between the centres of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The pixel that contains the point.
    Nearest,
    /// Bilinear between the centres of the four pixels around the point.
    Bilinear,
}

/// Extension of an image beyond the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The image is repeated.
    Repeat,
    /// The image is repeated and mirrored at each edge.
    Mirror,
    /// The nearest pixel of the border.
    Clamp,
}

/// An image over the unit square: row 0 starts at v = 0 and pixel 0 of a row at u = 0, as in Mitsuba 3.
#[derive(Clone, Debug)]
pub struct Bitmap {
    size: IVec2,
    /// Rows of `size.x` pixels.
    pixels: Vec<Rgb>,
    interpolation: Interpolation,
    wrap: Wrap,
    to_uv: Affine2,
    mean: Rgb,
}

impl Texture {
    /// Size in memory, in bytes.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Texture::Bitmap(bitmap) => size_of_val(&*bitmap.pixels),
            Texture::Constant(_) | Texture::Checkerboard { .. } => 0,
        }
    }

    /// Value at `uv`.
    #[inline]
    pub fn evaluate(&self, uv: Vec2) -> Rgb {
        match self {
            Texture::Constant(color) => *color,
            Texture::Bitmap(bitmap) => bitmap.evaluate(uv),
            Texture::Checkerboard {
                color0,
                color1,
                to_uv,
            } => {
                let p = to_uv.transform_point2(uv);
                let second_half = (p - p.floor()).cmpgt(Vec2::splat(0.5));
                if second_half.x == second_half.y {
                    *color0
                } else {
                    *color1
                }
            }
        }
    }

    /// Maximum of each channel over all texture coordinates.
    pub fn max(&self) -> Rgb {
        match self {
            Texture::Constant(color) => *color,
            Texture::Bitmap(bitmap) => bitmap
                .pixels
                .iter()
                .fold(Rgb::NEG_INFINITY, |max, pixel| max.max(*pixel)),
            Texture::Checkerboard { color0, color1, .. } => color0.max(*color1),
        }
    }

    /// Mean over the unit square of texture coordinates; used to choose between lobes.
    pub fn mean(&self) -> Rgb {
        match self {
            Texture::Constant(color) => *color,
            Texture::Bitmap(bitmap) => bitmap.mean,
            Texture::Checkerboard { color0, color1, .. } => 0.5 * (*color0 + *color1),
        }
    }
}

impl Bitmap {
    /// An image of linear `pixels`, in rows from top to bottom; `to_uv` transforms texture coordinates.
    /// `None` unless there are `width` x `height` pixels, at least one, and each side is below 2^31.
    pub fn new(
        width: usize,
        height: usize,
        pixels: Vec<[f32; 3]>,
        interpolation: Interpolation,
        wrap: Wrap,
        to_uv: Affine2,
    ) -> Option<Self> {
        if pixels.is_empty() || width.checked_mul(height) != Some(pixels.len()) {
            return None;
        }
        let size = IVec2::new(width.try_into().ok()?, height.try_into().ok()?);
        let mut sum = [0.0; 3];
        for pixel in &pixels {
            for (s, &p) in sum.iter_mut().zip(pixel) {
                *s += f64::from(p);
            }
        }
        let mean = sum.map(|s| (s / pixels.len() as f64) as f32);
        Some(Self {
            size,
            pixels: pixels.into_iter().map(Vec3A::from).collect(),
            interpolation,
            wrap,
            to_uv,
            mean: Vec3A::from(mean),
        })
    }

    #[inline]
    fn evaluate(&self, uv: Vec2) -> Rgb {
        let p = self.to_uv.transform_point2(uv) * self.size.as_vec2();
        match self.interpolation {
            Interpolation::Nearest => self.pixel(p.floor().as_ivec2()),
            Interpolation::Bilinear => {
                let p = p - Vec2::splat(0.5);
                let corner = p.floor();
                let w = p - corner;
                let i = corner.as_ivec2();
                let row = |dy: i32| {
                    let left = self.pixel(i.saturating_add(IVec2::new(0, dy)));
                    left.lerp(self.pixel(i.saturating_add(IVec2::new(1, dy))), w.x)
                };
                row(0).lerp(row(1), w.y)
            }
        }
    }

    /// Derivative of the luminance with respect to the texture coordinates; zero without interpolation.
    fn gradient(&self, uv: Vec2) -> Vec2 {
        if self.interpolation == Interpolation::Nearest {
            return Vec2::ZERO;
        }
        let size = self.size.as_vec2();
        let p = self.to_uv.transform_point2(uv) * size - Vec2::splat(0.5);
        let corner = p.floor();
        let w = p - corner;
        let i = corner.as_ivec2();
        let at = |dx, dy| scalar(self.pixel(i.saturating_add(IVec2::new(dx, dy))));
        let [[a, b], [c, d]] = [[at(0, 0), at(1, 0)], [at(0, 1), at(1, 1)]];
        let per_pixel = Vec2::new(
            (b - a) * (1.0 - w.y) + (d - c) * w.y,
            (c - a) * (1.0 - w.x) + (d - b) * w.x,
        );
        self.to_uv.matrix2.transpose() * (size * per_pixel)
    }

    #[inline]
    fn pixel(&self, at: IVec2) -> Rgb {
        let x = self.wrap.apply(at.x, self.size.x);
        let y = self.wrap.apply(at.y, self.size.y);
        self.pixels[y * self.size.x as usize + x]
    }
}

impl Wrap {
    /// The pixel in `0..size` to which pixel `i` is mapped.
    #[inline]
    fn apply(self, i: i32, size: i32) -> usize {
        let wrapped = match self {
            Wrap::Repeat => i.rem_euclid(size),
            Wrap::Mirror => {
                let period = i.rem_euclid(size.saturating_mul(2));
                period.min(size.saturating_mul(2) - 1 - period)
            }
            Wrap::Clamp => i.clamp(0, size - 1),
        };
        wrapped as usize
    }
}

#[cfg(test)]
mod tests {
    //! Compared with Mitsuba 3.9.1, whose texture coordinates start at the first row of an image: a
    //! `rectangle` has v = 0 at y = -1 and so shows images upside down; `obj` flips v when it is loaded.
    //!
    //! ```python
    //! pixels = [[[i / 10, j / 10, (i + 2 * j) / 20] for i in range(3)] for j in range(4)]
    //! texture = mi.load_dict({"type": "bitmap", "bitmap": mi.Bitmap(np.float32(pixels)), "raw": True,
    //!                         "filter_type": ..., "wrap_mode": ...})
    //! si = mi.SurfaceInteraction3f(); si.uv = uv; print(texture.eval(si))
    //! ```

    use super::Interpolation::{Bilinear, Nearest};
    use super::Wrap::{Clamp, Mirror, Repeat};
    use super::*;

    const UVS: [Vec2; 5] = [
        Vec2::new(0.1, 0.2),
        Vec2::new(0.9, 0.95),
        Vec2::new(-0.3, 1.7),
        Vec2::new(2.45, -3.6),
        Vec2::new(0.02, 0.99),
    ];

    fn bitmap(interpolation: Interpolation, wrap: Wrap, to_uv: Affine2) -> Texture {
        let pixels = (0..12)
            .map(|n| ((n % 3) as f32, (n / 3) as f32))
            .map(|(i, j)| [i / 10.0, j / 10.0, (i + 2.0 * j) / 20.0])
            .collect();
        let bitmap = Bitmap::new(3, 4, pixels, interpolation, wrap, to_uv);
        Texture::Bitmap(bitmap.expect("width times height pixels"))
    }

    /// [[2, 0.5, 0.1], [-0.25, 1.5, 0.3], [0, 0, 1]] in rows, as `mi.ScalarTransform3f` takes it.
    fn to_uv() -> Affine2 {
        Affine2::from_cols(
            Vec2::new(2.0, -0.25),
            Vec2::new(0.5, 1.5),
            Vec2::new(0.1, 0.3),
        )
    }

    fn assert_close(texture: &Texture, uv: Vec2, expected: [f32; 3]) {
        let error = texture.evaluate(uv) - Vec3A::from(expected);
        assert!(
            error.abs().max_element() < 2e-6,
            "{texture:?} {uv}: {error}"
        );
    }

    #[test]
    fn bitmaps_agree_with_mitsuba() {
        let cases = [
            (
                Nearest,
                Repeat,
                [[0.0, 0.0], [0.2, 0.3], [0.2, 0.2], [0.1, 0.1], [0.0, 0.3]],
            ),
            (
                Nearest,
                Mirror,
                [[0.0, 0.0], [0.2, 0.3], [0.0, 0.1], [0.1, 0.1], [0.0, 0.3]],
            ),
            (
                Nearest,
                Clamp,
                [[0.0, 0.0], [0.2, 0.3], [0.0, 0.3], [0.2, 0.0], [0.0, 0.3]],
            ),
            (
                Bilinear,
                Repeat,
                [
                    [0.04, 0.03],
                    [0.16, 0.21],
                    [0.16, 0.23],
                    [0.085, 0.11],
                    [0.088, 0.162],
                ],
            ),
            (
                Bilinear,
                Mirror,
                [
                    [0.0, 0.03],
                    [0.2, 0.3],
                    [0.04, 0.07],
                    [0.085, 0.11],
                    [0.0, 0.3],
                ],
            ),
            (
                Bilinear,
                Clamp,
                [[0.0, 0.03], [0.2, 0.3], [0.0, 0.3], [0.2, 0.0], [0.0, 0.3]],
            ),
        ];
        for (interpolation, wrap, values) in cases {
            let texture = bitmap(interpolation, wrap, Affine2::IDENTITY);
            for (uv, [r, g]) in UVS.into_iter().zip(values) {
                // Blue is r / 2 + g in every pixel, and therefore between pixels too.
                assert_close(&texture, uv, [r, g, 0.5 * r + g]);
            }
        }
    }

    #[test]
    fn transformed_coordinates_agree_with_mitsuba() {
        let texture = bitmap(Bilinear, Repeat, to_uv());
        let values = [
            [0.07, 0.18, 0.215],
            [0.0625, 0.15, 0.18125],
            [0.055, 0.24, 0.2675],
            [0.01, 0.065, 0.07],
            [0.1405, 0.262, 0.33225],
        ];
        for (uv, value) in UVS.into_iter().zip(values) {
            assert_close(&texture, uv, value);
        }
    }

    #[test]
    fn checkerboards_agree_with_mitsuba() {
        let (plain, transformed) = ([0.8, 0.8, 0.8, 0.8, 0.1], [0.1, 0.8, 0.1, 0.8, 0.8]);
        for (to_uv, values) in [(Affine2::IDENTITY, plain), (to_uv(), transformed)] {
            let texture = Texture::Checkerboard {
                color0: Rgb::splat(0.8),
                color1: Rgb::splat(0.1),
                to_uv,
            };
            for (uv, value) in UVS.into_iter().zip(values) {
                assert_close(&texture, uv, [value; 3]);
            }
            assert!((texture.mean().x - 0.45).abs() < 1e-6);
        }
    }

    /// Central differences over a distance at which no pixel centre is crossed.
    #[test]
    fn gradients_are_derivatives() {
        const STEP: f32 = 1e-3;
        for wrap in [Repeat, Mirror, Clamp] {
            for to_uv in [Affine2::IDENTITY, to_uv()] {
                let texture = bitmap(Bilinear, wrap, to_uv);
                for uv in UVS {
                    let at = |uv| TextureAt {
                        texture: &texture,
                        uv,
                    };
                    let difference = |axis: Vec2| {
                        let [a, b] = [-STEP, STEP].map(|h| at(uv + h * axis).luminance());
                        (b - a) / (2.0 * STEP)
                    };
                    let expected = Vec2::new(difference(Vec2::X), difference(Vec2::Y));
                    let error = (at(uv).gradient() - expected).abs().max_element();
                    assert!(error < 2e-3, "{wrap:?} {uv}: {error}");
                }
            }
        }
        let nearest = bitmap(Nearest, Repeat, Affine2::IDENTITY);
        let uv = Vec2::splat(0.4);
        let at = TextureAt {
            texture: &nearest,
            uv,
        };
        assert_eq!(at.gradient(), Vec2::ZERO);
    }

    #[test]
    fn means_are_over_all_pixels() {
        let mean = bitmap(Nearest, Clamp, to_uv()).mean();
        let error = mean - Rgb::new(0.1, 0.15, 0.2);
        assert!(error.abs().max_element() < 1e-6, "{mean}");
    }

    #[test]
    fn bad_sizes_are_rejected_and_large_coordinates_accepted() {
        let make = |width, height, count| {
            let pixels = vec![[0.5; 3]; count];
            Bitmap::new(width, height, pixels, Bilinear, Repeat, Affine2::IDENTITY)
        };
        assert!(make(0, 0, 0).is_none() && make(2, 2, 3).is_none());
        assert!(make(usize::MAX, 2, 2).is_none());
        let pixel = Texture::Bitmap(make(1, 1, 1).expect("one pixel"));
        for uv in [Vec2::splat(1e30), Vec2::splat(-1e30), Vec2::splat(0.3)] {
            assert_eq!(pixel.evaluate(uv), Rgb::splat(0.5));
        }
        for wrap in [Repeat, Mirror, Clamp] {
            let i = wrap.apply(i32::MAX, 3).max(wrap.apply(i32::MIN, 3));
            assert!(i < 3, "{wrap:?}");
        }
    }
}
