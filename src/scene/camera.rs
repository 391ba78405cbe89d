//! Perspective cameras: pinhole and thin lens.
//!
//! The film is the unit square: (0, 0) is the top left corner of the image, x points right and y down.
//! The importance of the camera is normalised so that a sample of film position and lens point, both
//! uniform, has weight 1 (pbrt, 4th ed., section 16.1.2 "Sampling cameras" with a film of unit area):
//!
//!   W_e(x, w) = 1 / (A_film A_lens cos^4 theta),   A_film at distance 1 from the lens,
//!
//! without A_lens for a pinhole. Hence p_w(w) = 1 / (A_film cos^3 theta) per steradian.

use glam::{DMat4, DVec3, Vec2, Vec3A};

use super::description::{CameraDescription, SceneError};
use super::{MAX_DISTANCE, Ray};
use crate::sampling::warp::square_to_disk;

/// A camera in scene units.
#[derive(Clone, Debug)]
pub struct Camera {
    position: Vec3A,
    /// Unit axes: right and up in the image, and the viewing direction.
    right: Vec3A,
    up: Vec3A,
    forward: Vec3A,
    /// Half the width and height of the film at distance 1.
    half_extent: Vec2,
    near: f32,
    far: f32,
    /// In scene units; 0 for a pinhole.
    lens_radius: f32,
    /// Distance along the viewing axis of the plane in focus; unused for a pinhole.
    focus: f32,
}

/// A connection from a point to the lens (technique t = 1).
#[derive(Clone, Copy, Debug)]
pub struct LensSample {
    /// Film position of the point, in [0, 1)^2.
    pub film: Vec2,
    /// Unit, from the point to the lens.
    pub direction: Vec3A,
    /// Distance from the point to the near plane: the length of the shadow ray.
    pub visible_distance: f32,
    /// W_e cos(theta at the lens) / (p(lens point) d^2). Multiplied by the throughput of the light
    /// subpath and the cosine at the point, it is the contribution to the film.
    pub importance: f32,
    /// p_w / d^2, where p_w is the density with which the camera samples the direction to the point.
    /// Multiplied by the cosine at the point, it is the density per area there.
    pub density: f32,
}

impl Camera {
    /// The camera of `description` in scene units: world coordinates p become (p - `center`) / `unit`.
    ///
    /// # Errors
    /// If the transform is singular or not finite, or the position or lens overflow f32.
    pub fn new(
        description: &CameraDescription,
        aspect: f64,
        center: DVec3,
        unit: f64,
    ) -> Result<Self, SceneError> {
        let singular = || SceneError::SingularTransform {
            name: "sensor".into(),
        };
        let m: DMat4 = description.to_world;
        let axis = |v: DVec3| m.transform_vector3(v).try_normalize().ok_or_else(singular);
        let (right, up, forward) = (axis(DVec3::NEG_X)?, axis(DVec3::Y)?, axis(DVec3::Z)?);
        // The unit axes must span a volume, whatever the scale of the transform.
        if !m.is_finite() || right.cross(up).dot(forward).abs() < 1e-9 {
            return Err(singular());
        }
        let position = ((m.transform_point3(DVec3::ZERO) - center) / unit).as_vec3a();
        let lens_radius = description.lens.map_or(0.0, |l| l.aperture_radius / unit) as f32;
        let focus = description.lens.map_or(1.0, |l| l.focus_distance / unit) as f32;
        if !(position.length() < MAX_DISTANCE && lens_radius < MAX_DISTANCE && focus < MAX_DISTANCE)
        {
            let name = "sensor".into();
            return Err(SceneError::OutOfRange { name });
        }
        let tan_x = (0.5 * description.fov_x.to_radians()).tan();
        Ok(Self {
            position,
            right: right.as_vec3a(),
            up: up.as_vec3a(),
            forward: forward.as_vec3a(),
            half_extent: Vec2::new(tan_x as f32, (tan_x / aspect) as f32),
            near: (description.near_clip / unit) as f32,
            far: (description.far_clip / unit) as f32,
            lens_radius,
            focus,
        })
    }

    /// True if the lens is a point.
    pub fn is_pinhole(&self) -> bool {
        self.lens_radius == 0.0
    }

