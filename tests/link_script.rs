//! `examples/link.py` against a pilot: what was written from the page alone is understood, over a wire that loses frames.

use fuzzypilot::geometry::Pose;
use fuzzypilot::link::message::Cause;
use fuzzypilot::pilot::{Pilot, State};
use fuzzypilot::presets;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Output};
use std::thread;

type Flown = Pilot<8, 4, 8>;

/// Runs the script; `None` where there is no Python, which is an error on the server that checks changes.
fn script(arguments: &[&str]) -> Option<Output> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/link.py");
    let output = Command::new("python3").arg(path).args(arguments).output();
    if output.is_err() && std::env::var("CI").is_ok_and(|ci| ci == "true") {
        panic!("missing: python3");
    }
    output.ok()
}

fn lines(output: &Output) -> Vec<String> {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().map(str::to_owned).collect()
}

/// Serves one conversation; every fifth piece of what comes in is lost.
fn serve(mut stream: TcpStream, pilot: &mut Flown) {
    let mut now_us = 0;
    let mut heard = 0;
    let mut buffer = [0; 256];
    while let Ok(length @ 1..) = stream.read(&mut buffer) {
        heard += 1;
        if heard % 5 == 0 {
            continue;
        }
        for byte in &buffer[..length] {
            now_us += 87;
            let mut send = |wire: &[u8]| stream.write_all(wire).unwrap();
            pilot.receive(*byte, now_us, &mut send);
        }
    }
}

/// What the script says when it talks to a pilot, and the pilot afterwards.
fn talk(pilot: Flown, commands: &[&str]) -> Option<(Output, Flown)> {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    let server = thread::spawn(move || {
        let mut pilot = pilot;
        serve(listener.accept().unwrap().0, &mut pilot);
        pilot
    });
    let output = script(&[&[port.as_str()], commands].concat());
    // If it has not connected, let the server go.
    drop(TcpStream::connect(&port[4..]));
    let pilot = server.join().unwrap();
    output.map(|output| (output, pilot))
}

#[test]
fn the_script_passes_its_self_test() {
    if let Some(output) = script(&["--self-test"]) {
        lines(&output);
    }
}

#[test]
fn the_script_sets_up_and_arms_a_robot() {
    let pilot = Flown::new(presets::small_robot(), Pose::default());
    let path = "line 0 0 0 3; arc 3 1 1 -90 180";
    let commands = [
        "status", "get", "45", "set", "45", "1.5q16", "get", "45", "path", path, "begin", "1",
        "-2", "90", "arm", "status",
    ];
    let Some((output, pilot)) = talk(pilot, &commands) else {
        return;
    };
    let said = lines(&output);
    assert!(
        said[0].contains("\"armed\": false, \"cause\": {\"Boot\": {}}"),
        "{said:?}"
    );
    assert_eq!(said[1], "{\"get\": {\"id\": 45, \"value\": 131072}}");
    assert_eq!(said[2], "{\"set\": {}}");
    assert_eq!(said[3], "{\"get\": {\"id\": 45, \"value\": 98304}}");
    assert!(said[7].contains("\"armed\": true"), "{said:?}");
    assert_eq!(said.len(), 8);
    assert_eq!(pilot.state(), State::Armed);
    let length = pilot.path().unwrap().length().get().to_num::<f64>();
    assert!((length - 3.0 - std::f64::consts::PI).abs() < 1e-3);
    let pose = pilot.robot().pose();
    assert_eq!(
        (pose.at.x.bits(), pose.at.y.bits(), pose.heading.bits()),
        (1 << 16, -2 << 16, 1 << 30)
    );

    // Another conversation stops it; it needs no session for that.
    let (output, pilot) = talk(pilot, &["stop"]).unwrap();
    assert!(lines(&output)[0].contains("\"cause\": {\"StopCommand\": {}}"));
    assert_ne!(pilot.state(), State::Armed);
}

#[test]
fn the_script_asks_after_another_session_and_stops_what_it_armed() {
    let mut pilot = Flown::new(presets::small_robot(), Pose::default());
    let line = "line 0 0 0 3";
    // Numbers far ahead of those that the next conversation begins with.
    for _ in 0..12 {
        let Some((output, flown)) = talk(pilot, &["path", line, "begin", "0", "0", "0", "status"])
        else {
            return;
        };
        assert_eq!(lines(&output).len(), 3);
        pilot = flown;
    }
    let (output, pilot) = talk(pilot, &["status"]).unwrap();
    assert!(lines(&output)[0].contains("\"armed\": false"));

    // A step that is refused is not the last word to a robot that drives.
    let chain = ["begin", "0", "0", "0", "arm", "get", "9999", "stop"];
    let (output, pilot) = talk(pilot, &chain).unwrap();
    assert!(!output.status.success());
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("Get: refused: {\"UnknownId\""), "{errors}");
    assert_eq!(pilot.state(), State::Disarmed(Cause::StopCommand));
    // Without a stop in sight either, and not by what fails before it.
    let (_, pilot) = talk(pilot, &chain[..7]).unwrap();
    assert_eq!(pilot.state(), State::Disarmed(Cause::StopCommand));
    let (_, pilot) = talk(pilot, &chain[..5]).unwrap();
    assert_eq!(pilot.state(), State::Armed);
    // Whoever mistypes has sent nothing.
    let (output, pilot) = talk(pilot, &["hello", "stpo"]).unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.starts_with("stpo: no such command"), "{errors}");
    assert_eq!(pilot.state(), State::Armed);
    let (output, pilot) = talk(pilot, &["record", "stop"]).unwrap();
    assert!(!output.status.success());
    assert_ne!(pilot.state(), State::Armed);
}

/// One rate on both ends of a serial line, and in what people read.
#[test]
fn everybody_names_the_rate_of_the_firmware() {
    let text = |path: &str| {
        let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
    };
    let firmware = text("src/main/serial.rs");
    let (_, rate) = firmware.split_once("pub const BAUD: u32 = ").unwrap();
    let rate = rate.split_once(';').unwrap().0.replace('_', "");
    assert_eq!(rate.len(), 6, "{rate}");
    let (thousands, ones) = rate.split_at(3);
    for (file, says) in [
        (
            "host-sim/src/hil/serial.rs",
            format!("BAUD: u32 = {thousands}_{ones};"),
        ),
        ("examples/link.py", format!("BAUD = {rate}  #")),
        ("examples/link.py", format!("at {thousands},{ones} baud")),
        (
            "examples/pico/src/chip.rs",
            format!("{thousands} {ones} baud"),
        ),
        ("docs/link.md", format!("{thousands} {ones} baud")),
        ("docs/wiring.md", format!("{thousands} {ones} baud")),
        ("docs/wiring-pico.md", format!("{thousands} {ones} baud")),
        ("docs/hil.md", rate.clone()),
    ] {
        assert!(text(file).contains(&says), "{file} does not say {says}");
    }
    if let Some(output) = script(&["--help"]) {
        let said = lines(&output).join("\n");
        assert!(said.contains(&format!("{rate} unless")), "{said}");
    }
}

#[test]
fn the_script_says_why_something_was_refused() {
    let pilot = Flown::new(presets::small_robot(), Pose::default());
    let Some((output, _)) = talk(pilot, &["begin", "0", "0", "0"]) else {
        return;
    };
    assert!(!output.status.success());
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(errors, "Begin: refused: {\"NoPath\": {}}\n");
}
