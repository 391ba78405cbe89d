//! The subcommands: each parses its arguments, calls the library and prints.

mod check;
mod compare;
mod comparison;
mod completions;
mod converge;
mod diagnose;
mod input;
mod integrator_args;
mod interrupt;
mod names;
mod numbers;
mod output;
mod progress;
mod render;
mod replay;
mod report;
mod run_args;
mod source;
mod statistics;
mod strategies;
mod values;
mod wording;

use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use miette::MietteHandlerOpts;

/// Exit code if `diagnose` rejects stationarity.
pub const REJECTED: u8 = 1;
/// Exit code for wrong arguments and input; clap uses the same.
pub const BAD_INPUT: u8 = 2;
/// Exit code after Ctrl-C: 128 + SIGINT, as in shells.
pub const INTERRUPTED: u8 = 130;

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    diagnose: the chains are not stationary
  2    bad input: wrong arguments, a scene that cannot be rendered, an output that cannot be written
  130  interrupted by Ctrl-C";

/// Metropolis light transport over bidirectional path tracing: renders scenes with difficult light
/// without bias, and estimates the error of the image.
#[derive(Parser)]
#[command(version, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Args),
    Check(check::Args),
    Compare(compare::Args),
    Converge(converge::Args),
    Diagnose(diagnose::Args),
    Replay(replay::Args),
    Report(report::Args),
    Strategies(strategies::Args),
    Completions(completions::Args),
}

/// How a command without errors ended.
pub enum Outcome {
    /// It did all its work.
    Done,
    /// `diagnose` rejected that the chains are stationary.
    Rejected,
    /// Ctrl-C ended it early.
    Interrupted,
}

impl Outcome {
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Done => ExitCode::SUCCESS,
            Self::Rejected => ExitCode::from(REJECTED),
            Self::Interrupted => ExitCode::from(INTERRUPTED),
        }
    }
}

/// Parses the command line and runs the subcommand. Wrong arguments end the process here.
pub fn run() -> miette::Result<Outcome> {
    match Cli::parse().command {
        Command::Render(args) => render::run(args),
        Command::Check(args) => check::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Converge(args) => converge::run(&args),
        Command::Diagnose(args) => diagnose::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Strategies(args) => strategies::run(args),
        Command::Completions(args) => Ok(completions::run(&args)),
    }
}

/// Prints a line on stdout. A closed pipe (`| head`) is not an error.
fn print(text: impl Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Prints a line on stderr. A closed pipe is not an error.
pub fn eprint(text: impl Display) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Prints warnings on stderr, even with --quiet.
fn warn(warnings: impl IntoIterator<Item = impl Display>) {
    for warning in warnings {
        eprint(format_args!("warning: {warning}"));
    }
}

/// Prints more warnings, and appends them to those of a result.
fn warn_more(warnings: &mut Vec<String>, more: impl IntoIterator<Item = String>) {
    let known = warnings.len();
    warnings.extend(more);
    warn(&warnings[known..]);
}

/// Error reports keep paths and numbers in one piece: lines are never broken within a word, and not at
/// all if stderr is no terminal.
pub fn install_reports() {
    let wrap = std::io::stderr().is_terminal();
    // Fails only if a hook is installed already.
    let _ = miette::set_hook(Box::new(move |_| {
        let options = MietteHandlerOpts::new();
        Box::new(options.break_words(false).wrap_lines(wrap).build())
    }));
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::CommandFactory;

    use super::Cli;

    #[test]
    fn arguments_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn flags_in_warnings_are_options() {
        let command = Cli::command();
        let arguments = command
            .get_subcommands()
            .flat_map(|command| command.get_arguments());
        let options: BTreeSet<&str> = arguments.filter_map(|option| option.get_long()).collect();
        let is_letter = |c: char| c.is_ascii_lowercase() || c == '-';
        for text in include_str!("wording.rs").split("--").skip(1) {
            let flag = text.split(|c| !is_letter(c)).next().unwrap_or_default();
            assert!(options.contains(flag), "--{flag}");
        }
    }
}
