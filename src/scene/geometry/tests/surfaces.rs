use glam::{DMat4, DVec3, Vec2, Vec3A};

use crate::scene::test_scenes::{Numbers, blob, mesh, scene, shape};
use crate::scene::{
    Ray, RayCounts, Scene, ShapeDescription, ShapeGeometry, SurfacePoint, TriangleMesh,
};

/// The first hit of a ray given in world coordinates.
fn cast(scene: &Scene, origin: DVec3, direction: DVec3) -> Option<SurfacePoint> {
    let ray = Ray {
        origin: ((origin - scene.center) / scene.unit).as_vec3a(),
        direction: direction.normalize().as_vec3a(),
        t_max: f32::INFINITY,
    };
    scene.geometry.intersect(&ray, &mut RayCounts::default())
}

/// Two triangles in z = 0, counter-clockwise from +z, without texture coordinates.
fn plate(normals: Vec<[f32; 3]>) -> TriangleMesh {
    TriangleMesh {
        uvs: Vec::new(),
        normals,
        ..TriangleMesh::rectangle()
    }
}

/// Shading normal and texture coordinates where a ray from (0.3, 0.2, 5) along -z hits a shape under the
/// identity, mirroring in x, in z, and in all axes; then the same with `flip_normals`. From Mitsuba:
///
///     s = mi.load_dict({'type': 'scene', 'a': {'type': ..., 'flip_normals': ..., 'to_world': ...}})
///     si = s.ray_intersect(mi.Ray3f([0.3, 0.2, 5], [0, 0, -1])); print(si.sh_frame.n, si.uv)
///
/// OBJ meshes hold the two triangles of `plate`; with `face_normals` or without normals, and with the
/// normal (0, 0.6, -0.8) at all vertices.
#[test]
fn sides_and_texture_coordinates_agree_with_mitsuba() {
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    const S: [f64; 3] = [0.3, 0.2, 0.932_738];
    const N: [f64; 3] = [0.0, 0.6, -0.8];
    const M: [f64; 3] = [0.0, 0.6, 0.8];
    let smooth = |to_world: &DMat4| {
        let mut mesh = plate(Vec::new());
        mesh.compute_vertex_normals(to_world);
        mesh
    };
    type Make<'a> = &'a dyn Fn(&DMat4) -> ShapeGeometry;
    // Normal, its sign, and texture coordinates.
    type Seen = ([f64; 3], f64, [f32; 2]);
    let cases: [(&str, Make, [Seen; 4]); 6] = [
        (
            "cube",
            &|_| ShapeGeometry::Mesh(TriangleMesh::cube()),
            [
                (Z, 1.0, [0.6, 0.65]),
                (Z, 1.0, [0.6, 0.35]),
                (Z, 1.0, [0.4, 0.65]),
                (Z, 1.0, [0.6, 0.35]),
            ],
        ),
        (
            "rectangle",
            &|_| ShapeGeometry::Mesh(TriangleMesh::rectangle()),
            [
                (Z, 1.0, [0.65, 0.6]),
                (Z, 1.0, [0.35, 0.6]),
                (Z, -1.0, [0.65, 0.6]),
                (Z, -1.0, [0.35, 0.4]),
            ],
        ),
        (
            "sphere",
            &|_| ShapeGeometry::Sphere {
                center: DVec3::ZERO,
                radius: 1.0,
            },
            [
                (S, 1.0, [0.093_583_5, 0.117_413]),
                (S, -1.0, [0.406_416, 0.117_413]),
                (S, -1.0, [0.093_583_5, 0.882_587]),
                (S, -1.0, [0.593_584, 0.882_587]),
            ],
        ),
        (
            "flat obj",
            &|_| ShapeGeometry::Mesh(plate(Vec::new())),
            [
                (Z, 1.0, [0.05, 0.6]),
                (Z, -1.0, [0.35, 0.25]),
                (Z, 1.0, [0.05, 0.6]),
                (Z, 1.0, [0.35, 0.05]),
            ],
        ),
        (
            "obj with computed normals",
            &|to_world| ShapeGeometry::Mesh(smooth(to_world)),
            [
                (Z, 1.0, [0.05, 0.6]),
                (Z, -1.0, [0.35, 0.25]),
                (Z, 1.0, [0.05, 0.6]),
                (Z, 1.0, [0.35, 0.05]),
            ],
        ),
        (
            "obj with normals",
            &|_| ShapeGeometry::Mesh(plate(vec![[0.0, 0.6, -0.8]; 4])),
            [
                (N, 1.0, [0.05, 0.6]),
                (N, 1.0, [0.35, 0.25]),
                (M, 1.0, [0.05, 0.6]),
                ([0.0, -0.6, 0.8], 1.0, [0.35, 0.05]),
            ],
        ),
    ];
    let mirrors = [
        DVec3::ONE,
        DVec3::new(-1.0, 1.0, 1.0),
        DVec3::new(1.0, 1.0, -1.0),
        DVec3::NEG_ONE,
    ];
    for (name, geometry, expected) in cases {
        for (mirror, (normal, sign, uv)) in mirrors.into_iter().zip(expected) {
            for flip_normals in [false, true] {
                let to_world = DMat4::from_scale(mirror);
                let transformed = ShapeDescription {
                    flip_normals,
                    ..shape(geometry(&to_world), to_world)
                };
                let scene = scene(vec![transformed], vec![]);
                let hit = cast(&scene, DVec3::new(0.3, 0.2, 5.0), DVec3::NEG_Z).expect("a hit");
                let sign = if flip_normals { -sign } else { sign };
                let normal = (DVec3::from_array(normal) * sign).as_vec3a();
                let case = format!("{name}, scaled by {mirror}, flipped: {flip_normals}");
                assert!(
                    (hit.shading.n - normal).length() < 1e-5,
                    "{case}: {:?}",
                    hit.shading.n
                );
                assert!(hit.geometric_normal.dot(hit.shading.n) > 0.0, "{case}");
                assert!(
                    (hit.uv - Vec2::from_array(uv)).length() < 1e-5,
                    "{case}: {:?}",
                    hit.uv
                );
            }
        }
    }
}

