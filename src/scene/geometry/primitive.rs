//! What the acceleration structure holds.

use bytemuck::{Pod, Zeroable};
use glam::Vec3A;
use obvhs::{Boundable, aabb::Aabb};

use super::pages::Pages;
use super::triangle::{Corners, LANES, Packet};
use crate::scene::SCENE_RADIUS;

/// A triangle or a sphere, in scene units.
#[derive(Clone, Copy, Debug)]
pub enum Primitive {
    /// One triangle of a mesh.
    Triangle {
        /// In the order of the mesh.
        corners: Corners,
        /// Index of the shape.
        shape: u32,
        /// Indices into the attributes of the mesh.
        vertices: [u32; 3],
    },
    /// A whole sphere.
    Sphere {
        /// Centre.
        center: [f32; 3],
        /// Positive.
        radius: f32,
        /// Index of the shape.
        shape: u32,
    },
}

/// By how much boxes are larger than what they hold, in scene units.
///
/// For rays that start within 1.7 [`SCENE_RADIUS`] of the centre, the slab test of a box at a distance of
/// up to 2.7 radii errs by at most two roundings of 2^-24 of that distance and two of a coordinate (the
/// plane's and the origin's, where a product is rounded), 4.9e-4 in all; a direction component that the
/// ray replaces by 2^-23, since it is smaller, moves the ray by 3.2e-4. The sum is 8.1e-4.
pub const PADDING: f32 = 2e-6 * SCENE_RADIUS;

impl Boundable for Primitive {
    #[inline]
    fn aabb(&self) -> Aabb {
        let (min, max) = match *self {
            Self::Triangle { corners, .. } => {
                let [a, b, c] = corners.map(Vec3A::from_array);
                (a.min(b).min(c), a.max(b).max(c))
            }
            Self::Sphere { center, radius, .. } => {
                let center = Vec3A::from_array(center);
                (center - radius, center + radius)
            }
        };
        Aabb::new(min - PADDING, max + PADDING)
    }
}

/// A sphere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ball {
    pub center: [f32; 3],
    pub radius: f32,
    shape: u32,
}

/// What belongs to a triangle and is asked for once a ray has met it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Owner {
    shape: u32,
    vertices: [u32; 3],
}

/// All primitives, in the leaves' order: triangles by [`LANES`], each leaf's in a packet of its own, then
/// spheres. A primitive's number counts the empty places of packets.
pub struct Primitives {
    pub packets: Pages<Packet>,
    owners: Pages<[Owner; LANES]>,
    pub spheres: Vec<Ball>,
}

/// Memory is given back whenever so many primitives have been packed.
const GIVE_BACK: usize = 1 << 16;

impl Primitives {
    /// From primitives in the order of the leaves, the numbers of primitives in these, and the number of
    /// spheres among them.
    pub fn new(mut primitives: Vec<Primitive>, leaves: &[u8], spheres: usize) -> Self {
        let packets = leaves.len() - spheres;
        let mut all = Self {
            packets: Pages::zeroed(packets),
            owners: Pages::zeroed(packets),
            spheres: vec![Ball::default(); spheres],
        };
        // From the back, so that what has been packed can be given back.
        let (mut packet, mut sphere) = (packets, spheres);
        for &count in leaves.iter().rev() {
            let rest = primitives.len() - usize::from(count);
            let leaf = &primitives[rest..];
            if let &[
                Primitive::Sphere {
                    center,
                    radius,
                    shape,
                },
            ] = leaf
            {
                sphere -= 1;
                all.spheres[sphere] = Ball {
                    center,
                    radius,
                    shape,
                };
            } else {
                packet -= 1;
                (all.packets[packet], all.owners[packet]) = pack(leaf);
            }
            primitives.truncate(rest);
            if primitives.capacity() - rest > GIVE_BACK {
                primitives.shrink_to_fit();
            }
        }
        all
    }

    /// The number of the triangle at `lane` of a packet.
    #[inline]
    pub fn number(packet: u32, lane: usize) -> u32 {
        packet * LANES as u32 + lane as u32
    }

    /// The number of the sphere with this index.
    #[inline]
    pub fn number_of_sphere(&self, index: u32) -> u32 {
        (self.packets.len() * LANES) as u32 + index
    }

    /// The primitive of a number; `None` for empty places, and beyond the last.
    #[inline]
    pub fn get(&self, number: u32) -> Option<Primitive> {
        let (packet, lane) = (number as usize / LANES, number as usize % LANES);
        if let Some(triangles) = self.packets.get(packet) {
            let Owner { shape, vertices } = self.owners[packet][lane];
            return Some(Primitive::Triangle {
                corners: triangles.corners(lane)?,
                shape,
                vertices,
            });
        }
        let sphere = self
            .spheres
            .get(number as usize - self.packets.len() * LANES)?;
        Some(Primitive::Sphere {
            center: sphere.center,
            radius: sphere.radius,
            shape: sphere.shape,
        })
    }

    /// All primitives with their numbers, in the order of these.
    pub fn iter(&self) -> impl Iterator<Item = (u32, Primitive)> {
        let end = self.number_of_sphere(self.spheres.len() as u32);
        (0..end).filter_map(|number| Some((number, self.get(number)?)))
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.packets[..])
            + size_of_val(&self.owners[..])
            + size_of_val(&self.spheres[..])
    }
}

/// The triangles of a leaf.
fn pack(leaf: &[Primitive]) -> (Packet, [Owner; LANES]) {
    let mut owners = [Owner::zeroed(); LANES];
    let mut triangles = [[[f32::NAN; 3]; 3]; LANES];
    for (i, primitive) in leaf.iter().enumerate() {
        if let &Primitive::Triangle {
            corners,
            shape,
            vertices,
        } = primitive
        {
            triangles[i] = corners;
            owners[i] = Owner { shape, vertices };
        }
    }
    (Packet::new(triangles), owners)
}
