//! Errors have a place and list the alternatives.

use std::fs;

use tempfile::TempDir;

use super::{BASE, load_body, load_text};
use metrolight::mitsuba::load;

fn sensor(parameters: &str) -> String {
    format!(r#"<sensor type="perspective">{parameters}</sensor>"#)
}

fn film(parameters: &str) -> String {
    sensor(&format!(r#"<film type="hdrfilm">{parameters}</film>"#))
}

fn bsdf(kind: &str, parameters: &str) -> String {
    format!(r#"<bsdf type="{kind}">{parameters}</bsdf>"#)
}

fn sphere(parameters: &str) -> String {
    format!(r#"<shape type="sphere">{parameters}</shape>"#)
}

fn placed(steps: &str) -> String {
    format!(r#"<shape type="cube"><transform name="to_world">{steps}</transform></shape>"#)
}

fn file(kind: &str, name: &str) -> String {
    format!(r#"<shape type="{kind}"><string name="filename" value="{name}"/></shape>"#)
}

/// Each case is a body, a place and a phrase. The scene with the body in its second line must fail
/// at the place, with a message that contains the phrase and fits on a screen.
fn assert_fail(cases: &[(String, &str, &str)]) {
    let problem = |(body, place, phrase): &(String, &str, &str)| {
        let message = match load_body(body) {
            Ok(_) => return Some(format!("{body}\n  loads, without `{phrase}`")),
            Err(error) => error.to_string(),
        };
        let is_right = message.contains(&format!("scene.xml:{place}: "))
            && message.contains(phrase)
            && message.len() < 1600;
        (!is_right).then(|| format!("{body}\n  at {place} `{phrase}`\n  {message}"))
    };
    let problems: Vec<String> = cases.iter().filter_map(problem).collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn unknown_names_are_reported_with_suggestions() {
    assert_fail(&[
        (r#"<shpae type="sphere"/>"#.into(), "2:1", "`shape`"),
        (
            sphere(r#"<medium type="homogeneous" name="interior"/>"#),
            "2:22",
            "not supported: participating media such as medium `homogeneous`",
        ),
        (r#"<shape type="spheer"/>"#.into(), "2:1", "`sphere`"),
        // Columns are characters, not bytes.
        (
            r#"<!-- é --><shape type="spheer"/>"#.into(),
            "2:11",
            "`sphere`",
        ),
        (bsdf("difuse", ""), "2:1", "`diffuse`"),
        (r#"<emitter type="points"/>"#.into(), "2:1", "`point`"),
        (
            r#"<sensor type="perspectiv"/>"#.into(),
            "2:1",
            "`perspective`",
        ),
        (sensor(r#"<film type="hdrflim"/>"#), "2:28", "`hdrfilm`"),
        (film(r#"<rfilter type="gausian"/>"#), "2:49", "`gaussian`"),
        (
            bsdf("diffuse", r#"<texture type="bitmp" name="reflectance"/>"#),
            "2:22",
            "`bitmap`",
        ),
        (
            sphere(r#"<float name="raduis" value="1"/>"#),
            "2:22",
            "`radius`",
        ),
        (
            film(r#"<integer name="hieght" value="1"/>"#),
            "2:49",
            "`height`",
        ),
        (
            bsdf("plastic", r#"<float name="alpha" value="0.1"/>"#),
            "2:22",
            "no parameter `alpha`",
        ),
        (
            bsdf(
                "roughconductor",
                r#"<string name="distribution" value="bekmann"/>"#,
            ),
            "2:29",
            "`beckmann`",
        ),
        (
            bsdf("conductor", r#"<string name="material" value="Aux"/>"#),
            "2:24",
            "`Au`",
        ),
        (
            bsdf("dielectric", r#"<string name="int_ior" value="diamnd"/>"#),
            "2:25",
            "`diamond`",
        ),
        (
            sensor(r#"<float name="fov" value="9"/><string name="fov_axis" value="z"/>"#),
            "2:57",
            "diagonal",
        ),
        (placed(r#"<rotat y="1" angle="3"/>"#), "2:47", "`rotate`"),
        (placed(r#"<scale w="1"/>"#), "2:57", "no attribute `w`"),
        (sphere(r#"<ref id="nobody"/>"#), "2:22", "`nobody`"),
        (
            r#"<bsdf type="diffuse" id="wood"/><shape type="cube"><ref id="wod"/></shape>"#.into(),
            "2:52",
            "`wood`",
        ),
        (
            sphere(r#"<float name="radius" value="$r"/>"#),
            "2:50",
            "-D r=VALUE",
        ),
    ]);
}

#[test]
fn values_of_the_wrong_type_are_rejected() {
    assert_fail(&[
        (
            sphere(r#"<string name="radius" value="1"/>"#),
            "2:22",
            "must be a float, not a string",
        ),
        (
            sphere(r#"<float name="radius" value="1abc"/>"#),
            "2:50",
            "`1abc` is not a finite number",
        ),
        (
            sphere(r#"<float name="radius" value="nan"/>"#),
            "2:50",
            "finite",
        ),
        (
            sphere(r#"<boolean name="flip_normals" value="1"/>"#),
            "2:58",
            "`true` or `false`",
        ),
        (
            r#"<integrator type="path"><integer name="max_depth" value="2.5"/></integrator>"#
                .into(),
            "2:58",
            "whole number",
        ),
        (
            bsdf("diffuse", r##"<rgb name="reflectance" value="#ff0000"/>"##),
            "2:53",
            "`#ff0000`",
        ),
        (
            bsdf(
                "diffuse",
                r#"<spectrum name="reflectance" value="700:1, 400:0"/>"#,
            ),
            "2:58",
            "a wavelength above the one before",
        ),
        (
            bsdf("diffuse", r#"<boolean name="reflectance" value="true"/>"#),
            "2:22",
            "a colour",
        ),
        (
            r#"<emitter type="point"><texture type="checkerboard" name="intensity"/></emitter>"#
                .into(),
            "2:23",
            "not supported: light that varies",
        ),
        (sphere(r#"<point name="center" x="1"/>"#), "2:22", "`y`"),
        (placed(r#"<matrix value="1 2 3"/>"#), "2:62", "16 or 9"),
        (placed(r#"<rotate angle="3"/>"#), "2:47", "direction"),
        (
            placed(r#"<lookat origin="1 1 1" target="1 1 1"/>"#),
            "2:47",
            "same point",
        ),
        (
            placed(r#"<lookat origin="0 0 0" target="0 1 0" up="0 1 0"/>"#),
            "2:47",
            "parallel",
        ),
        (
            placed(r#"<scale value="1" x="2"/>"#),
            "2:47",
            "not `value` and `x`",
        ),
        (
            placed(r#"<scale value="1e300"/><scale value="1e300"/>"#),
            "2:20",
            "finite",
        ),
    ]);
}

#[test]
fn values_out_of_range_are_rejected() {
    let float = |name: &str, value: &str| format!(r#"<float name="{name}" value="{value}"/>"#);
    let integer = |name: &str, value: &str| format!(r#"<integer name="{name}" value="{value}"/>"#);
    let path = |inner: String| format!(r#"<integrator type="path">{inner}</integrator>"#);
    let sized = |w: &str, h: &str| film(&(integer("width", w) + &integer("height", h)));
    assert_fail(&[
        (sphere(&float("radius", "0")), "2:22", "above 0"),
        (
            bsdf("diffuse", &float("reflectance", "1.5")),
            "2:22",
            "between 0 and 1",
        ),
        (
            bsdf("diffuse", &float("reflectance", "-0.5")),
            "2:22",
            "between 0 and 1",
        ),
        (
            r#"<emitter type="constant"><rgb name="radiance" value="1 -1 1"/></emitter>"#.into(),
            "2:26",
            "0 or above",
        ),
        (
            r#"<emitter type="constant"><rgb name="radiance" value="1e39"/></emitter>"#.into(),
            "2:26",
            "too large",
        ),
        (
            bsdf("roughdielectric", &float("alpha", "-0.1")),
            "2:30",
            "between 0 and",
        ),
        (
            bsdf("roughdielectric", &float("alpha", "11")),
            "2:30",
            "between 0 and",
        ),
        (
            bsdf("dielectric", &float("int_ior", "0")),
            "2:25",
            "between 0.001",
        ),
        (
            bsdf("dielectric", &float("int_ior", "-1.5")),
            "2:25",
            "between 0.001",
        ),
        (
            bsdf("roughdielectric", &float("int_ior", "1.000277")),
            "2:1",
            "must differ",
        ),
        (sensor(&float("fov", "180")), "2:28", "below 180"),
        (sensor(&float("near_clip", "0")), "2:28", "above 0"),
        (
            sensor(&float("far_clip", "0.001")),
            "2:28",
            "above `near_clip`",
        ),
        (
            sensor(&float("principal_point_offset_x", "101")),
            "2:28",
            "at most 100 film widths",
        ),
        (sized("0", "5"), "2:49", "at least 1"),
        (sized("5", "-1"), "2:82", "at least 1"),
        (sized("100000", "100000"), "2:28", "pixels"),
        (film(&integer("crop_width", "769")), "2:49", "at most 768"),
        (
            film(r#"<boolean name="sample_border" value="true"/>"#),
            "2:49",
            "not supported",
        ),
        (path(integer("max_depth", "-2")), "2:25", "-1 (no limit)"),
        (path(integer("rr_depth", "0")), "2:25", "at least 1"),
        (placed(r#"<scale z="0"/>"#), "2:20", "singular"),
        (
            placed(r#"<matrix value="1 2 3 2 4 6 0 0 1"/>"#),
            "2:20",
            "singular",
        ),
        (
            placed(r#"<matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"/>"#),
            "2:20",
            "perspective",
        ),
        (
            sensor(r#"<transform name="to_world"><scale value="2"/></transform>"#),
            "2:28",
            "scale and shear",
        ),
        (
            r#"<sensor type="thinlens"/>"#.into(),
            "2:1",
            "needs the float `aperture_radius`",
        ),
        (
            r#"<emitter type="directional"><vector name="direction" value="0"/></emitter>"#.into(),
            "2:1",
            "a direction",
        ),
        (
            r#"<emitter type="envmap"><string name="filename" value="colors.exr"/>
<transform name="to_world"><scale x="2"/></transform></emitter>"#
                .into(),
            "3:1",
            "stretched",
        ),
    ]);
}

#[test]
fn contradictions_are_rejected() {
    let nested = |kind: &str| bsdf("twosided", &bsdf(kind, ""));
    let deep = "<bsdf type=\"twosided\">\n".repeat(70) + &"</bsdf>".repeat(70);
    assert_fail(&[
        (
            r#"<bsdf type="diffuse" id="a"/><bsdf type="diffuse" id="a"/><shape type="cube"><ref id="a"/></shape>"#.into(),
            "2:78",
            "scene.xml:2:1 and the one at",
        ),
        (
            sphere(&(r#"<float name="radius" value="1"/>"#.repeat(2))),
            "2:54",
            "given twice",
        ),
        (
            r#"<bsdf type="twosided" id="a"><ref id="a"/></bsdf>"#.into(),
            "2:1",
            "a -> a",
        ),
        (
            r#"<bsdf type="twosided" id="a"><ref id="b"/></bsdf>
<bsdf type="twosided" id="b"><ref id="a"/></bsdf>"#
                .into(),
            "2:1",
            "a -> b -> a",
        ),
        (deep, "66:1", "64 levels"),
        (nested("dielectric"), "2:23", "transmits"),
        (
            bsdf("twosided", &bsdf("diffuse", "").repeat(3)),
            "2:79",
            "third",
        ),
        (bsdf("twosided", ""), "2:1", "nested materials"),
        (sphere(&bsdf("diffuse", "").repeat(2)), "2:50", "its second"),
        (
            sphere(r#"<emitter type="point"/>"#),
            "2:22",
            "only `area` can",
        ),
        (
            r#"<emitter type="area"/>"#.into(),
            "2:1",
            "nested in the shape",
        ),
        (
            sphere(r#"<texture type="checkerboard"/>"#),
            "2:22",
            "does not accept a nested texture `checkerboard`",
        ),
        (
            r#"<shape type="sphere" id="s"/><ref id="s"/>"#.into(),
            "2:30",
            "already part of the scene",
        ),
        (
            bsdf(
                "conductor",
                r#"<string name="material" value="Au"/><rgb name="k" value="1"/>"#,
            ),
            "2:60",
            "not both",
        ),
        (
            bsdf("roughconductor", r#"<float name="alpha_u" value="0.1"/>"#),
            "2:1",
            "both of `alpha_u` and `alpha_v`",
        ),
        (
            sensor(r#"<float name="fov" value="9"/><string name="focal_length" value="50mm"/>"#),
            "2:57",
            "not both",
        ),
        (
            r#"<emitter type="point"><point name="position" value="1"/>
<transform name="to_world"/></emitter>"#
                .into(),
            "3:1",
            "not both",
        ),
        (
            r#"<integrator type="path"/><integrator type="path"/>"#.into(),
            "2:26",
            "one integrator",
        ),
        (
            r#"<alias id="b" as="c"/><bsdf type="diffuse" id="b"/>"#.into(),
            "2:12",
            "no object has the id `b`",
        ),
        (
            sphere(r#"<float name="radius" value="1"><float/></float>"#),
            "2:53",
            "<float> in <float>",
        ),
        (r#"<shape/>"#.into(), "2:1", "needs the attribute `type`"),
        (
            r#"<float name="radius" value="1"/>"#.into(),
            "2:1",
            "the scene has no parameter",
        ),
        (
            r#"<include filename="none.xml"/>"#.into(),
            "2:20",
            "none.xml",
        ),
        (sphere(r#"<lookat/>"#), "2:22", "<lookat> in <shape>"),
    ]);
}

#[test]
fn errors_in_files_name_the_file_and_the_element() {
    let texture = |name: &str| {
        bsdf(
            "diffuse",
            &format!(
                "<texture type=\"bitmap\" name=\"reflectance\">\n\
                 <string name=\"filename\" value=\"{name}\"/></texture>"
            ),
        )
    };
    assert_fail(&[
        (
            file("obj", "none.obj"),
            "2:19",
            "none.obj: cannot read it: No such file",
        ),
        (file("obj", "."), "2:19", "it is not a file"),
        (
            file("ply", "quad.obj"),
            "2:19",
            "quad.obj:1: a PLY file begins",
        ),
        (
            file("serialized", "quad.obj"),
            "2:26",
            "quad.obj (byte 0): no serialized mesh",
        ),
        (
            r#"<shape type="obj"/>"#.into(),
            "2:1",
            "needs the string `filename`",
        ),
        (
            texture("none.png"),
            "3:1",
            "none.png: cannot read the image: No such file",
        ),
        (texture("quad.obj"), "3:1", "quad.obj: not a usable image"),
    ]);
}

#[test]
fn images_with_invalid_values_are_rejected() {
    // 2 x 1 pixels of Radiance HDR: (0.5, 0.25, 0) and (2, 0, 0).
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("bright.hdr");
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    let pixels = [[128, 64, 0, 128], [128, 0, 0, 130]].concat();
    fs::write(&path, [header.as_slice(), &pixels].concat()).expect("a writable file");
    let name = path.display();
    let image = format!(r#"<string name="filename" value="{name}"/>"#);
    let texture = format!(r#"<texture type="bitmap" name="reflectance">{image}</texture>"#);
    assert_fail(&[(
        bsdf("diffuse", &texture),
        "2:64",
        "pixel (1, 0) is (2, 0, 0); values must be between 0 and 1",
    )]);
    let sky =
        format!(r#"<emitter type="envmap"><string name="filename" value="{name}"/></emitter>"#);
    assert!(load_body(&sky).is_ok());
}

#[test]
fn invalid_scene_files_are_rejected() {
    let entities = "<!DOCTYPE a [<!ENTITY b \"x\">]><scene version=\"3.0.0\">&b;</scene>";
    for (text, place, phrase) in [
        ("", "1:1", "the file is not XML"),
        (
            "<scene version=\"3.0.0\">\n<shape>\n</scene>",
            "3:1",
            "broken XML",
        ),
        (entities, "1:1", "broken XML"),
        (
            "<bsdf version=\"3.0.0\" type=\"diffuse\"/>",
            "1:1",
            "not <bsdf>",
        ),
        ("<scene/>", "1:1", "needs a version"),
        ("<scene version=\"three\"/>", "1:1", "not \"three\""),
        ("<scene version=\"3.0.0\"/>", "1:1", "no sensor"),
    ] {
        let message = load_text(text).expect_err(text).to_string();
        let start = format!("scene.xml:{place}: ");
        assert!(
            message.contains(&start) && message.contains(phrase),
            "{message}"
        );
    }
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("scene.xml");
    let message = load(&path, &[]).expect_err("a missing file").to_string();
    assert!(message.contains("scene.xml") && message.contains("No such file"));
    let text = b"<?xml version=\"1.0\" encoding=\"Shift_JIS\"?>\n<scene> \x81 \xff</scene>";
    fs::write(&path, text).expect("a file");
    let message = load(&path, &[]).expect_err("broken text").to_string();
    assert!(
        message.contains("scene.xml:2:9: ") && message.contains("not valid Shift_JIS"),
        "{message}"
    );
}

#[test]
fn endless_includes_are_rejected() {
    let folder = TempDir::new().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let text = format!("<scene version=\"3.0.0\">\n{text}</scene>");
        fs::write(folder.path().join(name), text).expect("a writable file");
    };
    write("a.xml", "<include filename=\"b.xml\"/>");
    write("b.xml", "<include filename=\"a.xml\"/>");
    let message = load(&folder.path().join("a.xml"), &[])
        .expect_err("a cycle")
        .to_string();
    assert!(
        message.contains("b.xml:2:20: circular include"),
        "{message}"
    );

    // Each file includes the next twice: 2^40 files.
    for i in 0..40 {
        let next = format!("<include filename=\"{}.xml\"/>", i + 1);
        write(&format!("{i}.xml"), &next.repeat(2));
    }
    write("40.xml", "");
    let message = load(&folder.path().join("0.xml"), &[])
        .expect_err("too many")
        .to_string();
    assert!(message.contains("files are included"), "{message}");
}

#[test]
fn nesting_depth_is_limited() {
    let depth = 100_000;
    let text = "<scene version=\"3.0.0\">".to_owned()
        + &"<bsdf type=\"twosided\">".repeat(depth)
        + &"</bsdf>".repeat(depth)
        + BASE
        + "</scene>";
    let message = load_text(&text).expect_err("too deep").to_string();
    assert!(message.contains("64 levels"), "{message}");
    // A long chain of references, from the innermost object to the outermost.
    let mut chain = String::from("<bsdf type=\"diffuse\" id=\"0\"/>");
    for i in 1..10_000 {
        chain += &format!(
            "<bsdf type=\"twosided\" id=\"{i}\"><ref id=\"{}\"/></bsdf>",
            i - 1
        );
    }
    let message = load_body(&chain).expect_err("too deep").to_string();
    assert!(message.contains("64 levels"), "{message}");
}

#[test]
fn reports_show_the_faulty_line() {
    let Err(error) = load_body(r#"<shape type="sphere"><float name="raduis" value="1"/></shape>"#)
    else {
        panic!("loaded");
    };
    let mut report = String::new();
    miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::none())
        .render_report(&mut report, &error)
        .expect("a report");
    assert!(report.contains("<float name=\"raduis\""), "{report}");
    assert!(report.contains("scene.xml:2:22"), "{report}");
    assert!(report.lines().count() < 24, "{report}");
}

#[test]
fn a_variable_that_decides_the_name_of_a_missing_include_is_named() {
    let folder = TempDir::new().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect(name);
    };
    write(
        "scene.xml",
        &format!(
            r#"<scene version="0.6.0">{BASE}<default name="method" value="guided"/>
<include filename="methods/$method.xml"/></scene>"#
        ),
    );
    let path = folder.path().join("scene.xml");
    let message = |defines: &[(String, String)]| match load(&path, defines) {
        Ok(_) => "loads".to_owned(),
        Err(error) => error.to_string(),
    };
    let without = message(&[]);
    let phrase = "no such folder; `$method` is `guided`; -D method=VALUE gives it another value";
    assert!(
        without.contains("scene.xml:2:20: cannot read "),
        "{without}"
    );
    assert!(without.ends_with(phrase), "{without}");

    // Settings as published: parameters of the scene, which have no effect, and an integrator.
    write(
        "methods/path.xml",
        r#"<scene version="0.6.0"><integer name="maxDepth" value="10"/>
           <integrator type="volpath"><boolean name="nee" value="false"/></integrator></scene>"#,
    );
    let with_folder = message(&[]);
    assert!(with_folder.contains("no such file; "), "{with_folder}");
    assert!(with_folder.ends_with("(known: path.xml)"), "{with_folder}");
    let loaded = load(&path, &[("method".into(), "path".into())]).expect("a scene");
    let warnings: Vec<String> = loaded.warnings.iter().map(ToString::to_string).collect();
    let ignored = "path.xml:1:24: `maxDepth` has no effect in <scene>: it is ignored";
    assert!(
        warnings.iter().any(|warning| warning.ends_with(ignored)),
        "{warnings:?}"
    );
}
