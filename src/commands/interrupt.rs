//! Ctrl-C: the first asks for an end, the second ends at once.

use std::sync::atomic::{AtomicBool, Ordering};

use miette::IntoDiagnostic;

use super::{INTERRUPTED, tell};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Listens for Ctrl-C from now on.
pub fn listen() -> miette::Result<()> {
    ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        tell("stopping; press Ctrl-C again to quit at once");
    })
    .into_diagnostic()
}

/// True once Ctrl-C has been pressed.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
