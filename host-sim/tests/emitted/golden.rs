//! What a person reads: the fan as code, as it was checked in. `EMITTED_GOLDEN=write` writes it anew.

use assert_cmd::Command;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

#[test]
fn the_fan_is_as_it_was() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let golden = here.join("tests/emitted/golden");
    let folder = tempdir().unwrap();
    for (design, arguments, files) in [
        (
            "fan.fll",
            &["--to", "rust", "--out", "fan.rs"][..],
            &["fan.rs"][..],
        ),
        (
            "fan.fll",
            &["--to", "rust", "--route", "fast", "--out", "fan_fast.rs"],
            &["fan_fast.rs"],
        ),
        (
            "fine.fll",
            &["--to", "rust", "--route", "fast", "--out", "fine_fast.rs"],
            &["fine_fast.rs"],
        ),
        (
            "fan.fll",
            &["--to", "c", "--out", "fan.c"],
            &["fan.h", "fan.c"],
        ),
    ] {
        Command::new(assert_cmd::cargo::cargo_bin!("host-sim"))
            .current_dir(folder.path())
            .args(["fuzzy", "convert"])
            .arg(here.join("designs").join(design))
            .args(arguments)
            .assert()
            .success()
            .stdout("");
        for file in files {
            let found = fs::read_to_string(folder.path().join(file)).unwrap();
            let place = golden.join(file);
            if std::env::var("EMITTED_GOLDEN").is_ok_and(|what| what == "write") {
                fs::write(&place, &found).unwrap();
            }
            let wanted = fs::read_to_string(&place).unwrap_or_default();
            assert!(
                found == wanted,
                "{file} is another: see what changed with EMITTED_GOLDEN=write and git diff"
            );
        }
    }
}
