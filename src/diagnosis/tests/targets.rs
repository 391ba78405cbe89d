//! Targets whose distribution is known.

use crate::diagnosis::{
    COORDINATES, ChainTarget, Features, IndependentEstimate, Observation, TILES, tile_at,
};
use crate::markov::{Mutations, Perturbation, Target, bootstrap};
use crate::path::dimensions;
use crate::sampling::{Dimension, Sampler, Stream};

/// Number of independent samples with which chains are compared.
const INDEPENDENT: u64 = 1 << 17;

/// A density I on the hypercube.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Analytic {
    /// One dimension, with the maximum at one end of the interval: I = 1/10 + 4 x^3.
    Ramp,
    /// Two dimensions: a Gaussian ridge along the diagonal, of standard deviation 0.03, plus 0.05. For
    /// x < 1/2 a third coordinate z, in another stream, is read, and I has the factor 2z.
    Ridge,
    /// Two dimensions: two separate Gaussian peaks of standard deviation 0.04.
    Peaks,
    /// Two dimensions, nearly constant: I = 1 + sin(2 pi x) sin(2 pi y) / 2. So b = 1 has a small
    /// standard error.
    Sine,
    /// A coordinate chooses one of three techniques, whose densities over (x, y) differ; the number
    /// of techniques is a factor of I (Hachisuka et al. 2014, section 4).
    Multiplexed,
}

impl Analytic {
    pub const ALL: [Self; 5] = [
        Self::Ramp,
        Self::Ridge,
        Self::Peaks,
        Self::Sine,
        Self::Multiplexed,
    ];

    /// Its integral.
    pub fn b(self) -> f64 {
        let tau = std::f64::consts::TAU;
        match self {
            Self::Ramp => 1.1,
            // The truncated tails of the ridge and of the peaks are negligible.
            Self::Ridge => 0.05 + 0.03 * tau.sqrt(),
            Self::Peaks => 2.0 * tau * 0.04 * 0.04,
            Self::Sine | Self::Multiplexed => 1.0,
        }
    }
}

/// exp(-d^2 / (2 sigma^2)).
fn bell(d_squared: f64, sigma: f64) -> f64 {
    (-0.5 * d_squared / (sigma * sigma)).exp()
}

/// The densities of the techniques of [`Analytic::Multiplexed`]; their sum has the mean 1.
fn techniques(x: f64, y: f64) -> [f64; 3] {
    [0.5, 0.6 * x, 0.6 * y * y]
}

impl Target for Analytic {
    type Contribution = Observation;

    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut Observation) -> f64 {
        let tau = std::f64::consts::TAU;
        let [x, y] = match self {
            Self::Ramp => {
                let [x] = sampler.get(dimensions::FILM);
                [f64::from(x), 0.5]
            }
            _ => sampler.get(dimensions::FILM).map(f64::from),
        };
        let mut coordinates = [f64::NAN; COORDINATES];
        (coordinates[0], coordinates[1]) = (x, y);
        let mut technique = 0;
        let density = match self {
            Self::Ramp => 0.1 + 4.0 * x * x * x,
            Self::Ridge => {
                let d = (x - y).rem_euclid(1.0);
                let mut density = 0.05 + bell(d.min(1.0 - d).powi(2), 0.03);
                if x < 0.5 {
                    let [z] = sampler.get(Dimension::new(Stream::Light, 2));
                    coordinates[2] = f64::from(z);
                    technique = 1;
                    density *= 2.0 * f64::from(z);
                }
                density
            }
            Self::Peaks => {
                let peak = |a: f64, b: f64| bell((x - a).powi(2) + (y - b).powi(2), 0.04);
                peak(0.3, 0.3) + peak(0.7, 0.6)
            }
            Self::Sine => 1.0 + 0.5 * (tau * x).sin() * (tau * y).sin(),
            Self::Multiplexed => {
                let [choice] = sampler.get(dimensions::TECHNIQUE);
                technique = ((choice * 3.0) as usize).min(2);
                techniques(x, y)[technique] * 3.0
            }
        };
        let tile = tile_at([x, y], [1.0; 2]);
        out.features = Features {
            log_density: f64::NAN,
            tile,
            technique,
            length: technique as f64,
            coordinates,
        };
        out.light.clear();
        out.add(tile, density);
        density
    }
}

/// Chains of an analytic target.
#[derive(Clone, Copy, Debug)]
pub struct AnalyticChains {
    pub target: Analytic,
    /// p_large.
    pub large_step_probability: f32,
}

impl ChainTarget for AnalyticChains {
    type Target<'t> = Analytic;

    fn target(&self) -> Analytic {
        self.target
    }

    /// On the ramp, steps are long enough to cross the end of the interval often.
    fn mutations(&self) -> Mutations {
        let small_step = match self.target {
            Analytic::Ramp => Perturbation::new(1.0 / 64.0, 0.25),
            _ => Perturbation::default(),
        };
        Mutations::kelemen(self.large_step_probability, small_step)
    }

    /// For a multiplexed target, sums all techniques at every point.
    fn independent(&self, seed: u64) -> IndependentEstimate {
        let mut target = self.target;
        let mut out = Observation::default();
        let mut tiles = vec![0.0; TILES * TILES];
        for i in 0..INDEPENDENT {
            let mut density = target.evaluate(&mut bootstrap::sample(seed, i), &mut out);
            if target == Analytic::Multiplexed {
                let [x, y, ..] = out.features.coordinates;
                density = techniques(x, y).iter().sum();
            }
            tiles[out.features.tile] += density / INDEPENDENT as f64;
        }
        IndependentEstimate {
            samples: INDEPENDENT,
            tiles,
        }
    }
}