#[test]
fn normals_of_a_smooth_mesh_are_interpolated_and_perpendicular_to_the_surface() {
    let mut smooth = blob(60);
    smooth.compute_vertex_normals(&DMat4::IDENTITY);
    let scene = scene(vec![mesh(smooth, DMat4::IDENTITY)], vec![]);
    let mut numbers = Numbers::new(5);
    let mut largest: f32 = 0.0;
    for _ in 0..2_000 {
        let hit = cast(&scene, DVec3::ZERO, numbers.direction().as_dvec3()).expect("a hit");
        assert!(hit.shading.n.is_normalized());
        let bend = hit.shading.n.dot(hit.geometric_normal);
        assert!(bend > 0.95, "{bend}");
        largest = largest.max(1.0 - bend);
        let outward = hit.position - (-scene.center / scene.unit).as_vec3a();
        assert!(hit.geometric_normal.dot(outward) > 0.0);
    }
    assert!(largest > 1e-4, "flat: {largest}");
}

/// A scene that is translated or scaled has the same hits, up to the precision of f32 relative to the size
/// of the scene.
#[test]
fn geometry_does_not_depend_on_scale_or_position() {
    let build = |change: DMat4| {
        let mut shapes = vec![
            mesh(TriangleMesh::cube(), DMat4::from_rotation_x(0.5)),
            mesh(blob(12), DMat4::from_translation(DVec3::new(2.0, 0.0, 1.0))),
        ];
        let geometry = ShapeGeometry::Sphere {
            center: DVec3::new(0.0, 2.5, 0.0),
            radius: 0.8,
        };
        shapes.push(shape(geometry, DMat4::IDENTITY));
        for shape in &mut shapes {
            shape.to_world = change * shape.to_world;
        }
        scene(shapes, vec![])
    };
    let reference = build(DMat4::IDENTITY);
    for (name, scale, offset) in [
        ("small", 1e-3, 0.0),
        ("large", 1e3, 0.0),
        ("far", 1.0, 1e4),
        ("small and far", 1e-3, 10.0),
    ] {
        let change =
            DMat4::from_translation(DVec3::splat(offset)) * DMat4::from_scale(DVec3::splat(scale));
        let changed = build(change);
        assert!(
            (changed.unit / reference.unit / scale - 1.0).abs() < 1e-9,
            "{name}"
        );
        let mut numbers = Numbers::new(6);
        let mut hits = 0;
        for _ in 0..5_000 {
            let ray = Ray {
                origin: numbers.direction() * 900.0,
                direction: numbers.direction(),
                t_max: f32::INFINITY,
            };
            let [a, b] = [&reference, &changed]
                .map(|scene| scene.geometry.intersect(&ray, &mut RayCounts::default()));
            assert_eq!(a.map(|hit| hit.shape), b.map(|hit| hit.shape), "{name}");
            if let (Some(a), Some(b)) = (a, b) {
                hits += 1;
                let grazing = a.geometric_normal.dot(ray.direction).abs();
                let error = (a.position - b.position).length() * grazing;
                assert!(error < 1e-3, "{name}: {error}");
                assert!((a.geometric_normal - b.geometric_normal).length() < 1e-5);
                assert!(
                    (a.uv - b.uv).length() * grazing < 1e-4,
                    "{name}: {} {}",
                    a.uv,
                    b.uv
                );
            }
        }
        assert!(hits > 500, "{hits}");
    }
}

