//! `host-sim replay-carmen` from outside, on logs of a corridor whose ranges are worked out here.

use assert_cmd::Command;
use flate2::{Compression, write::GzEncoder};
use predicates::prelude::*;
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use tempfile::tempdir;

/// Half the width of the corridor, m, and where it is closed.
const HALF: f64 = 1.0;
const END: f64 = 8.0;

/// Beams over the half turn ahead, both ends included.
const BEAMS: usize = 181;

fn sim(dir: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command.current_dir(dir).arg("replay-carmen");
    command
}

/// What a laser at x, in the middle of the corridor and looking along it, sees.
fn ranges(x: f64) -> Vec<f64> {
    (0..BEAMS)
        .map(|k| {
            let direction = (k as f64 - 90.0).to_radians();
            let wall = HALF / direction.sin().abs().max(1e-9);
            let end = (END - x) / direction.cos().max(1e-9);
            wall.min(end).min(81.0)
        })
        .collect()
}

fn words(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(|x| format!("{x:.3}")).collect();
    words.join(" ")
}

/// A robot that drives to `last` at 0.5 m/s, five scans a second, with a time or without.
fn corridor(last: f64, timed: bool) -> String {
    let mut text = String::from("# a comment\nPARAM robot_width 0.4 nohost 0\n");
    for k in 0..=(last / 0.1).round() as u32 {
        let (x, t) = (f64::from(k) * 0.1, f64::from(k) * 0.2);
        let time = if timed { t + 1000.0 } else { 0.0 };
        let _ = writeln!(
            text,
            "FLASER {BEAMS} {} {x} 0 0 {x} 0 0 {time} host {time}",
            words(&ranges(x))
        );
        let _ = writeln!(text, "ODOM {x} 0 0 0.5 0 0 {time} host {time}");
    }
    text
}

/// The same as messages of the later kind.
fn robotlaser(last: f64) -> String {
    let mut text = String::new();
    for k in 0..=(last / 0.1).round() as u32 {
        let (x, t) = (f64::from(k) * 0.1, f64::from(k) * 0.2);
        let _ = writeln!(
            text,
            "ROBOTLASER1 0 -1.570796326794897 3.141592653589793 0.017453292519943295 81 0.01 0 {BEAMS} {} 0 {x} 0 0 {x} 0 0 0.5 0 0 0 0 {t} host {t}",
            words(&ranges(x))
        );
    }
    text
}

