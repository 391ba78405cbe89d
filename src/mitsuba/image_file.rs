//! Images in files that objects name.

use std::path::PathBuf;

use super::builder::Builder;
use super::error::{Cause, LoadError, Located};
use super::xml::{Object, Property};
use crate::film::{Decode, Image, read_image};

/// The image that `filename` names. All its values must satisfy `is_valid`, which `range`
/// describes.
pub fn image<'a>(
    builder: &Builder<'a>,
    object: &'a Object,
    decode: Decode,
    range: &'static str,
    is_valid: impl Fn(f32) -> bool,
) -> Result<Image, LoadError> {
    let file = ImageFile::read(builder, object, decode)?;
    match file.invalid_pixel(range, is_valid) {
        None => Ok(file.image),
        Some(error) => Err(error),
    }
}

/// An image and where its name is given.
pub struct ImageFile<'a> {
    /// The image.
    pub image: Image,
    path: PathBuf,
    property: &'a Property,
}

impl<'a> ImageFile<'a> {
    /// Reads the image that `filename` names.
    pub fn read(
        builder: &Builder<'a>,
        object: &'a Object,
        decode: Decode,
    ) -> Result<Self, LoadError> {
        let (path, property) = builder.file(object)?;
        match read_image(&path, decode) {
            Ok(image) => Ok(Self {
                image,
                path,
                property,
            }),
            Err(error) => Err(property.error(Cause::Image { path, error })),
        }
    }

    /// An error if some value does not satisfy `is_valid`, which `range` describes.
    pub fn invalid_pixel(
        &self,
        range: &'static str,
        is_valid: impl Fn(f32) -> bool,
    ) -> Option<LoadError> {
        let image = &self.image;
        let mut pixels = image.pixels.iter();
        let invalid = pixels.position(|p| !p.iter().all(|&x| is_valid(x)))?;
        Some(self.property.error(Cause::ImageValue {
            path: self.path.clone(),
            pixel: [invalid % image.width, invalid / image.width],
            value: image.pixels[invalid],
            range,
        }))
    }
}
