//! An option of the integrators that takes several values in turn.

use std::fmt;

use clap::ValueEnum;
use metrolight::markov::SmallStep;
use metrolight::render::{Integrator, Settings};

use crate::commands::names::DirectName;
use crate::commands::values;

/// An option and its values. Such an option changes the variance of an image but not its mean.
#[derive(Clone, Debug, PartialEq)]
pub enum Sweep {
    LargeStepProbability(Vec<f32>),
    Chains(Vec<u64>),
    Bootstrap(Vec<u64>),
    Threads(Vec<usize>),
    SmallStep(Vec<SmallStep>),
    Threshold(Vec<f32>),
    Direct(Vec<DirectName>),
    ImportanceMap(Vec<Switch>),
}

/// The value of a switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Switch {
    On,
    Off,
}

impl fmt::Display for Switch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::On => "on",
            Self::Off => "off",
        })
    }
}

fn switch(text: &str) -> Result<Switch, String> {
    match text {
        "on" => Ok(Switch::On),
        "off" => Ok(Switch::Off),
        _ => Err("expected on or off".into()),
    }
}

fn direct(text: &str) -> Result<DirectName, String> {
    DirectName::from_str(text, false).map_err(|_| "expected separate or joint".into())
}

/// The value parser of `--sweep`.
pub fn sweep(text: &str) -> Result<Sweep, String> {
    let (name, list) = text.split_once('=').unwrap_or((text, ""));
    Ok(match name {
        "large-step-probability" => Sweep::LargeStepProbability(all(list, values::probability)?),
        "chains" => Sweep::Chains(all(list, values::chains)?),
        "bootstrap" => Sweep::Bootstrap(all(list, values::positive)?),
        "threads" => Sweep::Threads(all(list, values::threads)?),
        "small-step" => Sweep::SmallStep(all(list, values::small_step)?),
        "threshold" => Sweep::Threshold(all(list, values::threshold)?),
        "direct" => Sweep::Direct(all(list, direct)?),
        "importance-map" => Sweep::ImportanceMap(all(list, switch)?),
        _ => {
            return Err(
                "expected an option and its values, such as large-step-probability=0.1,0.3; other \
                 options are chains, bootstrap, threads, small-step, threshold, direct and \
                 importance-map"
                    .into(),
            );
        }
    })
}

fn all<T>(list: &str, parse: impl Fn(&str) -> Result<T, String>) -> Result<Vec<T>, String> {
    let value = |text| parse(text).map_err(|error| format!("`{text}`: {error}"));
    list.split(',').map(value).collect()
}

impl Sweep {
    /// The option's name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::LargeStepProbability(_) => "large-step-probability",
            Self::Chains(_) => "chains",
            Self::Bootstrap(_) => "bootstrap",
            Self::Threads(_) => "threads",
            Self::SmallStep(_) => "small-step",
            Self::Threshold(_) => "threshold",
            Self::Direct(_) => "direct",
            Self::ImportanceMap(_) => "importance-map",
        }
    }

    /// True if the integrator has the option.
    pub fn applies_to(&self, integrator: Integrator) -> bool {
        match self {
            Self::Threads(_) => true,
            Self::LargeStepProbability(_) | Self::Chains(_) | Self::Bootstrap(_) => {
                integrator.is_metropolis()
            }
            Self::SmallStep(_) => integrator.is_metropolis() || integrator == Integrator::Mmlt,
            Self::Threshold(_) | Self::Direct(_) | Self::ImportanceMap(_) => {
                integrator == Integrator::Mmlt
            }
        }
    }

    /// Each value as text, and `settings` with it.
    pub fn apply(&self, settings: &Settings) -> Vec<(String, Settings)> {
        match self {
            Self::LargeStepProbability(values) => with_each(settings, values, |settings, &p| {
                settings.large_step_probability = p;
            }),
            Self::Chains(values) => with_each(settings, values, |settings, &n| settings.chains = n),
            Self::Bootstrap(values) => with_each(settings, values, |settings, &n| {
                settings.bootstrap = Some(n);
            }),
            Self::Threads(values) => with_each(settings, values, |settings, &n| {
                settings.threads = Some(n);
            }),
            Self::SmallStep(values) => with_each(settings, values, |settings, &step| {
                settings.small_step = step;
            }),
            Self::Threshold(values) => with_each(settings, values, |settings, &threshold| {
                settings.division.threshold = Some(threshold);
            }),
            Self::Direct(values) => with_each(settings, values, |settings, &direct| {
                settings.division.separate_direct = direct == DirectName::Separate;
            }),
            Self::ImportanceMap(values) => with_each(settings, values, |settings, &map| {
                settings.division.importance = map == Switch::On;
            }),
        }
    }
}

fn with_each<T: ToString>(
    settings: &Settings,
    values: &[T],
    set: impl Fn(&mut Settings, &T),
) -> Vec<(String, Settings)> {
    let with = |value: &T| {
        let mut settings = settings.clone();
        set(&mut settings, value);
        (value.to_string(), settings)
    };
    values.iter().map(with).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_the_option() {
        let parsed = sweep("large-step-probability=0.05,0.3").unwrap();
        let settings = parsed.apply(&Settings::default());
        assert_eq!(settings[0].0, "0.05");
        assert_eq!(settings[1].1.large_step_probability, 0.3);
        assert!(!parsed.applies_to(Integrator::Bdpt));
        assert!(sweep("threads=1,2").unwrap().applies_to(Integrator::Bdpt));
        let steps = sweep("small-step=log:0.001:0.01,gaussian:0.02").unwrap();
        assert!(steps.applies_to(Integrator::Mmlt));
        assert!(!steps.applies_to(Integrator::Bdpt));
        let settings = steps.apply(&Settings::new(Integrator::Mmlt));
        assert_eq!(settings[1].0, "gaussian:0.02");
        assert_eq!(settings[0].1.small_step, SmallStep::new(0.001, 0.01));
        let direct = sweep("direct=separate,joint").unwrap();
        let settings = direct.apply(&Settings::new(Integrator::Mmlt));
        assert_eq!(settings[1].0, "joint");
        assert!(!settings[1].1.division.separate_direct);
        for text in [
            "",
            "chains",
            "chains=",
            "chains=1,x",
            "chains=0",
            "large-step-probability=2",
            "threads=0",
            "spp=4",
            "small-step=log:1:2",
            "small-step=gaussian",
            "threshold=-1",
            "direct=both",
            "importance-map=maybe",
            "bootstrap=-1",
        ] {
            assert!(sweep(text).is_err(), "{text}");
        }
    }
}
