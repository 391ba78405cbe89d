//! Construction of the bounding volume hierarchy.
//!
//! Binary trees are grown from the top by the surface area heuristic over bins (Wald 2007, "On fast
//! construction of SAH-based bounding volume hierarchies"), improved by reinsertion, and collapsed.
//! To bound the memory this takes, it is done for chunks of the scene, each of them finished before
//! the tree over the chunks is put on top: peak use grows by the size of a chunk, not of the scene.

use glam::Vec3A;
use obvhs::{
    Boundable,
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
};
use rayon::prelude::*;

use super::collapse::Collapse;
use super::pages::Pages;
use super::primitive::Primitive;
use super::traversal::{Child, Kind, MAX_DEPTH, Node};
use super::triangle::LANES;

/// Greatest number of primitives in a chunk. Construction needs some 300 bytes for each of them.
const CHUNK: usize = 1 << 15;

/// Bins per axis of the surface area heuristic.
const BINS: usize = 16;

/// Levels of a binary tree below which it is split in the middle, to bound its depth.
const HEURISTIC_LEVELS: u32 = 48;

/// As in the crate's `medium_build`: the share of nodes that each pass tries to place better.
const REINSERTION_RATIO: f32 = 0.05;

/// How a binary tree is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// As cheap to traverse as possible.
    Best,
    /// As shallow as possible, for the rare scene where `Best` is too deep to traverse.
    Shallow,
}

/// What construction leaves.
pub struct Hierarchy {
    /// The tree; the first node is the root.
    pub nodes: Pages<Node>,
    /// Numbers of primitives in the leaves, in the order of the primitives: up to [`LANES`] triangles, or
    /// a sphere. The n-th leaf with triangles is packet n.
    pub leaves: Vec<u8>,
}

/// The hierarchy over `primitives`, which are brought into its order.
pub fn build(primitives: &mut [Primitive]) -> Hierarchy {
    let best = build_with(primitives, Quality::Best);
    if depth(&best.nodes) <= MAX_DEPTH {
        best
    } else {
        build_with(primitives, Quality::Shallow)
    }
}

/// The hierarchy, and `primitives` in its order, of a given quality whatever its depth.
pub fn build_with(primitives: &mut [Primitive], quality: Quality) -> Hierarchy {
    if primitives.is_empty() {
        return Hierarchy {
            nodes: Pages::zeroed(0),
            leaves: Vec::new(),
        };
    }
    let top = Tree::grow(primitives, CHUNK, quality);
    let mut rest = &mut *primitives;
    let mut slices = Vec::with_capacity(top.leaves.len());
    for &len in &top.leaves {
        let (slice, others) = rest.split_at_mut(len);
        slices.push(slice);
        rest = others;
    }
    let chunks: Vec<Chunk> = slices
        .into_par_iter()
        .map(|slice| Chunk::build(slice, quality))
        .collect();
    join(&top.into_bvh2(), chunks)
}

/// A part of the scene, with a hierarchy of its own.
struct Chunk {
    nodes: Vec<Node>,
    leaves: Vec<u8>,
    /// Numbers of leaves of either kind.
    packets: u32,
    spheres: u32,
}

impl Chunk {
    /// Of `primitives`, which are brought into its order.
    fn build(primitives: &mut [Primitive], quality: Quality) -> Self {
        let mut binary = Tree::grow(primitives, 1, quality).into_bvh2();
        if quality == Quality::Best {
            ReinsertionOptimizer::default().run(&mut binary, REINSERTION_RATIO, None);
        }
        let is_triangle = |i: u32| matches!(primitives[i as usize], Primitive::Triangle { .. });
        let mut order = Vec::with_capacity(primitives.len());
        let mut leaves = Vec::new();
        let (mut packets, mut spheres) = (0, 0);
        let collapse = Collapse::new(&binary, LANES as u32, is_triangle);
        let mut nodes = collapse.finish(&mut |members| {
            order.extend_from_slice(members);
            leaves.push(members.len() as u8);
            let (count, kind): (_, fn(u32) -> Kind) = if is_triangle(members[0]) {
                (&mut packets, Kind::Triangles)
            } else {
                (&mut spheres, Kind::Sphere)
            };
            *count += 1;
            Child::new(kind(*count - 1))
        });
        let before = primitives.to_vec();
        for (primitive, i) in primitives.iter_mut().zip(order) {
            *primitive = before[i as usize];
        }
        nodes.shrink_to_fit();
        Self {
            nodes,
            leaves,
            packets,
            spheres,
        }
    }
}

