//! Markov chains in difficult cases: light that hardly any sample finds, islands that small steps cannot
//! cross, chains that never move.
//!
//! Statistical tests have fixed seeds and reject at ALPHA: a correct program fails a comparison with that
//! probability for a new choice of seeds.

use glam::{DMat4, DVec3};
use metrolight::render::{Budget, Method, Rendering, Settings, Unobserved, Warning, render};
use metrolight::scene::{ChainSearch, Scene, TriangleMesh};
use metrolight::statistics::{Moments, normal_two_sided, welch};

use super::rooms::{add_glass_ball, add_lamp, behind_two_panes, room};
use crate::common::renders::renderings;
use crate::common::renders::with_pssmlt;
use crate::common::scenes::{SceneBuilder, emit};
use crate::records::{ALPHA, row, told};

fn pssmlt(spp: u64) -> Settings {
    with_pssmlt(
        Settings {
            budget: Budget::SamplesPerPixel(spp),
            ..Settings::new(Method::Pssmlt)
        },
        |own| {
            own.bootstrap = Some(10_000);
        },
    )
}

fn run(scene: &Scene, settings: &Settings) -> Rendering {
    render(scene, settings, &Unobserved).expect("threads")
}

/// Mean of the first channel over all pixels.
fn mean(rendering: &Rendering) -> f64 {
    let pixels = &rendering.image.pixels;
    pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / pixels.len() as f64
}

/// Renders with `seeds` seeds, on one thread each: most of them are short.
fn renders(scene: &Scene, settings: &Settings, seeds: u64) -> Vec<Rendering> {
    let range = settings.seed..settings.seed + seeds;
    let settings = Settings {
        threads: Some(1),
        ..settings.clone()
    };
    renderings(scene, &settings, range).collect()
}

/// Moments of `value` over renders.
fn moments(renders: &[Rendering], value: impl Fn(&Rendering) -> f64) -> Moments {
    renders.iter().map(value).collect()
}

/// Null hypothesis: the mean over seeds is `truth`. There are enough seeds for a z-test.
fn assert_mean(what: &str, moments: &Moments, truth: f64) {
    let p = normal_two_sided((moments.mean - truth) / moments.standard_error());
    let error = moments.standard_error();
    println!(
        "{what}: {} +- {error}, truth {truth}, p = {p:.1e}",
        moments.mean
    );
    assert!(
        p > ALPHA,
        "{what}: {} +- {error} is not {truth}",
        moments.mean
    );
}

fn stability(case: &str, happens: String, warnings: &[Warning]) {
    row(case, "pssmlt", happens, told(warnings));
}

/// Two emitting squares parallel to a film of 2 x 1 pixels: the left covers the fraction `areas[0]` of its
/// pixel with radiance `radiances[0]`, and the right likewise. There are only paths of one edge, so every
/// value is known: pixel i is areas[i] radiances[i]. The gap between them is wider than any small step.
fn islands(areas: [f64; 2], radiances: [f64; 2]) -> Scene {
    let mut builder = SceneBuilder::seen(DVec3::ZERO, DVec3::NEG_Z, 90.0, [2, 1]).depth(1);
    builder.near_clip = 1e-2;
    let black = builder.diffuse(0.0);
    for (i, x) in [-0.5, 0.5].into_iter().enumerate() {
        // At distance 1 under 90 degrees the film spans [-1, 1] x [-0.5, 0.5].
        let half = DVec3::splat(0.5 * areas[i].sqrt());
        let to_world = DMat4::from_translation(DVec3::new(x, 0.0, -1.0)) * DMat4::from_scale(half);
        let square = builder.mesh(TriangleMesh::rectangle(), to_world, black);
        emit(square, radiances[i] as f32);
    }
    builder.build()
}

/// A room with a lamp and a ball of glass.
fn room_with_ball() -> Scene {
    let mut builder = room();
    add_lamp(&mut builder, 0.2, DVec3::new(0.0, 2.2, 0.0));
    add_glass_ball(&mut builder, 0.5, DVec3::new(0.5, 0.5, 0.0));
    builder.build()
}

fn pixel(i: usize) -> impl Fn(&Rendering) -> f64 {
    move |rendering| f64::from(rendering.image.pixels[i][0])
}

