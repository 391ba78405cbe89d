//! Discrete distributions: sampling agrees exactly with the returned probabilities.

use metrolight::sampling::{Distribution1D, Distribution2D};
use proptest::prelude::*;

use super::unit;

/// Number of multiples of 2^-24 in [0, 1), the values of random numbers.
const RESOLUTION: u32 = 1 << 24;

fn u(number: u32) -> f32 {
    number as f32 / RESOLUTION as f32
}

/// Weights that span 18 decimal orders of magnitude, some of them 0.
fn weights() -> impl Strategy<Value = Vec<f64>> {
    let weight = prop_oneof![
        1 => Just(0.0),
        4 => (-30.0..30.0_f64).prop_map(f64::exp2),
    ];
    prop::collection::vec(weight, 1..60)
}

/// Number of random numbers that choose each outcome, by [`Distribution1D::probability`].
fn counts_of(distribution: &Distribution1D) -> Vec<u32> {
    let counts = (0..distribution.len()).map(|i| {
        let count = distribution.probability(i) * RESOLUTION as f32;
        assert_eq!(count.fract(), 0.0);
        count as u32
    });
    counts.collect()
}

proptest! {
    /// Each outcome is chosen by consecutive random numbers, as many as its probability implies. Checking
    /// the first and the last of them suffices, since the inversion is monotone.
    #[test]
    fn outcomes_are_chosen_by_as_many_numbers_as_their_probability_implies(weights in weights()) {
        let total: f64 = weights.iter().sum();
        let Some(distribution) = Distribution1D::new(weights.iter().copied()) else {
            prop_assert_eq!(total, 0.0);
            return Ok(());
        };
        prop_assert_eq!(distribution.len(), weights.len());
        prop_assert_eq!(distribution.total(), total);
        let possible = weights.iter().filter(|w| **w > 0.0).count() as f64;
        let mut first = 0;
        for (i, (count, weight)) in counts_of(&distribution).into_iter().zip(&weights).enumerate() {
            prop_assert_eq!(count > 0, *weight > 0.0);
            if count > 0 {
                prop_assert_eq!(distribution.sample(u(first)).0, i);
                prop_assert_eq!(distribution.sample(u(first + count - 1)).0, i);
                let expected = 1.0 + weight / total * (f64::from(RESOLUTION) - possible);
                prop_assert!((f64::from(count) - expected).abs() < 1.001, "{count} {expected}");
            }
            first += count;
        }
        prop_assert_eq!(first, RESOLUTION);
    }

    /// The rescaled numbers of the k random numbers of an outcome are the midpoints of k equal parts.
    #[test]
    fn rescaled_numbers_are_uniform(weights in weights(), number in 0..RESOLUTION) {
        let Some(distribution) = Distribution1D::new(weights) else {
            return Ok(());
        };
        let (i, within) = distribution.sample(u(number));
        let counts = counts_of(&distribution);
        let first: u32 = counts[..i].iter().sum();
        let expected = (f64::from(number - first) + 0.5) / f64::from(counts[i]);
        prop_assert!((0.0..1.0).contains(&within));
        prop_assert!((f64::from(within) - expected).abs() < 1e-7);
    }

    /// A small-step mutation may produce a number between two multiples of 2^-24: it chooses the same
    /// outcome as the multiple below it.
    #[test]
    fn numbers_between_multiples_choose_the_same_outcome(
        weights in weights(),
        number in 0..RESOLUTION / 2,
        between in 0.0f32..1.0,
    ) {
        let Some(distribution) = Distribution1D::new(weights) else {
            return Ok(());
        };
        let above = ((number as f32 + between) / RESOLUTION as f32).min(u(number + 1).next_down());
        prop_assert_eq!(distribution.sample(above), distribution.sample(u(number)));
    }

    /// The probability of a cell is proportional to its weight and positive unless that is 0; the sum is 1.
    #[test]
    fn cells_are_chosen_with_their_probability(
        weights in weights(),
        width in 1_usize..7,
        point in [unit(), unit()],
    ) {
        let weights = &weights[..weights.len() - weights.len() % width];
        let total: f64 = weights.iter().sum();
        let Some(grid) = Distribution2D::new(weights, width) else {
            prop_assert!(total == 0.0);
            return Ok(());
        };
        let mut sum = 0.0;
        for (i, weight) in weights.iter().enumerate() {
            let probability = grid.probability(i % width, i / width);
            prop_assert_eq!(probability > 0.0, *weight > 0.0);
            prop_assert!((f64::from(probability) - weight / total).abs() < 1e-5);
            sum += f64::from(probability);
        }
        prop_assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        let cell = grid.sample(point);
        prop_assert!(grid.probability(cell.column, cell.row) > 0.0);
        prop_assert!(cell.within.iter().all(|x| (0.0..1.0).contains(x)));
    }
}

/// Counts every random number, for weights of which many are below the resolution.
#[test]
fn probabilities_are_exact() {
    let weights = (0..3000).map(|i| match i % 4 {
        0 => 0.0,
        1 => 0.3 / f64::from(RESOLUTION),
        2 => 2.7 / f64::from(RESOLUTION),
        _ => f64::from(i) * f64::from(i),
    });
    let distribution = Distribution1D::new(weights).expect("a distribution");
    let mut counts = vec![0; distribution.len()];
    for number in 0..RESOLUTION {
        counts[distribution.sample(u(number)).0] += 1;
    }
    assert_eq!(counts, counts_of(&distribution));
}

/// The maximum number of outcomes have one random number each; one outcome more is an error.
#[test]
fn the_number_of_outcomes_is_limited() {
    let even = |n: u32| Distribution1D::new((0..n).map(|_| 0.1));
    let full = even(RESOLUTION).expect("a distribution");
    for number in (0..RESOLUTION).step_by(1009) {
        assert_eq!(full.sample(u(number)).0, number as usize);
        assert_eq!(full.probability(number as usize), u(1));
    }
    assert!(even(RESOLUTION + 1).is_none());
}
