//! Single precision: images do not depend on the size and position of a scene, and no light leaks or is lost
//! at grazing angles, where surfaces touch, or near degenerate triangles.
//!
//! Statistical tests reject at ALPHA after Holm's correction: the probability, over the choice of seeds,
//! that a correct program fails a comparison.

mod common;

use common::compare::{assert_mean, assert_same_image, mean, means, rendering, tiles};
use common::figures::{Accuracy, Stability, record};
use common::worlds::{World, shine};
use glam::{DMat4, DVec3};
use metrolight::math::Rgb;
use metrolight::render::Integrator;
use metrolight::scene::{EmitterDescription, Scene, TriangleMesh};

use Integrator::{Bdpt, Light, Path, Pssmlt};

const ALPHA: f64 = 1e-4;

/// Records a result.
fn row(case: &str, found: impl Into<String>, demanded: impl Into<String>) {
    let (found, demanded) = (found.into(), demanded.into());
    record(
        "accuracy",
        &Accuracy {
            oracle: "f32",
            case,
            found,
            demanded,
        },
    );
}

/// A ball of n x n smooth-shaded patches.
fn ball(n: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let count = 2 * n;
    for j in 0..=n {
        for i in 0..count {
            let theta = std::f64::consts::PI * f64::from(j) / f64::from(n);
            let phi = std::f64::consts::TAU * f64::from(i) / f64::from(count);
            let p = DVec3::new(
                theta.sin() * phi.cos(),
                theta.cos(),
                theta.sin() * phi.sin(),
            );
            mesh.positions.push(p.as_vec3().to_array());
            let at = |j: u32, i: u32| j * count + i % count;
            if j < n {
                mesh.triangles
                    .push([at(j, i), at(j + 1, i + 1), at(j + 1, i)]);
                mesh.triangles
                    .push([at(j, i), at(j, i + 1), at(j + 1, i + 1)]);
            }
        }
    }
    mesh
}

/// A closed room with a lamp, a ball of glass with a caustic on the floor, a smooth mesh, and a box that
/// stands exactly on the floor.
fn room() -> World {
    let (from, to) = (DVec3::new(0.0, 1.2, 1.9), DVec3::new(0.0, 0.5, 0.0));
    let mut world = World::seen(from, to, 55.0, [24, 18]).depth(5);
    let (white, grey) = (world.diffuse_sheet(0.6), world.diffuse_sheet(0.3));
    let glass = world.glass(1.5);
    world.cube(DVec3::Y, DVec3::new(2.0, 1.0, 2.0), white);
    world.cube(DVec3::new(0.9, 0.3, -0.7), DVec3::splat(0.3), grey);
    world.sphere(DVec3::new(-0.3, 0.55, 0.1), 0.4, glass);
    let mut mesh = ball(6);
    let to_world = DMat4::from_translation(DVec3::new(-1.2, 0.5, -0.9))
        * DMat4::from_scale(DVec3::splat(0.45));
    mesh.compute_vertex_normals(&to_world);
    world.mesh(mesh, to_world, grey);
    shine(world.ceiling(DVec3::new(-0.2, 1.9, 0.1), 0.35, grey), 5.0);
    world
}

