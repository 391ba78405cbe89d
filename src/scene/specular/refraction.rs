//! Refraction at one or two planes between two given ends. The points minimise the optical length (Fermat), sum
//! eta |x_{k+1} - x_k|, which is convex in the points on the planes.

use arrayvec::ArrayVec;
use glam::{DMat4, DVec2, DVec3, DVec4};

use super::chain::Endpoint;
use super::plane::Plane;

/// Distance in scene units below which the points of two planes are at the edge where these meet, at which the
/// optical length has its minimum if there is no chain.
const AT_EDGE: f64 = 1e-6 * crate::scene::SCENE_RADIUS as f64;

/// Size of a step, in scene units, at which an iteration ends.
const MIN_STEP: f64 = 1e-11 * crate::scene::SCENE_RADIUS as f64;

/// Maximum number of Newton steps.
const STEPS: usize = 64;

/// The point of a plane where light from `start` is refracted toward `end`; `None` if they are on one side.
pub fn refract_once(
    start: DVec3,
    end: &Endpoint,
    plane: &Plane,
    [eta_start, eta_end]: [f64; 2],
) -> Option<DVec3> {
    let height = plane.distance(start);
    let foot = start - plane.normal * height;
    let (start_height, side) = (height.abs(), height.signum());
    let end_height = -side * plane.side_of(end);
    if !(start_height > 0.0 && end_height > 0.0) {
        return None;
    }
    let across = match end {
        Endpoint::Point { position, .. } => *position - foot,
        Endpoint::Direction(direction) => *direction,
    };
    let across = across - plane.normal * plane.normal.dot(across);
    let length = across.length();
    if length == 0.0 {
        return Some(foot);
    }
    let lateral = across / length;
    let offset = match end {
        Endpoint::Direction(_) => {
            let sin = eta_end * length / eta_start;
            if sin >= 1.0 {
                return None;
            }
            start_height * sin / (1.0 - sin * sin).sqrt()
        }
        Endpoint::Point { .. } => {
            // Increasing in x, and convex below and concave above its inflection: bracketed Newton.
            let f = |x: f64| {
                let y = length - x;
                let a = (x * x + start_height * start_height).sqrt();
                let b = (y * y + end_height * end_height).sqrt();
                let value = eta_start * x / a - eta_end * y / b;
                let slope = eta_start * start_height * start_height / (a * a * a)
                    + eta_end * end_height * end_height / (b * b * b);
                (value, slope)
            };
            let (mut low, mut high) = (0.0, length);
            let mut x = length * start_height / (start_height + end_height);
            for _ in 0..STEPS {
                let (value, slope) = f(x);
                if value > 0.0 {
                    high = x;
                } else {
                    low = x;
                }
                let newton = x - value / slope;
                let next = if newton > low && newton < high {
                    newton
                } else {
                    0.5 * (low + high)
                };
                if (next - x).abs() <= 1e-12 * length {
                    break;
                }
                x = next;
            }
            x
        }
    };
    Some(foot + lateral * offset)
}

/// The points of two planes where light from `start` is refracted toward `end`, by minimising the optical
/// length with Newton's method.
pub fn refract_twice(
    start: DVec3,
    end: &Endpoint,
    planes: [Plane; 2],
    indices: [f64; 3],
) -> Option<ArrayVec<DVec3, 2>> {
    // Directions inside lie within the critical angle of both normals.
    let inner = indices[1];
    if inner > indices[0] && inner > indices[2] {
        let critical = (indices[0] / inner).asin() + (indices[2] / inner).asin();
        let sides = [planes[0].distance(start), -planes[1].side_of(end)].map(f64::signum);
        let cos = planes[0].normal.dot(planes[1].normal) * sides[0] * sides[1];
        if cos.clamp(-1.0, 1.0).acos() > critical {
            return None;
        }
    }
    let frames = planes.map(|plane| {
        let (s, t) = plane.normal.any_orthonormal_pair();
        [s, t]
    });
    // Start on the straight line between the ends.
    let (toward, _) = end.from(start);
    let crossing = |plane: &Plane| {
        let along = plane.normal.dot(toward);
        let distance = -plane.distance(start) / along;
        if distance > 0.0 && distance.is_finite() {
            start + toward * distance
        } else {
            start - plane.normal * plane.distance(start)
        }
    };
    let mut points = [crossing(&planes[0]), crossing(&planes[1])];
    let length = |points: &[DVec3; 2]| {
        let tail = match end {
            Endpoint::Point { position, .. } => position.distance(points[1]),
            Endpoint::Direction(direction) => -direction.dot(points[1]),
        };
        indices[0] * points[0].distance(start)
            + indices[1] * points[1].distance(points[0])
            + indices[2] * tail
    };
    let mut current = length(&points);
    for _ in 0..STEPS {
        let (w0, d0) = direction(start, points[0])?;
        let (w1, d1) = direction(points[0], points[1])?;
        if d1 < AT_EDGE {
            return None;
        }
        let (w2, d2) = end.from(points[1]);
        let gradients = [
            indices[0] * w0 - indices[1] * w1,
            indices[1] * w1 - indices[2] * w2,
        ];
        let g = [0, 1].map(|k| frames[k].map(|axis| axis.dot(gradients[k])));
        // Second derivatives of the three segments.
        let second =
            |w: DVec3, scale: f64, a: DVec3, b: DVec3| (a.dot(b) - a.dot(w) * b.dot(w)) * scale;
        let [k0, k1, k2] = [indices[0] / d0, indices[1] / d1, indices[2] / d2];
        let mut hessian = [[0.0; 4]; 4];
        for i in 0..4 {
            for j in 0..4 {
                let (a, b) = (frames[i / 2][i % 2], frames[j / 2][j % 2]);
                hessian[i][j] = match (i / 2, j / 2) {
                    (0, 0) => second(w0, k0, a, b) + second(w1, k1, a, b),
                    (1, 1) => second(w1, k1, a, b) + second(w2, k2, a, b),
                    _ => -second(w1, k1, a, b),
                };
            }
        }
        let step = solve_4(hessian, [g[0][0], g[0][1], g[1][0], g[1][1]])?;
        let moves = [DVec2::new(step[0], step[1]), DVec2::new(step[2], step[3])];
        let size = moves[0].length() + moves[1].length();
        let mut factor = 1.0;
        loop {
            let next = [0, 1].map(|k: usize| {
                points[k] - (frames[k][0] * moves[k].x + frames[k][1] * moves[k].y) * factor
            });
            let at_next = length(&next);
            if at_next <= current || factor * size < MIN_STEP {
                (points, current) = (next, at_next);
                break;
            }
            factor *= 0.5;
        }
        if size < MIN_STEP {
            return Some(points.into_iter().collect());
        }
    }
    None
}

/// Unit direction and distance; `None` if the points coincide.
fn direction(from: DVec3, to: DVec3) -> Option<(DVec3, f64)> {
    let distance = from.distance(to);
    (distance > 0.0).then(|| ((to - from) / distance, distance))
}

/// x with M x = `right` for the symmetric matrix M of these rows; `None` if M is singular.
fn solve_4(rows: [[f64; 4]; 4], right: [f64; 4]) -> Option<[f64; 4]> {
    let matrix = DMat4::from_cols_array_2d(&rows);
    let inverse = matrix.inverse();
    inverse
        .is_finite()
        .then(|| (inverse * DVec4::from_array(right)).to_array())
}
