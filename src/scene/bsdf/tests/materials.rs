//! The materials of the tests, and their textures.

use glam::Affine2;

use super::super::{
    DisneyLobes, DisneySum, Material, MicrofacetDistribution, NormalPerturbation, Principled,
    PrincipledThin, Roughness, metals,
};
use crate::math::Rgb;
use crate::scene::Texture;
use crate::scene::texture::{Bitmap, Interpolation, Wrap};

/// Indices into [`textures`].
pub const WHITE: u32 = 0;
pub const COLOR: u32 = 1;
pub const TINT: u32 = 2;
/// Grey textures.
pub const BLACK: u32 = 3;
pub const GREY: u32 = 4;
pub const LIGHT_GREY: u32 = 5;
pub const TENTH: u32 = 8;
pub const FIFTH: u32 = 9;
pub const TWO_FIFTHS: u32 = 10;
pub const HALF: u32 = 11;
/// A normal map of one normal, tilted by 31 degrees.
pub const NORMAL: u32 = 6;
/// A ramp.
pub const HEIGHT: u32 = 7;

pub fn textures() -> [Texture; 12] {
    let height = (0..12).map(|n| [0.1 * (n % 3) as f32 + 0.25 * (n / 3) as f32; 3]);
    let height = Bitmap::new(
        3,
        4,
        height.collect(),
        Interpolation::Bilinear,
        Wrap::Repeat,
        Affine2::IDENTITY,
    );
    [
        Texture::Constant(Rgb::ONE),
        Texture::Constant(Rgb::new(0.2, 0.5, 0.8)),
        Texture::Constant(Rgb::new(0.9, 0.8, 0.7)),
        Texture::Constant(Rgb::ZERO),
        Texture::Constant(Rgb::splat(0.3)),
        Texture::Constant(Rgb::splat(0.7)),
        Texture::Constant(Rgb::new(0.7, 0.4, 0.9)),
        Texture::Bitmap(height.expect("3 x 4 pixels")),
        Texture::Constant(Rgb::splat(0.1)),
        Texture::Constant(Rgb::splat(0.2)),
        Texture::Constant(Rgb::splat(0.4)),
        Texture::Constant(Rgb::splat(0.5)),
    ]
}

pub fn conductor(name: &str, specular_reflectance: u32) -> Material {
    let (eta, k) = metals::metal(name).expect("a known metal");
    Material::Conductor {
        eta,
        k,
        specular_reflectance,
    }
}

pub fn rough_conductor(
    distribution: MicrofacetDistribution,
    alpha: f32,
    name: &str,
    specular_reflectance: u32,
) -> Material {
    let (eta, k) = metals::metal(name).expect("a known metal");
    Material::RoughConductor {
        distribution,
        roughness: Roughness::Constant(alpha),
        eta,
        k,
        specular_reflectance,
    }
}

pub fn ashikhmin_shirley(alpha: f32, specular_reflectance: u32) -> Material {
    let (eta, k) = metals::metal("Al").expect("aluminium");
    Material::AshikhminShirley {
        alpha,
        eta,
        k,
        specular_reflectance,
    }
}

pub fn dielectric(eta: f32, reflectance: u32, transmittance: u32) -> Material {
    Material::Dielectric {
        eta,
        specular_reflectance: reflectance,
        specular_transmittance: transmittance,
    }
}

pub fn rough_dielectric(
    distribution: MicrofacetDistribution,
    alpha: f32,
    eta: f32,
    reflectance: u32,
    transmittance: u32,
) -> Material {
    Material::RoughDielectric {
        distribution,
        roughness: Roughness::Constant(alpha),
        eta,
        specular_reflectance: reflectance,
        specular_transmittance: transmittance,
    }
}

