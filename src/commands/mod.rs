//! The subcommands: each parses its arguments, calls the library and prints.

mod check;
mod compare;
mod comparison;
mod completions;
mod converge;
mod diagnose;
mod files;
mod help;
mod input;
mod integrator_args;
mod interrupt;
mod memory;
mod mixture;
mod names;
mod numbers;
mod output;
mod progress;
mod render;
mod replay;
mod report;
mod rescue;
mod run_args;
mod saves;
mod source;
mod statistics;
mod strategies;
mod values;
mod wording;

use std::ffi::OsString;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use clap::error::{ContextKind, ErrorKind};
use clap::{Parser, Subcommand};
use miette::MietteHandlerOpts;

/// Exit code if `diagnose` rejects stationarity.
const REJECTED: u8 = 1;
/// Exit code if standard output cannot be written.
const NOT_PRINTED: u8 = 1;
/// Exit code for wrong arguments and input; clap uses the same.
const BAD_INPUT: u8 = 2;

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    standard output cannot be written; or diagnose: the chains are not stationary
  2    bad input: wrong arguments, a scene that cannot be rendered, an output that cannot be written
  129, 130, 143  ended early by SIGHUP, Ctrl-C or SIGTERM: what has been computed is written";

/// Metropolis light transport over bidirectional path tracing: renders scenes with difficult light
/// without bias, and estimates the error of the image.
#[derive(Parser)]
#[command(
    version,
    propagate_version = true,
    disable_help_subcommand = true,
    after_help = EXIT_CODES
)]
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
    Help(help::Args),
}

/// How a command without errors ended.
pub enum Outcome {
    /// It did all its work.
    Done,
    /// `diagnose` rejected that the chains are stationary.
    Rejected,
    /// A signal ended it early.
    Interrupted,
}

impl Outcome {
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Done => ExitCode::SUCCESS,
            Self::Rejected => ExitCode::from(REJECTED),
            Self::Interrupted => ExitCode::from(interrupt::exit_code()),
        }
    }
}

/// Parses the command line and runs the subcommand. Wrong arguments end the process here.
pub fn run() -> miette::Result<Outcome> {
    run_with(std::env::args_os())
}

fn run_with(words: impl IntoIterator<Item = OsString>) -> miette::Result<Outcome> {
    let command = match Cli::try_parse_from(words) {
        Ok(cli) => cli.command,
        Err(error) => return explain(error),
    };
    match command {
        Command::Render(args) => render::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Converge(args) => converge::run(&args),
        Command::Diagnose(args) => diagnose::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Strategies(args) => strategies::run(args),
        Command::Completions(args) => completions::run(&args),
        Command::Help(args) => help::run(args),
    }
}

/// Prints the help or the version that was asked for; any other error of the arguments ends the process.
fn explain(mut error: clap::Error) -> miette::Result<Outcome> {
    if error.use_stderr() {
        if error.kind() == ErrorKind::UnknownArgument {
            // No argument of any command begins with a dash, so `--` is no help.
            error.remove(ContextKind::Suggested);
        }
        error.exit();
    }
    let text = error.render();
    let plain = !io::stdout().is_terminal() || std::env::var_os("NO_COLOR").is_some();
    match plain {
        true => print(text.to_string().trim_end())?,
        false => print(text.ansi().to_string().trim_end())?,
    }
    Ok(Outcome::Done)
}

/// Standard output cannot be written.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("cannot write to standard output: {0}")]
struct PrintError(io::Error);

/// Prints a line on stdout. A closed pipe (`| head`) is not an error.
fn print(text: impl Display) -> miette::Result<()> {
    let mut output = io::stdout().lock();
    match writeln!(output, "{text}").and_then(|()| output.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(PrintError(error).into()),
        _ => Ok(()),
    }
}

/// The exit code of an error.
pub fn exit_code(error: &miette::Report) -> u8 {
    match error.downcast_ref::<PrintError>() {
        Some(_) => NOT_PRINTED,
        None => BAD_INPUT,
    }
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

/// Settles how the process fails. Without memory it ends as with bad input, and a file that may not grow is an
/// error. Reports of errors keep paths and numbers in one piece: lines are never broken within a word, and not
/// at all if stderr is no terminal.
pub fn prepare_to_fail() {
    memory::exit_if_exhausted(BAD_INPUT);
    interrupt::survive_full_files();
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
