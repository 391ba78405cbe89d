//! Chains of one vertex on a triangle mesh: a tree ([`cone_tree`](super::cone_tree)) excludes most triangles, and
//! Newton's method ([`newton`](super::newton)) searches the others.

use glam::DVec3;

use super::chain::{Candidate, Endpoint, Lobes};
use super::cone_tree::{ConeTree, Query, Triangle};
use super::kind::{Kind, Kinds};
use super::newton::{Conditions, SmoothTriangle};
use super::route::Route;

/// A triangle mesh that reflects or refracts without roughness.
#[derive(Debug)]
pub struct MeshCaster {
    pub shape: u32,
    kinds: Kinds,
    tree: ConeTree,
    triangles: Vec<Triangle>,
    /// The primitive of each triangle, and the index of the triangle, in the order of the primitives.
    indices: Vec<(u32, u32)>,
}

impl MeshCaster {
    /// The caster of the triangles of a shape; `None` without triangles. `eta` is the index of refraction of the
    /// side behind the normals over that of the other side; `None` if the mesh only reflects.
    pub fn new(shape: u32, eta: Option<f64>, mut triangles: Vec<Triangle>) -> Option<Self> {
        let tree = ConeTree::new(&mut triangles)?;
        let primitives = triangles.iter().map(|triangle| triangle.primitive);
        let mut indices: Vec<(u32, u32)> = primitives.zip(0..).collect();
        indices.sort_unstable();
        Some(Self {
            shape,
            kinds: Kinds::new(eta),
            tree,
            triangles,
            indices,
        })
    }

    /// Centre and radius of a sphere around the mesh.
    pub fn bounds(&self) -> (DVec3, f64) {
        self.tree.bounds()
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + size_of_val(&self.triangles[..]) + size_of_val(&self.indices[..])
    }

    /// Calls `visit` with every chain of one vertex from `start` to `end`.
    pub fn chains(&self, start: DVec3, end: &Endpoint, mut visit: impl FnMut(Candidate)) {
        let query = Query::new(start, end, &self.kinds);
        self.tree.visit(&query, |triangle, mask| {
            self.solve(triangle as usize, (start, end), mask, &mut visit);
        });
    }

    /// As [`Self::chains`] for those with the triangle and the lobe of `route`.
    pub fn chains_along(
        &self,
        start: DVec3,
        end: &Endpoint,
        route: &Route,
        mut visit: impl FnMut(Candidate),
    ) {
        let ([primitive], [lobe]) = (&route.primitives[..], route.lobes.as_slice()) else {
            return;
        };
        let at = self.indices.binary_search_by_key(primitive, |pair| pair.0);
        let Ok(at) = at else { return };
        let triangle = self.indices[at].1;
        let query = Query::new(start, end, &self.kinds);
        let mask = self.tree.possible(&query, triangle) & self.kinds.mask_of(*lobe);
        self.solve(triangle as usize, (start, end), mask, &mut visit);
    }

    /// As [`Self::chains`], without the tree and from many starts in every triangle.
    #[cfg(test)]
    pub fn chains_by_brute_force(
        &self,
        start: DVec3,
        end: &Endpoint,
        mut visit: impl FnMut(Candidate),
    ) {
        for triangle in &self.triangles {
            for (_, kind) in self.kinds.iter(u8::MAX) {
                Conditions::new(start, end, kind).solve_by_brute_force(
                    &SmoothTriangle::from(triangle),
                    8,
                    |vertex| visit(self.candidate(start, vertex, kind)),
                );
            }
        }
    }

    fn solve(
        &self,
        triangle: usize,
        (start, end): (DVec3, &Endpoint),
        mask: u8,
        visit: &mut impl FnMut(Candidate),
    ) {
        let triangle = SmoothTriangle::from(&self.triangles[triangle]);
        for (_, kind) in self.kinds.iter(mask) {
            Conditions::new(start, end, kind).solve(&triangle, |vertex| {
                visit(self.candidate(start, vertex, kind));
            });
        }
    }

    fn candidate(&self, start: DVec3, vertex: DVec3, kind: &Kind) -> Candidate {
        Candidate {
            direction: (vertex - start).normalize(),
            lobes: Lobes::new(&[kind.lobe]),
            shape: self.shape,
        }
    }
}
