//! One bounce: a diffuse floor of albedo rho under irradiance E shows rho E / pi.

use std::f64::consts::PI;

use glam::DVec3;
use metrolight::math::Rgb;
use metrolight::render::Method::{self, Bdpt, Path, Pssmlt};
use metrolight::scene::{EmitterDescription, Material, Radiance, Scene, ShapeDescription};

use crate::common::scenes::{SceneBuilder, floor, grey, look_at, parallelogram, sphere};
use crate::common::truths::Truths;

const METHODS: [Method; 3] = [Path, Bdpt, Pssmlt];
const RHO: f64 = 0.6;
const LE: f64 = 3.0;

/// The floor at the origin, seen from `eye` with so narrow a field of view that irradiance is constant over
/// the film.
fn floor_under(
    shapes: Vec<ShapeDescription>,
    emitters: Vec<EmitterDescription>,
    eye: DVec3,
) -> Scene {
    let mut all = vec![floor(10.0)];
    all.extend(shapes);
    SceneBuilder {
        materials: vec![Material::Diffuse { reflectance: 0 }],
        textures: vec![grey(RHO)],
        shapes: all,
        emitters,
        depth: Some(2),
        fov_x: 0.02,
        camera: look_at(eye, DVec3::ZERO, DVec3::new(0.3, 0.1, 1.0)),
        ..SceneBuilder::default()
    }
    .build()
}

/// Lambert's formula for the irradiance at the origin of a plane of normal +y from a polygon of
/// radiance 1 that lies above it: E = (1/2) sum of the angles that its edges subtend, each times the
/// cosine of its plane's normal with +y (Baum et al. 1989, "Improving radiosity solutions through the
/// use of analytically determined form-factors", eq. 7).
fn lambert(polygon: &[DVec3]) -> f64 {
    let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| {
            let normal = a.cross(*b);
            a.angle_between(*b) * normal.y / normal.length()
        })
        .sum();
    0.5 * sum.abs()
}

/// E at the foot of the perpendicular through a corner of a parallel rectangle a x b at height h
/// (Howell, "A catalog of radiation heat transfer configuration factors", B-3).
fn corner(a: f64, b: f64, h: f64) -> f64 {
    let (x, y) = (a / h, b / h);
    let term = |x: f64, y: f64| x / x.hypot(1.0) * (y / x.hypot(1.0)).atan();
    0.5 * (term(x, y) + term(y, x))
}

#[test]
fn lambert_agrees_with_a_published_factor() {
    for [a, b, h] in [[1.0, 1.0, 1.0], [0.3, 4.0, 0.7], [9.0, 5.0, 0.01]] {
        let polygon = [[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]].map(|[x, z]| DVec3::new(x, h, z));
        assert!((lambert(&polygon) - corner(a, b, h)).abs() < 1e-12);
    }
}

/// A sphere of radiance L above the horizon: E = pi L (R/d)^2 cos, as of a point light at its centre.
#[test]
fn sphere_lights() {
    let mut truths = Truths::default();
    for (name, center, radius, eye) in [
        ("overhead", [0.0, 3.0, 0.0], 1.0, [4.0, 4.0, 0.0]),
        ("on the horizon", [5.0, 1.0, 0.0], 1.0, [-4.0, 4.0, 0.0]),
        ("nearly touching", [-0.05, 1.001, 0.0], 1.0, [4.0, 0.2, 0.0]),
        (
            "near and small",
            [-0.002, 0.01, 0.0],
            0.009,
            [0.1, 0.01, 0.0],
        ),
        ("far", [0.0, 600.0, 800.0], 1.0, [0.0, 4.0, 0.0]),
    ] {
        let center = DVec3::from(center);
        let light = ShapeDescription {
            emission: Some(Radiance::Constant(Rgb::splat(LE as f32))),
            ..sphere(center, radius)
        };
        let distance = center.length();
        let irradiance = PI * LE * (radius / distance).powi(2) * center.y / distance;
        let scene = floor_under(vec![light], vec![], DVec3::from(eye));
        truths.render(name, &scene, &METHODS, 250, RHO / PI * irradiance);
    }
    truths.settle(
        "closed form",
        "irradiance from sphere lights, from 0.002 R to 1000 R away",
    );
}

