//! The chains of `mmlt` in a scene, without a fault or with a fault planted in the rendering code.

use super::budget;
use crate::diagnosis::equilibrium::equilibrium;
use crate::diagnosis::{Check, MmltChains, MmltSamples};
use crate::render::{MmltSettings, Unobserved};

/// Threshold of the clamp, in units of the importance map: so low that all path lengths and techniques have
/// a residual.
const THRESHOLD: f32 = 0.1;

/// All tests of a small run.
pub fn mmlt_checks(seed: u64) -> Vec<Check> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/plates.xml");
    let loaded = crate::mitsuba::load(&path, &[]).expect("a scene of the tests");
    let mut scene = loaded.description.build().expect("a scene of the tests");
    let settings = MmltSettings {
        threshold: Some(THRESHOLD),
        separate_direct: false,
        ..MmltSettings::default()
    };
    let samples = MmltSamples {
        independent: 1 << 17,
        renders: 32,
        passes: 1,
    };
    let chains = MmltChains::new(&mut scene, settings, seed, samples).expect("a residual");
    let found = equilibrium(&chains, &budget(seed, 1000, 15), &Unobserved);
    found.expect("a scene with light").checks
}

/// Null hypothesis: chains are correct. None of 3 runs may reject at 10^-3: the false-alarm rate is 0.003.
#[test]
fn chains_without_a_fault_pass() {
    for seed in 100..103 {
        let checks = mmlt_checks(seed);
        let names = [
            "sum to the path",
            "redistributed",
            "b of bootstrap",
            "Bowker, small step",
        ];
        for name in names {
            assert!(
                checks.iter().any(|check| check.name.contains(name)),
                "{name}"
            );
        }
        for check in checks {
            assert!(check.adjusted > 1e-3, "seed {seed}: {check:?}");
        }
    }
}
