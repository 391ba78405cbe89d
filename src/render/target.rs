//! A path sampler as the target of Markov chains.

use crate::integrators::{PathSampler, SplatList, Workspace};
use crate::markov::Target;
use crate::sampling::Sampler;
use crate::scene::{RayCounts, Scene};

/// I(u) is the luminance of all splats of a sample (Kelemen et al. 2002, section 2).
pub struct SplatTarget<'a, P> {
    scene: &'a Scene,
    path_sampler: P,
    workspace: Workspace,
}

impl<'a, P> SplatTarget<'a, P> {
    /// The paths of `path_sampler` in `scene`.
    pub fn new(scene: &'a Scene, path_sampler: P) -> Self {
        Self {
            scene,
            path_sampler,
            workspace: Workspace::default(),
        }
    }

    /// Rays traced so far.
    pub fn rays(&self) -> RayCounts {
        self.workspace.rays
    }
}

impl<P: PathSampler> Target for SplatTarget<'_, P> {
    type Contribution = SplatList;

    #[inline]
    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut SplatList) -> f64 {
        self.path_sampler
            .sample_splats(self.scene, sampler, &mut self.workspace, out);
        out.luminance()
    }
}
