//! A tree over the triangles of a mesh with bounding spheres and cones of normals (Walter, Zhao, Holzschuch and
//! Bala 2009, "Single scattering in refractive media with triangle mesh boundaries", section 4.1). All eight
//! children of a node are tested at once.
//!
//! For triangles with the bounding sphere (c, r), let a_D and a_y be the unit directions from c to the ends, and
//! H_c = eta_D a_D + eta_y a_y. The half vector of any point in the sphere differs from H_c by at most
//!
//!   e = 2 eta_D sin(d_D / 2) + 2 eta_y sin(d_y / 2),   sin d = r / distance of the end.
//!
//! Triangles whose normals lie in a cone of half-angle b around the axis a hold no solution if the angle between
//! H_c and the axis exceeds asin(e / |H_c|) + b.

use arrayvec::ArrayVec;
use glam::{DVec3, Vec3A};
use wide::f32x8;

use super::chain::Endpoint;
use super::kind::{COUNT, Kind, Kinds};
use crate::bvh::Corners;
use crate::scene::bsdf::DeltaLobe;

/// Children of a node.
const WIDTH: usize = 8;

/// Capacity of the stack: each of at most 32 / 3 levels leaves up to seven children there.
const STACK: usize = 128;

/// Marks a child that is a triangle.
const LEAF: u32 = 1 << 31;

/// Slack of the bounds, for the rounding of f32.
const SLACK: f32 = 1e-4;

/// A triangle with vertex normals on its front side.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    pub primitive: u32,
    pub corners: Corners,
    pub normals: [[f32; 3]; 3],
}

/// The tree.
#[derive(Debug)]
pub struct ConeTree {
    nodes: Vec<Node>,
    /// Where each node is a child; the first node is the root.
    node_places: Vec<Place>,
    /// Where each triangle is a child.
    triangle_places: Vec<Place>,
    bounds: (Vec3A, f32),
}

/// A child of a node.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    node: u32,
    child: u32,
}

/// The bounds of up to eight children, and the children.
#[derive(Clone, Copy, Debug)]
struct Node {
    center: [f32x8; 3],
    /// Unit axis of the cone of normals.
    axis: [f32x8; 3],
    radius: f32x8,
    /// Sine and cosine of the half-angle of the cone; a cosine of -1 if there is no cone.
    sin_cone: f32x8,
    cos_cone: f32x8,
    /// Indices of nodes, or of triangles with the mark [`LEAF`].
    children: [u32; WIDTH],
    /// Number of children.
    count: u32,
}

impl ConeTree {
    /// The tree over `triangles`, which it sorts; `None` without triangles.
    pub fn new(triangles: &mut [Triangle]) -> Option<Self> {
        if triangles.is_empty() {
            return None;
        }
        let whole = Bound::new(triangles);
        let mut tree = Self {
            nodes: Vec::new(),
            node_places: Vec::new(),
            triangle_places: vec![Place::default(); triangles.len()],
            bounds: (whole.center, whole.radius),
        };
        tree.build(triangles, 0, Place::default());
        Some(tree)
    }

    /// Centre and radius of a sphere around all triangles.
    pub fn bounds(&self) -> (DVec3, f64) {
        (self.bounds.0.as_dvec3(), f64::from(self.bounds.1))
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
            + size_of_val(&self.node_places[..])
            + size_of_val(&self.triangle_places[..])
    }

    /// Appends the node over `triangles`, the first of which has the index `first`, and its descendants; returns its index.
    fn build(&mut self, triangles: &mut [Triangle], first: usize, place: Place) -> u32 {
        let index = self.nodes.len() as u32;
        let groups = split(triangles);
        self.nodes.push(Node::new(&groups, triangles));
        self.node_places.push(place);
        for (child, &(start, end)) in (0..).zip(&groups) {
            let place = Place { node: index, child };
            let reference = if end - start == 1 {
                self.triangle_places[first + start] = place;
                (first + start) as u32 | LEAF
            } else {
                self.build(&mut triangles[start..end], first + start, place)
            };
            self.nodes[index as usize].children[child as usize] = reference;
        }
        index
    }

    /// Calls `visit` with the triangles that may hold a solution, each with a mask of its kinds.
    pub fn visit(&self, query: &Query, mut visit: impl FnMut(u32, u8)) {
        let mut stack = ArrayVec::<(u32, u8), STACK>::new();
        stack.push((0, query.kinds.all()));
        while let Some((index, mask)) = stack.pop() {
            let node = &self.nodes[index as usize];
            let possible = query.possible(node, mask);
            let mut left = possible.iter().fold(0, |all, kind| all | kind);
            while left != 0 {
                let child = left.trailing_zeros() as usize;
                left &= left - 1;
                let mask = kinds_of(&possible, child);
                let reference = node.children[child];
                if reference & LEAF != 0 {
                    visit(reference & !LEAF, mask);
                } else {
                    stack.push((reference, mask));
                }
            }
        }
    }

