//! A temporary directory with small scenes, in which the program runs.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use predicates::str::{contains, is_empty};
use serde_json::Value;
use tempfile::TempDir;

/// A sphere of glass on a floor below a lamp of radiance `$radiance`.
pub const ROOM: &str = r#"<scene version="3.0.0">
    <default name="radiance" value="3"/>
    <integrator type="path"><integer name="max_depth" value="6"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="45"/>
        <transform name="to_world"><lookat origin="0, 2, 5" target="0, 0.5, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="20"/>
            <integer name="height" value="15"/>
            <rfilter type="tent"/>
        </film>
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform>
    </shape>
    <shape type="sphere">
        <point name="center" x="0" y="0.6" z="0"/>
        <float name="radius" value="0.5"/>
        <bsdf type="dielectric"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="90"/><translate y="3"/></transform>
        <emitter type="area"><rgb name="radiance" value="$radiance"/></emitter>
    </shape>
</scene>
"#;

/// Constant environment light of radiance `$radiance`, and nothing else.
pub const SKY: &str = r#"<scene version="3.0.0">
    <default name="radiance" value="0.25"/>
    <sensor type="perspective">
        <film type="hdrfilm">
            <integer name="width" value="6"/>
            <integer name="height" value="4"/>
            <rfilter type="box"/>
        </film>
    </sensor>
    <emitter type="constant"><rgb name="radiance" value="$radiance"/></emitter>
</scene>
"#;

/// A temporary directory for one test, with the scenes `room.xml` and `sky.xml`.
pub struct Workplace(TempDir);

impl Workplace {
    #[allow(clippy::new_without_default)] // It makes a directory.
    pub fn new() -> Self {
        let directory = tempfile::tempdir().expect("a directory");
        fs::write(directory.path().join("room.xml"), ROOM).expect("written");
        fs::write(directory.path().join("sky.xml"), SKY).expect("written");
        Self(directory)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program with `arguments`, which are separated by spaces.
    pub fn run(&self, arguments: &str) -> Command {
        let mut command = Command::cargo_bin("metrolight").expect("built");
        command
            .current_dir(self.0.path())
            .args(arguments.split(' '));
        command
    }

    /// The output of a shell that runs `script`, in which `metrolight` is the program.
    #[cfg(unix)]
    pub fn shell(&self, script: &str) -> std::process::Output {
        let program = assert_cmd::cargo::cargo_bin("metrolight");
        std::process::Command::new("sh")
            .args([
                "-c",
                &script.replace("metrolight", &program.display().to_string()),
            ])
            .current_dir(self.0.path())
            // With it, the runtime shows a stack where memory cannot be allocated: whoever sets it has asked for that.
            .env_remove("RUST_BACKTRACE")
            .stdin(std::process::Stdio::null())
            .output()
            .expect("started")
    }

    /// Asserts that the program rejects `arguments` with exit code 2 and an explanation on stderr that
    /// contains `message`.
    pub fn assert_rejects(&self, arguments: &str, message: &str) {
        let assert = self.run(arguments).assert().code(2);
        assert.stdout(is_empty()).stderr(contains(message));
    }

    /// Names of all files, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("a directory");
        let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
        let mut names: Vec<_> = entries.map(|e| name(e.expect("an entry"))).collect();
        names.sort();
        names
    }

    pub fn pixels(&self, name: &str) -> Vec<[f32; 3]> {
        read(&self.path(name)).pixels
    }

    pub fn json(&self, name: &str) -> Value {
        let text = fs::read_to_string(self.path(name)).expect("readable");
        serde_json::from_str(&text).expect("JSON")
    }
}

pub fn read(path: &Path) -> metrolight::film::Image {
    metrolight::film::read_image(path, metrolight::film::Decode::Raw).expect("an image")
}
