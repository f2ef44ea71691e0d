//! What `host-sim bench`, `tune` and `merge` refuse before anything is driven, and what they say then.

use crate::command::sim;
use host_sim::bench::worlds::generate::KINDS;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::Duration;
use tempfile::tempdir;

/// The message of a command line that is refused: exit code 2, nothing on standard output.
fn refused(dir: &Path, arguments: &[&str]) -> String {
    // What is not refused must not be waited for.
    let limit = Duration::from_secs(30);
    let output = sim(dir).args(arguments).timeout(limit).assert().code(2);
    let output = output.get_output();
    assert!(output.stdout.is_empty(), "{arguments:?} printed something");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The same, and that it is one line that holds all of some parts.
fn refused_with(dir: &Path, arguments: &[&str], parts: &[&str]) {
    let message = refused(dir, arguments);
    assert_eq!(message.trim_end().lines().count(), 1, "{message}");
    for part in parts {
        assert!(message.contains(part), "{part} is not in: {message}");
    }
}

/// A short campaign of the library's navigator.
fn ours(worlds: &str) -> Vec<&str> {
    let mut arguments = vec!["bench", "--worlds", worlds, "--numbers", "0,1"];
    arguments.extend(["--controllers", "ours", "--time-limit", "1"]);
    arguments
}

#[test]
fn the_limits_that_are_stated_are_those_that_can_be_driven() {
    let dir = tempdir().unwrap();
    let barn = ours("generated:barn");
    for edge in [
        ["--speed", "2.8"],
        ["--speed", "0.05"],
        ["--sensors", "cones:16:270:90"],
        ["--sensors", "cones:64:360:90"],
        ["--sensors", "cones:3:1:0"],
        ["--body", "disc:0.01"],
        ["--body", "rectangle:0.84x0.3"],
    ] {
        sim(dir.path()).args(&barn).args(edge).assert().success();
    }
    for command in [barn, vec!["tune"]] {
        for speed in ["2.9", "5"] {
            let message = refused(dir.path(), &[&command[..], &["--speed", speed]].concat());
            assert!(message.contains("0.05 to 2.8"), "{message}");
        }
        for sensors in ["cones:16:270:91", "cones:9:200:120"] {
            let arguments = [&command[..], &["--sensors", sensors]].concat();
            refused_with(dir.path(), &arguments, &["--sensors", "0 to 90°"]);
        }
    }
}

#[test]
fn a_world_without_a_way_to_drive_is_refused() {
    let dir = tempdir().unwrap();
    let route = "two points or more, from within 1 m of the start to within 1 m of the goal";
    let cases = [
        (
            "goal = [0, 0]",
            "w.toml: world 0: the start (0, 0) is within 1 m of the goal",
        ),
        (
            "goal = [0.05, 0]\ngoal-radius = 0.01",
            "is 0.050 m long; allowed: 0.1 m or more",
        ),
        (
            "goal = [5, 0]\nroute = [[0, 0], [0, 0]]",
            "w.toml:3: found a route whose points are one place",
        ),
        (
            "goal = [5, 0]\nroute = []",
            "w.toml:3: found a route without points",
        ),
        (
            "goal = [5, 0]\nroute = [[0, 0]]",
            "w.toml:3: found a route of one point",
        ),
        (
            "goal = [5, 0]\nroute = [[5, 5], [6, 6]]",
            "w.toml:3: found a route that begins 7.07 m from the start",
        ),
        (
            "goal = [5, 0]\nroute = [[0, 0], [3, 0]]",
            "w.toml:3: found a route that ends 2.00 m from the goal",
        ),
    ];
    for (text, part) in cases {
        fs::write(
            dir.path().join("w.toml"),
            format!("start = [0, 0, 0]\n{text}\n"),
        )
        .unwrap();
        let allowed = if text.contains("route") {
            route
        } else {
            "allowed"
        };
        for task in ["path", "goal"] {
            let arguments = [&ours("w.toml")[..], &["--task", task]].concat();
            refused_with(dir.path(), &arguments, &[part, allowed]);
        }
    }
}

/// Its points are so far apart that two of them fall together where it turns back.
#[test]
fn a_route_that_turns_back_on_itself_is_driven() {
    let dir = tempdir().unwrap();
    let text = "start = [0, 0, 0]\ngoal = [2.0895522388, 0]\n\
                route = [[0, 0], [6.0447761194, 0], [2.0895522388, 0]]\n";
    fs::write(dir.path().join("back.toml"), text).unwrap();
    sim(dir.path())
        .args(ours("back.toml"))
        .args(["--task", "path"])
        .assert()
        .success();
}

/// Like [`ours`] of two worlds without obstacles to speak of.
fn blind(more: &[&'static str]) -> Vec<&'static str> {
    let mut arguments = vec!["bench", "--worlds", "generated:forest", "--numbers", "0,1"];
    arguments.extend(["--task", "goal", "--controllers", "pure-pursuit"]);
    arguments.extend(["--time-limit", "1"]);
    arguments.extend(more);
    arguments
}

#[test]
fn a_place_that_cannot_be_written_is_noticed_before_the_runs() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("file"), "").unwrap();
    fs::create_dir_all(dir.path().join("folder/index.html")).unwrap();
    fs::create_dir_all(dir.path().join("tuned/report.json")).unwrap();
    fs::create_dir_all(dir.path().join("held")).unwrap();
    fs::write(dir.path().join("held/runs"), "").unwrap();
    // So many runs that they would not end.
    let endless = ["--seeds", "1000000", "--time-limit", "3600"];
    let places: [([&str; 2], &str); 5] = [
        (
            ["--json", "file/a.json"],
            "--json file/a.json: cannot be written",
        ),
        (
            ["--json", "folder"],
            "--json folder: cannot be written (is a directory",
        ),
        (["--report", "file"], "file is a file"),
        (
            ["--report", "folder"],
            "--report folder/index.html: cannot be written",
        ),
        (["--report", "held"], "held/runs is a file"),
    ];
    for (place, part) in places {
        let arguments = [
            &["bench", "--worlds", "generated:forest", "--numbers", "0-99"][..],
            &["--controllers", "pure-pursuit"],
            &endless,
            &place,
        ]
        .concat();
        refused_with(dir.path(), &arguments, &[part, "allowed"]);
    }
    for (out, part) in [
        ("file/out", "file is a file"),
        ("tuned", "--out tuned/report.json: cannot be written"),
    ] {
        let tune = [
            "tune",
            "--numbers",
            "1-299/6",
            "--seeds",
            "1000",
            "--out",
            out,
        ];
        refused_with(dir.path(), &tune, &[part, "allowed"]);
    }
}

#[test]
fn folders_are_made_and_what_cannot_be_written_at_the_end_takes_no_table_along() {
    let dir = tempdir().unwrap();
    sim(dir.path())
        .args(blind(&["--json", "a/b/whole.json"]))
        .assert()
        .success();
    assert!(dir.path().join("a/b/whole.json").exists());
    for (shard, file) in [("0/2", "0.json"), ("1/2", "1.json")] {
        sim(dir.path())
            .args(blind(&["--shard", shard, "--json", file]))
            .assert()
            .success();
    }
    let merge = ["merge", "0.json", "1.json", "--json"];
    sim(dir.path())
        .args(merge)
        .arg("c/d/merged.json")
        .assert()
        .success();
    let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    assert_eq!(read("c/d/merged.json"), read("a/b/whole.json"));
    refused_with(
        dir.path(),
        &[&merge[..], &["0.json/merged.json"]].concat(),
        &["--json 0.json/merged.json: cannot be written"],
    );
    if cfg!(target_os = "linux") {
        // A device without room.
        for arguments in [blind(&[]), merge[..3].to_vec()] {
            sim(dir.path())
                .args(arguments)
                .args(["--json", "/dev/full"])
                .assert()
                .code(1)
                .stdout(predicates::str::contains("pure-pursuit"))
                .stderr(predicates::str::contains("/dev/full: cannot be written"));
        }
    }
}

#[test]
fn a_part_that_is_not_as_it_was_written_is_refused() {
    let dir = tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
    for (shard, file) in [("0/2", "0.json"), ("1/2", "1.json")] {
        let more = ["--shard", shard, "--json", file, "--seeds", "2"];
        sim(dir.path())
            .args(blind(&[]))
            .args(more)
            .assert()
            .success();
    }
    let part: Value =
        serde_json::from_str(&fs::read_to_string(dir.path().join("1.json")).unwrap()).unwrap();
    let run = &["per_world", "0", "attempts", "1"];
    let changes: [(&[&str], Value, &str); 10] = [
        (
            &["score"],
            json!(7e300),
            "all runs: found the score 7e300 where the runs have 0",
        ),
        (&["success"], json!(-0.5), "found the success -0.5"),
        (&["runs"], json!(3), "found the runs 3"),
        (&["shard", "0"], json!(2), "found part 2/2"),
        (
            &["per_world", "0", "score"],
            json!(0.4),
            "world 1: found the score 0.4",
        ),
        (
            &["per_world", "0", "world"],
            json!(0),
            "found world 0 in the parts 0/2 and 1/2",
        ),
        (
            &["per_world"],
            json!([]),
            "all runs: found the runs 2 where the runs have 0",
        ),
        (
            &[run[0], run[1], run[2], run[3], "seed"],
            json!(5),
            "world 1: found 2 runs, with the seeds 0, 5",
        ),
        (
            &[run[0], run[1], run[2], run[3], "score"],
            json!(0.6),
            "world 1, seed 1: found the score 0.6",
        ),
        (
            &[run[0], run[1], run[2], run[3], "time_s"],
            json!(-1),
            "world 1, seed 1: found the time_s -1",
        ),
    ];
    for (path, value, message) in changes {
        let mut changed = part.clone();
        let place = path
            .iter()
            .fold(&mut changed[0], |at, key| match key.parse::<usize>() {
                Ok(index) => &mut at[index],
                Err(_) => &mut at[*key],
            });
        *place = value;
        write("changed.json", &changed.to_string());
        let merge = ["merge", "0.json", "changed.json"];
        refused_with(
            dir.path(),
            &merge,
            &["changed.json: pure-pursuit", message, "allowed"]
                [usize::from(path.len() == 3 && path[2] == "world")..],
        );
    }
    write("empty.json", "[]");
    refused_with(
        dir.path(),
        &["merge", "empty.json"],
        &["empty.json: found no results", "allowed"],
    );
    write("cut.json", &part.to_string()[..40]);
    refused_with(
        dir.path(),
        &["merge", "0.json", "cut.json"],
        &["cut.json:1: found EOF", "at column"],
    );
    write("binary.json", "\u{0}");
    fs::write(dir.path().join("binary.json"), [0xff, 0xfe, 0]).unwrap();
    refused_with(
        dir.path(),
        &["merge", "binary.json"],
        &["binary.json: found bytes that are no text"],
    );
}

#[test]
fn a_file_of_cylinders_fits_the_worlds_that_are_chosen() {
    let dir = tempdir().unwrap();
    let common = r#"{"start": [0, 0, 0], "goal": [8, 0], "goal_radius": 1, "cyl_radius": 0.1, "common_cylinders_xy": []}"#;
    fs::write(dir.path().join("common.json"), common).unwrap();
    let line = |n: u32| format!("{{\"w\": {n}, \"cyl\": [[4, 3]], \"path\": [[4, 0]]}}\n");
    fs::write(dir.path().join("three.jsonl"), [1, 2, 3].map(line).concat()).unwrap();
    let unmapped = |numbers: &'static str| {
        let mut arguments = vec!["bench", "--worlds", "three.jsonl", "--numbers", numbers];
        arguments.extend(["--task", "unmapped", "--unmapped", "extra.csv"]);
        arguments.extend(["--controllers", "pure-pursuit", "--time-limit", "1"]);
        arguments
    };
    let extra = |text: &str| fs::write(dir.path().join("extra.csv"), text).unwrap();
    extra("world,x,y,r\n1,4,1,0.1\n2,4,1,0.1\n2,5,1,0.1\n");
    // Lines of worlds that are not chosen are for other choices.
    sim(dir.path()).args(unmapped("2")).assert().success();
    refused_with(
        dir.path(),
        &unmapped("all"),
        &[
            "extra.csv: found no cylinder for world 3;",
            "allowed: a line or more",
        ],
    );
    refused_with(dir.path(), &unmapped("3"), &["no cylinder for world 3"]);
    extra("# of another place\n2,4,1,0.1\n7,4,1,0.1\n");
    let note = "note: extra.csv:3: world 7 is not in three.jsonl; its lines are not used";
    let said = predicates::str::contains(note);
    sim(dir.path())
        .args(unmapped("2"))
        .assert()
        .success()
        .stderr(said);
    let fence: String = (-40..=40)
        .map(|k| format!("2,4,{},0.2\n", f64::from(k) / 10.0))
        .collect();
    let ring: String = (0..40)
        .map(|k| f64::from(k) / 40.0 * std::f64::consts::TAU)
        .map(|turn| format!("2,{:.3},{:.3},0.2\n", 1.5 * turn.cos(), 1.5 * turn.sin()))
        .collect();
    for (text, line, part) in [
        (
            "2,4,1,0.1\n2,8,0.1,0.3\n".to_owned(),
            2,
            "the goal (8, 0) is inside the obstacle",
        ),
        (
            "2,0.3,0,0.1\n2,4,1,0.1\n".to_owned(),
            1,
            "the robot touches an obstacle where it starts",
        ),
        (format!("{ring}{fence}"), 39, "no route from"),
    ] {
        extra(&text);
        let message = refused(dir.path(), &unmapped("2"));
        let place = message
            .split(": with this cylinder")
            .next()
            .unwrap_or_default();
        let found: u32 = place
            .split(':')
            .nth(2)
            .unwrap_or_default()
            .parse()
            .unwrap_or_default();
        assert!(
            place.contains("extra.csv:") && message.contains(part),
            "{message}"
        );
        assert!(
            found.abs_diff(line) < 4 && message.contains("world 2"),
            "{line}: {message}"
        );
    }
}

