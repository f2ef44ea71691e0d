//! A robot behind a link that computes the ticks of a run.

use super::line::{Answer, Line, State, Welcome};
use super::report::LinkReport;
use super::{LONGEST_SILENCE, Outage};
use crate::plant::command_timeout;
use crate::run::{Controller, OwnedPath, Reply, SimPorts};
use crate::si;
use fuzzypilot::geometry::Pose;
use fuzzypilot::guide::Segment;
use fuzzypilot::link::message::{
    Cause, Counts, MAX_READINGS, PART_BYTES, PathForm, Readings, Role, ToTarget, Why,
};
use fuzzypilot::link::record::{self, RECORD_BYTES};
use fuzzypilot::link::settings::{self, MOUNTS};
use fuzzypilot::params::Params;
use fuzzypilot::ports::{RangeReading, RangeSensors, Side, WheelDrive, WheelEncoders};
use fuzzypilot::signals::TickRecord;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// A record that has not come by then is asked for by a status: answers come in the order of questions.
const PROMPT: Duration = Duration::from_millis(100);

/// The first time that a robot does not answer, this is waited; from then on [`SILENT`] a control period.
const FIRST: Duration = Duration::from_millis(600);

/// See [`FIRST`].
const SILENT: Duration = Duration::from_millis(50);

/// So many good answers in a row of a disarmed robot, and its link counts as recovered.
pub const RECOVERED: u32 = 5;

/// More ticks in a row are not lost by chance.
const MOST_LOST: u32 = 100;

/// Sets up again, from the beginning, after a conversation that has got out of step, at most this often.
const SETUPS: u32 = 5;

/// A robot behind a link, set up for one run.
pub struct Target {
    line: Line,
    /// After so many good answers a robot that the link has disarmed is armed again.
    rearm: Option<u32>,
    period: u64,
    next_tick: u32,
    scan: u8,
    token: u32,
    uptime_ms: u32,
    /// The plant's last time-out after which the robot was disarmed.
    timed_out: Option<(f64, f64)>,
    /// When it was last armed or heard, s, and how long it may be silent while it is armed.
    heard: Option<f64>,
    silence: f64,
    /// Since when and why it is disarmed.
    disarmed: Option<(f64, Cause)>,
    /// Good answers in a row.
    good: u32,
    /// Lost ticks in a row.
    lost: u32,
    /// It owes the answer to this question, the last one: which tick is its next is not known.
    owed: Option<u8>,
    set_up: Duration,
    setup_trips: u64,
    begun: Instant,
    /// What happened.
    report: LinkReport,
}

/// This program's version, which the firmware's must be: they are built from the same source.
pub const OWN: [u8; 3] = [
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
];

const fn number(text: &str) -> u8 {
    match u8::from_str_radix(text, 10) {
        Ok(number) => number,
        Err(_) => u8::MAX,
    }
}

fn version([major, minor, patch]: [u8; 3]) -> String {
    format!("{major}.{minor}.{patch}")
}

/// Begins a session.
pub fn hello(line: &mut Line, role: Role) -> Result<Welcome, Outage> {
    // Ends whatever the robot has of another frame.
    line.send_raw(&[0])?;
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let nonce = since.map_or(0, |since| since.subsec_nanos() ^ since.as_secs() as u32);
    let hello = ToTarget::Hello { nonce, role };
    let wire = line.name();
    match line.ask(&hello)? {
        Answer::Welcome(welcome) => Ok(welcome),
        other => Err(confused(wire, "hello", &other)),
    }
}

fn confused(wire: String, what: &str, answer: &Answer) -> Outage {
    match answer {
        Answer::Refused(why) => Outage::Refused {
            wire,
            what: what.to_owned(),
            why: *why,
        },
        other => Outage::Confused {
            wire,
            what: what.to_owned(),
            found: match other {
                // One's own question, for example.
                Answer::Unknown => "a frame that is no answer".to_owned(),
                other => cut(&format!("{other:?}")),
            },
        },
    }
}

