//! `metrolight completions`: scripts that complete the command line.

use clap::CommandFactory;
use clap_complete::Shell;

use super::{Cli, Outcome, say};

/// Print a script that completes metrolight's arguments
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  metrolight completions bash > ~/.local/share/bash-completion/completions/metrolight")]
pub struct Args {
    /// The shell that the script is for
    shell: Shell,
}

/// Prints the script on stdout.
pub fn run(args: &Args) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "metrolight", &mut script);
    say(String::from_utf8_lossy(&script).trim_end());
    Outcome::Done
}
