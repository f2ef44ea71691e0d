//! The command line from outside: what it prints and writes, its exit codes, and what it says about wrong input.

use assert_cmd::Command;
use host_sim::metrics::Metrics;
use host_sim::run::{check, simulate};
use host_sim::scenario::{BUILT_IN, load};
use predicates::prelude::*;
use std::fs;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// A good scenario; the cases below each break it in one place.
const GOOD: &str = r#"[robot]
preset = "small"

[start]
x = 0.0
y = 0.0
heading = 0.0

[path]
[[path.piece]]
line = { from = [0.0, 0.0], to = [1.0, 0.0] }

[[obstacle]]
x = 5.0
y = 3.0
radius = 0.5

[run]
duration = 3.0
"#;

const LINE: &str = "[[path.piece]]\nline = { from = [0.0, 0.0], to = [1.0, 0.0] }";
/// What a coordinate may be.
const PLACE: &str = "a number from -10000 to 10000";
const POINTS: &str = "points = [\n    [0.0, 0.0, 0.0],\n    [1.0, 0.0, 0.0],\n]";

fn sim(dir: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command
        .current_dir(dir)
        .timeout(std::time::Duration::from_secs(60));
    command
}

/// Runs it and gives stdout back; nothing may appear on stderr.
fn done(dir: &Path, args: &[&str]) -> String {
    let output = sim(dir).args(args).assert().success().stderr("");
    String::from_utf8(output.get_output().stdout.clone()).unwrap()
}

/// Runs it, expects one line on stderr with every one of `parts` in it, and that the folder stays as it was.
fn refused(dir: &Path, args: &[&str], code: i32, parts: &[&str]) {
    let before = names(dir);
    let output = sim(dir).args(args).assert().code(code).stdout("");
    let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    assert_eq!(said.lines().count(), 1, "{args:?}: {said}");
    assert!(said.len() < 600, "{args:?}: {} bytes", said.len());
    for part in parts {
        assert!(said.contains(part), "{args:?}: `{part}` not in {said}");
    }
    assert_eq!(names(dir), before, "{args:?} left something behind");
}

/// What clap itself refuses: several lines, but naming the argument and what is allowed.
fn refused_by_clap(args: &[&str], parts: &[&str]) {
    let dir = tempdir().unwrap();
    let output = sim(dir.path()).args(args).assert().code(2).stdout("");
    let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    for part in parts {
        assert!(said.contains(part), "{args:?}: `{part}` not in {said}");
    }
    assert!(names(dir.path()).is_empty(), "{args:?}");
}

fn names(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(dir)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn with(name: &str, bytes: impl AsRef<[u8]>) -> TempDir {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join(name), bytes).unwrap();
    dir
}

