//! Tests of warps and distributions. The statistical ones use fixed seeds; each p-value is tested at
//! 1e-4, which is then the rate of false alarms over seeds.

use glam::{Vec2, Vec3A};

use super::seeds::Purpose;
use super::warp::{
    square_to_cosine_hemisphere, square_to_disk, square_to_sphere, square_to_triangle,
};
use super::{Dimension, Distribution1D, Distribution2D, IndependentSampler, Sampler, Stream};
use crate::math::color::is_light;
use crate::math::luminance;
use crate::statistics::chi_square;

/// Pairs of independent uniform numbers.
fn pairs(seed: u64) -> impl Iterator<Item = [f32; 2]> {
    let at = Dimension::new(Stream::Camera, 0);
    (0..).map(move |i| IndependentSampler::new(seed, Purpose::Tests, i).get(at))
}

/// Null hypothesis: the points of `warp` are uniform on the unit square. The caller composes the warp
/// under test with a map that inverts its density.
fn check_uniform(name: &str, warp: impl Fn(Vec2) -> Vec2) {
    const SIDE: usize = 20;
    let samples = 100_000;
    let numbers = pairs(17);
    let mut observed = vec![0; SIDE * SIDE];
    for u in numbers.take(samples as usize) {
        let p = warp(Vec2::from_array(u));
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

/// Azimuth over 2 pi, in [0, 1).
fn azimuth(v: Vec2) -> f32 {
    let phi = v.y.atan2(v.x) / std::f32::consts::TAU;
    phi - phi.floor()
}

#[test]
fn warps_have_their_densities() {
    check_uniform("independent numbers", |u| u);
    check_uniform("disk", |u| {
        let d = square_to_disk(u);
        Vec2::new(d.length_squared(), azimuth(d))
    });
    // Density cos/pi: cos^2 is uniform.
    check_uniform("cosine hemisphere", |u| {
        let d = square_to_cosine_hemisphere(u);
        Vec2::new(d.z * d.z, azimuth(Vec2::new(d.x, d.y)))
    });
    check_uniform("sphere", |u| {
        let d = square_to_sphere(u);
        Vec2::new(0.5 * (d.z + 1.0), azimuth(Vec2::new(d.x, d.y)))
    });
    // The share of the triangle's area beyond b1, and the position on the line of equal b1.
    check_uniform("triangle", |u| {
        let b = square_to_triangle(u);
        Vec2::new((1.0 - b.x) * (1.0 - b.x), b.y / (1.0 - b.x).max(1e-9))
    });
}

/// Thousands of outcomes have negligible weights beside two dominant ones. Each must keep a positive
/// probability.
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

/// Null hypothesis: outcomes have their probabilities, and the remapped sample value is uniform.
#[test]
fn sampling_a_distribution_leaves_a_uniform_number() {
    let weights = [3.0, 0.0, 1.0, 0.5, 7.0];
    let distribution = Distribution1D::new(weights).expect("a distribution");
    assert_eq!(distribution.total(), 11.5);
    let numbers = pairs(18);
    let samples = 50_000;
    let mut observed = vec![0; weights.len() * 10];
    for [u, _] in numbers.take(samples as usize) {
        let (i, rest) = distribution.sample(u);
        observed[i * 10 + (rest * 10.0) as usize] += 1;
    }
    let expected: Vec<f64> = (0..observed.len())
        .map(|cell| f64::from(samples) * weights[cell / 10] / 115.0)
        .collect();
    let p = chi_square(&observed, &expected);
    assert!(p > 1e-4, "p = {p}");
}

/// Null hypothesis: cells are chosen in proportion to their weights, and positions are uniform within a
/// cell.
#[test]
fn grids_are_sampled_in_proportion() {
    let weights = [1.0, 0.0, 3.0, 2.0, 0.0, 0.0, 0.0, 0.0, 5.0, 4.0, 0.1, 0.9];
    let grid = Distribution2D::new(&weights, 4).expect("a distribution");
    let numbers = pairs(19);
    let samples = 50_000;
    // Each cell in quarters.
    let mut observed = vec![0; 4 * weights.len()];
    for u in numbers.take(samples as usize) {
        let cell = grid.sample(u);
        let quarter = cell.within.map(|x| usize::from(x >= 0.5));
        observed[4 * (4 * cell.row + cell.column) + 2 * quarter[0] + quarter[1]] += 1;
    }
    let expected: Vec<f64> = (0..observed.len())
        .map(|quarter| f64::from(samples) * weights[quarter / 4] / 64.0)
        .collect();
    let p = chi_square(&observed, &expected);
    assert!(p > 1e-4, "p = {p}");
    for (i, weight) in weights.iter().enumerate() {
        let probability = f64::from(grid.probability(i % 4, i / 4));
        assert!(
            (probability - weight / 16.0).abs() < 1e-6,
            "{i}: {probability}"
        );
    }
    assert!(Distribution2D::new(&weights, 5).is_none());
    assert!(Distribution2D::new(&weights, 0).is_none());
    assert!(Distribution2D::new(&[1.0, 1.0, 1.0, -1.0], 2).is_none());
}

#[test]
fn luminance_and_validity_of_colours() {
    assert!((luminance(Vec3A::ONE) - 1.0).abs() < 1e-6);
    assert!((luminance(Vec3A::X) - 0.2126).abs() < 1e-4);
    assert!(is_light(Vec3A::new(0.0, 1.0, 1e30)));
    for bad in [-1e-9, f32::NAN, f32::INFINITY] {
        assert!(!is_light(Vec3A::new(0.0, bad, 1.0)));
    }
}
