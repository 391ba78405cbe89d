//! The tests of whether chains are in equilibrium.

use super::check::{self, Check};
use super::history::{self, History};
use super::normalisation::{self, Normalisation};
use super::observation::{ChainTarget, Features};
use super::starts::{self, Starts};
use super::{DiagnoseError, DiagnosisBudget, begin, invariance, part, reversibility};
use crate::markov::{Bootstrap, KelemenWeights};
use crate::render::Observer;
use crate::sampling::seeds::{self, Purpose};

/// Chains that started in equilibrium, and the results of the tests.
pub(super) struct Equilibrium {
    pub checks: Vec<Check>,
    pub bootstrap: Bootstrap,
    /// States drawn exactly from the target, for comparison.
    pub reference: Vec<Features>,
    pub starts: Starts,
    pub histories: Vec<History>,
    pub normalisation: Normalisation,
}

/// Runs all tests.
pub(super) fn equilibrium<S: ChainTarget>(
    chain_target: &S,
    budget: &DiagnosisBudget,
    observer: &dyn Observer,
) -> Result<Equilibrium, DiagnoseError> {
    let seed = |part| seeds::part(budget.seed, part);
    let mutations = chain_target.mutations();
    begin(observer, "bootstrap")?;
    let bootstrap = Bootstrap::run(
        seed(part::BOOTSTRAP),
        budget.bootstrap,
        || chain_target.target(),
        |_| (),
        |done| {
            observer.progress(done as f64 / budget.bootstrap.at_most as f64, None);
            observer.interrupted()
        },
    );
    if bootstrap.moments.mean <= 0.0 {
        return Err(DiagnoseError::NoLight(bootstrap.moments.count));
    }

    begin(observer, "starts in equilibrium")?;
    let c = starts::spacing(&bootstrap);
    let limits = (budget.chains, budget.samples);
    let draw = |part| Starts::draw(chain_target, seed(part), c, limits, observer);
    let reference = draw(part::REFERENCE);
    begin(observer, "more starts")?;
    let starts = draw(part::STARTS);
    let reference: Vec<Features> = reference
        .starts
        .iter()
        .map(|start| start.features)
        .collect();

    begin(observer, "chains")?;
    let weights = KelemenWeights {
        b: bootstrap.moments.mean,
        large_step_probability: mutations.large_step_probability(),
    };
    let histories = history::run(chain_target, &starts, seed(part::CHAINS), weights, observer)?;
    begin(observer, "ranks")?;
    let mut checks = reversibility::ranks(chain_target, &starts, seed(part::RANKS));
    begin(observer, "tests")?;
    let mut rng = seeds::generator(seed(part::TESTS), Purpose::Tests, 0);
    checks.extend(invariance::invariance(
        &reference, &histories, budget, &mut rng,
    ));
    checks.extend(reversibility::symmetry(&reference, &histories, &mutations));
    checks.extend(invariance::independence(&histories));
    begin(observer, "independent samples")?;
    let independent = chain_target.independent(seed(part::INDEPENDENT));
    let (normalisation, more) =
        normalisation::normalisation(&bootstrap, &histories, &independent, weights);
    checks.extend(more);
    checks.extend(chain_target.own_checks(seed(part::SPECIFIC)));
    check::correct(&mut checks);
    Ok(Equilibrium {
        checks,
        bootstrap,
        reference,
        starts,
        histories,
        normalisation,
    })
}
