//! Shapes for the tests of the finders.

mod finder;
mod jacobian;

use glam::{DMat4, DVec3, Vec3A};

use super::{Candidate, Endpoint};
use crate::math::{Frame, Rgb};
use crate::scene::bsdf::Material;
use crate::scene::test_scenes::{self, Numbers};
use crate::scene::{EmitterDescription, Scene, ShapeDescription, SurfacePoint, TriangleMesh};

/// Of the scene.
const RADIUS: f64 = crate::scene::SCENE_RADIUS as f64;

/// T beyond which a point is too close to a caustic for a comparison, in units of [`scale`].
const FOCUS: f64 = 100.0;

/// Makes T a number without a unit.
fn scale(end: &Endpoint) -> f64 {
    match end {
        Endpoint::Point { .. } => RADIUS * RADIUS,
        Endpoint::Direction(_) => 1.0,
    }
}

fn glass(eta: f32) -> Material {
    Material::Dielectric {
        eta,
        specular_reflectance: 0,
        specular_transmittance: 0,
    }
}

const MIRROR: Material = Material::Conductor {
    eta: Rgb::splat(0.2),
    k: Rgb::splat(4.0),
    specular_reflectance: 0,
};

/// A scene of one shape of this material.
fn scene_of(shape: ShapeDescription, material: Material) -> Scene {
    let constant = EmitterDescription::Constant { radiance: Rgb::ONE };
    let mut description = test_scenes::description(vec![shape], vec![constant]);
    description.materials = vec![material];
    description.build().expect("a scene")
}

/// A point in free space, as a vertex that no ray is offset from in an unexpected direction.
fn free_point(position: DVec3) -> SurfacePoint {
    SurfacePoint {
        position: position.as_vec3a(),
        geometric_normal: Vec3A::ZERO,
        shading: Frame::from_normal(Vec3A::Z),
        uv: glam::Vec2::ZERO,
        shape: 0,
        primitive: 0,
    }
}

fn find(scene: &Scene, start: DVec3, end: &Endpoint) -> Vec<Candidate> {
    let mut found = Vec::new();
    scene.casters.chains(start, end, &mut found);
    found
}

fn random_direction(numbers: &mut Numbers) -> DVec3 {
    numbers.direction().as_dvec3()
}

/// A graph z = f(x, y) over [-1, 1]^2 with its normals.
fn graph(n: u32, f: impl Fn(f64, f64) -> f64) -> TriangleMesh {
    let mut mesh = test_scenes::grid(n);
    let slope = |x: f64, y: f64| {
        let step = 1e-5;
        let dx = (f(x + step, y) - f(x - step, y)) / (2.0 * step);
        let dy = (f(x, y + step) - f(x, y - step)) / (2.0 * step);
        DVec3::new(-dx, -dy, 1.0).normalize()
    };
    mesh.normals = mesh
        .positions
        .iter()
        .map(|p| slope(p[0].into(), p[1].into()).as_vec3().to_array())
        .collect();
    for p in &mut mesh.positions {
        p[2] = f(p[0].into(), p[1].into()) as f32;
    }
    mesh
}

fn shape(mesh: TriangleMesh) -> ShapeDescription {
    test_scenes::mesh(mesh, DMat4::IDENTITY)
}

fn waves(x: f64, y: f64) -> f64 {
    0.05 * (5.0 * x + 1.0).sin() * (4.0 * y).cos() + 0.03 * (9.0 * x - 7.0 * y).sin()
}

fn blob(n: u32, flat: bool) -> ShapeDescription {
    let mut mesh = test_scenes::blob(n);
    if !flat {
        mesh.compute_vertex_normals(&DMat4::IDENTITY);
    }
    shape(mesh)
}

/// A prism with a triangular base.
fn prism() -> ShapeDescription {
    let corner = |angle: f32, z: f32| [angle.cos(), angle.sin(), z];
    let angles = [0.3, 2.2, 4.1];
    let mut positions: Vec<[f32; 3]> = angles.map(|a| corner(a, -0.8)).to_vec();
    positions.extend(angles.map(|a| corner(a, 0.8)));
    let mut triangles = vec![[0, 2, 1], [3, 4, 5]];
    for i in 0..3u32 {
        let j = (i + 1) % 3;
        triangles.extend([[i, j, j + 3], [i, j + 3, i + 3]]);
    }
    shape(TriangleMesh {
        positions,
        triangles,
        ..TriangleMesh::default()
    })
}
