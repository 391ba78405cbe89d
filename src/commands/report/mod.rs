//! `metrolight report`: one HTML page of the results of other commands in a directory.

mod folder;
mod images;
mod page;
mod records;
mod sections;

use std::path::{Path, PathBuf};

use askama::Template;
use miette::{IntoDiagnostic, bail};

use self::folder::{EXPECTED, Folder};
use self::page::{Page, SCRIPT, STYLE, Viewer};
use super::files::{Content, OutputFiles};
use super::output::write_text;
use super::{Outcome, print, values, warn};

/// Make one HTML page of the results of other commands in a directory
///
/// The page shows the charts and tables of converge, the verdict of diagnose, the error images of
/// compare and the contact sheets of strategies. A viewer compares the images, with zoom, exposure and
/// relative errors. The page is a single file that needs no network and no server.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  metrolight converge scenes/cornell/scene.xml --integrators bdpt,pssmlt --time 20s -o cornell
  metrolight diagnose scenes/cornell/scene.xml --integrator pssmlt -o cornell
  metrolight report cornell                          writes cornell/report.html
  metrolight report cornell -o cornell.html

Exit codes: 0 written, 2 bad input")]
pub struct Args {
    /// Directory that converge, diagnose, compare, strategies or render wrote into
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    /// HTML file to write [default: DIR/report.html]
    #[arg(short, long, value_name = "FILE.html", value_parser = values::html_path())]
    output: Option<PathBuf>,

    /// Print nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
}

/// Reads the results, assembles the page and writes it.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    let folder = Folder::open(&args.directory)?;
    let output = match &args.output {
        Some(path) => path.clone(),
        None => args.directory.join("report.html"),
    };
    let mut outputs = OutputFiles::default();
    outputs.add(&output, Content::Text, "-o");
    outputs.check_writable(0)?;

    // Read the sections.
    let convergence = sections::convergence(&folder)?;
    let table = convergence.as_ref().and_then(|c| c.table.as_ref());
    let images = images::find(&folder, table.map_or(&[], |table| &table.stems));
    let page = Page {
        title: title(&args.directory),
        version: env!("CARGO_PKG_VERSION"),
        diagnosis: sections::diagnosis(&folder)?,
        comparison: sections::comparison(&folder)?,
        strategies: sections::strategies(&folder)?,
        images: Viewer::new(&images),
        convergence,
        origins: images.iter().filter_map(sections::origin).collect(),
        style: STYLE,
        script: SCRIPT,
    };
    let shown = page.sections();
    if shown.is_empty() {
        bail!(
            "{} has nothing to report on; {EXPECTED}: convergence.json or .svg, diagnose.json, \
             compare.json, strategies.json, or images (.exr) that Metrolight rendered",
            args.directory.display()
        );
    }

    // Write the page.
    outputs.protect(&folder.inputs())?;
    if let Some(joined) = page.images.as_ref().map(|viewer| viewer.joined)
        && joined > 1
    {
        warn([format!(
            "the images are large: each pixel of the page is the mean of {joined} x {joined} pixels"
        )]);
    }
    write_text(&output, &page.render().into_diagnostic()?)?;
    if !args.quiet {
        print(format_args!(
            "wrote {}: {}",
            output.display(),
            shown.join(", ")
        ))?;
    }
    Ok(Outcome::Done)
}

/// The directory's name, even if it is given as `.`.
fn title(directory: &Path) -> String {
    let whole = directory.canonicalize();
    let name = whole.as_deref().unwrap_or(directory).file_name();
    name.unwrap_or(directory.as_os_str())
        .to_string_lossy()
        .into_owned()
}
