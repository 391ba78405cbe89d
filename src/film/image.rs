//! Images, and the layers and attributes of their files.

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

/// An image with the other contents of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnotatedImage {
    /// The image.
    pub image: Image,
    /// Layers of an OpenEXR file that have channels NAME.R, NAME.G and NAME.B, by name; each has as
    /// many pixels as the image.
    pub layers: BTreeMap<String, Vec<[f32; 3]>>,
    /// Attributes of an OpenEXR file that are texts or numbers and not standard ones, by name.
    pub attributes: BTreeMap<String, AttributeValue>,
}

impl AnnotatedImage {
    /// The value of an attribute that is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.attributes.get(name) {
            Some(AttributeValue::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// The value of an attribute that is a text.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.attributes.get(name) {
            Some(AttributeValue::Text(text)) => Some(text),
            _ => None,
        }
    }
}

/// Value of an attribute of an image file.
#[derive(Clone, Debug, PartialEq)]
pub enum AttributeValue {
    /// Stored as `string`, in UTF-8.
    Text(String),
    /// Stored as `double`.
    Number(f64),
}
