//! Area lights: Lambertian emission from the front side of meshes and spheres.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::{Vec2, Vec3A};

use super::mesh::MeshSurface;
use super::sample::{
    EmissionSample, LightEvaluation, LightSample, MIN_DISTANCE_SQUARED, SurfaceSample,
};
use super::specular::{Cap, ChainEnd, on_surface};
use super::sphere::SphereSurface;
use crate::math::{Frame, Rgb};
use crate::sampling::warp::{square_to_cosine_hemisphere, square_to_sphere};
use crate::scene::geometry::{ShapeSurface, SurfaceTriangle};
use crate::scene::interaction::offset;
use crate::scene::{SurfacePoint, Texture};

/// A surface that emits.
#[derive(Debug)]
pub struct AreaEmitter {
    /// W/(m^2 sr) on the front side.
    radiance: Texture,
    /// In scene units squared.
    area: f64,
    surface: Surface,
}

#[derive(Debug)]
enum Surface {
    Mesh(MeshSurface),
    Sphere(SphereSurface),
}

/// The segment from a point to y_0.
struct Segment {
    /// Unit, from the point to y_0.
    direction: Vec3A,
    /// Cosine at y_0.
    cos: f32,
    distance_squared: f32,
}

impl AreaEmitter {
    /// An emitter with this surface; `None` if it has no area.
    pub fn new(radiance: Texture, surface: ShapeSurface) -> Option<Self> {
        let (surface, area) = match surface {
            ShapeSurface::Triangles(triangles) => {
                let area = triangles.iter().map(SurfaceTriangle::area).sum();
                (Surface::Mesh(MeshSurface::new(triangles, area)?), area)
            }
            ShapeSurface::Sphere {
                center,
                radius,
                inward,
                to_local,
            } => {
                let sphere = SphereSurface {
                    center,
                    radius,
                    inward,
                    to_local,
                };
                let area = sphere.area();
                (Surface::Sphere(sphere), area)
            }
        };
        Some(Self {
            radiance,
            area,
            surface,
        })
    }

    /// Flux: pi A L. That of a texture takes the mean of its image, not that over the surface: the choice
    /// between emitters need not be exact.
    pub fn power(&self) -> Rgb {
        self.radiance.mean() * (PI * self.area as f32)
    }

    /// True if chains end here: the light is the same everywhere.
    pub fn ends_chains(&self) -> bool {
        matches!(self.radiance, Texture::Constant(_))
    }

    /// Samples a point on the surface by area; and its radiance.
    #[inline]
    pub fn sample_light(&self, u_primitive: f32, u_position: Vec2) -> (SurfaceSample, Rgb) {
        let sample = self.sample_surface(u_primitive, u_position);
        (sample, self.radiance.evaluate(sample.uv))
    }

    /// Samples a point on the surface by area.
    #[inline]
    fn sample_surface(&self, u_primitive: f32, u_position: Vec2) -> SurfaceSample {
        match &self.surface {
            Surface::Mesh(mesh) => mesh.sample(u_primitive, u_position),
            Surface::Sphere(sphere) => {
                sphere.sample(square_to_sphere(u_position), self.uniform_pdf())
            }
        }
    }

    /// The density with which [`Self::sample_surface`] samples a point of a primitive.
    #[inline]
    pub fn surface_pdf(&self, primitive: u32) -> f32 {
        match &self.surface {
            Surface::Mesh(mesh) => mesh.pdf(primitive),
            Surface::Sphere(_) => self.uniform_pdf(),
        }
    }

    /// Density per area of a point uniform on the surface.
    #[inline]
    fn uniform_pdf(&self) -> f32 {
        (1.0 / self.area) as f32
    }

    /// Density per area with which [`Self::sample_direct`] for `point` samples y_0, at the end of
    /// `segment`; `pdf_position` is the density with which [`Self::sample_surface`] does. Both include
    /// the probability `choice_pdf` of this emitter.
    #[inline]
    fn direct_pdf(
        &self,
        point: Vec3A,
        segment: &Segment,
        pdf_position: f32,
        choice_pdf: f32,
    ) -> f32 {
        match &self.surface {
            Surface::Sphere(sphere) if !sphere.inward => sphere.cone(point).map_or(0.0, |cone| {
                choice_pdf * (cone.pdf() * segment.cos / segment.distance_squared)
            }),
            Surface::Mesh(_) | Surface::Sphere(_) => pdf_position,
        }
    }

    /// Light from `y0` toward `point`, and the segment between them; `None` from behind. The density
    /// of `y0` includes the probability `choice_pdf` of this emitter.
    #[inline]
    fn light_toward(
        &self,
        y0: &SurfaceSample,
        point: Vec3A,
        choice_pdf: f32,
    ) -> Option<(LightEvaluation, Segment)> {
        let to_light = y0.position - point;
        let distance_squared = to_light.length_squared();
        if distance_squared < MIN_DISTANCE_SQUARED {
            return None;
        }
        let direction = to_light / distance_squared.sqrt();
        let cos = -y0.normal.dot(direction);
        if cos <= 0.0 {
            return None;
        }
        let segment = Segment {
            direction,
            cos,
            distance_squared,
        };
        let emission = LightEvaluation {
            radiance: self.radiance.evaluate(y0.uv),
            pdf_direct: self.direct_pdf(point, &segment, y0.pdf, choice_pdf),
            pdf_position: y0.pdf,
            pdf_direction: cos * FRAC_1_PI,
        };
        Some((emission, segment))
    }

