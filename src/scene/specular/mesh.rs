//! Chains of one vertex on a triangle mesh: a tree with bounding spheres and normal cones excludes most
//! triangles (Walter et al. 2009, section 4.1), and Newton's method searches the others.
//!
//! For a node with the bounding sphere (c, r), let a_D and a_y be the unit directions from c to the ends, and
//! H_c = eta_D a_D + eta_y a_y. The half vector of any point in the sphere differs from H_c by at most
//!
//!   e = 2 eta_D sin(d_D / 2) + 2 eta_y sin(d_y / 2),   sin d = r / distance of the end.
//!
//! A node whose normals lie in a cone of half-angle b around the axis a holds no solution if the angle between
//! H_c and the axis exceeds asin(e / |H_c|) + b.

use glam::{DVec3, Vec3A};

use super::chain::{Candidate, Endpoint, Lobes};
use super::newton::{Conditions, SmoothTriangle};
use crate::bvh::Corners;
use crate::scene::bsdf::DeltaLobe;

/// Triangles of a leaf.
const LEAF: usize = 2;

/// Slack of the bounds, for the rounding of f32.
const SLACK: f32 = 1e-4;

/// A triangle mesh that reflects or refracts without roughness.
#[derive(Debug)]
pub struct MeshCaster {
    pub shape: u32,
    /// Index of refraction of the side behind the normals over that of the other side; `None` if the mesh only
    /// reflects.
    pub eta: Option<f64>,
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
}

/// A triangle with vertex normals on its front side.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    pub corners: Corners,
    pub normals: [[f32; 3]; 3],
}

#[derive(Clone, Copy, Debug)]
struct Node {
    center: Vec3A,
    /// Unit axis of the cone of normals.
    axis: Vec3A,
    radius: f32,
    /// Sine and cosine of the half-angle of the cone; a cosine of -1 if there is no cone.
    sin_cone: f32,
    cos_cone: f32,
    /// Index of the first triangle of a leaf, or of the second child; the first child follows its parent.
    index: u32,
    /// Number of triangles; 0 for an inner node.
    count: u32,
}

/// A kind of vertex: its lobe, and the side of the mesh on which D is.
#[derive(Clone, Copy)]
struct Kind {
    lobe: DeltaLobe,
    /// 1 if D is on the front side, -1 if it is behind.
    side: f32,
    /// eta_D and eta_y.
    indices: [f32; 2],
}

impl MeshCaster {
    /// The caster of the triangles of a shape; `None` without triangles.
    pub fn new(shape: u32, eta: Option<f64>, mut triangles: Vec<Triangle>) -> Option<Self> {
        if triangles.is_empty() {
            return None;
        }
        let mut nodes = Vec::new();
        build(&mut triangles, 0, &mut nodes);
        Some(Self {
            shape,
            eta,
            nodes,
            triangles,
        })
    }

    /// Centre and radius of a sphere around the mesh.
    pub fn bounds(&self) -> (DVec3, f64) {
        let root = &self.nodes[0];
        (root.center.as_dvec3(), f64::from(root.radius))
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.triangles[..])
    }

    fn kinds(&self) -> impl Iterator<Item = Kind> {
        let eta = self.eta.map(|eta| eta as f32);
        let reflection = [1.0, -1.0].map(|side| Kind {
            lobe: DeltaLobe::Reflection,
            side,
            indices: [1.0, 1.0],
        });
        let refraction = eta.map(|eta| {
            [(1.0, [1.0, eta]), (-1.0, [eta, 1.0])].map(|(side, indices)| Kind {
                lobe: DeltaLobe::Transmission,
                side,
                indices,
            })
        });
        let reflects = eta != Some(1.0);
        let reflection = reflects.then_some(reflection);
        reflection.into_iter().chain(refraction).flatten()
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
            for kind in self.kinds() {
                kind.conditions(start, end)
                    .solve_by_brute_force(&triangle.smooth(), 8, |vertex| {
                        visit(self.candidate(start, vertex, kind))
                    });
            }
        }
    }

    fn candidate(&self, start: DVec3, vertex: DVec3, kind: Kind) -> Candidate {
        Candidate {
            direction: (vertex - start).normalize(),
            lobes: Lobes::new(&[kind.lobe]),
            shape: self.shape,
        }
    }

    /// Calls `visit` with every chain of one vertex from `start` to `end`.
    pub fn chains(&self, start: DVec3, end: &Endpoint, mut visit: impl FnMut(Candidate)) {
        let mut kinds = [None; 4];
        for (slot, kind) in kinds.iter_mut().zip(self.kinds()) {
            *slot = Some(kind);
        }
        let query = Query {
            start: start.as_vec3a(),
            end: match end {
                Endpoint::Point { position, .. } => (position.as_vec3a(), false),
                Endpoint::Direction(direction) => (direction.as_vec3a(), true),
            },
            kinds,
        };
        let all = (0..4).filter(|&i| kinds[i].is_some());
        let all = all.fold(0u8, |mask, i| mask | 1 << i);
        let mut stack = [(0u32, 0u8); 64];
        stack[0] = (0, all);
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (index, mask) = stack[depth];
            let node = &self.nodes[index as usize];
            let mask = query.possible(node, mask);
            if mask == 0 {
                continue;
            }
            if node.count == 0 {
                stack[depth] = (node.index, mask);
                stack[depth + 1] = (index + 1, mask);
                depth += 2;
                continue;
            }
            let first = node.index as usize;
            for triangle in &self.triangles[first..first + node.count as usize] {
                self.solve(triangle, (start, end), &kinds, mask, &mut visit);
            }
        }
    }

    fn solve(
        &self,
        triangle: &Triangle,
        (start, end): (DVec3, &Endpoint),
        kinds: &[Option<Kind>; 4],
        mask: u8,
        visit: &mut impl FnMut(Candidate),
    ) {
        let triangle = triangle.smooth();
        for (i, kind) in kinds.iter().enumerate() {
            let Some(kind) = kind.filter(|_| mask & 1 << i != 0) else {
                continue;
            };
            kind.conditions(start, end).solve(&triangle, |vertex| {
                visit(self.candidate(start, vertex, kind));
            });
        }
    }
}

