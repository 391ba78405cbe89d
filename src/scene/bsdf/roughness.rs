//! The roughness of a microfacet surface, which may vary over it and with the direction.

use glam::Vec2;

use super::context::MaterialContext;
use super::microfacet::{MicrofacetDistribution, Microfacets};

/// Roughness alpha of a surface, without unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roughness {
    /// The same everywhere and in all directions.
    Constant(f32),
    /// The luminance of textures, given by their indices.
    Textured {
        /// Along dp/du.
        along_u: u32,
        /// Perpendicular to it.
        along_v: u32,
    },
}

impl Roughness {
    /// The microfacets at a point.
    #[inline]
    pub(super) fn microfacets(
        &self,
        distribution: MicrofacetDistribution,
        context: &MaterialContext,
    ) -> Microfacets {
        match *self {
            Self::Constant(alpha) => Microfacets::isotropic(distribution, alpha),
            Self::Textured { along_u, along_v } => {
                let alpha = |texture| context.texture(texture).luminance();
                if along_u == along_v {
                    Microfacets::isotropic(distribution, alpha(along_u))
                } else {
                    let alpha = Vec2::new(alpha(along_u), alpha(along_v));
                    Microfacets::anisotropic(distribution, alpha, context.tangent())
                }
            }
        }
    }
}
