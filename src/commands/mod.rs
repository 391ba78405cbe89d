//! The verbs of the command line: parse, call the library, print.

mod check;
mod compare;
mod comparison;
mod completions;
mod converge;
mod diagnose;
mod figures;
mod input;
mod interrupt;
mod output;
mod progress;
mod render;
mod replay;
mod report;
mod source;
mod strategies;
mod values;

use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use miette::MietteHandlerOpts;

/// Exit code of a diagnosis that finds something wrong.
pub const REJECTED: u8 = 1;
/// Exit code for anything wrong with what the user gave; also clap's.
pub const BAD_INPUT: u8 = 2;
/// Exit code after Ctrl-C: 128 + SIGINT, as shells have it.
pub const INTERRUPTED: u8 = 130;

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    diagnose: the chains are not stationary
  2    bad input: wrong arguments, a scene that cannot be rendered, an output that cannot be written
  130  interrupted by Ctrl-C";

/// Metropolis light transport over bidirectional path tracing: renders scenes with difficult light
/// without bias, and says how sure it is.
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

/// How a command ended that met no error.
pub enum Outcome {
    /// As asked.
    Done,
    /// Chains were found not to be stationary.
    Rejected,
    /// Early, by Ctrl-C.
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

/// Parses the command line and does what it says. Wrong arguments end the process here.
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

/// Prints a line on stdout. That nobody listens any more (`| head`) is no error.
fn say(text: impl Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Prints a line on stderr, likewise.
pub fn tell(text: impl Display) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Reports keep paths and numbers in one piece: no line is broken within a word, and none at all
/// where no terminal shows it.
pub fn install_reports() {
    let wrap = std::io::stderr().is_terminal();
    // An error here would say that reports are installed already.
    let _ = miette::set_hook(Box::new(move |_| {
        let options = MietteHandlerOpts::new();
        Box::new(options.break_words(false).wrap_lines(wrap).build())
    }));
}
