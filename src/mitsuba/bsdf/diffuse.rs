//! `diffuse`: Lambertian reflection.

use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::Object;
use crate::scene::Material;

pub fn diffuse(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    Ok(Material::Diffuse {
        reflectance: reflectance(builder, object, "reflectance", 0.5)?,
    })
}
