//! Sources of sample values: points of the unit hypercube, one number per dimension.
//!
//! A path sampler maps such a point to splats and does not depend on the source of the values: independent
//! samples for Monte Carlo, or the state of a Markov chain for Metropolis (Kelemen et al. 2002, section
//! 2). A dimension is an address. Its value does not depend on the order of reads.

/// Streams of dimensions. Each is an infinite sequence of its own, so that a longer camera subpath does
/// not shift the dimensions of the light subpath (Kelemen et al. 2002, section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stream {
    /// Film and lens position, then the vertices of the camera subpath.
    Camera,
    /// The light, then the vertices of the light subpath.
    Light,
    /// Points on lights and on the lens that connections sample.
    Connection,
    /// The technique, for samples that choose one.
    Technique,
    /// Points on lights that are connected through specular chains.
    Specular,
}

impl Stream {
    /// Number of streams.
    pub const COUNT: usize = 5;
}

/// The address of a coordinate of the hypercube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Dimension {
    /// The stream.
    pub stream: Stream,
    /// The index within the stream.
    pub index: usize,
}

impl Dimension {
    /// Dimension `index` of `stream`.
    #[inline]
    pub const fn new(stream: Stream, index: usize) -> Self {
        Self { stream, index }
    }
}

/// A point of the unit hypercube (pbrt's sampler). Repeated reads of a dimension return the same value,
/// in any order.
pub trait Sampler {
    /// The values of `N` consecutive dimensions of one stream, from `first` on, each in [0, 1).
    fn get<const N: usize>(&mut self, first: Dimension) -> [f32; N];
}
