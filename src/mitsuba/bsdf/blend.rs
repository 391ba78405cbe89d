//! `blendbsdf` and `mixturebsdf`: weighted sums of materials.

use super::nested;
use crate::math::Rgb;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::{Object, value};
use crate::scene::{Material, Texture};

/// Two materials; `weight` is that of the second.
pub fn blend(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let [first, second] = nested::exactly(builder, object, "two nested materials")?;
    if object.find("weight").is_none() {
        return Err(object.missing("`weight`"));
    }
    Ok(Material::Blend {
        weight: reflectance(builder, object, "weight", 0.5)?,
        first: Box::new(first),
        second: Box::new(second),
    })
}

/// Any number of materials with constant `weights`: the `mixturebsdf` of Mitsuba 0.6, which divides weights by
/// their sum if it exceeds 1, and absorbs the rest if it is less.
pub fn mixture(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let Some((text, property)) = object.text("weights")? else {
        return Err(object.missing("the string `weights`"));
    };
    let weights = value::floats(text).map_err(|cause| property.error(cause))?;
    if let Some(weight) = weights.iter().find(|weight| **weight < 0.0) {
        return Err(property.out_of_range(weight, "0 or above"));
    }
    let nested = builder.nested_materials(object);
    if nested.is_empty() || weights.len() != nested.len() {
        let counts = format!("{} weights for {} materials", weights.len(), nested.len());
        return Err(property.conflict(format!("each nested material needs one weight: {counts}")));
    }
    let materials: Vec<Material> = nested.into_iter().map(|(m, _)| m.clone()).collect();
    let black = Material::Diffuse {
        reflectance: builder.add_texture(Texture::Constant(Rgb::ZERO)),
    };
    let rest = (1.0 - weights.iter().sum::<f64>()).max(0.0);
    let mut parts = materials.into_iter().zip(weights);
    let (mut blend, mut total) = (black, rest);
    for (material, weight) in parts.by_ref().filter(|(_, weight)| *weight > 0.0) {
        total += weight;
        let weight = (weight / total) as f32;
        blend = if weight == 1.0 {
            material
        } else {
            Material::Blend {
                weight: builder.add_texture(Texture::Constant(Rgb::splat(weight))),
                first: Box::new(blend),
                second: Box::new(material),
            }
        };
    }
    Ok(blend)
}
