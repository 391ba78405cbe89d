//! How far an image is from the truth.

/// Part of the mean's square that keeps the relative error of dark pixels finite.
const FLOOR: f64 = 0.01;

/// Relative mean squared error: the mean over all pixels and channels of
/// (x - r)^2 / (r^2 + 0.01 m^2), with m the mean of the reference. After Rousselle et al. (2011,
/// "Adaptive sampling and reconstruction using greedy error minimization", section 6), whose floor
/// 0.01 stands for an image of mean 1: with m the measure does not change when all light is scaled.
///
/// `image` and `reference` have the same number of pixels, at least one. 0 if both are black.
pub fn relative_mse(image: &[[f32; 3]], reference: &[[f32; 3]]) -> f64 {
    let floor = floor(reference);
    mean(image.iter().zip(reference).flat_map(|(x, r)| {
        std::array::from_fn::<f64, 3, _>(|c| {
            let (x, r) = (f64::from(x[c]), f64::from(r[c]));
            ratio((x - r) * (x - r), r * r + floor)
        })
    }))
}

/// What [`relative_mse`] is expected to be for an unbiased `image` whose pixels have these
/// `standard_errors`, the image itself standing for the reference.
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

/// 0/0 = 0: where both are black there is no error.
fn ratio(squared: f64, scale: f64) -> f64 {
    if squared == 0.0 { 0.0 } else { squared / scale }
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