#[test]
fn no_light_at_all_is_a_black_image_and_a_warning() {
    // A lamp in a box without windows.
    let mut builder = room();
    add_lamp(&mut builder, 0.1, DVec3::Y * 2.2);
    let walls = builder.diffuse_sheet(0.5);
    builder.cube(DVec3::Y * 2.2, DVec3::splat(0.4), walls);
    let rendering = run(&builder.build(), &pssmlt(4));
    assert!(rendering.image.pixels.iter().flatten().all(|&v| v == 0.0));
    let [warning] = &rendering.warnings[..] else {
        panic!("one warning: {:?}", rendering.warnings);
    };
    assert_eq!(*warning, Warning::NoLightInBootstrap { samples: 10_000 });
    stability(
        "no light at all",
        "a black image".into(),
        &rendering.warnings,
    );
}

#[test]
fn light_that_few_bootstrap_samples_find_gives_a_warning() {
    let mut scene = behind_two_panes(0.004);
    // Technique 1* would find it.
    scene.casters.set_search(ChainSearch::Off);
    let settings = with_pssmlt(pssmlt(16), |own| {
        own.bootstrap = Some(100_000);
    });
    // Some bootstraps find the light and some do not; either gives a warning.
    let renderings = renders(&scene, &settings, 8);
    for rendering in &renderings {
        let warning = rendering.warnings.first().expect("a warning");
        assert!(
            matches!(
                warning,
                Warning::NormalisationUncertain { .. } | Warning::NoLightInBootstrap { .. }
            ),
            "{warning:?}"
        );
        assert!(
            rendering
                .image
                .pixels
                .iter()
                .flatten()
                .all(|v| v.is_finite())
        );
    }
    let found = renderings.iter().filter(|r| mean(r) > 0.0).count();
    let told = renderings
        .iter()
        .find(|r| mean(r) > 0.0)
        .map_or(&[][..], |r| &r.warnings);
    stability(
        "light found by 1 bootstrap sample in 10^5",
        format!("{found} of 8 seeds find it; the others are black"),
        told,
    );
}

/// A similar case whose truth is known: an island that a bootstrap of 1000 finds once on average. The mean
/// over black and bright images is unbiased.
#[test]
fn images_with_a_rare_light_are_unbiased_in_the_mean() {
    let scene = islands([2e-3, 1e-12], [1.0, 1e-3]);
    let settings = with_pssmlt(pssmlt(64), |own| {
        own.bootstrap = Some(1000);
        own.chains = 8;
    });
    let renders = renders(&scene, &settings, 3000);
    let moments = moments(&renders, pixel(0));
    assert_mean("rare island", &moments, 2e-3);
    let is_black = |r: &Rendering| f64::from(u8::from(pixel(0)(r) == 0.0));
    let black: Moments = renders.iter().map(is_black).collect();
    assert!((0.2..0.6).contains(&black.mean), "{} are black", black.mean);
    stability(
        "an island that a bootstrap finds once on the average",
        format!(
            "{:.0}% of images are black, the mean of all is {:.3} +- {:.3} of the truth",
            100.0 * black.mean,
            moments.mean / 2e-3,
            moments.standard_error() / 2e-3
        ),
        &[],
    );
}

#[test]
fn islands_that_small_steps_cannot_cross() {
    let scene = islands([0.04, 0.01], [1.0, 4.0]);
    for (p_large, chains) in [(0.0, 64), (0.0, 1), (0.3, 1), (0.3, 64), (1.0, 1)] {
        let settings = with_pssmlt(pssmlt(256), |own| {
            own.large_step_probability = p_large;
            own.chains = chains;
            own.bootstrap = Some(2000);
        });
        let renders = renders(&scene, &settings, 400);
        for i in 0..2 {
            let moments = moments(&renders, pixel(i));
            assert_mean(
                &format!("p {p_large}, {chains} chains, island {i}"),
                &moments,
                0.04,
            );
            if p_large == 0.0 {
                stability(
                    &format!(
                        "two islands, p_large = 0, {chains} chains, island {}",
                        i + 1
                    ),
                    format!(
                        "right in the mean; one image is off by {:.0}%",
                        100.0 * moments.variance().sqrt() / 0.04
                    ),
                    &[],
                );
            }
        }
    }
}

