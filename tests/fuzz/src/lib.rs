//! What the fuzz targets do with their bytes. See README.md beside it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use glam::Vec3A;
use metrolight::film::{Decode, png_text, read_annotated, read_image};
use metrolight::integrators::{
    BidirectionalPathTracer, LightTracer, PathSampler, PathTracer, SplatList, Workspace,
};
use metrolight::metrics::{Estimate, image_errors, test_bias};
use metrolight::mitsuba::{LoadError, load};
use metrolight::sampling::IndependentSampler;
use metrolight::sampling::seeds::Purpose;
use metrolight::sampling::warp::square_to_sphere;
use metrolight::scene::{Ray, RayCounts, SCENE_RADIUS, Scene};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use tempfile::TempDir;

/// Longest path: a scene may ask for endless ones, between mirrors without loss.
const MOST_EDGES: u32 = 12;
/// Rays for each scene that loads, and samples of each path sampler.
const RAYS: usize = 8;
const SAMPLES: u64 = 4;

/// Files that scenes may name, from the tests of the loader.
const FIXTURES: [(&str, &[u8]); 9] = [
    ("colors.exr", include_bytes!("../../fixtures/colors.exr")),
    ("colors.hdr", include_bytes!("../../fixtures/colors.hdr")),
    ("colors.png", include_bytes!("../../fixtures/colors.png")),
    ("flat.jpg", include_bytes!("../../fixtures/flat.jpg")),
    ("quad.obj", include_bytes!("../../fixtures/quad.obj")),
    ("normals.obj", include_bytes!("../../fixtures/normals.obj")),
    ("quad_le.ply", include_bytes!("../../fixtures/quad_le.ply")),
    (
        "quad_ascii.ply",
        include_bytes!("../../fixtures/quad_ascii.ply"),
    ),
    (
        "v4.serialized",
        include_bytes!("../../fixtures/v4.serialized"),
    ),
];

/// A folder for the files that loaders read: in memory where the system has such a place.
static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
    let memory = Path::new("/dev/shm");
    let folder = if memory.is_dir() {
        TempDir::new_in(memory)
    } else {
        TempDir::new()
    };
    let folder = folder.expect("a temporary folder");
    for (name, bytes) in FIXTURES {
        fs::write(folder.path().join(name), bytes).expect("a fixture");
    }
    folder
});

fn file(name: &str) -> PathBuf {
    FOLDER.path().join(name)
}

fn write(path: &Path, bytes: &[u8]) {
    fs::write(path, bytes).expect("a writable file");
}

/// Loads a scene file and renders what it describes.
pub fn scene(bytes: &[u8]) {
    let path = file("scene.xml");
    write(&path, bytes);
    if let Err(error) = load_and_render(&path) {
        report(error);
    }
}

