//! For one scene, seed and sample count, images are identical bit for bit on any number of threads.

mod common;

use common::renders::with_pssmlt;
use metrolight::render::{
    Budget, ChoiceReason, Integrator, Method, MmltSettings, Settings, Unobserved, choose, render,
};
use metrolight::scene::Scene;

fn settings(method: Method, threads: usize, seed: u64) -> Settings {
    let settings = Settings {
        budget: Budget::SamplesPerPixel(3),
        threads: Some(threads),
        seed,
        ..Settings::new(method)
    };
    with_pssmlt(settings, |own| own.chains = 37)
}

fn bits(scene: &Scene, settings: &Settings) -> Vec<[u32; 3]> {
    let rendering = render(scene, settings, &Unobserved).expect("threads");
    let pixels = rendering.image.pixels.iter();
    pixels.map(|pixel| pixel.map(f32::to_bits)).collect()
}

#[test]
fn images_do_not_depend_on_the_number_of_threads() {
    // The Gaussian filter is wider than a pixel, so that pixels receive splats from several tiles.
    for scene in [
        "scenes/spheres/scene.xml",
        "tests/references/scenes/gaussian.xml",
    ] {
        let scene = common::load(scene, &[("resx", "57"), ("resy", "41")]);
        for method in Method::ALL {
            let one = bits(&scene, &settings(method, 1, 7));
            for threads in [2, 3, 5] {
                let more = bits(&scene, &settings(method, threads, 7));
                assert!(one == more, "{method:?} on {threads} threads");
            }
            assert!(
                one != bits(&scene, &settings(method, 1, 8)),
                "{method:?}: another seed"
            );
        }
    }
}

/// A render with the plan of the pilot that chose its integrator equals a render that makes its own plan. A
/// plan with another threshold gives another image.
#[test]
fn a_plan_that_is_handed_on_gives_the_same_image() {
    let scene = common::load("scenes/pool/scene.xml", &[("resx", "40"), ("resy", "30")]);
    let own = Settings {
        budget: Budget::SamplesPerPixel(64),
        ..settings(Method::Mmlt, 2, 7)
    };
    let choice = choose(&scene, &own, &MmltSettings::default(), &[], &Unobserved).expect("threads");
    assert!(
        matches!(choice.reason(), ChoiceReason::Gain(_)),
        "{choice:?}"
    );
    let mut handed_on = Settings {
        integrator: choice.integrator,
        ..own.clone()
    };
    assert!(bits(&scene, &own) == bits(&scene, &handed_on));
    let Integrator::Mmlt(MmltSettings {
        plan: Some(plan), ..
    }) = &mut handed_on.integrator
    else {
        panic!("{:?}", handed_on.integrator);
    };
    plan.clamp.threshold *= 1.01;
    assert!(bits(&scene, &own) != bits(&scene, &handed_on));
}
