//! The film compared with integrals of its filters, and its files with their contents.

use std::ffi::OsString;
use std::io::{Error, Write};
use std::path::Path;

use metrolight::film::{
    AttributeValue, Film, FilmSampler, Filter, Image, Splat, SplatLog, check_writable,
    replace_file, write_exr, write_png,
};
use metrolight::math::Rgb;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

const WIDTH: u32 = 7;
const HEIGHT: u32 = 5;

const FILTERS: [Filter; 5] = [
    Filter::Box,
    Filter::Tent { radius: 1.0 },
    Filter::Tent { radius: 2.3 },
    Filter::Gaussian { stddev: 0.5 },
    // Wider than the film: all pixels are at the border.
    Filter::Gaussian { stddev: 1.5 },
];

/// A picture with a different gradient in each channel, at a film position in the unit square.
fn picture([x, y]: [f64; 2]) -> [f64; 3] {
    [1.0 + x, 2.0 * y, 3.0 - x - y]
}

/// Mean position along one side, weighted by the filter of pixel `j` within the film, by numerical
/// integration.
fn filtered_position(filter: Filter, j: u32, size: u32) -> f64 {
    let n = 140_000;
    let (mut sum, mut weights) = (0.0, 0.0);
    for i in 0..n {
        let x = (f64::from(i) + 0.5) / f64::from(n);
        let weight = filter.evaluate(x * f64::from(size) - f64::from(j) - 0.5);
        sum += weight * x;
        weights += weight;
    }
    sum / weights
}

fn assert_filtered_picture(filter: Filter, image: &Image, tolerance: f64) {
    let means = |size| (0..size).map(move |j| filtered_position(filter, j, size));
    let columns: Vec<f64> = means(WIDTH).collect();
    let rows: Vec<f64> = means(HEIGHT).collect();
    for (pixel, value) in image.pixels.iter().enumerate() {
        let expected = picture([columns[pixel % columns.len()], rows[pixel / columns.len()]]);
        for c in 0..3 {
            assert!(
                (f64::from(value[c]) - expected[c]).abs() < tolerance,
                "{filter:?}, pixel {pixel}: {value:?}, not {expected:?}"
            );
        }
    }
}

/// The mean of a pixel's samples is the integral of the picture times the pixel's filter, also at the
/// border. The picture is a sum of functions of x and of y, so evenly spaced numbers on a diagonal
/// replace a grid, without noise.
#[test]
fn samples_of_a_pixel_average_to_the_filtered_picture() {
    let n = 10_000;
    for filter in FILTERS {
        let sampler = FilmSampler::new(WIDTH, HEIGHT, filter);
        let mut film = Film::new(WIDTH, HEIGHT, filter);
        for pixel in 0..(WIDTH * HEIGHT) as usize {
            let mut sum = [0.0; 3];
            for i in 0..n {
                let u = [i, n - 1 - i].map(|k| (k as f32 + 0.5) / n as f32);
                let position = sampler.pixel_position(pixel, u);
                assert!(position.iter().all(|p| (0.0..1.0).contains(p)));
                let value = picture(position.map(f64::from));
                (0..3).for_each(|c| sum[c] += value[c]);
            }
            // In two parts, as a driver does in two passes.
            film.add_samples(pixel, sum.map(|s| 0.25 * s), n / 4);
            film.add_samples(pixel, sum.map(|s| 0.75 * s), n - n / 4);
        }
        assert_filtered_picture(filter, &film.resolve(0.0), 1e-5);
    }
}

/// Splats over the whole film, each a sample of the integral over the unit square, add up to the same
/// image. Their positions are a grid of midpoints; its side is a multiple of both sides of the film, so
/// that box filters contain whole cells.
#[test]
fn splats_add_up_to_the_filtered_picture() {
    let n = 7 * 5 * 20;
    for filter in FILTERS {
        let mut film = Film::new(WIDTH, HEIGHT, filter);
        let mut log = SplatLog::new();
        for i in 0..n * n {
            let position = [i % n, i / n].map(|k| (k as f32 + 0.5) / n as f32);
            let value = picture(position.map(f64::from)).map(|v| v as f32);
            log.push(Splat {
                position,
                value: Rgb::from_array(value),
            });
        }
        film.apply(&[&log]);
        let image = film.resolve(1.0 / f64::from(n * n));
        assert_filtered_picture(filter, &image, 1e-4);
    }
}

