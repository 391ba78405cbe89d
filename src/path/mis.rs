//! MIS weights of techniques in O(1), from partial sums carried along the subpaths (van Antwerpen 2011,
//! "Recursive MIS computation for streaming BDPT on the GPU"; Georgiev 2012, "Implementing vertex
//! connection and merging", here without merging).
//!
//! Let technique s sample the path x_0 ... x_k with density p_s, and let h(p) = p^2 be the power of the
//! power heuristic (Veach 1997, section 9.2, beta = 2). The weight of technique s is 1 / (1 + S^L + S^E),
//! where S^L sums h(p_i / p_s) over the techniques with fewer light vertices, i < s, and S^E over those with
//! fewer camera vertices, i > s.
//!
//! Two neighbouring techniques differ in the subpath that samples one vertex. Along one subpath x_0, x_1,
//! ... let f_i be the density with which this subpath samples x_i, and b_i the density with which the
//! other subpath samples it. Then the sum over the techniques that end this subpath before x_i is
//!
//!   S_i = h(b_i / f_i) (v_i + S_{i-1}),                                                      (1)
//!
//! with v_i = 1 if technique i can connect x_{i-1} and x_i, that is, if neither scatters by a delta lobe
//! on this path, and v_i = 0 otherwise. Now b_{i-1} = r_i g_i, where r_i is the density per steradian of
//! sampling the direction from x_i to x_{i-1} and g_i = |cos at x_{i-1}| / d^2. So with
//!
//!   C_i = h(g_i / f_{i-1}) (v_{i-1} + h(r_{i-1}) C_{i-1}),                                   (2)
//!   S_i = h(b_i / f_i) (v_i + h(r_i) C_i),                                                   (3)
//!
//! everything in C_i is known when x_i is sampled, and the other terms of (3) are known when x_i is
//! connected.
//!
//! Technique 1* samples y_0 with density p_d and x_i = D from the other side, and finds the delta vertices
//! between them. If this subpath comes from a light and D is its first vertex after a chain of delta vertices,
//! let F be the density with which it samples y_0 and D. Then 1* has the term h(p_d b_i / F), so that v_i is to
//! be replaced in (1) to (3) by
//!
//!   v_i + v*_i,   v*_i = h(p_d f_i / F).                                                      (4)
//!
//! Technique s = 1 samples y_0 given the point that it illuminates, with density p_direct instead of the
//! density p_pos of a light subpath. Then f_0 = p_direct, and f_1 has the factor p_pos / p_direct.
//!
//! The densities exclude the survival probabilities of Russian roulette, for all techniques alike. So the
//! weights sum to 1, and every density can be evaluated from either end of the path.

/// h(p) = p^2: the power heuristic (Veach 1997, section 9.2).
#[inline]
pub fn h(p: f64) -> f64 {
    p * p
}

/// The weight of a technique, given S^L and S^E: the sums over the techniques with fewer light vertices and
/// with fewer camera vertices.
#[inline]
pub fn weight(light: f64, camera: f64) -> f32 {
    (1.0 / (1.0 + light + camera)) as f32
}

/// Partial sums of a subpath at its vertex x_i, i >= 1, for the MIS weights of all techniques.
#[derive(Clone, Copy, Debug, Default)]
pub struct PartialMis {
    /// f_i: density with which the subpath samples x_i given its predecessors, per unit area (per
    /// steradian at infinity).
    pub forward: f64,
    /// C_i of (2).
    pub partial: f64,
    /// v_i of (1), if x_i itself does not scatter by a delta lobe: true if x_{i-1} does not.
    pub connectible: bool,
    /// v*_i of (4), if x_i itself does not scatter by a delta lobe.
    pub specular: f64,
}

impl PartialMis {
    /// At the first vertex of a camera subpath, sampled with density `forward`. Light subpaths never hit
    /// the lens (there is no technique t = 0), so C_1 = 0.
    #[inline]
    pub fn after_lens(forward: f64) -> Self {
        Self {
            forward,
            partial: 0.0,
            connectible: true,
            specular: 0.0,
        }
    }

    /// At the first vertex of a light subpath. `forward` is the area density there, `pdf_position` and
    /// `pdf_direct` are the densities of y_0 for s >= 2 and s = 1, `jacobian` is g_1, and `can_be_hit` is
    /// true if technique s = 0 exists.
    #[inline]
    pub fn after_light(
        forward: f64,
        pdf_position: f64,
        pdf_direct: f64,
        jacobian: f64,
        can_be_hit: bool,
    ) -> Self {
        // Rounding may put x_1 behind the emitting side of y_0. Then technique s = 1 cannot sample the
        // path, and `forward` becomes infinite: all techniques with fewer light vertices have weight 0.
        let hit = if can_be_hit && pdf_direct > 0.0 {
            h(jacobian / pdf_direct)
        } else {
            0.0
        };
        Self {
            forward: forward * (pdf_position / pdf_direct),
            partial: hit,
            connectible: true,
            specular: 0.0,
        }
    }

    /// At x_{i+1}, given the values at x_i (`self`), the density `reverse` per steradian of scattering
    /// at x_i from x_{i+1} to x_{i-1}, whether x_i scattered by a delta lobe, g_{i+1} and f_{i+1}:
    /// equation (2).
    #[inline]
    pub fn extend(&self, reverse: f64, delta: bool, jacobian: f64, forward: f64) -> Self {
        let connect = if delta { 0.0 } else { self.connections() };
        Self {
            forward,
            partial: h(jacobian / self.forward) * (connect + h(reverse) * self.partial),
            connectible: !delta,
            specular: 0.0,
        }
    }

    /// v_i + v*_i of (4).
    #[inline]
    fn connections(&self) -> f64 {
        let connect = if self.connectible { 1.0 } else { 0.0 };
        connect + self.specular
    }

    /// True if the path so far, with a chain of delta vertices after x_i, can be sampled by a technique that
    /// connects two of its vertices.
    #[inline]
    pub fn has_connection(&self) -> bool {
        self.connectible || self.partial > 0.0
    }

    /// S_i of (3): `other` is b_i, the density at x_i of the other subpath, and `reverse` is r_i.
    #[inline]
    pub fn sum(&self, other: f64, reverse: f64) -> f64 {
        h(other / self.forward) * (self.connections() + h(reverse) * self.partial)
    }

    /// S_i where x_i lies on a light that a camera subpath has hit (technique s = 0). The other
    /// techniques sample it with `pdf_direct` (s = 1) or with `pdf_position`, going on to x_{i-1}
    /// with `pdf_direction` (s >= 2). Equation (3) with b_i = pdf_direct and r_i = pdf_direction
    /// pdf_position / pdf_direct, multiplied out to avoid the division by pdf_direct.
    #[inline]
    pub fn sum_on_light(&self, pdf_direct: f64, pdf_position: f64, pdf_direction: f64) -> f64 {
        let connect = if self.connectible { h(pdf_direct) } else { 0.0 };
        (connect + h(pdf_position * pdf_direction) * self.partial) / h(self.forward)
    }
}
