//! Recorded runs: the shipped navigator with 16 cones in generated worlds, in closed loop.

use crate::tape::{Bytes, Cursor};
use fuzzypilot::geometry::Point;
use fuzzypilot::navigate::{NavigationRecord, Setup};
use fuzzypilot::ports::{Range, RangeReading};
use fuzzypilot::units::Metres;
use host_sim::bench::arena::Arena;
use host_sim::bench::attempt::{Setting, drive};
use host_sim::bench::body::JACKAL;
use host_sim::bench::discs::Discs;
use host_sim::bench::navigator::{Command, Inputs, Mode, Navigator};
use host_sim::bench::worlds::{self, numbers::Numbers, unmapped};
use host_sim::bench::{ours::waypoints, sensors};
use host_sim::si;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use replica::navigation::{
    CONES, Course, Engine, POINTS, RECORD_BYTES, Seen, Way, encode, head, setup, tick,
};
use replica::tape::Source;

/// A run's tape.
pub type Tape = crate::tape::Tape<RECORD_BYTES>;

/// Runs of one kind.
pub struct Group {
    /// Its key.
    pub name: &'static str,
    /// Its runs.
    pub tapes: Vec<Tape>,
}

/// The worlds of each group: `generated:barn`, these numbers.
const WORLDS: &str = "1-70";

/// Longest run, s.
const LONGEST: f64 = 40.0;

/// All groups: to the goal only, along the planner's path, and along a path with three cylinders that it knows nothing of.
pub fn groups() -> anyhow::Result<Vec<Group>> {
    let numbers = Numbers::parse(WORLDS).map_err(anyhow::Error::msg)?;
    let arenas = worlds::load("generated:barn", &numbers, &JACKAL)?;
    let mut more = arenas.clone();
    unmapped::place(&mut more);
    let setting = |planned| -> anyhow::Result<Setting> {
        let cones = sensors::named("cone16").map_err(anyhow::Error::msg)?;
        Ok(Setting {
            time_limit: LONGEST,
            ..Setting::new(cones, 1.0, planned)
        })
    };
    [
        ("goal", &arenas, false),
        ("path", &arenas, true),
        ("unmapped", &more, true),
    ]
    .into_iter()
    .map(|(name, arenas, planned)| {
        let setting = setting(planned)?;
        let tapes = arenas.iter().map(|arena| record(name, arena, &setting));
        Ok(Group {
            name,
            tapes: tapes.collect::<anyhow::Result<_>>()?,
        })
    })
    .collect()
}

/// Drives a run and puts it on tape.
fn record(group: &str, arena: &Arena, setting: &Setting) -> anyhow::Result<Tape> {
    let name = format!("{group}, world {}", arena.number);
    let points = waypoints(&arena.route, POINTS);
    let [x, y] = arena.goal;
    let way = match setting.planned {
        true => Way::Path(&points),
        false => Way::Goal(Point::new(si::metres(x), si::metres(y))),
    };
    let mut driver = Driver::new(way)?;
    let discs = Discs::new(&arena.circles);
    drive(arena, &discs, setting, 1, &mut driver, &mut |_| {});
    Ok(driver.tape(name, way))
}

/// Invented to be expensive: every cone echoes near and far by turns, so that the memory is full, while the robot turns.
pub fn contrived() -> anyhow::Result<Vec<Tape>> {
    let goal = Point::new(Metres::lit("20"), Metres::lit("3"));
    let points = waypoints(&[[0.0, 0.0], [8.0, 1.0], [9.0, -6.0]], POINTS);
    [Way::Goal(goal), Way::Path(&points)]
        .into_iter()
        .flat_map(|way| (1..=4).map(move |seed| (way, seed)))
        .map(|(way, seed)| {
            let mut driver = Driver::new(way)?;
            let mut dice = Pcg64Mcg::seed_from_u64(seed);
            let mut within = |from: f64, to: f64| {
                from + (to - from) * f64::from(dice.next_u32()) / 4_294_967_296.0
            };
            let mut pose = [0.0; 3];
            for _ in 0..400 {
                let near = within(0.3, 1.1);
                let readings = std::array::from_fn(|_| {
                    let range = near + within(0.0, 0.4);
                    RangeReading::fresh(Range::Echo(si::metres(range)))
                });
                pose[0] += within(0.0, 0.05);
                pose[1] += within(-0.02, 0.02);
                pose[2] += within(-0.1, 0.1);
                driver.go(Seen {
                    pose: si::pose(pose),
                    readings,
                });
            }
            Ok(driver.tape(format!("crowd {seed}"), way))
        })
        .collect()
}