    /// As [`super::Emitters::sample_direct`]; `choice_pdf` is the probability of this emitter.
    #[inline]
    pub fn sample_direct(
        &self,
        point: Vec3A,
        u_primitive: f32,
        u_position: Vec2,
        choice_pdf: f32,
    ) -> Option<LightSample> {
        let mut y0 = match &self.surface {
            Surface::Sphere(sphere) if !sphere.inward => {
                let cone = sphere.cone(point)?;
                sphere.sample(cone.sample_normal(u_position), self.uniform_pdf())
            }
            Surface::Mesh(_) | Surface::Sphere(_) => self.sample_surface(u_primitive, u_position),
        };
        y0.pdf *= choice_pdf;
        let (emission, segment) = self.light_toward(&y0, point, choice_pdf)?;
        Some(LightSample {
            direction: segment.direction,
            target: offset(y0.position, y0.normal, -segment.direction),
            emission,
            jacobian_direction: segment.cos / segment.distance_squared,
            jacobian_area: 1.0 / segment.distance_squared,
            delta: false,
        })
    }

    /// As [`super::Emitters::sample_chain_end`]; `bounds` is a sphere around all casters, and `pdfs` are the
    /// probabilities of this emitter for chains and for light subpaths.
    #[inline]
    pub fn sample_chain_end(
        &self,
        bounds: (Vec3A, f32),
        u_primitive: f32,
        u_position: Vec2,
        pdfs: [f32; 2],
    ) -> ChainEnd {
        match &self.surface {
            Surface::Sphere(sphere) => {
                let cap = Cap::facing(sphere, bounds);
                let outward = cap.sample(u_position);
                let (position, normal) = sphere.at(outward);
                let densities = [cap.pdf(sphere, outward), f64::from(self.uniform_pdf())];
                self.chain_end(position, normal, densities, pdfs)
            }
            Surface::Mesh(mesh) => {
                let y0 = mesh.sample(u_primitive, u_position);
                let densities = [f64::from(y0.pdf); 2];
                self.chain_end(y0.position, y0.normal, densities, pdfs)
            }
        }
    }

    /// As [`super::Emitters::chain_end_on`], for a point with the normal `normal` on its front side; `pdf` is the
    /// density of light subpaths there without the choice of the emitter.
    #[inline]
    pub fn chain_end_on(
        &self,
        bounds: (Vec3A, f32),
        position: Vec3A,
        normal: Vec3A,
        pdf: f32,
        pdfs: [f32; 2],
    ) -> ChainEnd {
        let pdf = f64::from(pdf);
        let own = match &self.surface {
            Surface::Sphere(sphere) => {
                let outward = if sphere.inward { -normal } else { normal };
                Cap::facing(sphere, bounds).pdf(sphere, outward)
            }
            Surface::Mesh(_) => pdf,
        };
        self.chain_end(position, normal, [own, pdf], pdfs)
    }

    fn chain_end(
        &self,
        position: Vec3A,
        normal: Vec3A,
        [own, of_subpaths]: [f64; 2],
        pdfs: [f32; 2],
    ) -> ChainEnd {
        ChainEnd {
            end: on_surface(position, normal),
            radiance: self.radiance.mean(),
            pdf: f64::from(pdfs[0]) * own,
            pdf_position: f64::from(pdfs[1]) * of_subpaths,
            delta: false,
        }
    }

    /// As [`super::Emitters::sample_emission`].
    #[inline]
    pub fn sample_emission(
        &self,
        emitter: u32,
        u_primitive: f32,
        u_position: Vec2,
        u_direction: Vec2,
        choice_pdf: f32,
    ) -> EmissionSample {
        let (sample, radiance) = self.sample_light(u_primitive, u_position);
        let SurfaceSample {
            position,
            normal,
            pdf,
            ..
        } = sample;
        let pdf_position = choice_pdf * pdf;
        let local = square_to_cosine_hemisphere(u_direction);
        let direction = Frame::from_normal(normal).to_world(local);
        EmissionSample {
            emitter,
            origin: offset(position, normal, direction),
            position,
            normal,
            direction,
            // Le cos / (pdf_position * cos/pi): the cosine cancels.
            weight: radiance * (PI / pdf_position),
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
        let y0 = SurfaceSample {
            position: sample.position,
            normal: sample.normal,
            // Only densities are asked for.
            uv: Vec2::ZERO,
            pdf: sample.pdf_position,
        };
        self.light_toward(&y0, point, choice_pdf)
            .map_or(0.0, |(emission, _)| emission.pdf_direct)
    }

    /// As [`super::Emitters::evaluate_surface`].
    #[inline]
    pub fn evaluate(
        &self,
        surface: &SurfacePoint,
        from: Vec3A,
        choice_pdf: f32,
    ) -> Option<LightEvaluation> {
        let y0 = SurfaceSample {
            position: surface.position,
            normal: surface.geometric_normal,
            uv: surface.uv,
            pdf: choice_pdf * self.surface_pdf(surface.primitive),
        };
        let (emission, _) = self.light_toward(&y0, from, choice_pdf)?;
        Some(emission)
    }
}
