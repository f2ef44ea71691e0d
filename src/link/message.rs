//! What is said. In postcard's format: an enum is its variant's number and the fields, `u8` and `bool` a byte, other
//! integers varints, signed ones zigzagged first.
//!
//! The order of variants and fields is the protocol; a change needs a new [`VERSION`](super::frame::VERSION).

use super::frame::MAX_MESSAGE;
use crate::guide::PathError;
use crate::ports::{Fault, Range, RangeReading, WheelCounts};
use crate::units::{Metres, Seconds};
use serde::{Deserialize, Serialize};

/// From the desktop to the robot. Every one but [`ToTarget::Ranges`] is answered by one message, [`ToTarget::Inputs`]
/// and [`ToTarget::Record`] by up to three; refusals included, an answer carries the sequence number of its question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToTarget<'a> {
    /// Begins a session; an armed robot is disarmed. Answer: [`ToHost::Welcome`].
    Hello {
        /// Any number, new in every session.
        nonce: u32,
        /// What the session is for.
        role: Role,
    },
    /// Asks for [`ToHost::State`].
    Status,
    /// Asks for a setting's [`ToHost::Value`].
    Get {
        /// Its id in [`settings`](super::settings).
        id: u16,
    },
    /// Changes a setting; disarmed only, and [`ToTarget::Begin`] is due afterwards. Answer: [`ToHost::Ack`].
    Set {
        /// Its id in [`settings`](super::settings).
        id: u16,
        /// Its raw value.
        value: i32,
    },
    /// Checks settings and path and places the robot at the beginning of the path, tick 0; disarmed only. Answer:
    /// [`ToHost::Ack`].
    Begin {
        /// World x, m / 2¹⁶.
        x: i32,
        /// World y, m / 2¹⁶.
        y: i32,
        /// Heading, turn / 2³².
        heading: i32,
    },
    /// Forgets the path and announces a new one; disarmed only. Answer: [`ToHost::Ack`].
    PathBegin {
        /// What it is made of.
        form: PathForm,
        /// Number of points or segments.
        count: u16,
        /// Whether its end joins its start.
        closed: bool,
        /// Whether its segments may start away from where the ones before end.
        gaps: bool,
    },
    /// The next point. Answer: [`ToHost::Ack`].
    PathPoint {
        /// Its place among them, from 0.
        index: u16,
        /// World x, m / 2¹⁶.
        x: i32,
        /// World y, m / 2¹⁶.
        y: i32,
        /// Tangent, turn / 2³².
        heading: i32,
    },
    /// The next segment, a line. Answer: [`ToHost::Ack`].
    PathLine {
        /// Its place among them, from 0.
        index: u16,
        /// World x of its start, m / 2¹⁶.
        x: i32,
        /// World y of its start, m / 2¹⁶.
        y: i32,
        /// Direction, turn / 2³².
        heading: i32,
        /// Length, m / 2¹⁶.
        length: i32,
    },
    /// The next segment, an arc. Answer: [`ToHost::Ack`].
    PathArc {
        /// Its place among them, from 0.
        index: u16,
        /// World x of the centre, m / 2¹⁶.
        x: i32,
        /// World y of the centre, m / 2¹⁶.
        y: i32,
        /// Radius, m / 2¹⁶.
        radius: i32,
        /// Direction from the centre to its first point, turn / 2³².
        from: i32,
        /// Angle swept, counter-clockwise positive, turn / 2²⁴.
        sweep: i32,
    },
    /// All pieces are there: checks the path. Answer: [`ToHost::Ack`].
    PathEnd,
    /// Arms. Answer: [`ToHost::State`].
    Arm {
        /// The token of the last [`ToHost::Welcome`] or [`ToHost::State`].
        token: u32,
    },
    /// Disarms, whatever its sequence number. Answer: [`ToHost::State`].
    Stop,
    /// Readings for the next [`ToTarget::Inputs`]; lock-step only. Not answered unless refused.
    Ranges {
        /// Number of the scan, as in the inputs that it belongs to.
        scan: u8,
        /// Place of the first reading in the ring.
        first: u8,
        /// The readings.
        #[serde(borrow)]
        readings: Readings<'a>,
    },
    /// Triggers one tick; lock-step only. Answer: three [`ToHost::RecordPart`]s, or [`ToHost::State`] when the robot is
    /// not (or no longer) armed.
    Inputs {
        /// Number of the tick: [`ToHost::State`]'s `tick`, one more every time.
        tick: u32,
        /// Time of the tick, microseconds; wraps.
        time_us: u32,
        /// Number of the scan whose readings belong to it; one more every time.
        scan: u8,
        /// Encoders.
        counts: Counts,
    },
    /// Asks for the last tick's [`ToHost::RecordPart`]s.
    Record,
}

