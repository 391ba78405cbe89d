//! Error measures of an image against a reference: relMSE and others.

use serde::Serialize;

/// Fraction of the mean (for squares: of the squared mean) in the denominator that keeps the relative error
/// of dark pixels finite.
const FLOOR: f64 = 0.01;

/// The worst of this many pixels is left out of [`ImageError::relative_mse_trimmed`].
const PIXELS_PER_OUTLIER: usize = 1000;

/// Error measures of an image against a reference. Means are over all pixels and channels, x and r are
/// the values of the image and the reference, and m is the mean of r.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ImageError {
    /// Mean squared error: the mean of (x - r)^2, in the square of the reference's unit.
    pub mse: f64,
    /// Its root, in the reference's unit.
    pub rmse: f64,
    /// See [`relative_mse`].
    pub relative_mse: f64,
    /// The same without the worst 0.1% of the pixels (one of each full thousand), and so without fireflies.
    pub relative_mse_trimmed: f64,
    /// Number of pixels left out of `relative_mse_trimmed`.
    pub trimmed_pixels: usize,
    /// Mean absolute percentage error, as a fraction: the mean of |x - r| / (|r| + 0.01 m).
    pub mape: f64,
    /// Symmetric mean absolute percentage error, as a fraction from 0 to 1: the mean of
    /// |x - r| / (|x| + |r| + 0.01 m) (Vogels et al. 2018, "Denoising with kernel prediction and
    /// asymmetric loss functions", section 4, with their floor 0.01 for an image of mean 1).
    pub smape: f64,
    /// Mean of the image over mean of the reference; `None` if the reference's mean is 0.
    pub mean_ratio: Option<f64>,
}

/// Measures `image` against `reference`, which has the same number of pixels, at least one. All values
/// are finite.
pub fn image_errors(image: &[[f32; 3]], reference: &[[f32; 3]]) -> ImageError {
    let values = || {
        let channels = image.iter().flatten().zip(reference.iter().flatten());
        channels.map(|(&x, &r)| (f64::from(x), f64::from(r)))
    };
    let [mean_image, mean_reference] = [mean(values().map(|v| v.0)), mean(values().map(|v| v.1))];
    let floor = FLOOR * mean_reference.abs();
    let mse = mean(values().map(|(x, r)| (x - r) * (x - r)));
    let mut relative = relative_square_errors(image, reference);
    let relative_mse = mean(relative.iter().copied());
    let kept = relative.len() - relative.len() / PIXELS_PER_OUTLIER;
    if kept < relative.len() {
        relative.select_nth_unstable_by(kept, f64::total_cmp);
    }
    ImageError {
        mse,
        rmse: mse.sqrt(),
        relative_mse,
        trimmed_pixels: relative.len() - kept,
        relative_mse_trimmed: mean(relative[..kept].iter().copied()),
        mape: mean(values().map(|(x, r)| ratio((x - r).abs(), r.abs() + floor))),
        smape: mean(values().map(|(x, r)| ratio((x - r).abs(), x.abs() + r.abs() + floor))),
        mean_ratio: (mean_reference != 0.0).then(|| mean_image / mean_reference),
    }
}

/// Relative mean squared error: the mean over all pixels and channels of
/// (x - r)^2 / (r^2 + 0.01 m^2), with m the mean of the reference. After Rousselle et al. (2011,
/// "Adaptive sampling and reconstruction using greedy error minimization", section 6), whose floor
/// 0.01 is for an image of mean 1; the factor m^2 makes the measure independent of the scale of light.
///
/// `image` and `reference` have the same number of pixels, at least one. 0 if both are black.
pub fn relative_mse(image: &[[f32; 3]], reference: &[[f32; 3]]) -> f64 {
    mean(relative_square_errors(image, reference).into_iter())
}

/// Contribution of each pixel to [`relative_mse`]: the mean over its channels.
pub fn relative_square_errors(image: &[[f32; 3]], reference: &[[f32; 3]]) -> Vec<f64> {
    let floor = floor(reference);
    let channel = |(&x, &r): (&f32, &f32)| {
        let (x, r) = (f64::from(x), f64::from(r));
        ratio((x - r) * (x - r), r * r + floor)
    };
    let pixels = image.iter().zip(reference);
    pixels
        .map(|(x, r)| mean(x.iter().zip(r).map(channel)))
        .collect()
}

