//! Each technique (s, t) of bidirectional path tracing as an image of its own, with and without its
//! weight: Veach's pyramid (1997, figures 10.3 and 10.4).
//!
//! The samples are those of the integrator `bdpt` with the same seed: its image is the sum of the
//! weighted images here. An unweighted one shows C_{s,t} = alpha^L_s c_{s,t} alpha^E_t (section
//! 10.2): all light of paths of s + t - 1 edges that the technique can make, as well as it can.

use std::time::Instant;

use super::clock::Clock;
use super::sweep::{AtPixel, Collector, Place, Sweep, pixels};
use super::{NonFinite, Observer, Origin, Settings, Statistics, Warning, warnings};
use crate::film::{Film, Image, Splat, SplatLog};
use crate::integrators::{Sampler, Technique, Workspace};
use crate::math::Rgb;
use crate::math::color::is_light;
use crate::scene::Scene;
use crate::technique::Connection;

/// What one technique gives.
#[derive(Clone, Debug, PartialEq)]
pub struct TechniqueImages {
    /// Which.
    pub technique: Technique,
    /// Without the weight.
    pub unweighted: Image,
    /// With the weight of the power heuristic.
    pub weighted: Image,
}

/// What all techniques give.
#[derive(Debug)]
pub struct Strategies {
    /// In the order of [`techniques`].
    pub images: Vec<TechniqueImages>,
    /// What they took.
    pub statistics: Statistics,
    /// The observer stopped before all samples were taken.
    pub interrupted: bool,
    /// What limits the images.
    pub warnings: Vec<Warning>,
}

/// Why techniques cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum StrategiesError {
    /// There are as many techniques as paths are long.
    #[error("paths of any length have techniques without number: a limit on their edges is needed")]
    Unlimited,
    /// Each technique has two images.
    #[error(
        "{techniques} techniques at {pixels} pixels would take {needed} GB of memory, more than {most}: \
         a smaller image or shorter paths are needed"
    )]
    TooMuchMemory {
        /// Number of techniques.
        techniques: u64,
        /// Pixels of each image.
        pixels: u64,
        /// Gigabytes.
        needed: u64,
        /// Gigabytes.
        most: u64,
    },
    /// The threads cannot be started.
    #[error(transparent)]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Most memory for films, in bytes.
const MOST_BYTES: u64 = 8_000_000_000;

/// Memory for a pixel of a technique: sums of samples and splats and a number of samples, twice, and
/// two pixels of 32-bit floats.
const PIXEL_BYTES: u64 = 2 * (24 + 24 + 8) + 2 * 12;

/// All techniques for paths of up to `edges` edges that the sampler uses: by number of edges, those of
/// one number by s. Light that is seen directly is left to (0, 2), so that (1, 1) is not among them.
pub fn techniques(edges: u32) -> Vec<Technique> {
    let lengths = 1..=edges as usize;
    let all = lengths.flat_map(|k| (0..=k).map(move |s| Technique { s, t: k + 1 - s }));
    all.filter(|technique| (technique.s, technique.t) != (1, 1))
        .collect()
}

/// The place of a technique in [`techniques`].
fn place_of(Technique { s, t }: Technique) -> usize {
    match s + t - 1 {
        1 => 0,
        // Before it: one technique of one edge, and j + 1 of j edges for 2 <= j < k.
        k => k * (k + 1) / 2 - 2 + s,
    }
}

/// Renders each technique. Of the settings the budget, the seed and the number of threads matter; the
/// integrator must be `bdpt`. The images depend on the number of threads no more than a render does.
///
/// # Errors
/// If the scene does not limit the length of paths, the images would not fit into memory, or threads
/// cannot be started.
pub fn strategies(
    scene: &Scene,
    settings: &Settings,
    observer: &dyn Observer,
) -> Result<Strategies, StrategiesError> {
    let edges = check(scene)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads.unwrap_or(0))
        .build()?;
    Ok(pool.install(|| {
        let mut pyramid = Pyramid::new(scene, settings, edges);
        let mut sweep = Sweep::new(scene, settings.seed);
        observer.phase("rendering");
        let mut clock = Clock::new(Instant::now(), settings.budget, pixels(scene), observer);
        sweep.sample(&mut pyramid, &mut clock);
        pyramid.finish(&sweep, &clock, observer)
    }))
}

/// Checks that the techniques of `scene` can be shown, and returns the greatest number of edges.
///
/// # Errors
/// If the scene does not limit the length of paths, or the images would not fit into memory.
pub fn check(scene: &Scene) -> Result<u32, StrategiesError> {
    let edges = scene.depth.max_depth.ok_or(StrategiesError::Unlimited)?;
    check_memory(edges, pixels(scene))?;
    Ok(edges)
}

fn check_memory(edges: u32, pixels: u64) -> Result<(), StrategiesError> {
    // As many as `techniques` makes, without making them.
    let edges = u64::from(edges);
    let techniques = (edges.saturating_mul(edges + 3) / 2).saturating_sub(1);
    let bytes = techniques
        .saturating_mul(pixels)
        .saturating_mul(PIXEL_BYTES);
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    Err(StrategiesError::TooMuchMemory {
        techniques,
        pixels,
        needed: bytes.div_ceil(1_000_000_000),
        most: MOST_BYTES / 1_000_000_000,
    })
}

