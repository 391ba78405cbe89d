//! Tests of warps and distributions. The statistical ones use fixed seeds; each p-value is tested at
//! 1e-4, which is then the rate of false alarms over seeds.

use glam::{Vec2, Vec3A};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::color::is_light;
use super::warp::{
    cosine_hemisphere_pdf, square_to_cosine_hemisphere, square_to_disk, square_to_sphere,
    square_to_triangle,
};
use super::{Coordinates, Distribution1D, Distribution2D, FreshCoordinates, Stream, luminance};
use crate::statistics::chi_square;

fn fresh(seed: u64) -> FreshCoordinates {
    FreshCoordinates::new(Xoshiro256PlusPlus::seed_from_u64(seed))
}

/// Null hypothesis: `warp`, followed by a map that should make it uniform again on the unit square,
/// is uniform.
fn check_uniform(name: &str, warp: impl Fn(Vec2) -> Vec2) {
    const SIDE: usize = 20;
    let samples = 100_000;
    let mut numbers = fresh(17);
    let mut observed = vec![0; SIDE * SIDE];
    for _ in 0..samples {
        let p = warp(Vec2::from_array(numbers.read(Stream::Camera, 0)));
        let [i, j] = p.to_array().map(|x| {
            assert!((-1e-5..1.0 + 1e-5).contains(&x), "{name}: {p}");
            ((x * SIDE as f32) as usize).min(SIDE - 1)
        });
        observed[i * SIDE + j] += 1;
    }
    let expected = vec![f64::from(samples) / observed.len() as f64; observed.len()];
    let p = chi_square(&observed, &expected);
    assert!(p > 1e-4, "{name}: p = {p}");
}

fn turns(v: Vec2) -> f32 {
    let phi = v.y.atan2(v.x) / std::f32::consts::TAU;
    phi - phi.floor()
}

#[test]
fn warps_have_their_densities() {
    check_uniform("fresh numbers", |u| u);
    check_uniform("disk", |u| {
        let d = square_to_disk(u);
        Vec2::new(d.length_squared(), turns(d))
    });
    // Density cos/pi: cos^2 is uniform.
    check_uniform("cosine hemisphere", |u| {
        let d = square_to_cosine_hemisphere(u);
        Vec2::new(d.z * d.z, turns(Vec2::new(d.x, d.y)))
    });
    check_uniform("sphere", |u| {
        let d = square_to_sphere(u);
        Vec2::new(0.5 * (d.z + 1.0), turns(Vec2::new(d.x, d.y)))
    });
    // The share of the triangle beyond b1, and the place on the line of equal b1.
    check_uniform("triangle", |u| {
        let b = square_to_triangle(u);
        Vec2::new((1.0 - b.x) * (1.0 - b.x), b.y / (1.0 - b.x).max(1e-9))
    });
}

