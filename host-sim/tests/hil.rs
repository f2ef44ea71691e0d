//! Hardware in the loop from outside: the same ticks as without, faults on the wire, robots that die, restart or are
//! others than they should be. Against the pilot in this process always, over a pseudo-terminal on Unix, and against the
//! firmware in QEMU where both are there.

use assert_cmd::Command;
use fuzzypilot::link::frame::{Decoder, MAX_FRAME, encode};
use fuzzypilot::link::message::{Cause, ToHost, ToTarget};
use host_sim::hil::fault::{Fault, Faulty};
use host_sim::hil::hostile::{MOST_GOOD, attack};
use host_sim::hil::local::Local;
use host_sim::hil::wire::Wire;
use host_sim::hil::{Driven, Outage};
use host_sim::run::{Ending, Gap, Period, simulate};
use host_sim::scenario::{BUILT_IN, Scenario, load};
use host_sim::ticks;
use std::cell::Cell;
use std::fs;
use std::path::Path;
use std::rc::Rc;
use std::time::{Duration, Instant};
use tempfile::tempdir;

/// What a `run` writes, and a run with hardware in the loop besides.
const RESULTS: [&str; 6] = [
    "link.json",
    "replay.html",
    "run.png",
    "run.svg",
    "summary.json",
    "ticks.csv",
];

fn sim(dir: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command.current_dir(dir).timeout(Duration::from_secs(300));
    command
}

fn names(dir: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(dir) else {
        return Vec::new();
    };
    let names = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

fn json(file: impl AsRef<Path>) -> serde_json::Value {
    serde_json::from_slice(&fs::read(file).unwrap()).unwrap()
}

/// A robot that cannot be used (any more) is named within two seconds: the complaints tell how long was waited, 1200 ms at
/// most. This is only so that a hang is seen: a busy machine may take seconds to start the program and to draw.
const IN_TIME: Duration = Duration::from_millis(8000);

/// The one line that it said on stderr.
fn complaint(output: &std::process::Output) -> String {
    let said = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.len() < 400, "{said}");
    said
}

// ---- a robot without a wire ----

/// A run, and what was seen of it.
struct Seen {
    driven: Driven,
    rows: Vec<Vec<String>>,
    /// The ticks' times.
    times: Vec<f64>,
    gaps: Vec<Gap>,
}

fn drive(scenario: &Scenario, seed: u64, faults: &[&str], rearm: Option<u32>) -> Seen {
    let faults: Vec<Fault> = faults.iter().map(|f| f.parse().unwrap()).collect();
    let mut wire: Box<dyn Wire> = Box::new(Local::new());
    if !faults.is_empty() {
        wire = Box::new(Faulty::new(wire, faults, seed));
    }
    let (mut rows, mut times, mut gaps) = (Vec::new(), Vec::new(), Vec::new());
    let driven = host_sim::hil::run(scenario, seed, wire, rearm, &mut |period| match period {
        Period::Tick(step) => {
            rows.push(ticks::row(step.record));
            times.push(step.time);
        }
        Period::Gap(gap) => gaps.push(*gap),
    });
    Seen {
        driven: driven.unwrap_or_else(|e| panic!("{e}")),
        rows,
        times,
        gaps,
    }
}

fn rows(scenario: &Scenario, seed: u64) -> (Vec<Vec<String>>, Ending) {
    let mut rows = Vec::new();
    let ending = simulate(scenario, seed, &mut |step| {
        rows.push(ticks::row(step.record));
    });
    (rows, ending.unwrap())
}

#[test]
fn every_built_in_has_the_same_ticks_over_the_link() {
    for (name, _) in BUILT_IN {
        let scenario = load(name).unwrap();
        let (expected, ending) = rows(&scenario, 7);
        let seen = drive(&scenario, 7, &[], None);
        assert!(seen.rows == expected, "{name}");
        assert_eq!(seen.driven.ending, ending, "{name}");
        assert!(
            seen.driven.outage.is_none() && seen.gaps.is_empty(),
            "{name}"
        );
        let report = &seen.driven.report;
        assert_eq!(report.ticks, expected.len() as u64, "{name}");
        assert_eq!(
            (report.lost_ticks, report.retries, report.late),
            (0, 0, 0),
            "{name}"
        );
    }
}

#[test]
fn it_writes_what_run_writes_and_a_link_report() {
    let dir = tempdir().unwrap();
    let dir = dir.path();
    for (name, variant) in [
        ("cones", &[][..]),
        ("line", &["--law", "paper", "--odometry", "noisy"]),
    ] {
        let common = [&["--seed", "5"][..], variant].concat();
        sim(dir)
            .args(["run", name, "--out", "run"])
            .args(&common)
            .assert()
            .success();
        let mut hil = sim(dir);
        hil.args(["hil", "--local", "--scenario", name, "--out", "hil"])
            .args(&common);
        let said = hil
            .assert()
            .success()
            .stderr("")
            .get_output()
            .stdout
            .clone();
        let said = String::from_utf8(said).unwrap();
        for part in ["× real time", "round trips", "0 lost", "written: hil"] {
            assert!(said.contains(part), "{part}: {said}");
        }
        assert_eq!(names(&dir.join("hil")), RESULTS);
        for file in names(&dir.join("run")) {
            let [run, hil] = ["run", "hil"].map(|out| fs::read(dir.join(out).join(&file)).unwrap());
            assert!(run == hil, "{name}: {file}");
        }
        let link = json(dir.join("hil/link.json"));
        assert_eq!(link["firmware"], env!("CARGO_PKG_VERSION"));
        assert_eq!(link["ticks"], json(dir.join("run/summary.json"))["ticks"]);
        assert_eq!(link["received_by_target"]["corrupt"], 0);
        assert!(link["times_real_time"].as_f64().unwrap() > 0.0);
    }
}

