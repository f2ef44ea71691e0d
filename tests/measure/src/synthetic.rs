//! Invented inputs. Only integers are drawn, so that these tapes are the same on every machine.

use crate::tape::{Head, Tape};
use fixed::types::I16F16;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{Segment, Waypoint};
use fuzzypilot::link::settings::{self, Format};
use fuzzypilot::params::Params;
use fuzzypilot::ports::{Fault, Range, RangeReading, WheelCounts};
use fuzzypilot::presets;
use fuzzypilot::units::{Angle, Metres, Seconds};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use replica::tape::Pieces;

/// One tick's inputs.
type Tick = (Result<WheelCounts, Fault>, Vec<RangeReading>);

/// Whole numbers by chance.
struct Dice(Pcg64Mcg);

impl Dice {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// `least` to `most`.
    fn within(&mut self, least: i64, most: i64) -> i64 {
        let span = (most - least + 1).unsigned_abs();
        least + (self.0.next_u64() % span).cast_signed()
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.within(0, choices.len() as i64 - 1) as usize]
    }

    /// True once in so many.
    fn once_in(&mut self, times: i64) -> bool {
        self.within(1, times) == 1
    }

    fn metres(&mut self, least: f64, most: f64) -> Metres {
        let bits = |x: f64| (x * 65_536.0) as i64;
        Metres::from_bits(self.within(bits(least), bits(most)) as i32)
    }

    fn angle(&mut self) -> Angle {
        Angle::from_bits(self.0.next_u32().cast_signed())
    }

    fn point(&mut self, reach: f64) -> Point {
        Point::new(self.metres(-reach, reach), self.metres(-reach, reach))
    }

    fn pose(&mut self, reach: f64) -> Pose {
        Pose::new(self.point(reach), self.angle())
    }

    fn fault(&mut self) -> Fault {
        self.of(&[
            Fault::NeverSeen,
            Fault::Timeout,
            Fault::Bus,
            Fault::OutOfRange,
            Fault::Stale,
        ])
    }
}

/// Any settings, any path, and inputs as no robot ever sees them: jumps, faults, stale and impossible ranges.
pub fn hostile(seed: u64) -> anyhow::Result<Tape> {
    let mut dice = Dice::new(seed);
    let settings = any_settings(&mut dice);
    let sensors = settings.ring.mounts.len();
    loop {
        let path = AnyPath::new(&mut dice);
        let head = path.head(&settings, dice.pose(2.0));
        if head.path().is_err() {
            continue;
        }
        let (mut left, mut right) = (0i32, 0i32);
        let ticks: Vec<Tick> = (0..200)
            .map(|_| {
                let (most, jump) = (1 << 18, dice.once_in(40));
                let step = |dice: &mut Dice| match jump {
                    true => dice.of(&[i32::MIN, i32::MAX, 1 << 30, -(1 << 28)]),
                    false => dice.within(-most / 4, most) as i32,
                };
                left = left.wrapping_add(step(&mut dice));
                right = right.wrapping_add(step(&mut dice));
                let counts = match dice.once_in(20) {
                    true => Err(dice.fault()),
                    false => Ok(WheelCounts { left, right }),
                };
                (
                    counts,
                    (0..sensors).map(|_| any_reading(&mut dice)).collect(),
                )
            })
            .collect();
        return head.invented(format!("hostile {seed}"), lent(&ticks));
    }
}

fn lent(ticks: &[Tick]) -> impl Iterator<Item = (Result<WheelCounts, Fault>, &[RangeReading])> {
    ticks
        .iter()
        .map(|(counts, readings)| (*counts, readings.as_slice()))
}

fn any_reading(dice: &mut Dice) -> RangeReading {
    let range = match dice.within(0, 9) {
        0 => Range::Clear,
        1 => Range::Invalid(dice.fault()),
        2 => Range::Echo(dice.of(&[Metres::ZERO, Metres::MAX, Metres::lit("-1")])),
        3 => Range::Echo(dice.metres(0.0, 0.2)),
        _ => Range::Echo(dice.metres(0.2, 3.0)),
    };
    let age = match dice.once_in(8) {
        true => Seconds::from_bits(dice.of(&[1 << 20, 1 << 24, i32::MAX, -1, i32::MIN])),
        false => Seconds::ZERO,
    };
    RangeReading { range, age }
}

