//! A closed room with a block in it, as rectangles, and its light transport operator on patches.

use glam::DVec3;
use rayon::prelude::*;

use super::form_factors::{Receiver, Rectangle, form_factor};

/// Red, green, blue.
pub type Color = DVec3;

/// A rectangle of one colour.
pub struct Surface {
    pub rectangle: Rectangle,
    pub albedo: Color,
    pub emission: Color,
}

/// Corners of the block on the floor and of the lamp in the ceiling, in eighths of the room's width.
const BLOCK: [[f64; 3]; 2] = [[3.0, 0.0, 2.0], [5.0, 4.0, 4.0]];
const LAMP: [[f64; 2]; 2] = [[4.0, 4.0], [6.0, 6.0]];

const FLOOR: Color = DVec3::new(0.7, 0.7, 0.7);
const CEILING: Color = DVec3::new(0.8, 0.8, 0.75);
const LEFT: Color = DVec3::new(0.63, 0.1, 0.08);
const RIGHT: Color = DVec3::new(0.15, 0.5, 0.1);
const BACK: Color = DVec3::new(0.6, 0.6, 0.7);
const FRONT: Color = DVec3::new(0.4, 0.4, 0.5);
const STONE: Color = DVec3::new(0.5, 0.6, 0.7);
const SHADE: Color = DVec3::new(0.3, 0.3, 0.3);
const LIGHT: Color = DVec3::new(10.0, 8.0, 5.0);

fn eighths(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z) / 8.0
}

/// Walls face inward, the block outward; floor and ceiling have holes for block and lamp.
pub fn surfaces() -> Vec<Surface> {
    let mut all = Vec::new();
    let mut add = |albedo: Color, emission: Color, corner: DVec3, a: DVec3, b: DVec3| {
        let rectangle = Rectangle { corner, a, b };
        all.push(Surface {
            rectangle,
            albedo,
            emission,
        });
    };
    let dark = DVec3::ZERO;
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    add(LEFT, dark, DVec3::ZERO, y, z);
    add(RIGHT, dark, x, z, y);
    add(BACK, dark, DVec3::ZERO, x, y);
    add(FRONT, dark, z, y, x);
    let [low, high] = BLOCK;
    for [x0, z0, x1, z1] in around([low[0], low[2]], [high[0], high[2]]) {
        add(
            FLOOR,
            dark,
            eighths(x0, 0.0, z0),
            z * (z1 - z0) / 8.0,
            x * (x1 - x0) / 8.0,
        );
    }
    for [x0, z0, x1, z1] in around(LAMP[0], LAMP[1]) {
        add(
            CEILING,
            dark,
            eighths(x0, 8.0, z0),
            x * (x1 - x0) / 8.0,
            z * (z1 - z0) / 8.0,
        );
    }
    let lamp = [LAMP[1][0] - LAMP[0][0], LAMP[1][1] - LAMP[0][1]];
    add(
        SHADE,
        LIGHT,
        eighths(LAMP[0][0], 8.0, LAMP[0][1]),
        x * lamp[0] / 8.0,
        z * lamp[1] / 8.0,
    );
    for face in block() {
        add(STONE, dark, face.corner, face.a, face.b);
    }
    all
}

/// The floor plan of the room minus a rectangle, as rectangles x0, z0, x1, z1.
fn around(low: [f64; 2], high: [f64; 2]) -> [[f64; 4]; 4] {
    [
        [0.0, 0.0, 8.0, low[1]],
        [0.0, high[1], 8.0, 8.0],
        [0.0, low[1], low[0], high[1]],
        [high[0], low[1], 8.0, high[1]],
    ]
}

/// The visible faces of the block.
pub fn block() -> Vec<Rectangle> {
    let low = DVec3::from(BLOCK[0]) / 8.0;
    let high = DVec3::from(BLOCK[1]) / 8.0;
    let size = high - low;
    let (x, y, z) = (DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z);
    let face = |corner, a, b| Rectangle { corner, a, b };
    vec![
        face(low, z, y),
        face(high, DVec3::ZERO - y, DVec3::ZERO - z),
        face(low, y, x),
        face(high, DVec3::ZERO - x, DVec3::ZERO - y),
        face(high, DVec3::ZERO - z, DVec3::ZERO - x),
    ]
}

