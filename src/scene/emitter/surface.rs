//! Area emitters: Lambertian light from the front side of triangles and spheres.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::{Vec2, Vec3A};

use super::{DirectSample, EmissionSample, EmissionToward};
use crate::math::warp::{square_to_cosine_hemisphere, square_to_sphere, square_to_triangle};
use crate::math::{Distribution1D, Frame, Rgb};
use crate::scene::geometry::PlacedTriangle;
use crate::scene::surface::offset;

/// Distances squared below which two points are the same: the geometry term is beyond f32.
pub const MIN_DISTANCE_SQUARED: f32 = 1e-20;

/// A surface that emits the same radiance everywhere.
#[derive(Debug)]
pub struct AreaEmitter {
    /// W/(m^2 sr) on the front side.
    radiance: Rgb,
    /// In scene units squared.
    area: f64,
    form: Form,
}

#[derive(Debug)]
enum Form {
    Triangles {
        triangles: Vec<PlacedTriangle>,
        /// Proportional to their areas.
        choice: Distribution1D,
    },
    Sphere(Sphere),
}

#[derive(Debug)]
struct Sphere {
    center: Vec3A,
    radius: f32,
    /// The front side is inside.
    inward: bool,
}

impl AreaEmitter {
    /// Light from `triangles`; `None` if there are none.
    pub fn triangles(radiance: Rgb, triangles: Vec<PlacedTriangle>) -> Option<Self> {
        let choice = Distribution1D::new(triangles.iter().map(PlacedTriangle::area))?;
        Some(Self {
            radiance,
            area: choice.total(),
            form: Form::Triangles { triangles, choice },
        })
    }

    /// Light from a sphere, to its inside if `inward`; `None` if it has no area.
    pub fn sphere(radiance: Rgb, center: Vec3A, radius: f32, inward: bool) -> Option<Self> {
        (radius > 0.0).then(|| Self {
            radiance,
            area: 4.0 * std::f64::consts::PI * f64::from(radius) * f64::from(radius),
            form: Form::Sphere(Sphere {
                center,
                radius,
                inward,
            }),
        })
    }

    /// Flux: pi A L.
    pub fn power(&self) -> Rgb {
        self.radiance * (PI * self.area as f32)
    }

    /// Density per area of a point uniform on the surface.
    #[inline]
    fn uniform_pdf(&self) -> f32 {
        (1.0 / self.area) as f32
    }

    /// A point uniform on the surface and the normal there.
    #[inline]
    fn sample_uniform(&self, part: f32, u: Vec2) -> (Vec3A, Vec3A) {
        match &self.form {
            Form::Triangles { triangles, choice } => {
                let triangle = &triangles[choice.sample(part).0];
                let b = square_to_triangle(u);
                let [p0, p1, p2] = triangle.corners.map(Vec3A::from_array);
                (p0 + (p1 - p0) * b.x + (p2 - p0) * b.y, triangle.normal)
            }
            Form::Sphere(sphere) => sphere.at(square_to_sphere(u)),
        }
    }

    /// Density per area with which [`Self::sample_direct`] for `point` finds y_0, where `cos` and
    /// `distance_squared` are those of the segment between them.
    #[inline]
    fn direct_pdf(&self, point: Vec3A, cos: f32, distance_squared: f32) -> f32 {
        match &self.form {
            Form::Triangles { .. } => self.uniform_pdf(),
            Form::Sphere(sphere) => match sphere.cone(point) {
                _ if sphere.inward => self.uniform_pdf(),
                Some(cone) => cone.pdf() * cos / distance_squared,
                None => 0.0,
            },
        }
    }

    /// Light from y_0 = `position` with normal `normal` toward `point`, the direction from `point`
    /// to y_0, the cosine at y_0 and the distance squared; `None` from behind.
    #[inline]
    fn toward(
        &self,
        position: Vec3A,
        normal: Vec3A,
        point: Vec3A,
        choice_pdf: f32,
    ) -> Option<(EmissionToward, Vec3A, f32, f32)> {
        let to = position - point;
        let distance_squared = to.length_squared();
        if distance_squared < MIN_DISTANCE_SQUARED {
            return None;
        }
        let direction = to / distance_squared.sqrt();
        let cos = -normal.dot(direction);
        if cos <= 0.0 {
            return None;
        }
        let emission = EmissionToward {
            radiance: self.radiance,
            pdf_direct: choice_pdf * self.direct_pdf(point, cos, distance_squared),
            pdf_position: choice_pdf * self.uniform_pdf(),
            pdf_direction: cos * FRAC_1_PI,
        };
        Some((emission, direction, cos, distance_squared))
    }

