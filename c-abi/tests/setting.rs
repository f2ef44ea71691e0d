//! The settings' names for C against the link's table of settings.

use fuzzypilot::link::settings::{MOUNTS, SETTINGS};
use std::collections::BTreeMap;

/// The header's ids by name.
fn header() -> BTreeMap<String, u16> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/include/fuzzypilot.h");
    let text = std::fs::read_to_string(path).unwrap();
    let pairs = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("FP_SETTING_"));
    let pairs = pairs.filter_map(|line| line.trim_end_matches(',').split_once(" = "));
    pairs
        .map(|(name, id)| (name.to_owned(), id.parse().unwrap()))
        .collect()
}

#[test]
fn every_setting_has_its_name_in_c() {
    let mut wanted = BTreeMap::from([("RING_MOUNTS".to_owned(), MOUNTS)]);
    for setting in SETTINGS {
        let name = setting.name.replace("[0]", ".smallest");
        let name = name.replace("[1]", ".largest").replace('.', "_");
        wanted.insert(name.to_uppercase(), setting.id);
    }
    assert_eq!(header(), wanted);
}
