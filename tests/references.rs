//! Images against references rendered by Mitsuba 3 (tests/references/make_references.py): materials,
//! textures, emitters, shapes, cameras, filters and transforms mean the same in both.
//!
//! Null hypothesis, for each tile, for the whole image, and for each channel: the mean over our seeds
//! and the mean over Mitsuba's renderings are equal. The tests are those of `common/comparison.rs`: z
//! with Holm's correction over one image, and the distribution of the p-values over all images. A
//! correct program fails an image with probability `alpha` for a new choice of seeds, and the
//! distribution of p-values with probability `UNIFORMITY`.

mod common;

use std::path::Path;

use common::comparison::{Comparison, POWER, Renderings, normals, uniformity};
use common::figures::{Accuracy, record};
use common::reference::{Entry, Form, Methods, REPLICATES, Run, UNIFORMITY, manifest, read_image};
use common::renders::{means, with_pssmlt};
use metrolight::analysis::lost_light;
use metrolight::render::{Budget, Method, Settings, Unobserved, render};
use metrolight::scene::Scene;
use metrolight::statistics::{Moments, smallest_detectable};
use metrolight::technique::TechniqueSet;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// For every run of the tests.
const QUICK: Form = Form {
    alpha: 1e-4,
    tile: [8, 8],
    seeds: 16,
};

/// Tiles are quarters of the image.
const FINE: Form = Form {
    alpha: 1e-3,
    tile: [16, 12],
    seeds: 32,
};

/// Renders the `chosen` entries by path tracing, and by `others` where those find the same light.
fn check(chosen: impl Fn(&Entry) -> bool, samples: u64, others: impl Fn(&Scene) -> Vec<Method>) {
    let mut run = Run::new(QUICK);
    for (index, entry) in (0..).zip(&manifest()) {
        if !chosen(entry) || !entry.is_wanted() {
            continue;
        }
        let scene = entry.load();
        let reference = entry.reference(run.form.tile);
        let mut integrators = vec![Method::Path];
        if entry.methods == Methods::All {
            integrators.extend(others(&scene));
        }
        for integrator in integrators {
            let spp = match integrator {
                Method::Bdpt | Method::Mmlt => samples,
                Method::Path | Method::Light | Method::Pssmlt => 2 * samples,
            };
            let settings = with_pssmlt(
                Settings {
                    budget: Budget::SamplesPerPixel(spp),
                    ..Settings::new(integrator)
                },
                |own| {
                    own.bootstrap = Some(1 << 16);
                },
            );
            run.compare((index, entry), &scene, &settings, &reference);
        }
    }
    run.judge();
}

#[test]
fn small_scenes_equal_their_references() {
    // Light tracing only where nothing is seen through smooth surfaces.
    let others = |scene: &Scene| match lost_light(scene, TechniqueSet::Light).as_slice() {
        [] => vec![Method::Bdpt, Method::Light],
        _ => vec![Method::Bdpt],
    };
    check(|e| !e.is_ours() && !e.is_published(), 12, others);
}

/// Lamps are large enough for path tracing to find, so that all integrators can be compared.
#[test]
fn our_scenes_equal_their_references() {
    let others = |_: &Scene| vec![Method::Bdpt, Method::Pssmlt, Method::Mmlt];
    check(Entry::is_ours, 16, others);
}

/// Small inputs beside the project, with the mean of Mitsuba's image (3000 samples per pixel). Null hypothesis: ours
/// differs by at most 0.001, for the rational fit of Beckmann's masking in Mitsuba, which is exact here. The bound is
/// 4.5 standard errors beyond that: a correct program fails with probability 7e-6 for a new choice of seeds.
#[test]
fn small_inputs_have_the_means_of_mitsuba() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases");
    if !folder.is_dir() {
        println!("skipped: {} is absent", folder.display());
        return;
    }
    // Textured and anisotropic roughness.
    for (name, expected) in [("c15", 0.8976), ("c16", 0.9849)] {
        let path = folder.join(name).with_extension("xml");
        let loaded = metrolight::mitsuba::load(&path, &[]).expect(name);
        let scene = loaded.description.build().expect(name);
        let found = means(&scene, Method::Path, 64, 16);
        let error = (found.mean - expected).abs();
        let bound = 1e-3 + 4.5 * found.standard_error();
        assert!(error < bound, "{name}: {} {expected}", found.mean);
    }
}

#[test]
fn published_scenes_equal_their_references() {
    check(Entry::is_published, 8, |_| vec![Method::Bdpt]);
}

