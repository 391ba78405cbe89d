//! Nodes of the wide tree: eight children each.

use bytemuck::{Pod, Zeroable};
use glam::Vec3A;
use wide::f32x8;

/// Children of a node.
pub const WIDTH: usize = 8;

/// Maximum depth of a tree that can be traversed: each level leaves up to seven children on the stack.
pub const MAX_DEPTH: u32 = 30;

/// A reference to a node or leaf, packed in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Child(pub u32);

/// What a [`Child`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Index of a node of the tree.
    Node(u32),
    /// Index of a packet of triangles.
    Triangles(u32),
    /// Index of a sphere.
    Sphere(u32),
}

impl Child {
    /// The first node.
    pub const ROOT: Self = Self(0);

    const LEAF: u32 = 1 << 31;
    const SPHERE: u32 = 1 << 30;

    /// Packs the reference.
    pub fn new(kind: Kind) -> Self {
        Self(match kind {
            Kind::Node(node) => node,
            Kind::Triangles(packet) => packet | Self::LEAF,
            Kind::Sphere(sphere) => sphere | Self::LEAF | Self::SPHERE,
        })
    }

    /// Unpacks the reference.
    #[inline]
    pub fn kind(self) -> Kind {
        let index = self.0 & (Self::SPHERE - 1);
        if self.0 & Self::LEAF == 0 {
            Kind::Node(self.0)
        } else if self.0 & Self::SPHERE == 0 {
            Kind::Triangles(index)
        } else {
            Kind::Sphere(index)
        }
    }
}

/// The boxes of the children and references to them.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Node {
    /// For each axis the lower and the upper planes of all children's boxes.
    pub planes: [[f32x8; 2]; 3],
    /// Unused places have an empty box.
    pub children: [Child; WIDTH],
    /// Aligns nodes with cache lines.
    padding: [u32; 8],
}

impl Node {
    /// A node over at most eight children, each with the lower and upper corner of its box.
    pub fn new(children: &[(Child, Vec3A, Vec3A)]) -> Self {
        // A box whose upper corner is below its lower one is empty: no ray enters it.
        let mut planes = [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3];
        let mut words = [Child::ROOT; WIDTH];
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

    /// The children in use.
    pub fn children(&self) -> impl Iterator<Item = Child> {
        let lower = self.planes[0][0].to_array();
        let children = self.children.into_iter().zip(lower);
        children.filter_map(|(child, lower)| (lower < f32::INFINITY).then_some(child))
    }

    /// Replaces each child in use by its image under `change`.
    pub fn map(&mut self, change: impl Fn(Kind) -> Kind) {
        let count = self.children().count();
        for child in &mut self.children[..count] {
            *child = Child::new(change(child.kind()));
        }
    }
}
