//! Each technique alone, and all of them against closed forms.
//!
//! Statistical tests have fixed seeds and reject at p < ALPHA after Holm's correction: a correct
//! program fails one of them with that probability for a new choice of seeds.

mod common;

use std::collections::BTreeMap;

use glam::{DMat4, DVec3, Vec2};
use metrolight::film::Filter;
use metrolight::integrators::{Workspace, bdpt};
use metrolight::math::seeds::{self, Purpose};
use metrolight::math::{Coordinates, FreshCoordinates, Rgb, Stream, luminance};
use metrolight::path::{Heuristic, dimensions};
use metrolight::render::{Budget, Integrator, Settings, Unobserved, render};
use metrolight::scene::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Material, Scene,
    SceneDescription, ShapeDescription, ShapeGeometry, Texture, TriangleMesh,
};
use metrolight::statistics::{Moments, holm, normal_two_sided, welch};

const ALPHA: f64 = 1e-4;

/// Halves of the film, left and right, in which the light of a technique is measured.
const PARTS: usize = 2;

/// Per technique (s, t) and half: moments of its unweighted and of its weighted light.
type Light = BTreeMap<(usize, usize), [[Moments; 2]; PARTS]>;

fn light_by_technique(scene: &Scene, samples: u64) -> Light {
    let mut light = Light::new();
    let mut workspace = Workspace::default();
    let mut point = FreshCoordinates::new(seeds::generator(11, Purpose::Pixels, 0));
    let edges = scene.depth.max_depth.expect("bounded paths") as usize;
    let techniques: Vec<(usize, usize)> = (1..=edges)
        .flat_map(|k| (0..=k).map(move |s| (s, k + 1 - s)))
        .filter(|&technique| technique != (1, 1))
        .collect();
    for _ in 0..samples {
        let film = Vec2::from(point.read::<2>(Stream::Camera, dimensions::FILM));
        let mut made: BTreeMap<(usize, usize), [[f64; 2]; PARTS]> = BTreeMap::new();
        let heuristic = Heuristic::Power;
        bdpt::connections(
            scene,
            heuristic,
            film,
            &mut point,
            &mut workspace,
            |t, c| {
                let part = usize::from(c.film.unwrap_or(film).x >= 0.5);
                let value = f64::from(luminance(c.value));
                let sums = &mut made.entry((t.s, t.t)).or_default()[part];
                sums[0] += value;
                sums[1] += value * f64::from(c.weight);
            },
        );
        for technique in &techniques {
            let sums = made.get(technique).copied().unwrap_or_default();
            let moments = light.entry(*technique).or_default();
            for (m, s) in moments.iter_mut().flatten().zip(sums.iter().flatten()) {
                m.add(*s);
            }
        }
    }
    light
}

/// Null hypotheses: for each path length and half of the film, every technique alone has the mean of
/// every other, and the weighted sum of all has it too.
#[test]
fn every_technique_alone_finds_the_same_light() {
    let scene = common::load("tests/scenes/plates.xml", &[]);
    let light = light_by_technique(&scene, 600_000);
    let mut tests = Vec::new();
    for edges in 2..=4 {
        let techniques: Vec<_> = (0..=edges).map(|s| (s, edges + 1 - s)).collect();
        for (part, half) in ["left", "right"].iter().enumerate() {
            let alone = |i: usize| light[&techniques[i]][part][0];
            for i in 0..techniques.len() {
                assert!(alone(i).mean > 0.0, "{:?} finds nothing", techniques[i]);
                for j in i + 1..techniques.len() {
                    let (a, b) = (techniques[i], techniques[j]);
                    let text = format!("{half}: {a:?} {:?} and {b:?} {:?}", alone(i), alone(j));
                    tests.push((welch(&alone(i), &alone(j)), text));
                }
            }
            // The weighted light of one sample is spread over techniques: add means and variances.
            let (mut mean, mut variance) = (0.0, 0.0);
            for technique in &techniques {
                let weighted = &light[technique][part][1];
                mean += weighted.mean;
                variance += weighted.standard_error().powi(2);
            }
            let best = alone(1);
            let z = (mean - best.mean) / (variance + best.standard_error().powi(2)).sqrt();
            let text = format!("{half}: sum of weighted {mean} and (1, {edges}) {best:?}");
            tests.push((normal_two_sided(z), text));
        }
    }
    let adjusted = holm(&tests.iter().map(|t| t.0).collect::<Vec<_>>());
    for (p, (_, text)) in adjusted.iter().zip(&tests) {
        assert!(*p > ALPHA, "{text}: p = {p:e}");
    }
}

