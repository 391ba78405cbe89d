//! Compares the loader with Mitsuba 3.9.1 and checks that it rejects invalid input. The expected
//! numbers are printed by `fixtures/make_fixtures.py` or by the snippets next to them.

#[path = "loader/errors.rs"]
mod errors;
#[path = "loader/images.rs"]
mod images;
#[path = "loader/materials.rs"]
mod materials;
#[path = "loader/meshes.rs"]
mod meshes;
#[path = "loader/published.rs"]
mod published;
#[path = "loader/robustness.rs"]
mod robustness;

use std::fs;
use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, Vec3A};
use metrolight::film::Filter;
use metrolight::mitsuba::{LoadError, Loaded, Overrides, load, load_with};
use metrolight::scene::{
    DepthLimits, EmitterDescription, Material, Projection, Radiance, Roughness, SceneDescription,
    ShapeGeometry, Texture,
};
use proptest::prelude::*;
use tempfile::TempDir;

/// A camera and an emitter, without which a scene cannot be loaded.
const BASE: &str = r#"<sensor type="perspective"/><emitter type="point"/>"#;

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures")
}

/// Loads a scene file with this text.
fn load_text(text: &str) -> Result<Loaded, LoadError> {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("scene.xml");
    fs::write(&path, text).expect("a writable file");
    load(&path, &[])
}

/// Loads a scene whose second line begins with `body`. File names are relative to the fixtures.
fn load_body(body: &str) -> Result<Loaded, LoadError> {
    let fixtures = fixtures();
    let fixtures = fixtures.display();
    load_text(&format!(
        "<scene version=\"3.0.0\">\n{body}\n<path value=\"{fixtures}\"/>{BASE}</scene>"
    ))
}

fn description(body: &str) -> SceneDescription {
    match load_body(body) {
        Ok(loaded) => loaded.description,
        Err(error) => panic!("{body}: {error}"),
    }
}

/// The horizontal field of view of a perspective camera, in degrees.
fn fov_x(scene: &SceneDescription) -> f64 {
    match scene.camera.projection {
        Projection::Perspective { fov_x, .. } => fov_x,
        Projection::Orthographic { .. } => panic!("a perspective camera"),
    }
}

fn define(name: &str, value: &str) -> (String, String) {
    (name.to_owned(), value.to_owned())
}

#[test]
fn published_scenes_load_without_a_warning() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    if !scenes.is_dir() {
        println!("skipped: {} is absent", scenes.display());
        return;
    }
    for (name, shapes, emitting, depth) in [
        ("cornell-box", 8, 1, 30),
        ("veach-mis", 9, 3, 3),
        ("veach-bidir", 14, 2, 7),
    ] {
        let path = scenes.join(name).join("scene.xml");
        let loaded = load(&path, &[define("integrator", "path")]).expect(name);
        assert!(loaded.warnings.is_empty(), "{name}: {:?}", loaded.warnings);
        let scene = loaded.description;
        assert_eq!(scene.shapes.len(), shapes, "{name}");
        let lit = scene.shapes.iter().filter(|s| s.emission.is_some()).count();
        assert_eq!(lit, emitting, "{name}");
        assert_eq!(scene.depth.max_depth, Some(depth), "{name}");
        // Metrolight does not have the integrator that the files specify.
        let warnings = load(&path, &[]).expect(name).warnings;
        assert_eq!(warnings.len(), 1, "{name}");
        assert!(warnings[0].text.contains("path_guiding_integrator"));
    }
}

