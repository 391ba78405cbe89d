//! Each technique (s, t) alone: which paths it finds, and how much light they carry.
//!
//! Veach (1997, section 8.3) predicts which techniques find a path from its class, the sequence of diffuse
//! and specular vertices. Each predicted technique must find paths of the class; unweighted, they must all
//! find the same light; no other technique may find any; and light that none finds must be reported as
//! lost.
//!
//! Statistical tests have fixed seeds and reject at p < ALPHA after Holm's correction: a correct
//! program fails one of them with that probability for a new choice of seeds.

mod common;

#[path = "techniques/classes.rs"]
mod classes;
#[path = "techniques/measure.rs"]
mod measure;
#[path = "techniques/plates.rs"]
mod plates;

use std::collections::BTreeSet;

use classes::{Class, Emitter, Lens, finds, techniques};
use common::figures::{Accuracy, record};
use common::truths::images;
use measure::{HALVES, Key, Measured};
use metrolight::analysis::{Loss, lost_light};
use metrolight::math::{Rgb, luminance};
use metrolight::render::Method;
use metrolight::scene::Scene;
use metrolight::statistics::{Moments, holm, welch};
use metrolight::technique::TechniqueSet;
use plates::plates;

const ALPHA: f64 = 1e-4;

/// Pairs of subpaths per scene.
const SAMPLES: usize = 512_000;

/// A class is tested if one technique has found this many of its paths; then every other technique that can
/// find it must have found some.
const ENOUGH: u64 = 2000;

/// Too few paths give no reliable variance.
const TESTABLE: u64 = 200;

/// A scene and the measurements of its techniques.
struct Case {
    emitter: Emitter,
    lens: Lens,
    scene: Scene,
    measured: Measured,
}

impl Case {
    fn new(emitter: Emitter, lens: Lens, glass: bool, depth: u32, samples: usize) -> Self {
        let scene = plates(emitter, lens, glass, depth);
        let measured = Measured::new(&scene, samples);
        Self {
            emitter,
            lens,
            scene,
            measured,
        }
    }

    fn name(&self) -> String {
        format!("{:?} light, {:?} lens", self.emitter, self.lens)
    }

    fn predicted(&self, class: Class, technique: (usize, usize)) -> bool {
        // Directly visible lights are left to technique (0, 2).
        technique != (1, 1) && finds(self.emitter, self.lens, class, technique)
    }

    /// Asserts that exactly the predicted techniques find each class; returns the classes with enough
    /// paths.
    fn assert_predicted_sets(&self) -> Vec<Class> {
        let measured = &self.measured;
        let mut judged = Vec::new();
        for class in measured.classes() {
            let all: Vec<_> = techniques(class.edges()).collect();
            let most = all
                .iter()
                .map(|&t| measured.class_paths(class, t))
                .max()
                .unwrap_or(0);
            for technique in all {
                let paths = measured.class_paths(class, technique);
                let name = format!("{}: {class} by {technique:?}: {paths} paths", self.name());
                if !self.predicted(class, technique) {
                    assert_eq!(paths, 0, "{name}, but none is possible");
                } else if most >= ENOUGH {
                    assert!(paths > 0, "{name}, where another technique finds {most}");
                }
            }
            if most >= ENOUGH {
                judged.push(class);
            }
        }
        judged
    }

    /// Null hypotheses, for each class and half of the film: all techniques alone have the same mean, which
    /// is also that of their weighted sum.
    fn agreements(&self, classes: &[Class]) -> Vec<(f64, String)> {
        let measured = &self.measured;
        let mut tests = Vec::new();
        for &class in classes {
            for (half, side) in HALVES.iter().enumerate() {
                let key = |technique| Key {
                    class,
                    technique,
                    half,
                };
                let alone = |technique| measured.alone(&key(technique));
                let able: Vec<_> = techniques(class.edges())
                    .filter(|&technique| measured.paths(&key(technique)) >= TESTABLE)
                    .collect();
                let weighted = measured.weighted(|key| key.class == class && key.half == half);
                let name = format!("{}, {side}: {class}", self.name());
                for (i, &a) in able.iter().enumerate() {
                    let found = alone(a);
                    for &b in &able[i + 1..] {
                        tests.push(compare(
                            &format!("{name} by {a:?} and {b:?}"),
                            &found,
                            &alone(b),
                        ));
                    }
                    tests.push(compare(
                        &format!("{name} by {a:?} and all"),
                        &found,
                        &weighted,
                    ));
                }
                // The only technique of a class has weight 1.
                let predicted = techniques(class.edges()).filter(|&t| self.predicted(class, t));
                if let ([only], 1) = (able.as_slice(), predicted.count()) {
                    let off = weighted.mean - alone(*only).mean;
                    assert!(off.abs() <= 1e-6 * weighted.mean, "{name}: {off:e}");
                }
            }
        }
        tests
    }

    /// Asserts that the report of lost light names the surfaces that a sampler renders too dark, because
    /// none of its techniques finds their classes.
    fn assert_lost_light_is_reported(&self) {
        let behind = &self.measured.behind;
        let (mut path, mut bidirectional) = (BTreeSet::new(), BTreeSet::new());
        // Camera subpaths can hit area lights.
        if self.emitter != Emitter::Area {
            path = behind.lit.clone();
            bidirectional = behind.lit.intersection(&behind.seen).cloned().collect();
        }
        for (sampler, expected) in [
            (TechniqueSet::Path, &path),
            (TechniqueSet::Light, &behind.seen),
            (TechniqueSet::Bidirectional, &bidirectional),
        ] {
            let name = format!("{}, {sampler:?}", self.name());
            assert_eq!(lost(&self.scene, sampler), *expected, "{name}");
            let clear = plates(self.emitter, self.lens, false, 6);
            assert!(lost(&clear, sampler).is_empty(), "{name} without glass");
        }
    }

