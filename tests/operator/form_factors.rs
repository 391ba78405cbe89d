//! Form factors from a point to rectangles that one box may occlude, in closed form and f64: Lambert's
//! formula for polygons minus the occluded part, by polygon clipping. No ray is traced.

use glam::DVec3;

/// A rectangle `corner` + [0, 1] `a` + [0, 1] `b` that faces along a x b.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    pub corner: DVec3,
    pub a: DVec3,
    pub b: DVec3,
}

impl Rectangle {
    pub fn normal(&self) -> DVec3 {
        self.a.cross(self.b).normalize()
    }

    pub fn at(&self, u: f64, v: f64) -> DVec3 {
        self.corner + self.a * u + self.b * v
    }

    fn corners(&self) -> [DVec3; 4] {
        [
            self.at(0.0, 0.0),
            self.at(1.0, 0.0),
            self.at(1.0, 1.0),
            self.at(0.0, 1.0),
        ]
    }

    /// True if `point` is in front of the rectangle's plane, and not on it.
    pub fn faces(&self, point: DVec3) -> bool {
        (point - self.corner).dot(self.normal()) > 1e-9
    }
}

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    pub position: DVec3,
    pub normal: DVec3,
}

/// A convex polygon: clipping a rectangle by four planes leaves at most eight corners.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [DVec3; 8],
    len: usize,
}

impl Polygon {
    /// A rectangle as seen from `origin`.
    fn new(rectangle: &Rectangle, origin: DVec3) -> Self {
        let mut corners = [DVec3::ZERO; 8];
        for (to, from) in corners.iter_mut().zip(rectangle.corners()) {
            *to = from - origin;
        }
        Self { corners, len: 4 }
    }

    fn edges(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        (0..self.len).map(|i| (self.corners[i], self.corners[(i + 1) % self.len]))
    }

    /// The part where `plane` . p >= 0 (Sutherland and Hodgman 1974, "Reentrant polygon clipping").
    fn clip(&self, plane: DVec3) -> Self {
        let mut out = Self {
            corners: [DVec3::ZERO; 8],
            len: 0,
        };
        for (p, q) in self.edges() {
            let (at_p, at_q) = (plane.dot(p), plane.dot(q));
            if at_p >= 0.0 {
                out.push(p);
            }
            if (at_p >= 0.0) != (at_q >= 0.0) {
                out.push(p + (q - p) * (at_p / (at_p - at_q)));
            }
        }
        out
    }

    fn push(&mut self, p: DVec3) {
        self.corners[self.len] = p;
        self.len += 1;
    }

    /// The form factor from the origin, with normal `n`, to this polygon above its horizon:
    /// 1/(2 pi) sum of the angles that the edges subtend, each times the cosine of its plane's
    /// normal with n (Lambert 1760; Baum et al. 1989, "Improving radiosity solutions through the use
    /// of analytically determined form-factors", eq. 7).
    fn form_factor(&self, n: DVec3) -> f64 {
        let sum: f64 = self
            .edges()
            .map(|(p, q)| {
                let normal = p.cross(q);
                let length = normal.length();
                if length == 0.0 {
                    return 0.0;
                }
                // The angle from sine and cosine: exact for small ones too.
                length.atan2(p.dot(q)) * normal.dot(n) / length
            })
            .sum();
        sum.abs() / std::f64::consts::TAU
    }
}

/// The form factor from `to` to the part of `patch` that the convex box of `box_faces` does not occlude.
/// The box is nowhere behind a patch, and either does not cross the horizon of `to` or has it on a face.
pub fn form_factor(to: Receiver, patch: &Rectangle, box_faces: &[Rectangle]) -> f64 {
    let centre = patch.at(0.5, 0.5) - to.position;
    if !patch.faces(to.position) || centre.dot(to.normal) <= 1e-9 {
        return 0.0;
    }
    let polygon = Polygon::new(patch, to.position);
    let mut factor = polygon.form_factor(to.normal);
    // Faces of the box visible from a point do not overlap. A patch on the box lies in the plane of a
    // face and is never occluded.
    let normal = patch.normal();
    for face in box_faces.iter().filter(|face| face.faces(to.position)) {
        if face.normal() == normal && (face.corner - patch.corner).dot(normal).abs() < 1e-9 {
            return polygon.form_factor(to.normal);
        }
        let mut hidden = Polygon::new(face, to.position);
        for (p, q) in polygon.edges() {
            let plane = p.cross(q);
            hidden = hidden.clip(plane * plane.dot(centre).signum());
        }
        factor -= hidden.form_factor(to.normal);
    }
    // The form factor of an occluded patch is 0 up to rounding.
    factor.max(0.0)
}
