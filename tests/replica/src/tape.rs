//! The tape's form: everything that a [`Robot`] needs to run open loop. Little endian, without padding.
//!
//! ```text
//! file     "FPTP", word FORM, word mode (0 records, 1 ticks, 2 stages, 3 stack), tape…, word 0
//!          (the navigator's tapes have a form of their own: `navigation`)
//! tape     word ticks (above 0), word sensors, settings, start pose, path, tick…
//! settings word count, then of each: word id, word raw value (`fuzzypilot::link::settings`, mounts too)
//! pose     words x, y, heading
//! path     word flags (1 points, 2 closed, 4 gaps), word pieces, then of each
//!          point: a pose
//!          segment: 6 words: 0, start pose, length, 0; or 1, centre x, y, radius, from, sweep
//! tick     byte: 0, then words left and right count; or 1 + fault; then a reading of each sensor
//! reading  byte: 0 clear; 1 echo, then word distance; or 2 + fault; plus 128 if a word age follows
//! ```
//!
//! A word has 32 bits. Faults are numbered in the order of [`Fault`].

use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{Segment, StoredPath, Waypoint};
use fuzzypilot::link::settings;
use fuzzypilot::params::{MAX_BEAMS, Params};
use fuzzypilot::ports::{
    Fault, Range, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use fuzzypilot::tick::Robot;
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, Seconds};

const MAGIC: [u8; 4] = *b"FPTP";
const FORM: i32 = 1;

const POINTS: i32 = 1;
const CLOSED: i32 = 2;
const GAPS: i32 = 4;

/// Room for a path on tape.
pub type Store = StoredPath<64, 128>;

/// What a player does with the tapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Writes every record.
    Records,
    /// Counts whole ticks and single inferences.
    Ticks,
    /// Counts stages.
    Stages,
    /// Measures the stack.
    Stack,
}

const MODES: [Mode; 4] = [Mode::Records, Mode::Ticks, Mode::Stages, Mode::Stack];

/// Takes a tape's bytes.
pub trait Sink {
    /// Takes all of `bytes`.
    fn put(&mut self, bytes: &[u8]);

    /// A word.
    fn word(&mut self, word: i32) {
        self.put(&word.to_le_bytes());
    }

    /// A pose.
    fn pose(&mut self, pose: Pose) {
        self.word(pose.at.x.bits());
        self.word(pose.at.y.bits());
        self.word(pose.heading.bits());
    }

    /// A segment.
    fn segment(&mut self, segment: &Segment) {
        match *segment {
            Segment::Line { start, length } => {
                self.word(0);
                self.pose(start);
                self.word(length.bits());
                self.word(0);
            }
            Segment::Arc {
                centre,
                radius,
                from,
                sweep,
            } => {
                self.word(1);
                self.word(centre.x.bits());
                self.word(centre.y.bits());
                self.word(radius.bits());
                self.word(from.bits());
                self.word(sweep);
            }
        }
    }
}

/// Gives a tape's bytes; zeros after its end.
pub trait Source {
    /// The next byte.
    fn byte(&mut self) -> u8;

    /// A word.
    fn word(&mut self) -> i32 {
        let bytes = [self.byte(), self.byte(), self.byte(), self.byte()];
        i32::from_le_bytes(bytes)
    }

    /// A length.
    fn metres(&mut self) -> Metres {
        Metres::from_bits(self.word())
    }

    /// An angle.
    fn angle(&mut self) -> Angle {
        Angle::from_bits(self.word())
    }

    /// A point.
    fn point(&mut self) -> Point {
        Point::new(self.metres(), self.metres())
    }

    /// A pose.
    fn pose(&mut self) -> Pose {
        Pose::new(self.point(), self.angle())
    }

    /// A sensor's reading.
    fn reading(&mut self) -> RangeReading {
        let tag = self.byte();
        let range = match tag & 127 {
            0 => Range::Clear,
            1 => Range::Echo(self.metres()),
            fault => Range::Invalid(fault_of(fault.wrapping_sub(2))),
        };
        let age = match tag & 128 {
            0 => Seconds::ZERO,
            _ => Seconds::from_bits(self.word()),
        };
        RangeReading { range, age }
    }

    /// A segment.
    fn segment(&mut self) -> Segment {
        if self.word() == 0 {
            let line = Segment::line(self.pose(), self.metres());
            self.word();
            return line;
        }
        Segment::Arc {
            centre: self.point(),
            radius: self.metres(),
            from: self.angle(),
            sweep: self.word(),
        }
    }
}

const FAULTS: [Fault; 5] = [
    Fault::NeverSeen,
    Fault::Timeout,
    Fault::Bus,
    Fault::OutOfRange,
    Fault::Stale,
];

fn fault_tag(fault: Fault) -> u8 {
    FAULTS.iter().position(|f| *f == fault).unwrap_or(0) as u8
}

fn fault_of(tag: u8) -> Fault {
    FAULTS.get(usize::from(tag)).copied().unwrap_or(Fault::Bus)
}

