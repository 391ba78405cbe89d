//! A single technique: the paths of multiplexed Metropolis (Hachisuka, Kaplanyan and Dachsbacher
//! 2014, "Multiplexed Metropolis light transport", section 4).
//!
//! The dimensions are those of bidirectional path tracing, so that technique (s, t) maps a point of the
//! hypercube to the same path as in [`super::bdpt`]. Subpaths are traced only as far as that path needs.

use glam::Vec2;

use super::{PathSampler, Workspace};
use crate::path::{dimensions, trace_camera_subpath, trace_light_subpath};
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::technique::{
    Connection, NextEvent, PathContribution, Technique, TechniqueSet, connect_to_camera,
    connect_vertices, has_specular, hit_environment, hit_light, specular_next_event, specular_term,
};

/// The paths of one technique, with their weights among all bidirectional techniques.
#[derive(Clone, Copy, Debug)]
pub struct SingleTechnique(pub Technique);

impl PathSampler for SingleTechnique {
    #[inline]
    fn sample_paths<S: Sampler>(
        &self,
        scene: &Scene,
        sampler: &mut S,
        workspace: &mut Workspace,
        mut visit: impl FnMut(PathContribution),
    ) {
        let technique = self.0;
        if let Technique::Specular { t, n } = technique {
            specular(scene, [t, n], sampler, workspace, |film, connection| {
                visit(PathContribution::new(technique, film, connection));
            });
        } else if let Some((film, connection)) = sample(scene, technique, sampler, workspace) {
            visit(PathContribution::new(technique, film, connection));
        }
    }
}

/// The paths of technique 1* with t camera vertices and n delta vertices, and their film position.
#[inline]
fn specular<S: Sampler>(
    scene: &Scene,
    [t, n]: [usize; 2],
    sampler: &mut S,
    workspace: &mut Workspace,
    mut visit: impl FnMut(Vec2, Connection),
) {
    let Workspace {
        camera,
        rays,
        candidates,
        ..
    } = workspace;
    let film = Vec2::from(sampler.get::<2>(dimensions::FILM));
    trace_camera_subpath(scene, film, t - 1, sampler, rays, camera);
    let vertex = camera.vertices.get(t - 2);
    let set = TechniqueSet::Bidirectional;
    if let Some(z) = vertex.filter(|z| has_specular(scene, z, set)) {
        specular_next_event(scene, z, t - 1, set, sampler, candidates, rays, |found| {
            if found.length == n {
                visit(film, found.connection);
            }
        });
    }
}

/// The path that `technique` samples at a point, and its film position; `None` if it carries no light.
#[inline]
fn sample<S: Sampler>(
    scene: &Scene,
    technique: Technique,
    sampler: &mut S,
    workspace: &mut Workspace,
) -> Option<(Vec2, Connection)> {
    // Trace the light subpath first: it leaves the scene early more often than the camera subpath.
    let (s, t) = (technique.s(), technique.t());
    if t == 1 && s < 2 {
        // Only light tracing uses (1,1): bidirectional path tracing samples these paths by (0,2).
        return None;
    }
    if s >= 2 {
        let Workspace { light, rays, .. } = &mut *workspace;
        trace_light_subpath(scene, s - 1, sampler, rays, light);
        let y = light.vertices.get(s - 2)?;
        if !y.is_connectible(scene) {
            return None;
        }
        if let Technique::Camera { .. } = technique {
            return connect_to_camera(scene, y, s - 1, sampler, rays);
        }
    }
    let Workspace {
        camera,
        light,
        rays,
        candidates,
    } = workspace;
    let film = Vec2::from(sampler.get::<2>(dimensions::FILM));
    trace_camera_subpath(scene, film, t - 1, sampler, rays, camera);
    let camera = &*camera;
    let set = TechniqueSet::Bidirectional;
    let Some(z) = camera.vertices.get(t - 2) else {
        // Paths of t - 2 surface vertices whose last vertex is at infinity.
        let at_infinity = s == 0 && camera.vertices.len() == t - 2;
        let vertex = camera.environment.as_ref().filter(|_| at_infinity)?;
        let term = || specular_term(scene, camera, t - 1, set, candidates, rays);
        return Some((
            film,
            hit_environment(scene, vertex, t - 1, term)?.connection(),
        ));
    };
    let connection = match technique {
        Technique::Hit { .. } => {
            let term = || specular_term(scene, camera, t - 1, set, candidates, rays);
            hit_light(scene, z, t - 1, camera.position_before(t - 2), term)?.connection()
        }
        Technique::NextEvent { .. } => {
            NextEvent::sample(scene, z, t - 1, sampler, rays)?.connection()
        }
        Technique::Camera { .. } | Technique::Specular { .. } => return None,
        Technique::Join { .. } => {
            let y = light.vertices.get(s - 2)?;
            let z = Some(z).filter(|z| z.is_connectible(scene))?;
            connect_vertices(scene, y, z, rays)?
        }
    };
    Some((film, connection))
}