/// Reflected radiance on patches, T Le + T^2 Le + ..., by collocation at the centres of the patches.
pub struct Solution {
    patches: Vec<Rectangle>,
    /// After 0, 1, ... terms: the radiance reflected by every patch from paths of at most that many edges
    /// plus one.
    partial_sums: Vec<Vec<Color>>,
    block: Vec<Rectangle>,
}

/// Number of terms after which the rest is below rounding: no albedo exceeds 0.8, and most walls are
/// darker.
const ALL_TERMS: usize = 60;

impl Solution {
    /// With `n` patches along the width of the room.
    pub fn new(n: usize) -> Self {
        let surfaces = surfaces();
        let block = block();
        let mut patches = Vec::new();
        let mut owners = Vec::new();
        for surface in &surfaces {
            for patch in divide(&surface.rectangle, n) {
                patches.push(patch);
                owners.push(surface);
            }
        }
        let rows: Vec<Vec<f64>> = patches
            .par_iter()
            .map(|patch| {
                let to = Receiver {
                    position: patch.at(0.5, 0.5),
                    normal: patch.normal(),
                };
                factors(to, &patches, &block)
            })
            .collect();
        let mut partial_sums = vec![vec![DVec3::ZERO; patches.len()]];
        for _ in 0..ALL_TERMS {
            let last = &partial_sums[partial_sums.len() - 1];
            let radiance: Vec<Color> = last
                .iter()
                .zip(&owners)
                .map(|(l, surface)| surface.emission + *l)
                .collect();
            let next = rows
                .par_iter()
                .zip(&owners)
                .map(|(row, surface)| surface.albedo * gather(row, &radiance))
                .collect();
            partial_sums.push(next);
        }
        Self {
            patches,
            partial_sums,
            block,
        }
    }

    /// Radiance at a point of `surface` reflected at least twice, for each of `depths` (edges; `None` for
    /// all), by a final gather from the patches.
    pub fn indirect(
        &self,
        surface: &Surface,
        position: DVec3,
        depths: &[Option<u32>],
    ) -> Vec<Color> {
        let normal = surface.rectangle.normal();
        let row = factors(Receiver { position, normal }, &self.patches, &self.block);
        depths
            .iter()
            .map(|depth| {
                let terms = depth.map_or(ALL_TERMS, |depth| depth.saturating_sub(2) as usize);
                surface.albedo * gather(&row, &self.partial_sums[terms])
            })
            .collect()
    }

    /// The largest deviation from 1 of the sum of form factors from the centre of a patch.
    pub fn closure_error(&self) -> f64 {
        self.patches
            .par_iter()
            .map(|patch| {
                let to = Receiver {
                    position: patch.at(0.5, 0.5),
                    normal: patch.normal(),
                };
                (factors(to, &self.patches, &self.block).iter().sum::<f64>() - 1.0).abs()
            })
            .reduce(|| 0.0, f64::max)
    }
}

/// Radiance of the lamp reflected at a point of `surface`, exact.
pub fn direct(
    surfaces: &[Surface],
    block: &[Rectangle],
    surface: &Surface,
    position: DVec3,
) -> Color {
    let normal = surface.rectangle.normal();
    let to = Receiver { position, normal };
    let emitting = surfaces
        .iter()
        .filter(|other| other.emission != DVec3::ZERO);
    let light: Color = emitting
        .map(|lamp| form_factor(to, &lamp.rectangle, block) * lamp.emission)
        .sum();
    surface.albedo * light
}

fn factors(to: Receiver, patches: &[Rectangle], block: &[Rectangle]) -> Vec<f64> {
    patches
        .iter()
        .map(|patch| form_factor(to, patch, block))
        .collect()
}

fn gather(row: &[f64], radiance: &[Color]) -> Color {
    row.iter()
        .zip(radiance)
        .map(|(factor, l)| *factor * *l)
        .sum()
}

/// Squares of side 1/n.
fn divide(rectangle: &Rectangle, n: usize) -> Vec<Rectangle> {
    let cells = |side: DVec3| (side.length() * n as f64).round();
    let (along_a, along_b) = (cells(rectangle.a), cells(rectangle.b));
    let mut patches = Vec::new();
    for i in 0..along_a as usize {
        for j in 0..along_b as usize {
            patches.push(Rectangle {
                corner: rectangle.at(i as f64 / along_a, j as f64 / along_b),
                a: rectangle.a / along_a,
                b: rectangle.b / along_b,
            });
        }
    }
    patches
}
