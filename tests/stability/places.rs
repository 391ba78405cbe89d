//! Extreme placements: a camera in glass, in a lamp, on a surface; and rooms that light cannot leave.
//!
//! Null hypotheses, thresholds and false-alarm rates are those of `assert_mean` at ALPHA.

use glam::{DMat4, DVec3};
use metrolight::analysis::trapped_light;
use metrolight::render::{Method, Unobserved, render};
use metrolight::scene::{Scene, ThinLens, TriangleMesh};
use metrolight::statistics::Moments;

use super::numbers::lamp_in_slab;
use crate::common::renders::{mean, means, rendering, renderings, settings, with_pssmlt};
use crate::common::scenes::{SceneBuilder, emit};
use crate::common::truths::assert_mean;
use crate::common::wording;
use crate::records::{ALPHA, ROUNDING, figure, row, told};

use Method::{Bdpt, Light, Path, Pssmlt};

/// In glass, radiance from directions that reach an environment of radiance L is n^2 L. Off the centre of a
/// ball, rays that hit its surface beyond the critical angle are totally reflected forever: they carry no
/// light, and their paths must end.
#[test]
fn a_camera_in_glass() {
    let n: f64 = 1.5;
    for (what, from, to, truth) in [
        ("centre of a ball", DVec3::ZERO, DVec3::X, n * n),
        (
            "off centre, along a radius",
            DVec3::X * 0.9,
            DVec3::X * 2.0,
            n * n,
        ),
        (
            "off centre, trapped",
            DVec3::X * 0.9,
            DVec3::new(0.9, 1.0, 0.0),
            0.0,
        ),
    ] {
        let mut builder = SceneBuilder::seen(from, to, 5.0, [4, 3]);
        let glass = builder.glass(n as f32);
        builder.sphere(DVec3::ZERO, 1.0, glass);
        builder.sky(1.0);
        let scene = builder.build();
        for integrator in [Path, Bdpt, Pssmlt] {
            let moments = means(&scene, integrator, 200, 8);
            let name = format!("{what}, {}", integrator.name());
            assert_mean(&name, &moments, truth, ROUNDING, ALPHA);
        }
        row(
            &format!("a camera inside glass: {what}"),
            "path, bdpt, pssmlt",
            format!("radiance {truth} L, with n^2 = 2.25, as in theory"),
            told(&rendering(&scene, Path, 16, 1).warnings),
        );
    }
}

/// Inside a lamp that emits inward every pixel has its radiance; inside one that emits outward, 0.
#[test]
fn a_camera_in_a_lamp() {
    for (inward, truth) in [(true, 3.0), (false, 0.0)] {
        let mut builder = SceneBuilder::seen(DVec3::new(0.2, 0.1, -0.3), DVec3::X, 60.0, [6, 4]);
        let black = builder.diffuse(0.0);
        let lamp = builder.sphere(DVec3::ZERO, 1.0, black);
        lamp.flip_normals = inward;
        emit(lamp, 3.0);
        let scene = builder.build();
        let mut message = String::new();
        for integrator in Method::ALL {
            let rendering = rendering(&scene, integrator, 64, 1);
            message = told(&rendering.warnings);
            if integrator != Method::Light {
                let pixels = rendering.image.pixels.iter().flatten();
                let error = pixels
                    .map(|&x| (f64::from(x) - truth).abs())
                    .fold(0.0, f64::max);
                // A Metropolis chain visits pixels at random; only its mean is exact.
                let exact = if integrator == Pssmlt { 1.0 } else { 0.0 };
                assert!(error <= exact * truth, "{}: {error}", integrator.name());
            }
            let moments = means(&scene, integrator, 256, 8);
            assert_mean(integrator.name(), &moments, truth, ROUNDING, ALPHA);
        }
        row(
            &format!(
                "a camera inside a lamp that shines {}",
                if inward { "inward" } else { "outward" }
            ),
            "path, light, bdpt, pssmlt",
            format!("radiance {truth}"),
            message,
        );
    }
}

/// A camera exactly on a floor of albedo 1/2, or half its near_clip above, does not see the floor, which is
/// nearer than its near plane: in all directions it sees the environment of radiance 1.
#[test]
fn a_camera_on_a_floor() {
    for (what, height, to) in [
        ("up", 0.0, DVec3::new(0.1, 1.0, 0.0)),
        ("along it", 0.0, DVec3::X),
        ("down", 0.0, DVec3::new(0.1, -1.0, 0.0)),
        ("down from just above it", 5e-4, DVec3::new(0.1, -1.0, 0.0)),
    ] {
        let from = DVec3::Y * height;
        let mut builder = SceneBuilder::seen(from, from + to, 50.0, [6, 4]).depth(3);
        let white = builder.diffuse_sheet(0.5);
        builder.floor(DVec3::ZERO, 1.0, white);
        builder.sky(1.0);
        let scene = builder.build();
        for integrator in Method::ALL {
            let moments = means(&scene, integrator, 400, 8);
            let name = format!("{what}, {}", integrator.name());
            assert_mean(&name, &moments, 1.0, ROUNDING, ALPHA);
        }
    }
    row(
        "a camera exactly on a plane, looking up, along it and down",
        "path, light, bdpt, pssmlt",
        "the sky above and below: what is nearer than near_clip is not seen",
        "nothing",
    );
}