/// Rectangles parallel to the floor and tilted, by Lambert's formula.
#[test]
fn rectangle_lights() {
    let mut truths = Truths::default();
    let far_eye = [-3.0, 3.0, -3.0];
    for (name, first, a, b, eye) in [
        (
            "over a corner",
            [0.0, 1.0, 0.0],
            [2.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            far_eye,
        ),
        (
            "very near",
            [0.0, 0.01, 0.0],
            [0.3, 0.0, 0.0],
            [0.0, 0.0, 0.2],
            far_eye,
        ),
        (
            "overhead",
            [-1.0, 2.0, -1.0],
            [2.0, 0.0, 0.0],
            [0.0, 0.0, 2.0],
            [6.0, 2.0, 0.0],
        ),
        (
            "tilted",
            [1.0, 0.5, -1.0],
            [0.5, 0.0, 2.0],
            [1.0, 2.0, 0.0],
            far_eye,
        ),
        (
            "far",
            [50.0, 80.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            far_eye,
        ),
    ] {
        let [first, a, b] = [first, a, b].map(DVec3::from);
        let light = ShapeDescription {
            emission: Some(Radiance::Constant(Rgb::splat(LE as f32))),
            ..parallelogram(first, a, b)
        };
        let irradiance = LE * lambert(&[first, first + a, first + a + b, first + b]);
        let scene = floor_under(vec![light], vec![], DVec3::from(eye));
        truths.render(name, &scene, &METHODS, 250, RHO / PI * irradiance);
    }
    truths.settle(
        "closed form",
        "irradiance from rectangle lights, by Lambert's formula",
    );
}

/// Point and directional lights: E = I cos / d^2 and E_0 cos.
#[test]
fn lights_without_extent() {
    let mut truths = Truths::default();
    let point = EmitterDescription::Point {
        position: DVec3::new(1.0, 2.0, 0.0),
        intensity: Rgb::splat(5.0),
    };
    let directional = EmitterDescription::Directional {
        direction: DVec3::new(1.0, -1.0, 0.5),
        irradiance: Rgb::splat(2.0),
    };
    for (name, light, irradiance) in [
        ("point", point, 5.0 * (2.0 / 5.0f64.sqrt()) / 5.0),
        ("directional", directional, 2.0 / 1.5),
    ] {
        let scene = floor_under(vec![], vec![light], DVec3::new(0.0, 4.0, 0.0));
        truths.render(name, &scene, &METHODS, 250, RHO / PI * irradiance);
    }
    truths.settle(
        "closed form",
        "irradiance from point and directional lights",
    );
}

/// Form factor from a rectangle l x w to one of l x h at right angles along the edge l, for W = w/l and
/// H = h/l (Howell, C-14).
fn perpendicular_factor(h: f64, w: f64) -> f64 {
    let (h2, w2) = (h * h, w * w);
    let both = h2 + w2;
    let log = ((1.0 + w2) * (1.0 + h2) / (1.0 + both)).ln()
        + w2 * (w2 * (1.0 + both) / ((1.0 + w2) * both)).ln()
        + h2 * (h2 * (1.0 + both) / ((1.0 + h2) * both)).ln();
    let arcs =
        w * w.recip().atan() + h * h.recip().atan() - both.sqrt() * both.sqrt().recip().atan();
    (arcs + 0.25 * log) / (PI * w)
}

/// The floor along an emitting wall. A pinhole above a rectangle that fills its film sees every part in
/// proportion to its area, so the mean of the image is the mean radiance.
#[test]
fn floor_along_an_emitting_wall() {
    let mut truths = Truths::default();
    for (height, width) in [(1.0, 1.0), (0.2, 2.0)] {
        let wall = ShapeDescription {
            emission: Some(Radiance::Constant(Rgb::splat(LE as f32))),
            ..parallelogram(DVec3::ZERO, DVec3::Z, DVec3::Y * height)
        };
        let wall = ShapeDescription {
            flip_normals: true,
            ..wall
        };
        let centre = DVec3::new(0.5 * width, 0.0, 0.5);
        let scene = SceneBuilder {
            materials: vec![Material::Diffuse { reflectance: 0 }],
            textures: vec![grey(RHO)],
            shapes: vec![wall, floor(5.0)],
            depth: Some(2),
            fov_x: 2.0 * (0.5 * width / 3.0).atan().to_degrees(),
            camera: look_at(centre + 3.0 * DVec3::Y, centre, DVec3::Z),
            film: [4 * width as u32, 4],
            ..SceneBuilder::default()
        }
        .build();
        let truth = RHO * LE * perpendicular_factor(height, width);
        let name = format!("wall of {height}, floor of {width}");
        truths.render(
            &name,
            &scene,
            &[Path, Method::Light, Bdpt, Pssmlt],
            250,
            truth,
        );
    }
    truths.settle(
        "closed form",
        "floor along an emitting wall: form factor of rectangles at right angles",
    );
}
