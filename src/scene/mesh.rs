//! Triangle meshes as read from a file.

use std::collections::HashMap;

use glam::{DMat3, DMat4, DVec3, Vec3};

/// A triangle mesh in its own coordinates. [`super::SceneDescription::build`] requires finite numbers,
/// indices in range, and attribute arrays that are empty or as long as `positions`.
#[derive(Clone, Debug, Default)]
pub struct TriangleMesh {
    /// Positions of the vertices.
    pub positions: Vec<[f32; 3]>,
    /// Shading normals per vertex, not necessarily of unit length; empty for flat shading.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates per vertex; if empty, the barycentric coordinates (b1, b2) of the hit are used
    /// instead, as in Mitsuba.
    pub uvs: Vec<[f32; 2]>,
    /// Indices of the three vertices of each, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Mitsuba's `rectangle`: [-1, 1]^2 in the plane z = 0, facing +z, with texture coordinates
    /// ((x + 1)/2, (y + 1)/2).
    pub fn rectangle() -> Self {
        let uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        Self {
            positions: uvs
                .iter()
                .map(|[u, v]| [2.0 * u - 1.0, 2.0 * v - 1.0, 0.0])
                .collect(),
            // Unlike the winding, these follow a mirroring transform, as Mitsuba's do.
            normals: vec![[0.0, 0.0, 1.0]; 4],
            uvs,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// Mitsuba's `cube`: [-1, 1]^3, facing outward, each face mapped to the unit square.
    pub fn cube() -> Self {
        /// The normal of each face and its corners, in the order of [`UVS`].
        const FACES: [(Vec3, [[i8; 3]; 4]); 6] = [
            (
                Vec3::NEG_Y,
                [[1, -1, -1], [1, -1, 1], [-1, -1, 1], [-1, -1, -1]],
            ),
            (Vec3::Y, [[1, 1, -1], [-1, 1, -1], [-1, 1, 1], [1, 1, 1]]),
            (Vec3::X, [[1, -1, -1], [1, 1, -1], [1, 1, 1], [1, -1, 1]]),
            (Vec3::Z, [[1, -1, 1], [1, 1, 1], [-1, 1, 1], [-1, -1, 1]]),
            (
                Vec3::NEG_X,
                [[-1, -1, 1], [-1, 1, 1], [-1, 1, -1], [-1, -1, -1]],
            ),
            (
                Vec3::NEG_Z,
                [[1, 1, -1], [1, -1, -1], [-1, -1, -1], [-1, 1, -1]],
            ),
        ];
        const UVS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        let mut mesh = Self::default();
        for (normal, corners) in FACES {
            let first = mesh.positions.len() as u32;
            mesh.positions
                .extend(corners.map(|corner| corner.map(f32::from)));
            mesh.normals.extend([normal.to_array(); 4]);
            mesh.uvs.extend(UVS);
            mesh.triangles.push([first, first + 1, first + 2]);
            mesh.triangles.push([first + 3, first, first + 2]);
        }
        mesh
    }

    /// Computes smooth normals, as Mitsuba does where a file has none: [`Self::smooth_normals`] of all vertices.
    pub fn compute_vertex_normals(&mut self, to_world: &DMat4) {
        self.normals = self.smooth_normals(to_world);
    }

    /// For each vertex the mean of the normals of the triangles around it, weighted by their angle there
    /// (Thürmer and Wüthrich 1998, "Computing vertex normals from polygonal facets").
    ///
    /// Angles and front sides are those of the mesh after the transform `to_world`, which may stretch and
    /// mirror it; the normals are such that this transform yields the right ones. Vertices of no
    /// triangle with area get (1, 0, 0) in world coordinates.
    pub fn smooth_normals(&self, to_world: &DMat4) -> Vec<[f32; 3]> {
        let linear = DMat3::from_mat4(*to_world);
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let p = triangle.map(|vertex| linear * self.position(vertex));
            let Some(normal) = (p[1] - p[0]).cross(p[2] - p[0]).try_normalize() else {
                continue;
            };
            for (i, &vertex) in triangle.iter().enumerate() {
                let a = p[(i + 1) % 3] - p[i];
                let b = p[(i + 2) % 3] - p[i];
                let angle = a.cross(b).length().atan2(a.dot(b));
                sums[vertex as usize] += normal * angle;
            }
        }
        // The inverse transpose of `linear` transforms normals to the world.
        let to_local = linear.transpose();
        sums.iter()
            .map(|sum| {
                let normal = to_local * sum.try_normalize().unwrap_or(DVec3::X);
                normal.normalize_or_zero().as_vec3().to_array()
            })
            .collect()
    }

    /// Computes normals that are smooth except where triangles meet at more than `max_degrees`, as Mitsuba
    /// 0.6 does (`TriMesh::rebuildTopology`): vertices at one place with the same texture coordinates become
    /// one, and then several, each of the triangles whose normals are within the angle of that of the first
    /// of them. Angles are those after the transform `to_world`.
    pub fn smooth_up_to(&mut self, max_degrees: f64, to_world: &DMat4) {
        let min_cos = max_degrees.to_radians().cos();
        let linear = DMat3::from_mat4(*to_world);
        let place = |vertex: u32| -> Vec<u32> {
            let uv = self.uvs.get(vertex as usize).into_iter().flatten();
            let numbers = self.positions[vertex as usize].iter().chain(uv);
            // Adding 0 makes -0 the same as 0.
            numbers.map(|x| (x + 0.0).to_bits()).collect()
        };
        // At each place, the vertices so far: the normal of their first triangle, and their index.
        let mut places: HashMap<Vec<u32>, Vec<(DVec3, u32)>> = HashMap::new();
        let mut smoothed = Self::default();
        for triangle in &self.triangles {
            let p = triangle.map(|vertex| linear * self.position(vertex));
            let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
            let corners = triangle.map(|vertex| {
                let vertices = places.entry(place(vertex)).or_default();
                let same = vertices.iter().find(|(n, _)| n.dot(normal) >= min_cos);
                if let Some(&(_, index)) = same {
                    return index;
                }
                let index = smoothed.positions.len() as u32;
                vertices.push((normal, index));
                smoothed.positions.push(self.positions[vertex as usize]);
                smoothed.uvs.extend(self.uvs.get(vertex as usize));
                index
            });
            smoothed.triangles.push(corners);
        }
        smoothed.compute_vertex_normals(to_world);
        *self = smoothed;
    }

    fn position(&self, vertex: u32) -> DVec3 {
        DVec3::from_array(self.positions[vertex as usize].map(f64::from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(mesh: &TriangleMesh, vertex: u32) -> Vec3 {
        Vec3::from_array(mesh.positions[vertex as usize])
    }

    #[test]
    fn rectangle_and_cube_have_the_right_area_and_winding() {
        for (mesh, area) in [
            (TriangleMesh::rectangle(), 4.0),
            (TriangleMesh::cube(), 24.0),
        ] {
            let mut sum = 0.0;
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|v| position(&mesh, v));
                let cross = (b - a).cross(c - a);
                let normal = Vec3::from_array(mesh.normals[triangle[0] as usize]);
                assert_eq!(cross.normalize(), normal);
                sum += 0.5 * cross.length();
            }
            assert_eq!(sum, area);
        }
    }

    /// The corner of a cube, with one of its three faces divided into two triangles there: without
    /// weights that face would count twice.
    #[test]
    fn vertex_normals_are_weighted_by_angle() {
        let mut mesh = TriangleMesh {
            positions: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, 1.0, 0.0],
            ],
            triangles: vec![[0, 4, 1], [0, 2, 4], [0, 1, 3], [0, 3, 2]],
            ..TriangleMesh::default()
        };
        mesh.compute_vertex_normals(&DMat4::IDENTITY);
        let expected = Vec3::splat(-1.0 / 3.0_f32.sqrt());
        assert!((Vec3::from_array(mesh.normals[0]) - expected).length() < 1e-6);
    }

