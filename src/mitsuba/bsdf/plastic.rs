//! `plastic` and `roughplastic`: a diffuse base under a dielectric coating.

use super::ior::{differing_ior, relative_ior};
use super::roughness::{constant_roughness, distribution};
use super::specular::specular_reflectance;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::Object;
use crate::scene::Material;

/// The medium inside by default.
const INSIDE: &str = "polypropylene";

pub fn smooth(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let nonlinear = object.boolean("nonlinear", false)?;
    let diffuse = diffuse_reflectance(builder, object)?;
    let specular = specular_reflectance(builder, object)?;
    let eta = relative_ior(object, INSIDE)?;
    let textures = &builder.textures;
    Ok(Material::plastic(
        eta, nonlinear, diffuse, specular, textures,
    ))
}

pub fn rough(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let nonlinear = object.boolean("nonlinear", false)?;
    let diffuse = diffuse_reflectance(builder, object)?;
    let specular = specular_reflectance(builder, object)?;
    Ok(Material::rough_plastic(
        distribution(object)?,
        constant_roughness(object)?,
        differing_ior(object, INSIDE)?,
        nonlinear,
        diffuse,
        specular,
        &builder.textures,
    ))
}

fn diffuse_reflectance(builder: &mut Builder, object: &Object) -> Result<u32, LoadError> {
    reflectance(builder, object, "diffuse_reflectance", 0.5)
}
