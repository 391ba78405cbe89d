//! Shapes and the acceleration structure that finds them.

mod collapse;
mod hierarchy;
mod pages;
mod primitive;
mod shape;
mod sphere;
mod traversal;
mod triangle;

#[cfg(test)]
mod tests;

use glam::{Mat3A, Vec3A};
use obvhs::Boundable;
use obvhs::aabb::Aabb;

use super::{Ray, SCENE_RADIUS, SurfacePoint, TriangleMesh};
use hierarchy::Hierarchy;
use pages::Pages;
use primitive::{Ball, PADDING, Primitive, Primitives};
use shape::{Attributes, MeshAttributes, Shape, cross};
use traversal::{Kind, Node};
use triangle::{Corners, Shear};

/// Rays traced: the unit of cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Closest-hit queries.
    pub closest_hit: u64,
    /// Occlusion queries.
    pub shadow: u64,
}

/// By how much a shadow ray ends before its target: its two ends are off their surfaces by more than
/// this, but the distance at which it meets a surface has an error. Relative and in scene units.
const SHADOW_END: (f32, f32) = (1.0 - 1e-6, 1e-7 * SCENE_RADIUS);

impl RayCounts {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.closest_hit + self.shadow
    }
}

impl std::ops::AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.closest_hit += other.closest_hit;
        self.shadow += other.shadow;
    }
}

impl std::iter::Sum for RayCounts {
    fn sum<I: Iterator<Item = Self>>(counts: I) -> Self {
        counts.fold(Self::default(), |mut sum, more| {
            sum += more;
            sum
        })
    }
}

/// All surfaces of a scene.
pub struct Geometry {
    nodes: Pages<Node>,
    primitives: Primitives,
    /// The box around all primitives, padded.
    bounds: Aabb,
    shapes: Vec<Shape>,
    triangles: usize,
    degenerate: usize,
}

impl Geometry {
    /// The first surface that `ray` meets.
    #[inline]
    pub fn intersect(&self, ray: &Ray, counts: &mut RayCounts) -> Option<SurfacePoint> {
        counts.closest_hit += 1;
        self.first_hit(&enter_scene(ray)?)
    }

    /// True if no surface lies between `from` and `to`, which have both been moved off their own
    /// surfaces ([`super::surface::offset`]).
    #[inline]
    pub fn visible(&self, from: Vec3A, to: Vec3A, counts: &mut RayCounts) -> bool {
        counts.shadow += 1;
        let distance = (to - from).length();
        let t_max = distance * SHADOW_END.0 - SHADOW_END.1;
        if t_max <= 0.0 {
            return true;
        }
        let ray = Ray {
            origin: from,
            direction: (to - from) / distance,
            t_max,
        };
        enter_scene(&ray).is_none_or(|ray| self.misses(&ray))
    }

    fn first_hit(&self, ray: &Ray) -> Option<SurfacePoint> {
        let shear = Shear::new(ray.origin, ray.direction);
        let mut barycentric = (0.0, 0.0);
        let mut number = u32::MAX;
        let mut distance = ray.t_max;
        traversal::visit(&self.nodes, ray, |leaf, t_max| {
            match leaf {
                Kind::Sphere(sphere) => {
                    if let Some(t) = self.meet_sphere(sphere, ray, t_max) {
                        number = self.primitives.number_of_sphere(sphere);
                        distance = t;
                    }
                }
                Kind::Triangles(packet) | Kind::Node(packet) => {
                    let triangles = &self.primitives.packets[packet as usize];
                    if let Some(hit) = shear.intersect(triangles, t_max) {
                        number = Primitives::number(packet, hit.lane);
                        barycentric = (hit.b1, hit.b2);
                        distance = hit.t;
                    }
                }
            }
            distance
        });
        match self.primitives.get(number)? {
            Primitive::Triangle {
                corners,
                shape,
                vertices,
            } => {
                let (b1, b2) = barycentric;
                let numbers = (shape, number);
                Some(self.shapes[shape as usize].on_triangle(numbers, &corners, vertices, b1, b2))
            }
            Primitive::Sphere {
                center,
                radius,
                shape,
            } => {
                let near = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(distance);
                let numbers = (shape, number);
                Some(self.shapes[shape as usize].on_sphere(numbers, center, radius, near))
            }
        }
    }

