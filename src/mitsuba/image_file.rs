//! Images in files that objects name.

use super::builder::Builder;
use super::error::{Cause, LoadError, Located};
use super::xml::Object;
use crate::film::{Decode, Image, read_image};

/// The image that `filename` names. All its values must satisfy `is_valid`, which `range`
/// describes.
pub fn image(
    builder: &Builder,
    object: &Object,
    decode: Decode,
    range: &'static str,
    is_valid: impl Fn(f32) -> bool,
) -> Result<Image, LoadError> {
    let (path, property) = builder.file(object)?;
    let image = match read_image(&path, decode) {
        Ok(image) => image,
        Err(error) => return Err(property.error(Cause::Image { path, error })),
    };
    let invalid = image
        .pixels
        .iter()
        .position(|p| !p.iter().all(|&x| is_valid(x)));
    match invalid {
        None => Ok(image),
        Some(i) => Err(property.error(Cause::ImageValue {
            path,
            pixel: [i % image.width, i / image.width],
            value: image.pixels[i],
            range,
        })),
    }
}
