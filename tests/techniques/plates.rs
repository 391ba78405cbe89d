//! Diffuse plates that face each other without touching: no two vertices of a path are close, so every
//! technique alone has finite variance. Optionally with a pane of glass over one side of the floor and a
//! mirror, so that paths of all classes exist.

use glam::{DMat4, DVec3};
use metrolight::math::Rgb;
use metrolight::scene::{
    ChainSearch, EmitterDescription, Material, Radiance, Scene, ShapeDescription, ShapeGeometry,
    Texture, ThinLens, TriangleMesh,
};

use super::classes::{Emitter, Lens};
use crate::common::scenes::{SceneBuilder, floor, grey, look_at, parallelogram, sphere};

const DIFFUSE: u32 = 0;
const GLASS: u32 = 1;
const MIRROR: u32 = 2;

/// Position of the sphere light or the point light.
const LAMP: DVec3 = DVec3::new(0.3, 1.1, 0.0);

pub fn plates(emitter: Emitter, lens: Lens, glass_and_mirror: bool, depth: u32) -> Scene {
    let mut builder = SceneBuilder {
        materials: vec![
            Material::Diffuse { reflectance: 0 },
            Material::Dielectric {
                eta: 1.5,
                specular_reflectance: 1,
                specular_transmittance: 1,
            },
            Material::Conductor {
                eta: Rgb::ZERO,
                k: Rgb::ONE,
                specular_reflectance: 1,
            },
        ],
        textures: vec![Texture::Constant(Rgb::new(0.8, 0.7, 0.6)), grey(1.0)],
        shapes: diffuse_plates(),
        depth: Some(depth),
        camera: look_at(
            DVec3::new(0.0, 1.1, 4.5),
            DVec3::new(0.0, 0.8, 0.0),
            DVec3::Y,
        ),
        lens: (lens == Lens::Thin).then_some(ThinLens {
            aperture_radius: 0.1,
            focus_distance: 4.0,
        }),
        film: [16, 12],
        ..SceneBuilder::default()
    };
    if glass_and_mirror {
        builder.shapes.extend([pane(), mirror()]);
    }
    match emitter {
        Emitter::Area => builder.shapes.push(ShapeDescription {
            name: "lamp".into(),
            emission: Some(Radiance::Constant(Rgb::new(3.0, 4.0, 5.0))),
            ..sphere(LAMP, 0.35)
        }),
        Emitter::Point => builder.emitters.push(EmitterDescription::Point {
            position: LAMP,
            intensity: Rgb::new(3.0, 4.0, 5.0),
        }),
        Emitter::Directional => builder.emitters.push(EmitterDescription::Directional {
            direction: DVec3::new(-1.0, -1.0, -0.3),
            irradiance: Rgb::new(3.0, 4.0, 5.0),
        }),
    }
    let mut scene = builder.build();
    // The classes are those that the techniques (s, t) find or miss.
    scene.casters.set_search(ChainSearch::Off);
    scene
}

fn diffuse_plates() -> Vec<ShapeDescription> {
    let named = |name: &str, shape| ShapeDescription {
        name: name.into(),
        material: DIFFUSE,
        ..shape
    };
    let ceiling = DVec3::new(-0.2, 2.0, -0.7);
    let back = DVec3::new(-1.2, 0.5, -2.2);
    vec![
        named("floor", floor(1.5)),
        named(
            "ceiling",
            parallelogram(ceiling, DVec3::X * 1.4, DVec3::Z * 1.4),
        ),
        named("back", parallelogram(back, DVec3::X * 2.4, DVec3::Y)),
    ]
}

/// A pane over the right side of the floor.
fn pane() -> ShapeDescription {
    ShapeDescription {
        name: "pane".into(),
        geometry: ShapeGeometry::Mesh(TriangleMesh::cube()),
        to_world: DMat4::from_translation(DVec3::new(0.7, 0.2, 0.0))
            * DMat4::from_scale(DVec3::new(0.6, 0.025, 1.0)),
        material: GLASS,
        ..floor(1.0)
    }
}

/// A mirror at the back on the left, inclined toward the floor.
fn mirror() -> ShapeDescription {
    let normal = DVec3::new(1.0, -0.5, 1.0).normalize();
    let across = DVec3::Y.cross(normal).normalize();
    let up = normal.cross(across);
    let corner = DVec3::new(-1.4, 0.8, -1.2) - 0.5 * across - 0.5 * up;
    ShapeDescription {
        name: "mirror".into(),
        material: MIRROR,
        ..parallelogram(corner, across, up)
    }
}
