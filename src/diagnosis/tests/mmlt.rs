//! The chains of `mmlt` in a scene: without a fault, and for faults planted in the code that renders.

use super::budget;
use crate::diagnosis::equilibrium::equilibrium;
use crate::diagnosis::{Check, MmltChains, MmltSamples};
use crate::render::{MmltSettings, Unobserved};

/// Light of the scene above this luminance, in units of the importance map, is left to chains: so low that
/// all lengths and techniques have a residual.
const THRESHOLD: f32 = 0.1;

/// All tests of a small run.
pub fn mmlt_checks(seed: u64) -> Vec<Check> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/plates.xml");
    let loaded = crate::mitsuba::load(&path, &[]).expect("a scene of the tests");
    let mut scene = loaded.description.build().expect("a scene of the tests");
    let own = MmltSettings {
        threshold: Some(THRESHOLD),
        separate_direct: false,
        ..MmltSettings::default()
    };
    let samples = MmltSamples {
        independent: 1 << 17,
        renders: 32,
        passes: 1,
    };
    let chains = MmltChains::new(&mut scene, own, seed, samples).expect("a residual");
    let found = equilibrium(&chains, &budget(seed, 1000, 15), &Unobserved);
    found.expect("a scene with light").checks
}

/// Null hypothesis: nothing is wrong. 3 runs, none of which may reject at 10^-3: false alarms have the
/// probability 0.003.
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
