//! Small steps, resampling and streams of random numbers.

use metrolight::markov::mutation::perturbation::wrap;
use metrolight::markov::{Perturbation, systematic_resample};
use metrolight::sampling::seeds::{self, Purpose};
use proptest::prelude::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::unit;

/// Any number in [0, 1), not only multiples of 2^-24.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        unit(),
        0.0f32..1.0,
        (-140.0..-1.0f32).prop_map(f32::exp2),
        Just(f32::from_bits(1)),
        Just(1.0f32.next_down()),
    ]
}

fn purpose() -> impl Strategy<Value = Purpose> {
    prop_oneof![
        Just(Purpose::Pixels),
        Just(Purpose::Bootstrap),
        Just(Purpose::Resampling),
        Just(Purpose::Probes),
        Just(Purpose::Chains),
    ]
}

proptest! {
    #[test]
    fn wrapping_goes_round_the_circle(value in coordinate(), step in -1.0f32..1.0) {
        let wrapped = wrap(value + step);
        prop_assert!((0.0..1.0).contains(&wrapped), "{wrapped}");
        let turns = f64::from(wrapped) - f64::from(value) - f64::from(step);
        prop_assert!((turns - turns.round()).abs() < 2e-7);
    }

    /// A small step stays in [0, 1) and has a length within its limits, measured around the circle.
    #[test]
    fn small_steps_keep_to_the_circle_and_their_length(
        value in coordinate(),
        longest in (-14.0..-1.0f32).prop_map(f32::exp2),
        ratio in 0.001f32..1.0,
        seed in any::<u64>(),
    ) {
        let shortest = longest * ratio;
        let step = Perturbation::new(shortest, longest);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        for _ in 0..16 {
            let moved = step.apply(value, &mut rng);
            prop_assert!((0.0..1.0).contains(&moved), "{moved}");
            let difference = (f64::from(moved) - f64::from(value)).abs();
            let length = difference.min(1.0 - difference);
            let rounding = 1.2e-7 + 1e-5 * f64::from(longest);
            prop_assert!(length >= f64::from(shortest) - rounding, "{length}");
            prop_assert!(length <= f64::from(longest) + rounding, "{length}");
        }
    }

    /// Normal steps and redraws stay in [0, 1); a redraw with probability 0 changes nothing.
    #[test]
    fn other_steps_keep_to_the_circle(
        value in coordinate(),
        deviation in 1e-6f32..0.5,
        probability in 0.0f32..1.0,
        seed in any::<u64>(),
    ) {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let gaussian = Perturbation::Gaussian { deviation };
        let redraw = Perturbation::Redraw { probability };
        for _ in 0..16 {
            for step in [gaussian, redraw] {
                let moved = step.apply(value, &mut rng);
                prop_assert!((0.0..1.0).contains(&moved), "{step}: {moved}");
            }
        }
        let never = Perturbation::Redraw { probability: 0.0 };
        prop_assert_eq!(never.apply(value, &mut rng), value);
    }

    /// Index i is chosen n w_i / sum(w) times, up to a difference of one, in order, and never if w_i = 0.
    #[test]
    fn systematic_resampling_is_proportional(
        weights in prop::collection::vec(prop_oneof![Just(0.0), 1e-6..1e3], 1..50),
        n in 1_usize..300,
        u in 0.0..1.0f64,
    ) {
        let total: f64 = weights.iter().sum();
        let chosen = systematic_resample(&weights, n, u);
        if total == 0.0 {
            prop_assert!(chosen.is_empty());
            return Ok(());
        }
        prop_assert_eq!(chosen.len(), n);
        prop_assert!(chosen.is_sorted());
        for (i, &weight) in weights.iter().enumerate() {
            let count = chosen.iter().filter(|&&c| c == i).count() as f64;
            let expected = weight / total * n as f64;
            prop_assert!((count - expected).abs() < 1.0 + 1e-9, "{i}: {count} {expected}");
            prop_assert!(weight > 0.0 || count == 0.0);
        }
    }

    /// Streams that differ in seed, purpose or index share no number; equal ones are equal.
    #[test]
    fn streams_are_independent(
        a in (0_u64..3, purpose(), 0_u64..3),
        b in (0_u64..3, purpose(), 0_u64..3),
    ) {
        let numbers = |(seed, purpose, index): (u64, Purpose, u64)| {
            let mut stream = seeds::generator(seed, purpose, index);
            (0..8).map(|_| stream.next_u64()).collect::<Vec<_>>()
        };
        let same = (a.0, a.1 as u8, a.2) == (b.0, b.1 as u8, b.2);
        let shared = numbers(a).iter().filter(|n| numbers(b).contains(n)).count();
        prop_assert_eq!(shared, if same { 8 } else { 0 });
    }

    /// The streams of chains do not depend on the number of chains.
    #[test]
    fn streams_of_chains_do_not_depend_on_their_number(
        seed in any::<u64>(),
        few in 1_usize..20,
        more in 0_usize..20,
    ) {
        let first = |n: usize| -> Vec<u64> {
            let chains = seeds::chain_generators(seed, n);
            chains.into_iter().map(|mut chain| chain.random()).collect()
        };
        prop_assert_eq!(&first(few)[..], &first(few + more)[..few]);
    }
}
