//! The techniques: each joins what the subpaths give and says what light the path carries, before
//! and after weighting. A path whose unoccluded contribution is zero traces no shadow ray.

use glam::{Vec2, Vec3A};

use crate::fault::{Fault, planted};
use crate::math::Rgb;
use crate::path::Escape;
use crate::path::Heuristic;
use crate::path::dimensions;
use crate::path::{Bounce, Vertex};
use crate::sampling::{Coordinates, Stream};
use crate::scene::{LightEvaluation, LightSample, RayCounts, Scene, TransportMode, interaction};

/// A path made by one technique.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Path contribution over the density of this technique: alone, an unbiased estimate of the
    /// light of all paths of this length that the technique can make.
    pub value: Rgb,
    /// Its weight among all techniques that can make the path, in [0, 1].
    pub weight: f32,
    /// Where on the film the path ends, for t = 1; for t > 1 it ends where its camera subpath began.
    pub film: Option<Vec2>,
}

impl Connection {
    /// What the path counts beside those of all other techniques.
    #[inline]
    pub fn contribution(&self) -> Rgb {
        self.value * self.weight
    }

    /// Where on the film it counts, if its camera subpath began at `film`.
    #[inline]
    pub fn position(&self, film: Vec2) -> Vec2 {
        self.film.unwrap_or(film)
    }
}

#[inline]
fn weight(light: f64, camera: f64) -> f32 {
    (1.0 / (1.0 + light + camera)) as f32
}

/// Technique (0, t), t = i + 1: camera vertex z_i lies on an emitter. `previous` is z_{i-1}'s
/// position.
#[inline]
pub fn emitted(
    scene: &Scene,
    heuristic: Heuristic,
    vertex: &Vertex,
    i: usize,
    previous: Vec3A,
) -> Option<Connection> {
    let emission = scene.emitters.evaluate_surface(&vertex.surface, previous)?;
    Some(met(
        heuristic,
        &emission,
        vertex.throughput,
        &vertex.carried,
        i,
    ))
}

/// Technique (0, t) where the camera subpath has left the scene after `i - 1` surface vertices.
#[inline]
pub fn escaped(
    scene: &Scene,
    heuristic: Heuristic,
    escape: &Escape,
    i: usize,
) -> Option<Connection> {
    let emission = scene.emitters.evaluate_environment(escape.direction)?;
    Some(met(
        heuristic,
        &emission,
        escape.throughput,
        &escape.carried,
        i,
    ))
}

fn met(
    heuristic: Heuristic,
    emission: &LightEvaluation,
    throughput: Rgb,
    carried: &crate::path::Carried,
    i: usize,
) -> Connection {
    // A directly visible emitter: no other technique makes paths of one edge.
    let camera = if i == 1 {
        0.0
    } else {
        carried.sum_on_emitter(
            heuristic,
            f64::from(emission.pdf_direct),
            f64::from(emission.pdf_position),
            f64::from(emission.pdf_direction),
        )
    };
    Connection {
        value: throughput * emission.radiance,
        weight: weight(0.0, camera),
        film: None,
    }
}

/// A point on an emitter, sampled for a camera vertex and visible from it.
pub struct SampledLight {
    /// Path contribution over density.
    pub value: Rgb,
    /// The point.
    pub direct: LightSample,
    /// The camera vertex, scattering toward it.
    pub bounce: Bounce,
}

impl SampledLight {
    /// How much denser the camera subpath would have sampled the point than it was.
    #[inline]
    pub fn hit_ratio(&self) -> f64 {
        f64::from(self.bounce.pdf_forward) * f64::from(self.direct.jacobian_direction)
            / f64::from(self.direct.emission.pdf_direct)
    }
}

/// Next event estimation: samples a point on an emitter for camera vertex z_i.
#[inline]
pub fn sample_light<C: Coordinates>(
    scene: &Scene,
    vertex: &Vertex,
    i: usize,
    point: &mut C,
    counts: &mut RayCounts,
) -> Option<SampledLight> {
    if !vertex.is_connectible(scene) {
        return None;
    }
    let [choose, part, u, v] = point.read::<4>(Stream::Connection, dimensions::to_light(i));
    let position = vertex.surface.position;
    let direct = scene
        .emitters
        .sample_direct(position, choose, part, Vec2::new(u, v))?;
    let emission = &direct.emission;
    let bounce = vertex.bounce(scene, direct.direction, TransportMode::Radiance);
    let value = vertex.throughput
        * bounce.value
        * emission.radiance
        * (direct.jacobian_direction / emission.pdf_direct);
    if value == Rgb::ZERO {
        return None;
    }
    let origin = vertex.surface.ray_origin(direct.direction);
    let visible = scene.geometry.visible(origin, direct.target, counts);
    visible.then_some(SampledLight {
        value,
        direct,
        bounce,
    })
}