/// A 20 Hz robot that is driving, 3 s into its run, and one that ticks once a second.
fn moving() -> [(Scenario, u64); 2] {
    [("one-obstacle", 60), ("worked-example", 5)].map(|(name, at)| (load(name).unwrap(), at))
}

/// What is lost, when the link is bad for so many periods that the robot disarms itself.
const OUTAGES: [&str; 8] = [
    "silence",
    "drop",
    "to-drop",
    "from-drop",
    "corrupt",
    "truncate",
    "to-corrupt",
    "from-truncate",
];

#[test]
fn without_answers_the_motors_stop_and_arming_is_required_again() {
    for (scenario, at) in moving() {
        let period = scenario.robot.period;
        // Longer than the motors wait.
        let count = (0.2 / period).floor() as u64 + 4;
        for kind in OUTAGES {
            let fault = format!("{kind}@{at}+{count}");
            let what = format!("{} {fault}", scenario.name);
            let seen = drive(&scenario, 3, &[&fault], None);
            let report = &seen.driven.report;
            assert_eq!(seen.driven.ending, Ending::Disarmed, "{what}");
            match &seen.driven.outage {
                Some(Outage::Disarmed { cause, .. }) => {
                    assert_eq!(*cause, Cause::LinkTimeout, "{what}");
                }
                other => panic!("{what}: {other:?}"),
            }
            assert!(report.lost_ticks >= count, "{what}: {report:?}");
            // The last command was that of the tick before. A period of a second has to pass first.
            let last = (at - 1) as f64 * period;
            let most = if period < 0.2 { 0.2 } else { period + 0.2 };
            let (stopped, _) = seen.gaps.iter().find_map(|gap| gap.timed_out).unwrap();
            assert!(
                (most - 0.01..=most + 1e-9).contains(&(stopped - last)),
                "{what}: {stopped}"
            );
            let after = report.motors_stopped_after_ms.unwrap();
            assert!(
                (most * 1e3 - 10.0..=most * 1e3 + 1e-6).contains(&after),
                "{what}: {after}"
            );
            // The robot was driving, slows down, and stands when its link has recovered.
            let moved = |gap: &Gap| gap.wheels.iter().any(|wheel| wheel.abs() > 1e-9);
            assert!(moved(&seen.gaps[0]), "{what}");
            assert!(
                !moved(seen.gaps.last().unwrap()),
                "{what}: {:?}",
                seen.gaps.last()
            );
            let recovered = seen.gaps.iter().filter(|gap| gap.disarmed.is_some());
            assert_eq!(recovered.count(), 5, "{what}");

            // Armed again, it goes on to the end.
            let seen = drive(&scenario, 3, &[&fault], Some(5));
            assert_eq!(seen.driven.ending, Ending::PathEnd, "{what}");
            assert!(seen.driven.outage.is_none(), "{what}");
            let events: Vec<&str> = seen.driven.report.events.iter().map(|e| &*e.what).collect();
            let disarmed = "disarmed: no inputs in time";
            for event in ["motors stopped by themselves", disarmed, "armed again"] {
                assert_eq!(
                    events.iter().filter(|e| **e == event).count(),
                    1,
                    "{what}: {events:?}"
                );
            }
        }
    }
}

/// The robot hears everything and is never late, so it does not disarm itself; that its motors have stopped for want of its
/// answers is no reason to go on by itself.
#[test]
fn motors_that_stopped_go_on_after_arming_only() {
    let scenario = load("one-obstacle").unwrap();
    for fault in ["from-corrupt:0.3", "from-drop:0.3", "drop:0.15"] {
        let seen = drive(&scenario, 1, &[fault], None);
        assert_eq!(seen.driven.ending, Ending::Disarmed, "{fault}");
        let outage = seen.driven.outage.as_ref().unwrap().to_string();
        assert!(outage.contains("--rearm"), "{fault}: {outage}");
        let (stopped, _) = seen.gaps.iter().find_map(|gap| gap.timed_out).unwrap();
        assert!(seen.times.iter().all(|time| *time < stopped), "{fault}");
        let last = seen.gaps.last().unwrap();
        assert_eq!(last.wheels, [0.0; 2], "{fault}: {last:?}");

        let seen = drive(&scenario, 1, &[fault], Some(2));
        let events = &seen.driven.report.events;
        let at = |what: &str| -> Vec<f64> {
            let of = events.iter().filter(|event| event.what == what);
            of.map(|event| event.time_s).collect()
        };
        let (stops, arms) = (at("motors stopped by themselves"), at("armed again"));
        assert!(stops.len() > 1 && arms.len() > 1, "{fault}: {events:?}");
        for stop in stops {
            let driven = seen.times.iter().find(|time| **time > stop);
            let armed = arms.iter().find(|time| **time > stop);
            assert!(
                driven.is_none_or(|driven| armed.is_some_and(|armed| armed <= driven)),
                "{fault}: stopped at {stop}, driven at {driven:?}, armed at {armed:?}"
            );
        }
    }
}

