//! Extreme numbers: indices of refraction around 1, radiances of all magnitudes, films of one pixel,
//! emitters seen edge-on.
//!
//! Statistical tests reject at ALPHA: a correct program fails a comparison with that probability for
//! a new choice of seeds.

use glam::{DMat4, DVec3};
use metrolight::render::Method;
use metrolight::scene::{MicrofacetDistribution, Scene};
use metrolight::statistics::Moments;

use crate::common::renders::{mean, means, rendering};
use crate::common::scenes::{SceneBuilder, emit};
use crate::common::tiles::{assert_same_image, tiles};
use crate::common::truths::assert_mean;
use crate::records::{ALPHA, ROUNDING, row, told};

use Method::{Bdpt, Light, Path, Pssmlt};

/// Reflectance of a smooth interface for light at `cos` on the side of index 1, `eta` beyond it: for
/// either polarisation the square of an amplitude (Born and Wolf, section 1.5.2).
fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin_t = (1.0 - cos * cos).sqrt() / eta;
    if sin_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin_t * sin_t).sqrt();
    let s = (cos - eta * cos_t) / (cos + eta * cos_t);
    let p = (cos_t - eta * cos) / (cos_t + eta * cos);
    0.5 * (s * s + p * p)
}

/// A floor lit by a lamp, with an optional ball between them.
fn floor_behind_ball(ball: Option<Ball>) -> Scene {
    let (from, to) = (DVec3::new(0.0, 0.9, 3.0), DVec3::new(0.0, -0.6, 0.0));
    let mut builder = SceneBuilder::seen(from, to, 40.0, [16, 12]).depth(7);
    let white = builder.diffuse(0.7);
    builder.floor(DVec3::NEG_Y, 3.0, white);
    emit(builder.ceiling(DVec3::new(0.4, 1.5, 0.0), 0.6, white), 5.0);
    let ball = ball.map(|ball| match ball {
        Ball::Smooth(eta) => builder.glass(eta),
        Ball::Rough(eta) => builder.rough_glass(MicrofacetDistribution::Ggx, eta, 0.3),
    });
    if let Some(material) = ball {
        builder.sphere(DVec3::ZERO, 0.6, material);
    }
    builder.build()
}

#[derive(Clone, Copy, Debug)]
enum Ball {
    Smooth(f32),
    Rough(f32),
}

/// Null hypothesis: a ball with (nearly) the index of refraction of its surroundings does not change the
/// image. At 1 + 1e-4 light is displaced by about 1e-4 of the ball, and 2.5e-9 of it is reflected.
#[test]
fn a_ball_of_index_one_is_invisible() {
    for (integrator, spp) in [(Path, 96), (Bdpt, 32), (Pssmlt, 64)] {
        let without = tiles(&floor_behind_ball(None), integrator, spp, (1, 8), 4);
        for (i, ball) in [
            Ball::Smooth(1.0),
            Ball::Smooth(1.0 + 1e-6),
            Ball::Smooth(1.0 + 1e-4),
            Ball::Rough(1.0),
            Ball::Rough(1.0 + 5e-5),
        ]
        .into_iter()
        .enumerate()
        {
            let name = format!("{ball:?}, {}", integrator.name());
            let with = floor_behind_ball(Some(ball));
            let with = tiles(&with, integrator, spp, (2 + i as u64, 8), 4);
            let p = assert_same_image(&name, [&without, &with], 0.0, ALPHA);
            println!("{name}: p = {p:.2e}");
        }
    }
    row(
        "glass of index 1, 1 + 1e-6, 1 + 1e-4; rough glass of index 1, 1 + 5e-5",
        "path, bdpt, pssmlt",
        "the same image as without the glass",
        "nothing",
    );
}

/// A slab of glass under environment light, with a black lamp in it that faces up; `from` looks at the
/// centre of the slab's top.
pub fn lamp_in_slab(from: DVec3) -> Scene {
    let mut builder = SceneBuilder::seen(from, DVec3::Y, 0.02, [4, 3]);
    let glass = builder.glass(1.5);
    let black = builder.diffuse(0.0);
    builder.cube(DVec3::ZERO, DVec3::new(200.0, 1.0, 200.0), glass);
    emit(
        builder.floor(DVec3::new(0.0, -0.5, 0.0), 199.9, black),
        LAMP as f32,
    );
    builder.sky(SKY as f32);
    builder.build()
}

const LAMP: f64 = 3.0;
const SKY: f64 = 0.8;

