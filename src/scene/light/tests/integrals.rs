//! Compares estimates with closed forms, within 4.5 standard errors of the mean: one false alarm in 1.5e5
//! seeds.

use std::f64::consts::PI;

use super::*;
use crate::statistics::Moments;

fn check(name: &str, estimate: &Moments, expected: f64) {
    let error = (estimate.mean - expected).abs();
    let bound = 4.5 * estimate.standard_error() + 5e-4 * expected.abs();
    assert!(
        error < bound,
        "{name}: {} +- {}, not {expected}",
        estimate.mean,
        estimate.standard_error()
    );
}

/// Irradiance (green) at a point in world coordinates with the normal `normal`, by direct sampling.
fn irradiance(scene: &Scene, world: DVec3, normal: Vec3A, samples: u32) -> Moments {
    let point = to_scene(scene, world);
    let mut numbers = Numbers::new(41);
    let estimate = |sample: LightSample| {
        let cos = sample.direction.dot(normal).max(0.0);
        let emission = sample.emission;
        f64::from(emission.radiance.y * sample.jacobian_direction * cos / emission.pdf_direct)
    };
    (0..samples)
        .map(|_| sample_direct(scene, point, &mut numbers).map_or(0.0, estimate))
        .collect()
}

/// E = pi L (r/d)^2 cos for a sphere above the horizon, at several sizes and distances.
#[test]
fn irradiance_from_a_sphere() {
    for (radius, distance, tilt) in [
        (0.7, 1.0, 0.2),
        (0.7, 0.75, 0.0),
        (1e-3, 2.0, 1.0),
        (1.0, 50.0, 0.5),
    ] {
        let lamp = emitting(sphere(DVec3::ZERO, radius), RADIANCE);
        let scene = scene(vec![lamp, floor()], vec![]);
        let normal = Vec3A::new(f32::sin(tilt), 0.0, -f32::cos(tilt));
        let estimate = irradiance(&scene, DVec3::new(0.0, 0.0, distance), normal, 20_000);
        let ratio: f64 = radius / distance;
        let expected = PI * f64::from(RADIANCE.y) * ratio * ratio * f64::from(tilt).cos();
        check(
            &format!("r = {radius}, d = {distance}"),
            &estimate,
            expected,
        );
    }
}

/// Form factor of a square of side 2a at distance d, centred over a parallel receiver: four times the
/// corner form factor with X = Y = a/d (Howell, "A catalog of radiation heat transfer configuration factors", B-3).
fn square_factor(a: f64, d: f64) -> f64 {
    let x = a / d;
    let root = (1.0 + x * x).sqrt();
    4.0 / (2.0 * PI) * 2.0 * x / root * (x / root).atan()
}

#[test]
fn irradiance_from_a_rectangle() {
    for distance in [0.2, 1.0, 30.0] {
        let lamp = emitting(mesh(TriangleMesh::rectangle(), DMat4::IDENTITY), RADIANCE);
        let scene = scene(vec![lamp, floor()], vec![]);
        let estimate = irradiance(
            &scene,
            DVec3::new(0.0, 0.0, distance),
            Vec3A::NEG_Z,
            100_000,
        );
        let expected = PI * f64::from(RADIANCE.y) * square_factor(1.0, distance);
        check(&format!("d = {distance}"), &estimate, expected);
    }
}

/// Irradiance from a point light is I/d^2 in the units of the world, whatever these are and wherever the
/// origin is.
#[test]
fn irradiance_does_not_depend_on_the_units_or_origin_of_the_world() {
    for (scale, offset) in [(1e-3, 0.0), (1.0, 0.0), (1e3, 0.0), (1e-3, 1e4)] {
        let offset = DVec3::new(0.0, 0.0, offset + scale / 7.0);
        let change = DMat4::from_translation(offset) * DMat4::from_scale(DVec3::splat(scale));
        let mut ground = floor();
        ground.to_world = change * ground.to_world;
        let light = EmitterDescription::Point {
            position: offset + DVec3::new(0.0, 0.0, 2.0 * scale),
            intensity: Rgb::splat(5.0 * (scale * scale) as f32),
        };
        let scene = scene(
            vec![
                ground,
                emitting(mesh(TriangleMesh::rectangle(), change), Rgb::splat(1e-9)),
            ],
            vec![light],
        );
        let estimate = irradiance(&scene, offset, Vec3A::Z, 1_000);
        check(&format!("{scale}, {offset}"), &estimate, 5.0 / 4.0);
    }
}

