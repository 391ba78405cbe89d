//! `metrolight help`: the help of a command.

use std::ffi::OsString;

use super::{Outcome, run_with};

/// Print the help of a command
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  metrolight help render                             the same as metrolight render --help")]
pub struct Args {
    /// The command [default: all commands]
    command: Option<OsString>,
}

/// Prints the help on stdout.
pub fn run(args: Args) -> miette::Result<Outcome> {
    let words = [
        Some("metrolight".into()),
        args.command,
        Some("--help".into()),
    ];
    run_with(words.into_iter().flatten())
}
