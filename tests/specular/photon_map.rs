//! A photon map of the floor of the pool under a point light.

use glam::{DVec3, Vec3A};
use metrolight::render::Method;
use metrolight::sampling::seeds::{self, Purpose};
use metrolight::scene::{Ray, RayCounts, Scene, SurfacePoint};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::common::tiles::tile_moments;
use super::pool::{ALBEDO, INTENSITY, LAMP, Light, WATER, pool};
use super::settings;

/// Photons on the floor: an oracle that shares nothing with technique 1* but the intersection of rays.
struct PhotonMap {
    cells: Vec<f64>,
}

const CELLS: usize = 512;
const PHOTONS: usize = 24_000_000;

/// Photons of one random number generator.
const TASK: usize = 1_000_000;

/// Views of a tile along each axis.
const VIEWS: usize = 300;

/// Refraction at a surface, and the fraction that is not reflected (Born and Wolf, section 1.5).
fn refract(direction: DVec3, normal: DVec3) -> Option<(DVec3, f64)> {
    let cos_i = -direction.dot(normal);
    let (normal, cos_i, ratio) = if cos_i > 0.0 {
        (normal, cos_i, 1.0 / WATER)
    } else {
        (-normal, -cos_i, WATER)
    };
    let sin2_t = ratio * ratio * (1.0 - cos_i * cos_i);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let refracted = direction * ratio + normal * (ratio * cos_i - cos_t);
    let s = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t);
    let p = (ratio * cos_t - cos_i) / (ratio * cos_t + cos_i);
    Some((refracted, 1.0 - 0.5 * (s * s + p * p)))
}

fn hit(scene: &Scene, origin: Vec3A, direction: DVec3) -> Option<SurfacePoint> {
    let ray = Ray {
        origin,
        direction: direction.as_vec3a(),
        t_max: f32::INFINITY,
    };
    scene.geometry.intersect(&ray, &mut RayCounts::default())
}

/// From above the water to the floor: the point in world coordinates and the transmitted fraction.
fn through_water(scene: &Scene, from: DVec3, direction: DVec3) -> Option<(DVec3, f64)> {
    let origin = ((from - scene.center) / scene.unit).as_vec3a();
    let surface = hit(scene, origin, direction)?;
    if surface.shape != 0 {
        return None;
    }
    let (below, fraction) = refract(direction, surface.shading.n.as_dvec3())?;
    let floor = hit(scene, surface.ray_origin(below.as_vec3a()), below)?;
    (floor.shape == 1).then(|| (scene.to_world(floor.position), fraction))
}

/// Cosine of the half-angle of the downward cone in which photons start: all light that reaches the visible part
/// of the floor.
const CONE: f64 = 0.7;

fn direction_in_cone(rng: &mut Xoshiro256PlusPlus) -> DVec3 {
    let y = -1.0 + (1.0 - CONE) * rng.random::<f64>();
    let (sin, cos) = (std::f64::consts::TAU * rng.random::<f64>()).sin_cos();
    let r = (1.0 - y * y).sqrt();
    DVec3::new(r * cos, y, r * sin)
}

impl PhotonMap {
    fn new(scene: &Scene) -> Self {
        let power = std::f64::consts::TAU * (1.0 - CONE) * INTENSITY / PHOTONS as f64;
        let area = (4.0 / CELLS as f64).powi(2);
        let task = |task: usize| {
            let mut cells = vec![0.0; CELLS * CELLS];
            let mut rng = seeds::generator(3, Purpose::Tests, task as u64);
            for _ in 0..TASK {
                let direction = direction_in_cone(&mut rng);
                if let Some((point, fraction)) = through_water(scene, LAMP, direction)
                    && let Some(cell) = Self::cell(point)
                {
                    cells[cell] += power * fraction / area;
                }
            }
            cells
        };
        let add = |mut sum: Vec<f64>, cells: Vec<f64>| {
            sum.iter_mut()
                .zip(cells)
                .for_each(|(sum, cell)| *sum += cell);
            sum
        };
        let tasks = (0..PHOTONS / TASK).into_par_iter().map(task);
        let cells = tasks.reduce(|| vec![0.0; CELLS * CELLS], add);
        Self { cells }
    }

    fn cell(point: DVec3) -> Option<usize> {
        let [i, j] = [point.x, point.z].map(|x| ((x + 2.0) / 4.0 * CELLS as f64).floor());
        let inside = |i: f64| i >= 0.0 && i < CELLS as f64;
        (inside(i) && inside(j)).then_some(i as usize * CELLS + j as usize)
    }

    /// Radiance toward the camera through a film position.
    fn radiance(&self, scene: &Scene, film: glam::Vec2) -> f64 {
        let (ray, _) = scene.camera.ray(film, glam::Vec2::ZERO);
        let from = scene.to_world(ray.origin);
        let seen = through_water(scene, from, ray.direction.as_dvec3());
        let Some((point, fraction)) = seen else {
            return 0.0;
        };
        let irradiance = Self::cell(point).map_or(0.0, |cell| self.cells[cell]);
        // Radiance above the water is that below over the squared index.
        fraction * irradiance * f64::from(ALBEDO) / std::f64::consts::PI / (WATER * WATER)
    }
}

/// Under a point light, every tile of 4 x 4 pixels agrees with the photon map within 1%: its cells are 0.008
/// wide, each tile holds some 1.5 * 10^5 photons, and the standard error of the tile itself is 0.2%.
#[test]
fn point_lights_agree_with_a_photon_map() {
    let scene = pool(Light::Point, 4).build();
    let map = PhotonMap::new(&scene);
    let [width, height] = [16, 12];
    let found = tile_moments(&scene, &settings(Method::Bdpt, 2000), 0..4, 4);
    for (tile, moments) in found.chunks(3).map(|channels| channels[1]).enumerate() {
        let corner = [tile % (width / 4), tile / (width / 4)].map(|i| (4 * i) as f32);
        let size = [width, height].map(|n| n as f32);
        let view = |i: usize| {
            let offset = [i % VIEWS, i / VIEWS].map(|i| 4.0 * (i as f32 + 0.5) / VIEWS as f32);
            let film = [0, 1].map(|axis| (corner[axis] + offset[axis]) / size[axis]);
            map.radiance(&scene, film.into())
        };
        let sum: f64 = (0..VIEWS * VIEWS).into_par_iter().map(view).sum();
        let expected = sum / (VIEWS * VIEWS) as f64;
        let ratio = moments.mean / expected;
        assert!(
            (ratio - 1.0).abs() < 0.01,
            "tile {tile}: ratio {ratio}, {expected}"
        );
    }
}
