//! Materials and textures: parameters of every kind, and one error for each way to get them wrong.

use metrolight::math::Rgb;
use metrolight::scene::bsdf::{DisneyLobes, NormalPerturbation};
use metrolight::scene::{Material, Roughness, SceneDescription, Texture};

use super::{description, load_body, load_text};

fn bsdf(kind: &str, parameters: &str) -> String {
    format!(r#"<bsdf type="{kind}">{parameters}</bsdf>"#)
}

fn float(name: &str, value: f32) -> String {
    format!(r#"<float name="{name}" value="{value}"/>"#)
}

const DIFFUSE: &str = r#"<bsdf type="diffuse"/>"#;
const PICTURE: &str = r#"<string name="filename" value="colors.png"/>"#;

fn bitmap(name: &str, parameters: &str) -> String {
    format!(r#"<texture type="bitmap" name="{name}">{PICTURE}{parameters}</texture>"#)
}

fn unnamed_bitmap() -> String {
    format!(r#"<texture type="bitmap">{PICTURE}</texture>"#)
}

/// The scene with this BSDF, and the last of its materials.
fn material(kind: &str, parameters: &str) -> (SceneDescription, Material) {
    let scene = description(&bsdf(kind, parameters));
    let material = scene.materials.last().expect("a material").clone();
    (scene, material)
}

/// The value of a texture that is the same everywhere.
fn constant(scene: &SceneDescription, texture: u32) -> Rgb {
    match &scene.textures[texture as usize] {
        Texture::Constant(color) => *color,
        other => panic!("{other:?}"),
    }
}

/// Asserts that the BSDF cannot be loaded, with a message that contains `phrase`.
fn assert_refused(kind: &str, parameters: &str, phrase: &str) {
    match load_body(&bsdf(kind, parameters)) {
        Ok(_) => panic!("{kind} {parameters} loads, without `{phrase}`"),
        Err(error) => assert!(error.to_string().contains(phrase), "{error}"),
    }
}

#[test]
fn roughness_is_constant_textured_or_anisotropic() {
    let roughness = |parameters: &str| {
        let (scene, material) = material("roughconductor", parameters);
        match material {
            Material::RoughConductor { roughness, .. } => (scene, roughness),
            other => panic!("{other:?}"),
        }
    };
    let (_, alpha) = roughness(&(float("alpha_u", 0.3) + &float("alpha_v", 0.3)));
    assert_eq!(alpha, Roughness::Constant(0.3));
    let (scene, alpha) = roughness(&(float("alpha_u", 0.1) + &float("alpha_v", 0.0)));
    let Roughness::Textured { along_u, along_v } = alpha else {
        panic!("{alpha:?}");
    };
    assert_eq!(constant(&scene, along_u), Rgb::splat(0.1));
    assert_eq!(constant(&scene, along_v), Rgb::splat(1e-4));
    let (scene, alpha) = roughness(&bitmap("alpha", ""));
    let Roughness::Textured { along_u, along_v } = alpha else {
        panic!("{alpha:?}");
    };
    assert_eq!(along_u, along_v);
    assert!(matches!(
        scene.textures[along_u as usize],
        Texture::Bitmap(_)
    ));
    let (_, alpha) = roughness(&(bitmap("alpha_u", "") + &float("alpha_v", 0.2)));
    assert!(matches!(alpha, Roughness::Textured { along_u, along_v } if along_u != along_v));
    assert_refused(
        "roughplastic",
        &bitmap("alpha", ""),
        "`alpha` must be a float",
    );
    assert_refused("roughconductor", &float("alpha_u", 0.2), "both of");
}

#[test]
fn masks_and_blends_contain_materials() {
    let (scene, mask) = material("mask", DIFFUSE);
    let Material::Mask { opacity, covered } = mask else {
        panic!("{mask:?}");
    };
    assert_eq!(constant(&scene, opacity), Rgb::splat(0.5));
    assert!(matches!(*covered, Material::Diffuse { .. }));
    let metal = bsdf("conductor", "");
    let (scene, blend) = material("blendbsdf", &(float("weight", 0.25) + DIFFUSE + &metal));
    let Material::Blend {
        weight,
        first,
        second,
    } = blend
    else {
        panic!("{blend:?}");
    };
    assert_eq!(constant(&scene, weight), Rgb::splat(0.25));
    assert!(matches!(
        (*first, *second),
        (Material::Diffuse { .. }, Material::Conductor { .. })
    ));
    assert_refused("mask", "", "one nested material");
    assert_refused("mask", &(DIFFUSE.to_owned() + &metal), "this is one more");
    assert_refused("blendbsdf", DIFFUSE, "two nested materials");
    assert_refused("blendbsdf", &(DIFFUSE.to_owned() + &metal), "`weight`");
    assert_refused("twosided", &bsdf("mask", DIFFUSE), "transmits");
    assert_refused(
        "mask",
        &(float("opacity", 1.5) + DIFFUSE),
        "between 0 and 1",
    );
}

/// The weights of a mixture are those of its materials in the nested blends; what they lack to 1 is black.
#[test]
fn mixtures_are_nested_blends() {
    /// The weights of the materials in the order of the file, black first.
    fn weights(scene: &SceneDescription, material: &Material, weight: f32, found: &mut Vec<f32>) {
        match material {
            Material::Blend {
                weight: share,
                first,
                second,
            } => {
                let share = constant(scene, *share).x;
                weights(scene, first, weight * (1.0 - share), found);
                weights(scene, second, weight * share, found);
            }
            _ => found.push(weight),
        }
    }
    let nested = [DIFFUSE, DIFFUSE, DIFFUSE].concat();
    for (given, expected) in [
        ("0.2, 0.3, 0.1", vec![0.4, 0.2, 0.3, 0.1]),
        ("0.5 0.25 0.25", vec![0.5, 0.25, 0.25]),
        ("2, 1, 1", vec![0.5, 0.25, 0.25]),
        ("0, 0, 1", vec![1.0]),
        ("0, 0, 0", vec![1.0]),
    ] {
        let parameters = format!(r#"<string name="weights" value="{given}"/>{nested}"#);
        let (scene, mixture) = material("mixturebsdf", &parameters);
        let mut found = Vec::new();
        weights(&scene, &mixture, 1.0, &mut found);
        assert_eq!(found.len(), expected.len(), "{given}: {found:?}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-6, "{given}: {found}");
        }
    }
    let weights = |text: &str| format!(r#"<string name="weights" value="{text}"/>{DIFFUSE}"#);
    assert_refused(
        "mixturebsdf",
        &weights("0.5, 0.5"),
        "2 weights for 1 materials",
    );
    assert_refused("mixturebsdf", &weights("-1"), "0 or above");
    assert_refused("mixturebsdf", &weights("half"), "finite number");
    assert_refused("mixturebsdf", DIFFUSE, "`weights`");
}

#[test]
fn normals_are_perturbed_by_textures() {
    let shadow = r#"<boolean name="use_shadowing_function" value="false"/>"#;
    let (scene, mapped) = material("normalmap", &(bitmap("normalmap", "") + shadow + DIFFUSE));
    let Material::NormalMap {
        normals,
        perturbation,
        ..
    } = mapped
    else {
        panic!("{mapped:?}");
    };
    assert!(matches!(
        scene.textures[normals as usize],
        Texture::Bitmap(_)
    ));
    let default = NormalPerturbation::default();
    assert!(perturbation.flip_invalid_normals && !perturbation.use_shadowing_function);
    let (_, bumps) = material(
        "bumpmap",
        &(float("scale", 2.5) + &unnamed_bitmap() + DIFFUSE),
    );
    let Material::BumpMap {
        scale,
        perturbation,
        ..
    } = bumps
    else {
        panic!("{bumps:?}");
    };
    assert_eq!((scale, perturbation), (2.5, default));
    // Forks of Mitsuba 2 name the image of a normal map directly.
    let (scene, mapped) = material("normalmap", &(PICTURE.to_owned() + DIFFUSE));
    let Material::NormalMap { normals, .. } = mapped else {
        panic!("{mapped:?}");
    };
    assert!(matches!(
        scene.textures[normals as usize],
        Texture::Bitmap(_)
    ));
    assert_refused("normalmap", DIFFUSE, "the texture `normalmap`");
    assert_refused("bumpmap", DIFFUSE, "one nested texture");
    let nested = bsdf("bumpmap", &(unnamed_bitmap() + DIFFUSE));
    let within = bitmap("normalmap", "") + &nested;
    assert_refused("normalmap", &within, "within another");
}

#[test]
fn disney_s_models_have_the_defaults_of_mitsuba() {
    let (scene, principled) = material("principled", "");
    let Material::Principled(principled) = principled else {
        panic!("{principled:?}");
    };
    assert_eq!(constant(&scene, principled.base_color), Rgb::splat(0.5));
    assert_eq!(constant(&scene, principled.roughness), Rgb::splat(0.5));
    assert_eq!(constant(&scene, principled.clearcoat), Rgb::ZERO);
    // 2 / (1 - sqrt(0.08 * 0.5)) - 1
    assert!((principled.eta - 1.5).abs() < 1e-6 && !principled.transmits);
    let eta = |parameters: &str| match material("principled", parameters).1 {
        Material::Principled(principled) => principled.eta,
        other => panic!("{other:?}"),
    };
    assert_eq!(eta(&float("eta", 1.4)), 1.4);
    assert_eq!(eta(&(float("eta", 1.0) + &float("spec_trans", 0.5))), 1.001);
    let (scene, thin) = material("principledthin", &float("diff_trans", 1.2));
    let Material::PrincipledThin(thin) = thin else {
        panic!("{thin:?}");
    };
    assert_eq!(constant(&scene, thin.diff_trans), Rgb::splat(0.6));
    assert_eq!(thin.eta, 1.5);
    let both = float("eta", 1.5) + &float("specular", 0.5);
    assert_refused("principled", &both, "either `eta` or `specular`");
    assert_refused("principled", &float("metallic", 2.0), "between 0 and 1");
    assert_refused(
        "principledthin",
        &float("diff_trans", 2.5),
        "between 0 and 2",
    );
    let transparent = bsdf("principled", &float("spec_trans", 1.0));
    assert_refused("twosided", &transparent, "transmits");
}

#[test]
fn phong_reflection_has_the_defaults_of_mitsuba_0_6() {
    let (scene, phong) = material("phong", "");
    let Material::Phong {
        exponent,
        diffuse_reflectance,
        specular_reflectance,
    } = phong
    else {
        panic!("{phong:?}");
    };
    assert_eq!(exponent, 30.0);
    assert_eq!(constant(&scene, diffuse_reflectance), Rgb::splat(0.5));
    assert_eq!(constant(&scene, specular_reflectance), Rgb::splat(0.2));
    assert_refused("phong", &float("exponent", -1.0), "between 0");
    let bright = float("diffuse_reflectance", 0.7) + &float("specular_reflectance", 0.6);
    assert_refused("phong", &bright, "must not exceed 1");
}

/// Filters of version 0.x are read with a warning; what only concerns their speed is ignored.
#[test]
fn old_parameters_of_bitmaps_are_read() {
    let scene = |version: &str, parameters: &str| {
        let path = super::fixtures();
        load_text(&format!(
            "<scene version=\"{version}\"><path value=\"{}\"/>\n{}{}</scene>",
            path.display(),
            bsdf("diffuse", &bitmap("reflectance", parameters)),
            super::BASE
        ))
    };
    for filter in ["trilinear", "ewa", "EWA"] {
        let name = format!(r#"<string name="filterType" value="{filter}"/>"#);
        let anisotropy = r#"<float name="maxAnisotropy" value="8"/>"#;
        let loaded = scene("0.6.0", &(name + anisotropy)).expect("a scene");
        let [warning] = &loaded.warnings[..] else {
            panic!("{:?}", loaded.warnings);
        };
        let text = warning.to_string();
        assert!(text.contains(filter) && text.contains("bilinear"), "{text}");
        assert!(text.contains("scene.xml:2:"), "{text}");
    }
    let value = |parameters: &str, at: [f32; 2]| {
        let loaded = scene("0.6.0", parameters).expect("a scene");
        let texture = loaded
            .description
            .textures
            .last()
            .expect("a texture")
            .clone();
        texture.evaluate(at.into())
    };
    let scaled = value(r#"<float name="uvscale" value="2"/>"#, [0.2, 0.3]);
    assert_eq!(scaled, value("", [0.4, 0.6]));
    let both = r#"<float name="uvscale" value="2"/><float name="vscale" value="3"/>"#;
    assert_eq!(value(both, [0.2, 0.3]), value("", [0.4, 0.3 * 3.0]));
    let raw = value(r#"<boolean name="raw" value="true"/>"#, [0.2, 0.3]);
    assert_eq!(value(r#"<float name="gamma" value="1"/>"#, [0.2, 0.3]), raw);
    assert!(value(r#"<float name="gamma" value="-1"/>"#, [0.2, 0.3]) != raw);
    let error = |parameters: &str| match scene("0.6.0", parameters) {
        Ok(_) => panic!("{parameters} loads"),
        Err(error) => error.to_string(),
    };
    let other = error(r#"<float name="gamma" value="2.2"/>"#);
    assert!(other.contains("a `gamma` other than"), "{other}");
    let cubic = error(r#"<string name="filterType" value="cubic"/>"#);
    assert!(cubic.contains("bilinear, nearest"), "{cubic}");
}

#[test]
fn lajolla_s_models_have_its_defaults() {
    let load = |kind: &str, parameters: &str| match material(kind, parameters) {
        (scene, Material::DisneySum(disney)) => (scene, disney),
        (_, other) => panic!("{other:?}"),
    };
    let (scene, whole) = load("disneybsdf", &float("specular_transmission", 0.4));
    assert_eq!(constant(&scene, whole.base_color), Rgb::splat(0.5));
    assert_eq!(constant(&scene, whole.sheen_tint), Rgb::splat(0.5));
    assert_eq!(constant(&scene, whole.clearcoat_gloss), Rgb::ONE);
    assert!(whole.eta == 1.5 && whole.transmits && whole.lobes == DisneyLobes::All);
    assert!(!load("disneybsdf", "").1.transmits);
    let (scene, glass) = load("disneyglass", &float("eta", 1.3));
    assert_eq!(constant(&scene, glass.specular_transmission), Rgb::ONE);
    assert_eq!(constant(&scene, glass.metallic), Rgb::ZERO);
    assert!(glass.eta == 1.3 && glass.transmits);
    let (scene, metal) = load("disneymetal", &float("roughness", 0.01));
    assert_eq!(constant(&scene, metal.metallic), Rgb::ONE);
    assert_eq!(constant(&scene, metal.clearcoat), Rgb::ZERO);
    for (kind, lobes) in [
        ("disneydiffuse", DisneyLobes::Diffuse),
        ("disneysheen", DisneyLobes::Sheen),
        ("disneyclearcoat", DisneyLobes::Clearcoat),
    ] {
        assert_eq!(load(kind, "").1.lobes, lobes);
    }
    assert_refused("disneyglass", &float("eta", 1.0), "between 1.001 and 2");
    assert_refused("disneysheen", &float("roughness", 0.2), "`roughness`");
    assert_refused("twosided", &bsdf("disneyglass", ""), "transmits");
}

#[test]
fn ashikhmin_shirley_s_distribution_has_one_roughness() {
    let with = |kind: &str, roughness: &str| {
        format!(r#"<string name="distribution" value="{kind}"/>{roughness}"#)
    };
    let both = |value| float("alpha_u", value) + &float("alpha_v", value);
    for kind in ["as", "phong"] {
        match material("roughconductor", &with(kind, &both(0.8))).1 {
            Material::AshikhminShirley { alpha, .. } => assert_eq!(alpha, 0.8),
            other => panic!("{other:?}"),
        }
    }
    let refused = |roughness: &str, phrase| {
        assert_refused("roughconductor", &with("as", roughness), phrase);
    };
    refused(&float("alpha", 1.5), "at most 1");
    refused(&bitmap("alpha", ""), "textured or anisotropic");
    let anisotropic = float("alpha_u", 0.1) + &float("alpha_v", 0.2);
    refused(&anisotropic, "textured or anisotropic");
    assert_refused("roughdielectric", &with("as", ""), "beckmann, ggx");
}
