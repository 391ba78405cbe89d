//! Transforms of shapes: positions, normals and sides of surfaces.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec2, DVec3};
use metrolight::film::Filter;
use metrolight::math::Rgb;
use metrolight::scene::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Material, Projection, Ray,
    RayCounts, Scene, SceneDescription, ShapeDescription, ShapeGeometry, SurfacePoint, Texture,
    TriangleMesh,
};
use proptest::prelude::*;

use super::direction;

fn scene(geometry: ShapeGeometry, to_world: DMat4, flip_normals: bool) -> Scene {
    let shape = ShapeDescription {
        name: "shape".into(),
        geometry,
        to_world,
        flip_normals,
        material: 0,
        emission: None,
    };
    let description = SceneDescription {
        camera: CameraDescription {
            to_world: DMat4::IDENTITY,
            projection: Projection::Perspective {
                fov_x: 50.0,
                lens: None,
            },
            principal_point_offset: DVec2::ZERO,
            near_clip: 0.01,
            far_clip: 1e4,
        },
        film: FilmSettings {
            width: 2,
            height: 2,
            filter: Filter::Box,
            crop: None,
        },
        depth: DepthLimits {
            max_depth: None,
            rr_depth: 5,
        },
        hide_emitters: false,
        textures: vec![Texture::Constant(Rgb::splat(0.5))],
        materials: vec![Material::Diffuse { reflectance: 0 }],
        shapes: vec![shape],
        emitters: vec![EmitterDescription::Constant { radiance: Rgb::ONE }],
    };
    description.build().expect("a scene")
}

/// Intersection of the ray from `origin` (in world coordinates) through `target`.
fn cast(scene: &Scene, origin: DVec3, target: DVec3) -> Option<SurfacePoint> {
    let ray = Ray {
        origin: ((origin - scene.center) / scene.unit).as_vec3a(),
        direction: (target - origin).normalize().as_vec3a(),
        t_max: f32::INFINITY,
    };
    scene.geometry.intersect(&ray, &mut RayCounts::default())
}

fn rotation() -> impl Strategy<Value = DQuat> {
    (direction(), -4.0..4.0f64)
        .prop_map(|(axis, angle)| DQuat::from_axis_angle(axis.as_dvec3().normalize(), angle))
}

/// A factor of either sign.
fn factor() -> impl Strategy<Value = f64> {
    (-3.0..3.0f64, any::<bool>()).prop_map(|(e, mirror)| if mirror { -e.exp2() } else { e.exp2() })
}

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    [-size..size, -size..size, -size..size].prop_map(DVec3::from)
}

/// Rotated, scaled non-uniformly, mirrored, rotated again (so sheared) and translated.
fn affine() -> impl Strategy<Value = DMat4> {
    let scale = [factor(), factor(), factor()].prop_map(DVec3::from);
    (rotation(), scale, rotation(), vector(100.0)).prop_map(|(first, scale, second, place)| {
        let linear =
            DMat3::from_quat(second) * DMat3::from_diagonal(scale) * DMat3::from_quat(first);
        DAffine3::from_mat3_translation(linear, place).into()
    })
}

/// Corners of a triangle that is not a sliver, at the precision of a mesh.
fn corners() -> impl Strategy<Value = [DVec3; 3]> {
    [vector(1.0), vector(1.0), vector(1.0)].prop_filter_map("a triangle", |corners| {
        let [a, b, c] = corners.map(|p| p.as_vec3().as_dvec3());
        let area = (b - a).cross(c - a).length();
        (area > 0.1 * (b - a).length_squared().max((c - a).length_squared())).then_some([a, b, c])
    })
}

/// Barycentric coordinates within a triangle, away from its edges.
fn within() -> impl Strategy<Value = [f64; 3]> {
    (0.01..0.97f64, 0.01..1.0f64).prop_map(|(b1, part)| {
        let b2 = (0.98 - b1) * part + 0.005;
        [1.0 - b1 - b2, b1, b2]
    })
}

fn blend(b: [f64; 3], v: [DVec3; 3]) -> DVec3 {
    v[0] * b[0] + v[1] * b[1] + v[2] * b[2]
}

