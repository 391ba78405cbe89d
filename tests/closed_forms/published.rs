//! Materials by their published formulas, in f64, and their albedos by brute-force quadrature, without any
//! code of the renderer.
//!
//! Directions are unit vectors in the frame of the surface (+z is the normal) and point away from it.

use std::f64::consts::PI;

use glam::DVec3;

/// Fresnel's equations for unpolarised light that enters a medium of relative index `eta` at `cos` (Born
/// and Wolf, "Principles of Optics", 7th ed., section 1.5.2, in terms of the angles).
pub fn dielectric_fresnel(cos: f64, eta: f64) -> f64 {
    let incident = cos.clamp(0.0, 1.0).acos();
    let sine = incident.sin() / eta;
    if sine >= 1.0 {
        return 1.0;
    }
    if incident < 1e-6 {
        return ((eta - 1.0) / (eta + 1.0)).powi(2);
    }
    let refracted = sine.asin();
    let perpendicular = (incident - refracted).sin() / (incident + refracted).sin();
    let parallel = (incident - refracted).tan() / (incident + refracted).tan();
    0.5 * (perpendicular.powi(2) + parallel.powi(2))
}

/// The same for a metal of index n + i k, in complex numbers (Born and Wolf, section 14.2): with
/// q = sqrt((n + ik)^2 - sin^2), r_s = (cos - q)/(cos + q) and r_p = (m^2 cos - q)/(m^2 cos + q).
pub fn conductor_fresnel(cos: f64, n: f64, k: f64) -> f64 {
    let index2 = [n * n - k * k, 2.0 * n * k];
    let (real, imaginary) = (index2[0] - 1.0 + cos * cos, index2[1]);
    let modulus = real.hypot(imaginary);
    let q = [
        (0.5 * (modulus + real)).max(0.0).sqrt(),
        (0.5 * (modulus - real)).max(0.0).sqrt(),
    ];
    let ratio = |a: [f64; 2]| {
        let difference = (a[0] - q[0]).hypot(a[1] - q[1]);
        (difference / (a[0] + q[0]).hypot(a[1] + q[1])).powi(2)
    };
    0.5 * (ratio([cos, 0.0]) + ratio(index2.map(|part| part * cos)))
}

/// The microfacets of a rough surface (Walter et al. 2007, "Microfacet models for refraction through rough
/// surfaces").
#[derive(Clone, Copy)]
pub enum Facets {
    Beckmann(f64),
    Ggx(f64),
}

impl Facets {
    /// D(m): equations 25 and 33.
    fn density(self, m: DVec3) -> f64 {
        let tan2 = (1.0 - m.z * m.z).max(0.0) / (m.z * m.z);
        match self {
            Self::Beckmann(a) => (-tan2 / (a * a)).exp() / (PI * a * a * m.z.powi(4)),
            Self::Ggx(a) => a * a / (PI * m.z.powi(4) * (a * a + tan2).powi(2)),
        }
    }

    /// Smith's G1 of a direction on either side: equations 26 (Beckmann's, exact) and 34.
    fn masking(self, v: DVec3) -> f64 {
        let tan = (1.0 - v.z * v.z).max(0.0).sqrt() / v.z.abs();
        if tan == 0.0 {
            return 1.0;
        }
        match self {
            Self::Beckmann(alpha) => {
                let a = 1.0 / (alpha * tan);
                2.0 / (1.0 + libm::erf(a) + (-a * a).exp() / (a * PI.sqrt()))
            }
            Self::Ggx(alpha) => 2.0 / (1.0 + (1.0 + (alpha * tan).powi(2)).sqrt()),
        }
    }

    /// Reflection, 1/sr: equation 20, with the reflectance `fresnel` of a cosine.
    pub fn reflect(self, light: DVec3, camera: DVec3, fresnel: impl Fn(f64) -> f64) -> f64 {
        if light.z * camera.z <= 0.0 {
            return 0.0;
        }
        let m = (light + camera).normalize();
        let m = if m.z < 0.0 { -m } else { m };
        let masking = self.masking(light) * self.masking(camera);
        fresnel(light.dot(m).abs()) * self.density(m) * masking / (4.0 * (light.z * camera.z).abs())
    }

