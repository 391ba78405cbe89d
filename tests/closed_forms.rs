//! Images whose mean is known in closed form, or by a quadrature that shares no code with the renderer.

mod common;

#[path = "closed_forms/enclosures.rs"]
mod enclosures;
#[path = "closed_forms/integrating_sphere.rs"]
mod integrating_sphere;
#[path = "closed_forms/irradiance.rs"]
mod irradiance;
#[path = "closed_forms/plates.rs"]
mod plates;
#[path = "closed_forms/published.rs"]
mod published;
