//! Arguments about how a command runs.

use std::io::{IsTerminal, stderr};

use super::progress::Progress;
use super::values;

/// Options that all long-running commands share.
#[derive(clap::Args)]
pub struct RunArgs {
    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = values::threads)]
    pub threads: Option<usize>,

    /// Print nothing but warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl RunArgs {
    /// Reports progress on stderr unless quiet.
    pub fn progress(&self) -> Progress {
        Progress::new(self.quiet, stderr().is_terminal())
    }
}
