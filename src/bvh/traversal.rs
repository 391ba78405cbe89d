//! Traversal of the wide tree: the boxes of all eight children of a node are tested at once.
//!
//! As Wald, Benthin and Boulos (2008, "Getting rid of packets: efficient SIMD single-ray traversal using
//! multi-branching BVHs") and in Embree (Wald et al. 2014), children are visited nearest first, and those
//! that begin beyond a hit are dropped from the stack.

use arrayvec::ArrayVec;
use wide::f32x8;

use super::node::{Child, Kind, MAX_DEPTH, Node, WIDTH};
use super::ray::Ray;

/// Capacity of the stack, sufficient for a tree of [`MAX_DEPTH`].
const STACK_SIZE: usize = (WIDTH - 1) * MAX_DEPTH as usize + WIDTH + 1;

/// A ray prepared for the slab test: the plane x = p is at distance p * `inverse` - `scaled`.
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

    /// A mask of the children whose boxes the ray enters before `t_max`, and the distances of entry.
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

/// 1/x, kept finite: a direction component below 2^-23 in size is replaced by 2^-23.
#[inline(always)]
fn safe_inverse(x: f32) -> f32 {
    if x.abs() <= f32::EPSILON {
        1.0_f32.copysign(x) / f32::EPSILON
    } else {
        1.0 / x
    }
}

/// Packs a child and the distance at which its box is entered in one number that sorts by distance:
/// the order of non-negative floats is that of their bits.
#[inline(always)]
fn pack(distance: f32, child: Child) -> u64 {
    u64::from(distance.to_bits()) << 32 | u64::from(child.0)
}

/// The inverse of [`pack`].
#[inline(always)]
fn unpack(entry: u64) -> (f32, Child) {
    (f32::from_bits((entry >> 32) as u32), Child(entry as u32))
}

/// Calls `leaf` for the leaves along a ray, nearest first, with the distance below which a hit counts;
/// `leaf` returns the distance of the hit that it has found, else the one it was given.
#[inline(always)]
pub fn visit(nodes: &[Node], ray: &Ray, mut leaf: impl FnMut(Kind, f32) -> f32) {
    if nodes.is_empty() {
        return;
    }
    let slabs = Slabs::new(ray);
    let mut t_max = ray.t_max;
    let mut stack = ArrayVec::<u64, STACK_SIZE>::new();
    let mut child = Child::ROOT;
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
            let (distance, child) = unpack(top);
            if distance < t_max {
                break child;
            }
        };
    }
}

/// The nearest of the children in the mask `entered`, which is not 0. The others are pushed on the stack,
/// the farthest first.
#[inline(always)]
fn nearest(
    node: &Node,
    entered: u32,
    distances: f32x8,
    stack: &mut ArrayVec<u64, STACK_SIZE>,
) -> Child {
    let mut rest = entered & (entered - 1);
    let first = entered.trailing_zeros() as usize % WIDTH;
    if rest == 0 {
        return node.children[first];
    }
    let distances = distances.to_array();
    let mut nearest = pack(distances[first], node.children[first]);
    let floor = stack.len();
    while rest != 0 {
        let i = rest.trailing_zeros() as usize % WIDTH;
        rest &= rest - 1;
        let other = pack(distances[i], node.children[i]);
        stack.push(nearest.max(other));
        nearest = nearest.min(other);
        // Insertion sort: the new entry sinks below those that are nearer.
        let mut k = stack.len() - 1;
        while k > floor && stack[k - 1] < stack[k] {
            stack.swap(k - 1, k);
            k -= 1;
        }
    }
    unpack(nearest).1
}

/// True if `leaf` is true for any of the leaves along a ray.
#[inline(always)]
pub fn any(nodes: &[Node], ray: &Ray, mut leaf: impl FnMut(Kind) -> bool) -> bool {
    if nodes.is_empty() {
        return false;
    }
    let slabs = Slabs::new(ray);
    let mut stack = ArrayVec::<Child, STACK_SIZE>::new();
    stack.push(Child::ROOT);
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
