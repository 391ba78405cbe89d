//! Faults planted in materials, and the tests that find them.

use std::f32::consts::FRAC_1_PI;

use super::super::Material;
use super::materials::{connectible, diffuse, normal_map, perturbation, textures};
use super::phong::{self, albedo};
use super::sampling::disagreement;
use super::{both_ends, context, tilted, unit};
use crate::fault::{self, Fault};
use crate::math::Rgb;

/// The material of this name.
fn named(name: &str) -> Material {
    let found = connectible().into_iter().find(|(known, _)| *known == name);
    found.expect("a material of the tests").1
}

fn samples_disagree(name: &'static str) -> bool {
    disagreement(name, &named(name)).is_some()
}

/// At a level of 1e-6.
fn ends_differ(name: &str) -> bool {
    both_ends::difference(&named(name), 1) < 1e-6
}

/// Whether light on a Lambertian surface with a perturbed normal n' is not scattered by its cosine with n'.
fn ignores_the_perturbed_normal() -> bool {
    let material = normal_map(perturbation(false, false), diffuse());
    // 2 color - 1 of the normal map
    let normal = unit(0.4, -0.2, 0.8);
    let (light, camera) = (tilted(40.0, 0.3), tilted(20.0, 2.0));
    let found = material.evaluate(&context(&textures()), light, camera).f * light.z;
    let expected = Rgb::new(0.2, 0.5, 0.8) * (FRAC_1_PI * light.dot(normal));
    (found - expected).abs().max_element() > 1e-5
}

fn phong_is_too_dark() -> bool {
    (albedo(3.0, 0.0) - (phong::DIFFUSE + phong::SPECULAR)).abs() > 1e-3
}

#[test]
fn planted_faults_are_found() {
    let cases: [(Fault, fn() -> bool); 6] = [
        (Fault::OpacityLeftOut, || samples_disagree("masked metal")),
        (Fault::BlendOfOneModel, || samples_disagree("blend")),
        (Fault::NormalProbabilityLeftOut, || {
            ends_differ("normal map on two sides")
        }),
        (Fault::PerturbedCosineLeftOut, ignores_the_perturbed_normal),
        (Fault::PhongNormalisedAsDensity, phong_is_too_dark),
        (Fault::FacetJacobianOff, || ends_differ("principled glass")),
    ];
    for (fault, found) in cases {
        assert!(!fault::with(None, found), "without {fault:?}");
        assert!(fault::with(Some(fault), found), "{fault:?}");
    }
}
