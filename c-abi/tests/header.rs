//! The header that is checked in is the one that the sources make. To write it anew after a change:
//! `GOLDEN=write cargo test -p fuzzypilot-c --test header`.

use std::path::Path;

/// In the order in which the header has them.
const SOURCES: [&str; 7] = [
    "status", "setting", "rule", "fine", "coarse", "robot", "path",
];

fn generated() -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in SOURCES.iter().chain(&["tick"]) {
        builder = builder.with_src(folder.join(format!("src/{source}.rs")));
    }
    let mut bytes = Vec::new();
    builder.generate().unwrap().write(&mut bytes);
    String::from_utf8(bytes).unwrap()
}

#[test]
fn the_header_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/fuzzypilot.h");
    let wanted = generated();
    if std::env::var("GOLDEN").is_ok_and(|golden| golden == "write") {
        std::fs::write(&path, &wanted).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    let line = found.lines().zip(wanted.lines()).position(|(a, b)| a != b);
    assert!(
        found == wanted,
        "include/fuzzypilot.h is not what src/ makes (line {:?}); GOLDEN=write renews it",
        line.map(|line| line + 1)
    );
}
