//! `<spectrum>` and its relatives `<srgb>` and `<blackbody>`: values by wavelength, written inline, read
//! from a file, or given by a type and its parameters.

use std::path::Path;

use glam::DVec3;

use super::attributes::Attributes;
use super::object::Object;
use super::property::{Spectrum, Value};
use super::value;
use super::within::Within;
use crate::mitsuba::cie;
use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::file::regular_file_size;

/// Largest file with a spectrum, in bytes.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// Radiation constants of Planck's law for spectral radiance, 2 h c^2 in W m^2 / sr and h c / k in m K (exact
/// values of h, c and k: SI Brochure, 9th edition, 2019).
const FIRST_RADIATION: f64 = 1.191_042_972_397_188e-16;
const SECOND_RADIATION: f64 = 1.438_776_877_503_933e-2;

/// Distance of the wavelengths at which a black body is sampled, in nanometres.
const BLACK_BODY_STEP: f64 = 1.0;

/// A `<spectrum>` without a type: one value for all wavelengths, pairs `wavelength:value`, or a file of such
/// pairs. Three values without wavelengths are a linear RGB colour, as in version 0.x.
pub fn spectrum(attributes: &mut Attributes, within: &Within) -> Result<Value, LoadError> {
    ignore_intent(attributes);
    if let Some((name, place)) = attributes.text_optional("filename") {
        let path = within.search_path.locate(&name, &place);
        let samples = read(&path).map_err(|cause| place.error(cause))?;
        return Ok(Value::Spectrum(Spectrum::Samples(samples)));
    }
    let (text, place) = attributes.text("value")?;
    let tokens = value::tokens(&text);
    let parsed = if text.contains(':') {
        pairs(&tokens).map(|samples| Value::Spectrum(Spectrum::Samples(samples)))
    } else if tokens.len() == 3 && within.file.legacy {
        value::triple(&text).map(Value::Rgb)
    } else if tokens.len() > 1 {
        let expected = "one value, or pairs `wavelength:value`; for a colour give <rgb>";
        Err(value::malformed(&text, expected))
    } else {
        value::float(&text).map(|x| Value::Spectrum(Spectrum::Uniform(x)))
    };
    parsed.map_err(|cause| place.error(cause))
}

/// `<srgb>` of version 0.x: `#rrggbb`, or one or three numbers, encoded in sRGB.
pub fn srgb(attributes: &mut Attributes, _: &Within) -> Result<Value, LoadError> {
    ignore_intent(attributes);
    let encoded = attributes.parse("value", |text| match text.trim().strip_prefix('#') {
        Some(digits) => hexadecimal(digits).ok_or_else(|| {
            value::malformed(text, "a colour such as `#f9aa34`, or one or three numbers")
        }),
        None => value::one_or_three(text),
    })?;
    Ok(Value::Rgb(encoded.map(srgb_to_linear)))
}

/// `<blackbody>` of version 0.x: a temperature in kelvin, with or without its unit, and a scale.
pub fn blackbody(attributes: &mut Attributes, _: &Within) -> Result<Value, LoadError> {
    let temperature = attributes.parse("temperature", |text| {
        let number = text.trim().trim_end_matches(['K', 'k']);
        kelvin(value::float(number)?).map_err(|_| value::malformed(text, "a temperature above 0 K"))
    })?;
    let scale = attributes.parse_optional("scale", value::float)?;
    let scale = scale.or(attributes.parse_optional("multiplier", value::float)?);
    let samples = planck(temperature, cie::RANGE, scale.unwrap_or(1.0));
    Ok(Value::Spectrum(Spectrum::Samples(samples)))
}

/// A `<spectrum>` with the type and the parameters of `object`.
pub fn of_object(object: &Object) -> Result<Value, LoadError> {
    type Constructor = fn(&Object) -> Result<Value, LoadError>;
    const PLUGINS: [(&str, Constructor); 5] = [
        ("blackbody", |object| {
            let given = object.float_in("temperature", 0.0, "above 0 K", |t| t > 0.0)?;
            if given == 0.0 {
                return Err(object.missing("the float `temperature`"));
            }
            let samples = planck(given, wavelength_range(object)?, 1.0);
            Ok(Value::Spectrum(Spectrum::Samples(samples)))
        }),
        ("d65", |object| {
            // The white of sRGB.
            let scale = object.float_in("scale", 1.0, "0 or above", |x| x >= 0.0)?;
            Ok(Value::Rgb(DVec3::splat(scale)))
        }),
        ("irregular", |object| {
            let wavelengths = numbers(object, "wavelengths")?;
            let values = numbers(object, "values")?;
            if wavelengths.len() != values.len() {
                return Err(object.conflict(format!(
                    "{} `wavelengths` but {} `values`",
                    wavelengths.len(),
                    values.len()
                )));
            }
            samples(object, wavelengths.into_iter().zip(values))
        }),
        ("regular", |object| {
            let values = numbers(object, "values")?;
            let [first, last] = wavelength_range(object)?;
            let step = (last - first) / (values.len().max(2) - 1) as f64;
            let pairs = (0..).zip(values);
            samples(
                object,
                pairs.map(|(i, value)| (first + step * f64::from(i), value)),
            )
        }),
        ("uniform", |object| {
            let value = object.float_in("value", 1.0, "0 or above", |x| x >= 0.0)?;
            Ok(Value::Spectrum(Spectrum::Uniform(value)))
        }),
    ];
    object.find_plugin(&PLUGINS)?(object)
}

