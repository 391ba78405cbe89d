use glam::{DMat4, DVec2, DVec3, Vec2, Vec3A};
use proptest::prelude::*;

use super::Camera;
use crate::scene::{CameraDescription, Projection, SceneError, ThinLens};

/// Mitsuba's `look_at`: the view is along +z, +x points left.
fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let forward = (target - origin).normalize();
    let left = up.cross(forward).normalize();
    let up = forward.cross(left);
    DMat4::from_cols(
        left.extend(0.0),
        up.extend(0.0),
        forward.extend(0.0),
        origin.extend(1.0),
    )
}

fn description(lens: Option<ThinLens>) -> CameraDescription {
    CameraDescription {
        to_world: look_at(
            DVec3::new(1.0, 2.0, 3.0),
            DVec3::new(4.0, 1.0, -2.0),
            DVec3::new(0.1, 1.0, 0.2),
        ),
        projection: Projection::Perspective { fov_x: 50.0, lens },
        principal_point_offset: DVec2::ZERO,
        near_clip: 0.5,
        far_clip: 100.0,
    }
}

const LENS: ThinLens = ThinLens {
    aperture_radius: 0.3,
    focus_distance: 4.0,
};

const CENTER: DVec3 = DVec3::new(0.5, -1.0, 2.0);
const UNIT: f64 = 0.01;

fn camera(lens: Option<ThinLens>) -> Camera {
    Camera::new(&description(lens), 1.6, CENTER, UNIT).expect("a camera")
}

/// Film position, lens number, origin (on the near plane), direction and extent of rays:
///
///     c = mi.load_dict({'type': 'perspective', 'fov': 50, 'fov_axis': 'x', 'near_clip': 0.5,
///         'far_clip': 100.0, 'to_world': T().look_at([1, 2, 3], [4, 1, -2], [0.1, 1, 0.2]),
///         'film': {'type': 'hdrfilm', 'width': 320, 'height': 200, 'rfilter': {'type': 'box'}}})
///     r, w = c.sample_ray(0, 0.5, film, lens); print(r.o, r.d, r.maxt)   # w is 1
///
/// and the same of type `thinlens` with aperture_radius 0.3 and focus_distance 4. The first lens number
/// increases to the left in Mitsuba, as the x axis of its camera does, and to the right here.
#[test]
fn rays_agree_with_mitsuba() {
    type Row = ([f32; 2], [f32; 2], [f64; 3], [f32; 3], f32);
    let pinhole: [Row; 4] = [
        (
            [0.5, 0.5],
            [0.5, 0.5],
            [1.253546, 1.915485, 2.577423],
            [0.507092, -0.169031, -0.845154],
            99.5,
        ),
        (
            [0.1, 0.2],
            [0.3, 0.8],
            [1.121527, 2.035319, 2.474244],
            [0.224728, 0.065313, -0.97223],
            107.61381,
        ),
        (
            [0.9, 0.3],
            [0.5, 0.5],
            [1.421969, 1.936608, 2.674252],
            [0.786036, -0.118086, -0.606797],
            106.82953,
        ),
        (
            [0.25, 0.95],
            [0.5, 0.5],
            [1.12462, 1.81066, 2.521032],
            [0.235177, -0.357315, -0.90389],
            105.44939,
        ),
    ];
    let thin: [Row; 4] = [
        (
            [0.5, 0.5],
            [0.3, 0.8],
            [1.352581, 2.032538, 2.613433],
            [0.478313, -0.20227, -0.854578],
            99.60069,
        ),
        (
            [0.1, 0.2],
            [0.3, 0.8],
            [1.220562, 2.152373, 2.510255],
            [0.198127, 0.034314, -0.979575],
            107.85194,
        ),
        (
            [0.9, 0.3],
            [0.3, 0.8],
            [1.521004, 2.053662, 2.710262],
            [0.767664, -0.150803, -0.622856],
            105.7187,
        ),
        (
            [0.25, 0.95],
            [0.3, 0.8],
            [1.223655, 1.927714, 2.557042],
            [0.205485, -0.383289, -0.900481],
            106.98549,
        ),
    ];
    for (lens, rows) in [(None, pinhole), (Some(LENS), thin)] {
        let camera = camera(lens);
        for (film, aperture, origin, direction, extent) in rows {
            let (ray, _) = camera.ray(
                Vec2::from_array(film),
                Vec2::new(1.0 - aperture[0], aperture[1]),
            );
            let world = ray.origin.as_dvec3() * UNIT + CENTER;
            assert!(
                (world - DVec3::from_array(origin)).length() < 1e-5,
                "{film:?}: {world}"
            );
            let error = (ray.direction - Vec3A::from_array(direction)).length();
            assert!(error < 3e-6, "{film:?}: {}", ray.direction);
            assert!(
                (ray.t_max * UNIT as f32 / extent - 1.0).abs() < 1e-4,
                "{film:?}"
            );
        }
    }
}

