//! Mistakes that show in what the camera and the emitters see: dark backs of surfaces, nothing between the
//! clipping planes, lamps that light nothing.

use std::collections::{BTreeMap, BTreeSet};

use rand_xoshiro::Xoshiro256PlusPlus;

use super::probe::{emitted, pair, scattered};
use crate::sampling::seeds::{self, Purpose};
use crate::scene::{Ray, RayCounts, Scene, SurfacePoint, TransportMode};

/// Number of rays that are traced from the camera, and from the emitters.
pub const VIEW_PROBES: u32 = 1 << 14;

/// Smallest share of the image that is reported as the backs of surfaces.
const MIN_BACK_SHARE: f64 = 0.01;

/// Something in a view that is probably a mistake.
#[derive(Clone, Debug, PartialEq)]
pub enum OddView {
    /// The camera sees surfaces from behind, where their material is black.
    BackFaces {
        /// Their names.
        surfaces: Vec<String>,
        /// Their share of the image.
        share: f64,
    },
    /// All that the camera would see lies beyond its far clipping plane.
    BeyondFarClip,
    /// Nothing lies on the side to which a surface emits, and the camera does not see that side.
    LampFacesAway {
        /// The name of the surface.
        surface: String,
    },
}

/// Looks for mistakes by tracing [`VIEW_PROBES`] random rays from the camera and as many from the emitters.
pub fn odd_view(scene: &Scene) -> Vec<OddView> {
    let mut rng = seeds::generator(0, Purpose::Probes, 1);
    let mut found = Vec::new();
    let mut seen = Seen::default();
    for _ in 0..VIEW_PROBES {
        seen.look(scene, &mut rng);
    }
    let backs: u32 = seen.backs.values().sum();
    let share = f64::from(backs) / f64::from(VIEW_PROBES);
    if share > MIN_BACK_SHARE {
        let name = |&shape: &u32| scene.geometry.shape_name(shape).to_owned();
        let surfaces = seen.backs.keys().map(name).collect();
        found.push(OddView::BackFaces { surfaces, share });
    }
    if seen.hits == 0 && seen.beyond > 0 {
        found.push(OddView::BeyondFarClip);
    }
    found.extend(lamps_facing_away(scene, &seen, &mut rng));
    found
}

/// What random camera rays hit.
#[derive(Default)]
struct Seen {
    /// Number of rays that hit something between the clipping planes.
    hits: u32,
    /// Number of rays that would hit something beyond the far plane.
    beyond: u32,
    /// For shapes whose backs are black, number of rays that hit them from behind.
    backs: BTreeMap<u32, u32>,
    /// Emitting shapes seen from the front.
    lamps: BTreeSet<u32>,
}

impl Seen {
    fn look(&mut self, scene: &Scene, rng: &mut Xoshiro256PlusPlus) {
        let (ray, _) = scene.camera.ray(pair(rng), pair(rng));
        let mut counts = RayCounts::default();
        let Some(surface) = scene.seen_from_camera(&ray, &mut counts) else {
            let unlimited = Ray {
                t_max: f32::INFINITY,
                ..ray
            };
            let hit = scene.seen_from_camera(&unlimited, &mut counts);
            self.beyond += u32::from(hit.is_some());
            return;
        };
        self.hits += 1;
        let is_lamp = scene.emitters.of_shape(surface.shape).is_some();
        if surface.geometric_normal.dot(ray.direction) < 0.0 {
            if is_lamp {
                self.lamps.insert(surface.shape);
            }
        } else if !is_lamp && is_one_sided(scene, &surface, &ray, rng) {
            *self.backs.entry(surface.shape).or_default() += 1;
        }
    }
}

/// True if a surface scatters light that comes from the front, and none that comes from behind as `ray` does.
fn is_one_sided(
    scene: &Scene,
    surface: &SurfacePoint,
    ray: &Ray,
    rng: &mut Xoshiro256PlusPlus,
) -> bool {
    let (mode, behind) = (TransportMode::Radiance, -ray.direction);
    let front = behind - 2.0 * surface.shading.n * surface.shading.n.dot(behind);
    scattered(scene, surface, behind, mode, rng).is_none()
        && scattered(scene, surface, front, mode, rng).is_some()
}

/// Emitting shapes that the camera does not see from the front, of whose rays none hits a surface.
fn lamps_facing_away(scene: &Scene, seen: &Seen, rng: &mut Xoshiro256PlusPlus) -> Vec<OddView> {
    let mut counts = RayCounts::default();
    let mut lights_something: BTreeMap<u32, bool> = BTreeMap::new();
    for _ in 0..VIEW_PROBES {
        let Some((sample, ray)) = emitted(scene, rng) else {
            continue;
        };
        if let Some(shape) = scene.emitters.shape(sample.emitter) {
            let hits = scene.geometry.intersect(&ray, &mut counts).is_some();
            *lights_something.entry(shape).or_default() |= hits;
        }
    }
    let is_odd = |(shape, hits): &(u32, bool)| !hits && !seen.lamps.contains(shape);
    lights_something
        .into_iter()
        .filter(is_odd)
        .map(|(shape, _)| OddView::LampFacesAway {
            surface: scene.geometry.shape_name(shape).to_owned(),
        })
        .collect()
}
