//! The `metrolight` command: turns errors into reports and exit codes.

mod commands;

use std::process::ExitCode;

fn main() -> ExitCode {
    commands::install_reports();
    match commands::run() {
        Ok(outcome) => outcome.exit_code(),
        Err(report) => {
            commands::eprint(format_args!("{report:?}"));
            ExitCode::from(commands::BAD_INPUT)
        }
    }
}
