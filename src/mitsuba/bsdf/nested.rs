//! BSDFs nested in others.

use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::xml::Object;
use crate::scene::Material;

/// The only material nested in `object`.
pub fn only(builder: &Builder, object: &Object) -> Result<Material, LoadError> {
    let [material] = exactly(builder, object, "one nested material")?;
    Ok(material)
}

/// The N materials nested in `object`; `what` describes them.
pub fn exactly<const N: usize>(
    builder: &Builder,
    object: &Object,
    what: &str,
) -> Result<[Material; N], LoadError> {
    let nested = builder.nested_materials(object);
    if let Some((_, property)) = nested.get(N) {
        let title = object.title();
        return Err(property.conflict(format!("{title} takes {what}, and this is one more")));
    }
    let materials: Vec<Material> = nested.into_iter().map(|(m, _)| m.clone()).collect();
    materials.try_into().map_err(|_| object.missing(what))
}

/// As [`only`], for materials whose normals a texture perturbs. They cannot be nested in each other, as their
/// derivatives are those of the surface.
pub fn only_unperturbed(builder: &Builder, object: &Object) -> Result<Material, LoadError> {
    let material = only(builder, object)?;
    if material.perturbs_normals() {
        let feature = "a normal or bump map within another one";
        return Err(object.not_modelled(feature));
    }
    Ok(material)
}
