//! The light transport operator of a diffuse room, discretised and solved, against the renderer.
//!
//! Radiance obeys L = Le + T L (Kajiya 1986; Veach 1997, section 4.3), so L = Le + T Le + T^2 Le + ...,
//! and paths of at most k edges carry the first k terms. Between diffuse patches T is a matrix of albedos
//! and form factors. The form factors are computed in closed form, with the part occluded by a block
//! clipped away: without rays or random numbers, and sharing only the room's geometry and colours with
//! the renderer. The error is proportional to the square of the patch size; two sizes give the limit by
//! extrapolation (Richardson 1911).
//!
//! Null hypothesis, for every tile, channel, depth and integrator: the mean over independent seeds is
//! that limit, within the known bound on its error. Student's test for each, and for the whole of each
//! image; Holm's correction over all. A correct program fails with probability ALPHA for a new choice of
//! seeds.

mod common;

#[path = "operator/form_factors.rs"]
mod form_factors;
#[path = "operator/room.rs"]
mod room;
#[path = "operator/views.rs"]
mod views;

use common::figures::{Accuracy, record};
use common::renders::renderings;
use common::renders::with_pssmlt;
use common::truths::p_value;
use glam::DVec3;
use metrolight::render::{Budget, Method, Rendering, Settings};
use metrolight::statistics::{Moments, holm};
use room::{Color, Solution};
use views::{View, views};

use Method::{Bdpt, Path, Pssmlt};

const ALPHA: f64 = 1e-3;
const SEEDS: u64 = 32;

/// Radiance below this is 0 up to the rounding of the reference.
const DARK: f64 = 1e-12;

const DEPTHS: [Option<u32>; 6] = [Some(1), Some(2), Some(3), Some(4), Some(6), None];

/// Resolution of the solution, and bounds on the relative error of its limit.
struct Precision {
    /// Patches along the width of the room.
    patches: [usize; 2],
    /// Of any tile; the worst are dark ones along the foot of the block.
    tile_error: f64,
    /// Of a whole image.
    image_error: f64,
}

/// The errors bound the difference to [`FINE`].
const COARSE: Precision = Precision {
    patches: [8, 16],
    tile_error: 3e-3,
    image_error: 5e-4,
};

const FINE: Precision = Precision {
    patches: [16, 32],
    tile_error: 1.5e-3,
    image_error: 2.5e-4,
};

/// Points along each side of a tile over which its mean is taken.
const POINTS: u32 = 6;

/// The limit of two solutions, whose errors have the ratio 4 to 1, by tile and depth.
fn limit(view: &View, [coarse, fine]: [&Solution; 2], points: u32) -> Vec<Vec<Color>> {
    let [coarse, fine] = [coarse, fine].map(|s| view.tile_means(s, &DEPTHS, points));
    let extrapolate = |c: &[Color], f: &[Color]| -> Vec<Color> {
        c.iter().zip(f).map(|(c, f)| (4.0 * f - c) / 3.0).collect()
    };
    coarse
        .iter()
        .zip(&fine)
        .map(|(c, f)| extrapolate(c, f))
        .collect()
}

/// The mean of a tile or image and its true value.
struct Comparison {
    name: String,
    found: Moments,
    truth: f64,
    /// Relative error allowed for the truth.
    slack: f64,
    whole_image: bool,
}

impl Comparison {
    fn p_value(&self) -> f64 {
        // Exactly 0, such as direct light on the lamp's own plane.
        if self.truth < DARK {
            return if self.found.mean == 0.0 { 1.0 } else { 0.0 };
        }
        p_value(&self.found, self.truth, self.slack)
    }

    fn relative_error(&self) -> f64 {
        self.found.standard_error() / self.truth
    }
}

/// Renders one view and compares all tiles, and the sum of them.
fn compare(
    view: &View,
    (depth, truth): (Option<u32>, &[Color]),
    precision: &Precision,
    integrator: Method,
    spp: u64,
    into: &mut Vec<Comparison>,
) {
    let scene = view.scene(depth);
    let truth: Vec<f64> = truth.iter().flat_map(|color| color.to_array()).collect();
    let mut tiles = vec![Moments::default(); truth.len()];
    let mut whole = Moments::default();
    let settings = with_pssmlt(
        Settings {
            budget: Budget::SamplesPerPixel(spp),
            ..Settings::new(integrator)
        },
        |own| {
            own.chains = 16;
            own.bootstrap = Some(2_000);
        },
    );
    for Rendering { image, .. } in renderings(&scene, &settings, 0..SEEDS) {
        let values: Vec<f64> = image
            .pixels
            .iter()
            .flatten()
            .map(|&v| f64::from(v))
            .collect();
        whole.add(values.iter().sum());
        for (moments, value) in tiles.iter_mut().zip(values) {
            moments.add(value);
        }
    }
    let name = format!("{}, {}, depth {depth:?}", view.name, integrator.name());
    into.push(Comparison {
        name: format!("{name}, all tiles"),
        found: whole,
        truth: truth.iter().sum(),
        slack: precision.image_error,
        whole_image: true,
    });
    for (i, (found, truth)) in tiles.into_iter().zip(truth).enumerate() {
        into.push(Comparison {
            name: format!("{name}, tile {}, channel {}", i / 3, i % 3),
            found,
            truth,
            slack: precision.tile_error,
            whole_image: false,
        });
    }
}