    fn misses(&self, ray: &Ray) -> bool {
        let shear = Shear::new(ray.origin, ray.direction);
        !traversal::any(&self.nodes, ray, |leaf| match leaf {
            Kind::Sphere(sphere) => self.meet_sphere(sphere, ray, ray.t_max).is_some(),
            Kind::Triangles(packet) | Kind::Node(packet) => {
                shear.meets(&self.primitives.packets[packet as usize], ray.t_max)
            }
        })
    }

    #[inline]
    fn meet_sphere(&self, sphere: u32, ray: &Ray, t_max: f32) -> Option<f32> {
        let Ball { center, radius, .. } = self.primitives.spheres[sphere as usize];
        sphere::intersect(center, radius, ray.origin, ray.direction, t_max)
    }

    /// The surfaces of all shapes for which `wanted` is true; of the others no triangle.
    pub(super) fn surfaces(&self, wanted: impl Fn(u32) -> bool) -> Vec<PlacedSurface> {
        let none = || PlacedSurface::Triangles(Vec::new());
        let mut surfaces: Vec<PlacedSurface> = self.shapes.iter().map(|_| none()).collect();
        for (primitive, placed) in self.primitives.iter() {
            match placed {
                Primitive::Triangle {
                    corners,
                    shape,
                    vertices,
                } if wanted(shape) => {
                    let normal = self.shapes[shape as usize].triangle_normal(&corners, vertices);
                    if let PlacedSurface::Triangles(list) = &mut surfaces[shape as usize] {
                        list.push(PlacedTriangle {
                            corners,
                            normal,
                            primitive,
                        });
                    }
                }
                Primitive::Sphere {
                    center,
                    radius,
                    shape,
                } if wanted(shape) => {
                    surfaces[shape as usize] = PlacedSurface::Sphere {
                        center: center.into(),
                        radius,
                        inward: self.shapes[shape as usize].flip,
                    }
                }
                Primitive::Triangle { .. } | Primitive::Sphere { .. } => {}
            }
        }
        surfaces
    }

    /// Index of the material of a shape.
    #[inline]
    pub fn material(&self, shape: u32) -> u32 {
        self.shapes[shape as usize].material
    }

    /// How messages call a shape.
    pub fn shape_name(&self, shape: u32) -> &str {
        &self.shapes[shape as usize].name
    }

    /// Number of shapes.
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// Number of triangles that have area.
    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// Number of spheres.
    pub fn sphere_count(&self) -> usize {
        self.primitives.spheres.len()
    }

    /// Number of triangles and spheres left out because they have no area.
    pub fn degenerate_count(&self) -> usize {
        self.degenerate
    }

    /// Lower and upper corner of the box around all surfaces in scene units; `None` without surfaces.
    pub fn bounds(&self) -> Option<(Vec3A, Vec3A)> {
        let padded = self.bounds;
        (!self.nodes.is_empty()).then_some((padded.min + PADDING, padded.max - PADDING))
    }

    /// Bytes in memory: nodes, primitives and attributes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
            + self.primitives.bytes()
            + self.shapes.iter().map(Shape::bytes).sum::<usize>()
    }
}

