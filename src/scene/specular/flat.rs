//! Chains through the flat faces of one shape: slabs, blocks, prisms, mirrors. Every sequence of faces and
//! lobes has at most one chain.
//!
//! Reflections are unfolded: the faces after a reflection, and the end, are mirrored in its plane, so that the
//! chain goes straight there. What remains are refractions at planes. The chain minimises the optical length
//! (Fermat), sum eta |x_{k+1} - x_k|, which is convex in the points on the planes.

use arrayvec::ArrayVec;
use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, DVec4};

use super::chain::{Candidate, Endpoint, Lobes, MAX_LENGTH};
use crate::bvh::Corners;
use crate::scene::bsdf::DeltaLobe::{self, Reflection, Transmission};

/// Maximum number of faces of a shape whose sequences are enumerated.
pub const MAX_FACES: usize = 16;

/// Tolerance for the normals of faces in one plane, and relative tolerance for points on faces.
const TOLERANCE: f64 = 1e-5;

/// Tolerance for distances from a plane, in scene units: coordinates are rounded to f32.
const PLANE_TOLERANCE: f64 = 1e-6 * crate::scene::SCENE_RADIUS as f64;

/// Distance in scene units below which the points of two planes are at the edge where these meet, at which the
/// optical length has its minimum if there is no chain.
const AT_EDGE: f64 = 1e-6 * crate::scene::SCENE_RADIUS as f64;

/// Size of a step, in scene units, at which an iteration ends.
const MIN_STEP: f64 = 1e-11 * crate::scene::SCENE_RADIUS as f64;

/// Maximum number of Newton steps.
const STEPS: usize = 16;

/// A shape of flat faces that reflects or refracts without roughness.
#[derive(Debug)]
pub struct FlatCaster {
    pub shape: u32,
    /// Index of refraction of the side behind the normals over that of the other side; `None` if it only
    /// reflects.
    pub eta: Option<f64>,
    faces: Vec<Face>,
    /// All faces lie behind each other: the shape is a convex body, and its normals point outward.
    convex: bool,
}

/// The triangles of a shape in one plane.
#[derive(Debug)]
struct Face {
    plane: Plane,
    triangles: Vec<Corners>,
    /// A sphere around the triangles.
    center: DVec3,
    radius: f64,
}

/// The points x with normal . x = offset.
#[derive(Clone, Copy, Debug)]
struct Plane {
    /// Unit, on the front side.
    normal: DVec3,
    offset: f64,
}

impl Plane {
    fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// The reflection in the plane.
    fn mirror(&self) -> DAffine3 {
        let n = self.normal;
        let outer = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        DAffine3 {
            matrix3: DMat3::IDENTITY - outer * 2.0,
            translation: 2.0 * self.offset * n,
        }
    }

    /// The image of the plane under an isometry.
    fn transformed(&self, isometry: &DAffine3) -> Self {
        let normal = isometry.matrix3 * self.normal;
        Self {
            normal,
            offset: self.offset + normal.dot(isometry.translation),
        }
    }

    /// Positive if the end is in front.
    fn side_of(&self, end: &Endpoint) -> f64 {
        match end {
            Endpoint::Point { position, .. } => self.distance(*position),
            Endpoint::Direction(direction) => self.normal.dot(*direction),
        }
    }
}

impl Face {
    fn contains(&self, point: DVec3) -> bool {
        self.triangles.iter().any(|corners| {
            let [a, b, c] = corners.map(|p| DVec3::from_array(p.map(f64::from)));
            let area = (b - a).cross(c - a).dot(self.plane.normal);
            let part = |p: DVec3, q: DVec3| (p - point).cross(q - point).dot(self.plane.normal);
            let parts = [part(a, b), part(b, c), part(c, a)];
            parts
                .iter()
                .all(|&part| part * area >= -TOLERANCE * area * area)
        })
    }
}

/// A vertex of a sequence in the unfolded space.
#[derive(Clone, Copy)]
struct Step {
    face: usize,
    lobe: DeltaLobe,
    /// The plane of the face.
    plane: Plane,
    /// Between the unfolded space before this vertex and the scene.
    space: Space,
}

/// Unfolded space: mirrored as often as the chain has been reflected.
#[derive(Clone, Copy)]
struct Space {
    to_scene: DAffine3,
    from_scene: DAffine3,
}