/// One tree from that over the chunks, whose leaves are the chunks, and the chunks.
fn join(top: &Bvh2, mut chunks: Vec<Chunk>) -> Hierarchy {
    if chunks.len() == 1 {
        let Chunk { nodes, leaves, .. } = chunks.remove(0);
        return Hierarchy {
            nodes: Pages::copy_of(&nodes),
            leaves,
        };
    }
    // Leaves stand for chunks until it is known where their nodes go.
    let mut top =
        Collapse::new(top, 1, |_| true).finish(&mut |chunk| Child::new(Kind::Triangles(chunk[0])));
    let mut firsts = Vec::with_capacity(chunks.len());
    let mut first = top.len();
    for chunk in &chunks {
        firsts.push(first as u32);
        first += chunk.nodes.len();
    }
    for node in &mut top {
        node.map(|child| match child {
            Kind::Triangles(chunk) => Kind::Node(firsts[chunk as usize]),
            other => other,
        });
    }
    let mut nodes = Pages::zeroed(first);
    nodes[..top.len()].copy_from_slice(&top);
    let (mut leaves, mut packets, mut spheres) = (Vec::new(), 0, 0);
    for (chunk, first) in chunks.into_iter().zip(firsts) {
        for (to, mut node) in nodes[first as usize..].iter_mut().zip(chunk.nodes) {
            node.map(|child| match child {
                Kind::Node(node) => Kind::Node(node + first),
                Kind::Triangles(packet) => Kind::Triangles(packet + packets),
                Kind::Sphere(sphere) => Kind::Sphere(sphere + spheres),
            });
            *to = node;
        }
        leaves.extend(chunk.leaves);
        packets += chunk.packets;
        spheres += chunk.spheres;
    }
    Hierarchy { nodes, leaves }
}

/// A binary tree whose leaves are runs of the primitives that it was grown from.
struct Tree {
    nodes: Vec<Bvh2Node>,
    /// Lengths of the runs, in the order of the primitives.
    leaves: Vec<usize>,
}

impl Tree {
    /// A tree over `primitives`, which are brought into its order, with at most `max_leaf` to a leaf.
    fn grow(primitives: &mut [Primitive], max_leaf: usize, quality: Quality) -> Self {
        let mut tree = Self {
            nodes: vec![Bvh2Node::default()],
            leaves: Vec::new(),
        };
        let level = match quality {
            Quality::Best => 0,
            Quality::Shallow => HEURISTIC_LEVELS,
        };
        tree.grow_node(0, primitives, max_leaf, level);
        tree
    }

    fn grow_node(&mut self, at: usize, primitives: &mut [Primitive], max_leaf: usize, level: u32) {
        let (bounds, centers) = bounds(primitives);
        if primitives.len() <= max_leaf {
            self.nodes[at] = Bvh2Node::new(bounds, 1, self.leaves.len() as u32);
            self.leaves.push(primitives.len());
            return;
        }
        let middle = if level < HEURISTIC_LEVELS {
            split_by_area(primitives, &centers)
        } else {
            None
        };
        let middle = middle.unwrap_or_else(|| split_in_half(primitives, &centers));
        let first = self.nodes.len();
        self.nodes.extend([Bvh2Node::default(); 2]);
        self.nodes[at] = Bvh2Node::new(bounds, 0, first as u32);
        let (left, right) = primitives.split_at_mut(middle);
        self.grow_node(first, left, max_leaf, level + 1);
        self.grow_node(first + 1, right, max_leaf, level + 1);
    }

    /// The crate's form of the tree; leaves stand for themselves.
    fn into_bvh2(self) -> Bvh2 {
        Bvh2 {
            nodes: self.nodes,
            primitive_indices: (0..self.leaves.len() as u32).collect(),
            ..Bvh2::default()
        }
    }
}