/// Technique (1, t), t = i + 1: next event estimation from camera vertex z_i.
#[inline]
pub fn to_light<C: Coordinates>(
    scene: &Scene,
    heuristic: Heuristic,
    vertex: &Vertex,
    i: usize,
    point: &mut C,
    counts: &mut RayCounts,
) -> Option<Connection> {
    let sampled = sample_light(scene, vertex, i, point, counts)?;
    let SampledLight {
        value,
        direct,
        bounce,
    } = &sampled;
    let emission = &direct.emission;
    let light = if direct.delta {
        0.0
    } else {
        heuristic.power(sampled.hit_ratio())
    };
    let from_light = f64::from(emission.pdf_position)
        * f64::from(emission.pdf_direction)
        * f64::from(direct.jacobian_area)
        * f64::from(bounce.cos)
        / f64::from(emission.pdf_direct);
    let camera = vertex
        .carried
        .sum(heuristic, from_light, f64::from(bounce.pdf_reverse));
    Some(Connection {
        value: *value,
        weight: weight(light, camera),
        film: None,
    })
}

/// Technique (s, 1), s = i + 1: light vertex y_i is joined to a point on the lens.
#[inline]
pub fn to_lens<C: Coordinates>(
    scene: &Scene,
    heuristic: Heuristic,
    vertex: &Vertex,
    i: usize,
    point: &mut C,
    counts: &mut RayCounts,
) -> Option<Connection> {
    if !vertex.is_connectible(scene) {
        return None;
    }
    let lens = lens_point(scene, i, point);
    let position = vertex.surface.position;
    let lens = scene.camera.connect(position, lens)?;
    let bounce = vertex.bounce(scene, lens.direction, TransportMode::Importance);
    let value = vertex.throughput * bounce.value * lens.importance;
    if value == Rgb::ZERO {
        return None;
    }
    let origin = vertex.surface.ray_origin(lens.direction);
    let target = position + lens.direction * lens.visible_distance;
    if !scene.geometry.visible(origin, target, counts) {
        return None;
    }
    let from_lens = f64::from(lens.density) * f64::from(bounce.cos);
    let light = vertex
        .carried
        .sum(heuristic, from_lens, f64::from(bounce.pdf_reverse));
    Some(Connection {
        value,
        weight: weight(light, 0.0),
        film: Some(lens.film),
    })
}

/// The coordinates of the lens point that technique t = 1 joins to y_i.
#[inline]
pub fn lens_point<C: Coordinates>(scene: &Scene, i: usize, point: &mut C) -> Vec2 {
    if scene.camera.is_pinhole() {
        Vec2::ZERO
    } else {
        Vec2::from(point.read::<2>(Stream::Connection, dimensions::to_lens(i)))
    }
}

/// Technique (s, t), s >= 2 and t >= 2: light vertex `y` is joined to camera vertex `z`. Both must
/// be connectible.
#[inline]
pub fn join(
    scene: &Scene,
    heuristic: Heuristic,
    y: &Vertex,
    z: &Vertex,
    counts: &mut RayCounts,
) -> Option<Connection> {
    let to_z = z.surface.position - y.surface.position;
    let distance_squared = to_z.length_squared();
    if distance_squared == 0.0 {
        return None;
    }
    let direction = to_z / distance_squared.sqrt();
    let at_z = z.bounce(scene, -direction, TransportMode::Radiance);
    if at_z.value == Rgb::ZERO {
        return None;
    }
    let at_y = y.bounce(scene, direction, TransportMode::Importance);
    let value = y.throughput * at_y.value * at_z.value * z.throughput / distance_squared;
    if value == Rgb::ZERO {
        return None;
    }
    let from = y.surface.ray_origin(direction);
    let to = interaction::offset(z.surface.position, z.surface.geometric_normal, -direction);
    if !scene.geometry.visible(from, to, counts) {
        return None;
    }
    let distance_squared = f64::from(distance_squared);
    let from_z = f64::from(at_z.pdf_forward) * f64::from(at_y.cos) / distance_squared;
    let from_y = f64::from(at_y.pdf_forward) * f64::from(at_z.cos) / distance_squared;
    let light = y
        .carried
        .sum(heuristic, from_z, f64::from(at_y.pdf_reverse));
    let camera = z
        .carried
        .sum(heuristic, from_y, f64::from(at_z.pdf_reverse));
    let mut weight = weight(light, camera);
    if planted(Fault::WeightOff) {
        weight *= 1.2;
    }
    Some(Connection {
        value,
        weight,
        film: None,
    })
}
