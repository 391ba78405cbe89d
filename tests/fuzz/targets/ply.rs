//! PLY meshes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| metrolight_fuzz::mesh("ply", bytes));