/// A camera exactly on the surface of a glass ball looks along the normal, out or in: its rays start at the
/// near plane, outside or inside.
#[test]
fn a_camera_on_glass() {
    for (what, to, truth) in [("out", DVec3::X * 2.0, 1.0), ("in", DVec3::ZERO, 2.25)] {
        let mut builder = SceneBuilder::seen(DVec3::X, to, 5.0, [4, 3]);
        let glass = builder.glass(1.5);
        builder.sphere(DVec3::ZERO, 1.0, glass);
        builder.sky(1.0);
        let scene = builder.build();
        for integrator in [Path, Bdpt, Pssmlt] {
            let moments = means(&scene, integrator, 200, 8);
            let name = format!("{what}, {}", integrator.name());
            assert_mean(&name, &moments, truth, ROUNDING, ALPHA);
        }
    }
    row(
        "a camera exactly on the surface of glass, looking out and in",
        "path, bdpt, pssmlt",
        "L outside, n^2 L inside: the medium is the one at near_clip",
        "nothing",
    );
}

/// The surface of a glass block bisects a thin lens: half of its rays start in air and have radiance L, the
/// others start in glass and have n^2 L.
#[test]
fn a_lens_cut_by_glass() {
    let mut builder = SceneBuilder::seen(DVec3::ZERO, DVec3::Z, 20.0, [6, 4]);
    builder.lens = Some(ThinLens {
        aperture_radius: 0.1,
        focus_distance: 2.0,
    });
    let glass = builder.glass(1.5);
    builder.cube(DVec3::X * 5.0, DVec3::splat(5.0), glass);
    builder.sky(1.0);
    let scene = builder.build();
    for integrator in [Path, Bdpt, Pssmlt] {
        let moments = means(&scene, integrator, 400, 8);
        assert_mean(integrator.name(), &moments, 1.625, ROUNDING, ALPHA);
        row(
            "a thin lens half in glass",
            integrator.name(),
            format!("(1 + n^2) L / 2 = 1.625 L: {}", figure(&moments)),
            "nothing",
        );
    }
}

/// A closed white room, the inside of a sphere, with a black lamp.
fn white_room(lamp_radius: f64) -> Scene {
    let (from, to) = (DVec3::new(0.0, 0.1, 0.8), DVec3::new(0.2, 0.0, 0.0));
    let mut builder = SceneBuilder::seen(from, to, 60.0, [6, 4]);
    let white = builder.diffuse(1.0);
    let black = builder.diffuse(0.0);
    builder.sphere(DVec3::ZERO, 1.0, white).flip_normals = true;
    emit(builder.sphere(DVec3::ZERO, lamp_radius, black), 1.0);
    builder.build()
}

/// In equilibrium radiance equals the lamp's everywhere. With a lamp of radius 0.1 light is reflected a
/// hundred times before it hits the lamp again.
#[test]
fn a_white_room_is_as_bright_as_its_black_lamp() {
    let mut found = Vec::new();
    for (integrator, radius, spp, bootstrap) in [
        (Path, 0.1, 400, 0),
        (Light, 0.1, 400, 0),
        (Bdpt, 0.2, 60, 0),
        (Pssmlt, 0.2, 60, 4000),
    ] {
        let scene = white_room(radius);
        assert_eq!(trapped_light(&scene), None);
        let settings = with_pssmlt(settings(integrator, spp), |own| {
            own.bootstrap = Some(bootstrap);
        });
        let moments: Moments = renderings(&scene, &settings, 0..8)
            .map(|r| mean(&r))
            .collect();
        let name = integrator.name();
        assert_mean(name, &moments, 1.0, ROUNDING, ALPHA);
        found.push(format!("{name} {} (radius {radius})", figure(&moments)));
    }
    row(
        "a closed room of albedo 1 with a black lamp, unbounded depth",
        "path, light, bdpt, pssmlt",
        format!(
            "ends; radiance over the lamp's, exactly 1: {}",
            found.join(", ")
        ),
        "nothing",
    );
}