    /// Null hypothesis, for each integrator: the mean of its image is the light of the classes that its
    /// techniques find.
    fn images(&self, spp: u64) -> Vec<(f64, String)> {
        Method::ALL
            .into_iter()
            .map(|integrator| {
                let of_sampler = |key: &Key| {
                    techniques(key.class.edges()).any(|(s, t)| {
                        makes(integrator.techniques(), s, t)
                            && finds(self.emitter, self.lens, key.class, (s, t))
                    })
                };
                let expected = self.measured.weighted(of_sampler);
                let found: Moments = images(&self.scene, integrator, spp)
                    .map(|rendering| {
                        let pixels = &rendering.image.pixels;
                        let light = pixels.iter().map(|p| f64::from(luminance(Rgb::from(*p))));
                        light.sum::<f64>() / pixels.len() as f64
                    })
                    .collect();
                let name = format!("{}: image by {}", self.name(), integrator.name());
                compare(&name, &found, &expected)
            })
            .collect()
    }
}

/// True if `techniques` has technique (s, t).
fn makes(techniques: TechniqueSet, s: usize, t: usize) -> bool {
    match techniques {
        TechniqueSet::Path => s <= 1,
        TechniqueSet::Light => t == 1,
        TechniqueSet::Bidirectional => t >= 1,
    }
}

fn compare(name: &str, a: &Moments, b: &Moments) -> (f64, String) {
    let show = |m: &Moments| format!("{} +- {}", m.mean, m.standard_error());
    (welch(a, b), format!("{name}: {}, {}", show(a), show(b)))
}

/// Names of the surfaces with light that is lost with certainty.
fn lost(scene: &Scene, techniques: TechniqueSet) -> BTreeSet<String> {
    lost_light(scene, techniques)
        .into_iter()
        .filter(|lost| lost.loss == Loss::Always)
        .flat_map(|lost| lost.surfaces)
        .collect()
}

/// Asserts that no test rejects; returns the smallest corrected p-value.
fn settle(tests: &[(f64, String)]) -> f64 {
    let adjusted = holm(&tests.iter().map(|t| t.0).collect::<Vec<_>>());
    for (p, (_, text)) in adjusted.iter().zip(tests) {
        assert!(*p > ALPHA, "{text}, p = {p:e}");
    }
    adjusted.into_iter().fold(1.0, f64::min)
}

#[test]
fn every_technique_alone_finds_the_same_light() {
    for lens in [Lens::Pinhole, Lens::Thin] {
        let case = Case::new(Emitter::Area, lens, false, 5, SAMPLES);
        let judged = case.assert_predicted_sets();
        let all = ["", "D", "DD", "DDD", "DDDD"].map(Class::parse);
        assert_eq!(judged, all, "path lengths 1 to 5");
        let mut tests = case.agreements(&judged);
        tests.extend(case.images(50));
        let p = settle(&tests);
        record(
            "accuracy",
            &Accuracy {
                oracle: "techniques alone",
                case: &format!("diffuse plates, {lens:?} lens, lengths 1 to 5, all (s, t)"),
                found: format!("{} comparisons, smallest p {p:.2}", tests.len()),
                demanded: format!("Welch tests, p > {ALPHA:e} after Holm"),
            },
        );
    }
}

/// The scene with a sphere light shows which classes exist; with a point light in its place some of them
/// are lost.
#[test]
fn techniques_find_the_predicted_classes_and_the_rest_is_reported() {
    let area = Case::new(Emitter::Area, Lens::Pinhole, true, 6, SAMPLES);
    let point = Case::new(Emitter::Point, Lens::Pinhole, true, 6, SAMPLES);
    let directional = Case::new(Emitter::Directional, Lens::Thin, true, 6, SAMPLES);
    let common = [
        "D", "DD", "SD", "SSD", "DS", "DSS", "SDD", "DDS", "DDD", "SSDD",
    ];
    let no_pair = ["SDS", "SSDSS", "SDSS", "SSDS"];
    let mut tests = Vec::new();
    let mut classes = 0;
    for case in [&area, &point, &directional] {
        case.assert_lost_light_is_reported();
        let judged = case.assert_predicted_sets();
        let mut expected = common.map(Class::parse).to_vec();
        if case.emitter == Emitter::Area {
            expected.push(Class::parse(""));
            expected.extend(no_pair.map(Class::parse));
        }
        for class in expected {
            assert!(
                case.measured.classes().contains(&class),
                "{}: too little of {class}",
                case.name()
            );
        }
        tests.extend(case.agreements(&judged));
        tests.extend(case.images(50));
        classes += judged.len();
    }
    let p = settle(&tests);
    // The light lost with the point light exists: it is found with the sphere light in its place.
    let between = &area.measured.behind.both;
    assert!(between.contains("floor"), "{between:?}");
    assert!(between.is_subset(&lost(&point.scene, TechniqueSet::Bidirectional)));
    record(
        "accuracy",
        &Accuracy {
            oracle: "techniques alone",
            case: "plates with glass and mirror, three kinds of emitter, lengths 1 to 6",
            found: format!(
                "{classes} classes of paths found by exactly the techniques predicted; {} comparisons \
                 of means, smallest p {p:.2}",
                tests.len()
            ),
            demanded: format!(
                "no path by another technique; Welch tests, p > {ALPHA:e} after Holm"
            ),
        },
    );
}
