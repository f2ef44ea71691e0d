//! Range sensors: cones that hear the nearest echo anywhere inside, beams that hit what is on their line, and what
//! goes wrong with both.

use super::arena::Circle;
use super::body::BodyFrame;
use super::seeds::normal;
use crate::recording::BeamView;
use crate::si;
use fuzzypilot::ports::{Fault, Range, RangeReading};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// How wrong ranges are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// Standard deviation, m.
    pub noise: f64,
    /// Share of readings lost; reported as time-outs.
    pub dropout: f64,
    /// Share of readings in which a sensor also hears its two neighbours' pulses and takes the nearest echo of the three.
    /// All pulses leave together, so what it hears has the neighbour's range.
    pub cross_talk: f64,
    /// Incidence from the surface's normal beyond which nothing comes back, rad. The reading then says "nothing there".
    pub specular: f64,
}

impl Disturbance {
    /// The reference design's sensors: 1 cm of noise and nothing else.
    pub const MILD: Self = Self {
        noise: 0.01,
        dropout: 0.0,
        cross_talk: 0.0,
        specular: std::f64::consts::FRAC_PI_2,
    };

    /// Harsher: 2 cm, 5 % lost, 2 % cross-talk, no echo beyond 60°.
    pub const HARSH: Self = Self {
        noise: 0.02,
        dropout: 0.05,
        cross_talk: 0.02,
        specular: std::f64::consts::FRAC_PI_3,
    };
}

/// A sensor with its sines worked out.
#[derive(Clone, Copy, Debug)]
struct Sensor {
    view: BeamView,
    cos: f64,
    sin: f64,
    cos_half: f64,
    sin_half: f64,
}

/// The sensors of a robot.
#[derive(Clone, Debug)]
pub struct Ranging {
    sensors: Vec<Sensor>,
    disturbance: Disturbance,
    dead: Option<usize>,
    /// sin² of the incidence beyond which nothing comes back.
    specular: f64,
    /// Largest distance from the robot's centre at which a surface can be seen, m.
    pub reach: f64,
    /// Beams of one fan: their common place, first heading and pitch.
    fan: Option<Fan>,
    /// Which sensors of one place look where.
    sectors: Option<Sectors>,
    scratch: Vec<Circle>,
    echoes: Vec<f64>,
    /// As the robot reads them.
    pub readings: Vec<RangeReading>,
}

#[derive(Clone, Copy, Debug)]
struct Fan {
    first: f64,
    pitch: f64,
}

impl Ranging {
    /// Cones are at most 170° wide. The sensor `dead` reads "nothing there" for ever.
    pub fn new(sensors: &[BeamView], disturbance: Disturbance, dead: Option<usize>) -> Self {
        let reach = sensors
            .iter()
            .map(|s| s.max_range + libm::hypot(s.x, s.y))
            .fold(0.0, f64::max);
        let sine = libm::sin(disturbance.specular.min(std::f64::consts::FRAC_PI_2));
        Self {
            sensors: sensors.iter().map(|view| Sensor::new(*view)).collect(),
            disturbance,
            dead,
            // Nothing is beyond a right angle; rounding must not make it so.
            specular: if disturbance.specular < std::f64::consts::FRAC_PI_2 {
                sine * sine
            } else {
                f64::INFINITY
            },
            reach,
            fan: Fan::of(sensors),
            sectors: Sectors::of(sensors),
            scratch: Vec::new(),
            echoes: vec![f64::INFINITY; sensors.len()],
            readings: vec![RangeReading::NEVER_SEEN; sensors.len()],
        }
    }

    /// True ranges of the last look, m; infinite where there is nothing.
    pub fn echoes(&self) -> &[f64] {
        &self.echoes
    }

    /// Looks from `pose` at circles that stand in the world's frame, and fills [`Ranging::readings`].
    pub fn look(&mut self, pose: [f64; 3], circles: &[Circle], rng: &mut Pcg64Mcg) {
        self.scratch.clear();
        let frame = BodyFrame::new(pose);
        self.scratch.extend(circles.iter().map(|c| Circle {
            at: frame.see(c.at),
            radius: c.radius,
        }));
        match (self.fan, &self.sectors) {
            (Some(fan), _) => self.sweep(fan),
            (None, Some(sectors)) => {
                for (sensor, echo) in self.sensors.iter().zip(&mut self.echoes) {
                    *echo = sensor.view.max_range;
                }
                let mut heard = 0u64;
                for circle in &self.scratch {
                    let mut looking = sectors.looking_at(circle);
                    while looking != 0 {
                        let k = looking.trailing_zeros() as usize;
                        looking &= looking - 1;
                        let range = self.sensors[k].range(circle, self.specular, self.echoes[k]);
                        if let Some(range) = range {
                            self.echoes[k] = range;
                            heard |= 1 << k;
                        }
                    }
                }
                for (k, echo) in self.echoes.iter_mut().enumerate() {
                    if heard >> k & 1 == 0 {
                        *echo = f64::INFINITY;
                    }
                }
            }
            (None, None) => {
                for (sensor, echo) in self.sensors.iter().zip(&mut self.echoes) {
                    *echo = sensor.nearest(&self.scratch, self.specular);
                }
            }
        }
        self.disturb(rng);
    }

