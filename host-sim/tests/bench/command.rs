//! `host-sim bench` and `host-sim merge` from outside.

use assert_cmd::Command;
use predicates::prelude::*;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

pub fn sim(dir: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command.current_dir(dir);
    command
}

/// A short campaign of two controllers.
fn bench(dir: &Path, more: &[&str]) -> Command {
    bench_of(dir, "pure-pursuit,vfh", more)
}

fn bench_of(dir: &Path, controllers: &str, more: &[&str]) -> Command {
    let mut command = sim(dir);
    command
        .args(["bench", "--worlds", "generated:forest", "--numbers", "0-6"])
        .args([
            "--task",
            "goal",
            "--controllers",
            controllers,
            "--seeds",
            "2",
        ])
        .args(["--time-limit", "20"])
        .args(more);
    command
}

#[test]
fn parts_merge_into_what_one_run_writes() {
    let dir = tempdir().unwrap();
    bench(dir.path(), &["--json", "whole.json", "--threads", "1"])
        .assert()
        .success();
    for shard in ["0/3", "1/3", "2/3"] {
        let name = format!("part{}.json", &shard[..1]);
        bench(dir.path(), &["--json", &name, "--shard", shard])
            .assert()
            .success();
    }
    sim(dir.path())
        .args([
            "merge",
            "part2.json",
            "part0.json",
            "part1.json",
            "--json",
            "merged.json",
        ])
        .assert()
        .success()
        .stdout(predicate::str::contains("vfh"));
    let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    assert_eq!(read("merged.json"), read("whole.json"));

    let results: Value = serde_json::from_str(&read("whole.json")).unwrap();
    assert_eq!(results.as_array().unwrap().len(), 2);
    let vfh = &results[1];
    assert_eq!(vfh["controller"], "vfh");
    assert_eq!(vfh["runs"], 14);
    assert_eq!(vfh["per_world"].as_array().unwrap().len(), 7);
    let shares: f64 = ["success", "collision", "timeout", "blocked"]
        .iter()
        .map(|key| vfh[key].as_f64().unwrap())
        .sum();
    assert!((shares - 1.0).abs() < 1e-9);
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let dir = tempdir().unwrap();
    bench(dir.path(), &["--json", "a.json", "--shard", "0/2"])
        .assert()
        .success();
    bench(
        dir.path(),
        &["--json", "b.json", "--shard", "1/2", "--speed", "0.5"],
    )
    .assert()
    .success();
    bench(dir.path(), &["--json", "c.json"]).assert().success();
    fs::write(dir.path().join("d.json"), "[{\"controller\": \"vfh\"").unwrap();
    let cases: [(&[&str], &str); 5] = [
        (&["a.json"], "part 1/2 is missing"),
        (&["a.json", "a.json"], "a second time"),
        (&["a.json", "b.json"], "of another campaign"),
        (&["c.json"], "a whole campaign"),
        (&["d.json"], "d.json:1: found"),
    ];
    for (files, part) in cases {
        sim(dir.path())
            .arg("merge")
            .args(files)
            .args(["--json", "out.json"])
            .assert()
            .code(2)
            .stderr(predicate::str::contains(part));
    }
    assert!(!dir.path().join("out.json").exists());
}

#[test]
fn a_report_has_a_picture_and_a_replay_for_every_failed_run() {
    let dir = tempdir().unwrap();
    bench_of(
        dir.path(),
        "pure-pursuit",
        &["--json", "r.json", "--report", "report"],
    )
    .assert()
    .success();
    let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    let results: Value = serde_json::from_str(&read("r.json")).unwrap();
    let failed = results[0]["per_world"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|w| w["attempts"].as_array().unwrap())
        .filter(|a| a["ending"] != "reached")
        .count();
    assert!(failed > 0, "a blind robot got through every forest");
    let page = read("report/index.html");
    assert_eq!(page.matches("<svg").count(), failed);
    for link in page.split("href=\"runs/").skip(1) {
        let file = format!("runs/{}", link.split('"').next().unwrap());
        assert!(
            read(&format!("report/{file}")).contains("</html>"),
            "{file}"
        );
    }
    assert_eq!(read("report/per-world.csv").lines().count(), 8);
    assert!(read("report/table.txt").contains("pure-pursuit"));
}

