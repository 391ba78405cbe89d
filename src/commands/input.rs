//! Images that commands read as input.

use std::path::Path;

use metrolight::film::{AnnotatedImage, Decode, read_annotated};
use miette::{bail, miette};

use super::output::STANDARD_ERROR;

/// Reads an image. Fails if the image or its standard errors are not finite everywhere.
pub fn read(path: &Path) -> miette::Result<AnnotatedImage> {
    let annotated = read_annotated(path, Decode::Srgb)
        .map_err(|error| miette!("{}: {error}", path.display()))?;
    check_finite(path, "", annotated.image.width, &annotated.image.pixels)?;
    if let Some(errors) = annotated.layers.get(STANDARD_ERROR) {
        check_finite(
            path,
            &format!("{STANDARD_ERROR}."),
            annotated.image.width,
            errors,
        )?;
    }
    Ok(annotated)
}

fn check_finite(
    path: &Path,
    prefix: &str,
    width: usize,
    pixels: &[[f32; 3]],
) -> miette::Result<()> {
    let is_finite = |pixel: &[f32; 3]| pixel.iter().all(|v| v.is_finite());
    let Some(i) = pixels.iter().position(|pixel| !is_finite(pixel)) else {
        return Ok(());
    };
    let channel = pixels[i].iter().position(|v| !v.is_finite()).unwrap_or(0);
    let count = pixels.iter().filter(|pixel| !is_finite(pixel)).count();
    let more = match count {
        1 => String::new(),
        n => format!(", and so are {} more pixels", n - 1),
    };
    bail!(
        "{}: channel {prefix}{} of the pixel in column {}, row {} (from 0, at the top left) is {}{more}: \
         only finite values can be compared",
        path.display(),
        ["R", "G", "B"][channel],
        i % width,
        i / width,
        pixels[i][channel]
    )
}
