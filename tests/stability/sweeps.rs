//! Error at fixed work as a parameter shrinks: lamps, roughness, a slit.
//!
//! Every point of a sweep is a scene with a reference of many times the work. The recorded rows make the
//! charts in `docs/stability.md`.

use glam::{DMat4, DVec3};
use metrolight::analysis::lost_light;
use metrolight::metrics::relative_mse;
use metrolight::render::{Budget, Method, Rendering, Settings, Unobserved, render};
use metrolight::scene::{ChainSearch, MicrofacetDistribution, Scene, TriangleMesh};
use metrolight::statistics::Moments;
use serde::Serialize;

use super::rooms::{
    BK7, OUT_OF_SIGHT, add_glass_ball, add_lamp, behind_one_pane, behind_two_panes, room,
};
use crate::common::figures::record;
use crate::common::renders::renderings;
use crate::common::renders::with_pssmlt;
use crate::common::wording;

/// The parameter that shrinks.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Sweep {
    /// Area of a lamp in a diffuse room.
    Lamp,
    /// Area of a lamp over a ball of glass with a visible caustic.
    LampOverGlass,
    /// Area of a lamp in a ball of glass, seen by a camera in another.
    LampBehindTwoPanes,
    /// Roughness of a ball of glass.
    Roughness,
    /// Width of a slit that all light passes.
    Slit,
}

const ALL: [Sweep; 5] = [
    Sweep::Lamp,
    Sweep::LampOverGlass,
    Sweep::LampBehindTwoPanes,
    Sweep::Roughness,
    Sweep::Slit,
];

const METHODS: [Method; 3] = [Method::Path, Method::Bdpt, Method::Pssmlt];

/// Samples or mutations per pixel of every tested image.
const WORK: u64 = 64;

/// Work per point of a sweep.
#[derive(Clone, Copy)]
struct Effort {
    /// Tested images.
    seeds: u64,
    /// Work of the reference, as a multiple of [`WORK`].
    reference: u64,
}

/// For charts.
const FULL: Effort = Effort {
    seeds: 4,
    reference: 32,
};

/// For assertions.
const QUICK: Effort = Effort {
    seeds: 2,
    reference: 12,
};

/// A point of a chart.
#[derive(Serialize)]
struct Row<'a> {
    sweep: Sweep,
    parameter: f64,
    integrator: &'a str,
    /// Mean over seeds, against the reference.
    relative_mse: f64,
    /// Mean of the images over the mean of the reference, and its standard error.
    found: f64,
    found_error: f64,
    told: Vec<String>,
}

impl Sweep {
    /// Values of the parameter, the easiest first.
    fn parameters(self) -> Vec<f64> {
        match self {
            Self::Lamp | Self::LampOverGlass | Self::LampBehindTwoPanes => {
                (0..=8).map(|i| 10.0_f64.powi(-i)).collect()
            }
            Self::Roughness => vec![0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 1e-3, 1e-4, 0.0],
            Self::Slit => vec![2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01],
        }
    }

    fn scene(self, parameter: f64) -> Scene {
        let radius = radius(parameter);
        let ball = DVec3::new(0.3, 0.7, 0.0);
        let mut builder = room();
        // Lamps are out of sight: one in view is brighter than all that it lights.
        match self {
            Self::Lamp => add_lamp(&mut builder, radius, OUT_OF_SIGHT),
            Self::LampOverGlass => {
                add_lamp(&mut builder, radius, OUT_OF_SIGHT);
                add_glass_ball(&mut builder, 0.6, ball);
            }
            Self::LampBehindTwoPanes => return behind_two_panes(radius),
            Self::Roughness => {
                add_lamp(&mut builder, 0.2, OUT_OF_SIGHT);
                if parameter > 0.0 {
                    let glass = builder.rough_glass(
                        MicrofacetDistribution::Beckmann,
                        BK7,
                        parameter as f32,
                    );
                    builder.sphere(ball, 0.6, glass);
                } else {
                    add_glass_ball(&mut builder, 0.6, ball);
                }
            }
            Self::Slit => {
                // A wall across the room, with a slit; the lamp is behind it.
                let half = 0.5 * (2.0 - 0.5 * parameter);
                let center = 0.25 * parameter + half;
                let wall = builder.diffuse_sheet(0.5);
                for x in [-center, center] {
                    let to_world = DMat4::from_translation(DVec3::new(x, 1.5, -0.5))
                        * DMat4::from_scale(DVec3::new(half, 2.0, 1.0));
                    builder.mesh(TriangleMesh::rectangle(), to_world, wall);
                }
                add_lamp(&mut builder, 0.1, DVec3::new(1.2, 1.5, -1.2));
            }
        }
        builder.build()
    }

    /// A reference by bidirectional path tracing with much work.
    fn reference(self, parameter: f64, effort: Effort) -> Vec<[f32; 3]> {
        let (scene, factor) = match self {
            Self::LampBehindTwoPanes => behind_one_pane(radius(parameter)),
            Self::Lamp | Self::LampOverGlass | Self::Roughness | Self::Slit => {
                (self.scene(parameter), 1.0)
            }
        };
        let settings = Settings {
            budget: Budget::SamplesPerPixel(effort.reference * WORK),
            seed: 1000,
            ..Settings::new(Method::Bdpt)
        };
        let image = render(&scene, &settings, &Unobserved)
            .expect("threads")
            .image;
        let scaled = |pixel: &[f32; 3]| pixel.map(|value| value * factor as f32);
        image.pixels.iter().map(scaled).collect()
    }

