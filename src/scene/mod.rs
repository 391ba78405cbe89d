//! What light meets: camera, emitters, materials, textures, geometry and its acceleration
//! structure, all immutable once built from a [`SceneDescription`].
//!
//! Lengths are in *scene units*: the description's world is moved and scaled so that its bounding
//! sphere is centred at the origin with radius [`SCENE_RADIUS`]. Radiance does not change with
//! scale; what does (intensities, the lens) is converted once, in `build`.

pub mod bsdf;
mod build;
pub mod camera;
pub mod description;
pub mod geometry;
pub mod interaction;
pub mod light;
pub mod mesh;
pub mod texture;

#[cfg(test)]
mod test_scenes;

pub use crate::bvh::Ray;
pub use bsdf::{BsdfEvaluation, BsdfSample, Material, MicrofacetDistribution, TransportMode};
pub use camera::{Camera, LensSample};
pub use description::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, SceneDescription, SceneError,
    ShapeDescription, ShapeGeometry, ThinLens,
};
pub use geometry::{Geometry, RayCounts};
pub use interaction::SurfacePoint;
pub use light::{EmissionSample, EmitterKind, Emitters, LightEvaluation, LightSample};
pub use mesh::TriangleMesh;
pub use texture::{Bitmap, Interpolation, Texture, Wrap};

use glam::DVec3;

/// Radius of the scene's bounding sphere in scene units.
pub const SCENE_RADIUS: f32 = crate::bvh::RADIUS;

/// A scene ready to be rendered.
pub struct Scene {
    /// Where importance comes from.
    pub camera: Camera,
    /// Shapes and the structure that finds them.
    pub geometry: Geometry,
    /// Where light comes from.
    pub emitters: Emitters,
    /// Indexed by a shape's material.
    pub materials: Vec<Material>,
    /// Indexed by the materials.
    pub textures: Vec<Texture>,
    /// Size of the image and its reconstruction filter.
    pub film: FilmSettings,
    /// How long paths may be.
    pub depth: DepthLimits,
    /// Length of one scene unit in the units of the scene file.
    pub unit: f64,
    /// Where in the scene file's world the origin of scene units is.
    pub center: DVec3,
}

/// Least distance from the origin, in scene units, that is too large: its square would be near the end
/// of the range of f32.
const MAX_DISTANCE: f32 = 1e18;

impl Scene {
    /// A point in scene units, in the units of the scene file.
    pub fn to_world(&self, point: glam::Vec3A) -> DVec3 {
        point.as_dvec3() * self.unit + self.center
    }

    /// Lower and upper corner of the box around all surfaces, in the units of the scene file; `None`
    /// without surfaces.
    pub fn world_bounds(&self) -> Option<(DVec3, DVec3)> {
        let (min, max) = self.geometry.bounds()?;
        Some((self.to_world(min), self.to_world(max)))
    }
}