impl Kind {
    fn conditions<'a>(&self, start: DVec3, end: &'a Endpoint) -> Conditions<'a> {
        Conditions {
            start,
            end,
            indices: self.indices.map(f64::from),
            side: f64::from(self.side),
            end_side: match self.lobe {
                DeltaLobe::Reflection => 1.0,
                DeltaLobe::Transmission => -1.0,
            },
        }
    }
}

/// The two ends of the chains that are sought.
struct Query {
    start: Vec3A,
    /// Position, or direction if the flag is set.
    end: (Vec3A, bool),
    kinds: [Option<Kind>; 4],
}

impl Query {
    /// The kinds in `mask` that a node may hold.
    #[inline]
    fn possible(&self, node: &Node, mask: u8) -> u8 {
        let Some(start) = Seen::from(node, self.start) else {
            return mask;
        };
        let end = if self.end.1 {
            Seen::at_infinity(self.end.0)
        } else {
            match Seen::from(node, self.end.0) {
                Some(seen) => seen,
                None => return mask,
            }
        };
        let cosines = [node.axis.dot(start.direction), node.axis.dot(end.direction)];
        let mut possible = 0;
        for (i, kind) in self.kinds.iter().enumerate() {
            let Some(kind) = kind.as_ref().filter(|_| mask & 1 << i != 0) else {
                continue;
            };
            let end_side = match kind.lobe {
                DeltaLobe::Reflection => kind.side,
                DeltaLobe::Transmission => -kind.side,
            };
            if start.faces(node, kind.side * cosines[0])
                && end.faces(node, end_side * cosines[1])
                && half_vector_fits(node, kind, [&start, &end])
            {
                possible |= 1 << i;
            }
        }
        possible
    }
}

/// False if the angle between the half vector and the normals excludes a solution in `node`.
#[inline]
fn half_vector_fits(node: &Node, kind: &Kind, [start, end]: [&Seen; 2]) -> bool {
    let [eta_start, eta_end] = kind.indices;
    let h = eta_start * start.direction + eta_end * end.direction;
    let length_squared = h.length_squared();
    let error = (eta_start * start.chord + eta_end * end.chord) * (1.0 + SLACK) + SLACK;
    if error * error >= length_squared || node.cos_cone <= -1.0 {
        return true;
    }
    // H points to the denser side, and to the side of both ends for reflection.
    let sign = match kind.lobe {
        DeltaLobe::Transmission if eta_start < eta_end => -kind.side,
        DeltaLobe::Transmission | DeltaLobe::Reflection => kind.side,
    };
    // All sines and cosines times |H|.
    let length = length_squared.sqrt();
    let cos_error = (length_squared - error * error).sqrt();
    let cos_sum = cos_error * node.cos_cone - error * node.sin_cone;
    let sin_sum = error * node.cos_cone + cos_error * node.sin_cone;
    sin_sum < 0.0 || sign * node.axis.dot(h) >= cos_sum - SLACK * length
}