fn replaced(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

fn json(file: impl AsRef<Path>) -> serde_json::Value {
    serde_json::from_slice(&fs::read(file).unwrap()).unwrap()
}

const RESULTS: [&str; 5] = [
    "replay.html",
    "run.png",
    "run.svg",
    "summary.json",
    "ticks.csv",
];

#[test]
fn without_arguments_it_tells_the_chapters_story() {
    let dir = tempdir().unwrap();
    let said = done(dir.path(), &[]);
    // Obstacle and measured side, and at the row's end what the chapter tells.
    for (name, side, told) in [
        ("Obs4", "right", ["right", "69", "40"]),
        ("Obs5", "left", ["left", "36", "–"]),
        ("Obs6", "left", ["left", "49", "–"]),
    ] {
        let row = said.lines().find(|l| l.contains(name)).unwrap();
        let cells: Vec<&str> = row.trim_matches('│').split('┆').map(str::trim).collect();
        assert_eq!(cells[1], side, "{row}");
        assert_eq!(cells[5..], told, "{row}");
    }
    let out = dir.path().join("out/experiment-1");
    assert_eq!(names(&out), RESULTS);
    let summary = json(out.join("summary.json"));
    for key in [
        "scenario",
        "law",
        "seed",
        "ticks",
        "sim_time_s",
        "reached_end",
        "collisions",
        "min_clearance_m",
        "cross_track_rms_m",
        "cross_track_max_m",
    ] {
        assert!(!summary[key].is_null(), "{key}");
    }
    assert_eq!(summary["scenario"], "experiment-1");
    assert_eq!(summary["reached_end"], true);
    assert_eq!(summary["collisions"], 0);
    let passes = summary["avoidances"].as_array().unwrap();
    let sides: Vec<_> = passes
        .iter()
        .map(|p| (&p["obstacle"], &p["side"]))
        .collect();
    assert_eq!(
        serde_json::to_value(sides).unwrap(),
        serde_json::json!([["Obs4", "right"], ["Obs5", "left"], ["Obs6", "left"]])
    );
    assert!(passes.iter().all(|p| p["steps"].as_u64().unwrap() > 0));
    // One row a tick below the header.
    let ticks = fs::read_to_string(out.join("ticks.csv")).unwrap();
    assert_eq!(
        ticks.lines().count() as u64,
        summary["ticks"].as_u64().unwrap() + 1
    );
    let png = fs::read(out.join("run.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
    assert!(
        fs::read_to_string(out.join("run.svg"))
            .unwrap()
            .contains("</svg>")
    );
    assert!(
        fs::read_to_string(out.join("replay.html"))
            .unwrap()
            .contains("</html>")
    );

    // The same run without the word `run`, elsewhere, is the same to the byte; so is the JSON file.
    done(dir.path(), &["--out", "here", "--json", "copy.json"]);
    let here = dir.path().join("here");
    assert_eq!(names(&here), RESULTS);
    for file in ["ticks.csv", "summary.json"] {
        assert_eq!(
            fs::read(out.join(file)).unwrap(),
            fs::read(here.join(file)).unwrap()
        );
    }
    assert_eq!(
        fs::read(dir.path().join("copy.json")).unwrap(),
        fs::read(here.join("summary.json")).unwrap()
    );
    assert_eq!(names(dir.path()), ["copy.json", "here", "out"]);

    done(dir.path(), &["run", "--seed", "2", "--out", "other"]);
    let other = dir.path().join("other");
    for file in ["ticks.csv", "summary.json"] {
        assert_ne!(
            fs::read(out.join(file)).unwrap(),
            fs::read(other.join(file)).unwrap()
        );
    }
}

#[test]
fn every_variant_flag_runs_and_shows_in_the_summary() {
    let dir = tempdir().unwrap();
    for (args, variant) in [
        (
            &["--law", "paper", "--radius", "6"][..],
            "law paper, printed tables",
        ),
        (&["--law", "guided"], "law guided, printed tables"),
        (&["--tables", "tuned"], "law guided, tuned tables"),
        (
            &["--fine-nn", "prose"],
            "law guided, printed tables (7.2 by prose)",
        ),
        (
            &["--speed-axis", "literal"],
            "law guided, printed tables, literal speed axis",
        ),
        (
            &["--table-7-3", "printed"],
            "law guided, printed tables, Table 7.3 as printed",
        ),
        (
            &["--table-7-4-input", "bearing"],
            "law guided, printed tables, Table 7.4 reads the bearing",
        ),
        (
            &["--integrator", "arc", "--odometry", "noisy"],
            "law guided, printed tables",
        ),
        (
            &[
                "--integrator",
                "euler",
                "--odometry",
                "exact",
                "--seed",
                "18446744073709551615",
            ],
            "law guided, printed tables",
        ),
    ] {
        let line = [
            &["run", "experiment-1", "--out", "o", "--json", "s.json"],
            args,
        ]
        .concat();
        done(dir.path(), &line);
        let summary = json(dir.path().join("s.json"));
        assert_eq!(summary["variant"], variant, "{args:?}");
        assert_eq!(summary["law"], variant[4..].split(',').next().unwrap());
    }
}

#[test]
fn every_built_in_runs_to_its_end_without_collision() {
    for (name, _) in BUILT_IN {
        let scenario = load(name).unwrap();
        check(&scenario).unwrap();
        let mut metrics = Metrics::new(&scenario, 1);
        let ending = simulate(&scenario, 1, &mut |step| metrics.observe(&step)).unwrap();
        let summary = metrics.finish(ending);
        assert!(summary.reached_end, "{name}");
        assert_eq!(summary.collisions, 0, "{name}");
    }
}

#[test]
fn a_built_in_printed_runs_as_a_file_with_the_same_ticks() {
    let dir = tempdir().unwrap();
    let listed = done(dir.path(), &["list"]);
    for (name, _) in BUILT_IN {
        assert!(
            listed
                .lines()
                .any(|l| l.split_whitespace().next() == Some(name)),
            "{name}"
        );
        assert_eq!(
            done(dir.path(), &["list", "--show", name]),
            BUILT_IN.iter().find(|b| b.0 == *name).unwrap().1
        );
    }
    // With points, with obstacles and noise, closed; and with Windows line ends.
    for name in ["points", "one-obstacle", "circle"] {
        let text = done(dir.path(), &["list", "--show", name]);
        fs::write(dir.path().join("mine.toml"), text.replace('\n', "\r\n")).unwrap();
        done(dir.path(), &["run", name, "--out", "a"]);
        done(dir.path(), &["run", "mine.toml", "--out", "b"]);
        assert_eq!(
            fs::read(dir.path().join("a/ticks.csv")).unwrap(),
            fs::read(dir.path().join("b/ticks.csv")).unwrap(),
            "{name}"
        );
    }
}

#[test]
fn the_worked_example_evaluates_as_the_chapter_computes_it() {
    let dir = tempdir().unwrap();
    let said = done(dir.path(), &["eval", "fine", "1.2", "100"]);
    let cells = |row: &str| -> Vec<String> {
        row.trim_matches('│')
            .split('┆')
            .map(|c| c.trim().to_owned())
            .collect()
    };
    let figures = |name: &str| -> Vec<f64> {
        let row = said.lines().find(|l| l.contains(name)).unwrap();
        cells(row)[1..3]
            .iter()
            .map(|c| c.parse().unwrap())
            .collect()
    };
    // Fixed point beside f64, within one step of the output.
    let v = figures("v [axis");
    assert!(
        (v[0] - 0.6944).abs() < 1.3e-4 && (v[1] - 0.6944).abs() < 5e-5,
        "{v:?}"
    );
    let turn = figures("Δφ [°]");
    assert!(
        (turn[0] - 52.540).abs() < 4e-3 && (turn[1] - 52.540).abs() < 5e-4,
        "{turn:?}"
    );
    let mut degrees: Vec<String> = said
        .lines()
        .map(cells)
        .filter(|row| row.len() == 5 && row[4].starts_with("0."))
        .map(|row| row[4].clone())
        .collect();
    degrees.sort();
    assert_eq!(degrees, ["0.200", "0.200", "0.222", "0.778"]);

    let said = done(dir.path(), &["eval", "coarse", "0.8", "-15"]);
    assert!(said.contains("fixed point") && said.contains("f64"));
    assert!(said.contains("Δθ [°, clockwise]") && said.contains("56.250"));
    // Far outside of every axis: saturates, does not crash.
    for args in [
        ["fine", "1e300", "-1e300"],
        ["coarse", "-1e300", "1e300"],
        ["fine", "-0", "1e-320"],
    ] {
        done(dir.path(), &[&["eval"], &args[..]].concat());
    }
    done(
        dir.path(),
        &["eval", "coarse", "1e300", "0", "--range", "1e-300"],
    );
}

/// Tables 7.1 and 7.2 once more, rows φ, columns d, by their terms' peaks.
const SPEED: [[f64; 5]; 5] = [
    [0.75, 0.75, 1.5, 2.25, 2.6],
    [0.75, 0.75, 1.5, 1.5, 2.25],
    [0.4, 0.75, 0.75, 1.5, 1.5],
    [0.4, 0.4, 0.75, 0.75, 1.5],
    [2.6, 0.4, 0.4, 0.75, 1.5],
];
const TURN: [[f64; 5]; 5] = [
    [0.0, 0.0, 0.0, 0.0, 0.0],
    [20.0, 45.0, 20.0, 20.0, 20.0],
    [0.0, 45.0, 45.0, 20.0, 20.0],
    [45.0, 70.0, 70.0, 45.0, 45.0],
    [70.0, 90.0, 70.0, 70.0, 45.0],
];

/// Triangles of width 1 about 0 to 4, minimum, height method.
fn by_hand(table: &[[f64; 5]; 5], d: f64, phi: f64) -> f64 {
    let degree = |x: f64, term: usize| (1.0 - (x - term as f64).abs()).max(0.0);
    let (mut sum, mut weight) = (0.0, 0.0);
    for (row, peaks) in table.iter().enumerate() {
        for (col, peak) in peaks.iter().enumerate() {
            let w = degree(phi / 45.0, row).min(degree(d, col));
            sum += w * peak;
            weight += w;
        }
    }
    sum / weight
}

#[test]
fn the_whole_grid_agrees_with_a_second_route() {
    let mut points = String::from("phi,d\n");
    for i in 0..=200 {
        for phi in 0..=180 {
            points += &format!("{phi},{}\n", f64::from(i) / 50.0);
        }
    }
    // Columns in another order, and with a byte order mark as spreadsheets write it.
    let dir = with("grid.csv", format!("\u{feff}{points}"));
    let said = done(dir.path(), &["eval", "fine", "--points", "grid.csv"]);
    let mut rows = said.lines();
    assert_eq!(rows.next(), Some("d,phi,v,dphi"));
    let mut count = 0;
    for row in rows {
        let x: Vec<f64> = row.split(',').map(|c| c.parse().unwrap()).collect();
        assert!((x[2] - by_hand(&SPEED, x[0], x[1])).abs() <= 0.001, "{row}");
        assert!((x[3] - by_hand(&TURN, x[0], x[1])).abs() <= 0.02, "{row}");
        count += 1;
    }
    assert_eq!(count, 201 * 181);
}

#[test]
fn surface_draws_every_table_twice() {
    let dir = tempdir().unwrap();
    done(dir.path(), &["surface", "--out", "deep/down"]);
    let files = names(&dir.path().join("deep/down"));
    for table in [
        "fine-printed-speed",
        "fine-printed-deflection",
        "fine-printed-prose-deflection",
        "fine-tuned-speed",
        "fine-tuned-deflection",
        "coarse-corrected-deflection",
        "coarse-corrected-speed",
        "coarse-printed-deflection",
        "coarse-printed-speed",
    ] {
        for what in ["surface", "memberships"] {
            for kind in ["svg", "png"] {
                let file = format!("{table}-{what}.{kind}");
                assert!(files.contains(&file), "{file}");
            }
        }
    }
    assert!(
        files
            .iter()
            .all(|f| f.ends_with(".svg") || f.ends_with(".png"))
    );
}

#[test]
fn a_wrong_scenario_is_named_with_line_field_and_what_is_allowed() {
    let piece = |new: &str| replaced(GOOD, LINE, new);
    let points = |new: &str| piece(&replaced(POINTS, "[1.0, 0.0, 0.0]", new));
    let start = |new: &str| replaced(GOOD, "x = 0.0", new);
    let after = |new: &str| format!("{GOOD}{new}\n");
    let cases: Vec<(String, usize, &[&str])> = vec![
        // Not the right TOML.
        (
            start("x = \"left\""),
            5,
            &["start.x", "\"left\"", "a number"],
        ),
        (start("x = = 0.0"), 5, &["start.x"]),
        (start("x = 0.0\nx = 1.0"), 6, &["start.x", "duplicate"]),
        (replaced(GOOD, "[start]", "[start"), 4, &["start", "`]`"]),
        (
            start("x = 0.0\nspin = 1.0"),
            6,
            &["start.spin", "spin", "`x`, `y`, `heading`"],
        ),
        (after("[weather]\nrain = 1"), 20, &["weather", "`robot`"]),
        (
            after("\"new\\nline\" = 1"),
            20,
            &["new", "`duration` or `laps`"],
        ),
        (
            replaced(GOOD, "heading = 0.0\n", ""),
            4,
            &["start.heading", "nothing"],
        ),
        (
            replaced(GOOD, &format!("[path]\n{LINE}"), ""),
            1,
            &[":1: path: ", "nothing"],
        ),
        (
            points("[\"a\", 0, 0]"),
            12,
            &["path.points", "\"a\"", "a number"],
        ),
        (
            points("[1.0, 0.0]"),
            12,
            &["path.points", "an array of length 3"],
        ),
        (String::new(), 1, &["start", "nothing"]),
        (format!("a = {}", "[".repeat(100_000)), 1, &["recur"]),
        (
            format!("{} = 1", "a".repeat(1_000_000)),
            1,
            &["unknown field", "`about`"],
        ),
        // Numbers.
        (start("x = nan"), 5, &["start.x", "NaN", PLACE]),
        (start("x = -inf"), 5, &["start.x", "-inf", PLACE]),
        (start("x = 1e300"), 5, &["start.x", "1e300", PLACE]),
        (
            replaced(GOOD, "radius = 0.5", "radius = -0.5"),
            16,
            &["obstacle[0].radius", "-0.5"],
        ),
        (
            replaced(GOOD, "radius = 0.5", "radius = inf"),
            16,
            &["obstacle[0].radius", "inf"],
        ),
        (
            replaced(GOOD, "preset = \"small\"", "preset = \"small\"\nperiod = 0"),
            3,
            &["robot.period", "0.0", "0.001 to 2"],
        ),
        (
            replaced(
                GOOD,
                "preset = \"small\"",
                "preset = \"small\"\nacceleration = 1e-9",
            ),
            3,
            &["robot.acceleration", "1e-9", "0.001 to 100"],
        ),
        (
            replaced(
                GOOD,
                "preset = \"small\"",
                "preset = \"small\"\nradius = 1e-9",
            ),
            3,
            &["robot.radius", "1e-9"],
        ),
        (
            after("[sensors]\nrange = 1e-7"),
            21,
            &["sensors.range", "1e-7", "0.01 to 100"],
        ),
        (
            after("[sensors]\ncount = 7"),
            21,
            &["sensors.count", "7", "8, 16, 32 or 64"],
        ),
        (
            after("[sensors]\ncount = 99999999999999999999"),
            21,
            &["sensors.count", "whole"],
        ),
        (after("laps = 0"), 20, &["run.laps", "0", "1 to 1000"]),
        (after("laps = -1"), 20, &["run.laps", "-1", "1 to 1000"]),
        (
            after("laps = 1.5"),
            20,
            &["run.laps", "1.5", "a whole number"],
        ),
        (
            replaced(GOOD, "duration = 3.0", "duration = 0"),
            19,
            &["run.duration", "above 0"],
        ),
        (
            replaced(GOOD, "duration = 3.0", "duration = 1e300"),
            19,
            &["run.duration", "1e300"],
        ),
        // More ticks than can be kept.
        (
            replaced(
                &replaced(GOOD, "duration = 3.0", "duration = 100000"),
                "preset = \"small\"",
                "preset = \"small\"\nperiod = 0.001",
            ),
            20,
            &["run.duration", "100000000 ticks", "at most 200000"],
        ),
        // Words.
        (
            after("[control]\nlaw = \"x\""),
            21,
            &["control.law", "`x`", "`guided` or `paper`"],
        ),
        (
            after("[control]\ntables = \"x\""),
            21,
            &["control.tables", "`printed` or `tuned`"],
        ),
        (
            replaced(GOOD, "\"small\"", "\"tiny\""),
            2,
            &["robot.preset", "`chapter` or `small`"],
        ),
        (
            after("[control]\nfine-nn = \"prose\""),
            20,
            &["control.fine-nn", "prose", "printed"],
        ),
        // The path.
        (piece(""), 9, &["path", "neither", "`points`"]),
        (
            piece(&format!("{POINTS}\n{LINE}")),
            9,
            &["path", "both", "either"],
        ),
        (
            piece("points = []"),
            10,
            &["path.points", "0 points", "2 to 4096"],
        ),
        (
            piece("points = [[0.0, 0.0, 0.0]]"),
            10,
            &["path.points", "1 point", "2 to 4096"],
        ),
        (
            points("[0.0, 0.0, 90.0]"),
            12,
            &["path.points[1]", "same place", "1 mm"],
        ),
        (
            points("[36000.0, 0.0, 0.0]"),
            12,
            &["path.points[1]", "36000", PLACE],
        ),
        (
            piece(&format!(
                "closed = true\n{}",
                replaced(POINTS, "0.0],\n]", "0.0],\n    [0.0, 0.0, 0.0],\n]")
            )),
            9,
            &["path.points", "last point", "1 mm"],
        ),
        (
            piece(&format!("closed = true\n{LINE}")),
            9,
            &["path.closed", "gap of 1.000 m"],
        ),
        (
            piece(&format!(
                "{LINE}\n{}",
                replaced(LINE, "from = [0.0", "from = [2.0")
            )),
            12,
            &["path.piece[1]", "gap of 1.000 m", "gaps = true"],
        ),
        (
            piece("piece = [{ arc = { centre = [0, 0], radius = 1, from = 0, sweep = 0 } }]"),
            10,
            &["path.piece[0]", "without length"],
        ),
        (
            piece("piece = [{ arc = { centre = [0, 0], radius = 1, from = 0, sweep = 361 } }]"),
            10,
            &["path.piece[0].arc.sweep", "361", "-360 to 360"],
        ),
        (
            replaced(GOOD, "line = {", "spline = {"),
            11,
            &["`spline`", "`line` or `arc`"],
        ),
        (
            piece(&format!(
                "points = [{}]",
                "[-9999, 0, 0], [9999, 0, 0], ".repeat(2)
            )),
            9,
            &["path", "length of 59994 m", "at most 30000 m"],
        ),
        // Obstacles.
        (
            replaced(GOOD, "x = 5.0\ny = 3.0", "x = 0.3\ny = 0.3"),
            4,
            &["start", "Obs1", "touches"],
        ),
        (
            replaced(GOOD, "x = 5.0", "along = 0.5\nx = 5.0"),
            13,
            &["obstacle[0]", "unclear"],
        ),
        (
            replaced(GOOD, "x = 5.0", "name = \"a\\nb\\u0000\"\nx = 5.0"),
            14,
            &["obstacle[0].name", "one line"],
        ),
        (
            after(&"[[obstacle]]\nx = 50\ny = 50\nradius = 1\n".repeat(1000)),
            4016,
            &["obstacle", "1001 obstacles", "at most 1000"],
        ),
    ];
    for (text, line, parts) in cases {
        let dir = with("bad.toml", &text);
        let place = format!("bad.toml:{line}: ");
        let parts = [&[place.as_str(), "found ", "allowed: "], parts].concat();
        let args = ["run", "bad.toml", "--out", "o", "--json", "j.json"];
        refused(dir.path(), &args, 2, &parts);
    }
}

#[test]
fn the_good_scenario_is_good() {
    let dir = with("good.toml", format!("\u{feff}{}", GOOD.replace("0.0", "0")));
    done(dir.path(), &["run", "good.toml"]);
    assert_eq!(names(&dir.path().join("out/good")), RESULTS);
    // A name that would end the replay's script, or not be XML.
    let text = replaced(GOOD, "x = 5.0", "name = \"</script><b>&\"\nx = 5.0");
    fs::write(dir.path().join("name.toml"), text).unwrap();
    done(dir.path(), &["run", "name.toml", "--out", "n"]);
    let page = fs::read_to_string(dir.path().join("n/replay.html")).unwrap();
    assert!(!page.contains("</script><b>"));
}

#[test]
fn what_is_no_scenario_file_is_refused() {
    let mut garbage = Vec::new();
    while garbage.len() < 10_000_000 {
        garbage.extend((0..95).map(|i| b' ' + (i * 2 % 95)));
    }
    let dir = with("big.toml", garbage);
    fs::write(
        dir.path().join("binary.toml"),
        [GOOD.as_bytes(), b"\n\xff\xfe"].concat(),
    )
    .unwrap();
    fs::write(dir.path().join("zero.toml"), vec![0; 1_000_000]).unwrap();
    fs::create_dir(dir.path().join("folder.toml")).unwrap();
    for (name, parts) in [
        ("big.toml", &["big.toml", "4 MiB", "allowed"][..]),
        ("binary.toml", &["binary.toml:21: ", "UTF-8"]),
        ("zero.toml", &["zero.toml:1: ", "allowed"]),
        ("folder.toml", &["folder.toml", "directory", "allowed"]),
        ("absent.toml", &["absent.toml", "No such file", "allowed"]),
        ("no/where", &["no/where", "allowed"]),
        (
            "nosuch",
            &["nosuch", "allowed", "experiment-1", "narrow-gap"],
        ),
        ("", &["unknown scenario", "experiment-1"]),
    ] {
        refused(dir.path(), &["run", name, "--out", "o"], 2, parts);
        refused(dir.path(), &["sweep", name, "--seeds", "1"], 2, parts);
    }
    #[cfg(target_os = "linux")]
    refused(
        dir.path(),
        &["run", "/dev/zero"],
        2,
        &["/dev/zero", "4 MiB"],
    );
}

#[test]
fn a_place_that_cannot_be_written_is_refused_before_the_run() {
    let dir = with("file", "kept");
    fs::create_dir(dir.path().join("folder")).unwrap();
    for (args, parts) in [
        (
            &["--out", "file"][..],
            &["--out file", "is a file", "allowed"][..],
        ),
        (
            &["--out", "file/under"],
            &["--out file/under", "file is a file", "allowed"],
        ),
        (
            &["--json", "absent/x.json"],
            &["--json absent/x.json", "existing folder"],
        ),
        (&["--json", "folder"], &["--json folder", "allowed"]),
        (&["--json", "new/"], &["--json new/", "allowed"]),
        (&["--json", "file/x"], &["--json file/x", "allowed"]),
    ] {
        refused(dir.path(), &[&["run", "line"], args].concat(), 2, parts);
        if args[0] == "--out" {
            refused(dir.path(), &[&["surface"], args].concat(), 2, parts);
        }
    }
    assert_eq!(fs::read(dir.path().join("file")).unwrap(), b"kept");
    // `out` itself may be in the way.
    let dir = with("out", "");
    refused(dir.path(), &["run", "line"], 2, &["out is a file"]);
    refused(dir.path(), &["surface"], 2, &["out is a file"]);
}

/// The run was fine, the system is not: exit code 1, and no half-written files.
#[cfg(target_os = "linux")]
#[test]
fn a_failing_disk_is_no_bad_input() {
    let dir = tempdir().unwrap();
    let proc = "/proc/host-sim";
    refused(
        dir.path(),
        &["run", "worked-example", "--out", proc],
        1,
        &[proc, "cannot be created"],
    );
    // A folder where a result belongs.
    fs::create_dir_all(dir.path().join("o/ticks.csv")).unwrap();
    refused(
        dir.path(),
        &["run", "line", "--out", "o"],
        1,
        &["ticks.csv", "cannot be written"],
    );
    assert!(
        names(&dir.path().join("o"))
            .iter()
            .all(|n| !n.ends_with(".tmp"))
    );
    // A full disk behind --json, and behind standard output.
    sim(dir.path())
        .args(["run", "line", "--out", "p", "--json", "/dev/full"])
        .assert()
        .code(1)
        .stderr(predicate::str::contains("/dev/full: cannot be written"));
    use std::os::unix::fs::FileTypeExt;
    assert!(
        fs::metadata("/dev/full")
            .unwrap()
            .file_type()
            .is_char_device()
    );
    let full = || fs::File::options().write(true).open("/dev/full").unwrap();
    let bin = || std::process::Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    let output = bin()
        .args(["eval", "fine", "1.2", "100"])
        .stdout(full())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        String::from_utf8(output.stderr)
            .unwrap()
            .contains("standard output")
    );
}

/// `--json` onto a link keeps the link.
#[cfg(unix)]
#[test]
fn json_goes_where_a_link_leads() {
    let dir = tempdir().unwrap();
    let link = dir.path().join("link.json");
    std::os::unix::fs::symlink("real.json", &link).unwrap();
    done(
        dir.path(),
        &["run", "line", "--out", "o", "--json", "link.json"],
    );
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(json(dir.path().join("real.json"))["scenario"], "line");
}

/// `host-sim list | true`.
#[test]
fn a_reader_that_leaves_is_no_error() {
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("host-sim"))
        .args(["list", "--show", "points"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    assert!(output.stderr.is_empty());
}

#[test]
fn wrong_points_are_named_by_line_and_nothing_is_printed() {
    let many = "x".repeat(1_000_000);
    for (bytes, parts) in [
        (&b"x,y\n1,2\n"[..], &[":1: header", "`x,y`", "d,phi"][..]),
        (b"d;phi\n1;2\n", &[":1: header", "`d;phi`", "d,phi"]),
        (b"", &[":1: header", "d,phi"]),
        (b"\"d\nx\",phi\n1,2\n", &[":1: header", "d,phi"]),
        (
            b"d,phi\n1,2\n1\n",
            &[":3: row", "fields: 1", "2, as the header"],
        ),
        (
            b"d,phi\n1,2\nNaN,3\n",
            &[":3: d", "`NaN`", "a finite number"],
        ),
        (
            b"d,phi\r\n1,2\r\n3,inf\r\n",
            &[":3: phi", "`inf`", "a finite number"],
        ),
        (
            b"d,phi\n\n\n1,2\n\nx,3\n",
            &[":6: d", "`x`", "a finite number"],
        ),
        (b"d,phi\r\n\r\n1,2,3\r\n", &[":3: row", "fields: 3"]),
        (b"d,phi\n1,\n", &[":2: phi", "``", "a finite number"]),
        (b"d,phi\n1,2\n\xff\xfe,3\n", &["points.csv:3: ", "UTF-8"]),
        (b"\x7fELF\x00\x01\xff\xfe\n\x00", &["points.csv", "d,phi"]),
        (many.as_bytes(), &[":1: header", "d,phi"]),
    ] {
        let dir = with("points.csv", bytes);
        let args = ["eval", "fine", "--points", "points.csv"];
        refused(dir.path(), &args, 2, &[&["points.csv"], parts].concat());
    }
    let dir = tempdir().unwrap();
    let args = ["eval", "fine", "--points"];
    refused(
        dir.path(),
        &[&args[..], &["no.csv"]].concat(),
        2,
        &["no.csv", "d,phi"],
    );
    refused(
        dir.path(),
        &[&args[..], &["."]].concat(),
        2,
        &["directory", "d,phi"],
    );
    // The other controller has other columns.
    let dir = with("points.csv", "d,phi\n1,2\n");
    let args = ["eval", "coarse", "--points", "points.csv"];
    refused(dir.path(), &args, 2, &[":1: header", "`d,phi`", "s,theta"]);
}

#[test]
fn wrong_values_are_named() {
    let dir = tempdir().unwrap();
    let number = "a finite number";
    for (args, parts) in [
        (
            &["eval", "fine", "nan", "3"][..],
            &["d:", "`nan`", number][..],
        ),
        (&["eval", "fine", "1", "inf"], &["phi:", "`inf`", number]),
        (&["eval", "fine", "far", "3"], &["d:", "`far`", number]),
        (&["eval", "fine", "1.2"], &["phi:", "missing", number]),
        (&["eval", "coarse"], &["s:", "missing", number]),
        (
            &["eval", "coarse", "1", "2", "--range", "-1"],
            &["--range", "-1", "above 0"],
        ),
        (
            &["eval", "coarse", "1", "2", "--range", "nan"],
            &["--range", "`nan`", number],
        ),
        (
            &[
                "eval",
                "fine",
                "1",
                "2",
                "--tables",
                "tuned",
                "--fine-nn",
                "prose",
            ],
            &["--fine-nn prose", "--tables printed"],
        ),
        (
            &["run", "line", "--fine-nn", "prose"],
            &["--fine-nn prose", "--tables printed"],
        ),
        (&["run", "line", "--radius", "3"], &["--radius", "no arcs"]),
        (
            &["run", "points", "--radius", "3"],
            &["--radius", "no arcs"],
        ),
        (
            &["list", "--show", "nosuch"],
            &["--show nosuch", "allowed", "slalom"],
        ),
    ] {
        refused(dir.path(), args, 2, parts);
    }
}

#[test]
fn arguments_that_clap_refuses_are_named_with_what_is_allowed() {
    for (args, parts) in [
        (
            &["run", "--radius", "-1"][..],
            &["--radius", "'-1'", "0.01 to 1000"][..],
        ),
        (
            &["run", "--radius", "nan"],
            &["--radius", "'nan'", "0.01 to 1000"],
        ),
        (
            &["run", "--radius", "-inf"],
            &["--radius", "'-inf'", "0.01 to 1000"],
        ),
        (&["run", "--radius", "1e-9"], &["--radius", "0.01 to 1000"]),
        (
            &["run", "--seed", "x"],
            &["--seed", "'x'", "a whole number from 0"],
        ),
        (
            &["run", "--seed", "-1"],
            &["--seed", "'-1'", "a whole number from 0"],
        ),
        (
            &["--seed", "18446744073709551616"],
            &["--seed", "18446744073709551615"],
        ),
        (&["run", "--law", "x"], &["--law", "'x'", "guided, paper"]),
        (&["run", "--tables", "x"], &["--tables", "printed, tuned"]),
        (
            &["run", "--integrator", "x"],
            &["--integrator", "arc, euler"],
        ),
        (&["run", "--out", ""], &["--out"]),
        (&["run", "--json", ""], &["--json"]),
        (&["run", "line", "circle"], &["circle"]),
        (
            &["sweep", "line", "--seeds", "0"],
            &["--seeds", "1 to 1000000"],
        ),
        (
            &["sweep", "line", "--seeds", "-1"],
            &["--seeds", "1 to 1000000"],
        ),
        (&["sweep"], &["SCENARIOS"]),
        (&["errata", "--seeds", "x"], &["--seeds", "1 to 100000"]),
        (
            &["bench-tick", "--seconds", "nan"],
            &["--seconds", "0.001 to 600"],
        ),
        (&["eval", "fine", "1", "2", "--points", "x"], &["--points"]),
        (&["eval", "medium"], &["medium"]),
        (&["frobnicate"], &["frobnicate"]),
        (&["--out", "o", "list"], &["--out", "list"]),
    ] {
        refused_by_clap(args, parts);
    }
}

/// Whatever a result's file is called, and whatever name the file that is read has beside its own.
#[test]
fn no_command_writes_over_what_it_reads() {
    let dir = tempdir().unwrap();
    let here = dir.path();
    fs::create_dir(here.join("o")).unwrap();
    for file in [
        "run.svg",
        "run.png",
        "replay.html",
        "ticks.csv",
        "summary.json",
    ] {
        fs::write(here.join("o").join(file), GOOD).unwrap();
        let scenario = format!("o/{file}");
        let lost = format!("{scenario} is the scenario that is read, which would be lost");
        refused(
            here,
            &["run", &scenario, "--out", "o"],
            2,
            &["--out: ", &lost],
        );
        let json = ["run", &scenario, "--out", "p", "--json", &scenario];
        refused(here, &json, 2, &["--json: ", &lost]);
        let hil = ["hil", "--local", "--scenario", &scenario, "--out", "o"];
        refused(here, &hil, 2, &["--out: ", &lost]);
        fs::remove_file(here.join(&scenario)).unwrap();
    }
    fs::write(here.join("o/link.json"), GOOD).unwrap();
    let hil = ["hil", "--local", "--scenario", "o/link.json", "--out", "o"];
    refused(here, &hil, 2, &["--out: ", "o/link.json is the scenario"]);
    for file in [
        "decisions.svg",
        "decisions.png",
        "ticks.csv",
        "summary.json",
    ] {
        let log = format!("o/{file}");
        fs::write(here.join(&log), "").unwrap();
        let lost = format!("{log} is the log that is read");
        refused(
            here,
            &["replay-carmen", &log, "--out", "o"],
            2,
            &["--out: ", &lost],
        );
    }
    fs::write(here.join("worlds.jsonl"), "").unwrap();
    fs::write(here.join("common.json"), "").unwrap();
    fs::create_dir_all(here.join("barn/path_files")).unwrap();
    fs::write(here.join("barn/world_1.world"), "").unwrap();
    fs::write(here.join("barn/path_files/path_1.npy"), "").unwrap();
    for (worlds, file) in [
        ("worlds.jsonl", "worlds.jsonl"),
        ("worlds.jsonl", "common.json"),
        ("barn", "barn/world_1.world"),
        ("barn", "barn/path_files/path_1.npy"),
    ] {
        let lost = format!("{file} is a file of the worlds that is read");
        let args = ["bench", "--worlds", worlds, "--json", file];
        refused(here, &args, 2, &["--json: ", &lost]);
        for result in ["table.txt", "per-world.csv", "index.html"] {
            fs::create_dir(here.join("report")).unwrap();
            fs::hard_link(here.join(file), here.join("report").join(result)).unwrap();
            let args = ["bench", "--worlds", worlds, "--report", "report"];
            refused(
                here,
                &args,
                2,
                &["--report: ", "is a file of the worlds that is read"],
            );
            fs::remove_dir_all(here.join("report")).unwrap();
        }
        for result in ["tuned.rs", "report.json", "state.json"] {
            fs::create_dir(here.join("tuned")).unwrap();
            fs::hard_link(here.join(file), here.join("tuned").join(result)).unwrap();
            let args = ["tune", "--worlds", worlds, "--out", "tuned"];
            refused(
                here,
                &args,
                2,
                &["--out: ", "is a file of the worlds that is read"],
            );
            fs::remove_dir_all(here.join("tuned")).unwrap();
        }
    }
    // No file is read of worlds that are made: what is called so is the last run's.
    let made = "bench --worlds generated:forest --numbers 0 --task goal --controllers pure-pursuit --seeds 1 --json";
    sim(here)
        .args(made.split(' '))
        .args(["common.json", "--time-limit", "1"])
        .assert()
        .success();
    fs::write(here.join("o/per-world.csv"), "").unwrap();
    let cylinders = ["--task", "unmapped", "--unmapped", "o/per-world.csv"];
    let bench = ["bench", "--worlds", "generated:barn"];
    for (option, value) in [("--report", "o"), ("--json", "o/per-world.csv")] {
        let args = [&bench[..], &cylinders, &[option, value]].concat();
        refused(
            here,
            &args,
            2,
            &[option, "is the file of cylinders that is read"],
        );
    }
}