/// Null hypothesis, per tile: the image of a room is the same if the room is scaled by 1e-3 or 1e3, or
/// translated by 1e6 times its size.
#[test]
fn images_do_not_depend_on_scale_or_position() {
    for (integrator, spp) in [(Path, 64), (Light, 64), (Bdpt, 24), (Pssmlt, 48)] {
        let seen = |world: World, group| tiles(&world.build(), integrator, spp, (group, 8), 6);
        let here = seen(room(), 1);
        let mut smallest: f64 = 1.0;
        let mut means = Vec::new();
        for (i, (scale, offset)) in [
            (1e-3, DVec3::ZERO),
            (1e3, DVec3::ZERO),
            (1.0, DVec3::new(1e6, -1e6, 1e6)),
        ]
        .into_iter()
        .enumerate()
        {
            let name = format!("{}, {scale} times, moved by {offset}", integrator.name());
            let there = seen(room().placed(scale, offset), 2 + i as u64);
            let p = assert_same_image(&name, [&here, &there], 0.0, ALPHA);
            smallest = smallest.min(p);
            let total = |tiles: &[metrolight::statistics::Moments]| -> f64 {
                tiles.iter().map(|m| m.mean).sum()
            };
            means.push(total(&there) / total(&here));
        }
        println!("{}: {smallest:.2e} {means:?}", integrator.name());
        row(
            &format!(
                "a room at 1e-3 and 1e3 times its size, and moved by 1e6 times its size; {}",
                integrator.name()
            ),
            format!("smallest p of all tiles, corrected: {smallest:.3}"),
            "p > 1e-4; catches shifts of a few per cent of a tile",
        );
    }
}

/// The room without its lamp, under an environment light that no path may reach. The walls have no
/// thickness.
#[test]
fn closed_rooms_stay_dark() {
    for (name, scale, offset) in [
        ("small", 1e-3, DVec3::ZERO),
        ("as it is", 1.0, DVec3::ZERO),
        ("far away", 1.0, DVec3::splat(1e6)),
    ] {
        let mut world = room();
        world.0.shapes.pop();
        world.sky(1.0);
        let scene = world.placed(scale, offset).build();
        for integrator in Integrator::ALL {
            let found = mean(&rendering(&scene, integrator, 200, 1));
            println!("{name}, {}: {found:e}", integrator.name());
            assert_eq!(found, 0.0, "{name}, {}", integrator.name());
        }
    }
    row(
        "a closed dark room under a bright sky",
        "0, exactly",
        "0; catches one leak in 86400 paths",
    );
}

/// Light at grazing incidence on a floor: L = rho/pi E cos.
#[test]
fn grazing_light() {
    let rho = 0.5;
    let turn = DMat4::from_rotation_z(0.4) * DMat4::from_rotation_x(0.3);
    for slope in [1e-1, 1e-3, 1e-5] {
        // In the plane y = 0, where the normal is exact, and tilted, where its relative error is 1e-7.
        for (turn, rounding) in [(DMat4::IDENTITY, 1e-5), (turn, 1e-5 + 3e-7 / slope)] {
            let place = |p: DVec3| turn.transform_point3(p);
            let (from, to) = (DVec3::Y * 3.0, DVec3::ZERO);
            let mut world = World::seen(place(from), place(to), 20.0, [6, 4]).depth(2);
            let white = world.diffuse(rho as f32);
            world.floor(DVec3::ZERO, 2.0, white).to_world = turn
                * DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2)
                * DMat4::from_scale(DVec3::splat(2.0));
            let direction = turn.transform_vector3(DVec3::new(1.0, -slope, 0.2));
            world.0.emitters.push(EmitterDescription::Directional {
                direction,
                irradiance: Rgb::splat(1.0),
            });
            let scene = world.build();
            let cos = slope / DVec3::new(1.0, slope, 0.2).length();
            let truth = rho / std::f64::consts::PI * cos;
            for integrator in [Path, Bdpt] {
                let name = format!("slope {slope}, {}", integrator.name());
                assert_mean(
                    &name,
                    &means(&scene, integrator, 16, 4),
                    truth,
                    rounding,
                    ALPHA,
                );
            }
            for integrator in [Light, Pssmlt] {
                let name = format!("slope {slope}, {}", integrator.name());
                // At smaller slopes only one light subpath in 1e5 hits the floor.
                if slope > 1e-2 {
                    assert_mean(
                        &name,
                        &means(&scene, integrator, 400, 8),
                        truth,
                        rounding,
                        ALPHA,
                    );
                }
            }
        }
    }
    row(
        "a floor under directional light at slopes of 0.1, 1e-3 and 1e-5",
        "L = rho/pi E cos to 1e-5, in a tilted plane to 3e-7 / slope",
        "the same; catches self-shadowing and offsets that lift a ray over its light",
    );
}

