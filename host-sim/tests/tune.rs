//! `host-sim fuzzy tune` from outside: what it finds, that it finds the same again, and what it refuses.

use assert_cmd::Command;
use host_sim::fuzzy::files::load;
use host_sim::fuzzy::model::{Conclusion, Shape, System};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::{TempDir, tempdir};

fn host_sim(folder: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command
        .current_dir(folder)
        .timeout(std::time::Duration::from_secs(300))
        .arg("fuzzy");
    command
}

fn tune(folder: &Path, args: &str) -> Command {
    let mut command = host_sim(folder);
    command.arg("tune").args(args.split_whitespace());
    command
}

fn design(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("designs")
        .join(name)
}

/// A folder with the fan's answers on a grid, and `detuned.fll`: the fan with its warm peak and two consequents elsewhere.
fn folder() -> TempDir {
    let folder = tempdir().unwrap();
    let fan = design("fan.fll");
    host_sim(folder.path())
        .args([
            "eval",
            fan.to_str().unwrap(),
            "--grid",
            "15",
            "--csv",
            "data.csv",
        ])
        .assert()
        .success();
    let text = fs::read_to_string(fan).unwrap();
    let detuned = text
        .replace("Ramp 24 18", "Ramp 28.5 18")
        .replace("Triangle 18 24 32", "Triangle 18 28.5 32")
        .replace("Ramp 24 32", "Ramp 28.5 32")
        .replace("mid Constant 40", "mid Constant 65")
        .replace("low Constant 0", "low Constant 12");
    assert_ne!(detuned, text);
    fs::write(folder.path().join("detuned.fll"), detuned).unwrap();
    folder
}

const FIT: &str = "detuned.fll --data data.csv --ignore fan¤(fixed)";

/// [`FIT`] and more; `¤` is a blank in an argument.
fn fit(folder: &Path, args: &str) -> Command {
    let mut command = host_sim(folder);
    let words = FIT.split_whitespace().chain(args.split_whitespace());
    command
        .arg("tune")
        .args(words.map(|word| word.replace('¤', " ")));
    command
}

