//! Construction of the bounding volume hierarchy: a compressed wide tree (Ylitie, Karras and Laine
//! 2017, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs").
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
    cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh, node::CwBvhNode},
};
use rayon::prelude::*;

use super::primitive::Primitive;

/// Greatest number of primitives in a chunk. Construction needs some 300 bytes for each of them.
const CHUNK: usize = 1 << 15;

/// Bins per axis of the surface area heuristic.
const BINS: usize = 16;

/// Levels of a binary tree below which it is split in the middle, to bound its depth.
const HEURISTIC_LEVELS: u32 = 48;

/// Greatest depth of the wide tree: traversal keeps a stack of 32 and loses what does not fit.
pub const MAX_DEPTH: u32 = 30;

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

/// The hierarchy over `primitives`, which are brought into its order: the primitive that traversal
/// names is an index into them.
pub fn build(primitives: &mut [Primitive]) -> CwBvh {
    let best = build_with(primitives, Quality::Best);
    if depth(&best.nodes) <= MAX_DEPTH {
        best
    } else {
        build_with(primitives, Quality::Shallow)
    }
}

/// The hierarchy, and `primitives` in its order, of a given quality whatever its depth.
pub fn build_with(primitives: &mut [Primitive], quality: Quality) -> CwBvh {
    if primitives.is_empty() {
        return CwBvh::default();
    }
    let top = Tree::grow(primitives, CHUNK, quality);
    let mut rest = &mut *primitives;
    let mut slices = Vec::with_capacity(top.leaves.len());
    for &len in &top.leaves {
        let (slice, others) = rest.split_at_mut(len);
        slices.push(slice);
        rest = others;
    }
    let chunks: Vec<CwBvh> = slices
        .into_par_iter()
        .map(|slice| build_chunk(slice, quality))
        .collect();
    let firsts = top.leaves.iter().scan(0, |first, &len| {
        let this = *first;
        *first += len as u32;
        Some(this)
    });
    let chunks = firsts.zip(chunks).collect();
    let total_aabb = *top.nodes[0].aabb();
    // One chunk to a leaf, so that each becomes a child of its own.
    let top = bvh2_to_cwbvh(&top.into_bvh2(), 1, true, false);
    CwBvh {
        nodes: join(&top, chunks),
        primitive_indices: Vec::new(),
        total_aabb,
        exact_node_aabbs: None,
        uses_spatial_splits: false,
    }
}

/// The hierarchy over one chunk, whose primitives are brought into its order.
fn build_chunk(primitives: &mut [Primitive], quality: Quality) -> CwBvh {
    let mut binary = Tree::grow(primitives, 1, quality).into_bvh2();
    if quality == Quality::Best {
        ReinsertionOptimizer::default().run(&mut binary, REINSERTION_RATIO, None);
    }
    let mut wide = bvh2_to_cwbvh(&binary, 3, true, false);
    drop(binary);
    let before = primitives.to_vec();
    for (primitive, &i) in primitives.iter_mut().zip(&wide.primitive_indices) {
        *primitive = before[i as usize];
    }
    wide.primitive_indices = Vec::new();
    wide.nodes.shrink_to_fit();
    wide
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

/// One tree from `top`, whose leaves stand for chunks, and the `chunks`, each with the index of its
/// first primitive.
fn join(top: &CwBvh, mut chunks: Vec<(u32, CwBvh)>) -> Vec<CwBvhNode> {
    if chunks.len() == 1 {
        return chunks.pop().map_or(Vec::new(), |(_, only)| only.nodes);
    }
    let below: usize = chunks.iter().map(|(_, chunk)| chunk.nodes.len()).sum();
    let mut nodes = Vec::with_capacity(top.nodes.len() + below);
    nodes.push(CwBvhNode::default());
    let mut chunks: Vec<_> = chunks.into_iter().map(Some).collect();
    join_node(top, 0, &mut chunks, &mut nodes, 0);
    nodes
}

/// Writes node `from` of `top` to place `to`, and what is below it to the end of `nodes`.
fn join_node(
    top: &CwBvh,
    from: usize,
    chunks: &mut [Option<(u32, CwBvh)>],
    nodes: &mut Vec<CwBvhNode>,
    to: usize,
) {
    let old = &top.nodes[from];
    let children: Vec<usize> = (0..8).filter(|&child| !old.is_child_empty(child)).collect();
    let base = nodes.len();
    let mut node = *old;
    node.child_base_idx = base as u32;
    // All children are inner nodes now; see `CwBvhNode::child_meta` for the code.
    for &child in &children {
        node.imask |= 1 << child;
        node.child_meta[child] = (24 + child as u8) | 0b0010_0000;
    }
    nodes[to] = node;
    nodes.resize(base + children.len(), CwBvhNode::default());
    for (i, &child) in children.iter().enumerate() {
        if old.is_leaf(child) {
            let chunk = top.primitive_indices[old.child_primitives(child).0 as usize];
            if let Some((first, chunk)) = chunks[chunk as usize].take() {
                join_chunk(first, &chunk, nodes, base + i);
            }
        } else {
            let below = old.child_node_index(child) as usize;
            join_node(top, below, chunks, nodes, base + i);
        }
    }
}

/// Writes the root of `chunk` to place `to` and its other nodes to the end of `nodes`.
fn join_chunk(first_primitive: u32, chunk: &CwBvh, nodes: &mut Vec<CwBvhNode>, to: usize) {
    let base = nodes.len() as u32;
    // Node 1 of the chunk goes to `base`.
    let mut moved = chunk.nodes.iter().map(|node| CwBvhNode {
        child_base_idx: node.child_base_idx - 1 + base,
        primitive_base_idx: node.primitive_base_idx + first_primitive,
        ..*node
    });
    if let Some(root) = moved.next() {
        nodes[to] = root;
    }
    nodes.extend(moved);
}

/// Number of levels below the root.
pub fn depth(nodes: &[CwBvhNode]) -> u32 {
    fn below(nodes: &[CwBvhNode], node: &CwBvhNode) -> u32 {
        (0..8)
            .filter(|&child| !node.is_child_empty(child) && !node.is_leaf(child))
            .map(|child| 1 + below(nodes, &nodes[node.child_node_index(child) as usize]))
            .max()
            .unwrap_or(0)
    }
    nodes.first().map_or(0, |root| below(nodes, root))
}