#[test]
fn needles_have_a_normal() {
    let needle = TriangleMesh {
        positions: vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1e-4, 1e-4]],
        triangles: vec![[0, 1, 2]],
        ..TriangleMesh::default()
    };
    let scene = scene(vec![mesh(needle, DMat4::IDENTITY)], vec![]);
    let hit = cast(&scene, DVec3::new(0.0, 5e-5, 1.0), DVec3::NEG_Z).expect("a hit");
    let expected = Vec3A::new(0.0, -1.0, 1.0).normalize();
    assert!((hit.geometric_normal - expected).length() < 1e-4, "{hit:?}");
}

/// The inverse transpose of a transform maps normals: (0, 0.6, -0.8) under a scale of (1, 2, 4) becomes
/// (0, 0.3, -0.2), normalised.
#[test]
fn stretched_normals_stay_perpendicular() {
    let plate = plate(vec![[0.0, 0.6, -0.8]; 4]);
    let stretch = DMat4::from_scale(DVec3::new(1.0, 2.0, 4.0));
    let scene = scene(vec![mesh(plate, stretch)], vec![]);
    let hit = cast(&scene, DVec3::new(0.3, 0.2, 5.0), DVec3::NEG_Z).expect("a hit");
    let expected = Vec3A::new(0.0, 0.3, -0.2).normalize();
    assert!((hit.shading.n - expected).length() < 1e-6, "{hit:?}");
}

/// dp/du and dp/dv where a ray along -z hits a sphere, a stretched rectangle, a cube, and a triangle without texture
/// coordinates, with them, and with the same ones at all corners. From Mitsuba 3.9.1:
///
///     s = mi.load_dict({'type': 'scene', 'a': {'type': ..., 'bsdf': {'type': 'roughconductor'}}})
///     si = s.ray_intersect(mi.Ray3f([x, y, 5], [0, 0, -1])); print(si.dp_du, si.dp_dv)
///
/// The triangles are OBJ files, whose v is flipped.
#[test]
fn partial_derivatives_agree_with_mitsuba() {
    let triangle = |uvs: &[[f32; 2]]| {
        ShapeGeometry::Mesh(TriangleMesh {
            positions: vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.3], [0.5, 1.5, -0.2]],
            normals: vec![[0.0, 0.1, 1.0], [0.3, 0.0, 1.0], [-0.2, 0.1, 1.0]],
            uvs: uvs.to_vec(),
            triangles: vec![[0, 1, 2]],
        })
    };
    let sphere = ShapeGeometry::Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
    };
    let stretched = DMat4::from_scale(DVec3::new(2.0, 3.0, 1.0));
    let (identity, ball, corner) = (DMat4::IDENTITY, [0.3, 0.2], [0.6, 0.4]);
    let cases = [
        (
            sphere,
            identity,
            ball,
            [[-1.25664, 1.88496, 0.0], [2.43814, 1.62543, -1.13272]],
        ),
        (
            ShapeGeometry::Mesh(TriangleMesh::rectangle()),
            stretched,
            ball,
            [[4.0, 0.0, 0.0], [0.0, 6.0, 0.0]],
        ),
        (
            ShapeGeometry::Mesh(TriangleMesh::cube()),
            identity,
            ball,
            [[0.0, 2.0, 0.0], [2.0, 0.0, 0.0]],
        ),
        (
            triangle(&[]),
            identity,
            corner,
            [[2.0, 0.0, 0.3], [0.5, 1.5, -0.2]],
        ),
        (
            triangle(&[[0.1, 0.8], [0.9, 0.7], [0.4, 0.2]]),
            identity,
            corner,
            [
                [2.55556, -0.333333, 0.444445],
                [0.444445, -2.66667, 0.555556],
            ],
        ),
        (
            triangle(&[[0.1, 0.2]; 3]),
            identity,
            corner,
            [
                [0.989202, 0.0131971, 0.145961],
                [0.0131971, 0.98387, -0.178397],
            ],
        ),
    ];
    for (i, (geometry, to_world, [x, y], expected)) in cases.into_iter().enumerate() {
        let scene = scene(vec![shape(geometry, to_world)], Vec::new());
        let point = cast(&scene, DVec3::new(x, y, 5.0), DVec3::NEG_Z).expect("a hit");
        let found = scene.geometry.partial_derivatives(&point);
        // Tangents in place of degenerate derivatives have unit length in any units.
        let unit = if i == 5 { 1.0 } else { scene.unit };
        for (found, expected) in found.into_iter().zip(expected) {
            let error = found.as_dvec3() * unit - DVec3::from_array(expected);
            assert!(error.length() < 2e-5, "{i}: {found} {expected:?}");
        }
    }
}