/// From below, the radiance of the slab's top is F times that of the lamp plus (1 - F) n^2 times that of
/// the environment; from above, F times that of the environment plus (1 - F)/n^2 times that of the lamp.
/// Beyond the critical angle of 41.81 degrees F = 1.
#[test]
fn total_internal_reflection() {
    let n: f64 = 1.5;
    let distance = 0.7;
    for (degrees, inside) in [
        (30.0, true),
        (41.7, true),
        (41.9, true),
        (60.0, true),
        (89.0, true),
        (0.0, false),
        (50.0, false),
        (89.0, false),
        (89.9, false),
    ] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let height = if inside { -cos } else { cos };
        let from = DVec3::Y + distance * DVec3::new(sin, height, 0.0);
        let truth = if inside {
            let f = fresnel(cos, 1.0 / n);
            f * LAMP + (1.0 - f) * n * n * SKY
        } else {
            let f = fresnel(cos, n);
            f * SKY + (1.0 - f) / (n * n) * LAMP
        };
        let scene = lamp_in_slab(from);
        for integrator in [Path, Bdpt, Pssmlt] {
            let name = format!("{degrees} degrees, inside {inside}, {}", integrator.name());
            let moments = means(&scene, integrator, 200, 8);
            assert_mean(&name, &moments, truth, ROUNDING, ALPHA);
        }
    }
    row(
        "light inside glass, 30 to 89 degrees, total internal reflection beyond 41.8",
        "path, bdpt, pssmlt",
        "F L1 + (1 - F) n^2 L2 from inside and F L2 + (1 - F) L1 / n^2 from outside",
        "nothing",
    );
}

/// An air bubble of radius 1 in water with a black lamp at its centre. A ray at height b hits the lamp if
/// n b is less than the lamp's radius; if n b < 1 it misses the lamp and reaches the environment;
/// otherwise it is totally reflected and reaches the environment too.
#[test]
fn air_bubbles_in_water() {
    let n = 1.33;
    for b in [0.0, 0.1, 0.5, 0.745, 0.76, 0.99] {
        let (from, to) = (DVec3::new(b, 0.0, 5.0), DVec3::new(b, 0.0, 0.0));
        let mut builder = SceneBuilder::seen(from, to, 0.02, [4, 3]);
        let air = builder.glass((1.0 / n) as f32);
        let black = builder.diffuse(0.0);
        builder.sphere(DVec3::ZERO, 1.0, air);
        emit(builder.sphere(DVec3::ZERO, 0.2, black), LAMP as f32);
        builder.sky(SKY as f32);
        let scene = builder.build();
        let f = fresnel((1.0 - b * b).sqrt(), 1.0 / n);
        let truth = match b {
            b if n * b < 0.2 => f * SKY + (1.0 - f) * n * n * LAMP,
            _ => SKY,
        };
        for integrator in [Path, Bdpt, Pssmlt] {
            let name = format!("b = {b}, {}", integrator.name());
            let moments = means(&scene, integrator, 200, 8);
            assert_mean(&name, &moments, truth, ROUNDING, ALPHA);
        }
    }
    row(
        "an air bubble in water (eta < 1)",
        "path, bdpt, pssmlt",
        "F L1 + (1 - F) n^2 L2 where rays enter; total reflection where b > 1/n",
        "nothing",
    );
}

/// A floor with a ball of glass under a lamp of the given radiance.
fn room(radiance: f32) -> Scene {
    let (from, to) = (DVec3::new(0.0, 0.5, 3.5), DVec3::new(0.0, -0.2, 0.0));
    let mut builder = SceneBuilder::seen(from, to, 40.0, [16, 12]).depth(6);
    let white = builder.diffuse(0.7);
    let glass = builder.glass(1.5);
    builder.floor(DVec3::NEG_Y, 3.0, white);
    builder.sphere(DVec3::new(0.4, -0.3, 0.0), 0.5, glass);
    emit(builder.ceiling(DVec3::Y, 0.5, white), radiance);
    builder.build()
}