    /// Refraction of radiance from `light` to `camera` on opposite sides: equation 21 with i = light,
    /// o = camera. `eta` is the index of the light's side over that of the camera's.
    fn refract(self, light: DVec3, camera: DVec3, eta: f64) -> f64 {
        if light.z * camera.z >= 0.0 {
            return 0.0;
        }
        let m = (camera + eta * light).normalize_or_zero();
        let m = if m.z < 0.0 { -m } else { m };
        let (light_m, camera_m) = (light.dot(m), camera.dot(m));
        if light_m * light.z <= 0.0 || camera_m * camera.z <= 0.0 {
            return 0.0;
        }
        let masking = self.masking(light) * self.masking(camera);
        let transmittance = 1.0 - dielectric_fresnel(camera_m.abs(), eta);
        (light_m * camera_m).abs() * transmittance * masking * self.density(m)
            / ((light.z * camera.z).abs() * (eta * light_m + camera_m).powi(2))
    }

    /// Reflection and refraction of radiance by a rough interface of index `eta` (+z outside, index 1).
    pub fn interface(self, light: DVec3, camera: DVec3, eta: f64) -> f64 {
        let across = if camera.z > 0.0 { eta } else { 1.0 / eta };
        self.reflect(light, camera, |cos| dielectric_fresnel(cos, across))
            + self.refract(light, camera, across)
    }

    /// Fraction of the power from `from` that a rough interface of index `eta` reflects.
    fn reflected_fraction(self, from: DVec3, eta: f64) -> f64 {
        albedo(from, |to, from| {
            self.reflect(to, from, |cos| dielectric_fresnel(cos, eta))
        })
    }

    /// Fraction of the power from `from` that it transmits: by reciprocity that of radiance in the reverse
    /// direction, without the factor of the squared index (Veach 1997, eq. 5.14).
    fn transmitted_fraction(self, from: DVec3, eta: f64) -> f64 {
        albedo(from, |to, from| eta * eta * self.refract(to, from, eta))
    }

    /// Mitsuba's rough plastic: reflection by the coat, and a substrate of albedo `rho` below it,
    /// f = T(l) T(c) rho / (pi eta^2 (1 - rho R)), where T is the transmitted fraction of the coat and R
    /// the fraction of diffuse light inside that it reflects back.
    pub fn nonlinear_plastic(self, rho: f64, eta: f64, from: DVec3) -> f64 {
        let coat = self.reflected_fraction(from, eta);
        let through = 2.0 * cosine_mean(|from| self.transmitted_fraction(from, eta));
        let inside = 2.0 * cosine_mean(|from| self.reflected_fraction(from, 1.0 / eta));
        let substrate = rho / (eta * eta * (1.0 - rho * inside));
        coat + self.transmitted_fraction(from, eta) * substrate * through
    }
}

/// Integral over the cosine, from 0 to 1, of `f` times the cosine.
fn cosine_mean(f: impl Fn(DVec3) -> f64) -> f64 {
    const STEPS: u32 = 32;
    let step = 0.5 * PI / f64::from(STEPS);
    (0..STEPS)
        .map(|i| {
            let (sin, cos) = ((f64::from(i) + 0.5) * step).sin_cos();
            f(DVec3::new(sin, 0.0, cos)) * cos * sin * step
        })
        .sum()
}

/// Fraction of diffuse light inside a smooth boundary of index `eta` that is reflected back:
/// 2 int F(cos, 1/eta) cos dcos, by the midpoint rule over the angle.
pub fn internal_diffuse_reflectance(eta: f64) -> f64 {
    const STEPS: u32 = 20_000;
    let step = 0.5 * PI / f64::from(STEPS);
    (0..STEPS)
        .map(|i| {
            let angle = (f64::from(i) + 0.5) * step;
            dielectric_fresnel(angle.cos(), 1.0 / eta) * (2.0 * angle).sin() * step
        })
        .sum()
}

/// Integral of f(to, `from`) |cos| over the whole sphere of directions `to`, by the midpoint rule in polar
/// angle and azimuth.
pub fn albedo(from: DVec3, f: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    const STEPS: u32 = 300;
    let step = PI / f64::from(STEPS);
    let mut sum = 0.0;
    for i in 0..STEPS {
        let (sin, cos) = ((f64::from(i) + 0.5) * step).sin_cos();
        // Half of the azimuths: `from` is in the plane y = 0, which is a plane of symmetry.
        for j in 0..STEPS {
            let (sin_phi, cos_phi) = ((f64::from(j) + 0.5) * step).sin_cos();
            let to = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
            sum += f(to, from) * cos.abs() * sin;
        }
    }
    2.0 * sum * step * step
}
