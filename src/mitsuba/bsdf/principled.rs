//! `principled` and `principledthin`: Disney's models.

use crate::math::Rgb;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::Object;
use crate::scene::bsdf::{Principled, PrincipledThin};
use crate::scene::{Material, Texture};

/// Mitsuba's index of refraction where transmission has the index 1.
const MIN_TRANSMITTING_ETA: f32 = 1.001;
/// Mitsuba's `specular` where transmission has a `specular` of 0.
const MIN_TRANSMITTING_SPECULAR: f64 = 1e-3;
/// Maximum index of refraction; the minimum is its inverse.
const MAX_ETA: f64 = 1000.0;

pub fn solid(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    // Which lobes are sampled how often does not change what is estimated.
    object.ignore(&[
        "main_specular_sampling_rate",
        "clearcoat_sampling_rate",
        "diffuse_reflectance_sampling_rate",
    ]);
    let mut weight = |name: &str| reflectance(builder, object, name, 0.0);
    let [spec_trans, metallic, anisotropic] = [
        weight("spec_trans")?,
        weight("metallic")?,
        weight("anisotropic")?,
    ];
    let [spec_tint, sheen, sheen_tint] = [
        weight("spec_tint")?,
        weight("sheen")?,
        weight("sheen_tint")?,
    ];
    let [flatness, clearcoat, clearcoat_gloss] = [
        weight("flatness")?,
        weight("clearcoat")?,
        weight("clearcoat_gloss")?,
    ];
    let transmits = builder.textures[spec_trans as usize].max() != Rgb::ZERO;
    Ok(Material::Principled(Principled {
        base_color: reflectance(builder, object, "base_color", 0.5)?,
        roughness: reflectance(builder, object, "roughness", 0.5)?,
        anisotropic,
        metallic,
        spec_trans,
        spec_tint,
        sheen,
        sheen_tint,
        flatness,
        clearcoat,
        clearcoat_gloss,
        eta: eta(object, transmits)?,
        transmits,
    }))
}

/// `eta`, or the index of refraction whose reflectance at normal incidence is 0.08 `specular`.
fn eta(object: &Object, transmits: bool) -> Result<f32, LoadError> {
    match (object.find("eta"), object.find("specular")) {
        (Some(_), Some(specular)) => {
            Err(specular.conflict("give either `eta` or `specular`, not both"))
        }
        (Some(_), None) => match given_eta(object)? {
            1.0 if transmits => Ok(MIN_TRANSMITTING_ETA),
            eta => Ok(eta),
        },
        (None, _) => {
            let is_valid = |x: f64| (0.0..=1.0).contains(&x);
            let specular = object.float_in("specular", 0.5, "between 0 and 1", is_valid)?;
            let specular = match specular {
                0.0 if transmits => MIN_TRANSMITTING_SPECULAR,
                specular => specular,
            };
            Ok((2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0) as f32)
        }
    }
}

fn given_eta(object: &Object) -> Result<f32, LoadError> {
    let range = format!("between {} and {MAX_ETA}", MAX_ETA.recip());
    let is_valid = |x: f64| (MAX_ETA.recip()..=MAX_ETA).contains(&x);
    Ok(object.float_in("eta", 1.5, &range, is_valid)? as f32)
}

pub fn thin(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    // As for `solid`.
    object.ignore(&[
        "specular_reflectance_sampling_rate",
        "specular_transmittance_sampling_rate",
        "diffuse_transmittance_sampling_rate",
        "diffuse_reflectance_sampling_rate",
    ]);
    // Its values are from 0 to 2.
    let is_valid = |x: f64| (0.0..=2.0).contains(&x);
    let diff_trans = object.float_in("diff_trans", 0.0, "between 0 and 2", is_valid)?;
    let half = Texture::Constant(Rgb::splat(0.5 * diff_trans as f32));
    let diff_trans = builder.add_texture(half);
    let eta = given_eta(object)?;
    let mut weight = |name: &str, default| reflectance(builder, object, name, default);
    Ok(Material::PrincipledThin(PrincipledThin {
        base_color: weight("base_color", 0.5)?,
        roughness: weight("roughness", 0.5)?,
        anisotropic: weight("anisotropic", 0.0)?,
        spec_trans: weight("spec_trans", 0.0)?,
        spec_tint: weight("spec_tint", 0.0)?,
        sheen: weight("sheen", 0.0)?,
        sheen_tint: weight("sheen_tint", 0.0)?,
        flatness: weight("flatness", 0.0)?,
        diff_trans,
        eta,
    }))
}