/// What of a long text fits a line.
fn cut(text: &str) -> String {
    const MOST: usize = 80;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text.to_owned(),
    }
}

/// Asks for something that is only to be done.
fn done(line: &mut Line, message: &ToTarget<'_>, what: &str) -> Result<(), Outage> {
    match line.ask(message)? {
        Answer::Ack => Ok(()),
        other => Err(confused(line.name(), what, &other)),
    }
}

/// Refuses a robot that could not compute the same.
pub fn check<const N: usize>(
    wire: String,
    welcome: &Welcome,
    params: &Params<N>,
    path: &OwnedPath,
) -> Result<(), Outage> {
    let records = usize::from(welcome.record_bytes);
    if welcome.firmware != OWN || records != RECORD_BYTES {
        let of = |firmware, bytes: usize| match welcome.firmware == OWN {
            // It was built from another source of the same version.
            true => format!("{} with records of {bytes} bytes", version(firmware)),
            false => version(firmware),
        };
        return Err(Outage::Firmware {
            wire,
            found: of(welcome.firmware, records),
            own: of(OWN, RECORD_BYTES),
        });
    }
    let (what, room, needed) = match path {
        OwnedPath::Points(points, _) => ("points of a path", welcome.points, points.len()),
        OwnedPath::Segments(segments, _, _) => {
            ("segments of a path", welcome.segments, segments.len())
        }
    };
    let sensors = (
        "range sensors",
        welcome.ranges.into(),
        params.ring.mounts.len(),
    );
    for (what, room, needed) in [sensors, (what, room.into(), needed)] {
        if needed > room {
            return Err(Outage::Room {
                wire,
                what,
                room,
                needed,
            });
        }
    }
    Ok(())
}

/// Gives it settings and path, and places it at `start`.
pub fn upload<const N: usize>(
    line: &mut Line,
    params: &Params<N>,
    path: &OwnedPath,
    start: Pose,
) -> Result<(), Outage> {
    // Sensors that are mounted anew sit at the centre and look ahead: what of theirs is zero need not be sent.
    let unmount = ToTarget::Set {
        id: MOUNTS,
        value: 0,
    };
    done(line, &unmount, "to unmount its sensors")?;
    for setting in settings::list(params.ring.mounts.len()) {
        let id = setting.id;
        let value = settings::get(params, id).unwrap_or_default();
        if id <= MOUNTS || value != 0 {
            let what = format!("{} = {value} (setting {id})", setting.name);
            done(line, &ToTarget::Set { id, value }, &what)?;
        }
    }
    upload_path(line, path)?;
    let begin = ToTarget::Begin {
        x: start.at.x.bits(),
        y: start.at.y.bits(),
        heading: start.heading.bits(),
    };
    done(line, &begin, "to begin")
}

fn upload_path(line: &mut Line, path: &OwnedPath) -> Result<(), Outage> {
    let (form, count, closed, gaps) = match path {
        OwnedPath::Points(points, closed) => (PathForm::Points, points.len(), *closed, false),
        OwnedPath::Segments(segments, closed, gaps) => {
            (PathForm::Segments, segments.len(), *closed, *gaps)
        }
    };
    let begin = ToTarget::PathBegin {
        form,
        // It has room for them.
        count: count as u16,
        closed,
        gaps,
    };
    done(line, &begin, "a path")?;
    for index in 0..count as u16 {
        let i = usize::from(index);
        let piece = match path {
            OwnedPath::Points(points, _) => ToTarget::PathPoint {
                index,
                x: points[i].at.x.bits(),
                y: points[i].at.y.bits(),
                heading: points[i].heading.bits(),
            },
            OwnedPath::Segments(segments, _, _) => match segments[i] {
                Segment::Line { start, length } => ToTarget::PathLine {
                    index,
                    x: start.at.x.bits(),
                    y: start.at.y.bits(),
                    heading: start.heading.bits(),
                    length: length.bits(),
                },
                Segment::Arc {
                    centre,
                    radius,
                    from,
                    sweep,
                } => ToTarget::PathArc {
                    index,
                    x: centre.x.bits(),
                    y: centre.y.bits(),
                    radius: radius.bits(),
                    from: from.bits(),
                    sweep,
                },
            },
        };
        done(line, &piece, "a piece of the path")?;
    }
    done(line, &ToTarget::PathEnd, "the path")
}

