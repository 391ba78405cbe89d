//! A material scatters as much light by samples from the camera's side as by samples from the light's.

use std::f64::consts::PI;

use glam::{Vec2, Vec3A};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::{Material, TransportMode};
use super::context;
use super::materials::{connectible, perfectly_smooth, textures};
use crate::math::luminance;
use crate::statistics::{Moments, holm, welch};

/// Estimates of the integral of f |cos| |cos| over all pairs of directions, in sr: one direction is uniform on
/// the sphere, and the other is sampled by the material. Cameras behind count threefold, so that errors in the
/// refraction from both sides do not cancel.
fn scattered(material: &Material, mode: TransportMode, seed: u64) -> Moments {
    const COUNT: usize = 20_000;
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let textures = textures();
    let mut moments = Moments::default();
    for _ in 0..COUNT {
        let z = rng.random_range(-1.0_f32..1.0);
        let (sin_phi, cos_phi) = rng.random_range(0.0..std::f32::consts::TAU).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        let from = Vec3A::new(r * cos_phi, r * sin_phi, z).normalize();
        let u = Vec2::new(rng.random(), rng.random());
        let sample = material.sample(&context(&textures), from, mode, rng.random(), u);
        let value = sample.map_or(0.0, |sample| {
            let to_camera = match mode {
                TransportMode::Radiance => from,
                TransportMode::Importance => sample.direction,
            };
            let side = if to_camera.z > 0.0 { 1.0 } else { 3.0 };
            side * luminance(sample.weight) * from.z.abs()
        });
        moments.add(4.0 * PI * f64::from(value));
    }
    moments
}

/// p-value of the hypothesis that both estimates have the same mean.
pub fn difference(material: &Material, seed: u64) -> f64 {
    let [from_camera, from_light] = [TransportMode::Radiance, TransportMode::Importance]
        .map(|mode| scattered(material, mode, 2 * seed + mode as u64));
    welch(&from_camera, &from_light)
}

/// Null hypothesis: for each material both estimates have the same mean. With Holm's correction over all materials, the
/// level is 1%: the false-alarm rate over the choice of seeds.
#[test]
fn both_ends_scatter_the_same_light() {
    let mut cases = connectible();
    cases.extend(perfectly_smooth());
    let p_values: Vec<f64> = (0..)
        .zip(&cases)
        .map(|(seed, (_, material))| difference(material, seed))
        .collect();
    for (((name, _), adjusted), p) in cases.iter().zip(holm(&p_values)).zip(&p_values) {
        assert!(adjusted >= 0.01, "{name}: p = {p:e}");
    }
}
