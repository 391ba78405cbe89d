//! Queries of specular next event estimation: the chains between a point that the camera sees through glass
//! and a point on an emitter, found, followed by rays, and tested for visibility.

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{Vec2, Vec3A};
use metrolight::path::{Subpath, trace_camera_subpath};
use metrolight::sampling::IndependentSampler;
use metrolight::sampling::seeds::{self, Purpose};
use metrolight::scene::{ChainEnd, RayCounts, Scene, SurfacePoint};
use metrolight::technique::{TechniqueSet, has_specular};
use rand::RngExt;

const QUERIES: usize = 1 << 12;

fn scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let path = path.join(name).join("scene.xml");
    let loaded = metrolight::mitsuba::load(&path, &[]).expect("a scene of the repository");
    loaded
        .description
        .build()
        .expect("a scene of the repository")
}

/// Camera vertices of technique 1*, each with a point on an emitter.
fn queries(scene: &Scene) -> Vec<(SurfacePoint, ChainEnd)> {
    let mut rng = seeds::generator(1, Purpose::Probes, 0);
    let (mut counts, mut subpath) = (RayCounts::default(), Subpath::default());
    let mut queries = Vec::with_capacity(QUERIES);
    for i in 0.. {
        let film = Vec2::new(rng.random(), rng.random());
        let mut sampler = IndependentSampler::new(1, Purpose::Probes, i);
        trace_camera_subpath(scene, film, 4, &mut sampler, &mut counts, &mut subpath);
        for vertex in &subpath.vertices {
            let end = scene.emitters.sample_chain_end(
                rng.random(),
                rng.random(),
                Vec2::new(rng.random(), rng.random()),
            );
            if let Some(end) = end
                && has_specular(scene, vertex, TechniqueSet::Bidirectional)
            {
                queries.push((vertex.surface, end));
            }
        }
        if queries.len() >= QUERIES {
            break;
        }
    }
    queries.truncate(QUERIES);
    queries
}

/// Number of visible chains.
fn visible_chains(scene: &Scene, queries: &[(SurfacePoint, ChainEnd)]) -> usize {
    let (mut counts, mut candidates) = (RayCounts::default(), Vec::new());
    let mut visible = 0;
    for (start, end) in queries {
        let position = start.position.as_dvec3();
        scene.casters.chains(position, &end.end, &mut candidates);
        for candidate in &candidates {
            let Some(chain) = candidate.follow(scene, start, &end.end, &mut counts) else {
                continue;
            };
            let origin: Vec3A = chain.last.ray_origin(chain.to_end);
            let target = end.target(chain.last.position, chain.to_end);
            visible += usize::from(scene.geometry.visible(origin, target, &mut counts));
        }
    }
    visible
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("specular queries");
    group.throughput(Throughput::Elements(QUERIES as u64));
    for name in ["pool", "spheres", "torus-in-glass", "lost-caustic"] {
        let scene = scene(name);
        let queries = queries(&scene);
        group.bench_function(name, |b| {
            b.iter(|| visible_chains(&scene, black_box(&queries)))
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
