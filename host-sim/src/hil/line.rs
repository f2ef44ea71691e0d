//! Frames over a wire: sequence numbers, answers, the same bytes once more when no answer comes.

use super::wire::Wire;
use super::{LONGEST_SILENCE, Outage};
use fuzzypilot::link::frame::{self, Counters, Decoder, FrameError, MAX_FRAME};
use fuzzypilot::link::message::{Cause, ToHost, ToTarget, Why};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// An unanswered question is asked again after this.
pub const AGAIN: Duration = Duration::from_millis(200);

/// The longest wait without a look around.
const GLANCE: Duration = Duration::from_millis(50);

/// What has come by the end of a wait is still read for this long; who never stops sending is not waited for.
const LEFTOVERS: Duration = Duration::from_millis(50);

/// Set when the program is to end: every wait ends soon.
pub static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// How the robot is, as it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// Whether it drives.
    pub armed: bool,
    /// Cause of the last disarming.
    pub cause: Cause,
    /// What arms it.
    pub token: u32,
    /// Time since its start, ms.
    pub uptime_ms: u32,
    /// Number of the next tick.
    pub tick: u32,
    /// Frames that it has received.
    pub received: Counters,
    /// Its deepest stack, bytes; 0 if it does not know.
    pub stack: u32,
}

/// What the robot can do, as it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Welcome {
    /// Its firmware's version.
    pub firmware: [u8; 3],
    /// Room for range sensors.
    pub ranges: u8,
    /// Room for segments.
    pub segments: u16,
    /// Room for points.
    pub points: u16,
    /// Length of a record.
    pub record_bytes: u16,
    /// What arms it.
    pub token: u32,
}

/// An answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// A session has begun.
    Welcome(Welcome),
    /// How it is.
    State(State),
    /// A setting's raw value.
    Value(i32),
    /// Done.
    Ack,
    /// Not done.
    Refused(Why),
    /// A part of a record.
    Part(u8, Vec<u8>),
    /// A sound frame with an unknown message.
    Unknown,
}

impl From<ToHost<'_>> for Answer {
    fn from(message: ToHost<'_>) -> Self {
        match message {
            ToHost::Welcome {
                firmware,
                ranges,
                segments,
                points,
                record_bytes,
                token,
            } => Self::Welcome(Welcome {
                firmware,
                ranges,
                segments,
                points,
                record_bytes,
                token,
            }),
            ToHost::State {
                armed,
                cause,
                token,
                uptime_ms,
                tick,
                good,
                overlong,
                truncated,
                corrupt,
                version,
                stack,
                ..
            } => Self::State(State {
                armed,
                cause,
                token,
                uptime_ms,
                tick,
                received: Counters {
                    good,
                    overlong,
                    truncated,
                    corrupt,
                    version,
                },
                stack,
            }),
            ToHost::Value { value, .. } => Self::Value(value),
            ToHost::Ack => Self::Ack,
            ToHost::Refused { why } => Self::Refused(why),
            ToHost::RecordPart { part, bytes } => Self::Part(part, bytes.to_vec()),
        }
    }
}

/// What went over the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Frames sent.
    pub sent: u64,
    /// Bytes sent.
    pub sent_bytes: u64,
    /// Frames received, by their state.
    pub received: Counters,
    /// Bytes received.
    pub received_bytes: u64,
    /// Questions that were answered.
    pub round_trips: u64,
    /// Frames sent once more.
    pub retries: u64,
    /// Answers to questions that nobody waited for any more.
    pub late: u64,
}

/// The desktop's end of a link.
pub struct Line {
    wire: Box<dyn Wire>,
    decoder: Decoder,
    inbox: VecDeque<u8>,
    sequence: u8,
    /// The last frame.
    last: Vec<u8>,
    heard: Duration,
    /// What went over it.
    pub traffic: Traffic,
    /// Every frame sent, if somebody wants to know.
    pub tape: Option<Vec<Vec<u8>>>,
}

impl Line {
    /// Over a wire, from now on.
    pub fn new(wire: Box<dyn Wire>) -> Self {
        let heard = wire.now();
        Self {
            wire,
            decoder: Decoder::new(),
            inbox: VecDeque::new(),
            sequence: 0,
            last: Vec::new(),
            heard,
            traffic: Traffic::default(),
            tape: None,
        }
    }

    /// What it leads to.
    pub fn name(&self) -> String {
        self.wire.name()
    }

    /// The wire.
    pub fn wire(&mut self) -> &mut dyn Wire {
        &mut *self.wire
    }

    /// The time by which it waits.
    pub fn now(&self) -> Duration {
        self.wire.now()
    }

