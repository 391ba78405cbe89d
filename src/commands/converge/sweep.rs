//! One option, several values.

use metrolight::render::{Integrator, Settings};

use crate::commands::values;

/// An option, with the values that it takes in turn. Such options are numbers, and change how a scene
/// is rendered but not the truth.
#[derive(Clone, Debug, PartialEq)]
pub enum Sweep {
    LargeStepProbability(Vec<f32>),
    Chains(Vec<u64>),
    Bootstrap(Vec<u64>),
    Threads(Vec<usize>),
}

/// The value parser of `--sweep`.
pub fn sweep(text: &str) -> Result<Sweep, String> {
    let (name, list) = text.split_once('=').unwrap_or((text, ""));
    Ok(match name {
        "large-step-probability" => Sweep::LargeStepProbability(all(list, values::probability)?),
        "chains" => Sweep::Chains(all(list, values::chains)?),
        "bootstrap" => Sweep::Bootstrap(all(list, values::positive)?),
        "threads" => Sweep::Threads(all(list, values::threads)?),
        _ => {
            return Err(
                "an option and its values are needed: large-step-probability=0.1,0.3, or chains, \
                 bootstrap or threads likewise"
                    .into(),
            );
        }
    })
}

fn all<T>(list: &str, parse: impl Fn(&str) -> Result<T, String>) -> Result<Vec<T>, String> {
    let value = |text| parse(text).map_err(|needed| format!("`{text}`: {needed}"));
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
        }
    }

    /// True if the option changes what the integrator does.
    pub fn means_something_to(&self, integrator: Integrator) -> bool {
        matches!(self, Self::Threads(_)) || integrator.is_metropolis()
    }

    /// `settings` with each of the values, and the value as text.
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
        assert!(!parsed.means_something_to(Integrator::Bdpt));
        assert!(
            sweep("threads=1,2")
                .unwrap()
                .means_something_to(Integrator::Bdpt)
        );
        for text in [
            "",
            "chains",
            "chains=",
            "chains=1,x",
            "chains=0",
            "large-step-probability=2",
            "threads=0",
            "spp=4",
            "bootstrap=-1",
        ] {
            assert!(sweep(text).is_err(), "{text}");
        }
    }
}
