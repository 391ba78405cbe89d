//! Spectra as linear sRGB colours, as the `rgb` variants of Mitsuba 3 convert them. Reflectances are seen
//! under D65, the white of sRGB; emission is itself the light that is seen.

use glam::{DMat3, DVec3};

use super::cie;
use super::xml::Spectrum;

/// From XYZ to linear sRGB (IEC 61966-2-1), in rows, with the digits that Mitsuba 3 uses.
const XYZ_TO_SRGB: DMat3 = DMat3::from_cols(
    DVec3::new(3.240479, -0.969256, 0.055648),
    DVec3::new(-1.537150, 1.875991, -0.204043),
    DVec3::new(-0.498535, 0.041556, 1.057311),
);

/// Number of wavelengths at which a spectrum is summed, as in Mitsuba 3.
const STEPS: usize = 1000;

/// Integrals over wavelength, in nanometres, of the colour matching function y, and of D65 times y over
/// that: with them a spectrum of ones has luminance 1. These are Mitsuba 3's.
const Y_INTEGRAL: f64 = 106.750_259_399_414_06;
const D65_MEAN: f64 = 98.997_417_518_762_55;

/// What light a spectrum is seen in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Viewing {
    /// It is light.
    Emitted,
    /// It is a fraction of light, under D65.
    UnderD65,
}

/// The colour of a spectrum. It may have negative components: colours outside the gamut of sRGB.
pub fn to_rgb(spectrum: &Spectrum, viewing: Viewing) -> DVec3 {
    let samples = match spectrum {
        // Light of equal power at all wavelengths (illuminant E) is not the white of sRGB.
        Spectrum::Uniform(value) if viewing == Viewing::Emitted => {
            return XYZ_TO_SRGB * DVec3::splat(*value);
        }
        Spectrum::Uniform(value) => return DVec3::splat(*value),
        Spectrum::Samples(samples) => samples,
    };
    let [first, last] = cie::RANGE;
    let step = |i: usize| first + (last - first) * i as f64 / (STEPS - 1) as f64;
    let xyz: DVec3 = (0..STEPS)
        .map(|i| {
            let wavelength = step(i);
            let seen_in = match viewing {
                Viewing::Emitted => 1.0,
                Viewing::UnderD65 => cie::d65(wavelength) / D65_MEAN,
            };
            let matching = DVec3::from_array(cie::color_matching(wavelength));
            matching * (seen_in * at(samples, wavelength))
        })
        .sum();
    XYZ_TO_SRGB * (xyz * ((last - first) / (STEPS as f64 * Y_INTEGRAL)))
}

/// The value at a wavelength, interpolated linearly; 0 before the first and after the last sample.
fn at(samples: &[[f64; 2]], wavelength: f64) -> f64 {
    let after = samples.partition_point(|&[w, _]| w <= wavelength);
    match (after.checked_sub(1).map(|i| samples[i]), samples.get(after)) {
        (Some([w0, v0]), Some(&[w1, v1])) => v0 + (v1 - v0) * (wavelength - w0) / (w1 - w0),
        (Some([w0, v0]), None) if w0 == wavelength => v0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of `mitsuba.spectrum_list_to_srgb(wavelengths, values, bounded=False, d65=d65)` of the
    /// variant `scalar_rgb`, Mitsuba 3.9.1.
    #[test]
    fn colours_of_spectra_are_those_of_mitsuba() {
        let ramp = vec![[400.0, 0.1], [500.0, 0.3], [600.0, 0.6], [700.0, 0.8]];
        let lamp = vec![[400.0, 0.0], [500.0, 8.0], [600.0, 15.6], [700.0, 18.4]];
        for (samples, viewing, expected) in [
            (ramp, Viewing::UnderD65, [0.705605, 0.426538, 0.174197]),
            (lamp, Viewing::Emitted, [20.7108, 10.8546, 2.77115]),
        ] {
            let found = to_rgb(&Spectrum::Samples(samples), viewing);
            assert!(
                (found - DVec3::from_array(expected)).abs().max_element()
                    < 2e-5 * found.max_element(),
                "{found}"
            );
        }
    }

    /// A reflectance of one is white, up to the error of the sum.
    #[test]
    fn a_reflectance_of_one_is_white() {
        let ones = Spectrum::Samples(vec![[360.0, 1.0], [830.0, 1.0]]);
        let white = to_rgb(&ones, Viewing::UnderD65);
        assert!((white - DVec3::ONE).abs().max_element() < 2e-3, "{white}");
    }
}
