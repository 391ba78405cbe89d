//! Parameters that are left out of account: those of integrators and samplers, which are the user's choice,
//! and those that research forks of Mitsuba added for their methods.

use std::collections::BTreeMap;

use super::error::Warning;
use super::xml::{Object, Property};

/// How the names of parameters of research forks begin: specular manifold sampling marks casters, receivers
/// and emitters of caustics, and describes glints; path guiding by mixture models names the files of its models.
const OF_FORKS: [&str; 3] = ["caustic_", "glint_", "sdmm_"];

/// True for a parameter that a research fork of Mitsuba added.
pub fn is_of_a_fork(name: &str) -> bool {
    OF_FORKS.iter().any(|prefix| name.starts_with(prefix))
}

/// The names of ignored parameters by their owners, and how often each is given.
#[derive(Default)]
pub struct Ignored(BTreeMap<String, BTreeMap<String, usize>>);

impl Ignored {
    /// Adds a parameter of `owner`.
    pub fn add(&mut self, owner: &Object, parameter: &Property) {
        let names = self.0.entry(owner.title()).or_default();
        *names.entry(parameter.name.clone()).or_default() += 1;
    }

    /// One warning of all of them, if there are any.
    pub fn warning(&self) -> Option<Warning> {
        let of_owner = |(owner, names): (&String, &BTreeMap<String, usize>)| {
            let names = names.iter().map(|(name, count)| match count {
                1 => format!("`{name}`"),
                _ => format!("`{name}` ({count} times)"),
            });
            format!("{owner}: {}", names.collect::<Vec<_>>().join(", "))
        };
        let count: usize = self.0.values().flat_map(BTreeMap::values).sum();
        let owners: Vec<String> = self.0.iter().map(of_owner).collect();
        let parameters = if count == 1 {
            "parameter"
        } else {
            "parameters"
        };
        (count > 0).then(|| Warning {
            place: None,
            text: format!("{count} {parameters} ignored: {}", owners.join("; ")),
        })
    }
}
