//! `conductor` and `roughconductor`: metals.

use super::ior::refractive_index;
use super::roughness::{ashikhmin_shirley_roughness, distribution, roughness};
use super::specular::specular_reflectance;
use crate::math::Rgb;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::color::{Quantity, color};
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::xml::Object;
use crate::scene::Material;
use crate::scene::bsdf::metals::{metal, metal_names};

pub fn smooth(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let (eta, k) = metal_indices(object)?;
    Ok(Material::Conductor {
        eta,
        k,
        specular_reflectance: specular_reflectance(builder, object)?,
    })
}

pub fn rough(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let (eta, k) = metal_indices(object)?;
    if let Some(alpha) = ashikhmin_shirley_roughness(builder, object)? {
        return Ok(Material::AshikhminShirley {
            alpha,
            eta,
            k,
            specular_reflectance: specular_reflectance(builder, object)?,
        });
    }
    Ok(Material::RoughConductor {
        distribution: distribution(object)?,
        roughness: roughness(builder, object)?,
        eta,
        k,
        specular_reflectance: specular_reflectance(builder, object)?,
    })
}

/// Real and imaginary part of the refractive index, given by the name of a metal or as colours,
/// relative to the index `ext_eta` of the medium outside. `ext_eta` is a parameter of Mitsuba 0.6;
/// Mitsuba 3 has only metals in vacuum.
fn metal_indices(object: &Object) -> Result<(Rgb, Rgb), LoadError> {
    let colors = object.find("eta").or(object.find("k"));
    let (eta, k) = match (object.text("material")?, colors) {
        (Some(_), Some(color)) => {
            return Err(color.conflict("give either `material` or `eta` and `k`, not both"));
        }
        (Some((name, property)), None) => {
            metal(name).ok_or_else(|| property.unknown_name("material", name, metal_names()))?
        }
        (None, _) => (
            color(object, "eta", Quantity::Index, 0.0)?,
            color(object, "k", Quantity::Index, 1.0)?,
        ),
    };
    let outside = match object.find("ext_eta") {
        Some(property) => refractive_index(property)?,
        None => 1.0,
    };
    Ok((eta / outside, k / outside))
}