/// A small emitting sphere just above a floor: E = pi L (r/d)^2 cos while it is above the horizon.
#[test]
fn a_low_lamp() {
    let (rho, r) = (0.5, 0.01);
    for height in [1.0, 0.1, 0.0101] {
        let mut world = World::seen(DVec3::Y * 2.0, DVec3::ZERO, 0.2, [4, 3]).depth(2);
        let (white, black) = (world.diffuse(rho), world.diffuse(0.0));
        world.floor(DVec3::ZERO, 2.0, white);
        let center = DVec3::new(1.0, height, 0.0);
        shine(world.sphere(center, r, black), 1e4);
        let scene = world.build();
        let cos = height / center.length();
        let truth = f64::from(rho) * 1e4 * r * r / center.length_squared() * cos;
        for (integrator, spp) in [(Path, 1000), (Bdpt, 500), (Pssmlt, 500)] {
            let name = format!("height {height}, {}", integrator.name());
            let moments = means(&scene, integrator, spp, 8);
            println!("{name}: {} {truth}", moments.mean);
            // The image is 0.003 wide, over which the irradiance varies by at most 1e-4 of itself.
            assert_mean(&name, &moments, truth, 1e-4, ALPHA);
        }
    }
}

/// A floor under a constant environment, seen at grazing angles: all pixels are rho.
#[test]
fn grazing_views() {
    for (height, slope, near) in [(1e-1, 0.1, 1e-3), (1e-3, 1e-2, 1e-4), (1e-4, 1e-3, 1e-4)] {
        let from = DVec3::Y * height;
        let mut world =
            World::seen(from, from + DVec3::new(1.0, -slope, 0.0), 0.02, [6, 4]).depth(2);
        let white = world.diffuse(0.5);
        world.floor(DVec3::ZERO, 2.0, white);
        world.sky(1.0);
        world.0.camera.near_clip = near;
        let scene = world.build();
        // Light tracing is left out: its subpaths are unlikely to hit the visible part of the floor.
        for integrator in [Path, Bdpt, Pssmlt] {
            let name = format!("height {height}, slope {slope}, {}", integrator.name());
            let spp = if integrator == Path { 64 } else { 400 };
            assert_mean(&name, &means(&scene, integrator, spp, 8), 0.5, 1e-5, ALPHA);
        }
    }
    row(
        "a floor seen at slopes of 0.1, 0.01 and 1e-3, from as near as 1e-4",
        "radiance rho L",
        "a t-test at 1e-4, or rounding of 1e-5",
    );
}

/// Coincident and overlapping floors of different triangulations, in an oblique plane where they are
/// rounded differently: under a constant environment a floor of albedo rho has radiance rho.
#[test]
fn coincident_faces_of_one_material() {
    let tilt = DMat4::from_rotation_z(0.4) * DMat4::from_rotation_x(0.3);
    let place = |p: DVec3| tilt.transform_point3(p);
    let (from, to) = (DVec3::new(0.0, 2.0, 0.5), DVec3::ZERO);
    let mut world = World::seen(place(from), place(to), 40.0, [12, 9]).depth(2);
    let white = world.diffuse_sheet(0.5);
    for (move_by, turn) in [(0.0, 0.0), (0.0, 0.5), (0.4, 0.5), (0.123, 0.0)] {
        let flat = DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
        let to_world = tilt
            * DMat4::from_translation(DVec3::new(move_by, 0.0, -move_by))
            * DMat4::from_rotation_y(turn * std::f64::consts::PI)
            * flat
            * DMat4::from_scale(DVec3::splat(2.0));
        world.mesh(TriangleMesh::rectangle(), to_world, white);
    }
    world.sky(1.0);
    let scene = world.build();
    for (integrator, spp) in [(Path, 256), (Light, 256), (Bdpt, 64), (Pssmlt, 128)] {
        let moments = means(&scene, integrator, spp, 8);
        assert_mean(integrator.name(), &moments, 0.5, 1e-5, ALPHA);
    }
}

