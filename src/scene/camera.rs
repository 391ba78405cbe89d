//! Cameras: pinhole, thin lens and orthographic.
//!
//! The film is the unit square: (0, 0) is the top left corner of the image, x points right and y down.
//! The importance of the camera is normalised so that a sample of film position and lens point, both
//! uniform, has weight 1 (pbrt, 4th ed., section 16.1.2 "Sampling cameras" with a film of unit area):
//!
//!   W_e(x, w) = 1 / (A_film A_lens cos^4 theta),   A_film at distance 1 from the lens,
//!
//! without A_lens for a pinhole. Hence p_w(w) = 1 / (A_film cos^3 theta) per steradian.
//!
//! An orthographic camera is the limit of a pinhole camera that moves to infinity: all its rays have one
//! direction, and what has a density is the point of a plane across the view through which they pass, 1 / A
//! per unit area, where A is the area that the film shows. Every point is seen at one film position.

use glam::{DMat4, DVec2, DVec3, Vec2, Vec3A};

use super::description::{CameraDescription, Projection, SceneError};
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
    /// Half the width and height of the film at distance 1, or of what an orthographic camera shows.
    half_extent: Vec2,
    /// [`CameraDescription::principal_point_offset`].
    shift: Vec2,
    near: f32,
    far: f32,
    is_orthographic: bool,
    /// In scene units; 0 without a lens.
    lens_radius: f32,
    /// Distance along the viewing axis of the plane in focus; unused without a lens.
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
    /// W_e cos(theta at the lens) / (p(lens point) d^2), without d^2 for an orthographic camera. Multiplied by the throughput of the light
    /// subpath and the cosine at the point, it is the contribution to the film.
    pub importance: f32,
    /// p_w / d^2, or 1 / A for an orthographic camera, where p_w is the density with which the camera samples the direction to the point.
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
        let (half_extent, lens) = match description.projection {
            Projection::Perspective { fov_x, lens } => {
                let tan_x = (0.5 * fov_x.to_radians()).tan();
                (DVec2::new(tan_x, tan_x / aspect), lens)
            }
            Projection::Orthographic { half_extent } => (half_extent / unit, None),
        };
        let lens_radius = lens.map_or(0.0, |l| l.aperture_radius / unit) as f32;
        let focus = lens.map_or(1.0, |l| l.focus_distance / unit) as f32;
        let lengths = [
            position.length(),
            lens_radius,
            focus,
            half_extent.max_element() as f32,
        ];
        if !lengths.iter().all(|&length| length < MAX_DISTANCE) {
            let name = "sensor".into();
            return Err(SceneError::OutOfRange { name });
        }
        Ok(Self {
            position,
            right: right.as_vec3a(),
            up: up.as_vec3a(),
            forward: forward.as_vec3a(),
            half_extent: half_extent.as_vec2(),
            shift: description.principal_point_offset.as_vec2(),
            near: (description.near_clip / unit) as f32,
            far: (description.far_clip / unit) as f32,
            is_orthographic: matches!(description.projection, Projection::Orthographic { .. }),
            lens_radius,
            focus,
        })
    }

    /// True if rays pass through all points of a lens.
    #[inline]
    pub fn has_lens(&self) -> bool {
        self.lens_radius > 0.0
    }

    /// True if all rays have one direction.
    #[inline]
    pub fn is_orthographic(&self) -> bool {
        self.is_orthographic
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
    /// near plane; and the lens point itself. For an orthographic camera that is the point at depth 0.
    #[inline]
    pub fn ray(&self, film: Vec2, lens: Vec2) -> (Ray, Vec3A) {
        let p = (2.0 * (film + self.shift) - Vec2::ONE) * self.half_extent;
        if self.is_orthographic {
            let from = self.position + self.right * p.x - self.up * p.y;
            let ray = Ray {
                origin: from + self.forward * self.near,
                direction: self.forward,
                t_max: self.far - self.near,
            };
            return (ray, from);
        }
        // The point at distance 1 along the axis that a pinhole images at `film`.
        let pinhole = self.right * p.x - self.up * p.y + self.forward;
        let (origin, toward) = if self.has_lens() {
            let offset = self.lens_offset(lens);
            (self.position + offset, pinhole * self.focus - offset)
        } else {
            (self.position, pinhole)
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

    /// Density with which the camera samples `direction` (unit, away from the lens), per steradian; for an
    /// orthographic camera that of a ray per unit area of a plane across the view.
    #[inline]
    pub fn direction_pdf(&self, direction: Vec3A) -> f32 {
        let area = 4.0 * self.half_extent.x * self.half_extent.y;
        if self.is_orthographic {
            return area.recip();
        }
        let cos = direction.dot(self.forward);
        (area * cos * cos * cos).recip()
    }

    /// The square of the distance between a lens point and a point seen from it, if
    /// [`Self::direction_pdf`] is per steradian; 1 if it is per unit area.
    #[inline]
    pub fn squared_distance(&self, from: Vec3A, point: Vec3A) -> f32 {
        if self.is_orthographic {
            1.0
        } else {
            (point - from).length_squared()
        }
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
        if self.is_orthographic {
            let density = self.direction_pdf(self.forward);
            return Some(LensSample {
                film,
                direction: -self.forward,
                visible_distance: depth - self.near,
                importance: density,
                density,
            });
        }
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
        if self.has_lens() {
            self.position + self.lens_offset(lens)
        } else {
            self.position
        }
    }

    /// The film position, in [0, 1)^2, of light that arrives at the lens point of `lens` from
    /// `direction` (of any length, away from the lens); `None` if outside the film. For an orthographic camera
    /// `direction` leads from its position to the point that is seen.
    #[inline]
    pub fn film_position(&self, direction: Vec3A, lens: Vec2) -> Option<Vec2> {
        let depth = direction.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        // The intersection with the plane in focus, as a pinhole at the centre of the lens images it.
        let plane = if self.is_orthographic {
            direction
        } else if self.has_lens() {
            direction / depth + self.lens_offset(lens) / self.focus
        } else {
            direction / depth
        };
        let p = Vec2::new(plane.dot(self.right), -plane.dot(self.up)) / self.half_extent;
        let film = (p + Vec2::ONE) * 0.5 - self.shift;
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
