//! Signals while the program runs.

use std::io::{BufRead, BufReader, Lines};
use std::process::{Child, ChildStderr, Command, Stdio};

use super::workplace::Workplace;

/// A running program whose standard error is read.
pub struct Running {
    child: Child,
    lines: Lines<BufReader<ChildStderr>>,
}

impl Running {
    pub fn start(command: &mut Command) -> Self {
        let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("started");
        let lines = BufReader::new(child.stderr.take().expect("piped")).lines();
        Self { child, lines }
    }

    /// Waits until the program prints a line with `text`.
    pub fn wait_for(&mut self, text: &str) {
        let mut lines = self.lines.by_ref().map(|line| line.expect("text"));
        assert!(lines.any(|line| line.contains(text)), "no line with {text}");
    }

    /// Sends the signal of this name.
    pub fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        let kill = Command::new("kill")
            .args([&format!("-{name}"), &id])
            .status();
        assert!(kill.expect("kill").success());
    }

    /// The exit code, if there is one, and the lines that have not been read.
    pub fn finish(mut self) -> (Option<i32>, Vec<String>) {
        let rest = self.lines.map(|line| line.expect("text")).collect();
        (self.child.wait().expect("ended").code(), rest)
    }
}

/// Runs the program with `arguments`, which are separated by spaces, and sends SIGINT once it has
/// printed the remaining time: some samples have been taken by then. Asserts that it exits with 130
/// and prints that it was interrupted.
pub fn interrupt(place: &Workplace, arguments: &str) {
    interrupt_by(place, arguments, "INT", 130);
}

/// The same with another signal and exit code.
pub fn interrupt_by(place: &Workplace, arguments: &str, signal: &str, code: i32) {
    let mut running = Running::start(
        Command::new(assert_cmd::cargo::cargo_bin("metrolight"))
            .current_dir(place.path(""))
            .args(arguments.split(' ')),
    );
    running.wait_for(" left");
    running.signal(signal);
    let (found, rest) = running.finish();
    assert_eq!(found, Some(code), "{rest:?}");
    assert!(
        rest.iter().any(|line| line.starts_with("interrupted: ")),
        "{rest:?}"
    );
}