/// Materials with a lobe that is not a delta function.
pub fn connectible() -> Vec<(&'static str, Material)> {
    use MicrofacetDistribution::{Beckmann, Ggx};
    let textures = textures();
    let rough_plastic = |distribution, alpha, eta, nonlinear| {
        Material::rough_plastic(distribution, alpha, eta, nonlinear, COLOR, WHITE, &textures)
    };
    let mut materials = vec![
        ("diffuse", Material::Diffuse { reflectance: COLOR }),
        ("shiny GGX metal", rough_conductor(Ggx, 0.05, "Au", TINT)),
        ("rough GGX metal", rough_conductor(Ggx, 1.0, "Cr", WHITE)),
        (
            "shiny Beckmann metal",
            rough_conductor(Beckmann, 0.05, "Cu", WHITE),
        ),
        (
            "rough Beckmann metal",
            rough_conductor(Beckmann, 0.8, "none", WHITE),
        ),
        (
            "shiny Ashikhmin-Shirley metal",
            ashikhmin_shirley(0.1, TINT),
        ),
        (
            "rough Ashikhmin-Shirley metal",
            ashikhmin_shirley(0.8, WHITE),
        ),
        (
            "shiny GGX glass",
            rough_dielectric(Ggx, 0.06, 1.5, WHITE, WHITE),
        ),
        (
            "rough GGX glass",
            rough_dielectric(Ggx, 0.7, 1.5, TINT, COLOR),
        ),
        (
            "rough Beckmann bubble",
            rough_dielectric(Beckmann, 0.4, 0.75, WHITE, TINT),
        ),
        (
            "rough Beckmann diamond",
            rough_dielectric(Beckmann, 0.2, 2.419, WHITE, WHITE),
        ),
        (
            "plastic",
            Material::plastic(1.49, false, COLOR, WHITE, &textures),
        ),
        (
            "nonlinear plastic",
            Material::plastic(1.9, true, COLOR, TINT, &textures),
        ),
        ("shiny plastic", rough_plastic(Beckmann, 0.08, 1.49, false)),
        ("rough plastic", rough_plastic(Ggx, 0.5, 1.7, true)),
        (
            "metal and paint",
            Material::TwoSided {
                front: Box::new(rough_conductor(Ggx, 0.3, "Al", WHITE)),
                back: Box::new(Material::plastic(1.49, false, COLOR, WHITE, &textures)),
            },
        ),
    ];
    materials.extend(anisotropic());
    materials.extend(nested());
    materials.extend(perturbed());
    materials.extend(disney());
    materials
}

/// Microfacets that are rougher in one direction than in the other.
fn anisotropic() -> Vec<(&'static str, Material)> {
    use MicrofacetDistribution::{Beckmann, Ggx};
    vec![
        ("brushed GGX metal", brushed_metal(Ggx, GREY, LIGHT_GREY)),
        (
            "brushed Beckmann metal",
            brushed_metal(Beckmann, LIGHT_GREY, GREY),
        ),
        (
            "brushed GGX glass",
            Material::RoughDielectric {
                distribution: Ggx,
                roughness: along(LIGHT_GREY, GREY),
                eta: 1.5,
                specular_reflectance: WHITE,
                specular_transmittance: COLOR,
            },
        ),
    ]
}

pub fn along(along_u: u32, along_v: u32) -> Roughness {
    Roughness::Textured { along_u, along_v }
}

pub fn brushed_metal(distribution: MicrofacetDistribution, along_u: u32, along_v: u32) -> Material {
    let (eta, k) = metals::metal("Au").expect("gold");
    Material::RoughConductor {
        distribution,
        roughness: along(along_u, along_v),
        eta,
        k,
        specular_reflectance: WHITE,
    }
}

pub fn diffuse() -> Box<Material> {
    Box::new(Material::Diffuse { reflectance: COLOR })
}

pub fn copper() -> Box<Material> {
    Box::new(rough_conductor(
        MicrofacetDistribution::Ggx,
        0.3,
        "Cu",
        WHITE,
    ))
}

pub fn mask(covered: Box<Material>) -> Material {
    Material::Mask {
        opacity: GREY,
        covered,
    }
}

pub fn blend(first: Box<Material>, second: Box<Material>) -> Material {
    Material::Blend {
        weight: GREY,
        first,
        second,
    }
}

pub fn phong(exponent: f32) -> Material {
    Material::Phong {
        exponent,
        diffuse_reflectance: GREY,
        specular_reflectance: LIGHT_GREY,
    }
}

/// Phong reflection, masks and blends, also with delta lobes.
fn nested() -> Vec<(&'static str, Material)> {
    let mirror = || Box::new(conductor("none", TINT));
    let glass = || Box::new(dielectric(1.5, TINT, COLOR));
    vec![
        ("phong", phong(20.0)),
        ("wide phong", phong(0.5)),
        ("masked metal", mask(copper())),
        ("blend", blend(diffuse(), copper())),
        ("paint on glass", blend(diffuse(), glass())),
        (
            "paint on a masked mirror",
            blend(Box::new(mask(mirror())), diffuse()),
        ),
    ]
}

pub fn normal_map(perturbation: NormalPerturbation, base: Box<Material>) -> Material {
    Material::NormalMap {
        normals: NORMAL,
        perturbation,
        base,
    }
}

pub fn bump_map(scale: f32, perturbation: NormalPerturbation, base: Box<Material>) -> Material {
    Material::BumpMap {
        displacement: HEIGHT,
        scale,
        perturbation,
        base,
    }
}

pub fn perturbation(flip: bool, shadowing: bool) -> NormalPerturbation {
    NormalPerturbation {
        flip_invalid_normals: flip,
        use_shadowing_function: shadowing,
    }
}

