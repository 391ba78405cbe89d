//! Images against references that Mitsuba 3 rendered (tests/references/make_references.py): materials,
//! textures, emitters, shapes, cameras, filters and transforms mean what they mean there.
//!
//! Null hypothesis, for each tile and channel: the mean over our seeds and the mean over Mitsuba's
//! renderings are equal. Welch's test for each, Holm's correction over all tiles and channels of one
//! image; a correct program fails an image with probability ALPHA for a new choice of seeds.

mod common;

use std::path::{Path, PathBuf};

use common::tiles::{tile_moments, tile_sums};
use metrolight::integrators::{Sampler, lost_light};
use metrolight::render::{Budget, Integrator, Settings};
use metrolight::scene::Scene;
use metrolight::statistics::{Moments, holm, welch};
use serde::Deserialize;

const ALPHA: f64 = 1e-4;
const SEEDS: u64 = 8;
const SIDE: usize = 8;

/// One line of the manifest.
#[derive(Deserialize)]
struct Entry {
    name: String,
    scene: String,
    defines: std::collections::BTreeMap<String, String>,
    width: u32,
    height: u32,
    renderings: u64,
    methods: Methods,
}

/// Who can find the light that the reference shows.
#[derive(Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Methods {
    All,
    Path,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn manifest() -> Vec<Entry> {
    let path = root().join("tests/references/manifest.json");
    let text = std::fs::read_to_string(path).expect("the manifest");
    serde_json::from_str(&text).expect("a manifest as written by make_references.py")
}

/// Mean and variance of the mean, per pixel.
fn read_reference(name: &str) -> [Vec<[f32; 3]>; 2] {
    use exr::prelude::*;
    let path = root().join(format!("tests/references/{name}.exr"));
    let file = read_all_flat_layers_from_file(path).expect("a reference image");
    let channel = |name: &str| -> Vec<f32> {
        file.layer_data
            .iter()
            .flat_map(|layer| &layer.channel_data.list)
            .find(|channel| channel.name.to_string() == name)
            .map(|channel| channel.sample_data.values_as_f32().collect())
            .unwrap_or_else(|| panic!("{name} is missing"))
    };
    ["", "variance."].map(|prefix| {
        let [r, g, b] = ["R", "G", "B"].map(|c| channel(&format!("{prefix}{c}")));
        r.iter()
            .zip(&g)
            .zip(&b)
            .map(|((&r, &g), &b)| [r, g, b])
            .collect()
    })
}

/// The reference's tiles as moments over its renderings.
fn reference_moments(entry: &Entry) -> Vec<Moments> {
    let [mean, variance] = read_reference(&entry.name);
    let width = entry.width as usize;
    tile_sums(&mean, width, SIDE)
        .into_iter()
        .zip(tile_sums(&variance, width, SIDE))
        .map(|((sum, count), (variances, _))| {
            let n = f64::from(count);
            let variance_of_mean = variances / (n * n);
            let renderings = entry.renderings;
            Moments::from_summary(renderings, sum / n, variance_of_mean * renderings as f64)
        })
        .collect()
}

fn load(entry: &Entry) -> Scene {
    let size = [("resx", entry.width), ("resy", entry.height)].map(|(k, v)| (k, v.to_string()));
    let mut defines: Vec<(&str, &str)> = vec![("integrator", "path")];
    defines.extend(size.iter().map(|(k, v)| (*k, v.as_str())));
    defines.extend(entry.defines.iter().map(|(k, v)| (k.as_str(), v.as_str())));
    common::load(&entry.scene, &defines)
}

/// Smallest corrected p-value, and a message about that tile.
fn compare(reference: &[Moments], ours: &[Moments]) -> (f64, String) {
    // Tiles of nearly one colour have next to no variance, and what they have is far from normal: a
    // difference too small to matter is none.
    let negligible = |a: &Moments, b: &Moments| (a.mean - b.mean).abs() <= 5e-4 * a.mean.abs();
    let p_value = |(a, b)| if negligible(a, b) { 1.0 } else { welch(a, b) };
    let p_values: Vec<f64> = reference.iter().zip(ours).map(p_value).collect();
    let adjusted = holm(&p_values);
    let (tile, p) = adjusted
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(b.1))
        .expect("some tiles");
    let (a, b) = (&reference[tile], &ours[tile]);
    let message = format!(
        "tile {}, channel {}: reference {:.5} +- {:.5}, ours {:.5} +- {:.5}",
        tile / 3,
        tile % 3,
        a.mean,
        a.standard_error(),
        b.mean,
        b.standard_error()
    );
    (*p, message)
}

/// Renders `entries` by path tracing, and by `others` where these find the same light.
fn check(
    entries: impl Iterator<Item = Entry>,
    samples: u64,
    others: impl Fn(&Scene) -> Vec<Integrator>,
) {
    let mut failures = Vec::new();
    for entry in entries {
        if entry.scene.starts_with("..") && !root().join(&entry.scene).exists() {
            println!("{}: skipped, the published scene is not here", entry.name);
            continue;
        }
        let scene = load(&entry);
        let reference = reference_moments(&entry);
        let mut integrators = vec![(Integrator::Path, 2 * samples)];
        if entry.methods == Methods::All {
            integrators.extend(others(&scene).into_iter().map(|i| match i {
                Integrator::Bdpt => (i, samples),
                Integrator::Path | Integrator::Light | Integrator::Pssmlt => (i, 2 * samples),
            }));
        }
        for (integrator, spp) in integrators {
            let settings = Settings {
                budget: Budget::SamplesPerPixel(spp),
                ..Settings::new(integrator)
            };
            let first = 100 * (integrator as u64 + 1);
            let ours = tile_moments(&scene, &settings, first..first + SEEDS, SIDE);
            let (p, message) = compare(&reference, &ours);
            println!("{} {integrator:?}: smallest adjusted p {p:.2e}", entry.name);
            if p < ALPHA {
                failures.push(format!(
                    "{} {integrator:?}: p = {p:.1e}, {message}",
                    entry.name
                ));
            }
        }
    }
    assert!(
        failures.is_empty(),
        "{} images differ:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

#[test]
fn small_scenes_equal_their_references() {
    // Light tracing too, where nothing is seen through smooth surfaces.
    let others = |scene: &Scene| match lost_light(scene, Sampler::Light).as_slice() {
        [] => vec![Integrator::Bdpt, Integrator::Light],
        _ => vec![Integrator::Bdpt],
    };
    let small = manifest()
        .into_iter()
        .filter(|e| e.scene.starts_with("tests/"));
    check(small, 24, others);
}

/// With lamps of a size that path tracing can find, so that all integrators can be compared.
#[test]
fn our_scenes_equal_their_references() {
    let others = |_: &Scene| vec![Integrator::Bdpt, Integrator::Pssmlt];
    let ours = manifest()
        .into_iter()
        .filter(|e| e.scene.starts_with("scenes/"));
    check(ours, 32, others);
}

#[test]
fn published_scenes_equal_their_references() {
    let others = |_: &Scene| vec![Integrator::Bdpt];
    let published = manifest().into_iter().filter(|e| e.scene.starts_with(".."));
    check(published, 16, others);
}
