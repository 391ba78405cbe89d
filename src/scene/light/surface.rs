//! Area emitters: Lambertian light from the front side of triangles and spheres.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::{Vec2, Vec3A};

use super::{DirectSample, EmissionSample, EmissionToward};
use crate::math::{Frame, Rgb};
use crate::sampling::Distribution1D;
use crate::sampling::warp::{square_to_cosine_hemisphere, square_to_sphere, square_to_triangle};
use crate::scene::SurfacePoint;
use crate::scene::geometry::{ShapeSurface, SurfaceTriangle};
use crate::scene::interaction::offset;

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
    Mesh(Mesh),
    Sphere(Sphere),
}

#[derive(Debug)]
struct Mesh {
    /// In the order of their primitives.
    triangles: Vec<SurfaceTriangle>,
    /// Proportional to their areas, but for rounding.
    choice: Distribution1D,
    /// Per unit area, of a point on each triangle: from the probabilities as they were rounded.
    densities: Vec<f32>,
}

#[derive(Debug)]
struct Sphere {
    center: Vec3A,
    radius: f32,
    /// The front side is inside.
    inward: bool,
}

/// Share of an emitter's area below which a triangle is not sampled, only hit: all of them together
/// have no light that could be seen, and densities stay in the range of f32.
const SMALLEST_SHARE: f64 = 1e-12;

impl AreaEmitter {
    /// Light from a surface; `None` if it has no area.
    pub fn new(radiance: Rgb, surface: ShapeSurface) -> Option<Self> {
        let (form, area) = match surface {
            ShapeSurface::Triangles(triangles) => {
                let area = triangles.iter().map(SurfaceTriangle::area).sum();
                (Form::Mesh(Mesh::new(triangles, area)?), area)
            }
            ShapeSurface::Sphere {
                center,
                radius,
                inward,
            } => {
                let sphere = Sphere {
                    center,
                    radius,
                    inward,
                };
                let area = 4.0 * std::f64::consts::PI * f64::from(radius) * f64::from(radius);
                (Form::Sphere(sphere), area)
            }
        };
        Some(Self {
            radiance,
            area,
            form,
        })
    }

    /// Flux: pi A L.
    pub fn power(&self) -> Rgb {
        self.radiance * (PI * self.area as f32)
    }

    /// A point on the surface, sampled without regard to what it lights, the normal there, and its
    /// density per area.
    #[inline]
    fn sample_surface(&self, part: f32, u: Vec2) -> (Vec3A, Vec3A, f32) {
        match &self.form {
            Form::Mesh(mesh) => mesh.sample(part, u),
            Form::Sphere(sphere) => {
                let (position, normal) = sphere.at(square_to_sphere(u));
                (position, normal, self.uniform_pdf())
            }
        }
    }

    /// The density with which [`Self::sample_surface`] finds a point of a primitive.
    #[inline]
    fn surface_pdf(&self, primitive: u32) -> f32 {
        match &self.form {
            Form::Mesh(mesh) => mesh.pdf(primitive),
            Form::Sphere(_) => self.uniform_pdf(),
        }
    }

    /// Density per area of a point uniform on the surface.
    #[inline]
    fn uniform_pdf(&self) -> f32 {
        (1.0 / self.area) as f32
    }

    /// Density with which [`Self::sample_direct`] for `point` finds y_0, where `pdf_position` is that
    /// of [`Self::sample_surface`] and `cos` and `distance_squared` are those of the segment between
    /// them; both include the probability `choice_pdf` of this emitter.
    #[inline]
    fn direct_pdf(
        &self,
        point: Vec3A,
        pdf_position: f32,
        choice_pdf: f32,
        (cos, distance_squared): (f32, f32),
    ) -> f32 {
        match &self.form {
            Form::Sphere(sphere) if !sphere.inward => sphere.cone(point).map_or(0.0, |cone| {
                choice_pdf * (cone.pdf() * cos / distance_squared)
            }),
            Form::Mesh(_) | Form::Sphere(_) => pdf_position,
        }
    }

    /// Light from y_0 = `position` with normal `normal` and density `pdf_position` toward `point`,
    /// the direction from `point` to y_0, the cosine at y_0 and the distance squared; `None` from
    /// behind.
    #[inline]
    fn toward(
        &self,
        (position, normal, pdf_position): (Vec3A, Vec3A, f32),
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
            pdf_direct: self.direct_pdf(point, pdf_position, choice_pdf, (cos, distance_squared)),
            pdf_position,
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
        let (position, normal, pdf) = match &self.form {
            Form::Sphere(sphere) if !sphere.inward => {
                let (position, normal) = sphere.at(sphere.cone(point)?.sample_normal(u));
                (position, normal, self.uniform_pdf())
            }
            Form::Mesh(_) | Form::Sphere(_) => self.sample_surface(part, u),
        };
        let (emission, direction, cos, distance_squared) =
            self.toward((position, normal, choice_pdf * pdf), point, choice_pdf)?;
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
        let (position, normal, pdf) = self.sample_surface(part, place);
        let pdf_position = choice_pdf * pdf;
        let local = square_to_cosine_hemisphere(way);
        let direction = Frame::from_normal(normal).to_world(local);
        EmissionSample {
            emitter,
            origin: offset(position, normal, direction),
            position,
            normal,
            direction,
            // Le cos / (pdf_position * cos/pi): the cosine cancels.
            weight: self.radiance * (PI / pdf_position),
            pdf_position,
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
        let start = (sample.position, sample.normal, sample.pdf_position);
        self.toward(start, point, choice_pdf)
            .map_or(0.0, |(emission, ..)| emission.pdf_direct)
    }

    /// As [`super::Emitters::hit`].
    #[inline]
    pub fn hit(
        &self,
        surface: &SurfacePoint,
        from: Vec3A,
        choice_pdf: f32,
    ) -> Option<EmissionToward> {
        let pdf_position = choice_pdf * self.surface_pdf(surface.primitive);
        let y0 = (surface.position, surface.geometric_normal, pdf_position);
        self.toward(y0, from, choice_pdf)
            .map(|(emission, ..)| emission)
    }
}

impl Mesh {
    /// Of triangles whose areas add up to `area`; `None` if that is 0.
    fn new(triangles: Vec<SurfaceTriangle>, area: f64) -> Option<Self> {
        let sampled = |own: f64| {
            if own < SMALLEST_SHARE * area {
                0.0
            } else {
                own
            }
        };
        let choice = Distribution1D::new(triangles.iter().map(|t| sampled(t.area())))?;
        let density = |(i, triangle): (usize, &SurfaceTriangle)| {
            (f64::from(choice.probability(i)) / triangle.area()) as f32
        };
        let densities = triangles.iter().enumerate().map(density).collect();
        Some(Self {
            triangles,
            choice,
            densities,
        })
    }

    /// As [`AreaEmitter::sample_surface`].
    #[inline]
    fn sample(&self, part: f32, u: Vec2) -> (Vec3A, Vec3A, f32) {
        let i = self.choice.sample(part).0;
        let triangle = &self.triangles[i];
        let b = square_to_triangle(u);
        let [p0, p1, p2] = triangle.corners.map(Vec3A::from_array);
        let position = p0 + (p1 - p0) * b.x + (p2 - p0) * b.y;
        (position, triangle.normal, self.densities[i])
    }

    /// As [`AreaEmitter::surface_pdf`].
    #[inline]
    fn pdf(&self, primitive: u32) -> f32 {
        let found = self
            .triangles
            .binary_search_by_key(&primitive, |t| t.primitive);
        found.map_or(0.0, |i| self.densities[i])
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
