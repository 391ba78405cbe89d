//! `disneymetal` and `disneydiffuse` of the renderer lajolla: two lobes of Disney's models, which `principled` and
//! `principledthin` contain too. Its other names (`disneyglass`, `disneysheen`, `disneyclearcoat`, `disneybsdf`) are
//! models of its own.

use crate::math::Rgb;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::Object;
use crate::scene::bsdf::{Principled, PrincipledThin};
use crate::scene::{Material, Texture};

/// Minimum roughness of `disneymetal`: at lower ones, the minimum of alpha of lajolla, 1e-4, and that of `principled`,
/// 1e-3, may differ.
const MIN_ROUGHNESS: f64 = 0.06;

/// Reflection by microfacets whose reflectance at normal incidence is `base_color`.
pub fn metal(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let [black, white] = black_and_white(builder);
    let range = format!("between {MIN_ROUGHNESS} and 1");
    let is_valid = |x: f64| (MIN_ROUGHNESS..=1.0).contains(&x);
    let roughness = object.float_in("roughness", 0.5, &range, is_valid)? as f32;
    Ok(Material::Principled(Principled {
        base_color: reflectance(builder, object, "base_color", 0.5)?,
        roughness: builder.add_texture(Texture::Constant(Rgb::splat(roughness))),
        anisotropic: reflectance(builder, object, "anisotropic", 0.0)?,
        metallic: white,
        spec_trans: black,
        spec_tint: black,
        sheen: black,
        sheen_tint: black,
        flatness: black,
        clearcoat: black,
        clearcoat_gloss: black,
        eta: 1.5,
        transmits: false,
    }))
}

/// The diffuse base, on the front only.
pub fn diffuse(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let [black, _] = black_and_white(builder);
    let base = PrincipledThin {
        base_color: reflectance(builder, object, "base_color", 0.5)?,
        roughness: reflectance(builder, object, "roughness", 0.5)?,
        anisotropic: black,
        spec_trans: black,
        spec_tint: black,
        sheen: black,
        sheen_tint: black,
        flatness: reflectance(builder, object, "subsurface", 0.0)?,
        diff_trans: black,
        eta: 1.5,
    };
    Ok(Material::TwoSided {
        front: Box::new(Material::PrincipledThin(base)),
        back: Box::new(Material::Diffuse { reflectance: black }),
    })
}

fn black_and_white(builder: &mut Builder) -> [u32; 2] {
    [0.0, 1.0].map(|value| builder.add_texture(Texture::Constant(Rgb::splat(value))))
}
