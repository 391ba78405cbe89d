//! Scenes for rays.

use std::f32::consts::{PI, TAU};
use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use metrolight::sampling::seeds::{self, Purpose};
use metrolight::scene::{Scene, SceneDescription, ShapeGeometry, TriangleMesh};
use rand::RngExt;

use crate::common::{description, shape, white_sky};

/// A scene, and its triangles in scene units.
pub struct Subject {
    pub name: String,
    pub scene: Scene,
    pub triangles: Vec<[[f32; 3]; 3]>,
}

impl Subject {
    fn new(name: &str, description: SceneDescription) -> Self {
        let meshes: Vec<_> = description
            .shapes
            .iter()
            .filter_map(|shape| match &shape.geometry {
                ShapeGeometry::Mesh(mesh) => Some((mesh.clone(), shape.to_world)),
                ShapeGeometry::Sphere { .. } => None,
            })
            .collect();
        let scene = description.build().expect("a valid scene");
        // The same arithmetic as in `SceneDescription::build`.
        let to_scene = DMat4::from_scale(DVec3::splat(1.0 / scene.unit))
            * DMat4::from_translation(-scene.center);
        let mut triangles = Vec::new();
        for (mesh, to_world) in meshes {
            let place = |v: u32| {
                let p = DVec3::from_array(mesh.positions[v as usize].map(f64::from));
                let p = (to_scene * to_world).transform_point3(p);
                p.as_vec3().to_array()
            };
            triangles.extend(mesh.triangles.iter().map(|t| t.map(place)));
        }
        Self {
            name: name.into(),
            scene,
            triangles,
        }
    }
}

/// A scene of the repository, without its spheres.
pub fn of_repository(name: &str) -> Subject {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = root.join(format!("scenes/{name}/scene.xml"));
    let loaded = metrolight::mitsuba::load(&path, &[]).expect("a scene of the repository");
    let mut description = loaded.description;
    description
        .shapes
        .retain(|shape| matches!(shape.geometry, ShapeGeometry::Mesh(_)));
    description.emitters = vec![white_sky()];
    Subject::new(name, description)
}

/// 26 bumpy balls of `2 n (n - 1)` triangles each, of various sizes and overlapping, in a closed room.
pub fn clutter(name: &str, n: u32) -> Subject {
    let mut rng = seeds::generator(1, Purpose::Probes, 1);
    let mut shapes = vec![shape(TriangleMesh::cube(), DMat4::IDENTITY)];
    for _ in 0..26 {
        let mut number = || 2.0 * rng.random::<f64>() - 1.0;
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, number(), number(), number());
        let center = DVec3::new(number(), number(), number()) * 0.75;
        let size = 0.25 + 0.15 * number();
        let place = DMat4::from_scale_rotation_translation(
            DVec3::new(size, size, 0.6 * size),
            turn,
            center,
        );
        shapes.push(shape(bumpy_ball(n), place));
    }
    Subject::new(name, description(-0.99, 70.0, shapes))
}

/// One closed mesh around the origin.
pub fn ball(n: u32) -> Subject {
    let shapes = vec![shape(bumpy_ball(n), DMat4::IDENTITY)];
    Subject::new("ball", description(-0.99, 70.0, shapes))
}

/// Exactly closed: adjacent triangles share their vertices, also at the poles and along the seam.
fn bumpy_ball(n: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    mesh.positions.push([0.0, 0.0, 1.0]);
    for i in 1..n {
        for j in 0..n {
            let (theta, phi) = (PI * i as f32 / n as f32, TAU * j as f32 / n as f32);
            let r = 1.0 + 0.05 * (9.0 * theta).sin() * (7.0 * phi).sin();
            let xy = r * theta.sin();
            let position = [xy * phi.cos(), xy * phi.sin(), r * theta.cos()];
            mesh.positions.push(position);
        }
    }
    mesh.positions.push([0.0, 0.0, -1.0]);
    let vertex = |i: u32, j: u32| match i {
        0 => 0,
        _ if i == n => 1 + (n - 1) * n,
        _ => 1 + (i - 1) * n + j % n,
    };
    for i in 0..n {
        for j in 0..n {
            let [a, b] = [vertex(i, j), vertex(i, j + 1)];
            let [c, d] = [vertex(i + 1, j), vertex(i + 1, j + 1)];
            if a != b {
                mesh.triangles.push([a, c, b]);
            }
            if c != d {
                mesh.triangles.push([b, c, d]);
            }
        }
    }
    mesh
}
