//! What a command writes: it replaces no input, its files belong together, and a signal, a full disk or a kill
//! loses nothing that was computed.

mod common;

use std::fs;
use std::path::Path;

use metrolight::film::{Image, png_text, write_exr, write_png};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;

use common::workplace::Workplace;

/// A mesh with a texture, below an included sky.
const TEXTURED: &str = r#"<scene version="3.0.0">
    <sensor type="perspective"><film type="hdrfilm">
        <integer name="width" value="6"/><integer name="height" value="4"/>
    </film></sensor>
    <integrator type="path"><integer name="max_depth" value="3"/></integrator>
    <include filename="sky-light.xml"/>
    <shape type="obj">
        <string name="filename" value="mesh.obj"/>
        <bsdf type="diffuse">
            <texture name="reflectance" type="bitmap"><string name="filename" value="TEXTURE"/></texture>
        </bsdf>
    </shape>
</scene>"#;

const MESH: &str = "v -1 -1 4\nv 1 -1 4\nv 0 1 4\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

const SKY_LIGHT: &str = r#"<scene version="3.0.0"><emitter type="constant"/></scene>"#;

fn grey() -> Image {
    Image {
        width: 6,
        height: 4,
        pixels: vec![[0.5; 3]; 24],
    }
}

/// A directory with scenes of which each has one of `textures`, and is named after it.
fn textured(textures: &[&str]) -> Workplace {
    let place = Workplace::new();
    for (name, text) in [("mesh.obj", MESH), ("sky-light.xml", SKY_LIGHT)] {
        fs::write(place.path(name), text).expect("written");
    }
    for &texture in textures {
        let path = place.path(texture);
        match path.extension().is_some_and(|extension| extension == "exr") {
            true => write_exr(&path, &grey(), &[], &[]).expect("written"),
            false => write_png(&path, &grey()).expect("written"),
        }
        let scene = TEXTURED.replace("TEXTURE", texture);
        fs::write(place.path(&format!("{texture}.xml")), scene).expect("written");
    }
    place
}

/// All files below `folder`, with their contents.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).expect("a directory") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => all.extend(contents(&path)),
            false => all.push((path.display().to_string(), fs::read(&path).expect("a file"))),
        }
    }
    all.sort();
    all
}

/// Asserts that the program refuses `arguments` with a message that names `input`, and changes no file.
fn assert_refuses(place: &Workplace, arguments: &str, input: &str) {
    let before = contents(&place.path(""));
    let message = contains("choose another name with").and(contains(input));
    place.run(arguments).assert().code(2).stderr(message);
    assert!(before == contents(&place.path("")), "{arguments}");
}

#[test]
fn no_output_of_a_render_replaces_an_input() {
    let place = textured(&["picture.png", "tex.exr"]);
    fs::create_dir(place.path("sub")).expect("created");
    for (arguments, input) in [
        ("render tex.exr.xml --stats tex.exr.xml", "tex.exr.xml"),
        ("render tex.exr.xml --stats mesh.obj", "mesh.obj"),
        ("render tex.exr.xml --stats sky-light.xml", "sky-light.xml"),
        ("render tex.exr.xml --stats sub/../mesh.obj", "mesh.obj"),
        ("render tex.exr.xml -o tex.exr", "tex.exr"),
        ("render picture.png.xml -o picture.exr", "picture.png"),
        ("render tex.exr.xml -o a.exr --stats a.png", "a.png"),
        ("render tex.exr.xml -o a.exr --stats sub/../a.exr", "a.exr"),
    ] {
        assert_refuses(&place, &format!("{arguments} --spp 1"), input);
    }
}

#[cfg(unix)]
#[test]
fn links_to_an_input_are_not_replaced() {
    let place = textured(&["tex.exr"]);
    std::os::unix::fs::symlink("mesh.obj", place.path("soft.json")).expect("linked");
    fs::hard_link(place.path("mesh.obj"), place.path("hard.json")).expect("linked");
    for stats in ["soft.json", "hard.json"] {
        let arguments = format!("render tex.exr.xml --spp 1 --stats {stats}");
        assert_refuses(&place, &arguments, "mesh.obj");
    }
}

