//! Light that a local path sampler cannot find, or only rarely (Veach 1997, section 8.3.4 and theorem
//! 8.3).
//!
//! A sampler that builds subpaths by local scattering and connects them vertex by vertex finds a path
//! only if two consecutive events of it are not delta functions. At a point or directional light the
//! emission is a delta function, so the first surface after it must be non-specular; a camera whose
//! lens cannot be hit demands the same of the last surface. Light that leaves such an emitter through
//! specular surfaces, scatters once at a rough surface, and is seen there through specular surfaces
//! is therefore lost: the S D S paths of a point light. Path tracing connects only camera vertices to
//! emitters, so it loses all light that reaches a rough surface through specular ones. Light tracing
//! loses all light that is seen through them.
//!
//! An emitter with an extent can be hit by a camera subpath. Such light is found, but rarely if the
//! emitter is small.
//!
//! Specular next event estimation (technique 1*) finds light of both kinds if the specular vertices before
//! the emitter form a chain that its finder seeks: on one shape, and not too long
//! ([`Casters::max_length_on`](crate::scene::Casters::max_length_on)).

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3A;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::probe::{emitted, pair, scattered};
use crate::sampling::seeds::{self, Purpose};
use crate::scene::{Ray, RayCounts, Scene, SurfacePoint, TransportMode};
use crate::technique::TechniqueSet;

/// Number of rays that are traced from the camera, and from the emitters.
pub const PROBES: u64 = 1 << 15;

/// Smallest share that is reported of the light that reaches a surface through specular ones. A sphere reflects
/// some light inside more often than technique 1* follows.
const MIN_SHARE: f64 = 0.01;

/// Maximum number of consecutive specular surfaces that a ray is followed through.
const MAX_SPECULAR_BOUNCES: usize = 16;

/// How completely light is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Loss {
    /// The sampler never finds a path.
    Always,
    /// The sampler finds only paths that hit the emitter by chance, and none of [`PROBES`] rays did.
    Nearly,
}

/// Light that a sampler cannot find, or only rarely.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LostLight {
    /// Name of the emitter; empty if the light of all emitters is lost.
    pub emitter: String,
    /// Names of the surfaces that are rendered too dark.
    pub surfaces: Vec<String>,
    /// The techniques that miss the light.
    pub techniques: TechniqueSet,
    /// How completely.
    pub loss: Loss,
}

/// Finds light in `scene` that `techniques` cannot find, or only rarely, by tracing [`PROBES`] random rays
/// from the camera and as many from the emitters. Light that none of these rays carries is not
/// reported.
pub fn lost_light(scene: &Scene, techniques: TechniqueSet) -> Vec<LostLight> {
    lost_light_observed(scene, techniques, &|_| {})
}

/// As [`lost_light`]; `progress` is called from time to time with the fraction of the rays that are done.
pub fn lost_light_observed(
    scene: &Scene,
    techniques: TechniqueSet,
    progress: &dyn Fn(f64),
) -> Vec<LostLight> {
    /// Rays between two calls.
    const STEP: u64 = 256;
    let report = |done: u64| {
        if done.is_multiple_of(STEP) {
            progress(done as f64 / (2 * PROBES) as f64);
        }
    };
    let mut rng = seeds::generator(0, Purpose::Probes, 0);
    let seen = Seen::from_camera(scene, &mut rng, &report);
    if techniques == TechniqueSet::Light {
        let lost = LostLight {
            emitter: String::new(),
            surfaces: names(scene, &seen.through_specular),
            techniques,
            loss: Loss::Always,
        };
        return if lost.surfaces.is_empty() {
            vec![]
        } else {
            vec![lost]
        };
    }
    // For each emitter and surface: rays that specular chains carry in all, and those that are lost.
    let mut rays: BTreeMap<(u32, u32), [u32; 2]> = BTreeMap::new();
    let mut deltas = BTreeSet::new();
    for i in 0..PROBES {
        report(PROBES + i);
        let Some(lit) = lit_through_specular(scene, &mut rng) else {
            continue;
        };
        let (emitter, shape) = (lit.emitter, lit.shape);
        // Only a subpath that hits the emitter can find this light.
        let needs_hit = techniques == TechniqueSet::Path || seen.through_specular.contains(&shape);
        // Rays that leave the scene always hit infinite emitters.
        let is_finite = lit.delta || scene.emitters.shape(emitter).is_some();
        let was_hit = seen.emitter_hits.contains(&(emitter, shape));
        // Hits were counted only for shapes that the camera sees.
        let is_known = lit.delta || seen.shapes.contains(&shape);
        let is_lost = needs_hit && is_finite && is_known && !was_hit && !lit.by_chain;
        let [all, lost] = rays.entry((emitter, shape)).or_default();
        *all += 1;
        *lost += u32::from(is_lost);
        if lit.delta {
            deltas.insert(emitter);
        }
    }
    let mut lost: BTreeMap<(u32, Loss), BTreeSet<u32>> = BTreeMap::new();
    for ((emitter, shape), [all, lost_rays]) in rays {
        if f64::from(lost_rays) > MIN_SHARE * f64::from(all) {
            let is_delta = deltas.contains(&emitter);
            let loss = if is_delta { Loss::Always } else { Loss::Nearly };
            lost.entry((emitter, loss)).or_default().insert(shape);
        }
    }
    lost.into_iter()
        .map(|((emitter, loss), shapes)| LostLight {
            emitter: emitter_name(scene, emitter),
            surfaces: names(scene, &shapes),
            techniques,
            loss,
        })
        .collect()
}

fn names(scene: &Scene, shapes: &BTreeSet<u32>) -> Vec<String> {
    let name = |&shape| scene.geometry.shape_name(shape).to_owned();
    shapes.iter().map(name).collect()
}

