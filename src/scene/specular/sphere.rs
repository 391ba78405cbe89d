//! Chains through one sphere, complete: all vertices lie in the plane of the two end points and the centre,
//! so that one unknown remains.
//!
//! Let q = n sin(theta) R be the invariant of Snell's law along a ray that meets a sphere of radius R: the
//! index times the distance of the ray's line from the centre is the same inside and outside. Seen from the
//! centre, the ray sweeps the angle
//!
//!   sweep(q) = a_D(q) + c (pi - 2 r(q)) + a_y(q),   sin r = q / (n_in R),   sin i = q / (n_out R),
//!
//! where c counts the chords inside between the first and the last vertex, and a(q) is the angle from an end
//! at distance d to the vertex next to it:
//!
//!   outside:  i - asin(q / (n_out d))
//!   inside:   asin(q / (n_in d)) - r,  or  pi - asin(q / (n_in d)) - r.
//!
//! Chains are the q with sweep(q) = +-phi (mod 2 pi), where phi is the angle between the ends. Between
//! stationary points of the sweep there is at most one for each right-hand side. With q = q_max sin x the
//! sweep is smooth in x.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::chain::{Candidate, Endpoint, Lobes};
use super::route::Route;
use crate::scene::bsdf::DeltaLobe::{self, Reflection, Transmission};

/// Intervals in which stationary points of the sweep are sought.
const INTERVALS: usize = 12;

/// Steps of a bisection.
const BISECTIONS: usize = 48;

/// Step in x at which a root is accepted.
const ROOT_TOLERANCE: f64 = 1e-12;

/// Distance from x = pi / 2 at which the slope is evaluated last: there it is 0 / 0.
const X_MARGIN: f64 = 1e-4;

/// A sphere that reflects or refracts without roughness.
#[derive(Clone, Copy, Debug)]
pub struct SphereCaster {
    pub center: DVec3,
    pub radius: f64,
    pub shape: u32,
    /// Index of refraction of the inside of the sphere over that of its outside; `None` if it only reflects.
    pub eta: Option<f64>,
}

/// The angle from an end of a chain to the vertex next to it.
#[derive(Clone, Copy)]
enum End {
    /// At this distance from the centre, or at infinity.
    Outside(f64),
    /// At this distance from the centre; the ray to the vertex goes away from the centre, or first past it.
    Inside { distance: f64, past: bool },
}

/// The sweep of one kind of chain.
struct Sweep {
    ends: [End; 2],
    /// c.
    chords: f64,
    radius: f64,
    /// Index of the inside; that of the outside is 1.
    eta: f64,
    q_max: f64,
}

impl Sweep {
    fn new(ends: [End; 2], chords: usize, radius: f64, eta: f64) -> Self {
        let touches_outside = ends.iter().any(|end| matches!(end, End::Outside(_)));
        let touches_inside = chords > 0 || ends.iter().any(|end| matches!(end, End::Inside { .. }));
        let mut q_max = f64::INFINITY;
        if touches_outside {
            q_max = q_max.min(radius);
        }
        if touches_inside {
            q_max = q_max.min(eta * radius);
        }
        for end in &ends {
            if let End::Inside { distance, .. } = end {
                q_max = q_max.min(eta * distance);
            }
        }
        Self {
            ends,
            chords: chords as f64,
            radius,
            eta,
            q_max,
        }
    }

    /// The angle from an end to its vertex.
    fn angle(&self, end: End, q: f64) -> f64 {
        let asin = |x: f64| x.min(1.0).asin();
        match end {
            End::Outside(distance) => asin(q / self.radius) - asin(q / distance),
            End::Inside { distance, past } => {
                let at_end = asin(q / (self.eta * distance));
                let at_end = if past { PI - at_end } else { at_end };
                at_end - asin(q / (self.eta * self.radius))
            }
        }
    }

