//! `film`: size of the image and reconstruction filter.

use super::builder::Builder;
use super::error::{Cause, LoadError, Located};
use super::xml::{Object, Tag};
use crate::film::Filter;
use crate::scene::FilmSettings;

/// Mitsuba's default size.
const DEFAULT_SIZE: [u32; 2] = [768, 576];
/// Maximum number of pixels. Sums in f64 for more do not fit into the memory of a workstation.
const MAX_PIXELS: u64 = 1 << 28;
/// Mitsuba's default filter.
const DEFAULT_FILTER: Filter = Filter::Gaussian { stddev: 0.5 };
/// Maximum width of a filter in pixels. The cost of a sample grows with its square.
const MAX_FILTER_WIDTH: f64 = 64.0;

type Constructor = fn(&Object) -> Result<Filter, LoadError>;

/// The reconstruction filters.
const FILTERS: [(&str, Constructor); 3] = [
    ("box", |_| Ok(Filter::Box)),
    ("gaussian", |object| {
        let stddev = filter_width(object, "stddev", 0.5)?;
        Ok(Filter::Gaussian { stddev })
    }),
    ("tent", |object| {
        let radius = filter_width(object, "radius", 1.0)?;
        Ok(Filter::Tent { radius })
    }),
];

/// The film at `index`, or Mitsuba's default film if there is none.
pub fn film(builder: &Builder, index: Option<usize>) -> Result<FilmSettings, LoadError> {
    let Some(index) = index else {
        let [width, height] = builder.overrides.size.unwrap_or(DEFAULT_SIZE);
        return Ok(FilmSettings {
            width,
            height,
            filter: DEFAULT_FILTER,
        });
    };
    let object = builder.object(index);
    object.find_plugin(&[("hdrfilm", ())])?;
    let size = size(object)?;
    object.must_be_false("sample_border", "all samples lie inside the film")?;
    object.ignore(&["file_format", "pixel_format", "component_format"]);
    object.ignore(&["banner", "attach_log", "compensate"]);
    let filter = match builder.child(object, Tag::Rfilter)? {
        Some(index) => filter(builder, builder.object(index))?,
        None => DEFAULT_FILTER,
    };
    builder.finish(object)?;
    let [width, height] = builder.overrides.size.unwrap_or(size);
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > MAX_PIXELS {
        return Err(object.error(Cause::OutOfRange {
            name: "size".into(),
            found: format!("{width} x {height}"),
            range: format!("between 1 and {MAX_PIXELS} pixels"),
        }));
    }
    Ok(FilmSettings {
        width,
        height,
        filter,
    })
}

/// Width and height in pixels. The crop window must be the whole film.
fn size(object: &Object) -> Result<[u32; 2], LoadError> {
    let [mut width, mut height] = DEFAULT_SIZE;
    for (name, target) in [("width", &mut width), ("height", &mut height)] {
        let given = object.integer_in(name, 1..=i64::from(u32::MAX), "at least 1")?;
        *target = given.unwrap_or(*target);
    }
    for (name, whole) in [
        ("crop_width", width),
        ("crop_height", height),
        ("crop_offset_x", 0),
        ("crop_offset_y", 0),
    ] {
        if let Some((value, property)) = object.integer(name)?
            && value != i64::from(whole)
        {
            let feature = "a crop window that is only a part of the film";
            return Err(property.not_modelled(feature));
        }
    }
    Ok([width, height])
}

fn filter(builder: &Builder, object: &Object) -> Result<Filter, LoadError> {
    let filter = object.find_plugin(&FILTERS)?(object)?;
    builder.finish(object)?;
    Ok(filter)
}

/// In pixels.
fn filter_width(object: &Object, name: &str, default: f64) -> Result<f32, LoadError> {
    let range = format!("above 0 and at most {MAX_FILTER_WIDTH} pixels");
    let is_valid = |x: f64| x > 0.0 && x <= MAX_FILTER_WIDTH;
    let width = object.float_in(name, default, &range, is_valid)?;
    Ok(width as f32)
}
