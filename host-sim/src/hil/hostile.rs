//! Frames that nobody honest sends, at a robot that is one message away from driving.

use super::line::{Answer, Line};
use super::report::Received;
use super::target::{self, Target};
use super::wire::Wire;
use super::{HilError, Outage, SENSORS};
use crate::params::params;
use crate::run::{OwnedPath, RunError, drive};
use crate::scenario::Scenario;
use crate::si;
use fuzzypilot::geometry::Pose;
use fuzzypilot::link::frame::{self, Decoder, MAX_FRAME};
use fuzzypilot::link::message::{Cause, Role, ToTarget};
use fuzzypilot::params::Params;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;
use std::time::{Duration, Instant};

/// After so many the robot is looked at.
const BATCH: u64 = 500;

/// After so many its answers are heard.
const HEAR: u64 = 20;

/// Honest ticks that are recorded to be played back.
const TICKS: f64 = 10.0;

/// A byte is given this time on the way, so that a robot as fast as its wire has no queue.
const BYTE: Duration = Duration::from_micros(40);

/// Good frames within which a robot must be heard again.
pub const MOST_GOOD: u32 = 5;

/// A good frame that is not answered by then is followed by the next. How many it took, the answers' order tells, not the
/// time: a robot that is behind answers later.
const NEXT_GOOD: Duration = Duration::from_millis(200);

/// One that has not answered by then, with everything before it to be read, does not hear.
const LAST_ANSWER: Duration = Duration::from_secs(10);

/// A robot that says nothing for this long has nothing more to say to what it has read.
const QUIET: Duration = Duration::from_millis(50);

/// What came of it: `hostile.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct HostileReport {
    /// What the wire led to.
    pub target: String,
    /// Frames of random bytes.
    pub random: u64,
    /// Honest frames cut short.
    pub truncated: u64,
    /// Honest frames with changed bits.
    pub flipped: u64,
    /// Honest frames played back.
    pub replayed: u64,
    /// Of all these, those that met a robot in the role of a monitor, which drives by itself once it is armed.
    pub in_monitor: u64,
    /// Times that the robot was looked at, set up anew, armed, driven for a tick and stopped.
    pub checks: u32,
    /// Most good frames until it was heard again.
    pub recovered_after: u32,
    /// Its time since its start, ms: before the first, and after the last. It never went back.
    pub uptime_ms: (u32, u32),
    /// How long it took, s.
    pub seconds: f64,
    /// Frames that the robot has received, as it says.
    pub received_by_target: Received,
    /// What the robot has logged.
    #[serde(skip)]
    pub log: Vec<u8>,
}

/// An attack.
struct Attack {
    line: Line,
    tape: Vec<Vec<u8>>,
    /// The robot's role, in which it is now.
    role: Role,
    dice: Pcg64Mcg,
    params: Params<SENSORS>,
    path: OwnedPath,
    start: Pose,
    sent: u64,
    /// Bytes sent since the robot was heard.
    on_the_way: u32,
    report: HostileReport,
}

/// Sends `count` hostile frames, and looks at the robot again and again: it must not have moved nor been reset, and must
/// hear good frames again.
///
/// # Errors
///
/// It did not stand it.
pub fn attack(
    scenario: &Scenario,
    seed: u64,
    wire: Box<dyn Wire>,
    count: u64,
) -> Result<HostileReport, HilError> {
    let params: Params<SENSORS> = params(scenario).map_err(RunError::from)?;
    let path = OwnedPath::new(scenario);
    let start = si::pose(scenario.start);
    let begin = Instant::now();

    let mut line = Line::new(wire);
    line.tape = Some(Vec::new());
    let mut target = Target::set_up(line, &params, &path, start, None)?;
    let short = Scenario {
        duration: TICKS * scenario.robot.period,
        ..scenario.clone()
    };
    drive(&short, seed, &params, &mut target, &mut |_| {})?;
    let mut line = target.into_line();
    let tape = thinned(line.tape.take().unwrap_or_default());
    let mut attack = Attack {
        report: HostileReport {
            target: line.name(),
            ..HostileReport::default()
        },
        line,
        tape,
        role: Role::Lockstep,
        dice: Pcg64Mcg::seed_from_u64(seed ^ 0x686f_7374_696c_6500),
        params,
        path,
        start,
        sent: 0,
        on_the_way: 0,
    };
    attack.check()?;
    attack.report.uptime_ms.0 = attack.report.uptime_ms.1;
    attack.report.recovered_after = 0;
    while attack.sent < count {
        attack.strike()?;
        let last = attack.sent == count;
        if attack.sent.is_multiple_of(HEAR) || last {
            attack.hear()?;
        }
        if attack.sent.is_multiple_of(BATCH) || last {
            attack.check()?;
        }
    }
    let mut report = attack.report;
    report.seconds = begin.elapsed().as_secs_f64();
    report.log = attack.line.wire().log();
    Ok(report)
}