    /// Beams of a fan: every circle in turn, for the beams that it can be on.
    fn sweep(&mut self, fan: Fan) {
        self.echoes.fill(f64::INFINITY);
        let Some(first) = self.sensors.first() else {
            return;
        };
        let mount = BodyFrame::new([first.view.x, first.view.y, 0.0]);
        let last = self.sensors.len() as f64 - 1.0;
        for circle in &self.scratch {
            let [x, y] = mount.see(circle.at);
            let distance = libm::hypot(x, y);
            let (middle, half) = if distance > circle.radius {
                (libm::atan2(y, x), libm::asin(circle.radius / distance))
            } else {
                (0.0, std::f64::consts::PI)
            };
            // A fan may be wider than a half turn: a bearing counts as it is and a turn further either way.
            for turn in [-std::f64::consts::TAU, 0.0, std::f64::consts::TAU] {
                let from = ((middle - half + turn - fan.first) / fan.pitch - 1e-6)
                    .ceil()
                    .max(0.0);
                let to = ((middle + half + turn - fan.first) / fan.pitch + 1e-6)
                    .floor()
                    .min(last);
                if from > to {
                    continue;
                }
                for beam in from as usize..=to as usize {
                    let range = self.sensors[beam].hit(circle, self.specular);
                    let echo = &mut self.echoes[beam];
                    *echo = echo.min(range);
                }
            }
        }
        for (sensor, echo) in self.sensors.iter().zip(&mut self.echoes) {
            if *echo > sensor.view.max_range {
                *echo = f64::INFINITY;
            }
        }
    }

    /// Draws the same number of random numbers in every tick, whatever was seen.
    fn disturb(&mut self, rng: &mut Pcg64Mcg) {
        let d = self.disturbance;
        for k in 0..self.sensors.len() {
            let error = d.noise * normal(rng);
            let lost = d.dropout > 0.0 && rng.random::<f64>() < d.dropout;
            let crossed = d.cross_talk > 0.0 && rng.random::<f64>() < d.cross_talk;
            let mut echo = self.echoes[k];
            if crossed {
                for neighbour in [k.wrapping_sub(1), k + 1] {
                    echo = echo.min(self.echoes.get(neighbour).copied().unwrap_or(f64::INFINITY));
                }
            }
            let range = (echo + error).max(0.0);
            self.readings[k] = RangeReading::fresh(if self.dead == Some(k) {
                Range::Clear
            } else if lost {
                Range::Invalid(Fault::Timeout)
            } else if range <= self.sensors[k].view.max_range {
                Range::Echo(si::metres(range))
            } else {
                Range::Clear
            });
        }
    }
}

impl Fan {
    /// The fan that sensors form, if all are beams from one place at one pitch.
    fn of(sensors: &[BeamView]) -> Option<Self> {
        let [first, second, ..] = sensors else {
            return None;
        };
        let pitch = second.heading - first.heading;
        let even = sensors.iter().enumerate().all(|(k, s)| {
            s.width == 0.0
                && (s.x, s.y) == (first.x, first.y)
                && (s.heading - first.heading - pitch * k as f64).abs() < 1e-9
        });
        (even && pitch > 0.0).then_some(Self {
            first: first.heading,
            pitch,
        })
    }
}

/// The sensors of one place, by the sector that a circle's centre is seen in: most of them look elsewhere.
#[derive(Clone, Debug)]
struct Sectors {
    place: [f64; 2],
    /// A bit a sensor.
    looking: [u64; SECTORS],
    all: u64,
}

/// Sectors of a turn, eight in each of eight octants: even in the tangent, and not in the angle.
const SECTORS: usize = 64;

/// A circle of at most this radius, as a share of its distance, is hidden in its sector and this sine beside it.
const SMALL: f64 = 0.2;

