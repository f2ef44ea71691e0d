//! Settings as the Rust module that the library's presets read.

use super::knobs::{KNOBS, Kind, Knob, Tuned};
use std::fmt::Write;

/// The module's text: a function that puts every number that can move into settings, and the tables.
pub fn rust(tuned: &Tuned, command: &str, what: &str) -> String {
    let mut text = format!(
        "//! {what}. Written by\n//! `{command}`\n\n\
         use crate::navigate::NavigatorParams;\nuse crate::tables::clutter::Peaks;\n\
         use crate::tables::coarse::{{CoarseTwin, Deflection, SpeedShare}};\n\n\
         /// Puts the tuned numbers into settings.\n#[rustfmt::skip]\n\
         pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {{\n"
    );
    for knob in &KNOBS {
        let value = number(knob, tuned);
        let value = match knob.kind() {
            Kind::Metres => format!("m!(\"{value}\")"),
            Kind::Number => format!("n!(\"{value}\")"),
            Kind::Seconds => format!("s!(\"{value}\")"),
            Kind::Count => value,
            Kind::Peak => continue,
        };
        // Writing to a string does not fail.
        let _ = writeln!(text, "    params.{} = {value};", knob.name);
    }
    text += "    params.steer.tables = &TABLES;\n    params\n}\n\n\
             /// Peaks of its rule tables.\n#[rustfmt::skip]\npub const PEAKS: Peaks = Peaks {\n";
    for (field, format, peaks) in [
        ("deflection", "Deflection", tuned.deflections),
        ("speed", "SpeedShare", tuned.speeds),
    ] {
        let peaks = peaks.map(|peak| format!("{format}::lit(\"{}\")", (1e4 * peak).round() / 1e4));
        let _ = writeln!(text, "    {field}: [{}],", peaks.join(", "));
    }
    text + "};\n\nstatic TABLES: CoarseTwin = PEAKS.tables();\n"
}

fn number(knob: &Knob, tuned: &Tuned) -> String {
    let text = format!("{:.*}", knob.digits, knob.get(tuned));
    if knob.digits == 0 {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