/// Asks how it is; none, if there is no answer in time.
pub fn status(line: &mut Line, patience: Duration) -> Result<Option<State>, Outage> {
    match line.try_ask(&ToTarget::Status, patience)? {
        Some(Answer::State(state)) => Ok(Some(state)),
        Some(other) => Err(confused(line.name(), "status", &other)),
        None => Ok(None),
    }
}

/// Whether a conversation can go on after a new hello only: frames were lost, repeated or overtaken.
fn out_of_step(outage: &Outage) -> bool {
    matches!(
        outage,
        Outage::Confused { .. }
            | Outage::Refused {
                why: Why::Replayed
                    | Why::NoSession
                    | Why::Role
                    | Why::Token
                    | Why::NotBegun
                    | Why::NotDisarmed
                    | Why::NoPath
                    | Why::OutOfSequence { .. },
                ..
            }
    )
}

impl Target {
    /// Sets the robot up for a run, and arms it.
    ///
    /// # Errors
    ///
    /// It cannot be used; nothing was driven.
    pub fn set_up<const N: usize>(
        mut line: Line,
        params: &Params<N>,
        path: &OwnedPath,
        start: Pose,
        rearm: Option<u32>,
    ) -> Result<Self, Outage> {
        let from = Instant::now();
        let mut attempt = 1;
        let (welcome, state) = loop {
            match Self::try_set_up(&mut line, params, path, start) {
                Err(outage) if attempt < SETUPS && out_of_step(&outage) => attempt += 1,
                done => break done?,
            }
        };
        let report = LinkReport::new(line.name(), &welcome);
        let begun = Instant::now();
        Ok(Self {
            rearm,
            period: 0,
            next_tick: state.tick,
            scan: 0,
            token: state.token,
            uptime_ms: state.uptime_ms,
            timed_out: None,
            heard: None,
            silence: command_timeout(si::from_seconds(params.period)),
            disarmed: None,
            good: 0,
            lost: 0,
            owed: None,
            set_up: begun.duration_since(from),
            setup_trips: line.traffic.round_trips,
            begun,
            report,
            line,
        })
    }

    fn try_set_up<const N: usize>(
        line: &mut Line,
        params: &Params<N>,
        path: &OwnedPath,
        start: Pose,
    ) -> Result<(Welcome, State), Outage> {
        let welcome = hello(line, Role::Lockstep)?;
        check(line.name(), &welcome, params, path)?;
        upload(line, params, path, start)?;
        let token = welcome.token;
        match line.ask(&ToTarget::Arm { token })? {
            Answer::State(state) if state.armed => Ok((welcome, state)),
            other => Err(confused(line.name(), "to be armed", &other)),
        }
    }

    /// Stops the robot, and gives the line back.
    pub fn into_line(mut self) -> Line {
        // The next hello disarms it, too.
        let _ = self.line.try_ask(&ToTarget::Stop, FIRST);
        self.line
    }

    /// Ends the session as well as can be; what went over the link, and what the robot has logged.
    pub fn finish(mut self, period_s: f64) -> (LinkReport, Vec<u8>) {
        let sim_time_s = self.period as f64 * period_s;
        let run = self.begun.elapsed();
        let trips = self.line.traffic.round_trips - self.setup_trips;
        self.report.time(self.set_up, run, trips, sim_time_s);
        // A robot that does not hear it any more disarms itself, and is not waited for.
        let patience = match self.owed {
            None => 2 * PROMPT,
            Some(_) => Duration::ZERO,
        };
        if let Ok(Some(Answer::State(state))) = self.line.try_ask(&ToTarget::Stop, patience) {
            self.report.stack_bytes = state.stack;
            self.report.received_by_target = state.received.into();
        }
        self.report.count(&self.line.traffic);
        self.report.faults = self.line.wire().faults();
        let log = self.line.wire().log();
        (self.report, log)
    }

