//! Compares Metrolight's rays per second with those of Embree 3: the same triangles and the same rays, on
//! one thread, in alternating runs. `benches/embree/run.sh` compiles the program that calls Embree and runs
//! this benchmark.
//!
//! The queries are those of a renderer. Metrolight returns position, normals, frame and texture coordinates
//! of the closest hit; Embree returns distance, barycentric coordinates and an unnormalised normal.

#[path = "../common/mod.rs"]
mod common;
mod embree;
mod rays;
mod scenes;

use std::path::{Path, PathBuf};

use embree::Embree;
use metrolight::scene::SCENE_RADIUS;
use rays::Rays;
use rustix::time::{ClockId, clock_gettime};
use scenes::Subject;

/// Rays of each kind.
const RAYS: usize = 1 << 17;

/// Runs of each program; the first is not counted.
const RUNS: usize = 12;

/// Rays to edges and corners.
const EDGES: usize = 1 << 20;

/// Distances that differ by more than this belong to different hits.
const TOLERANCE: f32 = 1e-5 * SCENE_RADIUS;

/// Embree's modes.
const MODES: [&str; 2] = ["default", "robust"];

fn main() {
    // Cargo adds `--bench`.
    let program = std::env::args().skip(1).find(|arg| !arg.starts_with("--"));
    let Some(program) = program.map(PathBuf::from) else {
        println!(
            "embree: skipped; benches/embree/run.sh compiles the program that calls Embree and runs this benchmark"
        );
        return;
    };
    println!(
        "| scene | triangles | rays | Metrolight, M/s | Embree, M/s | ratio | robust Embree, M/s | ratio | differ from robust Embree |"
    );
    println!("| --- | --: | --- | --: | --: | --: | --: | --: | --: |");
    for subject in [
        scenes::of_repository("cornell"),
        scenes::of_repository("torus-in-glass"),
        scenes::of_repository("pool"),
        scenes::clutter("clutter", 45),
        scenes::clutter("clutter", 139),
    ] {
        compare(&program, &subject);
    }
    println!("\n| leaks of a closed mesh | of rays to its edges and corners |\n| --- | --: |");
    leaks(&program);
}

fn compare(program: &Path, subject: &Subject) {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let mut others = start(program, directory.path(), subject);
    for rays in rays::of_transport(&subject.scene, RAYS) {
        embree::write(&directory.path().join(rays.name), rays.floats());
        let verb = if rays.shadow { "shadow" } else { "closest" };
        let mut runs = Vec::new();
        for _ in 0..RUNS {
            let start = seconds();
            rays.trace(&subject.scene);
            let own = seconds() - start;
            let [a, b] = &mut others;
            runs.push([own, a.time(verb, rays.name), b.time(verb, rays.name)]);
        }
        let row = row(&rays, &runs[1..]);
        let differ = differ(subject, &rays, &mut others[1]);
        let (name, triangles) = (&subject.name, subject.triangles.len());
        println!(
            "| {name} | {triangles} | {} | {row} | {differ:.1e} |",
            rays.name
        );
    }
}

/// CPU time of this thread, which depends little on the load of the machine.
fn seconds() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

fn start(program: &Path, directory: &Path, subject: &Subject) -> [Embree; 2] {
    let corners = subject.triangles.iter().flatten().flatten();
    embree::write(&directory.join("triangles"), corners.copied());
    MODES.map(|mode| Embree::start(program, directory, mode))
}

/// Rates of all three, and the median ratio of a run, with the minimum and the maximum.
fn row(rays: &Rays, runs: &[[f64; 3]]) -> String {
    let rate = |side: usize| {
        let [_, median, _] = extremes(runs.iter().map(|run| run[side]));
        1e-6 * rays.rays.len() as f64 / median
    };
    let ratio = |side: usize| {
        let [min, median, max] = extremes(runs.iter().map(|run| run[side] / run[0]));
        format!("{:.2} | **{median:.2}** ({min:.2} to {max:.2})", rate(side))
    };
    format!("{:.2} | {} | {}", rate(0), ratio(1), ratio(2))
}

/// Minimum, median and maximum.
fn extremes(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    [
        values[0],
        values[values.len() / 2],
        values[values.len() - 1],
    ]
}

/// Fraction of rays whose hit differs from that of the other program, or which only one of them finds.
fn differ(subject: &Subject, rays: &Rays, other: &mut Embree) -> f64 {
    let verb = if rays.shadow { "check" } else { "find" };
    let own = rays.found(&subject.scene);
    let pairs = own.iter().zip(other.found(verb, rays.name));
    let differ = pairs.filter(|&(&a, b)| {
        a != b
            && (a - b)
                .abs()
                .partial_cmp(&TOLERANCE)
                .is_none_or(|o| o.is_gt())
    });
    differ.count() as f64 / own.len() as f64
}

/// Prints the number of rays that leave a closed mesh.
fn leaks(program: &Path) {
    let subject = scenes::ball(60);
    let directory = tempfile::tempdir().expect("a temporary directory");
    let mut others = start(program, directory.path(), &subject);
    let rays = rays::to_edges(&subject, EDGES);
    embree::write(&directory.path().join(rays.name), rays.floats());
    let escaped = |found: Vec<f32>| found.iter().filter(|t| t.is_infinite()).count();
    println!(
        "| Metrolight | {} of {EDGES} |",
        escaped(rays.found(&subject.scene))
    );
    for (mode, other) in MODES.iter().zip(&mut others) {
        let count = escaped(other.found("find", rays.name));
        println!("| Embree, {mode} | {count} of {EDGES} |");
    }
}
