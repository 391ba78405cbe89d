//! Compares orientations and sides with Mitsuba 3.

use super::*;

/// Radiance (times 1) by direction, for an image of 4 x 3 pixels (1 + i, 10 (j + 1) + i, 0.5 + i j) in
/// column i and row j, scaled by 2; unrotated, rotated, and mirrored:
///
///     e = mi.load_dict({'type': 'scene', 'e': {'type': 'envmap', 'bitmap': mi.Bitmap(image),
///                       'scale': 2.0, 'to_world': to_world}})
///     si = e.ray_intersect(mi.Ray3f([0, 0, 0], d)); print(e.environment().eval(si))
///
/// with to_world T(), T().rotate(a, 40) with a = [1, 2, 3]/sqrt(14), and T().scale([-1, 1, 1]).
#[test]
fn environments_are_oriented_as_in_mitsuba() {
    let directions = [
        [1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.3, 0.8, 0.2],
        [0.3, -0.5, -0.9],
        [-0.7, 0.1, -0.05],
    ];
    let turn = DMat4::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 40.0_f64.to_radians());
    let mirror = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let cases = [
        (
            DMat4::IDENTITY,
            [
                [3.0, 41.0, 2.0],
                [5.0, 43.0, 4.0],
                [3.74867, 27.14, 1.47138],
                [3.771, 47.9468, 3.31788],
                [7.09079, 43.2886, 5.63207],
            ],
        ),
        (
            turn,
            [
                [3.59338, 47.9963, 3.10349],
                [5.39456, 39.8864, 3.79913],
                [3.48111, 32.3614, 1.80574],
                [3.76643, 52.593, 3.72265],
                [7.7663, 37.9784, 4.52093],
            ],
        ),
        (
            mirror,
            [
                [7.0, 45.0, 6.0],
                [5.0, 43.0, 4.0],
                [6.25133, 29.6426, 2.14601],
                [6.229, 50.4048, 6.53488],
                [2.90921, 39.1071, 1.82728],
            ],
        ),
    ];
    for (to_world, radiances) in cases {
        let pixels = (0..12)
            .map(|k| ((k % 4) as f32, (k / 4) as f32))
            .map(|(i, j)| [1.0 + i, 10.0 * (j + 1.0) + i, 0.5 + i * j])
            .collect();
        let map = EmitterDescription::Environment {
            width: 4,
            pixels,
            scale: 2.0,
            to_world,
        };
        let scene = scene(vec![floor()], vec![map]);
        for (direction, expected) in directions.into_iter().zip(radiances) {
            let direction = Vec3A::from_array(direction).normalize();
            let light = scene
                .emitters
                .evaluate_environment(direction)
                .expect("light");
            let error = (light.radiance - Rgb::from_array(expected)).length();
            assert!(error < 1e-3, "{direction}: {} {expected:?}", light.radiance);
        }
    }
}

/// Whether area emitters emit toward a point above them, (0.3, 0.2, 5), rather than into the box or sphere
/// or downward: under the identity and mirroring in x, in z and in all axes. `flip_normals` reverses all.
///
///     si = scene.ray_intersect(ray); print(si.emitter(scene).eval(si)[0] > 0)
///
/// OBJ meshes hold the rectangle without normals, with those computed from it, and with the normal
/// (0, 0.6, -0.8) everywhere.
#[test]
fn area_emitters_emit_to_the_same_side_as_in_mitsuba() {
    let smooth = |to_world: &DMat4| {
        let mut mesh = TriangleMesh::rectangle();
        mesh.compute_vertex_normals(to_world);
        mesh
    };
    let with_normals = |normals| TriangleMesh {
        normals,
        ..TriangleMesh::rectangle()
    };
    type Make<'a> = &'a dyn Fn(&DMat4) -> ShapeGeometry;
    let cases: [(&str, Make, [bool; 4]); 6] = [
        (
            "cube",
            &|_| ShapeGeometry::Mesh(TriangleMesh::cube()),
            [true; 4],
        ),
        (
            "rectangle",
            &|_| ShapeGeometry::Mesh(TriangleMesh::rectangle()),
            [true, true, false, false],
        ),
        (
            "sphere",
            &|_| ShapeGeometry::Sphere {
                center: DVec3::ZERO,
                radius: 1.0,
            },
            [true, false, false, false],
        ),
        (
            "flat obj",
            &|_| ShapeGeometry::Mesh(with_normals(Vec::new())),
            [true, false, true, true],
        ),
        (
            "obj with computed normals",
            &|to_world| ShapeGeometry::Mesh(smooth(to_world)),
            [true, false, true, true],
        ),
        (
            "obj with normals",
            &|_| ShapeGeometry::Mesh(with_normals(vec![[0.0, 0.6, -0.8]; 4])),
            [false, false, true, true],
        ),
    ];
    let mirrors = [
        DVec3::ONE,
        DVec3::new(-1.0, 1.0, 1.0),
        DVec3::new(1.0, 1.0, -1.0),
        DVec3::NEG_ONE,
    ];
    for (name, geometry, expected) in cases {
        for (mirror, emits_up) in mirrors.into_iter().zip(expected) {
            for flip_normals in [false, true] {
                let to_world = DMat4::from_scale(mirror);
                let lamp = ShapeDescription {
                    flip_normals,
                    ..emitting(shape(geometry(&to_world), to_world), RADIANCE)
                };
                let scene = scene(vec![lamp], vec![]);
                let case = format!("{name} scaled by {mirror}, flipped: {flip_normals}");
                check_side(&scene, &case, emits_up != flip_normals);
            }
        }
    }
}

/// Checks that hits, direct samples and light subpaths agree on the side that emits.
fn check_side(scene: &Scene, case: &str, emits_up: bool) {
    let above = to_scene(scene, DVec3::new(0.3, 0.2, 5.0));
    let met = light_hit(scene, above, Vec3A::NEG_Z);
    assert_eq!(met.is_some(), emits_up, "{case}: hit");
    let mut numbers = Numbers::new(61);
    let mut arrives = false;
    let mut leaves_up = false;
    for _ in 0..200 {
        let u = (
            numbers.unit(),
            numbers.unit(),
            numbers.pair(),
            numbers.pair(),
        );
        if let Some(sample) = scene.emitters.sample_direct(above, u.0, u.1, u.2) {
            arrives |= scene
                .geometry
                .visible(above, sample.target, &mut RayCounts::default());
        }
        if let Some(start) = scene.emitters.sample_emission(u.0, u.1, u.2, u.3) {
            let ray = Ray {
                origin: start.origin,
                direction: start.direction,
                t_max: f32::INFINITY,
            };
            let blocked = scene.geometry.intersect(&ray, &mut RayCounts::default());
            leaves_up |= blocked.is_none() && start.direction.z > 0.0;
        }
    }
    assert_eq!(arrives, emits_up, "{case}: direct light");
    assert_eq!(leaves_up, emits_up, "{case}: emission");
}
