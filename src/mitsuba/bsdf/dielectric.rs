//! `dielectric`, `roughdielectric` and `thindielectric`: interfaces that reflect and transmit.

use super::ior::{differing_ior, relative_ior};
use super::roughness::{distribution, roughness};
use super::specular::{specular_reflectance, specular_transmittance};
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::xml::Object;
use crate::scene::Material;

/// The medium inside by default.
const INSIDE: &str = "bk7";

pub fn smooth(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    Ok(Material::Dielectric {
        eta: relative_ior(object, INSIDE)?,
        specular_reflectance: specular_reflectance(builder, object)?,
        specular_transmittance: specular_transmittance(builder, object)?,
    })
}

pub fn thin(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    Ok(Material::ThinDielectric {
        eta: relative_ior(object, INSIDE)?,
        specular_reflectance: specular_reflectance(builder, object)?,
        specular_transmittance: specular_transmittance(builder, object)?,
    })
}

pub fn rough(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    Ok(Material::RoughDielectric {
        distribution: distribution(object)?,
        roughness: roughness(builder, object)?,
        eta: differing_ior(object, INSIDE)?,
        specular_reflectance: specular_reflectance(builder, object)?,
        specular_transmittance: specular_transmittance(builder, object)?,
    })
}
