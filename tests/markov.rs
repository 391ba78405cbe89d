//! Markov chains on targets of exactly known distribution, which detect a wrong kernel and wrong weights
//! without a renderer.
//!
//! Every statistical test has a fixed seed and rejects at p < 1e-4, the probability with which a correct
//! chain fails it for a new choice of seeds.

use metrolight::markov::{
    Bootstrap, BootstrapLimits, Chain, Mutations, Perturbation, Target, bootstrap,
    systematic_resample,
};
use metrolight::sampling::seeds::{self, Purpose};
use metrolight::sampling::{Dimension, Sampler, Stream};
use metrolight::statistics::{Moments, chi_square, normal_two_sided};
use rand::RngExt;

const ALPHA: f64 = 1e-4;

/// The dimensions of x and y, and of z.
const X: Dimension = Dimension::new(Stream::Camera, 0);
const Z: Dimension = Dimension::new(Stream::Light, 2);

/// Kelemen's mutations.
fn mutations(p_large: f32) -> Mutations {
    Mutations::kelemen(p_large, Perturbation::default())
}

/// A ridge along the diagonal of (x, y), periodic like the steps, that crosses the edges of the
/// square; for x < 1/2 the density also depends on a third coordinate z in another stream.
#[derive(Clone, Copy)]
struct Ridge;

/// x, y, and z if it was read.
#[derive(Clone, Copy, Default)]
struct Place {
    x: f32,
    y: f32,
    z: Option<f32>,
}

impl Ridge {
    /// Maximum of the density.
    const GREATEST: f64 = 1.05 * 2.0;

    fn xy(x: f64, y: f64) -> f64 {
        let d = (x - y).rem_euclid(1.0);
        let d = d.min(1.0 - d);
        0.05 + (-0.5 * (d / 0.03).powi(2)).exp()
    }

    fn z(z: f64) -> f64 {
        2.0 * z
    }
}

impl Target for Ridge {
    type Contribution = Place;

    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut Place) -> f64 {
        let [x, y] = sampler.get(X);
        *out = Place { x, y, z: None };
        let mut density = Self::xy(f64::from(x), f64::from(y));
        if x < 0.5 {
            let [z] = sampler.get(Z);
            out.z = Some(z);
            density *= Self::z(f64::from(z));
        }
        density
    }
}

const CELLS: usize = 10;

/// Cells of (x, y, z): 10 x 10, and for x < 1/2 four of z.
fn cell(place: &Place) -> usize {
    let index = |v: f32, n: usize| ((v * n as f32) as usize).min(n - 1);
    let xy = index(place.x, CELLS) * CELLS + index(place.y, CELLS);
    xy * 4 + place.z.map_or(0, |z| index(z, 4))
}

/// Probabilities of the cells under the normalised target, by the midpoint rule.
fn cell_probabilities() -> Vec<f64> {
    let n = 2000;
    let mut mass = vec![0.0; CELLS * CELLS * 4];
    for i in 0..n {
        for j in 0..n {
            let (x, y) = (
                (f64::from(i) + 0.5) / f64::from(n),
                (f64::from(j) + 0.5) / f64::from(n),
            );
            let density = Ridge::xy(x, y);
            let xy = (x * 10.0) as usize * CELLS + (y * 10.0) as usize;
            if x < 0.5 {
                // The integral of 2z over a quarter.
                for (k, part) in [1.0, 3.0, 5.0, 7.0].iter().enumerate() {
                    mass[xy * 4 + k] += density * part / 16.0;
                }
            } else {
                mass[xy * 4] += density;
            }
        }
    }
    let total: f64 = mass.iter().sum();
    mass.iter().map(|m| m / total).collect()
}

/// Chains that start exactly in equilibrium, by rejection sampling.
fn chains_in_equilibrium(count: usize, p_large: f32) -> Vec<Chain<Place>> {
    let mut accept = seeds::generator(99, Purpose::Resampling, 0);
    let mut candidate = 0;
    seeds::chain_generators(5, count)
        .into_iter()
        .map(|rng| {
            loop {
                candidate += 1;
                let mut start = bootstrap::sample(5, candidate);
                let density = Ridge.evaluate(&mut start, &mut Place::default());
                if accept.random::<f64>() * Ridge::GREATEST < density {
                    break Chain::start(&mut Ridge, start, rng, mutations(p_large));
                }
            }
        })
        .collect()
}

