//! The observed quantities of the paths of a scene.

use super::observation::{COORDINATES, Features, Observation, TECHNIQUES, TILES, tile_at};
use crate::film::Splat;
use crate::math::luminance;
use crate::path::dimensions;
use crate::sampling::{Dimension, Sampler, Stream};
use crate::scene::Scene;
use crate::technique::Technique;

/// Pixels in a row and in a column of a diagnosed image, a multiple of [`TILES`].
pub(super) const PIXELS: u32 = 64;

/// Observed dimensions: film position, a direction at the first surface, and a position on a light.
const OBSERVED: [Dimension; COORDINATES] = [
    dimensions::FILM,
    Dimension::new(Stream::Camera, dimensions::FILM.index + 1),
    Dimension::new(Stream::Camera, dimensions::camera_vertex(1).index + 1),
    Dimension::new(Stream::Light, dimensions::EMISSION.index + 2),
];

/// Names of the observed dimensions.
pub const COORDINATE_NAMES: [&str; COORDINATES] = [
    "film x",
    "film y",
    "direction at the first surface",
    "position on the light",
];

/// Gives `scene` the film of a diagnosed image. A box filter makes the mean of all pixels the integral of
/// the light over the film. Chains do not depend on either: their film is continuous.
pub(super) fn set_film(scene: &mut Scene) {
    scene.film.filter = crate::film::Filter::Box;
    [scene.film.width, scene.film.height] = [PIXELS; 2];
}

/// The tile of the pixel in which a splat lands.
pub(super) fn tile(position: [f32; 2]) -> usize {
    let size = f64::from(PIXELS);
    let centre = position.map(|x| (f64::from(x) * size).floor() + 0.5);
    tile_at(centre, [size; 2])
}

/// Records the values of the observed dimensions that are read.
pub(super) struct ObservedSampler<'a, S> {
    sampler: &'a mut S,
    seen: [f64; COORDINATES],
}

impl<'a, S> ObservedSampler<'a, S> {
    pub fn new(sampler: &'a mut S) -> Self {
        Self {
            sampler,
            seen: [f64::NAN; COORDINATES],
        }
    }
}

impl<S: Sampler> Sampler for ObservedSampler<'_, S> {
    fn get<const N: usize>(&mut self, first: Dimension) -> [f32; N] {
        let values = self.sampler.get::<N>(first);
        for (seen, observed) in self.seen.iter_mut().zip(OBSERVED) {
            let read = first.index..first.index + N;
            if first.stream == observed.stream && read.contains(&observed.index) {
                *seen = f64::from(values[observed.index - first.index]);
            }
        }
        values
    }
}

/// The brightest path of a sample.
pub(super) struct Brightest {
    luminance: f32,
    position: [f32; 2],
    technique: Option<Technique>,
}

impl Brightest {
    /// Before the first path.
    pub fn new() -> Self {
        Self {
            luminance: 0.0,
            position: [0.0; 2],
            technique: None,
        }
    }

    /// Keeps the path if it is brighter than those before.
    pub fn add(&mut self, technique: Technique, splat: Splat) {
        let luminance = luminance(splat.value);
        if luminance > self.luminance {
            *self = Self {
                luminance,
                position: splat.position,
                technique: Some(technique),
            };
        }
    }

    /// Writes the features of the sample, whose coordinates were read through `sampler`.
    pub fn observe<S>(&self, sampler: &ObservedSampler<S>, out: &mut Observation) {
        out.features = Features {
            log_density: f64::NAN,
            tile: tile(self.position),
            technique: self.technique.map_or(0, technique_index),
            length: self.technique.map_or(0, Technique::edges) as f64,
            coordinates: sampler.seen,
        };
        out.light.clear();
    }
}

/// Index of a technique. Techniques of more than 7 light or camera vertices are counted as having 7.
fn technique_index(technique: Technique) -> usize {
    const SIDE: usize = 8;
    const { assert!(SIDE * SIDE == TECHNIQUES) };
    technique.s().min(SIDE - 1) * SIDE + technique.t().min(SIDE - 1)
}

/// Integral of the luminance of `pixels` over each tile, the film being the unit square.
pub(super) fn light_of_tiles(pixels: &[[f32; 3]]) -> Vec<f64> {
    let mut tiles = vec![0.0; TILES * TILES];
    let side = PIXELS as usize;
    for (i, &pixel) in pixels.iter().enumerate() {
        let position = [i % side, i / side].map(|x| (x as f32 + 0.5) / side as f32);
        tiles[tile(position)] += f64::from(luminance(pixel.into())) / pixels.len() as f64;
    }
    tiles
}
