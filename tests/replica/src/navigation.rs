//! The navigator's tape and what is compared of its ticks: a jackal with 16 cones, on its way to a goal or along a path.
//!
//! ```text
//! file     as in `tape`, with these tapes
//! tape     word ticks (above 0), word points, then the path's poses, or a goal's x and y where there are 0 points; tick…
//! tick     pose, then a reading of each of the 16 cones
//! ```

use crate::tape::{Sink, Source, reading};
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{Path, StoredPath, Waypoint};
use fuzzypilot::navigate::{NavigationRecord, Navigator, Setup, Task, presets};
use fuzzypilot::params::ParamError;
use fuzzypilot::ports::RangeReading;
use fuzzypilot::units::{Angle, Metres};

/// Range sensors.
pub const CONES: usize = 16;

/// The most points of a path on tape.
pub const POINTS: usize = 128;

/// The navigator that is counted.
pub type Engine = Navigator<CONES>;

/// Its settings.
///
/// # Errors
///
/// None, as long as the preset is sound.
pub fn setup() -> Result<Setup<CONES>, ParamError> {
    presets::jackal().setup()
}

/// Where a run leads, on tape.
#[derive(Clone, Copy, Debug)]
pub enum Way<'a> {
    /// To a place.
    Goal(Point),
    /// Along points, [`POINTS`] at most.
    Path(&'a [Waypoint]),
}

/// Where a run leads, read from a tape.
#[derive(Debug)]
pub struct Course {
    goal: Point,
    path: StoredPath<1, POINTS>,
}

impl Default for Course {
    fn default() -> Self {
        Self::new()
    }
}

impl Course {
    /// Nowhere.
    pub const fn new() -> Self {
        Self {
            goal: Point::new(Metres::ZERO, Metres::ZERO),
            path: StoredPath::new(),
        }
    }

    /// Reads a tape's.
    ///
    /// # Errors
    ///
    /// A path that is too long or cannot be driven.
    pub fn read(&mut self, from: &mut impl Source) -> Result<(), &'static str> {
        let points = from.word();
        self.path.begin_points(false);
        if points <= 0 {
            self.goal = from.point();
            return Ok(());
        }
        for _ in 0..points {
            let point = from.pose();
            self.path
                .push_point(point)
                .map_err(|_| "the path is too long")?;
        }
        self.path
            .commit(false)
            .map_err(|_| "the path cannot be driven")
    }

    /// The path, if there is one.
    pub fn path(&self) -> Option<Path<'_>> {
        self.path.path()
    }

    /// The navigator's task.
    pub fn task<'a>(&self, path: &'a Option<Path<'a>>) -> Task<'a> {
        match path {
            Some(path) => Task::Path(path),
            None => Task::Goal(self.goal),
        }
    }
}

/// Writes a tape's head: all but its ticks.
pub fn head(to: &mut impl Sink, ticks: u32, way: Way<'_>) {
    to.word(ticks as i32);
    match way {
        Way::Goal(goal) => {
            to.word(0);
            to.word(goal.x.bits());
            to.word(goal.y.bits());
        }
        Way::Path(points) => {
            to.word(points.len() as i32);
            for point in points {
                to.pose(*point);
            }
        }
    }
}

/// One tick's inputs.
#[derive(Clone, Debug)]
pub struct Seen {
    /// The believed pose.
    pub pose: Pose,
    /// A reading a cone.
    pub readings: [RangeReading; CONES],
}

impl Default for Seen {
    fn default() -> Self {
        Self::new()
    }
}

impl Seen {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self {
            pose: Pose::new(Point::new(Metres::ZERO, Metres::ZERO), Angle::ZERO),
            readings: [RangeReading::NEVER_SEEN; CONES],
        }
    }

    /// Writes them.
    pub fn write(&self, to: &mut impl Sink) {
        to.pose(self.pose);
        for one in &self.readings {
            reading(to, one);
        }
    }

    /// Reads the next tick's.
    pub fn read(&mut self, from: &mut impl Source) {
        self.pose = from.pose();
        for reading in &mut self.readings {
            *reading = from.reading();
        }
    }
}

/// Bytes of a record: all of a [`NavigationRecord`], and the navigator's digest.
pub const RECORD_BYTES: usize = 3 + 13 * 4;

/// A tick's record, little endian, without padding.
pub fn encode(record: &NavigationRecord, digest: u32) -> [u8; RECORD_BYTES] {
    let mut bytes = Filled {
        bytes: [0; RECORD_BYTES],
        filled: 0,
    };
    let guarded = &record.guarded;
    let flag = |set: bool, bit: u8| if set { bit } else { 0 };
    bytes.put(&[
        record.manoeuvre as u8,
        flag(guarded.slowed, 1) | flag(guarded.gated, 2) | flag(guarded.trapped, 4),
        record.heading.is_some().into(),
    ]);
    for twist in [record.twist, record.wanted, guarded.twist] {
        bytes.word(twist.linear.bits());
        bytes.word(twist.angular.bits());
    }
    let heading = record.heading.unwrap_or_default();
    bytes.word(heading.angle.bits());
    bytes.word(heading.hard.bits());
    bytes.word(heading.soft.bits());
    bytes.word(record.direction.bits());
    bytes.word(record.clearance.bits());
    bytes.word(record.points.into());
    bytes.word(digest.cast_signed());
    bytes.bytes
}

struct Filled {
    bytes: [u8; RECORD_BYTES],
    filled: usize,
}

impl Sink for Filled {
    fn put(&mut self, bytes: &[u8]) {
        let end = self.filled.saturating_add(bytes.len());
        if let Some(place) = self.bytes.get_mut(self.filled..end) {
            place.copy_from_slice(bytes);
        }
        self.filled = end;
    }
}

/// A whole tick, as a firmware calls it.
#[inline(never)]
pub fn tick(
    navigator: &mut Engine,
    setup: &Setup<CONES>,
    seen: &Seen,
    task: Task<'_>,
) -> NavigationRecord {
    navigator.see(setup, &seen.readings);
    navigator.step(setup, seen.pose, task)
}