    /// The mask with which [`Self::visit`] visits a triangle; 0 if it does not.
    pub fn possible(&self, query: &Query, triangle: u32) -> u8 {
        let mut mask = query.kinds.all();
        let mut place = self.triangle_places[triangle as usize];
        loop {
            let possible = query.possible(&self.nodes[place.node as usize], mask);
            mask = kinds_of(&possible, place.child as usize);
            if place.node == 0 || mask == 0 {
                return mask;
            }
            place = self.node_places[place.node as usize];
        }
    }
}

/// A mask of the kinds that a child may hold, from the masks of children for each kind.
#[inline]
fn kinds_of(possible: &[u32; COUNT], child: usize) -> u8 {
    let bit = |(kind, children): (usize, &u32)| ((children >> child & 1) << kind) as u8;
    possible.iter().enumerate().map(bit).sum()
}

/// Sorts triangles into up to [`WIDTH`] groups of about the same size; returns the ranges of these.
fn split(triangles: &mut [Triangle]) -> ArrayVec<(usize, usize), WIDTH> {
    let mut groups: ArrayVec<(usize, usize), WIDTH> = ArrayVec::new();
    groups.push((0, triangles.len()));
    while !groups.is_full() {
        let largest = groups
            .iter()
            .enumerate()
            .max_by_key(|(_, group)| group.1 - group.0);
        let Some((i, &(start, end))) = largest.filter(|(_, group)| group.1 - group.0 > 1) else {
            break;
        };
        let middle = start + halve(&mut triangles[start..end]);
        groups[i] = (start, middle);
        groups.push((middle, end));
    }
    groups
}

/// Sorts triangles into two halves along the longest axis; returns where the second begins.
fn halve(triangles: &mut [Triangle]) -> usize {
    let centroid = |t: &Triangle| t.corners.map(Vec3A::from_array).iter().sum::<Vec3A>() / 3.0;
    let (min, max) = triangles
        .iter()
        .map(centroid)
        .fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(min, max), c| {
            (min.min(c), max.max(c))
        });
    let axis = (max - min).max_position();
    let half = triangles.len() / 2;
    triangles.select_nth_unstable_by(half, |a, b| centroid(a)[axis].total_cmp(&centroid(b)[axis]));
    half
}

/// Bounding sphere and cone of normals.
struct Bound {
    center: Vec3A,
    radius: f32,
    axis: Vec3A,
    sin_cone: f32,
    cos_cone: f32,
}

impl Bound {
    fn new(triangles: &[Triangle]) -> Self {
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
        Self {
            center,
            radius: radius * (1.0 + SLACK),
            axis,
            sin_cone,
            cos_cone,
        }
    }
}

impl Node {
    /// The node whose children are these ranges of `triangles`; the children themselves are left open.
    fn new(groups: &[(usize, usize)], triangles: &[Triangle]) -> Self {
        let bounds: ArrayVec<Bound, WIDTH> = groups
            .iter()
            .map(|&(start, end)| Bound::new(&triangles[start..end]))
            .collect();
        let gather = |get: &dyn Fn(&Bound) -> f32| {
            f32x8::new(std::array::from_fn(|i| bounds.get(i).map_or(0.0, get)))
        };
        Self {
            center: std::array::from_fn(|axis| gather(&|bound| bound.center[axis])),
            axis: std::array::from_fn(|axis| gather(&|bound| bound.axis[axis])),
            radius: gather(&|bound| bound.radius),
            sin_cone: gather(&|bound| bound.sin_cone),
            cos_cone: gather(&|bound| bound.cos_cone),
            children: [0; WIDTH],
            count: groups.len() as u32,
        }
    }
}

/// The two ends of the chains that are sought.
pub struct Query<'a> {
    start: [f32x8; 3],
    end: End,
    kinds: &'a Kinds,
}

enum End {
    Point([f32x8; 3]),
    /// Unit.
    Direction([f32x8; 3]),
}

impl<'a> Query<'a> {
    pub fn new(start: DVec3, end: &Endpoint, kinds: &'a Kinds) -> Self {
        let splat = |v: DVec3| v.as_vec3().to_array().map(f32x8::splat);
        Self {
            start: splat(start),
            end: match end {
                Endpoint::Point { position, .. } => End::Point(splat(*position)),
                Endpoint::Direction(direction) => End::Direction(splat(*direction)),
            },
            kinds,
        }
    }