impl Space {
    /// Before the first vertex.
    const SCENE: Self = Self {
        to_scene: DAffine3::IDENTITY,
        from_scene: DAffine3::IDENTITY,
    };

    /// After a vertex.
    fn after(step: &Step) -> Self {
        match step.lobe {
            Transmission => step.space,
            Reflection => {
                let mirror = step.plane.mirror();
                Self {
                    to_scene: step.space.to_scene * mirror,
                    from_scene: mirror * step.space.from_scene,
                }
            }
        }
    }
}

/// The search for chains between two points.
struct Search<'a, V> {
    caster: &'a FlatCaster,
    start: DVec3,
    end: &'a Endpoint,
    end_inside: bool,
    steps: ArrayVec<Step, MAX_LENGTH>,
    visit: V,
}

impl FlatCaster {
    /// The caster of triangles and their front normals; `None` if their planes are too many.
    pub fn new(
        shape: u32,
        eta: Option<f64>,
        triangles: impl Iterator<Item = (Corners, DVec3)>,
    ) -> Option<Self> {
        let mut faces: Vec<Face> = Vec::new();
        for (corners, normal) in triangles {
            let points = corners.map(|p| DVec3::from_array(p.map(f64::from)));
            let geometric = (points[1] - points[0])
                .cross(points[2] - points[0])
                .normalize();
            // From the corners, which are more precise than the given normal.
            let normal = geometric * geometric.dot(normal).signum();
            let offset = normal.dot(points.iter().sum::<DVec3>() / 3.0);
            let same = |face: &&mut Face| {
                face.plane.normal.distance(normal) < TOLERANCE
                    && points
                        .iter()
                        .all(|&p| face.plane.distance(p).abs() < PLANE_TOLERANCE)
            };
            if let Some(face) = faces.iter_mut().find(same) {
                face.triangles.push(corners);
            } else if faces.len() == MAX_FACES {
                return None;
            } else {
                let plane = Plane { normal, offset };
                let triangles = vec![corners];
                faces.push(Face {
                    plane,
                    triangles,
                    center: DVec3::ZERO,
                    radius: 0.0,
                });
            }
        }
        for face in &mut faces {
            (face.center, face.radius) = bounding_sphere(face.triangles.iter());
        }
        let corners = || {
            let all = faces
                .iter()
                .flat_map(|face| face.triangles.iter().flatten());
            all.map(|p| DVec3::from_array(p.map(f64::from)))
        };
        let behind = |face: &Face| corners().all(|p| face.plane.distance(p) < PLANE_TOLERANCE);
        let convex = faces.len() >= 4 && faces.iter().all(behind);
        (!faces.is_empty()).then_some(Self {
            shape,
            eta,
            faces,
            convex,
        })
    }

    /// Centre and radius of a sphere around the faces.
    pub fn bounds(&self) -> (DVec3, f64) {
        bounding_sphere(self.faces.iter().flat_map(|face| face.triangles.iter()))
    }

    /// Maximum length of its chains.
    pub fn max_length(&self) -> usize {
        if self.faces.len() == 1 { 1 } else { MAX_LENGTH }
    }

    /// Calls `visit` with every chain of up to [`MAX_LENGTH`] vertices from `start` to `end`.
    pub fn chains(&self, start: DVec3, end: &Endpoint, visit: impl FnMut(Candidate)) {
        let inside = |distance: &dyn Fn(&Plane) -> f64| {
            self.convex && self.faces.iter().all(|face| distance(&face.plane) < 0.0)
        };
        let is_point = matches!(end, Endpoint::Point { .. });
        let mut search = Search {
            caster: self,
            start,
            end,
            end_inside: is_point && inside(&|plane| plane.side_of(end)),
            steps: ArrayVec::new(),
            visit,
        };
        let start_inside = inside(&|plane| plane.distance(start));
        for (index, face) in self.faces.iter().enumerate() {
            let front = face.plane.distance(start) > 0.0;
            // From within a convex body every face is seen from behind; from outside only its front.
            if self.convex && front == start_inside {
                continue;
            }
            search.first(index, front);
        }
    }
}

