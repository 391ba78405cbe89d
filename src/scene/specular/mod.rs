//! Chains of delta vertices between two given points: the geometry of next event estimation through smooth
//! glass and mirrors.
//!
//! [`Casters`] finds them for the shapes of a scene without a random number: on a triangle mesh the chains of
//! one vertex (`mesh`, `newton`), through a sphere those of up to three (`sphere`), through a shape of a few
//! flat faces those of up to three (`flat`). All vertices of a chain lie on one shape. What a finder proposes is
//! followed by rays ([`chain`]), so that every chain is one that a subpath could take.
//!
//! ```
//! use metrolight::scene::specular::{Candidate, Endpoint};
//!
//! let path = std::path::Path::new("scenes/pool/scene.xml");
//! let scene = metrolight::mitsuba::load(path, &[])?.description.build()?;
//! // From below the water to above it, light takes one way through waves that are low.
//! let below = glam::DVec3::new(0.0, -0.3, 0.0);
//! let end = Endpoint::Direction(glam::DVec3::Y);
//! let mut candidates: Vec<Candidate> = Vec::new();
//! scene.casters.chains(below, &end, &mut candidates);
//! assert_eq!(candidates.len() % 2, 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod chain;
mod cone_tree;
mod differential;
mod flat;
mod kind;
mod mesh;
mod newton;
mod plane;
mod refraction;
mod route;
mod sphere;
mod unfolding;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use glam::{DVec3, Vec3A};

pub use chain::{Candidate, Chain, Endpoint, Lobes};
pub use route::Route;

use self::cone_tree::Triangle;
use self::flat::FlatCaster;
use self::mesh::MeshCaster;
use self::sphere::SphereCaster;
use super::bsdf::Material;
use super::geometry::Geometry;
use crate::bvh::Primitive;

/// Largest angle, as a distance of unit vectors, between the normals of a triangle that counts as flat.
const FLAT: f64 = 1e-5;

/// A shape that reflects or refracts without roughness.
#[derive(Debug)]
enum Caster {
    Mesh(MeshCaster),
    Flat(FlatCaster),
    Sphere(SphereCaster),
}

/// All casters of a scene.
#[derive(Debug)]
pub struct Casters {
    /// In the order of their shapes.
    casters: Vec<Caster>,
    max_length: usize,
    search: ChainSearch,
}

/// The vertices from which bidirectional methods seek chains. Path tracing seeks them from every vertex unless they
/// are off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChainSearch {
    /// None.
    Off,
    /// Those that no other technique connects.
    #[default]
    Unconnected,
    /// All.
    Everywhere,
}

impl Casters {
    /// The casters of `geometry`.
    pub(super) fn new(geometry: &Geometry, materials: &[Material]) -> Self {
        let material = |shape: u32| &materials[geometry.material(shape) as usize];
        let mut triangles: BTreeMap<u32, Vec<(Triangle, DVec3)>> = BTreeMap::new();
        let mut casters = Vec::new();
        let is_caster = |shape: u32| material(shape).is_caster();
        for (index, primitive, normals) in geometry.primitives(is_caster) {
            match primitive {
                Primitive::Triangle(triangle) => {
                    let front = geometry.triangle_normal(&triangle).as_dvec3();
                    let normals = normals.unwrap_or([front; 3]);
                    let own = Triangle {
                        primitive: index,
                        corners: triangle.corners,
                        normals: normals.map(|n| n.as_vec3().to_array()),
                    };
                    triangles
                        .entry(triangle.shape)
                        .or_default()
                        .push((own, front));
                }
                Primitive::Sphere(sphere) => casters.push(Caster::Sphere(SphereCaster {
                    center: DVec3::from_array(sphere.center.map(f64::from)),
                    radius: f64::from(sphere.radius),
                    shape: sphere.shape,
                    eta: material(sphere.shape).smooth_refraction().map(|eta| {
                        // A sphere whose normals point inward has its inside in front.
                        let eta = f64::from(eta);
                        if geometry.is_flipped(sphere.shape) {
                            eta.recip()
                        } else {
                            eta
                        }
                    }),
                })),
            }
        }
        for (shape, triangles) in triangles {
            let eta = material(shape).smooth_refraction().map(f64::from);
            casters.extend(of_triangles(shape, eta, triangles));
        }
        casters.sort_by_key(Caster::shape);
        let lengths = casters.iter().map(Caster::max_length);
        let max_length = lengths.max().unwrap_or(0);
        Self {
            casters,
            max_length,
            search: ChainSearch::default(),
        }
    }

    /// True if no chain is sought: no shape reflects or refracts without roughness, or the search is off.
    pub fn is_empty(&self) -> bool {
        self.casters.is_empty() || self.search == ChainSearch::Off
    }

    /// The vertices from which chains are sought.
    #[inline]
    pub fn search(&self) -> ChainSearch {
        self.search
    }

    /// Sets [`Self::search`].
    pub fn set_search(&mut self, search: ChainSearch) {
        self.search = search;
    }

    /// True if bidirectional methods seek chains from every vertex.
    #[inline]
    pub fn everywhere(&self) -> bool {
        self.search == ChainSearch::Everywhere
    }

    /// Maximum number of vertices of a chain; 0 without casters.
    pub fn max_length(&self) -> usize {
        self.max_length
    }

    /// Replaces `candidates` by all chains from `start` to `end`, in scene units.
    #[inline]
    pub fn chains(&self, start: DVec3, end: &Endpoint, candidates: &mut Vec<Candidate>) {
        candidates.clear();
        for caster in &self.casters {
            caster.chains(start, end, candidates);
        }
    }

