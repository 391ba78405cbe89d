//! Sources of sample values: points of the unit hypercube, one number per dimension.
//!
//! A path sampler maps such a point to light and does not know where its numbers come from: they are
//! independent for Monte Carlo, and the state of a Markov chain for Metropolis (Kelemen et al. 2002,
//! section 2). A dimension is an address, not a place in a sequence of reads.

/// The families of dimensions. Each has its own infinite sequence, so that a longer camera subpath
/// never shifts the numbers of the light subpath (Kelemen et al. 2002, section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stream {
    /// Film and lens position, then the vertices of the camera subpath.
    Camera,
    /// The light, then the vertices of the light subpath.
    Light,
    /// Points on lights and on the lens that connections need.
    Connection,
    /// The technique, where a sample chooses one.
    Technique,
}

impl Stream {
    /// Number of streams.
    pub const COUNT: usize = 4;
}

/// The address of a coordinate of the hypercube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Dimension {
    /// The family.
    pub stream: Stream,
    /// The place within the family.
    pub index: usize,
}

impl Dimension {
    /// Dimension number `index` of `stream`.
    #[inline]
    pub const fn new(stream: Stream, index: usize) -> Self {
        Self { stream, index }
    }
}

/// A point of the unit hypercube (pbrt's sampler). The value of a dimension is the same however often
/// and in whatever order it is asked for.
pub trait Sampler {
    /// The values of `N` consecutive dimensions of one stream, from `first` on, each in [0, 1).
    fn get<const N: usize>(&mut self, first: Dimension) -> [f32; N];
}