/// An end as seen from the centre of a node.
struct Seen {
    /// Unit.
    direction: Vec3A,
    /// Sine and cosine of the angle d by which the direction varies within the node.
    sin: f32,
    cos: f32,
    /// At least 2 sin(d / 2).
    chord: f32,
}

impl Seen {
    /// `None` if the point lies within the bounding sphere.
    #[inline]
    fn from(node: &Node, point: Vec3A) -> Option<Self> {
        let offset = point - node.center;
        let inverse = offset.length_recip();
        let sin = node.radius * inverse * (1.0 + SLACK);
        (sin < 1.0).then(|| Self {
            direction: offset * inverse,
            sin,
            cos: (1.0 - sin * sin).sqrt(),
            // 2 sin(d / 2) = sin d / cos(d / 2), which is sqrt(2) for a right angle.
            chord: sin * (1.0 + (std::f32::consts::SQRT_2 - 1.0) * sin * sin),
        })
    }

    #[inline]
    fn at_infinity(direction: Vec3A) -> Self {
        Self {
            direction,
            sin: 0.0,
            cos: 1.0,
            chord: 0.0,
        }
    }

    /// True if some normal of `node` can make an angle of less than a right angle with the direction to the
    /// end; `cos` is the cosine between the axis and the direction from the centre.
    #[inline]
    fn faces(&self, node: &Node, cos: f32) -> bool {
        // cos(90 degrees + b + d) = -sin(b + d), if b + d < 90 degrees.
        let cos_sum = node.cos_cone * self.cos - node.sin_cone * self.sin;
        let sin_sum = node.sin_cone * self.cos + node.cos_cone * self.sin;
        cos_sum <= 0.0 || cos >= -sin_sum - SLACK
    }
}

impl Triangle {
    fn smooth(&self) -> SmoothTriangle {
        let [p0, p1, p2] = self.corners.map(|p| DVec3::from_array(p.map(f64::from)));
        let [n0, n1, n2] = self.normals.map(|n| DVec3::from_array(n.map(f64::from)));
        SmoothTriangle {
            corner: p0,
            edges: [p1 - p0, p2 - p0],
            normal: n0,
            slopes: [n1 - n0, n2 - n0],
        }
    }
}

/// Appends the tree over `triangles`, the first of which has the index `first`, to `nodes`.
fn build(triangles: &mut [Triangle], first: u32, nodes: &mut Vec<Node>) {
    let index = nodes.len();
    nodes.push(bound(triangles, first));
    if triangles.len() <= LEAF {
        return;
    }
    let centroid = |t: &Triangle| t.corners.map(Vec3A::from_array).iter().sum::<Vec3A>() / 3.0;
    let (min, max) = triangles
        .iter()
        .map(centroid)
        .fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(min, max), c| {
            (min.min(c), max.max(c))
        });
    let extent = max - min;
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    let half = triangles.len() / 2;
    triangles.select_nth_unstable_by(half, |a, b| centroid(a)[axis].total_cmp(&centroid(b)[axis]));
    let (left, right) = triangles.split_at_mut(half);
    build(left, first, nodes);
    nodes[index].index = nodes.len() as u32;
    nodes[index].count = 0;
    build(right, first + half as u32, nodes);
}

/// The leaf of `triangles`.
fn bound(triangles: &[Triangle], first: u32) -> Node {
    let corners = || {
        let all = triangles.iter().flat_map(|t| t.corners);
        all.map(Vec3A::from_array)
    };
    let (min, max) = corners().fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(min, max), p| {
        (min.min(p), max.max(p))
    });
    let center = 0.5 * (min + max);
    let radius = corners().map(|p| p.distance(center)).fold(0.0, f32::max);
    let normals = || {
        let all = triangles.iter().flat_map(|t| t.normals);
        all.filter_map(|n| Vec3A::from_array(n).try_normalize())
    };
    let axis = normals().sum::<Vec3A>().normalize_or(Vec3A::Z);
    let cos = normals().map(|n| n.dot(axis)).fold(1.0, f32::min);
    // Interpolated normals stay within a cone narrower than a hemisphere.
    let (cos_cone, sin_cone) = if cos > 0.0 {
        let cos = (cos - SLACK).max(0.0);
        (cos, (1.0 - cos * cos).sqrt())
    } else {
        (-1.0, 0.0)
    };
    Node {
        center,
        axis,
        radius: radius * (1.0 + SLACK),
        sin_cone,
        cos_cone,
        index: first,
        count: triangles.len() as u32,
    }
}