/// Armed and then silent, the motors have not moved yet: it may not set off late.
#[test]
fn silence_right_after_arming_disarms_too() {
    let scenario = load("one-obstacle").unwrap();
    for fault in ["silence@0+8", "to-silence@0+12", "from-silence@0+8"] {
        let seen = drive(&scenario, 1, &[fault], None);
        assert_eq!(seen.driven.ending, Ending::Disarmed, "{fault}");
        assert!(seen.times.is_empty(), "{fault}: {:?}", seen.times);
        let seen = drive(&scenario, 1, &[fault], Some(2));
        assert_eq!(seen.driven.ending, Ending::PathEnd, "{fault}");
        let events = &seen.driven.report.events;
        assert!(
            events.iter().any(|event| event.what == "armed again"),
            "{fault}: {events:?}"
        );
    }
}

#[test]
fn a_few_lost_ticks_are_driven_through() {
    let scenario = load("one-obstacle").unwrap();
    for kind in OUTAGES {
        let seen = drive(&scenario, 3, &[&format!("{kind}@60+2")], None);
        assert_eq!(seen.driven.ending, Ending::PathEnd, "{kind}");
        // A frame that has lost its end takes the next one with it.
        let most = if kind.ends_with("truncate") { 3 } else { 2 };
        let lost = seen.driven.report.lost_ticks;
        assert!((2..=most).contains(&lost), "{kind}: {lost}");
        assert_eq!(seen.driven.report.disarmed_ticks, 0, "{kind}");
    }
}

#[test]
fn faults_now_and_then_are_survived() {
    let scenario = load("slalom").unwrap();
    for seed in 1..=5 {
        for fault in [
            "truncate",
            "corrupt",
            "duplicate",
            "reorder",
            "drop",
            "noise",
            "silence",
        ] {
            let seen = drive(&scenario, seed, &[&format!("{fault}:0.03")], Some(3));
            let report = &seen.driven.report;
            assert_eq!(
                seen.driven.ending,
                Ending::PathEnd,
                "{fault} {seed}: {:?}",
                seen.driven.outage
            );
            let [(kind, count)] = &report.faults[..] else {
                panic!("{:?}", report.faults);
            };
            assert!(kind == fault && *count > 10, "{fault}: {count}");
            let bad = |r: &host_sim::hil::report::Received| r.overlong + r.truncated + r.corrupt;
            let seen_bad = bad(&report.received) + bad(&report.received_by_target) > 0;
            let spoils = matches!(fault, "truncate" | "corrupt" | "noise");
            assert_eq!(seen_bad, spoils, "{fault} {seed}");
            // Repeated frames change nothing; a lost one does.
            let same = seen.rows == rows(&scenario, seed).0;
            assert_eq!(same, fault == "duplicate", "{fault} {seed}");
        }
        let all = [
            "truncate",
            "corrupt:0.02",
            "duplicate",
            "reorder",
            "drop:0.02",
            "noise",
        ];
        let seen = drive(&scenario, seed, &all, Some(3));
        assert_eq!(
            seen.driven.ending,
            Ending::PathEnd,
            "{seed}: {:?}",
            seen.driven.outage
        );
        // The same seed, the same faults.
        assert!(
            drive(&scenario, seed, &all, Some(3)).rows == seen.rows,
            "{seed}"
        );
    }
}

#[test]
fn what_was_driven_is_written_when_the_robot_is_lost() {
    let dir = tempdir().unwrap();
    let dir = dir.path();
    for (fault, ended, parts) in [
        (
            "silence@60+8",
            "disarmed",
            &["no inputs in time", "link has recovered", "--rearm"][..],
        ),
        (
            "silence@60+100000",
            "link lost",
            &["no answer for 1200 ms at 3"],
        ),
        (
            "from-corrupt@60+100000",
            "link lost",
            &["no answer for 1200 ms at 3"],
        ),
    ] {
        let args = [
            "hil",
            "--local",
            "--scenario",
            "one-obstacle",
            "--out",
            "o",
            "--fault",
            fault,
        ];
        let output = sim(dir).args(args).assert().code(3).get_output().clone();
        let said = complaint(&output);
        for part in parts {
            assert!(said.contains(part), "{fault}: {said}");
        }
        assert!(
            String::from_utf8(output.stdout)
                .unwrap()
                .contains("written: o")
        );
        assert_eq!(names(&dir.join("o")), RESULTS);
        let summary = json(dir.join("o/summary.json"));
        assert_eq!(summary["ended"], ended, "{fault}");
        assert_eq!(summary["ticks"], 60, "{fault}");
        assert_eq!(summary["reached_end"], false);
        let rows = fs::read_to_string(dir.join("o/ticks.csv")).unwrap();
        assert_eq!(rows.lines().count(), 61, "{fault}");
    }
}

/// How a 32-bit ELF file for ARM begins; not more of one.
const HEAD: [u8; 20] = *b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0\x02\0\x28\0";

