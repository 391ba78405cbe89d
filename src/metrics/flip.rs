//! FLIP, the perceived difference of two images when a viewer flips between them (Andersson et al. 2020,
//! "FLIP: a difference evaluator for alternating images"), for high dynamic range (Andersson, Nilsson,
//! Shirley and Akenine-Moeller 2021, "Visualizing errors in rendered high dynamic range images").
//!
//! Both images are tone mapped at exposures from dark to bright and compared by FLIP. The error of a pixel
//! is the largest over all exposures. Images are quantized to 8 bits per channel: a difference below one
//! step at every exposure is lost.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8};
use rayon::prelude::*;

use crate::film::Image;
use crate::film::png::encode_srgb;
use crate::math::{Rgb, luminance};

/// The perceived difference of two images.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// Mean of `errors`, the summary that the authors recommend.
    pub mean: f64,
    /// Per pixel, from 0 (none) to 1.
    pub errors: Vec<f32>,
    /// Pixels per degree of the visual angle of the assumed observer. 67 corresponds to a screen of 3840
    /// pixels, 0.7 m wide, 0.7 m away.
    pub pixels_per_degree: f32,
    /// The darkest and the brightest exposure, in stops.
    pub exposures: [f64; 2],
    /// Number of exposures, including both; 1 if they are equal.
    pub count: usize,
}

/// Coefficients k_0 to k_5 of the ACES tone mapper (k_0 x^2 + k_1 x + k_2) / (k_3 x^2 + k_4 x + k_5)
/// as in the paper: Narkowicz's fit (2016, "ACES filmic tone mapping curve") for 0.6 x.
const ACES: [f64; 6] = [
    0.6 * 0.6 * 2.51,
    0.6 * 0.03,
    0.0,
    0.6 * 0.6 * 2.43,
    0.6 * 0.59,
    0.14,
];

/// The tone-mapped value that the reference's largest luminance has at the first exposure, and its
/// median at the last (section 3 of the paper).
const ANCHOR: f64 = 0.85;

/// Compares `image` with `reference`, which have the same size and finite values. `go_on` receives the
/// fraction of the work done; if it returns false, the comparison is cancelled and returns `None`.
pub fn flip(
    image: &Image,
    reference: &Image,
    go_on: &(dyn Fn(f64) -> bool + Sync),
) -> Option<Flip> {
    let exposures = exposures(reference);
    let [start, stop] = exposures;
    // About one stop between two exposures, as in the authors' program.
    let count = match stop - start {
        range if range > 0.0 => (range.ceil() as usize).max(2),
        _ => 1,
    };
    let mut errors = vec![0.0; reference.pixels.len()];
    // Rounds of as many exposures as threads limit the number of maps in memory.
    let threads = rayon::current_num_threads();
    for first in (0..count).step_by(threads) {
        if !go_on(first as f64 / count as f64) {
            return None;
        }
        let round = first..count.min(first + threads);
        let maps = round.into_par_iter().map(|i| {
            let exposure = start + (stop - start) * i as f64 / (count - 1).max(1) as f64;
            let [reference, image] = [reference, image].map(|image| tone_mapped(image, exposure));
            nv_flip::flip(reference, image, DEFAULT_PIXELS_PER_DEGREE).to_vec()
        });
        for map in maps.collect::<Vec<_>>() {
            for (error, value) in errors.iter_mut().zip(map) {
                *error = value.max(*error);
            }
        }
    }
    Some(Flip {
        mean: errors.iter().map(|&e| f64::from(e)).sum::<f64>() / errors.len() as f64,
        errors,
        pixels_per_degree: DEFAULT_PIXELS_PER_DEGREE,
        exposures,
        count,
    })
}

/// The exposures at which the largest and the median luminance of `reference` are mapped to
/// [`ANCHOR`], in stops. If more than half of the pixels are black, the median is that of the others, as no
/// exposure maps 0 to the anchor. Exposure 0 alone if all are black.
fn exposures(reference: &Image) -> [f64; 2] {
    let luminances = reference.pixels.iter().map(|&p| luminance(Rgb::from(p)));
    let mut luminances: Vec<f64> = luminances.map(f64::from).collect();
    luminances.sort_by(f64::total_cmp);
    let median = |sorted: &[f64]| (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]) / 2.0;
    let lit = &luminances[luminances.partition_point(|&y| y <= 0.0)..];
    let Some(&largest) = lit.last() else {
        return [0.0; 2];
    };
    let middle = match median(&luminances) {
        y if y > 0.0 => y,
        _ => median(lit),
    };
    let anchor = inverse_tone_map(ANCHOR);
    [largest, middle].map(|y| (anchor / y).log2())
}

/// The image at an exposure, tone mapped, with 8 bits per channel. Negative values count as 0.
fn tone_mapped(image: &Image, exposure: f64) -> FlipImageRgb8 {
    let scale = exposure.exp2();
    let values = image.pixels.iter().flatten();
    let bytes: Vec<u8> = values
        .map(|&v| encode_srgb(tone_map(scale * f64::from(v).max(0.0)) as f32))
        .collect();
    FlipImageRgb8::with_data(image.width as u32, image.height as u32, &bytes)
}

