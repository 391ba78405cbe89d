//! Chains through the flat faces of one shape. Every sequence of faces and lobes has at most one chain.
//!
//! Reflections are unfolded: the faces after a reflection, and the end, are mirrored in its plane, so that the
//! chain goes straight there. What remains are refractions at planes ([`refraction`](super::refraction)).

use arrayvec::ArrayVec;
use glam::{DAffine3, DVec3};

use super::chain::{Candidate, Endpoint, Lobes, MAX_LENGTH};
use super::flat::{Face, FlatCaster};
use super::plane::Plane;
use super::refraction::{refract_once, refract_twice};
use super::route::Route;
use crate::scene::bsdf::DeltaLobe::{self, Reflection, Transmission};

/// Faces and lobes of a chain.
type Sequence = ArrayVec<(usize, DeltaLobe), MAX_LENGTH>;

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
    /// Sequences that begin otherwise are left out, and those that end earlier.
    only: Option<Sequence>,
    caster: &'a FlatCaster,
    start: DVec3,
    end: &'a Endpoint,
    end_inside: bool,
    steps: ArrayVec<Step, MAX_LENGTH>,
    visit: V,
}

impl FlatCaster {
    /// Calls `visit` with every chain of up to [`MAX_LENGTH`] vertices from `start` to `end`.
    pub fn chains(&self, start: DVec3, end: &Endpoint, visit: impl FnMut(Candidate)) {
        self.search(start, end, None, visit);
    }

    /// As [`Self::chains`] for those with the faces and lobes of `route`.
    pub fn chains_along(
        &self,
        start: DVec3,
        end: &Endpoint,
        route: &Route,
        visit: impl FnMut(Candidate),
    ) {
        let faces = route.primitives.iter().map(|primitive| {
            let on_face = |face: &Face| face.primitives.contains(primitive);
            self.faces.iter().position(on_face)
        });
        let lobes = route.lobes.as_slice().iter();
        let steps = faces.zip(lobes).map(|(face, &lobe)| Some((face?, lobe)));
        if let Some(only) = steps.collect() {
            self.search(start, end, Some(only), visit);
        }
    }

    fn search(
        &self,
        start: DVec3,
        end: &Endpoint,
        only: Option<Sequence>,
        visit: impl FnMut(Candidate),
    ) {
        let inside = |distance: &dyn Fn(&Plane) -> f64| {
            self.convex && self.faces.iter().all(|face| distance(&face.plane) < 0.0)
        };
        let is_point = matches!(end, Endpoint::Point { .. });
        let mut search = Search {
            only,
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
    /// All sequences that begin at a face, seen from the outside (its front side) or from the inside.
    fn first(&mut self, face: usize, outside: bool) {
        if self.step(face, Reflection, Space::SCENE) {
            self.finish(outside);
            if !outside {
                self.inside();
            }
            self.steps.clear();
        }
        if self.step(face, Transmission, Space::SCENE) {
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
            if self.step(face, Reflection, space) {
                self.finish(false);
                self.inside();
                self.steps.pop();
            }
            if self.step(face, Transmission, space) {
                self.finish(true);
                self.steps.pop();
            }
        }
    }

    /// Appends a vertex to the sequence; false if there is none.
    fn step(&mut self, face: usize, lobe: DeltaLobe, space: Space) -> bool {
        let exists = lobe == Reflection || self.caster.eta.is_some();
        let next = self.steps.len();
        let only = self.only.as_ref();
        if !exists || only.is_some_and(|only| only.get(next) != Some(&(face, lobe))) {
            return false;
        }
        self.steps.push(Step {
            face,
            lobe,
            plane: self.caster.faces[face].plane.transformed(&space.from_scene),
            space,
        });
        true
    }

    /// Solves the sequence with the end on the outside or inside of its last face.
    fn finish(&mut self, outside: bool) {
        let Some(&last) = self.steps.last() else {
            return;
        };
        let only = self.only.as_ref();
        if only.is_some_and(|only| only.len() != self.steps.len()) {
            return;
        }
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
        let mut points = points.into_iter().peekable();
        let mut first_direction = None;
        for step in &self.steps {
            let toward = match points.peek() {
                Some(&point) => (point - from).try_normalize()?,
                None => end.from(from).0,
            };
            let vertex = match step.lobe {
                Transmission => points.next()?,
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
