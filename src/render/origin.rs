//! Where a sample came from, so that it can be made again.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

/// A sample of a render, found again from the scene, the integrator and the seed alone, whatever
/// the budget was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A sample of Monte Carlo.
    Pixel {
        /// Which of the samples of the pixel, from 0 on.
        pass: u64,
        /// Index of the pixel, in rows from the top.
        pixel: u64,
    },
    /// A sample of the bootstrap.
    Bootstrap {
        /// Its index.
        sample: u64,
    },
    /// What a Markov chain proposed.
    Mutation {
        /// Index of the chain.
        chain: u64,
        /// Index of the bootstrap sample that it started from.
        start: u64,
        /// The step, from 1 on.
        step: u64,
    },
}

impl fmt::Display for Origin {
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

impl FromStr for Origin {
    type Err = String;

    /// Reads what [`fmt::Display`] writes.
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
            Some(&[("chain", chain), ("start", start), ("step", step)]) if step > 0 => {
                Ok(Self::Mutation { chain, start, step })
            }
            _ => Err(
                "needed is what a render printed: pass=N,pixel=N or bootstrap=N or \
                 chain=N,start=N,step=N"
                    .into(),
            ),
        }
    }
}

impl Serialize for Origin {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Contributions that were NaN, infinite or negative: how many, and where the first ones came from.
#[derive(Clone, Debug, Default)]
pub struct NonFinite {
    /// All of them.
    pub count: u64,
    /// The first ones.
    pub origins: Vec<Origin>,
}

impl NonFinite {
    /// Most origins that are kept: enough to find the fault.
    const MOST: usize = 64;

    /// Counts `count` of them, all from `origin`.
    pub fn add(&mut self, count: u64, origin: Origin) {
        self.count += count;
        if self.origins.len() < Self::MOST {
            self.origins.push(origin);
        }
    }

    /// Adds others, which are known by number and by some of their origins.
    pub fn extend(&mut self, count: u64, origins: impl Iterator<Item = Origin>) {
        self.count += count;
        let room = Self::MOST - self.origins.len();
        self.origins.extend(origins.take(room));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origins_are_read_as_they_are_written() {
        for origin in [
            Origin::Pixel { pass: 3, pixel: 99 },
            Origin::Bootstrap { sample: 7 },
            Origin::Mutation {
                chain: 1,
                start: 0,
                step: u64::MAX,
            },
        ] {
            assert_eq!(origin.to_string().parse(), Ok(origin));
        }
        for text in [
            "",
            "pass=1",
            "pass=1,pixel=-2",
            "chain=1,start=1,step=0",
            "bootstrap=1,x=2",
        ] {
            assert!(text.parse::<Origin>().is_err(), "{text}");
        }
    }
}
