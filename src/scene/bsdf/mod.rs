//! Surface scattering. All directions are unit vectors in the local shading frame (+z is the shading
//! normal) that point away from the surface.
//!
//! A [`Material`] holds the parameters of a surface; at a point, with its textures evaluated there, it
//! becomes one of the models that implement `Bsdf`, each in a file of its own. Some models contain others: a mask, a
//! blend, perturbed normals, the two sides of a surface.

mod ashikhmin_shirley;
mod at_point;
mod blend;
mod conductor;
mod context;
mod dielectric;
mod diffuse;
mod disney;
mod disney_sum;
mod facet;
mod fresnel;
pub mod ior;
mod layered;
mod mask;
mod material;
pub mod metals;
mod microfacet;
mod model;
mod perturbed;
mod phong;
mod plastic;
mod principled;
mod principled_thin;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;
mod rough_reflection;
mod roughness;
mod substrate;
mod thin_dielectric;
mod two_sided;

#[cfg(test)]
mod tests;

pub use context::MaterialContext;
pub use disney_sum::{DisneyLobes, DisneySum};
pub use material::Material;
pub use microfacet::MicrofacetDistribution;
pub use model::{BsdfEvaluation, BsdfSample, DeltaLobe, TransportMode};
pub use perturbed::NormalPerturbation;
pub use plastic::Plastic;
pub use principled::Principled;
pub use principled_thin::PrincipledThin;
pub use rough_plastic::RoughPlastic;
pub use roughness::Roughness;