    /// Takes over what the robot says of itself.
    fn learn(&mut self, state: &State, time: f64) -> Result<(), Outage> {
        // Its clock wraps after seven weeks.
        let back = state.uptime_ms.wrapping_sub(self.uptime_ms) > i32::MAX as u32;
        if back || (!state.armed && is_reset(state.cause)) {
            return Err(Outage::Restarted {
                wire: self.line.name(),
                time,
                cause: state.cause,
            });
        }
        self.uptime_ms = state.uptime_ms;
        self.next_tick = state.tick;
        self.token = state.token;
        self.owed = None;
        if state.armed {
            self.disarmed = None;
        } else if self.disarmed.is_none() {
            self.disarmed = Some((time, state.cause));
            self.good = 0;
            let what = format!("disarmed: {}", state.cause);
            self.report.event(time, what);
        }
        Ok(())
    }

    /// The answer to a tick did not come.
    fn lost(&mut self, time: f64, what: &str) -> Result<Reply, Outage> {
        // One event tells of several in a row.
        if self.lost == 0 {
            self.report.event(time, what);
        }
        self.good = 0;
        self.lost += 1;
        self.report.lost_ticks += 1;
        match self.lost {
            0..=MOST_LOST => Ok(Reply::Lost),
            ticks => Err(Outage::Deaf {
                wire: self.line.name(),
                ticks,
                time,
            }),
        }
    }

    /// An answer has come.
    fn answered(&mut self) {
        self.good += 1;
        self.lost = 0;
    }

    /// Arms a robot again that the link has disarmed, if that is wanted and it is time. An error says that it is not.
    fn rearm(&mut self, time: f64) -> Result<(), Outage> {
        let Some((since, cause)) = self.disarmed else {
            return Ok(());
        };
        // In a run a stop is sent for want of answers only.
        let unanswered = cause == Cause::StopCommand;
        let by_the_link = unanswered || matches!(cause, Cause::LinkTimeout | Cause::Sequence);
        let enough = self.rearm.filter(|_| by_the_link).unwrap_or(RECOVERED);
        if self.good < enough {
            return Ok(());
        }
        if !by_the_link || self.rearm.is_none() {
            return Err(Outage::Disarmed {
                wire: self.line.name(),
                time: since,
                cause,
                hint: match by_the_link {
                    true if unanswered => {
                        "its answers were lost, and the motors stopped by themselves; motion goes on only after \
                         arming again: --rearm does that"
                    }
                    true => {
                        "the link has recovered, but motion goes on only after arming again: \
                         --rearm does that"
                    }
                    false => "a person must look after it",
                },
            });
        }
        let token = self.token;
        let sequence = self.line.send(&ToTarget::Arm { token })?;
        self.settle(sequence, time, FIRST)
    }

    /// Waits for the answer to the last question, which tells how the robot is.
    fn settle(&mut self, sequence: u8, time: f64, patience: Duration) -> Result<(), Outage> {
        self.owed = Some(sequence);
        let was = self.disarmed;
        match self
            .line
            .wait(sequence, patience.min(self.line.patience()))?
        {
            Some(Answer::State(state)) => self.learn(&state, time)?,
            // It has disarmed itself once more meanwhile.
            Some(Answer::Refused(Why::Token)) => {
                self.owed = Some(self.line.send(&ToTarget::Status)?);
            }
            Some(Answer::Refused(why)) => return Err(self.refused("to be armed again", why, time)),
            Some(other) => return Err(confused(self.line.name(), "status", &other)),
            None if self.line.patience().is_zero() => {
                let wire = self.line.name();
                return Err(Outage::Silent { wire, time });
            }
            None => {}
        }
        if was.is_some() && self.disarmed.is_none() {
            self.report.event(time, "armed again");
            self.heard = Some(time);
        }
        Ok(())
    }