fn report(folder: &Path, out: &str) -> Value {
    let text = fs::read_to_string(folder.join(out).join("report.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn constants(system: &System, output: usize) -> Vec<f64> {
    let terms = system.outputs[output].terms.iter();
    terms
        .map(|term| match term.conclusion {
            Conclusion::Constant(value) => value,
            ref other => panic!("{other:?}"),
        })
        .collect()
}

#[test]
fn a_known_design_is_found_again() {
    let folder = folder();
    fit(
        folder.path(),
        "--validate 0.2 --evaluations 1500 --out found",
    )
    .assert()
    .success()
    .stderr("");
    let tuned = load(&folder.path().join("found/tuned.fll"), None).unwrap();
    let Shape::Triangle { left, peak, right } = tuned.inputs[0].terms[1].shape else {
        panic!("a triangle stays one");
    };
    assert_eq!((left, right), (18.0, 32.0));
    assert!((peak - 24.0).abs() < 0.01, "{peak}");
    for (found, wanted) in constants(&tuned, 0).iter().zip([0.0, 40.0, 100.0]) {
        assert!((found - wanted).abs() < 0.05, "{found}, not {wanted}");
    }
    let head = fs::read_to_string(folder.path().join("found/tuned.fll")).unwrap();
    assert!(
        head.starts_with(
            "# fan: host-sim fuzzy tune detuned.fll --data data.csv --ignore 'fan (fixed)' --validate 0.2 --seed 1"
        ),
        "{head}"
    );
    let module = fs::read_to_string(folder.path().join("found/tuned.rs")).unwrap();
    host_sim(folder.path())
        .args(["convert", "found/tuned.fll", "--to", "rust"])
        .assert()
        .success()
        .stdout(module);
    let report = report(folder.path(), "found");
    assert_eq!(report["refused"], 0);
    for (fit, count) in report["fits"].as_array().unwrap().iter().zip([180, 45]) {
        assert_eq!(fit["count"], count);
        let cost = |when: &str| fit["cost"][when].as_f64().unwrap();
        assert!(cost("before") > 0.05 && cost("after") < 1e-4, "{fit}");
    }
    for file in ["memberships.svg", "memberships.png", "state.json"] {
        let size = fs::metadata(folder.path().join("found").join(file))
            .unwrap()
            .len();
        assert!(size > 1000, "{file}");
    }
}

#[test]
fn any_number_of_threads_and_any_break_give_the_same() {
    let folder = folder();
    let run = |args: &str, threads: &str| {
        fit(folder.path(), args)
            .env("RAYON_NUM_THREADS", threads)
            .assert()
            .success();
    };
    run("--evaluations 300 --out one", "1");
    run("--evaluations 300 --out two", "2");
    run("--evaluations 120 --out half", "2");
    run("--evaluations 300 --resume half/state.json --out rest", "2");
    let read = |out: &str, file: &str| fs::read_to_string(folder.path().join(out).join(file));
    for out in ["two", "rest"] {
        for file in ["tuned.fll", "state.json", "memberships.svg"] {
            assert_eq!(
                read(out, file).unwrap(),
                read("one", file).unwrap(),
                "{out}/{file}"
            );
        }
    }
    assert_eq!(
        read("one", "report.json").unwrap(),
        read("two", "report.json").unwrap()
    );
    let known = report(folder.path(), "rest")["known"].as_u64().unwrap();
    assert!((100..=120).contains(&known), "{known}");
    // Another seed searches elsewhere.
    run("--evaluations 300 --seed 2 --out other", "2");
    assert_ne!(
        read("other", "state.json").unwrap(),
        read("one", "state.json").unwrap()
    );
}

/// A design as MATLAB writes it: sets, a centroid from end to end, a name with a blank.
const TIPPER: &str = "\
[System]
Name='tipper'
Type='mamdani'
NumInputs=2
NumOutputs=1
NumRules=3
AndMethod='min'
OrMethod='max'
ImpMethod='min'
AggMethod='max'
DefuzzMethod='centroid'
[Input1]
Name='service'
Range=[0 10]
NumMFs=3
MF1='poor':'gaussmf',[1.5 0]
MF2='very good':'gaussmf',[1.5 5]
MF3='excellent':'gaussmf',[1.5 10]
[Input2]
Name='food quality'
Range=[0 10]
NumMFs=2
MF1='rancid':'trapmf',[0 0 1 3]
MF2='delicious':'trapmf',[7 9 10 10]
[Output1]
Name='tip'
Range=[0 30]
NumMFs=3
MF1='cheap':'trimf',[0 5 10]
MF2='average':'trimf',[10 15 20]
MF3='generous':'trimf',[20 25 30]
[Rules]
1 1, 1 (1) : 2
2 0, 2 (1) : 1
3 2, 3 (1) : 2
";

#[test]
fn a_design_of_matlabs_is_tuned_and_written_where_its_centroid_can_be_said() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("tipper.fis"), TIPPER).unwrap();
    let wanted = TIPPER.replace("[10 15 20]", "[8 13 18]");
    fs::write(here.join("wanted.fis"), wanted).unwrap();
    host_sim(here)
        .args(["eval", "wanted.fis", "--grid", "9", "--csv", "data.csv"])
        .assert()
        .success();
    let data = fs::read_to_string(here.join("data.csv")).unwrap();
    let data = data.replace("tip (fixed)", "fixed");
    fs::write(here.join("data.csv"), data).unwrap();
    let args = "tipper.fis --data data.csv --ignore fixed --only tip --evaluations 200 --out tuned";
    refused(
        here,
        tune(here, args),
        &[
            "FCL has no such name: the term `very good`",
            "(--adapt does that)",
        ],
    );
    let done = tune(here, &format!("{args} --adapt")).assert().success();
    let said = String::from_utf8(done.get_output().stderr.clone()).unwrap();
    for change in [
        "the variable `food quality` is now `food_quality`",
        "the term of `service` `very good` is now `very_good`",
    ] {
        assert!(said.contains(change), "{said}");
    }
    let report = report(here, "tuned");
    let cost = |when: &str| report["cost"][when].as_f64().unwrap();
    assert!(cost("after") < 0.5 * cost("before"), "{report}");
    // The file says what was judged: samples from end to end, and the same value at a point.
    let text = fs::read_to_string(here.join("tuned/tuned.fcl")).unwrap();
    assert!(text.contains("samples: 101 ends"), "{text}");
    let tuned = load(&here.join("tuned/tuned.fcl"), None).unwrap();
    assert_eq!(tuned.inputs[1].name, "food_quality");
    let module = fs::read_to_string(here.join("tuned/tuned.rs")).unwrap();
    host_sim(here)
        .args(["convert", "tuned/tuned.fcl", "--to", "rust"])
        .assert()
        .success()
        .stdout(module);
}

