//! Specular next event estimation: it changes no mean, it finds the light of point lights that nothing else
//! finds, and lamps that shrink to a point approach it.

mod common;

use common::scenes::{SceneBuilder, emit};
use common::tiles::{assert_same_image, tile_moments};
use glam::{DMat4, DVec3, Vec3A};
use metrolight::math::Rgb;
use metrolight::render::{
    Budget, Integrator, Method, Settings, Strategies, Unobserved, render, strategies,
};
use metrolight::sampling::seeds::{self, Purpose};
use metrolight::scene::{
    Casters, EmitterDescription, Ray, RayCounts, Scene, SurfacePoint, TriangleMesh,
};
use metrolight::technique::Technique;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

const LAMP: DVec3 = DVec3::new(0.3, 2.2, -0.2);
const INTENSITY: f64 = 10.0;
const WATER: f64 = 1.33;

/// A light at [`LAMP`].
#[derive(Clone, Copy, Debug)]
enum Light {
    Point,
    /// A sphere of this radius that emits as much as the point light.
    Sphere(f64),
}

fn add_light(builder: &mut SceneBuilder, light: Light) {
    match light {
        Light::Point => builder.emitters.push(EmitterDescription::Point {
            position: LAMP,
            intensity: Rgb::splat(INTENSITY as f32),
        }),
        Light::Sphere(radius) => {
            let black = builder.diffuse(0.0);
            let radiance = INTENSITY / (std::f64::consts::PI * radius * radius);
            emit(builder.sphere(LAMP, radius, black), radiance as f32);
        }
    }
}

/// The height of the water at (x, z).
fn wave(x: f64, z: f64) -> f64 {
    0.05 * (3.0 * x + 0.4).sin() * (2.5 * z).cos() + 0.02 * (6.0 * z - 4.0 * x).sin()
}

/// Water over [-2, 2]^2 around y = 0, with normals.
fn water(n: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let at = |i: u32| -2.0 + 4.0 * f64::from(i) / f64::from(n);
    for i in 0..=n {
        for j in 0..=n {
            let (x, z) = (at(i), at(j));
            mesh.positions.push([x as f32, wave(x, z) as f32, z as f32]);
            let step = 1e-4;
            let dx = (wave(x + step, z) - wave(x - step, z)) / (2.0 * step);
            let dz = (wave(x, z + step) - wave(x, z - step)) / (2.0 * step);
            let normal = DVec3::new(-dx, 1.0, -dz).normalize();
            mesh.normals.push(normal.as_vec3().to_array());
        }
    }
    for i in 0..n {
        for j in 0..n {
            let a = i * (n + 1) + j;
            mesh.triangles.push([a, a + 1, a + n + 2]);
            mesh.triangles.push([a, a + n + 2, a + n + 1]);
        }
    }
    mesh
}

const FLOOR: f64 = -1.0;
const ALBEDO: f32 = 0.5;

/// A floor under water, seen from above the water: light reaches the image only as E T D T L if paths have at
/// most 4 edges.
fn pool(light: Light, depth: u32) -> SceneBuilder {
    let mut builder = SceneBuilder::seen(
        DVec3::new(0.2, 2.6, 1.6),
        DVec3::new(0.0, -0.6, 0.0),
        32.0,
        [16, 12],
    )
    .depth(depth);
    let glass = builder.glass(WATER as f32);
    let floor = builder.diffuse(ALBEDO);
    builder.mesh(water(40), DMat4::IDENTITY, glass);
    builder.floor(DVec3::new(0.0, FLOOR, 0.0), 2.0, floor);
    add_light(&mut builder, light);
    builder
}

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
    scene.casters = Casters::none();
    scene
}

fn settings(integrator: impl Into<Integrator>, spp: u64) -> Settings {
    Settings {
        budget: Budget::SamplesPerPixel(spp),
        ..Settings::of(integrator.into())
    }
}

fn with_chains_everywhere(mut scene: Scene) -> Scene {
    scene.casters.set_everywhere(true);
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

/// Photons on the floor: an oracle that shares nothing with technique 1* but the intersection of rays.
struct PhotonMap {
    cells: Vec<f64>,
}

const CELLS: usize = 256;
const PHOTONS: usize = 6_000_000;

/// Refraction at a surface, and the fraction that is not reflected (Born and Wolf, section 1.5).
fn refract(direction: DVec3, normal: DVec3) -> Option<(DVec3, f64)> {
    let cos_i = -direction.dot(normal);
    let (normal, cos_i, ratio) = if cos_i > 0.0 {
        (normal, cos_i, 1.0 / WATER)
    } else {
        (-normal, -cos_i, WATER)
    };
    let sin2_t = ratio * ratio * (1.0 - cos_i * cos_i);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let refracted = direction * ratio + normal * (ratio * cos_i - cos_t);
    let s = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t);
    let p = (ratio * cos_t - cos_i) / (ratio * cos_t + cos_i);
    Some((refracted, 1.0 - 0.5 * (s * s + p * p)))
}

