//! Mitsuba's `serialized` meshes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| metrolight_fuzz::mesh("serialized", bytes));