/// The box around `primitives` and that around the centres of their boxes.
fn bounds(primitives: &[Primitive]) -> (Aabb, Aabb) {
    let mut bounds = Aabb::INVALID;
    let mut centers = Aabb::INVALID;
    for primitive in primitives {
        let aabb = primitive.aabb();
        bounds = bounds.union(&aabb);
        centers.extend(aabb.center());
    }
    (bounds, centers)
}

/// Brings `primitives` into two groups and tells where the second starts: the division, of those
/// between bins on any axis, with the least sum of area times number. `None` if all centres are in
/// one place.
fn split_by_area(primitives: &mut [Primitive], centers: &Aabb) -> Option<usize> {
    let extent = centers.diagonal();
    let scale = BINS as f32 / extent;
    let bin = |center: Vec3A, axis: usize| {
        (((center[axis] - centers.min[axis]) * scale[axis]) as usize).min(BINS - 1)
    };
    let mut bins = [[(Aabb::INVALID, 0_usize); BINS]; 3];
    for primitive in &*primitives {
        let aabb = primitive.aabb();
        for (axis, bins) in bins.iter_mut().enumerate() {
            let (bounds, count) = &mut bins[bin(aabb.center(), axis)];
            *bounds = bounds.union(&aabb);
            *count += 1;
        }
    }
    let (axis, last_left) = (0..3)
        .filter(|&axis| extent[axis] > 0.0)
        .flat_map(|axis| cheapest_division(&bins[axis]).map(|(cost, i)| (cost, axis, i)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, axis, i)| (axis, i))?;
    Some(partition(primitives, |p| {
        bin(p.aabb().center(), axis) <= last_left
    }))
}

/// Cost of the cheapest division of `bins` in two groups that are not empty, and the last bin of the
/// first group.
fn cheapest_division(bins: &[(Aabb, usize); BINS]) -> Option<(f32, usize)> {
    let mut right_costs = [0.0; BINS];
    let mut right = (Aabb::INVALID, 0);
    for i in (1..BINS).rev() {
        right = (right.0.union(&bins[i].0), right.1 + bins[i].1);
        right_costs[i] = cost(&right);
    }
    let total = right.1 + bins[0].1;
    let mut left = (Aabb::INVALID, 0);
    let mut best: Option<(f32, usize)> = None;
    for i in 0..BINS - 1 {
        left = (left.0.union(&bins[i].0), left.1 + bins[i].1);
        let sum = cost(&left) + right_costs[i + 1];
        if left.1 > 0 && left.1 < total && best.is_none_or(|(least, _)| sum < least) {
            best = Some((sum, i));
        }
    }
    best
}

fn cost((bounds, count): &(Aabb, usize)) -> f32 {
    if *count == 0 {
        0.0
    } else {
        bounds.half_area() * *count as f32
    }
}

/// Brings those that satisfy `first` to the front and tells how many they are.
fn partition(primitives: &mut [Primitive], first: impl Fn(&Primitive) -> bool) -> usize {
    let mut count = 0;
    for i in 0..primitives.len() {
        if first(&primitives[i]) {
            primitives.swap(i, count);
            count += 1;
        }
    }
    count
}

/// Divides `primitives` in two groups of equal number, on the axis where they are spread widest.
fn split_in_half(primitives: &mut [Primitive], centers: &Aabb) -> usize {
    let middle = primitives.len() / 2;
    let axis = centers.largest_axis();
    primitives.select_nth_unstable_by(middle, |a, b| {
        let center = |p: &Primitive| p.aabb().center()[axis];
        center(a).total_cmp(&center(b))
    });
    middle
}

/// Number of levels below the root.
pub fn depth(nodes: &[Node]) -> u32 {
    fn below(nodes: &[Node], node: &Node) -> u32 {
        node.children()
            .filter_map(|child| match child.kind() {
                Kind::Node(node) => Some(1 + below(nodes, &nodes[node as usize])),
                Kind::Triangles(_) | Kind::Sphere(_) => None,
            })
            .max()
            .unwrap_or(0)
    }
    nodes.first().map_or(0, |root| below(nodes, root))
}
