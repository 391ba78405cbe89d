//! Small scenes for the tests of the scene.

use glam::{DMat4, DVec2, DVec3};

use super::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Material, Projection,
    Radiance, Scene, SceneDescription, ShapeDescription, ShapeGeometry, Texture, TriangleMesh,
};
use crate::bvh::test_primitives;
pub use crate::bvh::test_primitives::Numbers;
use crate::film::Filter;
use crate::math::Rgb;

pub fn shape(geometry: ShapeGeometry, to_world: DMat4) -> ShapeDescription {
    ShapeDescription {
        name: "shape".into(),
        geometry,
        to_world,
        flip_normals: false,
        material: 0,
        emission: None,
    }
}

pub fn mesh(mesh: TriangleMesh, to_world: DMat4) -> ShapeDescription {
    shape(ShapeGeometry::Mesh(mesh), to_world)
}

pub fn sphere(center: DVec3, radius: f64) -> ShapeDescription {
    shape(ShapeGeometry::Sphere { center, radius }, DMat4::IDENTITY)
}

pub fn emitting(mut shape: ShapeDescription, radiance: Rgb) -> ShapeDescription {
    shape.emission = Some(Radiance::Constant(radiance));
    shape
}

pub fn camera() -> CameraDescription {
    CameraDescription {
        to_world: DMat4::IDENTITY,
        projection: Projection::Perspective {
            fov_x: 50.0,
            lens: None,
        },
        principal_point_offset: DVec2::ZERO,
        near_clip: 0.01,
        far_clip: 1e4,
    }
}

pub fn description(
    shapes: Vec<ShapeDescription>,
    emitters: Vec<EmitterDescription>,
) -> SceneDescription {
    SceneDescription {
        camera: camera(),
        film: FilmSettings {
            width: 320,
            height: 200,
            filter: Filter::Box,
            crop: None,
        },
        depth: DepthLimits {
            max_depth: None,
            rr_depth: 5,
        },
        hide_emitters: false,
        textures: vec![Texture::Constant(Rgb::splat(0.5))],
        materials: vec![Material::Diffuse { reflectance: 0 }],
        shapes,
        emitters,
    }
}

/// The scene; a constant emitter is added if there is no emitter.
pub fn scene(shapes: Vec<ShapeDescription>, mut emitters: Vec<EmitterDescription>) -> Scene {
    if emitters.is_empty() && shapes.iter().all(|shape| shape.emission.is_none()) {
        let radiance = Rgb::ONE;
        emitters.push(EmitterDescription::Constant { radiance });
    }
    description(shapes, emitters)
        .build()
        .expect("a valid scene")
}

/// A closed wavy sphere of 2 n (n - 1) triangles, its radius between 0.8 and 1.2.
pub fn blob(n: u32) -> TriangleMesh {
    indexed_mesh(test_primitives::blob(n))
}

/// A square grid of `n` by `n` cells, [-1, 1]^2 in the plane z = 0.
pub fn grid(n: u32) -> TriangleMesh {
    indexed_mesh(test_primitives::grid(n))
}

fn indexed_mesh((positions, triangles): test_primitives::Mesh) -> TriangleMesh {
    TriangleMesh {
        positions,
        triangles,
        ..TriangleMesh::default()
    }
}