proptest! {
    /// A transformed triangle is hit at its transformed position, from both sides. Its normal is
    /// perpendicular to its edges, which needs the inverse transpose for non-uniform scales, and on the
    /// side of the vertex normals, or else of the winding.
    #[test]
    fn triangles_are_transformed(
        corners in corners(),
        normals in prop::option::of([vector(1.0), vector(1.0), vector(1.0)]),
        to_world in affine(),
        flip in any::<bool>(),
        b in within(),
        from in direction(),
    ) {
        let winding = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        // Vertex normals deviate by up to 45 degrees from that of the triangle.
        let normals = normals.map(|lean| lean.map(|lean| winding + 0.5 * lean));
        let uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let mesh = TriangleMesh {
            positions: corners.map(|p| p.as_vec3().to_array()).to_vec(),
            normals: normals.map_or(vec![], |n| n.map(|n| n.as_vec3().to_array()).to_vec()),
            uvs: uvs.to_vec(),
            triangles: vec![[0, 1, 2]],
        };
        let scene = scene(ShapeGeometry::Mesh(mesh), to_world, flip);
        let placed = corners.map(|p| to_world.transform_point3(p));
        let target = blend(b, placed);
        let edges = [placed[1] - placed[0], placed[2] - placed[0]];
        let normal = edges[0].cross(edges[1]).normalize();
        let from = from.as_dvec3();
        // Not at grazing angles.
        prop_assume!(from.dot(normal).abs() > 0.1);
        let hit = cast(&scene, target + 500.0 * scene.unit * from, target);
        let hit = hit.ok_or_else(|| TestCaseError::fail("no hit"))?;

        let place = hit.position.as_dvec3() * scene.unit + scene.center;
        prop_assert!(place.distance(target) < 1e-5 * 1000.0 * scene.unit, "{place} {target}");
        prop_assert!((f64::from(hit.uv.x) - b[1]).abs() < 2e-4, "{} {b:?}", hit.uv);
        prop_assert!((f64::from(hit.uv.y) - b[2]).abs() < 2e-4, "{} {b:?}", hit.uv);

        let inverse_transpose = DMat3::from_mat4(to_world).inverse().transpose();
        let side = match normals {
            Some(normals) => (inverse_transpose * (normals[0] + normals[1] + normals[2])).dot(normal),
            None => 1.0,
        };
        let expected = if (side < 0.0) == flip { normal } else { -normal };
        let geometric = hit.geometric_normal.as_dvec3();
        // Where the side of the vertex normals is ambiguous, either is right.
        prop_assume!(side.abs() > 1e-3);
        prop_assert!(geometric.distance(expected) < 1e-3, "{geometric} {expected}");

        let smooth = normals.map(|n| blend(b, n.map(|n| (inverse_transpose * n).normalize())));
        let expected = match smooth {
            Some(n) if flip => -n.normalize(),
            Some(n) => n.normalize(),
            None => expected,
        };
        let shading = hit.shading.n.as_dvec3();
        prop_assert!(shading.distance(expected) < 2e-3, "{shading} {expected}");
        prop_assert!((hit.shading.s.cross(hit.shading.t) - hit.shading.n).length() < 1e-5);
    }

    /// Rotations, reflections and uniform scales map spheres to spheres; a reflection turns them inside
    /// out.
    #[test]
    fn spheres_are_transformed(
        center in vector(2.0),
        radius in 0.1..3.0f64,
        turn in rotation(),
        scale in factor(),
        mirror in any::<bool>(),
        place in vector(100.0),
        flip in any::<bool>(),
        outward in direction(),
    ) {
        let mirroring = DVec3::new(if mirror { -1.0 } else { 1.0 }, 1.0, 1.0);
        let linear = DMat3::from_quat(turn) * DMat3::from_diagonal(scale * mirroring);
        let to_world: DMat4 = DAffine3::from_mat3_translation(linear, place).into();
        let scene = scene(ShapeGeometry::Sphere { center, radius }, to_world, flip);
        let outward = outward.as_dvec3().normalize();
        let center = to_world.transform_point3(center);
        let radius = radius * scale.abs();
        let surface = center + radius * outward;
        let hit = cast(&scene, surface + radius * outward, center);
        let hit = hit.ok_or_else(|| TestCaseError::fail("no hit"))?;
        let place = hit.position.as_dvec3() * scene.unit + scene.center;
        prop_assert!(place.distance(surface) < 1e-5 * radius, "{place} {surface}");
        let inside_out = (linear.determinant() < 0.0) != flip;
        let expected = if inside_out { -outward } else { outward };
        let normal = hit.geometric_normal.as_dvec3();
        prop_assert!(normal.distance(expected) < 1e-5, "{normal} {expected}");
        prop_assert!((hit.shading.n - hit.geometric_normal).length() < 1e-6);
    }
}