/// What a run of pixels leaves.
#[derive(Default)]
struct Run {
    /// Light at the samples' own pixels: the pixel, the technique's place, its light without and with
    /// the weight.
    camera: Vec<(u64, usize, [Rgb; 2])>,
    /// Per technique, light elsewhere without and with the weight.
    elsewhere: Vec<[SplatLog; 2]>,
    /// Pixels with a contribution that was not finite; one entry for each.
    non_finite: Vec<u64>,
}

impl Run {
    /// Takes note of what technique number `place` gave to the sample of `pixel`.
    #[inline]
    fn note(&mut self, pixel: u64, place: usize, connection: &Connection) {
        let both = [connection.value, connection.contribution()];
        if !both.iter().all(|&value| is_light(value)) {
            self.non_finite.push(pixel);
            return;
        }
        let Some(film) = connection.film else {
            self.camera.push((pixel, place, both));
            return;
        };
        if self.elsewhere.len() <= place {
            self.elsewhere.resize_with(place + 1, Default::default);
        }
        for (log, value) in self.elsewhere[place].iter_mut().zip(both) {
            if value != Rgb::ZERO {
                let position = film.into();
                log.push(Splat { position, value });
            }
        }
    }
}

/// Two images of each technique in the making.
struct Pyramid<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    techniques: Vec<Technique>,
    /// Per technique, without and with the weight.
    films: Vec<[Film; 2]>,
    non_finite: NonFinite,
}

impl Collector for Pyramid<'_> {
    type Run = Run;

    fn clear(run: &mut Run) {
        run.camera.clear();
        run.elsewhere.iter_mut().flatten().for_each(SplatLog::clear);
        run.non_finite.clear();
    }

    #[inline]
    fn sample(&self, pixel: u64, point: &mut AtPixel, workspace: &mut Workspace, run: &mut Run) {
        let sampler = Sampler::Bidirectional;
        let film = sampler.film_position(point);
        let note = |technique, connection| run.note(pixel, place_of(technique), &connection);
        sampler.connections(self.scene, film, point, workspace, note);
    }

    fn add(&mut self, runs: &[(Place, &Run)]) {
        for (place, run) in runs {
            // Each sample counts for every technique, whether it has found light or not.
            for film in self.films.iter_mut().flatten() {
                for pixel in place.pixels.clone() {
                    film.add_samples(pixel as usize, [0.0; 3], 1);
                }
            }
            for &(pixel, technique, both) in &run.camera {
                for (film, value) in self.films[technique].iter_mut().zip(both) {
                    film.add_samples(pixel as usize, value.as_dvec3().to_array(), 0);
                }
            }
            let pass = place.pass;
            for &pixel in &run.non_finite {
                self.non_finite.add(1, Origin::Pixel { pass, pixel });
            }
        }
        for (technique, films) in self.films.iter_mut().enumerate() {
            for (which, film) in films.iter_mut().enumerate() {
                let logs = runs
                    .iter()
                    .filter_map(|(_, run)| run.elsewhere.get(technique));
                let logs = logs.map(|both| &both[which]);
                let logs: Vec<_> = logs.filter(|log| !log.splats().is_empty()).collect();
                if !logs.is_empty() {
                    film.apply(&logs);
                }
            }
        }
    }
}

impl<'a> Pyramid<'a> {
    fn new(scene: &'a Scene, settings: &'a Settings, edges: u32) -> Self {
        let techniques = techniques(edges);
        let [width, height] = [scene.film.width, scene.film.height];
        let film = || Film::new(width, height, scene.film.filter);
        Self {
            scene,
            settings,
            films: techniques.iter().map(|_| [film(), film()]).collect(),
            techniques,
            non_finite: NonFinite::default(),
        }
    }

    fn finish(self, sweep: &Sweep<Run>, clock: &Clock, observer: &dyn Observer) -> Strategies {
        let done = sweep.done();
        let splat_scale = 1.0 / done.max(1) as f64;
        let images = self.techniques.iter().zip(&self.films);
        let images = images.map(|(&technique, films)| {
            let [unweighted, weighted] = films.each_ref().map(|film| film.resolve(splat_scale));
            TechniqueImages {
                technique,
                unweighted,
                weighted,
            }
        });
        Strategies {
            images: images.collect(),
            interrupted: observer.interrupted() && clock.total_samples().is_none_or(|n| done < n),
            warnings: warnings::non_finite(&self.non_finite)
                .into_iter()
                .chain(warnings::unsampled(done, pixels(self.scene)))
                .collect(),
            statistics: Statistics::new(
                self.scene,
                self.settings,
                [clock.elapsed(); 2],
                done,
                sweep.rays(),
                self.non_finite,
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn techniques_are_where_their_place_says() {
        let all = techniques(7);
        for (i, &technique) in all.iter().enumerate() {
            assert_eq!(place_of(technique), i, "{technique:?}");
        }
        assert_eq!(all.len(), 34);
        let pairs: Vec<_> = all[..4]
            .iter()
            .map(|technique| (technique.s, technique.t))
            .collect();
        assert_eq!(pairs, [(0, 2), (0, 3), (1, 2), (2, 1)]);
    }

    #[test]
    fn memory_is_not_spent_without_limit() {
        assert!(check_memory(5, 1 << 20).is_ok());
        assert!(check_memory(u32::MAX, 1).is_err());
        let error = check_memory(10, 1 << 22).unwrap_err().to_string();
        assert!(
            error.contains("64 techniques at 4194304 pixels would take 37 GB"),
            "{error}"
        );
    }
}