/// Null hypothesis: chains that start in the target distribution are still in it after n steps. One
/// state per chain, so the counts are multinomial.
#[test]
fn chains_that_start_in_equilibrium_stay_there() {
    let probabilities = cell_probabilities();
    for p_large in [0.0, 0.1, 0.5] {
        let mut chains = chains_in_equilibrium(20_000, p_large);
        let mut made = 0;
        for steps in [0, 1, 8, 64, 256] {
            let mut counts = vec![0u64; probabilities.len()];
            for chain in &mut chains {
                for _ in made..steps {
                    chain.step(&mut Ridge);
                }
                counts[cell(&chain.current().contribution)] += 1;
            }
            made = steps;
            let expected: Vec<f64> = probabilities
                .iter()
                .map(|p| p * chains.len() as f64)
                .collect();
            let p = chi_square(&counts, &expected);
            assert!(p > ALPHA, "p_large {p_large}, {steps} steps: p = {p:e}");
        }
    }
}

/// Weighted sums over a chain's samples, given b and the b_0 of the denominator.
fn estimate(chain: &mut Chain<Place>, steps: u64, p_large: f64, b: f64, b_0: f64) -> [f64; 3] {
    // The integrands: 1, x, and the indicator of a corner.
    let functions = |place: &Place| {
        let (x, y) = (f64::from(place.x), f64::from(place.y));
        [1.0, x, if x > 0.8 && y < 0.2 { 1.0 } else { 0.0 }]
    };
    let mut sums = [0.0; 3];
    let mut add = |density: f64, weight: f64, place: &Place| {
        let scale = weight / (density / b_0 + p_large) / steps as f64;
        for (sum, f) in sums.iter_mut().zip(functions(place)) {
            *sum += f * scale;
        }
    };
    for _ in 0..steps {
        let sample = chain.step(&mut Ridge).sample;
        add(
            sample.density,
            sample.weights.chain * b / b_0 + sample.weights.large,
            &sample.contribution,
        );
    }
    let weights = chain.take_weights();
    let current = chain.current();
    add(
        current.density,
        weights.chain * b / b_0 + weights.large,
        &current.contribution,
    );
    sums
}

/// Null hypothesis: over independent chains in equilibrium the mean of the weighted sums is the integral,
/// for any positive b_0 in the denominator.
#[test]
fn weights_integrate_without_bias_for_any_denominator() {
    let n = 2000;
    let b: f64 = (0..n)
        .map(|i| Ridge::xy((f64::from(i) + 0.5) / f64::from(n), 0.0))
        .sum::<f64>()
        / f64::from(n);
    let truth = [1.0, 0.5, 0.04];
    for (p_large, b_0) in [
        (0.3, b),
        (0.3, 3.0 * b),
        (0.05, 0.2 * b),
        (1.0, b),
        (0.0, b),
    ] {
        let mut moments = [Moments::default(); 3];
        for chain in &mut chains_in_equilibrium(4000, p_large) {
            let sums = estimate(chain, 50, f64::from(p_large), b, b_0);
            moments.iter_mut().zip(sums).for_each(|(m, sum)| m.add(sum));
        }
        for (i, (m, truth)) in moments.iter().zip(truth).enumerate() {
            let p = normal_two_sided((m.mean - truth) / m.standard_error());
            let (mean, error) = (m.mean, m.standard_error());
            assert!(
                p > ALPHA,
                "p_large {p_large}, b_0 {b_0}, f{i}: {mean} +- {error}, {truth}"
            );
        }
    }
}

/// A target that is 1 on a quarter of [0, 1), NaN on another, and 0 elsewhere.
struct Island;

impl Target for Island {
    type Contribution = f32;

    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut f32) -> f64 {
        let [x] = sampler.get(X);
        *out = x;
        match x {
            x if x < 0.25 => 1.0,
            x if x < 0.5 => f64::NAN,
            _ => 0.0,
        }
    }
}