proptest! {
    /// `connect` from any point of a ray, through the lens point of the ray, returns the film position of
    /// the ray; its density is `direction_pdf` over the squared distance.
    #[test]
    fn connect_inverts_ray(
        x in 0.001f32..0.999, y in 0.001f32..0.999,
        a in 0.0f32..1.0, b in 0.0f32..1.0,
        t in 0.001f32..0.9, thin in any::<bool>(),
    ) {
        let camera = camera(thin.then_some(LENS));
        prop_assert_eq!(camera.has_lens(), thin);
        let (film, aperture) = (Vec2::new(x, y), Vec2::new(a, b));
        let (ray, lens_point) = camera.ray(film, aperture);
        let point = ray.origin + ray.direction * (t * ray.t_max);
        let sample = camera.connect(point, aperture);
        let Some(sample) = sample else {
            return Err(TestCaseError::fail(format!("{film} is not in view")));
        };
        prop_assert!((sample.film - film).length() < 2e-4, "{} {film}", sample.film);
        prop_assert!((sample.direction + ray.direction).length() < 1e-4);
        let distance = (point - lens_point).length();
        let expected = camera.direction_pdf(ray.direction) / (distance * distance);
        prop_assert!((sample.density / expected - 1.0).abs() < 1e-3);
        prop_assert!((sample.importance / expected - 1.0).abs() < 1e-3);
        // The shadow ray ends at the near plane.
        let near = point + sample.direction * sample.visible_distance;
        prop_assert!((near - ray.origin).length() < 1e-2, "{near} {}", ray.origin);
    }
}

/// The density integrates to 1 over all directions through the film: it is 1/(A cos^3) per steradian, and
/// the midpoint rule over the plane at distance 1 multiplies it by cos^3.
#[test]
fn direction_density_integrates_to_one() {
    let camera = camera(None);
    let mut sum = 0.0;
    let n = 400;
    let tan_x = 25.0_f64.to_radians().tan();
    let area = 4.0 * tan_x * tan_x / 1.6;
    for i in 0..n {
        for j in 0..n {
            let film = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / n as f32;
            let (ray, _) = camera.ray(film, Vec2::ZERO);
            let cos = f64::from(ray.direction.dot(camera.forward()));
            sum += f64::from(camera.direction_pdf(ray.direction)) * cos.powi(3) * area;
        }
    }
    assert!((sum / f64::from(n * n) - 1.0).abs() < 1e-4, "{sum}");
}

#[test]
fn points_out_of_view_are_not_connected() {
    let camera = camera(None);
    let at = |p: Vec3A| camera.connect(p, Vec2::splat(0.5));
    let (eye, forward) = (camera.position(), camera.forward());
    let unit = UNIT as f32;
    assert!(at(eye + forward * (1.0 / unit)).is_some());
    for outside in [
        eye,
        eye - forward * (1.0 / unit),
        eye + forward * (0.49 / unit),
        eye + forward * (101.0 / unit),
        eye + forward.any_orthonormal_vector() * 100.0,
    ] {
        assert!(at(outside).is_none(), "{outside}");
    }
    for (film, inside) in [
        (Vec2::new(-1e-3, 0.5), false),
        (Vec2::new(0.5, 1.001), false),
        (Vec2::new(0.999, 0.001), true),
    ] {
        let (ray, _) = camera.ray(film, Vec2::ZERO);
        assert_eq!(
            at(ray.origin + ray.direction * 100.0).is_some(),
            inside,
            "{film}"
        );
    }
}

