//! Closest-hit and shadow rays, on `cornell` and on a bumpy sphere of 100 000 triangles.
//!
//! Rays are those of light transport: from points on surfaces in cosine-distributed directions, and
//! between pairs of such points. One iteration traces all of them; the throughput is rays per second.

mod common;

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DMat4, Vec2, Vec3A};
use metrolight::sampling::seeds::{self, Purpose};
use metrolight::sampling::warp::square_to_cosine_hemisphere;
use metrolight::scene::{Ray, RayCounts, Scene, SurfacePoint, TriangleMesh};
use rand::RngExt;

const RAYS: usize = 1 << 14;

fn cornell() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell/scene.xml");
    let loaded = metrolight::mitsuba::load(&path, &[]).expect("a scene of the repository");
    loaded
        .description
        .build()
        .expect("a scene of the repository")
}

/// A sphere with bumps, of 2 * 224 * 224 = 100 352 triangles.
fn bumpy_sphere() -> Scene {
    const N: u32 = 224;
    let mut mesh = TriangleMesh::default();
    for i in 0..=N {
        for j in 0..=N {
            let theta = std::f32::consts::PI * i as f32 / N as f32;
            let phi = std::f32::consts::TAU * j as f32 / N as f32;
            let r = 1.0 + 0.05 * (9.0 * theta).sin() * (7.0 * phi).sin();
            let (z, xy) = (r * theta.cos(), r * theta.sin());
            mesh.positions.push([xy * phi.cos(), xy * phi.sin(), z]);
        }
    }
    for i in 0..N {
        for j in 0..N {
            let a = i * (N + 1) + j;
            mesh.triangles.push([a, a + N + 1, a + 1]);
            mesh.triangles.push([a + 1, a + N + 1, a + N + 2]);
        }
    }
    let shapes = vec![common::shape(mesh, DMat4::IDENTITY)];
    common::description(-4.0, 40.0, shapes)
        .build()
        .expect("a valid scene")
}

/// Points that the camera sees, each with a direction for the next ray.
fn points(scene: &Scene) -> Vec<(SurfacePoint, Vec3A)> {
    let mut rng = seeds::generator(1, Purpose::Probes, 0);
    let mut points = Vec::with_capacity(RAYS);
    while points.len() < RAYS {
        let (ray, _) = scene
            .camera
            .ray(Vec2::from(rng.random::<[f32; 2]>()), Vec2::ZERO);
        if let Some(hit) = scene.geometry.intersect(&ray, &mut RayCounts::default()) {
            let frame = metrolight::math::Frame::from_normal(
                hit.geometric_normal * -hit.geometric_normal.dot(ray.direction).signum(),
            );
            let local = square_to_cosine_hemisphere(Vec2::from(rng.random::<[f32; 2]>()));
            points.push((hit, frame.to_world(local)));
        }
    }
    points
}

fn rays(c: &mut Criterion) {
    for (name, scene) in [("cornell", cornell()), ("bumps-100k", bumpy_sphere())] {
        let points = points(&scene);
        let rays: Vec<Ray> = points
            .iter()
            .map(|(point, direction)| Ray {
                origin: point.ray_origin(*direction),
                direction: *direction,
                t_max: f32::INFINITY,
            })
            .collect();
        let segments: Vec<(Vec3A, Vec3A)> = points
            .iter()
            .zip(points.iter().rev())
            .map(|((a, _), (b, _))| {
                let direction = b.position - a.position;
                (a.ray_origin(direction), b.ray_origin(-direction))
            })
            .collect();
        let mut group = c.benchmark_group(name);
        group.throughput(Throughput::Elements(RAYS as u64));
        let mut counts = RayCounts::default();
        group.bench_function("closest hit", |bencher| {
            bencher.iter(|| {
                rays.iter()
                    .filter(|ray| {
                        scene
                            .geometry
                            .intersect(black_box(ray), &mut counts)
                            .is_some()
                    })
                    .count()
            });
        });
        group.bench_function("shadow", |bencher| {
            bencher.iter(|| {
                segments
                    .iter()
                    .filter(|(a, b)| scene.geometry.visible(black_box(*a), *b, &mut counts))
                    .count()
            });
        });
        group.finish();
    }
}

criterion_group!(benches, rays);
criterion_main!(benches);
