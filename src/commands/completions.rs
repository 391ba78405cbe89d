//! `metrolight completions`: completion scripts for shells.

use clap::CommandFactory;
use clap_complete::Shell;

use super::{Cli, Outcome, print};

/// Print a completion script for a shell
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  metrolight completions bash > ~/.local/share/bash-completion/completions/metrolight")]
pub struct Args {
    /// The shell
    shell: Shell,
}

/// Prints the script on stdout.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "metrolight", &mut script);
    print(String::from_utf8_lossy(&script).trim_end())?;
    Ok(Outcome::Done)
}
