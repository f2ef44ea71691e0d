//! Tapes with the records that this machine makes of them.

use anyhow::{Context, ensure};
use fuzzypilot::geometry::Pose;
use fuzzypilot::guide::{Path, PathError};
use fuzzypilot::link::record::{RECORD_BYTES, encode};
use fuzzypilot::params::Params;
use fuzzypilot::ports::{Fault, Ports, RangeReading, WheelCounts};
use fuzzypilot::presets;
use fuzzypilot::tick::Robot;
use host_sim::params::params;
use host_sim::run::{OwnedPath, simulate};
use host_sim::scenario::Scenario;
use host_sim::si;
use replica::tape::{self, Inputs, Mode, NoWheels, Pieces, Sink, Source, Store};

/// One run: its inputs, and the desktop's records of so many bytes each.
#[derive(Clone, Debug)]
pub struct Tape<const BYTES: usize = RECORD_BYTES> {
    /// What was run.
    pub name: String,
    /// Its bytes on tape.
    pub bytes: Vec<u8>,
    /// The records' canonical bytes, `BYTES` a tick.
    pub records: Vec<u8>,
}

impl<const BYTES: usize> Tape<BYTES> {
    /// Number of ticks.
    pub fn ticks(&self) -> usize {
        self.records.len() / BYTES
    }

    /// The record of a tick.
    pub fn record(&self, tick: usize) -> Option<&[u8; BYTES]> {
        self.records.as_chunks().0.get(tick)
    }
}

/// A file of tapes.
pub fn file<'a, const BYTES: usize>(
    mode: Mode,
    tapes: impl IntoIterator<Item = &'a Tape<BYTES>>,
) -> Vec<u8> {
    let mut bytes = Bytes::default();
    tape::begin(&mut bytes, mode);
    for tape in tapes {
        bytes.put(&tape.bytes);
    }
    tape::end(&mut bytes);
    bytes.0
}

/// Records a scenario in closed loop.
pub fn record(scenario: &Scenario, seed: u64) -> anyhow::Result<Tape> {
    let count = scenario.sensors.count;
    let name = format!("{}, seed {seed}, {count} ranges", scenario.name);
    let path = OwnedPath::new(scenario);
    let (pieces, closed, gaps) = match &path {
        OwnedPath::Points(points, closed) => (Pieces::Points(points), *closed, false),
        OwnedPath::Segments(segments, closed, gaps) => (Pieces::Segments(segments), *closed, *gaps),
    };
    let (mut ticks, mut records) = (Bytes::default(), Vec::new());
    let context = || name.clone();
    simulate(scenario, seed, &mut |step| {
        tape::tick(&mut ticks, step.counts, step.readings);
        records.extend(encode(step.record));
    })
    .with_context(context)?;
    let mut settings: Params<64> = params(scenario).with_context(context)?;
    settings.ring.mounts.truncate(count);
    let head = Head {
        settings: &settings,
        start: si::pose(scenario.start),
        pieces,
        closed,
        gaps,
    };
    Ok(Tape {
        name,
        bytes: head.with(&ticks, records.len() / RECORD_BYTES),
        records,
    })
}

/// All of a tape but its ticks.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a> {
    /// Settings.
    pub settings: &'a Params<64>,
    /// Start.
    pub start: Pose,
    /// Path.
    pub pieces: Pieces<'a>,
    /// The path is closed.
    pub closed: bool,
    /// Its pieces need not meet.
    pub gaps: bool,
}

impl Head<'_> {
    fn with(&self, ticks: &Bytes, count: usize) -> Vec<u8> {
        let mut bytes = Bytes::default();
        tape::head(
            &mut bytes,
            count as u32,
            self.settings,
            self.start,
            self.pieces,
            self.closed,
            self.gaps,
        );
        bytes.put(&ticks.0);
        bytes.0
    }

    /// Whether the library drives this path.
    pub fn path(&self) -> Result<(), PathError> {
        match self.pieces {
            Pieces::Points(points) => Path::points(points, self.closed),
            Pieces::Segments(segments) if self.gaps => {
                Path::segments_with_gaps(segments, self.closed)
            }
            Pieces::Segments(segments) => Path::segments(segments, self.closed),
        }
        .map(|_| ())
    }

    /// Puts invented inputs on tape, and plays them for the records.
    pub fn invented<'i>(
        &self,
        name: String,
        inputs: impl IntoIterator<Item = (Result<WheelCounts, Fault>, &'i [RangeReading])>,
    ) -> anyhow::Result<Tape> {
        let (mut ticks, mut count) = (Bytes::default(), 0);
        for (counts, readings) in inputs {
            tape::tick(&mut ticks, counts, readings);
            count += 1;
        }
        let bytes = self.with(&ticks, count);
        let records = play(&bytes).with_context(|| name.clone())?;
        Ok(Tape {
            name,
            bytes,
            records,
        })
    }
}

/// Plays a tape here, as the image does there.
pub fn play(bytes: &[u8]) -> anyhow::Result<Vec<u8>> {
    let mut from = Cursor(bytes);
    let mut robot = Robot::<64>::new(presets::small_robot(), Pose::default());
    let mut store = Store::new();
    let mut inputs = Inputs::new();
    let mut records = Vec::new();
    let ticks = from.word();
    let sensors = from.word() as usize;
    tape::load(&mut from, &mut robot, &mut store).map_err(anyhow::Error::msg)?;
    let path = store.path().context("there is no path")?;
    for _ in 0..ticks {
        inputs.read(&mut from, sensors);
        let mut ports = Ports {
            drive: NoWheels,
            encoders: &inputs,
            ranges: &inputs,
        };
        records.extend(encode(&robot.tick(&path, &mut ports)));
    }
    ensure!(from.0.is_empty(), "the tape is longer than its ticks");
    Ok(records)
}

/// A tape being written.
#[derive(Debug, Default)]
pub(crate) struct Bytes(pub Vec<u8>);

impl Sink for Bytes {
    fn put(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }
}

/// A tape being read.
pub(crate) struct Cursor<'a>(pub &'a [u8]);

impl Source for Cursor<'_> {
    fn byte(&mut self) -> u8 {
        self.0.split_off_first().copied().unwrap_or(0)
    }
}