    /// As [`super::Emitters::sample_direct`]; `choice_pdf` is the probability of this emitter.
    #[inline]
    pub fn sample_direct(
        &self,
        point: Vec3A,
        part: f32,
        u: Vec2,
        choice_pdf: f32,
    ) -> Option<DirectSample> {
        let (position, normal) = match &self.form {
            Form::Sphere(sphere) if !sphere.inward => {
                sphere.at(sphere.cone(point)?.sample_normal(u))
            }
            _ => self.sample_uniform(part, u),
        };
        let (emission, direction, cos, distance_squared) =
            self.toward(position, normal, point, choice_pdf)?;
        Some(DirectSample {
            direction,
            target: offset(position, normal, -direction),
            emission,
            geometry: cos / distance_squared,
            spread: 1.0 / distance_squared,
            delta: false,
        })
    }

    /// As [`super::Emitters::sample_emission`].
    #[inline]
    pub fn sample_emission(
        &self,
        emitter: u32,
        part: f32,
        place: Vec2,
        way: Vec2,
        choice_pdf: f32,
    ) -> EmissionSample {
        let (position, normal) = self.sample_uniform(part, place);
        let local = square_to_cosine_hemisphere(way);
        let direction = Frame::from_normal(normal).to_world(local);
        EmissionSample {
            emitter,
            origin: offset(position, normal, direction),
            position,
            normal,
            direction,
            // Le cos / (choice/A * cos/pi): the cosine cancels.
            weight: self.power() / choice_pdf,
            pdf_position: choice_pdf * self.uniform_pdf(),
            pdf_direction: local.z * FRAC_1_PI,
            infinite: false,
            delta: false,
        }
    }

    /// As [`super::Emitters::direct_pdf`].
    #[inline]
    pub fn emission_direct_pdf(
        &self,
        sample: &EmissionSample,
        point: Vec3A,
        choice_pdf: f32,
    ) -> f32 {
        self.toward(sample.position, sample.normal, point, choice_pdf)
            .map_or(0.0, |(emission, ..)| emission.pdf_direct)
    }

    /// As [`super::Emitters::hit`].
    #[inline]
    pub fn hit(
        &self,
        position: Vec3A,
        normal: Vec3A,
        from: Vec3A,
        choice_pdf: f32,
    ) -> Option<EmissionToward> {
        self.toward(position, normal, from, choice_pdf)
            .map(|(emission, ..)| emission)
    }
}

impl Sphere {
    /// The point in direction `outward` from the centre, and the normal there on the front side.
    #[inline]
    fn at(&self, outward: Vec3A) -> (Vec3A, Vec3A) {
        let normal = if self.inward { -outward } else { outward };
        (self.center + outward * self.radius, normal)
    }

    /// The cone under which `point` sees the sphere; `None` from inside.
    #[inline]
    fn cone(&self, point: Vec3A) -> Option<Cone> {
        let to_point = point.as_dvec3() - self.center.as_dvec3();
        let distance_squared = to_point.length_squared();
        let radius_squared = f64::from(self.radius) * f64::from(self.radius);
        if distance_squared <= radius_squared {
            return None;
        }
        let sin_squared = radius_squared / distance_squared;
        let cos = ((distance_squared - radius_squared) / distance_squared).sqrt();
        Some(Cone {
            axis: (to_point / distance_squared.sqrt()).as_vec3a(),
            sin_squared,
            // 1 - cos without cancellation for a small or distant sphere.
            height: sin_squared / (1.0 + cos),
        })
    }
}

/// The cone of directions to a sphere, in f64 as its solid angle spans all magnitudes.
struct Cone {
    /// Unit, from the centre of the sphere to the apex.
    axis: Vec3A,
    /// Of the half-angle.
    sin_squared: f64,
    /// 1 - cos of the half-angle.
    height: f64,
}

impl Cone {
    /// Density per steradian of a direction uniform in the cone.
    #[inline]
    fn pdf(&self) -> f32 {
        (0.5 * std::f64::consts::FRAC_1_PI / self.height) as f32
    }

    /// The normal of the sphere where a direction uniform in the cone meets it (pbrt, 4th ed.,
    /// section 6.2.4 "Sampling" of spheres).
    #[inline]
    fn sample_normal(&self, u: Vec2) -> Vec3A {
        let below = self.height * f64::from(u.x);
        let sin2_theta = below * (2.0 - below);
        let cos_theta = 1.0 - below;
        // By the sine rule the angle at the surface is beta = alpha + theta, where alpha is the angle
        // at the centre; sin alpha = sin(beta - theta).
        let sin2_beta = (sin2_theta / self.sin_squared).min(1.0);
        let cos_beta = (1.0 - sin2_beta).sqrt();
        let sin_theta = sin2_theta.sqrt();
        let sin_alpha = sin2_beta.sqrt() * cos_theta - cos_beta * sin_theta;
        let cos_alpha = cos_beta * cos_theta + sin2_beta.sqrt() * sin_theta;
        let (sin_phi, cos_phi) = (std::f32::consts::TAU * u.y).sin_cos();
        let local = Vec3A::new(
            sin_alpha as f32 * cos_phi,
            sin_alpha as f32 * sin_phi,
            cos_alpha as f32,
        );
        Frame::from_normal(self.axis).to_world(local)
    }
}
