//! Corrupt files cause errors: no panics, and no memory allocated for sizes that they only claim.

use std::fs;
use std::path::Path;

use metrolight::film::{Decode, read_image};
use metrolight::mitsuba::load;
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use tempfile::TempDir;

use super::{BASE, fixtures};

/// Mutations of each file.
const MUTATIONS: usize = 200;

/// Truncates the file, changes a few bytes or words, or repeats a part.
fn mutated(bytes: &[u8], random: &mut impl Rng) -> Vec<u8> {
    let mut result = bytes.to_vec();
    for _ in 0..random.random_range(1..4) {
        if result.is_empty() {
            break;
        }
        let at = random.random_range(0..result.len());
        match random.random_range(0..5) {
            0 => result.truncate(at),
            1 => result[at] ^= 1 << random.random_range(0..8),
            2 => result[at] = random.random(),
            3 => {
                let end = (at + 4).min(result.len());
                result[at..end].fill(if random.random() { 0xFF } else { 0 });
            }
            _ => {
                let end = (at + random.random_range(1..40)).min(result.len());
                let stretch = result[at..end].to_vec();
                result.splice(at..at, stretch);
            }
        }
    }
    result
}

/// Calls `read` with many mutations of a fixture, and once with the fixture itself, which it must
/// accept.
fn assert_robust(fixture: &str, read: impl Fn(&Path) -> bool) {
    let source = fixtures().join(fixture);
    assert!(read(&source), "{fixture} as it is");
    let bytes = fs::read(&source).expect(fixture);
    let extension = source.extension().and_then(|e| e.to_str()).expect(fixture);
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join(format!("mutated.{extension}"));
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    for _ in 0..MUTATIONS {
        fs::write(&path, mutated(&bytes, &mut random)).expect("a writable file");
        read(&path);
    }
}

#[test]
fn broken_meshes_are_errors() {
    for fixture in [
        "quad.obj",
        "normals.obj",
        "groups.obj",
        "quad_ascii.ply",
        "quad_le.ply",
        "quad_be.ply",
        "v3.serialized",
        "v4.serialized",
    ] {
        let folder = TempDir::new().expect("a temporary folder");
        let scene = folder.path().join("scene.xml");
        assert_robust(fixture, |path| {
            let kind = fixture.rsplit('.').next().expect(fixture);
            let name = path.display();
            let index = if kind == "serialized" {
                r#"<integer name="shape_index" value="1"/>"#
            } else {
                ""
            };
            let text = format!(
                r#"<scene version="3.0.0">{BASE}<shape type="{kind}">
                   <string name="filename" value="{name}"/>{index}</shape></scene>"#
            );
            fs::write(&scene, text).expect("a writable file");
            load(&scene, &[]).is_ok()
        });
    }
}

#[test]
fn broken_images_are_errors() {
    for fixture in [
        "colors.png",
        "colors16.png",
        "grey.png",
        "flat.jpg",
        "colors.exr",
        "half.exr",
        "grey.exr",
        "colors.hdr",
    ] {
        assert_robust(fixture, |path| read_image(path, Decode::Srgb).is_ok());
    }
}

#[test]
fn broken_scenes_are_errors() {
    for fixture in ["everything.xml", "everything_06.xml"] {
        // With the fixtures in the search path, so that meshes and images are found.
        assert_robust(fixture, |path| {
            let text = fs::read_to_string(path).unwrap_or_default();
            let search = format!("<path value=\"{}\"/>", fixtures().display());
            let text = text.replacen("<default", &format!("{search}<default"), 1);
            let folder = TempDir::new().expect("a temporary folder");
            let copy = folder.path().join("scene.xml");
            fs::write(&copy, text).expect("a writable file");
            load(&copy, &[]).is_ok()
        });
    }
}
