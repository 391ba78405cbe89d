//! Triangles and spheres, and how they are stored.

use bytemuck::{Pod, Zeroable};
use glam::Vec3A;
use obvhs::{Boundable, aabb::Aabb};

use super::huge_pages::HugePages;
use super::triangle::{Corners, LANES, Packet};

/// Radius of the ball around the origin in which all primitives lie.
pub const RADIUS: f32 = 1000.0;

/// Padding of bounding boxes.
///
/// For rays that start within 1.7 [`RADIUS`] of the centre, the slab test of a box at a distance of up
/// to 2.7 radii errs by at most two roundings of 2^-24 of that distance and two of a coordinate (that
/// of the plane and that of the origin, where a product is rounded), 4.9e-4 in all. A direction
/// component smaller than 2^-23 is replaced by 2^-23, which moves the ray by 3.2e-4. The sum is 8.1e-4.
pub const PADDING: f32 = 2e-6 * RADIUS;

/// A triangle or a sphere.
#[derive(Clone, Copy, Debug)]
pub enum Primitive {
    /// One triangle of a mesh.
    Triangle(Triangle),
    /// A whole sphere.
    Sphere(Sphere),
}

/// One triangle of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// In the order of the mesh.
    pub corners: Corners,
    /// Index of the shape that it belongs to.
    pub shape: u32,
    /// Indices of the corners among the vertices of the mesh.
    pub vertices: [u32; 3],
}

/// A sphere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sphere {
    /// Centre.
    pub center: [f32; 3],
    /// Positive.
    pub radius: f32,
    /// Index of the shape that it belongs to.
    pub shape: u32,
}

impl Boundable for Primitive {
    #[inline]
    fn aabb(&self) -> Aabb {
        let (min, max) = match *self {
            Self::Triangle(Triangle { corners, .. }) => {
                let [a, b, c] = corners.map(Vec3A::from_array);
                (a.min(b).min(c), a.max(b).max(c))
            }
            Self::Sphere(Sphere { center, radius, .. }) => {
                let center = Vec3A::from_array(center);
                (center - radius, center + radius)
            }
        };
        Aabb::new(min - PADDING, max + PADDING)
    }
}

/// The part of a triangle that is read only once a ray has hit it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct TriangleIndices {
    shape: u32,
    vertices: [u32; 3],
}

/// All primitives in the order of the leaves: first the triangles in packets of [`LANES`], a packet for
/// each leaf, then the spheres. The index of a primitive counts the unused lanes of packets too.
pub struct PrimitiveStore {
    pub packets: HugePages<Packet>,
    indices: HugePages<[TriangleIndices; LANES]>,
    pub spheres: Vec<Sphere>,
}

/// Memory of the unpacked primitives is released whenever this many have been packed.
const RELEASE_INTERVAL: usize = 1 << 16;

impl PrimitiveStore {
    /// Packs primitives that are in the order of the leaves; `leaves` holds the number of primitives
    /// in each leaf.
    pub fn new(mut primitives: Vec<Primitive>, leaves: &[u8]) -> Self {
        let is_sphere = |primitive: &&Primitive| matches!(primitive, Primitive::Sphere(_));
        let sphere_count = primitives.iter().filter(is_sphere).count();
        let packet_count = leaves.len() - sphere_count;
        let mut store = Self {
            packets: HugePages::zeroed(packet_count),
            indices: HugePages::zeroed(packet_count),
            spheres: vec![Sphere::default(); sphere_count],
        };
        // From the back, so that the memory of what has been packed can be released.
        let (mut packet, mut sphere) = (packet_count, sphere_count);
        for &count in leaves.iter().rev() {
            let rest = primitives.len() - usize::from(count);
            let leaf = &primitives[rest..];
            if let &[Primitive::Sphere(only)] = leaf {
                sphere -= 1;
                store.spheres[sphere] = only;
            } else {
                packet -= 1;
                (store.packets[packet], store.indices[packet]) = pack(leaf);
            }
            primitives.truncate(rest);
            if primitives.capacity() - rest > RELEASE_INTERVAL {
                primitives.shrink_to_fit();
            }
        }
        store
    }

    /// The index of the triangle at `lane` of a packet.
    #[inline]
    pub fn triangle_index(packet: u32, lane: usize) -> u32 {
        packet * LANES as u32 + lane as u32
    }

    /// The index, among all primitives, of a sphere.
    #[inline]
    pub fn sphere_index(&self, sphere: u32) -> u32 {
        (self.packets.len() * LANES) as u32 + sphere
    }

    /// The primitive with this index; `None` for unused lanes and beyond the last primitive.
    #[inline]
    pub fn get(&self, index: u32) -> Option<Primitive> {
        let (packet, lane) = (index as usize / LANES, index as usize % LANES);
        if let Some(triangles) = self.packets.get(packet) {
            let TriangleIndices { shape, vertices } = self.indices[packet][lane];
            return Some(Primitive::Triangle(Triangle {
                corners: triangles.corners(lane)?,
                shape,
                vertices,
            }));
        }
        let sphere = index as usize - self.packets.len() * LANES;
        self.spheres.get(sphere).copied().map(Primitive::Sphere)
    }

    /// All primitives with their indices, in increasing order of the index.
    pub fn iter(&self) -> impl Iterator<Item = (u32, Primitive)> {
        let end = self.sphere_index(self.spheres.len() as u32);
        (0..end).filter_map(|index| Some((index, self.get(index)?)))
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.packets[..])
            + size_of_val(&self.indices[..])
            + size_of_val(&self.spheres[..])
    }
}

/// The packet of a leaf's triangles.
fn pack(leaf: &[Primitive]) -> (Packet, [TriangleIndices; LANES]) {
    let mut indices = [TriangleIndices::zeroed(); LANES];
    let mut corners = [[[f32::NAN; 3]; 3]; LANES];
    for (lane, primitive) in leaf.iter().enumerate() {
        if let Primitive::Triangle(triangle) = primitive {
            corners[lane] = triangle.corners;
            indices[lane] = TriangleIndices {
                shape: triangle.shape,
                vertices: triangle.vertices,
            };
        }
    }
    (Packet::new(corners), indices)
}
