//! `twosided`: reflective materials on both sides of a surface.

use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::xml::Object;
use crate::scene::Material;

pub fn twosided(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let mut sides = Vec::new();
    for (material, property) in builder.nested_materials(object) {
        if sides.len() == 2 {
            return Err(property.conflict("`twosided` has two sides, and this is a third material"));
        }
        sides.push(match material {
            transmitting if transmitting.transmits() => {
                return Err(property.conflict("a material that transmits cannot be made two-sided"));
            }
            // Either side of the surface sees the front of a nested two-sided material.
            Material::TwoSided { front, .. } => front.clone(),
            one_sided => Box::new(one_sided.clone()),
        });
    }
    let mut sides = sides.into_iter();
    let Some(front) = sides.next() else {
        return Err(object.missing("one or two nested materials"));
    };
    let back = sides.next().unwrap_or_else(|| front.clone());
    Ok(Material::TwoSided { front, back })
}
