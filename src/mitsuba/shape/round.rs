//! `cylinder` and `disk`, as meshes of many thin triangles.
//!
//! The corners of a regular polygon of [`SIDES`] sides lie on the circle. Its area is smaller than the
//! circle's by 2 pi^2 / (3 n^2), 2e-6 of it, and its distance from the circle is at most pi^2 / (2 n^2),
//! 1.2e-6 of the radius. Vertex normals of a cylinder are exact at the corners; between them the
//! interpolated normal is off by at most (pi / n)^3 / (9 sqrt 3) radians, 3e-10.

use std::f64::consts::TAU;

use glam::{DMat3, DMat4, DVec3};

use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::xml::Object;
use crate::scene::{ShapeGeometry, TriangleMesh};

/// Number of sides of the polygon that stands for a circle.
const SIDES: u32 = 2048;

/// Around the line from `p0` to `p1`, without caps, facing outward. Texture coordinates are (phi / 2 pi,
/// height / length), as in Mitsuba 3.
pub fn cylinder(_: &mut Builder, object: &Object) -> Result<ShapeGeometry, LoadError> {
    let radius = object.float_in("radius", 1.0, "above 0", |r| r > 0.0)?;
    let from = object.vector("p0")?.unwrap_or(DVec3::ZERO);
    let to = object.vector("p1")?.unwrap_or(DVec3::Z);
    let axis = to - from;
    let Some(direction) = axis.try_normalize() else {
        return Err(object.error(Cause::zero_vector("p1 - p0")));
    };
    let (s, t) = tangents(direction);
    let place = DMat4::from_translation(from)
        * DMat4::from_mat3(DMat3::from_cols(s * radius, t * radius, axis));
    let mut mesh = TriangleMesh::default();
    for side in 0..=SIDES {
        let (around, outward) = on_circle(f64::from(side));
        let normal = (s * outward.x + t * outward.y).as_vec3().to_array();
        for height in [0.0, 1.0] {
            let point = place.transform_point3(outward + DVec3::Z * height);
            mesh.positions.push(point.as_vec3().to_array());
            mesh.normals.push(normal);
            mesh.uvs.push([around as f32, height as f32]);
        }
    }
    for first in (0..2 * SIDES).step_by(2) {
        mesh.triangles.push([first, first + 2, first + 3]);
        mesh.triangles.push([first, first + 3, first + 1]);
    }
    Ok(ShapeGeometry::Mesh(mesh))
}

/// Of radius 1 in the plane z = 0, facing +z. Texture coordinates are (r, phi / 2 pi), as in Mitsuba 3; phi
/// is off by up to half a side of the polygon.
pub fn disk(_: &mut Builder, object: &Object) -> Result<ShapeGeometry, LoadError> {
    object.boolean("face_normals", false)?;
    let mut mesh = TriangleMesh::default();
    let mut add = |point: DVec3, u: f64, v: f64| {
        mesh.positions.push(point.as_vec3().to_array());
        // Unlike the winding, these follow a mirroring transform, as Mitsuba's do.
        mesh.normals.push([0.0, 0.0, 1.0]);
        mesh.uvs.push([u as f32, v as f32]);
    };
    for side in 0..SIDES {
        // Each triangle has a corner of its own at the centre, where v is that of its middle.
        add(DVec3::ZERO, 0.0, on_circle(f64::from(side) + 0.5).0);
        for end in [side, side + 1] {
            let (around, outward) = on_circle(f64::from(end));
            add(outward, 1.0, around);
        }
    }
    mesh.triangles = (0..SIDES).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Ok(ShapeGeometry::Mesh(mesh))
}

/// The fraction of the way around the unit circle after a number of sides, and the point there.
fn on_circle(side: f64) -> (f64, DVec3) {
    let around = side / f64::from(SIDES);
    let (sin, cos) = (TAU * around).sin_cos();
    (around, DVec3::new(cos, sin, 0.0))
}

/// The tangents of Duff et al. 2017, "Building an orthonormal basis, revisited", with which Mitsuba places a
/// cylinder around its axis.
fn tangents(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(n.z);
    let a = -(sign + n.z).recip();
    let b = n.x * n.y * a;
    (
        DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        DVec3::new(b, sign + n.y * n.y * a, -n.y),
    )
}
