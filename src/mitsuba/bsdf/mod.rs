//! `bsdf`: materials.

mod blend;
mod conductor;
mod dielectric;
mod diffuse;
mod disney;
mod ior;
mod mask;
mod nested;
mod perturbed;
mod phong;
mod plastic;
mod principled;
mod roughness;
mod specular;
mod twosided;

use super::builder::Builder;
use super::error::LoadError;
use super::xml::Object;
use crate::math::Rgb;
use crate::scene::{Material, Texture};

type Constructor = for<'a> fn(&mut Builder<'a>, &'a Object) -> Result<Material, LoadError>;

/// The BSDFs.
const PLUGINS: [(&str, Constructor); 23] = [
    ("blendbsdf", blend::blend),
    ("bumpmap", perturbed::bump_map),
    ("conductor", conductor::smooth),
    ("dielectric", dielectric::smooth),
    ("diffuse", diffuse::diffuse),
    ("disneybsdf", disney::bsdf),
    ("disneyclearcoat", disney::clearcoat),
    ("disneydiffuse", disney::diffuse),
    ("disneyglass", disney::glass),
    ("disneymetal", disney::metal),
    ("disneysheen", disney::sheen),
    ("mask", mask::mask),
    ("mixturebsdf", blend::mixture),
    ("normalmap", perturbed::normal_map),
    ("phong", phong::phong),
    ("plastic", plastic::smooth),
    ("principled", principled::solid),
    ("principledthin", principled::thin),
    ("roughconductor", conductor::rough),
    ("roughdielectric", dielectric::rough),
    ("roughplastic", plastic::rough),
    ("thindielectric", dielectric::thin),
    ("twosided", twosided::twosided),
];

/// The material of the BSDF at `index`, as an index of [`Builder::materials`]. As in Mitsuba,
/// nested BSDFs are built first.
pub fn material(builder: &mut Builder, index: usize) -> Result<u32, LoadError> {
    if let Some(&material) = builder.material_of.get(&index) {
        return Ok(material);
    }
    let object = builder.object(index);
    let constructor = object.find_plugin(&PLUGINS)?;
    for nested in builder.nested_bsdfs(object) {
        material(builder, nested)?;
    }
    let material = constructor(builder, object)?;
    builder.finish(object)?;
    let material = builder.add_material(material);
    builder.material_of.insert(index, material);
    Ok(material)
}

/// Mitsuba's material for a shape without a BSDF: grey, or black if the shape emits.
pub fn default_material(builder: &mut Builder, emits: bool) -> u32 {
    let albedo = if emits { 0.0 } else { 0.5 };
    let reflectance = builder.add_texture(Texture::Constant(Rgb::splat(albedo)));
    builder.add_material(Material::Diffuse { reflectance })
}
