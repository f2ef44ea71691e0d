//! `host-sim tune`: what it refuses, what it writes, and that a search can be stopped and gone on with.

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use std::path::Path;
use tempfile::tempdir;

fn tune(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("host-sim").unwrap();
    command.arg("tune").args(arguments);
    command
}

/// A search that takes seconds: one world, two settings.
const SMALL: [&str; 8] = [
    "--numbers",
    "1",
    "--task",
    "goal",
    "--only",
    "steer.rate,barrier.share",
    "--sigma",
    "0.3",
];

#[test]
fn worlds_of_the_test_set_are_refused() {
    tune(&["--numbers", "1,12"])
        .assert()
        .code(2)
        .stderr(contains("world 12").and(contains("not divisible by 6")));
}

#[test]
fn a_search_that_could_find_nothing_is_refused() {
    let sealed = "--worlds generated:sealed: world 1 is sealed";
    for (arguments, part) in [
        (
            ["--numbers", "1", "--evaluations", "4"],
            "--evaluations 4: less than one generation; allowed is 15 or more",
        ),
        (["--worlds", "generated:sealed", "--numbers", "1"], sealed),
    ] {
        let folder = tempdir().unwrap();
        let out = folder.path().join("out");
        tune(&arguments)
            .args(["--out", out.to_str().unwrap()])
            .assert()
            .code(2)
            .stderr(contains(part).and(contains("allowed")));
        assert!(!out.exists());
    }
}

#[test]
fn worlds_of_several_places_are_driven_each_with_its_numbers() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let places = ["--worlds", "generated:barn", "--worlds", "generated:slalom"];
    tune(&places)
        .args([
            "--numbers",
            "1",
            "--numbers",
            "2",
            "--task",
            "goal",
            "--only",
        ])
        .args(["steer.rate,barrier.share", "--evaluations", "6", "--out"])
        .arg(&out)
        .assert()
        .success()
        .stdout(contains("goal 1 m/s, generated:barn 1").and(contains("generated:slalom 2")));
    let module = std::fs::read_to_string(out.join("tuned.rs")).unwrap();
    let command =
        "--worlds generated:barn --worlds generated:slalom --numbers 1 --numbers 2 --task";
    assert!(module.contains(command), "{module}");
    tune(&["--numbers", "1", "--numbers", "2"])
        .assert()
        .code(2)
        .stderr(contains(
            "--numbers: found 2 lists for 1 places; allowed is one for all, or one for each",
        ));
    tune(&places)
        .args(["--numbers", "1", "--numbers", "12"])
        .assert()
        .code(2)
        .stderr(contains("--numbers 12: found world 12"));
}

#[test]
fn settings_that_do_not_exist_are_named() {
    tune(&["--only", "steer.raet"])
        .assert()
        .code(2)
        .stderr(contains("--only steer.raet").and(contains("steer.rate")));
    tune(&["--only", "steer.rate", "--fix", "steer"])
        .assert()
        .code(2)
        .stderr(contains(
            "--fix steer: no setting is left to move; without it steer.rate",
        ));
    tune(&["--list", "--only", "steer"])
        .assert()
        .success()
        .stdout(contains("steer.flank").and(contains("memory").not()));
}

#[test]
fn a_search_that_goes_on_ends_where_a_whole_one_does() {
    let folder = tempdir().unwrap();
    let [whole, half, rest] = ["whole", "half", "rest"].map(|name| folder.path().join(name));
    let run = |out: &Path, more: &[&str]| {
        let mut arguments = SMALL.to_vec();
        arguments.extend(["--out", out.to_str().unwrap()]);
        arguments.extend(more);
        tune(&arguments).assert().success();
    };
    run(&whole, &["--evaluations", "18"]);
    run(&half, &["--evaluations", "6"]);
    let state = half.join("state.json");
    run(
        &rest,
        &["--evaluations", "18", "--resume", state.to_str().unwrap()],
    );
    let read = |folder: &Path, file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    assert_eq!(read(&whole, "tuned.rs"), read(&rest, "tuned.rs"));
    for file in ["state.json", "report.json"] {
        assert_eq!(read(&whole, file), read(&rest, file));
    }
    // Another seed asks other questions.
    let mut arguments = SMALL.to_vec();
    arguments.extend(["--seed", "2", "--resume", state.to_str().unwrap()]);
    tune(&arguments).assert().code(2).stderr(contains("--seed"));
}

/// What is shipped is what the command writes: read and written again it is the same.
#[test]
fn the_shipped_sets_are_its_output() {
    let folder = tempdir().unwrap();
    for (sensors, module) in [
        ("cone16", "sixteen"),
        ("cone8", "eight"),
        ("ultrasonic5", "five"),
        ("lidar720", "lidar"),
    ] {
        let out = folder.path().join(module);
        tune(&["--sensors", sensors, "--numbers", "1", "--task", "path"])
            // Steps that rounding swallows: nothing is better than the start.
            .args(["--only", "steer.rate", "--sigma", "0.000001"])
            .args(["--evaluations", "4", "--out", out.to_str().unwrap()])
            .assert()
            .success();
        let text = |file: &Path| {
            let text = std::fs::read_to_string(file).unwrap();
            // The first lines hold the command.
            let (_, body) = text.split_once("\n\n").unwrap();
            body.to_owned()
        };
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join(format!("../src/navigate/presets/{module}.rs"));
        assert_eq!(text(&out.join("tuned.rs")), text(&shipped), "{module}");
    }
}