fn perturbed() -> Vec<(&'static str, Material)> {
    let brushed = || Box::new(brushed_metal(MicrofacetDistribution::Ggx, GREY, LIGHT_GREY));
    let two_sided = Material::TwoSided {
        front: copper(),
        back: diffuse(),
    };
    vec![
        (
            "normal map",
            normal_map(NormalPerturbation::default(), brushed()),
        ),
        (
            "normal map on two sides",
            normal_map(perturbation(true, false), Box::new(two_sided)),
        ),
        (
            "bump map",
            bump_map(0.7, perturbation(false, true), diffuse()),
        ),
        (
            "steep bump map",
            bump_map(4.0, perturbation(true, true), diffuse()),
        ),
        (
            "normal map on smooth plastic",
            normal_map(
                NormalPerturbation::default(),
                Box::new(Material::plastic(1.49, false, COLOR, WHITE, &textures())),
            ),
        ),
    ]
}

/// A base of everything, opaque.
pub fn opaque_principled() -> Principled {
    Principled {
        base_color: COLOR,
        roughness: LIGHT_GREY,
        anisotropic: GREY,
        metallic: GREY,
        spec_trans: BLACK,
        spec_tint: GREY,
        sheen: LIGHT_GREY,
        sheen_tint: GREY,
        flatness: GREY,
        clearcoat: LIGHT_GREY,
        clearcoat_gloss: GREY,
        eta: 1.5,
        transmits: false,
    }
}

/// Transparent and dielectric.
pub fn transparent_principled(eta: f32) -> Principled {
    Principled {
        spec_trans: LIGHT_GREY,
        anisotropic: BLACK,
        sheen: BLACK,
        eta,
        transmits: true,
        ..opaque_principled()
    }
}

pub fn thin_principled(spec_trans: u32) -> PrincipledThin {
    PrincipledThin {
        base_color: COLOR,
        roughness: LIGHT_GREY,
        anisotropic: GREY,
        spec_trans,
        spec_tint: GREY,
        sheen: LIGHT_GREY,
        sheen_tint: GREY,
        flatness: GREY,
        diff_trans: GREY,
        eta: 1.5,
    }
}

/// Disney's model as a sum of lobes, with everything.
pub fn disney_sum(lobes: DisneyLobes) -> DisneySum {
    DisneySum {
        lobes,
        base_color: COLOR,
        roughness: LIGHT_GREY,
        anisotropic: GREY,
        metallic: GREY,
        specular_transmission: BLACK,
        specular: HALF,
        specular_tint: GREY,
        subsurface: GREY,
        sheen: LIGHT_GREY,
        sheen_tint: GREY,
        clearcoat: LIGHT_GREY,
        clearcoat_gloss: GREY,
        eta: 1.5,
        transmits: false,
    }
}

/// As [`disney_sum`], with transmission.
pub fn transparent_disney_sum(specular_transmission: u32) -> DisneySum {
    DisneySum {
        specular_transmission,
        transmits: true,
        ..disney_sum(DisneyLobes::All)
    }
}

fn disney() -> Vec<(&'static str, Material)> {
    let sum = |lobes| Material::DisneySum(disney_sum(lobes));
    vec![
        ("principled", Material::Principled(opaque_principled())),
        (
            "principled glass",
            Material::Principled(transparent_principled(1.5)),
        ),
        (
            "principled bubble",
            Material::Principled(transparent_principled(0.8)),
        ),
        ("thin", Material::PrincipledThin(thin_principled(BLACK))),
        (
            "thin glass",
            Material::PrincipledThin(thin_principled(GREY)),
        ),
        ("sum of lobes", sum(DisneyLobes::All)),
        ("retroreflection", sum(DisneyLobes::Diffuse)),
        ("sheen", sum(DisneyLobes::Sheen)),
        ("clearcoat", sum(DisneyLobes::Clearcoat)),
        (
            "sum of lobes with glass",
            Material::DisneySum(transparent_disney_sum(LIGHT_GREY)),
        ),
    ]
}

/// Perturbed normals are not reciprocal, nor is Mitsuba's thin transmission.
pub fn is_reciprocal((name, material): &(&str, Material)) -> bool {
    !material.perturbs_normals() && *name != "thin glass"
}

/// Materials of which all lobes are delta functions.
pub fn perfectly_smooth() -> Vec<(&'static str, Material)> {
    use MicrofacetDistribution::Ggx;
    vec![
        ("mirror", conductor("none", WHITE)),
        ("gold", conductor("Au", TINT)),
        ("glass", dielectric(1.5, WHITE, WHITE)),
        ("tinted bubble", dielectric(0.75, TINT, COLOR)),
        (
            "pane",
            Material::ThinDielectric {
                eta: 1.5,
                specular_reflectance: TINT,
                specular_transmittance: COLOR,
            },
        ),
        ("masked gold", mask(Box::new(conductor("Au", TINT)))),
        (
            "gold on glass",
            blend(
                Box::new(dielectric(1.5, TINT, COLOR)),
                Box::new(conductor("Au", WHITE)),
            ),
        ),
        ("nothing", dielectric(1.0, WHITE, WHITE)),
        (
            "rough nothing",
            rough_dielectric(Ggx, 0.3, 1.0, WHITE, WHITE),
        ),
    ]
}
