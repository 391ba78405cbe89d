//! Reconstruction filters and the positions of samples.

use metrolight::film::{Film, FilmSampler, Filter, FilterSampler, Splat};
use metrolight::math::Rgb;
use proptest::prelude::*;

use super::unit;

fn filter() -> impl Strategy<Value = Filter> {
    prop_oneof![
        Just(Filter::Box),
        (0.3f32..3.0).prop_map(|radius| Filter::Tent { radius }),
        (0.1f32..1.5).prop_map(|stddev| Filter::Gaussian { stddev }),
    ]
}

proptest! {
    #[test]
    fn filters_are_even_positive_and_bounded(filter in filter(), x in -8.0..8.0f64) {
        let value = filter.evaluate(x);
        prop_assert!((0.0..=1.0).contains(&value), "{value}");
        prop_assert!(x.abs() < filter.radius() || value == 0.0);
        prop_assert!(x.abs() == 0.5 || value == filter.evaluate(-x));
        // Decreasing from the centre on.
        prop_assert!(filter.evaluate(0.9 * x) >= value);
    }

    /// The integral over any interval equals that by the midpoint rule.
    #[test]
    fn integrals_are_those_of_the_values(filter in filter(), a in -4.0..4.0f64, length in 0.0..4.0f64) {
        const PARTS: i32 = 4000;
        let part = length / f64::from(PARTS);
        let middles = (0..PARTS).map(|i| a + (f64::from(i) + 0.5) * part);
        let sum: f64 = middles.map(|x| filter.evaluate(x)).sum();
        // A box has jumps, which may lie within a part.
        let tolerance = if filter == Filter::Box { 2.0 * part } else { 1e-5 };
        prop_assert!((filter.integral(a, a + length) - sum * part).abs() < tolerance);
    }

    /// The cumulative distribution function at a sample equals the random number.
    #[test]
    fn offsets_are_sampled_by_inversion(filter in filter(), u in 0.0..1.0f64) {
        let r = filter.radius();
        let x = FilterSampler::new(filter).sample(u);
        prop_assert!(x.abs() <= r);
        let cdf = filter.integral(-r, x) / filter.integral(-r, r);
        prop_assert!((cdf - u).abs() < 1e-7, "{cdf} {u}");
    }

    /// A sample of a pixel lies on the film and in the support of the pixel's filter.
    #[test]
    fn samples_lie_under_the_filter(
        filter in filter(),
        size in [1_u32..20, 1_u32..20],
        pixel in any::<prop::sample::Index>(),
        u in [unit(), unit()],
    ) {
        let [width, height] = size;
        let pixel = pixel.index((width * height) as usize);
        let position = FilmSampler::new(width, height, filter).pixel_position(pixel, u);
        let center = [pixel as u32 % width, pixel as u32 / width];
        for i in 0..2 {
            prop_assert!((0.0..1.0).contains(&position[i]));
            let offset = f64::from(position[i]) * f64::from(size[i]) - f64::from(center[i]) - 0.5;
            prop_assert!(offset.abs() <= filter.radius() + 1e-5, "{offset}");
        }
    }
}

/// For expensive properties: a sixteenth of the usual number of cases.
fn fewer_cases() -> ProptestConfig {
    let config = ProptestConfig::default();
    ProptestConfig {
        cases: config.cases.div_ceil(16),
        ..config
    }
}

proptest! {
    #![proptest_config(fewer_cases())]

    /// Constant light gives a constant image, up to the border: the filters of all pixels are normalised
    /// over the film. Splats on a fine grid represent constant light.
    #[test]
    fn constant_light_gives_a_constant_image(filter in filter(), width in 1_u32..5, height in 1_u32..5) {
        const FINE: u32 = 32;
        let mut film = Film::new(width, height, filter);
        let [columns, rows] = [width * FINE, height * FINE];
        for i in 0..columns * rows {
            let position = [
                ((i % columns) as f32 + 0.5) / columns as f32,
                ((i / columns) as f32 + 0.5) / rows as f32,
            ];
            let value = Rgb::new(1.0, 2.0, 0.5);
            film.splat(&Splat { position, value });
        }
        let image = film.resolve(1.0 / f64::from(columns * rows));
        for pixel in &image.pixels {
            for (found, expected) in pixel.iter().zip([1.0, 2.0, 0.5]) {
                prop_assert!((found / expected - 1.0).abs() < 0.01, "{pixel:?}");
            }
        }
    }
}
