//! Options of the integrators: each applies to some of them only.

use metrolight::markov::Perturbation;
use metrolight::render::{
    Integrator, MAX_PILOT_SAMPLES, Method, MmltSettings, PssmltSettings, Settings, Statistics,
};
use miette::bail;

use super::names::{DirectName, IntegratorName};
use super::values;

/// What a user may set of an integrator.
#[derive(clap::Args)]
pub struct IntegratorArgs {
    #[arg(
        long,
        value_name = "P",
        value_parser = values::probability,
        help = large_step_help()
    )]
    large_step_probability: Option<f32>,

    #[arg(long, value_name = "STEP", value_parser = values::small_step, help = small_step_help())]
    small_step: Option<Perturbation>,

    #[arg(long, value_name = "N", value_parser = values::chains, help = chains_help())]
    pub chains: Option<u64>,

    /// pssmlt: number of bootstrap samples
    /// [default: until the standard error of b is 1%, from 2^17 to 2^22]
    #[arg(long, value_name = "N", value_parser = values::bootstrap)]
    bootstrap: Option<u64>,

    /// mmlt: how direct light is rendered: by independent samples only (separate), or by independent samples
    /// and chains (joint)
    #[arg(long, value_name = "MODE")]
    direct: Option<DirectName>,

    /// mmlt: no importance map: distribute mutations in proportion to luminance, instead of equally over
    /// bright and dark regions
    #[arg(long)]
    no_importance_map: bool,

    /// mmlt: threshold above which the residual of a path's contribution is sampled by chains, relative to
    /// the expected brightness at its pixel [default: the pilot decides]
    #[arg(long, value_name = "T", value_parser = values::threshold)]
    threshold: Option<f32>,

    #[arg(long, value_name = "N", value_parser = values::pilot, help = pilot_help())]
    pilot: Option<u64>,
}

fn pilot_help() -> String {
    format!(
        "mmlt: number of samples of the pilot, at most {MAX_PILOT_SAMPLES} [default: as many as it may have \
         in 3% of the time]"
    )
}

fn large_step_help() -> String {
    let default = PssmltSettings::default().large_step_probability;
    format!("pssmlt: probability of a large step, from 0 to 1 [default: {default}]")
}

fn small_step_help() -> String {
    format!(
        "pssmlt, mmlt: distribution of small steps: log:SHORTEST:LONGEST or gaussian:DEVIATION \
         [default: {}, {}]",
        PssmltSettings::default().small_step,
        MmltSettings::default().small_step
    )
}

fn chains_help() -> String {
    let default = PssmltSettings::default().chains;
    format!("pssmlt: number of Markov chains [default: {default}]")
}

impl IntegratorArgs {
    /// The integrator `name` with these options; `None` for the name if a pilot is to choose, which any
    /// option forbids.
    pub fn integrator(&self, name: Option<IntegratorName>) -> miette::Result<Integrator> {
        self.check(name)?;
        Ok(match name.map(|name| name.0) {
            Some(Method::Path) => Integrator::Path,
            Some(Method::Light) => Integrator::Light,
            Some(Method::Bdpt) => Integrator::Bdpt,
            Some(Method::Pssmlt) => Integrator::Pssmlt(self.pssmlt()),
            // Both integrators that a pilot chooses from have the settings of one.
            Some(Method::Mmlt) | None => Integrator::Mmlt(self.mmlt()),
        })
    }

    /// The integrator of `settings` and its options, for a command line that is printed. Numbers that time has
    /// decided are those of `statistics`.
    pub fn words(settings: &Settings, statistics: &Statistics) -> String {
        let mut words = format!("--integrator {}", settings.method().name());
        let mut add = |option: &str, value: &dyn std::fmt::Display, default: bool| {
            if !default {
                words += &format!(" --{option} {value}");
            }
        };
        match &settings.integrator {
            Integrator::Path | Integrator::Light | Integrator::Bdpt => {}
            Integrator::Pssmlt(own) => {
                let defaults = PssmltSettings::default();
                let p = own.large_step_probability;
                add(
                    "large-step-probability",
                    &p,
                    p == defaults.large_step_probability,
                );
                add(
                    "small-step",
                    &own.small_step,
                    own.small_step == defaults.small_step,
                );
                add("chains", &own.chains, own.chains == defaults.chains);
                if let Some(pssmlt) = &statistics.pssmlt {
                    add("bootstrap", &pssmlt.bootstrap_samples, false);
                }
            }
            Integrator::Mmlt(own) => {
                let defaults = MmltSettings::default();
                add(
                    "small-step",
                    &own.small_step,
                    own.small_step == defaults.small_step,
                );
                add("direct", &DirectName::Joint, own.separate_direct);
                if let Some(threshold) = own.threshold {
                    add("threshold", &threshold, false);
                }
                if let Some(mmlt) = &statistics.mmlt {
                    add("pilot", &mmlt.pilot_samples, false);
                }
                if !own.importance_map {
                    words += " --no-importance-map";
                }
            }
        }
        words
    }

    fn pssmlt(&self) -> PssmltSettings {
        let defaults = PssmltSettings::default();
        PssmltSettings {
            large_step_probability: self
                .large_step_probability
                .unwrap_or(defaults.large_step_probability),
            small_step: self.small_step.unwrap_or(defaults.small_step),
            chains: self.chains.unwrap_or(defaults.chains),
            bootstrap: self.bootstrap,
        }
    }

    fn mmlt(&self) -> MmltSettings {
        let defaults = MmltSettings::default();
        MmltSettings {
            small_step: self.small_step.unwrap_or(defaults.small_step),
            separate_direct: self.direct != Some(DirectName::Joint),
            importance_map: !self.no_importance_map,
            threshold: self.threshold,
            pilot: self.pilot,
            ..defaults
        }
    }

    /// Checks that options of some integrators only are given with one of these.
    fn check(&self, name: Option<IntegratorName>) -> miette::Result<()> {
        let (pssmlt, mmlt) = (Method::Pssmlt, Method::Mmlt);
        let large_step = self.large_step_probability.is_some();
        let options = [
            ("--large-step-probability", large_step, &[pssmlt][..]),
            ("--small-step", self.small_step.is_some(), &[pssmlt, mmlt]),
            ("--chains", self.chains.is_some(), &[pssmlt]),
            ("--bootstrap", self.bootstrap.is_some(), &[pssmlt]),
            ("--direct", self.direct.is_some(), &[mmlt]),
            ("--no-importance-map", self.no_importance_map, &[mmlt]),
            ("--threshold", self.threshold.is_some(), &[mmlt]),
            ("--pilot", self.pilot.is_some(), &[mmlt]),
        ];
        check_applies(name.map(|name| name.0), &options)
    }
}

/// Checks that given options apply to the integrator. Each has its name, whether it is given, and the
/// integrators that it applies to.
pub fn check_applies(
    method: Option<Method>,
    options: &[(&str, bool, &[Method])],
) -> miette::Result<()> {
    for &(option, given, of) in options {
        let names: Vec<&str> = of.iter().map(|method| method.name()).collect();
        match method.map(|method| (method.name(), of.contains(&method))) {
            Some((name, false)) if given => {
                bail!("{option} applies to {}, not to {name}", names.join(" and "))
            }
            None if given => bail!("{option} needs --integrator {}", names.join(" or ")),
            _ => {}
        }
    }
    Ok(())
}