#[test]
fn no_output_of_other_commands_replaces_an_input() {
    let textures = [
        "bdpt.exr",
        "convergence.png",
        "reference.exr",
        "weighted.png",
    ];
    let place = textured(&textures);
    fs::create_dir(place.path("d")).expect("created");
    let image = place.path("d/bdpt.exr");
    write_exr(&image, &grey(), &[], &[]).expect("written");
    write_png(&place.path("d/error.png"), &grey()).expect("written");
    write_png(&place.path("d/flip.png"), &grey()).expect("written");
    fs::rename(place.path("bdpt.exr.xml"), place.path("tiles.svg")).expect("renamed");
    let converge = "--integrators bdpt --spp 1 --repeats 1";
    for (arguments, input) in [
        (
            format!("converge sky.xml {converge} -o d --reference d/bdpt.exr"),
            "d/bdpt.exr",
        ),
        (format!("converge tiles.svg {converge} -o ."), "bdpt.exr"),
        (
            format!("converge convergence.png.xml {converge} -o ."),
            "convergence.png",
        ),
        (
            format!("converge reference.exr.xml {converge} -o ."),
            "reference.exr",
        ),
        ("compare d/error.png d/bdpt.exr -o d".into(), "error.png"),
        ("compare d/bdpt.exr d/flip.png -o d/../d".into(), "flip.png"),
        (
            "strategies weighted.png.xml -o . --spp 1".into(),
            "weighted.png",
        ),
        ("diagnose tiles.svg -o . --steps 64".into(), "tiles.svg"),
    ] {
        assert_refuses(&place, &arguments, input);
    }

    place
        .run("compare d/bdpt.exr d/flip.png -o out")
        .assert()
        .success();
    fs::hard_link(
        place.path("out/compare.json"),
        place.path("out/report.html"),
    )
    .expect("linked");
    assert_refuses(&place, "report out", "compare.json");
}

/// A link stays a link, and a pipe a pipe.
#[cfg(unix)]
#[test]
fn an_output_that_is_a_link_or_a_pipe_is_written_through() {
    let place = Workplace::new();
    fs::create_dir(place.path("disk")).expect("created");
    for (name, to) in [("old.exr", "disk/old.exr"), ("new.exr", "disk/new.exr")] {
        std::os::unix::fs::symlink(to, place.path(name)).expect("linked");
    }
    fs::write(place.path("disk/old.exr"), "old").expect("written");
    for name in ["old", "new"] {
        let render = format!("render sky.xml -q --integrator path --spp 1 -o {name}.exr");
        place.run(&render).assert().success();
        assert!(place.path(&format!("{name}.exr")).is_symlink());
        let through = place.pixels(&format!("disk/{name}.exr"));
        assert_eq!(through, [[0.25; 3]; 24]);
    }

    let program = assert_cmd::cargo::cargo_bin("metrolight");
    let script = format!(
        "mkfifo pipe && (cat pipe > read &) && {} render sky.xml -q --integrator path --spp 1 --stats pipe \
         && test -p pipe && rm pipe",
        program.display()
    );
    let mut shell = std::process::Command::new("sh");
    let status = shell
        .args(["-c", &script])
        .current_dir(place.path(""))
        .status();
    assert!(status.expect("started").success());
    // The reader ends after the writer.
    while fs::metadata(place.path("read")).expect("made").len() == 0 {
        std::thread::yield_now();
    }
    let statistics = fs::read_to_string(place.path("read")).expect("text");
    assert!(statistics.starts_with('{'), "{statistics}");
}

