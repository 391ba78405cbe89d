//! Maps from the unit square to the domains that are sampled, with their densities.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use glam::{Vec2, Vec3A};

/// Uniform on the unit disk, by the concentric map of Shirley and Chiu (1997, "A low distortion
/// map between disk and square"). It is continuous, so that small changes in the square are small on the
/// disk.
#[inline]
pub fn square_to_disk(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (r, phi) = if p.x.abs() > p.y.abs() {
        (p.x, PI / 4.0 * (p.y / p.x))
    } else {
        (p.y, PI / 2.0 - PI / 4.0 * (p.x / p.y))
    };
    r * Vec2::new(phi.cos(), phi.sin())
}

/// Cosine-weighted on the hemisphere around +z (Malley's method); density
/// [`cosine_hemisphere_pdf`] in 1/sr.
#[inline]
pub fn square_to_cosine_hemisphere(u: Vec2) -> Vec3A {
    let d = square_to_disk(u);
    // Not in the tangent plane, where the density is 0.
    let z = (1.0 - d.length_squared()).max(1e-12).sqrt();
    Vec3A::new(d.x, d.y, z)
}

/// Density of [`square_to_cosine_hemisphere`], per steradian; 0 below the plane.
#[inline]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Uniform on the unit sphere; density 1/(4 pi) per steradian.
#[inline]
pub fn square_to_sphere(u: Vec2) -> Vec3A {
    let z = 1.0 - 2.0 * u.x;
    let r = (4.0 * u.x * (1.0 - u.x)).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (TAU * u.y).sin_cos();
    Vec3A::new(r * cos_phi, r * sin_phi, z)
}

/// Uniform on a triangle, as barycentric coordinates (b1, b2) of its second and third corner
/// (Osada et al. 2002, "Shape distributions", section 4.2); density 1/area.
#[inline]
pub fn square_to_triangle(u: Vec2) -> Vec2 {
    let r = u.x.sqrt();
    Vec2::new(1.0 - r, u.y * r)
}