/// The navigator behind the bench's trait, recording.
struct Driver {
    setup: Setup<CONES>,
    engine: Box<Engine>,
    course: Course,
    ticks: Bytes,
    records: Vec<u8>,
}

impl Driver {
    fn new(way: Way<'_>) -> anyhow::Result<Self> {
        // As the image reads it.
        let mut bytes = Bytes::default();
        head(&mut bytes, 1, way);
        let mut from = Cursor(&bytes.0);
        from.word();
        let mut course = Course::new();
        course.read(&mut from).map_err(anyhow::Error::msg)?;
        Ok(Self {
            setup: setup().map_err(|e| anyhow::anyhow!("{}: {}", e.field, e.allowed))?,
            engine: Box::new(Engine::new()),
            course,
            ticks: Bytes::default(),
            records: Vec::new(),
        })
    }

    fn go(&mut self, seen: Seen) -> NavigationRecord {
        seen.write(&mut self.ticks);
        let path = self.course.path();
        let record = tick(
            &mut self.engine,
            &self.setup,
            &seen,
            self.course.task(&path),
        );
        self.records.extend(encode(&record, self.engine.digest()));
        record
    }

    fn tape(self, name: String, way: Way<'_>) -> Tape {
        let mut bytes = Bytes::default();
        head(&mut bytes, (self.records.len() / RECORD_BYTES) as u32, way);
        bytes.0.extend(self.ticks.0);
        Tape {
            name,
            bytes: bytes.0,
            records: self.records,
        }
    }
}

impl Navigator for Driver {
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command {
        let mut seen = Seen {
            pose: si::pose(inputs.pose),
            ..Seen::new()
        };
        for (reading, ours) in inputs.ranges.iter().zip(&mut seen.readings) {
            *ours = *reading;
        }
        let record = self.go(seen);
        Command {
            speed: si::from_speed(record.twist.linear),
            yaw_rate: si::from_rate(record.twist.angular),
            // The run is to go on whatever it says.
            mode: Mode::Avoid,
        }
    }
}

/// Names of a record's words, in their order after its three bytes.
const WORDS: [&str; 13] = [
    "twist.linear",
    "twist.angular",
    "wanted.linear",
    "wanted.angular",
    "guarded.twist.linear",
    "guarded.twist.angular",
    "heading.angle",
    "heading.hard",
    "heading.soft",
    "direction",
    "clearance",
    "points",
    "digest",
];

/// The first field in which two records differ.
pub fn parting(expected: &[u8; RECORD_BYTES], found: &[u8; RECORD_BYTES]) -> String {
    let Some(byte) = expected.iter().zip(found).position(|(a, b)| a != b) else {
        return "nothing".to_owned();
    };
    let name = match byte {
        0 => "manoeuvre",
        1 => "guarded's flags",
        2 => "whether there is a heading",
        _ => WORDS[(byte - 3) / 4],
    };
    let start = if byte < 3 {
        byte
    } else {
        byte - (byte - 3) % 4
    };
    let end = if byte < 3 { byte + 1 } else { start + 4 };
    let [expected, found] = [expected, found].map(|bytes| &bytes[start..end]);
    format!("{name}: desktop {expected:02x?}, machine {found:02x?}")
}
