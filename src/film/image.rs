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

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Columns and rows before it.
    pub offset: [usize; 2],
    /// Its columns and rows.
    pub size: [usize; 2],
}

impl Crop {
    /// The pixels within the rectangle, of an image with `width` pixels in a row.
    pub fn of<T: Copy>(&self, width: usize, pixels: &[T]) -> Vec<T> {
        let [left, top] = self.offset;
        let [columns, rows] = self.size;
        let row = |y: usize| &pixels[(top + y) * width + left..][..columns];
        (0..rows).flat_map(row).copied().collect()
    }
}

impl Image {
    /// The part within a rectangle.
    pub fn part(&self, crop: &Crop) -> Self {
        let [width, height] = crop.size;
        Self {
            width,
            height,
            pixels: crop.of(self.width, &self.pixels),
        }
    }
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
