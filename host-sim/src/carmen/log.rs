//! CARMEN's log files (Carnegie Mellon Robot Navigation Toolkit, Montemerlo, Roy, Thrun): a message a line, words between
//! blanks, metres and radians.
//!
//! ```text
//! FLASER n range×n  laser x y θ  robot x y θ  time host logger-time
//! ROBOTLASER1 type start field resolution max-range accuracy remission-mode  n range×n  m remission×m
//!             laser x y θ  robot x y θ  v ω forward-safety side-safety turn-axis  time host logger-time
//! ODOM x y θ  v ω acceleration  time host logger-time
//! ```
//!
//! `FLASER` names no field of view: it is the half turn ahead, as the laser scanners had it that it was made for. Times are
//! optional here: some archives lost them. Other messages are passed over.

use flate2::read::MultiGzDecoder;
use std::f64::consts::PI;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Longest text that is read, bytes.
const MOST_BYTES: u64 = 512 << 20;

/// Most beams of a scan.
const MOST_BEAMS: usize = 4096;

/// Largest number that a place, a range or a time may be.
const LARGEST: f64 = 1e12;

/// Farthest place from the frame's origin, m.
const FARTHEST: f64 = 1e6;

/// What a log is read for, in messages.
const WANTED: &str = "a CARMEN log with FLASER or ROBOTLASER1 lines, plain or gzip";

/// Why a log cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be read at all.
    #[error("{file}: cannot be read ({why})")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's reason.
        why: String,
    },
    /// Something in it.
    #[error("{place}: found {found}; allowed: {allowed}")]
    Wrong {
        /// File, and line where there is one.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
}

/// A laser's scan.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// Where the laser is: x, y (m), heading (rad).
    pub at: [f64; 3],
    /// Direction of the first beam from the laser's axis, rad.
    pub first: f64,
    /// From a beam to the next, counter-clockwise, rad.
    pub pitch: f64,
    /// From here on a range says that nothing came back, m.
    pub max_range: f64,
    /// m, from right to left.
    pub ranges: Vec<f64>,
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Its own time and the logger's, s; none where the line has no number there.
    pub times: [Option<f64>; 2],
    /// Where the robot believes to be: x, y (m), heading (rad).
    pub pose: [f64; 3],
    /// The scan, if it is a laser's message.
    pub scan: Option<Scan>,
}

/// The messages of a file in its order; at least two of them, at least one with a scan.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// See above.
    pub events: Vec<Event>,
    /// Where the laser sits on the robot: x, y (m), heading (rad).
    pub mount: [f64; 3],
    /// Whether somebody corrected the lasers' poses after the drive: then they are no longer at one place of where the
    /// robot believed to be. Poses are the lasers' then, the mount is zero and messages without a scan are left out.
    pub corrected: bool,
}

/// Reads `FILE.log` or a gzip file of one.
///
/// # Errors
///
/// A file that cannot be read, is cut short, is no such log or holds no scan; a line that is not as it should be.
pub fn read(file: &Path) -> Result<Log, LogError> {
    let name = file.display().to_string();
    let unreadable = |e: std::io::Error| LogError::Unreadable {
        file: name.clone(),
        why: e.to_string(),
    };
    let mut bytes = Vec::new();
    let opened = File::open(file).map_err(unreadable)?;
    BufReader::new(opened)
        .take(MOST_BYTES)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let mut plain = Vec::new();
        MultiGzDecoder::new(bytes.as_slice())
            .take(MOST_BYTES + 1)
            .read_to_end(&mut plain)
            .map_err(|e| {
                let found = format!("a gzip file that is broken or cut short ({e})");
                wrong(&name, found, "a whole one")
            })?;
        bytes = plain;
    }
    if bytes.len() as u64 >= MOST_BYTES {
        return Err(wrong(
            &name,
            "more than 512 MiB of text",
            "less; cut the log",
        ));
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        let line = 1 + count_lines(&e.as_bytes()[..e.utf8_error().valid_up_to()]);
        wrong(format!("{name}:{line}"), "bytes that are no text", WANTED)
    })?;
    parse(&name, &text)
}

fn count_lines(bytes: &[u8]) -> usize {
    bytes.iter().filter(|b| **b == b'\n').count()
}

