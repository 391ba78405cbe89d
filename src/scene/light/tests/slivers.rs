//! Meshes whose triangles differ so much in area that some have a probability below the resolution of
//! random numbers.

use glam::Vec2;

use super::*;

/// Number of triangles whose area is 0.6 to 1.4 times 2^-24 of the whole, too small for their
/// probabilities to be proportional to it.
const SLIVERS: usize = 1600;

/// Number of multiples of 2^-24 in [0, 1), the values of random numbers.
const RESOLUTION: u32 = 1 << 24;

/// A right triangle of area 1 in x < 0 facing +z, slivers in x > 0, and a minute triangle inside the first.
fn slivers() -> TriangleMesh {
    let mut mesh = TriangleMesh {
        positions: vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-2.0, 0.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..TriangleMesh::default()
    };
    for i in 0..SLIVERS {
        let area = (0.6 + 0.8 * i as f32 / SLIVERS as f32) / RESOLUTION as f32;
        let (long, first) = (5e-3, mesh.positions.len() as u32);
        let [x, y] = [(i % 40 + 1) as f32 * 0.02, (i / 40) as f32 * 0.02];
        let corner = |dx: f32, dy: f32| [x + dx, y + dy, 0.0];
        let corners = [(0.0, 0.0), (long, 0.0), (0.0, 2.0 * area / long)];
        mesh.positions
            .extend(corners.map(|(dx, dy)| corner(dx, dy)));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    // At the centre of the scene, where f32 resolves its corners.
    let corners = [(0.0, 0.0), (1e-6, 0.0), (0.0, 5e-7)];
    let first = mesh.positions.len() as u32;
    mesh.positions
        .extend(corners.map(|(dx, dy)| [-0.5975 + dx, 0.5 + dy, 0.0]));
    mesh.triangles.push([first, first + 1, first + 2]);
    mesh
}

/// The sum of 1/density over samples in a part of the emitter is the area of that part; it is exact, since
/// every value of the random number occurs once. The minute triangle is never sampled: a probability of
/// 2^-24 would exceed its area so much that its density could overflow f32.
#[test]
fn triangles_are_sampled_with_the_density_that_is_returned() {
    let scene = scene(
        vec![emitting(mesh(slivers(), DMat4::IDENTITY), RADIANCE)],
        vec![],
    );
    let u_position = Vec2::splat(0.3);
    let border = to_scene(&scene, DVec3::ZERO).x;
    assert_eq!(scene.geometry.triangle_count(), SLIVERS + 2);
    let (mut slivers, mut whole, mut densest) = (0.0, 0.0, 0.0_f32);
    for number in 0..RESOLUTION {
        let u_primitive = number as f32 / RESOLUTION as f32;
        let sample = scene
            .emitters
            .sample_emission(0.5, u_primitive, u_position, u_position);
        let sample = sample.expect("a start");
        let area = scene.unit * scene.unit / f64::from(RESOLUTION) / f64::from(sample.pdf_position);
        whole += area;
        densest = densest.max(sample.pdf_position);
        if sample.position.x > border {
            slivers += area;
        }
    }
    let expected = SLIVERS as f64 / f64::from(RESOLUTION);
    // The corners of slivers are rounded to f32.
    assert!(
        (slivers / expected - 1.0).abs() < 1e-3,
        "{slivers} {expected}"
    );
    assert!((whole - 1.0 - expected).abs() < 1e-6, "{whole}");
    let uniform = (scene.unit * scene.unit) as f32;
    assert!(densest < 4.0 * uniform, "{densest} {uniform}");
}

/// The densities of a hit are those with which the triangle that is hit is sampled, for direct light and as
/// the start of a light subpath.
#[test]
fn hits_have_the_density_of_their_triangle() {
    let scene = scene(
        vec![emitting(mesh(slivers(), DMat4::IDENTITY), RADIANCE)],
        vec![],
    );
    let point = to_scene(&scene, DVec3::new(0.4, 0.5, 1.0));
    let u_position = Vec2::splat(0.4);
    let mut compared = 0;
    let mut last = 0.0;
    // Slivers are assigned the lowest or the highest values, since those of the large triangle are
    // consecutive.
    for number in (0..4096).chain(RESOLUTION - 4096..RESOLUTION) {
        let u_primitive = number as f32 / RESOLUTION as f32;
        let start = scene
            .emitters
            .sample_emission(0.5, u_primitive, u_position, u_position);
        let start = start.expect("a start");
        if start.pdf_position == last {
            continue;
        }
        last = start.pdf_position;
        compared += 1;
        let direct = scene
            .emitters
            .sample_direct(point, 0.5, u_primitive, u_position);
        let direct = direct.expect("a point on the emitter");
        let (hit, _) = light_hit(&scene, point, direct.direction).expect("a hit");
        for (what, pdf) in [
            ("direct, sampled", direct.emission.pdf_direct),
            ("direct, hit", hit.pdf_direct),
            ("position, of direct light", direct.emission.pdf_position),
            ("position, hit", hit.pdf_position),
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
