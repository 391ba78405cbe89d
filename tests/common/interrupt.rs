//! Ctrl-C while the program runs.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use super::workplace::Workplace;

/// Runs the program with `arguments`, which are separated by spaces, and sends SIGINT once it has
/// printed the remaining time: some samples have been taken by then. Asserts that it exits with 130
/// and prints that it was interrupted.
pub fn interrupt(place: &Workplace, arguments: &str) {
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("metrolight"))
        .current_dir(place.path(""))
        .args(arguments.split(' '))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("started");
    let mut lines = BufReader::new(child.stderr.take().expect("piped")).lines();
    let mut next = || lines.next().map(|line| line.expect("text"));
    while !next()
        .expect("a line with the remaining time")
        .contains(" left")
    {}
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill").success());
    let rest: Vec<String> = std::iter::from_fn(next).collect();
    assert_eq!(child.wait().expect("ended").code(), Some(130), "{rest:?}");
    assert!(
        rest.iter().any(|line| line.starts_with("interrupted: ")),
        "{rest:?}"
    );
}
