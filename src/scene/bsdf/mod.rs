//! Surface scattering. All directions are unit vectors in the local shading frame (+z is the shading
//! normal) that point away from the surface.
//!
//! A [`Material`] holds the parameters of a surface; at a point, with its textures evaluated there, it
//! becomes one of the models that implement `Bsdf`, each in a file of its own.

mod conductor;
mod dielectric;
mod diffuse;
mod fresnel;
pub mod ior;
mod material;
pub mod metals;
mod microfacet;
mod model;
mod plastic;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;
mod rough_reflection;
mod substrate;

#[cfg(test)]
mod tests;

pub use material::Material;
pub use microfacet::MicrofacetDistribution;
pub use model::{BsdfEvaluation, BsdfSample, DeltaLobe, TransportMode};
pub use plastic::Plastic;
pub use rough_plastic::RoughPlastic;
