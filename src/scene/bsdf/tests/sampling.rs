//! Compares sampled directions with their density.

use std::f64::consts::PI;

use glam::{Vec2, Vec3A};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::{BsdfEvaluation, BsdfSample, Material, TransportMode};
use super::materials::{connectible, is_reciprocal, textures};
use super::{context, integrate, integrate_evenly, tilted};
use crate::statistics::{chi_square, holm};

const MODES: [TransportMode; 2] = [TransportMode::Radiance, TransportMode::Importance];

/// Evaluates the material where `from` is given and `direction` is sampled.
fn evaluate(
    material: &Material,
    mode: TransportMode,
    from: Vec3A,
    direction: Vec3A,
) -> BsdfEvaluation {
    let (to_light, to_camera) = match mode {
        TransportMode::Radiance => (direction, from),
        TransportMode::Importance => (from, direction),
    };
    material.evaluate(&context(&textures()), to_light, to_camera)
}

/// Density of sampling `direction`.
fn pdf_of(material: &Material, mode: TransportMode, from: Vec3A, direction: Vec3A) -> f32 {
    let s = evaluate(material, mode, from, direction);
    match mode {
        TransportMode::Radiance => s.pdf_to_light,
        TransportMode::Importance => s.pdf_to_camera,
    }
}

fn random_samples(
    material: &Material,
    mode: TransportMode,
    from: Vec3A,
    count: usize,
    seed: u64,
) -> impl Iterator<Item = Option<BsdfSample>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let textures = textures();
    (0..count).map(move |_| {
        let u = Vec2::new(rng.random(), rng.random());
        material.sample(&context(&textures), from, mode, rng.random(), u)
    })
}

/// p-value of the hypothesis that `material` samples from its density: Pearson's chi-square test on 12 x
/// 24 cells of equal angles, and one cell for all other outcomes (paths that end, and delta lobes).
fn chi_square_p(material: &Material, mode: TransportMode, from: Vec3A, seed: u64) -> f64 {
    const COUNT: usize = 60_000;
    const ROWS: usize = 12;
    let step = PI / ROWS as f64;
    let mut observed = vec![0u64; 2 * ROWS * ROWS + 1];
    for sample in random_samples(material, mode, from, COUNT, seed) {
        let cell = match sample {
            Some(sample) if !sample.delta => {
                let d = sample.direction.as_dvec3();
                let theta = d.z.clamp(-1.0, 1.0).acos();
                let phi = d.y.atan2(d.x).rem_euclid(2.0 * PI);
                let row = ((theta / step) as usize).min(ROWS - 1);
                row * 2 * ROWS + ((phi / step) as usize).min(2 * ROWS - 1)
            }
            _ => 2 * ROWS * ROWS,
        };
        observed[cell] += 1;
    }
    let density = |direction: Vec3A| f64::from(pdf_of(material, mode, from, direction));
    let mut expected = Vec::with_capacity(observed.len());
    for row in 0..ROWS {
        for column in 0..2 * ROWS {
            let [t, p] = [row, column].map(|i| [i as f64 * step, (i + 1) as f64 * step]);
            let mut mean = COUNT as f64 * integrate(&density, t, p);
            // The adaptive rule can miss a part near a discontinuity: a suspicious cell is integrated
            // again.
            let count = observed[expected.len()] as f64;
            if (count - mean).powi(2) > 9.0 * mean {
                mean = COUNT as f64 * integrate_evenly(&density, t, p);
            }
            expected.push(mean);
        }
    }
    let rest = COUNT as f64 - expected.iter().sum::<f64>();
    assert!(
        rest > -1e-3 * COUNT as f64,
        "density integrates to more than 1: {rest}"
    );
    expected.push(rest);
    // Both rules can miss a sliver in the corner of a cell: expectations are never 0.
    let expected: Vec<f64> = expected.iter().map(|e| e.max(1e-3)).collect();
    chi_square(&observed, &expected)
}

