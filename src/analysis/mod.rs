//! Analysis of a scene before it is rendered: light that is lost, rare or trapped.

pub mod lost_light;
mod probe;
pub mod trapped_light;

pub use lost_light::{Loss, LostLight, lost_light};
pub use trapped_light::{TrappedLight, trapped_light};
