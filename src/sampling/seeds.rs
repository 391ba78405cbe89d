//! Keys and generators for independent streams of random numbers.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::fault::{Fault, planted};

/// The purpose of random numbers. Different purposes share no numbers.
#[derive(Clone, Copy, Debug)]
pub enum Purpose {
    /// Samples of the pixels of an image, pass after pass.
    Pixels,
    /// Uniform samples of a bootstrap or a pilot.
    Bootstrap,
    /// The choice of samples that chains start from.
    Resampling,
    /// Rays that search for light that no path sampler can find.
    Probes,
    /// The chains: one sequence, in which each chain jumps ahead of the previous one.
    Chains,
    /// Random choices of statistical tests.
    Tests,
    /// Chains that start from the residual of a block of independent samples.
    Redistribution,
}

/// Finaliser of SplitMix64 (Steele et al. 2014, "Fast splittable pseudorandom number generators"):
/// a bijection whose every output bit depends on every input bit.
#[inline]
pub(super) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A key for item `index` of a purpose, under the user's seed.
#[inline]
pub(super) fn key(seed: u64, purpose: Purpose, index: u64) -> u64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let key = mix(seed.wrapping_add(GOLDEN)) ^ (purpose as u64 + 1).wrapping_mul(GOLDEN);
    mix(mix(key).wrapping_add(index.wrapping_mul(GOLDEN)))
}

/// The generator for item `index` of a purpose, under the user's seed.
pub fn generator(seed: u64, purpose: Purpose, index: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(key(seed, purpose, index))
}

/// The seed of part `index` of an experiment under `seed`. The parts are independent of each other and of
/// a render under that seed.
pub fn part(seed: u64, index: u64) -> u64 {
    mix(mix(seed).wrapping_add(mix(index.wrapping_add(1))))
}

/// The generator of one chain: an element of [`chain_generators`].
pub fn chain_generator(seed: u64, chain: u64) -> Xoshiro256PlusPlus {
    let mut generator = generator(seed, Purpose::Chains, 0);
    for _ in 0..chain {
        generator.jump();
    }
    generator
}

/// One generator per chain, 2^128 numbers apart in a single sequence.
pub fn chain_generators(seed: u64, chains: usize) -> Vec<Xoshiro256PlusPlus> {
    let mut generator = generator(seed, Purpose::Chains, 0);
    let mut streams = Vec::with_capacity(chains);
    for _ in 0..chains {
        streams.push(generator.clone());
        generator.jump();
    }
    if planted(Fault::SharedNumbers) {
        for pair in streams.chunks_exact_mut(2) {
            pair[1] = pair[0].clone();
        }
    }
    streams
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn streams_differ_by_seed_purpose_index_and_chain() {
        let mut first = std::collections::HashSet::new();
        for seed in [0, 1, u64::MAX] {
            for purpose in [Purpose::Pixels, Purpose::Bootstrap, Purpose::Resampling] {
                for index in 0..100 {
                    assert!(first.insert(generator(seed, purpose, index).next_u64()));
                }
            }
            for (i, mut chain) in (0..).zip(chain_generators(seed, 100)) {
                assert_eq!(chain, chain_generator(seed, i));
                assert!(first.insert(chain.next_u64()));
            }
        }
    }
}