#[test]
fn every_supported_plugin_is_loaded() {
    let path = fixtures().join("everything.xml");
    let loaded = load(&path, &[define("depth", "4")]).expect("a scene");
    let scene = &loaded.description;
    let depth = DepthLimits {
        max_depth: Some(4),
        rr_depth: 9,
    };
    assert_eq!(scene.depth, depth, "-D takes precedence over <default>");
    assert_eq!((scene.film.width, scene.film.height), (320, 200));
    assert_eq!(scene.film.filter, Filter::Tent { radius: 1.5 });
    let camera = &scene.camera;
    let Projection::Perspective { fov_x, lens } = camera.projection else {
        panic!("a perspective camera");
    };
    assert!((fov_x - 60.428_966_5).abs() < 4e-6);
    assert_eq!((camera.near_clip, camera.far_clip), (0.1, 1000.0));
    let lens = lens.expect("a thin lens");
    assert_eq!((lens.aperture_radius, lens.focus_distance), (0.05, 3.0));

    assert_eq!(scene.shapes.len(), 7);
    let shape = |i: usize| &scene.shapes[i];
    let place = format!("shape \"early\" ({}:29:5)", path.display());
    assert_eq!(shape(0).name, place);
    let material = |i: usize| &scene.materials[shape(i).material as usize];
    let texture = |i: &u32| &scene.textures[*i as usize];
    let Material::Diffuse { reflectance } = material(0) else {
        panic!("{:?}", material(0));
    };
    let Texture::Constant(color) = texture(reflectance) else {
        panic!("{:?}", texture(reflectance));
    };
    assert_eq!(*color, Vec3A::new(0.1, 0.2, 0.3));
    let Material::Diffuse { reflectance } = material(1) else {
        panic!("{:?}", material(1));
    };
    assert!(matches!(texture(reflectance), Texture::Bitmap(_)));
    assert!(shape(2).flip_normals && !shape(1).flip_normals);
    assert!(matches!(material(2), Material::TwoSided { .. }));
    let Material::Dielectric { eta, .. } = material(3) else {
        panic!("{:?}", material(3));
    };
    assert!((eta - 2.418_33).abs() < 1e-5);
    let Material::RoughDielectric { eta, roughness, .. } = material(4) else {
        panic!("{:?}", material(4));
    };
    assert!((eta - 1.504_183_3).abs() < 1e-6);
    assert_eq!(*roughness, Roughness::Constant(1e-4));
    let ShapeGeometry::Sphere { center, radius } = shape(5).geometry else {
        panic!("{:?}", shape(5).geometry);
    };
    assert_eq!((center, radius), (DVec3::new(1.0, 2.0, 3.0), 0.5));
    let radiance = Radiance::Constant(Vec3A::new(1.0, 2.0, 3.0));
    assert_eq!(shape(5).emission, Some(radiance));
    let Material::Conductor { eta, k, .. } = material(6) else {
        panic!("{:?}", material(6));
    };
    assert_eq!(*eta, Vec3A::new(0.2, 0.9, 1.1));
    assert_eq!(*k, Vec3A::new(3.9, 2.4, 2.1));

    let [point, directional, environment] = &scene.emitters[..] else {
        panic!("{:?}", scene.emitters);
    };
    // Mitsuba: traverse(scene)["...intensity.value"] = [2.40959, 1.89658, 1.81783].
    let EmitterDescription::Point {
        position,
        intensity,
    } = point
    else {
        panic!("{point:?}");
    };
    assert_eq!(*position, DVec3::new(1.0, 2.0, 3.0));
    assert!(intensity.abs_diff_eq(Vec3A::new(2.40959, 1.89658, 1.81783), 1e-5));
    let EmitterDescription::Directional {
        direction,
        irradiance,
    } = directional
    else {
        panic!("{directional:?}");
    };
    assert!(direction.abs_diff_eq(DVec3::new(1.0, -2.0, 0.0).normalize(), 1e-15));
    assert_eq!(*irradiance, Vec3A::splat(3.0));
    let EmitterDescription::Environment {
        width,
        pixels,
        scale,
        to_world,
    } = environment
    else {
        panic!("{environment:?}");
    };
    assert_eq!((*width, pixels.len(), *scale), (4, 12, 0.5));
    assert!(to_world.abs_diff_eq(DMat4::from_rotation_y(90_f64.to_radians()), 1e-15));
}

#[test]
fn names_of_version_0_6_are_upgraded() {
    let shown = |name: &str| {
        let path = fixtures().join(name);
        let mut scene = load(&path, &[]).expect(name).description;
        for shape in &mut scene.shapes {
            shape.name.clear();
        }
        format!("{scene:?}")
    };
    assert_eq!(shown("everything.xml"), shown("everything_06.xml"));
}

