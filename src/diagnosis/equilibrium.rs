//! The tests of whether chains are in equilibrium.

use super::check::{self, Check};
use super::history::{self, History};
use super::normalisation::{self, Normalisation};
use super::observation::{Features, Subject};
use super::starts::{self, Starts};
use super::{DiagnoseError, Effort, begin, invariance, part, reversibility};
use crate::markov::{Bootstrap, Weighing};
use crate::render::Observer;
use crate::sampling::seeds::{self, Purpose};

/// Chains that started in equilibrium, and what the tests say.
pub(super) struct Equilibrium {
    pub checks: Vec<Check>,
    pub bootstrap: Bootstrap,
    /// States drawn exactly from the target, for comparison.
    pub fresh: Vec<Features>,
    pub starts: Starts,
    pub histories: Vec<History>,
    pub normalisation: Normalisation,
}

/// Runs all tests.
pub(super) fn equilibrium<S: Subject>(
    subject: &S,
    effort: &Effort,
    observer: &dyn Observer,
) -> Result<Equilibrium, DiagnoseError> {
    let seed = |part| seeds::part(effort.seed, part);
    let p_large = effort.large_step_probability;
    begin(observer, "bootstrap")?;
    let bootstrap = Bootstrap::run(
        seed(part::BOOTSTRAP),
        effort.bootstrap,
        || subject.target(),
        |_| (),
        |done| {
            observer.progress(done as f64 / effort.bootstrap.at_most as f64, None);
            observer.interrupted()
        },
    );
    if bootstrap.moments.mean <= 0.0 {
        return Err(DiagnoseError::NoLight(bootstrap.moments.count));
    }

    begin(observer, "starts in equilibrium")?;
    let c = starts::spacing(&bootstrap);
    let limits = (effort.chains, effort.samples);
    let draw = |part| Starts::draw(subject, seed(part), c, limits, observer);
    let fresh = draw(part::FRESH);
    begin(observer, "more starts")?;
    let starts = draw(part::STARTS);
    let fresh: Vec<Features> = fresh.starts.iter().map(|start| start.features).collect();

    begin(observer, "chains")?;
    let weighing = Weighing {
        b: bootstrap.moments.mean,
        large_step_probability: f64::from(p_large),
    };
    let histories = history::run(subject, &starts, seed(part::CHAINS), weighing, observer)?;
    begin(observer, "ranks")?;
    let mut checks = reversibility::ranks(subject, &starts, seed(part::RANKS), p_large);
    begin(observer, "tests")?;
    let mut rng = seeds::generator(seed(part::TESTS), Purpose::Tests, 0);
    checks.extend(invariance::invariance(&fresh, &histories, effort, &mut rng));
    checks.extend(reversibility::symmetry(&fresh, &histories));
    checks.extend(invariance::independence(&histories));
    begin(observer, "plain sampling")?;
    let plain = subject.plain(seed(part::PLAIN));
    let (normalisation, more) =
        normalisation::normalisation(&bootstrap, &histories, &plain, weighing);
    checks.extend(more);
    check::correct(&mut checks);
    Ok(Equilibrium {
        checks,
        bootstrap,
        fresh,
        starts,
        histories,
        normalisation,
    })
}