/// Loads a mesh and renders it: as it is, and as an emitter with other options.
pub fn mesh(kind: &str, bytes: &[u8]) {
    write(&file(&format!("mesh.{kind}")), bytes);
    let other = match kind {
        "serialized" => r#"<integer name="shape_index" value="1"/>"#,
        _ => r#"<boolean name="flip_tex_coords" value="true"/>"#,
    };
    let emitting =
        format!(r#"<emitter type="area"/><boolean name="face_normals" value="true"/>{other}"#);
    for options in ["", &emitting] {
        let text = format!(
            r#"<scene version="3.0.0"><sensor type="perspective">
            <transform name="to_world"><lookat origin="1,2,3" target="0,0,0"/></transform>
            </sensor><emitter type="constant"/><shape type="{kind}">
            <string name="filename" value="mesh.{kind}"/>{options}<bsdf type="diffuse">
            <texture name="reflectance" type="checkerboard"/></bsdf></shape></scene>"#
        );
        let scene = file(&format!("with_{kind}.xml"));
        write(&scene, text.as_bytes());
        if let Err(error) = load_and_render(&scene) {
            drop(error.to_string());
        }
    }
}

/// Reads an image whose name ends in `extension`.
pub fn image(extension: &str, bytes: &[u8]) {
    let path = file(&format!("image.{extension}"));
    write(&path, bytes);
    match read_image(&path, Decode::Srgb) {
        Ok(image) => {
            assert!(image.width > 0 && image.height > 0);
            assert_eq!(image.pixels.len(), image.width * image.height);
        }
        Err(error) => drop(error.to_string()),
    }
}

/// Reads an image with its layers and attributes, measures it against itself, and tests for bias. The first byte
/// chooses between OpenEXR and PNG.
pub fn reference(bytes: &[u8]) {
    let Some((format, bytes)) = bytes.split_first() else {
        return;
    };
    let extension = if format % 2 == 0 { "exr" } else { "png" };
    let path = file(&format!("reference.{extension}"));
    write(&path, bytes);
    drop(png_text(&path, "metrolight.render"));
    let Ok(annotated) = read_annotated(&path, Decode::Srgb) else {
        return;
    };
    let is_finite = |pixels: &[[f32; 3]]| pixels.as_flattened().iter().all(|v| v.is_finite());
    let layers = annotated.layers.values();
    // The command refuses any others.
    if !is_finite(&annotated.image.pixels) || !layers.map(|v| &v[..]).all(is_finite) {
        return;
    }
    let image = &annotated.image;
    let errors = image_errors(&image.pixels, &image.pixels);
    assert_eq!(errors.mse, 0.0);
    if let Some(standard_errors) = annotated.layers.get("standard_error") {
        let estimate = Estimate {
            pixels: &image.pixels,
            standard_errors,
            parts: annotated
                .number("metrolight.error.independent_parts")
                .filter(|&n| n >= 2.0)
                .map(|n| n as u64),
            independent_pixels: false,
        };
        drop(test_bias(&estimate, &estimate, image.width));
    }
}

/// Errors are those of loading alone.
fn load_and_render(path: &Path) -> Result<(), LoadError> {
    let loaded = load(path, &[])?;
    for warning in &loaded.warnings {
        drop(warning.to_string());
    }
    let mut description = loaded.description;
    let most = description.depth.max_depth.unwrap_or(MOST_EDGES);
    description.depth.max_depth = Some(most.min(MOST_EDGES));
    match description.build() {
        Ok(scene) => render(&scene),
        Err(error) => drop(error.to_string()),
    }
    Ok(())
}

/// Shows the error as the command does, with the line and a caret under the fault.
fn report(error: LoadError) {
    let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode());
    let mut text = String::new();
    handler
        .render_report(&mut text, &error)
        .expect("a report that can be shown");
    assert!(!error.to_string().is_empty());
}

/// Random rays, and samples of every path sampler.
fn render(scene: &Scene) {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut rays = RayCounts::default();
    for _ in 0..RAYS {
        let mut sphere = || square_to_sphere(rng.random::<[f32; 2]>().into());
        let (direction, position) = (sphere(), sphere());
        let origin: Vec3A = position * SCENE_RADIUS * rng.random_range(0.0..1.5);
        let ray = Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
        };
        if let Some(surface) = scene.geometry.intersect(&ray, &mut rays) {
            assert!((surface.shape as usize) < scene.geometry.shape_count());
            scene.geometry.visible(origin, surface.position, &mut rays);
        }
    }
    sample(scene, BidirectionalPathTracer);
    sample(scene, PathTracer);
    sample(scene, LightTracer);
}

fn sample(scene: &Scene, path_sampler: impl PathSampler) {
    let (mut workspace, mut splats) = (Workspace::default(), SplatList::default());
    for i in 0..SAMPLES {
        let mut sampler = IndependentSampler::new(0, Purpose::Pixels, i);
        path_sampler.sample_splats(scene, &mut sampler, &mut workspace, &mut splats);
    }
}