/// Each of them has a part of the other's results in its place.
#[test]
fn files_of_two_renders_are_told_apart() {
    let place = Workplace::new();
    for (name, seed) in [("a", 1), ("b", 2)] {
        let render = format!("render room.xml -q --integrator path --spp 2 --seed {seed}");
        let files = format!("-o {name}.exr --stats {name}.json");
        place.run(&format!("{render} {files}")).assert().success();
    }
    let ids: Vec<Value> = ["a.json", "b.json"]
        .iter()
        .map(|name| place.json(name)["render"].clone())
        .collect();
    assert_ne!(ids[0], ids[1]);
    let of_preview = png_text(&place.path("a.png"), "metrolight.render");
    assert_eq!(of_preview.as_deref(), ids[0].as_str());

    let compare = "compare a.exr b.exr";
    let mixture = contains("are not of one render");
    place
        .run(compare)
        .assert()
        .success()
        .stderr(mixture.clone().not());
    fs::copy(place.path("b.png"), place.path("a.png")).expect("copied");
    let preview = || contains("a.exr and ").and(contains("a.png are not of one render"));
    place.run(compare).assert().success().stderr(preview());
    place
        .run("report . -q")
        .assert()
        .success()
        .stderr(preview());
    let from_preview = contains("a.png and a.exr").and(mixture.clone());
    place
        .run("compare a.png b.png")
        .assert()
        .success()
        .stderr(from_preview);
    fs::copy(place.path("a.json"), place.path("b.json")).expect("copied");
    let statistics = contains("b.exr and b.json").and(mixture);
    place.run(compare).assert().success().stderr(statistics);
}

#[test]
fn temporary_files_of_killed_processes_are_removed() {
    let place = Workplace::new();
    for name in ["abc123", "XYZ789", "too-long-for-one"] {
        fs::write(place.path(&format!(".metrolight-{name}")), "half").expect("written");
    }
    let alive = fs::File::open(place.path(".metrolight-XYZ789")).expect("a file");
    alive.lock().expect("locked");
    let render = "render sky.xml -q --integrator path --spp 1";
    place.run(render).assert().success();
    let expected = [
        ".metrolight-XYZ789",
        ".metrolight-too-long-for-one",
        "room.xml",
        "sky.exr",
        "sky.png",
        "sky.xml",
    ];
    assert_eq!(place.files(), expected);
}

#[cfg(unix)]
mod unix {
    use std::process::{Command, Output};

    use super::*;
    use common::interrupt::{Running, interrupt_by};

    /// Exit codes are those of shells. The image and the statistics are there.
    #[test]
    fn a_signal_keeps_the_image() {
        for (signal, code) in [("TERM", 143), ("HUP", 129), ("INT", 130)] {
            let place = Workplace::new();
            let render = "render room.xml --time 1h --integrator bdpt --stats s.json";
            interrupt_by(&place, render, signal, code);
            assert!(place.pixels("room.exr").iter().any(|p| p[0] > 0.0));
            assert!(place.path("room.png").exists());
            assert_eq!(place.json("s.json")["interrupted"], true);
        }
    }