#[test]
fn defaults_match_mitsuba() {
    let scene = description(
        r#"<shape type="sphere"/><shape type="cube"><emitter type="area"/></shape>
           <shape type="sphere"><bsdf type="roughconductor"/></shape>"#,
    );
    assert_eq!(scene.depth.max_depth, None);
    assert_eq!(scene.depth.rr_depth, 5);
    assert_eq!((scene.film.width, scene.film.height), (768, 576));
    assert_eq!(scene.film.filter, Filter::Gaussian { stddev: 0.5 });
    // Mitsuba: x_fov = 38.18484115600586 for focal_length = 50mm.
    assert!((fov_x(&scene) - 38.184_841).abs() < 1e-5);
    assert_eq!(scene.camera.near_clip, 0.01);
    assert_eq!(scene.camera.far_clip, 1e4);
    let projection = scene.camera.projection;
    assert!(matches!(
        projection,
        Projection::Perspective { lens: None, .. }
    ));
    let albedo = |i: usize| match &scene.materials[scene.shapes[i].material as usize] {
        Material::Diffuse { reflectance } => scene.textures[*reflectance as usize].mean().x,
        other => panic!("{other:?}"),
    };
    assert_eq!((albedo(0), albedo(1)), (0.5, 0.0));
    let radiance = Radiance::Constant(Vec3A::ONE);
    assert_eq!(scene.shapes[1].emission, Some(radiance));
    let rough = &scene.materials[scene.shapes[2].material as usize];
    let Material::RoughConductor {
        roughness, eta, k, ..
    } = rough
    else {
        panic!("{rough:?}");
    };
    assert_eq!(*roughness, Roughness::Constant(0.1));
    assert_eq!((*eta, *k), (Vec3A::ZERO, Vec3A::ONE));
    let EmitterDescription::Point { intensity, .. } = scene.emitters[0] else {
        panic!("{:?}", scene.emitters);
    };
    assert_eq!(intensity, Vec3A::ONE);
}

/// Mitsuba: `np.array(traverse(rectangle)["...to_world"].matrix)`, in f32.
#[test]
fn transforms_match_mitsuba() {
    for (steps, rows) in [
        (
            r#"<scale x="2" y="3"/><rotate x="0.6" z="-0.8" angle="33"/>
               <translate x="1" y="2" z="3"/>"#,
            [
                [1.793_498_3, 1.307_133_7, -0.077_438_13, 1.0],
                [-0.871_422_47, 2.516_011_7, -0.326_783_42, 2.0],
                [-0.154_876_26, 0.980_350_26, 0.941_921_4, 3.0],
            ],
        ),
        (
            r#"<translate value="1 2 3"/><matrix value="1 2 3 4 5 6 7 8 10"/>
               <scale value="0.5"/>"#,
            [
                [0.5, 1.0, 1.5, 7.0],
                [2.0, 2.5, 3.0, 16.0],
                [3.5, 4.0, 5.0, 26.5],
            ],
        ),
        (
            r#"<lookat origin="1,2,3" target="0 0 0" up="0,1,0"/>"#,
            [
                [-0.948_683_3, -0.169_030_85, -0.267_261_24, 1.0],
                [0.0, 0.845_154_2, -0.534_522_5, 2.0],
                [0.316_227_76, -0.507_092_5, -0.801_783_74, 3.0],
            ],
        ),
        (
            r#"<lookat origin="1,2,3" target="0 0 0"/><rotate value="0,1,0" angle="90"/>"#,
            [
                [-0.534_522_5, -0.267_261_24, -0.801_783_74, 3.0],
                [0.841_427, -0.079_286_51, -0.534_522_5, 2.0],
                [0.079_286_51, -0.960_356_8, 0.267_261_24, -1.0],
            ],
        ),
    ] {
        let scene = description(&format!(
            r#"<shape type="rectangle"><transform name="to_world">{steps}</transform></shape>"#
        ));
        let found = scene.shapes[0].to_world;
        for (i, row) in rows.iter().enumerate() {
            for (j, expected) in row.iter().enumerate() {
                let error = (found.row(i)[j] - expected).abs();
                assert!(error < 5e-7, "{steps}: {i}, {j}: {}", found.row(i)[j]);
            }
        }
    }
}

