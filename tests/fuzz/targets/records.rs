//! The JSON files of other commands that `report` reads.
#![no_main]

#[allow(dead_code)] // Only the parser is of interest.
#[path = "../../../src/commands/report/records.rs"]
mod records;

use records::{Comparison, Convergence, Diagnosis, Strategies};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    drop(serde_json::from_slice::<Comparison>(bytes));
    drop(serde_json::from_slice::<Convergence>(bytes));
    drop(serde_json::from_slice::<Diagnosis>(bytes));
    drop(serde_json::from_slice::<Strategies>(bytes));
});
