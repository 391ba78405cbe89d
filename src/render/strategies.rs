//! Each technique (s, t) of bidirectional path tracing as an image of its own, with and without its
//! weight: Veach's pyramid (1997, figures 10.3 and 10.4).
//!
//! The samples are those of the integrator `bdpt` with the same seed: its image is the sum of the
//! weighted images here. An unweighted image shows C_{s,t} = alpha^L_s c_{s,t} alpha^E_t (section
//! 10.2): an estimate of all light of paths of s + t - 1 edges that the technique can sample.

use std::time::Instant;

use super::clock::Clock;
use super::passes::{BLOCK, PassLoop, Tile, TileBuffer};
use super::{
    NonFinite, Observer, SampleId, Settings, Statistics, Warning, in_pool, pixel_count, warnings,
};
use crate::film::{Film, Image, Splat, SplatLog};
use crate::integrators::{BidirectionalPathTracer, PathSampler};
use crate::math::Rgb;
use crate::math::color::is_light;
use crate::scene::Scene;
use crate::technique::{PathContribution, Technique, Techniques};

/// The images of one technique.
#[derive(Clone, Debug, PartialEq)]
pub struct TechniqueImages {
    /// The technique.
    pub technique: Technique,
    /// Without the weight.
    pub unweighted: Image,
    /// With the weight of the power heuristic.
    pub weighted: Image,
}

/// The images of all techniques.
#[derive(Debug)]
pub struct Strategies {
    /// In the order of [`Techniques::all`].
    pub images: Vec<TechniqueImages>,
    /// Samples, rays, times.
    pub statistics: Statistics,
    /// The observer cancelled before all samples were taken.
    pub interrupted: bool,
    /// Reasons to distrust the images, or to render for longer.
    pub warnings: Vec<Warning>,
}

/// Why techniques cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum StrategiesError {
    /// The number of techniques grows with the length of paths.
    #[error("paths of unlimited length have infinitely many techniques: limit the number of edges")]
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
        /// Memory of the images, in gigabytes.
        needed: u64,
        /// Maximum, in gigabytes.
        most: u64,
    },
    /// The threads cannot be started.
    #[error(transparent)]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Maximum memory for films, in bytes.
const MAX_BYTES: u64 = 8_000_000_000;

/// Number of edges up to which techniques are counted one by one.
const MAX_COUNTED: u32 = 1 << 12;

/// Memory for a pixel of a technique, in bytes: sums of samples, sums of splats and a number of samples,
/// for each of two films, and two pixels of 32-bit floats.
const PIXEL_BYTES: u64 = 2 * (24 + 24 + 8) + 2 * 12;

/// Renders each technique. Of the settings, only the budget, the seed and the number of threads are used;
/// the integrator must be `bdpt`. As in a render, the images do not depend on the number of threads.
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
    Ok(in_pool(settings.threads, || {
        observer.phase("rendering");
        let mut pyramid = Pyramid::new(scene, settings, edges);
        let mut passes = PassLoop::new(scene, settings.seed);
        let techniques = Techniques::of(scene);
        let clock = Clock::new(
            Instant::now(),
            settings.budget,
            pixel_count(scene),
            observer,
        );
        while !clock.is_over(passes.samples()) {
            let block = clock.prompt_block(passes.samples(), BLOCK);
            let tiles = passes.advance(
                &clock,
                block,
                |pixel, sampler, workspace, tile: &mut TilePaths| {
                    let add = |path| tile.add(pixel, &path, techniques);
                    BidirectionalPathTracer.sample_paths(scene, sampler, workspace, add);
                },
            );
            pyramid.add(&tiles);
        }
        pyramid.finish(&passes, &clock)
    })?)
}

/// Checks that the techniques of `scene` can be rendered, and returns the maximum number of edges.
///
/// # Errors
/// If the scene does not limit the length of paths, or the images would not fit into memory.
pub fn check(scene: &Scene) -> Result<u32, StrategiesError> {
    let edges = scene.depth.max_depth.ok_or(StrategiesError::Unlimited)?;
    check_memory(edges, Techniques::of(scene), pixel_count(scene))?;
    Ok(edges)
}

/// Memory for the films of all techniques of up to `edges` edges, in bytes.
pub fn memory_bytes(scene: &Scene, edges: u32) -> u64 {
    let techniques = technique_count(edges, Techniques::of(scene));
    film_bytes(techniques, pixel_count(scene))
}

fn film_bytes(techniques: u64, pixels: u64) -> u64 {
    techniques
        .saturating_mul(pixels)
        .saturating_mul(PIXEL_BYTES)
}

/// The number of techniques, or an upper bound if it is large.
fn technique_count(edges: u32, techniques: Techniques) -> u64 {
    // At most as many for each length as for the longest paths.
    let most = techniques.count(edges as usize) as u64;
    match edges {
        0..=MAX_COUNTED => techniques.all(edges as usize).count() as u64,
        _ => u64::from(edges).saturating_mul(most),
    }
}

