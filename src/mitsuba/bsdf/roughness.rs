//! Parameters of microfacet distributions.

use crate::math::Rgb;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::texture::{Range, texture};
use crate::mitsuba::xml::{Object, Value};
use crate::scene::Texture;
use crate::scene::bsdf::{MicrofacetDistribution, Roughness};

/// Minimum roughness. Mitsuba replaces lower values by it.
const MIN_ALPHA: f64 = 1e-4;
/// Maximum roughness, far above that of any real surface.
const MAX_ALPHA: f64 = 10.0;

/// The type of the microfacet distribution.
pub fn distribution(object: &Object) -> Result<MicrofacetDistribution, LoadError> {
    let choices = [
        ("beckmann", MicrofacetDistribution::Beckmann),
        ("ggx", MicrofacetDistribution::Ggx),
    ];
    // Which normals are sampled does not change what is estimated.
    object.ignore(&["sample_visible"]);
    object.choice("distribution", MicrofacetDistribution::Beckmann, &choices)
}

/// The roughness, if the distribution is that of Ashikhmin and Shirley, which Mitsuba 0.6 calls `as` or `phong`.
pub fn ashikhmin_shirley_roughness(
    builder: &mut Builder,
    object: &Object,
) -> Result<Option<f32>, LoadError> {
    let Some((name, property)) = object.text("distribution")? else {
        return Ok(None);
    };
    if !["as", "phong"]
        .iter()
        .any(|known| known.eq_ignore_ascii_case(name))
    {
        return Ok(None);
    }
    object.ignore(&["sample_visible"]);
    match roughness(builder, object)? {
        Roughness::Constant(alpha) if alpha <= 1.0 => Ok(Some(alpha)),
        Roughness::Constant(alpha) => {
            let limit =
                format!("the distribution `{name}` needs a roughness of at most 1, not {alpha}");
            Err(property.conflict(limit))
        }
        Roughness::Textured { .. } => {
            let feature = format!("textured or anisotropic roughness of the distribution `{name}`");
            Err(property.not_modelled(&feature))
        }
    }
}

/// The roughness `alpha`, one number.
pub fn constant_roughness(object: &Object) -> Result<f32, LoadError> {
    alpha(object, "alpha")
}

/// The roughness `alpha`, or `alpha_u` and `alpha_v`: numbers or textures.
pub fn roughness(builder: &mut Builder, object: &Object) -> Result<Roughness, LoadError> {
    let is_textured = |name| {
        let property = object.find(name);
        property.is_some_and(|property| matches!(property.value, Value::Object(_)))
    };
    let along_u = object.find("alpha_u").is_some();
    let along_v = object.find("alpha_v").is_some();
    if !along_u && !along_v {
        if !is_textured("alpha") {
            return Ok(Roughness::Constant(alpha(object, "alpha")?));
        }
        let texture = textured_alpha(builder, object, "alpha")?;
        return Ok(Roughness::Textured {
            along_u: texture,
            along_v: texture,
        });
    }
    if let Some(alpha) = object.find("alpha") {
        return Err(alpha.conflict("give either `alpha` or `alpha_u` and `alpha_v`"));
    }
    if !(along_u && along_v) {
        return Err(object.missing("both of `alpha_u` and `alpha_v`, or `alpha`"));
    }
    if !is_textured("alpha_u") && !is_textured("alpha_v") {
        let along_u = alpha(object, "alpha_u")?;
        if along_u == alpha(object, "alpha_v")? {
            return Ok(Roughness::Constant(along_u));
        }
    }
    Ok(Roughness::Textured {
        along_u: textured_alpha(builder, object, "alpha_u")?,
        along_v: textured_alpha(builder, object, "alpha_v")?,
    })
}

fn alpha(object: &Object, name: &str) -> Result<f32, LoadError> {
    let range = format!("between 0 and {MAX_ALPHA}");
    let alpha = object.float_in(name, 0.1, &range, |x| (0.0..=MAX_ALPHA).contains(&x))?;
    Ok(alpha.max(MIN_ALPHA) as f32)
}

/// A number or a texture, as an index of [`Builder::textures`].
fn textured_alpha(builder: &mut Builder, object: &Object, name: &str) -> Result<u32, LoadError> {
    if let Some(property) = object.find(name)
        && let Value::Object(index) = property.value
    {
        return texture(builder, index, Range::UnitInterval);
    }
    let alpha = alpha(object, name)?;
    Ok(builder.add_texture(Texture::Constant(Rgb::splat(alpha))))
}