    /// `nohup` lets a process ignore the end of its session.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_render_under_nohup_goes_on() {
        let place = Workplace::new();
        let mut running = Running::start(
            Command::new("nohup")
                .arg(assert_cmd::cargo::cargo_bin("metrolight"))
                .args("render room.xml --time 1h --integrator bdpt".split(' '))
                .current_dir(place.path("")),
        );
        running.wait_for(" left");
        running.signal("HUP");
        running.signal("TERM");
        assert_eq!(running.finish().0, Some(143));
    }

    /// The program under a limit of `blocks` on the size of a file, in units of 512 bytes.
    fn with_file_limit(place: &Workplace, blocks: u32, arguments: &str) -> Output {
        place.shell(&format!("ulimit -f {blocks}; exec metrolight {arguments}"))
    }

    /// If it were noticed only at the end, the render would take an hour.
    #[test]
    fn a_disk_without_room_is_noticed_before_rendering() {
        let place = Workplace::new();
        let before = place.files();
        let arguments = "render room.xml --time 1h --size 400x300";
        let output = with_file_limit(&place, 1000, arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("cannot write room.exr"), "{message}");
        assert!(message.contains("bytes are needed"), "{message}");
        assert_eq!(place.files(), before);
    }

    /// The folder of the output is removed during the render. The image goes to the temporary folder.
    #[test]
    fn an_image_that_cannot_be_written_goes_elsewhere() {
        let place = Workplace::new();
        for folder in ["out", "tmp"] {
            fs::create_dir(place.path(folder)).expect("created");
        }
        let arguments =
            "render room.xml --time 1h --integrator bdpt --error -o out/a.exr --stats out/s.json";
        let mut running = Running::start(
            Command::new(assert_cmd::cargo::cargo_bin("metrolight"))
                .args(arguments.split(' '))
                .env("TMPDIR", place.path("tmp"))
                .current_dir(place.path("")),
        );
        running.wait_for(" left");
        fs::remove_dir_all(place.path("out")).expect("removed");
        running.signal("INT");
        let (code, lines) = running.finish();
        assert_eq!(code, Some(2), "{lines:?}");
        let folders = contents(&place.path("tmp"));
        let names = folders.iter().map(|(name, _)| name.rsplit('/').next());
        assert_eq!(
            names.collect::<Vec<_>>(),
            [Some("a.exr"), Some("a.png"), Some("s.json")]
        );
        let folder = Path::new(&folders[0].0).parent().expect("a folder");
        let told = lines.join(" ");
        assert!(told.contains("cannot write out/"), "{told}");
        assert!(told.contains(&folder.display().to_string()), "{told}");
        let saved =
            metrolight::film::read_annotated(&folder.join("a.exr"), metrolight::film::Decode::Raw);
        let layers = saved.expect("an image").layers;
        assert!(layers.contains_key("standard_error"));
    }

    /// A killed render leaves its last save, whose files agree.
    #[test]
    fn a_killed_render_leaves_what_it_has_saved() {
        let place = Workplace::new();
        let arguments = "render room.xml --time 1h --integrator pssmlt --bootstrap 2000 \
                         --save-every 0.01s --stats s.json";
        let mut running = Running::start(
            Command::new(assert_cmd::cargo::cargo_bin("metrolight"))
                .args(arguments.split_whitespace())
                .current_dir(place.path("")),
        );
        running.wait_for(" left");
        while !place.path("s.json").exists() {
            std::thread::yield_now();
        }
        running.signal("KILL");
        assert_eq!(running.finish().0, None);
        assert!(place.pixels("room.exr").iter().any(|p| p[0] > 0.0));
        assert_eq!(place.json("s.json")["interrupted"], true);
        assert!(place.json("s.json")["samples"].as_u64() > Some(0));
    }
}

/// What time has ended is rendered again, to the bit, by the command in its statistics.
#[test]
fn a_render_with_a_time_budget_can_be_repeated() {
    let place = Workplace::new();
    for integrator in ["path", "light", "bdpt", "pssmlt", "mmlt"] {
        let render = format!("render room.xml -q --time 0.3s --seed 3 --integrator {integrator}");
        place
            .run(&format!("{render} --stats s.json"))
            .assert()
            .success();
        let image = place.pixels("room.exr");
        let command = place.json("s.json")["command"].clone();
        let command = command.as_str().expect("a command").to_owned();
        let again = command.strip_prefix("metrolight ").expect("the program");
        place
            .run(&format!("{again} -q -o again.exr --stats again.json"))
            .assert()
            .success();
        assert_eq!(
            place.json("again.json")["samples"],
            place.json("s.json")["samples"],
            "{command}"
        );
        assert!(image == place.pixels("again.exr"), "{command}");
    }
}

/// Saves do not change the image, not even by rounding.
#[test]
fn saves_leave_the_image_as_it_is() {
    let place = Workplace::new();
    for integrator in ["bdpt", "pssmlt", "mmlt"] {
        let images = ["never", "0.001s"].map(|every| {
            let arguments = format!(
                "render room.xml -q --spp 300 --integrator {integrator} --save-every {every} -o {every}.exr"
            );
            place.run(&arguments).assert().success();
            place.pixels(&format!("{every}.exr"))
        });
        assert!(images[0] == images[1], "{integrator}");
    }
}
