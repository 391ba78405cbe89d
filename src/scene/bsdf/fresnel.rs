//! Reflectance of smooth interfaces for unpolarised light.

use crate::math::Rgb;

/// Reflection and refraction at an interface between two dielectrics.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface {
    /// Fraction of the power that is reflected; 1 under total internal reflection.
    pub reflectance: f32,
    /// Cosine of the refracted ray with the normal on its side; 0 under total internal reflection.
    pub cos_t: f32,
}

/// Fresnel's equations and Snell's law (Born and Wolf, "Principles of Optics", 7th ed., section
/// 1.5.2 and 1.5.3) for a ray at `cos_i` >= 0; `eta` is the index of the far side over that of the near
/// side.
#[inline]
pub(super) fn dielectric(cos_i: f32, eta: f32) -> Interface {
    if eta == 1.0 {
        return Interface {
            reflectance: 0.0,
            cos_t: cos_i,
        };
    }
    let cos2_t = 1.0 - (1.0 - cos_i * cos_i) / (eta * eta);
    if cos2_t <= 0.0 {
        return Interface {
            reflectance: 1.0,
            cos_t: 0.0,
        };
    }
    let cos_t = cos2_t.sqrt();
    let r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    Interface {
        reflectance: (0.5 * (r_s * r_s + r_p * r_p)).min(1.0),
        cos_t,
    }
}

/// Reflectance of a conductor of index `eta` + i `k` at `cos_i` >= 0 (Moeller, "Optics", 1988; the
/// closed form for real arithmetic of Lagarde 2013, "Memo on Fresnel equations").
#[inline]
pub(super) fn conductor(cos_i: f32, eta: Rgb, k: Rgb) -> Rgb {
    let cos2 = cos_i * cos_i;
    let sin2 = 1.0 - cos2;
    let real = eta * eta - k * k - sin2;
    let a2_plus_b2 = sqrt(real * real + 4.0 * eta * eta * k * k);
    let a = sqrt(0.5 * (a2_plus_b2 + real));
    let t1 = a2_plus_b2 + cos2;
    let t2 = 2.0 * cos_i * a;
    let r_s = (t1 - t2) / (t1 + t2);
    let t3 = a2_plus_b2 * cos2 + sin2 * sin2;
    let t4 = t2 * sin2;
    let r_p = r_s * (t3 - t4) / (t3 + t4);
    0.5 * (r_s + r_p)
}

/// Square root of each channel, clamped to 0 from rounding errors below it.
#[inline]
fn sqrt(x: Rgb) -> Rgb {
    x.max(Rgb::ZERO).map(f32::sqrt)
}

/// Reflectance for diffuse light inside a medium of relative index `eta` at its smooth boundary, as in
/// Mitsuba 3's `plastic`: the fit of Egan and Hilgeman (1973) for light inside the denser medium, that
/// of d'Eon and Irving (2011, "A quantized-diffusion model", appendix) otherwise.
///
/// Beyond eta = 2 the former is off by up to a tenth, and it exceeds 1 at eta = 4. There it is replaced by
/// 1 - (1 - F) / eta^2, where F is the fit from outside: by reciprocity the transmittance for diffuse
/// light is the same from both sides, in terms of radiance over squared index.
pub(super) fn internal_diffuse_reflectance(eta: f32) -> f32 {
    let x = eta.recip();
    if eta <= 1.0 {
        return external_diffuse_reflectance(x);
    }
    if eta <= 2.0 {
        return -1.4399 * x * x + 0.7099 * x + 0.6681 + 0.0636 * eta;
    }
    1.0 - (1.0 - external_diffuse_reflectance(eta)) * x * x
}

/// The fit of d'Eon and Irving for light that enters a medium of relative index `eta` >= 1.
fn external_diffuse_reflectance(eta: f32) -> f32 {
    let x = eta.recip();
    let coefficients = [-1.368_81, 4.985_54, -7.809_89, 6.753_35, -3.4793, 0.919_317];
    coefficients.iter().fold(0.0, |sum, c| sum * x + c)
}
