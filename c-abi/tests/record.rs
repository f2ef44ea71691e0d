//! The record's struct against the table of its bytes in docs/link.md.

use fuzzypilot_c::tick::FpRecord;
use std::collections::BTreeMap;
use std::mem::offset_of;

/// Offsets by field, as the page has them.
fn page() -> BTreeMap<String, usize> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/link.md");
    let text = std::fs::read_to_string(path).unwrap();
    let records = text.split("\n## ").find(|part| part.starts_with("Records"));
    let rows = records.unwrap().lines().filter_map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        Some((cells.get(3)?.to_string(), cells.get(1)?.parse().ok()?))
    });
    rows.collect()
}

macro_rules! offsets {
    ($($name:literal $($field:ident).+;)*) => {
        BTreeMap::from([$(($name.to_owned(), offset_of!(FpRecord, $($field).+))),*])
    };
}

#[test]
#[rustfmt::skip]
fn every_field_is_where_the_page_has_it() {
    let mut found = offsets! {
        "tick" tick; "decision" decision; "detail" detail; "flags" flags; "controller" controller;
        "held.x" held_x; "held.y" held_y; "held.radius" held_radius; "held.residual" held_residual;
        "pose.x" pose.x; "pose.y" pose.y; "pose.heading" pose.heading;
        "foot.x" foot_x; "foot.y" foot_y; "cross_track" cross_track; "distance" distance; "tangent" tangent;
        "curvature" curvature; "heading_error" heading_error; "progress" progress; "remaining" remaining;
        "speed_limit" speed_limit; "laps" laps; "obstacles" obstacles; "valid_ranges" valid_ranges;
        "nearest" nearest; "held.echoes" held_echoes; "rules" rule_count; "speed_rules" speed_rule_count;
        "reserved" reserved; "distance_input" distance_input; "angle_input" angle_input;
        "speed_output" speed_output; "deflection_output" deflection_output;
        "desired.linear" desired.linear; "desired.angular" desired.angular;
        "twist.linear" twist.linear; "twist.angular" twist.angular;
        "wheels.left" wheels.left; "wheels.right" wheels.right;
    };
    let rules = [("rule", offset_of!(FpRecord, rule)), ("speed_rule", offset_of!(FpRecord, speed_rule))];
    for (name, at) in rules {
        for i in 0..4 {
            found.insert(format!("{name}{}.row", i + 1), at + 4 * i);
            found.insert(format!("{name}{}.col", i + 1), at + 4 * i + 1);
            found.insert(format!("{name}{}.degree", i + 1), at + 4 * i + 2);
        }
    }
    assert_eq!(found, page());
}