/// A white furnace of objects that touch: nothing absorbs light, so that the image is that of the
/// environment. A ball of glass touches the floor in one point, a box stands on it, and a white ball is half
/// below it and touches the box.
#[test]
fn a_white_furnace_of_objects_that_touch() {
    let (from, to) = (DVec3::new(0.3, 1.0, 2.5), DVec3::new(0.0, 0.2, 0.0));
    let mut world = World::seen(from, to, 45.0, [12, 9]);
    let white = world.diffuse_sheet(1.0);
    let glass = world.glass(1.5);
    world.floor(DVec3::ZERO, 2.0, white);
    world.sphere(DVec3::new(-0.5, 0.4, 0.0), 0.4, glass);
    world.cube(DVec3::new(0.5, 0.25, 0.0), DVec3::splat(0.25), white);
    world.sphere(DVec3::new(0.5, 0.0, 0.65), 0.4, white);
    world.sky(1.0);
    let scene = world.build();
    for (integrator, spp) in [(Path, 256), (Bdpt, 64), (Pssmlt, 128)] {
        let moments = means(&scene, integrator, spp, 8);
        println!(
            "{} {} {}",
            integrator.name(),
            moments.mean,
            moments.standard_error()
        );
        assert_mean(integrator.name(), &moments, 1.0, 1e-5, ALPHA);
    }
}

/// A block of water under a constant environment, with a ball of air inside, which contains a ball of glass
/// at the distance `gap` from its surface.
fn ball_in_cavity(gap: f64) -> Scene {
    let mut world = World::seen(DVec3::new(0.3, 1.0, 4.5), DVec3::ZERO, 25.0, [12, 9]);
    let [water, cavity, glass] = [1.33, 1.0 / 1.33, 1.5].map(|eta| world.glass(eta));
    world.cube(DVec3::ZERO, DVec3::ONE, water);
    world.sphere(DVec3::ZERO, 0.5 + gap, cavity);
    world.sphere(DVec3::ZERO, 0.5, glass);
    world.sky(1.0);
    world.build()
}

/// A block of glass over a floor of albedo 1/2.
fn block_on_floor(gap: f64) -> Scene {
    let (from, to) = (DVec3::new(0.3, 2.0, 4.5), DVec3::Y * 0.5);
    let mut world = World::seen(from, to, 25.0, [12, 9]);
    let (white, glass) = (world.diffuse(0.5), world.glass(1.5));
    world.floor(DVec3::ZERO, 3.0, white);
    world.cube(DVec3::Y * (0.5 + gap), DVec3::splat(0.5), glass);
    world.sky(1.0);
    world.build()
}

/// Gaps between glass and water, and between glass and a floor. The origin of a ray is offset by 5e-7 to
/// 1.5e-5 of the scene's radius from the surface that it leaves, and surfaces nearer than that are missed.
/// From a gap of 1e-5 on images are right (the radii here are 1.7 and 4.2, and the objects are near the
/// centres); with smaller ones light continues in the wrong medium, but numbers stay finite, and the error
/// is below a fifth.
#[test]
fn narrow_gaps() {
    for (integrator, spp) in [(Path, 128), (Bdpt, 32)] {
        let wide = tiles(&block_on_floor(1e-3), integrator, 4 * spp, (1, 8), 12);
        for gap in [1e-2, 1e-4, 2e-5] {
            let name = format!("gap {gap}, {}", integrator.name());
            let moments = means(&ball_in_cavity(gap), integrator, spp, 8);
            assert_mean(&name, &moments, 1.0, 1e-5, ALPHA);
            let narrow = tiles(&block_on_floor(gap), integrator, 4 * spp, (2, 8), 12);
            // A gap of 1e-2 is visible: it changes the mean, 0.685, by 0.0005.
            assert_same_image(&name, [&wide, &narrow], 2e-3, ALPHA);
        }
        for gap in [1e-6, 1e-7, 0.0] {
            let ball = means(&ball_in_cavity(gap), integrator, spp, 4).mean;
            let block = means(&block_on_floor(gap), integrator, spp, 4).mean / wide[1].mean;
            for ratio in [ball, block] {
                assert!((ratio - 1.0).abs() < 0.2, "gap {gap}: {ratio}");
            }
            if integrator == Path {
                record(
                    "stability",
                    &Stability {
                        case: &format!("a gap of {gap:?} between glass and water; glass and floor"),
                        method: "path",
                        happens: format!(
                            "brightness {ball:.3} and {block:.3} of the true one: the second \
                             surface is passed over. Right from 1.5e-5 of the scene's radius on"
                        ),
                        told: "nothing".into(),
                    },
                );
            }
        }
    }
}

