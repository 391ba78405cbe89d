//! Light toward a point, and samples of it.

use glam::{Vec2, Vec3A};

use crate::math::Rgb;

/// Distance squared below which two points coincide: their geometry term overflows f32.
pub const MIN_DISTANCE_SQUARED: f32 = 1e-20;

/// Light from a point y_0 of an emitter toward a given point, with the densities of all ways to sample
/// it.
#[derive(Clone, Copy, Debug)]
pub struct LightEvaluation {
    /// Radiance toward the point, W/(m^2 sr); intensity for point lights, irradiance for directional
    /// ones.
    pub radiance: Rgb,
    /// Density of y_0 in its native measure when sampled for that point (s = 1).
    pub pdf_direct: f32,
    /// Density of y_0 in its native measure when sampled as the start of a light subpath (s >= 2).
    pub pdf_position: f32,
    /// Density of the direction toward the point given y_0 (s >= 2): per steradian for emitters at a
    /// finite distance; for those at infinity, directional lights included, per unit area of the disk
    /// that emits.
    pub pdf_direction: f32,
}

/// A point y_0 on an emitter, sampled for a point that it may light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit, from the point to y_0.
    pub direction: Vec3A,
    /// End of the shadow ray, offset from the surface of the emitter; for an emitter at infinity a
    /// point outside the scene.
    pub target: Vec3A,
    /// Radiance and densities of y_0 toward the point.
    pub emission: LightEvaluation,
    /// Jacobian from solid angle at the point to the native measure of y_0: |cos(y_0)|/d^2 for
    /// surfaces, 1/d^2 for point lights, 1 at infinity. It is also the factor of the emitter in the
    /// geometry term G.
    pub jacobian_direction: f32,
    /// Jacobian, without the cosine at the point, from the measure of `pdf_direction` to area at the
    /// point: 1/d^2, or 1 for emitters at infinity.
    pub jacobian_area: f32,
    /// True if no camera subpath can hit this emitter (point and directional lights), so that technique
    /// s = 0 does not exist for it.
    pub delta: bool,
}

/// The start of a light subpath: y_0 and the direction to y_1.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// Index of the emitter.
    pub emitter: u32,
    /// Origin of the ray, offset from the surface of the emitter.
    pub origin: Vec3A,
    /// y_0, on a surface or of a point light; the same as `origin` for emitters at infinity.
    pub position: Vec3A,
    /// Unit normal at y_0 on the emitting side; for point lights and emitters at infinity the same as
    /// `direction`.
    pub normal: Vec3A,
    /// Unit direction in which the light travels.
    pub direction: Vec3A,
    /// Le |cos| / (pdf_position pdf_direction): the throughput alpha of the subpath.
    pub weight: Rgb,
    /// Density of y_0 in its native measure.
    pub pdf_position: f32,
    /// As [`LightEvaluation::pdf_direction`].
    pub pdf_direction: f32,
    /// True if y_0 is at infinity, where `jacobian_area` to y_1 is 1 instead of 1/d^2.
    pub infinite: bool,
    /// As [`LightSample::delta`].
    pub delta: bool,
}

/// A point sampled on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceSample {
    /// In scene units.
    pub position: Vec3A,
    /// Unit, on the front side.
    pub normal: Vec3A,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Density per unit area.
    pub pdf: f32,
}
