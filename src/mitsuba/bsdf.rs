//! `bsdf`: materials.

use super::color::{self, Quantity};
use super::error::{Cause, LoadError};
use super::object::{Object, Tag};
use super::property::{Property, Value};
use super::scene::Builder;
use super::texture::reflectance;
use crate::math::Rgb;
use crate::scene::Material;
use crate::scene::bsdf::MicrofacetDistribution;
use crate::scene::bsdf::ior::{ior, ior_names};
use crate::scene::bsdf::metals::{metal, metal_names};

const KNOWN: [&str; 8] = [
    "conductor",
    "dielectric",
    "diffuse",
    "plastic",
    "roughconductor",
    "roughdielectric",
    "roughplastic",
    "twosided",
];

/// Smallest roughness: Mitsuba takes smaller ones for this.
const SMOOTHEST: f64 = 1e-4;
/// Greatest roughness; microfacets are vertical walls long before.
const ROUGHEST: f64 = 10.0;
/// Greatest index of refraction of one medium over another's, and smallest inverse.
const GREATEST_IOR: f64 = 1000.0;

/// The material at `index`, as an index among the materials.
pub fn material(builder: &mut Builder, index: usize) -> Result<u32, LoadError> {
    if let Some(&material) = builder.material_of.get(&index) {
        return Ok(material);
    }
    let material = build(builder, index)?;
    let material = push(builder, material);
    builder.material_of.insert(index, material);
    Ok(material)
}

/// The material of a shape without one: Mitsuba's, black for emitters.
pub fn default_material(builder: &mut Builder, emits: bool) -> u32 {
    let albedo = if emits { 0.0 } else { 0.5 };
    let color = crate::scene::Texture::Constant(Rgb::splat(albedo));
    builder.textures.push(color);
    let reflectance = (builder.textures.len() - 1) as u32;
    push(builder, Material::Diffuse { reflectance })
}

fn push(builder: &mut Builder, material: Material) -> u32 {
    builder.materials.push(material);
    (builder.materials.len() - 1) as u32
}

fn build(builder: &mut Builder, index: usize) -> Result<Material, LoadError> {
    let object = builder.object(index);
    let material = match object.plugin.as_str() {
        "diffuse" => Material::Diffuse {
            reflectance: reflectance(builder, object, "reflectance", 0.5)?,
        },
        "conductor" => {
            let (eta, k) = metal_indices(object)?;
            let specular_reflectance = specular(builder, object)?;
            Material::Conductor {
                eta,
                k,
                specular_reflectance,
            }
        }
        "roughconductor" => {
            let (eta, k) = metal_indices(object)?;
            Material::RoughConductor {
                distribution: distribution(object)?,
                alpha: roughness(object)?,
                eta,
                k,
                specular_reflectance: specular(builder, object)?,
            }
        }
        "dielectric" => Material::Dielectric {
            eta: relative_ior(object, "bk7")?,
            specular_reflectance: specular(builder, object)?,
            specular_transmittance: reflectance(builder, object, "specular_transmittance", 1.0)?,
        },
        "roughdielectric" => Material::RoughDielectric {
            distribution: distribution(object)?,
            alpha: roughness(object)?,
            eta: differing_ior(object, "bk7")?,
            specular_reflectance: specular(builder, object)?,
            specular_transmittance: reflectance(builder, object, "specular_transmittance", 1.0)?,
        },
        "plastic" | "roughplastic" => plastic(builder, object)?,
        "twosided" => two_sided(builder, object)?,
        _ => return Err(object.unknown_plugin(&KNOWN)),
    };
    builder.finish(object)?;
    Ok(material)
}

fn plastic(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let nonlinear = object.boolean("nonlinear", false)?;
    let diffuse = reflectance(builder, object, "diffuse_reflectance", 0.5)?;
    let specular = specular(builder, object)?;
    if object.plugin == "plastic" {
        let eta = relative_ior(object, "polypropylene")?;
        let textures = &builder.textures;
        return Ok(Material::plastic(
            eta, nonlinear, diffuse, specular, textures,
        ));
    }
    let eta = differing_ior(object, "polypropylene")?;
    let distribution = distribution(object)?;
    let alpha = roughness(object)?;
    Ok(Material::rough_plastic(
        distribution,
        alpha,
        eta,
        nonlinear,
        diffuse,
        specular,
        &builder.textures,
    ))
}

fn two_sided(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let tree = builder.tree;
    let mut sides = Vec::new();
    for (index, property) in object.children(&tree.objects, Tag::Bsdf) {
        if sides.len() == 2 {
            let problem = "`twosided` has two sides, and this is a third material";
            return Err(property.error(Cause::Conflict(problem.into())));
        }
        let index = material(builder, index)?;
        sides.push(match builder.materials[index as usize].clone() {
            Material::Dielectric { .. } | Material::RoughDielectric { .. } => {
                let problem = "a material that transmits cannot be made two-sided";
                return Err(property.error(Cause::Conflict(problem.into())));
            }
            // Each side of the outer one meets the inner one from its front.
            Material::TwoSided { front, .. } => front,
            one_sided => Box::new(one_sided),
        });
    }
    let mut sides = sides.into_iter();
    let Some(front) = sides.next() else {
        return Err(object.missing("one or two nested materials"));
    };
    let back = sides.next().unwrap_or_else(|| front.clone());
    Ok(Material::TwoSided { front, back })
}

