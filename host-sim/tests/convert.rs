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
fn a_folder_is_no_file_to_write() {
    let folder = tempdir().unwrap();
    fs::create_dir(folder.path().join("made")).unwrap();
    let fan = design("fan.fll");
    for to in ["fll", "fcl", "rust"] {
        for out in ["made", "new/"] {
            let args = [fan.to_str().unwrap(), "--to", to, "--out", out];
            let said = format!("--out {out}: is a folder; --to {to} writes one file");
            refused(folder.path(), &args, &[&said, "allowed is a file's name"]);
        }
    }
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

#[test]
fn code_goes_where_it_is_told() {
    let folder = tempdir().unwrap();
    let fan = design("fan.fll");
    let fan = fan.to_str().unwrap();
    let said = convert(folder.path())
        .args([fan, "--to", "rust"])
        .assert()
        .success();
    let said = said.get_output().stdout.clone();
    convert(folder.path())
        .args([fan, "--to", "rust", "--out", "fan.rs"])
        .assert()
        .success()
        .stdout("");
    assert_eq!(fs::read(folder.path().join("fan.rs")).unwrap(), said);
    // Both files of C: by the source's name, or in a folder, under a name for both.
    convert(folder.path())
        .args([fan, "--to", "c", "--out", "vent.c"])
        .assert()
        .success()
        .stdout("");
    convert(folder.path())
        .args([
            fan,
            "--to",
            "c",
            "--name",
            "Lüfter 2",
            "--out",
            "new/folder",
        ])
        .assert()
        .success();
    for (file, part) in [
        ("vent.c", "#include \"vent.h\"\n"),
        ("vent.h", "void fan_evaluate("),
        ("new/folder/lufter_2.c", "#include \"lufter_2.h\"\n"),
        ("new/folder/lufter_2.h", "void lufter_2_evaluate("),
    ] {
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(text.contains(part), "{file}: {text}");
    }
}

#[test]
fn descriptions_stay_and_the_design_itself_is_not_written_over() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let text = fs::read_to_string(design("greenhouse.fll")).unwrap();
    let descriptions = |text: &str, mark: &str| -> Vec<String> {
        let lines = text.lines().map(str::trim);
        let lines = lines.filter_map(|line| Some(line.strip_prefix(mark)?.trim().to_owned()));
        lines.collect()
    };
    let said = descriptions(&text, "description:");
    assert!(said.len() >= 3);
    fs::write(here.join("design.fll"), &text).unwrap();
    let to = |to: &str| {
        let output = convert(here)
            .args(["design.fll", "--to", to])
            .assert()
            .success();
        String::from_utf8(output.get_output().stdout.clone()).unwrap()
    };
    assert_eq!(descriptions(&to("fll"), "description:"), said);
    let fan = fs::read_to_string(design("fan.fll")).unwrap();
    fs::write(here.join("design.fll"), fan).unwrap();
    assert!(descriptions(&to("fcl"), "//").contains(&"per cent of its speed".to_owned()));
    fs::write(here.join("design.fll"), &text).unwrap();
    for out in ["design.fll", "./design.fll"] {
        refused(
            here,
            &["design.fll", "--to", "fll", "--out", out],
            &["is the design that is read", "allowed is another file"],
        );
    }
    fs::write(here.join("design.c"), &text).unwrap();
    refused(
        here,
        &[
            "design.c", "--from", "fll", "--to", "c", "--out", "design.h",
        ],
        &["is the design that is read"],
    );
    assert_eq!(fs::read_to_string(here.join("design.fll")).unwrap(), text);
    assert_eq!(fs::read_to_string(here.join("design.c")).unwrap(), text);
}

#[test]
fn names_of_c_and_of_rust_are_left_to_them() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let fan = design("fan.fll");
    let fan = fan.to_str().unwrap();
    // The header's name says where both go, too.
    convert(here)
        .args([fan, "--to", "c", "--out", "vent.h"])
        .assert()
        .success();
    assert!(here.join("vent.c").is_file() && here.join("vent.h").is_file());
    convert(here)
        .args([fan, "--to", "c", "--name", "stdint", "--out", "."])
        .assert()
        .success();
    let header = fs::read_to_string(here.join("fuzzy_stdint.h")).unwrap();
    assert!(header.contains("void fuzzy_stdint_evaluate("), "{header}");
    refused(
        here,
        &[fan, "--to", "c", "--out", "stdint.c"],
        &["its header would be stdint.h, which is one of C's"],
    );
    refused(
        here,
        &[fan, "--to", "rust", "--name", ""],
        &["--name: found nothing"],
    );
    let text = fs::read_to_string(design("fan.fll")).unwrap();
    fs::write(here.join("self.fll"), text.replace("humidity", "self")).unwrap();
    let output = convert(here)
        .args(["self.fll", "--to", "rust"])
        .assert()
        .success();
    let module = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    assert!(module.contains("pub type Self2 ="), "{module}");
}

