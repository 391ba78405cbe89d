//! Specular next event estimation: it changes no mean, it finds the light of point lights that nothing else
//! finds, and lamps that shrink to a point approach it.

mod common;
#[path = "specular/flat_water.rs"]
mod flat_water;
#[path = "specular/photon_map.rs"]
mod photon_map;
#[path = "specular/pool.rs"]
mod pool;

use common::scenes::SceneBuilder;
use common::tiles::{assert_same_image, tile_moments};
use glam::DVec3;
use metrolight::math::Rgb;
use metrolight::render::{
    Budget, Integrator, Method, Settings, Strategies, Unobserved, choose_specular, render,
    strategies,
};
use metrolight::scene::{ChainSearch, EmitterDescription, Scene};
use metrolight::technique::Technique;
use pool::{ALBEDO, Light, add_light, pool, pool_under};

/// A glass ball and a glass block on a floor, and a red mirror ball, seen through a pane.
fn room(light: Light, depth: u32) -> SceneBuilder {
    let mut builder = SceneBuilder::seen(
        DVec3::new(0.0, 1.6, 3.0),
        DVec3::new(0.0, 0.2, 0.0),
        40.0,
        [16, 12],
    )
    .depth(depth);
    let glass = builder.glass(1.5);
    let floor = builder.diffuse(ALBEDO);
    builder.floor(DVec3::ZERO, 3.0, floor);
    builder.sphere(DVec3::new(-0.6, 0.5, 0.0), 0.4, glass);
    builder.cube(DVec3::new(0.6, 0.21, 0.1), DVec3::new(0.4, 0.2, 0.3), glass);
    builder.sphere(DVec3::new(0.6, 0.15, 0.1), 0.1, floor);
    add_light(&mut builder, light);
    builder
}

fn without_chains(mut scene: Scene) -> Scene {
    scene.casters.set_search(ChainSearch::Off);
    scene
}

fn settings(integrator: impl Into<Integrator>, spp: u64) -> Settings {
    Settings {
        budget: Budget::SamplesPerPixel(spp),
        ..Settings::of(integrator.into())
    }
}

fn with_chains_everywhere(mut scene: Scene) -> Scene {
    scene.casters.set_search(ChainSearch::Everywhere);
    scene
}

/// Null hypothesis, for tiles of 4 x 4 pixels: the mean is the same with and without technique 1*. 16 seeds.
#[test]
fn no_mean_changes() {
    type Make = fn(Light, u32) -> SceneBuilder;
    let scenes: [(&str, Make); 2] = [("pool", pool), ("room", room)];
    for (name, make) in scenes {
        let light = Light::Sphere(0.5);
        let with = make(light, 6).build();
        let everywhere = with_chains_everywhere(make(light, 6).build());
        let without = without_chains(make(light, 6).build());
        let expected = tile_moments(&without, &settings(Method::Bdpt, 1500), 0..16, 4);
        for (scene, method, spp) in [
            (&with, Method::Bdpt, 200),
            (&with, Method::Path, 300),
            (&with, Method::Mmlt, 100),
            (&everywhere, Method::Bdpt, 100),
            (&everywhere, Method::Mmlt, 60),
        ] {
            let found = tile_moments(scene, &settings(method, spp), 100..116, 4);
            let name = format!("{name}, {}", method.name());
            assert_same_image(&name, [&found, &expected], 0.0, 1e-3);
        }
    }
}

/// Where much light takes chains, pilots choose technique 1* everywhere; in a room with some glass they do not.
#[test]
fn pilots_choose_where_chains_are_sought() {
    for (path, expected) in [
        ("scenes/pool/point.xml", ChainSearch::Everywhere),
        ("scenes/spheres/scene.xml", ChainSearch::Unconnected),
    ] {
        let mut scene = common::load(path, &[]);
        let choice = choose_specular(&mut scene, None).expect("threads");
        let choice = choice.expect("chains");
        assert_eq!(choice.search, expected, "{path}: {choice:?}");
        assert_eq!(scene.casters.search(), expected, "{path}");
    }
    let mut scene = common::load("scenes/cornell/scene.xml", &[]);
    assert_eq!(choose_specular(&mut scene, None).expect("threads"), None);
}

/// Under a point light, chains everywhere and chains where nothing else connects give the same mean: the weights
/// of all techniques sum to 1 where light subpaths go through the water too.
#[test]
fn chains_everywhere_change_no_mean_under_a_point_light() {
    for make in [pool, room] {
        let light = Light::Point;
        let some = make(light, 6).build();
        let all = with_chains_everywhere(make(light, 6).build());
        let [some, all] = [(some, 600), (all, 150)]
            .map(|(scene, spp)| tile_moments(&scene, &settings(Method::Bdpt, spp), 0..16, 4));
        assert_same_image("point light", [&some, &all], 0.0, 1e-3);
    }
}