/// Mitsuba: `traverse(sensor)["x_fov"]`, in f32.
#[test]
fn fields_of_view_match_mitsuba() {
    for (size, parameters, x_fov) in [
        ((320, 200), "", 40.296_192),
        ((320, 200), FOV_40, 40.0),
        ((320, 200), "y", 60.428_966_5),
        ((320, 200), "diagonal", 34.305_278_8),
        ((320, 200), "smaller", 60.428_966_5),
        ((320, 200), "larger", 40.0),
        ((200, 320), "smaller", 40.0),
        ((200, 320), "larger", 25.631_267_5),
        ((200, 320), "diagonal", 21.836_923_6),
        ((320, 200), FOCAL_35, 55.321_941_4),
    ] {
        let parameters = match parameters {
            "" | FOV_40 | FOCAL_35 => parameters.to_owned(),
            axis => format!(r#"{FOV_40}<string name="fov_axis" value="{axis}"/>"#),
        };
        let (width, height) = size;
        let found = load_text(&format!(
            r#"<scene version="3.0.0"><emitter type="point"/><sensor type="perspective">{parameters}
               <film type="hdrfilm"><integer name="width" value="{width}"/>
               <integer name="height" value="{height}"/></film></sensor></scene>"#
        ));
        let found = fov_x(&found.expect("a scene").description);
        assert!(
            (found - x_fov).abs() < 4e-6,
            "{size:?} {parameters}: {found}"
        );
    }
}

const FOV_40: &str = r#"<float name="fov" value="40"/>"#;
const FOCAL_35: &str = r#"<string name="focal_length" value="35mm"/>"#;

#[test]
fn overriding_the_size_changes_the_field_of_view() {
    let path = fixtures().join("everything.xml");
    let size = Some([200, 320]);
    let scene = load_with(&path, &[], Overrides { size }).expect("a scene");
    let scene = scene.description;
    assert_eq!((scene.film.width, scene.film.height), (200, 320));
    assert!((fov_x(&scene) - 40.0).abs() < 1e-9);
}

#[test]
fn included_files_are_part_of_the_scene() {
    let folder = TempDir::new().expect("a temporary folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect(name);
    fs::create_dir(folder.path().join("parts")).expect("a folder");
    fs::copy(
        fixtures().join("normals.obj"),
        folder.path().join("parts/mesh.obj"),
    )
    .expect("a mesh");
    // Each file has its own version; ids and variables are shared.
    write(
        "parts/materials.xml",
        r#"<scene version="0.6.0"><default name="albedo" value="0.25"/>
           <bsdf type="diffuse" id="m"><rgb name="diffuseReflectance" value="$albedo"/></bsdf>
           <shape type="obj"><string name="filename" value="mesh.obj"/></shape></scene>"#,
    );
    write(
        "parts/light.xml",
        r#"<emitter version="3.0.0" type="constant"/>"#,
    );
    write(
        "scene.xml",
        r#"<scene version="3.0.0"><include filename="parts/materials.xml"/>
           <include filename="parts/light.xml"/><sensor type="perspective"/>
           <shape type="sphere"><ref id="m"/><float name="radius" value="$albedo"/></shape></scene>"#,
    );
    let defines = [define("albedo", "0.75"), define("nothing", "1")];
    let loaded = load(&folder.path().join("scene.xml"), &defines).expect("a scene");
    let scene = loaded.description;
    assert_eq!(scene.shapes.len(), 2);
    assert_eq!(scene.emitters.len(), 1);
    let ShapeGeometry::Sphere { radius, .. } = scene.shapes[1].geometry else {
        panic!("{:?}", scene.shapes[1]);
    };
    assert_eq!(radius, 0.75);
    let Material::Diffuse { reflectance } = scene.materials[scene.shapes[1].material as usize]
    else {
        panic!("{:?}", scene.materials);
    };
    assert_eq!(scene.textures[reflectance as usize].mean().x, 0.75);
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    assert!(loaded.warnings[0].text.contains("-D nothing"));
}

#[test]
fn warnings_have_a_place() {
    let second = r#"<sensor type="perspective"/>"#;
    for (body, place, text) in [
        (r#"<integrator type="direct"/>"#, "2:1", "`direct`"),
        (
            "hello <shape type=\"sphere\"/>",
            "1:24",
            "between elements is ignored",
        ),
        (second, "3:", "only the first sensor"),
        (
            r#"<shape type="cube"><transform name="to_world"><rotate x="2" angle="9"/></transform></shape>"#,
            "2:47",
            "not of unit length",
        ),
        (
            r#"<shape type="obj"><string name="filename" value="quad.obj"/></shape>"#,
            "2:19",
            "3 of 7 vertices",
        ),
    ] {
        let loaded = load_body(body).expect(body);
        assert_eq!(loaded.warnings.len(), 1, "{body}: {:?}", loaded.warnings);
        let warning = loaded.warnings[0].to_string();
        assert!(
            warning.contains(&format!("scene.xml:{place}")) && warning.contains(text),
            "{warning}"
        );
    }
}

/// Mitsuba: `traverse(shape)["...to_uv"].matrix`, 3 x 3. The third row and column of a 4 x 4 matrix
/// are dropped; a `<matrix>` of 9 numbers is first extended to 4 x 4.
#[test]
fn texture_transforms_match_mitsuba() {
    for (steps, linear, translation) in [
        (
            r#"<scale x="2" y="3"/><translate x=".1" y=".2"/>"#,
            [2.0, 0.0, 0.0, 3.0],
            [0.1, 0.2],
        ),
        (
            r#"<matrix value="2 0 .1 0 3 .2 0 0 1"/>"#,
            [2.0, 0.0, 0.0, 3.0],
            [0.0, 0.0],
        ),
        (
            r#"<matrix value="2 4 5 .1 0 3 6 .2 0 0 1 0 0 0 0 1"/>"#,
            [2.0, 0.0, 4.0, 3.0],
            [0.1, 0.2],
        ),
    ] {
        let scene = description(&format!(
            r#"<texture type="checkerboard"><transform name="to_uv">{steps}</transform></texture>"#
        ));
        let Texture::Checkerboard {
            color0,
            color1,
            to_uv,
        } = scene.textures[0]
        else {
            panic!("{:?}", scene.textures);
        };
        assert_eq!((color0.x, color1.x), (0.4, 0.2));
        assert_eq!(to_uv.matrix2.to_cols_array(), linear, "{steps}");
        assert_eq!(to_uv.translation.to_array(), translation, "{steps}");
    }
}

#[test]
fn metal_indices_are_relative_to_the_medium_outside() {
    let scene = description(
        r#"<shape type="sphere"><bsdf type="conductor"><rgb name="eta" value="1, 2, 3"/>
           <rgb name="k" value="4"/><string name="ext_eta" value="water"/></bsdf></shape>"#,
    );
    let Material::Conductor { eta, k, .. } = scene.materials[0] else {
        panic!("{:?}", scene.materials[0]);
    };
    let water = 1.333;
    assert!(eta.abs_diff_eq(Vec3A::new(1.0, 2.0, 3.0) / water, 1e-6));
    assert!(k.abs_diff_eq(Vec3A::splat(4.0) / water, 1e-6));
}

proptest! {
    /// A number written with all its digits is read without a rounding error.
    #[test]
    fn numbers_are_read_exactly(x in proptest::num::f64::NORMAL | proptest::num::f64::ZERO) {
        let body = format!(
            r#"<shape type="cube"><transform name="to_world"><translate y=" {x:e} "/></transform></shape>"#
        );
        prop_assert_eq!(description(&body).shapes[0].to_world.w_axis.y, x);
    }

    /// No text in any kind of value causes a panic.
    #[test]
    fn any_text_is_a_value_or_an_error(text in "\\PC{0,40}", kind in 0_usize..8) {
        let kinds = ["float", "integer", "boolean", "string", "rgb", "spectrum", "point", "ref"];
        let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
        let attribute = if kinds[kind] == "ref" { "id" } else { "value" };
        let _ = load_body(&format!(
            r#"<shape type="sphere"><{0} name="radius" {attribute}="{escaped}"/></shape>"#,
            kinds[kind]
        ));
    }
}