/// A tape on which the settings, most of a set-up, do not drown what places, arms and drives the robot.
fn thinned(tape: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
    let mut sets = 0u32;
    let keep = |frame: &Vec<u8>| {
        let mut decoder = Decoder::new();
        let set = frame.iter().any(|byte| match decoder.push(*byte) {
            Some(Ok(frame)) => matches!(frame.parse(), Some(ToTarget::Set { .. })),
            _ => false,
        });
        sets += u32::from(set);
        !set || sets.is_multiple_of(16)
    };
    let mut tape = tape;
    tape.retain(keep);
    tape
}

/// The same frame of a session as a monitor.
fn as_monitor(honest: Vec<u8>) -> Vec<u8> {
    let mut decoder = Decoder::new();
    for byte in &honest {
        if let Some(Ok(frame)) = decoder.push(*byte)
            && let Some(ToTarget::Hello { nonce, .. }) = frame.parse()
        {
            let role = Role::Monitor;
            let mut wire = [0; MAX_FRAME];
            let hello = ToTarget::Hello { nonce, role };
            let hello = frame::encode(frame.sequence, &hello, &mut wire);
            return hello.unwrap_or_default().to_vec();
        }
    }
    honest
}

impl Attack {
    fn below(&mut self, most: usize) -> usize {
        self.dice.random_range(0..most.max(1))
    }

    fn failed(&self, what: String) -> Outage {
        Outage::Fell {
            wire: self.line.name(),
            frames: self.sent,
            what,
        }
    }

    /// Sends one hostile frame.
    fn strike(&mut self) -> Result<(), Outage> {
        let at = self.below(self.tape.len());
        let mut frame = self.tape.get(at).cloned().unwrap_or_default();
        if self.role == Role::Monitor {
            frame = as_monitor(frame);
            self.report.in_monitor += 1;
        }
        match self.below(4) {
            0 => {
                let count = self.below(100);
                frame = std::iter::repeat_with(|| self.dice.random())
                    .take(count)
                    .collect();
                self.report.random += 1;
            }
            1 => {
                let length = self.below(frame.len());
                frame.truncate(length);
                self.report.truncated += 1;
            }
            2 => {
                for _ in 0..=self.below(3) {
                    let (at, bit) = (self.below(frame.len()), self.below(8));
                    if let Some(byte) = frame.get_mut(at) {
                        *byte ^= 1 << bit;
                    }
                }
                self.report.flipped += 1;
            }
            _ => self.report.replayed += 1,
        }
        self.line.send_raw(&frame)?;
        self.sent += 1;
        self.on_the_way += frame.len() as u32;
        Ok(())
    }

    /// Hears what is said to hostile frames.
    fn hear(&mut self) -> Result<(), Outage> {
        let until = self.line.now() + BYTE * std::mem::take(&mut self.on_the_way);
        while let Some((_, answer)) = self.line.next(until)? {
            self.judge(&answer)?;
        }
        Ok(())
    }

    /// Nothing that hostile frames may lead to is a tick or an armed robot.
    fn judge(&self, answer: &Answer) -> Result<(), Outage> {
        match answer {
            Answer::Part(..) => Err(self.failed("it drove a tick".to_owned())),
            Answer::State(state) if state.armed => Err(self.failed("it is armed".to_owned())),
            _ => Ok(()),
        }
    }