/// For powers of two rounding is the same, and the image must scale bit for bit. For 1e12 and 1e-12
/// rounding differs, and a Metropolis chain diverges after the first different decision, so the means
/// over seeds must agree.
#[test]
fn images_scale_with_the_radiance_of_the_emitters() {
    for integrator in Method::ALL {
        let image = |radiance, spp| rendering(&room(radiance), integrator, spp, 1).image.pixels;
        let unit = image(1.0, 16);
        for exponent in [-40, 40] {
            let factor = 2.0_f32.powi(exponent);
            let scaled = image(factor, 16);
            for (a, b) in unit.iter().flatten().zip(scaled.iter().flatten()) {
                assert_eq!(a * factor, *b, "{}: 2^{exponent}", integrator.name());
            }
        }
        let moments = |radiance: f32| -> Moments {
            let over = |seed| mean(&rendering(&room(radiance), integrator, 16, seed));
            (0..6)
                .map(|seed| over(seed) / f64::from(radiance))
                .collect()
        };
        let unit = moments(1.0);
        for radiance in [1e-12, 1e12] {
            let scaled = moments(radiance);
            let name = format!("{}: {radiance:e}", integrator.name());
            assert_same_image(&name, [&[unit], &[scaled]], 1e-5, ALPHA);
        }
    }
    row(
        "emitters of radiance 1e-12 and 1e12",
        "path, light, bdpt, pssmlt",
        "the image scales to the bit with powers of two, and within 1e-5 or noise with powers of ten",
        "nothing",
    );
}

/// Lamps of radiance 1e12 and 1e-12 on the two sides of a black wall: each side must equal the image with
/// its lamp alone, so that the dim lamp is not lost beside the bright one.
#[test]
fn the_brightest_and_the_dimmest_emitter_in_one_scene() {
    const BRIGHT: f32 = 1e12;
    const DIM: f32 = 1e-12;
    let scene = |bright: f32, dim: f32| {
        let mut builder = SceneBuilder::seen(DVec3::Y * 8.0, DVec3::ZERO, 40.0, [16, 4]);
        let (white, black) = (builder.diffuse(0.7), builder.diffuse_sheet(0.0));
        builder.floor(DVec3::ZERO, 3.0, white);
        builder.cube(DVec3::Y * 1.5, DVec3::new(0.01, 1.5, 9.0), black);
        for (side, radiance) in [(-1.0, bright), (1.0, dim)] {
            let lamp = builder.ceiling(DVec3::new(side * 1.5, 1.5, 0.0), 0.3, black);
            if radiance > 0.0 {
                emit(lamp, radiance);
            }
        }
        builder.depth(3).build()
    };
    let both = scene(BRIGHT, DIM);
    for (integrator, spp) in [(Path, 256), (Light, 256), (Bdpt, 64), (Pssmlt, 256)] {
        let both = tiles(&both, integrator, spp, (1, 12), 4);
        let only = [scene(BRIGHT, 0.0), scene(0.0, DIM)]
            .map(|scene| tiles(&scene, integrator, spp, (2, 12), 4));
        let (mut sides, mut alone) = (Vec::new(), Vec::new());
        for ((both, bright), dim) in both.iter().zip(&only[0]).zip(&only[1]) {
            // No tile is lit by both.
            assert!((bright.mean == 0.0) != (dim.mean == 0.0));
            let (one, unit) = match bright.mean > 0.0 {
                true => (bright, BRIGHT),
                false => (dim, DIM),
            };
            let scaled = |m: &Moments| {
                let unit = f64::from(unit);
                Moments::from_summary(m.count, m.mean / unit, m.variance() / (unit * unit))
            };
            sides.push(scaled(both));
            alone.push(scaled(one));
        }
        let p = assert_same_image(integrator.name(), [&sides, &alone], 1e-5, ALPHA);
        let error = |moments: &[Moments], bright: bool| {
            let of = |m: &&Moments| (m.standard_error() / m.mean, m.mean);
            let errors = moments
                .iter()
                .zip(&only[0])
                .filter(|(_, b)| (b.mean > 0.0) == bright);
            let errors: Vec<f64> = errors.map(|(m, _)| of(&m).0).collect();
            100.0 * errors.iter().sum::<f64>() / errors.len() as f64
        };
        println!(
            "{}: {p:.2e} {} {}",
            integrator.name(),
            error(&sides, true),
            error(&sides, false)
        );
        row(
            "lamps of radiance 1e12 and 1e-12 in one scene, each behind a wall from the other",
            integrator.name(),
            format!(
                "both sides right; standard error of a tile {:.1}% on the bright side, {:.1}% on the dim one",
                error(&sides, true),
                error(&sides, false)
            ),
            "nothing",
        );
    }
}

/// A floor with a ball under a lamp, on a film of `size` with a horizontal field of view of `fov`.
fn view(size: [u32; 2], fov: f64) -> Scene {
    let mut builder = SceneBuilder::seen(
        DVec3::new(0.0, 0.3, 3.5),
        DVec3::new(0.1, -0.3, 0.0),
        fov,
        size,
    );
    let white = builder.diffuse(0.7);
    builder.floor(DVec3::NEG_Y, 3.0, white);
    builder.sphere(DVec3::new(0.4, -0.3, 0.0), 0.5, white);
    emit(builder.ceiling(DVec3::Y, 0.5, white), 2.0);
    builder.depth(4).build()
}