#[test]
fn wrong_arguments_are_named() {
    let dir = tempdir().unwrap();
    let dir = dir.path();
    let fault = |text| ["hil", "--local", "--fault", text];
    for (args, parts) in [
        (&["hil"][..], &["--qemu", "--port", "--local"][..]),
        (&["hil", "--local", "--qemu"], &["cannot be used with"]),
        (
            &["hil", "--local", "--image", "x"],
            &["cannot be used with"],
        ),
        (&fault("explode"), &["truncate, corrupt, duplicate"]),
        (&fault("drop:0"), &["RATE above 0, up to 1"]),
        (&fault("drop:1.5"), &["RATE above 0, up to 1"]),
        (&fault("drop@5+0"), &["@PERIOD[+COUNT]"]),
        (&["hil", "--local", "--rearm=0"], &["1..=1000"]),
        (
            &["hil", "--local", "--scenario", "nowhere"],
            &["unknown scenario"],
        ),
        (
            &["hil", "--qemu", "--image", "none.elf"],
            &["none.elf", "cargo fw"],
        ),
    ] {
        let output = sim(dir)
            .args(args)
            .assert()
            .code(2)
            .stdout("")
            .get_output()
            .clone();
        let said = String::from_utf8(output.stderr).unwrap();
        for part in parts {
            assert!(said.contains(part), "{args:?}: {said}");
        }
        assert!(names(dir).is_empty(), "{args:?}");
    }
    // Some file, and the head of an image.
    fs::write(dir.join("image.elf"), "root:x:0:0").unwrap();
    let output = sim(dir)
        .args(["hil", "--qemu", "--image", "image.elf"])
        .assert()
        .code(2);
    let said = complaint(output.get_output());
    assert!(
        said.contains("image.elf: it is no program for ARM"),
        "{said}"
    );
    fs::write(dir.join("image.elf"), HEAD).unwrap();
    let output = sim(dir)
        .env("PATH", dir)
        .args(["hil", "--qemu", "--image", "image.elf"])
        .assert()
        .code(2);
    let said = complaint(output.get_output());
    assert!(
        said.contains("qemu-system-arm is not installed") && said.contains("apt-get"),
        "{said}"
    );
    let output = sim(dir)
        .args(["hil", "--port", "/dev/none"])
        .assert()
        .code(3);
    let said = complaint(output.get_output());
    assert!(said.contains("/dev/none: cannot be opened"), "{said}");
    if cfg!(target_os = "linux") {
        let output = sim(dir)
            .args(["hil", "--port", "image.elf"])
            .assert()
            .code(3);
        let said = complaint(output.get_output());
        assert!(said.contains("it is no serial port"), "{said}");
    }
    assert_eq!(names(dir), ["image.elf"]);
}

/// What a wire does from some moment on.
#[derive(Clone, Copy, Debug)]
enum Then {
    /// It is silent.
    Silence,
    /// It talks, but never answers.
    Chatter,
}

/// A robot that hears and answers until so many bytes or until it is stopped, and then does something else; with the time by
/// which it is waited for, which waiting and bytes let pass.
struct Until {
    robot: Local,
    left: Option<usize>,
    then: Then,
    over: bool,
    passed: Duration,
    /// When it was over, and now.
    clock: Rc<Cell<(Duration, Duration)>>,
}

impl Until {
    fn tell(&self) {
        let (since, _) = self.clock.get();
        let since = if self.over { since } else { self.now() };
        self.clock.set((since, self.now()));
    }
}

impl Wire for Until {
    fn send(&mut self, frame: &[u8]) -> std::io::Result<()> {
        let mut decoder = Decoder::new();
        let stop = frame.iter().any(|byte| match decoder.push(*byte) {
            Some(Ok(frame)) => matches!(frame.parse(), Some(ToTarget::Stop)),
            _ => false,
        });
        let end = match &mut self.left {
            None => stop,
            Some(left) => {
                *left = left.saturating_sub(frame.len());
                *left == 0
            }
        };
        self.over |= end;
        self.tell();
        match self.over {
            true => Ok(()),
            false => self.robot.send(frame),
        }
    }

    fn receive(&mut self, room: &mut [u8], patience: Duration) -> std::io::Result<usize> {
        let count = match (self.over, self.then) {
            (false, _) => self.robot.receive(room, patience)?,
            (true, Then::Silence) => {
                self.passed += patience;
                0
            }
            (true, Then::Chatter) => {
                let mut wire = [0; MAX_FRAME];
                let frame = encode(177, &ToHost::Ack, &mut wire).unwrap();
                self.passed += Duration::from_micros(20) * frame.len() as u32;
                room[..frame.len()].copy_from_slice(frame);
                frame.len()
            }
        };
        self.tell();
        Ok(count)
    }

    fn now(&self) -> Duration {
        self.robot.now() + self.passed
    }

    fn name(&self) -> String {
        "a robot".to_owned()
    }
}

/// By the wire's own clock, so whatever else the desktop has to do: a second and a half, which leaves half a second to draw.
#[test]
fn nobody_is_waited_for_longer_than_said() {
    let scenario = load("line").unwrap();
    let mut other = Vec::new();
    for then in [Then::Silence, Then::Chatter] {
        for (left, least) in [(Some(1), 1200), (Some(9_000), 1200), (None, 200)] {
            let what = format!("{then:?} after {left:?}");
            let clock = Rc::new(Cell::default());
            let wire = Until {
                robot: Local::new(),
                left,
                then,
                over: false,
                passed: Duration::ZERO,
                clock: Rc::clone(&clock),
            };
            let driven = host_sim::hil::run(&scenario, 1, Box::new(wire), None, &mut |_| {});
            match left {
                Some(1) => assert!(driven.is_err(), "{what}"),
                Some(_) => assert_eq!(driven.unwrap().ending, Ending::LinkLost, "{what}"),
                None => assert_eq!(driven.unwrap().ending, Ending::PathEnd, "{what}"),
            }
            let (since, end) = clock.get();
            let took = (end - since).as_millis();
            if !(least..=least + 150).contains(&took) {
                other.push(format!("{what}: {took} ms"));
            }
        }
    }
    assert!(other.is_empty(), "{other:?}");
}