/// All views, depths and integrators, with `effort` times the samples.
fn assert_operator(precision: &Precision, effort: u64, case: &str) {
    let [coarse, fine] = precision.patches.map(Solution::new);
    let mut comparisons = Vec::new();
    for view in &views() {
        let truth = limit(view, [&coarse, &fine], POINTS);
        for (i, depth) in DEPTHS.into_iter().enumerate() {
            let truth: Vec<Color> = truth.iter().map(|tile| tile[i]).collect();
            if truth.iter().all(|color| *color == DVec3::ZERO) {
                continue;
            }
            for (integrator, spp) in [(Path, 150), (Bdpt, 40), (Pssmlt, 60)] {
                let spp = spp * effort;
                compare(
                    view,
                    (depth, &truth),
                    precision,
                    integrator,
                    spp,
                    &mut comparisons,
                );
            }
        }
    }
    let adjusted = holm(
        &comparisons
            .iter()
            .map(Comparison::p_value)
            .collect::<Vec<_>>(),
    );
    for (p, c) in adjusted.iter().zip(&comparisons) {
        let off = c.found.mean / c.truth - 1.0;
        let error = c.relative_error();
        if c.whole_image {
            println!(
                "{}: {:.3}% +- {:.3}%, p = {p:e}",
                c.name,
                100.0 * off,
                100.0 * error
            );
        }
        assert!(*p > ALPHA, "{}: off by {off} +- {error}, p = {p:e}", c.name);
    }
    report(case, &comparisons);
}

fn report(case: &str, comparisons: &[Comparison]) {
    let lit = comparisons.iter().filter(|c| c.truth >= DARK);
    let (whole, tiles): (Vec<_>, Vec<_>) = lit.partition(|c| c.whole_image);
    let median = |mut errors: Vec<f64>| {
        errors.sort_by(f64::total_cmp);
        100.0 * errors[errors.len() / 2]
    };
    let error = |of: &[&Comparison]| median(of.iter().map(|c| c.relative_error()).collect());
    let off = |of: &[&Comparison]| {
        median(
            of.iter()
                .map(|c| (c.found.mean / c.truth - 1.0).abs())
                .collect(),
        )
    };
    record(
        "accuracy",
        &Accuracy {
            oracle: "transport operator",
            case,
            found: format!(
                "median deviation of {} tiles {:.2}% (standard error {:.2}%), of {} images {:.3}% \
                 (standard error {:.3}%)",
                tiles.len(),
                off(&tiles),
                error(&tiles),
                whole.len(),
                off(&whole),
                error(&whole)
            ),
            demanded: format!("no mean differs: t-tests, p > {ALPHA:e} after Holm"),
        },
    );
}

/// Form factors from a point sum to 1 in a closed room, up to rounding.
#[test]
fn form_factors_add_up() {
    let error = Solution::new(8).closure_error();
    assert!(error < 1e-12, "{error:e}");
}

/// Twice as many patches and points change the limit by no more than the stated bounds.
#[test]
#[ignore = "takes two minutes"]
fn the_limit_has_the_stated_accuracy() {
    let [coarse, fine] = COARSE.patches.map(Solution::new);
    let finest = Solution::new(FINE.patches[1]);
    let (mut tile_error, mut image_error) = (0.0_f64, 0.0_f64);
    for view in &views() {
        let first = limit(view, [&coarse, &fine], POINTS);
        let second = limit(view, [&fine, &finest], 2 * POINTS);
        for depth in 0..DEPTHS.len() {
            let (mut sum, mut reference) = (0.0, 0.0);
            for (a, b) in first.iter().zip(&second) {
                for (a, b) in a[depth].to_array().into_iter().zip(b[depth].to_array()) {
                    if b > DARK {
                        tile_error = tile_error.max((a / b - 1.0).abs());
                        sum += a;
                        reference += b;
                    }
                }
            }
            if reference > 0.0 {
                image_error = image_error.max((sum / reference - 1.0_f64).abs());
            }
        }
    }
    let found = format!(
        "no tile differs by more than {:.2}%, no image by more than {:.3}%",
        100.0 * tile_error,
        100.0 * image_error
    );
    println!("{found}");
    record(
        "accuracy",
        &Accuracy {
            oracle: "transport operator",
            case: "its limit from 8 and 16 patches a side against that from 16 and 32",
            found,
            demanded: format!(
                "{:.2}% and {:.3}%",
                100.0 * COARSE.tile_error,
                100.0 * COARSE.image_error
            ),
        },
    );
    assert!(tile_error < COARSE.tile_error && image_error < COARSE.image_error);
}

#[test]
fn tiles_of_a_room() {
    let case = "room with a block, depths 1 to unbounded, path, bdpt, pssmlt";
    assert_operator(&COARSE, 1, case);
}

#[test]
#[ignore = "takes ten minutes"]
fn tiles_of_a_room_at_length() {
    assert_operator(&FINE, 12, "the same, 12 times the samples");
}