#[test]
fn wrong_input_ends_with_2_and_one_message() {
    let dir = tempdir().unwrap();
    let world = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
    let ring = |radius: f64| -> String {
        let circles: Vec<String> = (0..40)
            .map(|k| {
                let turn = f64::from(k) / 40.0 * std::f64::consts::TAU;
                let (x, y) = (radius * turn.cos(), radius * turn.sin());
                format!("{{ at = [{x:.3}, {y:.3}], radius = 0.2 }}")
            })
            .collect();
        circles.join(", ")
    };
    world(
        "closed.toml",
        &format!(
            "start = [0, 0, 0]\ngoal = [5, 0]\ncircle = [{}]\n",
            ring(1.5)
        ),
    );
    world(
        "goal.toml",
        "start = [0, 0, 0]\ngoal = [5, 0]\ncircle = [{ at = [5.1, 0.0], radius = 0.3 }]\n",
    );
    world(
        "start.toml",
        "start = [0, 0, 0]\ngoal = [5, 0]\ncircle = [{ at = [0.3, 0.0], radius = 0.1 }]\n",
    );
    world("field.toml", "start = [0, 0, 0]\n\ngaol = [5, 0]\n");
    world(
        "radius.toml",
        "start = [0, 0, 0]\ngoal = [5, 0]\ncircle = [\n  { at = [3, 0], radius = -1 },\n]\n",
    );
    world(
        "false.toml",
        "start = [0, 0, 0]\ngoal = [5, 0]\nsealed = true\n",
    );
    world("extra.csv", "1,0.0,zero,0.1\n");
    let cases: [(&[&str], &str); 17] = [
        (&["--worlds", "closed.toml"], "world 0: no route from"),
        (
            &["--worlds", "goal.toml"],
            "the goal (5, 0) is inside the obstacle",
        ),
        (
            &["--worlds", "start.toml"],
            "the robot touches an obstacle where it starts",
        ),
        (
            &["--worlds", "field.toml"],
            "field.toml:3: found unknown field `gaol`",
        ),
        (
            &["--worlds", "radius.toml"],
            "radius.toml:4: found -1; allowed: a radius above 0",
        ),
        (
            &["--worlds", "false.toml"],
            "it is called sealed and has a route",
        ),
        (&["--worlds", "none.jsonl"], "cannot be read"),
        (
            &["--worlds", "generated:sea"],
            "the kind `sea`; allowed: barn, corridor",
        ),
        (
            &["--worlds", "generated:barn,fill=2"],
            "found `fill=2`; allowed: radius",
        ),
        (
            &["--numbers", "5-1"],
            "--numbers 5-1: allowed are all, dev, test",
        ),
        (&["--sensors", "cone7"], "unknown sensors `cone7`"),
        (&["--controllers", "vhf"], "unknown controller `vhf`"),
        (&["--shard", "3/3"], "--shard 3/3: allowed is i/n"),
        (&["--dead", "16"], "--dead 16: no such sensor"),
        (&["--drift", "2"], "--drift 2: allowed are two numbers"),
        (&["--task", "unmapped"], "--task unmapped: no cylinders"),
        (
            &["--task", "unmapped", "--unmapped", "extra.csv"],
            "extra.csv:1: found `1,0.0,zero,0.1`",
        ),
    ];
    for (arguments, part) in cases {
        let worlds: &[&str] = if arguments.contains(&"--worlds") {
            &[]
        } else {
            &["--worlds", "generated:forest", "--numbers", "1"]
        };
        let worlds = if arguments.contains(&"--numbers") {
            &worlds[..2]
        } else {
            worlds
        };
        let output = sim(dir.path())
            .arg("bench")
            .args(worlds)
            .args(arguments)
            .args(["--json", "out.json"])
            .assert()
            .code(2)
            .stderr(predicate::str::contains(part));
        let text = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        assert_eq!(text.trim_end().lines().count(), 1, "{text}");
    }
    assert!(!dir.path().join("out.json").exists());
}

#[test]
fn one_s_own_world_is_driven_and_a_sealed_one_is_no_error() {
    let dir = tempdir().unwrap();
    let text = "start = [0, 0, 90]\ngoal = [0, 5]\nwall = [{ from = [-1, 0], to = [-1, 5] }]\n\
                mover = [{ from = [3, 2], to = [4, 2], speed = 0.5, radius = 0.2 }]\n";
    fs::write(dir.path().join("own.toml"), text).unwrap();
    for (place, share) in [("own.toml", "100.0"), ("generated:sealed", "0.0")] {
        sim(dir.path())
            .args([
                "bench",
                "--worlds",
                place,
                "--numbers",
                "0",
                "--task",
                "goal",
            ])
            .args(["--controllers", "bendy", "--time-limit", "15"])
            .assert()
            .success()
            .stdout(predicate::str::contains(format!("┆ {share} ")));
    }
}