fn wrong(
    place: impl Into<String>,
    found: impl Into<String>,
    allowed: impl Into<String>,
) -> LogError {
    LogError::Wrong {
        place: place.into(),
        found: found.into(),
        allowed: allowed.into(),
    }
}

/// Reads a log's text; `name` is what messages call it.
///
/// # Errors
///
/// As [`read`].
pub fn parse(name: &str, text: &str) -> Result<Log, LogError> {
    let mut events = Vec::new();
    let lines = text.lines().count();
    for (index, line) in text.lines().enumerate() {
        let mut words = Words::new(line);
        let Some(kind) = words.word() else {
            continue;
        };
        let event = match kind {
            "FLASER" => flaser(&mut words),
            "ROBOTLASER1" => robotlaser(&mut words),
            "ODOM" => odom(&mut words),
            _ => continue,
        };
        let event = event.map_err(|Fault { found, allowed }| {
            let cut = index + 1 == lines && !text.ends_with('\n');
            let end = if cut { ", where the file ends" } else { "" };
            wrong(
                format!("{name}:{}", index + 1),
                format!("{kind} with {found}{end}"),
                allowed,
            )
        })?;
        events.push(event);
    }
    let scans = events.iter().filter(|e| e.scan.is_some()).count();
    if scans == 0 {
        let found = match (text.trim().is_empty(), events.len()) {
            (true, _) => "nothing".to_owned(),
            (false, 0) => format!("{lines} lines and no message of a robot"),
            (false, n) => format!("{n} ODOM lines and no scan"),
        };
        return Err(wrong(name, found, WANTED));
    }
    let log = settled(events);
    if log.events.len() < 2 {
        return Err(wrong(name, "a single message", "a log of two or more"));
    }
    Ok(log)
}

/// Farthest from the axle's middle that a laser sits, m: what the navigator takes.
const FARTHEST_MOUNT: f64 = 2.0;

/// Finds out where the laser sits.
fn settled(mut events: Vec<Event>) -> Log {
    let mounts = |event: &Event| Some(seen_from(event.pose, event.scan.as_ref()?.at));
    let mount = events.iter().find_map(mounts).unwrap_or_default();
    let near = |a: f64, b: f64| (a - b).abs() < 0.05;
    let fixed = libm::hypot(mount[0], mount[1]) < FARTHEST_MOUNT
        && events.iter().filter_map(mounts).all(|[x, y, heading]| {
            near(x, mount[0])
                && near(y, mount[1])
                && near(crate::world::wrap(heading - mount[2]), 0.0)
        });
    if fixed {
        return Log {
            events,
            mount,
            corrected: false,
        };
    }
    events.retain_mut(|event| match &event.scan {
        Some(scan) => {
            event.pose = scan.at;
            true
        }
        None => false,
    });
    Log {
        events,
        mount: [0.0; 3],
        corrected: true,
    }
}

/// What is wrong with a line.
struct Fault {
    found: String,
    allowed: String,
}

/// The words of a line, one after the other.
struct Words<'a> {
    words: std::str::SplitAsciiWhitespace<'a>,
    taken: usize,
}

impl<'a> Words<'a> {
    fn new(line: &'a str) -> Self {
        Self {
            words: line.split_ascii_whitespace(),
            taken: 0,
        }
    }

