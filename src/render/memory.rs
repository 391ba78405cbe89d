//! Memory that a render needs besides its scene.

use super::{Integrator, PssmltSettings, Settings};

/// Bytes of a pixel in the sums of camera samples: three sums in f64, and a number.
const SAMPLES: u64 = 4 * 8;

/// Bytes of a pixel in the sums of splats.
const SPLATS: u64 = 3 * 8;

/// Bytes of a pixel in an image, and in the copies of it that encoders make.
const IMAGE: u64 = 4 * 3 * 4;

/// Bytes of a pixel for the variance of passes, and for standard errors.
const VARIANCE: u64 = 7 * 8 + 2 * IMAGE;

/// Bytes of a Markov chain: the coordinates of its state and of its proposal, and their splats.
const CHAIN: u64 = 8 << 10;

/// Bytes of a bootstrap sample.
const BOOTSTRAP: u64 = 8;

/// Maximum number of groups of chains, each with a film of its own, from which errors are estimated.
const GROUPS: u64 = 16;

/// Memory of a render in bytes, by its purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Sums over all samples, and the image.
    pub film: u64,
    /// Standard errors.
    pub errors: u64,
    /// Markov chains and the bootstrap.
    pub chains: u64,
}

impl Memory {
    /// The memory of a render of `pixels` pixels.
    pub fn of(settings: &Settings, pixels: u64) -> Self {
        let (film, groups, chains) = match &settings.integrator {
            Integrator::Path | Integrator::Light | Integrator::Bdpt => (SAMPLES + SPLATS, 0, 0),
            // Splats of the chains, in all passes and in the current one.
            Integrator::Mmlt(_) => (SAMPLES + 3 * SPLATS, 0, 0),
            Integrator::Pssmlt(own) => {
                let PssmltSettings {
                    chains, bootstrap, ..
                } = own;
                let samples = bootstrap.unwrap_or(0);
                let chain_bytes = chains.saturating_mul(CHAIN);
                let bytes = chain_bytes.saturating_add(samples.saturating_mul(BOOTSTRAP));
                (2 * SPLATS, GROUPS.min(*chains) * SPLATS, bytes)
            }
        };
        let errors = match settings.wants_error() {
            true => VARIANCE + groups,
            false => 0,
        };
        Self {
            film: pixels.saturating_mul(film + IMAGE),
            errors: pixels.saturating_mul(errors),
            chains,
        }
    }

    /// The sum.
    pub fn total(&self) -> u64 {
        let sum = self.film.saturating_add(self.errors);
        sum.saturating_add(self.chains)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Method;

    #[test]
    fn films_errors_and_chains_are_counted() {
        let bdpt = Settings::new(Method::Bdpt);
        let plain = Memory::of(&bdpt, 1 << 28);
        assert!(plain.total() > 20 << 30 && plain.errors == 0 && plain.chains == 0);
        let with_error = Settings {
            error: true,
            ..bdpt
        };
        assert!(Memory::of(&with_error, 1 << 28).total() > plain.total());
        let many = PssmltSettings {
            chains: 1 << 20,
            bootstrap: Some(1 << 30),
            ..PssmltSettings::default()
        };
        let many = Memory::of(&Settings::of(Integrator::Pssmlt(many)), 1);
        assert_eq!(many.chains, (8 << 30) + (8 << 30));
        assert_eq!(Memory::of(&with_error, u64::MAX).total(), u64::MAX);
    }
}