/// Triangles without area (repeated or collinear corners) are left out: the image is bitwise the same.
/// Slivers that lie within other triangles do not change its mean, on emitters either.
#[test]
fn triangles_without_area() {
    let scene = |points: usize, slivers: usize, flat: bool| {
        let (from, to) = (DVec3::new(0.0, 0.6, 3.0), DVec3::ZERO);
        let mut world = World::seen(from, to, 40.0, [16, 12]).depth(4);
        let white = world.diffuse_sheet(0.7);
        world.floor(DVec3::NEG_Y, 3.0, white);
        for (place, size, radiance) in [
            (DVec3::ZERO, 0.6, 0.0),
            (DVec3::new(0.5, 1.5, 0.5), 0.3, 5.0),
        ] {
            let mut mesh = ball(6);
            let whole = mesh.triangles.len() as u32;
            for i in 0..points as u32 {
                let [a, b, _] = mesh.triangles[(7 * i % whole) as usize];
                mesh.triangles
                    .push([[a, a, a], [a, a, b], [a, b, a], [b, a, a]][i as usize % 4]);
            }
            for i in 0..slivers as u32 {
                // Parallel to an edge of a triangle, thinner than the resolution of f32 at the size of the
                // scene.
                let [a, b, c] = mesh.triangles[(5 * i % whole) as usize];
                let [p, q, r] =
                    [a, b, c].map(|v| DVec3::from_array(mesh.positions[v as usize].map(f64::from)));
                let inner = |x: f64, y: f64| (p + x * (q - p) + y * (r - p)).as_vec3().to_array();
                let first = mesh.positions.len() as u32;
                mesh.positions
                    .extend([inner(0.2, 0.3), inner(0.6, 0.3), inner(0.4, 0.3 + 1e-7)]);
                mesh.triangles.push([first, first + 1, first + 2]);
            }
            let to_world = DMat4::from_translation(place) * DMat4::from_scale(DVec3::splat(size));
            if !flat {
                mesh.compute_vertex_normals(&to_world);
            }
            let shape = world.mesh(mesh, to_world, white);
            if radiance > 0.0 {
                shine(shape, radiance);
            }
        }
        world.build()
    };
    for flat in [true, false] {
        let (plain, with_points, with_slivers) =
            (scene(0, 0, flat), scene(40, 0, flat), scene(0, 40, flat));
        // At the poles of a ball one half of each patch has no area either.
        let left_out = plain.geometry.degenerate_count();
        assert_eq!(with_points.geometry.degenerate_count(), left_out + 80);
        for (integrator, spp) in [(Path, 64), (Light, 64), (Bdpt, 24), (Pssmlt, 48)] {
            let [a, b] = [&plain, &with_points]
                .map(|scene| rendering(scene, integrator, 16, 1).image.pixels);
            assert!(a == b, "{}, flat {flat}", integrator.name());
            let [a, b] = [(&plain, 1), (&with_slivers, 2)]
                .map(|(scene, group)| tiles(scene, integrator, spp, (group, 8), 4));
            let p = assert_same_image(integrator.name(), [&a, &b], 0.0, ALPHA);
            println!("{} {p:.2e}", integrator.name());
        }
    }
}