impl Sectors {
    /// Of up to 64 sensors, if all are in one place.
    fn of(sensors: &[BeamView]) -> Option<Self> {
        let first = sensors.first()?;
        let together = |s: &BeamView| (s.x, s.y) == (first.x, first.y);
        if sensors.len() > 64 || !sensors.iter().all(together) {
            return None;
        }
        let aside = libm::asin(SMALL) + 1e-6;
        let mut looking = [0; SECTORS];
        for (sector, bits) in looking.iter_mut().enumerate() {
            let [from, to] = bounds(sector);
            let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0 + aside);
            for (k, sensor) in sensors.iter().enumerate() {
                let off = (sensor.heading - middle).rem_euclid(std::f64::consts::TAU);
                let off = off.min(std::f64::consts::TAU - off);
                if off <= half + sensor.width / 2.0 {
                    *bits |= 1 << k;
                }
            }
        }
        Some(Self {
            place: [first.x, first.y],
            looking,
            all: u64::MAX >> (64 - sensors.len()),
        })
    }

    /// The sensors that may see a circle, a bit each.
    fn looking_at(&self, circle: &Circle) -> u64 {
        let (x, y) = (circle.at[0] - self.place[0], circle.at[1] - self.place[1]);
        let small = SMALL * SMALL * (x * x + y * y);
        if circle.radius * circle.radius > small {
            return self.all;
        }
        self.looking[sector(x, y)]
    }
}

/// The sector of a direction.
fn sector(x: f64, y: f64) -> usize {
    let (long, short) = (x.abs().max(y.abs()), x.abs().min(y.abs()));
    let step = ((short / long * 8.0) as usize).min(7);
    let octant =
        usize::from(y.abs() > x.abs()) | usize::from(x < 0.0) << 1 | usize::from(y < 0.0) << 2;
    octant << 3 | step
}

/// Directions of a sector, the lower one first, rad.
fn bounds(sector: usize) -> [f64; 2] {
    let (octant, step) = (sector >> 3, sector & 7);
    let angle = |step: usize| {
        let mut angle = libm::atan(step as f64 / 8.0);
        if octant & 1 != 0 {
            angle = std::f64::consts::FRAC_PI_2 - angle;
        }
        if octant & 2 != 0 {
            angle = std::f64::consts::PI - angle;
        }
        if octant & 4 != 0 { -angle } else { angle }
    };
    let [a, b] = [angle(step), angle(step + 1)];
    [a.min(b), a.max(b)]
}

impl Sensor {
    fn new(view: BeamView) -> Self {
        let (sin, cos) = libm::sincos(view.heading);
        let (sin_half, cos_half) = libm::sincos(view.width / 2.0);
        Self {
            view,
            cos,
            sin,
            cos_half,
            sin_half,
        }
    }

    /// Nearest echo, m; infinite if there is none within reach.
    fn nearest(&self, circles: &[Circle], specular: f64) -> f64 {
        let mut nearest = self.view.max_range;
        let mut heard = false;
        for circle in circles {
            if let Some(range) = self.range(circle, specular, nearest) {
                (nearest, heard) = (range, true);
            }
        }
        if heard { nearest } else { f64::INFINITY }
    }

    /// Range of a circle, if that is no farther than the nearest so far.
    fn range(&self, circle: &Circle, specular: f64, nearest: f64) -> Option<f64> {
        let (x, y) = (circle.at[0] - self.view.x, circle.at[1] - self.view.y);
        let near = nearest + circle.radius;
        if x * x + y * y > near * near || x * self.cos + y * self.sin < -circle.radius {
            return None;
        }
        let range = self.hit(circle, specular);
        (range <= nearest).then_some(range)
    }

    /// Range of the part of a circle inside the cone, m; infinite if there is none, or if it reflects away.
    fn hit(&self, circle: &Circle, specular: f64) -> f64 {
        let (x, y) = (circle.at[0] - self.view.x, circle.at[1] - self.view.y);
        let along = x * self.cos + y * self.sin;
        let beside = (y * self.cos - x * self.sin).abs();
        let r2 = circle.radius * circle.radius;
        // The edge nearer to the centre, by symmetry: along it, and how far the centre is outside of it.
        let on_edge = along * self.cos_half + beside * self.sin_half;
        let outside = beside * self.cos_half - along * self.sin_half;
        if outside <= 0.0 && self.view.width > 0.0 {
            // The centre is inside: its nearest point is seen, head on.
            return ((x * x + y * y).sqrt() - circle.radius).max(0.0);
        }
        let across2 = outside * outside;
        if across2 > r2 {
            return f64::INFINITY;
        }
        let half = (r2 - across2).sqrt();
        if on_edge + half < 0.0 {
            f64::INFINITY
        } else if on_edge <= half {
            // The sensor is inside the circle.
            0.0
        } else if across2 > specular * r2 {
            // The sine of the incidence is the offset over the radius.
            f64::INFINITY
        } else {
            on_edge - half
        }
    }
}
