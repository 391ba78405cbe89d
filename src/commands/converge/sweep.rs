//! An option of the integrators that takes several values in turn.

use clap::ValueEnum;
use metrolight::convergence::Variant;
use metrolight::markov::Perturbation;
use metrolight::render::{Integrator, Method};

use crate::commands::names::{DirectName, SpecularName};
use crate::commands::values;

/// An option and its values. Such an option changes the variance of an image but not its mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    name: String,
    /// Each as text and parsed.
    values: Vec<(String, Value)>,
}

/// A value of an option.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Value {
    LargeStepProbability(f32),
    Chains(u64),
    Bootstrap(u64),
    Threads(usize),
    SmallStep(Perturbation),
    Threshold(f32),
    Direct(DirectName),
    ImportanceMap(bool),
    Specular(SpecularName),
}

impl Value {
    fn parse(option: &str, text: &str) -> Result<Self, String> {
        match option {
            "large-step-probability" => values::probability(text).map(Self::LargeStepProbability),
            "chains" => values::chains(text).map(Self::Chains),
            "bootstrap" => values::bootstrap(text).map(Self::Bootstrap),
            "threads" => values::threads(text).map(Self::Threads),
            "small-step" => values::small_step(text).map(Self::SmallStep),
            "threshold" => values::threshold(text).map(Self::Threshold),
            "direct" => direct(text).map(Self::Direct),
            "importance-map" => switch(text).map(Self::ImportanceMap),
            "specular" => specular(text).map(Self::Specular),
            _ => Err(
                "expected an option and its values, such as large-step-probability=0.1,0.3; other \
                 options are chains, bootstrap, threads, small-step, threshold, direct, \
                 importance-map and specular"
                    .into(),
            ),
        }
    }

    /// Sets the option in `variant`; false if its integrator does not have it.
    fn set(self, variant: &mut Variant) -> bool {
        let settings = &mut variant.settings;
        match (self, &mut settings.integrator) {
            (Self::Threads(n), _) => settings.threads = Some(n),
            (
                Self::Specular(name),
                Integrator::Path | Integrator::Bdpt | Integrator::Pssmlt(_) | Integrator::Mmlt(_),
            ) => variant.search = name.search(),
            (Self::LargeStepProbability(p), Integrator::Pssmlt(own)) => {
                own.large_step_probability = p;
            }
            (Self::Chains(n), Integrator::Pssmlt(own)) => own.chains = n,
            (Self::Bootstrap(n), Integrator::Pssmlt(own)) => own.bootstrap = Some(n),
            (Self::SmallStep(step), Integrator::Pssmlt(own)) => own.small_step = step,
            (Self::SmallStep(step), Integrator::Mmlt(own)) => own.small_step = step,
            (Self::Threshold(threshold), Integrator::Mmlt(own)) => own.threshold = Some(threshold),
            (Self::Direct(direct), Integrator::Mmlt(own)) => {
                own.separate_direct = direct == DirectName::Separate;
            }
            (Self::ImportanceMap(on), Integrator::Mmlt(own)) => own.importance_map = on,
            _ => return false,
        }
        true
    }
}

fn switch(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err("expected on or off".into()),
    }
}

fn direct(text: &str) -> Result<DirectName, String> {
    DirectName::from_str(text, false).map_err(|_| "expected separate or joint".into())
}

fn specular(text: &str) -> Result<SpecularName, String> {
    SpecularName::from_str(text, false).map_err(|_| "expected auto, on, everywhere or off".into())
}

/// The value parser of `--sweep`.
pub fn sweep(text: &str) -> Result<Sweep, String> {
    let (name, list) = text.split_once('=').unwrap_or((text, ""));
    let value = |text: &str| {
        let value = Value::parse(name, text).map_err(|error| match text {
            "" => error,
            _ => format!("`{text}`: {error}"),
        })?;
        Ok((text.into(), value))
    };
    Ok(Sweep {
        name: name.into(),
        values: list.split(',').map(value).collect::<Result<_, String>>()?,
    })
}

impl Sweep {
    /// The option's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// True if the integrator has the option.
    pub fn applies_to(&self, method: Method) -> bool {
        let mut variant = Variant::new(method);
        let mut values = self.values.iter();
        values.all(|(_, value)| value.set(&mut variant))
    }

    /// `variant` with each value.
    pub fn apply(&self, variant: &Variant) -> Vec<Variant> {
        let with = |(text, value): &(String, Value)| {
            let label = format!("{} {} {text}", variant.label, self.name);
            let mut variant = Variant {
                label,
                ..variant.clone()
            };
            value.set(&mut variant);
            variant
        };
        self.values.iter().map(with).collect()
    }
}

#[cfg(test)]
mod tests {
    use metrolight::scene::ChainSearch;

    use super::*;

    #[test]
    fn values_are_those_of_the_option() {
        let parsed = sweep("large-step-probability=0.05,0.3").unwrap();
        let variants = parsed.apply(&Variant::new(Method::Pssmlt));
        assert_eq!(variants[0].label, "pssmlt large-step-probability 0.05");
        let Integrator::Pssmlt(own) = &variants[1].settings.integrator else {
            panic!("not pssmlt: {variants:?}");
        };
        assert_eq!(own.large_step_probability, 0.3);
        assert!(!parsed.applies_to(Method::Bdpt));
        assert!(sweep("threads=1,2").unwrap().applies_to(Method::Bdpt));
        let steps = sweep("small-step=log:0.001:0.01,gaussian:0.02").unwrap();
        assert!(steps.applies_to(Method::Mmlt));
        assert!(!steps.applies_to(Method::Bdpt));
        let variants = steps.apply(&Variant::new(Method::Mmlt));
        assert_eq!(variants[1].label, "mmlt small-step gaussian:0.02");
        let Integrator::Mmlt(own) = &variants[0].settings.integrator else {
            panic!("not mmlt: {variants:?}");
        };
        assert_eq!(own.small_step, Perturbation::new(0.001, 0.01));
        let direct = sweep("direct=separate,joint").unwrap();
        let variants = direct.apply(&Variant::new(Method::Mmlt));
        assert_eq!(variants[1].label, "mmlt direct joint");
        let Integrator::Mmlt(own) = &variants[1].settings.integrator else {
            panic!("not mmlt: {variants:?}");
        };
        assert!(!own.separate_direct);
        let chains = sweep("specular=auto,off").unwrap();
        assert!(!chains.applies_to(Method::Light));
        let variants = chains.apply(&Variant::new(Method::Bdpt));
        assert_eq!(variants[0].search, None);
        assert_eq!(variants[1].search, Some(ChainSearch::Off));
        for text in [
            "specular=some",
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
