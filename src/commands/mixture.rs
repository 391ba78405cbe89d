//! Files that do not belong together: an image whose preview or statistics are those of another render, because
//! a process was killed between writing them, or because one of them was replaced.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use metrolight::film::{AnnotatedImage, Decode, png_text, read_annotated};
use serde_json::Value;

use super::output::{ATTRIBUTE, RENDER};

/// The attribute of an image with the path of its statistics.
const STATISTICS: &str = "metrolight.files.statistics";

/// A sentence for each file beside the image at `path` that belongs to another render.
pub fn mixtures(path: &Path, image: &AnnotatedImage) -> Vec<String> {
    let Some(own) = image.text(ATTRIBUTE) else {
        return from_preview(path).into_iter().collect();
    };
    let preview = path.with_extension("png");
    let statistics = image.text(STATISTICS).and_then(|named| beside(path, named));
    let others = [
        png_text(&preview, ATTRIBUTE).map(|render| (preview, render)),
        statistics.and_then(|statistics| Some((statistics.clone(), render_of(&statistics)?))),
    ];
    let others = others.into_iter().flatten();
    others
        .filter(|(_, render)| render != own)
        .map(|(other, _)| mixture(path, &other))
        .collect()
}

/// The same for a preview, which has no attributes.
fn from_preview(path: &Path) -> Option<String> {
    let own = png_text(path, ATTRIBUTE)?;
    let image = path.with_extension("exr");
    let annotated = read_annotated(&image, Decode::Raw).ok()?;
    (annotated.text(ATTRIBUTE)? != own).then(|| mixture(path, &image))
}

fn mixture(path: &Path, other: &Path) -> String {
    format!(
        "{} and {} are not of one render: one of them was replaced alone, or a render was killed while it \
         wrote them",
        path.display(),
        other.display()
    )
}

/// The file that an image names, in the directory of the image.
fn beside(path: &Path, named: &str) -> Option<PathBuf> {
    Some(path.with_file_name(Path::new(named).file_name()?))
}

/// The identifier of the render whose statistics are in a file.
fn render_of(statistics: &Path) -> Option<String> {
    let file = BufReader::new(File::open(statistics).ok()?);
    let value: Value = serde_json::from_reader(file).ok()?;
    Some(value[RENDER].as_str()?.to_owned())
}