    fn rows(self, parameter: f64, effort: Effort) -> Vec<Row<'static>> {
        let scene = self.scene(parameter);
        let reference = self.reference(parameter, effort);
        METHODS
            .map(|integrator| {
                let (mut error, mut found) = (Moments::default(), Moments::default());
                let settings = with_pssmlt(
                    Settings {
                        budget: Budget::SamplesPerPixel(WORK),
                        ..Settings::new(integrator)
                    },
                    |own| {
                        own.bootstrap = Some(50_000);
                    },
                );
                for Rendering { image, .. } in renderings(&scene, &settings, 0..effort.seeds) {
                    error.add(relative_mse(&image.pixels, &reference));
                    found.add(mean(&image.pixels) / mean(&reference));
                }
                let lost = lost_light(&scene, integrator.techniques());
                Row {
                    sweep: self,
                    parameter,
                    integrator: integrator.name(),
                    relative_mse: error.mean,
                    found: found.mean,
                    found_error: found.standard_error(),
                    told: lost
                        .iter()
                        .map(|lost| wording::lost_light(lost, None))
                        .collect(),
                }
            })
            .into()
    }
}

/// Radius of a sphere of the given area, 4 pi r^2.
fn radius(area: f64) -> f64 {
    (area / (4.0 * std::f64::consts::PI)).sqrt()
}

fn mean(pixels: &[[f32; 3]]) -> f64 {
    pixels.iter().flatten().map(|&v| f64::from(v)).sum::<f64>() / (3 * pixels.len()) as f64
}

/// Rows of the easiest and of the hardest point of a sweep, by integrator.
fn ends(sweep: Sweep, hardest: f64) -> [Vec<Row<'static>>; 2] {
    [sweep.parameters()[0], hardest].map(|parameter| sweep.rows(parameter, QUICK))
}

/// The error of next event estimation does not depend on the size of a lamp.
#[test]
fn a_shrinking_lamp_costs_nothing_with_next_event_estimation() {
    let [large, small] = ends(Sweep::Lamp, 1e-8);
    for (large, small) in large.iter().zip(&small) {
        assert!(
            small.relative_mse < 2.0 * large.relative_mse && (small.found - 1.0).abs() < 0.1,
            "{}: {} after {}, {} found",
            small.integrator,
            small.relative_mse,
            large.relative_mse,
            small.found
        );
        assert!(small.told.is_empty(), "{:?}", small.told);
    }
}

/// Technique 1* finds a caustic whatever the size of the lamp, in path tracing too. What is reflected in the ball
/// more than once is lost: little light.
#[test]
fn a_shrinking_lamp_over_glass_is_found_by_all_methods() {
    for row in Sweep::LampOverGlass.rows(1e-6, QUICK) {
        assert!(
            (row.found - 1.0).abs() < 0.1,
            "{}: {}",
            row.integrator,
            row.found
        );
    }
}

/// Behind two panes only hits on the lamp find light, and technique 1*: nothing is lost with it, and without it
/// the loss is reported.
#[test]
fn a_lamp_behind_two_panes_is_found_whatever_its_size() {
    let told = |area: f64, chains: bool| {
        let mut scene = Sweep::LampBehindTwoPanes.scene(area);
        if !chains {
            scene.casters.set_search(ChainSearch::Off);
        }
        METHODS.map(|integrator| lost_light(&scene, integrator.techniques()).len())
    };
    assert_eq!(told(1.0, false), [0; 3]);
    let small = told(1e-7, false);
    assert!(small.iter().all(|&n| n > 0), "{small:?}");
    assert_eq!(told(1e-7, true), [0; 3]);
    for area in [1.0, 1e-7] {
        for row in Sweep::LampBehindTwoPanes.rows(area, QUICK) {
            let z = (row.found - 1.0) / row.found_error.max(0.05);
            assert!(z.abs() < 4.0, "{area}, {}: {}", row.integrator, row.found);
        }
    }
}

/// As rough glass becomes smooth, connections at it become impossible; other techniques find the light.
#[test]
fn error_stays_bounded_as_glass_becomes_smooth() {
    let [rough, smooth] = ends(Sweep::Roughness, 1e-3);
    for (rough, smooth) in rough.iter().zip(&smooth).skip(1) {
        assert!(
            (smooth.found - 1.0).abs() < 0.1,
            "{}: {}",
            smooth.integrator,
            smooth.found
        );
        assert!(
            smooth.relative_mse < 200.0 * rough.relative_mse,
            "{}: {} after {}",
            smooth.integrator,
            smooth.relative_mse,
            rough.relative_mse
        );
    }
}

/// As a slit closes, all methods find the remaining light.
#[test]
fn all_methods_find_the_light_through_a_slit() {
    for row in Sweep::Slit.rows(0.05, QUICK) {
        assert!(
            (row.found - 1.0).abs() < (5.0 * row.found_error).max(0.1),
            "{}: {} +- {}",
            row.integrator,
            row.found,
            row.found_error
        );
    }
}

/// All sweeps, for the charts. Takes some minutes.
#[test]
#[ignore = "takes minutes: METROLIGHT_FIGURES=target/figures cargo test --release --test stability sweeps -- --ignored"]
fn all_sweeps() {
    for sweep in ALL {
        for parameter in sweep.parameters() {
            for row in sweep.rows(parameter, FULL) {
                println!(
                    "{sweep:?} {parameter:e} {}: relMSE {:.2e}, found {:.3} +- {:.3}, {:?}",
                    row.integrator, row.relative_mse, row.found, row.found_error, row.told
                );
                assert!(row.relative_mse.is_finite());
                record("sweeps", &row);
            }
        }
    }
}
