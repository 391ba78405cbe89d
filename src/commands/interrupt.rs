//! Signals that end a command: Ctrl-C, a request to terminate, and the end of the terminal session. The
//! first one ends the command in an orderly way, the second at once.

use std::sync::atomic::{AtomicU8, Ordering};

use super::eprint;

/// Exit code of the first signal that was received: 128 and its number, as in shells. 0 before.
static EXIT_CODE: AtomicU8 = AtomicU8::new(0);

/// Exit code after Ctrl-C: 128 + SIGINT.
const CTRL_C: u8 = 130;

/// Begins to listen for signals.
pub fn listen() -> miette::Result<()> {
    platform::listen()
}

/// From now on, a file that may not grow any more (`ulimit -f`) is an error of the operation that writes it.
pub fn survive_full_files() {
    platform::survive_full_files();
}

/// True once a signal has been received.
pub fn requested() -> bool {
    EXIT_CODE.load(Ordering::Relaxed) != 0
}

/// Exit code of a command that a signal has ended.
pub fn exit_code() -> u8 {
    EXIT_CODE.load(Ordering::Relaxed)
}

fn receive(exit_code: u8) {
    let first = EXIT_CODE.compare_exchange(0, exit_code, Ordering::Relaxed, Ordering::Relaxed);
    if first.is_err() {
        std::process::exit(exit_code.into());
    }
    match exit_code {
        CTRL_C => eprint("stopping; press Ctrl-C again to quit at once"),
        _ => eprint("stopping; another signal quits at once"),
    }
}

#[cfg(unix)]
mod platform {
    use std::fs;
    use std::sync::Arc;

    use miette::IntoDiagnostic;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::flag;
    use signal_hook::iterator::Signals;

    pub fn survive_full_files() {
        // Fails only for signals that cannot be handled.
        let _ = flag::register(SIGXFSZ, Arc::default());
    }

    pub fn listen() -> miette::Result<()> {
        let ignored = ignored();
        let is_heard = |signal: &i32| *signal != SIGHUP || ignored & 1 << (signal - 1) == 0;
        let signals = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(is_heard);
        let mut signals = Signals::new(signals).into_diagnostic()?;
        std::thread::spawn(move || {
            for signal in signals.forever() {
                super::receive(128 + signal as u8);
            }
        });
        Ok(())
    }

    /// Bit n - 1 is set if signal n is ignored, as SIGHUP is under `nohup`: such a command goes on. Known
    /// only under Linux (proc_pid_status(5)).
    fn ignored() -> u64 {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
            .unwrap_or(0)
    }
}

#[cfg(not(unix))]
mod platform {
    use miette::IntoDiagnostic;

    pub fn survive_full_files() {}

    /// Ctrl-C and Ctrl-Break are not told apart.
    pub fn listen() -> miette::Result<()> {
        ctrlc::set_handler(|| super::receive(super::CTRL_C)).into_diagnostic()
    }
}
