use glam::{DMat3, DMat4, DVec3, Vec3A};

use crate::math::Rgb;
use crate::scene::test_scenes::{Numbers, blob, description, emitting, mesh, scene, shape, sphere};
use crate::scene::{
    EmitterDescription, EmitterKind, SCENE_RADIUS, SceneError, ShapeDescription, ShapeGeometry,
    TriangleMesh,
};

fn lamp() -> EmitterDescription {
    EmitterDescription::Constant { radiance: Rgb::ONE }
}

#[test]
fn shapes_fill_the_bounding_sphere() {
    let mut stray = TriangleMesh::rectangle();
    stray.positions.push([1e6, 0.0, 0.0]);
    stray.normals.push([0.0, 0.0, 1.0]);
    stray.uvs.push([0.0, 0.0]);
    for shapes in [
        vec![mesh(TriangleMesh::cube(), DMat4::IDENTITY)],
        vec![mesh(stray, DMat4::from_rotation_x(1.0))],
        vec![
            sphere(DVec3::new(5.0, 1.0, -7.0), 3.0),
            mesh(blob(9), DMat4::IDENTITY),
        ],
        vec![sphere(DVec3::splat(1e5), 1e-2)],
    ] {
        let extent = |shape: &ShapeDescription| match &shape.geometry {
            ShapeGeometry::Sphere { radius, .. } => *radius,
            ShapeGeometry::Mesh(_) => 0.0,
        };
        let radius = shapes.iter().map(extent).fold(0.0, f64::max);
        let scene = scene(shapes, vec![]);
        let (min, max) = scene.geometry.bounds().expect("bounds");
        assert!(min.max_element() < 0.0 && max.min_element() > -0.1);
        assert!(((min + max) * 0.5).length() < 0.01, "{min} {max}");
        let corner = max.length();
        assert!(
            corner > SCENE_RADIUS * 0.99 && max.max_element() < SCENE_RADIUS * 1.001,
            "{max}"
        );
        assert!(radius / scene.unit < f64::from(SCENE_RADIUS) * 1.001);
    }
}

#[test]
fn scenes_without_shapes_keep_their_units() {
    let scene = scene(vec![], vec![]);
    assert_eq!((scene.unit, scene.center), (1.0, DVec3::ZERO));
    assert!(scene.geometry.bounds().is_none());
    let mut counts = crate::scene::RayCounts::default();
    assert!(scene.geometry.visible(Vec3A::ZERO, Vec3A::X, &mut counts));
    let ray = crate::scene::Ray {
        origin: Vec3A::ZERO,
        direction: Vec3A::X,
        t_max: f32::INFINITY,
    };
    assert!(scene.geometry.intersect(&ray, &mut counts).is_none());
}

#[test]
fn invalid_transforms_are_rejected() {
    let ball = |to_world| {
        let geometry = ShapeGeometry::Sphere {
            center: DVec3::X,
            radius: 2.0,
        };
        description(vec![shape(geometry, to_world)], vec![lamp()])
            .build()
            .err()
    };
    let plate = |to_world| {
        let plate = mesh(TriangleMesh::rectangle(), to_world);
        description(vec![plate], vec![lamp()]).build().err()
    };
    let stretch = DMat4::from_scale(DVec3::new(1.0, 1.0, 1.01));
    let mut shear = DMat4::IDENTITY;
    shear.x_axis.y = 0.01;
    for bad in [stretch, shear] {
        assert!(matches!(
            ball(bad),
            Some(SceneError::StretchedSphere { .. })
        ));
        assert!(plate(bad).is_none());
    }
    let flat = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0));
    for bad in [flat, DMat4::ZERO, DMat4::IDENTITY * f64::INFINITY] {
        assert!(matches!(
            ball(bad),
            Some(SceneError::SingularTransform { .. })
        ));
        assert!(matches!(
            plate(bad),
            Some(SceneError::SingularTransform { .. })
        ));
    }
    // Valid ones: rounded in a file, tiny, huge, mirrored.
    let rounded = DMat4::from_mat3(DMat3::from_rotation_y(0.3) * 1.000_01);
    for good in [
        rounded,
        DMat4::from_scale(DVec3::splat(-1e-9)),
        DMat4::from_scale(DVec3::splat(1e9)),
    ] {
        assert!(ball(good).is_none());
        assert!(plate(good).is_none());
    }
    let sky = |to_world| {
        let sky = EmitterDescription::Environment {
            width: 2,
            pixels: vec![[1.0; 3]; 4],
            scale: 1.0,
            to_world,
        };
        description(vec![], vec![sky]).build().err()
    };
    assert!(matches!(
        sky(stretch),
        Some(SceneError::StretchedEnvironment)
    ));
    assert!(matches!(
        sky(DMat4::ZERO),
        Some(SceneError::StretchedEnvironment)
    ));
    assert!(sky(DMat4::from_scale(DVec3::new(-2.0, 2.0, 2.0))).is_none());
    let nowhere = EmitterDescription::Directional {
        direction: DVec3::ZERO,
        irradiance: Rgb::ONE,
    };
    let error = description(vec![], vec![nowhere]).build().err();
    assert!(matches!(error, Some(SceneError::SingularTransform { .. })));
}