/// A scene in a few words: shapes, what they are made of, lights.
struct Words {
    materials: Vec<Material>,
    textures: Vec<Texture>,
    shapes: Vec<ShapeDescription>,
    emitters: Vec<EmitterDescription>,
    depth: Option<u32>,
    fov_x: f64,
    camera: DMat4,
}

impl Words {
    fn build(self) -> Scene {
        let description = SceneDescription {
            camera: CameraDescription {
                to_world: self.camera,
                fov_x: self.fov_x,
                near_clip: 1e-3,
                far_clip: 1e4,
                lens: None,
            },
            film: FilmSettings {
                width: 6,
                height: 4,
                filter: Filter::Box,
            },
            depth: DepthLimits {
                max_depth: self.depth,
                rr_depth: 5,
            },
            textures: self.textures,
            materials: self.materials,
            shapes: self.shapes,
            emitters: self.emitters,
        };
        description.build().expect("a valid scene")
    }
}

fn sphere(radius: f64, flip_normals: bool, emission: Option<Rgb>) -> ShapeDescription {
    ShapeDescription {
        name: "sphere".into(),
        geometry: ShapeGeometry::Sphere {
            center: DVec3::ZERO,
            radius,
        },
        to_world: DMat4::IDENTITY,
        flip_normals,
        material: 0,
        emission,
    }
}

/// Mean over all pixels, for each of `seeds` seeds.
fn means(scene: &Scene, integrator: Integrator, spp: u64, seeds: u64) -> Moments {
    (0..seeds)
        .map(|seed| {
            let settings = Settings {
                budget: Budget::SamplesPerPixel(spp),
                seed,
                chains: 16,
                bootstrap: Some(20_000),
                ..Settings::new(integrator)
            };
            let image = render(scene, &settings, &Unobserved)
                .expect("threads")
                .image;
            let sum: f64 = image.pixels.iter().map(|p| f64::from(p[1])).sum();
            sum / image.pixels.len() as f64
        })
        .collect()
}

/// Null hypothesis: the mean over seeds is `truth`. The standard error has few degrees of freedom,
/// so it is compared as a Welch test with a sample that has no variance.
fn assert_mean(name: &str, moments: &Moments, truth: f64) {
    let exact = Moments::from_summary(moments.count, truth, 0.0);
    // Estimators without variance differ from the truth by rounding alone.
    if (moments.mean / truth - 1.0).abs() < 1e-4 {
        return;
    }
    let p = welch(moments, &exact);
    assert!(
        p > ALPHA,
        "{name}: {} +- {}, {truth}, p = {p:e}",
        moments.mean,
        moments.standard_error()
    );
}