#[test]
fn hostile_frames_move_nothing() {
    let scenario = load("square").unwrap();
    let report = attack(&scenario, 1, Box::new(Local::new()), 10_000).unwrap();
    let kinds = [
        report.random,
        report.truncated,
        report.flipped,
        report.replayed,
    ];
    assert!(kinds.iter().all(|kind| *kind > 2_000) && kinds.iter().sum::<u64>() == 10_000);
    assert_eq!((report.checks, report.in_monitor), (21, 5_000));
    assert!(report.recovered_after <= MOST_GOOD);
}

// ---- a robot on a serial port ----

#[cfg(unix)]
mod port {
    use super::*;
    use fuzzypilot::geometry::Pose;
    use fuzzypilot::presets;
    use host_sim::hil::local::LocalPilot;
    use rustix::fs::{OFlags, fcntl_setfl};
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use std::fs::File;
    use std::io::{Read, Write};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::{self, JoinHandle};

    /// What is done with the bytes that come to a port, and every millisecond without; what it answers. None: the port is
    /// closed.
    type Robot = Box<dyn FnMut(&[u8]) -> Option<Vec<u8>> + Send>;

    /// A pseudo-terminal with a robot at its end.
    struct Pty {
        name: String,
        over: Arc<AtomicBool>,
        thread: Option<JoinHandle<()>>,
    }

    impl Pty {
        fn new(mut robot: Robot) -> Self {
            // Not host-sim's, too: else it would stay open when this end is closed.
            let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
            let near = openpt(flags).unwrap();
            grantpt(&near).unwrap();
            unlockpt(&near).unwrap();
            fcntl_setfl(&near, OFlags::NONBLOCK).unwrap();
            let name = ptsname(&near, Vec::new()).unwrap().into_string().unwrap();
            let mut near = File::from(near);
            let over = Arc::new(AtomicBool::new(false));
            let stop = Arc::clone(&over);
            let thread = thread::spawn(move || {
                let mut bytes = [0; 256];
                let mut spoken_to = false;
                while !stop.load(Ordering::Relaxed) {
                    let count = near.read(&mut bytes).unwrap_or(0);
                    spoken_to |= count > 0;
                    if count == 0 {
                        thread::sleep(Duration::from_millis(1));
                    }
                    if !spoken_to {
                        continue;
                    }
                    let Some(answer) = robot(&bytes[..count]) else {
                        break;
                    };
                    // Nobody need listen any more.
                    let _ = near.write_all(&answer);
                }
            });
            Self {
                name,
                over,
                thread: Some(thread),
            }
        }

        fn run(&self, dir: &Path, scenario: &str) -> (std::process::Output, Duration) {
            let begin = Instant::now();
            let args = [
                "hil",
                "--port",
                &self.name,
                "--scenario",
                scenario,
                "--out",
                "hil",
            ];
            let output = sim(dir).args(args).output().unwrap();
            (output, begin.elapsed())
        }
    }

    impl Drop for Pty {
        fn drop(&mut self) {
            self.over.store(true, Ordering::Relaxed);
            let _ = self.thread.take().unwrap().join();
        }
    }

    /// The pilot in this process, byte by byte.
    fn pilot() -> Robot {
        let mut local = Local::new();
        Box::new(move |bytes| {
            local.send(bytes).unwrap();
            let mut all = Vec::new();
            let mut room = [0; 256];
            while let Ok(count @ 1..) = local.receive(&mut room, Duration::from_micros(1)) {
                all.extend(&room[..count]);
            }
            Some(all)
        })
    }

    #[test]
    fn a_run_over_a_serial_port_has_the_same_ticks() {
        let dir = tempdir().unwrap();
        let pty = Pty::new(pilot());
        // Twice: the robot finds into a new session.
        for scenario in ["points", "cones"] {
            let (output, _) = pty.run(dir.path(), scenario);
            assert!(output.status.success(), "{output:?}");
            let run = ["run", scenario, "--out", "run"];
            sim(dir.path()).args(run).assert().success();
            for file in ["ticks.csv", "summary.json"] {
                let [run, hil] =
                    ["run", "hil"].map(|o| fs::read(dir.path().join(o).join(file)).unwrap());
                assert!(run == hil, "{scenario}: {file}");
            }
        }
    }

    /// The pilot, until so many bytes have come; then another robot.
    fn until(most: usize, mut then: Robot) -> Robot {
        let mut first = pilot();
        let mut count = 0;
        Box::new(move |bytes| {
            count += bytes.len();
            if count < most {
                first(bytes)
            } else {
                then(bytes)
            }
        })
    }

    /// A robot that answers everything by one frame, given a sequence number.
    fn stubborn(frame: impl Fn(u8) -> Vec<u8> + Send + 'static) -> Robot {
        let mut decoder = Decoder::new();
        Box::new(move |bytes| {
            let mut answers = Vec::new();
            for byte in bytes {
                if let Some(Ok(heard)) = decoder.push(*byte) {
                    answers.extend(frame(heard.sequence));
                }
            }
            Some(answers)
        })
    }

    fn greeting(
        sequence: u8,
        firmware: [u8; 3],
        ranges: u8,
        segments: u16,
        record: u16,
    ) -> Vec<u8> {
        let welcome = ToHost::Welcome {
            firmware,
            ranges,
            segments,
            points: 64,
            record_bytes: record,
            token: 1,
        };
        let mut wire = [0; MAX_FRAME];
        encode(sequence, &welcome, &mut wire).unwrap().to_vec()
    }

    fn welcome(firmware: [u8; 3], ranges: u8, segments: u16) -> Robot {
        stubborn(move |sequence| greeting(sequence, firmware, ranges, segments, 156))
    }