/// L = 1/(1 - 0.99) = 100 in a closed room of albedo 0.99. If Russian roulette bounded the survival
/// probability by 0.95 at all vertices, weights would grow faster than paths end: 133 +- 43 from as many
/// samples.
#[test]
fn a_nearly_white_furnace_has_finite_variance() {
    for integrator in [Path, Light] {
        let moments = means(&furnace(0.99), integrator, 400, 8);
        assert_mean(integrator.name(), &moments, 100.0, ROUNDING, ALPHA);
        assert!(moments.standard_error() < 4.0, "{moments:?}");
        row(
            "a closed furnace of albedo 0.99, unbounded depth",
            integrator.name(),
            format!("radiance, exactly 100: {}", figure(&moments)),
            "nothing",
        );
    }
}

/// The inside of a sphere that emits radiance 1 and reflects `albedo`.
fn furnace(albedo: f32) -> Scene {
    let (from, to) = (DVec3::new(0.0, 0.1, 0.8), DVec3::new(0.2, 0.0, 0.0));
    let mut builder = SceneBuilder::seen(from, to, 60.0, [6, 4]);
    let white = builder.diffuse(albedo);
    let wall = builder.sphere(DVec3::ZERO, 1.0, white);
    wall.flip_normals = true;
    emit(wall, 1.0);
    builder.build()
}

/// A closed furnace of albedo 1 has infinite radiance: every render of it ends, with a meaningless value
/// and a warning. There is no warning where light escapes or is absorbed, or where path length is
/// limited.
#[test]
fn a_closed_white_furnace_ends_and_is_reported() {
    let scene = furnace(1.0);
    let trapped = trapped_light(&scene).expect("all of it");
    assert_eq!(trapped.share, 1.0);
    for integrator in Method::ALL {
        let settings = with_pssmlt(settings(integrator, 16), |own| {
            own.bootstrap = Some(1000);
        });
        let rendering = render(&scene, &settings, &Unobserved).expect("threads");
        assert_eq!(rendering.statistics.non_finite, 0);
        assert!(mean(&rendering) > 10.0);
    }
    row(
        "a closed furnace of albedo 1, unbounded depth",
        "path, light, bdpt, pssmlt",
        "ends (some 75 vertices to a subpath); the truth is infinite, the image a number that grows with \
         the samples",
        wording::trapped_light(&trapped),
    );
    assert_eq!(trapped_light(&furnace(0.99)), None);
    assert_eq!(trapped_light(&lamp_in_slab(2.0 * DVec3::Y)), None);
    let mut limited = scene;
    limited.depth.max_depth = Some(50);
    assert_eq!(trapped_light(&limited), None);
}

/// A white box without a lid absorbs nothing, so it has the radiance of the environment.
#[test]
fn an_open_white_box_has_the_radiance_of_the_environment() {
    for (integrator, spp) in [(Path, 200), (Bdpt, 50), (Pssmlt, 100)] {
        let (from, to) = (DVec3::new(0.0, 1.4, 0.9), DVec3::new(0.0, -0.2, -0.5));
        let mut builder = SceneBuilder::seen(from, to, 50.0, [6, 4]);
        let white = builder.diffuse_sheet(1.0);
        let mut sides = TriangleMesh::cube();
        // The second face is the lid.
        sides.triangles.drain(2..4);
        builder.mesh(sides, DMat4::IDENTITY, white);
        builder.sky(1.0);
        let scene = builder.build();
        let moments = means(&scene, integrator, spp, 10);
        assert_mean(integrator.name(), &moments, 1.0, ROUNDING, ALPHA);
    }
    row(
        "an open box of albedo 1, unbounded depth",
        "path, bdpt, pssmlt",
        "ends; shows the radiance of the sky",
        "nothing",
    );
}

/// Coordinates too large for the precision of f64 are an error that names the shape.
#[test]
fn huge_coordinates() {
    let message = |distance: f64| {
        let mut builder = SceneBuilder::seen(DVec3::ZERO, DVec3::X, 40.0, [4, 3]);
        let white = builder.diffuse(0.5);
        builder.sphere(DVec3::X * 4.0, 1.0, white);
        builder.floor(DVec3::Y * -distance, 1.0, white);
        builder.sky(1.0);
        builder
            .description()
            .build()
            .err()
            .map(|error| error.to_string())
    };
    let told = message(1e30).expect("an error");
    assert!(
        told.starts_with("shape 1: coordinates reach 1e30; they must be below 1e15"),
        "{told}"
    );
    assert_eq!(message(9e14), None);
    row(
        "coordinates of 1e30 (1e15 and more), a whole scene of 1e-13 (less than 1e-12)",
        "all",
        "the scene is refused",
        told,
    );
}
