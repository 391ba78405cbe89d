//! Light that no local path techniques can find (Veach 1997, section 8.3.4 and theorem 8.3), or hardly.
//!
//! A techniques that extends and joins subpaths vertex by vertex finds a path only if two consecutive
//! events on it are not delta functions. A point or directional light brings such a pair only with a
//! first surface that is not smooth, and the lens (which nothing hits here) only with a last one. So
//! light that goes from such an emitter through smooth surfaces to a rough one, and is seen there
//! through smooth surfaces again, is lost: S D S at a point light. Path tracing joins only camera
//! vertices to emitters and loses all light that reached a rough surface through smooth ones; light
//! tracing loses all that is seen through them.
//!
//! Where the emitter has an extent, what would be lost is found by camera subpaths that happen to run
//! into it: rarely, if it is small.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use glam::Vec3A;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::probe::{emitted, pair, scattered};
use crate::sampling::seeds::{self, Purpose};
use crate::scene::{Ray, RayCounts, Scene, SurfacePoint, TransportMode};
use crate::technique::TechniqueSet;

/// Rays that look from each side.
const PROBES: u64 = 1 << 15;

/// Longest chains of smooth surfaces that are followed.
const LONGEST_CHAIN: usize = 16;

/// How completely light is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Loss {
    /// No path is ever found.
    Always,
    /// Only paths that run into the emitter by chance are found, and none of some 30000 did.
    Nearly,
}

/// Light that a techniques cannot find, or hardly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LostLight {
    /// Where it comes from; empty if it does not matter.
    pub emitter: String,
    /// The surfaces that show too little.
    pub surfaces: Vec<String>,
    /// Who cannot find it.
    pub techniques: TechniqueSet,
    /// Whether never or hardly.
    pub loss: Loss,
}

impl fmt::Display for LostLight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            emitter,
            surfaces,
            techniques,
            loss,
        } = self;
        let surface = match &surfaces[..] {
            [one] => format!("{one} is"),
            [one, two] => format!("{one} and {two} are"),
            [one, more @ ..] => format!("{one} and {} more shapes are", more.len()),
            [] => return Ok(()),
        };
        match (techniques, loss) {
            (TechniqueSet::Bidirectional, Loss::Always) => write!(
                f,
                "lost light: {surface} lit by {emitter} through smooth glass or mirrors and seen \
                 through smooth glass or mirrors; no path techniques here can find that light, so the \
                 image is too dark there. A small area light or a little roughness makes it findable"
            ),
            (TechniqueSet::Path, Loss::Always) => write!(
                f,
                "lost light: {surface} lit by {emitter} through smooth glass or mirrors, which \
                 path tracing cannot find; bdpt and pssmlt can where it is seen directly"
            ),
            (TechniqueSet::Light, _) => write!(
                f,
                "lost light: {surface} seen through smooth glass or mirrors, where light tracing \
                 finds nothing; use another integrator"
            ),
            (TechniqueSet::Bidirectional, Loss::Nearly) => write!(
                f,
                "rare light: {surface} lit by {emitter} through smooth glass or mirrors and seen \
                 through smooth glass or mirrors; only paths that run into the emitter find that \
                 light, and none of {PROBES} did. Expect bright dots, or darkness where it should \
                 be. A larger emitter or a little roughness makes it easier to find"
            ),
            (TechniqueSet::Path, Loss::Nearly) => write!(
                f,
                "rare light: {surface} lit by {emitter} through smooth glass or mirrors; path \
                 tracing finds that light only by running into the emitter, and none of {PROBES} \
                 paths did. bdpt and pssmlt find it where it is seen directly"
            ),
        }
    }
}

