//! The chains of a scene.

use super::observation::{
    COORDINATES, Features, Observation, Plain, Subject, TECHNIQUES, TILES, tile_at,
};
use crate::film::{Filter, Image};
use crate::integrators::{Sampler, Splats, Technique, Workspace};
use crate::markov::Target;
use crate::math::{Rgb, luminance};
use crate::path::dimensions;
use crate::render::{Budget, Integrator, Settings, Unobserved, render};
use crate::sampling::{Coordinates, Stream};
use crate::scene::Scene;

/// The path sampler of every Metropolis integrator.
const SAMPLER: Sampler = Sampler::Bidirectional;

/// Samples per pixel of the plain render that chains are compared with, and its pixels in a row and in
/// a column, a multiple of [`TILES`].
const PLAIN_SPP: u64 = 512;
const PLAIN_PIXELS: u32 = 64;

/// The light of a scene.
pub struct SceneLight<'a> {
    scene: &'a Scene,
    threads: Option<usize>,
}

impl<'a> SceneLight<'a> {
    /// Of `scene`, with a plain render on `threads` threads (`None` for one per core).
    ///
    /// The film gets a box filter, so that the mean of all pixels is the integral of the light over
    /// the film, and few pixels. Neither has any part in what chains do: their film is continuous.
    pub fn new(scene: &'a mut Scene, threads: Option<usize>) -> Self {
        scene.film.filter = Filter::Box;
        [scene.film.width, scene.film.height] = [PLAIN_PIXELS; 2];
        Self { scene, threads }
    }
}

impl<'a> Subject for SceneLight<'a> {
    type Target = ObservedLight<'a>;

    fn target(&self) -> ObservedLight<'a> {
        ObservedLight {
            scene: self.scene,
            workspace: Workspace::default(),
            splats: Splats::default(),
        }
    }

    /// From a render by plain bidirectional path tracing, which shares nothing with the chains but the
    /// path sampler. Without samples if its threads cannot be started.
    fn plain(&self, seed: u64) -> Plain {
        let settings = Settings {
            budget: Budget::SamplesPerPixel(PLAIN_SPP),
            seed,
            threads: self.threads,
            ..Settings::new(Integrator::Bdpt)
        };
        match render(self.scene, &settings, &Unobserved) {
            Ok(rendering) => Plain {
                samples: rendering.statistics.samples,
                tiles: light_of_tiles(&rendering.image),
            },
            Err(_) => Plain {
                samples: 0,
                tiles: vec![0.0; TILES * TILES],
            },
        }
    }
}

/// Integral of the luminance over each tile, the film being the unit square.
fn light_of_tiles(image: &Image) -> Vec<f64> {
    let mut tiles = vec![0.0; TILES * TILES];
    let size = [image.width as f64, image.height as f64];
    for (i, &pixel) in image.pixels.iter().enumerate() {
        let centre = [
            (i % image.width) as f64 + 0.5,
            (i / image.width) as f64 + 0.5,
        ];
        let light = f64::from(luminance(Rgb::from(pixel)));
        tiles[tile_at(centre, size)] += light / image.pixels.len() as f64;
    }
    tiles
}

/// A bidirectional path sampler that tells what its paths are like.
pub struct ObservedLight<'a> {
    scene: &'a Scene,
    workspace: Workspace,
    splats: Splats,
}

impl ObservedLight<'_> {
    /// The tile of the pixel that a splat lands in.
    fn tile(&self, position: [f32; 2]) -> usize {
        let size = [self.scene.film.width, self.scene.film.height].map(f64::from);
        let centre = |i: usize| (f64::from(position[i]) * size[i]).floor() + 0.5;
        tile_at([centre(0), centre(1)], size)
    }
}

impl Target for ObservedLight<'_> {
    type Contribution = Observation;

    fn evaluate<C: Coordinates>(&mut self, point: &mut C, out: &mut Observation) -> f64 {
        let mut watched = Watched {
            point,
            seen: [f64::NAN; COORDINATES],
        };
        self.splats.clear();
        let film = SAMPLER.film_position(&mut watched);
        self.splats.film = film;
        let mut brightest = (0.0, film, Technique { s: 0, t: 0 });
        let Self {
            scene,
            workspace,
            splats,
        } = self;
        SAMPLER.connections(
            scene,
            film,
            &mut watched,
            workspace,
            |technique, connection| {
                let value = connection.contribution();
                splats.add(connection.film, value);
                let light = luminance(value);
                if light > brightest.0 {
                    brightest = (light, connection.position(film), technique);
                }
            },
        );
        let Technique { s, t } = brightest.2;
        out.features = Features {
            log_density: f64::NAN,
            tile: self.tile(brightest.1.into()),
            technique: technique_index(brightest.2),
            length: (s + t).saturating_sub(1) as f64,
            coordinates: watched.seen,
        };
        out.light.clear();
        for splat in self.splats.iter() {
            let light = f64::from(luminance(splat.value));
            out.add(self.tile(splat.position), light);
        }
        self.splats.luminance()
    }
}

/// Techniques of up to 6 light vertices and up to 7 camera vertices have an index of their own; longer
/// ones share with their likes.
fn technique_index(Technique { s, t }: Technique) -> usize {
    const SIDE: usize = 8;
    const { assert!(SIDE * SIDE == TECHNIQUES) };
    s.min(SIDE - 1) * SIDE + t.min(SIDE - 1)
}

/// A point of the hypercube some of whose coordinates are noted down as they are read.
struct Watched<'a, C> {
    point: &'a mut C,
    seen: [f64; COORDINATES],
}

/// The film position, a direction after the first surface, and a place on an emitter.
const WATCHED: [(Stream, usize); COORDINATES] = [
    (Stream::Camera, dimensions::FILM),
    (Stream::Camera, dimensions::FILM + 1),
    (Stream::Camera, dimensions::camera_vertex(1) + 1),
    (Stream::Light, dimensions::EMISSION + 2),
];

/// What the watched coordinates are.
pub const COORDINATE_NAMES: [&str; COORDINATES] = [
    "film x",
    "film y",
    "direction at the first surface",
    "place on the emitter",
];

impl<C: Coordinates> Coordinates for Watched<'_, C> {
    fn read<const N: usize>(&mut self, stream: Stream, first: usize) -> [f32; N] {
        let values = self.point.read::<N>(stream, first);
        for (seen, (watched, index)) in self.seen.iter_mut().zip(WATCHED) {
            if stream == watched && (first..first + N).contains(&index) {
                *seen = f64::from(values[index - first]);
            }
        }
        values
    }
}