#[test]
fn rows_outside_of_the_ranges_are_counted() {
    let folder = folder();
    let here = folder.path();
    let text = fs::read_to_string(here.join("data.csv")).unwrap();
    let names = text.lines().next().unwrap();
    let row = |temperature: &str| {
        let of = |name: &str| match name {
            "temperature" => temperature.to_owned(),
            _ => "50".to_owned(),
        };
        names.split(',').map(of).collect::<Vec<_>>().join(",")
    };
    let rows = [row("-7"), row("20"), row("1000")].join("\n");
    fs::write(here.join("beyond.csv"), format!("{names}\n{rows}\n")).unwrap();
    let args = [
        "tune",
        "detuned.fll",
        "--ignore",
        "fan (fixed)",
        "--evaluations",
        "10",
    ];
    for (data, said) in [
        (
            "beyond.csv",
            "note: beyond.csv: 2 of 3 rows lie outside the inputs' ranges\n",
        ),
        ("data.csv", ""),
    ] {
        let mut command = host_sim(here);
        command.args(args).args(["--data", data, "--out", "tuned"]);
        let output = command.assert().success();
        let errors = String::from_utf8(output.get_output().stderr.clone()).unwrap();
        assert_eq!(errors, said);
    }
}

#[test]
fn what_is_fixed_stays() {
    let folder = folder();
    fit(
        folder.path(),
        "--only fan --fix fan.mid --evaluations 200 --out only",
    )
    .assert()
    .success();
    let before = load(&folder.path().join("detuned.fll"), None).unwrap();
    let after = load(&folder.path().join("only/tuned.fll"), None).unwrap();
    assert_eq!(
        before.without_places().inputs,
        after.clone().without_places().inputs
    );
    let [low, mid, _] = constants(&after, 0)[..] else {
        panic!("three terms");
    };
    assert!(mid == 65.0 && low < 12.0, "{low} {mid}");
}

#[test]
fn the_follower_drives_better_and_its_distance_stays_evenly_divided() {
    let folder = tempdir().unwrap();
    let fine = design("fine.fll");
    tune(
        folder.path(),
        &format!(
            "{} --scenario line-offset,line --evaluations 45 --out drive",
            fine.display()
        ),
    )
    .assert()
    .success();
    let report = report(folder.path(), "drive");
    let cost = |when: &str| report["cost"][when].as_f64().unwrap();
    assert!(cost("after") < 0.98 * cost("before"), "{report}");
    assert_eq!(report["drives"].as_array().unwrap().len(), 2);
    for change in report["changed"].as_array().unwrap() {
        let variable = change["variable"].as_str().unwrap();
        assert!(["d", "speed", "deflection"].contains(&variable), "{change}");
    }
    // d's peaks as far apart from each other as from zero, and nearer than they were.
    let tuned = load(&folder.path().join("drive/tuned.fll"), None).unwrap();
    let d = &tuned.inputs.iter().find(|input| input.name == "d").unwrap();
    let peaks: Vec<f64> = d.terms[1..4]
        .iter()
        .map(|term| match term.shape {
            Shape::Triangle { peak, .. } => peak,
            ref other => panic!("{other:?}"),
        })
        .collect();
    assert!(peaks[0] > 0.25 && peaks[0] < 1.0, "{peaks:?}");
    assert_eq!(peaks[1..], [2.0 * peaks[0], 3.0 * peaks[0]]);
    // So even that a module takes the quickest route, and that it drives on from there.
    let module = fs::read_to_string(folder.path().join("drive/tuned.rs")).unwrap();
    assert!(module.contains("TwinTable"), "{module}");
    let again = "drive/tuned.fll --scenario line --evaluations 11 --out again";
    tune(folder.path(), again).assert().success();
    // A wish that holds d still does.
    let still = format!(
        "{} --scenario line --fix d --evaluations 10 --out still",
        fine.display()
    );
    tune(folder.path(), &still).assert().success();
    let tuned = load(&folder.path().join("still/tuned.fll"), None).unwrap();
    let before = load(&fine, None).unwrap();
    let shapes = |system: &System| -> Vec<Shape> {
        let terms = system.inputs.iter().flat_map(|input| &input.terms);
        terms.map(|term| term.shape.clone()).collect()
    };
    assert_eq!(shapes(&tuned), shapes(&before));
}

/// Runs it, expects exit code 2 and every one of `parts` on stderr, and that the folder stays as it was.
fn refused(folder: &Path, mut command: Command, parts: &[&str]) {
    let names = || -> Vec<_> {
        fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name())
            .collect()
    };
    let before = names();
    let output = command.assert().code(2).stdout("");
    let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    for part in parts {
        assert!(said.contains(part), "`{part}` not in {said}");
    }
    assert_eq!(names(), before, "{said} left something behind");
}

