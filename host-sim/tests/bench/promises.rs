//! What the navigator promises in generated worlds, none of which any number was tuned on: how often it arrives, that it
//! touches nothing, and how near it keeps to a route. The worlds are few, so that a bar here is somewhat below what
//! docs/bench.md shows.

use crate::command::sim;
use serde_json::Value;
use std::fs;
use tempfile::tempdir;

fn ours(arguments: &[&str]) -> Value {
    let dir = tempdir().unwrap();
    sim(dir.path())
        .args(["bench", "--controllers", "ours", "--json", "results.json"])
        .args(arguments)
        .assert()
        .success();
    let text = fs::read_to_string(dir.path().join("results.json")).unwrap();
    let results: Value = serde_json::from_str(&text).unwrap();
    results[0].clone()
}

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap()
}

/// Success, collisions, score of 40 worlds.
fn campaign(arguments: &[&str]) -> [f64; 3] {
    let worlds = ["--worlds", "generated:barn", "--numbers", "100-139"];
    let results = ours(&[&worlds[..], arguments].concat());
    assert_eq!(number(&results, "runs"), 40.0);
    ["success", "collision", "score"].map(|name| number(&results, name))
}

#[test]
fn to_a_goal_through_clutter() {
    let [success, collision, score] = campaign(&["--task", "goal"]);
    assert!(
        success >= 0.975 && collision == 0.0,
        "{success} {collision}"
    );
    assert!((0.42..=0.5).contains(&score), "{score}");
}

#[test]
fn along_a_path_at_three_speeds() {
    for speed in ["1", "1.5", "2"] {
        let [success, collision, score] = campaign(&["--task", "path", "--speed", speed]);
        assert!(
            success >= 0.975 && collision == 0.0,
            "{speed}: {success} {collision}"
        );
        assert!((0.48..=0.5).contains(&score), "{speed}: {score}");
    }
}

#[test]
fn around_what_the_path_does_not_know() {
    let unmapped = ["--task", "unmapped", "--unmapped", "generated"];
    let [success, collision, score] = campaign(&unmapped);
    assert!(
        success >= 0.925 && collision == 0.0,
        "{success} {collision}"
    );
    assert!((0.35..=0.5).contains(&score), "{score}");
}

/// Both worlds have a pocket that is too narrow to turn in.
#[test]
fn a_pocket_is_left_the_way_it_was_entered() {
    let pockets = ["--worlds", "generated:barn", "--numbers", "34,337"];
    let results = ours(&[&pockets[..], &["--task", "goal", "--seeds", "2"]].concat());
    assert_eq!(number(&results, "success"), 1.0, "{results}");
}

/// Nothing is seen behind: who backs where he never looked touches the wall in a fifth of these.
#[test]
fn who_is_shut_in_says_so() {
    for (kind, most) in [("sealed", 0.0), ("closed", 0.08)] {
        let place = format!("generated:{kind}");
        let results = ours(&["--worlds", &place, "--numbers", "0-79", "--task", "goal"]);
        let [touched, blocked] = ["collision", "blocked"].map(|name| number(&results, name));
        assert!(touched <= most, "{kind}: {touched}");
        assert!(blocked >= 0.97 - most, "{kind}: {blocked}");
        assert_eq!(number(&results, "stalls"), 0.0, "{kind}");
    }
}

#[test]
fn routes_are_kept_to() {
    let results = ours(&["--worlds", "generated:routes", "--task", "path"]);
    let worlds = results["per_world"].as_array().unwrap();
    assert_eq!(worlds.len(), 8);
    for world in worlds {
        let route = world["route"].as_str().unwrap();
        for stretch in world["tracking"].as_array().unwrap() {
            let rms = number(stretch, "rms_m");
            let most = match route {
                "corner" => 0.02,
                "pass" => 0.3,
                _ => 0.005,
            };
            assert!(rms <= most, "{route}: {rms}");
            if route == "pass" {
                let after = number(&stretch["pass"], "regained_after_m");
                assert!(after <= 1.5, "{after}");
            }
        }
    }
}
