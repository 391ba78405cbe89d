//! The density of technique 1* for a whole path. The Jacobian of its chain is a finite difference of rays.

use glam::{Vec2, Vec3A};
use metrolight::path::{Vertex, dimensions};
use metrolight::sampling::{IndependentSampler, Sampler};
use metrolight::scene::specular::{Endpoint, Lobes};
use metrolight::scene::{ChainEnd, DeltaLobe, Ray, RayCounts, Scene, SurfacePoint, TransportMode};

use super::whole_path::WholePath;

/// Distance of unit vectors below which two directions are the same.
const SAME_DIRECTION: f32 = 2e-3;

/// The density of technique 1* cannot be evaluated: the chain is too close to an edge or a caustic for finite
/// differences.
pub struct Unknown;

/// A ray followed through delta vertices.
struct Traced {
    vertices: Vec<SurfacePoint>,
    /// Unit, in which it leaves the last vertex.
    direction: Vec3A,
}

/// Follows the ray that leaves `start` along `direction` through these lobes.
fn trace(scene: &Scene, start: &SurfacePoint, direction: Vec3A, lobes: &Lobes) -> Option<Traced> {
    let (mut vertices, mut direction) = (Vec::new(), direction);
    let mut from = *start;
    for &lobe in lobes.as_slice() {
        let ray = Ray {
            origin: from.ray_origin(direction),
            direction,
            t_max: f32::INFINITY,
        };
        let point = scene.geometry.intersect(&ray, &mut RayCounts::default())?;
        let material = &scene.materials[scene.geometry.material(point.shape) as usize];
        let local = point.shading.to_local(-direction);
        let mode = TransportMode::Radiance;
        let sample = material.sample_delta(&scene.material_context(&point), local, mode, lobe)?;
        direction = point.shading.to_world(sample.direction);
        vertices.push(point);
        from = point;
    }
    Some(Traced {
        vertices,
        direction,
    })
}

/// The end and the delta vertices x_1 ... x_n, each with the index of its material, of a path of technique 1* from
/// camera vertex z_i = `z`: of the chains with n vertices that carry light, number `number`.
pub fn sampled_chain(
    scene: &Scene,
    z: &Vertex,
    (i, n, number): (usize, usize, usize),
    sampler: &mut IndependentSampler,
) -> (ChainEnd, Vec<(SurfacePoint, u32)>) {
    let [u_light, u_primitive, x, y] = sampler.get(dimensions::specular(i));
    let u = Vec2::new(x, y);
    let end = scene
        .emitters
        .sample_chain_end(u_light, u_primitive, u)
        .expect("an end, because there is a path");
    let mut candidates = Vec::new();
    let start = z.surface.position.as_dvec3();
    scene.casters.chains(start, &end.end, &mut candidates);
    let mut counts = RayCounts::default();
    let mut found = candidates.iter().filter(|candidate| {
        let direction = candidate.direction.as_vec3a();
        let scatter = z.scatter(scene, direction, TransportMode::Radiance);
        let chain = candidate.follow(scene, &z.surface, &end.end, &mut counts);
        chain.is_some_and(|chain| {
            let origin = chain.last.ray_origin(chain.to_end);
            let target = end.target(chain.last.position, chain.to_end);
            let light = scatter.value * chain.throughput * end.radiance_against(chain.to_end);
            chain.length == n
                && light.max_element() > 0.0
                && scene.geometry.visible(origin, target, &mut counts)
        })
    });
    let candidate = found.nth(number).expect("a chain for every path");
    let direction = candidate.direction.as_vec3a();
    let traced = trace(scene, &z.surface, direction, &candidate.lobes).expect("a chain");
    let with_material = |point: SurfacePoint| (point, scene.geometry.material(point.shape));
    let vertices = traced.vertices.into_iter().rev().map(with_material);
    (end, vertices.collect())
}

