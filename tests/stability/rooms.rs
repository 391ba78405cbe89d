//! Diffuse rooms with a lamp and balls of glass.

use glam::{DMat4, DVec3};
use metrolight::math::Rgb;
use metrolight::scene::{Material, Scene, Texture, TriangleMesh};

use crate::common::scenes::{SceneBuilder, emit};

/// Relative index of BK7 glass in air.
pub const BK7: f32 = 1.5046 / 1.000_277;

/// Above the opening of a room, outside the camera's view.
pub const OUT_OF_SIGHT: DVec3 = DVec3::new(0.0, 2.75, 2.6);

/// A diffuse room of 4 x 3 x 4 around (0, 1.5, 0), open toward the camera. The film has 24 x 18 pixels,
/// paths at most 6 edges.
pub fn room() -> SceneBuilder {
    use std::f64::consts::FRAC_PI_2;
    let (from, to) = (DVec3::new(0.0, 1.5, 5.8), DVec3::new(0.0, 1.4, 0.0));
    let mut builder = SceneBuilder::seen(from, to, 40.0, [24, 18]).depth(6);
    builder.near_clip = 1e-2;
    let color = Texture::Constant(Rgb::new(0.6, 0.55, 0.5));
    builder.textures.push(color);
    let side = Box::new(Material::Diffuse { reflectance: 0 });
    let walls = builder.material(Material::TwoSided {
        front: side.clone(),
        back: side,
    });
    for (place, turn) in [
        (DVec3::ZERO, DMat4::from_rotation_x(-FRAC_PI_2)),
        (DVec3::Y * 3.0, DMat4::from_rotation_x(FRAC_PI_2)),
        (DVec3::new(0.0, 1.5, -2.0), DMat4::IDENTITY),
        (
            DVec3::new(-2.0, 1.5, 0.0),
            DMat4::from_rotation_y(FRAC_PI_2),
        ),
        (
            DVec3::new(2.0, 1.5, 0.0),
            DMat4::from_rotation_y(-FRAC_PI_2),
        ),
    ] {
        let to_world = DMat4::from_translation(place) * turn * DMat4::from_scale(DVec3::splat(2.0));
        builder.mesh(TriangleMesh::rectangle(), to_world, walls);
    }
    builder
}

/// Adds a black spherical lamp that emits 40 W in every channel whatever its radius.
pub fn add_lamp(builder: &mut SceneBuilder, radius: f64, center: DVec3) {
    let black = builder.diffuse(0.0);
    let radiance = 40.0 / (4.0 * std::f64::consts::PI.powi(2) * radius * radius);
    emit(builder.sphere(center, radius, black), radiance as f32);
}

/// Adds a ball of smooth glass.
pub fn add_glass_ball(builder: &mut SceneBuilder, radius: f64, center: DVec3) {
    let glass = builder.glass(BK7);
    builder.sphere(center, radius, glass);
}

/// A room whose camera and lamp are each in a ball of glass: direct light comes over paths of four edges
/// that only camera subpaths find, and of them only those that hit the lamp. Longer paths, which
/// connections on the walls could make, are left out.
pub fn behind_two_panes(lamp_radius: f64) -> Scene {
    let mut builder = room_with_shaded_lamp(lamp_radius);
    add_glass_ball(&mut builder, 0.35, DVec3::new(0.0, 1.5, 5.8));
    builder.depth(4).build()
}

/// The same without the ball around the camera, so that connections find the light; and the factor by
/// which radiance is larger in that ball: n^2 T, with Fresnel's T = 4n/(n + 1)^2 for the rays through its
/// centre.
pub fn behind_one_pane(lamp_radius: f64) -> (Scene, f64) {
    let n: f64 = 1.5046 / 1.000_277;
    let brighter = n * n * 4.0 * n / (n + 1.0).powi(2);
    (
        room_with_shaded_lamp(lamp_radius).depth(3).build(),
        brighter,
    )
}

fn room_with_shaded_lamp(lamp_radius: f64) -> SceneBuilder {
    let mut builder = room();
    add_lamp(&mut builder, lamp_radius, OUT_OF_SIGHT);
    add_glass_ball(&mut builder, 0.35, OUT_OF_SIGHT);
    builder
}
