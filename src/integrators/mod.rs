//! Path samplers: maps from a point of the unit hypercube to splats on the film. They know nothing
//! of how the point was chosen; the drivers in `render` pair each with Monte Carlo or Metropolis.

pub mod bdpt;
pub mod light;
pub mod multiplexed;
pub mod path;

use glam::Vec2;

use crate::film::Splat;
use crate::math::{Rgb, color};
use crate::path::{Escape, Heuristic, Subpath, Vertex, dimensions};
use crate::sampling::{Coordinates, Stream};
use crate::scene::{RayCounts, Scene};
use crate::technique::Connection;

pub use bdpt::Technique;

/// The path samplers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// Unidirectional path tracing with next event estimation: techniques s <= 1.
    Path,
    /// Light tracing: technique t = 1 alone.
    Light,
    /// Bidirectional path tracing: all techniques with t >= 1.
    Bidirectional,
}

/// What one point of the hypercube gives: samples of the integral over the film as a unit square.
#[derive(Debug, Default)]
pub struct Splats {
    /// Film position of the camera subpath, in [0, 1)^2.
    pub film: Vec2,
    /// Light that arrives there.
    pub camera: Rgb,
    /// Light that arrives elsewhere, by technique t = 1.
    pub elsewhere: Vec<Splat>,
    /// Contributions that were NaN, infinite or negative, and left out.
    pub non_finite: u64,
}

impl Splats {
    /// Forgets everything but the room it has.
    pub fn clear(&mut self) {
        self.film = Vec2::ZERO;
        self.camera = Rgb::ZERO;
        self.elsewhere.clear();
        self.non_finite = 0;
    }

    /// Adds light at `film`, or at the camera subpath's position if that is `None`.
    #[inline]
    pub fn add(&mut self, film: Option<Vec2>, value: Rgb) {
        if !color::is_light(value) {
            self.non_finite += 1;
        } else if let Some(film) = film {
            if value != Rgb::ZERO {
                self.elsewhere.push(Splat {
                    position: film.into(),
                    value,
                });
            }
        } else {
            self.camera = color::saturated(self.camera + value);
        }
    }

    /// Every splat with light in it.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = Splat> + '_ {
        let camera = Splat {
            position: self.film.into(),
            value: self.camera,
        };
        let camera = (self.camera != Rgb::ZERO).then_some(camera);
        camera.into_iter().chain(self.elsewhere.iter().copied())
    }

    /// Total luminance: the scalar contribution I(u) of Kelemen et al. (2002, section 2), positive
    /// wherever a splat is. NaN if a contribution was not finite.
    #[inline]
    pub fn luminance(&self) -> f64 {
        if self.non_finite > 0 {
            return f64::NAN;
        }
        self.iter()
            .map(|splat| f64::from(crate::math::luminance(splat.value)))
            .sum()
    }
}

/// Memory that a sampler uses again for every path, and its counters.
#[derive(Debug, Default)]
pub struct Workspace {
    camera: Subpath,
    light: Subpath,
    /// Rays traced so far.
    pub rays: RayCounts,
}

impl Workspace {
    /// Surface vertices z_1, z_2, ... of the last camera subpath.
    pub fn camera_vertices(&self) -> &[Vertex] {
        &self.camera.vertices
    }

    /// Surface vertices y_1, y_2, ... of the last light subpath.
    pub fn light_vertices(&self) -> &[Vertex] {
        &self.light.vertices
    }

    /// Where the last camera subpath left the scene, if it did.
    pub fn escape(&self) -> Option<&Escape> {
        self.camera.escape.as_ref()
    }
}

impl Sampler {
    /// The light of all paths that `point` stands for, as splats; `splats` is cleared first.
    #[inline]
    pub fn sample<C: Coordinates>(
        self,
        scene: &Scene,
        point: &mut C,
        workspace: &mut Workspace,
        splats: &mut Splats,
    ) {
        splats.clear();
        splats.film = self.film_position(point);
        let film = splats.film;
        self.connections(scene, film, point, workspace, |_, connection| {
            splats.add(connection.film, connection.contribution());
        });
    }

    /// Where the camera subpath begins on the film, in [0, 1)^2; (0, 0) if there is none.
    #[inline]
    pub fn film_position<C: Coordinates>(self, point: &mut C) -> Vec2 {
        match self {
            Self::Path | Self::Bidirectional => {
                Vec2::from(point.read::<2>(Stream::Camera, dimensions::FILM))
            }
            Self::Light => Vec2::ZERO,
        }
    }

    /// Samples the subpaths that `point` stands for, the camera's from `film` on, and hands every
    /// connection that carries light to `visit`.
    #[inline]
    pub fn connections<C: Coordinates>(
        self,
        scene: &Scene,
        film: Vec2,
        point: &mut C,
        workspace: &mut Workspace,
        visit: impl FnMut(Technique, Connection),
    ) {
        let heuristic = Heuristic::default();
        match self {
            Self::Path => path::connections(scene, heuristic, film, point, workspace, visit),
            Self::Light => light::connections(scene, heuristic, point, workspace, visit),
            Self::Bidirectional => {
                bdpt::connections(scene, heuristic, film, point, workspace, visit);
            }
        }
    }
}

/// Greatest number of edges of a path, with a bound where the scene has none that no path reaches
/// by more than chance: Russian roulette ends every subpath long before.
fn max_edges(scene: &Scene) -> usize {
    scene
        .depth
        .max_depth
        .map_or(usize::MAX / 4, |depth| depth as usize)
}