    /// A bare board: the input of its emergency stop is open.
    fn unarmable() -> Robot {
        let mut pilot = Box::new(LocalPilot::new(presets::small_robot(), Pose::default()));
        pilot.emergency(true);
        Box::new(move |bytes| {
            let mut all = Vec::new();
            for byte in bytes {
                pilot.receive(*byte, 0, &mut |frame: &[u8]| all.extend(frame));
            }
            Some(all)
        })
    }

    /// A robot whose records are all zeros, in sound frames, once it has heard so many bytes.
    fn garbler(most: usize) -> Robot {
        let (mut robot, mut heard) = (pilot(), 0);
        Box::new(move |bytes| {
            heard += bytes.len();
            let answers = robot(bytes)?;
            if heard < most {
                return Some(answers);
            }
            let (mut decoder, mut garbled) = (Decoder::new(), Vec::new());
            for byte in answers {
                let Some(Ok(frame)) = decoder.push(byte) else {
                    continue;
                };
                let message = match frame.parse::<ToHost<'_>>() {
                    Some(ToHost::RecordPart { part, .. }) => ToHost::RecordPart {
                        part,
                        bytes: &[0; 52],
                    },
                    other => other?,
                };
                let mut wire = [0; MAX_FRAME];
                garbled.extend_from_slice(encode(frame.sequence, &message, &mut wire)?);
            }
            Some(garbled)
        })
    }

    /// A robot that says the same over and over, whatever it is asked.
    fn chatter() -> Robot {
        let mut wire = [0; MAX_FRAME];
        let frame = encode(177, &ToHost::Ack, &mut wire).unwrap().to_vec();
        Box::new(move |_| Some(frame.clone()))
    }

    const OWN: [u8; 3] = host_sim::hil::target::OWN;

    #[test]
    fn robots_that_cannot_be_used_are_named_in_time() {
        // A refusal by version 2: raw 02 0a 04 01 and the CRC that Python's zlib.crc32 gives.
        let another = vec![9, 2, 10, 4, 1, 0xd3, 0x67, 0xb1, 0x95, 0];
        let cases: Vec<(Robot, &[&str])> = vec![
            (
                Box::new(|_| Some(Vec::new())),
                &["no answer for 1200 ms", "baud"],
            ),
            (
                Box::new(|bytes| Some(bytes.to_vec())),
                &["answered hello by", "no answer"],
            ),
            (
                Box::new(|_| Some(b"login: ".to_vec())),
                &["no answer for 1200 ms"],
            ),
            (
                // Answers to nobody's question, without an end.
                chatter(),
                &["no answer for 1200 ms"],
            ),
            (
                welcome([9, 8, 7], 64, 32),
                &["firmware is 9.8.7", "allowed is 0.1.0"],
            ),
            (
                stubborn(|sequence| greeting(sequence, OWN, 64, 32, 148)),
                &[
                    "0.1.0 with records of 148 bytes",
                    "allowed is 0.1.0 with records of 156",
                ],
            ),
            (
                unarmable(),
                &["to be armed", "emergency stop is pressed", "docs/hil.md"],
            ),
            (
                stubborn(move |_| another.clone()),
                &["protocol version 2", "allowed is 1"],
            ),
            (welcome(OWN, 8, 32), &["room for 8 range sensors", "has 32"]),
            (welcome(OWN, 64, 3), &["room for 3 segments", "has 4"]),
            (Box::new(|_| None), &["link is gone"]),
        ];
        for (robot, parts) in cases {
            let dir = tempdir().unwrap();
            let pty = Pty::new(robot);
            let (output, took) = pty.run(dir.path(), "square");
            assert_eq!(output.status.code(), Some(3), "{parts:?}: {output:?}");
            let said = complaint(&output);
            assert!(said.contains(&pty.name), "{said}");
            for part in parts {
                assert!(said.contains(part), "{part}: {said}");
            }
            assert!(took < IN_TIME, "{parts:?}: {took:?}");
            assert!(names(dir.path()).is_empty(), "{parts:?}");
        }
    }

    #[test]
    fn robots_that_are_lost_on_the_way_are_named_in_time() {
        // Bytes of the set-up and some twenty ticks.
        const SOME: usize = 9_000;
        let cases: Vec<(Robot, &[&str])> = vec![
            (until(SOME, Box::new(|_| None)), &["link is gone"]),
            (
                until(SOME, Box::new(|_| Some(Vec::new()))),
                &["no answer for 1200 ms at"],
            ),
            (until(SOME, pilot()), &["has restarted at", "switched on"]),
            (
                garbler(SOME),
                &["answered tick", "by something else: the record of tick 0"],
            ),
        ];
        for (robot, parts) in cases {
            let dir = tempdir().unwrap();
            let pty = Pty::new(robot);
            let (output, took) = pty.run(dir.path(), "square");
            assert_eq!(output.status.code(), Some(3), "{parts:?}: {output:?}");
            let said = complaint(&output);
            for part in parts {
                assert!(said.contains(part), "{part}: {said}");
            }
            assert!(said.len() <= 200, "{said}");
            // Set-up and drawing included.
            assert!(took < IN_TIME, "{parts:?}: {took:?}");
            assert_eq!(names(&dir.path().join("hil")), RESULTS);
            let summary = json(dir.path().join("hil/summary.json"));
            assert_eq!(summary["ended"], "link lost");
            assert!(
                summary["ticks"].as_u64().unwrap() > 5,
                "{parts:?}: {summary}"
            );
        }
    }
}

// ---- the firmware in an emulator ----

