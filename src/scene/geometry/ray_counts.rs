//! Counts of rays and of searches for specular chains.

/// Rays traced, and searches for specular chains: the units of cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Closest-hit queries.
    pub closest_hit: u64,
    /// Occlusion queries.
    pub shadow: u64,
    /// Searches for the chains between a vertex and a point on an emitter.
    pub chain_searches: u64,
}

impl RayCounts {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.closest_hit + self.shadow
    }

    /// Cost of all rays and searches, in rays; a search costs `search` rays.
    pub fn cost(&self, search: f64) -> f64 {
        self.total() as f64 + search * self.chain_searches as f64
    }
}

impl std::ops::AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.closest_hit += other.closest_hit;
        self.shadow += other.shadow;
        self.chain_searches += other.chain_searches;
    }
}

impl std::iter::Sum for RayCounts {
    fn sum<I: Iterator<Item = Self>>(counts: I) -> Self {
        counts.fold(Self::default(), |mut sum, more| {
            sum += more;
            sum
        })
    }
}
