//! Surface vertices of subpaths.

use glam::Vec3A;

use super::mis::Carried;
use crate::fault::{Fault, planted};
use crate::math::Rgb;
use crate::scene::{BsdfEvaluation, Scene, SurfacePoint, TransportMode};

/// A surface vertex of a subpath.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Where it is.
    pub surface: SurfacePoint,
    /// Index of its material.
    pub material: u32,
    /// Unit, to the previous vertex of the subpath, in world coordinates.
    pub to_previous: Vec3A,
    /// Veach's alpha: on a camera subpath importance over the density of having made it, on a light
    /// subpath radiance over that density.
    pub throughput: Rgb,
    /// Quantities for the weights of techniques.
    pub carried: Carried,
}

/// What a vertex does to light between its predecessor and a direction it is joined in.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// f times the cosines that the geometric term leaves to this vertex: for a camera vertex
    /// f |w_i . N_s|, for a light vertex f |w_o . N_g| |w_i . N_s| / |w_i . N_g|, where w_i points to
    /// the light and w_o to the camera (Veach 1997, section 5.3: the adjoint for shading normals).
    pub value: Rgb,
    /// Density of sampling the joined direction given the predecessor, per steradian.
    pub pdf_forward: f32,
    /// Density of sampling the predecessor's direction given the joined one, per steradian.
    pub pdf_reverse: f32,
    /// |cos| between the joined direction and the geometric normal.
    pub cos: f32,
}

impl Vertex {
    /// True if the material has a lobe that explicit connections can use.
    #[inline]
    pub fn is_connectible(&self, scene: &Scene) -> bool {
        scene.materials[self.material as usize].is_connectible()
    }

    /// Scatters between the predecessor and `direction` (unit, world): `mode` is that of the
    /// subpath.
    #[inline]
    pub fn bounce(&self, scene: &Scene, direction: Vec3A, mode: TransportMode) -> Bounce {
        let surface = &self.surface;
        let previous = surface.shading.to_local(self.to_previous);
        let next = surface.shading.to_local(direction);
        let material = &scene.materials[self.material as usize];
        let cos = surface.geometric_normal.dot(direction).abs();
        match mode {
            TransportMode::Radiance => {
                let BsdfEvaluation {
                    f,
                    pdf_to_light,
                    pdf_to_camera,
                } = material.evaluate(&scene.textures, surface.uv, next, previous);
                Bounce {
                    value: f * next.z.abs(),
                    pdf_forward: pdf_to_light,
                    pdf_reverse: pdf_to_camera,
                    cos,
                }
            }
            TransportMode::Importance => {
                let BsdfEvaluation {
                    f,
                    pdf_to_light,
                    pdf_to_camera,
                } = material.evaluate(&scene.textures, surface.uv, previous, next);
                Bounce {
                    value: f * (cos * self.shading_over_geometric_cos(previous.z)),
                    pdf_forward: pdf_to_camera,
                    pdf_reverse: pdf_to_light,
                    cos,
                }
            }
        }
    }

    /// |w_i . N_s| / |w_i . N_g| for the direction to the previous vertex, whose cosine with the
    /// shading normal is given: 1 without shading normals.
    #[inline]
    pub fn shading_over_geometric_cos(&self, shading_cos: f32) -> f32 {
        let geometric_cos = self.surface.geometric_normal.dot(self.to_previous);
        if planted(Fault::AdjointLeftOut) {
            1.0
        } else if geometric_cos == 0.0 {
            0.0
        } else {
            (shading_cos / geometric_cos).abs()
        }
    }
}