/// C has the general route's integers, so Rust has them, too, unless another route is asked for.
#[test]
fn rust_is_the_general_route_unless_told_otherwise() {
    let folder = tempdir().unwrap();
    let [fan, greenhouse] = ["fan.fll", "greenhouse.fll"].map(design);
    let made = |design: &Path, route: &[&str]| {
        let said = convert(folder.path())
            .arg(design)
            .args(["--to", "rust"])
            .args(route)
            .assert()
            .success();
        let [out, err] = [&said.get_output().stdout, &said.get_output().stderr]
            .map(|text| String::from_utf8(text.clone()).unwrap());
        // The head says the command.
        let code = out.lines().filter(|line| !line.contains("Made by"));
        (code.collect::<Vec<_>>().join("\n"), err)
    };
    let (general, silent) = made(&fan, &["--route", "general"]);
    let (module, note) = made(&fan, &[]);
    assert!(module == general && module.contains("Route: general"));
    assert_eq!(
        (silent.as_str(), note.as_str()),
        (
            "",
            "note: --route fast is quicker and fits this design; its integers are others than C's: fractional bits are of `fan` 8 for 16\n"
        )
    );
    let (fast, silent) = made(&fan, &["--route", "fast"]);
    assert!(fast.contains("Route: fast") && silent.is_empty());
    assert_eq!(made(&fan, &["--route", "auto"]), (fast, silent));
    assert_eq!(made(&greenhouse, &[]).1, "");
}

#[test]
fn code_that_cannot_be_is_refused() {
    let folder = tempdir().unwrap();
    let greenhouse = design("greenhouse.fll");
    let greenhouse = greenhouse.to_str().unwrap();
    fs::write(folder.path().join("file"), "precious").unwrap();
    refused(
        folder.path(),
        &[
            greenhouse, "--to", "rust", "--route", "fast", "--out", "x.rs",
        ],
        &[
            "greenhouse.fll: --route fast does not fit: it takes 2 inputs, and there are 4; allowed is --route general",
        ],
    );
    refused(
        folder.path(),
        &[greenhouse, "--to", "c"],
        &["--to c writes two files; --out says where: NAME.c, or a folder for both"],
    );
    refused(
        folder.path(),
        &[greenhouse, "--to", "c", "--out", "file/below"],
        &["file is a file; allowed is a folder"],
    );
    for (arguments, part) in [
        (
            &["--to", "fll", "--route", "fast"][..],
            "--route is of no use here; allowed with --to rust",
        ),
        (
            &["--to", "c", "--out", "x.c", "--route", "general"],
            "--route is of no use here",
        ),
        (
            &["--to", "fcl", "--name", "x"],
            "--name is of no use here; allowed with --to rust or --to c",
        ),
        (
            &["--to", "rust", "--adapt"],
            "--adapt is of no use here; allowed with --to fll or --to fcl",
        ),
    ] {
        refused(folder.path(), &[&[greenhouse], arguments].concat(), &[part]);
    }
    // No number format has room for both.
    let text = fs::read_to_string(design("fan.fll")).unwrap();
    let text = text.replace("range: 0 100", "range: 0 1e-9");
    fs::write(folder.path().join("wide.fll"), text).unwrap();
    for to in [&["--to", "rust"][..], &["--to", "c", "--out", "."]] {
        refused(
            folder.path(),
            &[&["wide.fll"], to].concat(),
            &[
                "wide.fll: line 16, column",
                "the output `fan` does not fit: its largest number",
            ],
        );
    }
}

/// A source that cannot be written takes its header with it.
#[test]
fn no_half_of_two_files_is_left() {
    let folder = tempdir().unwrap();
    fs::create_dir(folder.path().join("fan.c")).unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    fs::create_dir(folder.path().join("out/fan.c")).unwrap();
    convert(folder.path())
        .args([
            design("fan.fll").to_str().unwrap(),
            "--to",
            "c",
            "--out",
            "out",
        ])
        .assert()
        .code(2);
    let left: Vec<_> = fs::read_dir(folder.path().join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(left, ["fan.c"]);
}