fn check_memory(edges: u32, techniques: Techniques, pixels: u64) -> Result<(), StrategiesError> {
    let techniques = technique_count(edges, techniques);
    let bytes = film_bytes(techniques, pixels);
    if bytes <= MAX_BYTES {
        return Ok(());
    }
    Err(StrategiesError::TooMuchMemory {
        techniques,
        pixels,
        needed: bytes.div_ceil(1_000_000_000),
        most: MAX_BYTES / 1_000_000_000,
    })
}

/// The paths of a tile's samples.
#[derive(Default)]
struct TilePaths {
    /// Contributions to the pixels of the samples: the pixel, the ordinal of the technique, and the light
    /// without and with the weight.
    pixels: Vec<(u64, usize, [Rgb; 2])>,
    /// Per technique, splats at other positions without and with the weight.
    light_images: Vec<[SplatLog; 2]>,
    /// Pixels with a contribution that was not finite; one entry for each.
    non_finite: Vec<u64>,
}

impl TileBuffer for TilePaths {
    fn clear(&mut self) {
        self.pixels.clear();
        let logs = self.light_images.iter_mut().flatten();
        logs.for_each(SplatLog::clear);
        self.non_finite.clear();
    }
}

impl TilePaths {
    /// Adds a path of the sample of `pixel`.
    #[inline]
    fn add(&mut self, pixel: u64, path: &PathContribution, techniques: Techniques) {
        let Splat { position, value } = path.splat();
        let both = [path.value, value];
        if !both.iter().all(|&value| is_light(value)) {
            self.non_finite.push(pixel);
            return;
        }
        let ordinal = techniques.ordinal(path.technique);
        if !path.technique.is_light_image() {
            self.pixels.push((pixel, ordinal, both));
            return;
        }
        if self.light_images.len() <= ordinal {
            self.light_images.resize_with(ordinal + 1, Default::default);
        }
        for (log, value) in self.light_images[ordinal].iter_mut().zip(both) {
            if value != Rgb::ZERO {
                log.push(Splat { position, value });
            }
        }
    }
}

/// Accumulates two images of each technique.
struct Pyramid<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    techniques: Vec<Technique>,
    /// Per technique, films without and with the weight.
    films: Vec<[Film; 2]>,
    non_finite: NonFinite,
}

impl<'a> Pyramid<'a> {
    fn new(scene: &'a Scene, settings: &'a Settings, edges: u32) -> Self {
        let techniques: Vec<Technique> = Techniques::of(scene).all(edges as usize).collect();
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

    fn add(&mut self, tiles: &[(Tile, &TilePaths)]) {
        for (tile, paths) in tiles {
            // Each sample counts for every technique, with or without light.
            for film in self.films.iter_mut().flatten() {
                for pixel in tile.pixels.clone() {
                    film.add_samples(pixel as usize, [0.0; 3], 1);
                }
            }
            for &(pixel, technique, both) in &paths.pixels {
                for (film, value) in self.films[technique].iter_mut().zip(both) {
                    film.add_samples(pixel as usize, value.as_dvec3().to_array(), 0);
                }
            }
            let pass = tile.pass;
            for &pixel in &paths.non_finite {
                self.non_finite.add(1, SampleId::Pixel { pass, pixel });
            }
        }
        for (technique, films) in self.films.iter_mut().enumerate() {
            let logs = tiles
                .iter()
                .filter_map(|(_, p)| p.light_images.get(technique));
            let logs: Vec<&[SplatLog; 2]> = logs.collect();
            for (which, film) in films.iter_mut().enumerate() {
                let logs = logs.iter().map(|both| &both[which]);
                let logs: Vec<_> = logs.filter(|log| !log.splats().is_empty()).collect();
                if !logs.is_empty() {
                    film.apply(&logs);
                }
            }
        }
    }

    fn finish(self, passes: &PassLoop<TilePaths>, clock: &Clock) -> Strategies {
        let samples = passes.samples();
        let splat_scale = 1.0 / samples.max(1) as f64;
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
            interrupted: clock.was_cancelled(samples),
            warnings: warnings::non_finite(&self.non_finite)
                .into_iter()
                .chain(warnings::unsampled(samples, pixel_count(self.scene)))
                .collect(),
            statistics: Statistics::new(
                self.scene,
                self.settings,
                [clock.elapsed(); 2],
                samples,
                passes.rays(),
                self.non_finite,
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_limited() {
        let techniques = Techniques::without_chains();
        assert!(check_memory(5, techniques, 1 << 20).is_ok());
        assert!(check_memory(u32::MAX, techniques, 1).is_err());
        let error = check_memory(10, techniques, 1 << 22)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("64 techniques at 4194304 pixels would take 37 GB"),
            "{error}"
        );
    }
}
