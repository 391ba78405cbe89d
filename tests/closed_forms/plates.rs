//! A plate of every material under constant environment light: its radiance is its directional albedo
//! times the radiance of the environment.

use glam::DVec3;
use metrolight::math::Rgb;
use metrolight::render::Method::{Bdpt, Path, Pssmlt};
use metrolight::scene::bsdf::metals;
use metrolight::scene::{
    EmitterDescription, Material, MicrofacetDistribution, Roughness, Scene, ShapeDescription,
    Texture,
};

use super::published::{
    Facets, albedo, conductor_fresnel, dielectric_fresnel, internal_diffuse_reflectance,
};
use crate::common::scenes::{SceneBuilder, floor, grey, look_at};
use crate::common::truths::Truths;

const SKY: f64 = 0.8;

/// Textures of [`plate`], and their values.
const GREY: u32 = 0;
const WHITE: u32 = 1;
const RHO: f64 = 0.6;

/// A plate of `material` seen at `degrees` from its normal, from below beyond 90.
fn plate(material: Material, degrees: f64) -> Scene {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let eye = DVec3::new(4.0 * sin, 4.0 * cos, 0.0);
    SceneBuilder {
        materials: vec![material],
        textures: vec![grey(RHO), grey(1.0)],
        shapes: vec![ShapeDescription {
            name: "plate".into(),
            ..floor(1.0)
        }],
        emitters: vec![EmitterDescription::Constant {
            radiance: Rgb::splat(SKY as f32),
        }],
        // So narrow that the angle is constant over the film.
        fov_x: 0.05,
        camera: look_at(eye, DVec3::ZERO, DVec3::Z),
        ..SceneBuilder::default()
    }
    .build()
}

fn textures() -> [Texture; 2] {
    [grey(RHO), grey(1.0)]
}

