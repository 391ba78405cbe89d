//! One sample of a render, made again and taken apart.

use glam::Vec2;

use super::sweep::pixel_sample;
use super::{Origin, Settings};
use crate::film::FilmSampler;
use crate::integrators::{Sampler, Splats, Technique, Workspace};
use crate::markov::{Chain, Target};
use crate::sampling::seeds::{self, Purpose};
use crate::sampling::{Coordinates, FreshCoordinates};
use crate::scene::Scene;
use crate::technique::Connection;

/// A path sampler that keeps what its last sample was made of.
pub struct Replay<'a> {
    scene: &'a Scene,
    sampler: Sampler,
    /// The subpaths.
    pub workspace: Workspace,
    /// Where the camera subpath begins on the film, in [0, 1)^2.
    pub film: Vec2,
    /// What every technique gave.
    pub connections: Vec<(Technique, Connection)>,
}

/// Why a sample cannot be made again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplayError {
    /// Samples of pixels are Monte Carlo's; bootstraps and chains are Metropolis's.
    #[error("the integrator {0} makes no such sample")]
    WrongIntegrator(&'static str),
    /// The image is smaller.
    #[error("the image has {0} pixels only: is its size that of the render?")]
    NoSuchPixel(u64),
    /// A chain starts from a sample with light.
    #[error("bootstrap sample {0} has no light, so that no chain started from it")]
    DarkStart(u64),
}

impl<'a> Replay<'a> {
    /// Makes the sample again that a render of `scene` with these settings made at `origin`. Of the
    /// settings the integrator, the seed and, for a chain, its steps matter.
    ///
    /// # Errors
    /// If the integrator makes no such samples, the image has no such pixel, or the chain could not
    /// have started where it is said to.
    pub fn run(scene: &'a Scene, settings: &Settings, origin: Origin) -> Result<Self, ReplayError> {
        let mut replay = Self {
            scene,
            sampler: settings.integrator.sampler(),
            workspace: Workspace::default(),
            film: Vec2::ZERO,
            connections: Vec::new(),
        };
        if matches!(origin, Origin::Pixel { .. }) == settings.integrator.is_metropolis() {
            let name = settings.integrator.name();
            return Err(ReplayError::WrongIntegrator(name));
        }
        let mut splats = Splats::default();
        match origin {
            Origin::Pixel { pass, pixel } => replay.pixel(settings.seed, pass, pixel)?,
            Origin::Bootstrap { sample } => {
                let rng = seeds::generator(settings.seed, Purpose::Bootstrap, sample);
                replay.evaluate(&mut FreshCoordinates::new(rng), &mut splats);
            }
            Origin::Mutation { chain, start, step } => {
                let mut chain = Chain::start(
                    &mut replay,
                    seeds::generator(settings.seed, Purpose::Bootstrap, start),
                    seeds::chain_generator(settings.seed, chain),
                    settings.large_step_probability,
                    settings.small_step,
                );
                let density = chain.current().density;
                if density.is_nan() || density <= 0.0 {
                    return Err(ReplayError::DarkStart(start));
                }
                for _ in 0..step {
                    chain.step(&mut replay);
                }
            }
        }
        Ok(replay)
    }

    fn pixel(&mut self, seed: u64, pass: u64, pixel: u64) -> Result<(), ReplayError> {
        let [width, height] = [self.scene.film.width, self.scene.film.height];
        let pixels = u64::from(width) * u64::from(height);
        if pixel >= pixels {
            return Err(ReplayError::NoSuchPixel(pixels));
        }
        let film = FilmSampler::new(width, height, self.scene.film.filter);
        pixel_sample(&film, pixels, seed, pass, pixel, |point| {
            self.sample(point);
        });
        Ok(())
    }

    fn sample<C: Coordinates>(&mut self, point: &mut C) {
        let Self {
            scene,
            sampler,
            workspace,
            film,
            connections,
        } = self;
        connections.clear();
        *film = sampler.film_position(point);
        sampler.connections(scene, *film, point, workspace, |technique, connection| {
            connections.push((technique, connection));
        });
    }
}

impl Target for Replay<'_> {
    type Contribution = Splats;

    fn evaluate<C: Coordinates>(&mut self, point: &mut C, out: &mut Splats) -> f64 {
        self.sample(point);
        out.clear();
        out.film = self.film;
        for (_, connection) in &self.connections {
            out.add(connection.film, connection.contribution());
        }
        out.luminance()
    }
}
