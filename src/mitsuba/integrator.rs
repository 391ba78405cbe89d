//! `integrator`: the limits of path length. The light transport algorithm itself is chosen by the
//! user, not by the scene.

use super::builder::Builder;
use super::error::{LoadError, Located};
use super::xml::{Object, Tag};
use crate::scene::DepthLimits;

/// Mitsuba's defaults.
pub const DEFAULT_DEPTH_LIMITS: DepthLimits = DepthLimits {
    max_depth: None,
    rr_depth: 5,
};

/// Integrators of Mitsuba that Metrolight has too, under the same names.
const KNOWN: [&str; 4] = ["path", "light", "bdpt", "pssmlt"];

/// The limits that the integrator at `index` sets.
pub fn depth_limits(builder: &mut Builder, index: usize) -> Result<DepthLimits, LoadError> {
    let object = builder.object(index);
    let limits = limits(object)?;
    object.ignore(&["samples_per_pass", "block_size", "timeout"]);
    // Such as the integrator inside an `aov` integrator.
    let nested = builder.child(object, Tag::Integrator)?;
    if KNOWN.contains(&object.plugin.as_str()) {
        builder.finish(object)?;
    } else {
        builder.warnings.push(object.warning(format!(
            "unknown integrator type `{}` (known: {}); only its parameters `max_depth` and \
             `rr_depth` are used",
            object.plugin,
            KNOWN.join(", ")
        )));
    }
    match nested {
        Some(nested) if object.find("max_depth").is_none() => depth_limits(builder, nested),
        _ => Ok(limits),
    }
}

fn limits(object: &Object) -> Result<DepthLimits, LoadError> {
    object.must_be_false("hide_emitters", "emitters are always visible")?;
    let max = i64::from(u32::MAX);
    let max_depth: Option<i64> =
        object.integer_in("max_depth", -1..=max, "-1 (no limit) or at least 0")?;
    let rr_depth = object.integer_in("rr_depth", 1..=max, "at least 1")?;
    Ok(DepthLimits {
        max_depth: max_depth.and_then(|depth| u32::try_from(depth).ok()),
        rr_depth: rr_depth.unwrap_or(DEFAULT_DEPTH_LIMITS.rr_depth),
    })
}