/// The inside of a sphere that shines with radiance 1 and reflects rho: L = 1 + rho + rho^2 + ...
#[test]
fn furnace() {
    for (rho, depth) in [(0.5, None), (0.9, None), (0.9, Some(3))] {
        let scene = Words {
            materials: vec![Material::Diffuse { reflectance: 0 }],
            textures: vec![Texture::Constant(Rgb::splat(rho))],
            shapes: vec![sphere(2.0, true, Some(Rgb::ONE))],
            emitters: vec![],
            depth,
            fov_x: 70.0,
            camera: DMat4::from_translation(DVec3::new(0.3, -0.2, 0.5)),
        }
        .build();
        let rho = f64::from(rho);
        let terms = depth.map_or(f64::INFINITY, f64::from);
        let truth = (1.0 - rho.powf(terms)) / (1.0 - rho);
        for integrator in Integrator::ALL {
            let name = format!("{integrator:?}, rho {rho}, depth {depth:?}");
            assert_mean(&name, &means(&scene, integrator, 60, 12), truth);
        }
    }
}

/// Glass and mirrors under the same radiance from everywhere show that radiance, whatever they do
/// with it: what refraction adds on entering it takes away on leaving.
#[test]
fn white_furnace_of_smooth_materials() {
    let mirror = Material::Conductor {
        eta: Rgb::ZERO,
        k: Rgb::ONE,
        specular_reflectance: 0,
    };
    let glass = |eta| Material::Dielectric {
        eta,
        specular_reflectance: 0,
        specular_transmittance: 0,
    };
    for (name, material) in [
        ("mirror", mirror),
        ("glass", glass(1.5)),
        ("bubble", glass(1.0 / 1.33)),
        ("matched", glass(1.0)),
        ("diamond", glass(2.4)),
    ] {
        let scene = Words {
            materials: vec![material],
            textures: vec![Texture::Constant(Rgb::ONE)],
            shapes: vec![sphere(1.0, false, None)],
            emitters: vec![EmitterDescription::Constant {
                radiance: Rgb::splat(0.8),
            }],
            depth: None,
            fov_x: 40.0,
            camera: DMat4::from_translation(DVec3::new(0.0, 0.0, -4.0)),
        }
        .build();
        for integrator in [Integrator::Path, Integrator::Bdpt, Integrator::Pssmlt] {
            let moments = means(&scene, integrator, 100, 12);
            assert_mean(&format!("{name}, {integrator:?}"), &moments, 0.8);
        }
    }
}

/// One bounce from a point or directional light: L = rho/pi I cos/d^2 and rho/pi E cos.
#[test]
fn one_bounce_from_lights_without_extent() {
    let rho = 0.6;
    let shine = [
        EmitterDescription::Point {
            position: DVec3::new(1.0, 2.0, 0.0),
            intensity: Rgb::splat(5.0),
        },
        EmitterDescription::Directional {
            direction: DVec3::new(1.0, -1.0, 0.5),
            irradiance: Rgb::splat(2.0),
        },
    ];
    let truths = [
        rho / std::f64::consts::PI * 5.0 * (2.0 / 5.0f64.sqrt()) / 5.0,
        rho / std::f64::consts::PI * 2.0 * (1.0 / 2.25f64.sqrt()),
    ];
    for (emitter, truth) in shine.into_iter().zip(truths) {
        let floor = ShapeDescription {
            name: "floor".into(),
            geometry: ShapeGeometry::Mesh(TriangleMesh::rectangle()),
            to_world: DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2)
                * DMat4::from_scale(DVec3::splat(3.0)),
            flip_normals: false,
            material: 0,
            emission: None,
        };
        let scene = Words {
            materials: vec![Material::Diffuse { reflectance: 0 }],
            textures: vec![Texture::Constant(Rgb::splat(rho as f32))],
            shapes: vec![floor],
            emitters: vec![emitter],
            depth: Some(2),
            // So narrow that cos/d^2 is constant over the film; the camera looks straight down.
            fov_x: 0.05,
            camera: DMat4::from_translation(DVec3::new(0.0, 4.0, 0.0))
                * DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2),
        }
        .build();
        for integrator in [Integrator::Path, Integrator::Bdpt, Integrator::Pssmlt] {
            let moments = means(&scene, integrator, 100, 12);
            assert_mean(&format!("{integrator:?}"), &moments, truth);
        }
    }
}
