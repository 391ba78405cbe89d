//! The tree that rays traverse: eight children to a node, whose boxes are tested at once.
//!
//! As Wald, Benthin and Boulos (2008, "Getting rid of packets: efficient SIMD single-ray traversal using
//! multi-branching BVHs") and Embree (Wald et al. 2014) have it: children are visited nearest first, and
//! those that begin beyond a hit are dropped from the stack.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::Vec3A;
use wide::f32x8;

use crate::scene::Ray;

/// Children of a node.
pub const WIDTH: usize = 8;

/// Greatest depth of a tree that can be traversed: each level leaves up to seven children on the stack.
pub const MAX_DEPTH: u32 = 30;

/// A stack that a tree of [`MAX_DEPTH`] does not fill.
const STACK: usize = (WIDTH - 1) * MAX_DEPTH as usize + WIDTH + 1;

/// A node or leaf, in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Child(u32);

/// What a [`Child`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A node of the tree.
    Node(u32),
    /// Number of a packet of triangles.
    Triangles(u32),
    /// Number of a sphere.
    Sphere(u32),
}

impl Child {
    const LEAF: u32 = 1 << 31;
    const SPHERE: u32 = 1 << 30;

    /// In one word.
    pub fn new(kind: Kind) -> Self {
        Self(match kind {
            Kind::Node(node) => node,
            Kind::Triangles(packet) => packet | Self::LEAF,
            Kind::Sphere(sphere) => sphere | Self::LEAF | Self::SPHERE,
        })
    }

    /// In words.
    #[inline]
    pub fn kind(self) -> Kind {
        let number = self.0 & (Self::SPHERE - 1);
        if self.0 & Self::LEAF == 0 {
            Kind::Node(self.0)
        } else if self.0 & Self::SPHERE == 0 {
            Kind::Triangles(number)
        } else {
            Kind::Sphere(number)
        }
    }
}

/// Boxes and what is in them.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Node {
    /// For each axis the lower and the upper planes of all children's boxes.
    planes: [[f32x8; 2]; 3],
    children: [Child; WIDTH],
    /// Nodes begin with a line of the cache.
    padding: [u32; 8],
}

impl Node {
    /// A node over at most eight children, each with the lower and upper corner of its box.
    pub fn new(children: &[(Child, Vec3A, Vec3A)]) -> Self {
        // No ray enters a box that is inside out.
        let mut planes = [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3];
        let mut words = [Child(0); WIDTH];
        for (i, (child, min, max)) in children.iter().enumerate() {
            words[i] = *child;
            for (axis, [lower, upper]) in planes.iter_mut().enumerate() {
                lower[i] = min[axis];
                upper[i] = max[axis];
            }
        }
        Self {
            planes: planes.map(|planes| planes.map(f32x8::new)),
            children: words,
            padding: [0; 8],
        }
    }

    /// All children.
    pub fn children(&self) -> impl Iterator<Item = Child> {
        let lower = self.planes[0][0].to_array();
        let children = self.children.into_iter().zip(lower);
        children.filter_map(|(child, lower)| (lower < f32::INFINITY).then_some(child))
    }

    /// Changes all children.
    pub fn map(&mut self, change: impl Fn(Kind) -> Kind) {
        let count = self.children().count();
        for child in &mut self.children[..count] {
            *child = Child::new(change(child.kind()));
        }
    }
}

/// A ray as the test of boxes needs it: a plane x = p is at distance p * `inverse` - `scaled`.
struct Slabs {
    inverse: [f32x8; 3],
    scaled: [f32x8; 3],
    /// 1 where the upper plane comes first.
    first: [usize; 3],
}

impl Slabs {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        let inverse = ray.direction.to_array().map(safe_inverse);
        let origin = ray.origin.to_array();
        Self {
            inverse: inverse.map(f32x8::splat),
            scaled: std::array::from_fn(|axis| f32x8::splat(origin[axis] * inverse[axis])),
            first: inverse.map(|x| usize::from(x < 0.0)),
        }
    }

    /// Which children's boxes the ray enters before `t_max`, and where.
    #[inline(always)]
    fn enter(&self, node: &Node, t_max: f32) -> (u32, f32x8) {
        let distance = |axis: usize, last: usize| {
            let planes = node.planes[axis][(self.first[axis] ^ last) & 1];
            planes.mul_sub(self.inverse[axis], self.scaled[axis])
        };
        let entry = distance(0, 0)
            .fast_max(distance(1, 0))
            .fast_max(distance(2, 0).fast_max(f32x8::ZERO));
        let exit = distance(0, 1)
            .fast_min(distance(1, 1))
            .fast_min(distance(2, 1).fast_min(f32x8::splat(t_max)));
        (entry.simd_le(exit).to_bitmask(), entry)
    }
}

