//! Names that options take, for closed sets of the library.

use clap::ValueEnum;
use clap::builder::PossibleValue;
use metrolight::render::Method;
use metrolight::scene::ChainSearch;

/// The integrator where one is needed and none is named. `render` chooses between it and `bdpt` by a pilot.
pub const DEFAULT: Method = Method::Mmlt;

/// An integrator, each with what it is good for.
#[derive(Clone, Copy, PartialEq)]
pub struct IntegratorName(pub Method);

impl ValueEnum for IntegratorName {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [IntegratorName; 5] = [
            IntegratorName(Method::ALL[0]),
            IntegratorName(Method::ALL[1]),
            IntegratorName(Method::ALL[2]),
            IntegratorName(Method::ALL[3]),
            IntegratorName(Method::ALL[4]),
        ];
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let help = match self.0 {
            Method::Path => "Path tracing: for large emitters and few bounces",
            Method::Light => "Light tracing: for directly visible caustics",
            Method::Bdpt => "Bidirectional path tracing",
            Method::Pssmlt => "Primary sample space Metropolis over bidirectional path tracing",
            Method::Mmlt => {
                "Multiplexed Metropolis for bright paths, bidirectional path tracing for the rest"
            }
        };
        Some(PossibleValue::new(self.0.name()).help(help))
    }
}

impl std::fmt::Display for IntegratorName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0.name())
    }
}

/// Whether light is sought through chains of smooth glass and mirrors.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum SpecularName {
    /// A pilot chooses between on and everywhere
    Auto,
    /// Connect vertices to lights through smooth glass and mirrors, where no other connection exists
    On,
    /// From every vertex: better where much of the image is seen and lit through glass, slower elsewhere
    Everywhere,
    /// Leave such light to paths that hit an emitter by chance
    Off,
}

impl SpecularName {
    /// Where chains are sought; `None` if pilots choose.
    pub fn search(self) -> Option<ChainSearch> {
        match self {
            Self::Auto => None,
            Self::On => Some(ChainSearch::Unconnected),
            Self::Everywhere => Some(ChainSearch::Everywhere),
            Self::Off => Some(ChainSearch::Off),
        }
    }
}

impl std::fmt::Display for SpecularName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::On => "on",
            Self::Everywhere => "everywhere",
            Self::Off => "off",
        })
    }
}

/// How mmlt renders direct light.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum DirectName {
    /// Independent samples only
    Separate,
    /// Independent samples, and chains for bright paths
    Joint,
}

impl std::fmt::Display for DirectName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Separate => "separate",
            Self::Joint => "joint",
        })
    }
}