/// The two files of a reference, pixels and tiles of its renderings, agree: the means, and for independent
/// pixels (box filter) the variances. 32 renderings of 12 tiles give their ratio over the whole image to
/// about 0.08. With the wide tent neighbours share samples: the variance of tiles is four times that of
/// independent pixels.
#[test]
fn variances_of_pixels_and_of_tiles_agree() {
    for (name, range) in [("diffuse", 0.65..1.45), ("tent", 3.0..5.5)] {
        let entries = manifest();
        let entry = entries.iter().find(|e| e.name == name).expect("an entry");
        let size = [8, 8];
        let by_tiles = |channels| {
            let image = read_image(name, channels);
            common::tiles::tile_means(&image, entry.width as usize, size)
        };
        let variances = by_tiles(["variance.R", "variance.G", "variance.B"]);
        let means = by_tiles(["R", "G", "B"]);
        let reference = entry.reference(size);
        let (mut of_tiles, mut of_pixels) = (0.0, 0.0);
        for ((tile, variance), mean) in reference.moments().iter().zip(&variances).zip(&means) {
            assert!((tile.mean - mean).abs() <= 1e-5 * mean, "{name}");
            of_tiles += tile.standard_error().powi(2);
            of_pixels += variance / (size[0] * size[1]) as f64;
        }
        let ratio = of_tiles / of_pixels;
        assert!(range.contains(&ratio), "{name}: {ratio}");
    }
}

/// Simulated renderings of a grey image of 4 x 3 tiles with noise of 1%, part of which all tiles of a
/// rendering share, as in Metropolis; tile 5 is brighter by `one`, all tiles by `every`.
fn simulate(stream: u64, count: u64, one: f64, every: f64) -> Renderings {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(stream);
    let image = |_| -> Vec<[f32; 3]> {
        let mut noise = normals(&mut rng, 13);
        let shared = noise.pop().expect("the last of 13");
        let pixel = |(i, noise): (usize, f64)| {
            let bias = every + if i == 5 { one } else { 0.0 };
            [(1.0 + bias + 0.01 * (0.8 * noise + 0.6 * shared)) as f32; 3]
        };
        noise.into_iter().enumerate().map(pixel).collect()
    };
    let images: Vec<_> = (0..count).map(image).collect();
    Renderings::new(images.iter().map(Vec::as_slice), 4, [1, 1])
}

/// In 400 simulations of two comparisons that share a reference, both verdicts raise false alarms at
/// their level (0.05; the standard deviation of the rate is 0.011), a bias of the stated detectable size
/// in one tile is detected with power 0.9 (standard deviation 0.015), and a bias of all tiles by 0.7
/// standard errors is detected more often by the distribution of the p-values than in any tile.
#[test]
fn verdicts_have_their_stated_level_and_power() {
    const ALPHA: f64 = 0.05;
    const RUNS: u64 = 400;
    let comparisons = |stream: u64, one: f64, every: f64| -> Vec<Comparison> {
        let reference = simulate(stream, 32, 0.0, 0.0);
        let compare = |i: u64| {
            let ours = simulate(stream + i, 16, one, every);
            Comparison::new(&ours, &reference, ALPHA, [2 * stream + i, stream])
        };
        vec![compare(1), compare(2)]
    };
    let rates = |first: u64, one: f64, every: f64| {
        let (mut holm, mut distribution) = (0, 0);
        for i in 0..RUNS {
            let comparisons = comparisons(1000 * first + 3 * i, one, every);
            holm += usize::from(comparisons[0].smallest().0 < ALPHA);
            distribution += usize::from(uniformity(&comparisons, 199) < ALPHA);
        }
        [holm, distribution].map(|n| n as f64 / RUNS as f64)
    };
    let [holm, distribution] = rates(10, 0.0, 0.0);
    assert!(holm < 0.05 + 0.035, "false alarms of Holm's test: {holm}");
    assert!(
        (distribution - 0.05).abs() < 0.035,
        "of the distribution: {distribution}"
    );

    // The detectable size estimated in one simulation is rough: average 50.
    let stated = (0..50).map(|i| comparisons(90_000 + 3 * i, 0.0, 0.0)[0].catches()[0]);
    let catchable = stated.sum::<f64>() / 50.0;
    let [holm, _] = rates(20, catchable, 0.0);
    assert!((holm - POWER).abs() < 0.06, "power of Holm's test: {holm}");

    let [holm, distribution] = rates(30, 0.0, 0.7 * 0.01 * (1.0f64 / 16.0 + 1.0 / 32.0).sqrt());
    assert!(
        distribution > 2.0 * holm,
        "small biases everywhere: {distribution} {holm}"
    );
}

/// Upper bound on the rays of one image of the fine form; METROLIGHT_RAYS overrides it.
fn max_rays() -> f64 {
    let rays = std::env::var("METROLIGHT_RAYS");
    rays.map_or(5e7, |rays| rays.parse().expect("a number of rays"))
}

