//! Scene files: XML, substitution, references, every plugin and parameter; and the rendering of
//! whatever loads.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| metrolight_fuzz::scene(bytes));