/// The dim island has 10^-6 of the light, and only large steps find it: its error is that of Monte Carlo
/// with as many independent samples as there are large steps and bootstrap samples.
#[test]
fn an_island_a_million_times_brighter_does_not_hide_the_other() {
    let scene = islands([0.25, 0.25], [1.0, 1e6]);
    let settings = with_pssmlt(pssmlt(2048), |own| {
        own.chains = 16;
        own.bootstrap = Some(2000);
    });
    let renders = renders(&scene, &settings, 100);
    let dim = moments(&renders, pixel(0));
    assert_mean("dim island", &dim, 0.25);
    let bright = moments(&renders, pixel(1));
    assert_mean("bright island", &bright, 0.25e6);
    // p M = 1229 large steps, an eighth of which hit the island: 1/sqrt(154) = 8%. The weights of the chain
    // contribute nothing there.
    let error = dim.variance().sqrt() / 0.25;
    assert!(error < 0.12, "{error}");
    stability(
        "one island 10^6 brighter than the other",
        format!(
            "both right in the mean; the dim one has an error of {:.1}% with 1229 large steps",
            100.0 * error
        ),
        &[],
    );
}

/// p_large = 0 and 1, one chain and many: all agree with bidirectional path tracing.
#[test]
fn extremes_of_large_steps_and_of_chains_agree_with_bdpt() {
    let scene = room_with_ball();
    let bdpt = Settings {
        budget: Budget::SamplesPerPixel(16),
        ..Settings::new(Method::Bdpt)
    };
    let truth = moments(&renders(&scene, &bdpt, 24), mean);
    for (p_large, chains) in [(0.0, 1024), (1.0, 1024), (0.3, 1), (0.3, 100_000)] {
        let settings = with_pssmlt(
            Settings {
                seed: 1000,
                ..pssmlt(if chains > 10_000 { 300 } else { 16 })
            },
            |own| {
                own.large_step_probability = p_large;
                own.chains = chains;
            },
        );
        let seeds = if chains > 10_000 { 6 } else { 24 };
        let ours = moments(&renders(&scene, &settings, seeds), mean);
        let p = welch(&ours, &truth);
        println!(
            "p {p_large}, {chains} chains: {} and {}, p = {p:.1e}",
            ours.mean, truth.mean
        );
        assert!(
            p > ALPHA,
            "p {p_large}, {chains} chains: {} for {}",
            ours.mean,
            truth.mean
        );
        stability(
            &format!("p_large = {p_large}, {chains} chains"),
            format!(
                "mean {:.4} +- {:.4} of that of bdpt",
                ours.mean / truth.mean,
                ours.standard_error() / truth.mean
            ),
            &[],
        );
    }
}

/// Chains start from N bootstrap samples in proportion to I: the expected share of chains that start on the
/// left island, which is its share of the light in the image, is a ratio of two means over N samples. Its
/// bias is
/// (q v - k)/N to first order, with q the true share, v = E[I^2]/b^2 and k = E[I 1_left I]/b^2
/// (Cochran 1977, "Sampling techniques", section 6.8): it falls as 1/N.
#[test]
fn start_up_bias_falls_as_one_over_the_bootstrap() {
    let (areas, radiances) = ([0.4, 0.1], [1.0, 12.0]);
    let scene = islands(areas, radiances);
    // The film has two pixels: an island covers half its area of it.
    let first: f64 = (0..2).map(|i| 0.5 * areas[i] * radiances[i]).sum();
    let squares = [0, 1].map(|i| 0.5 * areas[i] * radiances[i] * radiances[i] / (first * first));
    let share = 0.5 * areas[0] * radiances[0] / first;
    let constant = share * (squares[0] + squares[1]) - squares[0];
    for (n, seeds) in [(32, 6000), (64, 12_000), (128, 24_000)] {
        let settings = with_pssmlt(pssmlt(16), |own| {
            own.large_step_probability = 0.0;
            own.chains = 32;
            own.bootstrap = Some(n);
        });
        // A bootstrap that finds neither island, one in 10^4 of 32 samples, is left out.
        let moments: Moments = renders(&scene, &settings, seeds)
            .iter()
            .map(|rendering| [0, 1].map(|i| pixel(i)(rendering)))
            .filter(|light| light[0] + light[1] > 0.0)
            .map(|light| light[0] / (light[0] + light[1]))
            .collect();
        let predicted = constant / n as f64;
        let bias = moments.mean - share;
        let error = moments.standard_error();
        println!("N = {n}: bias {bias:.5} +- {error:.5}, predicted {predicted:.5}");
        // The next order is about v/N of the first; allow twice that.
        let next_order = 2.0 * predicted.abs() * (squares[0] + squares[1]) / n as f64;
        assert!(bias > 5.0 * error, "N = {n}: the bias is not significant");
        assert!(
            (bias - predicted).abs() < 4.0 * error + next_order,
            "N = {n}: {bias} for {predicted}"
        );
        stability(
            &format!("a bootstrap of {n}, no large step"),
            format!(
                "the dim island's share of the light is biased by {bias:.4} +- {error:.4}; first order predicts {predicted:.4}"
            ),
            &[],
        );
    }
}