/// Relative bias that the fine form shall detect in the median tile.
const AIM: f64 = 0.005;

/// Samples per pixel of one of our renderings with which the fine form reaches its aim. A pilot with
/// seeds of its own measures the scene's noise; where the reference alone is too noisy for the aim, half
/// of its error suffices.
fn samples_for_aim(scene: &Scene, settings: &Settings, reference: &Renderings) -> u64 {
    const SAMPLES: u64 = 16;
    const SEEDS: u64 = 8;
    let settings = Settings {
        budget: Budget::SamplesPerPixel(SAMPLES),
        ..settings.clone()
    };
    let pilot = Renderings::render(scene, &settings, 0..SEEDS, FINE.tile);
    let statistics = render(scene, &settings, &Unobserved)
        .expect("threads")
        .statistics;
    let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
    let bootstrap = statistics
        .pssmlt
        .map_or(0, |chains| chains.bootstrap_samples);
    let samples = SAMPLES * pixels + bootstrap;
    let rays = (statistics.closest_hit_rays + statistics.shadow_rays) as f64 / samples as f64;

    // The detectable difference in standard errors, if both sides have the same.
    let side = Moments::from_summary(FINE.seeds, 0.0, 0.5 * FINE.seeds as f64);
    let tests = reference.moments().len() as f64;
    let quantiles = smallest_detectable(&side, &side, FINE.alpha / tests, POWER);
    let wanted = (AIM / quantiles).powi(2) - reference.error().powi(2);
    let variance = wanted.max((0.5 * reference.error()).powi(2));
    // A margin for the noise of the pilot.
    let samples = 1.2 * pilot.error().powi(2) / variance * (SEEDS * SAMPLES * pixels) as f64;
    let samples = samples.min(max_rays() / rays) / (FINE.seeds * pixels) as f64;
    (samples.ceil() as u64).max(SAMPLES)
}

/// Every scene of `scenes/` and every published scene that is present, by all integrators that find its
/// light, precisely enough to detect a bias of 0.5% of the median tile where the reference and the number
/// of rays allow. METROLIGHT_SCENE limits it to scenes whose names contain its value.
#[test]
#[ignore = "takes ten minutes: cargo test --release --test references -- --ignored --nocapture"]
fn scenes_equal_their_references_finely() {
    let mut run = Run::new(FINE);
    for (index, entry) in (0..).zip(&manifest()) {
        if !(entry.is_ours() || entry.is_published()) || !entry.is_wanted() {
            continue;
        }
        let scene = entry.load();
        let reference = entry.reference(FINE.tile);
        let integrators = Method::ALL.into_iter().filter(|&integrator| {
            integrator == Method::Path
                || entry.methods == Methods::All
                    && (integrator != Method::Light
                        || lost_light(&scene, TechniqueSet::Light).is_empty())
        });
        for integrator in integrators {
            let mut settings = with_pssmlt(Settings::new(integrator), |own| {
                own.bootstrap = Some(1 << 16);
            });
            let samples = samples_for_aim(&scene, &settings, &reference);
            settings.budget = Budget::SamplesPerPixel(samples);
            let comparison = run.compare((index, entry), &scene, &settings, &reference);
            record_image(
                &format!("{}, {}", entry.name, integrator.name()),
                comparison,
            );
        }
    }
    let (images, tenths) = (run.comparisons.len(), run.tenths());
    let uniform = run.judge();
    let found =
        format!("p-values of {images} images uniform: p = {uniform:.2}; in tenths: {tenths:?}");
    record(
        "accuracy",
        &Accuracy {
            oracle: "Mitsuba 3",
            case: "all of these together",
            found,
            demanded: format!("p >= {UNIFORMITY}"),
        },
    );
}

/// Records the result of the fine form for one image.
fn record_image(case: &str, comparison: &Comparison) {
    let uniform = uniformity([comparison], REPLICATES);
    let [excess, error] = comparison.excess.map(|x| 100.0 * x);
    let [median, worst, image] = comparison.catches().map(|c| 100.0 * c);
    let found = format!(
        "smallest adjusted p {:.4}; p-values uniform: p = {uniform:.2}; image brighter by {excess:.2}% \
         +- {error:.2}%",
        comparison.smallest().0
    );
    let demanded = format!(
        "p >= {}; catches {median:.2}% of a quarter's mean ({worst:.2}% of the worst's), {image:.2}% of \
         the image's",
        FINE.alpha
    );
    record(
        "accuracy",
        &Accuracy {
            oracle: "Mitsuba 3",
            case,
            found,
            demanded,
        },
    );
}