fn summary(dir: &Path) -> Value {
    let text = fs::read_to_string(dir.join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn drawn(dir: &Path) -> String {
    fs::read_to_string(dir.join("decisions.svg")).unwrap()
}

fn gzip(text: &str) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(text.as_bytes()).unwrap();
    packed.finish().unwrap()
}

#[test]
fn a_corridor_is_driven_in_the_middle_and_the_end_is_seen() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("hall.log"), corridor(6.0, true)).unwrap();
    sim(dir.path())
        .arg("hall.log")
        .assert()
        .success()
        .stdout(predicate::str::contains("written: out/hall"));
    let out = dir.path().join("out/hall");
    let figures = summary(&out);
    let number = |key: &str| figures[key].as_f64().unwrap();
    assert_eq!(figures["scans"], 61);
    assert_eq!(figures["messages"], 122);
    assert_eq!(figures["clock"], "messages");
    // 12 s and the tick at their beginning.
    assert_eq!(figures["ticks"], 241);
    assert!((number("driven_m") - 6.0).abs() < 1e-6);
    let shares = figures["manoeuvres"].as_object().unwrap();
    let all: f64 = shares.values().map(|s| s.as_f64().unwrap()).sum();
    assert!((all - 1.0).abs() < 1e-9 && shares.len() == 5, "{shares:?}");
    // The walls are a metre away, half the width of the body less.
    for key in ["least_clearance_m", "least_beam_m"] {
        assert!((number(key) - 0.785).abs() < 0.06, "{key}: {figures}");
    }
    // It would have driven on, faster than the recorded robot did.
    assert!(number("mean_speed_mps") > 0.5, "{figures}");

    let table = fs::read_to_string(out.join("ticks.csv")).unwrap();
    assert_eq!(table.lines().count(), 242);
    let picture = fs::read_to_string(out.join("decisions.svg")).unwrap();
    for part in ["avoid", "remembered point", "decided twist"] {
        assert!(picture.contains(part), "{part}");
    }
    assert!(
        fs::read(out.join("decisions.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );
}

#[test]
fn in_front_of_the_end_it_would_have_slowed_and_stopped() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("hall.log"), corridor(7.7, true)).unwrap();
    sim(dir.path())
        .args(["hall.log", "--out", "o"])
        .assert()
        .success();
    let table = fs::read_to_string(dir.path().join("o/ticks.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let headers = reader.headers().unwrap().clone();
    let at = |name: &str| headers.iter().position(|h| h == name).unwrap();
    let (x, v) = (at("x_m"), at("v_mps"));
    let rows: Vec<(f64, f64)> = reader
        .records()
        .map(|r| r.unwrap())
        .map(|r| (r[x].parse().unwrap(), r[v].parse().unwrap()))
        .collect();
    let fastest = |from: f64, to: f64| {
        let within = rows.iter().filter(|(x, _)| (from..to).contains(x));
        within.map(|(_, v)| *v).fold(0.0, f64::max)
    };
    assert!(fastest(2.0, 5.0) > 0.6);
    // The front is 5 cm from the end then.
    assert!(fastest(7.65, 8.0) < 0.25, "{}", fastest(7.65, 8.0));
    assert!(fastest(7.0, 7.5) < fastest(2.0, 5.0));
}

#[test]
fn packed_or_of_the_later_kind_it_is_the_same() {
    let dir = tempdir().unwrap();
    let text = corridor(3.0, true);
    fs::write(dir.path().join("plain.log"), &text).unwrap();
    fs::write(dir.path().join("packed.log.gz"), gzip(&text)).unwrap();
    fs::write(dir.path().join("later.log"), robotlaser(3.0)).unwrap();
    let table = |file: &str| {
        sim(dir.path())
            .args([file, "--out", "o"])
            .assert()
            .success();
        fs::read_to_string(dir.path().join("o/ticks.csv")).unwrap()
    };
    let plain = table("plain.log");
    assert_eq!(table("packed.log.gz"), plain);
    assert_eq!(table("later.log"), plain);
}

#[test]
fn without_times_it_goes_at_a_pace() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("hall.log"), corridor(3.0, false)).unwrap();
    for (pace, lasts) in [("0.5", 6.0), ("0.25", 12.0)] {
        sim(dir.path())
            .args(["hall.log", "--out", "o", "--pace", pace])
            .assert()
            .success()
            .stdout(predicate::str::contains("none in the log"));
        let figures = summary(&dir.path().join("o"));
        assert_eq!(figures["clock"], "pace");
        assert!((figures["duration_s"].as_f64().unwrap() - lasts).abs() < 1e-6);
        assert!(drawn(&dir.path().join("o")).contains("driven at --pace"));
    }
    fs::write(dir.path().join("timed.log"), corridor(3.0, true)).unwrap();
    sim(dir.path())
        .args(["timed.log", "--out", "o"])
        .assert()
        .success();
    assert!(!drawn(&dir.path().join("o")).contains("--pace"));
}

#[test]
fn the_picture_says_the_way_that_the_summary_has() {
    let dir = tempdir().unwrap();
    // To and fro within a tick, which sees the corners of none of it.
    let mut text = String::new();
    for k in 0..=300 {
        let (x, y, t) = (
            f64::from(k) * 0.01,
            0.02 * f64::from(k % 2),
            f64::from(k) * 0.02,
        );
        let _ = writeln!(
            text,
            "FLASER {BEAMS} {} {x} {y} 0 {x} {y} 0 {t} host {t}",
            words(&ranges(x))
        );
    }
    fs::write(dir.path().join("hall.log"), text).unwrap();
    sim(dir.path())
        .args(["hall.log", "--out", "o"])
        .assert()
        .success();
    let out = dir.path().join("o");
    let driven = summary(&out)["driven_m"].as_f64().unwrap();
    assert!((driven - 300.0 * 0.01_f64.hypot(0.02)).abs() < 1e-6);
    assert!(drawn(&out).contains(&format!("{driven:.1} m driven")));
}

