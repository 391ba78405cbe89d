//! The choice, by pilots, of where technique 1* is used in a scene.

use super::in_pool;
use super::plan::{Clamp, MmltSettings, Pilot};
use crate::scene::{ChainSearch, Scene};

/// Samples of each pilot.
const SAMPLES: u64 = 1 << 13;

/// Chains are sought from every vertex if the expected ratio of errors exceeds this.
const MIN_GAIN: f64 = 1.0;

/// Where technique 1* is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecularChoice {
    /// [`ChainSearch::Unconnected`] or [`ChainSearch::Everywhere`].
    pub search: ChainSearch,
    /// Expected error with technique 1* where no other technique connects, over that with it everywhere, at equal
    /// time.
    pub gain: f64,
}

/// Chooses whether bidirectional methods seek chains from every vertex of `scene`, by the expected error of each way
/// at equal time, and sets it in the scene. `None` if no chain can be sought there. The choice depends on the scene
/// alone.
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
    let gain = in_pool(threads, || {
        let [some, all] = [ChainSearch::Unconnected, ChainSearch::Everywhere].map(|search| {
            scene.casters.set_search(search);
            let pilot = Pilot::run(scene, 0, SAMPLES, || false);
            let size = [scene.film.width, scene.film.height];
            Clamp::new(size, &pilot, &MmltSettings::default()).score
        });
        (some / all).powi(2)
    })?;
    let search = if gain > MIN_GAIN {
        ChainSearch::Everywhere
    } else {
        ChainSearch::Unconnected
    };
    scene.casters.set_search(search);
    Ok(Some(SpecularChoice { search, gain }))
}
