//! Scenes in a few words: shapes, what they are made of, lights and a camera.

use glam::{DMat4, DVec3};
use metrolight::film::Filter;
use metrolight::math::Rgb;
use metrolight::scene::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Material, Scene,
    SceneDescription, ShapeDescription, ShapeGeometry, Texture, ThinLens, TriangleMesh,
};

/// What a scene is made of. By default there is nothing in it and a pinhole at the origin looks
/// along +z.
pub struct Words {
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub shapes: Vec<ShapeDescription>,
    pub emitters: Vec<EmitterDescription>,
    /// Greatest number of edges of a path.
    pub depth: Option<u32>,
    /// Of the width of the film, in degrees.
    pub fov_x: f64,
    pub camera: DMat4,
    pub lens: Option<ThinLens>,
    /// Width and height in pixels.
    pub film: [u32; 2],
}

impl Default for Words {
    fn default() -> Self {
        Self {
            materials: vec![],
            textures: vec![],
            shapes: vec![],
            emitters: vec![],
            depth: None,
            fov_x: 45.0,
            camera: DMat4::IDENTITY,
            lens: None,
            film: [6, 4],
        }
    }
}

impl Words {
    pub fn build(self) -> Scene {
        let [width, height] = self.film;
        let description = SceneDescription {
            camera: CameraDescription {
                to_world: self.camera,
                fov_x: self.fov_x,
                near_clip: 1e-3,
                far_clip: 1e4,
                lens: self.lens,
            },
            film: FilmSettings {
                width,
                height,
                filter: Filter::Box,
            },
            depth: DepthLimits {
                max_depth: self.depth,
                rr_depth: 5,
            },
            textures: self.textures,
            materials: self.materials,
            shapes: self.shapes,
            emitters: self.emitters,
        };
        description.build().expect("a valid scene")
    }
}

/// A sphere of material 0 that faces outward.
pub fn sphere(center: DVec3, radius: f64) -> ShapeDescription {
    ShapeDescription {
        name: "sphere".into(),
        geometry: ShapeGeometry::Sphere { center, radius },
        to_world: DMat4::IDENTITY,
        flip_normals: false,
        material: 0,
        emission: None,
    }
}

/// A parallelogram of material 0: `corner` + [0, 1] `a` + [0, 1] `b`, facing along a x b.
pub fn parallelogram(corner: DVec3, a: DVec3, b: DVec3) -> ShapeDescription {
    let positions = [corner, corner + a, corner + a + b, corner + b];
    ShapeDescription {
        name: "parallelogram".into(),
        geometry: ShapeGeometry::Mesh(TriangleMesh {
            positions: positions.map(|p| p.as_vec3().to_array()).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..TriangleMesh::default()
        }),
        to_world: DMat4::IDENTITY,
        flip_normals: false,
        material: 0,
        emission: None,
    }
}

/// A square of material 0 in the plane y = 0, centred at the origin and facing up.
pub fn floor(half_side: f64) -> ShapeDescription {
    parallelogram(
        DVec3::new(-half_side, 0.0, half_side),
        DVec3::X * (2.0 * half_side),
        DVec3::NEG_Z * (2.0 * half_side),
    )
}

/// A camera at `eye` that looks at `target`.
pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let forward = (target - eye).normalize();
    let left = up.cross(forward).normalize();
    DMat4::from_cols(
        left.extend(0.0),
        forward.cross(left).extend(0.0),
        forward.extend(0.0),
        eye.extend(1.0),
    )
}

/// The same in all three channels, everywhere.
pub fn grey(value: f64) -> Texture {
    Texture::Constant(Rgb::splat(value as f32))
}
