//! Scenes for benchmarks of rays.

use glam::{DMat4, DVec2, DVec3};
use metrolight::film::Filter;
use metrolight::math::Rgb;
use metrolight::scene::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Material, Projection,
    SceneDescription, ShapeDescription, ShapeGeometry, Texture, TriangleMesh,
};

/// Grey shapes under a white sky, seen with this field of view (degrees) from a point of the z axis.
pub fn description(z: f64, fov_x: f64, shapes: Vec<ShapeDescription>) -> SceneDescription {
    SceneDescription {
        camera: CameraDescription {
            to_world: DMat4::from_translation(DVec3::new(0.0, 0.0, z)),
            projection: Projection::Perspective { fov_x, lens: None },
            principal_point_offset: DVec2::ZERO,
            near_clip: 0.001,
            far_clip: 1e4,
        },
        film: FilmSettings {
            width: 128,
            height: 128,
            filter: Filter::Box,
            crop: None,
        },
        depth: DepthLimits {
            max_depth: Some(5),
            rr_depth: 5,
        },
        hide_emitters: false,
        textures: vec![Texture::Constant(Rgb::splat(0.5))],
        materials: vec![Material::Diffuse { reflectance: 0 }],
        shapes,
        emitters: vec![white_sky()],
    }
}

/// The same radiance from all directions.
pub fn white_sky() -> EmitterDescription {
    EmitterDescription::Constant { radiance: Rgb::ONE }
}

/// A mesh of that material.
pub fn shape(mesh: TriangleMesh, to_world: DMat4) -> ShapeDescription {
    ShapeDescription {
        name: "mesh".into(),
        geometry: ShapeGeometry::Mesh(mesh),
        to_world,
        flip_normals: false,
        material: 0,
        emission: None,
    }
}
