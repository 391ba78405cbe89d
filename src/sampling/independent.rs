//! Independent uniform sample values from a counter-based generator.

use super::seeds::{self, Purpose, mix};
use super::{Dimension, Sampler};

/// One sample of a render: a point of the hypercube with independent uniform coordinates, identified by
/// seed, purpose and index.
///
/// The generator is counter-based (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3"):
/// dimension d has the value mix(key + d * gamma), the element d of the stream of a SplitMix64 generator
/// with its own key and gamma (Steele et al. 2014, "Fast splittable pseudorandom number generators").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndependentSampler {
    key: u64,
    /// Increment of the counter-based generator; odd.
    gamma: u64,
}

impl IndependentSampler {
    /// Sample `index` of a purpose, under the user's seed.
    #[inline]
    pub fn new(seed: u64, purpose: Purpose, index: u64) -> Self {
        let key = seeds::key(seed, purpose, index);
        Self {
            key,
            gamma: mix(key) | 1,
        }
    }

    #[inline]
    fn value(&self, dimension: Dimension) -> f32 {
        // Streams start 2^40 dimensions apart, far more than any path uses.
        let counter = ((dimension.stream as u64) << 40) + dimension.index as u64 + 1;
        let bits = mix(self.key.wrapping_add(counter.wrapping_mul(self.gamma)));
        // A multiple of 2^-24, as `distribution` assumes.
        (bits >> 40) as f32 * (1.0 / (1u32 << 24) as f32)
    }
}

impl Sampler for IndependentSampler {
    #[inline]
    fn get<const N: usize>(&mut self, first: Dimension) -> [f32; N] {
        let Dimension { stream, index } = first;
        std::array::from_fn(|i| self.value(Dimension::new(stream, index + i)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stream;
    use crate::statistics::chi_square;

    #[test]
    fn a_dimension_has_one_value_in_any_order_of_reads() {
        let mut sampler = IndependentSampler::new(1, Purpose::Pixels, 9);
        let at = |index| Dimension::new(Stream::Light, index);
        let all: [f32; 8] = sampler.get(at(0));
        let [last] = sampler.get(at(7));
        let middle: [f32; 3] = sampler.get(at(2));
        assert_eq!(last, all[7]);
        assert_eq!(middle, all[2..5]);
        assert_eq!(IndependentSampler::new(1, Purpose::Pixels, 9), sampler);
    }

    /// Null hypothesis: pairs of values from different samples, dimensions, streams or seeds are uniform
    /// on the square. 16 x 16 cells, 2^18 pairs of each kind; each p-value is tested at 1e-4.
    #[test]
    fn neighbours_are_independent() {
        let value = |seed, index, stream, dimension| {
            let mut sampler = IndependentSampler::new(seed, Purpose::Pixels, index);
            let [value] = sampler.get::<1>(Dimension::new(stream, dimension));
            value
        };
        type Pair<'a> = &'a dyn Fn(u64) -> [f32; 2];
        let camera = Stream::Camera;
        let kinds: [(&str, Pair); 5] = [
            ("dimensions of one sample", &|i| {
                let (sample, d) = (i >> 6, i as usize & 63);
                [value(0, sample, camera, d), value(0, sample, camera, d + 1)]
            }),
            ("neighbouring samples", &|i| {
                [value(0, i, camera, 5), value(0, i + 1, camera, 5)]
            }),
            ("passes of an image", &|i| {
                [value(0, i, camera, 0), value(0, i + (1 << 16), camera, 0)]
            }),
            ("streams", &|i| {
                [value(0, i, camera, 4), value(0, i, Stream::Light, 4)]
            }),
            ("seeds", &|i| {
                [value(i, 3, camera, 4), value(i + 1, 3, camera, 4)]
            }),
        ];
        for (name, pair) in kinds {
            let mut observed = vec![0; 256];
            for i in 0..1 << 18 {
                let [a, b] = pair(i).map(|x| (x * 16.0) as usize);
                observed[a * 16 + b] += 1;
            }
            let p = chi_square(&observed, &vec![1024.0; 256]);
            assert!(p > 1e-4, "{name}: p = {p}");
        }
    }
}