fn tone_map(x: f64) -> f64 {
    let [k0, k1, k2, k3, k4, k5] = ACES;
    (((k0 * x + k1) * x + k2) / ((k3 * x + k4) * x + k5)).clamp(0.0, 1.0)
}

/// The positive root of (k_0 - t k_3) x^2 + (k_1 - t k_4) x + (k_2 - t k_5) = 0.
fn inverse_tone_map(t: f64) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|i| ACES[i] - t * ACES[i + 3]);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(value: impl Fn(usize, usize) -> [f32; 3]) -> Image {
        let (width, height) = (32, 24);
        let pixels = (0..width * height).map(|i| value(i % width, i / width));
        Image {
            width,
            height,
            pixels: pixels.collect(),
        }
    }

    fn ramp(scale: f32) -> Image {
        image(|x, y| [scale * (1 + x) as f32, scale * (1 + y) as f32, scale])
    }

    fn mean(image: &Image, reference: &Image) -> f64 {
        flip(image, reference, &|_| true).unwrap().mean
    }

    #[test]
    fn only_equal_images_have_no_error() {
        let reference = ramp(0.1);
        assert_eq!(mean(&reference, &reference), 0.0);
        assert_eq!(mean(&image(|_, _| [0.0; 3]), &image(|_, _| [0.0; 3])), 0.0);
        let [near, far] = [0.11, 0.2].map(|scale| mean(&ramp(scale), &reference));
        assert!(0.0 < near && near < far && far < 1.0, "{near} {far}");
    }

    /// Results of the authors' program (PyPI flip-evaluator 1.7, evaluate(reference, test, "HDR")), which
    /// compares in floating point, not in 8 bits. Quantization matters more on such smooth ramps than on
    /// renders, where both agree to 0.3%.
    #[test]
    fn errors_are_those_of_the_authors() {
        let reference = ramp(0.1);
        for (scale, expected) in [(0.11, 0.126_328), (0.2, 0.515_518)] {
            let flip = flip(&ramp(scale), &reference, &|_| true).unwrap();
            assert!(
                (flip.mean / expected - 1.0).abs() < 0.05,
                "{scale}: {}",
                flip.mean
            );
            let [start, stop] = flip.exposures;
            // The authors' median of an even number of pixels is the upper middle one.
            assert!((start + 0.182_15).abs() < 1e-3 && (stop - 0.756_85).abs() < 3e-3);
            assert_eq!(flip.count, 2);
        }
    }

    /// Full green against full blue is the pair that normalises FLIP's colour differences (Andersson et al.
    /// 2020, section 4.1): its error is 1 without any edge.
    #[test]
    fn green_and_blue_have_the_largest_error() {
        let flat = |rgb: [u8; 3]| FlipImageRgb8::with_data(16, 16, &rgb.repeat(256));
        let map = nv_flip::flip(flat([0, 255, 0]), flat([0, 0, 255]), 67.0).to_vec();
        assert!(map.iter().all(|&e| (e - 1.0).abs() < 1e-3), "{}", map[100]);
    }

    /// The exposures depend on the reference alone: if all light is scaled, they shift, and errors do not
    /// change.
    #[test]
    fn the_scale_of_light_does_not_matter() {
        let errors = |scale: f32| flip(&ramp(0.12 * scale), &ramp(0.1 * scale), &|_| true).unwrap();
        let (one, many) = (errors(1.0), errors(1024.0));
        for (a, b) in one.exposures.iter().zip(many.exposures) {
            assert!((a - b - 10.0).abs() < 1e-6, "{a} {b}");
        }
        assert_eq!(one.count, many.count);
        assert!((one.mean - many.mean).abs() < 1e-3 * one.mean);
    }

    /// Differences in the highlights alone and in the shadows alone are detected.
    #[test]
    fn differences_in_highlights_and_shadows_are_detected() {
        let lamp =
            |bright: f32, dark: f32| image(move |x, _| [if x < 4 { bright } else { dark }; 3]);
        let reference = lamp(1000.0, 0.01);
        assert!(mean(&lamp(500.0, 0.01), &reference) > 0.01);
        assert!(mean(&lamp(1000.0, 0.02), &reference) > 0.1);
    }

    #[test]
    fn exposures_put_the_largest_and_the_median_luminance_at_the_anchor() {
        assert!((tone_map(inverse_tone_map(ANCHOR)) - ANCHOR).abs() < 1e-12);
        let reference = image(|x, y| {
            if x == 0 && y == 0 {
                [64.0; 3]
            } else {
                [2.0; 3]
            }
        });
        let [start, stop] = exposures(&reference);
        assert!((tone_map(64.0 * start.exp2()) - ANCHOR).abs() < 1e-6);
        assert!((tone_map(2.0 * stop.exp2()) - ANCHOR).abs() < 1e-6);
        assert_eq!(flip(&reference, &reference, &|_| true).unwrap().count, 5);
        // If most pixels are black, the median is that of the others.
        let dark = image(|x, _| if x < 8 { [2.0; 3] } else { [0.0; 3] });
        assert!((exposures(&dark)[1] - stop).abs() < 1e-6);
        assert_eq!(flip(&dark, &dark, &|_| false), None);
    }
}
