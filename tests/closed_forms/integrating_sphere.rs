//! A point light inside a diffuse sphere. Every part of a sphere illuminates all others equally, so that
//! the irradiance by reflected light is uniform, whatever the direct light (Walsh 1958, "Photometry").
//! With flux Phi into a sphere of area A, the radiance is
//!
//!   rho/pi (E_direct + Phi/A (rho + rho^2 + ...)).

use std::f64::consts::PI;

use glam::DVec3;
use metrolight::math::{Rgb, luminance};
use metrolight::render::Integrator::{self, Bdpt, Path, Pssmlt};
use metrolight::scene::{EmitterDescription, Material, Scene, ShapeDescription, Texture};
use metrolight::statistics::Moments;

use crate::common::truths::{Truths, images};
use crate::common::words::{Words, grey, look_at, sphere};

const RADIUS: f64 = 2.0;
const INTENSITY: f64 = 5.0;

fn scene(words: Words, lamp: DVec3, intensity: Rgb) -> Scene {
    Words {
        materials: vec![Material::Diffuse { reflectance: 0 }],
        shapes: vec![ShapeDescription {
            flip_normals: true,
            ..sphere(DVec3::ZERO, RADIUS)
        }],
        emitters: vec![EmitterDescription::Point {
            position: lamp,
            intensity,
        }],
        ..words
    }
    .build()
}

/// Phi/A (rho + rho^2 + ...) for paths of at most `depth` edges; paths of direct light have two.
fn reflected_irradiance(intensity: f64, rho: f64, depth: Option<u32>) -> f64 {
    let uniform = 4.0 * PI * intensity / (4.0 * PI * RADIUS * RADIUS);
    let terms = depth.map_or(0.0, |depth| rho.powi(depth as i32 - 2));
    uniform * rho * (1.0 - terms) / (1.0 - rho)
}

/// The wall near a point light that is off centre.
#[test]
fn direct_and_reflected_light() {
    let mut truths = Truths::default();
    let lamp = DVec3::new(0.9, -0.4, 0.3);
    let target = DVec3::new(1.2, 1.6, 0.0);
    for (rho, depth) in [
        (0.8, Some(2)),
        (0.8, Some(3)),
        (0.8, Some(4)),
        (0.8, Some(7)),
        (0.8, None),
        (0.9, None),
    ] {
        let words = Words {
            textures: vec![grey(rho)],
            depth,
            fov_x: 0.05,
            camera: look_at(DVec3::new(-1.0, 0.2, 0.3), target, DVec3::Z),
            ..Words::default()
        };
        let to_lamp = lamp - target;
        let cos = to_lamp.normalize().dot(-target.normalize());
        let direct = INTENSITY * cos / to_lamp.length_squared();
        let truth = rho / PI * (direct + reflected_irradiance(INTENSITY, rho, depth));
        let name = format!("rho {rho}, depth {depth:?}");
        let scene = scene(words, lamp, Rgb::splat(INTENSITY as f32));
        truths.render(&name, &scene, &[Path, Bdpt, Pssmlt], 20, truth);
    }
    truths.settle(
        "closed form",
        "integrating sphere with a lamp off centre, depths 2 to unbounded",
    );
}

/// With the light at the centre the image is uniform. Its luminance is b: in the statistics of the chains,
/// in their image, and in the images of the other integrators.
#[test]
fn brightness_of_a_known_image() {
    let rho = [0.3_f32, 0.6, 0.9];
    let intensity = [4.0_f32, 2.0, 1.0];
    let words = Words {
        textures: vec![Texture::Constant(Rgb::from(rho))],
        fov_x: 80.0,
        camera: look_at(DVec3::new(-1.0, 0.2, 0.3), DVec3::X, DVec3::Z),
        ..Words::default()
    };
    let scene = scene(words, DVec3::ZERO, Rgb::from(intensity));
    let radiance: [f64; 3] = std::array::from_fn(|c| {
        let (rho, intensity) = (f64::from(rho[c]), f64::from(intensity[c]));
        let direct = intensity / (RADIUS * RADIUS);
        rho / PI * (direct + reflected_irradiance(intensity, rho, None))
    });
    let b = f64::from(luminance(Rgb::from(radiance.map(|r| r as f32))));
    let mut truths = Truths::default();
    for integrator in Integrator::ALL {
        let (mut mean, mut stated) = (Moments::default(), Moments::default());
        for rendering in images(&scene, integrator, 20) {
            let pixels = &rendering.image.pixels;
            let sum: f64 = pixels
                .iter()
                .map(|p| f64::from(luminance(Rgb::from(*p))))
                .sum();
            mean.add(sum / pixels.len() as f64);
            if let Some(metropolis) = &rendering.statistics.metropolis {
                stated.add(metropolis.b);
            }
        }
        truths.compare(
            0.0,
            format!("mean luminance, {}", integrator.name()),
            mean,
            b,
        );
        if integrator.is_metropolis() {
            truths.compare(0.0, "b in the statistics".into(), stated, b);
        }
    }
    truths.settle(
        "closed form",
        "b of a coloured integrating sphere: in the statistics and in the image",
    );
}