#[test]
fn given_its_own_way_it_follows_that() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("hall.log"), corridor(6.0, true)).unwrap();
    let follows = |task: &str| {
        sim(dir.path())
            .args(["hall.log", "--out", "o", "--task", task])
            .assert()
            .success();
        let figures = summary(&dir.path().join("o"));
        figures["manoeuvres"]["follow"].as_f64().unwrap()
    };
    assert_eq!(follows("goal"), 0.0);
    let path = follows("path");
    assert!(path > 0.5, "{path}");
}

#[test]
fn another_body_has_another_clearance() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("hall.log"), corridor(3.0, true)).unwrap();
    sim(dir.path())
        .args(["hall.log", "--out", "o", "--body", "disc:0.5"])
        .assert()
        .success();
    let least = summary(&dir.path().join("o"))["least_beam_m"]
        .as_f64()
        .unwrap();
    assert!((least - 0.5).abs() < 0.01, "{least}");
}

#[test]
fn wrong_input_ends_with_2_and_one_message() {
    let dir = tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| fs::write(dir.path().join(name), bytes).unwrap();
    let whole = corridor(1.0, true);
    let packed = gzip(&whole);
    put("whole.log", whole.as_bytes());
    put("cut.log.gz", &packed[..packed.len() / 2]);
    put("empty.log", b"");
    put("picture.log", b"\x89PNG\r\n\x1a\n\xff\xfe\x00");
    put("letter.log", b"Dear robot,\nhow are you?\n");
    put(
        "blind.log",
        b"ODOM 0 0 0 0 0 0 1 h 1\nODOM 1 0 0 0 0 0 2 h 2\n",
    );
    put("lone.log", b"FLASER 2 1 1 0 0 0 0 0 0 0 h 0\n");
    put("ranges.log", b"ODOM 0 0 0 0 0 0 1 h 1\nFLASER 5 1 1 1\n");
    put(
        "word.log",
        b"ODOM 0 0 0 0 0 0 1 h 1\nFLASER 2 1 far 0 0 0 0 0 0\n",
    );
    put("count.log", b"FLASER -3 1 1 0 0 0 0 0 0\n");
    put("tail.log", &whole.as_bytes()[..whole.len() - 2500]);
    fs::create_dir_all(dir.path().join("taken/ticks.csv")).unwrap();
    let cases: [(&[&str], &str); 16] = [
        (&["none.log"], "none.log: cannot be read"),
        (
            &["cut.log.gz"],
            "cut.log.gz: found a gzip file that is broken or cut short",
        ),
        (
            &["empty.log"],
            "empty.log: found nothing; allowed: a CARMEN log",
        ),
        (
            &["picture.log"],
            "picture.log:1: found bytes that are no text",
        ),
        (
            &["letter.log"],
            "letter.log: found 2 lines and no message of a robot",
        ),
        (&["blind.log"], "blind.log: found 2 ODOM lines and no scan"),
        (&["lone.log"], "lone.log: found a single message"),
        (
            &["ranges.log"],
            "ranges.log:2: found FLASER with 3 of 5 ranges",
        ),
        (
            &["word.log"],
            "word.log:2: found FLASER with `far` as word 4",
        ),
        (
            &["count.log"],
            "count.log:1: found FLASER with `-3` as word 2",
        ),
        (&["tail.log"], "where the file ends"),
        (
            &["whole.log", "--look", "0"],
            "allowed is a number from 0.5",
        ),
        (
            &["whole.log", "--body", "disc:9"],
            "--body disc:9: allowed: jackal",
        ),
        (
            &["whole.log", "--body", "polygon:1,1:-1,1"],
            "3 to 8 vertices",
        ),
        (&["whole.log", "--out", "empty.log"], "empty.log is a file"),
        (
            &["whole.log", "--out", "taken"],
            "--out taken/ticks.csv: cannot be written",
        ),
    ];
    for (arguments, part) in cases {
        let output = sim(dir.path()).args(arguments).assert().code(2);
        let text = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        assert!(text.contains(part), "{arguments:?}: {text}");
    }
    assert!(!dir.path().join("out").exists());
}