    /// The sweep at x.
    fn at(&self, x: f64) -> f64 {
        let q = self.q_max * x.sin();
        let ends = self.angle(self.ends[0], q) + self.angle(self.ends[1], q);
        if self.chords == 0.0 {
            return ends;
        }
        let r = (q / (self.eta * self.radius)).min(1.0).asin();
        ends + self.chords * (PI - 2.0 * r)
    }

    /// Derivative of the sweep with respect to x; x < pi / 2.
    fn slope(&self, x: f64) -> f64 {
        let (sin, cos) = x.sin_cos();
        let (q, dq) = (self.q_max * sin, self.q_max * cos);
        // Of asin(q / k).
        let asin = |k: f64| dq / (k * k - q * q).max(f64::MIN_POSITIVE).sqrt();
        let angle = |end: End| match end {
            End::Outside(distance) => asin(self.radius) - asin(distance),
            End::Inside { distance, past } => {
                let at_end = asin(self.eta * distance);
                let at_end = if past { -at_end } else { at_end };
                at_end - asin(self.eta * self.radius)
            }
        };
        let ends = angle(self.ends[0]) + angle(self.ends[1]);
        if self.chords == 0.0 {
            ends
        } else {
            ends - 2.0 * self.chords * asin(self.eta * self.radius)
        }
    }

    /// Calls `visit` with every q in (0, q_max) whose sweep is +-`phi` (mod 2 pi), and the sign.
    fn solve(&self, phi: f64, mut visit: impl FnMut(f64, f64)) {
        let mut piece = |from: [f64; 2], to: [f64; 2]| {
            for sign in [1.0, -1.0] {
                let (low, high) = (from[1].min(to[1]), from[1].max(to[1]));
                let turns = ((low - sign * phi) / TAU).ceil();
                let mut wanted = sign * phi + TAU * turns;
                while wanted <= high {
                    let miss = |x: f64| self.at(x) - wanted;
                    if let Some(x) = root(miss, |x| self.slope(x), from[0], to[0]) {
                        visit(self.q_max * x.sin(), sign);
                    }
                    wanted += TAU;
                }
            }
        };
        let mut from = [0.0, self.at(0.0)];
        let mut before = [0.0, self.slope(0.0)];
        for i in 1..=INTERVALS {
            let x = (FRAC_PI_2 - X_MARGIN) * i as f64 / INTERVALS as f64;
            let here = [x, self.slope(x)];
            if before[1] * here[1] < 0.0
                && let Some(turn) = bisect(|x| self.slope(x), before[0], x)
            {
                let to = [turn, self.at(turn)];
                piece(from, to);
                from = to;
            }
            before = here;
        }
        piece(from, [FRAC_PI_2, self.at(FRAC_PI_2)]);
    }
}

