//! The `metrolight` command: turns errors into reports and exit codes.

mod commands;

use std::process::ExitCode;

fn main() -> ExitCode {
    commands::prepare_to_fail();
    match commands::run() {
        Ok(outcome) => outcome.exit_code(),
        Err(report) => {
            commands::eprint(format_args!("{report:?}"));
            ExitCode::from(commands::exit_code(&report))
        }
    }
}