proptest! {
    #[test]
    fn warps_stay_in_their_domains(x in 0.0f32..1.0, y in 0.0f32..1.0) {
        let u = Vec2::new(x, y);
        prop_assert!(square_to_disk(u).length() <= 1.0 + 1e-6);
        prop_assert!((square_to_sphere(u).length() - 1.0).abs() < 1e-5);
        let d = square_to_cosine_hemisphere(u);
        prop_assert!((d.length() - 1.0).abs() < 1e-5 && d.z > 0.0);
        prop_assert!(cosine_hemisphere_pdf(d.z) > 0.0);
        prop_assert_eq!(cosine_hemisphere_pdf(-d.z), 0.0);
        let b = square_to_triangle(u);
        prop_assert!(b.min_element() >= 0.0 && b.x + b.y <= 1.0 + 1e-6);
    }

    /// Of any weights: positive ones get a positive probability, 0 gets 0, the sum is 1, larger
    /// numbers choose later outcomes, and the outcome is the one whose share holds the number.
    #[test]
    fn distributions_follow_their_weights(
        exponents in prop::collection::vec(-30.0f64..30.0, 1..40),
        zeros in prop::collection::vec(any::<bool>(), 40),
        u in 0.0f32..1.0, v in 0.0f32..1.0,
    ) {
        let weights: Vec<f64> = exponents
            .iter()
            .zip(&zeros)
            .map(|(e, zero)| if *zero { 0.0 } else { e.exp2() })
            .collect();
        let total: f64 = weights.iter().sum();
        let Some(distribution) = Distribution1D::new(weights.iter().copied()) else {
            prop_assert_eq!(total, 0.0);
            return Ok(());
        };
        prop_assert_eq!(distribution.len(), weights.len());
        let probabilities: Vec<f32> =
            (0..weights.len()).map(|i| distribution.probability(i)).collect();
        prop_assert!((probabilities.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        for (p, w) in probabilities.iter().zip(&weights) {
            prop_assert_eq!(*p > 0.0, *w > 0.0);
            prop_assert!((f64::from(*p) - w / total).abs() < 4e-6);
        }
        let (i, rest) = distribution.sample(u);
        let (j, _) = distribution.sample(v);
        prop_assert!(weights[i] > 0.0);
        prop_assert!((0.0..1.0).contains(&rest));
        prop_assert_eq!(u <= v, i < j || (i == j && u <= v));
        let below: f32 = probabilities[..i].iter().sum();
        prop_assert!(below - 1e-5 <= u && u < below + probabilities[i] + 1e-5);
    }
}

/// Thousands of outcomes that are next to nothing beside two great ones: none may be lost.
#[test]
fn faint_outcomes_keep_a_probability() {
    let mut weights = vec![1e-12; 5_000];
    weights[0] = 1e12;
    weights[4_999] = 1e12;
    weights[2_500] = 0.0;
    let distribution = Distribution1D::new(weights.iter().copied()).expect("a distribution");
    for (i, weight) in weights.iter().enumerate() {
        assert_eq!(distribution.probability(i) > 0.0, *weight > 0.0, "{i}");
    }
    for weights in [
        vec![],
        vec![0.0, 0.0],
        vec![1.0, -1.0],
        vec![f64::NAN],
        vec![f64::INFINITY],
    ] {
        assert!(Distribution1D::new(weights).is_none());
    }
}

/// Null hypothesis: outcomes have their probabilities, and what is left of the number is uniform.
#[test]
fn sampling_a_distribution_leaves_a_uniform_number() {
    let weights = [3.0, 0.0, 1.0, 0.5, 7.0];
    let distribution = Distribution1D::new(weights).expect("a distribution");
    assert_eq!(distribution.total(), 11.5);
    let mut numbers = fresh(18);
    let samples = 50_000;
    let mut observed = vec![0; weights.len() * 10];
    for _ in 0..samples {
        let [u] = numbers.read(Stream::Light, 0);
        let (i, rest) = distribution.sample(u);
        observed[i * 10 + (rest * 10.0) as usize] += 1;
    }
    let expected: Vec<f64> = (0..observed.len())
        .map(|cell| f64::from(samples) * weights[cell / 10] / 115.0)
        .collect();
    let p = chi_square(&observed, &expected);
    assert!(p > 1e-4, "p = {p}");
}

/// Null hypothesis: points have the density that `pdf` tells; and `sample` tells the same.
#[test]
fn piecewise_constant_densities_are_sampled() {
    let weights = [1.0, 0.0, 3.0, 2.0, 0.0, 0.0, 0.0, 0.0, 5.0, 4.0, 0.1, 0.9];
    let distribution = Distribution2D::new(&weights, 4).expect("a distribution");
    let mut numbers = fresh(19);
    let samples = 50_000;
    // Each cell in quarters.
    let mut observed = vec![0; 6 * 8];
    for _ in 0..samples {
        let (point, density) = distribution.sample(numbers.read(Stream::Connection, 0));
        assert!(
            (density - distribution.pdf(point)).abs() < 1e-6,
            "{point:?}"
        );
        let [x, y] = point;
        observed[(y * 6.0) as usize * 8 + (x * 8.0) as usize] += 1;
    }
    let expected: Vec<f64> = (0..observed.len())
        .map(|cell| {
            let center = [(cell % 8) as f32 + 0.5, (cell / 8) as f32 + 0.5];
            let pdf = distribution.pdf([center[0] / 8.0, center[1] / 6.0]);
            f64::from(samples) * f64::from(pdf) / 48.0
        })
        .collect();
    let p = chi_square(&observed, &expected);
    assert!(p > 1e-4, "p = {p}");
    for (cell, weight) in weights.iter().enumerate() {
        let center = [
            ((cell % 4) as f32 + 0.5) / 4.0,
            ((cell / 4) as f32 + 0.5) / 3.0,
        ];
        let expected = weight / 16.0 * 12.0;
        assert!(
            (f64::from(distribution.pdf(center)) - expected).abs() < 1e-4,
            "{cell}"
        );
    }
    assert!(Distribution2D::new(&weights, 5).is_none());
    assert!(Distribution2D::new(&weights, 0).is_none());
}

#[test]
fn colours_are_weighed_and_checked() {
    assert!((luminance(Vec3A::ONE) - 1.0).abs() < 1e-6);
    assert!((luminance(Vec3A::X) - 0.2126).abs() < 1e-4);
    assert!(is_light(Vec3A::new(0.0, 1.0, 1e30)));
    for bad in [-1e-9, f32::NAN, f32::INFINITY] {
        assert!(!is_light(Vec3A::new(0.0, bad, 1.0)));
    }
}
