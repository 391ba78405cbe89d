//! Path tracing, light tracing, bidirectional path tracing and Metropolis make one image.
//!
//! Null hypothesis, for each pair of integrators, tile of the image and channel: both have the same
//! mean over independent seeds. Welch's test for each, Holm's correction over all of a scene; a
//! correct program fails one scene with probability ALPHA for a new choice of seeds. Nothing is
//! rescaled, so a wrong normalisation shows too.

mod common;

use common::tiles::tile_moments;
use metrolight::render::{Budget, Integrator, Settings};
use metrolight::scene::Scene;
use metrolight::statistics::{Moments, holm, welch};

use Integrator::{Bdpt, Light, Path, Pssmlt};

const ALPHA: f64 = 1e-3;
const SEEDS: u64 = 16;

/// Moments over seeds of the means of all tiles.
fn sample(scene: &Scene, integrator: Integrator, spp: u64, side: usize) -> Vec<Moments> {
    let settings = Settings {
        budget: Budget::SamplesPerPixel(spp),
        chains: 64,
        bootstrap: Some(100_000),
        ..Settings::new(integrator)
    };
    // No two integrators share a random number.
    let first = 1000 * (integrator as u64 + 1);
    tile_moments(scene, &settings, first..first + SEEDS, side)
}

/// Asserts that all integrators, given with their samples per pixel, agree.
fn assert_agreement(path: &str, defines: &[(&str, &str)], integrators: &[(Integrator, u64)]) {
    let defines = [
        &[("resx", "24"), ("resy", "18"), ("integrator", "path")],
        defines,
    ]
    .concat();
    let scene = common::load(path, &defines);
    let side = 6;
    let samples: Vec<Vec<Moments>> = integrators
        .iter()
        .map(|&(i, spp)| sample(&scene, i, spp, side))
        .collect();
    let mut p_values = Vec::new();
    let mut names = Vec::new();
    for a in 0..samples.len() {
        for b in a + 1..samples.len() {
            for (tile, (x, y)) in samples[a].iter().zip(&samples[b]).enumerate() {
                p_values.push(welch(x, y));
                names.push((integrators[a].0, x, integrators[b].0, y, tile));
            }
        }
    }
    let adjusted = holm(&p_values);
    let (worst, p) = adjusted
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(b.1))
        .expect("some tiles");
    let (a, x, b, y, tile) = names[worst];
    println!("{path}: smallest adjusted p {p:.2e}");
    assert!(
        *p > ALPHA,
        "{path} {defines:?}: {a:?} {} +- {} and {b:?} {} +- {} differ in tile {}, channel {}: \
         adjusted p = {p:e}",
        x.mean,
        x.standard_error(),
        y.mean,
        y.standard_error(),
        tile / 3,
        tile % 3
    );
}

#[test]
fn diffuse_box() {
    assert_agreement(
        "scenes/cornell/scene.xml",
        &[],
        &[(Path, 32), (Light, 32), (Bdpt, 16), (Pssmlt, 32)],
    );
}

#[test]
fn smooth_rough_and_mixed_materials_under_area_lights() {
    assert_agreement(
        "tests/scenes/mis-area.xml",
        &[],
        &[(Path, 128), (Bdpt, 32), (Pssmlt, 64)],
    );
}

#[test]
fn point_and_directional_lights() {
    assert_agreement(
        "tests/scenes/mis-point.xml",
        &[],
        &[(Bdpt, 32), (Pssmlt, 64)],
    );
}

#[test]
fn light_from_all_around() {
    assert_agreement(
        "tests/scenes/mis-environment.xml",
        &[],
        &[(Path, 64), (Bdpt, 32), (Pssmlt, 64)],
    );
}

/// What refraction does to radiance it does not do to importance, and shading normals make scattering
/// asymmetric: without their adjoint factors path and light tracing make different images.
#[test]
fn path_and_light_tracing_are_adjoint() {
    assert_agreement(
        "tests/scenes/adjoint.xml",
        &[],
        &[(Path, 256), (Light, 96), (Bdpt, 64)],
    );
}