/// A preset with some settings changed to whatever the library still takes.
fn any_settings(dice: &mut Dice) -> Params<64> {
    let mut params: Params<64> = match dice.once_in(2) {
        true => presets::small_robot(),
        false => presets::chapter_robot(),
    };
    let sensors = dice.of(&[1, 2, 3, 5, 8, 8, 16, 33, 64]);
    params.ring.mounts.truncate(sensors);
    for mount in &mut params.ring.mounts {
        if dice.once_in(2) {
            mount.pose = dice.pose(0.2);
            mount.width = Angle::from_bits(dice.within(0, 1 << 29) as i32);
        }
    }
    for setting in settings::SETTINGS {
        let raw = settings::get(&params, setting.id).unwrap_or(0);
        let new = match setting.format {
            Format::Choice(names) => dice.within(0, names.len() as i64 - 1),
            Format::Whole(_) => dice.within(0, 20),
            _ if dice.once_in(3) => i64::from(raw) * dice.within(0, 64) / 16,
            _ => continue,
        };
        let mut changed = params.clone();
        let new = i32::try_from(new).unwrap_or(raw);
        if settings::set(&mut changed, setting.id, new).is_ok() && changed.check().is_ok() {
            params = changed;
        }
    }
    params
}

struct AnyPath {
    points: Vec<Waypoint>,
    segments: Vec<Segment>,
    closed: bool,
}

impl AnyPath {
    fn new(dice: &mut Dice) -> Self {
        let pieces = dice.within(2, 60);
        let reach = dice.of(&[0.1, 1.0, 20.0]);
        let discrete = dice.once_in(3);
        let mut path = Self {
            points: Vec::new(),
            segments: Vec::new(),
            closed: dice.once_in(2),
        };
        for _ in 0..pieces {
            if discrete {
                path.points.push(dice.pose(reach));
            } else if dice.once_in(2) {
                let line = Segment::line(dice.pose(reach), dice.metres(0.001, reach));
                path.segments.push(line);
            } else {
                path.segments.push(Segment::Arc {
                    centre: dice.point(reach),
                    radius: dice.metres(0.001, reach),
                    from: dice.angle(),
                    sweep: dice.within(-(1 << 24), 1 << 24) as i32,
                });
            }
        }
        path
    }

    fn head<'a>(&'a self, settings: &'a Params<64>, start: Pose) -> Head<'a> {
        Head {
            settings,
            start,
            pieces: match self.points.is_empty() {
                true => Pieces::Segments(&self.segments),
                false => Pieces::Points(&self.points),
            },
            closed: self.closed,
            gaps: true,
        }
    }
}

/// Eight ranges that all echo, crowds and single obstacles in turn, on paths of many short pieces far ahead of which a
/// weak brake has to look.
pub fn contrived() -> anyhow::Result<Vec<Tape>> {
    let mut settings: Params<64> = presets::small_robot();
    settings.ring.mounts = presets::small_robot::<8>()
        .ring
        .mounts
        .iter()
        .copied()
        .collect();
    settings.limits.acceleration = I16F16::lit("0.5");
    settings.guard.braking = I16F16::lit("0.5");
    let mut tapes = Vec::new();
    for (form, path) in [("arcs", arcs()), ("lines", lines()), ("points", points())] {
        for seed in 1..=2 {
            let mut dice = Dice::new(seed);
            let start = Pose::new(dice.point(0.1), Angle::ZERO);
            let head = path.head(&settings, start);
            let mut place = WheelCounts::default();
            let ticks: Vec<Tick> = (0..400)
                .map(|_| {
                    place.left = place.left.wrapping_add(dice.within(0, 1 << 17) as i32);
                    place.right = place.right.wrapping_add(dice.within(0, 1 << 17) as i32);
                    (Ok(place), crowd(&mut dice))
                })
                .collect();
            tapes.push(head.invented(format!("short {form} in a crowd, {seed}"), lent(&ticks))?);
        }
    }
    Ok(tapes)
}

/// Echoes all round: every one an obstacle, or some of one piece.
fn crowd(dice: &mut Dice) -> Vec<RangeReading> {
    let near = dice.metres(0.15, 1.2);
    let together = dice.within(0, 8);
    (0..8)
        .map(|i| {
            let distance = match i < together {
                true => near + dice.metres(0.0, 0.02),
                false => dice.metres(0.1, 2.0),
            };
            RangeReading::fresh(Range::Echo(distance))
        })
        .collect()
}

const RADIUS: Metres = Metres::lit("0.2");

/// Place and heading at `i` of 64 on a circle.
fn on_circle(i: u32) -> Pose {
    let out = Angle::from_bits((i << 26).cast_signed());
    Pose::new(Point::polar(RADIUS, out), out + Angle::QUARTER)
}

fn arcs() -> AnyPath {
    let arc = |i: u32| Segment::Arc {
        centre: Point::default(),
        radius: RADIUS,
        from: Angle::from_bits((i << 26).cast_signed()),
        sweep: 1 << 18,
    };
    AnyPath {
        points: Vec::new(),
        segments: (0..64).map(arc).collect(),
        closed: true,
    }
}

fn lines() -> AnyPath {
    let line = |i: u32| Segment::line(on_circle(i), Metres::lit("0.0196"));
    AnyPath {
        points: Vec::new(),
        segments: (0..64).map(line).collect(),
        closed: true,
    }
}

fn points() -> AnyPath {
    AnyPath {
        points: (0..64).map(on_circle).collect(),
        segments: Vec::new(),
        closed: true,
    }
}
