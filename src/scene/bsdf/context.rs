//! What a material needs to know about the point where light scatters.

use glam::{Vec2, Vec3A};

use crate::scene::geometry::Geometry;
use crate::scene::interaction::SurfacePoint;
use crate::scene::texture::{Texture, TextureAt};

/// The point where a material scatters light: textures, and the surface around it.
#[derive(Clone, Copy)]
pub struct MaterialContext<'a> {
    textures: &'a [Texture],
    uv: Vec2,
    /// `None` on a plane.
    surface: Option<(&'a Geometry, &'a SurfacePoint)>,
}

impl<'a> MaterialContext<'a> {
    /// At a point of `geometry`; materials index `textures`.
    #[inline]
    pub fn new(textures: &'a [Texture], geometry: &'a Geometry, surface: &'a SurfacePoint) -> Self {
        Self {
            textures,
            uv: surface.uv,
            surface: Some((geometry, surface)),
        }
    }

    /// At the texture coordinates `uv` of a plane, which are the local coordinates x and y.
    pub fn on_plane(textures: &'a [Texture], uv: Vec2) -> Self {
        Self {
            textures,
            uv,
            surface: None,
        }
    }

    /// The texture of this index.
    #[inline]
    pub(super) fn texture(&self, index: u32) -> TextureAt<'a> {
        TextureAt {
            texture: &self.textures[index as usize],
            uv: self.uv,
        }
    }

    /// The derivatives dp/du and dp/dv of the position with respect to the texture coordinates, local, in scene
    /// units.
    pub(super) fn partial_derivatives(&self) -> [Vec3A; 2] {
        match self.surface {
            Some((geometry, surface)) => geometry
                .partial_derivatives(surface)
                .map(|derivative| surface.shading.to_local(derivative)),
            None => [Vec3A::X, Vec3A::Y],
        }
    }

    /// The unit vector along dp/du in the tangent plane, local.
    pub(super) fn tangent(&self) -> Vec2 {
        let [dp_du, _] = self.partial_derivatives();
        Vec2::new(dp_du.x, dp_du.y).normalize_or(Vec2::X)
    }

    /// Unit geometric normal, local.
    pub(super) fn geometric_normal(&self) -> Vec3A {
        self.surface.map_or(Vec3A::Z, |(_, surface)| {
            surface.shading.to_local(surface.geometric_normal)
        })
    }
}
