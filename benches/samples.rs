//! One full BDPT sample and one PSSMLT mutation on `spheres` and `pool`; sampling and evaluating each
//! kind of BSDF.

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Vec2, Vec3A};
use metrolight::integrators::{BidirectionalPathTracer, PathSampler, SplatList, Workspace};
use metrolight::markov::{Bootstrap, BootstrapLimits, Chain, Mutations, Perturbation};
use metrolight::math::Rgb;
use metrolight::render::SplatTarget;
use metrolight::sampling::IndependentSampler;
use metrolight::sampling::seeds::{self, Purpose};
use metrolight::scene::bsdf::MicrofacetDistribution;
use metrolight::scene::{Material, MaterialContext, Roughness, Scene, Texture, TransportMode};

fn load(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}/scene.xml"));
    let loaded = metrolight::mitsuba::load(&path, &[]).expect("a scene of the repository");
    loaded
        .description
        .build()
        .expect("a scene of the repository")
}

fn paths(c: &mut Criterion) {
    for name in ["spheres", "pool"] {
        let scene = load(name);
        let mut group = c.benchmark_group(name);
        let mut samples = (0..).map(|i| IndependentSampler::new(0, Purpose::Pixels, i));
        let (mut workspace, mut splats) = (Workspace::default(), SplatList::default());
        let bdpt = BidirectionalPathTracer;
        group.bench_function("bdpt sample", |bencher| {
            bencher.iter(|| {
                let mut sampler = samples.next().expect("endless");
                bdpt.sample_splats(&scene, &mut sampler, &mut workspace, &mut splats);
                black_box(splats.pixel)
            });
        });
        let mut target = SplatTarget::new(&scene, bdpt);
        let limits = BootstrapLimits {
            at_least: 1 << 14,
            at_most: 1 << 14,
            relative_error: 0.0,
        };
        let worker = || SplatTarget::new(&scene, bdpt);
        let bootstrap = Bootstrap::run(0, limits, worker, drop, |_| false);
        let start = bootstrap.sample(bootstrap.starts(1)[0]);
        let rng = seeds::chain_generators(0, 1).remove(0);
        let mutations = Mutations::kelemen(0.3, Perturbation::default());
        let mut chain = Chain::start(&mut target, start, rng, mutations);
        group.bench_function("pssmlt mutation", |bencher| {
            bencher.iter(|| black_box(chain.step(&mut target).sample.density));
        });
        group.finish();
    }
}

fn bsdfs(c: &mut Criterion) {
    let textures = [Texture::Constant(Rgb::splat(0.7))];
    let eta = Rgb::new(0.2, 0.9, 1.1);
    let k = Rgb::new(3.9, 2.4, 2.1);
    let ggx = MicrofacetDistribution::Ggx;
    let materials = [
        ("diffuse", Material::Diffuse { reflectance: 0 }),
        (
            "roughconductor",
            Material::RoughConductor {
                distribution: ggx,
                roughness: Roughness::Constant(0.2),
                eta,
                k,
                specular_reflectance: 0,
            },
        ),
        (
            "dielectric",
            Material::Dielectric {
                eta: 1.5,
                specular_reflectance: 0,
                specular_transmittance: 0,
            },
        ),
        (
            "roughdielectric",
            Material::RoughDielectric {
                distribution: ggx,
                roughness: Roughness::Constant(0.2),
                eta: 1.5,
                specular_reflectance: 0,
                specular_transmittance: 0,
            },
        ),
        ("plastic", Material::plastic(1.49, false, 0, 0, &textures)),
        (
            "roughplastic",
            Material::rough_plastic(ggx, 0.2, 1.49, false, 0, 0, &textures),
        ),
    ];
    let mut group = c.benchmark_group("bsdf");
    let context = MaterialContext::on_plane(&textures, Vec2::ZERO);
    let from = Vec3A::new(0.3, -0.4, 0.8).normalize();
    let to = Vec3A::new(-0.5, 0.2, 0.7).normalize();
    for (name, material) in &materials {
        group.bench_function(format!("{name} sample"), |bencher| {
            let u = Vec2::new(0.37, 0.61);
            bencher.iter(|| {
                let (from, u) = (black_box(from), black_box(u));
                material.sample(&context, from, TransportMode::Radiance, 0.4, u)
            });
        });
        group.bench_function(format!("{name} evaluate"), |bencher| {
            bencher.iter(|| material.evaluate(&context, black_box(to), black_box(from)));
        });
    }
    group.finish();
}

criterion_group!(benches, paths, bsdfs);
criterion_main!(benches);