    /// Centre of the lens.
    pub fn position(&self) -> Vec3A {
        self.position
    }

    /// Unit viewing direction.
    pub fn forward(&self) -> Vec3A {
        self.forward
    }

    /// The ray through the film position `film` and the lens point that `lens` maps to, starting at the
    /// near plane; and the lens point itself.
    #[inline]
    pub fn ray(&self, film: Vec2, lens: Vec2) -> (Ray, Vec3A) {
        let p = (2.0 * film - Vec2::ONE) * self.half_extent;
        // The point at distance 1 along the axis that a pinhole images at `film`.
        let pinhole = self.right * p.x - self.up * p.y + self.forward;
        let (origin, toward) = if self.is_pinhole() {
            (self.position, pinhole)
        } else {
            let offset = self.lens_offset(lens);
            (self.position + offset, pinhole * self.focus - offset)
        };
        let direction = toward.normalize();
        let distance_per_depth = direction.dot(self.forward).recip();
        let ray = Ray {
            origin: origin + direction * (self.near * distance_per_depth),
            direction,
            t_max: (self.far - self.near) * distance_per_depth,
        };
        (ray, origin)
    }

    /// Density with which the camera samples `direction` (unit, away from the lens), per steradian.
    #[inline]
    pub fn direction_pdf(&self, direction: Vec3A) -> f32 {
        let cos = direction.dot(self.forward);
        (4.0 * self.half_extent.x * self.half_extent.y * cos * cos * cos).recip()
    }

    /// Connects `point` to the lens point that `lens` maps to; `None` if it is not in view.
    #[inline]
    pub fn connect(&self, point: Vec3A, lens: Vec2) -> Option<LensSample> {
        let to_point = point - self.lens_position(lens);
        let depth = to_point.dot(self.forward);
        if !(depth > self.near && depth < self.far) {
            return None;
        }
        let film = self.film_position(to_point, lens)?;
        let distance = to_point.length();
        let direction = to_point / distance;
        // W_e cos / p(lens point) = 1 / (A_film cos^3) = p_w: the lens area cancels.
        let density = self.direction_pdf(direction) / (distance * distance);
        Some(LensSample {
            film,
            direction: -direction,
            visible_distance: distance - self.near * distance / depth,
            importance: density,
            density,
        })
    }

    /// The lens point that `lens` in [0, 1)^2 maps to.
    #[inline]
    pub fn lens_position(&self, lens: Vec2) -> Vec3A {
        if self.is_pinhole() {
            self.position
        } else {
            self.position + self.lens_offset(lens)
        }
    }

    /// The film position, in [0, 1)^2, of light that arrives at the lens point of `lens` from
    /// `direction` (of any length, away from the lens); `None` if outside the film.
    #[inline]
    pub fn film_position(&self, direction: Vec3A, lens: Vec2) -> Option<Vec2> {
        let depth = direction.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        // The intersection with the plane in focus, as a pinhole at the centre of the lens images it.
        let offset = if self.is_pinhole() {
            Vec3A::ZERO
        } else {
            self.lens_offset(lens)
        };
        let plane = direction / depth + offset / self.focus;
        let p = Vec2::new(plane.dot(self.right), -plane.dot(self.up)) / self.half_extent;
        let film = (p + Vec2::ONE) * 0.5;
        let inside = film.x >= 0.0 && film.x < 1.0 && film.y >= 0.0 && film.y < 1.0;
        inside.then_some(film)
    }

    /// The part between the clipping planes of the segment from the lens point `from` to `target`, along
    /// the unit `direction`; `None` if `target` is not between them.
    #[inline]
    pub fn visible_segment(
        &self,
        from: Vec3A,
        direction: Vec3A,
        target: Vec3A,
    ) -> Option<(Vec3A, Vec3A)> {
        let cos = direction.dot(self.forward);
        let depth = (target - from).dot(self.forward);
        let seen = cos > 0.0 && depth > self.near && depth < self.far;
        seen.then(|| (from + direction * (self.near / cos), target))
    }

    fn lens_offset(&self, lens: Vec2) -> Vec3A {
        let d = square_to_disk(lens) * self.lens_radius;
        self.right * d.x + self.up * d.y
    }
}

#[cfg(test)]
mod tests;
