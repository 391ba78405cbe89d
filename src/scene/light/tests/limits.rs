//! Degenerate input: all numbers stay finite, and every emitter can be chosen.

use super::*;
use crate::scene::SceneError;
use crate::scene::test_scenes::description;

fn is_finite(emission: &LightEvaluation) -> bool {
    emission.radiance.is_finite()
        && [
            emission.pdf_direct,
            emission.pdf_position,
            emission.pdf_direction,
        ]
        .iter()
        .all(|pdf| pdf.is_finite() && *pdf >= 0.0)
}

fn check_direct(sample: &LightSample) {
    assert!(is_finite(&sample.emission), "{sample:?}");
    assert!(sample.emission.pdf_direct > 0.0, "{sample:?}");
    assert!(
        sample.direction.is_normalized() && sample.target.is_finite(),
        "{sample:?}"
    );
    assert!(
        sample.jacobian_direction.is_finite() && sample.jacobian_direction > 0.0,
        "{sample:?}"
    );
    assert!(
        sample.jacobian_area.is_finite() && sample.jacobian_area > 0.0,
        "{sample:?}"
    );
}

fn check_emission(sample: &EmissionSample) {
    assert!(
        sample.origin.is_finite() && sample.weight.is_finite(),
        "{sample:?}"
    );
    assert!(sample.direction.is_normalized(), "{sample:?}");
    assert!(
        sample.pdf_position > 0.0 && sample.pdf_position.is_finite(),
        "{sample:?}"
    );
    assert!(
        sample.pdf_direction > 0.0 && sample.pdf_direction.is_finite(),
        "{sample:?}"
    );
}

/// Random numbers in [0, 1), often at its ends.
fn corner_case(numbers: &mut Numbers) -> f32 {
    match numbers.index(4) {
        0 => 0.0,
        1 => 1.0 - f32::EPSILON / 2.0,
        _ => numbers.unit(),
    }
}

#[test]
fn degenerate_points_give_finite_samples() {
    let mut scenes = extended_lights();
    let tiny = DMat4::from_scale(DVec3::splat(5e-5));
    let deltas = || vec![point_light(), directional_light()];
    scenes.push((
        "tiny",
        scene(
            vec![
                emitting(mesh(TriangleMesh::rectangle(), tiny), RADIANCE),
                floor(),
            ],
            vec![],
        ),
        DVec3::ZERO,
    ));
    scenes.push((
        "tiny ball",
        scene(
            vec![emitting(sphere(DVec3::X, 5e-5), RADIANCE), floor()],
            vec![],
        ),
        DVec3::X,
    ));
    scenes.push((
        "deltas",
        scene(vec![floor()], deltas()),
        DVec3::new(0.5, 0.6, 2.0),
    ));
    scenes.push(("sky alone", scene(vec![], vec![sky()]), DVec3::ZERO));
    for (name, scene, world) in scenes {
        let mut numbers = Numbers::new(51);
        let mut emitted = 0;
        for i in 0..20_000 {
            let mut u = || corner_case(&mut numbers);
            let (u_light, u_primitive, a, b) = (
                u(),
                u(),
                glam::Vec2::new(u(), u()),
                glam::Vec2::new(u(), u()),
            );
            let Some(start) = scene.emitters.sample_emission(u_light, u_primitive, a, b) else {
                continue;
            };
            emitted += 1;
            check_emission(&start);
            // On the emitter, in its plane, just above it, inside, and far away.
            let tangent = start.normal.any_orthonormal_vector();
            let point = match i % 7 {
                0 => start.position,
                1 => start.origin,
                2 => start.position + tangent * 1e-3,
                3 => start.position + tangent * 10.0 + start.normal * 1e-12,
                4 => start.position - start.normal * (1e-4 * numbers.unit()),
                5 => start.position + start.direction * 1e4,
                _ => to_scene(&scene, world),
            };
            let direct = scene.emitters.sample_direct(point, u_light, u_primitive, b);
            if let Some(sample) = direct {
                check_direct(&sample);
            }
            let pdf = scene.emitters.direct_pdf(&start, point);
            assert!(
                pdf.is_finite() && pdf >= 0.0,
                "{name}: {pdf} {start:?} {point}"
            );
            if let Some((light, _)) = light_hit(&scene, point, -start.direction) {
                assert!(is_finite(&light), "{name}: {light:?}");
            }
            for pole in [Vec3A::Y, Vec3A::NEG_Y, Vec3A::NEG_Z] {
                if let Some(light) = scene.emitters.evaluate_environment(pole) {
                    assert!(is_finite(&light), "{name}: {light:?}");
                }
            }
        }
        assert!(emitted > 0, "{name}");
    }
}

