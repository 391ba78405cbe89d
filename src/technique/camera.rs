//! t = 1: the last vertex of the light subpath is connected to the lens.

use glam::Vec2;

use super::Connection;
use crate::math::Rgb;
use crate::path::mis::weight;
use crate::path::{Vertex, dimensions};
use crate::sampling::Sampler;
use crate::scene::interaction::offset;
use crate::scene::{RayCounts, Scene, TransportMode};

/// Connects light vertex y_i to a point on the lens. Returns the film position and the path; `None` if
/// the path carries no light.
#[inline]
pub fn connect_to_camera<S: Sampler>(
    scene: &Scene,
    vertex: &Vertex,
    i: usize,
    sampler: &mut S,
    counts: &mut RayCounts,
) -> Option<(Vec2, Connection)> {
    if !vertex.is_connectible(scene) || scene.is_hidden(vertex.surface.shape) {
        return None;
    }
    let position = vertex.position();
    let lens = scene
        .camera
        .connect(position, lens_point(scene, i, sampler))?;
    let scatter = vertex.scatter(scene, lens.direction, TransportMode::Importance);
    let value = vertex.throughput * scatter.value * lens.importance;
    if value == Rgb::ZERO {
        return None;
    }
    let origin = vertex.ray_origin(lens.direction);
    let target = position + lens.direction * lens.visible_distance;
    if !scene.visible_to_camera(origin, target, counts) {
        return None;
    }
    // `lens.density` includes 1/d^2.
    let from_lens = scatter.density(lens.density, 1.0);
    let light = vertex.mis.sum(from_lens, f64::from(scatter.pdf_reverse));
    let connection = Connection {
        value,
        weight: weight(light, 0.0),
    };
    Some((lens.film, connection))
}

/// Technique (1, 1): a directly visible light, sampled for the lens. Point and directional lights have no
/// extent on the film and are invisible. Only light tracing has this technique.
pub fn visible_light<S: Sampler>(
    scene: &Scene,
    sampler: &mut S,
    rays: &mut RayCounts,
) -> Option<(Vec2, Connection)> {
    if scene.hide_emitters {
        return None;
    }
    let [u_light, u_primitive, x, y] = sampler.get::<4>(dimensions::next_event(0));
    let u_position = Vec2::new(x, y);
    if scene.camera.is_orthographic() {
        return visible_surface(scene, u_light, u_primitive, u_position, rays);
    }
    let lens = lens_point(scene, 0, sampler);
    let from = scene.camera.lens_position(lens);
    let direct = scene
        .emitters
        .sample_direct(from, u_light, u_primitive, u_position)
        .filter(|direct| !direct.delta)?;
    let film = scene.camera.film_position(direct.direction, lens)?;
    let emission = &direct.emission;
    // The lens measures the integral of radiance times p_w, the density of its directions per steradian.
    let importance = scene.camera.direction_pdf(direct.direction);
    let value = emission.radiance * (importance * direct.jacobian_direction / emission.pdf_direct);
    let (near, far) = scene
        .camera
        .visible_segment(from, direct.direction, direct.target)?;
    let visible = value != Rgb::ZERO && scene.geometry.visible(near, far, rays);
    visible.then_some((film, Connection { value, weight: 1.0 }))
}

/// Technique (1, 1) for an orthographic camera: a point of an area emitter, which is seen at one film position.
/// The camera sees no more than one direction of an environment: sampled light never comes from there.
fn visible_surface(
    scene: &Scene,
    u_light: f32,
    u_primitive: f32,
    u_position: Vec2,
    rays: &mut RayCounts,
) -> Option<(Vec2, Connection)> {
    let sampled = scene
        .emitters
        .sample_surface(u_light, u_primitive, u_position);
    let (y0, radiance) = sampled?;
    let lens = scene.camera.connect(y0.position, Vec2::ZERO)?;
    let cos = y0.normal.dot(lens.direction);
    let value = radiance * (cos.max(0.0) * lens.importance / y0.pdf);
    let from = offset(y0.position, y0.normal, lens.direction);
    let to = y0.position + lens.direction * lens.visible_distance;
    let visible = value != Rgb::ZERO && scene.visible_to_camera(from, to, rays);
    visible.then_some((lens.film, Connection { value, weight: 1.0 }))
}

/// Sample values of the lens point that is connected to y_i.
#[inline]
fn lens_point<S: Sampler>(scene: &Scene, i: usize, sampler: &mut S) -> Vec2 {
    if scene.camera.has_lens() {
        Vec2::from(sampler.get::<2>(dimensions::connect_to_camera(i)))
    } else {
        Vec2::ZERO
    }
}