    /// Sends everything that the tick reads.
    fn send_inputs(
        &mut self,
        time: f64,
        counts: Counts,
        readings: &[RangeReading],
    ) -> Result<u8, Outage> {
        self.scan = self.scan.wrapping_add(1);
        let scan = self.scan;
        let mut first = 0;
        while first < readings.len() {
            let mut room = [0; MAX_READINGS];
            let (readings, count) = Readings::pack(&readings[first..], &mut room);
            self.line.send(&ToTarget::Ranges {
                scan,
                first: first as u8,
                readings,
            })?;
            first += count.max(1);
        }
        self.line.send(&ToTarget::Inputs {
            tick: self.next_tick,
            time_us: (time * 1e6).round() as u64 as u32,
            scan,
            counts,
        })
    }

    /// Waits for the record of the question with this sequence number.
    fn await_record(&mut self, sequence: u8, time: f64) -> Result<Reply, Outage> {
        let mut parts: [Option<Vec<u8>>; 3] = [const { None }; 3];
        let mut until = self.line.now() + PROMPT;
        let mut probe = None;
        let end = self.line.now() + FIRST.min(self.line.patience());
        loop {
            let heard = match self.line.is_over(end) {
                true => None,
                false => self.line.next(until)?,
            };
            let Some((answered, answer)) = heard else {
                if self.line.now() >= end {
                    self.owed = probe;
                    return self.lost(time, "no answer");
                }
                // Answers come in the order of questions: this one's tells that the record will not come.
                match probe {
                    None => probe = Some(self.line.send(&ToTarget::Status)?),
                    Some(_) => self.line.send_again()?,
                }
                until = end.min(self.line.now() + 2 * PROMPT);
                continue;
            };
            if answered == sequence || probe == Some(answered) {
                self.line.listen();
            }
            match answer {
                Answer::Part(part, bytes) if answered == sequence && bytes.len() == PART_BYTES => {
                    if let Some(place) = parts.get_mut(usize::from(part)) {
                        *place = Some(bytes);
                    }
                    if let Some(record) = whole(&parts) {
                        return self.take(record, time);
                    }
                }
                Answer::State(state) if answered == sequence => {
                    self.line.traffic.round_trips += 1;
                    self.learn(&state, time)?;
                    self.answered();
                    self.report.disarmed_ticks += 1;
                    let (_, cause) = self.disarmed.unwrap_or((time, state.cause));
                    return Ok(Reply::Disarmed(cause));
                }
                Answer::State(state) if probe == Some(answered) => {
                    self.line.traffic.round_trips += 1;
                    self.learn(&state, time)?;
                    return self.lost(time, "answer lost");
                }
                // Another frame has overtaken it: it is not acted upon. The status tells the rest.
                Answer::Refused(Why::Replayed) if answered == sequence => {
                    if probe.is_none() {
                        until = self.line.now();
                    }
                }
                Answer::Refused(why) if answered == sequence || probe == Some(answered) => {
                    let what = format!("tick {} at {time:.2} s", self.next_tick);
                    return Err(self.refused(&what, why, time));
                }
                _ => self.line.traffic.late += 1,
            }
        }
    }

    /// A record has come.
    fn take(&mut self, bytes: [u8; RECORD_BYTES], time: f64) -> Result<Reply, Outage> {
        self.line.traffic.round_trips += 1;
        let record = record::decode(&bytes);
        let Some(record) = record
            .clone()
            .filter(|record| record.tick == self.next_tick)
        else {
            return Err(Outage::Confused {
                wire: self.line.name(),
                what: format!("tick {} at {time:.2} s", self.next_tick),
                found: match record {
                    Some(record) => format!("the record of tick {}", record.tick),
                    None => "bytes that are no record".to_owned(),
                },
            });
        };
        self.next_tick = self.next_tick.wrapping_add(1);
        self.answered();
        self.report.ticks += 1;
        Ok(Reply::Tick(Box::new(record)))
    }

