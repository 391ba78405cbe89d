//! `normalmap` and `bumpmap`: materials whose normals a texture perturbs.

use super::nested;
use crate::film::Decode;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::texture::{Range, bitmap_file, required_texture, texture};
use crate::mitsuba::xml::{Object, Tag};
use crate::scene::Material;
use crate::scene::bsdf::NormalPerturbation;

/// The texture is `normalmap`, or the image `filename` of forks of Mitsuba 2.
pub fn normal_map<'a>(
    builder: &mut Builder<'a>,
    object: &'a Object,
) -> Result<Material, LoadError> {
    let normals = if object.find("filename").is_some() {
        bitmap_file(builder, object, Decode::Raw)?
    } else {
        required_texture(builder, object, "normalmap", Range::Any)?
    };
    Ok(Material::NormalMap {
        normals,
        perturbation: perturbation(object)?,
        base: Box::new(nested::only_unperturbed(builder, object)?),
    })
}

/// The only nested texture is the displacement.
pub fn bump_map(builder: &mut Builder, object: &Object) -> Result<Material, LoadError> {
    let Some(index) = builder.child(object, Tag::Texture)? else {
        return Err(object.missing("one nested texture"));
    };
    Ok(Material::BumpMap {
        displacement: texture(builder, index, Range::Any)?,
        scale: object.float_in("scale", 1.0, "finite", f64::is_finite)? as f32,
        perturbation: perturbation(object)?,
        base: Box::new(nested::only_unperturbed(builder, object)?),
    })
}

fn perturbation(object: &Object) -> Result<NormalPerturbation, LoadError> {
    let default = NormalPerturbation::default();
    let flip = default.flip_invalid_normals;
    let shadowing = default.use_shadowing_function;
    Ok(NormalPerturbation {
        flip_invalid_normals: object.boolean("flip_invalid_normals", flip)?,
        use_shadowing_function: object.boolean("use_shadowing_function", shadowing)?,
    })
}
