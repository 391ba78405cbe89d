//! Tests of emitters. Statistical tests use fixed seeds and reject at p < 1e-4, which is the rate of false
//! alarms over the choice of seeds.

mod densities;
mod integrals;
mod limits;
mod mitsuba;
mod slivers;

use glam::{Affine2, DMat4, DVec3, Vec3A};

use crate::math::Rgb;
use crate::scene::test_scenes::{Numbers, description, emitting, mesh, scene, shape, sphere};
use crate::scene::{
    Bitmap, EmissionSample, EmitterDescription, Interpolation, LightEvaluation, LightSample,
    Radiance, Ray, RayCounts, SCENE_RADIUS, Scene, ShapeDescription, ShapeGeometry, Texture,
    TriangleMesh, Wrap,
};

const RADIANCE: Rgb = Rgb::new(2.0, 3.0, 0.5);

/// A surface that does not emit, far below, so that the scene is larger than its emitters.
fn floor() -> ShapeDescription {
    let down = DMat4::from_translation(DVec3::new(0.0, 0.0, -6.0));
    mesh(TriangleMesh::rectangle(), down)
}

fn box_light() -> ShapeDescription {
    let to_world = DMat4::from_rotation_x(0.5)
        * DMat4::from_rotation_y(0.3)
        * DMat4::from_scale(DVec3::new(1.0, 0.5, 0.2));
    emitting(mesh(TriangleMesh::cube(), to_world), RADIANCE)
}

fn sphere_light(flip_normals: bool) -> ShapeDescription {
    let ball = ShapeDescription {
        flip_normals,
        ..sphere(DVec3::new(0.2, -0.1, 0.3), 0.7)
    };
    emitting(ball, RADIANCE)
}

/// A shape with a radiance that varies slowly over it, and a floor.
fn pictured(lamp: ShapeDescription) -> Scene {
    let pixels = vec![
        [1.0, 0.2, 0.3],
        [0.4, 0.9, 0.5],
        [0.6, 0.7, 0.1],
        [0.8, 0.3, 0.7],
    ];
    let (filter, wrap) = (Interpolation::Bilinear, Wrap::Mirror);
    let bitmap = Bitmap::new(2, 2, pixels, filter, wrap, Affine2::IDENTITY).expect("a bitmap");
    let lamp = ShapeDescription {
        emission: Some(Radiance::Texture(1)),
        ..lamp
    };
    let mut description = description(vec![lamp, floor()], vec![]);
    description.textures.push(Texture::Bitmap(bitmap));
    description.build().expect("a scene")
}

/// An environment map of few pixels, some of them black and one very bright.
fn sky() -> EmitterDescription {
    let mut numbers = Numbers::new(77);
    let mut pixels: Vec<[f32; 3]> = (0..7 * 6)
        .map(|_| (0.5 * (numbers.cube() + 1.0)).to_array())
        .collect();
    for dark in [8, 9, 10, 15, 16, 17, 22, 23, 24] {
        pixels[dark] = [0.0; 3];
    }
    pixels[19] = [90.0, 80.0, 70.0];
    EmitterDescription::Environment {
        width: 7,
        pixels,
        scale: 1.5,
        to_world: DMat4::from_rotation_x(0.4) * DMat4::from_rotation_z(1.1),
    }
}

/// Scenes with area or environment emitters, each with a point that is lit, in world coordinates.
fn extended_lights() -> Vec<(&'static str, Scene, DVec3)> {
    let place = DVec3::new(0.3, 1.4, 1.6);
    let constant = || EmitterDescription::Constant { radiance: RADIANCE };
    let room = ShapeDescription {
        flip_normals: true,
        ..emitting(mesh(TriangleMesh::cube(), DMat4::IDENTITY), RADIANCE)
    };
    vec![
        ("box", scene(vec![box_light(), floor()], vec![]), place),
        (
            "room",
            scene(vec![room, floor()], vec![]),
            DVec3::new(0.2, 0.3, -0.5),
        ),
        (
            "sphere",
            scene(vec![sphere_light(false), floor()], vec![]),
            place,
        ),
        (
            "sphere from near",
            scene(vec![sphere_light(false), floor()], vec![]),
            DVec3::new(0.2, -0.1, 1.001),
        ),
        (
            "sphere from inside",
            scene(vec![sphere_light(true), floor()], vec![]),
            DVec3::new(0.4, 0.2, 0.1),
        ),
        ("picture on a box", pictured(box_light()), place),
        ("picture on a sphere", pictured(sphere_light(false)), place),
        (
            "picture in a sphere",
            pictured(sphere_light(true)),
            DVec3::new(0.4, 0.2, 0.1),
        ),
        ("constant", scene(vec![floor()], vec![constant()]), place),
        ("sky", scene(vec![floor()], vec![sky()]), place),
        (
            "many",
            scene(
                vec![box_light(), floor(), {
                    let lamp = ShapeGeometry::Sphere {
                        center: DVec3::new(2.0, 1.0, 0.0),
                        radius: 0.4,
                    };
                    emitting(shape(lamp, DMat4::IDENTITY), 20.0 * RADIANCE)
                }],
                vec![sky(), point_light()],
            ),
            place,
        ),
    ]
}

fn point_light() -> EmitterDescription {
    EmitterDescription::Point {
        position: DVec3::new(0.5, 0.6, 2.0),
        intensity: Rgb::new(1.0, 4.0, 9.0),
    }
}

fn directional_light() -> EmitterDescription {
    EmitterDescription::Directional {
        direction: DVec3::new(0.3, 0.1, -2.0),
        irradiance: Rgb::new(3.0, 1.0, 2.0),
    }
}

fn to_scene(scene: &Scene, world: DVec3) -> Vec3A {
    ((world - scene.center) / scene.unit).as_vec3a()
}

/// The light that a camera subpath from `point` along `direction` hits, and the Jacobian from its native
/// measure to solid angle at `point` (the inverse of [`super::LightSample::jacobian_direction`]).
fn light_hit(scene: &Scene, point: Vec3A, direction: Vec3A) -> Option<(LightEvaluation, f32)> {
    let ray = Ray {
        origin: point,
        direction,
        t_max: f32::INFINITY,
    };
    match scene.geometry.intersect(&ray, &mut RayCounts::default()) {
        Some(hit) => {
            let emission = scene.emitters.evaluate_surface(&hit, point)?;
            let to = hit.position - point;
            let cos = -hit.geometric_normal.dot(direction);
            Some((emission, to.length_squared() / cos))
        }
        None => Some((scene.emitters.evaluate_environment(direction)?, 1.0)),
    }
}

/// Samples the start of a light subpath with random numbers.
fn sample_emission(scene: &Scene, numbers: &mut Numbers) -> Option<EmissionSample> {
    let (u_light, u_primitive) = (numbers.unit(), numbers.unit());
    let (u_position, u_direction) = (numbers.pair(), numbers.pair());
    scene
        .emitters
        .sample_emission(u_light, u_primitive, u_position, u_direction)
}

/// Samples light for `point` with random numbers.
fn sample_direct(scene: &Scene, point: Vec3A, numbers: &mut Numbers) -> Option<LightSample> {
    let (u_light, u_primitive) = (numbers.unit(), numbers.unit());
    scene
        .emitters
        .sample_direct(point, u_light, u_primitive, numbers.pair())
}
