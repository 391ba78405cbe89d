//! For one scene, seed and sample count, images are identical bit for bit on any number of threads.

mod common;

use common::renders::with_pssmlt;
use metrolight::render::{Budget, Method, Settings, Unobserved, render};
use metrolight::scene::Scene;

fn bits(scene: &Scene, integrator: Method, threads: usize, seed: u64) -> Vec<[u32; 3]> {
    let settings = with_pssmlt(
        Settings {
            budget: Budget::SamplesPerPixel(3),
            threads: Some(threads),
            seed,
            ..Settings::new(integrator)
        },
        |own| {
            own.chains = 37;
        },
    );
    let image = render(scene, &settings, &Unobserved)
        .expect("threads")
        .image;
    image
        .pixels
        .iter()
        .map(|pixel| pixel.map(f32::to_bits))
        .collect()
}

#[test]
fn images_do_not_depend_on_the_number_of_threads() {
    // The Gaussian filter is wider than a pixel, so that pixels receive splats from several tiles.
    for scene in [
        "scenes/spheres/scene.xml",
        "tests/references/scenes/gaussian.xml",
    ] {
        let scene = common::load(scene, &[("resx", "57"), ("resy", "41")]);
        for integrator in Method::ALL {
            let one = bits(&scene, integrator, 1, 7);
            for threads in [2, 3, 5] {
                let more = bits(&scene, integrator, threads, 7);
                assert!(one == more, "{integrator:?} on {threads} threads");
            }
            assert!(
                one != bits(&scene, integrator, 1, 8),
                "{integrator:?}: another seed"
            );
        }
    }
}