/// Null hypothesis: each material samples the density that `evaluate` returns, in 14 x 7 settings. With
/// Holm's correction over all of them, the level is 1%: the false-alarm rate over the choice of seeds.
#[test]
fn directions_follow_their_density() {
    let directions = [
        tilted(0.0, 0.0),
        tilted(35.0, 2.0),
        tilted(70.0, -1.0),
        tilted(89.0, 0.5),
        tilted(140.0, 1.0),
        tilted(100.0, -2.0),
        tilted(175.0, 0.0),
    ];
    let mut cases = Vec::new();
    let mut p_values = Vec::new();
    for (m, (name, material)) in connectible().iter().enumerate() {
        for (d, &from) in directions.iter().enumerate() {
            let seed = (m * directions.len() + d) as u64;
            let mode = MODES[(m + d) % 2];
            p_values.push(chi_square_p(material, mode, from, seed));
            cases.push(format!("{name} from {from}, {mode:?}, seed {seed}"));
        }
    }
    for ((case, adjusted), p) in cases.iter().zip(holm(&p_values)).zip(&p_values) {
        assert!(adjusted >= 0.01, "{case}: p = {p:e}");
    }
}

/// How samples differ from what `evaluate` returns for them, if they do: their weights and densities, in either mode.
pub(super) fn disagreement(name: &'static str, material: &Material) -> Option<String> {
    let reciprocal = is_reciprocal(&(name, material.clone()));
    for (seed, mode) in [(1, MODES[0]), (2, MODES[1])] {
        for from in [tilted(40.0, 1.0), tilted(88.0, 0.0), tilted(130.0, 3.0)] {
            for sample in random_samples(material, mode, from, 300, seed).flatten() {
                if sample.delta {
                    continue;
                }
                let d = sample.direction;
                let s = evaluate(material, mode, from, d);
                let (pdf, reverse) = match mode {
                    TransportMode::Radiance => (s.pdf_to_light, s.pdf_to_camera),
                    TransportMode::Importance => (s.pdf_to_camera, s.pdf_to_light),
                };
                let error = (sample.weight * pdf - s.f * d.z.abs()).abs().max_element();
                // The density of the reverse direction, evaluated as a forward one.
                let back = pdf_of(material, mode, d, from);
                let same = (back - reverse).abs() <= 1e-3 * (back + reverse);
                let agrees = (sample.pdf, sample.reverse_pdf) == (pdf, reverse)
                    && error <= 1e-5 * pdf
                    && (d.length() - 1.0).abs() < 1e-5
                    && (same || !reciprocal);
                if !agrees {
                    return Some(format!("{name}: {sample:?} {s:?} {back}"));
                }
            }
        }
    }
    None
}

#[test]
fn samples_agree_with_evaluation() {
    for (name, material) in connectible() {
        assert_eq!(disagreement(name, &material), None);
    }
}

/// Along lines through the square of random numbers, directions change little from step to step: the map
/// is continuous.
#[test]
fn sampling_is_continuous() {
    const STEPS: u32 = 2000;
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    let textures = textures();
    for (name, material) in connectible() {
        for from in [tilted(20.0, 1.0), tilted(75.0, 4.0), tilted(120.0, 0.0)] {
            for line in 0..4 {
                let (fixed, lobe) = (rng.random_range(0.01..0.99), rng.random());
                let samples = (0..STEPS).map(|i| {
                    let x = 0.01 + 0.98 * i as f32 / STEPS as f32;
                    let (u, v) = if line % 2 == 0 {
                        (x, fixed)
                    } else {
                        (fixed, x)
                    };
                    material.sample(&context(&textures), from, MODES[0], lobe, Vec2::new(u, v))
                });
                let mut before: Option<BsdfSample> = None;
                for sample in samples {
                    // A rough interface changes from reflection to refraction with the angle of the
                    // microfacet.
                    if let (Some(a), Some(b)) = (before, sample)
                        && a.eta == b.eta
                    {
                        let step = (a.direction - b.direction).length();
                        assert!(step < 0.05, "{name}: {} {}", a.direction, b.direction);
                    }
                    before = sample;
                }
            }
        }
    }
}