/// Direction of [`plate`]'s camera in the plate's frame.
fn tilted(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// Smooth glass: the reflected part, and transmitted radiance over the square of the relative index.
fn smooth_glass(eta: f64, from: DVec3) -> f64 {
    let across = if from.z > 0.0 { eta } else { 1.0 / eta };
    let reflected = dielectric_fresnel(from.z.abs(), across);
    reflected + (1.0 - reflected) / (across * across)
}

/// Mitsuba's plastic: F + (1 - F) int (1 - F_i) rho / (pi eta^2 (1 - again)) cos. In the nonlinear variant
/// light that the coat reflects back inside is multiplied by the substrate's albedo each time.
fn plastic(eta: f64, nonlinear: bool, from: DVec3) -> f64 {
    let fresnel = |cos: f64| dielectric_fresnel(cos, eta);
    let again = internal_diffuse_reflectance(eta) * if nonlinear { RHO } else { 1.0 };
    let body = RHO / (eta * eta * (1.0 - again));
    let entering = albedo(from, |to, _| {
        if to.z > 0.0 {
            (1.0 - fresnel(to.z)) / std::f64::consts::PI
        } else {
            0.0
        }
    });
    fresnel(from.z) + (1.0 - fresnel(from.z)) * body * entering
}

/// A material, its directional albedo, and the relative error allowed for the renderer's model where that
/// uses a fit or a table.
struct Case {
    name: &'static str,
    material: Material,
    albedo: Box<dyn Fn(DVec3) -> f64>,
    model_error: f64,
}

fn case(name: &'static str, material: Material, albedo: impl Fn(DVec3) -> f64 + 'static) -> Case {
    Case {
        name,
        material,
        albedo: Box::new(albedo),
        model_error: 0.0,
    }
}

/// Metals; `n` and `k` are those of the green channel.
fn metal(name: &str) -> (Rgb, Rgb, f64, f64) {
    let (eta, k) = metals::metal(name).expect("a known metal");
    (eta, k, f64::from(eta.y), f64::from(k.y))
}

fn rough_metal(distribution: MicrofacetDistribution, alpha: f64, name: &'static str) -> Case {
    let (eta, k, n, kappa) = metal(name);
    let facets = facets(distribution, alpha);
    let material = Material::RoughConductor {
        distribution,
        roughness: Roughness::Constant(alpha as f32),
        eta,
        k,
        specular_reflectance: WHITE,
    };
    case("rough metal", material, move |from| {
        albedo(from, |to, from| {
            facets.reflect(to, from, |cos| conductor_fresnel(cos, n, kappa))
        })
    })
}

fn rough_glass(distribution: MicrofacetDistribution, alpha: f64, eta: f64) -> Case {
    let facets = facets(distribution, alpha);
    let material = Material::RoughDielectric {
        distribution,
        roughness: Roughness::Constant(alpha as f32),
        eta: eta as f32,
        specular_reflectance: WHITE,
        specular_transmittance: WHITE,
    };
    case("rough glass", material, move |from| {
        albedo(from, |to, from| facets.interface(to, from, eta))
    })
}

fn facets(distribution: MicrofacetDistribution, alpha: f64) -> Facets {
    match distribution {
        MicrofacetDistribution::Beckmann => Facets::Beckmann(alpha),
        MicrofacetDistribution::Ggx => Facets::Ggx(alpha),
    }
}

fn smooth_cases() -> Vec<Case> {
    let (eta, k, n, kappa) = metal("Au");
    let gold = Material::Conductor {
        eta,
        k,
        specular_reflectance: WHITE,
    };
    let glass = |eta: f64| Material::Dielectric {
        eta: eta as f32,
        specular_reflectance: WHITE,
        specular_transmittance: WHITE,
    };
    let plastic_of = |nonlinear| Material::plastic(1.49, nonlinear, GREY, WHITE, &textures());
    // The renderer fits the internal reflectance of a smooth coat, with an error of 1e-3.
    vec![
        case("diffuse", Material::Diffuse { reflectance: GREY }, |_| RHO),
        case("gold", gold, move |from| {
            conductor_fresnel(from.z, n, kappa)
        }),
        case("glass", glass(1.5), |from| smooth_glass(1.5, from)),
        case("bubble", glass(0.75), |from| smooth_glass(0.75, from)),
        Case {
            model_error: 0.002,
            ..case("plastic", plastic_of(false), |from| {
                plastic(1.49, false, from)
            })
        },
        Case {
            model_error: 0.002,
            ..case("nonlinear plastic", plastic_of(true), |from| {
                plastic(1.49, true, from)
            })
        },
    ]
}

fn rough_cases() -> Vec<Case> {
    use MicrofacetDistribution::{Beckmann, Ggx};
    let rough_plastic = Material::rough_plastic(Ggx, 0.3, 1.49, true, GREY, WHITE, &textures());
    vec![
        rough_metal(Ggx, 0.3, "none"),
        rough_metal(Beckmann, 0.3, "none"),
        rough_metal(Ggx, 0.8, "Au"),
        rough_metal(Beckmann, 0.8, "Cu"),
        rough_glass(Ggx, 0.4, 1.5),
        rough_glass(Beckmann, 0.4, 1.5),
        rough_glass(Ggx, 0.7, 0.75),
        // The internal reflectance of the coat from Mitsuba's table, which the renderer uses too, is 1.6%
        // low.
        Case {
            model_error: 0.01,
            ..case("rough plastic", rough_plastic, |from| {
                Facets::Ggx(0.3).nonlinear_plastic(RHO, 1.49, from)
            })
        },
    ]
}

fn settle(cases: Vec<Case>, title: &str) {
    let mut truths = Truths::default();
    for Case {
        name,
        material,
        albedo,
        model_error,
    } in cases
    {
        // From below only transmitting materials are not black.
        let transmits = matches!(
            material,
            Material::Dielectric { .. } | Material::RoughDielectric { .. }
        );
        let angles: &[f64] = if transmits {
            &[25.0, 65.0, 150.0]
        } else {
            &[25.0, 65.0]
        };
        for &degrees in angles {
            let scene = plate(material.clone(), degrees);
            let truth = SKY * albedo(tilted(degrees));
            let name = format!("{name} at {degrees}");
            truths.render_within(model_error, &name, &scene, &[Path, Bdpt, Pssmlt], 40, truth);
        }
    }
    truths.settle("closed form", title);
}

#[test]
fn smooth_materials_under_a_constant_environment() {
    settle(smooth_cases(), "albedo of smooth materials");
}

#[test]
fn rough_materials_under_a_constant_environment() {
    settle(rough_cases(), "albedo of rough materials, by quadrature");
}

/// The two sides of a two-sided material are independent materials.
#[test]
fn two_sided_materials_under_a_constant_environment() {
    let front = rough_metal(MicrofacetDistribution::Ggx, 0.3, "Au");
    let material = Material::TwoSided {
        front: Box::new(front.material),
        back: Box::new(Material::Diffuse { reflectance: GREY }),
    };
    let mut truths = Truths::default();
    for (degrees, albedo) in [(40.0, (front.albedo)(tilted(40.0))), (130.0, RHO)] {
        let scene = plate(material.clone(), degrees);
        let name = format!("at {degrees}");
        truths.render(&name, &scene, &[Path, Bdpt, Pssmlt], 40, SKY * albedo);
    }
    truths.settle(
        "closed form",
        "albedo of both sides of a two-sided material",
    );
}