#[test]
fn bad_data_is_refused_where_it_is_bad() {
    let folder = tempdir().unwrap();
    let good = "temperature,humidity,fan\n20,40,5\n";
    let cases: [(&[u8], &[&str]); 20] = [
        (b"", &["bad.csv: the file is empty", "a line of names"]),
        (b"\n\n\n", &["the file is empty"]),
        (b"temperature,humidity,fan\n", &["there is no row"]),
        (
            b"20,40,5\n21,40,5\n",
            &["bad.csv:1: column 1", "`20`", "temperature, humidity, fan"],
        ),
        (
            b"temperature;humidity;fan\n20;40;5\n",
            &["`temperature;humidity;fan`"],
        ),
        (
            b"temperature,damp,fan\n20,40,5\n",
            &["bad.csv:1: column 2", "`damp`", "--ignore"],
        ),
        (
            b"temperature,fan\n20,5\n",
            &["bad.csv:1", "the input `humidity` has no column"],
        ),
        (
            b"temperature,humidity\n20,40\n",
            &["no output has a column"],
        ),
        (
            b"temperature,humidity,fan,fan\n20,40,5,5\n",
            &["column 4", "`fan` a second time"],
        ),
        (
            b"temperature,humidity,fan\n20,40,5\n21,,6\n",
            &["bad.csv:3: column 2 (humidity): found nothing"],
        ),
        (
            b"temperature,humidity,fan\n20,40,NaN\n",
            &["bad.csv:2: column 3 (fan): found `NaN`", "a number"],
        ),
        (
            b"temperature,humidity,fan\n20,-inf,5\n",
            &["column 2 (humidity): found `-inf`"],
        ),
        (
            b"temperature,humidity,fan\n20,1e300,5\n",
            &["found `1e300`", "up to 1e15"],
        ),
        (
            b"temperature,humidity,fan\n20,forty,5\n",
            &["found `forty`"],
        ),
        (
            b"temperature,humidity,fan\n20,40\n",
            &["bad.csv:2: the number of fields is 2", "allowed is 3"],
        ),
        (
            b"temperature,humidity,fan\n20,40,5,\n",
            &["bad.csv:2: the number of fields is 4"],
        ),
        (
            b"temperature,humidity,fan\n20,5,40,5,5\n",
            &["the number of fields is 5"],
        ),
        (
            b"temperature,humidity,fan\n20,\"40,5\n21,40,5\n",
            &["bad.csv:2: the number of fields is 2"],
        ),
        (
            b"temperature,hum\xff,fan\n20,40,5\n",
            &["bad.csv:1: column 2", "UTF-8"],
        ),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", &["bad.csv:1: column 1"]),
    ];
    for (text, parts) in cases {
        fs::write(folder.path().join("bad.csv"), text).unwrap();
        let fan = design("fan.fll");
        let command = tune(folder.path(), &format!("{} --data bad.csv", fan.display()));
        refused(folder.path(), command, parts);
    }
    // The same with good data does something.
    fs::write(folder.path().join("bad.csv"), good).unwrap();
    let fan = design("fan.fll");
    tune(
        folder.path(),
        &format!("{} --data bad.csv --evaluations 10", fan.display()),
    )
    .assert()
    .success();
}

