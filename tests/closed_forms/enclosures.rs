//! Furnace tests: inside a closed surface that emits radiance 1 and has albedo rho, the radiance is
//! 1 + rho + rho^2 + ... everywhere, whatever the shape of the enclosure and whatever lossless objects
//! are in it.

use glam::{DMat4, DVec3};
use metrolight::math::Rgb;
use metrolight::render::Integrator::{self, Bdpt, Light, Path, Pssmlt};
use metrolight::scene::{EmitterDescription, Material, Scene, ShapeDescription};

use crate::common::truths::Truths;
use crate::common::words::{Words, grey, sphere};

/// Textures of [`enclosure`].
const WALL: u32 = 0;
const WHITE: u32 = 1;

const DIFFUSE: Material = Material::Diffuse { reflectance: WALL };

/// A metal whose reflectance is that of a texture.
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
    let rest = depth.map_or(0.0, |terms| rho.powi(terms as i32));
    (1.0 - rest) / (1.0 - rho)
}

/// The inside of an emitting sphere, where the texture [`WALL`] is `rho`. If there is a second material, a
/// ball of it fills the view.
fn enclosure(rho: f64, materials: Vec<Material>, depth: Option<u32>) -> Scene {
    let fov_x = if materials.len() > 1 { 35.0 } else { 70.0 };
    let mut shapes = vec![ShapeDescription {
        flip_normals: true,
        emission: Some(Rgb::ONE),
        ..sphere(DVec3::ZERO, 2.0)
    }];
    if materials.len() > 1 {
        shapes.push(ShapeDescription {
            material: 1,
            ..sphere(DVec3::new(0.3, -0.2, 0.9), 0.7)
        });
    }
    Words {
        materials,
        textures: vec![grey(rho), grey(1.0)],
        shapes,
        depth,
        fov_x,
        camera: DMat4::from_translation(DVec3::new(0.3, -0.2, -1.0)),
        ..Words::default()
    }
    .build()
}

fn compare(truths: &mut Truths, rho: f64, depth: Option<u32>, methods: &[Integrator], spp: u64) {
    let scene = enclosure(rho, vec![DIFFUSE], depth);
    let name = format!("rho {rho}, depth {depth:?}");
    truths.render(&name, &scene, methods, spp, radiance(rho, depth));
}

/// With walls of albedo 0.99, paths have some hundred edges and one sample of bidirectional path tracing
/// has ten thousand connections: that case is in the ignored test below.
#[test]
fn diffuse_walls() {
    let mut truths = Truths::default();
    compare(&mut truths, 0.5, None, &Integrator::ALL, 30);
    compare(&mut truths, 0.9, Some(3), &Integrator::ALL, 30);
    compare(&mut truths, 0.9, None, &Integrator::ALL, 10);
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

/// Emitting mirrors, to which no light subpath can be connected.
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

/// Materials that absorb nothing.
fn lossless() -> [(&'static str, Material); 5] {
    [
        ("mirror", mirror(WHITE)),
        ("glass", glass(1.5)),
        ("bubble", glass(1.0 / 1.33)),
        ("matched", glass(1.0)),
        ("diamond", glass(2.4)),
    ]
}

/// A ball that absorbs nothing is invisible between emitting walls.
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

/// Under a constant environment too: the factors of refraction on radiance at entry and exit cancel.
#[test]
fn lossless_balls_under_a_constant_environment() {
    let mut truths = Truths::default();
    for (name, ball) in lossless() {
        let scene = Words {
            materials: vec![ball],
            textures: vec![grey(1.0), grey(1.0)],
            shapes: vec![sphere(DVec3::ZERO, 1.0)],
            emitters: vec![EmitterDescription::Constant {
                radiance: Rgb::splat(0.8),
            }],
            fov_x: 40.0,
            camera: DMat4::from_translation(DVec3::new(0.0, 0.0, -4.0)),
            ..Words::default()
        }
        .build();
        truths.render(name, &scene, &[Path, Bdpt, Pssmlt], 30, 0.8);
    }
    truths.settle("closed form", "a ball of mirror or glass under an even sky");
}