fn hit(scene: &Scene, origin: Vec3A, direction: DVec3) -> Option<SurfacePoint> {
    let ray = Ray {
        origin,
        direction: direction.as_vec3a(),
        t_max: f32::INFINITY,
    };
    scene.geometry.intersect(&ray, &mut RayCounts::default())
}

/// From above the water to the floor: the point in world coordinates and the transmitted fraction.
fn through_water(scene: &Scene, from: DVec3, direction: DVec3) -> Option<(DVec3, f64)> {
    let origin = ((from - scene.center) / scene.unit).as_vec3a();
    let surface = hit(scene, origin, direction)?;
    if surface.shape != 0 {
        return None;
    }
    let (below, fraction) = refract(direction, surface.shading.n.as_dvec3())?;
    let floor = hit(scene, surface.ray_origin(below.as_vec3a()), below)?;
    (floor.shape == 1).then(|| (scene.to_world(floor.position), fraction))
}

fn uniform_direction(rng: &mut Xoshiro256PlusPlus) -> DVec3 {
    let z = 2.0 * rng.random::<f64>() - 1.0;
    let (sin, cos) = (std::f64::consts::TAU * rng.random::<f64>()).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

impl PhotonMap {
    fn new(scene: &Scene) -> Self {
        let mut cells = vec![0.0; CELLS * CELLS];
        let mut rng = seeds::generator(3, Purpose::Tests, 0);
        let power = 4.0 * std::f64::consts::PI * INTENSITY / PHOTONS as f64;
        let area = (4.0 / CELLS as f64).powi(2);
        for _ in 0..PHOTONS {
            let direction = uniform_direction(&mut rng);
            if let Some((point, fraction)) = through_water(scene, LAMP, direction)
                && let Some(cell) = Self::cell(point)
            {
                cells[cell] += power * fraction / area;
            }
        }
        Self { cells }
    }

    fn cell(point: DVec3) -> Option<usize> {
        let [i, j] = [point.x, point.z].map(|x| ((x + 2.0) / 4.0 * CELLS as f64).floor());
        let inside = |i: f64| i >= 0.0 && i < CELLS as f64;
        (inside(i) && inside(j)).then_some(i as usize * CELLS + j as usize)
    }

    /// Radiance toward the camera through a film position.
    fn radiance(&self, scene: &Scene, film: glam::Vec2) -> f64 {
        let (ray, _) = scene.camera.ray(film, glam::Vec2::ZERO);
        let from = scene.to_world(ray.origin);
        let seen = through_water(scene, from, ray.direction.as_dvec3());
        let Some((point, fraction)) = seen else {
            return 0.0;
        };
        let irradiance = Self::cell(point).map_or(0.0, |cell| self.cells[cell]);
        // Radiance above the water is that below over the squared index.
        fraction * irradiance * f64::from(ALBEDO) / std::f64::consts::PI / (WATER * WATER)
    }
}

/// Under a point light, every tile of 4 x 4 pixels agrees with the photon map within 2%: its cells are 0.016
/// wide, and each tile holds some 10^5 photons.
#[test]
fn point_lights_agree_with_a_photon_map() {
    let scene = pool(Light::Point, 4).build();
    let map = PhotonMap::new(&scene);
    let [width, height] = [16, 12];
    let mut rng = seeds::generator(5, Purpose::Tests, 0);
    let found = tile_moments(&scene, &settings(Method::Bdpt, 1000), 0..4, 4);
    for (tile, moments) in found.chunks(3).map(|channels| channels[1]).enumerate() {
        let corner = [tile % (width / 4), tile / (width / 4)].map(|i| (4 * i) as f32);
        let n = 40_000;
        let sum: f64 = (0..n)
            .map(|_| {
                let x = (corner[0] + 4.0 * rng.random::<f32>()) / width as f32;
                let y = (corner[1] + 4.0 * rng.random::<f32>()) / height as f32;
                map.radiance(&scene, glam::Vec2::new(x, y))
            })
            .sum();
        let expected = sum / f64::from(n);
        let ratio = moments.mean / expected;
        assert!(
            (ratio - 1.0).abs() < 0.02,
            "tile {tile}: ratio {ratio}, {expected}"
        );
    }
}
