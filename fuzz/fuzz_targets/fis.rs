//! The reader of `.fis`.
#![no_main]

use host_sim::fuzzy::files::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| fuzzypilot_fuzz::check(bytes, Format::Fis));