#[test]
fn splats_have_their_own_scale_and_pixels_without_samples_are_black() {
    let mut film = Film::new(2, 1, Filter::Box);
    film.add_samples(1, [6.0, 9.0, 12.0], 3);
    film.splat(&Splat {
        position: [0.75, 0.5],
        value: Rgb::new(1.0, 2.0, 4.0),
    });
    // A pixel is half of the unit film: its mean is twice its share of the integral.
    let image = film.resolve(0.5);
    assert_eq!((image.width, image.height), (2, 1));
    assert_eq!(image.pixels, [[0.0; 3], [2.0 + 1.0, 3.0 + 2.0, 4.0 + 4.0]]);
}

fn random_logs(seed: u64) -> Vec<SplatLog> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut random_log = || {
        let mut log = SplatLog::new();
        for _ in 0..rng.random_range(0..2000) {
            // The range of magnitudes makes the sum depend on the order.
            let magnitude = 10.0_f32.powf(rng.random_range(-6.0..6.0));
            log.push(Splat {
                position: [rng.random(), rng.random()],
                value: Rgb::splat(magnitude * rng.random::<f32>()),
            });
        }
        log
    };
    (0..9).map(|_| random_log()).collect()
}

#[test]
fn splats_are_added_in_order_for_any_number_of_threads() {
    let logs = random_logs(3);
    let refs: Vec<&SplatLog> = logs.iter().collect();
    for filter in [Filter::Box, Filter::Gaussian { stddev: 0.8 }] {
        // More rows than one band, and not a multiple of it.
        let (width, height) = (13, 75);
        let mut one_by_one = Film::new(width, height, filter);
        for splat in logs.iter().flat_map(SplatLog::splats) {
            one_by_one.splat(splat);
        }
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let mut film = Film::new(width, height, filter);
            pool.expect("a pool").install(|| {
                film.apply(&refs[..4]);
                film.apply(&refs[4..]);
            });
            assert!(
                film == one_by_one,
                "{filter:?}: sums differ with {threads} threads"
            );
        }
    }
}

/// Three rows of two pixels with distinct values.
fn small_image() -> Image {
    Image {
        width: 2,
        height: 3,
        pixels: (0..6)
            .map(|i| [i as f32, i as f32 / 8.0, 1.0e-3 * i as f32])
            .collect(),
    }
}

#[test]
fn exr_keeps_pixels_and_attributes() {
    use exr::meta::attribute::{AttributeValue as Value, Text};
    use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("image.exr");
    let attributes = [
        ("scene".into(), AttributeValue::Text("sölid.xml".into())),
        ("seed".into(), AttributeValue::Number(7.5)),
    ];
    write_exr(&path, &small_image(), &[], &attributes).expect("written");

    let layer = read_first_flat_layer_from_file(&path)
        .expect("a readable file")
        .layer_data;
    assert_eq!((layer.size.x(), layer.size.y()), (2, 3));
    // Channels are stored in alphabetical order.
    for (channel, (name, c)) in layer
        .channel_data
        .list
        .iter()
        .zip([("B", 2), ("G", 1), ("R", 0)])
    {
        let expected: Vec<f32> = small_image().pixels.iter().map(|p| p[c]).collect();
        assert_eq!(channel.name, Text::from(name));
        assert_eq!(channel.sample_data, FlatSamples::F32(expected), "{name}");
    }
    let utf8 = Text::from_slice_unchecked("sölid.xml".as_bytes());
    for (name, value) in [("scene", Value::Text(utf8)), ("seed", Value::F64(7.5))] {
        let found = layer.attributes.other.get(&Text::from(name));
        assert_eq!(found, Some(&value));
    }
}

