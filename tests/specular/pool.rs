//! A pool under a lamp.

use glam::{DMat4, DVec3};
use metrolight::math::Rgb;
use metrolight::scene::{EmitterDescription, TriangleMesh};

use super::common::scenes::{SceneBuilder, emit};

pub const LAMP: DVec3 = DVec3::new(0.3, 2.2, -0.2);
pub const INTENSITY: f64 = 10.0;
pub const WATER: f64 = 1.33;

/// A light at [`LAMP`].
#[derive(Clone, Copy, Debug)]
pub enum Light {
    Point,
    /// A sphere of this radius that emits as much as the point light.
    Sphere(f64),
}

pub fn add_light(builder: &mut SceneBuilder, light: Light) {
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

pub const FLOOR: f64 = -1.0;
pub const ALBEDO: f32 = 0.5;

/// A floor under water, seen from above the water: light reaches the image only as E T D T L if paths have at
/// most 4 edges.
pub fn pool(light: Light, depth: u32) -> SceneBuilder {
    pool_under(depth, |builder| add_light(builder, light))
}

/// The same under a light that `add_light` adds.
pub fn pool_under(depth: u32, add_light: impl FnOnce(&mut SceneBuilder)) -> SceneBuilder {
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
    add_light(&mut builder);
    builder
}
