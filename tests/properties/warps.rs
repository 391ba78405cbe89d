//! Frames, and maps from the unit square.

use std::f32::consts::PI;

use glam::{Vec2, Vec3A};
use metrolight::math::Frame;
use metrolight::sampling::warp::{
    cosine_hemisphere_pdf, square_to_cosine_hemisphere, square_to_disk, square_to_sphere,
    square_to_triangle,
};
use proptest::prelude::*;

use super::{direction, unit};

proptest! {
    #[test]
    fn frames_are_right_handed_bases(n in direction(), v in direction()) {
        let frame = Frame::from_normal(n);
        for (u, v, expected) in [
            (frame.s, frame.s, 1.0), (frame.t, frame.t, 1.0), (frame.n, n, 1.0),
            (frame.s, frame.t, 0.0), (frame.t, frame.n, 0.0), (frame.n, frame.s, 0.0),
        ] {
            prop_assert!((u.dot(v) - expected).abs() < 2e-6, "{u} {v}");
        }
        prop_assert!((frame.s.cross(frame.t) - n).length() < 2e-6);
        prop_assert!((frame.to_world(frame.to_local(v)) - v).length() < 2e-6);
        prop_assert!((frame.to_local(frame.to_world(v)) - v).length() < 2e-6);
        prop_assert!((frame.to_local(n) - Vec3A::Z).length() < 2e-6);
    }

    #[test]
    fn warps_stay_in_their_domains(x in unit(), y in unit()) {
        let u = Vec2::new(x, y);
        prop_assert!(square_to_disk(u).length() <= 1.0 + 1e-6);
        prop_assert!((square_to_sphere(u).length() - 1.0).abs() < 1e-5);
        let d = square_to_cosine_hemisphere(u);
        prop_assert!((d.length() - 1.0).abs() < 1e-5 && d.z > 0.0);
        prop_assert!(cosine_hemisphere_pdf(d.z) > 0.0);
        prop_assert_eq!(cosine_hemisphere_pdf(-d.z), 0.0);
        let b = square_to_triangle(u);
        prop_assert!(b.min_element() >= 0.0 && b.x + b.y <= 1.0 + 1e-6);
    }

    /// The area of the image of a small square is the area of the square over the density. Central
    /// differences of width 2^-8 have errors of about their square times the third derivative: an error
    /// of 2% in a density is detected. The edges are excluded, where derivatives are unbounded, and the
    /// diagonals, where the derivative of the map to the disk is discontinuous.
    #[test]
    fn densities_are_those_of_the_maps(x in 0.1f32..0.9, y in 0.1f32..0.9) {
        const H: f32 = 1.0 / 256.0;
        prop_assume!((x - y).abs() > 2.0 * H && (x + y - 1.0).abs() > 2.0 * H);
        let u = Vec2::new(x, y);
        let area = |warp: &dyn Fn(Vec2) -> Vec3A| {
            let dx = (warp(u + H * Vec2::X) - warp(u - H * Vec2::X)) / (2.0 * H);
            let dy = (warp(u + H * Vec2::Y) - warp(u - H * Vec2::Y)) / (2.0 * H);
            dx.cross(dy).length()
        };
        let flat = |p: Vec2| Vec3A::new(p.x, p.y, 0.0);
        let cosine = square_to_cosine_hemisphere(u);
        for (name, area, density) in [
            ("disk", area(&|u| flat(square_to_disk(u))), 1.0 / PI),
            ("sphere", area(&square_to_sphere), 0.25 / PI),
            ("triangle", area(&|u| flat(square_to_triangle(u))), 2.0),
            ("hemisphere", area(&square_to_cosine_hemisphere), cosine_hemisphere_pdf(cosine.z)),
        ] {
            prop_assert!((area * density - 1.0).abs() < 0.02, "{name}: {}", area * density);
        }
    }

    /// Each map has an inverse.
    #[test]
    fn warps_are_invertible(x in unit(), y in unit()) {
        let u = Vec2::new(x, y);
        // Shirley and Chiu's map takes concentric squares to circles: the half side becomes the radius.
        let (square, disk) = (2.0 * u - Vec2::ONE, square_to_disk(u));
        prop_assert!((square.abs().max_element() - disk.length()).abs() < 1e-6);
        // It maps octants linearly: the angle is 45 degrees times the fraction of the half side.
        let (major, minor) = (square.abs().max_element(), square.abs().min_element());
        if major > 1e-3 {
            let angle = disk.abs().min_element().atan2(disk.abs().max_element());
            prop_assert!((angle - PI / 4.0 * minor / major).abs() < 1e-5);
            let sign = |a: f32, b: f32| a * b >= -1e-6;
            prop_assert!(sign(disk.x, square.x) && sign(disk.y, square.y));
            let steep = |v: Vec2| v.y.abs() - v.x.abs();
            prop_assert!(steep(square) * steep(disk) >= -1e-6);
        }
        let sphere = square_to_sphere(u);
        prop_assert!((0.5 * (1.0 - sphere.z) - x).abs() < 1e-6);
        let turn = sphere.y.atan2(sphere.x) / (2.0 * PI) - y;
        let radius = sphere.x.hypot(sphere.y);
        prop_assert!((turn - turn.round()).abs() * radius < 1e-6);
        let b = square_to_triangle(u);
        prop_assert!(((1.0 - b.x) * (1.0 - b.x) - x).abs() < 1e-6);
        prop_assert!((b.y - y * (1.0 - b.x)).abs() < 1e-6);
    }
}
