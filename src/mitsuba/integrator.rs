//! `integrator`: the limits of path length. The method is the user's choice, not the scene's.

use super::error::{Cause, LoadError, Warning};
use super::object::{Object, Tag};
use super::scene::Builder;
use crate::scene::DepthLimits;

/// Mitsuba's default for `rr_depth`.
pub const DEFAULT_RR_DEPTH: u32 = 5;

/// Integrators whose name means here what it means there.
const KNOWN: [&str; 4] = ["path", "light", "bdpt", "pssmlt"];

/// The limits that the integrator at `index` sets.
pub fn depth_limits(builder: &mut Builder, index: usize) -> Result<DepthLimits, LoadError> {
    let object = builder.object(index);
    let limits = limits(object)?;
    object.ignore(&["samples_per_pass", "block_size", "timeout"]);
    // Such as the integrator that an `aov` integrator wraps.
    let nested = object.child(&builder.tree.objects, Tag::Integrator)?;
    if KNOWN.contains(&object.plugin.as_str()) {
        builder.finish(object)?;
    } else {
        let known = KNOWN.join(", ");
        builder.warnings.push(Warning {
            place: Some(object.place.clone()),
            text: format!(
                "integrator `{}` is not one of ours ({known}); of its parameters only `max_depth` \
                 and `rr_depth` count",
                object.plugin
            ),
        });
    }
    match nested {
        Some(nested) if object.find("max_depth").is_none() => depth_limits(builder, nested),
        _ => Ok(limits),
    }
}

fn limits(object: &Object) -> Result<DepthLimits, LoadError> {
    if object.boolean("hide_emitters", false)?
        && let Some(property) = object.find("hide_emitters")
    {
        let what = "`hide_emitters`: emitters are seen where they are";
        return Err(property.error(Cause::NotModelled(what.into())));
    }
    let in_range = |name: &str, range: std::ops::RangeInclusive<i64>, text: &str| {
        let (Some(value), Some(property)) = (object.integer(name)?, object.find(name)) else {
            return Ok(None);
        };
        if range.contains(&value) {
            Ok(Some(value))
        } else {
            Err(property.out_of_range(value, text))
        }
    };
    let most = i64::from(u32::MAX);
    let max_depth = in_range("max_depth", -1..=most, "-1 (no limit) or at least 0")?;
    let rr_depth = in_range("rr_depth", 1..=most, "at least 1")?;
    Ok(DepthLimits {
        max_depth: max_depth.and_then(|depth| u32::try_from(depth).ok()),
        rr_depth: rr_depth
            .and_then(|depth| u32::try_from(depth).ok())
            .unwrap_or(DEFAULT_RR_DEPTH),
    })
}