    /// Looks at the robot, and leaves it set up, placed and disarmed.
    fn check(&mut self) -> Result<(), Outage> {
        self.hear_out()?;
        let mut asked = Vec::new();
        let good = loop {
            // No retries, and nothing that would end a broken frame but a frame.
            let nonce = self.dice.random();
            let role = Role::Lockstep;
            self.role = role;
            asked.push(self.line.send(&ToTarget::Hello { nonce, role })?);
            let last = asked.len() >= MOST_GOOD as usize;
            let patience = if last { LAST_ANSWER } else { NEXT_GOOD };
            // Answers come in the order of questions: the first is that of the first frame that was heard.
            if let Some(first) = self.welcome(&asked, patience)? {
                break first as u32 + 1;
            }
            if last {
                let good = asked.len();
                return Err(self.failed(format!("it did not hear {good} good frames")));
            }
        };
        // The rest of them are answered before this.
        let sequence = self.line.send(&ToTarget::Status)?;
        let Some(Answer::State(state)) = self.line.wait(sequence, LAST_ANSWER)? else {
            return Err(self.failed("it did not say how it is".to_owned()));
        };
        if state.armed {
            return Err(self.failed("it is armed".to_owned()));
        }
        let back = state.uptime_ms.wrapping_sub(self.report.uptime_ms.1) > i32::MAX as u32;
        if back || target::is_reset(state.cause) {
            return Err(self.failed(format!("it was reset: {}", state.cause)));
        }
        self.report.uptime_ms.1 = state.uptime_ms;
        self.report.recovered_after = self.report.recovered_after.max(good);
        self.report.received_by_target = state.received.into();

        // Whatever was changed, it can be used as before.
        target::upload(&mut self.line, &self.params, &self.path, self.start)?;
        let token = state.token;
        match self.line.ask(&ToTarget::Arm { token })? {
            Answer::State(state) if state.armed => {}
            other => return Err(self.failed(format!("it was not armed: {other:?}"))),
        }
        match self.line.ask(&ToTarget::Stop)? {
            Answer::State(state) if !state.armed && state.cause == Cause::StopCommand => {}
            other => return Err(self.failed(format!("it was not stopped: {other:?}"))),
        }
        if (self.sent / BATCH) % 2 == 1 {
            self.monitor()?;
        }
        self.report.checks += 1;
        Ok(())
    }

    /// Leaves it in the other role, in which its own wheels would turn: placed on its own path, and so one message from driving.
    /// It is not armed here: nobody knows where it stands.
    fn monitor(&mut self) -> Result<(), Outage> {
        target::hello(&mut self.line, Role::Monitor)?;
        self.role = Role::Monitor;
        let (x, y, heading) = (0, 0, 0);
        match self.line.ask(&ToTarget::Begin { x, y, heading })? {
            Answer::Ack => Ok(()),
            other => Err(self.failed(format!("its own path was not begun: {other:?}"))),
        }
    }

    /// Waits until it has answered what it has read so far.
    fn hear_out(&mut self) -> Result<(), Outage> {
        let end = self.line.now() + LAST_ANSWER;
        loop {
            let until = self.line.now() + QUIET;
            match self.line.next(until)? {
                Some((_, answer)) => self.judge(&answer)?,
                None => return Ok(()),
            }
            if self.line.now() >= end {
                return Ok(());
            }
        }
    }

    /// Waits for an answer to a hello; to which of those asked.
    fn welcome(&mut self, asked: &[u8], patience: Duration) -> Result<Option<usize>, Outage> {
        let until = self.line.now() + patience;
        while let Some((answered, answer)) = self.line.next(until)? {
            self.judge(&answer)?;
            let which = asked.iter().position(|sequence| *sequence == answered);
            if let (Some(which), Answer::Welcome(_)) = (which, answer) {
                return Ok(Some(which));
            }
        }
        Ok(None)
    }
}
