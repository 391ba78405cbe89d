//! Time to load and check scenes that double in size: it doubles too, or nearly.
//!
//! Each of these scenes has once taken time in proportion to the square of its size.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use metrolight::analysis::lost_light;
use metrolight::mitsuba::{Loaded, load};
use metrolight::technique::TechniqueSet;

/// Numbers of shapes, attributes or letters.
const SIZES: [usize; 4] = [10_000, 20_000, 40_000, 80_000];

fn scene(contents: &str) -> String {
    format!(
        r#"<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>{contents}</scene>"#
    )
}

/// Spheres in a row, all on one line of the file.
fn one_line(n: usize) -> String {
    let mut text = String::new();
    for i in 0..n {
        let _ = write!(
            text,
            r#"<shape type="sphere"><point name="center" x="{i}" y="0" z="5"/></shape>"#
        );
    }
    scene(&text)
}

/// One element with many attributes, which is an error.
fn attributes(n: usize) -> String {
    let mut text = String::from("<shape type=\"sphere\"");
    for i in 0..n {
        let _ = write!(text, " a{i}=\"\"");
    }
    scene(&(text + "/>"))
}

/// One object with many parameters, which is an error.
fn parameters(n: usize) -> String {
    let mut text = String::from("<shape type=\"sphere\">");
    for i in 0..n {
        let _ = write!(text, "<float name=\"a{i}\" value=\"1\"/>");
    }
    scene(&(text + "</shape>"))
}

/// Many variables, each used once.
fn variables(n: usize) -> String {
    let mut text = String::new();
    for i in 0..n {
        let _ = write!(
            text,
            r#"<default name="v{i}" value="{i}"/>
            <shape type="sphere"><point name="center" x="$v{i}" y="0" z="5"/></shape>"#
        );
    }
    scene(&text)
}

/// A long name, which is an error.
fn long_name(n: usize) -> String {
    let name = "x".repeat(10 * n);
    scene(&format!("<shape type=\"{name}\"/>"))
}

fn load_text(path: &Path, text: &str) -> Option<Loaded> {
    fs::write(path, text).expect("written");
    load(path, &[]).map_err(|error| error.to_string()).ok()
}

fn loading(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.xml");
    type Text = fn(usize) -> String;
    let kinds: [(&str, Text); 5] = [
        ("one-line", one_line),
        ("attributes", attributes),
        ("parameters", parameters),
        ("variables", variables),
        ("long-name", long_name),
    ];
    for (kind, text) in kinds {
        let mut group = c.benchmark_group(format!("load/{kind}"));
        group.sample_size(10);
        for n in SIZES {
            let text = text(n);
            group.throughput(Throughput::Elements(n as u64));
            group.bench_function(BenchmarkId::from_parameter(n), |b| {
                b.iter(|| load_text(&path, &text));
            });
        }
    }
}

/// Coincident spheres: no tree can part them.
fn coincident(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.xml");
    let mut group = c.benchmark_group("check/coincident");
    group.sample_size(10);
    for n in SIZES {
        let sphere = r#"<shape type="sphere"><point name="center" x="0" y="0" z="5"/></shape>"#;
        let text = scene(&sphere.repeat(n));
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                let loaded = load_text(&path, &text).expect("a scene");
                let mut description = loaded.description;
                description.remove_coincident();
                let scene = description.build().expect("a scene");
                lost_light(&scene, TechniqueSet::Bidirectional).len()
            });
        });
    }
}

criterion_group!(benches, loading, coincident);
criterion_main!(benches);