    /// Under a transform that stretches and mirrors, the stored normals are transformed to those that
    /// would be computed in world coordinates.
    #[test]
    fn vertex_normals_are_those_of_the_transformed_mesh() {
        let to_world = DMat4::from_scale(DVec3::new(-1.0, 3.0, 0.5));
        let mut local = TriangleMesh {
            positions: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.2, 0.1],
                [0.3, 1.0, -0.4],
                [-1.0, 0.5, 0.6],
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..TriangleMesh::default()
        };
        let mut placed = local.clone();
        for p in &mut placed.positions {
            *p = [-p[0], 3.0 * p[1], 0.5 * p[2]];
        }
        local.compute_vertex_normals(&to_world);
        placed.compute_vertex_normals(&DMat4::IDENTITY);
        for (l, p) in local.normals.iter().zip(&placed.normals) {
            let world = Vec3::new(-l[0], l[1] / 3.0, l[2] / 0.5).normalize();
            assert!((world - Vec3::from_array(*p)).length() < 1e-6);
        }
    }

    /// Two triangles that meet at 90 degrees: with a larger angle they share the vertices of their edge,
    /// with a smaller one they do not, even if they did in the file.
    #[test]
    fn creases_divide_vertices() {
        let fold = TriangleMesh {
            positions: vec![
                [0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0],
            ],
            triangles: vec![[0, 2, 1], [0, 1, 3]],
            ..TriangleMesh::default()
        };
        for (angle, vertices, expected) in [(100.0, 4, [0.5, 0.0, 0.5]), (80.0, 6, [0.0, 0.0, 1.0])]
        {
            let mut mesh = fold.clone();
            mesh.smooth_up_to(angle, &DMat4::IDENTITY);
            assert_eq!(mesh.positions.len(), vertices, "{angle}");
            let corner = mesh.triangles[0][0] as usize;
            let normal = Vec3::from_array(mesh.normals[corner]);
            let expected = Vec3::from_array(expected).normalize();
            assert!((normal - expected).length() < 1e-6, "{angle}: {normal}");
        }
    }
}
