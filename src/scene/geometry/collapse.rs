//! From a binary tree to one of eight children to a node, at the least expected cost of a ray: the
//! dynamic programming of Ylitie, Karras and Laine (2017, "Efficient incoherent ray traversal on GPUs
//! through compressed wide BVHs", section 3).

use obvhs::bvh2::Bvh2;

use super::traversal::{Child, Kind, Node, WIDTH};

/// Cost of testing the boxes of a node; of testing a leaf it is 1.
const NODE_COST: f32 = 1.0;

/// What a subtree becomes if it may have so many roots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    /// A leaf.
    Leaf,
    /// A node.
    Node,
    /// So many roots for the first child, and the rest for the second.
    Split(u8),
    /// As with one root less.
    Fewer,
}

/// The cheapest forests of a subtree.
#[derive(Clone, Copy)]
struct Best {
    /// With at most 1, 2, ... roots.
    costs: [f32; WIDTH - 1],
    choices: [Choice; WIDTH - 1],
    /// The first child's roots where the subtree becomes a node.
    first: u8,
    /// Leaves of the binary tree below; more than a leaf of the wide tree holds if none can be made.
    count: u32,
}

/// A binary tree in the course of its collapse.
pub struct Collapse<'a> {
    binary: &'a Bvh2,
    best: Vec<Best>,
    max_leaf: u32,
    nodes: Vec<Node>,
}

impl<'a> Collapse<'a> {
    /// Of `binary`, whose leaves have one primitive each. A leaf of the wide tree holds at most
    /// `max_leaf` of those that may `share` it, else one.
    pub fn new(binary: &'a Bvh2, max_leaf: u32, share: impl Fn(u32) -> bool) -> Self {
        let none = Best {
            costs: [f32::INFINITY; WIDTH - 1],
            choices: [Choice::Fewer; WIDTH - 1],
            first: 0,
            count: 0,
        };
        let mut collapse = Self {
            binary,
            best: vec![none; binary.nodes.len()],
            max_leaf,
            nodes: Vec::new(),
        };
        collapse.weigh(0, &share);
        collapse
    }

    /// Finds the cheapest forests of the subtree at `at`.
    fn weigh(&mut self, at: usize, share: &impl Fn(u32) -> bool) {
        let node = &self.binary.nodes[at];
        let area = node.aabb().half_area();
        if node.is_leaf() {
            let alone = !share(self.binary.primitive_indices[node.first_index as usize]);
            self.best[at].costs = [area; WIDTH - 1];
            self.best[at].choices[0] = Choice::Leaf;
            self.best[at].count = if alone { self.max_leaf } else { 1 };
            return;
        }
        let children = node.first_index as usize;
        self.weigh(children, share);
        self.weigh(children + 1, share);
        let [first, second] = [self.best[children], self.best[children + 1]];
        let best = &mut self.best[at];
        best.count = first.count.saturating_add(second.count);
        // Splits among 2, 3, ... roots.
        let split = |roots: usize| {
            (1..roots)
                .map(|k| (first.costs[k - 1] + second.costs[roots - k - 1], k as u8))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f32::INFINITY, 0))
        };
        let (below, first_of_node) = split(WIDTH);
        best.first = first_of_node;
        let as_node = below + NODE_COST * area;
        (best.costs[0], best.choices[0]) = if best.count <= self.max_leaf && area <= as_node {
            (area, Choice::Leaf)
        } else {
            (as_node, Choice::Node)
        };
        for roots in 2..WIDTH {
            let (cost, first) = split(roots);
            (best.costs[roots - 1], best.choices[roots - 1]) = if cost < best.costs[roots - 2] {
                (cost, Choice::Split(first))
            } else {
                (best.costs[roots - 2], Choice::Fewer)
            };
        }
    }

    /// The wide tree. `leaf` is given the leaves one after the other, as leaves of the binary tree that are
    /// to be together, and says what it has made of them.
    pub fn finish(mut self, leaf: &mut impl FnMut(&[u32]) -> Child) -> Vec<Node> {
        self.nodes.push(Node::new(&[]));
        self.make_node(0, 0, leaf);
        self.nodes
    }

    /// Makes number `to` of the wide tree's nodes from the subtree at `at`.
    fn make_node(&mut self, at: usize, to: usize, leaf: &mut impl FnMut(&[u32]) -> Child) {
        let mut roots = Vec::with_capacity(WIDTH);
        if self.best[at].choices[0] == Choice::Leaf {
            // The whole tree is one leaf.
            roots.push(at);
        } else {
            let first = self.best[at].first.into();
            let children = self.binary.nodes[at].first_index as usize;
            self.forest(children, first, &mut roots);
            self.forest(children + 1, WIDTH - first, &mut roots);
        }
        let children: Vec<_> = roots
            .iter()
            .map(|&root| {
                let bounds = self.binary.nodes[root].aabb();
                let child = if self.best[root].choices[0] == Choice::Leaf {
                    let mut members = Vec::with_capacity(self.max_leaf as usize);
                    self.gather(root, &mut members);
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

    /// Collects the roots of the best forest of the subtree at `at`.
    fn forest(&self, at: usize, count: usize, roots: &mut Vec<usize>) {
        match self.best[at].choices[count - 1] {
            Choice::Leaf | Choice::Node => roots.push(at),
            Choice::Fewer => self.forest(at, count - 1, roots),
            Choice::Split(first) => {
                let children = self.binary.nodes[at].first_index as usize;
                self.forest(children, first.into(), roots);
                self.forest(children + 1, count - usize::from(first), roots);
            }
        }
    }

    /// Collects the primitives below `at`.
    fn gather(&self, at: usize, members: &mut Vec<u32>) {
        let node = &self.binary.nodes[at];
        if node.is_leaf() {
            members.push(self.binary.primitive_indices[node.first_index as usize]);
        } else {
            self.gather(node.first_index as usize, members);
            self.gather(node.first_index as usize + 1, members);
        }
    }
}
