//! `integrator`: the limits of path length, and whether emitters are seen. The light transport algorithm
//! itself is chosen by the user, not by the scene.

use super::builder::Builder;
use super::error::{LoadError, Located};
use super::xml::{Object, Tag};
use crate::scene::DepthLimits;

/// Mitsuba's defaults.
const DEFAULT_DEPTH_LIMITS: DepthLimits = DepthLimits {
    max_depth: None,
    rr_depth: 5,
};

/// Integrators of Mitsuba that Metrolight has too, under the same names.
const KNOWN: [&str; 4] = ["path", "light", "bdpt", "pssmlt"];

/// Integrators that show emitters and direct light alone: paths of at most two edges.
const DIRECT: [&str; 2] = ["direct", "direct_projective"];

/// What an integrator sets.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// The limits of path length.
    pub depth: DepthLimits,
    /// Whether the camera does not see emitters directly.
    pub hide_emitters: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            depth: DEFAULT_DEPTH_LIMITS,
            hide_emitters: false,
        }
    }
}

/// The settings of the integrator at `index`.
pub fn settings(builder: &mut Builder, index: usize) -> Result<Settings, LoadError> {
    let object = builder.object(index);
    let settings = own(object)?;
    object.ignore(&["samples_per_pass", "block_size", "timeout"]);
    // Such as the integrator inside an `aov` integrator.
    let nested = builder.child(object, Tag::Integrator)?;
    builder.ignore_rest(object);
    let plugin = object.plugin.as_str();
    if !KNOWN.contains(&plugin) && nested.is_none() {
        builder.warnings.push(object.warning(format!(
            "the scene asks for the integrator `{plugin}`: of its parameters only `max_depth`, \
             `rr_depth` and `hide_emitters` are used, and the method is that of --integrator"
        )));
    }
    match nested {
        Some(nested) if object.find("max_depth").is_none() => self::settings(builder, nested),
        _ => Ok(settings),
    }
}

fn own(object: &Object) -> Result<Settings, LoadError> {
    let max = i64::from(u32::MAX);
    let max_depth: Option<i64> =
        object.integer_in("max_depth", -1..=max, "-1 (no limit) or at least 0")?;
    let rr_depth = object.integer_in("rr_depth", 1..=max, "at least 1")?;
    let is_direct = DIRECT.contains(&object.plugin.as_str());
    let max_depth = max_depth.or(is_direct.then_some(2));
    Ok(Settings {
        depth: DepthLimits {
            max_depth: max_depth.and_then(|depth| u32::try_from(depth).ok()),
            rr_depth: rr_depth.unwrap_or(DEFAULT_DEPTH_LIMITS.rr_depth),
        },
        hide_emitters: object.boolean("hide_emitters", false)?,
    })
}
