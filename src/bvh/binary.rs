//! Construction of a binary tree from the top by the binned surface area heuristic (Wald 2007, "On fast
//! construction of SAH-based bounding volume hierarchies").

use glam::Vec3A;
use obvhs::{
    Boundable,
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node},
};

use super::primitive::Primitive;

/// Bins per axis of the surface area heuristic.
const BINS: usize = 16;

/// Levels of a tree below which primitives are split at the median, to bound the depth.
const MAX_HEURISTIC_LEVELS: u32 = 48;

/// How a binary tree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// As cheap to traverse as possible.
    Best,
    /// As shallow as possible, for the rare scene where `Best` is too deep to traverse.
    Shallow,
}

/// A binary tree whose leaves are runs of primitives.
pub struct BinaryTree {
    nodes: Vec<Bvh2Node>,
    /// Lengths of the runs, in the order of the primitives.
    pub leaves: Vec<usize>,
}

impl BinaryTree {
    /// Builds the tree over `primitives`, which are sorted into its order, with at most `max_leaf` of
    /// them in a leaf.
    pub fn build(primitives: &mut [Primitive], max_leaf: usize, quality: Quality) -> Self {
        let mut tree = Self {
            nodes: vec![Bvh2Node::default()],
            leaves: Vec::new(),
        };
        let level = match quality {
            Quality::Best => 0,
            Quality::Shallow => MAX_HEURISTIC_LEVELS,
        };
        tree.build_node(0, primitives, max_leaf, level);
        tree
    }

    fn build_node(&mut self, at: usize, primitives: &mut [Primitive], max_leaf: usize, level: u32) {
        let (bounds, centers) = bounds(primitives);
        if primitives.len() <= max_leaf {
            self.nodes[at] = Bvh2Node::new(bounds, 1, self.leaves.len() as u32);
            self.leaves.push(primitives.len());
            return;
        }
        let middle = if level < MAX_HEURISTIC_LEVELS {
            split_by_heuristic(primitives, &centers)
        } else {
            None
        };
        let middle = middle.unwrap_or_else(|| split_at_median(primitives, &centers));
        let first = self.nodes.len();
        self.nodes.extend([Bvh2Node::default(); 2]);
        self.nodes[at] = Bvh2Node::new(bounds, 0, first as u32);
        let (left, right) = primitives.split_at_mut(middle);
        self.build_node(first, left, max_leaf, level + 1);
        self.build_node(first + 1, right, max_leaf, level + 1);
    }

    /// The tree in the form of `obvhs`, with the leaves as its primitives.
    pub fn into_bvh2(self) -> Bvh2 {
        Bvh2 {
            nodes: self.nodes,
            primitive_indices: (0..self.leaves.len() as u32).collect(),
            ..Bvh2::default()
        }
    }
}

/// The box around `primitives`, and the box around the centres of their boxes.
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

/// Partitions `primitives` where the surface area heuristic is least, of all planes between bins on any
/// axis, and returns where the second group starts. `None` if all centres coincide.
fn split_by_heuristic(primitives: &mut [Primitive], centers: &Aabb) -> Option<usize> {
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
        .flat_map(|axis| cheapest_split(&bins[axis]).map(|(cost, i)| (cost, axis, i)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, axis, i)| (axis, i))?;
    Some(partition(primitives, |p| {
        bin(p.aabb().center(), axis) <= last_left
    }))
}

/// Cost of the cheapest split of `bins` in two groups that are not empty, and the last bin of the first
/// group.
fn cheapest_split(bins: &[(Aabb, usize); BINS]) -> Option<(f32, usize)> {
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

/// The term of a group in the surface area heuristic: area times number of primitives.
fn cost((bounds, count): &(Aabb, usize)) -> f32 {
    if *count == 0 {
        0.0
    } else {
        bounds.half_area() * *count as f32
    }
}

/// Moves the primitives that satisfy `first` to the front and returns their number.
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

/// Splits `primitives` at the median of the axis on which their centres extend farthest.
fn split_at_median(primitives: &mut [Primitive], centers: &Aabb) -> usize {
    let middle = primitives.len() / 2;
    let axis = centers.largest_axis();
    primitives.select_nth_unstable_by(middle, |a, b| {
        let center = |p: &Primitive| p.aabb().center()[axis];
        center(a).total_cmp(&center(b))
    });
    middle
}
