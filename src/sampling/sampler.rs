//! A point of the unit hypercube, read coordinate by coordinate.
//!
//! A path sampler maps such a point to light and knows nothing of where its numbers come from: fresh
//! ones for Monte Carlo, the state of a Markov chain for Metropolis (Kelemen et al. 2002, section 2).

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

/// The families of coordinates. Each has its own infinite sequence, so that a longer camera subpath
/// never shifts the numbers of the light subpath (Kelemen et al. 2002, section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Film and lens position, then the vertices of the camera subpath.
    Camera,
    /// The emitter, then the vertices of the light subpath.
    Light,
    /// What connections need: points on emitters and on the lens.
    Connection,
    /// Which technique joins the subpaths, where the point chooses one.
    Technique,
}

impl Stream {
    /// How many streams there are.
    pub const COUNT: usize = 4;
}

/// A point of the unit hypercube. Every coordinate is read at most once for each path sampled.
pub trait Coordinates {
    /// `N` consecutive coordinates of `stream`, from `first` on, each in [0, 1).
    fn read<const N: usize>(&mut self, stream: Stream, first: usize) -> [f32; N];
}

/// A point whose every coordinate is fresh and uniform: the Monte Carlo driver's.
#[derive(Clone, Debug)]
pub struct FreshCoordinates {
    rng: Xoshiro256PlusPlus,
}

impl FreshCoordinates {
    /// Numbers drawn from `rng`.
    pub fn new(rng: Xoshiro256PlusPlus) -> Self {
        Self { rng }
    }

    /// The generator, for draws that belong to the driver and not to the path.
    pub fn rng(&mut self) -> &mut Xoshiro256PlusPlus {
        &mut self.rng
    }
}

impl Coordinates for FreshCoordinates {
    #[inline]
    fn read<const N: usize>(&mut self, _stream: Stream, _first: usize) -> [f32; N] {
        std::array::from_fn(|_| self.rng.random::<f32>())
    }
}