    /// Begins to count silence anew: it has answered. What nobody has asked for is no answer.
    pub fn listen(&mut self) {
        self.heard = self.wire.now();
    }

    /// What is left until nobody would believe in an answer any more.
    pub fn patience(&self) -> Duration {
        (self.heard + LONGEST_SILENCE).saturating_sub(self.wire.now())
    }

    fn gone(&mut self, error: &std::io::Error) -> Outage {
        Outage::Gone {
            wire: self.wire.name(),
            why: self.wire.last_words().unwrap_or_else(|| error.to_string()),
        }
    }

    /// Sends any bytes.
    pub fn send_raw(&mut self, bytes: &[u8]) -> Result<(), Outage> {
        self.traffic.sent += 1;
        self.traffic.sent_bytes += bytes.len() as u64;
        self.wire.send(bytes).map_err(|error| self.gone(&error))
    }

    /// Sends a message; the sequence number of its answer.
    pub fn send(&mut self, message: &ToTarget<'_>) -> Result<u8, Outage> {
        self.sequence = self.sequence.wrapping_add(1);
        let mut wire = [0; MAX_FRAME];
        let frame = frame::encode(self.sequence, message, &mut wire).unwrap_or_default();
        self.last = frame.to_vec();
        if let Some(tape) = &mut self.tape {
            tape.push(frame.to_vec());
        }
        self.send_raw(frame)?;
        Ok(self.sequence)
    }

    /// Sends the last message's bytes once more; a robot that has acted upon it answers only.
    pub fn send_again(&mut self) -> Result<(), Outage> {
        self.traffic.retries += 1;
        let last = std::mem::take(&mut self.last);
        let done = self.send_raw(&last);
        self.last = last;
        done
    }

    /// The next sound frame until then, if one comes: its sequence number and what it says.
    pub fn next(&mut self, until: Duration) -> Result<Option<(u8, Answer)>, Outage> {
        loop {
            while let Some(byte) = self.inbox.pop_front() {
                let Some(result) = self.decoder.push(byte) else {
                    continue;
                };
                self.traffic.received.note(&result);
                match result {
                    Ok(frame) => {
                        let answer = frame.parse::<ToHost<'_>>();
                        let answer = answer.map_or(Answer::Unknown, Answer::from);
                        return Ok(Some((frame.sequence, answer)));
                    }
                    Err(FrameError::Version { found, .. }) => {
                        let wire = self.name();
                        return Err(Outage::Protocol { wire, found });
                    }
                    Err(_) => {}
                }
            }
            let now = self.wire.now();
            if INTERRUPTED.load(Ordering::Relaxed) {
                return Err(Outage::Interrupted);
            }
            let mut bytes = [0; 1024];
            let left = until.saturating_sub(now).min(GLANCE);
            let count = match self.wire.receive(&mut bytes, left) {
                Ok(count) => count,
                Err(error) => return Err(self.gone(&error)),
            };
            self.traffic.received_bytes += count as u64;
            self.inbox.extend(bytes.iter().take(count));
            if now >= until && (count == 0 || self.is_over(until)) {
                return Ok(None);
            }
        }
    }

    /// Whether a wait until then has lasted too long, even if there is something to read.
    pub fn is_over(&self, until: Duration) -> bool {
        self.wire.now() >= until + LEFTOVERS
    }

    /// Asks, and asks again, until there is an answer or `patience` is over.
    pub fn try_ask(
        &mut self,
        message: &ToTarget<'_>,
        patience: Duration,
    ) -> Result<Option<Answer>, Outage> {
        let sequence = self.send(message)?;
        self.wait(sequence, patience)
    }

    /// Waits for the answer to the last message, asking again meanwhile.
    pub fn wait(&mut self, sequence: u8, patience: Duration) -> Result<Option<Answer>, Outage> {
        let end = self.wire.now() + patience;
        let mut again = self.wire.now() + AGAIN;
        loop {
            match self.next(again.min(end))? {
                Some((answered, answer)) if answered == sequence => {
                    self.listen();
                    self.traffic.round_trips += 1;
                    return Ok(Some(answer));
                }
                Some(_) => {
                    self.traffic.late += 1;
                    if self.is_over(end) {
                        return Ok(None);
                    }
                }
                None if self.wire.now() >= end => return Ok(None),
                None => {
                    self.send_again()?;
                    again = self.wire.now() + AGAIN;
                }
            }
        }
    }

    /// Asks until there is an answer, or the robot has been silent for too long.
    pub fn ask(&mut self, message: &ToTarget<'_>) -> Result<Answer, Outage> {
        self.listen();
        match self.try_ask(message, LONGEST_SILENCE)? {
            Some(answer) => Ok(answer),
            None => Err(Outage::Mute { wire: self.name() }),
        }
    }
}
