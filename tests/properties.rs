//! Properties that hold for all inputs, tested on random ones: proptest searches for a counterexample and
//! shrinks it. The cases are the same in every run (`.cargo/config.toml` sets the seed); for more or other
//! cases:
//!
//!     PROPTEST_CASES=100000 PROPTEST_RNG_SEED=2 cargo test --release --test properties

#[path = "properties/distributions.rs"]
mod distributions;
#[path = "properties/film.rs"]
mod film;
#[path = "properties/markov.rs"]
mod markov;
#[path = "properties/surfaces.rs"]
mod surfaces;
#[path = "properties/warps.rs"]
mod warps;

use glam::{DVec3, Vec3A};
use proptest::prelude::*;

/// A random number as the generators make them: a multiple of 2^-24 in [0, 1), including both ends.
fn unit() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => 0_u32..1 << 24,
        1 => Just(0),
        1 => Just((1 << 24) - 1),
    ]
    .prop_map(|number| number as f32 / (1 << 24) as f32)
}

/// Unit vectors in all directions, and close to the axes and coordinate planes, where formulas branch or
/// divide by nearly 0.
fn direction() -> impl Strategy<Value = Vec3A> {
    let component = || {
        prop_oneof![
            3 => -1.0..1.0,
            1 => Just(0.0),
            2 => (-40.0..0.0_f64, any::<bool>()).prop_map(|(e, minus)| {
                if minus { -e.exp2() } else { e.exp2() }
            }),
            1 => Just(1.0),
            2 => Just(-1.0),
        ]
    };
    [component(), component(), component()].prop_filter_map("a direction", |v| {
        Some(DVec3::from(v).try_normalize()?.as_vec3a())
    })
}