#[cfg(target_os = "linux")]
mod qemu {
    use super::*;
    use host_sim::hil::qemu::{QEMU, default_image};
    use std::path::PathBuf;
    use std::process::{Child, Output, Stdio};
    use std::thread;

    /// The image, if it and the emulator are there; a reason not to test is said, and in CI it is a failure.
    fn image() -> Option<PathBuf> {
        let image = std::env::var_os("FUZZYPILOT_IMAGE").map_or_else(default_image, PathBuf::from);
        let emulator = std::process::Command::new(QEMU).arg("--version").output();
        let missing = if emulator.is_err() {
            format!("{QEMU}: apt-get install qemu-system-arm")
        } else if !image.is_file() {
            format!("{}: cargo fw", image.display())
        } else {
            return Some(image.canonicalize().unwrap());
        };
        assert!(
            std::env::var_os("CI").is_none_or(|ci| ci != "true"),
            "missing: {missing}"
        );
        // Past the harness, which would swallow it.
        use std::io::Write;
        let _ = writeln!(std::io::stderr(), "skipped, missing: {missing}");
        None
    }

    fn arguments(image: &Path, scenario: &str) -> Vec<String> {
        let image = image.to_string_lossy();
        [
            "hil",
            "--qemu",
            "--image",
            &image,
            "--scenario",
            scenario,
            "--out",
            "hil",
        ]
        .map(str::to_owned)
        .to_vec()
    }

    #[test]
    fn the_firmware_computes_the_same_ticks() {
        let Some(image) = image() else { return };
        let dir = tempdir().unwrap();
        let dir = dir.path();
        for scenario in ["experiment-1", "slalom", "one-obstacle", "points"] {
            sim(dir)
                .args(arguments(&image, scenario))
                .assert()
                .success()
                .stderr("");
            sim(dir)
                .args(["run", scenario, "--out", "run"])
                .assert()
                .success();
            for file in ["ticks.csv", "summary.json"] {
                let [run, hil] =
                    ["run", "hil"].map(|out| fs::read(dir.join(out).join(file)).unwrap());
                assert!(run == hil, "{scenario}: {file}");
            }
            let link = json(dir.join("hil/link.json"));
            assert_eq!(link["lost_ticks"], 0, "{scenario}");
            let speed = link["times_real_time"].as_f64().unwrap();
            // The one whose control period is a second: it asks for little, so a busy machine keeps it, too.
            assert!(scenario != "experiment-1" || speed >= 2.0, "{speed}");
            println!("{scenario}: {speed:.1} × real time");
        }
    }

    #[test]
    fn the_firmware_survives_faults() {
        let Some(image) = image() else { return };
        let dir = tempdir().unwrap();
        let dir = dir.path();
        let faults = [
            "--fault=silence@60+8",
            "--fault=to-corrupt@100+8",
            "--fault=from-truncate@140+8",
            "--fault=duplicate:0.02",
            "--fault=reorder:0.02",
            "--rearm",
        ];
        let args = arguments(&image, "one-obstacle");
        sim(dir)
            .args(args)
            .args(faults)
            .assert()
            .success()
            .stderr("");
        let link = json(dir.join("hil/link.json"));
        assert!(
            link["motors_stopped_after_ms"].as_f64().unwrap() <= 200.0 + 1e-6,
            "{link}"
        );
        let events = link["events"].as_array().unwrap();
        let count = |what: &str| events.iter().filter(|e| e["what"] == what).count();
        assert!(count("armed again") >= 3, "{link}");
        assert_eq!(count("armed again"), count("disarmed: no inputs in time"));
        assert_eq!(json(dir.join("hil/summary.json"))["ended"], "path end");
    }

    #[test]
    fn the_firmware_stands_hostile_frames() {
        let Some(image) = image() else { return };
        let dir = tempdir().unwrap();
        let dir = dir.path();
        let mut hostile = sim(dir);
        hostile
            .args(arguments(&image, "line"))
            .args(["--hostile", "10000"]);
        hostile.assert().success().stderr("");
        let report = json(dir.join("hil/hostile.json"));
        assert_eq!(report["checks"], 21, "{report}");
        assert_eq!(report["in_monitor"], 5_000, "{report}");
        assert!(
            report["recovered_after"].as_u64().unwrap() <= u64::from(MOST_GOOD),
            "{report}"
        );
    }

    /// host-sim on its way, and the emulator that it has started.
    struct Running {
        sim: Child,
        emulator: u32,
    }

    impl Running {
        fn start(dir: &Path, image: &Path) -> Self {
            let sim = std::process::Command::new(assert_cmd::cargo::cargo_bin!("host-sim"))
                .current_dir(dir)
                .args(arguments(image, "experiment-1"))
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let end = Instant::now() + Duration::from_secs(10);
            let emulator = loop {
                if let Some(emulator) = child_of(sim.id()) {
                    break emulator;
                }
                assert!(Instant::now() < end, "no emulator was started");
                thread::sleep(Duration::from_millis(10));
            };
            // Into the run: experiment-1 takes several seconds.
            thread::sleep(Duration::from_millis(1500));
            Self { sim, emulator }
        }

        fn signal(&self, signal: &str, process: u32) {
            let process = process.to_string();
            let mut kill = std::process::Command::new("kill");
            let status = kill.args([signal, &process]).status().unwrap();
            assert!(status.success(), "kill {signal}");
        }

        /// How it ends, and how long that takes; the emulator is gone then.
        fn end(self) -> (Output, Duration) {
            let begin = Instant::now();
            let output = self.sim.wait_with_output().unwrap();
            let took = begin.elapsed();
            let proc = format!("/proc/{}", self.emulator);
            assert!(!Path::new(&proc).exists(), "the emulator goes on");
            (output, took)
        }
    }

