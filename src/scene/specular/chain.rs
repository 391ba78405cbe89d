//! Chains of delta vertices between two points: what finders propose, and what a ray finds when it follows
//! the proposal.

use glam::{DVec3, Vec3A};

use super::differential::RayDifferential;
use crate::math::Rgb;
use crate::scene::bsdf::{DeltaLobe, TransportMode};
use crate::scene::{Ray, RayCounts, Scene, SurfacePoint};

/// Maximum number of delta vertices of a chain.
pub const MAX_LENGTH: usize = 3;

/// Relative distance by which a chain may miss its end. Finders solve in f64; what remains is the rounding of
/// f32 in the scene.
const MISS_TOLERANCE: f32 = 1e-3;

/// The end of a chain on an emitter.
#[derive(Clone, Copy, Debug)]
pub enum Endpoint {
    /// A point in scene units; on a surface with this unit normal, or a point light.
    Point {
        /// In scene units.
        position: DVec3,
        /// Of the surface; `None` for a point light.
        normal: Option<DVec3>,
    },
    /// The unit direction to an emitter at infinity.
    Direction(DVec3),
}

impl Endpoint {
    /// Unit direction from `point` to the end, and the distance (infinite for a direction).
    #[inline]
    pub fn from(&self, point: DVec3) -> (DVec3, f64) {
        match self {
            Self::Point { position, .. } => {
                let offset = *position - point;
                let distance = offset.length();
                (offset / distance, distance)
            }
            Self::Direction(direction) => (*direction, f64::INFINITY),
        }
    }
}

/// The lobes of a chain, in the order from its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lobes {
    lobes: [DeltaLobe; MAX_LENGTH],
    len: usize,
}

impl Lobes {
    /// These lobes; at most [`MAX_LENGTH`].
    pub fn new(lobes: &[DeltaLobe]) -> Self {
        let mut all = [DeltaLobe::Reflection; MAX_LENGTH];
        all[..lobes.len()].copy_from_slice(lobes);
        Self {
            lobes: all,
            len: lobes.len(),
        }
    }

    /// All of them.
    #[inline]
    pub fn as_slice(&self) -> &[DeltaLobe] {
        &self.lobes[..self.len]
    }
}

/// A chain that a finder proposes: all its vertices lie on one shape.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Unit direction in which it leaves its start.
    pub direction: DVec3,
    /// The lobes of its vertices.
    pub lobes: Lobes,
    /// Index of the shape.
    pub shape: u32,
}

/// A chain of delta vertices x_n ... x_1 from a point D to a point y on an emitter.
#[derive(Clone, Copy, Debug)]
pub struct Chain {
    /// Unit direction from D to x_n.
    pub direction: Vec3A,
    /// x_n, the vertex after D.
    pub first: SurfacePoint,
    /// x_1, the vertex before y.
    pub last: SurfacePoint,
    /// Unit direction from x_1 to y.
    pub to_end: Vec3A,
    /// n.
    pub length: usize,
    /// Product of the weights of the delta lobes times their probabilities, for radiance.
    pub throughput: Rgb,
    /// Product of the probabilities of the lobes.
    pub probability: f64,
    /// T: solid angle at D per area at y (per steradian at infinity; for a point light, per area
    /// perpendicular to the ray).
    pub jacobian: f64,
}

impl Candidate {
    /// Follows the candidate from `start` as a camera subpath would; `None` if a ray does not find it. Whether
    /// x_1 and y are mutually visible is left open.
    pub fn follow(
        &self,
        scene: &Scene,
        start: &SurfacePoint,
        end: &Endpoint,
        counts: &mut RayCounts,
    ) -> Option<Chain> {
        let first_direction = self.direction.as_vec3a();
        let mut direction = first_direction;
        let mut from = start.position;
        let mut origin = start.ray_origin(direction);
        let mut differential = RayDifferential::at_start(self.direction);
        let (mut throughput, mut probability) = (Rgb::ONE, 1.0);
        let mut ends: Option<[SurfacePoint; 2]> = None;
        for &lobe in self.lobes.as_slice() {
            let ray = Ray {
                origin,
                direction,
                t_max: f32::INFINITY,
            };
            let point = scene.geometry.intersect(&ray, counts)?;
            if point.shape != self.shape {
                return None;
            }
            let material = &scene.materials[scene.geometry.material(point.shape) as usize];
            let local = point.shading.to_local(-direction);
            let mode = TransportMode::Radiance;
            let sample = material.sample_delta(&scene.textures, point.uv, local, mode, lobe)?;
            let along = direction.as_dvec3();
            let distance = f64::from((point.position - from).length());
            differential.transfer(along, distance, point.geometric_normal.as_dvec3());
            let normal = point.shading.n.as_dvec3().normalize();
            let derivative = scene.geometry.normal_derivative(&point);
            match lobe {
                DeltaLobe::Reflection => differential.reflect(along, normal, &derivative),
                DeltaLobe::Transmission => {
                    let mu = f64::from(sample.eta).recip();
                    differential.refract(along, normal, &derivative, mu);
                }
            }
            throughput *= sample.weight * sample.pdf;
            probability *= f64::from(sample.pdf);
            direction = point.shading.to_world(sample.direction);
            from = point.position;
            origin = point.ray_origin(direction);
            ends = Some([ends.map_or(point, |[first, _]| first), point]);
        }
        let [first, last] = ends?;
        let (exact, distance) = end.from(last.position.as_dvec3());
        if (exact.as_vec3a() - direction).length() > MISS_TOLERANCE {
            return None;
        }
        let jacobian = match end {
            Endpoint::Point { normal, .. } => {
                differential.transfer(exact, distance, normal.unwrap_or(exact));
                differential.area().recip()
            }
            Endpoint::Direction(_) => differential.solid_angle().recip(),
        };
        (jacobian.is_finite() && throughput != Rgb::ZERO).then_some(Chain {
            direction: first_direction,
            first,
            last,
            to_end: exact.as_vec3a(),
            length: self.lobes.as_slice().len(),
            throughput,
            probability,
            jacobian,
        })
    }
}