/// Expectation of [`relative_mse`] for an unbiased `image` whose pixels have these `standard_errors`, with
/// the image itself in place of the reference.
pub fn expected_relative_mse(image: &[[f32; 3]], standard_errors: &[[f32; 3]]) -> f64 {
    let floor = floor(image);
    mean(image.iter().zip(standard_errors).flat_map(|(x, s)| {
        std::array::from_fn::<f64, 3, _>(|c| {
            let (x, s) = (f64::from(x[c]), f64::from(s[c]));
            ratio(s * s, x * x + floor)
        })
    }))
}

fn floor(reference: &[[f32; 3]]) -> f64 {
    let mean = mean(reference.iter().flatten().map(|&r| f64::from(r)));
    FLOOR * mean * mean
}

/// error / scale with 0/0 = 0, as both are black then.
fn ratio(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0u64), |(sum, count), v| (sum + v, count + 1));
    sum / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_by_hand() {
        // Mean of the reference 1, floor 0.01.
        let reference = [[2.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        let image = [[2.5, 1.0, 0.1], [1.0, 0.0, 1.0]];
        let expected = (0.25 / 4.01 + 0.01 / 0.01 + 1.0 / 1.01) / 6.0;
        assert!((relative_mse(&image, &reference) - expected).abs() < 1e-6);
        let errors = [[0.5, 0.0, 0.1], [0.0, 1.0, 0.0]];
        assert!((expected_relative_mse(&reference, &errors) - expected).abs() < 1e-6);
        assert_eq!(relative_mse(&[[0.0; 3]], &[[0.0; 3]]), 0.0);
    }

    /// Mean of the reference 1, of the image 13/12.
    #[test]
    fn measures_by_hand() {
        let reference = [[2.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        let image = [[3.0, 1.0, 0.5], [1.0, 0.0, 1.0]];
        let errors = image_errors(&image, &reference);
        let relative = [(1.0 / 4.01 + 0.25 / 0.01) / 3.0, (1.0 / 1.01) / 3.0];
        for (name, value, expected) in [
            ("mse", errors.mse, 2.25 / 6.0),
            ("rmse", errors.rmse, 0.612_372_435_7),
            (
                "relMSE",
                errors.relative_mse,
                (relative[0] + relative[1]) / 2.0,
            ),
            (
                "mape",
                errors.mape,
                (1.0 / 2.01 + 0.5 / 0.01 + 1.0 / 1.01) / 6.0,
            ),
            (
                "smape",
                errors.smape,
                (1.0 / 5.01 + 0.5 / 0.51 + 1.0 / 1.01) / 6.0,
            ),
            ("ratio", errors.mean_ratio.unwrap(), 6.5 / 6.0),
        ] {
            assert!(
                (value - expected).abs() < 1e-9,
                "{name}: {value} {expected}"
            );
        }
        // Nothing is trimmed from two pixels.
        assert_eq!(errors.relative_mse_trimmed, errors.relative_mse);
        let black = image_errors(&[[0.0; 3]], &[[0.0; 3]]);
        assert_eq!((black.mse, black.mape, black.smape), (0.0, 0.0, 0.0));
        assert_eq!((black.relative_mse, black.mean_ratio), (0.0, None));
    }

    #[test]
    fn the_worst_pixel_of_a_thousand_is_left_out() {
        let reference = [[1.0; 3]; 2500];
        let mut image = [[1.5; 3]; 2500];
        (image[7], image[2000], image[100]) = ([100.0; 3], [1000.0; 3], [2.5; 3]);
        let errors = image_errors(&image, &reference);
        assert_eq!(errors.trimmed_pixels, 2);
        let expected = (2497.0 * 0.25 + 2.25) / 1.01 / 2498.0;
        assert!((errors.relative_mse_trimmed / expected - 1.0).abs() < 1e-9);
        assert!(errors.relative_mse > 390.0);
    }

    #[test]
    fn the_scale_of_light_does_not_matter() {
        let reference = [[2.0, 1.0, 0.5], [1.0, 4.0, 0.0]];
        let image = [[2.5, 1.0, 0.1], [1.0, 0.0, 0.25]];
        let scaled = |image: &[[f32; 3]; 2]| image.map(|p| p.map(|v| v * 1024.0));
        let [a, b] = [
            relative_mse(&image, &reference),
            relative_mse(&scaled(&image), &scaled(&reference)),
        ];
        assert!((a - b).abs() < 1e-12 * a);
    }
}