/// A root of a function between two points where its signs differ.
fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> Option<f64> {
    let (at_low, at_high) = (f(low), f(high));
    if at_low * at_high > 0.0 || at_low == 0.0 {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if f(middle) * at_low > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// The root of a monotone function between two points where its signs differ, by Newton's method, or by
/// bisection where that leaves the bracket.
fn root(
    f: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
    mut low: f64,
    mut high: f64,
) -> Option<f64> {
    let (at_low, at_high) = (f(low), f(high));
    if at_low * at_high > 0.0 || at_low == 0.0 {
        return None;
    }
    // The secant.
    let mut x = low - at_low * (high - low) / (at_high - at_low);
    for _ in 0..BISECTIONS {
        let value = f(x);
        if value * at_low > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope(x);
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - x).abs() < ROOT_TOLERANCE {
            return Some(next);
        }
        x = next;
    }
    Some(x)
}

impl SphereCaster {
    /// Calls `visit` with every chain from `start` to `end`.
    pub fn chains(&self, start: DVec3, end: &Endpoint, mut visit: impl FnMut(Candidate)) {
        let ends = Ends::new(self, start, end);
        for kind in self.kinds(ends.inside) {
            self.solve(&ends, kind, &mut visit);
        }
    }

    /// As [`Self::chains`] for those with the lobes of `route`.
    pub fn chains_along(
        &self,
        start: DVec3,
        end: &Endpoint,
        route: &Route,
        mut visit: impl FnMut(Candidate),
    ) {
        let ends = Ends::new(self, start, end);
        let lobes = route.lobes.as_slice();
        for kind in self.kinds(ends.inside).filter(|&kind| kind == lobes) {
            self.solve(&ends, kind, &mut visit);
        }
    }

    /// The lobes of all kinds of chains between ends that are `inside` the sphere or not.
    fn kinds(&self, inside: [bool; 2]) -> impl Iterator<Item = &'static [DeltaLobe]> {
        const R: DeltaLobe = Reflection;
        const T: DeltaLobe = Transmission;
        let (reflected, refracted): (&[&[DeltaLobe]], &[&[DeltaLobe]]) = match inside {
            [false, false] => (&[&[R]], &[&[T, T], &[T, R, T]]),
            [true, true] => (&[&[R], &[R, R], &[R, R, R]], &[]),
            [true, false] => (&[], &[&[T], &[R, T], &[R, R, T]]),
            [false, true] => (&[], &[&[T], &[T, R], &[T, R, R]]),
        };
        let refracted = self.eta.map(|_| refracted).into_iter().flatten();
        reflected.iter().chain(refracted).copied()
    }

    /// Calls `visit` with every chain with these lobes.
    fn solve(&self, ends: &Ends, lobes: &[DeltaLobe], visit: &mut impl FnMut(Candidate)) {
        let eta = self.eta.unwrap_or(1.0);
        let [start_distance, end_distance] = ends.distances;
        for start_end in branches(start_distance, ends.inside[0]) {
            for end_end in branches(end_distance, ends.inside[1]) {
                let chords = lobes.len() - 1;
                let sweep = Sweep::new([start_end, end_end], chords, self.radius, eta);
                sweep.solve(ends.phi, |q, sign| {
                    let angle = sweep.angle(start_end, q);
                    let [e1, e2] = ends.axes;
                    let vertex = (e1 * angle.cos() + e2 * (sign * angle.sin())) * self.radius;
                    if let Some(direction) = (vertex - e1 * start_distance).try_normalize() {
                        visit(Candidate {
                            direction,
                            lobes: Lobes::new(lobes),
                            shape: self.shape,
                        });
                    }
                });
            }
        }
    }
}

/// The two ends of a chain in the plane of the ends and the centre.
struct Ends {
    /// Unit, from the centre to the start, and perpendicular to it.
    axes: [DVec3; 2],
    /// Angle between the ends.
    phi: f64,
    /// From the centre.
    distances: [f64; 2],
    /// Whether they are inside the sphere.
    inside: [bool; 2],
}

impl Ends {
    fn new(sphere: &SphereCaster, start: DVec3, end: &Endpoint) -> Self {
        let from_center = start - sphere.center;
        let start_distance = from_center.length();
        let (toward_end, end_distance) = end.from(sphere.center);
        let e1 = from_center / start_distance;
        let cos = e1.dot(toward_end).clamp(-1.0, 1.0);
        let across = toward_end - e1 * cos;
        let e2 = across
            .try_normalize()
            .unwrap_or_else(|| e1.any_orthonormal_vector());
        let distances = [start_distance, end_distance];
        Self {
            axes: [e1, e2],
            phi: across.length().atan2(cos),
            distances,
            inside: distances.map(|distance| distance < sphere.radius),
        }
    }
}

/// The ways in which a ray can leave an end at this distance from the centre.
fn branches(distance: f64, inside: bool) -> impl Iterator<Item = End> {
    let both = [false, true].map(|past| {
        if inside {
            Some(End::Inside { distance, past })
        } else {
            (!past).then_some(End::Outside(distance))
        }
    });
    both.into_iter().flatten()
}