/// What random camera rays hit.
#[derive(Default)]
struct Seen {
    /// Non-specular shapes.
    shapes: BTreeSet<u32>,
    /// Those of them that are seen through specular surfaces.
    through_specular: BTreeSet<u32>,
    /// Pairs of an emitter and a shape: a ray scattered at the shape hit the emitter through specular
    /// surfaces.
    emitter_hits: BTreeSet<(u32, u32)>,
}

impl Seen {
    fn from_camera(scene: &Scene, rng: &mut Xoshiro256PlusPlus, report: &dyn Fn(u64)) -> Self {
        let mut seen = Self::default();
        for i in 0..PROBES {
            report(i);
            let (film, lens) = (pair(rng), pair(rng));
            let (ray, _) = scene.camera.ray(film, lens);
            let mode = TransportMode::Radiance;
            let Some(hit) = first_non_specular(scene, ray, mode, rng) else {
                continue;
            };
            let shape = hit.surface.shape;
            seen.shapes.insert(shape);
            if !hit.specular.is_empty() {
                seen.through_specular.insert(shape);
            }
            if let Some((_, ray)) = scattered(scene, &hit.surface, -hit.direction, mode, rng)
                && let Some(next) = first_non_specular(scene, ray, mode, rng)
                && let Some(emitter) = scene.emitters.of_shape(next.surface.shape)
                && !next.specular.is_empty()
            {
                seen.emitter_hits.insert((emitter, shape));
            }
        }
        seen
    }
}

/// A non-specular surface that an emitter lights through specular ones.
struct Lit {
    emitter: u32,
    shape: u32,
    /// The emitter has no extent.
    delta: bool,
    /// The specular vertices between them form a chain that technique 1* seeks.
    by_chain: bool,
}

/// Follows a random ray from an emitter, if it passes specular surfaces and then hits a non-specular one.
fn lit_through_specular(scene: &Scene, rng: &mut Xoshiro256PlusPlus) -> Option<Lit> {
    let (sample, ray) = emitted(scene, rng)?;
    let hit = first_non_specular(scene, ray, TransportMode::Importance, rng)?;
    let (first, rest) = hit.specular.split_first()?;
    let is_chain = rest.iter().all(|shape| shape == first)
        && hit.specular.len() <= scene.casters.max_length_on(*first);
    Some(Lit {
        emitter: sample.emitter,
        shape: hit.surface.shape,
        delta: sample.delta,
        by_chain: is_chain && scene.emitters.ends_chains(sample.emitter),
    })
}

/// The name of an emitter in messages: its kind and, if there are several, its index in the scene.
fn emitter_name(scene: &Scene, emitter: u32) -> String {
    let kind = scene.emitters.kind(emitter).name();
    match scene.emitters.len() {
        1 => format!("the {kind} emitter"),
        n => format!("the {kind} emitter ({} of {n})", emitter + 1),
    }
}

/// A hit on a non-specular surface.
struct Hit {
    surface: SurfacePoint,
    /// Unit direction of the arriving ray.
    direction: Vec3A,
    /// The specular shapes that reflected or refracted the ray before.
    specular: Vec<u32>,
}

/// The first non-specular surface that `ray` hits, directly or through specular ones.
fn first_non_specular(
    scene: &Scene,
    mut ray: Ray,
    mode: TransportMode,
    rng: &mut Xoshiro256PlusPlus,
) -> Option<Hit> {
    let mut counts = RayCounts::default();
    let mut specular = Vec::new();
    for _ in 0..MAX_SPECULAR_BOUNCES {
        let surface = scene.geometry.intersect(&ray, &mut counts)?;
        let material = &scene.materials[scene.geometry.material(surface.shape) as usize];
        let scatters = material.is_connectible();
        let hit = |specular| Hit {
            surface,
            direction: ray.direction,
            specular,
        };
        if scatters && !material.has_openings() {
            return Some(hit(specular));
        }
        let (sample, next) = scattered(scene, &surface, -ray.direction, mode, rng)?;
        if scatters && !sample.delta {
            return Some(hit(specular));
        }
        specular.push(surface.shape);
        ray = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};

    use super::*;
    use crate::math::Rgb;
    use crate::scene::test_scenes::{description, mesh};
    use crate::scene::{EmitterDescription, Material, Texture, TriangleMesh};

    /// A floor under a point light, and a mask between them.
    #[test]
    fn light_through_the_openings_of_a_mask_is_lost_to_path_tracing() {
        let lost = |opacity: f32, techniques| {
            let plate = |z: f64| {
                let to_world = DMat4::from_translation(DVec3::new(0.0, 0.0, z));
                mesh(TriangleMesh::rectangle(), to_world)
            };
            let mut shapes = vec![plate(0.0), plate(1.0)];
            shapes[1].material = 1;
            let light = EmitterDescription::Point {
                position: DVec3::new(0.0, 0.0, 2.0),
                intensity: Rgb::ONE,
            };
            let mut description = description(shapes, vec![light]);
            description
                .textures
                .push(Texture::Constant(Rgb::splat(opacity)));
            description.materials.push(Material::Mask {
                opacity: 1,
                covered: Box::new(Material::Diffuse { reflectance: 0 }),
            });
            let scene = description.build().expect("a valid scene");
            lost_light(&scene, techniques)
        };
        let [light] = &lost(0.5, TechniqueSet::Path)[..] else {
            panic!("no light is lost");
        };
        assert_eq!((light.loss, light.surfaces.len()), (Loss::Always, 1));
        assert!(lost(1.0, TechniqueSet::Path).is_empty());
    }
}
