//! Embree, in a process of its own that runs alternately with this one.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The process.
pub struct Embree {
    child: Child,
    commands: ChildStdin,
    answers: BufReader<ChildStdout>,
    directory: PathBuf,
}

impl Embree {
    /// Starts `program` (`rays.cpp`) on the triangles in `directory`.
    pub fn start(program: &Path, directory: &Path, mode: &str) -> Self {
        let mut child = Command::new(program)
            .args([directory, Path::new(mode)])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("run benches/embree/run.sh");
        Self {
            commands: child.stdin.take().expect("piped"),
            answers: BufReader::new(child.stdout.take().expect("piped")),
            directory: directory.into(),
            child,
        }
    }

    /// Seconds that the command `verb` takes with the rays in the file `name`.
    pub fn time(&mut self, verb: &str, name: &str) -> f64 {
        writeln!(self.commands, "{verb} {name}").expect("Embree runs");
        let mut answer = String::new();
        self.answers.read_line(&mut answer).expect("an answer");
        let seconds = answer.split(' ').next().and_then(|s| s.parse().ok());
        seconds.expect("a number of seconds")
    }

    /// The distance to the first hit of each ray, for shadow rays 0; infinite without a hit.
    pub fn found(&mut self, verb: &str, name: &str) -> Vec<f32> {
        self.time(verb, name);
        let bytes = fs::read(self.directory.join(format!("{name}.found"))).expect("written");
        let (floats, _) = bytes.as_chunks::<4>();
        floats.iter().map(|&b| f32::from_le_bytes(b)).collect()
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // The end of its input would end it too, but only after the directory is removed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Writes floats in the format of `rays.cpp`.
pub fn write(path: &Path, floats: impl Iterator<Item = f32>) {
    let bytes: Vec<u8> = floats.flat_map(f32::to_le_bytes).collect();
    fs::write(path, bytes).expect("a directory to write to");
}
