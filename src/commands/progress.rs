//! Progress on stderr: a bar on a terminal, lines from time to time elsewhere.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use metrolight::render::Observer;

use super::numbers::duration;
use super::{eprint, interrupt};

/// Time between two lines of a phase if stderr is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(30);

/// Length of a full bar.
const STEPS: u64 = 1000;

/// Shows the progress of a render.
pub enum Progress {
    /// Shows nothing.
    Silent,
    /// A bar on a terminal.
    Bar(ProgressBar),
    /// Lines for a log.
    Lines(Mutex<Lines>),
}

/// State of a log.
#[derive(Default)]
pub struct Lines {
    phase: String,
    /// When the last line of the phase was written.
    last: Option<Instant>,
}

impl Lines {
    /// Writes a line as soon as the remaining time of the phase is known, then from time to time.
    fn progress(&mut self, fraction: f64, left: &str) {
        let due = match self.last {
            None => !left.is_empty(),
            Some(last) => last.elapsed() >= BETWEEN_LINES,
        };
        if due {
            eprint(format_args!(
                "{}: {:.0}% {left}",
                self.phase,
                100.0 * fraction
            ));
            self.last = Some(Instant::now());
        }
    }
}

impl Progress {
    /// A bar if stderr is a terminal, else lines; nothing if `quiet`.
    pub fn new(quiet: bool, terminal: bool) -> Self {
        if quiet {
            return Self::Silent;
        }
        if !terminal {
            return Self::Lines(Mutex::default());
        }
        let bar = ProgressBar::new(STEPS);
        let template = "{prefix:10} [{bar:40}] {percent:>3}%  {elapsed}  {msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        Self::Bar(bar)
    }

    /// Shows that `fraction` of a phase that began at `start` and goes on at the same speed is done.
    pub fn steady(&self, start: Instant, fraction: f64) {
        /// Shorter remaining times, in seconds, are not shown.
        const MIN_REMAINING: f64 = 2.0;
        let left = start.elapsed().as_secs_f64() * (1.0 / fraction - 1.0);
        let is_long = left.is_finite() && left > MIN_REMAINING;
        self.progress(fraction, is_long.then_some(left));
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Progress {
    fn phase(&self, name: &str) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                bar.reset();
                bar.set_message("");
                bar.set_prefix(name.to_owned());
            }
            Self::Lines(lines) => {
                if let Ok(mut lines) = lines.lock() {
                    *lines = Lines {
                        phase: name.to_owned(),
                        last: None,
                    };
                }
            }
        }
    }

    fn progress(&self, fraction: f64, seconds_left: Option<f64>) {
        let left = seconds_left.map_or_else(String::new, |s| format!("{} left", duration(s)));
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                bar.set_position((fraction * STEPS as f64) as u64);
                bar.set_message(left);
            }
            Self::Lines(lines) => {
                if let Ok(mut lines) = lines.lock() {
                    lines.progress(fraction, &left);
                }
            }
        }
    }

    fn interrupted(&self) -> bool {
        interrupt::requested()
    }
}
