//! Saves of a render while it runs.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use metrolight::film::Image;
use metrolight::render::{Observer, Progress as RenderProgress, Rendering};

use super::progress::Progress;
use super::values::SaveEvery;
use super::warn;

/// Time between two saves by default.
const INTERVAL: Duration = Duration::from_secs(60);

/// By default, renders are saved that will take longer than this, in seconds.
const MIN_SECONDS: f64 = 300.0;

/// A save is followed by at least this many times its duration without saves.
const MAX_COST: u32 = 20;

/// Shows the progress of a render, and saves its result from time to time.
pub struct Saves<'a> {
    progress: &'a Progress,
    every: SaveEvery,
    /// Writes a result.
    write: &'a (dyn Fn(&Rendering) -> miette::Result<()> + Sync),
    state: Mutex<State>,
}

struct State {
    /// Estimated seconds until the end.
    left: Option<f64>,
    /// When the next save is due.
    next: Instant,
    /// The last error, which is not repeated.
    error: String,
}

impl<'a> Saves<'a> {
    pub fn new(
        progress: &'a Progress,
        every: SaveEvery,
        write: &'a (dyn Fn(&Rendering) -> miette::Result<()> + Sync),
    ) -> Self {
        let state = State {
            left: None,
            next: Instant::now() + interval(every),
            error: String::new(),
        };
        Self {
            progress,
            every,
            write,
            state: state.into(),
        }
    }
}

fn interval(every: SaveEvery) -> Duration {
    match every {
        SaveEvery::Seconds(seconds) => Duration::from_secs_f64(seconds),
        SaveEvery::Default | SaveEvery::Never => INTERVAL,
    }
}

impl Observer for Saves<'_> {
    fn phase(&self, name: &str) {
        self.progress.phase(name);
    }

    fn progress(&self, fraction: f64, seconds_left: Option<f64>) {
        if let Ok(mut state) = self.state.lock() {
            state.left = seconds_left;
        }
        self.progress.progress(fraction, seconds_left);
    }

    fn interrupted(&self) -> bool {
        self.progress.interrupted()
    }

    fn wants_rendering(&self, progress: &RenderProgress) -> bool {
        let Ok(state) = self.state.lock() else {
            return false;
        };
        let is_due = Instant::now() >= state.next;
        let total = progress.seconds + state.left.unwrap_or(0.0);
        match self.every {
            SaveEvery::Never => false,
            SaveEvery::Seconds(_) => is_due,
            SaveEvery::Default => is_due && total > MIN_SECONDS,
        }
    }

    fn on_rendering(&self, rendering: &Rendering) {
        let start = Instant::now();
        let error = match (self.write)(rendering) {
            Ok(()) => String::new(),
            Err(error) => error.to_string(),
        };
        let Ok(mut state) = self.state.lock() else {
            return;
        };
        if !error.is_empty() && error != state.error {
            warn([format!(
                "the image so far is not saved: {error}. Rendering goes on"
            )]);
        }
        state.error = error;
        state.next = Instant::now() + interval(self.every).max(MAX_COST * start.elapsed());
    }

    fn wants_snapshot(&self, progress: &RenderProgress) -> bool {
        self.progress.wants_snapshot(progress)
    }

    fn on_snapshot(&self, progress: &RenderProgress, image: &Image) {
        self.progress.on_snapshot(progress, image);
    }
}