impl<V: FnMut(Candidate)> Search<'_, V> {
    /// All sequences that begin at a face, seen from its front side or from behind.
    fn first(&mut self, face: usize, front: bool) {
        let outside = front;
        let refracts = self.caster.eta.is_some();
        self.step(face, Reflection, Space::SCENE);
        self.finish(outside);
        if !outside {
            self.inside();
        }
        self.steps.clear();
        if refracts {
            self.step(face, Transmission, Space::SCENE);
            self.finish(!outside);
            if outside {
                self.inside();
            }
            self.steps.clear();
        }
    }

    /// Extends the sequence, which is inside the body.
    fn inside(&mut self) {
        if self.steps.len() == MAX_LENGTH {
            return;
        }
        let Some(&last) = self.steps.last() else {
            return;
        };
        let space = Space::after(&last);
        for face in 0..self.caster.faces.len() {
            if face == last.face {
                continue;
            }
            self.step(face, Reflection, space);
            self.finish(false);
            self.inside();
            self.steps.pop();
            if self.caster.eta.is_some() {
                self.step(face, Transmission, space);
                self.finish(true);
                self.steps.pop();
            }
        }
    }

    fn step(&mut self, face: usize, lobe: DeltaLobe, space: Space) {
        self.steps.push(Step {
            face,
            lobe,
            plane: self.caster.faces[face].plane.transformed(&space.from_scene),
            space,
        });
    }

    /// Solves the sequence with the end on the outside or inside of its last face.
    fn finish(&mut self, outside: bool) {
        let Some(&last) = self.steps.last() else {
            return;
        };
        let side = self.caster.faces[last.face].plane.side_of(self.end);
        if outside != (side > 0.0) || (self.caster.convex && outside == self.end_inside) {
            return;
        }
        if !self.may_leave(&last) {
            return;
        }
        let unfold = Space::after(&last).from_scene;
        let end = match self.end {
            Endpoint::Point { position, .. } => Endpoint::Point {
                position: unfold.transform_point3(*position),
                normal: None,
            },
            Endpoint::Direction(direction) => {
                Endpoint::Direction(unfold.transform_vector3(*direction))
            }
        };
        let Some(direction) = self.solve(&end) else {
            return;
        };
        let lobes: ArrayVec<DeltaLobe, MAX_LENGTH> = self.steps.iter().map(|s| s.lobe).collect();
        (self.visit)(Candidate {
            direction,
            lobes: Lobes::new(&lobes),
            shape: self.caster.shape,
        });
    }

    /// False if total internal reflection keeps the chain from leaving through its last face, where it comes
    /// straight from its start: no point of the face is within the critical angle.
    fn may_leave(&self, last: &Step) -> bool {
        let eta = self.caster.eta.unwrap_or(1.0);
        let refracted_before = self.steps.len() > 1 && self.steps[0].lobe == Transmission;
        let from_behind = last.plane.distance(self.start) < 0.0;
        let relative = if from_behind { eta } else { eta.recip() };
        if last.lobe == Reflection || refracted_before || relative <= 1.0 {
            return true;
        }
        let height = last.plane.distance(self.start);
        let foot = self.start - last.plane.normal * height;
        let face = &self.caster.faces[last.face];
        let center = last.space.from_scene.transform_point3(face.center);
        let reach = height.abs() / (relative * relative - 1.0).sqrt() + face.radius;
        foot.distance_squared(center) <= reach * reach
    }

    /// The direction in which the chain leaves its start, in unfolded space; `None` if it misses a face.
    fn solve(&self, end: &Endpoint) -> Option<DVec3> {
        let eta = self.caster.eta.unwrap_or(1.0);
        let refractions: ArrayVec<Plane, MAX_LENGTH> = self
            .steps
            .iter()
            .filter(|step| step.lobe == Transmission)
            .map(|step| step.plane)
            .collect();
        // The index before the first vertex, and after each refraction.
        let first = self.steps.first()?;
        let front = first.plane.distance(self.start) > 0.0;
        let mut index = if front { 1.0 } else { eta };
        let mut indices: ArrayVec<f64, { MAX_LENGTH + 1 }> = ArrayVec::new();
        for _ in 0..=refractions.len() {
            indices.push(index);
            index = if index == 1.0 { eta } else { 1.0 };
        }
        let points = match refractions[..] {
            [] => ArrayVec::new(),
            [plane] => {
                let mut points: ArrayVec<DVec3, 2> = ArrayVec::new();
                points.push(refract_once(
                    self.start,
                    end,
                    &plane,
                    [indices[0], indices[1]],
                )?);
                points
            }
            [a, b] => refract_twice(
                self.start,
                end,
                [a, b],
                [indices[0], indices[1], indices[2]],
            )?,
            _ => return None,
        };
        // Every vertex lies within its face.
        let mut from = self.start;
        let mut next = points.iter().copied();
        let mut pending: ArrayVec<DVec3, 2> = points.clone();
        let mut first_direction = None;
        for step in &self.steps {
            let toward = match pending.first() {
                Some(&point) => (point - from).try_normalize()?,
                None => end.from(from).0,
            };
            let vertex = match step.lobe {
                Transmission => {
                    pending.remove(0);
                    next.next()?
                }
                Reflection => {
                    let along = step.plane.normal.dot(toward);
                    let distance = -step.plane.distance(from) / along;
                    if !(distance > 0.0 && distance.is_finite()) {
                        return None;
                    }
                    from + toward * distance
                }
            };
            let in_scene = step.space.to_scene.transform_point3(vertex);
            if !self.caster.faces[step.face].contains(in_scene) {
                return None;
            }
            first_direction = first_direction.or((vertex - self.start).try_normalize());
            from = vertex;
        }
        first_direction
    }
}

