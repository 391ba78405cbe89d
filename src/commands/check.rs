//! `metrolight check`: lists what a scene contains, and warns of light that no render shows.

use std::collections::BTreeMap;
use std::io::{IsTerminal, stderr};

use metrolight::analysis::{near_surfaces, odd_view};
use metrolight::film::Filter;
use metrolight::mitsuba::LoadError;
use metrolight::render::{Memory, Method, Settings};
use metrolight::scene::{Material, Scene, Texture};
use metrolight::technique::TechniqueSet;
use serde_json::{Map, Value, json};

use super::numbers::quantity;
use super::progress::Progress;
use super::source::SceneArgs;
use super::{Outcome, print, warn, wording};

/// Load a scene, list what it contains, and warn of light that cannot be found
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  metrolight check scenes/pool/scene.xml

Exit codes: 0 the scene can be rendered (perhaps with warnings), 2 it cannot")]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Print one JSON object on stdout instead: the contents and warnings, or the errors
    #[arg(long)]
    json: bool,
}

/// Prints the scene on stdout and warnings on stderr, or both as JSON on stdout.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    let opened = match args.scene.open(None) {
        Err(report) if args.json => {
            let errors = messages(&report);
            print(json!({ "scene": args.scene.path, "loads": false, "errors": errors }))?;
            return Err(report);
        }
        opened => opened?,
    };
    let progress = Progress::new(args.json, stderr().is_terminal());
    let mut warnings = opened.warnings.clone();
    warnings.extend(odd_view(&opened.scene).iter().map(wording::odd_view));
    warnings.extend(near_surfaces(&opened.scene).map(|near| wording::near_surfaces(&near)));
    warnings.extend(opened.lost_light(TechniqueSet::Bidirectional, None, &progress));
    let contents = describe(&opened.scene);
    if args.json {
        let contents: Map<String, Value> = contents
            .into_iter()
            .map(|(what, text)| (what.into(), text.into()))
            .collect();
        print(json!({
            "scene": args.scene.path,
            "loads": true,
            "contents": contents,
            "warnings": warnings,
        }))?;
        return Ok(Outcome::Done);
    }
    print(args.scene.path.display())?;
    for (what, text) in contents {
        print(format_args!("  {what:<10} {text}"))?;
    }
    if let Some(choice) = &opened.specular {
        print(format_args!(
            "  {:<10} {}",
            "",
            wording::specular_choice(choice)
        ))?;
    }
    print(format_args!("  {:<10} {}", "time", opened.times()))?;
    warn(&warnings);
    Ok(Outcome::Done)
}

/// The message of an error, and those of the faults found after it.
fn messages(report: &miette::Report) -> Vec<String> {
    match report.downcast_ref::<LoadError>() {
        Some(error) => error.faults().map(ToString::to_string).collect(),
        None => vec![report.to_string()],
    }
}

fn describe(scene: &Scene) -> Vec<(&'static str, String)> {
    let emitters = 0..scene.emitters.len() as u32;
    vec![
        ("image", image(scene)),
        ("camera", camera(scene)),
        ("depth", depth(scene)),
        ("shapes", shapes(scene)),
        ("bounds", bounds(scene)),
        ("memory", memory(scene)),
        (
            "materials",
            by_kind(scene.materials.iter().map(Material::name)),
        ),
        (
            "emitters",
            by_kind(emitters.map(|i| scene.emitters.kind(i).name())),
        ),
        ("chains", chains(scene)),
    ]
}

/// Memory of the scene, and of renders with default settings.
fn memory(scene: &Scene) -> String {
    let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
    let bytes = |bytes: u64| format!("{}B", quantity(bytes as f64));
    let textures = scene
        .textures
        .iter()
        .map(Texture::memory_bytes)
        .sum::<usize>();
    let render = |method: Method| {
        let memory = Memory::of(&Settings::new(method), pixels);
        format!("{} {}", method.name(), bytes(memory.total()))
    };
    let renders: Vec<String> = Method::ALL.into_iter().map(render).collect();
    format!(
        "geometry {}, textures {}; besides them, film and chains of {}",
        bytes(scene.geometry.memory_bytes() as u64),
        bytes(textures as u64),
        renders.join(", ")
    )
}

