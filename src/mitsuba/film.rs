//! `film`: size of the image and reconstruction filter.

use super::Overrides;
use super::error::{Cause, LoadError};
use super::object::{Object, Tag};
use super::tree::Tree;
use crate::film::Filter;
use crate::scene::FilmSettings;

/// Mitsuba's default size.
const DEFAULT_SIZE: [u32; 2] = [768, 576];
/// Most pixels: sums in f64 for more do not fit into any memory of today's workstations.
const MOST_PIXELS: u64 = 1 << 28;
/// Mitsuba's default filter.
const DEFAULT_FILTER: Filter = Filter::Gaussian { stddev: 0.5 };
/// A filter as wide as the image has no use, and takes forever.
const WIDEST_FILTER: f64 = 64.0;

/// The film at `index`, or Mitsuba's default film if there is none.
pub fn film(
    tree: &Tree,
    index: Option<usize>,
    overrides: Overrides,
) -> Result<FilmSettings, LoadError> {
    let Some(index) = index else {
        let [width, height] = overrides.size.unwrap_or(DEFAULT_SIZE);
        return Ok(FilmSettings {
            width,
            height,
            filter: DEFAULT_FILTER,
        });
    };
    let object = &tree.objects[index];
    if object.plugin != "hdrfilm" {
        return Err(object.unknown_plugin(&["hdrfilm"]));
    }
    let width = dimension(object, "width", DEFAULT_SIZE[0])?;
    let height = dimension(object, "height", DEFAULT_SIZE[1])?;
    for (name, whole) in [
        ("crop_width", width),
        ("crop_height", height),
        ("crop_offset_x", 0),
        ("crop_offset_y", 0),
    ] {
        let value = object.integer(name)?.unwrap_or(whole.into());
        if value != i64::from(whole)
            && let Some(property) = object.find(name)
        {
            let what = "a part of the film; leave the crop window out";
            return Err(property.error(Cause::NotModelled(what.into())));
        }
    }
    if object.boolean("sample_border", false)?
        && let Some(property) = object.find("sample_border")
    {
        let what = "`sample_border`: all samples lie inside the film";
        return Err(property.error(Cause::NotModelled(what.into())));
    }
    object.ignore(&["file_format", "pixel_format", "component_format"]);
    object.ignore(&["banner", "attach_log", "compensate"]);
    let filter = match object.child(&tree.objects, Tag::Rfilter)? {
        Some(index) => filter(tree, &tree.objects[index])?,
        None => DEFAULT_FILTER,
    };
    object.finish(&tree.objects)?;
    let [width, height] = overrides.size.unwrap_or([width, height]);
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > MOST_PIXELS {
        return Err(object.error(Cause::OutOfRange {
            name: "size".into(),
            found: format!("{width} x {height}"),
            range: format!("between 1 and {MOST_PIXELS} pixels"),
        }));
    }
    Ok(FilmSettings {
        width,
        height,
        filter,
    })
}

fn dimension(object: &Object, name: &str, default: u32) -> Result<u32, LoadError> {
    let (Some(value), Some(property)) = (object.integer(name)?, object.find(name)) else {
        return Ok(default);
    };
    let positive = u32::try_from(value).ok().filter(|&value| value > 0);
    positive.ok_or_else(|| property.out_of_range(value, "at least 1"))
}

fn filter(tree: &Tree, object: &Object) -> Result<Filter, LoadError> {
    let length = |name, default| {
        let range = format!("above 0 and at most {WIDEST_FILTER} pixels");
        let is_valid = |x: f64| x > 0.0 && x <= WIDEST_FILTER;
        let length = object.float_in(name, default, &range, is_valid)?;
        Ok(length as f32)
    };
    let filter = match object.plugin.as_str() {
        "box" => Filter::Box,
        "tent" => Filter::Tent {
            radius: length("radius", 1.0)?,
        },
        "gaussian" => Filter::Gaussian {
            stddev: length("stddev", 0.5)?,
        },
        _ => return Err(object.unknown_plugin(&["box", "gaussian", "tent"])),
    };
    object.finish(&tree.objects)?;
    Ok(filter)
}