/// Film position, origin, direction and extent of rays.
type Row = ([f32; 2], [f64; 3], [f32; 3], f64);

const SHIFTED: [Row; 3] = [
    (
        [0.5, 0.5],
        [1.329446, 1.972741, 2.611511],
        [0.645847, -0.053439, -0.761594],
        101.50972,
    ),
    (
        [0.1, 0.2],
        [1.197427, 2.092576, 2.508333],
        [0.367065, 0.172121, -0.914132],
        107.03242,
    ),
    (
        [0.9, 0.7],
        [1.468746, 1.881098, 2.713420],
        [0.833877, -0.211521, -0.509812],
        111.86362,
    ),
];

const PARALLEL: [Row; 3] = [
    (
        [0.5, 0.5],
        [1.253546, 1.915485, 2.577423],
        [0.507093, -0.169031, -0.845154],
        99.50000,
    ),
    (
        [0.1, 0.2],
        [-0.538835, 3.094660, 1.266159],
        [0.507093, -0.169031, -0.845154],
        99.50000,
    ),
    (
        [0.9, 0.7],
        [3.108381, 0.978137, 3.877793],
        [0.507093, -0.169031, -0.845154],
        99.50000,
    ),
];

/// Values of Mitsuba 3.9.1, as above, for `perspective` with principal_point_offset_x 0.15 and
/// principal_point_offset_y -0.25, and for `orthographic` with near_clip 0.5, far_clip 100 and
/// T().look_at(...) @ T().scale([3, 2, 1]).
#[test]
fn shifted_and_orthographic_cameras_agree_with_mitsuba() {
    let shifted = CameraDescription {
        principal_point_offset: DVec2::new(0.15, -0.25),
        ..description(None)
    };
    let orthographic = CameraDescription {
        projection: Projection::Orthographic {
            half_extent: DVec2::new(3.0, 2.0 / 1.6),
        },
        ..description(None)
    };
    for (description, rows) in [(shifted, SHIFTED), (orthographic, PARALLEL)] {
        let camera = Camera::new(&description, 1.6, CENTER, UNIT).expect("a camera");
        for (film, origin, direction, extent) in rows {
            let film = Vec2::from(film);
            let (ray, from) = camera.ray(film, Vec2::ZERO);
            let world = ray.origin.as_dvec3() * UNIT + CENTER;
            assert!(
                world.distance(DVec3::from(origin)) < 2e-5,
                "{film}: {world}"
            );
            let expected = Vec3A::from(direction);
            assert!(
                (ray.direction - expected).length() < 2e-6,
                "{film}: {}",
                ray.direction
            );
            let length = f64::from(ray.t_max) * UNIT;
            assert!((length / extent - 1.0).abs() < 1e-5, "{film}: {length}");
            // A point on the ray is seen where the ray came from, with its density.
            let point = ray.origin + ray.direction * 700.0;
            let seen = camera.connect(point, Vec2::ZERO).expect("a film position");
            assert!((seen.film - film).length() < 1e-5, "{film}: {}", seen.film);
            assert!((seen.direction + ray.direction).length() < 1e-5);
            let squared = camera.squared_distance(from, point);
            let density = camera.direction_pdf(ray.direction) / squared;
            assert!((seen.density / density - 1.0).abs() < 1e-4, "{film}");
        }
    }
}

#[test]
fn singular_cameras_are_rejected() {
    for to_world in [
        DMat4::ZERO,
        DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0)),
        DMat4::IDENTITY * f64::NAN,
    ] {
        let flat = CameraDescription {
            to_world,
            ..description(None)
        };
        let error = Camera::new(&flat, 1.0, DVec3::ZERO, 1.0).err();
        assert!(matches!(error, Some(SceneError::SingularTransform { .. })));
    }
    // The scale of the transform does not matter.
    for scale in [1e-12, 1e12] {
        let to_world = description(None).to_world * DMat4::from_scale(DVec3::splat(scale));
        let scaled = CameraDescription {
            to_world,
            ..description(None)
        };
        assert!(
            Camera::new(&scaled, 1.0, DVec3::ZERO, 1.0).is_ok(),
            "{scale}"
        );
    }
}
