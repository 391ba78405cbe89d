//! Images whose format their contents tell: PNG, JPEG and Radiance HDR.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| metrolight_fuzz::image("png", bytes));