/// `ray` from where it comes near the scene, so that rounding follows the size of the scene and not
/// the distance of the camera; `None` if it passes by.
#[inline]
fn enter_scene(ray: &Ray) -> Option<Ray> {
    const NEAR: f32 = 1.2 * SCENE_RADIUS;
    if ray.origin.length_squared() <= NEAR * NEAR {
        return Some(*ray);
    }
    let along = ray.origin.dot(ray.direction);
    let closest = ray.origin - ray.direction * along;
    let skipped = -along - NEAR;
    if closest.length_squared() > NEAR * NEAR || along >= 0.0 {
        return None;
    }
    if skipped <= 0.0 {
        return Some(*ray);
    }
    (ray.t_max > skipped).then(|| Ray {
        origin: closest - ray.direction * NEAR,
        direction: ray.direction,
        t_max: ray.t_max - skipped,
    })
}

/// A geometry in the making.
#[derive(Default)]
pub(super) struct GeometryBuilder {
    primitives: Vec<Primitive>,
    shapes: Vec<Shape>,
    spheres: usize,
    degenerate: usize,
}

/// The surface of a shape in scene units, for an emitter to shine from.
pub(super) enum PlacedSurface {
    /// Triangles with area, in the order of their primitives.
    Triangles(Vec<PlacedTriangle>),
    /// A sphere of positive radius.
    Sphere {
        center: Vec3A,
        radius: f32,
        /// The front side is inside.
        inward: bool,
    },
}

/// A triangle with area.
#[derive(Debug)]
pub(super) struct PlacedTriangle {
    pub(super) corners: Corners,
    /// Unit, on the front side.
    pub(super) normal: Vec3A,
    /// As [`SurfacePoint::primitive`].
    pub(super) primitive: u32,
}

impl PlacedTriangle {
    /// In scene units squared.
    pub(super) fn area(&self) -> f64 {
        0.5 * cross(&self.corners).length()
    }
}

impl GeometryBuilder {
    /// Adds a mesh in scene units as the next shape.
    pub(super) fn add_mesh(&mut self, name: String, material: u32, flip: bool, mesh: TriangleMesh) {
        let shape = self.shapes.len() as u32;
        self.primitives.reserve(mesh.triangles.len());
        let before = self.primitives.len();
        let placed = mesh.triangles.iter().filter_map(|&vertices| {
            let corners = vertices.map(|v| mesh.positions[v as usize]);
            (cross(&corners).length_squared() > 0.0).then_some(Primitive::Triangle {
                corners,
                shape,
                vertices,
            })
        });
        self.primitives.extend(placed);
        self.degenerate += mesh.triangles.len() - (self.primitives.len() - before);
        let attributes = Attributes::Mesh(MeshAttributes {
            normals: mesh.normals,
            uvs: mesh.uvs,
        });
        self.shapes.push(Shape {
            name,
            material,
            flip,
            attributes,
        });
    }

    /// Adds a sphere in scene units as the next shape; `to_local` turns scene axes into its own.
    pub(super) fn add_sphere(
        &mut self,
        name: String,
        material: u32,
        flip: bool,
        (center, radius): (Vec3A, f32),
        to_local: Mat3A,
    ) {
        let shape = self.shapes.len() as u32;
        if radius > 0.0 {
            self.spheres += 1;
            self.primitives.push(Primitive::Sphere {
                center: center.to_array(),
                radius,
                shape,
            });
        } else {
            self.degenerate += 1;
        }
        self.shapes.push(Shape {
            name,
            material,
            flip,
            attributes: Attributes::Sphere(to_local),
        });
    }

    /// Builds the acceleration structure.
    pub(super) fn build(mut self) -> Geometry {
        self.primitives.shrink_to_fit();
        let Hierarchy { nodes, leaves } = hierarchy::build(&mut self.primitives);
        let bounds = self
            .primitives
            .iter()
            .fold(Aabb::INVALID, |all, primitive| all.union(&primitive.aabb()));
        let triangles = self.primitives.len() - self.spheres;
        Geometry {
            nodes,
            primitives: Primitives::new(self.primitives, &leaves, self.spheres),
            bounds,
            shapes: self.shapes,
            triangles,
            degenerate: self.degenerate,
        }
    }
}
