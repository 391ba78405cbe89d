//! A chain in equilibrium moves as often from one region to another as back.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::check::{Check, Family};
use super::history::{CHECKPOINTS, History, Transition};
use super::invariance::count_steps;
use super::observation::{ChainTarget, Features, Observation, Quantity, TILES};
use super::starts::{Start, Starts};
use crate::markov::{Chain, Mutations, Target, bootstrap};
use crate::sampling::seeds::{self, Purpose};
use crate::statistics::{bowker, rank_among, rank_uniformity};

/// Cells of equal probability into which log I is sorted.
const DENSITY_CELLS: usize = 8;

/// Bowker's test of symmetry for the first and the last step of all chains, for each kind of mutation,
/// over cells of log I (bounded by quantiles of `fresh` states) and over blocks of tiles.
pub fn symmetry(fresh: &[Features], histories: &[History], mutations: &Mutations) -> Vec<Check> {
    let bounds = density_bounds(fresh);
    let density_cell = |f: &Features| bounds.partition_point(|&bound| bound <= f.log_density);
    let mut checks = Vec::new();
    for (i, step) in [1, CHECKPOINTS[CHECKPOINTS.len() - 1]]
        .into_iter()
        .enumerate()
    {
        for (kind, mutation) in mutations.names().enumerate() {
            let steps = || {
                let all = histories.iter().map(|h| &h.transitions[i]);
                all.filter(move |t| t.kind == kind)
            };
            let mut check = |what: &str, table: &[Vec<u64>]| {
                let name = format!("Bowker, {mutation}s, {what}, step {step}");
                checks.push(Check::new(
                    Family::Reversibility,
                    name,
                    bowker(table).p_value,
                ));
            };
            check("log I", &table(steps(), DENSITY_CELLS, density_cell));
            check("tile", &table(steps(), TILES * TILES / 4, Features::block));
        }
    }
    checks
}

fn density_bounds(fresh: &[Features]) -> Vec<f64> {
    let mut densities: Vec<f64> = fresh.iter().map(|f| f.log_density).collect();
    densities.sort_by(f64::total_cmp);
    let quantile = |i: usize| densities.get(i * densities.len() / DENSITY_CELLS).copied();
    (1..DENSITY_CELLS).filter_map(quantile).collect()
}

fn table<'a>(
    transitions: impl Iterator<Item = &'a Transition>,
    cells: usize,
    cell: impl Fn(&Features) -> usize,
) -> Vec<Vec<u64>> {
    let mut table = vec![vec![0; cells]; cells];
    for transition in transitions {
        table[cell(&transition.before)][cell(&transition.after)] += 1;
    }
    table
}

/// States beside the start among which it is ranked.
const RANKED: usize = 15;

/// Steps between two of them.
const STRIDE: usize = 4;

/// Rank tests after Gandy and Scott (2020, section 3) for a reversible kernel: of 16 states of a chain
/// in equilibrium, the one at a random place is the start, drawn exactly, and those before it are made
/// by running the same kernel backward. Its rank among them is uniform.
pub fn ranks<S: ChainTarget>(chain_target: &S, starts: &Starts, seed: u64) -> Vec<Check> {
    let count = starts.starts.len();
    let generators = seeds::chain_generators(seed, 2 * count);
    let ranked: Vec<[usize; 4]> = starts
        .starts
        .par_iter()
        .zip(generators.par_chunks(2))
        .enumerate()
        .map(|(i, (start, generators))| {
            let mut rng = seeds::generator(seed, Purpose::Tests, i as u64);
            let backward = rng.random_range(0..=RANKED);
            let mut target = chain_target.target();
            let mut others = Vec::with_capacity(RANKED);
            for (generator, states) in generators.iter().zip([backward, RANKED - backward]) {
                let mut chain = Chain::start(
                    &mut target,
                    bootstrap::sample(starts.seed, start.sample),
                    generator.clone(),
                    chain_target.mutations(),
                );
                walk(&mut chain, &mut target, states, &mut others);
            }
            rank(start, &others, &mut rng)
        })
        .collect();
    let check = |(i, quantity): (usize, Quantity)| {
        let of_one: Vec<usize> = ranked.iter().map(|ranks| ranks[i]).collect();
        let reach = count_steps((RANKED * STRIDE) as u64);
        let name = format!("rank of the start's {} within {reach}", quantity.name());
        Check::new(Family::Ranks, name, rank_uniformity(&of_one, RANKED))
    };
    Quantity::ALL.into_iter().enumerate().map(check).collect()
}

fn walk<T: Target<Contribution = Observation>>(
    chain: &mut Chain<Observation>,
    target: &mut T,
    states: usize,
    seen: &mut Vec<Features>,
) {
    for _ in 0..states {
        for _ in 0..STRIDE {
            chain.step(target);
        }
        seen.push(Features::of(chain.current()));
    }
}

fn rank(start: &Start, others: &[Features], rng: &mut Xoshiro256PlusPlus) -> [usize; 4] {
    Quantity::ALL.map(|quantity| {
        let others: Vec<f64> = others.iter().map(|state| quantity.of(state)).collect();
        rank_among(quantity.of(&start.features), &others, rng)
    })
}
