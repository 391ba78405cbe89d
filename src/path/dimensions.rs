//! The use of each dimension of the hypercube. Every vertex has a fixed block of its stream, so that no
//! choice at one vertex shifts the dimensions of another (Kelemen et al. 2002, section 3).

use crate::sampling::{Dimension, Stream};

/// Film position (2).
pub const FILM: Dimension = Dimension::new(Stream::Camera, 0);
/// Point on the lens (2).
pub const LENS: Dimension = Dimension::new(Stream::Camera, 2);
/// Start of a light subpath: light, primitive, position (2), direction (2).
pub const EMISSION: Dimension = Dimension::new(Stream::Light, 0);
/// The technique, for samples that choose one.
pub const TECHNIQUE: Dimension = Dimension::new(Stream::Technique, 0);

/// Dimensions with which a vertex samples the next one: lobe, direction (2), Russian roulette.
pub const PER_VERTEX: usize = 4;

/// Dimensions of the connections of vertices z_i and y_i: light, primitive and position (2) for z_i; the
/// point on the lens (2) for y_i.
const PER_CONNECTION: usize = 6;

/// The block of camera subpath vertex z_i, i >= 1.
#[inline]
pub const fn camera_vertex(i: usize) -> Dimension {
    Dimension::new(Stream::Camera, 4 + (i - 1) * PER_VERTEX)
}

/// The block of light subpath vertex y_i, i >= 1.
#[inline]
pub const fn light_vertex(i: usize) -> Dimension {
    Dimension::new(Stream::Light, 6 + (i - 1) * PER_VERTEX)
}

/// The point on a light that technique s = 1 connects to z_i.
#[inline]
pub const fn next_event(i: usize) -> Dimension {
    Dimension::new(Stream::Connection, i * PER_CONNECTION)
}

/// The point on a light that technique 1* connects to z_i: light, primitive, position (2).
#[inline]
pub const fn specular(i: usize) -> Dimension {
    Dimension::new(Stream::Specular, (i - 1) * 4)
}

/// The point on the lens that technique t = 1 connects to y_i.
#[inline]
pub const fn connect_to_camera(i: usize) -> Dimension {
    Dimension::new(Stream::Connection, i * PER_CONNECTION + 4)
}
