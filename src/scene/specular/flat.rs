//! Shapes of a few flat faces: slabs, blocks, prisms, mirrors.

use glam::DVec3;

use super::chain::MAX_LENGTH;
use super::plane::Plane;
use crate::bvh::Corners;

/// Maximum number of faces of a shape whose sequences are enumerated.
pub const MAX_FACES: usize = 16;

/// Tolerance for the normals of faces in one plane, and relative tolerance for points on faces.
const TOLERANCE: f64 = 1e-5;

/// Tolerance for distances from a plane, in scene units: coordinates are rounded to f32.
const PLANE_TOLERANCE: f64 = 1e-6 * crate::scene::SCENE_RADIUS as f64;

/// A shape of flat faces that reflects or refracts without roughness.
#[derive(Debug)]
pub struct FlatCaster {
    pub shape: u32,
    /// Index of refraction of the side behind the normals over that of the other side; `None` if it only
    /// reflects.
    pub eta: Option<f64>,
    pub faces: Vec<Face>,
    /// All faces lie behind each other: the shape is a convex body, and its normals point outward.
    pub convex: bool,
}

/// The triangles of a shape in one plane.
#[derive(Debug)]
pub struct Face {
    pub plane: Plane,
    /// Indices of the primitives.
    pub primitives: Vec<u32>,
    triangles: Vec<Corners>,
    /// A sphere around the triangles.
    pub center: DVec3,
    pub radius: f64,
}

impl Face {
    /// True if a point of the plane lies within the triangles.
    pub fn contains(&self, point: DVec3) -> bool {
        self.triangles.iter().any(|corners| {
            let [a, b, c] = corners.map(|p| DVec3::from_array(p.map(f64::from)));
            let area = (b - a).cross(c - a).dot(self.plane.normal);
            let part = |p: DVec3, q: DVec3| (p - point).cross(q - point).dot(self.plane.normal);
            let parts = [part(a, b), part(b, c), part(c, a)];
            parts
                .iter()
                .all(|&part| part * area >= -TOLERANCE * area * area)
        })
    }
}

impl FlatCaster {
    /// The caster of triangles: index, corners, and front normal of each; `None` if their planes are too many.
    pub fn new(
        shape: u32,
        eta: Option<f64>,
        triangles: impl Iterator<Item = (u32, Corners, DVec3)>,
    ) -> Option<Self> {
        let mut faces: Vec<Face> = Vec::new();
        for (primitive, corners, normal) in triangles {
            let points = corners.map(|p| DVec3::from_array(p.map(f64::from)));
            let geometric = (points[1] - points[0])
                .cross(points[2] - points[0])
                .normalize();
            // From the corners, which are more precise than the given normal.
            let normal = geometric * geometric.dot(normal).signum();
            let offset = normal.dot(points.iter().sum::<DVec3>() / 3.0);
            let same = |face: &&mut Face| {
                face.plane.normal.distance(normal) < TOLERANCE
                    && points
                        .iter()
                        .all(|&p| face.plane.distance(p).abs() < PLANE_TOLERANCE)
            };
            if let Some(face) = faces.iter_mut().find(same) {
                face.primitives.push(primitive);
                face.triangles.push(corners);
            } else if faces.len() == MAX_FACES {
                return None;
            } else {
                let plane = Plane { normal, offset };
                faces.push(Face {
                    plane,
                    primitives: vec![primitive],
                    triangles: vec![corners],
                    center: DVec3::ZERO,
                    radius: 0.0,
                });
            }
        }
        for face in &mut faces {
            (face.center, face.radius) = bounding_sphere(face.triangles.iter());
        }
        let corners = || {
            let all = faces
                .iter()
                .flat_map(|face| face.triangles.iter().flatten());
            all.map(|p| DVec3::from_array(p.map(f64::from)))
        };
        let behind = |face: &Face| corners().all(|p| face.plane.distance(p) < PLANE_TOLERANCE);
        let convex = faces.len() >= 4 && faces.iter().all(behind);
        (!faces.is_empty()).then_some(Self {
            shape,
            eta,
            faces,
            convex,
        })
    }

    /// Centre and radius of a sphere around the faces.
    pub fn bounds(&self) -> (DVec3, f64) {
        bounding_sphere(self.faces.iter().flat_map(|face| face.triangles.iter()))
    }

    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Maximum length of its chains.
    pub fn max_length(&self) -> usize {
        if self.faces.len() == 1 { 1 } else { MAX_LENGTH }
    }
}

/// Centre and radius of a sphere around triangles.
fn bounding_sphere<'a>(triangles: impl Iterator<Item = &'a Corners> + Clone) -> (DVec3, f64) {
    let corners = || {
        let all = triangles.clone().flatten();
        all.map(|p| DVec3::from_array(p.map(f64::from)))
    };
    let (min, max) = corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| {
        (min.min(p), max.max(p))
    });
    let center = 0.5 * (min + max);
    let radius = corners().map(|p| p.distance(center)).fold(0.0, f64::max);
    (center, radius)
}