    /// It has refused what it must not refuse: why, if it can still be asked.
    fn refused(&mut self, what: &str, why: Why, time: f64) -> Outage {
        if let Ok(Some(state)) = status(&mut self.line, FIRST)
            && let Err(outage) = self.learn(&state, time)
        {
            return outage;
        }
        confused(self.line.name(), what, &Answer::Refused(why))
    }

    /// The motors have stopped by themselves, and the robot, which has heard everything, knows nothing of it: a record that
    /// comes through now drives nothing, and the robot is stopped.
    fn stop(&mut self, time: f64) -> Result<Reply, Outage> {
        self.report.event(time, "stopped: its answers were lost");
        self.report.ticks -= 1;
        let sequence = self.line.send(&ToTarget::Stop)?;
        self.settle(sequence, time, FIRST)?;
        match self.disarmed {
            Some((_, cause)) => {
                self.report.disarmed_ticks += 1;
                Ok(Reply::Disarmed(cause))
            }
            None => self.lost(time, "no answer"),
        }
    }

    fn exchange(
        &mut self,
        time: f64,
        counts: Counts,
        readings: &[RangeReading],
    ) -> Result<Reply, Outage> {
        if let Some(sequence) = self.owed {
            self.line.send_again()?;
            self.settle(sequence, time, SILENT)?;
        }
        if self.owed.is_none() {
            self.rearm(time)?;
        }
        if self.owed.is_some() {
            return self.lost(time, "no answer");
        }
        let sequence = self.send_inputs(time, counts, readings)?;
        self.await_record(sequence, time)
    }
}

/// Whether a robot that was disarmed for this cause has started anew.
pub fn is_reset(cause: Cause) -> bool {
    matches!(
        cause,
        Cause::Boot | Cause::Brownout | Cause::Watchdog | Cause::Panic | Cause::HardFault
    )
}

/// The record, when all its parts are there.
fn whole(parts: &[Option<Vec<u8>>; 3]) -> Option<[u8; RECORD_BYTES]> {
    let [Some(a), Some(b), Some(c)] = parts else {
        return None;
    };
    [a.as_slice(), b, c].concat().try_into().ok()
}

impl<const N: usize> Controller<N> for Target {
    type Error = Outage;

    fn tick(&mut self, time: f64, ports: &mut SimPorts<N>) -> Result<Reply, Outage> {
        self.line.wire().period(self.period);
        self.period += 1;
        if self.good > 0 || self.period == 1 {
            // The plant's own work is nobody's silence.
            self.line.listen();
        }
        let counts = Counts::from(ports.encoders.counts());
        let mut readings = vec![RangeReading::NEVER_SEEN; ports.ranges.mounted()];
        ports.ranges.read(&mut readings);
        self.heard.get_or_insert(time);
        let reply = self.exchange(time, counts, &readings)?;
        // Motors that stood stop nowhere, but what was armed may not set off late either.
        let silent = self
            .heard
            .is_some_and(|heard| time - heard > self.silence + 1e-9);
        let late = silent || self.timed_out != ports.drive.timed_out;
        if !matches!(reply, Reply::Lost) {
            self.heard = Some(time);
        }
        match reply {
            Reply::Lost => return Ok(reply),
            Reply::Tick(_) if late => {
                self.timed_out = ports.drive.timed_out;
                return self.stop(time);
            }
            Reply::Tick(ref record) => command(ports, record),
            Reply::Disarmed(_) => self.timed_out = ports.drive.timed_out,
        }
        Ok(reply)
    }
}

fn command<const N: usize>(ports: &mut SimPorts<N>, record: &TickRecord) {
    let Ok(()) = ports.drive.set_speed(Side::Left, record.wheels.left);
    let Ok(()) = ports.drive.set_speed(Side::Right, record.wheels.right);
}

const _: () = assert!(FIRST.as_millis() < LONGEST_SILENCE.as_millis());
