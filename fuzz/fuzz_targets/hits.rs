#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| raywright_fuzz::hits::check(data));