/// From the robot to the desktop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToHost<'a> {
    /// A session has begun.
    Welcome {
        /// Version of the firmware: major, minor, patch.
        firmware: [u8; 3],
        /// Range sensors that it has room for.
        ranges: u8,
        /// Segments of a path that it has room for.
        segments: u16,
        /// Points of a path that it has room for.
        points: u16,
        /// [`RECORD_BYTES`](super::record::RECORD_BYTES).
        record_bytes: u16,
        /// What [`ToTarget::Arm`] must carry.
        token: u32,
    },
    /// How the robot is.
    State {
        /// Whether it drives.
        armed: bool,
        /// Cause of the last disarming.
        cause: Cause,
        /// What [`ToTarget::Arm`] must carry.
        token: u32,
        /// Time since its start, milliseconds; wraps.
        uptime_ms: u32,
        /// Number of the next tick.
        tick: u32,
        /// Sound frames received; wraps.
        good: u32,
        /// Overlong frames received; this and the next three stay at 65 535.
        overlong: u16,
        /// Truncated frames received.
        truncated: u16,
        /// Frames received with a wrong CRC.
        corrupt: u16,
        /// Frames received of another protocol version.
        version: u16,
        /// Deepest stack so far, bytes; 0 if it does not know.
        stack: u32,
        /// Cumulative counts of the robot's own encoders, forward positive, as far as they are known; they wrap.
        left: i32,
        /// Likewise.
        right: i32,
    },
    /// A setting.
    Value {
        /// Its id.
        id: u16,
        /// Its raw value.
        value: i32,
    },
    /// Done.
    Ack,
    /// Not done, and nothing has changed.
    Refused {
        /// Why.
        why: Why,
    },
    /// A part of an encoded [`TickRecord`](crate::signals::TickRecord).
    RecordPart {
        /// Which: 0 is the first.
        part: u8,
        /// [`PART_BYTES`] of it, the last part what is left.
        bytes: &'a [u8],
    },
}

/// Bytes of a record in one [`ToHost::RecordPart`].
pub const PART_BYTES: usize = 52;

/// What a session is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Role {
    /// To look on, to set up, to arm and to stop; the robot drives by its own clock and sensors.
    #[default]
    Monitor,
    /// Hardware in the loop: sensors, encoders and time come in frames, and so do the commands go out; the robot's own
    /// wheels stand.
    Lockstep,
}

/// What a path is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PathForm {
    /// Discrete points with tangents.
    #[default]
    Points,
    /// Lines and arcs.
    Segments,
}

/// Why the robot was disarmed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cause {
    /// It has been switched on.
    #[default]
    Boot,
    /// [`ToTarget::Stop`].
    StopCommand,
    /// The button.
    Button,
    /// The emergency stop.
    Emergency,
    /// Lock-step: 200 ms went by without inputs; where the period is not shorter, a period and 200 ms.
    LinkTimeout,
    /// Lock-step: inputs for another tick than the next one, or time running backwards.
    Sequence,
    /// [`ToTarget::Hello`], or the end of a session that fell silent.
    NewSession,
    /// The board replaced settings or path.
    SettingsChanged,
    /// A wheel could not be commanded.
    DriveFault,
    /// The path is over, and the robot stands.
    PathOver,
    /// The control loop stood still for as long.
    Overrun,
    /// The supply was too low.
    Brownout,
    /// The watchdog has reset it.
    Watchdog,
    /// The program panicked.
    Panic,
    /// The processor trapped.
    HardFault,
}

impl core::fmt::Display for Cause {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Boot => "switched on",
            Self::StopCommand => "stop command",
            Self::Button => "button",
            Self::Emergency => "emergency stop",
            Self::LinkTimeout => "no inputs in time",
            Self::Sequence => "inputs out of sequence",
            Self::NewSession => "new session",
            Self::SettingsChanged => "settings changed",
            Self::DriveFault => "drive fault",
            Self::PathOver => "path over",
            Self::Overrun => "control loop stood still",
            Self::Brownout => "supply too low",
            Self::Watchdog => "watchdog reset",
            Self::Panic => "panic",
            Self::HardFault => "hard fault",
        })
    }
}

