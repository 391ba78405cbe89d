//! The techniques of bidirectional path tracing, enumerated by the length of their paths.

use super::Technique;
use crate::scene::Scene;

/// The techniques that bidirectional path tracing has in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Techniques {
    /// Maximum number of delta vertices of technique 1*.
    max_chain: usize,
    /// Minimum number of camera vertices of technique 1*: lens and D, or a delta vertex between them if light
    /// subpaths could be connected to the lens.
    min_t: usize,
}

impl Techniques {
    /// Those in `scene`.
    pub fn of(scene: &Scene) -> Self {
        let max_chain = if scene.has_chains() {
            scene.casters.max_length()
        } else {
            0
        };
        let min_t = if scene.casters.everywhere() { 2 } else { 3 };
        Self { max_chain, min_t }
    }

    /// All (s, t), and not 1*.
    pub fn without_chains() -> Self {
        Self {
            max_chain: 0,
            min_t: 2,
        }
    }

    /// Number of techniques for paths of `edges` >= 1 edges. Paths of one edge (directly visible lights) have
    /// only (0, 2).
    #[inline]
    pub fn count(self, edges: usize) -> usize {
        if edges == 1 {
            return 1;
        }
        edges + 1 + edges.saturating_sub(self.min_t).min(self.max_chain)
    }

    /// Technique `i` < [`Self::count`] for paths of `edges` edges: those of Veach in the order of s, then 1* in
    /// the order of the number of delta vertices.
    #[inline]
    pub fn nth(self, edges: usize, i: usize) -> Technique {
        if i <= edges {
            Technique::new(i, edges + 1 - i)
        } else {
            let n = i - edges;
            Technique::Specular { t: edges - n, n }
        }
    }

    /// The index of a technique among those of its path length: the inverse of [`Self::nth`].
    #[inline]
    pub fn index(self, technique: Technique) -> usize {
        match technique {
            Technique::Specular { n, .. } => technique.edges() + n,
            Technique::Hit { .. }
            | Technique::NextEvent { .. }
            | Technique::Camera { .. }
            | Technique::Join { .. } => technique.s(),
        }
    }

    /// All techniques for paths of up to `max_edges` edges, by length.
    pub fn all(self, max_edges: usize) -> impl Iterator<Item = Technique> {
        (1..=max_edges).flat_map(move |k| (0..self.count(k)).map(move |i| self.nth(k, i)))
    }

    /// The index of a technique in [`Self::all`].
    #[inline]
    pub fn ordinal(self, technique: Technique) -> usize {
        let shorter = (1..technique.edges()).map(|k| self.count(k)).sum::<usize>();
        shorter + self.index(technique)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn techniques_are_enumerated_by_length() {
        for (max_chain, count) in [(0, 34), (1, 38), (3, 43)] {
            let techniques = Techniques {
                max_chain,
                min_t: 3,
            };
            let all: Vec<Technique> = techniques.all(7).collect();
            assert_eq!(all.len(), count);
            for (i, &technique) in all.iter().enumerate() {
                assert_eq!(techniques.ordinal(technique), i, "{technique}");
                let edges = technique.edges();
                assert_eq!(technique.s() + technique.t(), edges + 1);
                assert_eq!(
                    techniques.nth(edges, techniques.index(technique)),
                    technique
                );
            }
            let names: Vec<String> = all[..4].iter().map(ToString::to_string).collect();
            assert_eq!(names, ["(0,2)", "(0,3)", "(1,2)", "(2,1)"]);
        }
        let chains = Techniques {
            max_chain: 2,
            min_t: 3,
        };
        let last: Vec<String> = chains.all(5).skip(18).map(|t| t.to_string()).collect();
        assert_eq!(last, ["(4,2)", "(5,1)", "(1*,4)", "(1**,3)"]);
    }
}
