//! Factors of specular reflection and transmission. Physically plausible scenes leave them at 1.

use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::Object;

/// As an index of [`Builder::textures`].
pub fn specular_reflectance(builder: &mut Builder, object: &Object) -> Result<u32, LoadError> {
    reflectance(builder, object, "specular_reflectance", 1.0)
}

/// As an index of [`Builder::textures`].
pub fn specular_transmittance(builder: &mut Builder, object: &Object) -> Result<u32, LoadError> {
    reflectance(builder, object, "specular_transmittance", 1.0)
}
