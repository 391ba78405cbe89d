//! Progress on stderr: a bar on a terminal, a line now and then elsewhere.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use metrolight::render::Observer;

use super::numbers::duration;
use super::{interrupt, tell};

/// Time between two lines where there is no terminal, after the first of a phase.
const BETWEEN_LINES: Duration = Duration::from_secs(30);

/// Steps of a bar from nothing to all.
const STEPS: u64 = 1000;

/// Watches a render.
pub enum Progress {
    /// Says nothing.
    Silent,
    /// A bar on a terminal.
    Bar(ProgressBar),
    /// Lines for a log.
    Lines(Mutex<Lines>),
}

/// What has been written to a log.
#[derive(Default)]
pub struct Lines {
    phase: String,
    /// When the last line of the phase was written.
    last: Option<Instant>,
}

impl Lines {
    /// Writes a line as soon as the phase can say how long it will take, then from time to time.
    fn progress(&mut self, fraction: f64, left: &str) {
        let due = match self.last {
            None => !left.is_empty(),
            Some(last) => last.elapsed() >= BETWEEN_LINES,
        };
        if due {
            tell(format_args!(
                "{}: {:.0}% {left}",
                self.phase,
                100.0 * fraction
            ));
            self.last = Some(Instant::now());
        }
    }
}

impl Progress {
    /// Fit for what stderr is.
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

    /// Takes the bar away.
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