/// As in Mitsuba.
#[test]
fn negative_radii_turn_spheres_inside_out() {
    let ball = emitting(sphere(DVec3::ZERO, -1.0), Rgb::ONE);
    let scene = scene(vec![ball], vec![]);
    let mut numbers = Numbers::new(8);
    let start = scene
        .emitters
        .sample_emission(numbers.unit(), 0.0, numbers.pair(), numbers.pair())
        .expect("a start");
    assert!(start.position.dot(start.normal) < 0.0);
    assert!((start.position.length() / SCENE_RADIUS - 1.0).abs() < 1e-5);
}

#[test]
fn emitters_have_shapes_and_kinds() {
    let shapes = vec![
        sphere(DVec3::ZERO, 1.0),
        emitting(sphere(DVec3::X, 1.0), Rgb::ONE),
        mesh(TriangleMesh::cube(), DMat4::IDENTITY),
        emitting(mesh(TriangleMesh::rectangle(), DMat4::IDENTITY), Rgb::ONE),
    ];
    let scene = scene(shapes, vec![lamp()]);
    let of_shapes: Vec<_> = (0..4).map(|i| scene.emitters.of_shape(i)).collect();
    assert_eq!(of_shapes, [None, Some(0), None, Some(1)]);
    assert_eq!(scene.emitters.shape(1), Some(3));
    assert_eq!(scene.emitters.shape(2), None);
    assert_eq!(scene.emitters.kind(1), EmitterKind::Area);
    assert_eq!(scene.emitters.kind(2), EmitterKind::Constant);
    let (min, max) = scene.world_bounds().expect("bounds");
    assert!(
        (min - DVec3::NEG_ONE).length() < 1e-5 && (max - DVec3::new(2.0, 1.0, 1.0)).length() < 1e-5
    );
    assert_eq!(scene.geometry.shape_name(0), "shape");
    assert_eq!(scene.geometry.material(3), 0);
}

/// The message names the object at fault and the bound.
#[test]
fn excessive_coordinates_are_rejected() {
    let far = |distance: f64| DMat4::from_translation(DVec3::Y * distance);
    let error = |to_world, center, radius, camera| {
        let mut ball = sphere(center, radius);
        ball.name = "ball".into();
        let plate = mesh(TriangleMesh::rectangle(), to_world);
        let mut description = description(vec![plate, ball], vec![lamp()]);
        description.camera.to_world = camera;
        description.build().err().map(|error| error.to_string())
    };
    let here = DMat4::IDENTITY;
    let at = |name, coordinate| {
        Some(format!(
            "{name}: coordinates reach {coordinate}; they must be below 1e15 in absolute value. \
             Use a larger unit of length, or remove distant objects"
        ))
    };
    assert_eq!(
        error(far(1e30), DVec3::ZERO, 1.0, here),
        at("shape", "1e30")
    );
    assert_eq!(error(here, DVec3::X * 1e30, 1.0, here), at("ball", "1e30"));
    assert_eq!(error(here, DVec3::ZERO, 1e308, here), at("ball", "1e308"));
    assert_eq!(
        error(here, DVec3::ZERO, 1.0, far(1e30)),
        at("sensor", "1e30")
    );
    assert_eq!(error(far(9e14), DVec3::X * -9e14, 1.0, far(9e14)), None);
    let mut huge = TriangleMesh::rectangle();
    huge.positions[1] = [3e38; 3];
    let huge = description(vec![mesh(huge, here)], vec![lamp()]).build();
    assert!(matches!(huge, Err(SceneError::TooLarge { .. })));
    let point = EmitterDescription::Point {
        position: DVec3::Z * -1e16,
        intensity: Rgb::ONE,
    };
    let point = description(vec![], vec![point]).build().err();
    assert!(matches!(point, Some(SceneError::TooLarge { name, .. }) if name == "point emitter"));
}

/// Distances are relative to the size of the shapes: their squares must not overflow f32.
#[test]
fn objects_too_far_from_tiny_shapes_are_rejected() {
    let speck = || vec![sphere(DVec3::ZERO, 1e-9)];
    let far = DVec3::X * 1e14;
    let mut unseen = description(speck(), vec![lamp()]);
    unseen.camera.to_world = DMat4::from_translation(far);
    let refused = |error: Option<SceneError>, what: &str| matches!(error, Some(SceneError::OutOfRange { name }) if name == what);
    assert!(refused(unseen.build().err(), "sensor"));
    let light = EmitterDescription::Point {
        position: far,
        intensity: Rgb::ONE,
    };
    let unlit = description(speck(), vec![light]);
    assert!(refused(unlit.build().err(), "point emitter"));
}

#[test]
fn scenes_that_are_too_small_are_rejected() {
    let speck = |radius| {
        let speck = description(vec![sphere(DVec3::ZERO, radius)], vec![lamp()]);
        speck.build().err().map(|error| error.to_string())
    };
    let message = "the scene is too small: the bounding sphere of all shapes has radius 1e-13, which \
                   must be at least 1e-12. Use a smaller unit of length";
    assert_eq!(speck(1e-13).as_deref(), Some(message));
    assert_eq!(speck(2e-12), None);
}
