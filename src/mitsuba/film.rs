//! `film`: size of the image and reconstruction filter.

use super::builder::Builder;
use super::error::{Cause, LoadError, Located};
use super::xml::{Object, Tag};
use crate::film::{Crop, Filter};
use crate::scene::FilmSettings;

/// Mitsuba's default size.
const DEFAULT_SIZE: [u32; 2] = [768, 576];
/// Maximum number of pixels. Sums in f64 for more do not fit into the memory of a workstation.
pub const MAX_PIXELS: u64 = 1 << 28;
/// Mitsuba's default filter.
const DEFAULT_FILTER: Filter = Filter::Gaussian { stddev: 0.5 };
/// Maximum width of a filter in pixels. The cost of a sample grows with its square.
const MAX_FILTER_WIDTH: f64 = 64.0;

/// The parameters of the crop window.
const CROP: [&str; 4] = [
    "crop_offset_x",
    "crop_offset_y",
    "crop_width",
    "crop_height",
];

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

/// The films. What distinguishes them is the file that they write, which is the user's choice here.
const FILMS: [(&str, ()); 5] = [
    ("hdrfilm", ()),
    ("ldrfilm", ()),
    ("mfilm", ()),
    ("specfilm", ()),
    ("tiledhdrfilm", ()),
];

/// The film of a sensor: that at `index`, or Mitsuba's default film if there is none. `outside` is a filter
/// that is nested in the sensor and not in its film, as some exporters write it.
pub fn film(
    builder: &mut Builder,
    index: Option<usize>,
    outside: Option<usize>,
) -> Result<FilmSettings, LoadError> {
    let default_filter = match outside {
        Some(index) => {
            let object = builder.object(index);
            let advice = "a filter belongs in the film; this one is used as if it were there";
            builder.warnings.push(object.warning(advice));
            filter(builder, object)?
        }
        None => DEFAULT_FILTER,
    };
    let Some(index) = index else {
        let [width, height] = builder.overrides.size.unwrap_or(DEFAULT_SIZE);
        return Ok(FilmSettings {
            width,
            height,
            filter: default_filter,
            crop: None,
        });
    };
    let object = builder.object(index);
    object.find_plugin(&FILMS)?;
    let size = size(object)?;
    let crop = match builder.overrides.size {
        None => crop(object, size)?,
        Some(_) => {
            // Its numbers are pixels of the size in the file.
            object.ignore(&CROP);
            None
        }
    };
    object.must_be_false("sample_border", "all samples lie inside the film")?;
    object.ignore(&["file_format", "pixel_format", "component_format"]);
    object.ignore(&["banner", "attach_log", "compensate", "filename"]);
    // Filters always extend beyond the border of the image: `high_quality_edges` is about blocks of it.
    object.ignore(&["high_quality_edges"]);
    let filter = match builder.child(object, Tag::Rfilter)? {
        Some(index) => filter(builder, builder.object(index))?,
        None => default_filter,
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
        crop,
    })
}

/// Width and height in pixels.
fn size(object: &Object) -> Result<[u32; 2], LoadError> {
    let [mut width, mut height] = DEFAULT_SIZE;
    for (name, target) in [("width", &mut width), ("height", &mut height)] {
        let given = object.integer_in(name, 1..=i64::from(u32::MAX), "at least 1")?;
        *target = given.unwrap_or(*target);
    }
    Ok([width, height])
}

/// The crop window; `None` if it is the whole film.
fn crop(object: &Object, size: [u32; 2]) -> Result<Option<Crop>, LoadError> {
    let mut crop = Crop {
        offset: [0; 2],
        size: size.map(|pixels| pixels as usize),
    };
    for (axis, whole) in size.into_iter().enumerate() {
        let last = i64::from(whole) - 1;
        let range = format!("at least 0 and below {whole}, the size of the film");
        let offset: Option<usize> = object.integer_in(CROP[axis], 0..=last, &range)?;
        let offset = offset.unwrap_or(0);
        let rest = whole as usize - offset;
        let range = format!("at least 1 and at most {rest}, what the film has from the offset on");
        let given = object.integer_in(CROP[2 + axis], 1..=rest as i64, &range)?;
        crop.offset[axis] = offset;
        crop.size[axis] = given.unwrap_or(rest);
    }
    let is_whole = crop.size == size.map(|pixels| pixels as usize);
    Ok((!is_whole).then_some(crop))
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
