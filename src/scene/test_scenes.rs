//! Small scenes for the tests of this room.

use glam::{DMat4, DVec3, Vec3A};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Material, Scene,
    SceneDescription, ShapeDescription, ShapeGeometry, Texture, TriangleMesh,
};
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
    shape.emission = Some(radiance);
    shape
}

pub fn camera() -> CameraDescription {
    CameraDescription {
        to_world: DMat4::IDENTITY,
        fov_x: 50.0,
        near_clip: 0.01,
        far_clip: 1e4,
        lens: None,
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
        },
        depth: DepthLimits {
            max_depth: None,
            rr_depth: 5,
        },
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

/// A closed wavy sphere of 2 n^2 triangles, its radius between 0.8 and 1.2: a grid wrapped around,
/// with all its vertices shared and a fan at either pole.
pub fn blob(n: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    mesh.positions.push([0.0, 0.0, 1.0]);
    for j in 1..n {
        for i in 0..n {
            let theta = std::f32::consts::PI * j as f32 / n as f32;
            let phi = std::f32::consts::TAU * i as f32 / n as f32;
            let r = 1.0 + 0.2 * (3.0 * phi).sin() * theta.sin() * (5.0 * theta).cos();
            mesh.positions.push([
                r * theta.sin() * phi.cos(),
                r * theta.sin() * phi.sin(),
                r * theta.cos(),
            ]);
        }
    }
    mesh.positions.push([0.0, 0.0, -1.0]);
    let last = mesh.positions.len() as u32 - 1;
    let at = |j: u32, i: u32| 1 + (j - 1) * n + i % n;
    for i in 0..n {
        mesh.triangles.push([0, at(1, i), at(1, i + 1)]);
        mesh.triangles.push([last, at(n - 1, i + 1), at(n - 1, i)]);
        for j in 1..n - 1 {
            mesh.triangles
                .push([at(j, i), at(j + 1, i), at(j + 1, i + 1)]);
            mesh.triangles
                .push([at(j, i), at(j + 1, i + 1), at(j, i + 1)]);
        }
    }
    mesh
}

/// A reproducible source of numbers.
pub struct Numbers(Xoshiro256PlusPlus);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    pub fn unit(&mut self) -> f32 {
        self.0.random()
    }

    pub fn index(&mut self, n: usize) -> usize {
        self.0.random_range(0..n)
    }

    pub fn pair(&mut self) -> glam::Vec2 {
        glam::Vec2::new(self.unit(), self.unit())
    }

    /// Uniform in [-1, 1]^3.
    pub fn cube(&mut self) -> Vec3A {
        2.0 * Vec3A::new(self.unit(), self.unit(), self.unit()) - 1.0
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3A {
        crate::sampling::warp::square_to_sphere(self.pair()).normalize()
    }
}
