//! A diagnosis as text and tables.

use metrolight::diagnosis::{Check, Diagnosis, Family, Quality, TILES};

use crate::commands::numbers::{digits, quantity};

/// Largest R-hat of chains that have mixed (Vehtari et al. 2021, section 4).
const MAX_R_HAT: f64 = 1.01;

/// With fewer independent starts the tests have little power.
const MIN_STARTS: usize = 500;

/// Smallest share of the steps in a tile whose R-hat is reported.
const MIN_SHARE: f64 = 1e-3;

const FAMILIES: [(Family, &str); 5] = [
    (Family::Invariance, "invariance"),
    (Family::Reversibility, "reversibility"),
    (Family::Ranks, "ranks"),
    (Family::Independence, "independence"),
    (Family::Normalisation, "normalisation"),
];

/// The results of the tests and of mixing, in a few lines.
pub fn verdict(diagnosis: &Diagnosis, alpha: f64) -> String {
    let all = diagnosis.checks.len();
    let rejections = diagnosis.rejections(alpha);
    let stationary = match rejections.first() {
        None => format!(
            "stationary: none of {all} tests rejects at {}",
            level(alpha)
        ),
        Some(worst) => format!(
            "NOT stationary: {} of {all} tests reject at {}; {}, p = {}",
            rejections.len(),
            level(alpha),
            worst.name,
            digits(worst.p_value)
        ),
    };
    let mut lines = vec![stationary, mixing(&diagnosis.quality)];
    if diagnosis.clusters < MIN_STARTS {
        lines.push(format!(
            "few independent starts: {} among {} samples; the tests cannot detect small errors",
            diagnosis.clusters,
            quantity(diagnosis.samples as f64)
        ));
    }
    lines.join("\n")
}

/// The quantity or tile with the largest R-hat.
fn mixing(quality: &Quality) -> String {
    let quantities = quality
        .quantities
        .iter()
        .map(|q| (q.r_hat, q.name.to_string()));
    let tiles = quality.tiles.iter().enumerate();
    let tiles = tiles.filter(|(_, tile)| tile.share >= MIN_SHARE);
    let tiles = tiles.map(|(i, tile)| {
        let [row, column] = [i / TILES + 1, i % TILES + 1];
        (
            tile.r_hat,
            format!("the tile in row {row}, column {column} of {TILES}"),
        )
    });
    let known = quantities.chain(tiles).filter(|(r_hat, _)| !r_hat.is_nan());
    match known.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((r_hat, place)) if r_hat > MAX_R_HAT => {
            format!("chains mix slowly: R-hat {r_hat:.3} in {place}")
        }
        Some((r_hat, place)) => format!("chains mix well: R-hat at most {r_hat:.3}, in {place}"),
        None => "mixing is not known: too few different states".into(),
    }
}

/// A significance level: `1e-3`.
fn level(alpha: f64) -> String {
    format!("{alpha:e}")
}

/// Tables of all results.
pub fn tables(diagnosis: &Diagnosis, alpha: f64) -> String {
    let mut tables = vec![
        tests(diagnosis, alpha),
        normalisation(diagnosis),
        quality(&diagnosis.quality),
    ];
    if !diagnosis.start_up.is_empty() {
        tables.push(start_up(diagnosis));
    }
    tables.join("\n\n")
}

fn tests(diagnosis: &Diagnosis, alpha: f64) -> String {
    let mut lines = vec![
        format!(
            "{} chains from {} independent starts; smallest p-value of each kind of test",
            diagnosis.chains, diagnosis.clusters
        ),
        format!(
            "  {:14} {:>5}  {:>9}  {:>9}  which",
            "", "tests", "p", "corrected"
        ),
    ];
    for (family, name) in FAMILIES {
        let of_family: Vec<&Check> = diagnosis
            .checks
            .iter()
            .filter(|check| check.family == family)
            .collect();
        let least = of_family
            .iter()
            .min_by(|a, b| a.p_value.total_cmp(&b.p_value));
        if let Some(least) = least {
            lines.push(format!(
                "  {name:14} {:5}  {:>9}  {:>9}  {}",
                of_family.len(),
                digits(least.p_value),
                digits(least.adjusted),
                least.name
            ));
        }
    }
    let rejections = diagnosis.rejections(alpha);
    if !rejections.is_empty() {
        lines.push("tests that reject:".into());
    }
    lines.extend(rejections.iter().map(|check| {
        let [p, adjusted] = [check.p_value, check.adjusted].map(digits);
        format!("  {p:>9}  {adjusted:>9}  {}", check.name)
    }));
    lines.join("\n")
}

fn normalisation(diagnosis: &Diagnosis) -> String {
    let mut lines = vec!["b".to_string()];
    lines.extend(diagnosis.normalisation.estimates.iter().map(|estimate| {
        let percent = 100.0 * estimate.standard_error / estimate.value;
        format!(
            "  {:19} {:.5e}  +- {percent:.2}%",
            estimate.name, estimate.value
        )
    }));
    lines.join("\n")
}

fn quality(quality: &Quality) -> String {
    let mut lines = vec![
        format!(
            "{} chains of {} steps from {} starts",
            quality.chains, quality.steps, quality.starts
        ),
        format!(
            "  {:14} {:>7} {:>7}  {:>8} {:>8} {:>8}  {:>6}  {:>7} {:>7}",
            "", "R-hat", "nested", "bulk ESS", "tail ESS", "ESS/s", "steps", "Geweke", "H.-W."
        ),
    ];
    lines.extend(quality.quantities.iter().map(|q| {
        if q.r_hat.is_nan() {
            return format!("  {:14} not known: too few different values", q.name);
        }
        format!(
            "  {:14} {:7.3} {:7.3}  {:>8} {:>8} {:>8}  {:>6}  {:6.0}% {:6.0}%",
            q.name,
            q.r_hat,
            q.nested_r_hat,
            quantity(q.bulk_ess),
            quantity(q.tail_ess),
            quantity(q.ess_per_second),
            digits(q.autocorrelation_time),
            100.0 * q.geweke_rejects,
            100.0 * q.heidelberger_welch_passes,
        )
    }));
    lines.push(
        "  (steps: autocorrelation time, the steps that count as one independent sample; Geweke: \
         chains rejected at 5%; H.-W.: chains that pass the test of Heidelberger and Welch)"
            .into(),
    );
    for kind in &quality.mutations {
        lines.push(format!(
            "  {}s: {} of {} accepted ({:.1}%)",
            kind.name,
            quantity(kind.accepted as f64),
            quantity(kind.proposed as f64),
            100.0 * kind.acceptance_rate
        ));
    }
    let starts = quality
        .distinct_starts
        .map_or(String::new(), |[distinct, starts]| {
            format!(
                "; the {starts} chains of a render start from {distinct} distinct bootstrap samples"
            )
        });
    lines.push(format!(
        "  longest run of rejections {}{starts}",
        quality.longest_rejection_run
    ));
    lines.join("\n")
}

fn start_up(diagnosis: &Diagnosis) -> String {
    let mut lines = vec![
        "start-up bias of log I, in standard deviations, by number of bootstrap samples per chain"
            .to_string(),
    ];
    lines.extend(diagnosis.start_up.iter().map(|bias| {
        let after: Vec<String> = bias
            .after
            .iter()
            .map(|(steps, bias, error)| format!("{bias:+.3} +- {error:.3} after {steps}"))
            .collect();
        format!("  {:5}  {}", bias.samples_per_chain, after.join(", "))
    }));
    lines.join("\n")
}
