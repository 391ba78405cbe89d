//! Scene files as people have them: what Mitsuba and its exporters write, and what Mitsuba 3 makes of it.

use std::fs;
use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, Vec3A};
use metrolight::film::{Crop, Filter};
use metrolight::mitsuba::load;
use metrolight::scene::{EmitterDescription, Projection, Radiance, ShapeGeometry};
use tempfile::TempDir;

use super::{BASE, description, load_body, load_text};

/// The warnings of a scene with `body`, which must load.
fn warnings(body: &str) -> Vec<String> {
    let loaded = load_body(body).unwrap_or_else(|error| panic!("{body}: {error}"));
    loaded.warnings.iter().map(ToString::to_string).collect()
}

/// The reflectance of a diffuse ball in a file of version 0.6, given by this element.
fn old_colour(element: &str) -> Vec3A {
    let text = format!(
        "<scene version=\"0.6.0\">{BASE}<shape type=\"Sphere\"><bsdf type=\"diffuse\">{element}</bsdf></shape></scene>"
    );
    let scene = load_text(&text).expect(element).description;
    scene.textures[0].mean()
}

#[test]
fn text_that_is_not_quite_xml_is_read() {
    for (start, end) in [
        ("\n\n<?xml version=\"1.0\"?>\n", ""),
        ("\u{feff}", ""),
        ("<!-- a -- b --->", "<!------>"),
        ("\r\n<!--\r\n\t--\r\n-->", "\r\n"),
    ] {
        let text = format!("{start}<scene version=\"3.0.0\">{BASE}{end}</scene>");
        let loaded = load_text(&text).unwrap_or_else(|error| panic!("{start}: {error}"));
        assert!(loaded.warnings.is_empty(), "{start}: {:?}", loaded.warnings);
    }
}

#[test]
fn other_encodings_are_read() {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("scene.xml");
    for (declaration, warns) in [
        ("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>", false),
        ("", true),
    ] {
        let mut bytes = format!("{declaration}<scene version=\"3.0.0\">{BASE}").into_bytes();
        bytes.extend(b"<shape type=\"sphere\" id=\"B\xe4lle\"/></scene>");
        fs::write(&path, bytes).expect("a file");
        let loaded = load(&path, &[]).expect("a scene");
        let name = &loaded.description.shapes[0].name;
        assert!(name.starts_with("shape \"Bälle\""), "{name}");
        assert_eq!(!loaded.warnings.is_empty(), warns, "{:?}", loaded.warnings);
    }
}

#[test]
fn what_is_left_out_is_listed_once() {
    let ball = r#"<shape type="sphere"><boolean name="caustic_bouncer" value="true"/></shape>"#;
    let method = r#"<integrator type="pssmlt"><integer name="seeds" value="3"/></integrator>"#;
    let found = warnings(&format!("{ball}{ball}{method}"));
    assert_eq!(
        found,
        [
            "3 parameters ignored: integrator `pssmlt`: `seeds`; shape `sphere`: `caustic_bouncer` (2 times)"
        ]
    );
}

