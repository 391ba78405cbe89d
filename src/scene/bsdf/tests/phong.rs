//! Phong reflection against closed forms (Lafortune and Willems 1994, "Using the modified Phong reflectance model for
//! physically based rendering").

use std::f64::consts::PI;

use glam::Vec3A;

use super::materials::{phong, textures};
use super::{context, integrate_hemisphere, tilted};

/// Diffuse and specular reflectance of [`phong`].
pub(super) const DIFFUSE: f64 = 0.3;
pub(super) const SPECULAR: f64 = 0.7;

/// Albedo under light at `degrees` from the normal, by quadrature of `evaluate`.
pub(super) fn albedo(exponent: f32, degrees: f32) -> f64 {
    let (material, textures) = (phong(exponent), textures());
    let from = tilted(degrees, 0.8);
    integrate_hemisphere(&|to: Vec3A| {
        let f = material.evaluate(&context(&textures), from, to).f;
        f64::from(f.x) * f64::from(to.z)
    })
}

/// At normal incidence the albedo is k_d + k_s whatever the exponent: (n + 2) / (2 pi) cos^n cos integrates to 1.
#[test]
fn at_normal_incidence_all_light_of_the_lobe_is_reflected() {
    for exponent in [0.0, 0.5, 3.0, 30.0, 300.0] {
        let found = albedo(exponent, 0.0);
        assert!(
            (found - (DIFFUSE + SPECULAR)).abs() < 1e-5,
            "{exponent}: {found}"
        );
    }
}

/// For n = 0 the lobe is k_s / pi in all directions. For n = 1 it is 3 k_s / (2 pi) max(0, r.w), where r is the
/// mirrored direction, at the angle a from the normal; the integral of max(0, r.w) max(0, n.w) over the sphere
/// is 2/3 (sin a + (pi - a) cos a).
#[test]
fn albedos_are_those_of_closed_forms() {
    for degrees in [0.0_f32, 20.0, 50.0, 75.0, 89.0] {
        let found = albedo(0.0, degrees);
        assert!((found - 1.0).abs() < 1e-5, "{degrees}: {found}");
        let a = f64::from(degrees).to_radians();
        let product = 2.0 / 3.0 * (a.sin() + (PI - a) * a.cos());
        let expected = DIFFUSE + SPECULAR * 3.0 / (2.0 * PI) * product;
        let found = albedo(1.0, degrees);
        assert!(
            (found - expected).abs() < 1e-5,
            "{degrees}: {found} {expected}"
        );
    }
}
