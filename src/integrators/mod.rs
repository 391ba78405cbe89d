//! Path samplers: maps from a point of the unit hypercube to splats on the film. They do not depend on how
//! the point is chosen; the drivers in `render` combine them with independent samples or Markov chains.
//!
//! ```
//! use metrolight::integrators::{BidirectionalPathTracer, PathSampler, SplatList, Workspace};
//! use metrolight::sampling::IndependentSampler;
//! use metrolight::sampling::seeds::Purpose;
//!
//! # let size = metrolight::mitsuba::Overrides { size: Some([16, 12]) };
//! # let path = std::path::Path::new("scenes/cornell/scene.xml");
//! # let scene = metrolight::mitsuba::load_with(path, &[], size)?.description.build()?;
//! let (mut workspace, mut splats) = (Workspace::default(), SplatList::default());
//! let mut mean = 0.0;
//! for i in 0..1000 {
//!     let mut sampler = IndependentSampler::new(0, Purpose::Pixels, i);
//!     BidirectionalPathTracer.sample_splats(&scene, &mut sampler, &mut workspace, &mut splats);
//!     mean += splats.luminance() / 1000.0;
//! }
//! assert!(mean > 0.1 && mean < 1.0, "mean luminance of the image: {mean}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bdpt;
mod camera_paths;
pub mod light;
pub mod path;
pub mod single;
pub mod splat_list;

#[cfg(test)]
mod tests;

pub use bdpt::BidirectionalPathTracer;
pub use light::LightTracer;
pub use path::PathTracer;
pub use single::SingleTechnique;
pub use splat_list::SplatList;

use crate::path::Subpath;
use crate::sampling::Sampler;
use crate::scene::specular::Candidate;
use crate::scene::{RayCounts, Scene};
use crate::technique::{PathContribution, TechniqueSet};

/// A map from a point of the unit hypercube to splats (`PathSampler` of Mitsuba 0.6). Every light transport
/// method here consists of a path sampler and a rule that chooses the points.
pub trait PathSampler: Sync {
    /// Samples the paths of the point `sampler`, and calls `visit` for each that carries light. The film is
    /// the unit square: the mean of the contributions over all points is an integral over that square.
    fn sample_paths<S: Sampler>(
        &self,
        scene: &Scene,
        sampler: &mut S,
        workspace: &mut Workspace,
        visit: impl FnMut(PathContribution),
    );

    /// Samples the same paths and replaces the content of `splats` by theirs.
    #[inline]
    fn sample_splats<S: Sampler>(
        &self,
        scene: &Scene,
        sampler: &mut S,
        workspace: &mut Workspace,
        splats: &mut SplatList,
    ) {
        splats.clear();
        self.sample_paths(scene, sampler, workspace, |path| {
            splats.add(path.technique, path.splat());
        });
    }
}

/// The path sampler that combines these techniques.
impl PathSampler for TechniqueSet {
    #[inline]
    fn sample_paths<S: Sampler>(
        &self,
        scene: &Scene,
        sampler: &mut S,
        workspace: &mut Workspace,
        visit: impl FnMut(PathContribution),
    ) {
        match self {
            Self::Path => PathTracer.sample_paths(scene, sampler, workspace, visit),
            Self::Light => LightTracer.sample_paths(scene, sampler, workspace, visit),
            Self::Bidirectional => {
                BidirectionalPathTracer.sample_paths(scene, sampler, workspace, visit);
            }
        }
    }
}

/// Initial capacity of the memory for specular chains.
const CANDIDATES: usize = 64;

/// Memory that a path sampler reuses for every sample, and its ray counts.
#[derive(Debug)]
pub struct Workspace {
    /// The last camera subpath.
    pub camera: Subpath,
    /// The last light subpath.
    pub light: Subpath,
    /// Memory for the specular chains of a vertex.
    pub candidates: Vec<Candidate>,
    /// Rays traced so far.
    pub rays: RayCounts,
}

impl Default for Workspace {
    fn default() -> Self {
        Self {
            camera: Subpath::default(),
            light: Subpath::default(),
            candidates: Vec::with_capacity(CANDIDATES),
            rays: RayCounts::default(),
        }
    }
}

/// Maximum number of edges of a path, or an effectively unreachable bound if unlimited: Russian roulette
/// ends every subpath long before.
fn max_edges(scene: &Scene) -> usize {
    scene
        .depth
        .max_depth
        .map_or(usize::MAX / 4, |depth| depth as usize)
}
