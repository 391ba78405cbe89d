//! Collapses a binary tree to one with eight children per node, at the least expected cost of a ray, by
//! the dynamic programming of Ylitie, Karras and Laine (2017, "Efficient incoherent ray traversal on
//! GPUs through compressed wide BVHs", section 3).
//!
//! C(n, i) is the least cost of the subtree at node n as a forest of at most i trees.

use obvhs::bvh2::Bvh2;

use super::node::{Child, Kind, Node, WIDTH};

/// Cost of the box tests of a node, relative to the test of a leaf.
const NODE_COST: f32 = 1.0;

/// What a subtree becomes in its cheapest forest of at most i trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    /// One leaf.
    Leaf,
    /// One node.
    Node,
    /// The forests of its two children: this many trees for the first and the rest for the second.
    Split(u8),
    /// The forest of at most i - 1 trees.
    Fewer,
}

/// The cheapest forests of a subtree, for i = 1, 2, ... trees.
#[derive(Clone, Copy)]
struct Forests {
    /// C(n, i).
    costs: [f32; WIDTH - 1],
    choices: [Choice; WIDTH - 1],
    /// Number of trees of the first child if the subtree becomes a node.
    first: u8,
    /// Number of primitives below; `max_leaf` or more if they cannot share a leaf.
    count: u32,
}

/// The state of a collapse.
pub struct Collapse<'a> {
    binary: &'a Bvh2,
    forests: Vec<Forests>,
    max_leaf: u32,
    nodes: Vec<Node>,
}

impl<'a> Collapse<'a> {
    /// Starts the collapse of `binary`, whose leaves have one primitive each. A leaf of the wide tree
    /// holds at most `max_leaf` primitives for which `share` is true, or one for which it is false.
    pub fn new(binary: &'a Bvh2, max_leaf: u32, share: impl Fn(u32) -> bool) -> Self {
        let none = Forests {
            costs: [f32::INFINITY; WIDTH - 1],
            choices: [Choice::Fewer; WIDTH - 1],
            first: 0,
            count: 0,
        };
        let mut collapse = Self {
            binary,
            forests: vec![none; binary.nodes.len()],
            max_leaf,
            nodes: Vec::new(),
        };
        collapse.find_forests(0, &share);
        collapse
    }

    /// Computes C(n, i) for the subtree at `at`.
    fn find_forests(&mut self, at: usize, share: &impl Fn(u32) -> bool) {
        let node = &self.binary.nodes[at];
        let area = node.aabb().half_area();
        if node.is_leaf() {
            let alone = !share(self.binary.primitive_indices[node.first_index as usize]);
            self.forests[at].costs = [area; WIDTH - 1];
            self.forests[at].choices[0] = Choice::Leaf;
            self.forests[at].count = if alone { self.max_leaf } else { 1 };
            return;
        }
        let children = node.first_index as usize;
        self.find_forests(children, share);
        self.find_forests(children + 1, share);
        let [first, second] = [self.forests[children], self.forests[children + 1]];
        let forests = &mut self.forests[at];
        forests.count = first.count.saturating_add(second.count);
        // The cheapest distribution of the trees among the two children.
        let split = |roots: usize| {
            (1..roots)
                .map(|k| (first.costs[k - 1] + second.costs[roots - k - 1], k as u8))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f32::INFINITY, 0))
        };
        let (below, first_of_node) = split(WIDTH);
        forests.first = first_of_node;
        let as_node = below + NODE_COST * area;
        (forests.costs[0], forests.choices[0]) =
            if forests.count <= self.max_leaf && area <= as_node {
                (area, Choice::Leaf)
            } else {
                (as_node, Choice::Node)
            };
        for roots in 2..WIDTH {
            let (cost, first) = split(roots);
            (forests.costs[roots - 1], forests.choices[roots - 1]) =
                if cost < forests.costs[roots - 2] {
                    (cost, Choice::Split(first))
                } else {
                    (forests.costs[roots - 2], Choice::Fewer)
                };
        }
    }

    /// The wide tree. `leaf` is called for each of its leaves in turn, with the primitives in it, and
    /// returns the reference to it.
    pub fn finish(mut self, leaf: &mut impl FnMut(&[u32]) -> Child) -> Vec<Node> {
        self.nodes.push(Node::new(&[]));
        self.make_node(0, 0, leaf);
        self.nodes
    }

    /// Makes the node at `to` of the wide tree from the subtree at `at`.
    fn make_node(&mut self, at: usize, to: usize, leaf: &mut impl FnMut(&[u32]) -> Child) {
        let mut roots = Vec::with_capacity(WIDTH);
        if self.forests[at].choices[0] == Choice::Leaf {
            // The whole tree is one leaf.
            roots.push(at);
        } else {
            let first = self.forests[at].first.into();
            let children = self.binary.nodes[at].first_index as usize;
            self.collect_roots(children, first, &mut roots);
            self.collect_roots(children + 1, WIDTH - first, &mut roots);
        }
        let children: Vec<_> = roots
            .iter()
            .map(|&root| {
                let bounds = self.binary.nodes[root].aabb();
                let child = if self.forests[root].choices[0] == Choice::Leaf {
                    let mut members = Vec::with_capacity(self.max_leaf as usize);
                    self.collect_primitives(root, &mut members);
                    leaf(&members)
                } else {
                    self.nodes.push(Node::new(&[]));
                    let below = self.nodes.len() - 1;
                    self.make_node(root, below, leaf);
                    Child::new(Kind::Node(below as u32))
                };
                (child, bounds.min, bounds.max)
            })
            .collect();
        self.nodes[to] = Node::new(&children);
    }

    /// Collects the roots of the cheapest forest of at most `count` trees of the subtree at `at`.
    fn collect_roots(&self, at: usize, count: usize, roots: &mut Vec<usize>) {
        match self.forests[at].choices[count - 1] {
            Choice::Leaf | Choice::Node => roots.push(at),
            Choice::Fewer => self.collect_roots(at, count - 1, roots),
            Choice::Split(first) => {
                let children = self.binary.nodes[at].first_index as usize;
                self.collect_roots(children, first.into(), roots);
                self.collect_roots(children + 1, count - usize::from(first), roots);
            }
        }
    }

    /// Collects the primitives below `at`.
    fn collect_primitives(&self, at: usize, members: &mut Vec<u32>) {
        let node = &self.binary.nodes[at];
        if node.is_leaf() {
            members.push(self.binary.primitive_indices[node.first_index as usize]);
        } else {
            self.collect_primitives(node.first_index as usize, members);
            self.collect_primitives(node.first_index as usize + 1, members);
        }
    }
}
