//! The reader of `.fis`.
#![no_main]

use fuzzypilot_fuzz::fuzzy::files::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| fuzzypilot_fuzz::check(bytes, Format::Fis));
