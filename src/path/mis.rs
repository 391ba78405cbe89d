//! Weights of techniques in O(1), from quantities carried along the subpaths (van Antwerpen 2011,
//! "Recursive MIS computation for streaming BDPT on the GPU"; Georgiev 2012, "Implementing vertex
//! connection and merging", here without merging).
//!
//! Let technique s make the path x_0 ... x_k with density p_s, and let h be the heuristic's power.
//! The weight of technique s is 1 / (1 + L + C), where L sums h(p_i / p_s) over the techniques with
//! fewer light vertices, i < s, and C over those with fewer camera vertices, i > s.
//!
//! Two neighbouring techniques differ in who sampled one vertex. Seen along one subpath x_0, x_1, ...
//! let f_i be the density with which that subpath samples x_i, and b_i the one with which the other
//! subpath would. Then the sum over the techniques that end this subpath before x_i is
//!
//!   S_i = h(b_i / f_i) (v_i + S_{i-1}),                                                      (1)
//!
//! with v_i = 1 if technique i can join x_{i-1} and x_i, that is, if neither scatters by a delta
//! lobe on this path. Now b_{i-1} = r_i g_i, where r_i is the density per steradian of sampling the
//! direction from x_i to x_{i-1} and g_i = |cos at x_{i-1}| / d^2. So with
//!
//!   C_i = h(g_i / f_{i-1}) (v_{i-1} + h(r_{i-1}) C_{i-1}),                                   (2)
//!   S_i = h(b_i / f_i) (v_i + h(r_i) C_i),                                                   (3)
//!
//! everything in C_i is known when x_i is sampled, and (3) needs only what a connection knows.
//!
//! Technique s = 1 samples y_0 for the point it lights, with density p_direct and not with the p_pos
//! of a light subpath. Then f_0 = p_direct and f_1 carries the factor p_pos / p_direct.
//!
//! Russian roulette is in no density: leaving it out of all techniques alike keeps the sum of the
//! weights at 1 and every density computable from either side.

/// How the densities of techniques are weighed against each other (Veach 1997, section 9.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heuristic {
    /// In proportion to the density.
    Balance,
    /// In proportion to its square: beta = 2.
    #[default]
    Power,
}

impl Heuristic {
    /// h(p): the power to which the heuristic raises a ratio of densities.
    #[inline]
    pub fn power(self, p: f64) -> f64 {
        match self {
            Self::Balance => p,
            Self::Power => p * p,
        }
    }
}

/// What a subpath carries at its vertex x_i, i >= 1, for the weights of all techniques.
#[derive(Clone, Copy, Debug)]
pub struct Carried {
    /// f_i: density with which the subpath samples x_i, relative to that of its predecessors; per
    /// unit area (per steradian at infinity).
    pub forward: f64,
    /// C_i of (2).
    pub partial: f64,
    /// v_i of (1), provided that x_i itself does not scatter by a delta lobe: x_{i-1} does not.
    pub joinable: bool,
}

impl Carried {
    /// At the first surface vertex of a camera subpath, sampled with density `forward`. The lens is
    /// never hit (no technique t = 0), so C_1 = 0.
    #[inline]
    pub fn after_lens(forward: f64) -> Self {
        Self {
            forward,
            partial: 0.0,
            joinable: true,
        }
    }

    /// At the first surface vertex of a light subpath. `forward` is the area density there,
    /// `pdf_position` and `pdf_direct` are the densities of y_0 for s >= 2 and s = 1, `geometry` is
    /// g_1, and `can_be_hit` tells whether technique s = 0 exists.
    #[inline]
    pub fn after_emitter(
        heuristic: Heuristic,
        forward: f64,
        pdf_position: f64,
        pdf_direct: f64,
        geometry: f64,
        can_be_hit: bool,
    ) -> Self {
        // Rounding may put x_1 where y_0 turns its dark side; then technique s = 1 cannot make the path
        // and `forward` becomes infinite: no technique with fewer vertices counts.
        let hit = if can_be_hit && pdf_direct > 0.0 {
            heuristic.power(geometry / pdf_direct)
        } else {
            0.0
        };
        Self {
            forward: forward * (pdf_position / pdf_direct),
            partial: hit,
            joinable: true,
        }
    }

    /// At x_{i+1}, given what x_i carries (`self`), the density `reverse` per steradian of going
    /// from x_{i+1}'s direction back to x_{i-1}, whether x_i scattered by a delta lobe, g_{i+1} and
    /// f_{i+1}: equation (2).
    #[inline]
    pub fn extend(
        &self,
        heuristic: Heuristic,
        reverse: f64,
        delta: bool,
        geometry: f64,
        forward: f64,
    ) -> Self {
        let join = if self.joinable && !delta { 1.0 } else { 0.0 };
        Self {
            forward,
            partial: heuristic.power(geometry / self.forward)
                * (join + heuristic.power(reverse) * self.partial),
            joinable: !delta,
        }
    }

    /// S_i of (3): `other` is b_i, the density at x_i of the other subpath, and `reverse` is r_i.
    #[inline]
    pub fn sum(&self, heuristic: Heuristic, other: f64, reverse: f64) -> f64 {
        let join = if self.joinable { 1.0 } else { 0.0 };
        heuristic.power(other / self.forward) * (join + heuristic.power(reverse) * self.partial)
    }

    /// S_i where x_i lies on an emitter that a camera subpath has met (technique s = 0). The other
    /// techniques sample it with `pdf_direct` (s = 1) or with `pdf_position`, going on to x_{i-1}
    /// with `pdf_direction` (s >= 2). Equation (3) with r_i = pdf_direction pdf_position /
    /// pdf_direct, multiplied out so that no density is divided by.
    #[inline]
    pub fn sum_on_emitter(
        &self,
        heuristic: Heuristic,
        pdf_direct: f64,
        pdf_position: f64,
        pdf_direction: f64,
    ) -> f64 {
        let join = if self.joinable {
            heuristic.power(pdf_direct)
        } else {
            0.0
        };
        (join + heuristic.power(pdf_position * pdf_direction) * self.partial)
            / heuristic.power(self.forward)
    }
}
