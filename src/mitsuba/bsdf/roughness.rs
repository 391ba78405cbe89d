//! Parameters of microfacet distributions.

use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::xml::Object;
use crate::scene::bsdf::MicrofacetDistribution;

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

/// The roughness `alpha`.
pub fn roughness(object: &Object) -> Result<f32, LoadError> {
    let range = format!("between 0 and {MAX_ALPHA}");
    let get = |name| object.float_in(name, 0.1, &range, |x| (0.0..=MAX_ALPHA).contains(&x));
    let alpha = match (object.find("alpha_u"), object.find("alpha_v")) {
        (None, None) => get("alpha")?,
        (Some(_), Some(property)) => {
            if let Some(alpha) = object.find("alpha") {
                return Err(alpha.conflict("give either `alpha` or `alpha_u` and `alpha_v`"));
            }
            if get("alpha_u")? != get("alpha_v")? {
                let feature = "anisotropic roughness; `alpha_u` and `alpha_v` must be equal";
                return Err(property.not_modelled(feature));
            }
            get("alpha_u")?
        }
        _ => return Err(object.missing("both of `alpha_u` and `alpha_v`, or `alpha`")),
    };
    Ok(alpha.max(MIN_ALPHA) as f32)
}
