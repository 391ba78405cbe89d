//! Flat water, for which the light has a closed form: indices of refraction from 1 to 2.4, and total internal
//! reflection.

use std::f64::consts::PI;

use glam::{DMat4, DVec3, Vec2, Vec3A};
use metrolight::math::Rgb;
use metrolight::scene::{EmitterDescription, Scene, TriangleMesh};

use super::caustic;
use super::common::scenes::SceneBuilder;
use super::pool::{ALBEDO, FLOOR, INTENSITY};

/// A floor under flat water of this index at y = 0, with a point light, seen from above.
fn flat_pool(eta: f64, lamp: DVec3) -> Scene {
    let mut builder = SceneBuilder::seen(
        DVec3::new(0.2, 2.6, 1.6),
        DVec3::new(0.0, -0.6, 0.0),
        32.0,
        [16, 12],
    )
    .depth(4);
    let glass = builder.glass(eta as f32);
    let floor = builder.diffuse(ALBEDO);
    let upward = DMat4::from_rotation_x(-0.5 * PI) * DMat4::from_scale(DVec3::splat(8.0));
    builder.mesh(TriangleMesh::rectangle(), upward, glass);
    builder.floor(DVec3::new(0.0, FLOOR, 0.0), 8.0, floor);
    builder.emitters.push(EmitterDescription::Point {
        position: lamp,
        intensity: Rgb::splat(INTENSITY as f32),
    });
    builder.build()
}

/// Sine of the refracted angle, and the fraction that is reflected, from index `from` to index `to` (Born and Wolf,
/// section 1.5).
fn fresnel(sin: f64, from: f64, to: f64) -> (f64, f64) {
    let sin_t = sin * from / to;
    if sin_t >= 1.0 {
        return (1.0, 1.0);
    }
    let (cos, cos_t) = ((1.0 - sin * sin).sqrt(), (1.0 - sin_t * sin_t).sqrt());
    let s = (from * cos - to * cos_t) / (from * cos + to * cos_t);
    let p = (from * cos_t - to * cos) / (from * cos_t + to * cos);
    (sin_t, 0.5 * (s * s + p * p))
}

/// Irradiance on the floor at the distance `rho` from below a lamp at the height `height` over the water.
fn refracted(rho: f64, height: f64, eta: f64) -> f64 {
    let reach = |sin: f64| {
        let (sin_t, _) = fresnel(sin, 1.0, eta);
        height * sin / (1.0 - sin * sin).sqrt() - FLOOR * sin_t / (1.0 - sin_t * sin_t).sqrt()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if reach(middle) < rho {
            low = middle;
        } else {
            high = middle;
        }
    }
    let sin = 0.5 * (low + high);
    let (_, reflected) = fresnel(sin, 1.0, eta);
    // The solid angle between two cones over the area of the ring on the floor.
    let angle = sin.asin();
    let step = 1e-5;
    let rings = [angle - step, angle + step].map(|angle| reach(angle.sin()).powi(2));
    let cosines = (angle - step).cos() - (angle + step).cos();
    INTENSITY * (1.0 - reflected) * 2.0 * cosines / (rings[1] - rings[0])
}

/// Irradiance on the floor by reflection at the water of a lamp below it, at the depth `depth`.
fn reflected(rho: f64, depth: f64, eta: f64) -> f64 {
    let down = depth - FLOOR;
    let squared = rho * rho + down * down;
    let (_, reflected) = fresnel(rho / squared.sqrt(), eta, 1.0);
    INTENSITY * reflected * down / (squared * squared.sqrt())
}

/// The mean of the image.
fn expected(scene: &Scene, eta: f64, lamp: DVec3) -> f64 {
    let (width, height, views) = (16, 12, 12);
    let mut sum = 0.0;
    for i in 0..width * views {
        for j in 0..height * views {
            let film = Vec2::new(
                (i as f32 + 0.5) / (width * views) as f32,
                (j as f32 + 0.5) / (height * views) as f32,
            );
            let (ray, _): (_, Vec3A) = scene.camera.ray(film, Vec2::ZERO);
            let (origin, direction) = (scene.to_world(ray.origin), ray.direction.as_dvec3());
            let on_water = origin - direction * (origin.y / direction.y);
            let across = DVec3::new(direction.x, 0.0, direction.z);
            let (sin_t, lost) = fresnel(across.length(), 1.0, eta);
            let offset = -FLOOR * sin_t / (1.0 - sin_t * sin_t).sqrt();
            let on_floor = on_water + across.normalize() * offset;
            let rho = DVec3::new(on_floor.x - lamp.x, 0.0, on_floor.z - lamp.z).length();
            let irradiance = if lamp.y > 0.0 {
                refracted(rho, lamp.y, eta)
            } else {
                reflected(rho, -lamp.y, eta)
            };
            sum += (1.0 - lost) * irradiance * f64::from(ALBEDO) / (PI * eta * eta);
        }
    }
    sum / f64::from(width * height * views * views)
}

/// The standard error is 0.1%.
#[test]
fn flat_water_of_any_index_agrees_with_the_closed_form() {
    let (above, below) = (DVec3::new(0.3, 2.2, -0.2), DVec3::new(0.3, -0.3, -0.2));
    for (lamp, indices) in [
        (above, [1.0, 1.001, 1.33, 1.8, 2.4]),
        (below, [1.001, 1.1, 1.33, 1.8, 2.4]),
    ] {
        for eta in indices {
            let scene = flat_pool(eta, lamp);
            let ratio = caustic(&scene, 3000) / expected(&scene, eta, lamp);
            assert!(
                (ratio - 1.0).abs() < 5e-3,
                "index {eta}, lamp at {lamp}: ratio {ratio}"
            );
        }
    }
}