impl WholePath<'_> {
    /// Number of delta vertices next to the emitter, if the vertex after them is not one and is no lens.
    fn chain_length(&self) -> Option<usize> {
        let n = (1..self.edges()).take_while(|&i| self.step(i).2).count();
        (n > 0 && n + 1 < self.edges()).then_some(n)
    }

    /// Density of technique 1*, as [`WholePath::density`].
    pub fn specular_density(&self) -> Result<Option<f64>, Unknown> {
        let Some(n) = self.chain_length() else {
            return Ok(None);
        };
        let d = n + 1;
        // Without `everywhere`, no technique may connect two vertices from D on.
        let connects = || (d + 1..=self.edges()).any(|s| self.connects(s));
        if !self.scene.has_chains() || (!self.scene.casters.everywhere() && connects()) {
            return Ok(None);
        }
        let Some(end) = self.emitter.chain_end.filter(|end| end.pdf > 0.0) else {
            return Ok(None);
        };
        let lobes = self.lobes(n);
        if !self.is_member(d, &end, &lobes) {
            return Ok(None);
        }
        let jacobian = self.jacobian(d, &end, &lobes).ok_or(Unknown)?;
        // From the measure of T to that of all other techniques: the product of areas at all vertices.
        let areas: f64 = (0..=n).map(|i| self.area_per_angle(i)).product();
        let camera = self.camera_density(self.edges() - n);
        Ok(Some(camera * end.pdf * areas / jacobian))
    }

    /// The lobes of x_n ... x_1.
    fn lobes(&self, n: usize) -> Lobes {
        let n = n.min(3);
        Lobes::collect(n, |k| {
            let i = n - k;
            let normal = self.surfaces[i - 1].0.shading.n;
            if normal.dot(self.to_light(i)) * normal.dot(self.to_camera(i)) < 0.0 {
                DeltaLobe::Transmission
            } else {
                DeltaLobe::Reflection
            }
        })
    }

    /// True if the finder returns the chain for D = x_d and the end.
    fn is_member(&self, d: usize, end: &ChainEnd, lobes: &Lobes) -> bool {
        let (point, shape) = (&self.surfaces[d - 1].0, self.surfaces[0].0.shape);
        let on_one_shape = self.surfaces[..d - 1].iter().all(|(p, _)| p.shape == shape);
        if d - 1 > lobes.as_slice().len() || !on_one_shape {
            return false;
        }
        let mut candidates = Vec::new();
        let start = point.position.as_dvec3();
        self.scene.casters.chains(start, &end.end, &mut candidates);
        candidates.iter().any(|candidate| {
            let apart = (candidate.direction.as_vec3a() - self.to_light(d)).length();
            candidate.shape == shape
                && candidate.lobes == *lobes
                && apart < SAME_DIRECTION
                && candidate
                    .follow(self.scene, point, &end.end, &mut RayCounts::default())
                    .is_some()
        })
    }

    /// T: solid angle at D = x_d per area at the end (per steradian at infinity), by differences of rays.
    fn jacobian(&self, d: usize, end: &ChainEnd, lobes: &Lobes) -> Option<f64> {
        let start = &self.surfaces[d - 1].0;
        let center = self.to_light(d);
        let (s, t) = center.any_orthonormal_pair();
        let arrival = |direction: Vec3A| {
            let traced = trace(self.scene, start, direction.normalize(), lobes)?;
            let Endpoint::Point { position, normal } = end.end else {
                return Some(traced.direction);
            };
            let normal = normal.map_or(self.emitter.direction, |n| n.as_vec3a());
            let from = traced.vertices.last()?.position;
            let distance = normal.dot(position.as_vec3a() - from) / normal.dot(traced.direction);
            Some(from + traced.direction * distance)
        };
        let area = |step: f32| {
            let along = |axis: Vec3A| {
                let [a, b] = [step, -step].map(|step| arrival(center + axis * step));
                Some((a? - b?) / (2.0 * step))
            };
            Some(f64::from(along(s)?.cross(along(t)?).length()))
        };
        let (coarse, fine) = (area(2e-3)?, area(1e-3)?);
        ((coarse / fine - 1.0).abs() < 3e-3 && fine > 0.0).then(|| fine.recip())
    }
}
