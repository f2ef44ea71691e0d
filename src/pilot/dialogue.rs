//! Messages in, answers out.

use super::Core;
use super::Upload;
use super::session::Answer;
use crate::geometry::{Point, Pose};
use crate::guide::{Segment, StoreError, Waypoint};
use crate::link::frame::{self, Counters, Frame, MAX_FRAME};
use crate::link::message::{
    Cause, Counts, PART_BYTES, PathForm, Readings, Role, ToHost, ToTarget, Why,
};
use crate::link::record::RECORD_BYTES;
use crate::link::settings::{self, SetError};
use crate::units::{Angle, Metres};

/// This library's version.
const FIRMWARE: [u8; 3] = [
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

impl<const N: usize, const SEGMENTS: usize, const POINTS: usize> Core<N, SEGMENTS, POINTS> {
    /// Acts on a frame and answers it.
    pub(super) fn take(
        &mut self,
        frame: Frame<'_>,
        counters: Counters,
        now_us: u32,
        out: &mut impl FnMut(&[u8]),
    ) {
        self.clock(now_us);
        self.heard_us = now_us;
        let (sequence, check) = (frame.sequence, frame.check);
        let answer = match self.session.again(sequence, check) {
            Some(answer) => answer,
            None => {
                let message = frame.parse();
                let answer = match (self.session.admits(sequence, message.as_ref()), message) {
                    (Ok(()), Some(message)) => self.act(message, now_us),
                    (Err(why), _) => Answer::Refused(why),
                    (Ok(()), None) => Answer::Refused(Why::Malformed),
                };
                let hello = matches!(message, Some(ToTarget::Hello { .. }));
                self.session.note(sequence, check, hello, answer);
                answer
            }
        };
        self.send(sequence, answer, counters, out);
    }

    fn act(&mut self, message: ToTarget<'_>, now_us: u32) -> Answer {
        match message {
            ToTarget::Hello { nonce, role } => self.hello(nonce, role, now_us),
            ToTarget::Status => Answer::State,
            ToTarget::Get { id } => match settings::get(self.robot.params(), id) {
                Some(value) => Answer::Value { id, value },
                None => Answer::Refused(Why::UnknownId { id }),
            },
            ToTarget::Set { id, value } => self.set(id, value).into(),
            ToTarget::Begin { x, y, heading } => self.begin(pose(x, y, heading)).into(),
            ToTarget::PathBegin {
                form,
                count,
                closed,
                gaps,
            } => self.path_begin(form, count, closed, gaps).into(),
            ToTarget::PathPoint {
                index,
                x,
                y,
                heading,
            } => {
                let point: Waypoint = pose(x, y, heading);
                self.piece(index, |core| core.path.push_point(point)).into()
            }
            ToTarget::PathLine {
                index,
                x,
                y,
                heading,
                length,
            } => {
                let line = Segment::line(pose(x, y, heading), Metres::from_bits(length));
                self.piece(index, |core| core.path.push_segment(line))
                    .into()
            }
            ToTarget::PathArc {
                index,
                x,
                y,
                radius,
                from,
                sweep,
            } => {
                let arc = Segment::Arc {
                    centre: Point::new(Metres::from_bits(x), Metres::from_bits(y)),
                    radius: Metres::from_bits(radius),
                    from: Angle::from_bits(from),
                    sweep,
                };
                self.piece(index, |core| core.path.push_segment(arc)).into()
            }
            ToTarget::PathEnd => self.path_end().into(),
            ToTarget::Arm { token } if token != self.arming.token() => Answer::Refused(Why::Token),
            ToTarget::Arm { .. } => match self.arming.arm() {
                Ok(()) => Answer::State,
                Err(why) => Answer::Refused(why),
            },
            ToTarget::Stop => {
                self.disarm(Cause::StopCommand);
                Answer::Stopped
            }
            ToTarget::Ranges {
                scan,
                first,
                readings,
            } => self.ranges(scan, first, readings),
            ToTarget::Inputs {
                tick,
                time_us,
                scan,
                counts,
            } => self.inputs(tick, time_us, scan, counts),
            ToTarget::Record if self.recorded => Answer::Record,
            ToTarget::Record => Answer::Refused(Why::NoRecord),
        }
    }

    fn hello(&mut self, nonce: u32, role: Role, now_us: u32) -> Answer {
        self.disarm(Cause::NewSession);
        self.arming.open(nonce, now_us);
        self.upload = None;
        // A monitor that comes back finds the robot as it left it; a plant is a new one every time.
        if role == Role::Lockstep || self.session.role == Role::Lockstep {
            self.come_home();
        }
        self.foreign |= role == Role::Lockstep;
        self.session.open(role);
        Answer::Welcome
    }

    fn set(&mut self, id: u16, value: i32) -> Result<(), Why> {
        if self.arming.is_armed() {
            return Err(Why::NotDisarmed);
        }
        settings::set(self.robot.params_mut(), id, value).map_err(|error| match error {
            SetError::UnknownId => Why::UnknownId { id },
            SetError::NotAllowed => Why::Setting { id },
        })?;
        self.arming.begun = false;
        Ok(())
    }

    fn path_begin(
        &mut self,
        form: PathForm,
        count: u16,
        closed: bool,
        gaps: bool,
    ) -> Result<(), Why> {
        if self.arming.is_armed() {
            return Err(Why::NotDisarmed);
        }
        let room = match form {
            PathForm::Points => POINTS,
            PathForm::Segments => SEGMENTS,
        };
        if usize::from(count) > room {
            return Err(Why::TooMany { most: narrow(room) });
        }
        match form {
            PathForm::Points => self.path.begin_points(closed),
            PathForm::Segments => self.path.begin_segments(closed),
        }
        self.upload = Some(Upload { count, gaps });
        self.arming.begun = false;
        Ok(())
    }

    /// Stores a piece, if it is the next.
    fn piece(
        &mut self,
        index: u16,
        store: impl FnOnce(&mut Self) -> Result<(), StoreError>,
    ) -> Result<(), Why> {
        let expected = narrow(self.path.stored());
        let Some(upload) = self.upload else {
            return Err(Why::OutOfSequence { expected: 0 });
        };
        if expected >= upload.count {
            return Err(Why::TooMany { most: upload.count });
        }
        if index != expected {
            return Err(Why::OutOfSequence { expected });
        }
        // Room there is; so it is of the other form.
        store(self).map_err(|_| Why::OutOfSequence { expected })
    }

    fn path_end(&mut self) -> Result<(), Why> {
        let Some(upload) = self.upload else {
            return Err(Why::OutOfSequence { expected: 0 });
        };
        let expected = narrow(self.path.stored());
        if expected != upload.count {
            return Err(Why::OutOfSequence { expected });
        }
        self.upload = None;
        self.path.commit(upload.gaps).map_err(|error| Why::Path {
            error: error.into(),
        })
    }

    fn ranges(&mut self, scan: u8, first: u8, readings: Readings<'_>) -> Answer {
        if self.session.role != Role::Lockstep {
            return Answer::Refused(Why::Role);
        }
        let mounted = self.robot.params().ring.mounts.len();
        let mut end = usize::from(first);
        for reading in readings.iter() {
            if reading.is_none() {
                return Answer::Refused(Why::Malformed);
            }
            end = end.saturating_add(1);
        }
        if end > mounted {
            let most = narrow(mounted);
            return Answer::Refused(Why::TooMany { most });
        }
        self.scan.turn_to(scan);
        self.scan.take(first, readings);
        Answer::Silence
    }

    /// One tick of a lock-step session.
    fn inputs(&mut self, tick: u32, time_us: u32, scan: u8, counts: Counts) -> Answer {
        if self.session.role != Role::Lockstep {
            return Answer::Refused(Why::Role);
        }
        self.scan.turn_to(scan);
        if self.arming.is_armed() {
            let elapsed = self.ticked_us.map_or(1, |last| time_us.wrapping_sub(last));
            if (1..=i32::MAX as u32).contains(&elapsed) && !self.in_time(time_us) {
                self.disarm(Cause::LinkTimeout);
            } else if tick != self.next_tick || !(1..=i32::MAX as u32).contains(&elapsed) {
                self.disarm(Cause::Sequence);
            }
        }
        let mut ports = self.scan.ports(counts.into());
        let path = self.path.path().filter(|_| self.arming.is_armed());
        let Some(path) = path else {
            // Where the wheels roll to while they are stopped is not lost.
            let _ = self.robot.rest(&mut ports);
            return Answer::State;
        };
        let record = self.robot.tick(&path, &mut ports);
        self.scan.clear();
        self.ticked(time_us, &record);
        Answer::Record
    }

    /// Sends an answer.
    pub(super) fn send(
        &self,
        sequence: u8,
        answer: Answer,
        counters: Counters,
        out: &mut impl FnMut(&[u8]),
    ) {
        let mut say = |message: ToHost<'_>| {
            let mut wire = [0; MAX_FRAME];
            if let Some(wire) = frame::encode(sequence, &message, &mut wire) {
                out(wire);
            }
        };
        match answer {
            Answer::Silence => {}
            Answer::Welcome => say(ToHost::Welcome {
                firmware: FIRMWARE,
                ranges: u8::try_from(N).unwrap_or(u8::MAX),
                segments: narrow(SEGMENTS),
                points: narrow(POINTS),
                record_bytes: RECORD_BYTES as u16,
                token: self.arming.token(),
            }),
            Answer::State | Answer::Stopped => say(ToHost::State {
                armed: self.arming.is_armed(),
                cause: self.arming.cause(),
                token: self.arming.token(),
                uptime_ms: (self.uptime_us / 1000) as u32,
                tick: self.next_tick,
                good: counters.good,
                overlong: counters.overlong,
                truncated: counters.truncated,
                corrupt: counters.corrupt,
                version: counters.version,
                stack: self.stack,
                left: self.counts.left,
                right: self.counts.right,
            }),
            Answer::Value { id, value } => say(ToHost::Value { id, value }),
            Answer::Ack => say(ToHost::Ack),
            Answer::Refused(why) => say(ToHost::Refused { why }),
            Answer::Record => {
                let mut part = 0u8;
                for bytes in self.record.chunks(PART_BYTES) {
                    say(ToHost::RecordPart { part, bytes });
                    part = part.saturating_add(1);
                }
            }
        }
    }
}

fn pose(x: i32, y: i32, heading: i32) -> Pose {
    Pose::new(
        Point::new(Metres::from_bits(x), Metres::from_bits(y)),
        Angle::from_bits(heading),
    )
}

/// Capacities are far below this.
fn narrow(count: usize) -> u16 {
    u16::try_from(count).unwrap_or(u16::MAX)
}
