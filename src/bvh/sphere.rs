//! The ray-sphere test.

use glam::{DVec3, Vec3A};

/// Distance of the first hit in (0, `t_max`), from outside or inside.
///
/// Haines, Günther and Akenine-Möller 2019, "Precision improvements for ray/sphere intersection"
/// (Ray Tracing Gems, ch. 7): the discriminant follows from the point of closest approach, and the roots
/// have no cancellation. In f64, since |f|^2 - r^2 has few digits in f32 for an origin close to a large
/// sphere.
#[inline]
pub fn intersect(
    center: [f32; 3],
    radius: f32,
    origin: Vec3A,
    direction: Vec3A,
    t_max: f32,
) -> Option<f32> {
    let f = origin.as_dvec3() - DVec3::from_array(center.map(f64::from));
    let d = direction.as_dvec3();
    let r2 = f64::from(radius) * f64::from(radius);
    let a = d.length_squared();
    let b = -f.dot(d);
    let discriminant = r2 - (f + d * (b / a)).length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let q = b + (a * discriminant).sqrt().copysign(b);
    let (t0, t1) = ((f.length_squared() - r2) / q, q / a);
    let (near, far) = (t0.min(t1), t0.max(t1));
    let t = if near > 0.0 { near } else { far } as f32;
    (t > 0.0 && t < t_max).then_some(t)
}
