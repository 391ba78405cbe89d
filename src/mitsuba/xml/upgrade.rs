//! Converts names of version 0.x to those of version 2 and later, as Mitsuba 3 does on loading.

use glam::{DMat4, DVec3};

use super::object::Object;
use super::property::{Property, Value};
use crate::mitsuba::error::LoadError;

/// Converts camel case to underscores: `toWorld` to `to_world`, `intIOR` to `int_ior`.
pub fn underscore_case(name: &str) -> String {
    let mut result = String::with_capacity(name.len() + 4);
    let mut previous = ' ';
    let mut in_capitals = false;
    for c in name.chars() {
        let is_capital = c.is_ascii_uppercase();
        let begins_word = is_capital && previous.is_ascii_lowercase();
        if begins_word {
            result.push('_');
        }
        in_capitals = is_capital && (begins_word || in_capitals);
        result.push(if in_capitals {
            c.to_ascii_lowercase()
        } else {
            c
        });
        previous = c;
    }
    result
}

/// Converts the parameters that changed otherwise: the reflectance of `diffuse`, and the offset and
/// scale of textures.
pub fn object(object: &mut Object) -> Result<(), LoadError> {
    if object.plugin == "diffuse" {
        let is_old = |p: &&mut Property| p.name == "diffuse_reflectance";
        if let Some(property) = object.properties.iter_mut().find(is_old) {
            property.name = "reflectance".into();
        }
    }
    let mut offset = DVec3::ZERO;
    let mut scale = DVec3::ONE;
    let mut place = None;
    if let Some(property) = object.remove("uvscale") {
        let number = property.value.as_float();
        let both = number.ok_or_else(|| property.wrong_type("a float"))?;
        scale = DVec3::new(both, both, 1.0);
        place = Some(property.place);
    }
    for (name, target) in [
        ("uoffset", &mut offset.x),
        ("voffset", &mut offset.y),
        ("uscale", &mut scale.x),
        ("vscale", &mut scale.y),
    ] {
        if let Some(property) = object.remove(name) {
            let number = property.value.as_float();
            *target = number.ok_or_else(|| property.wrong_type("a float"))?;
            place = Some(property.place);
        }
    }
    if let Some(place) = place {
        // In Mitsuba 3's order: first the offset, then the scale.
        let to_uv = DMat4::from_scale(scale) * DMat4::from_translation(offset);
        object.add("to_uv".into(), Value::Transform(to_uv), place)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camel_case_is_converted_to_underscores() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("maxDepth", "max_depth"),
            ("fovAxis", "fov_axis"),
            ("diffuseReflectance", "diffuse_reflectance"),
            ("already_new", "already_new"),
            ("uoffset", "uoffset"),
            ("IOR", "IOR"),
        ] {
            assert_eq!(underscore_case(old), new);
        }
    }
}