#[test]
fn a_chain_never_accepts_zero_or_nonfinite_densities() {
    let start = (0..)
        .map(|i| bootstrap::sample(1, i))
        .find(|start| Island.evaluate(&mut start.clone(), &mut 0.0) == 1.0)
        .unwrap();
    let rng = seeds::chain_generators(1, 1).remove(0);
    let mut chain = Chain::start(&mut Island, start, rng, mutations(0.5));
    for _ in 0..10_000 {
        chain.step(&mut Island);
        assert!(chain.current().contribution < 0.25);
    }
    let counters = &chain.counters;
    assert!(
        counters.non_finite > 500,
        "a quarter of the large steps: {counters:?}"
    );
    assert_eq!(counters.steps(), 10_000);
    assert!(counters.longest_rejection_run >= 3);
    // b is a quarter, from large steps alone: 5 standard errors.
    let b = &counters.large_densities;
    assert!((b.mean - 0.25).abs() < 5.0 * b.standard_error(), "{b:?}");
}

#[test]
fn chains_with_the_same_start_have_independent_streams() {
    let start = bootstrap::sample(1, 0);
    let mut chains: Vec<_> = seeds::chain_generators(1, 2)
        .into_iter()
        .map(|rng| Chain::start(&mut Ridge, start, rng, mutations(1.0)))
        .collect();
    let begun: Vec<f32> = chains
        .iter()
        .map(|chain| chain.current().contribution.x)
        .collect();
    assert_eq!(begun[0], begun[1]);
    for _ in 0..100 {
        let proposals: Vec<f32> = chains
            .iter_mut()
            .map(|chain| chain.step(&mut Ridge).sample.contribution.x)
            .collect();
        // After an acceptance the sample is the common start.
        assert!(proposals[0] != proposals[1] || proposals[0] == begun[0]);
    }
}

fn run_bootstrap(limits: BootstrapLimits) -> Bootstrap {
    Bootstrap::run(3, limits, || Ridge, |_| (), |_| false)
}

#[test]
fn the_bootstrap_stops_when_b_is_known_and_does_not_depend_on_threads() {
    let limits = BootstrapLimits {
        at_least: 1000,
        at_most: 10_000_000,
        relative_error: 0.01,
    };
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let three = rayon::ThreadPoolBuilder::new()
        .num_threads(3)
        .build()
        .unwrap();
    let a = one.install(|| run_bootstrap(limits));
    let b = three.install(|| run_bootstrap(limits));
    assert_eq!(a.densities, b.densities);
    assert_eq!(a.moments, b.moments);
    let error = a.moments.standard_error() / a.moments.mean;
    assert!(
        error <= 0.01 && a.moments.count < 100_000,
        "{error} {}",
        a.moments.count
    );
    // Mean of the ridge: 0.05 + 0.03 sqrt(2 pi); z has mean 1.
    let truth = 0.05 + 0.03 * std::f64::consts::TAU.sqrt();
    assert!((a.moments.mean - truth).abs() < 5.0 * a.moments.standard_error());
    let at_most = BootstrapLimits {
        at_most: 777,
        ..limits
    };
    assert_eq!(run_bootstrap(at_most).moments.count, 777);
    // Sample i can be reproduced.
    let again = Ridge.evaluate(&mut a.sample(123), &mut Place::default());
    assert_eq!(again, a.densities[123]);
}

#[test]
fn resampling_is_proportional_and_never_chooses_zero_weights() {
    let weights = [0.0, 1.0, 0.0, 2.5, 0.5, 0.0];
    for u in [0.0, 0.3, 0.999_999] {
        let chosen = systematic_resample(&weights, 80, u);
        assert_eq!(chosen.len(), 80);
        for (i, weight) in weights.iter().enumerate() {
            let expected = weight / 4.0 * 80.0;
            let count = chosen.iter().filter(|&&c| c == i).count() as f64;
            assert!((count - expected).abs() < 1.0 && (*weight > 0.0 || count == 0.0));
        }
    }
    assert!(systematic_resample(&[0.0; 4], 10, 0.5).is_empty());
}