fn specular(builder: &mut Builder, object: &Object) -> Result<u32, LoadError> {
    reflectance(builder, object, "specular_reflectance", 1.0)
}

fn distribution(object: &Object) -> Result<MicrofacetDistribution, LoadError> {
    let choices = [
        ("beckmann", MicrofacetDistribution::Beckmann),
        ("ggx", MicrofacetDistribution::Ggx),
    ];
    // Which normals are sampled has no influence on what is estimated.
    object.ignore(&["sample_visible"]);
    object.choice("distribution", MicrofacetDistribution::Beckmann, &choices)
}

fn roughness(object: &Object) -> Result<f32, LoadError> {
    let range = format!("between 0 and {ROUGHEST}");
    let get = |name| object.float_in(name, 0.1, &range, |x| (0.0..=ROUGHEST).contains(&x));
    let alpha = match (object.find("alpha_u"), object.find("alpha_v")) {
        (None, None) => get("alpha")?,
        (Some(_), Some(property)) => {
            if let Some(alpha) = object.find("alpha") {
                let problem = "give either `alpha` or `alpha_u` and `alpha_v`";
                return Err(alpha.error(Cause::Conflict(problem.into())));
            }
            if get("alpha_u")? != get("alpha_v")? {
                let what = "anisotropic roughness; `alpha_u` and `alpha_v` must be equal";
                return Err(property.error(Cause::NotModelled(what.into())));
            }
            get("alpha_u")?
        }
        _ => return Err(object.missing("both of `alpha_u` and `alpha_v`, or `alpha`")),
    };
    Ok(alpha.max(SMOOTHEST) as f32)
}

/// eta and k of a metal: by its name, or as colours. They count against `ext_eta` outside, which
/// is Mitsuba 0.6's parameter; Mitsuba 3 knows metals in vacuum only.
fn metal_indices(object: &Object) -> Result<(Rgb, Rgb), LoadError> {
    let given = object.find("eta").or(object.find("k"));
    let (eta, k) = match (object.text("material")?, object.find("material"), given) {
        (Some(_), _, Some(given)) => {
            let problem = "give either `material` or `eta` and `k`, not both";
            return Err(given.error(Cause::Conflict(problem.into())));
        }
        (Some(name), Some(property), None) => metal(name).ok_or_else(|| {
            property.error(Cause::UnknownName {
                what: "material".into(),
                found: name.to_owned(),
                known: metal_names().map(str::to_owned).collect(),
            })
        })?,
        _ => (
            color::color(object, "eta", Quantity::Index, 0.0)?,
            color::color(object, "k", Quantity::Index, 1.0)?,
        ),
    };
    let outside = match object.find("ext_eta") {
        Some(property) => refractive_index(property)?,
        None => 1.0,
    };
    Ok((eta / outside, k / outside))
}

/// `int_ior` over `ext_ior`.
fn relative_ior(object: &Object, inside: &str) -> Result<f32, LoadError> {
    let index = |name: &str, default: &str| match object.find(name) {
        Some(property) => refractive_index(property),
        None => ior(default).ok_or_else(|| object.missing(&format!("`{name}`"))),
    };
    Ok(index("int_ior", inside)? / index("ext_ior", "air")?)
}

/// As [`relative_ior`], for rough interfaces: those between equal media do nothing, and Mitsuba
/// refuses them too.
fn differing_ior(object: &Object, inside: &str) -> Result<f32, LoadError> {
    match relative_ior(object, inside)? {
        1.0 => Err(object.error(Cause::Conflict(
            "`int_ior` and `ext_ior` must differ for a rough surface".into(),
        ))),
        eta => Ok(eta),
    }
}

/// A number, or the name of a medium.
fn refractive_index(property: &Property) -> Result<f32, LoadError> {
    if let Value::Text(name) = &property.value {
        let found = ior(&name.to_lowercase());
        return found.ok_or_else(|| {
            property.error(Cause::UnknownName {
                what: "medium".into(),
                found: name.clone(),
                known: ior_names().map(str::to_owned).collect(),
            })
        });
    }
    let number = property.value.as_float();
    let number = number.ok_or_else(|| property.wrong_type("a number or the name of a medium"))?;
    if number >= GREATEST_IOR.recip() && number <= GREATEST_IOR {
        return Ok(number as f32);
    }
    let range = format!("between {} and {GREATEST_IOR}", GREATEST_IOR.recip());
    Err(property.out_of_range(number, &range))
}
