//! Path tracing, light tracing, bidirectional path tracing and Metropolis converge to the same image.
//!
//! Null hypothesis, for each pair of integrators, tile of the image and channel: both have the same
//! mean over independent seeds. Welch's test for each, Holm's correction over all of a scene; a
//! correct program fails one scene with probability ALPHA for a new choice of seeds. Images are not
//! rescaled, so that a wrong normalisation is detected too.

mod common;

use common::renders::pssmlt;
use common::tiles::tile_moments;
use glam::Vec3A;
use metrolight::integrators::{BidirectionalPathTracer, PathSampler, Workspace};
use metrolight::path::Vertex;
use metrolight::render::{Budget, Integrator, Method, MmltSettings, Settings};
use metrolight::scene::{Scene, TransportMode};
use metrolight::statistics::{Moments, holm, welch};

use Method::{Bdpt, Light, Mmlt, Path, Pssmlt};

const ALPHA: f64 = 1e-3;
const SEEDS: u64 = 16;

/// Moments over seeds of the means of all tiles.
fn sample(scene: &Scene, method: Method, spp: u64, side: usize) -> Vec<Moments> {
    let integrator = match method {
        Pssmlt => pssmlt(64, 100_000),
        // Chains carry most of the light, not only the brightest.
        Mmlt => Integrator::Mmlt(MmltSettings {
            threshold: Some(0.05),
            ..MmltSettings::default()
        }),
        Path | Light | Bdpt => method.into(),
    };
    let settings = Settings {
        budget: Budget::SamplesPerPixel(spp),
        ..Settings::of(integrator)
    };
    // No two methods share a random number.
    let first = 1000 * (method as u64 + 1);
    tile_moments(scene, &settings, first..first + SEEDS, side)
}

/// Asserts that all integrators, given with their samples per pixel, agree.
fn assert_agreement(path: &str, defines: &[(&str, &str)], integrators: &[(Method, u64)]) {
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
        &[
            (Path, 32),
            (Light, 32),
            (Bdpt, 16),
            (Pssmlt, 32),
            (Mmlt, 16),
        ],
    );
}

#[test]
fn smooth_rough_and_mixed_materials_under_area_lights() {
    assert_agreement(
        "tests/scenes/mis-area.xml",
        &[],
        &[(Path, 128), (Bdpt, 32), (Pssmlt, 64), (Mmlt, 32)],
    );
}

#[test]
fn point_and_directional_lights() {
    assert_agreement(
        "tests/scenes/mis-point.xml",
        &[],
        &[(Bdpt, 32), (Pssmlt, 64), (Mmlt, 32)],
    );
}

#[test]
fn light_from_all_around() {
    assert_agreement(
        "tests/scenes/mis-environment.xml",
        &[],
        &[(Path, 64), (Bdpt, 32), (Pssmlt, 64), (Mmlt, 32)],
    );
}

/// Refraction scales radiance but not importance, and shading normals make scattering asymmetric: without
/// the adjoint factors path and light tracing converge to different images.
#[test]
fn path_and_light_tracing_are_adjoint() {
    assert_agreement(
        "tests/scenes/adjoint.xml",
        &[],
        &[(Path, 256), (Light, 96), (Bdpt, 64)],
    );
}

/// Light through two interfaces, from a lamp outside to a camera in the water and from a lamp in the water
/// to a camera outside, so that the squared indices do not cancel.
#[test]
fn nested_media_are_adjoint() {
    let methods = [(Path, 128), (Light, 64), (Bdpt, 32)];
    assert_agreement("tests/scenes/nested.xml", &[], &methods);
    let inside = [
        ("origin", "0, 0.6, 0"),
        ("target", "0, -0.5, 0"),
        ("inner", "0"),
        ("outer", "20"),
    ];
    assert_agreement("tests/scenes/nested.xml", &inside, &methods);
}

/// Light from a lamp under water to objects that rise out of it; through a rough surface also to objects
/// below.
#[test]
fn half_immersed_things_are_adjoint() {
    let methods = [(Path, 128), (Light, 64), (Bdpt, 32)];
    assert_agreement("tests/scenes/immersed.xml", &[], &methods);
    let rough = [
        ("surface", "rough"),
        ("origin", "0.6, 1.6, 2.6"),
        ("target", "0, 0, 0"),
    ];
    assert_agreement("tests/scenes/immersed.xml", &rough, &methods);
}

