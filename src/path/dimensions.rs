//! Which coordinate of the hypercube means what. Every vertex owns a fixed block of its stream, so
//! that no choice made at one vertex shifts the numbers of another (Kelemen et al. 2002, section 3).

/// Camera stream: film position (2), then the lens (2).
pub const FILM: usize = 0;
/// Camera stream: the point on the lens (2).
pub const LENS: usize = 2;
/// Light stream: emitter, part of it, place (2), direction (2).
pub const EMISSION: usize = 0;

/// Numbers that a vertex needs to go on: lobe, direction (2), Russian roulette.
pub const PER_VERTEX: usize = 4;

/// Numbers that the connections of a pair of vertices (z_i, y_i) need: emitter, part of it and
/// place (2) for z_i; the point on the lens (2) for y_i.
const PER_CONNECTION: usize = 6;

/// Camera stream: the block of surface vertex z_i, i >= 1.
#[inline]
pub const fn camera_vertex(i: usize) -> usize {
    4 + (i - 1) * PER_VERTEX
}

/// Light stream: the block of surface vertex y_i, i >= 1.
#[inline]
pub const fn light_vertex(i: usize) -> usize {
    6 + (i - 1) * PER_VERTEX
}

/// Connection stream: the point on an emitter that technique s = 1 joins to z_i.
#[inline]
pub fn to_light(i: usize) -> usize {
    i * PER_CONNECTION
}

/// Connection stream: the point on the lens that technique t = 1 joins to y_i.
#[inline]
pub fn to_lens(i: usize) -> usize {
    i * PER_CONNECTION + 4
}
