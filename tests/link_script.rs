//! `examples/link.py` against a pilot: what was written from the page alone is understood, over a wire that loses frames.

use fuzzypilot::geometry::Pose;
use fuzzypilot::guide::{Path, Segment};
use fuzzypilot::link::frame::{self, Decoder, MAX_FRAME};
use fuzzypilot::link::message::Cause;
use fuzzypilot::pilot::{Pilot, State};
use fuzzypilot::presets;
use fuzzypilot::units::Metres;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Output};
use std::sync::mpsc;
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

/// How a robot that does not answer as it should does that.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Odd {
    /// The frame is sound, the message in it is cut short.
    Malformed,
    /// Nothing is heard nor said.
    Silent,
}

/// A message of any bytes.
struct Raw<'a>(&'a [u8]);

impl serde::Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeTuple;
        let mut tuple = to.serialize_tuple(self.0.len())?;
        for byte in self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

/// Serves one conversation; questions with this tag are answered oddly, and told.
fn serve_oddly(
    mut stream: TcpStream,
    pilot: &mut Flown,
    (tag, odd): (u8, Odd),
    told: &mpsc::Sender<()>,
) {
    let mut decoder = Decoder::new();
    let (mut frame, mut buffer) = (Vec::new(), [0; 256]);
    while let Ok(length @ 1..) = stream.read(&mut buffer) {
        for byte in &buffer[..length] {
            frame.push(*byte);
            let sound = match decoder.push(*byte) {
                None => continue,
                Some(Err(_)) => None,
                Some(Ok(sound)) => Some((sound.sequence, sound.message.first().copied())),
            };
            let bytes = std::mem::take(&mut frame);
            if let Some((sequence, first)) = sound
                && first == Some(tag)
            {
                told.send(()).unwrap();
                if odd == Odd::Malformed {
                    // A state without its fields.
                    let mut wire = [0; MAX_FRAME];
                    let answer = frame::encode(sequence, &Raw(&[1]), &mut wire).unwrap();
                    stream.write_all(answer).unwrap();
                }
                continue;
            }
            for byte in bytes {
                let mut send = |wire: &[u8]| stream.write_all(wire).unwrap();
                pilot.receive(byte, 0, &mut send);
            }
        }
    }
}

/// A robot that drives, for it has a path and its button was pressed.
fn driving() -> Flown {
    let mut pilot = Flown::new(presets::small_robot(), Pose::default());
    let line = [Segment::line(Pose::default(), Metres::lit("3"))];
    pilot
        .set_path(&Path::segments(&line, false).unwrap())
        .unwrap();
    pilot.button(0).unwrap();
    pilot
}

/// What the script says, and how the robot is afterwards. Interrupted: by Ctrl-C as soon as it was answered oddly.
fn talk_oddly(commands: &[&str], odd: (u8, Odd), interrupted: bool) -> Option<(Output, State)> {
    script(&["--help"])?;
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    let (told, hears) = mpsc::channel();
    let server = thread::spawn(move || {
        let mut pilot = driving();
        serve_oddly(listener.accept().unwrap().0, &mut pilot, odd, &told);
        pilot.state()
    });
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/link.py");
    let child = Command::new("python3")
        .arg(path)
        .arg(&port)
        .args(commands)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    if interrupted {
        hears.recv().unwrap();
        let id = child.id().to_string();
        let kill = Command::new("kill").args(["-INT", &id]).status().unwrap();
        assert!(kill.success());
    }
    let output = child.wait_with_output().unwrap();
    drop(TcpStream::connect(&port[4..]));
    Some((output, server.join().unwrap()))
}

/// Whatever goes wrong in a chain, and whether there is a session or not: the robot does not drive on.
#[cfg(unix)]
#[test]
fn an_odd_answer_and_ctrl_c_leave_the_robot_stopped() {
    const STATUS: u8 = 1;
    const GET: u8 = 2;
    let arm = ["begin", "0", "0", "0", "arm", "get", "45"];
    let cases: [(&[&str], u8, Odd, bool); 5] = [
        // Neither needs a session, so nothing but the stop disarms it.
        (&["status", "stop"], STATUS, Odd::Malformed, false),
        (&["status", "stop"], STATUS, Odd::Silent, true),
        (&arm, GET, Odd::Malformed, false),
        (&arm, GET, Odd::Silent, true),
        (&arm, GET, Odd::Silent, false),
    ];
    for (commands, tag, odd, interrupted) in cases {
        let what = format!("{commands:?} {odd:?} {interrupted}");
        let Some((output, state)) = talk_oddly(commands, (tag, odd), interrupted) else {
            return;
        };
        assert!(!output.status.success(), "{what}");
        assert_eq!(state, State::Disarmed(Cause::StopCommand), "{what}");
    }
    // A question alone stops nobody.
    let (_, state) = talk_oddly(&["status"], (STATUS, Odd::Malformed), false).unwrap();
    assert_eq!(state, State::Armed);
}

/// What the script sets a serial port to, read at the other end of a pseudo-terminal.
#[cfg(target_os = "linux")]
#[test]
fn a_port_is_opened_at_the_firmwares_rate() {
    const READ: &str = "
import os, pty, subprocess, sys, termios, time
near, far = pty.openpty()
script = subprocess.Popen([sys.executable, sys.argv[1], *sys.argv[2:], os.ttyname(far), 'status'], stderr=subprocess.DEVNULL)
before, until = termios.tcgetattr(far), time.monotonic() + 10
while (now := termios.tcgetattr(far)) == before and time.monotonic() < until:
    time.sleep(0.01)
time.sleep(0.2)
now = termios.tcgetattr(far)
script.kill()
names = {getattr(termios, name): name for name in dir(termios) if name[1:].isdigit() and name[0] == 'B'}
raw = not now[3] & (termios.ECHO | termios.ICANON) and now[2] & termios.CSIZE == termios.CS8 and not now[2] & termios.PARENB
print(names[now[4]], names[now[5]], raw)
";
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/link.py");
    for (arguments, rate) in [(&[][..], "B460800"), (&["--baud", "115200"][..], "B115200")] {
        let output = Command::new("python3")
            .args(["-c", READ, path])
            .args(arguments)
            .output();
        if script(&["--help"]).is_none() {
            return;
        }
        assert_eq!(lines(&output.unwrap()), [format!("{rate} {rate} True")]);
    }
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
