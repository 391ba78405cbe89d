//! The light of every class of paths found by each technique alone.

use std::collections::{BTreeMap, BTreeSet};

use metrolight::integrators::{BidirectionalPathTracer, PathSampler, Workspace};
use metrolight::math::luminance;
use metrolight::path::Vertex;
use metrolight::sampling::IndependentSampler;
use metrolight::sampling::seeds::Purpose;
use metrolight::scene::Scene;
use metrolight::statistics::Moments;
use rayon::prelude::*;

use super::classes::{Class, Event};

/// Independent batches of samples: their means are nearly normal, and give sums over classes and techniques
/// a variance estimate, however these are correlated.
const BATCHES: usize = 64;

/// Halves of the film, left and right, in which light is measured.
pub const HALVES: [&str; 2] = ["left", "right"];

/// Paths of one class, found by one technique in one half of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    pub class: Class,
    /// s and t.
    pub technique: (usize, usize),
    /// Index into [`HALVES`].
    pub half: usize,
}

/// Means over each batch, of luminance.
struct Tally {
    paths: u64,
    alone: [f64; BATCHES],
    weighted: [f64; BATCHES],
}

pub struct Measured {
    tallies: BTreeMap<Key, Tally>,
    /// Diffuse surfaces lit or seen through delta functions.
    pub behind: Behind<String>,
}

/// Diffuse surfaces that light reaches, or leaves toward the lens, through delta functions.
#[derive(Default)]
pub struct Behind<T> {
    /// Reached: the path has S vertices before its first D.
    pub lit: BTreeSet<T>,
    /// Left: the path has S vertices after its last D.
    pub seen: BTreeSet<T>,
    /// Both on one path, without another D.
    pub both: BTreeSet<T>,
}

impl Behind<u32> {
    fn note(&mut self, class: Class, surfaces: &[&Vertex]) {
        let events: Vec<Event> = class.events().collect();
        let diffuse = |event: &Event| *event == Event::D;
        let (Some(first), Some(last)) = (
            events.iter().position(diffuse),
            events.iter().rposition(diffuse),
        ) else {
            return;
        };
        let shape = |i: usize| surfaces[i].surface.shape;
        let (lit, seen) = (first > 0, last + 1 < events.len());
        if lit {
            self.lit.insert(shape(first));
        }
        if seen {
            self.seen.insert(shape(last));
        }
        if lit && seen && first == last {
            self.both.insert(shape(first));
        }
    }

    fn add_names(&self, scene: &Scene, names: &mut Behind<String>) {
        let name = |shape: &u32| scene.geometry.shape_name(*shape).to_owned();
        names.lit.extend(self.lit.iter().map(name));
        names.seen.extend(self.seen.iter().map(name));
        names.both.extend(self.both.iter().map(name));
    }
}

/// Sums of one batch: paths, their light, and that weighted.
type Batch = BTreeMap<Key, (u64, f64, f64)>;

impl Measured {
    pub fn new(scene: &Scene, samples: usize) -> Self {
        let per_batch = samples / BATCHES;
        let batches: Vec<_> = (0..BATCHES)
            .into_par_iter()
            .map(|batch| measure(scene, batch as u64, per_batch))
            .collect();
        let mut tallies = BTreeMap::new();
        let mut behind = Behind::default();
        for (i, (batch, shapes)) in batches.into_iter().enumerate() {
            for (key, (paths, alone, weighted)) in batch {
                let tally = tallies.entry(key).or_insert(Tally {
                    paths: 0,
                    alone: [0.0; BATCHES],
                    weighted: [0.0; BATCHES],
                });
                tally.paths += paths;
                tally.alone[i] = alone / per_batch as f64;
                tally.weighted[i] = weighted / per_batch as f64;
            }
            shapes.add_names(scene, &mut behind);
        }
        Self { tallies, behind }
    }

    /// All classes of which a path has been found.
    pub fn classes(&self) -> BTreeSet<Class> {
        self.tallies.keys().map(|key| key.class).collect()
    }

    /// Number of paths of `class` that `technique` has found.
    pub fn class_paths(&self, class: Class, technique: (usize, usize)) -> u64 {
        let halves = 0..HALVES.len();
        let keys = halves.map(|half| Key {
            class,
            technique,
            half,
        });
        keys.map(|key| self.paths(&key)).sum()
    }

    /// The same in one half of the film.
    pub fn paths(&self, key: &Key) -> u64 {
        self.tallies.get(key).map_or(0, |tally| tally.paths)
    }

    /// The light that one technique alone finds.
    pub fn alone(&self, key: &Key) -> Moments {
        match self.tallies.get(key) {
            Some(tally) => tally.alone.into_iter().collect(),
            None => [0.0; BATCHES].into_iter().collect(),
        }
    }

    /// The weighted light of all that `of` chooses.
    pub fn weighted(&self, of: impl Fn(&Key) -> bool) -> Moments {
        let chosen: Vec<_> = self.tallies.iter().filter(|(key, _)| of(key)).collect();
        (0..BATCHES)
            .map(|i| {
                chosen
                    .iter()
                    .map(|(_, tally)| tally.weighted[i])
                    .sum::<f64>()
            })
            .collect()
    }
}

fn measure(scene: &Scene, batch: u64, samples: usize) -> (Batch, Behind<u32>) {
    let mut sums = Batch::new();
    let mut behind = Behind::default();
    let mut workspace = Workspace::default();
    let mut made = Vec::new();
    for i in 0..samples as u64 {
        let index = batch * samples as u64 + i;
        let mut sampler = IndependentSampler::new(12, Purpose::Pixels, index);
        BidirectionalPathTracer.sample_paths(scene, &mut sampler, &mut workspace, |path| {
            made.push(path);
        });
        for path in made.drain(..) {
            let (s, t) = (path.technique.s(), path.technique.t());
            let value = f64::from(luminance(path.value));
            if value == 0.0 {
                continue;
            }
            let surfaces = surfaces(&workspace, s, t);
            let class = Class::new(surfaces.iter().map(|vertex| event(scene, vertex)));
            let key = Key {
                class,
                technique: (s, t),
                half: usize::from(path.film.x >= 0.5),
            };
            let (paths, alone, weighted) = sums.entry(key).or_default();
            *paths += 1;
            *alone += value;
            *weighted += value * f64::from(path.weight);
            behind.note(class, &surfaces);
        }
    }
    (sums, behind)
}

/// x_1 ... x_{k-1} of the path that technique (s, t) has just made.
fn surfaces(workspace: &Workspace, s: usize, t: usize) -> Vec<&Vertex> {
    let (light, camera) = (
        &workspace.light.vertices[..],
        &workspace.camera.vertices[..],
    );
    // For s = 0 the last camera vertex lies on the emitter.
    let camera = &camera[..if s == 0 { t - 2 } else { t - 1 }];
    let light = &light[..s.saturating_sub(1)];
    light.iter().chain(camera.iter().rev()).collect()
}

fn event(scene: &Scene, vertex: &Vertex) -> Event {
    if vertex.is_connectible(scene) {
        Event::D
    } else {
        Event::S
    }
}