/// Mean of an image with `spp` samples per pixel.
fn mean(scene: &Scene, method: Method, spp: u64) -> f64 {
    let image = render(scene, &settings(method, spp), &Unobserved)
        .expect("threads")
        .image;
    let sum: f64 = image.pixels.iter().map(|p| f64::from(p[1])).sum();
    sum / image.pixels.len() as f64
}

/// Mean weighted light of paths of 4 edges: E T D T L. The reflection of a lamp in the water has fewer.
fn caustic(scene: &Scene, spp: u64) -> f64 {
    let found = strategies(scene, &settings(Method::Bdpt, spp), &Unobserved).expect("images");
    let images = found.images.iter();
    let caustics = images.filter(|images| images.technique.edges() == 4);
    let pixels = caustics.flat_map(|images| &images.weighted.pixels);
    pixels.map(|p| f64::from(p[1])).sum::<f64>() / (16.0 * 12.0)
}

/// A lamp of radius 1, which is hit often enough: technique 1* finds all light that it does not leave to s = 0. The
/// means have standard errors of 0.1%.
#[test]
fn a_large_lamp_has_the_same_light_without_chains() {
    let lamp = || pool(Light::Sphere(1.0), 4).build();
    let ratio = caustic(&lamp(), 4000) / caustic(&without_chains(lamp()), 20_000);
    assert!((ratio - 1.0).abs() < 5e-3, "ratio {ratio}");
}

/// A sphere 1000 times as far away as the scene is large, as wide as the sun, gives the light of a directional emitter.
#[test]
fn a_distant_sun_is_a_directional_light() {
    let toward = DVec3::new(0.1, 1.0, -0.05).normalize();
    let directional = pool_under(4, |builder| {
        builder.emitters.push(EmitterDescription::Directional {
            direction: -toward,
            irradiance: Rgb::ONE,
        });
    });
    let (distance, radius): (f64, f64) = (3000.0, 14.0);
    let sphere = pool_under(4, |builder| {
        let black = builder.diffuse(0.0);
        let radiance = (distance / radius).powi(2) / std::f64::consts::PI;
        let sun = builder.sphere(toward * distance, radius, black);
        common::scenes::emit(sun, radiance as f32);
    });
    let ratio = caustic(&sphere.build(), 3000) / caustic(&directional.build(), 3000);
    assert!((ratio - 1.0).abs() < 5e-3, "ratio {ratio}");
}

/// The means have standard errors of less than 0.1%.
#[test]
fn small_lamps_approach_a_point_light() {
    let point = caustic(&pool(Light::Point, 4).build(), 4000);
    for radius in [0.1, 0.01, 1e-3, 1e-4] {
        let lamp = caustic(&pool(Light::Sphere(radius), 4).build(), 4000);
        let ratio = lamp / point;
        assert!((ratio - 1.0).abs() < 5e-3, "radius {radius}: ratio {ratio}");
    }
    let off = caustic(&without_chains(pool(Light::Point, 4).build()), 10);
    assert_eq!(off, 0.0);
}

/// The scene may be of any size and anywhere.
#[test]
fn scale_and_place_do_not_matter() {
    let reference = mean(&pool(Light::Point, 4).build(), Method::Bdpt, 1000);
    for (scale, offset) in [(1e-3, DVec3::ZERO), (1e3, DVec3::new(2e3, -1e3, 5e2))] {
        let scene = pool(Light::Point, 4).placed(scale, offset).build();
        let ratio = mean(&scene, Method::Bdpt, 1000) / reference;
        assert!((ratio - 1.0).abs() < 0.01, "scale {scale}: ratio {ratio}");
    }
}

/// Techniques s = 0 and 1* alone, without weights, estimate the same light of paths of 4 edges.
#[test]
fn both_techniques_alone_agree() {
    let scene = pool(Light::Sphere(0.5), 4).build();
    let Strategies { images, .. } =
        strategies(&scene, &settings(Method::Bdpt, 20_000), &Unobserved).expect("images");
    let mean = |technique: Technique| {
        let image = images.iter().find(|images| images.technique == technique);
        let pixels = &image.expect("the technique").unweighted.pixels;
        pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / pixels.len() as f64
    };
    let hit = mean(Technique::Hit { t: 5 });
    let specular = mean(Technique::Specular { t: 3, n: 1 });
    // s = 0 also finds the light of chains that 1* does not seek: there are none.
    assert!((specular / hit - 1.0).abs() < 0.02, "{specular} {hit}");
}
