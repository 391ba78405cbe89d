//! Renderings over seeds, and their means.

use std::ops::Range;

use metrolight::render::{
    Budget, Integrator, Method, PssmltSettings, Rendering, Settings, Unobserved, render,
};
use metrolight::scene::Scene;
use metrolight::statistics::Moments;

/// Settings for small images: few chains, a small bootstrap.
pub fn settings(method: Method, spp: u64) -> Settings {
    let integrator = match method {
        Method::Pssmlt => pssmlt(64, 4096),
        _ => method.into(),
    };
    Settings {
        budget: Budget::SamplesPerPixel(spp),
        ..Settings::of(integrator)
    }
}

/// `settings` with other settings of `pssmlt`; unchanged for other integrators.
pub fn with_pssmlt(mut settings: Settings, change: impl FnOnce(&mut PssmltSettings)) -> Settings {
    if let Integrator::Pssmlt(own) = &mut settings.integrator {
        change(own);
    }
    settings
}

/// `pssmlt` with so many chains and bootstrap samples.
pub fn pssmlt(chains: u64, bootstrap: u64) -> Integrator {
    Integrator::Pssmlt(PssmltSettings {
        chains,
        bootstrap: Some(bootstrap),
        ..PssmltSettings::default()
    })
}

/// One rendering for each of `seeds`; `settings` gives everything else.
pub fn renderings<'a>(
    scene: &'a Scene,
    settings: &Settings,
    seeds: Range<u64>,
) -> impl Iterator<Item = Rendering> + use<'a> {
    let settings = settings.clone();
    seeds.map(move |seed| {
        let settings = Settings {
            seed,
            ..settings.clone()
        };
        render(scene, &settings, &Unobserved).expect("threads")
    })
}

/// One rendering with [`settings`], whose values are all finite and in which no contribution was left out
/// because it was not.
pub fn rendering(scene: &Scene, integrator: Method, spp: u64, seed: u64) -> Rendering {
    let settings = settings(integrator, spp);
    let rendering = renderings(scene, &settings, seed..seed + 1).next();
    let rendering = rendering.expect("one seed");
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
pub fn means(scene: &Scene, integrator: Method, spp: u64, seeds: u64) -> Moments {
    (0..seeds)
        .map(|seed| mean(&rendering(scene, integrator, spp, seed)))
        .collect()
}
