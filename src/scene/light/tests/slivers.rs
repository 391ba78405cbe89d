//! Meshes whose triangles differ by much in area: those that own less than one random number.

use glam::Vec2;

use super::*;

/// Triangles too small to be chosen in proportion: the share of each is 0.6 to 1.4 times 2^-24.
const SLIVERS: usize = 1600;

/// Random numbers in [0, 1).
const NUMBERS: u32 = 1 << 24;

/// A right triangle of area 1 in x < 0 facing +z, slivers in x > 0, and a mote within the triangle.
fn dust() -> TriangleMesh {
    let mut mesh = TriangleMesh {
        positions: vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-2.0, 0.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..TriangleMesh::default()
    };
    for i in 0..SLIVERS {
        let area = (0.6 + 0.8 * i as f32 / SLIVERS as f32) / NUMBERS as f32;
        let (long, first) = (5e-3, mesh.positions.len() as u32);
        let [x, y] = [(i % 40 + 1) as f32 * 0.02, (i / 40) as f32 * 0.02];
        let corner = |dx: f32, dy: f32| [x + dx, y + dy, 0.0];
        let corners = [(0.0, 0.0), (long, 0.0), (0.0, 2.0 * area / long)];
        mesh.positions
            .extend(corners.map(|(dx, dy)| corner(dx, dy)));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    // At the centre of the scene, where f32 can tell its corners apart.
    let corners = [(0.0, 0.0), (1e-6, 0.0), (0.0, 5e-7)];
    let first = mesh.positions.len() as u32;
    mesh.positions
        .extend(corners.map(|(dx, dy)| [-0.5975 + dx, 0.5 + dy, 0.0]));
    mesh.triangles.push([first, first + 1, first + 2]);
    mesh
}

/// The area of a part of the emitter is the mean of 1/density over the samples in it. Exact: every
/// random number chooses a triangle once. The mote is not sampled: one random number would be so
/// much more than its due that its density could leave the range of f32.
#[test]
fn triangles_are_sampled_with_the_density_that_is_claimed() {
    let scene = scene(
        vec![emitting(mesh(dust(), DMat4::IDENTITY), RADIANCE)],
        vec![],
    );
    let place = Vec2::splat(0.3);
    let border = to_scene(&scene, DVec3::ZERO).x;
    assert_eq!(scene.geometry.triangle_count(), SLIVERS + 2);
    let (mut slivers, mut whole, mut densest) = (0.0, 0.0, 0.0_f32);
    for number in 0..NUMBERS {
        let part = number as f32 / NUMBERS as f32;
        let sample = scene.emitters.sample_emission(0.5, part, place, place);
        let sample = sample.expect("a start");
        let area = scene.unit * scene.unit / f64::from(NUMBERS) / f64::from(sample.pdf_position);
        whole += area;
        densest = densest.max(sample.pdf_position);
        if sample.position.x > border {
            slivers += area;
        }
    }
    let expected = SLIVERS as f64 / f64::from(NUMBERS);
    // f32 rounds the corners of slivers.
    assert!(
        (slivers / expected - 1.0).abs() < 1e-3,
        "{slivers} {expected}"
    );
    assert!((whole - 1.0 - expected).abs() < 1e-6, "{whole}");
    let uniform = (scene.unit * scene.unit) as f32;
    assert!(densest < 4.0 * uniform, "{densest} {uniform}");
}

/// A ray that hits a triangle is told the densities with which a point of it is sampled, for direct
/// light and for the start of a light subpath.
#[test]
fn hits_know_the_density_of_their_triangle() {
    let scene = scene(
        vec![emitting(mesh(dust(), DMat4::IDENTITY), RADIANCE)],
        vec![],
    );
    let point = to_scene(&scene, DVec3::new(0.4, 0.5, 1.0));
    let place = Vec2::splat(0.4);
    let mut compared = 0;
    let mut last = 0.0;
    // The slivers own the first random numbers or the last: the great triangle is in one piece.
    for number in (0..4096).chain(NUMBERS - 4096..NUMBERS) {
        let part = number as f32 / NUMBERS as f32;
        let start = scene.emitters.sample_emission(0.5, part, place, place);
        let start = start.expect("a start");
        if start.pdf_position == last {
            continue;
        }
        last = start.pdf_position;
        compared += 1;
        let direct = scene.emitters.sample_direct(point, 0.5, part, place);
        let direct = direct.expect("a point on the emitter");
        let (met, _) = light_met(&scene, point, direct.direction).expect("a hit");
        for (what, pdf) in [
            ("direct, sampled", direct.emission.pdf_direct),
            ("direct, met", met.pdf_direct),
            ("position, of direct light", direct.emission.pdf_position),
            ("position, met", met.pdf_position),
            (
                "direct, of a start",
                scene.emitters.direct_pdf(&start, point),
            ),
        ] {
            assert_eq!(pdf, start.pdf_position, "{what}");
        }
    }
    assert!(compared > SLIVERS / 2, "{compared}");
}