    fn child_of(parent: u32) -> Option<u32> {
        let processes = fs::read_dir("/proc").unwrap();
        let mut ids = processes.filter_map(|e| e.ok()?.file_name().to_str()?.parse::<u32>().ok());
        ids.find(|id| {
            let stat = fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
            // After the name in parentheses: state, parent.
            let rest = stat.rsplit(')').next().unwrap_or_default();
            rest.split_whitespace().nth(1) == Some(&parent.to_string())
        })
    }

    #[test]
    fn a_killed_emulator_is_named_and_what_was_driven_is_written() {
        let Some(image) = image() else { return };
        for (signal, parts) in [
            (
                "-KILL",
                &["link is gone", "emulator has ended (signal 9)"][..],
            ),
            ("-STOP", &["no answer for 1200 ms at"]),
        ] {
            let dir = tempdir().unwrap();
            let running = Running::start(dir.path(), &image);
            running.signal(signal, running.emulator);
            let (output, took) = running.end();
            assert_eq!(output.status.code(), Some(3), "{signal}: {output:?}");
            let said = complaint(&output);
            for part in parts {
                assert!(said.contains(part), "{signal}: {said}");
            }
            // Drawing included.
            assert!(took < IN_TIME, "{signal}: {took:?}");
            let summary = json(dir.path().join("hil/summary.json"));
            assert_eq!(summary["ended"], "link lost", "{signal}");
            assert!(
                summary["ticks"].as_u64().unwrap() > 0,
                "{signal}: {summary}"
            );
        }
    }

    #[test]
    fn an_interrupted_run_leaves_no_emulator_behind() {
        let Some(image) = image() else { return };
        for signal in ["-INT", "-TERM"] {
            let dir = tempdir().unwrap();
            let running = Running::start(dir.path(), &image);
            running.signal(signal, running.sim.id());
            let (output, took) = running.end();
            assert_eq!(output.status.code(), Some(130), "{signal}: {output:?}");
            assert!(took < IN_TIME, "{signal}: {took:?}");
            assert!(complaint(&output).contains("interrupted"), "{signal}");
        }
    }

    /// A script that is called like the emulator, in a folder of its own.
    fn wrapper(dir: &Path, lines: &str) -> std::ffi::OsString {
        use std::os::unix::fs::PermissionsExt;
        let bin = dir.join("bin");
        fs::create_dir(&bin).unwrap();
        fs::write(bin.join(QEMU), format!("#!/bin/sh\n{lines}\n")).unwrap();
        fs::set_permissions(bin.join(QEMU), fs::Permissions::from_mode(0o755)).unwrap();
        let path = std::env::var_os("PATH").unwrap_or_default();
        std::env::join_paths(std::iter::once(bin).chain(std::env::split_paths(&path))).unwrap()
    }

    /// Processes that were started with this in their command line.
    fn processes(with: &str) -> usize {
        let all = fs::read_dir("/proc").unwrap().filter_map(Result::ok);
        let lines = all.filter_map(|entry| fs::read(entry.path().join("cmdline")).ok());
        lines
            .filter(|line| String::from_utf8_lossy(line).contains(with))
            .count()
    }

    /// Whoever calls the emulator by a script, as people do who add arguments to it, leaves none of it behind.
    #[test]
    fn an_emulator_behind_a_script_ends_with_the_run() {
        let Some(image) = image() else { return };
        let dir = tempdir().unwrap();
        let real = std::env::split_paths(&std::env::var_os("PATH").unwrap())
            .map(|folder| folder.join(QEMU))
            .find(|path| path.is_file())
            .unwrap();
        let call = format!("{} \"$@\"\nexit $?", real.display());
        let path = wrapper(dir.path(), &call);
        let own = dir.path().join("own.elf");
        fs::copy(&image, &own).unwrap();
        let output = sim(dir.path())
            .env("PATH", &path)
            .args(arguments(&own, "line"))
            .timeout(Duration::from_secs(60))
            .assert()
            .success();
        assert!(output.get_output().stderr.is_empty());
        assert_eq!(names(&dir.path().join("hil")).len(), RESULTS.len() + 1);
        assert_eq!(processes(&own.to_string_lossy()), 0);

        // One that never opens its socket, and whose own child holds its output.
        let dir = tempdir().unwrap();
        let path = wrapper(dir.path(), "sleep 97531\nexit 0");
        let begin = Instant::now();
        let output = sim(dir.path())
            .env("PATH", &path)
            .args(arguments(&image, "line"))
            .timeout(Duration::from_secs(60))
            .assert()
            .code(3);
        let said = complaint(output.get_output());
        assert!(said.contains("has not opened its socket"), "{said}");
        assert!(begin.elapsed() < IN_TIME, "{:?}", begin.elapsed());
        assert_eq!(processes("97531"), 0);
    }

    #[test]
    fn an_image_that_is_none_is_named() {
        if image().is_none() {
            return;
        }
        let dir = tempdir().unwrap();
        let dir = dir.path();
        fs::write(dir.join("image.elf"), HEAD).unwrap();
        let begin = Instant::now();
        let output = sim(dir)
            .args(arguments(Path::new("image.elf"), "line"))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        let said = complaint(&output);
        assert!(said.contains("image.elf"), "{said}");
        assert!(begin.elapsed() < IN_TIME, "{:?}", begin.elapsed());
        assert_eq!(names(dir), ["image.elf"]);
    }
}