#[test]
fn all_emitters_have_positive_probability() {
    let mut shapes = vec![emitting(floor(), Rgb::splat(1e9))];
    for i in 0..300 {
        let place = DVec3::new(f64::from(i), 0.0, 0.0);
        shapes.push(emitting(sphere(place, 1e-3), Rgb::splat(1e-9)));
    }
    let scene = scene(shapes, vec![point_light()]);
    let emitters = 0..scene.emitters.len() as u32;
    assert_eq!(emitters.len(), 302);
    let sum: f32 = emitters
        .clone()
        .map(|i| scene.emitters.probability(i))
        .sum();
    assert!((sum - 1.0).abs() < 1e-5);
    for i in emitters {
        assert!(scene.emitters.probability(i) > 1e-6, "{i}");
    }
}

/// Directions from which light arrives have a positive density, however faint they are beside a sun.
#[test]
fn environment_densities_are_positive_where_radiance_is_and_integrate_to_one() {
    for scale in [1.5, 1e-6] {
        let EmitterDescription::Environment {
            width,
            mut pixels,
            to_world,
            ..
        } = sky()
        else {
            panic!("a sky is an environment");
        };
        pixels[19] = [1e7; 3];
        pixels[30] = [1e-4; 3];
        let sky = EmitterDescription::Environment {
            width,
            pixels,
            scale,
            to_world,
        };
        let scene = scene(vec![], vec![sky]);
        let mut numbers = Numbers::new(52);
        let n = 200_000;
        let mut sum = 0.0;
        let mut dark = 0;
        for _ in 0..n {
            let light = scene
                .emitters
                .evaluate_environment(numbers.direction())
                .expect("sky");
            assert!(light.pdf_direct > 0.0 || light.radiance == Rgb::ZERO);
            dark += usize::from(light.radiance == Rgb::ZERO);
            sum += f64::from(light.pdf_direct);
        }
        assert!(dark > 100, "{dark}");
        // With nearly all of the density in the bright patch, 1/50 of the sphere, 3% is 5 standard errors.
        let integral = sum * 4.0 * std::f64::consts::PI / f64::from(n);
        assert!((integral - 1.0).abs() < 0.1, "{integral}");
    }
}

#[test]
fn scenes_without_valid_emitters_are_rejected() {
    let none = description(vec![floor()], vec![]).build().err();
    assert!(matches!(none, Some(SceneError::NoEmitter)));
    let constant = || EmitterDescription::Constant { radiance: RADIANCE };
    let two = description(vec![floor()], vec![constant(), sky()])
        .build()
        .err();
    assert!(matches!(two, Some(SceneError::SecondEnvironment)));
    let mut flat = TriangleMesh::rectangle();
    flat.positions[2] = flat.positions[0];
    flat.positions[3] = flat.positions[0];
    let flat = emitting(mesh(flat, DMat4::IDENTITY), RADIANCE);
    let areal = description(vec![floor(), flat], vec![]).build().err();
    assert!(matches!(areal, Some(SceneError::EmitterWithoutArea { .. })));
    let point = description(vec![emitting(sphere(DVec3::ZERO, 0.0), RADIANCE)], vec![])
        .build()
        .err();
    assert!(matches!(point, Some(SceneError::EmitterWithoutArea { .. })));
    let thin = EmitterDescription::Environment {
        width: 4,
        pixels: vec![[1.0; 3]; 4],
        scale: 1.0,
        to_world: DMat4::IDENTITY,
    };
    let thin = description(vec![floor()], vec![thin]).build().err();
    assert!(matches!(thin, Some(SceneError::EnvironmentSize)));
}

/// Emitters without any light are not an error: the image is black.
#[test]
fn black_emitters_are_allowed() {
    let black = EmitterDescription::Environment {
        width: 2,
        pixels: vec![[0.0; 3]; 6],
        scale: 1.0,
        to_world: DMat4::IDENTITY,
    };
    let scene = scene(vec![emitting(floor(), Rgb::ZERO)], vec![black]);
    let mut numbers = Numbers::new(53);
    for _ in 0..100 {
        let start = sample_emission(&scene, &mut numbers);
        assert!(start.is_none_or(|start| start.weight == Rgb::ZERO));
    }
}