/// 1/x, finite: a ray along a plane of boxes is turned by 2^-23.
#[inline(always)]
fn safe_inverse(x: f32) -> f32 {
    if x.abs() <= f32::EPSILON {
        1.0_f32.copysign(x) / f32::EPSILON
    } else {
        1.0 / x
    }
}

/// A child on the stack with the distance at which its box is entered, in one number that sorts by
/// distance: floats from 0 on sort as their bits.
#[inline(always)]
fn entry(distance: f32, child: Child) -> u64 {
    u64::from(distance.to_bits()) << 32 | u64::from(child.0)
}

/// The inverse of [`entry`].
#[inline(always)]
fn parts(entry: u64) -> (f32, Child) {
    (f32::from_bits((entry >> 32) as u32), Child(entry as u32))
}

/// Calls `leaf` for the leaves along a ray, near ones first, with the distance up to which a hit counts;
/// `leaf` returns that distance, or that of a hit which it has found.
#[inline(always)]
pub fn visit(nodes: &[Node], ray: &Ray, mut leaf: impl FnMut(Kind, f32) -> f32) {
    if nodes.is_empty() {
        return;
    }
    let slabs = Slabs::new(ray);
    let mut t_max = ray.t_max;
    let mut stack = ArrayVec::<u64, STACK>::new();
    let mut child = Child(0);
    loop {
        match child.kind() {
            Kind::Node(node) => {
                let node = &nodes[node as usize];
                let (entered, distances) = slabs.enter(node, t_max);
                if entered != 0 {
                    child = nearest(node, entered, distances, &mut stack);
                    continue;
                }
            }
            kind => t_max = leaf(kind, t_max),
        }
        child = loop {
            let Some(top) = stack.pop() else { return };
            let (distance, child) = parts(top);
            if distance < t_max {
                break child;
            }
        };
    }
}

/// The nearest of the children in the mask `entered`, which is not 0; the others go to the stack, the next
/// nearest on top.
#[inline(always)]
fn nearest(node: &Node, entered: u32, distances: f32x8, stack: &mut ArrayVec<u64, STACK>) -> Child {
    let mut rest = entered & (entered - 1);
    let first = entered.trailing_zeros() as usize % WIDTH;
    if rest == 0 {
        return node.children[first];
    }
    let distances = distances.to_array();
    let mut nearest = entry(distances[first], node.children[first]);
    let floor = stack.len();
    while rest != 0 {
        let i = rest.trailing_zeros() as usize % WIDTH;
        rest &= rest - 1;
        let other = entry(distances[i], node.children[i]);
        stack.push(nearest.max(other));
        nearest = nearest.min(other);
        // Insertion: the new one sinks below those that are nearer.
        let mut k = stack.len() - 1;
        while k > floor && stack[k - 1] < stack[k] {
            stack.swap(k - 1, k);
            k -= 1;
        }
    }
    parts(nearest).1
}

/// True if `leaf` is for one of the leaves along a ray.
#[inline(always)]
pub fn any(nodes: &[Node], ray: &Ray, mut leaf: impl FnMut(Kind) -> bool) -> bool {
    if nodes.is_empty() {
        return false;
    }
    let slabs = Slabs::new(ray);
    let mut stack = ArrayVec::<Child, STACK>::new();
    stack.push(Child(0));
    while let Some(child) = stack.pop() {
        match child.kind() {
            Kind::Node(node) => {
                let node = &nodes[node as usize];
                let (mut entered, _) = slabs.enter(node, ray.t_max);
                while entered != 0 {
                    stack.push(node.children[entered.trailing_zeros() as usize % WIDTH]);
                    entered &= entered - 1;
                }
            }
            kind if leaf(kind) => return true,
            _ => {}
        }
    }
    false
}
