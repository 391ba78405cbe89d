//! Images, and what their files say about them.

use std::collections::BTreeMap;

/// An image in linear RGB with the primaries of sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: usize,
    /// Pixels in a column.
    pub height: usize,
    /// `width * height` pixels, rows from top to bottom.
    pub pixels: Vec<[f32; 3]>,
}

/// An image and what its file says beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnotatedImage {
    /// The image.
    pub image: Image,
    /// Of OpenEXR files, the other layers that have channels NAME.R, NAME.G and NAME.B, by name; as
    /// many pixels as the image has.
    pub layers: BTreeMap<String, Vec<[f32; 3]>>,
    /// Of OpenEXR files, the texts and numbers that are no standard attributes, by name.
    pub attributes: BTreeMap<String, AttributeValue>,
}

impl AnnotatedImage {
    /// An attribute that is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.attributes.get(name) {
            Some(AttributeValue::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// An attribute that is a text.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.attributes.get(name) {
            Some(AttributeValue::Text(text)) => Some(text),
            _ => None,
        }
    }
}

/// What an image file can say about how it was made.
#[derive(Clone, Debug, PartialEq)]
pub enum AttributeValue {
    /// Stored as `string`, in UTF-8.
    Text(String),
    /// Stored as `double`.
    Number(f64),
}
