//! Shapes that coincide with another.
//!
//! Of several equal shapes in one place a ray can hit one only, whatever their materials are, and no acceleration structure can part them: each
//! ray would be tested against all. If they emit, next event estimation would count the light of all of them, and
//! rays that hit them that of one.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::description::{Radiance, SceneDescription, ShapeDescription, ShapeGeometry};
use super::mesh::TriangleMesh;

/// Shapes that were left out because they coincide with others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coincident {
    /// Name of the first that was left out.
    pub name: String,
    /// Name of the shape that it coincides with.
    pub with: String,
    /// Number of shapes that were left out.
    pub count: usize,
}

impl SceneDescription {
    /// Removes shapes that equal an earlier one in everything but their names and materials. `None` if there are
    /// none.
    pub fn remove_coincident(&mut self) -> Option<Coincident> {
        let mut first: HashMap<u64, usize> = HashMap::new();
        let mut found: Option<Coincident> = None;
        let mut keep = vec![true; self.shapes.len()];
        for (i, shape) in self.shapes.iter().enumerate() {
            let first = *first.entry(hash(shape)).or_insert(i);
            if first == i || !is_same(shape, &self.shapes[first]) {
                continue;
            }
            keep[i] = false;
            let found = found.get_or_insert_with(|| Coincident {
                name: shape.name.clone(),
                with: self.shapes[first].name.clone(),
                count: 0,
            });
            found.count += 1;
        }
        let mut keep = keep.into_iter();
        self.shapes.retain(|_| keep.next().unwrap_or(true));
        found
    }
}

/// Equal for equal shapes.
fn hash(shape: &ShapeDescription) -> u64 {
    let mut hasher = DefaultHasher::new();
    let numbers = shape.to_world.to_cols_array();
    numbers.map(f64::to_bits).hash(&mut hasher);
    shape.flip_normals.hash(&mut hasher);
    match shape.emission {
        None => {}
        Some(Radiance::Constant(rgb)) => rgb.to_array().map(f32::to_bits).hash(&mut hasher),
        Some(Radiance::Texture(texture)) => texture.hash(&mut hasher),
    }
    match &shape.geometry {
        ShapeGeometry::Sphere { center, radius } => {
            center.to_array().map(f64::to_bits).hash(&mut hasher);
            radius.to_bits().hash(&mut hasher);
        }
        ShapeGeometry::Mesh(mesh) => {
            mesh.triangles.hash(&mut hasher);
            for position in &mesh.positions {
                position.map(f32::to_bits).hash(&mut hasher);
            }
        }
    }
    hasher.finish()
}

fn is_same(a: &ShapeDescription, b: &ShapeDescription) -> bool {
    let geometry = match (&a.geometry, &b.geometry) {
        (ShapeGeometry::Mesh(a), ShapeGeometry::Mesh(b)) => is_same_mesh(a, b),
        (
            ShapeGeometry::Sphere { center, radius },
            ShapeGeometry::Sphere {
                center: other_center,
                radius: other_radius,
            },
        ) => center == other_center && radius == other_radius,
        _ => false,
    };
    geometry
        && a.to_world == b.to_world
        && a.flip_normals == b.flip_normals
        && a.emission == b.emission
}

fn is_same_mesh(a: &TriangleMesh, b: &TriangleMesh) -> bool {
    a.triangles == b.triangles
        && a.positions == b.positions
        && a.normals == b.normals
        && a.uvs == b.uvs
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};

    use super::*;
    use crate::math::Rgb;
    use crate::scene::test_scenes;

    #[test]
    fn equal_shapes_are_left_out_and_others_kept() {
        let sphere = |name: &str, x: f64| ShapeDescription {
            name: name.into(),
            ..test_scenes::sphere(DVec3::new(x, 0.0, 0.0), 1.0)
        };
        let mesh = |name: &str| ShapeDescription {
            name: name.into(),
            ..test_scenes::mesh(TriangleMesh::rectangle(), DMat4::IDENTITY)
        };
        let mut scene = test_scenes::description(Vec::new(), Vec::new());
        scene.shapes = vec![
            sphere("a", 0.0),
            sphere("b", 1.0),
            sphere("c", 0.0),
            test_scenes::emitting(sphere("d", 0.0), Rgb::ONE),
            mesh("e"),
            sphere("f", 0.0),
            mesh("g"),
        ];
        let expected = Coincident {
            name: "c".into(),
            with: "a".into(),
            count: 3,
        };
        assert_eq!(scene.remove_coincident(), Some(expected));
        let names: Vec<&str> = scene.shapes.iter().map(|shape| &*shape.name).collect();
        assert_eq!(names, ["a", "b", "d", "e"]);
        assert_eq!(scene.remove_coincident(), None);
    }
}
