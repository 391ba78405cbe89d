//! Metrolight's rays per second beside those of Embree 3: the same triangles and the same rays, on one
//! thread, in turns. `benches/embree/run.sh` compiles Embree's side and runs this.
//!
//! What is timed is what a renderer calls. Metrolight answers a closest-hit query with position, normals,
//! frame and texture coordinates; Embree with distance, barycentric coordinates and an unnormalised
//! normal.

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

/// Turns of each side; the first is not counted.
const TURNS: usize = 12;

/// Rays to edges and corners.
const EDGES: usize = 1 << 20;

/// Distances that differ by more than this are two hits.
const SAME: f32 = 1e-5 * SCENE_RADIUS;

/// Embree's modes.
const MODES: [&str; 2] = ["default", "robust"];

fn main() {
    // Cargo adds `--bench`.
    let program = std::env::args().skip(1).find(|arg| !arg.starts_with("--"));
    let Some(program) = program.map(PathBuf::from) else {
        println!("embree: left out; benches/embree/run.sh compiles the other side and runs it");
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
        let mut turns = Vec::new();
        for _ in 0..TURNS {
            let start = seconds();
            rays.trace(&subject.scene);
            let own = seconds() - start;
            let [a, b] = &mut others;
            turns.push([own, a.time(verb, rays.name), b.time(verb, rays.name)]);
        }
        let row = row(&rays, &turns[1..]);
        let differ = differ(subject, &rays, &mut others[1]);
        let (name, triangles) = (&subject.name, subject.triangles.len());
        println!(
            "| {name} | {triangles} | {} | {row} | {differ:.1e} |",
            rays.name
        );
    }
}

/// Of this thread, so that it matters little what else the machine does.
fn seconds() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

fn start(program: &Path, directory: &Path, subject: &Subject) -> [Embree; 2] {
    let corners = subject.triangles.iter().flatten().flatten();
    embree::write(&directory.join("triangles"), corners.copied());
    MODES.map(|mode| Embree::start(program, directory, mode))
}

/// Rates of all three, and the median ratio of a turn, with the least and the greatest.
fn row(rays: &Rays, turns: &[[f64; 3]]) -> String {
    let rate = |side: usize| {
        let [_, median, _] = spread(turns.iter().map(|turn| turn[side]));
        1e-6 * rays.rays.len() as f64 / median
    };
    let ratio = |side: usize| {
        let [least, median, greatest] = spread(turns.iter().map(|turn| turn[side] / turn[0]));
        format!(
            "{:.2} | **{median:.2}** ({least:.2} to {greatest:.2})",
            rate(side)
        )
    };
    format!("{:.2} | {} | {}", rate(0), ratio(1), ratio(2))
}

/// The least, the median and the greatest.
fn spread(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    [
        values[0],
        values[values.len() / 2],
        values[values.len() - 1],
    ]
}

/// The share of rays that meet something else, or nothing where the other meets something.
fn differ(subject: &Subject, rays: &Rays, other: &mut Embree) -> f64 {
    let verb = if rays.shadow { "check" } else { "find" };
    let own = rays.found(&subject.scene);
    let pairs = own.iter().zip(other.found(verb, rays.name));
    let differ = pairs
        .filter(|&(&a, b)| a != b && (a - b).abs().partial_cmp(&SAME).is_none_or(|o| o.is_gt()));
    differ.count() as f64 / own.len() as f64
}

/// How many rays get out of a closed mesh.
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
