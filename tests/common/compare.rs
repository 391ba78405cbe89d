//! Images against closed forms and against each other.

use metrolight::render::{Budget, Integrator, Rendering, Settings, Unobserved, render};
use metrolight::scene::Scene;
use metrolight::statistics::{Moments, holm, welch};

use super::tiles::tile_moments;

/// Settings for small images: few chains, a small bootstrap.
pub fn settings(integrator: Integrator, spp: u64) -> Settings {
    Settings {
        budget: Budget::SamplesPerPixel(spp),
        chains: 64,
        bootstrap: Some(4096),
        ..Settings::new(integrator)
    }
}

/// One rendering, in which no contribution may have been left out as no number.
pub fn rendering(scene: &Scene, integrator: Integrator, spp: u64, seed: u64) -> Rendering {
    let settings = Settings {
        seed,
        ..settings(integrator, spp)
    };
    let rendering = render(scene, &settings, &Unobserved).expect("threads");
    let name = integrator.name();
    assert_eq!(rendering.statistics.non_finite, 0, "{name}");
    let pixels = rendering.image.pixels.iter().flatten();
    assert!(pixels.clone().all(|value| value.is_finite()), "{name}");
    rendering
}

/// Mean of the green channel over all pixels.
pub fn mean(rendering: &Rendering) -> f64 {
    let pixels = &rendering.image.pixels;
    pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / pixels.len() as f64
}

/// Moments over `seeds` of the mean over all pixels.
pub fn means(scene: &Scene, integrator: Integrator, spp: u64, seeds: u64) -> Moments {
    (0..seeds)
        .map(|seed| mean(&rendering(scene, integrator, spp, seed)))
        .collect()
}

/// Null hypothesis: the mean over seeds is `truth`, rejected at `alpha`. The standard error has few
/// degrees of freedom, so it is compared as a Welch test with a sample that has no variance.
/// Estimators without variance may differ from the truth by `rounding`, relative.
pub fn assert_mean(name: &str, moments: &Moments, truth: f64, rounding: f64, alpha: f64) {
    if (moments.mean - truth).abs() <= rounding * truth.abs() {
        return;
    }
    let exact = Moments::from_summary(moments.count, truth, 0.0);
    let p = welch(moments, &exact);
    assert!(
        p > alpha,
        "{name}: {} +- {}, should be {truth}: p = {p:e}",
        moments.mean,
        moments.standard_error()
    );
}

/// Null hypothesis, for each tile and channel: both scenes have the same mean. Welch's test for
/// each, Holm's correction over all; rejected at `alpha`. Differences of less than `negligible`,
/// relative, are none. Returns the smallest corrected p-value.
pub fn assert_same_image(name: &str, [a, b]: [&[Moments]; 2], negligible: f64, alpha: f64) -> f64 {
    assert_eq!(a.len(), b.len(), "{name}");
    let p_value = |(a, b): (&Moments, &Moments)| {
        if (a.mean - b.mean).abs() <= negligible * a.mean.abs() {
            1.0
        } else {
            welch(a, b)
        }
    };
    let adjusted = holm(&a.iter().zip(b).map(p_value).collect::<Vec<_>>());
    let (tile, &p) = adjusted
        .iter()
        .enumerate()
        .min_by(|x, y| x.1.total_cmp(y.1))
        .expect("some tiles");
    let (x, y) = (&a[tile], &b[tile]);
    assert!(
        p > alpha,
        "{name}: {} +- {} and {} +- {} differ in tile {}, channel {}: adjusted p = {p:e}",
        x.mean,
        x.standard_error(),
        y.mean,
        y.standard_error(),
        tile / 3,
        tile % 3
    );
    p
}

/// Moments over `seeds` of the means of tiles of `side` x `side` pixels, which no other call with
/// another `group` shares a random number with.
pub fn tiles(
    scene: &Scene,
    integrator: Integrator,
    spp: u64,
    (group, seeds): (u64, u64),
    side: usize,
) -> Vec<Moments> {
    let first = 1000 * group;
    tile_moments(
        scene,
        &settings(integrator, spp),
        first..first + seeds,
        side,
    )
}