/// Why something was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Why {
    /// The frame is sound, its message is none that is known here.
    Malformed,
    /// The frame is of another protocol version; the refusal is of this one.
    Version,
    /// No session: [`ToTarget::Hello`] comes first.
    NoSession,
    /// A sequence number of the past, or more than 32 ahead.
    Replayed,
    /// Only in the other role.
    Role,
    /// Only while disarmed.
    NotDisarmed,
    /// The token is not the current one.
    Token,
    /// [`ToTarget::Begin`] is due first.
    NotBegun,
    /// The emergency stop is pressed.
    Emergency,
    /// The wheels cannot be commanded.
    DriveFault,
    /// No setting has this id, or no sensor that it belongs to is mounted.
    UnknownId {
        /// The id.
        id: u16,
    },
    /// This setting may not have this value, alone or beside the others.
    Setting {
        /// Its id.
        id: u16,
    },
    /// No path is stored.
    NoPath,
    /// The path cannot be driven.
    Path {
        /// Why not.
        error: PathFault,
    },
    /// A piece of the path other than the expected one.
    OutOfSequence {
        /// Index of the expected one.
        expected: u16,
    },
    /// More points, segments or sensors than there is room for or mounts of.
    TooMany {
        /// The most.
        most: u16,
    },
    /// No tick has been driven yet.
    NoRecord,
    /// Settings and path are those of a lock-step session that is over, not the robot's own.
    Foreign,
}

impl core::fmt::Display for Why {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Malformed => f.write_str("message not understood"),
            Self::Version => f.write_str("another protocol version"),
            Self::NoSession => f.write_str("no session: hello comes first"),
            Self::Replayed => f.write_str("sequence number of the past, or more than 32 ahead"),
            Self::Role => f.write_str("not in this role"),
            Self::NotDisarmed => f.write_str("only while disarmed"),
            Self::Token => f.write_str("not the current token"),
            Self::NotBegun => f.write_str("begin comes first"),
            Self::Emergency => f.write_str("the emergency stop is pressed"),
            Self::DriveFault => f.write_str("the wheels cannot be commanded"),
            Self::UnknownId { id } => write!(f, "no setting {id}"),
            Self::Setting { id } => {
                let name = super::settings::describe(*id).map_or("?", |setting| setting.name);
                write!(f, "value not allowed for setting {id}, {name}")
            }
            Self::NoPath => f.write_str("no path"),
            Self::Path { error } => write!(f, "path: {error}"),
            Self::OutOfSequence { expected } => write!(f, "piece {expected} of the path is due"),
            Self::TooMany { most } => write!(f, "too many: at most {most}"),
            Self::NoRecord => f.write_str("no tick yet"),
            Self::Foreign => {
                f.write_str("settings and path of a plant: switch the robot off and on")
            }
        }
    }
}

/// A [`PathError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PathFault {
    /// [`PathError::TooShort`].
    TooShort,
    /// [`PathError::TooMany`].
    TooMany,
    /// [`PathError::Degenerate`].
    Degenerate {
        /// Index of the piece.
        piece: u16,
    },
    /// [`PathError::Gap`].
    Gap {
        /// Index of the piece.
        piece: u16,
    },
}

impl From<PathError> for PathFault {
    fn from(error: PathError) -> Self {
        // Paths have at most 4096 pieces.
        let narrow = |piece: usize| u16::try_from(piece).unwrap_or(u16::MAX);
        match error {
            PathError::TooShort => Self::TooShort,
            PathError::TooMany => Self::TooMany,
            PathError::Degenerate(piece) => Self::Degenerate {
                piece: narrow(piece),
            },
            PathError::Gap(piece) => Self::Gap {
                piece: narrow(piece),
            },
        }
    }
}

impl From<PathFault> for PathError {
    fn from(fault: PathFault) -> Self {
        match fault {
            PathFault::TooShort => Self::TooShort,
            PathFault::TooMany => Self::TooMany,
            PathFault::Degenerate { piece } => Self::Degenerate(piece.into()),
            PathFault::Gap { piece } => Self::Gap(piece.into()),
        }
    }
}

impl core::fmt::Display for PathFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        PathError::from(*self).fmt(f)
    }
}

/// A [`Fault`] of a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PortFault {
    /// [`Fault::NeverSeen`].
    NeverSeen,
    /// [`Fault::Timeout`].
    Timeout,
    /// [`Fault::Bus`].
    Bus,
    /// [`Fault::OutOfRange`].
    OutOfRange,
    /// [`Fault::Stale`].
    Stale,
}

