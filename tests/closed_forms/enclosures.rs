//! Furnaces: inside a closed surface that emits radiance 1 and has albedo rho, the radiance is
//! 1 + rho + rho^2 + ... everywhere, for any shape of the enclosure and any lossless objects in it.

use glam::{DMat4, DVec3};
use metrolight::math::Rgb;
use metrolight::render::Method::{self, Bdpt, Light, Path, Pssmlt};
use metrolight::scene::{EmitterDescription, Material, Radiance, Scene, ShapeDescription};

use crate::common::scenes::{SceneBuilder, grey, sphere};
use crate::common::truths::Truths;

/// Textures of [`enclosure`].
const WALL: u32 = 0;
const WHITE: u32 = 1;

const DIFFUSE: Material = Material::Diffuse { reflectance: WALL };

/// A mirror with the reflectance of a texture.
fn mirror(specular_reflectance: u32) -> Material {
    Material::Conductor {
        eta: Rgb::ZERO,
        k: Rgb::ONE,
        specular_reflectance,
    }
}

fn glass(eta: f32) -> Material {
    Material::Dielectric {
        eta,
        specular_reflectance: WHITE,
        specular_transmittance: WHITE,
    }
}

/// 1 + rho + ... + rho^(depth - 1).
fn radiance(rho: f64, depth: Option<u32>) -> f64 {
    let left = depth.map_or(0.0, |terms| rho.powi(terms as i32));
    (1.0 - left) / (1.0 - rho)
}

/// The inside of an emitting sphere whose texture [`WALL`] is `rho`. If there is a second material, a ball
/// of it fills the view.
fn enclosure(rho: f64, materials: Vec<Material>, depth: Option<u32>) -> Scene {
    let fov_x = if materials.len() > 1 { 35.0 } else { 70.0 };
    let mut shapes = vec![ShapeDescription {
        flip_normals: true,
        emission: Some(Radiance::Constant(Rgb::ONE)),
        ..sphere(DVec3::ZERO, 2.0)
    }];
    if materials.len() > 1 {
        shapes.push(ShapeDescription {
            material: 1,
            ..sphere(DVec3::new(0.3, -0.2, 0.9), 0.7)
        });
    }
    SceneBuilder {
        materials,
        textures: vec![grey(rho), grey(1.0)],
        shapes,
        depth,
        fov_x,
        camera: DMat4::from_translation(DVec3::new(0.3, -0.2, -1.0)),
        ..SceneBuilder::default()
    }
    .build()
}

fn compare(truths: &mut Truths, rho: f64, depth: Option<u32>, methods: &[Method], spp: u64) {
    let scene = enclosure(rho, vec![DIFFUSE], depth);
    let name = format!("rho {rho}, depth {depth:?}");
    truths.render(&name, &scene, methods, spp, radiance(rho, depth));
}

/// Walls of albedo 0.99 make paths of some hundred edges, for which one sample of bidirectional path
/// tracing has ten thousand connections: the ignored test below covers it.
#[test]
fn diffuse_walls() {
    let mut truths = Truths::default();
    compare(&mut truths, 0.5, None, &Method::ALL, 30);
    compare(&mut truths, 0.9, Some(3), &Method::ALL, 30);
    compare(&mut truths, 0.9, None, &Method::ALL, 10);
    compare(&mut truths, 0.99, None, &[Path, Light], 30);
    truths.settle(
        "closed form",
        "furnace of diffuse walls, albedo to 0.99, unbounded and bounded",
    );
}

#[test]
#[ignore = "takes a few minutes"]
fn very_white_diffuse_walls_by_bidirectional_methods() {
    let mut truths = Truths::default();
    compare(&mut truths, 0.99, None, &[Bdpt, Pssmlt], 8);
    truths.settle(
        "closed form",
        "furnace of diffuse walls, albedo 0.99, by bdpt and pssmlt",
    );
}

/// Emitting mirrors reflect only themselves; no light subpath connects to them.
#[test]
fn mirroring_walls() {
    let mut truths = Truths::default();
    for rho in [0.5, 0.9] {
        let scene = enclosure(rho, vec![mirror(WALL)], None);
        let methods = [Path, Bdpt, Pssmlt];
        truths.render(
            &format!("rho {rho}"),
            &scene,
            &methods,
            30,
            radiance(rho, None),
        );
    }
    truths.settle("closed form", "furnace of mirroring walls");
}

/// Materials without absorption.
fn lossless() -> [(&'static str, Material); 5] {
    [
        ("mirror", mirror(WHITE)),
        ("glass", glass(1.5)),
        ("bubble", glass(1.0 / 1.33)),
        ("matched", glass(1.0)),
        ("diamond", glass(2.4)),
    ]
}

/// A lossless ball is invisible between emitting walls.
#[test]
fn lossless_contents() {
    let mut truths = Truths::default();
    let white = ("white", Material::Diffuse { reflectance: WHITE });
    for (name, ball) in lossless().into_iter().chain([white]) {
        let scene = enclosure(0.6, vec![DIFFUSE, ball], None);
        truths.render(name, &scene, &[Path, Bdpt, Pssmlt], 20, radiance(0.6, None));
    }
    truths.settle(
        "closed form",
        "furnace with a ball of white, mirror or glass",
    );
}

/// Under constant environment light, refraction scales radiance on entering a ball and undoes it on
/// leaving.
#[test]
fn lossless_balls_under_a_constant_environment() {
    let mut truths = Truths::default();
    for (name, ball) in lossless() {
        let scene = SceneBuilder {
            materials: vec![ball],
            textures: vec![grey(1.0), grey(1.0)],
            shapes: vec![sphere(DVec3::ZERO, 1.0)],
            emitters: vec![EmitterDescription::Constant {
                radiance: Rgb::splat(0.8),
            }],
            fov_x: 40.0,
            camera: DMat4::from_translation(DVec3::new(0.0, 0.0, -4.0)),
            ..SceneBuilder::default()
        }
        .build();
        truths.render(name, &scene, &[Path, Bdpt, Pssmlt], 30, 0.8);
    }
    truths.settle(
        "closed form",
        "a ball of mirror or glass under a constant environment",
    );
}
