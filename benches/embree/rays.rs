//! Rays as in light transport.

use std::hint::black_box;

use glam::{Vec2, Vec3A};
use metrolight::math::Frame;
use metrolight::sampling::seeds::{self, Purpose};
use metrolight::sampling::warp::square_to_cosine_hemisphere;
use metrolight::scene::{Ray, RayCounts, SCENE_RADIUS, Scene, SurfacePoint};
use rand::RngExt;

use crate::scenes::Subject;

/// Rays of one kind: origins and directions, or pairs of points.
pub struct Rays {
    pub name: &'static str,
    /// Whether they are shadow rays between two points.
    pub shadow: bool,
    pub rays: Vec<(Vec3A, Vec3A)>,
}

/// Bounces of a walk.
const BOUNCES: usize = 4;

/// At most `count` rays of each kind: from the camera through random pixels, from their hits in
/// cosine-distributed directions, and between random pairs of the points that are hit.
pub fn of_transport(scene: &Scene, count: usize) -> [Rays; 3] {
    let mut rng = seeds::generator(1, Purpose::Probes, 0);
    let mut camera = Vec::new();
    let mut bounces = Vec::new();
    let mut points = Vec::new();
    while camera.len() < count {
        let (mut ray, _) = scene
            .camera
            .ray(Vec2::from(rng.random::<[f32; 2]>()), Vec2::ZERO);
        camera.push((ray.origin, ray.direction));
        for _ in 0..BOUNCES {
            let Some(hit) = scene.geometry.intersect(&ray, &mut RayCounts::default()) else {
                break;
            };
            let towards = -hit.geometric_normal.dot(ray.direction).signum();
            let frame = Frame::from_normal(hit.geometric_normal * towards);
            let local = square_to_cosine_hemisphere(Vec2::from(rng.random::<[f32; 2]>()));
            let direction = frame.to_world(local);
            ray = infinite(hit.ray_origin(direction), direction);
            bounces.push((ray.origin, ray.direction));
            points.push(hit);
        }
    }
    bounces.truncate(count);
    let mut pair = |_| {
        let mut point = || -> &SurfacePoint { &points[rng.random_range(0..points.len())] };
        let (a, b) = (point(), point());
        let between = b.position - a.position;
        (a.ray_origin(between), b.ray_origin(-between))
    };
    let connections = (0..count).map(&mut pair).collect();
    [
        rays("camera", false, camera),
        rays("bounce", false, bounces),
        rays("connection", true, connections),
    ]
}

/// Rays from inside a closed mesh toward its corners and edges.
pub fn to_edges(subject: &Subject, count: usize) -> Rays {
    let mut rng = seeds::generator(1, Purpose::Probes, 2);
    let mut toward = |i: usize| {
        let triangle = subject.triangles[rng.random_range(0..subject.triangles.len())];
        let [a, b, c] = triangle.map(Vec3A::from_array);
        let target = match i % 4 {
            0 => a,
            1 => a + (b - a) * rng.random::<f32>(),
            2 => a + (c - a) * 0.5,
            _ => a + (b - a) * (rng.random::<f32>() * 1e-6),
        };
        let offset = Vec3A::from(rng.random::<[f32; 3]>()) - 0.5;
        let origin = offset * (0.1 * SCENE_RADIUS);
        (origin, (target - origin).normalize())
    };
    rays("edges", false, (0..count).map(&mut toward).collect())
}

fn rays(name: &'static str, shadow: bool, rays: Vec<(Vec3A, Vec3A)>) -> Rays {
    Rays { name, shadow, rays }
}

fn infinite(origin: Vec3A, direction: Vec3A) -> Ray {
    Ray {
        origin,
        direction,
        t_max: f32::INFINITY,
    }
}

impl Rays {
    /// In the format of `rays.cpp`.
    pub fn floats(&self) -> impl Iterator<Item = f32> {
        self.rays
            .iter()
            .flat_map(|(a, b)| a.to_array().into_iter().chain(b.to_array()))
    }

    /// Traces all rays with Metrolight and returns the number of hits.
    pub fn trace(&self, scene: &Scene) -> usize {
        let mut counts = RayCounts::default();
        let rays = self.rays.iter();
        if self.shadow {
            rays.filter(|(a, b)| !scene.geometry.visible(black_box(*a), *b, &mut counts))
                .count()
        } else {
            let hits = rays.filter_map(|&(origin, direction)| {
                let ray = infinite(black_box(origin), direction);
                scene.geometry.intersect(&ray, &mut counts)
            });
            hits.map(black_box).count()
        }
    }

    /// The hits of Metrolight, as [`crate::embree::Embree::found`].
    pub fn found(&self, scene: &Scene) -> Vec<f32> {
        let mut counts = RayCounts::default();
        let mut distance = |&(a, b): &(Vec3A, Vec3A)| {
            if self.shadow {
                let free = scene.geometry.visible(a, b, &mut counts);
                return if free { f32::INFINITY } else { 0.0 };
            }
            let hit = scene.geometry.intersect(&infinite(a, b), &mut counts);
            hit.map_or(f32::INFINITY, |hit| (hit.position - a).dot(b))
        };
        self.rays.iter().map(&mut distance).collect()
    }
}
