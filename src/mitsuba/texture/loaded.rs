//! What the constructors of textures return.

use crate::mitsuba::error::LoadError;
use crate::scene::Texture;

/// A texture from a scene file.
pub struct LoadedTexture {
    /// The texture.
    pub texture: Texture,
    /// An error if it has values outside [0, 1].
    pub out_of_range: Option<LoadError>,
    /// An error if it has negative values.
    pub negative: Option<LoadError>,
}