    fn word(&mut self) -> Option<&'a str> {
        self.taken += 1;
        self.words.next()
    }

    /// A number within limits.
    fn number(&mut self, what: &str, least: f64, most: f64) -> Result<f64, Fault> {
        let allowed = || match (least, most) {
            (l, m) if l == -LARGEST && m == LARGEST => format!("a number as {what}"),
            _ => format!("a number from {least} to {most} as {what}"),
        };
        let Some(word) = self.word() else {
            return Err(Fault {
                found: format!("{} words", self.taken - 1),
                allowed: format!("{} as word {}", allowed(), self.taken),
            });
        };
        match word.parse::<f64>() {
            Ok(x) if x >= least && x <= most => Ok(x),
            _ => Err(Fault {
                found: format!("`{}` as word {}", short(word), self.taken),
                allowed: allowed(),
            }),
        }
    }

    fn any(&mut self, what: &str) -> Result<f64, Fault> {
        self.number(what, -LARGEST, LARGEST)
    }

    fn pose(&mut self, whose: &str) -> Result<[f64; 3], Fault> {
        let mut place = |axis| self.number(&format!("the {whose}'s {axis}"), -FARTHEST, FARTHEST);
        Ok([place("x")?, place("y")?, place("heading")?])
    }

    /// A count, and so many ranges.
    fn ranges(&mut self) -> Result<Vec<f64>, Fault> {
        let count = self.number("the count of ranges", 1.0, MOST_BEAMS as f64)?;
        if count.fract() != 0.0 {
            return Err(Fault {
                found: format!("`{count}` as the count of ranges"),
                allowed: "a whole number".to_owned(),
            });
        }
        (0..count as usize)
            .map(|k| {
                self.number("a range", 0.0, LARGEST).map_err(|fault| {
                    if self.words.clone().next().is_some() || fault.found.starts_with('`') {
                        return fault;
                    }
                    Fault {
                        found: format!("{k} of {count} ranges"),
                        allowed: "as many as their count says".to_owned(),
                    }
                })
            })
            .collect()
    }

    /// The message's time and the logger's, with the host between them.
    fn times(&mut self) -> [Option<f64>; 2] {
        let own = self.time();
        let _host = self.word();
        [own, self.time()]
    }

    fn time(&mut self) -> Option<f64> {
        let time = self.word()?.parse::<f64>().ok()?;
        (time.abs() <= LARGEST).then_some(time)
    }
}

/// As much of a word as a message has room for.
fn short(word: &str) -> String {
    match word.char_indices().nth(24) {
        Some((end, _)) => format!("{}…", &word[..end]),
        None => word.to_owned(),
    }
}

/// Ranges of this length, m, are what the usual scanners report when nothing comes back.
const NOTHING: f64 = 80.0;

fn flaser(words: &mut Words<'_>) -> Result<Event, Fault> {
    let ranges = words.ranges()?;
    let count = ranges.len() as f64;
    // 180 and 360 beams are a half turn without its last one, 181 and 361 with it.
    let gaps = if ranges.len().is_multiple_of(180) {
        count
    } else {
        (count - 1.0).max(1.0)
    };
    let (laser, pose) = (words.pose("laser")?, words.pose("robot")?);
    Ok(Event {
        pose,
        scan: Some(Scan {
            at: laser,
            first: -PI / 2.0,
            pitch: PI / gaps,
            max_range: NOTHING,
            ranges,
        }),
        times: words.times(),
    })
}

fn robotlaser(words: &mut Words<'_>) -> Result<Event, Fault> {
    words.any("the laser's type")?;
    let first = words.number("the first beam's direction", -7.0, 7.0)?;
    let field = words.number("the field of view", 0.0, 7.0)?;
    let pitch = words.number("the resolution", 0.0, 7.0)?;
    let max_range = words.number("the longest range", 0.0, LARGEST)?;
    words.any("the accuracy")?;
    words.any("the remission mode")?;
    let ranges = words.ranges()?;
    let remissions = words.number("the count of remissions", 0.0, MOST_BEAMS as f64)?;
    for _ in 0..remissions as usize {
        words.any("a remission")?;
    }
    let (laser, pose) = (words.pose("laser")?, words.pose("robot")?);
    for what in [
        "v",
        "ω",
        "the forward safety distance",
        "the side safety distance",
        "the turn axis",
    ] {
        words.any(what)?;
    }
    let gaps = (ranges.len() as f64 - 1.0).max(1.0);
    Ok(Event {
        pose,
        scan: Some(Scan {
            at: laser,
            first,
            pitch: if pitch > 0.0 { pitch } else { field / gaps },
            max_range: if max_range > 0.0 { max_range } else { NOTHING },
            ranges,
        }),
        times: words.times(),
    })
}

fn odom(words: &mut Words<'_>) -> Result<Event, Fault> {
    let pose = words.pose("robot")?;
    for what in ["v", "ω", "the acceleration"] {
        words.any(what)?;
    }
    Ok(Event {
        pose,
        scan: None,
        times: words.times(),
    })
}

/// A pose of the world in the frame of another one.
fn seen_from([x, y, heading]: [f64; 3], of: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = libm::sincos(heading);
    let (dx, dy) = (of[0] - x, of[1] - y);
    [
        dx * cos + dy * sin,
        dy * cos - dx * sin,
        crate::world::wrap(of[2] - heading),
    ]
}
