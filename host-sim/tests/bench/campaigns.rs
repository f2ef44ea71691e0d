//! Campaigns that say more than a mean: dead sensors one by one, what trouble costs, stalls, routes of known shape, bodies.

use crate::command::sim;
use host_sim::bench::arena::{Arena, Circle};
use host_sim::bench::attempt::{Ending, Outcome, Setting, drive};
use host_sim::bench::body::{Body, JACKAL};
use host_sim::bench::discs::Discs;
use host_sim::bench::navigator::{Command, Inputs, Mode, Navigator};
use host_sim::bench::sensors;
use host_sim::bench::tracking::{Tracked, Tracking};
use host_sim::bench::worlds::load;
use host_sim::bench::worlds::numbers::Numbers;
use predicates::prelude::*;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

fn results(dir: &Path, arguments: &[&str]) -> Value {
    sim(dir)
        .arg("bench")
        .args(arguments)
        .args(["--json", "results.json"])
        .assert()
        .success();
    let text = fs::read_to_string(dir.join("results.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

const DEAD: [&str; 12] = [
    "--worlds",
    "generated:barn",
    "--numbers",
    "0-3",
    "--task",
    "goal",
    "--controllers",
    "vfh",
    "--sensors",
    "cones:4:180:45",
    "--dead",
    "each",
];

#[test]
fn of_dead_sensors_the_worst_is_named_and_not_their_mean() {
    let dir = tempdir().unwrap();
    let arguments = [&DEAD[..], &["--seeds", "4", "--time-limit", "20"]].concat();
    let whole = results(dir.path(), &arguments);
    let vfh = &whole[0];
    let sensors = vfh["dead_sensors"]["sensors"].as_array().unwrap();
    assert_eq!(sensors.len(), 4);
    let attempts: Vec<&Value> = vfh["per_world"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|w| w["attempts"].as_array().unwrap())
        .collect();
    for (k, sensor) in sensors.iter().enumerate() {
        // A dead sensor's runs are those of the seeds that are its number, modulo four.
        let own = attempts.iter().filter(|a| a["seed"] == k);
        let reached = own.filter(|a| a["ending"] == "reached").count();
        assert_eq!(sensor["sensor"], k);
        assert_eq!(sensor["runs"], 4);
        assert_eq!(number(&sensor["success"]), reached as f64 / 4.0);
    }
    let least = sensors
        .iter()
        .map(|s| number(&s["success"]))
        .fold(1.0, f64::min);
    let worst = &vfh["dead_sensors"]["worst"];
    assert_eq!(number(&worst["success"]), least);
    assert!(least < number(&vfh["success"]), "all alike: choose others");
    let lost = number(&vfh["sound"]["success"]) - least;
    assert!((number(&worst["lost_success"]) - lost).abs() < 1e-12);

    // The parts know as much as the whole.
    for shard in ["0/2", "1/2"] {
        let file = format!("part{}.json", &shard[..1]);
        sim(dir.path())
            .arg("bench")
            .args(&arguments)
            .args(["--shard", shard, "--json", &file])
            .assert()
            .success();
    }
    let name = number(&worst["sensor"]);
    sim(dir.path())
        .args(["merge", "part0.json", "part1.json", "--json", "merged.json"])
        .assert()
        .success()
        .stdout(predicate::str::contains(format!("worst: sensor {name}, ")));
    let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    assert_eq!(read("merged.json"), read("results.json"));
}

/// Five metres of open ground.
fn open_world(dir: &Path) {
    let text = "start = [0, 0, 0]\ngoal = [5, 0]\ngoal-radius = 0.1\n";
    fs::write(dir.join("open.toml"), text).unwrap();
}

#[test]
fn drift_is_judged_by_truth_or_belief_and_its_cost_is_said() {
    let dir = tempdir().unwrap();
    open_world(dir.path());
    let run = |more: &[&str]| {
        let common = ["--worlds", "open.toml", "--task", "goal", "--seeds", "8"];
        let rest = ["--controllers", "pure-pursuit", "--drift", "20,0", "--cost"];
        results(dir.path(), &[&common[..], &rest[..], more].concat())
    };
    let truth = run(&["--time-limit", "20"]);
    let belief = run(&["--time-limit", "20", "--arrival", "belief"]);
    // Odometry that is off by a fifth stops somewhere else, and believes to be there.
    assert!(number(&truth[0]["success"]) < 0.5);
    assert_eq!(number(&belief[0]["success"]), 1.0);
    for result in [&truth, &belief] {
        let sound = &result[0]["sound"];
        assert_eq!(number(&sound["success"]), 1.0);
        let lost = 1.0 - number(&result[0]["success"]);
        assert!((number(&sound["lost_success"]) - lost).abs() < 1e-12);
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let dir = tempdir().unwrap();
    open_world(dir.path());
    let cases: [(&[&str], &str); 9] = [
        (&["--cost"], "--cost: nothing goes wrong"),
        (
            &["--dead", "each", "--seeds", "15"],
            "--seeds 15 leave sensors untried",
        ),
        (
            &["--worlds", "generated:routes", "--task", "goal"],
            "are to be followed",
        ),
        (
            &["--worlds", "generated:routes", "--numbers", "3,8"],
            "found route 8; allowed: 0 to 7",
        ),
        (
            &["--worlds", "generated:routes,radius=1"],
            "no option of routes",
        ),
        (
            &["--body", "square:1"],
            "--body square:1: allowed: jackal, rectangle",
        ),
        (
            &["--body", "rectangle:0.5"],
            "--body rectangle:0.5: allowed",
        ),
        (&["--body", "disc:nan"], "--body disc:nan: allowed"),
        // Clockwise.
        (
            &["--body", "polygon:0.2,0.2:0.2,-0.2:-0.2,0"],
            "counter-clockwise",
        ),
    ];
    for (arguments, part) in cases {
        let worlds: &[&str] = if arguments.contains(&"--worlds") {
            &[]
        } else {
            &["--worlds", "open.toml"]
        };
        sim(dir.path())
            .arg("bench")
            .args(worlds)
            .args(arguments)
            .args(["--controllers", "vfh", "--json", "out.json"])
            .assert()
            .code(2)
            .stderr(predicate::str::contains(part));
    }
    assert!(!dir.path().join("out.json").exists());
}

/// Does what a function of time says.
struct Timed<F: FnMut(f64) -> Command>(F);

impl<F: FnMut(f64) -> Command> Navigator for Timed<F> {
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command {
        (self.0)(inputs.time)
    }
}

fn straight(speed: f64, mode: Mode) -> Command {
    Command {
        speed,
        yaw_rate: 0.0,
        mode,
    }
}

fn route(number: u32) -> Arena {
    let numbers = Numbers::parse(&number.to_string()).unwrap();
    load("generated:routes", &numbers, &JACKAL)
        .unwrap()
        .remove(0)
}

fn run(arena: &Arena, limit: f64, command: impl FnMut(f64) -> Command) -> (Outcome, Vec<Tracked>) {
    let mut setting = Setting::new(sensors::named("cone8").unwrap(), 1.0, true);
    setting.time_limit = limit;
    let course = arena.course.clone().unwrap();
    let mut tracking = Tracking::new(&course);
    let outcome = drive(
        arena,
        &Discs::new(&arena.circles),
        &setting,
        0,
        &mut Timed(command),
        &mut |step| tracking.see(step),
    );
    (outcome, tracking.finish())
}

#[test]
fn every_place_that_is_kept_for_more_than_five_seconds_is_a_stall() {
    // Seven seconds here, a second of driving, seven seconds there.
    let go = |time: f64| (7.0..8.0).contains(&time);
    let twice = |mode: Mode| move |t: f64| straight(f64::from(u8::from(go(t))), mode);
    let (silent, _) = run(&route(0), 15.0, twice(Mode::Avoid));
    assert_eq!(silent.stalls, 2);
    let (reported, _) = run(&route(0), 15.0, move |t| {
        let mode = if go(t) { Mode::Avoid } else { Mode::Blocked };
        straight(f64::from(u8::from(go(t))), mode)
    });
    assert_eq!((reported.stalls, reported.longest_stall_s < 2.0), (0, true));
    // Four seconds at a time are none.
    let (short, _) = run(&route(0), 15.0, |t| {
        straight(if t % 5.0 < 4.0 { 0.0 } else { 1.0 }, Mode::Avoid)
    });
    assert_eq!(short.stalls, 0);
}

#[test]
fn distance_from_a_route_is_what_it_is() {
    let mut beside = route(0);
    beside.start[1] = 0.03;
    let (outcome, tracked) = run(&beside, 30.0, |_| straight(1.0, Mode::Follow));
    assert_eq!(outcome.ending, Ending::Reached);
    assert_eq!((tracked.len(), tracked[0].stretch.as_str()), (1, "whole"));
    assert!((tracked[0].rms_m - 0.03).abs() < 1e-9 && (tracked[0].max_m - 0.03).abs() < 1e-9);

    // Behind the corner, 4 cm outside of it: the approach knows nothing of that.
    let mut corner = route(6);
    corner.start = [5.04, 1.0, std::f64::consts::FRAC_PI_2];
    let (_, tracked) = run(&corner, 30.0, |_| straight(1.0, Mode::Follow));
    let [approach, exit] = &tracked[..] else {
        panic!("{tracked:?}");
    };
    assert_eq!((&*approach.stretch, &*exit.stretch), ("approach", "exit"));
    assert!(
        approach.max_m == 0.0 && (exit.rms_m - 0.04).abs() < 1e-9,
        "{tracked:?}"
    );

    // Past the cylinder without it: on the route at once, and never.
    let mut pass = route(7);
    pass.circles = vec![Circle {
        at: [4.0, 3.0],
        radius: 0.1,
    }];
    for (left, after) in [(0.0, Some(0.0)), (0.2, None)] {
        pass.start[1] = left;
        let (_, tracked) = run(&pass, 30.0, |_| straight(1.0, Mode::Follow));
        assert_eq!(tracked[0].pass.unwrap().regained_after_m, after);
    }
}

#[test]
fn routes_are_the_shapes_that_they_are_called() {
    let routes = load("generated:routes", &Numbers::All, &JACKAL).unwrap();
    let names: Vec<&str> = routes
        .iter()
        .map(|a| a.course.as_ref().unwrap().name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "line",
            "arc-r5",
            "arc-r2",
            "arc-r1",
            "s-r1.5",
            "dual-semicircle-r8",
            "corner",
            "pass"
        ]
    );
    let pi = std::f64::consts::PI;
    let lengths = [
        10.0,
        5.0 * pi,
        3.0 * pi,
        1.5 * pi,
        3.0 * pi,
        16.0 * pi,
        10.0,
        10.0,
    ];
    for (arena, length) in routes.iter().zip(lengths) {
        assert!((arena.route_length() - length).abs() < 1e-3, "{arena:?}");
        let steps = arena.route.windows(2);
        let longest = steps.map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
        assert!(longest.fold(0.0, f64::max) < 0.0201);
        // Everything begins at the origin along x.
        assert!(arena.start.iter().all(|x| x.abs() < 1e-12));
    }
}

#[test]
fn the_library_s_navigator_keeps_to_a_line_and_its_routes_are_reported() {
    let dir = tempdir().unwrap();
    let arguments = ["--worlds", "generated:routes", "--task", "path"];
    let ours = ["--numbers", "0,6", "--controllers", "ours"];
    let found = results(dir.path(), &[&arguments[..], &ours[..]].concat());
    let worlds = found[0]["per_world"].as_array().unwrap();
    assert_eq!(worlds[0]["route"], "line");
    assert!(number(&worlds[0]["tracking"][0]["rms_m"]) <= 0.005);
    assert_eq!(worlds[1]["tracking"][0]["stretch"], "approach");
    assert_eq!(worlds[1]["tracking"][1]["stretch"], "exit");
}

#[test]
fn a_body_is_the_shape_that_it_is_called() {
    let dir = tempdir().unwrap();
    let run = |controller: &str, body: &str| {
        let worlds = ["--worlds", "generated:forest", "--numbers", "0-5"];
        let task = ["--task", "goal", "--controllers", controller];
        results(
            dir.path(),
            &[&worlds[..], &task[..], &["--body", body]].concat(),
        )[0]
        .clone()
    };
    let rectangle = run("rpp", "rectangle:0.508x0.430");
    let polygon = run(
        "rpp",
        "polygon:0.254,0.215:-0.254,0.215:-0.254,-0.215:0.254,-0.215",
    );
    let [slim, broad] = ["disc:0.1", "disc:0.25"].map(|body| run("vfh", body));
    for key in ["success", "collision", "median_min_clearance_m"] {
        let [a, b] = [&rectangle, &polygon].map(|r| number(&r[key]));
        assert!((a - b).abs() < 1e-9, "{key}: {a} {b}");
    }
    // Who sees it as a circle of its own drives alike with both: the slimmer one stays that much clearer.
    let [slim_room, broad_room] = [&slim, &broad].map(|r| number(&r["median_min_clearance_m"]));
    assert!(slim_room > broad_room + 0.05, "{slim_room} {broad_room}");
    assert_eq!(slim["body"], "disc:0.1");
    assert_eq!(Body::parse("jackal").unwrap(), JACKAL);
}