/// Light in `scene` that `techniques` cannot find, or hardly, by looking along random rays from the
/// emitters and from the lens. What is so rare that some 30000 rays do not meet it is not reported.
pub fn lost_light(scene: &Scene, techniques: TechniqueSet) -> Vec<LostLight> {
    let mut rng = seeds::generator(0, Purpose::Probes, 0);
    let seen = Seen::from_camera(scene, &mut rng);
    if techniques == TechniqueSet::Light {
        let lost = LostLight {
            emitter: String::new(),
            surfaces: names(scene, &seen.behind_smooth),
            techniques,
            loss: Loss::Always,
        };
        return if lost.surfaces.is_empty() {
            vec![]
        } else {
            vec![lost]
        };
    }
    let mut lost: BTreeMap<(u32, Loss), BTreeSet<u32>> = BTreeMap::new();
    for _ in 0..PROBES {
        let Some((emitter, shape, delta)) = lit_through_smooth(scene, &mut rng) else {
            continue;
        };
        let needs_luck = techniques == TechniqueSet::Path || seen.behind_smooth.contains(&shape);
        // What is at infinity is large: who looks there finds it.
        let is_small = delta || scene.emitters.shape(emitter).is_some();
        let lucky = seen.lucky.contains(&(emitter, shape));
        // Luck was looked for on what the camera sees.
        let tried = delta || seen.anyhow.contains(&shape);
        if needs_luck && is_small && tried && !lucky {
            let loss = if delta { Loss::Always } else { Loss::Nearly };
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

/// What random rays from the lens meet.
#[derive(Default)]
struct Seen {
    /// Shapes that are not smooth.
    anyhow: BTreeSet<u32>,
    /// Those of them that are seen through smooth ones.
    behind_smooth: BTreeSet<u32>,
    /// Emitters that a path met, scattered by a shape, after smooth surfaces; and the shape.
    lucky: BTreeSet<(u32, u32)>,
}

impl Seen {
    fn from_camera(scene: &Scene, rng: &mut Xoshiro256PlusPlus) -> Self {
        let mut seen = Self::default();
        for _ in 0..PROBES {
            let (film, lens) = (pair(rng), pair(rng));
            let (ray, _) = scene.camera.ray(film, lens);
            let Some(met) = first_rough(scene, ray, TransportMode::Radiance, rng) else {
                continue;
            };
            let shape = met.surface.shape;
            seen.anyhow.insert(shape);
            if met.through_smooth {
                seen.behind_smooth.insert(shape);
            }
            let mode = TransportMode::Radiance;
            if let Some((_, ray)) = scattered(scene, &met.surface, -met.direction, mode, rng)
                && let Some(next) = first_rough(scene, ray, mode, rng)
                && let Some(emitter) = scene.emitters.of_shape(next.surface.shape)
                && next.through_smooth
            {
                seen.lucky.insert((emitter, shape));
            }
        }
        seen
    }
}

/// Follows a random ray from an emitter. If it meets smooth surfaces and then another: the emitter,
/// that shape, and whether the emitter has no extent.
fn lit_through_smooth(scene: &Scene, rng: &mut Xoshiro256PlusPlus) -> Option<(u32, u32, bool)> {
    let (sample, ray) = emitted(scene, rng)?;
    let met = first_rough(scene, ray, TransportMode::Importance, rng)?;
    met.through_smooth
        .then_some((sample.emitter, met.surface.shape, sample.delta))
}

/// How messages call an emitter: by its kind and, where there are several, its place in the scene.
fn emitter_name(scene: &Scene, emitter: u32) -> String {
    let kind = scene.emitters.kind(emitter).name();
    match scene.emitters.len() {
        1 => format!("the {kind} emitter"),
        n => format!("the {kind} emitter ({} of {n})", emitter + 1),
    }
}

/// Where a ray meets a surface that is not smooth.
struct Met {
    surface: SurfacePoint,
    /// Unit, of the ray on arrival.
    direction: Vec3A,
    /// It went through at least one smooth surface, or was mirrored by one.
    through_smooth: bool,
}

/// The first surface that is not smooth, if `ray` meets one.
fn first_rough(
    scene: &Scene,
    mut ray: Ray,
    mode: TransportMode,
    rng: &mut Xoshiro256PlusPlus,
) -> Option<Met> {
    let mut counts = RayCounts::default();
    for bounce in 0..LONGEST_CHAIN {
        let surface = scene.geometry.intersect(&ray, &mut counts)?;
        let material = &scene.materials[scene.geometry.material(surface.shape) as usize];
        if material.is_connectible() {
            return Some(Met {
                surface,
                direction: ray.direction,
                through_smooth: bounce > 0,
            });
        }
        (_, ray) = scattered(scene, &surface, -ray.direction, mode, rng)?;
    }
    None
}