#[test]
fn a_folder_of_lines_is_told_to_be_named_by_its_file() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("worlds-dev.jsonl.gz"), "").unwrap();
    fs::write(dir.path().join("more.jsonl"), "").unwrap();
    let place = dir.path().to_str().unwrap();
    let parts = [
        "no world_N.world, but more.jsonl, worlds-dev.jsonl.gz",
        "a file of lines: ",
        "/more.jsonl",
    ];
    refused_with(dir.path(), &ours(place), &parts);
}

#[test]
fn what_is_found_in_a_file_is_said_and_briefly() {
    let dir = tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(dir.path().join(name), bytes).unwrap();
    let good = r#"{"start": [0, 0, 0], "goal": [8, 0], "goal_radius": 1, "cyl_radius": 0.1, "common_cylinders_xy": []}"#;
    let line = r#"{"w": 1, "cyl": [[4, 3]], "path": [[4, 0]]}"#;
    write("common.json", good.as_bytes());
    write("text.jsonl.gz", line.as_bytes());
    write("binary.jsonl", &[0x1f, 0x8b, 0xff]);
    write("cut.jsonl", format!("{line}\n{}", &line[..30]).as_bytes());
    write(
        "far.jsonl",
        line.replace("[[4, 3]]", "[[1e300, 3]]").as_bytes(),
    );
    write(
        "w.jsonl",
        line.replace("\"w\": 1", "\"w\": 1e300").as_bytes(),
    );
    write("binary.toml", &[b'\n', 0xff, 0xfe, 0]);
    write("far.toml", b"start = [0, 0, 0]\ngoal = [1e300, 0]\n");
    write(
        "wide.toml",
        b"start = [0, 0, 0]\ngoal = [5, 0]\ngoal-radius = -1e300\n",
    );
    fs::create_dir_all(dir.path().join("binary")).unwrap();
    write("binary/world_1.world", &[b'<', 0xff]);
    fs::create_dir_all(dir.path().join("binary/path_files")).unwrap();
    let npy = |rows: u32, data: usize| {
        let mut bytes = b"\x93NUMPY\x01\x00\x46\x00".to_vec();
        let header = format!("{{'descr': '<i8', 'fortran_order': False, 'shape': ({rows}, 2), }}");
        bytes.extend(format!("{header:70}").bytes());
        bytes.extend(vec![0; data]);
        bytes
    };
    write("binary/path_files/path_1.npy", &npy(1, 16));
    for (place, parts) in [
        (
            "text.jsonl.gz",
            [
                "text.jsonl.gz: found what is no gzip file",
                "a name without .gz",
            ],
        ),
        (
            "binary.jsonl",
            [
                "binary.jsonl:1: found bytes that are no text (UTF-8)",
                "JSON lines",
            ],
        ),
        (
            "cut.jsonl",
            [
                "cut.jsonl:2: found EOF while parsing",
                "at column 30; allowed",
            ],
        ),
        (
            "far.jsonl",
            ["far.jsonl:1: found (1e300, 3)", "-1000 to 1000"],
        ),
        (
            "w.jsonl",
            [
                "w.jsonl:1: found invalid type: floating point `1e",
                "allowed",
            ],
        ),
        (
            "binary.toml",
            [
                "binary.toml:2: found bytes that are no text (UTF-8)",
                "TOML",
            ],
        ),
        ("far.toml", ["far.toml:2: found 1e300;", "-1000 to 1000"]),
        (
            "wide.toml",
            ["wide.toml:3: found -1e300;", "above 0 and up to 100"],
        ),
        (
            "binary",
            [
                "world_1.world:1: found bytes that are no text (UTF-8)",
                "an SDF world",
            ],
        ),
        ("none.jsonl", ["none.jsonl: cannot be read", ""]),
    ] {
        refused_with(dir.path(), &ours(place), &parts);
        let message = refused(dir.path(), &ours(place));
        assert!(!message.contains("at line"), "{message}");
        assert!(message.len() < 250, "{message}");
    }
    for (bytes, part) in [
        (
            npy(0, 0),
            "path_1.npy: found an array without rows; allowed",
        ),
        (
            npy(1, 24),
            "path_1.npy: found an array and 8 bytes behind it; allowed",
        ),
    ] {
        write("binary/path_files/path_1.npy", &bytes);
        refused_with(dir.path(), &ours("binary"), &[part]);
    }
    for (common, part) in [
        (
            good.replace("[8, 0]", "[1e300, 0]"),
            "common.json: found (1e300, 0)",
        ),
        (
            good.replace("0.1", "-0.1"),
            "common.json: found the cyl_radius -0.1",
        ),
        (
            good.replace("\"goal_radius\": 1", "\"goal_radius\": 0"),
            "common.json: found the goal_radius 0",
        ),
        (
            good.replace("}", "\n"),
            "common.json:2: found EOF while parsing an object at column 0",
        ),
    ] {
        write("common.json", common.as_bytes());
        refused_with(dir.path(), &ours("far.jsonl"), &[part, "allowed"]);
    }
}