#[test]
fn what_cannot_be_used_is_a_warning() {
    for (body, phrase) in [
        (r#"<path value="nowhere"/>"#, "no folder"),
        (
            r#"<shape type="cube" id="a"/><shape type="cube" id="a"/>"#,
            "the id `a` is given twice",
        ),
        (
            r#"<medium type="homogeneous" id="fog"/>"#,
            "it has no effect",
        ),
        (r#"<sampler type="independent"/>"#, "it has no effect"),
        (r#"<shape type="shapegroup"/>"#, "no instance refers"),
        (
            r#"<integrator type="direct"/>"#,
            "the scene asks for the integrator `direct`",
        ),
    ] {
        let found = warnings(body);
        assert!(found.len() == 1 && found[0].contains(phrase), "{found:?}");
    }
    let dark = r#"<scene version="3.0.0"><sensor type="perspective"/></scene>"#;
    let loaded = load_text(dark).expect("a black image");
    let warning = loaded.warnings[0].to_string();
    assert!(
        warning.contains("no emitter: its image is black"),
        "{warning}"
    );
    assert!(loaded.description.build().is_ok());
}

/// All faults of a file are listed, each once, and only the first in the message.
#[test]
fn all_faults_are_listed() {
    let body = r#"<bsdf type="velvet" id="v"/>
        <shape type="cube"><ref id="v"/></shape><shape type="cube"><ref id="v"/></shape>
        <shape type="sphere"><float name="radius" value="-1"/><float name="size" value="1"/></shape>
        <emitter type="laser"/>"#;
    let error = load_body(body).expect_err("faults");
    let faults: Vec<String> = error.faults().map(ToString::to_string).collect();
    let phrases = [
        "`velvet`",
        "`radius` is -1",
        "no parameter `size`",
        "`laser`",
    ];
    assert_eq!(faults.len(), phrases.len(), "{faults:?}");
    for (fault, phrase) in faults.iter().zip(phrases) {
        assert!(fault.contains(phrase), "{fault}");
    }
    assert_eq!(error.to_string(), faults[0]);
    let xml = load_body(r#"<shpae type="cube"/><float name="x" value="y"/>"#);
    assert_eq!(xml.expect_err("faults").faults().count(), 2);
}

#[test]
fn objects_at_the_root_are_used_by_reference() {
    let text = r#"<scene version="3.0.0"><sampler type="independent" id="s"/>
        <film type="hdrfilm" id="f"><integer name="width" value="9"/></film>
        <emitter type="area" id="e"><rgb name="radiance" value="2"/></emitter>
        <sensor type="perspective"><ref id="s"/><ref id="f"/></sensor>
        <shape type="sphere"><ref id="e"/></shape></scene>"#;
    let loaded = load_text(text).expect("a scene");
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!(loaded.description.film.width, 9);
    let radiance = Radiance::Constant(Vec3A::splat(2.0));
    assert_eq!(loaded.description.shapes[0].emission, Some(radiance));
}

/// Values of `mi.load_dict` with these spectra as reflectance of `diffuse`, Mitsuba 3.9.1, `scalar_rgb`.
/// Three values without wavelengths, `<srgb>` and `<blackbody>` are those of version 0.6.
#[test]
fn colours_in_all_notations() {
    for (element, expected) in [
        (
            r#"<spectrum name="reflectance" value="400:0.1, 500:0.3, 600:0.6, 700:0.8"/>"#,
            [0.705605, 0.426538, 0.174197],
        ),
        (
            r#"<spectrum name="reflectance" value="0.2 0.4, 0.8" intent="reflectance"/>"#,
            [0.2, 0.4, 0.8],
        ),
        (r#"<spectrum name="reflectance" value="0.3"/>"#, [0.3; 3]),
        (
            r##"<srgb name="reflectance" value="#8000ff"/>"##,
            [0.215861, 0.0, 1.0],
        ),
        (
            r#"<spectrum name="reflectance" type="irregular"><string name="wavelengths" value="400, 500, 600, 700"/>
               <string name="values" value="0.1, 0.3, 0.6, 0.8"/></spectrum>"#,
            [0.705605, 0.426538, 0.174197],
        ),
        (
            r#"<spectrum name="reflectance" type="d65"><float name="scale" value="0.5"/></spectrum>"#,
            [0.5; 3],
        ),
    ] {
        let found = old_colour(element);
        let expected = Vec3A::from_array(expected);
        assert!(
            (found - expected).abs().max_element() < 3e-5,
            "{element}: {found}"
        );
    }
}

#[test]
fn spectra_are_read_from_files() {
    let folder = TempDir::new().expect("a temporary folder");
    fs::write(
        folder.path().join("paint.spd"),
        "# nm\n400 0.1\n500 0.3 # green\n\n600 0.6\n700 0.8\n",
    )
    .expect("a file");
    let scene = |name: &str| {
        let path = folder.path().join("scene.xml");
        let bsdf = format!(
            r#"<bsdf type="diffuse"><spectrum name="reflectance" filename="{name}"/></bsdf>"#
        );
        fs::write(
            &path,
            format!("<scene version=\"3.0.0\">{BASE}{bsdf}</scene>"),
        )
        .expect("a file");
        load(&path, &[])
    };
    let found = scene("paint.spd").expect("a spectrum").description.textures[0].mean();
    let expected = Vec3A::new(0.705605, 0.426538, 0.174197);
    assert!((found - expected).abs().max_element() < 3e-5, "{found}");
    fs::write(folder.path().join("bad.spd"), "400 0.1\n500\n").expect("a file");
    let message = scene("bad.spd").expect_err("a broken file").to_string();
    assert!(
        message.contains("bad.spd:2: not a wavelength and a value"),
        "{message}"
    );
    assert!(
        scene("none.spd")
            .expect_err("no file")
            .to_string()
            .contains("none.spd")
    );
}

/// The radiance of a black body at 6504 K is close to the white of sRGB in colour, and its luminance is that of
/// Planck's law near the peak of y, 4.3e4 W/(m^2 sr nm).
#[test]
fn a_black_body_of_the_sun_is_white() {
    let text = format!(
        "<scene version=\"0.6.0\">{BASE}<emitter type=\"constant\"><blackbody name=\"radiance\" temperature=\"6504K\" scale=\"1e-4\"/></emitter></scene>"
    );
    let scene = load_text(&text).expect("a scene").description;
    let EmitterDescription::Constant { radiance } = scene.emitters[1] else {
        panic!("{:?}", scene.emitters);
    };
    assert!(
        radiance.max_element() < 1.1 * radiance.min_element(),
        "{radiance}"
    );
    // 2 h c^2 / lambda^5 / (exp(h c / (lambda k T)) - 1) at 560 nm.
    let at_560 = 4.26;
    assert!((radiance.y / at_560 - 1.0).abs() < 0.05, "{radiance}");
}

#[test]
fn an_animation_at_rest_is_a_transform() {
    let shape = |times: &str| {
        format!(r#"<shape type="cube"><animation name="to_world">{times}</animation></shape>"#)
    };
    let still = r#"<transform time="0"><translate x="2"/></transform>"#;
    let found = description(&shape(still)).shapes[0].to_world;
    assert_eq!(found, DMat4::from_translation(DVec3::X * 2.0));
    let moving = format!(r#"{still}<transform time="1"><translate x="3"/></transform>"#);
    let error = load_body(&shape(&moving)).expect_err("motion").to_string();
    assert!(error.contains("not supported: motion"), "{error}");
}

/// `mi.ScalarTransform4f().rotate([0, 1, 1], 15)` of Mitsuba 3.9.1.
#[test]
fn an_axis_that_is_not_a_unit_vector_scales() {
    let body = r#"<shape type="cube"><transform name="to_world"><rotate y="1" z="1" angle="15"/></transform></shape>"#;
    let found = description(body).shapes[0].to_world;
    let (sin, cos) = 15.0_f64.to_radians().sin_cos();
    let rows = [
        [cos, -sin, sin, 0.0],
        [sin, 1.0, 1.0 - cos, 0.0],
        [-sin, 1.0 - cos, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ];
    let expected = DMat4::from_cols_array_2d(&rows).transpose();
    assert!(found.abs_diff_eq(expected, 1e-12), "{found}");
}

#[test]
fn normals_that_are_missing_are_those_of_triangles() {
    let folder = TempDir::new().expect("a temporary folder");
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (name, rest) in [
        ("zero", "vn 0 0 0\nf 1//1 2//1 3//1\n"),
        ("some", "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\n"),
    ] {
        let path = folder.path().join("mesh.obj");
        fs::write(&path, format!("{corners}{rest}")).expect("a file");
        let body = format!(
            r#"<shape type="obj"><string name="filename" value="{}"/></shape>"#,
            path.display()
        );
        let found = warnings(&body);
        assert!(
            found.len() == 1 && found[0].contains("vertices have no normal"),
            "{found:?}"
        );
        let ShapeGeometry::Mesh(mesh) = &description(&body).shapes[0].geometry else {
            panic!("a mesh");
        };
        assert!(
            mesh.normals.iter().all(|n| *n == [0.0, 0.0, 1.0]),
            "{name}: {:?}",
            mesh.normals
        );
    }
}

#[test]
fn instances_are_placed_by_both_transforms() {
    let body = r#"<shape type="shapegroup" id="g"><shape type="sphere"><point name="center" x="1" y="0" z="0"/></shape>
        <shape type="cube"><transform name="to_world"><translate y="1"/></transform></shape></shape>
        <shape type="instance"><ref id="g"/><transform name="to_world"><scale value="2"/></transform></shape>
        <shape type="instance"><ref id="g"/></shape>"#;
    let shapes = description(body).shapes;
    assert_eq!(shapes.len(), 4);
    let doubled = DMat4::from_scale(DVec3::splat(2.0));
    assert_eq!(shapes[0].to_world, doubled);
    assert_eq!(
        shapes[1].to_world,
        doubled * DMat4::from_translation(DVec3::Y)
    );
    assert_eq!(shapes[2].to_world, DMat4::IDENTITY);
}

/// The area of a cylinder and a disk, and the places of their texture coordinates.
#[test]
fn round_shapes_have_their_areas() {
    use std::f64::consts::PI;
    let cylinder = r#"<shape type="cylinder"><point name="p0" value="1, 2, 3"/><point name="p1" value="1, 6, 6"/><float name="radius" value="0.5"/></shape>"#;
    for (body, area) in [
        (cylinder, 2.0 * PI * 0.5 * 5.0),
        (r#"<shape type="disk"/>"#, PI),
    ] {
        let ShapeGeometry::Mesh(mesh) = &description(body).shapes[0].geometry else {
            panic!("a mesh");
        };
        let corner = |i: u32| DVec3::from_array(mesh.positions[i as usize].map(f64::from));
        let found: f64 = mesh
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(corner);
                let cross = (b - a).cross(c - a);
                let normal = DVec3::from_array(mesh.normals[t[1] as usize].map(f64::from));
                assert!(cross.dot(normal) > 0.0, "{body}");
                0.5 * cross.length()
            })
            .sum();
        assert!((found / area - 1.0).abs() < 3e-6, "{body}: {found} {area}");
    }
}

#[test]
fn cameras_and_films() {
    let scene = description(
        r#"<sensor type="orthographic"><transform name="to_world"><scale x="3" y="3"/></transform>
        <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="20"/>
        <integer name="crop_offset_x" value="4"/><integer name="crop_height" value="8"/>
        <rfilter type="box"/></film></sensor>"#,
    );
    let Projection::Orthographic { half_extent } = scene.camera.projection else {
        panic!("{:?}", scene.camera);
    };
    assert_eq!(half_extent, glam::DVec2::new(3.0, 1.5));
    let crop = Crop {
        offset: [4, 0],
        size: [36, 8],
    };
    assert_eq!(scene.film.crop, Some(crop));
    let outside = r#"<sensor type="perspective"><rfilter type="tent"/></sensor>"#;
    assert_eq!(
        description(outside).film.filter,
        Filter::Tent { radius: 1.0 }
    );
    let hidden =
        r#"<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>"#;
    assert!(description(hidden).hide_emitters);
}

fn shared(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared")
        .join(name);
    if !folder.is_dir() {
        println!("skipped: {} is absent", folder.display());
        return None;
    }
    Some(folder)
}

/// Small inputs after public bug reports, which load without an error.
#[test]
fn cases_load() {
    let Some(folder) = shared("cases") else {
        return;
    };
    let own = [
        0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 13, 14, 17, 18, 19, 20, 21, 22, 23, 24,
    ];
    let numbered = own.map(|i| format!("c{i:02}.xml"));
    let named = [
        "principal_point",
        "sampler_at_root",
        "wavelength_spectrum",
        "xml_comment_dashes",
    ];
    let named = named.map(|name| format!("{name}/scene.xml"));
    for name in numbered.iter().chain(&named) {
        let loaded = load(&folder.join(name), &[]);
        let built = loaded.map(|loaded| loaded.description.build().is_ok());
        assert!(matches!(built, Ok(true)), "{name}: {:?}", built.err());
    }
}
