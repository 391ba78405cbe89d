//! Chains of one vertex on a triangle with interpolated normals, by Newton's method (Walter, Zhao, Holzschuch
//! and Bala 2009, "Single scattering in refractive media with triangle mesh boundaries", section 4.2).
//!
//! At the vertex P(u, v) = P_0 + u E_1 + v E_2 with the normal n(u, v), and unit directions w_D and w_y to the
//! ends, the half vector H = eta_D w_D + eta_y w_y is parallel to n. The residual is the part of H that is
//! perpendicular to n, in the coordinates of the edges:
//!
//!   g_i = (H - (H.n) n) . E_i.
//!
//! H is not normalised: where the indices are nearly the same, it is nearly 0 at the solution, and the
//! residual is still regular.

use glam::{DMat2, DVec2, DVec3};

use super::chain::Endpoint;
use super::cone_tree::Triangle;
use super::kind::Kind;

/// Maximum number of steps.
const STEPS: usize = 10;

/// Relative size of the residual, and of the step, at which a solution is accepted.
const TOLERANCE: f64 = 1e-11;

/// Triangles are split until the deviation of the residual from a linear function moves its zero by less than
/// this share of the triangle.
const NONLINEARITY: f64 = 0.05;

/// Maximum number of levels of splitting.
const MAX_SPLITS: usize = 6;

/// Barycentric distance from a triangle up to which the solution of the linear function starts Newton's method.
const MARGIN: f64 = 0.5;

/// Multiples of the shift of the zero by which it may lie farther outside.
const SHIFTS: f64 = 6.0;

/// Solutions of one triangle that are closer together in u and v are the same.
const SAME: f64 = 1e-7;

/// A triangle in f64.
#[derive(Clone, Copy, Debug)]
pub struct SmoothTriangle {
    /// P_0.
    pub corner: DVec3,
    /// E_1 and E_2.
    pub edges: [DVec3; 2],
    /// N_0, unnormalised like the following.
    pub normal: DVec3,
    /// M_1 and M_2.
    pub slopes: [DVec3; 2],
}

/// The conditions that a vertex fulfils.
#[derive(Clone, Copy, Debug)]
pub struct Conditions<'a> {
    /// D.
    start: DVec3,
    /// y.
    end: &'a Endpoint,
    /// eta_D and eta_y; equal for reflection.
    indices: [f64; 2],
    /// 1 if D is on the side of the normal, -1 if it is on the other one.
    side: f64,
    /// 1 if y is on the same side as D (reflection), -1 if it is not.
    end_side: f64,
}

impl<'a> Conditions<'a> {
    /// Those of a vertex of this kind.
    pub fn new(start: DVec3, end: &'a Endpoint, kind: &Kind) -> Self {
        Self {
            start,
            end,
            indices: kind.indices.map(f64::from),
            side: f64::from(kind.side),
            end_side: f64::from(kind.side * kind.end_side()),
        }
    }

    /// g at (u, v).
    #[inline]
    fn residual(&self, triangle: &SmoothTriangle, uv: DVec2) -> DVec2 {
        let point = triangle.point(uv);
        let normal = triangle.normal(uv);
        let to_start = (self.start - point).normalize();
        let (to_end, _) = self.end.from(point);
        let h = self.indices[0] * to_start + self.indices[1] * to_end;
        let across = h - normal * (h.dot(normal) / normal.length_squared());
        DVec2::new(across.dot(triangle.edges[0]), across.dot(triangle.edges[1]))
    }

