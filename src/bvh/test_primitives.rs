//! Primitives and random numbers for tests.

use glam::Vec3A;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Corners, Primitive, RADIUS, Sphere, Triangle};

/// Vertices, and the indices of the corners of each triangle.
pub type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// A closed wavy sphere of 2 n (n - 1) triangles, its radius between 0.8 and 1.2: a grid
/// wrapped around, all vertices shared, with a fan of triangles at either pole.
pub fn blob(n: u32) -> Mesh {
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for j in 1..n {
        for i in 0..n {
            let theta = std::f32::consts::PI * j as f32 / n as f32;
            let phi = std::f32::consts::TAU * i as f32 / n as f32;
            let r = 1.0 + 0.2 * (3.0 * phi).sin() * theta.sin() * (5.0 * theta).cos();
            positions.push([
                r * theta.sin() * phi.cos(),
                r * theta.sin() * phi.sin(),
                r * theta.cos(),
            ]);
        }
    }
    positions.push([0.0, 0.0, -1.0]);
    let last = positions.len() as u32 - 1;
    let at = |j: u32, i: u32| 1 + (j - 1) * n + i % n;
    let mut triangles = Vec::new();
    for i in 0..n {
        triangles.push([0, at(1, i), at(1, i + 1)]);
        triangles.push([last, at(n - 1, i + 1), at(n - 1, i)]);
        for j in 1..n - 1 {
            triangles.push([at(j, i), at(j + 1, i), at(j + 1, i + 1)]);
            triangles.push([at(j, i), at(j + 1, i + 1), at(j, i + 1)]);
        }
    }
    (positions, triangles)
}

/// A square grid of `n` by `n` cells, [-1, 1]^2 in the plane z = 0.
pub fn grid(n: u32) -> Mesh {
    let mut positions = Vec::new();
    let coordinate = |i: u32| i as f32 / (n as f32 / 2.0) - 1.0;
    for j in 0..=n {
        positions.extend((0..=n).map(|i| [coordinate(i), coordinate(j), 0.0]));
    }
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let v = j * (n + 1) + i;
            triangles.push([v, v + 1, v + n + 2]);
            triangles.push([v, v + n + 2, v + n + 1]);
        }
    }
    (positions, triangles)
}

/// The cube [-1, 1]^3, two triangles to a face.
pub fn cube() -> Vec<Corners> {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |u: f32, v: f32| {
                let mut corner = [side; 3];
                corner[(axis + 1) % 3] = u;
                corner[(axis + 2) % 3] = v;
                corner
            };
            let [a, b] = [corner(-1.0, -1.0), corner(1.0, -1.0)];
            let [c, d] = [corner(1.0, 1.0), corner(-1.0, 1.0)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

/// A triangle of shape 0.
pub fn triangle(corners: Corners) -> Primitive {
    Primitive::Triangle(Triangle {
        corners,
        shape: 0,
        vertices: [0, 1, 2],
    })
}

/// A sphere of shape 0.
pub fn sphere(center: Vec3A, radius: f32) -> Primitive {
    Primitive::Sphere(Sphere {
        center: center.to_array(),
        radius,
        shape: 0,
    })
}

/// The triangles of a mesh whose vertices are moved by `place`.
pub fn mesh((positions, triangles): &Mesh, place: impl Fn(Vec3A) -> Vec3A) -> Vec<Primitive> {
    let corner = |v: u32| place(Vec3A::from_array(positions[v as usize])).to_array();
    triangles
        .iter()
        .map(|vertices| triangle(vertices.map(corner)))
        .collect()
}

/// The primitives scaled such that the farthest point is at [`RADIUS`] from the origin.
pub fn scaled_to_radius(mut primitives: Vec<Primitive>) -> Vec<Primitive> {
    let length = |p: [f32; 3]| Vec3A::from_array(p).length();
    let farthest = primitives.iter().fold(0.0_f32, |farthest, primitive| {
        farthest.max(match primitive {
            Primitive::Triangle(t) => t.corners.map(length).into_iter().fold(0.0, f32::max),
            Primitive::Sphere(s) => length(s.center) + s.radius,
        })
    });
    let scale = RADIUS / farthest;
    for primitive in &mut primitives {
        match primitive {
            Primitive::Triangle(t) => t.corners = t.corners.map(|p| p.map(|x| x * scale)),
            Primitive::Sphere(s) => {
                s.center = s.center.map(|x| x * scale);
                s.radius *= scale;
            }
        }
    }
    primitives
}

/// Reproducible random numbers.
pub struct Numbers(Xoshiro256PlusPlus);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    pub fn unit(&mut self) -> f32 {
        self.0.random()
    }

    pub fn index(&mut self, n: usize) -> usize {
        self.0.random_range(0..n)
    }

    pub fn pair(&mut self) -> glam::Vec2 {
        glam::Vec2::new(self.unit(), self.unit())
    }

    /// Uniform in [-1, 1]^3.
    pub fn cube(&mut self) -> Vec3A {
        2.0 * Vec3A::new(self.unit(), self.unit(), self.unit()) - 1.0
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3A {
        let u = self.pair();
        let z = 1.0 - 2.0 * u.x;
        let r = (4.0 * u.x * (1.0 - u.x)).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (std::f32::consts::TAU * u.y).sin_cos();
        Vec3A::new(r * cos_phi, r * sin_phi, z).normalize()
    }
}