#[test]
fn bad_wishes_are_refused() {
    let folder = folder();
    let here = folder.path();
    fit(here, "--evaluations 20 --out begun").assert().success();
    fs::write(here.join("text.json"), "{\"form\": 1}").unwrap();
    let fine = design("fine.fll");
    for (args, parts) in [
        (
            "--only wind",
            &["--only wind", "temperature, humidity, fan"][..],
        ),
        (
            "--only ,",
            &["--only: found an empty name; allowed are temperature, "],
        ),
        (
            "--fix fan.none",
            &[
                "--fix fan.none: `fan` has no term `none`; allowed are fan.",
                ", fan.mid, ",
            ],
        ),
        (
            "--only humidity",
            &[
                "--only humidity: no number can move (knots at the ends of a range or beyond stay);",
                "; what can is temperature",
            ],
        ),
        (
            "--only fan.mid --fix fan",
            &["--only fan.mid and --fix fan: no number can move"],
        ),
        ("--validate 0.9999", &["allowed is a number from 0 to 0.9"]),
        ("--sigma nan", &["allowed is a number from"]),
        ("--evaluations 0", &["allowed is a whole number"]),
        (
            "--evaluations 3",
            &["--evaluations 3: less than one generation; allowed is"],
        ),
        (
            "--resume none.json",
            &["--resume none.json", "cannot be read"],
        ),
        (
            "--resume text.json",
            &["--resume text.json", "allowed is a state"],
        ),
        ("--resume begun/state.json --seed 2", &["another --seed"]),
        (
            "--resume begun/state.json --only fan",
            &["another --only or --fix"],
        ),
        (
            "--resume begun/state.json --validate 0.5",
            &["another objective"],
        ),
        ("--out data.csv", &["--out data.csv", "is a file"]),
        ("--scenario line", &["cannot be used with"]),
    ] {
        refused(here, fit(here, args), parts);
    }
    for (args, parts) in [
        ("detuned.fll".to_owned(), &["--data", "--scenario"][..]),
        (
            "detuned.fll --data none.csv".to_owned(),
            &["none.csv: cannot be read"],
        ),
        (
            "detuned.fll --scenario line".to_owned(),
            &["detuned.fll: no design for the robot's follower"],
        ),
        (
            format!("{} --scenario nowhere", fine.display()),
            &["unknown scenario `nowhere`"],
        ),
        (
            format!("{} --scenario line --only phi", fine.display()),
            &[
                "--only phi: no number can move",
                "all inputs but d); what can is d, ",
            ],
        ),
    ] {
        refused(here, tune(here, &args), parts);
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_search_leaves_what_it_has_and_goes_on() {
    let folder = folder();
    let here = folder.path();
    // So much to judge that the signal comes long before the end.
    let fan = design("fan.fll");
    host_sim(here)
        .args([
            "eval",
            fan.to_str().unwrap(),
            "--grid",
            "150",
            "--csv",
            "data.csv",
        ])
        .assert()
        .success();
    let args = "--evaluations 1000000 --sigma 0.5 --validate 0.1 --out stopped";
    let words = FIT.split_whitespace().chain(args.split_whitespace());
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("host-sim"))
        .current_dir(here)
        .args(["fuzzy", "tune"])
        .args(words.map(|word| word.replace('¤', " ")))
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let state = here.join("stopped/state.json");
    let begun = std::time::Instant::now();
    while !state.exists() && begun.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let process = child.id().to_string();
    let mut kill = std::process::Command::new("kill");
    assert!(kill.args(["-INT", &process]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    load(&here.join("stopped/tuned.fll"), None).unwrap();
    let report = report(here, "stopped");
    assert_eq!(report["stopped"], "interrupted");
    let judged = report["candidates"].as_u64().unwrap();
    let more = format!(
        "--evaluations {} --sigma 0.5 --validate 0.1 --resume stopped/state.json --out on",
        judged + 20
    );
    fit(here, &more).assert().success();
}

#[test]
fn results_do_not_take_the_place_of_what_is_read() {
    let folder = folder();
    let here = folder.path();
    fs::create_dir(here.join("made")).unwrap();
    fs::copy(here.join("detuned.fll"), here.join("made/tuned.fll")).unwrap();
    fs::copy(here.join("data.csv"), here.join("made/report.json")).unwrap();
    fs::hard_link(here.join("data.csv"), here.join("made/memberships.png")).unwrap();
    let refused = |args: &str, what: &str| {
        let args = format!("{args} --ignore fan¤(fixed) --evaluations 20 --out made");
        let args: Vec<String> = args
            .split_whitespace()
            .map(|a| a.replace('¤', " "))
            .collect();
        let mut command = host_sim(here);
        let output = command.arg("tune").args(args).assert().code(2).stdout("");
        let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
        assert!(said.contains(&format!("{what} that is read")), "{said}");
        assert!(!here.join("made/state.json").exists());
    };
    refused("made/tuned.fll --data data.csv", "the design");
    refused("detuned.fll --data made/report.json", "the data");
    refused("detuned.fll --data data.csv", "the data");
    fs::remove_file(here.join("made/memberships.png")).unwrap();
    // The state alone is gone on from in its place.
    tune(
        here,
        "detuned.fll --data made/report.json --evaluations 20 --out other",
    )
    .args(["--ignore", "fan (fixed)"])
    .assert()
    .success();
    tune(
        here,
        "detuned.fll --data made/report.json --evaluations 40 --out other",
    )
    .args(["--ignore", "fan (fixed)", "--resume", "other/state.json"])
    .assert()
    .success();
}