/// The purpose of a colour in version 0.6, which matters to spectral rendering alone.
fn ignore_intent(attributes: &mut Attributes) {
    attributes.text_optional("intent");
}

fn pairs(tokens: &[&str]) -> Result<Vec<[f64; 2]>, Cause> {
    let pair = |token: &&str| match token.split_once(':') {
        Some((wavelength, value)) => Ok([value::float(wavelength)?, value::float(value)?]),
        None => Err(value::malformed(token, "a pair `wavelength:value`")),
    };
    checked(tokens.iter().map(pair).collect::<Result<_, _>>()?)
}

/// The pairs in a file: a wavelength and a value in each line, with comments after `#`.
fn read(path: &Path) -> Result<Vec<[f64; 2]>, Cause> {
    let unreadable = |error| Cause::Unreadable {
        path: path.to_owned(),
        error,
    };
    let bytes = regular_file_size(path).map_err(unreadable)?;
    if bytes > MAX_FILE_BYTES {
        return Err(Cause::FileTooLarge {
            path: path.to_owned(),
            bytes,
            limit: MAX_FILE_BYTES,
        });
    }
    let bytes = std::fs::read(path).map_err(unreadable)?;
    let text = String::from_utf8_lossy(&bytes);
    let invalid = |line: usize, problem: String| Cause::SpectrumFile {
        path: path.to_owned(),
        line,
        problem,
    };
    let mut samples: Vec<[f64; 2]> = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.split('#').next().unwrap_or("");
        let numbers = value::floats(content).map_err(|cause| invalid(line, cause.to_string()))?;
        match numbers[..] {
            [] => {}
            [wavelength, value] => samples.push([wavelength, value]),
            _ => return Err(invalid(line, "not a wavelength and a value".into())),
        }
    }
    let lines = text.lines().count();
    checked(samples).map_err(|cause| invalid(lines.max(1), cause.to_string()))
}

fn numbers(object: &Object, name: &str) -> Result<Vec<f64>, LoadError> {
    match object.text(name)? {
        Some((text, property)) => value::floats(text).map_err(|cause| property.error(cause)),
        None => Err(object.missing(&format!("the string `{name}`"))),
    }
}

fn samples(object: &Object, pairs: impl Iterator<Item = (f64, f64)>) -> Result<Value, LoadError> {
    let pairs = pairs.map(|(wavelength, value)| [wavelength, value]);
    let samples = checked(pairs.collect()).map_err(|cause| object.error(cause))?;
    Ok(Value::Spectrum(Spectrum::Samples(samples)))
}

/// `samples`, if there are two or more, with increasing wavelengths and no negative value.
fn checked(samples: Vec<[f64; 2]>) -> Result<Vec<[f64; 2]>, Cause> {
    if samples.len() < 2 {
        return Err(value::malformed("a single sample", "two or more"));
    }
    if let Some(pair) = samples.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let wavelength = pair[1][0].to_string();
        return Err(value::malformed(
            &wavelength,
            "a wavelength above the one before",
        ));
    }
    match samples.iter().find(|[_, value]| *value < 0.0) {
        Some([_, negative]) => Err(value::malformed(
            &negative.to_string(),
            "a value of 0 or above",
        )),
        None => Ok(samples),
    }
}

/// `wavelength_min` and `wavelength_max`, by default those of the colour matching functions.
fn wavelength_range(object: &Object) -> Result<[f64; 2], LoadError> {
    let [first, last] = cie::RANGE;
    let min = object.float_in("wavelength_min", first, "above 0 nm", |x| x > 0.0)?;
    let above = "above `wavelength_min`";
    let max = object.float_in("wavelength_max", last, above, |x| x > min)?;
    Ok([min, max])
}

fn kelvin(temperature: f64) -> Result<f64, ()> {
    (temperature > 0.0).then_some(temperature).ok_or(())
}

/// The radiance of a black body, W/(m^2 sr nm), by Planck's law, times `scale`. `temperature` is in kelvin,
/// `range` in nanometres.
fn planck(temperature: f64, [first, last]: [f64; 2], scale: f64) -> Vec<[f64; 2]> {
    let [seen_first, seen_last] = cie::RANGE;
    let first = first.max(seen_first);
    let steps = ((last.min(seen_last) - first) / BLACK_BODY_STEP)
        .floor()
        .max(1.0) as u32;
    let radiance = |nanometres: f64| {
        let wavelength = nanometres * 1e-9;
        let exponent = SECOND_RADIATION / (wavelength * temperature);
        1e-9 * FIRST_RADIATION / (wavelength.powi(5) * exponent.exp_m1())
    };
    (0..=steps)
        .map(|i| first + f64::from(i) * BLACK_BODY_STEP)
        .map(|nanometres| [nanometres, scale * radiance(nanometres)])
        .collect()
}

/// The three bytes of six hexadecimal digits, from 0 to 1.
fn hexadecimal(digits: &str) -> Option<DVec3> {
    let is_right = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let number = is_right
        .then(|| u32::from_str_radix(digits, 16).ok())
        .flatten()?;
    let [_, r, g, b] = number.to_be_bytes().map(f64::from);
    Some(DVec3::new(r, g, b) / 255.0)
}

/// IEC 61966-2-1.
fn srgb_to_linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}
