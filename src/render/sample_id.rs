//! Identifiers of samples, by which any sample can be replayed.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

/// Identifies a sample of a render. With the scene, the integrator and the seed it can be replayed, for any
/// budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleId {
    /// An independent sample of a pixel.
    Pixel {
        /// Index of the sample within the pixel, from 0 on.
        pass: u64,
        /// Index of the pixel, in rows from the top.
        pixel: u64,
    },
    /// A sample of the bootstrap.
    Bootstrap {
        /// Its index.
        sample: u64,
    },
    /// A proposal of a Markov chain.
    Mutation {
        /// Index of the chain.
        chain: u64,
        /// Index of the bootstrap sample at which it started.
        start: u64,
        /// The step of the chain, from 1 on.
        step: u64,
    },
}

impl fmt::Display for SampleId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pixel { pass, pixel } => write!(f, "pass={pass},pixel={pixel}"),
            Self::Bootstrap { sample } => write!(f, "bootstrap={sample}"),
            Self::Mutation { chain, start, step } => {
                write!(f, "chain={chain},start={start},step={step}")
            }
        }
    }
}

impl SampleId {
    /// Greatest step of a chain that can be parsed: all steps before it are repeated, which takes hours for this
    /// many.
    pub const MAX_STEP: u64 = 1 << 32;
}

impl FromStr for SampleId {
    type Err = String;

    /// Parses what [`fmt::Display`] writes.
    fn from_str(text: &str) -> Result<Self, String> {
        let fields: Option<Vec<(&str, u64)>> = text
            .split(',')
            .map(|field| {
                let (name, value) = field.split_once('=')?;
                Some((name, value.parse().ok()?))
            })
            .collect();
        match fields.as_deref() {
            Some(&[("pass", pass), ("pixel", pixel)]) => Ok(Self::Pixel { pass, pixel }),
            Some(&[("bootstrap", sample)]) => Ok(Self::Bootstrap { sample }),
            Some(&[("chain", _), ("start", _), ("step", step)]) if step > Self::MAX_STEP => Err(
                format!("a chain is repeated for at most {} steps", Self::MAX_STEP),
            ),
            Some(&[("chain", chain), ("start", start), ("step", step)]) if step > 0 => {
                Ok(Self::Mutation { chain, start, step })
            }
            _ => Err(
                "expected a sample as printed by a render: pass=N,pixel=N or bootstrap=N or \
                 chain=N,start=N,step=N"
                    .into(),
            ),
        }
    }
}

impl Serialize for SampleId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Contributions that were NaN, infinite or negative: their number, and the samples of the first ones.
#[derive(Clone, Debug, Default)]
pub struct NonFinite {
    /// Number of such contributions.
    pub count: u64,
    /// The samples of the first ones.
    pub samples: Vec<SampleId>,
}

impl NonFinite {
    /// Maximum number of samples that are stored for replay.
    const MAX: usize = 64;

    /// Adds `count` contributions, all of one sample.
    pub fn add(&mut self, count: u64, sample: SampleId) {
        self.count += count;
        if self.samples.len() < Self::MAX {
            self.samples.push(sample);
        }
    }

    /// Adds `count` contributions, of which some samples are known.
    pub fn extend(&mut self, count: u64, samples: impl Iterator<Item = SampleId>) {
        self.count += count;
        let remaining = Self::MAX - self.samples.len();
        self.samples.extend(samples.take(remaining));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_parsed_as_written() {
        for id in [
            SampleId::Pixel { pass: 3, pixel: 99 },
            SampleId::Bootstrap { sample: 7 },
            SampleId::Mutation {
                chain: 1,
                start: 0,
                step: SampleId::MAX_STEP,
            },
        ] {
            assert_eq!(id.to_string().parse(), Ok(id));
        }
        for text in [
            "",
            "pass=1",
            "pass=1,pixel=-2",
            "chain=1,start=1,step=0",
            "chain=1,start=1,step=4294967297",
            "bootstrap=1,x=2",
        ] {
            assert!(text.parse::<SampleId>().is_err(), "{text}");
        }
    }
}
