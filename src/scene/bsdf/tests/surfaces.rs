//! Fresnel's equations, microfacet distributions, and tables of indices of refraction.

use glam::Vec3A;

use super::super::MicrofacetDistribution::{Beckmann, Ggx};
use super::super::fresnel::{self, internal_diffuse_reflectance};
use super::super::microfacet::{Microfacets, erf_inv};
use super::super::{ior, metals};
use super::{integrate_hemisphere, tilted};
use crate::math::Rgb;

fn close(a: f32, b: f32) -> bool {
    (a - b).abs() < 2e-6
}

#[test]
fn fresnel_matches_closed_forms() {
    for eta in [1.1, 1.5, 2.4, 1.0 / 1.5_f32] {
        let at = |cos: f32| fresnel::dielectric(cos, eta);
        let normal = ((eta - 1.0) / (eta + 1.0)).powi(2);
        assert!(close(at(1.0).reflectance, normal), "{eta}");
        // At Brewster's angle, tan = eta, p-polarised light is not reflected: the mean reflectance is
        // half of that of s-polarised light.
        let brewster = 0.5 * ((eta * eta - 1.0) / (eta * eta + 1.0)).powi(2);
        let cos = (1.0 + eta * eta).sqrt().recip();
        assert!(close(at(cos).reflectance, brewster), "{eta}");
        assert!(close(at(0.0).reflectance, 1.0), "{eta}");
    }
    assert_eq!(fresnel::dielectric(0.0, 1.0).reflectance, 0.0);
    assert_eq!(fresnel::dielectric(0.3, 1.0).cos_t, 0.3);
}

#[test]
fn total_internal_reflection_begins_at_the_critical_angle() {
    let critical = (1.0 - 1.5_f32.powi(-2)).sqrt();
    let below = fresnel::dielectric(critical - 1e-4, 1.5_f32.recip());
    assert_eq!((below.reflectance, below.cos_t), (1.0, 0.0));
    let above = fresnel::dielectric(critical + 1e-4, 1.5_f32.recip());
    assert!(above.reflectance < 0.95 && above.cos_t > 0.0, "{above:?}");
}

#[test]
fn transmittance_is_the_same_from_both_sides() {
    for i in 1..=20 {
        let cos = i as f32 / 20.0;
        for eta in [1.2, 1.5, 2.4] {
            let there = fresnel::dielectric(cos, eta);
            let back = fresnel::dielectric(there.cos_t, eta.recip());
            assert!(
                (there.reflectance - back.reflectance).abs() < 1e-5,
                "{cos} {eta}"
            );
            assert!((back.cos_t - cos).abs() < 1e-5, "{cos} {eta}");
        }
    }
}

#[test]
fn conductors_match_closed_forms() {
    let (eta, k) = metals::metal("Au").expect("gold");
    // ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2) at normal incidence, and 1 at grazing incidence.
    let normal = ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k);
    assert!(
        (fresnel::conductor(1.0, eta, k) - normal)
            .abs()
            .max_element()
            < 1e-6
    );
    assert!(
        (fresnel::conductor(0.0, eta, k) - Rgb::ONE)
            .abs()
            .max_element()
            < 1e-6
    );
    let (mirror_eta, mirror_k) = metals::metal("none").expect("mirror");
    for i in 0..=20 {
        let cos = i as f32 / 20.0;
        assert_eq!(
            fresnel::conductor(cos, mirror_eta, mirror_k),
            Rgb::ONE,
            "{cos}"
        );
        // Without absorption a conductor is a dielectric.
        let glass = fresnel::conductor(cos, Rgb::splat(1.5), Rgb::ZERO).x;
        let expected = fresnel::dielectric(cos, 1.5).reflectance;
        assert!((glass - expected).abs() < 1e-5, "{cos}: {glass} {expected}");
    }
}

/// Compares the fit with the integral of 2 F(mu) mu dmu from 0 to 1 by the midpoint rule.
#[test]
fn internal_diffuse_reflectance_is_the_integral() {
    let n = 20_000;
    for (eta, tolerance) in [
        (1.3, 0.003),
        (1.5, 0.003),
        (1.9, 0.008),
        (3.0, 0.003),
        (8.0, 0.003),
    ] {
        let sum: f64 = (0..n)
            .map(|i| (f64::from(i) + 0.5) / f64::from(n))
            .map(|mu| mu * f64::from(fresnel::dielectric(mu as f32, 1.0 / eta).reflectance))
            .sum();
        let exact = 2.0 * sum / f64::from(n);
        let fit = f64::from(internal_diffuse_reflectance(eta));
        assert!(
            (fit / exact - 1.0).abs() < tolerance,
            "{eta}: {fit} {exact}"
        );
    }
}

/// D cos integrates to 1, since the projected area of the microfacets is that of the surface; and D_v
/// integrates to 1, since it is a density. With Walter's rational fit of Beckmann's masking the second
/// integral is off by 0.3%.
#[test]
fn microfacet_densities_are_normalised() {
    for distribution in [Beckmann, Ggx] {
        for alpha in [0.1, 0.5, 1.0] {
            let microfacets = Microfacets::isotropic(distribution, alpha);
            let d = |m: Vec3A| f64::from(microfacets.density(m));
            let all = integrate_hemisphere(&|m| d(m) * f64::from(m.z));
            assert!((all - 1.0).abs() < 1e-4, "{distribution:?} {alpha}: {all}");
            for degrees in [0.0, 30.0, 60.0, 70.0, 80.0, 88.0] {
                let v = tilted(degrees, 0.7);
                let gamma = f64::from(microfacets.masking_over_cosine(v));
                let visible =
                    integrate_hemisphere(&|m| d(m) * gamma * f64::from(v.dot(m).max(0.0)));
                let case = format!("{distribution:?} {alpha} {degrees}: {visible}");
                assert!((visible - 1.0).abs() < 3e-4, "{case}");
            }
        }
    }
}

#[test]
fn names_are_those_of_mitsuba_in_the_same_case() {
    assert_eq!(ior::ior("BK7"), Some(1.5046));
    assert_eq!(ior::ior("carbon dioxide"), Some(1.000_45));
    assert_eq!(ior::ior("bk8"), None);
    assert_eq!(ior::ior_names().count(), 23);
    assert!(metals::metal("au").is_none());
    assert_eq!(metals::metal_names().count(), 72);
    let (eta, k) = metals::metal("Cu").expect("copper");
    assert_eq!((eta.x, k.z), (0.201_005_47, 2.142_089_8));
}

#[test]
fn erf_inv_inverts() {
    // erf(4.05) = 1 - 1e-8.
    for i in -405..=405 {
        let s = f64::from(i) * 0.01;
        let error = erf_inv(statrs::function::erf::erf(s)) - s;
        assert!(error.abs() <= 1e-5 * s.abs(), "{s}: {error:e}");
    }
}
