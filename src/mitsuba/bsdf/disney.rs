//! Disney's model as the renderer lajolla has it: `disneybsdf`, and its lobes `disneydiffuse`, `disneymetal`,
//! `disneyglass`, `disneyclearcoat` and `disneysheen`. The defaults are those of lajolla.

use crate::math::Rgb;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::texture::reflectance;
use crate::mitsuba::xml::Object;
use crate::scene::bsdf::{DisneyLobes, DisneySum};
use crate::scene::{Material, Texture};

/// Range of the index of refraction. At 1 glass does not refract, and its microfacets have no lobe.
const ETA: [f64; 2] = [1.001, 2.0];

type Loaded = Result<Material, LoadError>;

/// The whole model.
pub fn bsdf(builder: &mut Builder, object: &Object) -> Loaded {
    let specular_transmission = reflectance(builder, object, "specular_transmission", 0.0)?;
    let transmits = builder.textures[specular_transmission as usize].max() != Rgb::ZERO;
    let mut weight = |name: &str, default| reflectance(builder, object, name, default);
    Ok(Material::DisneySum(DisneySum {
        lobes: DisneyLobes::All,
        base_color: weight("base_color", 0.5)?,
        roughness: weight("roughness", 0.5)?,
        anisotropic: weight("anisotropic", 0.0)?,
        metallic: weight("metallic", 0.0)?,
        specular_transmission,
        specular: weight("specular", 0.5)?,
        specular_tint: weight("specular_tint", 0.0)?,
        subsurface: weight("subsurface", 0.0)?,
        sheen: weight("sheen", 0.0)?,
        sheen_tint: weight("sheen_tint", 0.5)?,
        clearcoat: weight("clearcoat", 0.0)?,
        clearcoat_gloss: weight("clearcoat_gloss", 1.0)?,
        eta: eta(object)?,
        transmits,
    }))
}

/// The diffuse lobe.
pub fn diffuse(builder: &mut Builder, object: &Object) -> Loaded {
    Ok(Material::DisneySum(DisneySum {
        base_color: reflectance(builder, object, "base_color", 0.5)?,
        roughness: reflectance(builder, object, "roughness", 0.5)?,
        subsurface: reflectance(builder, object, "subsurface", 0.0)?,
        ..black(builder, DisneyLobes::Diffuse)
    }))
}

/// The whole model of a metal is its metallic lobe.
pub fn metal(builder: &mut Builder, object: &Object) -> Loaded {
    Ok(Material::DisneySum(DisneySum {
        base_color: reflectance(builder, object, "base_color", 0.5)?,
        roughness: reflectance(builder, object, "roughness", 0.5)?,
        anisotropic: reflectance(builder, object, "anisotropic", 0.0)?,
        metallic: builder.add_texture(Texture::Constant(Rgb::ONE)),
        ..black(builder, DisneyLobes::All)
    }))
}

/// The whole model of a dielectric that transmits all light is glass.
pub fn glass(builder: &mut Builder, object: &Object) -> Loaded {
    Ok(Material::DisneySum(DisneySum {
        base_color: reflectance(builder, object, "base_color", 0.5)?,
        roughness: reflectance(builder, object, "roughness", 0.5)?,
        anisotropic: reflectance(builder, object, "anisotropic", 0.0)?,
        specular_transmission: builder.add_texture(Texture::Constant(Rgb::ONE)),
        eta: eta(object)?,
        transmits: true,
        ..black(builder, DisneyLobes::All)
    }))
}

/// The clearcoat.
pub fn clearcoat(builder: &mut Builder, object: &Object) -> Loaded {
    Ok(Material::DisneySum(DisneySum {
        clearcoat_gloss: reflectance(builder, object, "clearcoat_gloss", 1.0)?,
        ..black(builder, DisneyLobes::Clearcoat)
    }))
}

/// Sheen.
pub fn sheen(builder: &mut Builder, object: &Object) -> Loaded {
    Ok(Material::DisneySum(DisneySum {
        base_color: reflectance(builder, object, "base_color", 0.5)?,
        sheen_tint: reflectance(builder, object, "sheen_tint", 0.5)?,
        ..black(builder, DisneyLobes::Sheen)
    }))
}

/// The model with all parameters 0 and the default index of refraction.
fn black(builder: &mut Builder, lobes: DisneyLobes) -> DisneySum {
    let black = builder.add_texture(Texture::Constant(Rgb::ZERO));
    DisneySum {
        lobes,
        base_color: black,
        roughness: black,
        anisotropic: black,
        metallic: black,
        specular_transmission: black,
        specular: black,
        specular_tint: black,
        subsurface: black,
        sheen: black,
        sheen_tint: black,
        clearcoat: black,
        clearcoat_gloss: black,
        eta: 1.5,
        transmits: false,
    }
}

fn eta(object: &Object) -> Result<f32, LoadError> {
    let [min, max] = ETA;
    let range = format!("between {min} and {max}");
    let is_valid = |x: f64| (min..=max).contains(&x);
    Ok(object.float_in("eta", 1.5, &range, is_valid)? as f32)
}
