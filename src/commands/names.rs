//! Names that options take, for closed sets of the library.

use clap::ValueEnum;
use metrolight::render::Method;

/// Integrators, each with what it is good for.
#[derive(Clone, Copy, ValueEnum)]
pub enum IntegratorName {
    /// Path tracing: for large emitters and few bounces
    Path,
    /// Light tracing: for directly visible caustics
    Light,
    /// Bidirectional path tracing
    Bdpt,
    /// Primary sample space Metropolis over bidirectional path tracing
    Pssmlt,
    /// Multiplexed Metropolis for bright paths, bidirectional path tracing for the rest
    Mmlt,
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

impl From<Method> for IntegratorName {
    fn from(method: Method) -> Self {
        match method {
            Method::Path => Self::Path,
            Method::Light => Self::Light,
            Method::Bdpt => Self::Bdpt,
            Method::Pssmlt => Self::Pssmlt,
            Method::Mmlt => Self::Mmlt,
        }
    }
}

impl From<IntegratorName> for Method {
    fn from(name: IntegratorName) -> Self {
        match name {
            IntegratorName::Path => Self::Path,
            IntegratorName::Light => Self::Light,
            IntegratorName::Bdpt => Self::Bdpt,
            IntegratorName::Pssmlt => Self::Pssmlt,
            IntegratorName::Mmlt => Self::Mmlt,
        }
    }
}

impl std::fmt::Display for IntegratorName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(Method::from(*self).name())
    }
}
