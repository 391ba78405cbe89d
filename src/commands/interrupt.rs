//! Ctrl-C: the first press ends the command in an orderly way, the second at once.

use std::sync::atomic::{AtomicBool, Ordering};

use miette::IntoDiagnostic;

use super::{INTERRUPTED, eprint};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Installs the handler of Ctrl-C.
pub fn listen() -> miette::Result<()> {
    ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        eprint("stopping; press Ctrl-C again to quit at once");
    })
    .into_diagnostic()
}

/// True once Ctrl-C has been pressed.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