    /// For each kind in `mask`, a mask of the children that it is possible in.
    #[inline]
    fn possible(&self, node: &Node, mask: u8) -> [u32; COUNT] {
        let start = Seen::point(node, &self.start);
        let end = match &self.end {
            End::Point(point) => Seen::point(node, point),
            End::Direction(direction) => Seen::direction(node, *direction),
        };
        let used = (1 << node.count) - 1;
        let within = (start.within | end.within) & used;
        let mut possible = [0; COUNT];
        for (i, kind) in self.kinds.iter(mask) {
            let faces = start.faces(kind.side) & end.faces(kind.end_side()) & used & !within;
            possible[i] = within;
            if faces != 0 {
                possible[i] |= faces & half_vector_fits(node, kind, [&start, &end]);
            }
        }
        possible
    }
}

/// A mask of the children that the angle between the half vector and the normals does not exclude.
#[inline]
fn half_vector_fits(node: &Node, kind: &Kind, [start, end]: [&Seen; 2]) -> u32 {
    let [eta_start, eta_end] = kind.indices.map(f32x8::splat);
    let h: [f32x8; 3] = std::array::from_fn(|axis| {
        eta_start * start.direction[axis] + eta_end * end.direction[axis]
    });
    let length_squared = dot(&h, &h);
    let slack = f32x8::splat(SLACK);
    let error = (eta_start * start.chord + eta_end * end.chord) * (1.0 + SLACK) + slack;
    // Without a bound on the half vector, or on the normals, nothing is excluded.
    let unbounded =
        (error * error).simd_ge(length_squared) | node.cos_cone.simd_le(f32x8::splat(-1.0));
    // H points to the denser side, and to the side of both ends for reflection.
    let sign = match kind.lobe {
        DeltaLobe::Transmission if kind.indices[0] < kind.indices[1] => -kind.side,
        DeltaLobe::Transmission | DeltaLobe::Reflection => kind.side,
    };
    // All sines and cosines times |H|.
    let length = length_squared.sqrt();
    let cos_error = (length_squared - error * error)
        .fast_max(f32x8::ZERO)
        .sqrt();
    let cos_sum = cos_error * node.cos_cone - error * node.sin_cone;
    let sin_sum = error * node.cos_cone + cos_error * node.sin_cone;
    let along = dot(&node.axis, &h) * sign;
    let fits = sin_sum.simd_lt(f32x8::ZERO) | along.simd_ge(cos_sum - slack * length);
    (unbounded | fits).to_bitmask()
}

/// An end as seen from the centres of a node's children.
struct Seen {
    /// Unit.
    direction: [f32x8; 3],
    /// At least 2 sin(d / 2), where d is the angle by which the direction varies within the sphere.
    chord: f32x8,
    /// Masks of the children that have a normal at less than a right angle to the direction, and to its opposite.
    front: u32,
    back: u32,
    /// Mask of the children whose spheres the end lies in.
    within: u32,
}

impl Seen {
    #[inline]
    fn point(node: &Node, point: &[f32x8; 3]) -> Self {
        let offset: [f32x8; 3] = std::array::from_fn(|axis| point[axis] - node.center[axis]);
        let inverse = f32x8::ONE / dot(&offset, &offset).sqrt();
        let sin = node.radius * inverse * (1.0 + SLACK);
        let within = sin.simd_ge(f32x8::ONE).to_bitmask();
        let sin_squared = sin * sin;
        let cos = (f32x8::ONE - sin_squared).fast_max(f32x8::ZERO).sqrt();
        // 2 sin(d / 2) = sin d / cos(d / 2), which is sqrt(2) for a right angle.
        let chord = sin * (sin_squared * (std::f32::consts::SQRT_2 - 1.0) + f32x8::ONE);
        Self::new(node, offset.map(|x| x * inverse), [sin, cos], chord, within)
    }

    #[inline]
    fn direction(node: &Node, direction: [f32x8; 3]) -> Self {
        Self::new(node, direction, [f32x8::ZERO, f32x8::ONE], f32x8::ZERO, 0)
    }

    #[inline]
    fn new(
        node: &Node,
        direction: [f32x8; 3],
        [sin, cos]: [f32x8; 2],
        chord: f32x8,
        within: u32,
    ) -> Self {
        // cos(90 degrees + b + d) = -sin(b + d), if b + d < 90 degrees.
        let cos_sum = node.cos_cone * cos - node.sin_cone * sin;
        let sin_sum = node.sin_cone * cos + node.cos_cone * sin;
        let wide = cos_sum.simd_le(f32x8::ZERO);
        let along = dot(&node.axis, &direction);
        let least = -sin_sum - f32x8::splat(SLACK);
        Self {
            direction,
            chord,
            front: (wide | along.simd_ge(least)).to_bitmask(),
            back: (wide | (-along).simd_ge(least)).to_bitmask(),
            within,
        }
    }

    /// [`Self::front`] for the side 1, [`Self::back`] for -1.
    #[inline]
    fn faces(&self, side: f32) -> u32 {
        if side > 0.0 { self.front } else { self.back }
    }
}

#[inline]
fn dot(a: &[f32x8; 3], b: &[f32x8; 3]) -> f32x8 {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}
