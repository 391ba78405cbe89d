//! Cameras perpendicular to a wall. A pinhole sees the parts of a plane perpendicular to its axis in
//! proportion to their areas, so a pixel with a box filter is the mean radiance of one rectangle of
//! the wall.

use glam::DVec3;
use metrolight::math::Rgb;
use metrolight::scene::{Material, Radiance, Scene, ShapeDescription, Texture};
use rayon::prelude::*;

use super::room::{Color, Solution, Surface, block, direct, surfaces};
use crate::common::scenes::{SceneBuilder, look_at, parallelogram};

/// A rectangle on a wall and its division into pixels.
pub struct View {
    pub name: &'static str,
    center: DVec3,
    /// Unit, from the wall into the room.
    normal: DVec3,
    /// Unit, along the columns.
    up: DVec3,
    /// Width and height of the rectangle, in the room's widths.
    size: [f64; 2],
    /// From the wall to the camera.
    distance: f64,
    /// Columns and rows; pixels are square.
    pub tiles: [u32; 2],
}

/// Nothing occludes these rectangles from their cameras.
pub fn views() -> [View; 3] {
    [
        View {
            name: "floor beside the block",
            center: DVec3::new(0.1875, 0.0, 0.5),
            normal: DVec3::Y,
            up: DVec3::NEG_X,
            size: [1.0, 0.375],
            distance: 0.4,
            tiles: [8, 3],
        },
        View {
            name: "wall behind the block",
            center: DVec3::new(0.0, 0.5, 0.5),
            normal: DVec3::X,
            up: DVec3::Y,
            size: [1.0, 1.0],
            distance: 0.37,
            tiles: [4, 4],
        },
        View {
            name: "ceiling around the lamp",
            center: DVec3::new(0.5, 1.0, 0.5),
            normal: DVec3::NEG_Y,
            up: DVec3::Z,
            size: [1.0, 1.0],
            distance: 0.45,
            tiles: [4, 4],
        },
    ]
}

impl View {
    /// The room from this view. The reference and the renderer share only its surfaces.
    pub fn scene(&self, depth: Option<u32>) -> Scene {
        let mut builder = SceneBuilder {
            depth,
            fov_x: 2.0 * (0.5 * self.size[0] / self.distance).atan().to_degrees(),
            camera: look_at(
                self.center + self.normal * self.distance,
                self.center,
                self.up,
            ),
            film: self.tiles,
            ..SceneBuilder::default()
        };
        for (i, surface) in (0..).zip(&surfaces()) {
            let rectangle = &surface.rectangle;
            builder
                .textures
                .push(Texture::Constant(rgb(surface.albedo)));
            builder.materials.push(Material::Diffuse { reflectance: i });
            builder.shapes.push(ShapeDescription {
                material: i,
                emission: (surface.emission != DVec3::ZERO)
                    .then(|| Radiance::Constant(rgb(surface.emission))),
                ..parallelogram(rectangle.corner, rectangle.a, rectangle.b)
            });
        }
        builder.build()
    }

    /// Mean radiance of every pixel, in rows from the top left, for each of `depths`, by the midpoint rule
    /// with `points` x `points` per pixel, and more for direct light, which has shadows.
    pub fn tile_means(
        &self,
        solution: &Solution,
        depths: &[Option<u32>],
        points: u32,
    ) -> Vec<Vec<Color>> {
        const SHARP: u32 = 16;
        let (surfaces, block) = (surfaces(), block());
        let [columns, rows] = self.tiles;
        (0..columns * rows)
            .into_par_iter()
            .map(|tile| {
                let mut means = vec![DVec3::ZERO; depths.len()];
                self.over_tile(tile, points, |point, share| {
                    let surface = surface_at(&surfaces, point, self.normal);
                    let radiance = solution.indirect(surface, point, depths);
                    for (mean, value) in means.iter_mut().zip(radiance) {
                        *mean += share * value;
                    }
                });
                self.over_tile(tile, SHARP * points, |point, share| {
                    let surface = surface_at(&surfaces, point, self.normal);
                    let direct = direct(&surfaces, &block, surface, point);
                    for (mean, depth) in means.iter_mut().zip(depths) {
                        let reflected = if *depth == Some(1) {
                            DVec3::ZERO
                        } else {
                            direct
                        };
                        *mean += share * (surface.emission + reflected);
                    }
                });
                means
            })
            .collect()
    }

    /// Calls `visit` with n x n points of a tile and the fraction of its area that each represents.
    fn over_tile(&self, tile: u32, n: u32, mut visit: impl FnMut(DVec3, f64)) {
        let [columns, rows] = self.tiles;
        let within = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        for i in 0..n * n {
            let x = f64::from(tile % columns) + within(i % n);
            let y = f64::from(tile / columns) + within(i / n);
            let point = self.point(x / f64::from(columns), y / f64::from(rows));
            visit(point, 1.0 / f64::from(n * n));
        }
    }

    /// The point of the wall at (x, y) of the film as a unit square, y down.
    fn point(&self, x: f64, y: f64) -> DVec3 {
        let right = self.up.cross(self.normal);
        self.center + right * ((x - 0.5) * self.size[0]) + self.up * ((0.5 - y) * self.size[1])
    }
}

fn rgb(color: Color) -> Rgb {
    color.as_vec3().into()
}

/// The surface of the given normal that holds `point`.
fn surface_at(surfaces: &[Surface], point: DVec3, normal: DVec3) -> &Surface {
    surfaces
        .iter()
        .find(|surface| {
            let rectangle = &surface.rectangle;
            let offset = point - rectangle.corner;
            let along = |side: DVec3| offset.dot(side) / side.length_squared();
            rectangle.normal().dot(normal) > 0.99
                && offset.dot(normal).abs() < 1e-9
                && (0.0..=1.0).contains(&along(rectangle.a))
                && (0.0..=1.0).contains(&along(rectangle.b))
        })
        .expect("a rectangle on surfaces")
}
