//! Construction of the wide tree.
//!
//! A binary tree is built, improved by reinsertion, and collapsed. To bound the memory this takes, it is
//! done for one chunk of the primitives at a time, and a tree over the chunks is put on top: the peak
//! grows by the size of a chunk, not of the scene.

use obvhs::bvh2::{Bvh2, reinsertion::ReinsertionOptimizer};
use rayon::prelude::*;

use super::binary::{BinaryTree, Quality};
use super::collapse::Collapse;
use super::huge_pages::HugePages;
use super::node::{Child, Kind, MAX_DEPTH, Node};
use super::primitive::Primitive;
use super::triangle::LANES;

/// Maximum number of primitives in a chunk. Construction needs some 300 bytes for each of them.
const MAX_CHUNK: usize = 1 << 15;

/// Fraction of the nodes that each pass of reinsertion tries to improve, as in `medium_build` of `obvhs`.
const REINSERTION_RATIO: f32 = 0.05;

/// The result of construction.
pub struct Hierarchy {
    /// The wide tree; the first node is the root.
    pub nodes: HugePages<Node>,
    /// The number of primitives in each leaf, in the order of the primitives: up to [`LANES`] triangles,
    /// or one sphere. The n-th leaf with triangles is packet n.
    pub leaves: Vec<u8>,
}

/// Builds the hierarchy over `primitives`, which are sorted into its order.
pub fn build(primitives: &mut [Primitive]) -> Hierarchy {
    let best = build_with(primitives, Quality::Best);
    if depth(&best.nodes) <= MAX_DEPTH {
        best
    } else {
        build_with(primitives, Quality::Shallow)
    }
}

/// As [`build`], with a given quality whatever the depth.
pub fn build_with(primitives: &mut [Primitive], quality: Quality) -> Hierarchy {
    if primitives.is_empty() {
        return Hierarchy {
            nodes: HugePages::zeroed(0),
            leaves: Vec::new(),
        };
    }
    let top = BinaryTree::build(primitives, MAX_CHUNK, quality);
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

/// Part of the primitives, with a tree of its own.
struct Chunk {
    nodes: Vec<Node>,
    leaves: Vec<u8>,
    /// Number of leaves of each kind.
    packets: u32,
    spheres: u32,
}

impl Chunk {
    /// Builds the tree over `primitives`, which are sorted into its order.
    fn build(primitives: &mut [Primitive], quality: Quality) -> Self {
        let mut binary = BinaryTree::build(primitives, 1, quality).into_bvh2();
        if quality == Quality::Best {
            ReinsertionOptimizer::default().run(&mut binary, REINSERTION_RATIO, None);
        }
        let is_triangle = |i: u32| matches!(primitives[i as usize], Primitive::Triangle(_));
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

/// Joins the chunks and the tree over them, whose leaves they are, to one tree.
fn join(top: &Bvh2, mut chunks: Vec<Chunk>) -> Hierarchy {
    if chunks.len() == 1 {
        let Chunk { nodes, leaves, .. } = chunks.remove(0);
        return Hierarchy {
            nodes: HugePages::copy_of(&nodes),
            leaves,
        };
    }
    // Leaves refer to chunks until the positions of the nodes of these are known.
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
    let mut nodes = HugePages::zeroed(first);
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