    /// g at (u, v), and its Jacobian.
    #[inline]
    fn residual_and_jacobian(&self, triangle: &SmoothTriangle, uv: DVec2) -> (DVec2, DMat2) {
        let SmoothTriangle { edges, slopes, .. } = triangle;
        let point = triangle.point(uv);
        let normal = triangle.normal(uv);
        let inverse_length = normal.length().recip();
        let n = normal * inverse_length;
        let to_start = self.start - point;
        let start_distance = to_start.length();
        let to_start = to_start / start_distance;
        let (to_end, end_distance) = self.end.from(point);
        let h = self.indices[0] * to_start + self.indices[1] * to_end;
        let hn = h.dot(n);
        let ne = DVec2::new(n.dot(edges[0]), n.dot(edges[1]));
        let g = DVec2::new(h.dot(edges[0]), h.dot(edges[1])) - hn * ne;
        let factors = [
            self.indices[0] / start_distance,
            self.indices[1] / end_distance,
        ];
        let column = |i: usize| {
            let edge = edges[i];
            let dh = -(factors[0] * (edge - to_start * to_start.dot(edge))
                + factors[1] * (edge - to_end * to_end.dot(edge)));
            let dn = (slopes[i] - n * n.dot(slopes[i])) * inverse_length;
            let dhn = dh.dot(n) + h.dot(dn);
            let part = |k: usize| dh.dot(edges[k]) - dhn * ne[k] - hn * dn.dot(edges[k]);
            DVec2::new(part(0), part(1))
        };
        (g, DMat2::from_cols(column(0), column(1)))
    }

    /// True if D and y are on the sides of the shading normal that the conditions demand.
    #[inline]
    fn sides_hold(&self, triangle: &SmoothTriangle, uv: DVec2) -> bool {
        let point = triangle.point(uv);
        let normal = triangle.normal(uv) * self.side;
        let (to_end, _) = self.end.from(point);
        (self.start - point).dot(normal) > 0.0 && to_end.dot(normal) * self.end_side > 0.0
    }

    /// Newton's method from `uv`; the solution if it lies in the triangle.
    fn newton(&self, triangle: &SmoothTriangle, mut uv: DVec2) -> Option<DVec2> {
        for _ in 0..STEPS {
            let (g, jacobian) = self.residual_and_jacobian(triangle, uv);
            let step = solve(jacobian, g)?;
            let length = step.length();
            // Far outside the triangle, normals mean nothing.
            uv -= step * (1.0_f64).min(1.0 / length);
            if uv.x < -1.0 || uv.y < -1.0 || uv.x + uv.y > 2.0 {
                return None;
            }
            if length < TOLERANCE {
                break;
            }
        }
        let inside = uv.x >= 0.0 && uv.y >= 0.0 && uv.x + uv.y <= 1.0;
        if !inside || !self.sides_hold(triangle, uv) {
            return None;
        }
        let (g, jacobian) = self.residual_and_jacobian(triangle, uv);
        (solve(jacobian, g)?.length() < 1e-6).then_some(uv)
    }

    /// Calls `visit` with the vertices on `triangle` that fulfil the conditions.
    pub fn solve(&self, triangle: &SmoothTriangle, visit: impl FnMut(DVec3)) {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
        let values = corners.map(|uv| self.residual(triangle, uv));
        let mut found = Found::default();
        self.search(triangle, corners, values, 0, &mut found);
        found.visit(triangle, visit);
    }

    /// As [`Self::solve`], from `n` (n + 1) / 2 starts.
    #[cfg(test)]
    pub fn solve_by_brute_force(
        &self,
        triangle: &SmoothTriangle,
        n: usize,
        visit: impl FnMut(DVec3),
    ) {
        let mut found = Found::default();
        for i in 0..n {
            for j in 0..n - i {
                let start = DVec2::new(i as f64 + 0.33, j as f64 + 0.33) / n as f64;
                if let Some(uv) = self.newton(triangle, start) {
                    found.add(uv);
                }
            }
        }
        found.visit(triangle, visit);
    }

