//! Emitters, evaluated and sampled in the three ways that light transport needs: sampled for a point
//! that is lit (technique s = 1), sampled as the start of a light subpath (s >= 2), and hit by a camera
//! subpath (s = 0).
//!
//! A point y_0 on an emitter has a density in the *native measure* of its kind: area for surfaces,
//! solid angle for emitters at infinity, and a probability for point and directional lights. All
//! densities include the probability of choosing the emitter.

mod area;
mod directional;
mod emitters;
mod environment;
mod environment_map;
mod infinite;
mod mesh;
mod point;
mod profile;
mod sample;
mod specular;
mod sphere;

#[cfg(test)]
mod tests;

pub use emitters::{EmitterKind, Emitters};
pub use sample::{EmissionSample, LightEvaluation, LightSample, SurfaceSample};
pub use specular::ChainEnd;

pub(super) use area::AreaEmitter;
pub(super) use directional::DirectionalEmitter;
pub(super) use emitters::Emitter;
pub(super) use environment::Environment;
pub(super) use environment_map::EnvironmentMap;
pub(super) use point::PointEmitter;
pub(super) use profile::Profile;