#[test]
fn no_mutation_after_the_bootstrap_is_a_black_image() {
    let scene = islands([0.25, 0.25], [1.0, 1.0]);
    let rendering = run(&scene, &pssmlt(0));
    assert_eq!(rendering.statistics.samples, 0);
    assert!(rendering.image.pixels.iter().flatten().all(|&v| v == 0.0));
    assert!(
        rendering.warnings.contains(&Warning::NoMutations),
        "{:?}",
        rendering.warnings
    );
    stability(
        "0 mutations after the bootstrap",
        "a black image".into(),
        &rendering.warnings,
    );
}

/// A chain on a spike rejects nearly all proposals of large steps.
#[test]
fn a_chain_that_never_accepts_is_reported() {
    let scene = islands([0.5, 1e-3], [1.0, 1e9]);
    let settings = with_pssmlt(pssmlt(4000), |own| {
        own.large_step_probability = 1.0;
        own.chains = 4;
    });
    let rendering = run(&scene, &settings);
    let metropolis = rendering.statistics.pssmlt.as_ref().expect("pssmlt");
    assert!(metropolis.stuck_chains > 0);
    assert!(
        rendering
            .warnings
            .iter()
            .any(|w| matches!(w, Warning::StuckChains { .. }))
    );
    // Large steps still estimate the rest of the image without bias.
    let moments = moments(&renders(&scene, &settings, 60), pixel(0));
    assert_mean("beside the spike", &moments, 0.5);
    stability(
        "chains on a spike, p_large = 1",
        format!(
            "{} of {} chains never move for {} mutations; the rest of the image is right ({:.3} +- {:.3} of the truth)",
            metropolis.stuck_chains,
            metropolis.chains,
            metropolis.longest_rejection_run,
            moments.mean / 0.5,
            moments.standard_error() / 0.5
        ),
        &rendering.warnings,
    );
}

/// The differences between images of 80 seeds match their estimated errors: over all pixels the variance
/// between seeds equals the mean of the squared standard errors, within a quarter.
#[test]
fn eighty_seeds_differ_by_their_estimated_errors() {
    let scene = room_with_ball();
    let mut pixels: Vec<Moments> = Vec::new();
    let mut expected = Moments::default();
    let settings = Settings {
        error: true,
        ..pssmlt(64)
    };
    for rendering in renderings(&scene, &settings, 0..80) {
        pixels.resize(rendering.image.pixels.len(), Moments::default());
        for (moments, pixel) in pixels.iter_mut().zip(&rendering.image.pixels) {
            moments.add(f64::from(pixel[1]));
        }
        for error in &rendering.error.expect("groups").standard_errors {
            expected.add(f64::from(error[1]).powi(2));
        }
    }
    let between: Moments = pixels.iter().map(Moments::variance).collect();
    let ratio = between.mean / expected.mean;
    println!("variance between seeds over the estimated one: {ratio}");
    assert!((0.75..1.33).contains(&ratio), "{ratio}");
    stability(
        "flicker over 80 seeds",
        format!("the variance between images is {ratio:.2} of the one that they estimate"),
        &[],
    );
}