/// Shading normals on coarse meshes, rough, diffuse and refracting, lit by an environment and a lamp, seen
/// through a lens.
#[test]
fn coarse_meshes_are_adjoint() {
    let methods = [(Path, 48), (Light, 128), (Bdpt, 24)];
    assert_agreement("tests/scenes/coarse.xml", &[], &methods);
}

/// Delta lobes beside those that chains take: light that passes a mask or a pane, mirrors and glass under paint, and
/// reflection at perturbed normals; and their densities in light and camera subpaths.
#[test]
fn materials_made_of_others() {
    assert_agreement(
        "tests/scenes/composites.xml",
        &[],
        &[(Path, 96), (Bdpt, 24), (Pssmlt, 48), (Mmlt, 16)],
    );
}

/// A thin lens, diffuse plates and a lamp in view.
#[test]
fn lenses() {
    let methods = [
        (Path, 48),
        (Light, 48),
        (Bdpt, 16),
        (Pssmlt, 48),
        (Mmlt, 16),
    ];
    assert_agreement("tests/scenes/plates.xml", &[], &methods);
}

/// At every vertex of both walks the throughput of a sampled step equals that of a connection along it,
/// f cos over the density; and in the other direction the vertex scatters by the adjoint BSDF (Veach
/// 1997, section 5.3): value_I |w_i.N_g| = value_R |w_o.N_g|, with the densities exchanged. The vertices
/// include rough glass, and meshes whose shading normals differ from the geometric ones.
#[test]
fn walks_scatter_as_connections_do() {
    for path in ["tests/scenes/coarse.xml", "tests/scenes/immersed.xml"] {
        let mut scene = common::load(path, &[("surface", "rough")]);
        scene.depth.rr_depth = 1000;
        let mut workspace = Workspace::default();
        let (mut steps, mut transmitted) = (0, 0);
        for i in 0..20_000 {
            let sampler = &mut common::sample(i);
            BidirectionalPathTracer.sample_paths(&scene, sampler, &mut workspace, |_| {});
            let walks = [
                (&workspace.camera.vertices[..], TransportMode::Radiance),
                (&workspace.light.vertices[..], TransportMode::Importance),
            ];
            for (vertices, mode) in walks {
                for (v, next) in vertices.iter().zip(&vertices[vertices.len().min(1)..]) {
                    if !v.is_connectible(&scene) {
                        continue;
                    }
                    let direction = -next.to_previous;
                    check_step(&scene, v, next, direction, mode);
                    steps += 1;
                    let normal = v.surface.geometric_normal;
                    let through = normal.dot(direction) * normal.dot(v.to_previous) < 0.0;
                    transmitted += u32::from(through);
                }
            }
        }
        println!("{path}: {steps} steps, {transmitted} of them through the surface");
        assert!(steps > 8000 && transmitted > 100);
    }
}

fn check_step(scene: &Scene, v: &Vertex, next: &Vertex, direction: Vec3A, mode: TransportMode) {
    let close = |a: f32, b: f32| (a - b).abs() <= 5e-3 * (a.abs() + b.abs());
    let (scatter, back) = (
        v.scatter(scene, direction, mode),
        Vertex {
            to_previous: direction,
            ..*v
        }
        .scatter(scene, v.to_previous, other(mode)),
    );
    let cos_previous = v.surface.geometric_normal.dot(v.to_previous).abs();
    // Cosines close to 0 have too few significant digits in f32.
    if scatter.cos < 1e-3 || cos_previous < 1e-3 {
        return;
    }
    for channel in 0..3 {
        let sampled = next.throughput[channel] / v.throughput[channel];
        let connected = scatter.value[channel] / scatter.pdf_forward;
        assert!(
            close(sampled, connected),
            "{mode:?}: {sampled} {connected} at {v:?}"
        );
        // Each value times the cosine at its predecessor.
        let (there, again) = (scatter.value * cos_previous, back.value * scatter.cos);
        assert!(
            close(there[channel], again[channel]),
            "{mode:?}: {there} {again} at {v:?}"
        );
    }
    assert!(
        close(scatter.pdf_forward, back.pdf_reverse),
        "{mode:?} at {v:?}"
    );
    assert!(
        close(scatter.pdf_reverse, back.pdf_forward),
        "{mode:?} at {v:?}"
    );
}

fn other(mode: TransportMode) -> TransportMode {
    match mode {
        TransportMode::Radiance => TransportMode::Importance,
        TransportMode::Importance => TransportMode::Radiance,
    }
}