#[test]
fn png_keeps_orientation() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("image.png");
    write_png(&path, &small_image()).expect("written");
    let image = image::open(&path).expect("a readable file").into_rgb8();
    assert_eq!(image.dimensions(), (2, 3));
    // Green is i/8 in rows from the top; sRGB by
    // [round(255 * (1.055 * (i / 8)**(1 / 2.4) - 0.055)) for i in range(1, 6)]
    let green: Vec<u8> = image.pixels().map(|p| p.0[1]).collect();
    assert_eq!(green, [0, 99, 137, 165, 188, 207]);
}

fn names(directory: &Path) -> Vec<OsString> {
    let entries = std::fs::read_dir(directory).expect("a directory");
    entries.map(|e| e.expect("an entry").file_name()).collect()
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("file");
    replace_file(&path, |writer| writer.write_all(b"old")).expect("written");
    let error = replace_file(&path, |writer| {
        writer.write_all(b"half of the new")?;
        Err(Error::other("the disk is full"))
    })
    .expect_err("fails");
    let message = error.to_string();
    assert!(message.contains(&path.display().to_string()), "{message}");
    assert!(message.contains("the disk is full"), "{message}");
    assert_eq!(std::fs::read(&path).expect("readable"), b"old");
    assert_eq!(names(directory.path()), ["file"]);
}

#[test]
fn writability_is_known_before_writing() {
    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("file");
    check_writable([(file.as_path(), 100)]).expect("writable");
    assert!(names(directory.path()).is_empty());

    std::fs::write(&file, "").expect("written");
    check_writable([(file.as_path(), 100)]).expect("may be replaced");
    for (path, reason) in [
        (directory.path().join("absent/image.exr"), "no directory"),
        (file.join("image.exr"), "no directory"),
        (directory.path().into(), "is a directory"),
    ] {
        let message = check_writable([(path.as_path(), 100)])
            .expect_err("not writable")
            .to_string();
        assert!(message.contains(reason), "{message}");
        assert!(message.contains(&path.display().to_string()), "{message}");
    }
}

/// Images have the permissions of other new files.
#[cfg(unix)]
#[test]
fn files_have_default_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let directory = tempfile::tempdir().expect("a directory");
    let mode = |name: &str| {
        let metadata = std::fs::metadata(directory.path().join(name)).expect("exists");
        metadata.permissions().mode()
    };
    std::fs::write(directory.path().join("usual"), "").expect("written");
    replace_file(&directory.path().join("ours"), |_| Ok(())).expect("written");
    assert_eq!(mode("ours"), mode("usual"));
}

/// Layers and attributes are read as they were written.
#[test]
fn layers_and_attributes_are_read_back() {
    use metrolight::film::{Decode, read_annotated};
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("a.exr");
    let pixels = |first: f32| -> Vec<[f32; 3]> {
        (0..6)
            .map(|i| [0.0, 0.25, 0.5].map(|c| first + i as f32 + c))
            .collect()
    };
    let image = Image {
        width: 3,
        height: 2,
        pixels: pixels(1.0),
    };
    let errors = pixels(10.0);
    let attributes = [
        ("metrolight.seed".to_owned(), AttributeValue::Number(7.0)),
        (
            "metrolight.integrator".to_owned(),
            AttributeValue::Text("path".into()),
        ),
    ];
    write_exr(&path, &image, &[("standard_error", &errors)], &attributes).expect("written");
    let read = read_annotated(&path, Decode::Raw).expect("an image");
    assert_eq!(read.image, image);
    assert_eq!(read.layers.len(), 1);
    assert_eq!(read.layers["standard_error"], errors);
    assert_eq!(read.number("metrolight.seed"), Some(7.0));
    assert_eq!(read.text("metrolight.integrator"), Some("path"));
    assert_eq!(
        (read.number("metrolight.integrator"), read.text("none")),
        (None, None)
    );
}
