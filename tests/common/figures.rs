//! Results of tests, recorded for the tables and charts in `docs/`.
//!
//! With `METROLIGHT_FIGURES=DIR` in the environment every row that a test records is appended to
//! `DIR/TABLE.jsonl`, one JSON object per line; `docs/make_figures.py` turns them into tables and charts.
//! The documents thus show exactly what the tests measured.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;

use serde::Serialize;

/// Records a row of `table` if METROLIGHT_FIGURES is set. Rows of one table have the same fields.
pub fn record(table: &str, row: &impl Serialize) {
    let Some(directory) = std::env::var_os("METROLIGHT_FIGURES").map(PathBuf::from) else {
        return;
    };
    let mut line = serde_json::to_string(row).expect("a serializable row");
    line.push('\n');
    std::fs::create_dir_all(&directory).expect("the directory of figures");
    let path = directory.join(format!("{table}.jsonl"));
    // One write per row, so that lines of concurrent tests do not mix.
    let mut file = OpenOptions::new().append(true).create(true).open(path);
    let file = file.as_mut().expect("a file of figures");
    file.write_all(line.as_bytes()).expect("a writable file");
}

/// A row of the table in `docs/accuracy.md`.
#[derive(Serialize)]
pub struct Accuracy<'a> {
    /// The oracle, such as "closed form" or "transport operator".
    pub oracle: &'a str,
    /// What was compared: scene, integrators, path lengths.
    pub case: &'a str,
    /// The result, with its unit and standard error: "ratio of means 1.0003 +- 0.0008".
    pub found: String,
    /// What the test requires, and so what it would catch: "|z| < 3.9; catches 0.3% of the mean".
    pub demanded: String,
}

/// A row of the table in `docs/stability.md`.
#[derive(Serialize)]
pub struct Stability<'a> {
    /// The difficulty: "area light of 1e-8", "p_large = 0".
    pub case: &'a str,
    /// Integrators under test.
    pub method: &'a str,
    /// The result, with numbers.
    pub happens: String,
    /// The warnings that the user gets, verbatim, or "nothing".
    pub told: String,
}
