//! What the chains of multiplexed Metropolis sample.

use glam::Vec2;

use super::division::Division;
use crate::integrators::{Sampler, Splats, Technique, Workspace, multiplexed};
use crate::markov::Target;
use crate::math::color;
use crate::path::Heuristic;
use crate::sampling::{Coordinates, Stream};
use crate::scene::{RayCounts, Scene};

/// Paths of one length; the technique is a coordinate of the state (Hachisuka et al. 2014, section
/// 4.2). The density is the luminance of what the chains carry, in units of the importance map, times
/// the number of techniques of that length: its mean b_k is that of the sum over all techniques.
pub struct MultiplexedTarget<'a> {
    scene: &'a Scene,
    division: &'a Division,
    /// k: number of edges of the paths.
    edges: usize,
    workspace: Workspace,
}

impl<'a> MultiplexedTarget<'a> {
    /// The paths of `edges` edges, as far as `division` gives them to the chains.
    pub fn new(scene: &'a Scene, division: &'a Division, edges: usize) -> Self {
        Self {
            scene,
            division,
            edges,
            workspace: Workspace::default(),
        }
    }

    /// Reads all coordinates of `point` that any technique reads, in the order in which plain sampling
    /// reads them.
    pub fn read_all<C: Coordinates>(&mut self, point: &mut C) {
        let sampler = Sampler::Bidirectional;
        let film = sampler.film_position(point);
        sampler.connections(self.scene, film, point, &mut self.workspace, |_, _| {});
    }

    /// The technique coordinate that stands for technique number `s` of this length, `u` in [0, 1)
    /// being the place within its part of the unit interval.
    pub fn choice(&self, s: usize, u: f32) -> f32 {
        let count = Technique::count(self.edges) as f32;
        ((s as f32 + u) / count).min(1.0 - f32::EPSILON / 2.0)
    }

    /// Rays traced so far.
    pub fn rays(&self) -> RayCounts {
        self.workspace.rays
    }
}

impl Target for MultiplexedTarget<'_> {
    type Contribution = Splats;

    #[inline]
    fn evaluate<C: Coordinates>(&mut self, point: &mut C, out: &mut Splats) -> f64 {
        out.clear();
        let count = Technique::count(self.edges);
        let [choice] = point.read::<1>(Stream::Technique, 0);
        let s = ((choice * count as f32) as usize).min(count - 1);
        let technique = Technique::of(self.edges, s);
        let film = if technique.t == 1 {
            Vec2::ZERO
        } else {
            Sampler::Bidirectional.film_position(point)
        };
        let connection = multiplexed::connection(
            self.scene,
            Heuristic::default(),
            technique,
            film,
            point,
            &mut self.workspace,
        );
        let Some(connection) = connection else {
            return 0.0;
        };
        let value = connection.contribution();
        if !color::is_light(value) {
            return f64::NAN;
        }
        out.film = connection.position(film);
        let position = out.film.to_array();
        let plain = self.division.plain_share(self.edges, value, position);
        out.camera = color::saturated(value * (1.0 - plain) * count as f32);
        f64::from(self.division.brightness(out.camera, position))
    }
}