impl From<Fault> for PortFault {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::NeverSeen => Self::NeverSeen,
            Fault::Timeout => Self::Timeout,
            Fault::Bus => Self::Bus,
            Fault::OutOfRange => Self::OutOfRange,
            Fault::Stale => Self::Stale,
        }
    }
}

impl From<PortFault> for Fault {
    fn from(fault: PortFault) -> Self {
        match fault {
            PortFault::NeverSeen => Self::NeverSeen,
            PortFault::Timeout => Self::Timeout,
            PortFault::Bus => Self::Bus,
            PortFault::OutOfRange => Self::OutOfRange,
            PortFault::Stale => Self::Stale,
        }
    }
}

/// What the encoders say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Counts {
    /// Cumulative counts, forward positive; they wrap.
    Known {
        /// Left wheel.
        left: i32,
        /// Right wheel.
        right: i32,
    },
    /// Unknown this tick.
    Unknown {
        /// Why.
        fault: PortFault,
    },
}

impl From<Result<WheelCounts, Fault>> for Counts {
    fn from(counts: Result<WheelCounts, Fault>) -> Self {
        match counts {
            Ok(WheelCounts { left, right }) => Self::Known { left, right },
            Err(fault) => Self::Unknown {
                fault: fault.into(),
            },
        }
    }
}

impl From<Counts> for Result<WheelCounts, Fault> {
    fn from(counts: Counts) -> Self {
        match counts {
            Counts::Known { left, right } => Ok(WheelCounts { left, right }),
            Counts::Unknown { fault } => Err(fault.into()),
        }
    }
}

/// One sensor's reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reading {
    /// An echo.
    Echo {
        /// Its distance, m / 2¹⁶.
        range: i32,
        /// Time since it was measured, s / 2²⁴.
        age: i32,
    },
    /// Nothing up to the largest range.
    Clear {
        /// Time since it was measured, s / 2²⁴.
        age: i32,
    },
    /// No usable reading.
    Invalid {
        /// Why.
        fault: PortFault,
        /// Time since then, s / 2²⁴.
        age: i32,
    },
}

impl From<RangeReading> for Reading {
    fn from(reading: RangeReading) -> Self {
        let age = reading.age.bits();
        match reading.range {
            Range::Echo(range) => Self::Echo {
                range: range.bits(),
                age,
            },
            Range::Clear => Self::Clear { age },
            Range::Invalid(fault) => Self::Invalid {
                fault: fault.into(),
                age,
            },
        }
    }
}

impl From<Reading> for RangeReading {
    fn from(reading: Reading) -> Self {
        let (range, age) = match reading {
            Reading::Echo { range, age } => (Range::Echo(Metres::from_bits(range)), age),
            Reading::Clear { age } => (Range::Clear, age),
            Reading::Invalid { fault, age } => (Range::Invalid(fault.into()), age),
        };
        Self {
            range,
            age: Seconds::from_bits(age),
        }
    }
}

/// Bytes of readings in one [`ToTarget::Ranges`]: what its tag, `scan`, `first` and the length leave.
pub const MAX_READINGS: usize = MAX_MESSAGE - 4;

/// Encoded [`Reading`]s one behind the other. They stay bytes until they are looked at: a typical one is five bytes
/// here and twelve in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Readings<'a>(&'a [u8]);

impl<'a> Readings<'a> {
    /// As many of the `readings`, from the first on, as `room` takes; and how many these are: four or more, if there
    /// are as many.
    pub fn pack(readings: &[RangeReading], room: &'a mut [u8; MAX_READINGS]) -> (Self, usize) {
        let (mut end, mut count) = (0usize, 0usize);
        for reading in readings {
            let left = room.get_mut(end..).unwrap_or_default();
            let Ok(bytes) = postcard::to_slice(&Reading::from(*reading), left) else {
                break;
            };
            end = end.saturating_add(bytes.len());
            count = count.saturating_add(1);
        }
        (Self(room.get(..end).unwrap_or_default()), count)
    }

    /// The readings; `None` for the first that cannot be understood, and nothing after it.
    pub fn iter(self) -> impl Iterator<Item = Option<RangeReading>> + 'a {
        let mut rest = self.0;
        core::iter::from_fn(move || {
            if rest.is_empty() {
                return None;
            }
            let reading = postcard::take_from_bytes::<Reading>(rest).ok();
            rest = reading.map_or(&[], |(_, rest)| rest);
            Some(reading.map(|(reading, _)| reading.into()))
        })
    }
}
