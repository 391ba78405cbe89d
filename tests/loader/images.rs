//! Compares images with those that Mitsuba reads from the same files.

use super::fixtures;
use metrolight::film::{Decode, ReadImageError, read_image};
use metrolight::mitsuba::{LoadError, load};
use metrolight::scene::{Radiance, SceneDescription};
use std::fs;
use tempfile::TempDir;

/// Mitsuba: `np.array(mi.Bitmap(name).convert(RGB, Float32, False))` at [0, 1] and [2, 3]. The
/// tolerance is the precision of the format.
#[test]
fn pixels_match_mitsuba() {
    let png = [
        [0.007_499, 0.011_612_3, 0.016_807_4],
        [0.799_102_5, 0.854_992_4, 0.913_098_4],
    ];
    let linear = [
        [0.082_352_9, 0.109_803_9, 0.137_254_9],
        [0.905_882_4, 0.933_333_3, 0.960_784_3],
    ];
    let half = [
        [0.082_336_4, 0.109_802_2, 0.137_207],
        [0.905_761_7, 0.933_105_5, 0.960_937_5],
    ];
    let hdr = [
        [0.082_031_25, 0.109_375, 0.136_718_75],
        [0.902_343_75, 0.929_687_5, 0.957_031_25],
    ];
    let grey = |[a, b]: [[f32; 3]; 2]| [[a[0]; 3], [b[0]; 3]];
    for (name, expected, tolerance) in [
        ("colors.png", png, 1e-6),
        ("grey.png", grey(png), 1e-6),
        ("colors16.png", png, 1e-6),
        ("colors.exr", linear, 1e-7),
        ("grey.exr", grey(linear), 1e-7),
        ("half.exr", half, 1e-6),
        ("colors.hdr", hdr, 1e-7),
    ] {
        let image = read_image(&fixtures().join(name), Decode::Srgb).expect(name);
        assert_eq!(
            (image.width, image.height, image.pixels.len()),
            (4, 3, 12),
            "{name}"
        );
        for (index, expected) in [1, 11].into_iter().zip(expected) {
            for (found, expected) in image.pixels[index].into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() <= tolerance,
                    "{name}: {found} {expected}"
                );
            }
        }
    }
    let flat = read_image(&fixtures().join("flat.jpg"), Decode::Srgb).expect("a JPEG");
    assert_eq!((flat.width, flat.height), (8, 8));
    let is_flat = |p: &[f32; 3]| p.iter().all(|x| (x - 0.127_437_77).abs() < 1e-6);
    assert!(flat.pixels.iter().all(is_flat), "{:?}", flat.pixels);
}

#[test]
fn raw_images_are_not_decoded() {
    let image = read_image(&fixtures().join("colors.png"), Decode::Raw).expect("a PNG");
    for (found, code) in image.pixels[1].into_iter().zip([21.0, 28.0, 35.0]) {
        assert!((found - code / 255.0).abs() < 1e-7);
    }
    let exr = |decode| read_image(&fixtures().join("colors.exr"), decode).expect("an EXR");
    assert_eq!(exr(Decode::Raw), exr(Decode::Srgb));
}

#[test]
fn excessive_sizes_are_rejected_before_allocation() {
    let folder = TempDir::new().expect("a temporary folder");
    let is_too_large = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("a writable file");
        let result = read_image(&path, Decode::Srgb);
        assert!(
            matches!(result, Err(ReadImageError::TooLarge { .. })),
            "{name}: {result:?}"
        );
    };
    is_too_large(
        "a.hdr",
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n",
    );
    // An EXR with a data window from (0, 0) to (9999, 9999), in a file of some hundred bytes.
    let mut exr = fs::read(fixtures().join("colors.exr")).expect("an EXR");
    let name = b"dataWindow\0box2i\0";
    let at = exr
        .windows(name.len())
        .position(|w| w == name)
        .expect("a window")
        + name.len()
        + 12;
    exr[at..at + 8].copy_from_slice(&[0x0F, 0x27, 0, 0, 0x0F, 0x27, 0, 0]);
    is_too_large("a.exr", &exr);
    // 11000 x 11000 pixels, fewer than the limit, in a file too small to contain them. The size is
    // in the frame header of the JPEG and in the image header of the PNG, whose checksum is that of
    // the new size.
    let size = 11_000_u16.to_be_bytes();
    let mut jpeg = fs::read(fixtures().join("flat.jpg")).expect("a JPEG");
    let frame = jpeg.windows(2).position(|w| w == [0xFF, 0xC0]);
    let at = frame.expect("a frame") + 5;
    jpeg[at..at + 4].copy_from_slice(&[size, size].concat());
    is_too_large("a.jpg", &jpeg);
    let mut png = fs::read(fixtures().join("colors.png")).expect("a PNG");
    let at = png.windows(4).position(|w| w == b"IHDR").expect("a header") + 4;
    for i in [2, 6] {
        png[at + i..at + i + 2].copy_from_slice(&size);
    }
    png[at + 13..at + 17].copy_from_slice(&0x414D0DDD_u32.to_be_bytes());
    is_too_large("a.png", &png);
    is_too_large(
        "b.hdr",
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 11000 +X 11000\n",
    );
}

/// The radiance of a lamp may exceed 1, unlike a reflectance, but it is not negative.
#[test]
fn images_give_any_radiance_that_is_not_negative() {
    let folder = TempDir::new().expect("a temporary folder");
    let with_value = |value: f32| -> Result<SceneDescription, LoadError> {
        let pixel = |x: usize, _: usize| {
            if x == 0 {
                (0.5, 0.5, 0.5)
            } else {
                (value, 0.0, 1.0)
            }
        };
        let lamp = folder.path().join("lamp.exr");
        exr::prelude::write_rgb_file(lamp, 2, 1, pixel).expect("a writable file");
        let scene = folder.path().join("scene.xml");
        let text = r#"<scene version="3.0.0"><sensor type="perspective"/>
            <shape type="rectangle"><emitter type="area"><texture type="bitmap" name="radiance">
            <string name="filename" value="lamp.exr"/></texture></emitter></shape></scene>"#;
        fs::write(&scene, text).expect("a writable file");
        load(&scene, &[]).map(|loaded| loaded.description)
    };
    let scene = with_value(40.0).expect("a scene");
    let Some(Radiance::Texture(radiance)) = scene.shapes[0].emission else {
        panic!("{:?}", scene.shapes[0].emission);
    };
    assert_eq!(scene.textures[radiance as usize].max().x, 40.0);
    match with_value(-0.25) {
        Ok(_) => panic!("negative radiance loads"),
        Err(error) => {
            let text = error.to_string();
            let says = |phrase| text.contains(phrase);
            assert!(
                says("0 or above") && says("-0.25") && says("scene.xml:3"),
                "{text}"
            );
        }
    }
}
