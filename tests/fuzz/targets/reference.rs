//! Images with layers and attributes, as `compare` and `report` read them: a byte that chooses the format, and
//! the file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| metrolight_fuzz::reference(bytes));
