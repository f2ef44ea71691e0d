//! `host-sim fuzzy convert` from outside: what it writes, its exit codes, and that a refusal leaves nothing behind.

use assert_cmd::Command;
use host_sim::fuzzy::files::{fcl, fll, load};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::tempdir;

fn convert(folder: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command
        .current_dir(folder)
        .timeout(std::time::Duration::from_secs(60))
        .args(["fuzzy", "convert"]);
    command
}

fn design(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("designs")
        .join(name)
}

/// Runs it, expects exit code 2 and every one of `parts` on stderr, and that the folder stays as it was.
fn refused(folder: &Path, args: &[&str], parts: &[&str]) {
    let names = || -> Vec<_> {
        fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name())
            .collect()
    };
    let before = names();
    let output = convert(folder).args(args).assert().code(2).stdout("");
    let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    for part in parts {
        assert!(said.contains(part), "{args:?}: `{part}` not in {said}");
    }
    assert_eq!(names(), before, "{args:?} left something behind");
}

#[test]
fn a_design_goes_to_standard_output_or_to_a_file() {
    let folder = tempdir().unwrap();
    let fis = design("fine.fis");
    let system = load(&fis, None).unwrap();
    let wanted = fcl::write(&system).unwrap();
    convert(folder.path())
        .args([fis.to_str().unwrap(), "--to", "fcl"])
        .assert()
        .success()
        .stdout(wanted.clone())
        .stderr("");
    convert(folder.path())
        .args([fis.to_str().unwrap(), "--to", "fcl", "--out", "fine.fcl"])
        .assert()
        .success()
        .stdout("")
        .stderr("");
    assert_eq!(
        fs::read_to_string(folder.path().join("fine.fcl")).unwrap(),
        wanted
    );
    // There and back.
    convert(folder.path())
        .args(["fine.fcl", "--to", "fll"])
        .assert()
        .success()
        .stdout(fll::write(&system).unwrap());
}

#[test]
fn the_format_may_be_named() {
    let folder = tempdir().unwrap();
    let text = fs::read_to_string(design("fan.fll")).unwrap();
    fs::write(folder.path().join("fan.txt"), &text).unwrap();
    refused(
        folder.path(),
        &["fan.txt", "--to", "fcl"],
        &["fan.txt: the extension names no format; allowed is one of .fll, .fcl, .fis"],
    );
    convert(folder.path())
        .args(["fan.txt", "--from", "fll", "--to", "fcl"])
        .assert()
        .success();
    refused(
        folder.path(),
        &["fan.txt", "--from", "fis", "--to", "fcl"],
        &["fan.txt:2:1: the file begins with `Engine: fan`; allowed is `[System]`"],
    );
}

#[test]
fn bad_input_ends_with_2_and_leaves_nothing() {
    let folder = tempdir().unwrap();
    let text = fs::read_to_string(design("fan.fll")).unwrap();
    let bad = text.replace("Triangle 18 24 32", "Triangle 18 24");
    fs::write(folder.path().join("bad.fll"), bad).unwrap();
    fs::write(folder.path().join("out.fcl"), "precious").unwrap();
    let mark = "\n 8 |   term: warm Triangle 18 24\n   |              ^^^^^^^^\n";
    refused(
        folder.path(),
        &["bad.fll", "--to", "fcl", "--out", "out.fcl"],
        &[
            "error: bad.fll:8:14: `Triangle` has 2 numbers; allowed is 3",
            mark,
        ],
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("out.fcl")).unwrap(),
        "precious"
    );
    refused(
        folder.path(),
        &["none.fll", "--to", "fcl"],
        &["none.fll: cannot be read"],
    );
    refused(
        folder.path(),
        &["bad.fll", "--to", "fis"],
        &["possible values: fll, fcl"],
    );
}

#[test]
fn what_a_format_cannot_say_is_named_with_its_line() {
    let folder = tempdir().unwrap();
    let cruise = design("cruise.fis");
    refused(
        folder.path(),
        &[
            cruise.to_str().unwrap(),
            "--to",
            "fcl",
            "--out",
            "cruise.fcl",
        ],
        &["cruise.fis:36:5: FCL has no linear terms: `coast` of `throttle`"],
    );
}

#[test]
fn what_is_adapted_is_named() {
    let folder = tempdir().unwrap();
    let text = fs::read_to_string(design("watering.fcl")).unwrap();
    let ends = text.replace("450 middles", "101 ends");
    fs::write(folder.path().join("ends.fcl"), ends).unwrap();
    refused(
        folder.path(),
        &["ends.fcl", "--to", "fll"],
        &[
            "FLL cannot say that the centroid of `minutes` is sampled from end to end",
            "(--adapt does that)",
        ],
    );
    let output = convert(folder.path())
        .args(["ends.fcl", "--to", "fll", "--adapt"])
        .assert()
        .success();
    let output = output.get_output();
    let said = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(
        said.starts_with("note: the centroid of `minutes` takes its 101 samples"),
        "{said}"
    );
    assert!(
        String::from_utf8(output.stdout.clone())
            .unwrap()
            .contains("Centroid 101\n")
    );
    // FCL wants a name for a rule block.
    let fan = fs::read_to_string(design("fan.fll")).unwrap();
    fs::write(
        folder.path().join("fan.fll"),
        fan.replace("RuleBlock: rules", "RuleBlock:"),
    )
    .unwrap();
    convert(folder.path())
        .args(["fan.fll", "--to", "fcl", "--adapt"])
        .assert()
        .success()
        .stderr("note: the rule block 1 without a name is now `rules_1`\n");
    // Names of MATLAB's that no other format has.
    let fis = fs::read_to_string(design("cruise.fis")).unwrap();
    let fis = fis
        .replace("'shortfall'", "'short fall'")
        .replace("'hold'", "'not'");
    fs::write(folder.path().join("names.fis"), fis).unwrap();
    refused(
        folder.path(),
        &["names.fis", "--to", "fll"],
        &[
            "names.fis:17:6: FLL has no such name: the input `short fall`",
            "(--adapt does that)",
        ],
    );
    let output = convert(folder.path())
        .args(["names.fis", "--to", "fll", "--adapt"])
        .assert()
        .success();
    let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    assert!(
        said.contains("note: the variable `short fall` is now `short_fall`"),
        "{said}"
    );
    assert!(
        said.contains("note: the term of `throttle` `not` is now `not_2`"),
        "{said}"
    );
}
