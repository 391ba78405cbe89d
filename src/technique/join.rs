//! s >= 2 and t >= 2: the last vertices of both subpaths are connected.

use super::Connection;
use crate::fault::{Fault, planted};
use crate::math::Rgb;
use crate::path::Vertex;
use crate::path::mis::weight;
use crate::scene::{RayCounts, Scene, TransportMode};

/// Connects light vertex `y` and camera vertex `z`, which must both be connectible. `None` if the path
/// carries no light.
#[inline]
pub fn connect_vertices(
    scene: &Scene,
    y: &Vertex,
    z: &Vertex,
    counts: &mut RayCounts,
) -> Option<Connection> {
    let to_z = z.position() - y.position();
    let distance_squared = to_z.length_squared();
    if distance_squared == 0.0 {
        return None;
    }
    let direction = to_z / distance_squared.sqrt();
    let at_z = z.scatter(scene, -direction, TransportMode::Radiance);
    if at_z.value == Rgb::ZERO {
        return None;
    }
    let at_y = y.scatter(scene, direction, TransportMode::Importance);
    let value = y.throughput * at_y.value * at_z.value * z.throughput / distance_squared;
    if value == Rgb::ZERO {
        return None;
    }
    let from = y.ray_origin(direction);
    let to = z.ray_origin(-direction);
    if !scene.geometry.visible(from, to, counts) {
        return None;
    }
    let distance_squared = f64::from(distance_squared);
    let y_from_z = at_y.density(at_z.pdf_forward, distance_squared);
    let z_from_y = at_z.density(at_y.pdf_forward, distance_squared);
    let light = y.mis.sum(y_from_z, f64::from(at_y.pdf_reverse));
    let camera = z.mis.sum(z_from_y, f64::from(at_z.pdf_reverse));
    let mut weight = weight(light, camera);
    if planted(Fault::WeightOff) {
        weight *= 1.2;
    }
    Some(Connection { value, weight })
}