    fn search(
        &self,
        triangle: &SmoothTriangle,
        corners: [DVec2; 3],
        values: [DVec2; 3],
        level: usize,
        found: &mut Found,
    ) {
        let spans = [values[1] - values[0], values[2] - values[0]];
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let mean = (values[0] + values[1] + values[2]) / 3.0;
        let deviation = self.residual(triangle, centre) - mean;
        // Zero cannot lie in the image if the residual is everywhere far from it.
        let range = spans[0].length().max(spans[1].length());
        if mean.length() > 2.0 * range + 8.0 * deviation.length() {
            return;
        }
        let linear = DMat2::from_cols(spans[0], spans[1]);
        // The zero of a linear function through the corners, and by how much the deviation from it moves that.
        let zero = solve(linear, -values[0]).map(|local| (local, solve(linear, deviation)));
        let split = match zero {
            Some((local, Some(shift))) => {
                let shift = shift.length();
                let outside = (-local.x).max(-local.y).max(local.x + local.y - 1.0);
                if outside > MARGIN + SHIFTS * shift {
                    return;
                }
                shift > NONLINEARITY
            }
            _ => true,
        };
        if split && level < MAX_SPLITS {
            self.split(triangle, corners, values, level, found);
            return;
        }
        let Some((local, _)) = zero else { return };
        let slopes = [corners[1] - corners[0], corners[2] - corners[0]];
        let start = corners[0] + slopes[0] * local.x + slopes[1] * local.y;
        if let Some(uv) = self.newton(triangle, start) {
            found.add(uv);
        }
    }

    fn split(
        &self,
        triangle: &SmoothTriangle,
        corners: [DVec2; 3],
        values: [DVec2; 3],
        level: usize,
        found: &mut Found,
    ) {
        let [a, b, c] = corners;
        let middles = [0.5 * (b + c), 0.5 * (c + a), 0.5 * (a + b)];
        let at_middles = middles.map(|uv| self.residual(triangle, uv));
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.search(
                triangle,
                [corners[i], middles[k], middles[j]],
                [values[i], at_middles[k], at_middles[j]],
                level + 1,
                found,
            );
        }
        self.search(triangle, middles, at_middles, level + 1, found);
    }
}

/// x with `matrix` x = `right`; `None` if the matrix is singular.
#[inline]
fn solve(matrix: DMat2, right: DVec2) -> Option<DVec2> {
    let determinant = matrix.determinant();
    let scale = matrix.x_axis.length() * matrix.y_axis.length();
    (determinant.abs() > 1e-14 * scale).then(|| matrix.inverse() * right)
}

/// The distinct solutions on one triangle.
#[derive(Default)]
struct Found {
    solutions: [DVec2; 8],
    count: usize,
}

impl Found {
    fn solutions(&self) -> &[DVec2] {
        &self.solutions[..self.count]
    }

    /// Calls `visit` with every vertex found.
    fn visit(&self, triangle: &SmoothTriangle, mut visit: impl FnMut(DVec3)) {
        for uv in self.solutions() {
            visit(triangle.point(*uv));
        }
    }

    fn add(&mut self, uv: DVec2) {
        let is_new = self.solutions().iter().all(|s| s.distance(uv) > SAME);
        if is_new && self.count < self.solutions.len() {
            self.solutions[self.count] = uv;
            self.count += 1;
        }
    }
}

impl From<&Triangle> for SmoothTriangle {
    fn from(triangle: &Triangle) -> Self {
        let [p0, p1, p2] = triangle
            .corners
            .map(|p| DVec3::from_array(p.map(f64::from)));
        let [n0, n1, n2] = triangle
            .normals
            .map(|n| DVec3::from_array(n.map(f64::from)));
        Self {
            corner: p0,
            edges: [p1 - p0, p2 - p0],
            normal: n0,
            slopes: [n1 - n0, n2 - n0],
        }
    }
}

impl SmoothTriangle {
    /// P(u, v).
    #[inline]
    pub fn point(&self, uv: DVec2) -> DVec3 {
        self.corner + self.edges[0] * uv.x + self.edges[1] * uv.y
    }

    /// N(u, v).
    #[inline]
    pub fn normal(&self, uv: DVec2) -> DVec3 {
        self.normal + self.slopes[0] * uv.x + self.slopes[1] * uv.y
    }
}