    /// The chain along `route` as [`Self::chains`] returns it; `None` if it does not. `candidates` is memory.
    #[inline]
    pub fn find(
        &self,
        start: DVec3,
        end: &Endpoint,
        route: &Route,
        candidates: &mut Vec<Candidate>,
    ) -> Option<Candidate> {
        let caster = self.on_shape(route.shape)?;
        candidates.clear();
        caster.chains_along(start, end, route, candidates);
        if let Some(found) = route.nearest(candidates) {
            return Some(*found);
        }
        // Rounding may have put a vertex on a primitive beside that of the solution.
        candidates.clear();
        caster.chains(start, end, candidates);
        route.nearest(candidates).copied()
    }

    /// The caster of a shape.
    fn on_shape(&self, shape: u32) -> Option<&Caster> {
        let index = self.casters.binary_search_by_key(&shape, Caster::shape);
        index.ok().map(|index| &self.casters[index])
    }

    /// As [`Self::chains`] for meshes, by brute force.
    #[cfg(test)]
    fn chains_by_brute_force(&self, start: DVec3, end: &Endpoint) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        for caster in &self.casters {
            if let Caster::Mesh(mesh) = caster {
                mesh.chains_by_brute_force(start, end, |candidate| candidates.push(candidate));
            }
        }
        candidates
    }

    /// Maximum number of vertices of the chains that are sought on a shape; 0 if it is no caster.
    pub fn max_length_on(&self, shape: u32) -> usize {
        if self.is_empty() {
            return 0;
        }
        self.on_shape(shape).map_or(0, Caster::max_length)
    }

    /// Cost of a search for chains, in rays, as measured on the scenes of the repository.
    pub fn search_cost(&self) -> f64 {
        let cost = |caster: &Caster| match caster {
            Caster::Mesh(_) | Caster::Sphere(_) => 15.0,
            Caster::Flat(flat) => 1.2 * (flat.face_count() as f64).powi(2),
        };
        self.casters.iter().map(cost).sum()
    }

    /// Centre and radius of a sphere around all casters; `None` without casters.
    pub(super) fn bounds(&self) -> Option<(Vec3A, f32)> {
        let spheres: Vec<(DVec3, f64)> = self
            .casters
            .iter()
            .map(|caster| match caster {
                Caster::Mesh(mesh) => mesh.bounds(),
                Caster::Flat(flat) => flat.bounds(),
                Caster::Sphere(sphere) => (sphere.center, sphere.radius),
            })
            .collect();
        let (min, max) = spheres.iter().fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(min, max), &(center, radius)| (min.min(center - radius), max.max(center + radius)),
        );
        let center = 0.5 * (min + max);
        let reach = spheres.iter().map(|(c, r)| c.distance(center) + r);
        let radius = reach.fold(0.0, f64::max);
        (!spheres.is_empty()).then(|| (center.as_vec3a(), radius as f32))
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        let own = size_of_val(&self.casters[..]);
        let of_meshes = self.casters.iter().map(|caster| match caster {
            Caster::Mesh(mesh) => mesh.bytes(),
            Caster::Flat(_) | Caster::Sphere(_) => 0,
        });
        own + of_meshes.sum::<usize>()
    }
}

impl Caster {
    /// Appends all chains from `start` to `end` to `found`.
    fn chains(&self, start: DVec3, end: &Endpoint, found: &mut Vec<Candidate>) {
        let push = |candidate| found.push(candidate);
        match self {
            Self::Mesh(mesh) => mesh.chains(start, end, push),
            Self::Flat(flat) => flat.chains(start, end, push),
            Self::Sphere(sphere) => sphere.chains(start, end, push),
        }
    }

    /// As [`Self::chains`] for those whose vertices have the primitives and lobes of `route`.
    fn chains_along(
        &self,
        start: DVec3,
        end: &Endpoint,
        route: &Route,
        found: &mut Vec<Candidate>,
    ) {
        let push = |candidate| found.push(candidate);
        match self {
            Self::Mesh(mesh) => mesh.chains_along(start, end, route, push),
            Self::Flat(flat) => flat.chains_along(start, end, route, push),
            Self::Sphere(sphere) => sphere.chains_along(start, end, route, push),
        }
    }

    fn shape(&self) -> u32 {
        match self {
            Self::Mesh(mesh) => mesh.shape,
            Self::Flat(flat) => flat.shape,
            Self::Sphere(sphere) => sphere.shape,
        }
    }

    fn max_length(&self) -> usize {
        match self {
            Self::Mesh(_) => 1,
            Self::Flat(flat) => flat.max_length(),
            Self::Sphere(_) => chain::MAX_LENGTH,
        }
    }
}

/// The caster of a shape's triangles, with their front normals: faces if they are few and flat.
fn of_triangles(shape: u32, eta: Option<f64>, triangles: Vec<(Triangle, DVec3)>) -> Option<Caster> {
    let is_flat = |(triangle, front): &(Triangle, DVec3)| {
        let normals = triangle
            .normals
            .map(|n| DVec3::from_array(n.map(f64::from)));
        normals.iter().all(|n| n.distance(*front) < FLAT)
    };
    if triangles.iter().all(is_flat) {
        let faces = triangles
            .iter()
            .map(|(triangle, front)| (triangle.primitive, triangle.corners, *front));
        if let Some(flat) = FlatCaster::new(shape, eta, faces) {
            return Some(Caster::Flat(flat));
        }
    }
    let triangles = triangles
        .into_iter()
        .map(|(triangle, _)| triangle)
        .collect();
    MeshCaster::new(shape, eta, triangles).map(Caster::Mesh)
}
