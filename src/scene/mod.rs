//! The scene: camera, emitters, materials, textures and geometry, built from a [`SceneDescription`] and
//! immutable from then on.
//!
//! Lengths are in *scene units*: the world of the description is translated and scaled so that its
//! bounding sphere is centred at the origin with radius [`SCENE_RADIUS`]. Radiance does not depend on
//! scale; quantities that do (intensities, the lens) are converted once, in `build`.
//!
//! ```
//! let path = std::path::Path::new("scenes/cornell/scene.xml");
//! let scene = metrolight::mitsuba::load(path, &[])?.description.build()?;
//! assert_eq!(scene.emitters.len(), 1);
//! let (min, max) = scene.world_bounds().ok_or("a scene with surfaces")?;
//! assert!((max - min).min_element() > 1.9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bsdf;
mod build;
pub mod camera;
pub mod coincident;
pub mod description;
pub mod geometry;
pub mod interaction;
pub mod light;
pub mod mesh;
pub mod specular;
pub mod texture;

#[cfg(test)]
pub(crate) mod test_scenes;

pub use crate::bvh::Ray;
pub use bsdf::{
    BsdfEvaluation, BsdfSample, DeltaLobe, Material, MaterialContext, MicrofacetDistribution,
    Roughness, TransportMode,
};
pub use camera::{Camera, LensSample};
pub use description::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Projection, Radiance,
    SceneDescription, SceneError, ShapeDescription, ShapeGeometry, ThinLens,
};
pub use geometry::{Geometry, RayCounts};
pub use interaction::SurfacePoint;
pub use light::{ChainEnd, EmissionSample, EmitterKind, Emitters, LightEvaluation, LightSample};
pub use mesh::TriangleMesh;
pub use specular::{Casters, ChainSearch};
pub use texture::{Bitmap, Interpolation, Texture, Wrap};

use glam::DVec3;

/// Radius of the scene's bounding sphere in scene units.
pub const SCENE_RADIUS: f32 = crate::bvh::RADIUS;

/// A scene ready to be rendered.
pub struct Scene {
    /// The camera.
    pub camera: Camera,
    /// Surfaces, and the acceleration structure over them.
    pub geometry: Geometry,
    /// The emitters.
    pub emitters: Emitters,
    /// Indexed by [`Geometry::material`].
    pub materials: Vec<Material>,
    /// Indexed by the materials.
    pub textures: Vec<Texture>,
    /// Size of the image and its reconstruction filter.
    pub film: FilmSettings,
    /// Shapes that reflect or refract without roughness, for next event estimation through them.
    pub casters: Casters,
    /// Limits on the length of paths.
    pub depth: DepthLimits,
    /// Whether the camera sees past emitters: only their light is seen, and what is behind them.
    pub hide_emitters: bool,
    /// Length of one scene unit in the units of the scene file.
    pub unit: f64,
    /// The origin of scene units in the world of the scene file.
    pub center: DVec3,
}

/// Upper bound on distances from the origin, in scene units: squares stay within the range of f32.
const MAX_DISTANCE: f32 = 1e18;

impl Scene {
    /// What a material needs to know to scatter light at `surface`.
    #[inline]
    pub fn material_context<'a>(&'a self, surface: &'a SurfacePoint) -> MaterialContext<'a> {
        MaterialContext::new(&self.textures, &self.geometry, surface)
    }

    /// True if specular chains can be sought: there are casters, and emitters on which chains end.
    #[inline]
    pub fn has_chains(&self) -> bool {
        !self.casters.is_empty() && self.emitters.end_chains()
    }

    /// True if the camera sees past a shape.
    #[inline]
    pub fn is_hidden(&self, shape: u32) -> bool {
        self.hide_emitters && self.emitters.of_shape(shape).is_some()
    }

    /// The nearest point that a camera ray hits on a surface that is not hidden.
    #[inline]
    pub fn seen_from_camera(&self, ray: &Ray, counts: &mut RayCounts) -> Option<SurfacePoint> {
        if self.hide_emitters {
            let hidden = |shape| self.is_hidden(shape);
            self.geometry.intersect_past(ray, hidden, counts)
        } else {
            self.geometry.intersect(ray, counts)
        }
    }

    /// [`Geometry::visible`], for a point `to` on the near plane of the camera.
    #[inline]
    pub fn visible_to_camera(
        &self,
        from: glam::Vec3A,
        to: glam::Vec3A,
        counts: &mut RayCounts,
    ) -> bool {
        if self.hide_emitters {
            let hidden = |shape| self.is_hidden(shape);
            self.geometry.visible_past(from, to, hidden, counts)
        } else {
            self.geometry.visible(from, to, counts)
        }
    }

    /// Converts a point in scene units to world coordinates, in the units of the scene file.
    pub fn to_world(&self, point: glam::Vec3A) -> DVec3 {
        point.as_dvec3() * self.unit + self.center
    }

    /// Lower and upper corner of the box around all surfaces in world coordinates, in the units of the
    /// scene file; `None` without surfaces.
    pub fn world_bounds(&self) -> Option<(DVec3, DVec3)> {
        let (min, max) = self.geometry.bounds()?;
        Some((self.to_world(min), self.to_world(max)))
    }
}