/// Null hypothesis: a film of one row or column equals the middle row or column of a larger one with pixels
/// of the same size, and a film of one pixel equals the mean of a square one.
#[test]
fn films_of_one_row_one_column_and_one_pixel() {
    let fov: f64 = 40.0;
    let column = 2.0 * ((0.5 * fov).to_radians().tan() / 9.0).atan().to_degrees();
    for integrator in Method::ALL {
        let name = |what| format!("{what}, {}", integrator.name());
        let of = |size, fov, group, side| tiles(&view(size, fov), integrator, 64, (group, 8), side);
        let whole = of([9, 9], fov, 1, 1);
        let pixel = |x: usize, y: usize| whole[(y * 9 + x) * 3];
        let greys = |tiles: Vec<Moments>| tiles.into_iter().step_by(3).collect::<Vec<_>>();
        let middle: Vec<Moments> = (0..9).map(|x| pixel(x, 4)).collect();
        let row = greys(of([9, 1], fov, 2, 1));
        assert_same_image(&name("one row"), [&row, &middle], 0.0, ALPHA);
        let middle: Vec<Moments> = (0..9).map(|y| pixel(4, y)).collect();
        let line = greys(of([1, 9], column, 3, 1));
        assert_same_image(&name("one column"), [&line, &middle], 0.0, ALPHA);
        // As many samples as the larger film has: with few, the mean is far from normal.
        let one = greys(tiles(&view([1, 1], fov), integrator, 64 * 81, (4, 8), 1));
        let mean = greys(of([9, 9], fov, 5, 9));
        assert_same_image(&name("one pixel"), [&one, &mean], 0.0, ALPHA);
    }
    row(
        "films of 9 x 1, 1 x 9 and 1 x 1 pixels",
        "path, light, bdpt, pssmlt",
        "the middle row, the middle column and the mean of a film of 9 x 9",
        "nothing",
    );
}

/// A flat lamp seen exactly edge-on is invisible, and does not light the floor in its own plane; where
/// rounding tilts it, almost.
#[test]
fn an_emitter_seen_edge_on_is_invisible() {
    let mut told_of = String::new();
    for turn in [0.0, 0.3] {
        let tilt = DMat4::from_rotation_z(turn) * DMat4::from_rotation_x(turn);
        let place = |p: DVec3| tilt.transform_point3(p);
        // In the plane of the lamp, which is that of the floor.
        let (from, to) = (DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO);
        let mut builder = SceneBuilder::seen(place(from), place(to), 30.0, [16, 12]).depth(3);
        let (white, black) = (builder.diffuse(0.7), builder.diffuse(0.0));
        builder
            .floor(DVec3::new(0.0, 0.0, -3.0), 1.0, white)
            .flip_normals = false;
        builder.floor(DVec3::new(2.5, 0.0, 0.0), 1.0, white);
        emit(builder.floor(DVec3::ZERO, 1.0, black), 1.0);
        for shape in &mut builder.shapes {
            shape.to_world = tilt * shape.to_world;
        }
        let edge_on = builder.build();
        // The floor beside the lamp, from above.
        let above = DVec3::new(2.5, 3.0, 0.0);
        let mut builder =
            SceneBuilder::seen(place(above), place(above - DVec3::Y), 30.0, [16, 12]).depth(3);
        let (white, black) = (builder.diffuse(0.7), builder.diffuse(0.0));
        builder.floor(DVec3::new(2.5, 0.0, 0.0), 1.0, white);
        emit(builder.floor(DVec3::ZERO, 1.0, black), 1.0);
        for shape in &mut builder.shapes {
            shape.to_world = tilt * shape.to_world;
        }
        for scene in [edge_on, builder.build()] {
            for integrator in Method::ALL {
                let rendering = rendering(&scene, integrator, 64, 1);
                let mean = mean(&rendering);
                assert!(
                    mean < 1e-6,
                    "{}, turned by {turn}: {mean:e}",
                    integrator.name()
                );
                if mean == 0.0 && integrator == Path {
                    told_of = told(&rendering.warnings);
                }
            }
        }
    }
    row(
        "a rectangle light exactly edge-on to camera and receiver",
        "path, light, bdpt, pssmlt",
        "less than 1e-6 of its radiance; no NaN",
        told_of,
    );
}