/// The path of a tape to be written.
#[derive(Clone, Copy, Debug)]
pub enum Pieces<'a> {
    /// Discrete points.
    Points(&'a [Waypoint]),
    /// Lines and arcs.
    Segments(&'a [Segment]),
}

/// Writes a file's first bytes.
pub fn begin(to: &mut impl Sink, mode: Mode) {
    to.put(&MAGIC);
    to.word(FORM);
    to.word(mode as i32);
}

/// Writes a file's end.
pub fn end(to: &mut impl Sink) {
    to.word(0);
}

/// Writes a tape's head: all but its ticks.
pub fn head<const N: usize>(
    to: &mut impl Sink,
    ticks: u32,
    params: &Params<N>,
    start: Pose,
    pieces: Pieces<'_>,
    closed: bool,
    gaps: bool,
) {
    let sensors = params.ring.mounts.len();
    to.word(ticks as i32);
    to.word(sensors as i32);
    to.word(settings::list(sensors).count() as i32);
    for setting in settings::list(sensors) {
        to.word(i32::from(setting.id));
        to.word(settings::get(params, setting.id).unwrap_or(0));
    }
    to.pose(start);
    let flag = |set: bool, bit: i32| if set { bit } else { 0 };
    let form = flag(closed, CLOSED) | flag(gaps, GAPS);
    match pieces {
        Pieces::Points(points) => {
            to.word(form | POINTS);
            to.word(points.len() as i32);
            for point in points {
                to.pose(*point);
            }
        }
        Pieces::Segments(segments) => {
            to.word(form);
            to.word(segments.len() as i32);
            for segment in segments {
                to.segment(segment);
            }
        }
    }
}

/// Writes one tick's inputs.
pub fn tick(to: &mut impl Sink, counts: Result<WheelCounts, Fault>, readings: &[RangeReading]) {
    match counts {
        Ok(counts) => {
            to.put(&[0]);
            to.word(counts.left);
            to.word(counts.right);
        }
        Err(fault) => to.put(&[1 + fault_tag(fault)]),
    }
    for one in readings {
        reading(to, one);
    }
}

/// Writes a sensor's reading.
pub fn reading(to: &mut impl Sink, reading: &RangeReading) {
    let aged = reading.age != Seconds::ZERO;
    let age = if aged { 128 } else { 0 };
    match reading.range {
        Range::Clear => to.put(&[age]),
        Range::Echo(distance) => {
            to.put(&[1 | age]);
            to.word(distance.bits());
        }
        Range::Invalid(fault) => to.put(&[(2 + fault_tag(fault)) | age]),
    }
    if aged {
        to.word(reading.age.bits());
    }
}

/// Reads a file's first bytes; `None` if they are not a tape's of this form.
pub fn open(from: &mut impl Source) -> Option<Mode> {
    let magic = [from.byte(), from.byte(), from.byte(), from.byte()];
    let form = from.word();
    let mode = usize::try_from(from.word()).ok()?;
    (magic == MAGIC && form == FORM)
        .then(|| MODES.get(mode).copied())
        .flatten()
}

/// Reads a tape's head from its settings on, and puts the robot to its start.
pub fn load<const N: usize>(
    from: &mut impl Source,
    robot: &mut Robot<N>,
    path: &mut Store,
) -> Result<(), &'static str> {
    for _ in 0..from.word() {
        let (id, raw) = (from.word(), from.word());
        let id = u16::try_from(id).map_err(|_| "a setting's id is out of range")?;
        settings::set(robot.params_mut(), id, raw).map_err(|_| "a setting cannot be set")?;
    }
    let start = from.pose();
    let flags = from.word();
    let pieces = from.word();
    let full = "the path is too long";
    if flags & POINTS != 0 {
        path.begin_points(flags & CLOSED != 0);
        for _ in 0..pieces {
            path.push_point(from.pose()).map_err(|_| full)?;
        }
    } else {
        path.begin_segments(flags & CLOSED != 0);
        for _ in 0..pieces {
            path.push_segment(from.segment()).map_err(|_| full)?;
        }
    }
    path.commit(flags & GAPS != 0)
        .map_err(|_| "the path cannot be driven")?;
    robot
        .restart(start)
        .map_err(|_| "the settings cannot be driven with")
}

/// One tick's inputs, as the robot's ports give them.
#[derive(Clone, Debug)]
pub struct Inputs {
    counts: Result<WheelCounts, Fault>,
    readings: [RangeReading; MAX_BEAMS],
}

impl Inputs {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self {
            counts: Err(Fault::NeverSeen),
            readings: [RangeReading::NEVER_SEEN; MAX_BEAMS],
        }
    }

    /// Reads the next tick's.
    pub fn read(&mut self, from: &mut impl Source, sensors: usize) {
        self.counts = match from.byte() {
            0 => Ok(WheelCounts {
                left: from.word(),
                right: from.word(),
            }),
            tag => Err(fault_of(tag.wrapping_sub(1))),
        };
        for reading in self.readings.iter_mut().take(sensors) {
            *reading = from.reading();
        }
    }
}

impl Default for Inputs {
    fn default() -> Self {
        Self::new()
    }
}

impl WheelEncoders for &Inputs {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        self.counts
    }
}

impl RangeSensors for &Inputs {
    fn read(&mut self, readings: &mut [RangeReading]) {
        let seen = self.readings.get(..readings.len()).unwrap_or_default();
        if seen.len() == readings.len() {
            for (reading, seen) in readings.iter_mut().zip(seen) {
                *reading = *seen;
            }
        }
    }
}

/// Wheels that go nowhere: the record holds their command.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoWheels;

impl WheelDrive for NoWheels {
    type Error = core::convert::Infallible;

    fn set_speed(&mut self, _: Side, _: MetresPerSecond) -> Result<(), Self::Error> {
        Ok(())
    }
}
