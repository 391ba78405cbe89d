//! `phong` of Mitsuba 0.6: modified Phong reflection.

use super::specular::specular_reflectance;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::Object;
use crate::scene::Material;

/// Maximum exponent. Highlights of a larger one are below the resolution of f32.
const MAX_EXPONENT: f64 = 1e6;

/// The default values are those of Mitsuba 0.6.
pub fn phong(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let range = format!("between 0 and {MAX_EXPONENT}");
    let is_valid = |x: f64| (0.0..=MAX_EXPONENT).contains(&x);
    let exponent = object.float_in("exponent", 30.0, &range, is_valid)? as f32;
    let diffuse_reflectance = reflectance(builder, object, "diffuse_reflectance", 0.5)?;
    let specular = match object.find("specular_reflectance") {
        Some(_) => specular_reflectance(builder, object)?,
        None => reflectance(builder, object, "specular_reflectance", 0.2)?,
    };
    let max = |texture: u32| builder.textures[texture as usize].max();
    let largest = (max(diffuse_reflectance) + max(specular)).max_element();
    // Mitsuba 0.6 scales the reflectances down in this case.
    if largest > 1.0 {
        let sum = "the sum of `diffuse_reflectance` and `specular_reflectance` must not exceed 1";
        return Err(object.conflict(format!("{sum}, but reaches {largest}")));
    }
    Ok(Material::Phong {
        exponent,
        diffuse_reflectance,
        specular_reflectance: specular,
    })
}