/// Centre and radius of a sphere around triangles.
fn bounding_sphere<'a>(triangles: impl Iterator<Item = &'a Corners> + Clone) -> (DVec3, f64) {
    let corners = || {
        let all = triangles.clone().flatten();
        all.map(|p| DVec3::from_array(p.map(f64::from)))
    };
    let (min, max) = corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| {
        (min.min(p), max.max(p))
    });
    let center = 0.5 * (min + max);
    let radius = corners().map(|p| p.distance(center)).fold(0.0, f64::max);
    (center, radius)
}

/// The point of a plane where light from `start` is refracted toward `end`; `None` if they are on one side.
fn refract_once(
    start: DVec3,
    end: &Endpoint,
    plane: &Plane,
    [eta_start, eta_end]: [f64; 2],
) -> Option<DVec3> {
    let height = plane.distance(start);
    let foot = start - plane.normal * height;
    let (start_height, side) = (height.abs(), height.signum());
    let end_height = -side * plane.side_of(end);
    if !(start_height > 0.0 && end_height > 0.0) {
        return None;
    }
    let across = match end {
        Endpoint::Point { position, .. } => *position - foot,
        Endpoint::Direction(direction) => *direction,
    };
    let across = across - plane.normal * plane.normal.dot(across);
    let length = across.length();
    if length == 0.0 {
        return Some(foot);
    }
    let lateral = across / length;
    let offset = match end {
        Endpoint::Direction(_) => {
            let sin = eta_end * length / eta_start;
            if sin >= 1.0 {
                return None;
            }
            start_height * sin / (1.0 - sin * sin).sqrt()
        }
        Endpoint::Point { .. } => {
            // Increasing in x, and convex below and concave above its inflection: bracketed Newton.
            let f = |x: f64| {
                let y = length - x;
                let a = (x * x + start_height * start_height).sqrt();
                let b = (y * y + end_height * end_height).sqrt();
                let value = eta_start * x / a - eta_end * y / b;
                let slope = eta_start * start_height * start_height / (a * a * a)
                    + eta_end * end_height * end_height / (b * b * b);
                (value, slope)
            };
            let (mut low, mut high) = (0.0, length);
            let mut x = length * start_height / (start_height + end_height);
            for _ in 0..3 * STEPS {
                let (value, slope) = f(x);
                if value > 0.0 {
                    high = x;
                } else {
                    low = x;
                }
                let newton = x - value / slope;
                let next = if newton > low && newton < high {
                    newton
                } else {
                    0.5 * (low + high)
                };
                if (next - x).abs() <= 1e-12 * length {
                    break;
                }
                x = next;
            }
            x
        }
    };
    Some(foot + lateral * offset)
}