/// Which chains of specular vertices next event estimation seeks.
fn chains(scene: &Scene) -> String {
    if !scene.has_chains() {
        return "none are sought through smooth glass or mirrors".into();
    }
    let shapes = 0..scene.geometry.shape_count() as u32;
    let lengths = shapes.filter_map(|shape| {
        let length = scene.casters.max_length_on(shape);
        (length > 0).then(|| format!("{} ({length})", scene.geometry.shape_name(shape)))
    });
    let lengths: Vec<String> = lengths.collect();
    let some = match &lengths[..] {
        [first, second, rest @ ..] if rest.len() > 2 => {
            format!("{first}, {second} and {} more", rest.len())
        }
        few => few.join(", "),
    };
    let emitters = 0..scene.emitters.len() as u32;
    let ends = emitters.filter(|&emitter| scene.emitters.ends_chains(emitter));
    format!(
        "sought to {} of {} emitters through (vertices) {some}",
        ends.count(),
        scene.emitters.len()
    )
}

fn image(scene: &Scene) -> String {
    let film = &scene.film;
    let filter = match film.filter {
        Filter::Box => "box".into(),
        Filter::Tent { radius } => format!("tent of radius {radius}"),
        Filter::Gaussian { stddev } => format!("Gaussian of standard deviation {stddev}"),
    };
    let part = film.crop.map_or(String::new(), |crop| {
        let ([left, top], [width, height]) = (crop.offset, crop.size);
        format!(", of which {width} x {height} from column {left} and row {top} on are kept")
    });
    format!(
        "{} x {} pixels{part}, filter {filter}",
        film.width, film.height
    )
}

fn camera(scene: &Scene) -> String {
    let camera = &scene.camera;
    if camera.is_orthographic() {
        "orthographic"
    } else if camera.has_lens() {
        "thin lens"
    } else {
        "pinhole"
    }
    .into()
}

fn depth(scene: &Scene) -> String {
    let longest = match scene.depth.max_depth {
        Some(n) => format!("at most {n} edges"),
        None => "no limit".into(),
    };
    format!(
        "{longest}, Russian roulette from {} edges on",
        scene.depth.rr_depth
    )
}

fn shapes(scene: &Scene) -> String {
    let geometry = &scene.geometry;
    let left_out = match geometry.degenerate_count() {
        0 => String::new(),
        n => format!(", {n} without area left out"),
    };
    format!(
        "{} (triangles {}, spheres {}{left_out})",
        geometry.shape_count(),
        geometry.triangle_count(),
        geometry.sphere_count(),
    )
}

/// Corners of the bounding box of all surfaces, in units of the scene file, with five digits of the
/// largest coordinate.
fn bounds(scene: &Scene) -> String {
    let Some((low, high)) = scene.world_bounds() else {
        return "no surfaces".into();
    };
    let corners = [low, high];
    let largest = corners.map(|corner| corner.abs().max_element());
    let decimals = (4.0 - largest[0].max(largest[1]).max(1e-300).log10().floor()).max(0.0);
    let [low, high] = corners.map(|corner| {
        // Rounding and adding 0 avoids -0.
        let step = 10.0_f64.powf(decimals);
        let numbers = corner
            .to_array()
            .map(|x| format!("{:.*}", decimals as usize, (x * step).round() / step + 0.0));
        format!("({})", numbers.join(", "))
    });
    format!("{low} to {high}")
}

/// `2 area, 1 point`.
fn by_kind(names: impl Iterator<Item = &'static str>) -> String {
    let mut counts = BTreeMap::new();
    for name in names {
        *counts.entry(name).or_insert(0) += 1;
    }
    let counts: Vec<String> = counts
        .iter()
        .map(|(name, n)| format!("{n} {name}"))
        .collect();
    counts.join(", ")
}