#[test]
fn a_shard_without_worlds_says_so_and_has_no_zero_below_zero() {
    let dir = tempdir().unwrap();
    for shard in ["0/3", "1/3", "2/3"] {
        let file = format!("{}.json", &shard[..1]);
        let output = sim(dir.path())
            .args(blind(&["--shard", shard, "--report", "report"]))
            .args(["--json", &file])
            .assert()
            .success();
        let text = String::from_utf8_lossy(&output.get_output().stdout).into_owned();
        assert_eq!(
            shard == "2/3",
            text.contains("shard 2/3 has no world"),
            "{text}"
        );
    }
    for name in [
        "2.json",
        "report/table.txt",
        "report/per-world.csv",
        "report/index.html",
    ] {
        let text = fs::read_to_string(dir.path().join(name)).unwrap();
        assert!(!text.contains("-0.0"), "{name}: {text}");
    }
    sim(dir.path())
        .args(["merge", "0.json", "1.json", "2.json"])
        .assert()
        .success();
}

#[test]
fn help_names_every_kind_of_world_and_the_limits_of_sensors() {
    let dir = tempdir().unwrap();
    let output = sim(dir.path()).args(["bench", "--help"]).assert().success();
    let text = String::from_utf8_lossy(&output.get_output().stdout).into_owned();
    let words: Vec<&str> = text.split_whitespace().collect();
    let text = words.join(" ");
    for kind in KINDS
        .iter()
        .map(|kind| kind.name)
        .chain(["generated:routes"])
    {
        assert!(text.contains(kind), "{kind}");
    }
    for limits in ["3 to 64 cones", "0 to 90 degrees wide", "More than 32"] {
        assert!(text.contains(limits), "{limits}: {text}");
    }
}

