//! Collects the shapes of a scene and builds its geometry.

use glam::{Mat3A, Vec3A};

use super::Geometry;
use super::shape::{Attributes, MeshAttributes, Shape, cross};
use crate::bvh::{Bvh, Primitive, Sphere, Triangle};
use crate::scene::TriangleMesh;

/// The shapes that have been added so far.
#[derive(Default)]
pub(in crate::scene) struct GeometryBuilder {
    primitives: Vec<Primitive>,
    shapes: Vec<Shape>,
    degenerate: usize,
}

impl GeometryBuilder {
    /// Adds a mesh in scene units as the next shape.
    pub(in crate::scene) fn add_mesh(
        &mut self,
        name: String,
        material: u32,
        flip: bool,
        mesh: TriangleMesh,
    ) {
        let shape = self.shapes.len() as u32;
        self.primitives.reserve(mesh.triangles.len());
        let before = self.primitives.len();
        let primitives = mesh.triangles.iter().filter_map(|&vertices| {
            let corners = vertices.map(|v| mesh.positions[v as usize]);
            (cross(&corners).length_squared() > 0.0).then_some(Primitive::Triangle(Triangle {
                corners,
                shape,
                vertices,
            }))
        });
        self.primitives.extend(primitives);
        self.degenerate += mesh.triangles.len() - (self.primitives.len() - before);
        let attributes = Attributes::Mesh(MeshAttributes {
            normals: mesh.normals,
            uvs: mesh.uvs,
        });
        self.shapes.push(Shape {
            name,
            material,
            flip,
            attributes,
        });
    }

    /// Adds a sphere in scene units as the next shape; `to_local` turns scene axes into its own.
    pub(in crate::scene) fn add_sphere(
        &mut self,
        name: String,
        material: u32,
        flip: bool,
        (center, radius): (Vec3A, f32),
        to_local: Mat3A,
    ) {
        let shape = self.shapes.len() as u32;
        if radius > 0.0 {
            self.primitives.push(Primitive::Sphere(Sphere {
                center: center.to_array(),
                radius,
                shape,
            }));
        } else {
            self.degenerate += 1;
        }
        self.shapes.push(Shape {
            name,
            material,
            flip,
            attributes: Attributes::Sphere(to_local),
        });
    }

    /// Builds the acceleration structure.
    pub(in crate::scene) fn build(self) -> Geometry {
        Geometry {
            bvh: Bvh::new(self.primitives),
            shapes: self.shapes,
            degenerate: self.degenerate,
        }
    }
}
