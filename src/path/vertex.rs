//! Surface vertices of subpaths.

use glam::{Vec2, Vec3A};

use super::mis::PartialMis;
use crate::fault::{Fault, planted};
use crate::math::Rgb;
use crate::scene::{
    BsdfEvaluation, BsdfSample, LightEvaluation, Material, Scene, SurfacePoint, TransportMode,
};

/// A surface vertex of a subpath.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// The point.
    pub surface: SurfacePoint,
    /// Index of its material.
    pub material: u32,
    /// Unit direction to the previous vertex of the subpath, in world coordinates.
    pub to_previous: Vec3A,
    /// Veach's alpha: importance over the density of a camera subpath, or radiance over the density of a
    /// light subpath.
    pub throughput: Rgb,
    /// Partial sums for MIS weights.
    pub mis: PartialMis,
}

/// The BSDF at a vertex, evaluated for the directions to its predecessor and to a connected vertex.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    /// f times the cosines that the geometric term leaves to this vertex: for a camera vertex
    /// f |w_i . N_s|, for a light vertex f |w_o . N_g| |w_i . N_s| / |w_i . N_g|, where w_i points to
    /// the light and w_o to the camera (Veach 1997, section 5.3: the adjoint for shading normals).
    pub value: Rgb,
    /// Density of sampling the direction of the connection given the predecessor, per steradian.
    pub pdf_forward: f32,
    /// Density of sampling the predecessor's direction given that of the connection, per steradian.
    pub pdf_reverse: f32,
    /// [`Vertex::abs_cos`] of the direction of the connection.
    pub cos: f32,
}

impl Scatter {
    /// [`Vertex::density`] of this vertex when the other end of the connection samples it with `pdf`.
    #[inline]
    pub fn density(&self, pdf: f32, distance_squared: f64) -> f64 {
        density_per_area(f64::from(pdf), self.cos, distance_squared)
    }
}

/// Density per unit area of a point that a direction of density `pdf` per steradian hits at the squared
/// distance `distance_squared`, under the cosine `cos` (pbrt, 4th ed., section 13.2.2 "Integrals over area").
#[inline]
fn density_per_area(pdf: f64, cos: f32, distance_squared: f64) -> f64 {
    pdf * f64::from(cos) / distance_squared
}

/// A direction sampled at a vertex.
#[derive(Clone, Copy, Debug)]
pub struct DirectionSample {
    /// Unit, in world coordinates.
    pub direction: Vec3A,
    /// [`Vertex::abs_cos`] of the direction.
    pub cos: f32,
    /// The BSDF times the cosine over the density, with the adjoint's factor on light subpaths.
    pub weight: Rgb,
    /// Densities and the kind of the lobe; its direction is in the shading frame.
    pub bsdf: BsdfSample,
}

impl Vertex {
    /// Position, from which directions and distances are measured.
    #[inline]
    pub fn position(&self) -> Vec3A {
        self.surface.position
    }

    /// The factor of this vertex in the geometric term G: the absolute cosine between `direction` (unit)
    /// and the geometric normal.
    #[inline]
    pub fn abs_cos(&self, direction: Vec3A) -> f32 {
        self.surface.geometric_normal.dot(direction).abs()
    }

    /// Density of this vertex per unit area. `pdf` is the density per steradian of the direction toward
    /// it, sampled at a point whose squared distance is `distance_squared`.
    #[inline]
    pub fn density(&self, pdf: f64, direction: Vec3A, distance_squared: f64) -> f64 {
        density_per_area(pdf, self.abs_cos(direction), distance_squared)
    }

    /// The point from which rays leave in `direction` (unit, world coordinates).
    #[inline]
    pub fn ray_origin(&self, direction: Vec3A) -> Vec3A {
        self.surface.ray_origin(direction)
    }

    /// Light emitted toward the point `previous`; `None` if the vertex is on no emitter that emits there.
    #[inline]
    pub fn emission(&self, scene: &Scene, previous: Vec3A) -> Option<LightEvaluation> {
        scene.emitters.evaluate_surface(&self.surface, previous)
    }

    /// The material.
    #[inline]
    pub fn material<'a>(&self, scene: &'a Scene) -> &'a Material {
        &scene.materials[self.material as usize]
    }

    /// True if the material has a lobe that explicit connections can use.
    #[inline]
    pub fn is_connectible(&self, scene: &Scene) -> bool {
        self.material(scene).is_connectible()
    }

    /// Samples the direction in which the subpath continues; `mode` is that of the subpath. `None` if it
    /// is absorbed.
    #[inline]
    pub fn sample(
        &self,
        scene: &Scene,
        mode: TransportMode,
        u_lobe: f32,
        u_direction: Vec2,
    ) -> Option<DirectionSample> {
        let surface = &self.surface;
        let previous = surface.shading.to_local(self.to_previous);
        let context = scene.material_context(surface);
        let bsdf = self
            .material(scene)
            .sample(&context, previous, mode, u_lobe, u_direction)?;
        let direction = surface.shading.to_world(bsdf.direction);
        let cos = self.abs_cos(direction);
        let mut weight = bsdf.weight;
        if mode == TransportMode::Importance && !planted(Fault::AdjointLeftOut) {
            // Adjoint BSDF for shading normals (Veach 1997, eq. 5.19).
            let cos_ratio = if bsdf.direction.z == 0.0 {
                0.0
            } else {
                cos / bsdf.direction.z
            };
            weight *= self.shading_over_geometric_cos(previous.z) * cos_ratio.abs();
        }
        Some(DirectionSample {
            direction,
            cos,
            weight,
            bsdf,
        })
    }

    /// Evaluates the BSDF for the predecessor and `direction` (unit, world coordinates). `mode` is that
    /// of the subpath.
    #[inline]
    pub fn scatter(&self, scene: &Scene, direction: Vec3A, mode: TransportMode) -> Scatter {
        let surface = &self.surface;
        let previous = surface.shading.to_local(self.to_previous);
        let next = surface.shading.to_local(direction);
        let material = self.material(scene);
        let context = scene.material_context(surface);
        let cos = self.abs_cos(direction);
        match mode {
            TransportMode::Radiance => {
                let BsdfEvaluation {
                    f,
                    pdf_to_light,
                    pdf_to_camera,
                } = material.evaluate(&context, next, previous);
                Scatter {
                    value: f * next.z.abs(),
                    pdf_forward: pdf_to_light,
                    pdf_reverse: pdf_to_camera,
                    cos,
                }
            }
            TransportMode::Importance => {
                let BsdfEvaluation {
                    f,
                    pdf_to_light,
                    pdf_to_camera,
                } = material.evaluate(&context, previous, next);
                Scatter {
                    value: f * (cos * self.shading_over_geometric_cos(previous.z)),
                    pdf_forward: pdf_to_camera,
                    pdf_reverse: pdf_to_light,
                    cos,
                }
            }
        }
    }

    /// |w_i . N_s| / |w_i . N_g| for the direction w_i to the previous vertex, where `shading_cos` is
    /// w_i . N_s. It is 1 without shading normals.
    #[inline]
    pub fn shading_over_geometric_cos(&self, shading_cos: f32) -> f32 {
        let geometric_cos = self.surface.geometric_normal.dot(self.to_previous);
        if planted(Fault::AdjointLeftOut) {
            1.0
        } else if geometric_cos == 0.0 {
            0.0
        } else {
            (shading_cos / geometric_cos).abs()
        }
    }
}