/// The world that the document shows, as it stands there.
#[test]
fn the_document_s_own_world_can_be_driven() {
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/bench.md");
    let document = fs::read_to_string(document).unwrap();
    let (_, rest) = document.split_once("```toml\n").unwrap();
    let (world, _) = rest.split_once("```").unwrap();
    assert!(world.contains("mover"), "{world}");
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("own.toml"), world).unwrap();
    for task in ["path", "goal"] {
        let arguments = [
            "bench", "--worlds", "own.toml", "--task", task, "--seeds", "10",
        ];
        sim(dir.path())
            .args(arguments)
            .args(["--controllers", "ours", "--json", "own.json"])
            .assert()
            .success();
        let text = fs::read_to_string(dir.path().join("own.json")).unwrap();
        let results: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(results[0]["success"], 1.0, "{task}");
    }
}

#[test]
fn results_do_not_overwrite_each_other() {
    let dir = tempdir().unwrap();
    let barn = ours("generated:barn");
    for json in [
        "page",
        "./page/index.html",
        "page/table.txt",
        "page/runs/a.json",
    ] {
        let places = ["--json", json, "--report", "page"];
        let arguments = [&barn[..], &places[..]].concat();
        refused_with(
            dir.path(),
            &arguments,
            &[json, "--report page writes there"],
        );
    }
    assert!(!dir.path().join("page").exists());
    let places = ["--json", "page/all.json", "--report", "page"];
    sim(dir.path()).args(&barn).args(places).assert().success();
}

#[test]
fn a_world_has_a_way_and_is_there_once() {
    let dir = tempdir().unwrap();
    let common = r#"{"start": [0, 0, 0], "goal": [8, 0], "goal_radius": 1, "cyl_radius": 0.1, "common_cylinders_xy": []}"#;
    fs::write(dir.path().join("common.json"), common).unwrap();
    let world = "{\"w\": 1, \"cyl\": [[4, 3]], \"path\": []}";
    fs::write(dir.path().join("one.jsonl"), world).unwrap();
    let parts = [
        "one.jsonl:1: found a path without a point",
        "one point or more",
    ];
    refused_with(dir.path(), &ours("one.jsonl"), &parts);
    for name in ["raw/world_1.world", "raw/world_files/world_1.world"] {
        let file = dir.path().join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, "<sdf/>").unwrap();
    }
    refused_with(
        dir.path(),
        &ours("raw"),
        &["found world 1 in raw", "every world once"],
    );
}