/// The points of two planes where light from `start` is refracted toward `end`, by minimising the optical
/// length with Newton's method.
fn refract_twice(
    start: DVec3,
    end: &Endpoint,
    planes: [Plane; 2],
    indices: [f64; 3],
) -> Option<ArrayVec<DVec3, 2>> {
    // Directions inside lie within the critical angle of both normals.
    let inner = indices[1];
    if inner > indices[0] && inner > indices[2] {
        let critical = (indices[0] / inner).asin() + (indices[2] / inner).asin();
        let sides = [planes[0].distance(start), -planes[1].side_of(end)].map(f64::signum);
        let cos = planes[0].normal.dot(planes[1].normal) * sides[0] * sides[1];
        if cos.clamp(-1.0, 1.0).acos() > critical {
            return None;
        }
    }
    let frames = planes.map(|plane| {
        let (s, t) = plane.normal.any_orthonormal_pair();
        [s, t]
    });
    // Start on the straight line between the ends.
    let (toward, _) = end.from(start);
    let crossing = |plane: &Plane| {
        let along = plane.normal.dot(toward);
        let distance = -plane.distance(start) / along;
        if distance > 0.0 && distance.is_finite() {
            start + toward * distance
        } else {
            start - plane.normal * plane.distance(start)
        }
    };
    let mut points = [crossing(&planes[0]), crossing(&planes[1])];
    let length = |points: &[DVec3; 2]| {
        let tail = match end {
            Endpoint::Point { position, .. } => position.distance(points[1]),
            Endpoint::Direction(direction) => -direction.dot(points[1]),
        };
        indices[0] * points[0].distance(start)
            + indices[1] * points[1].distance(points[0])
            + indices[2] * tail
    };
    let mut current = length(&points);
    for _ in 0..STEPS {
        let (w0, d0) = direction(start, points[0])?;
        let (w1, d1) = direction(points[0], points[1])?;
        if d1 < AT_EDGE {
            return None;
        }
        let (w2, d2) = end.from(points[1]);
        let gradients = [
            indices[0] * w0 - indices[1] * w1,
            indices[1] * w1 - indices[2] * w2,
        ];
        let g = [0, 1].map(|k| frames[k].map(|axis| axis.dot(gradients[k])));
        // Second derivatives of the three segments.
        let second =
            |w: DVec3, scale: f64, a: DVec3, b: DVec3| (a.dot(b) - a.dot(w) * b.dot(w)) * scale;
        let [k0, k1, k2] = [indices[0] / d0, indices[1] / d1, indices[2] / d2];
        let mut hessian = [[0.0; 4]; 4];
        for i in 0..4 {
            for j in 0..4 {
                let (a, b) = (frames[i / 2][i % 2], frames[j / 2][j % 2]);
                hessian[i][j] = match (i / 2, j / 2) {
                    (0, 0) => second(w0, k0, a, b) + second(w1, k1, a, b),
                    (1, 1) => second(w1, k1, a, b) + second(w2, k2, a, b),
                    _ => -second(w1, k1, a, b),
                };
            }
        }
        let step = solve_4(hessian, [g[0][0], g[0][1], g[1][0], g[1][1]])?;
        let moves = [DVec2::new(step[0], step[1]), DVec2::new(step[2], step[3])];
        let size = moves[0].length() + moves[1].length();
        let mut factor = 1.0;
        loop {
            let next = [0, 1].map(|k: usize| {
                points[k] - (frames[k][0] * moves[k].x + frames[k][1] * moves[k].y) * factor
            });
            let at_next = length(&next);
            if at_next <= current || factor * size < MIN_STEP {
                (points, current) = (next, at_next);
                break;
            }
            factor *= 0.5;
        }
        if size < MIN_STEP {
            return Some(points.into_iter().collect());
        }
    }
    None
}

/// Unit direction and distance; `None` if the points coincide.
fn direction(from: DVec3, to: DVec3) -> Option<(DVec3, f64)> {
    let distance = from.distance(to);
    (distance > 0.0).then(|| ((to - from) / distance, distance))
}

/// x with M x = `right` for the symmetric matrix M of these rows; `None` if M is singular.
fn solve_4(rows: [[f64; 4]; 4], right: [f64; 4]) -> Option<[f64; 4]> {
    let matrix = DMat4::from_cols_array_2d(&rows);
    let inverse = matrix.inverse();
    inverse
        .is_finite()
        .then(|| (inverse * DVec4::from_array(right)).to_array())
}
