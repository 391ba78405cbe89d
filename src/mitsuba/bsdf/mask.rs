//! `mask`: a material that covers a fraction of the surface.

use super::nested;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::Object;
use crate::scene::Material;

pub fn mask(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    Ok(Material::Mask {
        opacity: reflectance(builder, object, "opacity", 0.5)?,
        covered: Box::new(nested::only(builder, object)?),
    })
}
