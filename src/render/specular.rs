//! The choice, by pilots, of where technique 1* is used in a scene.
//!
//! Let S be the share of the image's light that technique 1* samples from every vertex, less the share that it
//! samples where no other technique connects, and c the cost of a sample the first way over that the second way.
//! Where 1* is left out, the light S comes by connections of vertices that may be close to each other, whose
//! contributions have no bound, and by hits of the lamp. Few of these are bright, so the second moment of a pilot
//! tells little. Measured at equal time (25 s at 128 x 128 pixels), 1* everywhere reduces the error where S / (c - 1)
//! is large: `pool` (0.1), `torus-in-glass` (0.05); and increases it where it is small: `lost-caustic` (0.02), `lens`
//! (0.01), `spheres` (0.006), `bidir` (0.0003).

use super::in_pool;
use super::plan::Pilot;
use crate::math::luminance;
use crate::scene::{ChainSearch, Scene};
use crate::technique::Technique;

/// Samples of each pilot.
const SAMPLES: u64 = 1 << 13;

/// Chains are sought from every vertex if S / (c - 1) exceeds this.
const MIN_SHARE_PER_COST: f64 = 0.03;

/// Upper bound on the luminance of a path in S, relative to the mean of a sample, so that no single path decides.
const MAX_LUMINANCE: f64 = 50.0;

/// Where technique 1* is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecularChoice {
    /// [`ChainSearch::Unconnected`] or [`ChainSearch::Everywhere`].
    pub search: ChainSearch,
    /// S.
    pub share: f64,
    /// c.
    pub cost: f64,
}

/// Chooses whether bidirectional methods seek chains from every vertex of `scene`, and sets it in the scene. `None` if
/// no chain can be sought there. The choice depends on the scene alone.
///
/// # Errors
/// If the threads cannot be started.
pub fn choose_specular(
    scene: &mut Scene,
    threads: Option<usize>,
) -> Result<Option<SpecularChoice>, rayon::ThreadPoolBuildError> {
    if !scene.has_chains() {
        return Ok(None);
    }
    let [some, all] = in_pool(threads, || {
        [ChainSearch::Unconnected, ChainSearch::Everywhere].map(|search| {
            scene.casters.set_search(search);
            let pilot = Pilot::run(scene, 0, SAMPLES, || false);
            (specular_share(&pilot), pilot.cost)
        })
    })?;
    let (share, cost) = (all.0 - some.0, all.1 / some.1);
    let search = if share > MIN_SHARE_PER_COST * (cost - 1.0) {
        ChainSearch::Everywhere
    } else {
        ChainSearch::Unconnected
    };
    scene.casters.set_search(search);
    Ok(Some(SpecularChoice {
        search,
        share,
        cost,
    }))
}

/// The share of the light that technique 1* samples.
fn specular_share(pilot: &Pilot) -> f64 {
    let all = || {
        let found = pilot.found.iter();
        found.map(|found| (found.technique, f64::from(luminance(found.splat.value))))
    };
    let mean = all().map(|(_, l)| l).sum::<f64>() / pilot.samples.max(1) as f64;
    let bounded = |l: f64| l.min(MAX_LUMINANCE * mean);
    let total: f64 = all().map(|(_, l)| bounded(l)).sum();
    let of_chains = all().filter(|(technique, _)| matches!(technique, Technique::Specular { .. }));
    let light: f64 = of_chains.map(|(_, l)| bounded(l)).sum();
    if total > 0.0 { light / total } else { 0.0 }
}
