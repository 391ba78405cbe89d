//! The chains of primary sample space Metropolis in a scene.

use super::observation::{ChainTarget, IndependentEstimate, Observation, TILES};
use super::paths::{Brightest, ObservedSampler, light_of_tiles, set_film, tile};
use crate::integrators::{BidirectionalPathTracer, PathSampler, SplatList, Workspace};
use crate::markov::{Mutations, Target};
use crate::math::luminance;
use crate::render::{Budget, Method, PssmltSettings, Settings, Unobserved, render};
use crate::sampling::Sampler;
use crate::scene::Scene;

/// Samples per pixel of the independent estimate.
const INDEPENDENT_SPP: u64 = 512;

/// The chains of `pssmlt`.
pub struct PssmltChains<'a> {
    scene: &'a Scene,
    settings: PssmltSettings,
    threads: Option<usize>,
}

impl<'a> PssmltChains<'a> {
    /// The chains of a render of `scene`, whose film is replaced by a small one with a box filter. The
    /// independent estimate is rendered on `threads` threads (`None` for one per core).
    pub fn new(scene: &'a mut Scene, settings: PssmltSettings, threads: Option<usize>) -> Self {
        set_film(scene);
        Self {
            scene,
            settings,
            threads,
        }
    }
}

impl ChainTarget for PssmltChains<'_> {
    type Target<'t>
        = ObservedPaths<'t>
    where
        Self: 't;

    fn target(&self) -> ObservedPaths<'_> {
        ObservedPaths {
            scene: self.scene,
            workspace: Workspace::default(),
            splats: SplatList::default(),
        }
    }

    fn mutations(&self) -> Mutations {
        Mutations::kelemen(
            self.settings.large_step_probability,
            self.settings.small_step,
        )
    }

    /// The estimate of a render by `bdpt`, which shares only the path sampler with the chains. It has no
    /// samples if the threads of the render cannot be started.
    fn independent(&self, seed: u64) -> IndependentEstimate {
        let settings = Settings {
            budget: Budget::SamplesPerPixel(INDEPENDENT_SPP),
            seed,
            threads: self.threads,
            ..Settings::new(Method::Bdpt)
        };
        match render(self.scene, &settings, &Unobserved) {
            Ok(rendering) => IndependentEstimate {
                samples: rendering.statistics.samples,
                tiles: light_of_tiles(&rendering.image.pixels),
            },
            Err(_) => IndependentEstimate {
                samples: 0,
                tiles: vec![0.0; TILES * TILES],
            },
        }
    }
}

/// The target of `pssmlt`, with the observed quantities.
pub struct ObservedPaths<'a> {
    scene: &'a Scene,
    workspace: Workspace,
    splats: SplatList,
}

impl Target for ObservedPaths<'_> {
    type Contribution = Observation;

    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut Observation) -> f64 {
        let mut observed = ObservedSampler::new(sampler);
        let mut brightest = Brightest::new();
        let Self {
            scene,
            workspace,
            splats,
        } = self;
        splats.clear();
        BidirectionalPathTracer.sample_paths(scene, &mut observed, workspace, |path| {
            splats.add(path.technique, path.splat());
            brightest.add(path.technique, path.splat());
        });
        brightest.observe(&observed, out);
        for splat in splats.iter() {
            out.add(tile(splat.position), f64::from(luminance(splat.value)));
        }
        splats.luminance()
    }
}
