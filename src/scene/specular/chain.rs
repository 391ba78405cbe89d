//! Chains of delta vertices between two points: what finders propose, and what a ray finds when it follows
//! the proposal.

use arrayvec::ArrayVec;
use glam::{DVec3, Vec3A};

use super::differential::RayDifferential;
use crate::fault::{Fault, planted};
use crate::math::Rgb;
use crate::scene::bsdf::{DeltaLobe, TransportMode};
use crate::scene::geometry::NormalDerivative;
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

    /// The lobes `lobe(0)`, `lobe(1)`, ... of `len` vertices; at most [`MAX_LENGTH`].
    pub fn collect(len: usize, lobe: impl Fn(usize) -> DeltaLobe) -> Self {
        let lobes: ArrayVec<DeltaLobe, MAX_LENGTH> = (0..len).map(lobe).collect();
        Self::new(&lobes)
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
    /// The same from the other side: solid angle at y per area at D (for an emitter at infinity, area
    /// perpendicular to the ray per area at D).
    pub reverse_jacobian: f64,
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
        let (mut throughput, mut probability) = (Rgb::ONE, 1.0);
        let mut interfaces: ArrayVec<Interface, MAX_LENGTH> = ArrayVec::new();
        let mut last = *start;
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
            let context = scene.material_context(&point);
            let sample = material.sample_delta(&context, local, mode, lobe)?;
            let next = point.shading.to_world(sample.direction);
            interfaces.push(Interface {
                distance: f64::from((point.position - from).length()),
                geometric_normal: point.geometric_normal.as_dvec3(),
                normal: point.shading.n.as_dvec3().normalize(),
                derivative: scene.geometry.normal_derivative(&point),
                lobe,
                eta: f64::from(sample.eta),
                arriving: direction.as_dvec3(),
                leaving: next.as_dvec3(),
            });
            throughput *= sample.weight * sample.pdf;
            if !planted(Fault::ChainProbabilityLeftOut) {
                probability *= f64::from(sample.pdf);
            }
            if planted(Fault::ChainRadianceUnscaled) {
                throughput *= sample.eta * sample.eta;
            }
            direction = next;
            from = point.position;
            origin = point.ray_origin(direction);
            last = point;
        }
        let (exact, distance) = end.from(last.position.as_dvec3());
        if (exact.as_vec3a() - direction).length() > MISS_TOLERANCE {
            return None;
        }
        let jacobian = jacobian(self.direction, &interfaces, end, exact, distance);
        let factor = if planted(Fault::ChainJacobianOff) {
            0.8
        } else {
            1.0
        };
        let jacobian = factor * jacobian;
        let normal = start.geometric_normal.as_dvec3();
        (jacobian.is_finite() && throughput != Rgb::ZERO).then(|| Chain {
            direction: first_direction,
            last,
            to_end: exact.as_vec3a(),
            length: interfaces.len(),
            throughput,
            probability,
            jacobian,
            reverse_jacobian: reverse_jacobian(normal, &interfaces, end, exact, distance),
        })
    }
}

/// A delta vertex, as far as ray differentials depend on it.
struct Interface {
    /// From the vertex before it.
    distance: f64,
    geometric_normal: DVec3,
    /// Unit shading normal.
    normal: DVec3,
    derivative: NormalDerivative,
    lobe: DeltaLobe,
    /// Index of refraction of the side that is left over that of the side of arrival.
    eta: f64,
    /// Unit directions from the start to the end of the chain.
    arriving: DVec3,
    leaving: DVec3,
}

impl Interface {
    /// The differential of a ray that arrives along `direction`; `mu` is as for [`RayDifferential::refract`].
    fn scatter(&self, differential: &mut RayDifferential, direction: DVec3, mu: f64) {
        let (normal, derivative) = (self.normal, &self.derivative);
        match self.lobe {
            DeltaLobe::Reflection => differential.reflect(direction, normal, derivative),
            DeltaLobe::Transmission => differential.refract(direction, normal, derivative, mu),
        }
    }
}

/// T of a chain that leaves its start along `direction`, and its last vertex along `exact` over `distance`.
fn jacobian(
    direction: DVec3,
    interfaces: &[Interface],
    end: &Endpoint,
    exact: DVec3,
    distance: f64,
) -> f64 {
    let mut differential = RayDifferential::at_point(direction);
    for interface in interfaces {
        let arriving = interface.arriving;
        differential.transfer(arriving, interface.distance, interface.geometric_normal);
        interface.scatter(&mut differential, arriving, interface.eta.recip());
    }
    match end {
        Endpoint::Point { normal, .. } => {
            differential.transfer(exact, distance, normal.unwrap_or(exact));
            differential.area().recip()
        }
        Endpoint::Direction(_) => differential.solid_angle().recip(),
    }
}

/// [`Chain::reverse_jacobian`]; `normal` is the geometric normal at the start.
fn reverse_jacobian(
    normal: DVec3,
    interfaces: &[Interface],
    end: &Endpoint,
    exact: DVec3,
    distance: f64,
) -> f64 {
    let (mut differential, mut distance) = match end {
        Endpoint::Point { .. } => (RayDifferential::at_point(-exact), distance),
        // Parallel rays: the distance does not matter.
        Endpoint::Direction(_) => (RayDifferential::parallel(-exact), 0.0),
    };
    let mut direction = -exact;
    for interface in interfaces.iter().rev() {
        differential.transfer(direction, distance, interface.geometric_normal);
        interface.scatter(&mut differential, -interface.leaving, interface.eta);
        direction = -interface.arriving;
        distance = interface.distance;
    }
    differential.transfer(direction, distance, normal);
    differential.area().recip()
}