/// Irradiance from environments: pi L from a constant one; from an image, the integral by the midpoint
/// rule.
#[test]
fn irradiance_from_an_environment() {
    let constant = EmitterDescription::Constant { radiance: RADIANCE };
    let uniform = scene(vec![floor()], vec![constant]);
    let estimate = irradiance(&uniform, DVec3::ZERO, Vec3A::Z, 100_000);
    check("constant", &estimate, PI * f64::from(RADIANCE.y));

    let image = scene(vec![floor()], vec![sky()]);
    let (rows, columns) = (700, 700);
    let mut expected = 0.0;
    for i in 0..rows {
        for j in 0..columns {
            let z = (f64::from(i) + 0.5) / f64::from(rows);
            let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(columns);
            let r = (1.0 - z * z).sqrt();
            let direction = DVec3::new(r * phi.cos(), r * phi.sin(), z).as_vec3a();
            let light = image.emitters.evaluate_environment(direction).expect("sky");
            expected += f64::from(light.radiance.y) * z;
        }
    }
    expected *= 2.0 * PI / f64::from(rows * columns);
    check(
        "sky",
        &irradiance(&image, DVec3::ZERO, Vec3A::Z, 200_000),
        expected,
    );
}

/// The mean throughput of light subpaths is the flux of all emitters, in scene units.
#[test]
fn mean_throughput_is_the_total_flux() {
    let disk = PI * f64::from(SCENE_RADIUS).powi(2);
    type Flux<'a> = &'a dyn Fn(&Scene) -> f64;
    let green = f64::from(RADIANCE.y);
    let ball = |scene: &Scene| PI * green * 4.0 * PI * (0.7 / scene.unit).powi(2);
    let cases: [(&str, Scene, Flux); 6] = [
        ("box", scene(vec![box_light(), floor()], vec![]), &|s| {
            PI * green * 8.0 * (0.5 + 0.2 + 0.1) / (s.unit * s.unit)
        }),
        (
            "sphere",
            scene(vec![sphere_light(true), floor()], vec![]),
            &ball,
        ),
        ("point", scene(vec![floor()], vec![point_light()]), &|s| {
            4.0 * PI * 4.0 / (s.unit * s.unit)
        }),
        (
            "directional",
            scene(vec![floor()], vec![directional_light()]),
            &|_| disk,
        ),
        (
            "constant",
            scene(
                vec![floor()],
                vec![EmitterDescription::Constant { radiance: RADIANCE }],
            ),
            &|_| 4.0 * PI * green * disk,
        ),
        (
            "many",
            scene(
                vec![sphere_light(false), floor()],
                vec![point_light(), directional_light()],
            ),
            &|s| ball(s) + 4.0 * PI * 4.0 / (s.unit * s.unit) + disk,
        ),
    ];
    for (name, scene, flux) in cases {
        let mut numbers = Numbers::new(42);
        let estimate: Moments = (0..20_000)
            .map(|_| {
                sample_emission(&scene, &mut numbers)
                    .map_or(0.0, |sample| f64::from(sample.weight.y))
            })
            .collect();
        check(name, &estimate, flux(&scene));
    }
}

/// The flux from a sphere onto a coaxial disk, by light subpaths, has the form factor F = (1 - 1/sqrt(1 + (R/h)^2))/2 for a
/// disk of radius R at distance h from the centre (Howell, C-124).
#[test]
fn flux_from_a_sphere_onto_a_disk() {
    let lamp = emitting(sphere(DVec3::ZERO, 0.5), RADIANCE);
    let scene = scene(vec![lamp, floor()], vec![]);
    let (disk_radius, height) = (2.0, 1.5);
    let mut numbers = Numbers::new(43);
    let estimate: Moments = (0..100_000)
        .map(|_| {
            let sample = sample_emission(&scene, &mut numbers).expect("a start");
            let origin = sample.position.as_dvec3() * scene.unit + scene.center;
            let direction = sample.direction.as_dvec3();
            let t = (height - origin.z) / direction.z;
            let at = origin + direction * t;
            let arrives = t > 0.0 && at.truncate().length() < disk_radius;
            if arrives {
                f64::from(sample.weight.y)
            } else {
                0.0
            }
        })
        .collect();
    let flux = PI * f64::from(RADIANCE.y) * 4.0 * PI * (0.5 / scene.unit).powi(2);
    let factor = 0.5 * (1.0 - 1.0 / (1.0 + (disk_radius / height).powi(2)).sqrt());
    check("sphere to disk", &estimate, flux * factor);
}
