//! Range sensors: cones that hear the nearest echo anywhere inside, beams that hit what is on their line, and what
//! goes wrong with both.

use super::arena::Circle;
use super::body::to_body;
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
        let (sin, cos) = libm::sincos(pose[2]);
        self.scratch.extend(circles.iter().map(|c| {
            let (dx, dy) = (c.at[0] - pose[0], c.at[1] - pose[1]);
            Circle {
                at: [dx * cos + dy * sin, dy * cos - dx * sin],
                radius: c.radius,
            }
        }));
        match self.fan {
            Some(fan) => self.sweep(fan),
            None => {
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
        let mount = [first.view.x, first.view.y, 0.0];
        let last = self.sensors.len() as f64 - 1.0;
        for circle in &self.scratch {
            let [x, y] = to_body(mount, circle.at);
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
            let (x, y) = (circle.at[0] - self.view.x, circle.at[1] - self.view.y);
            let near = nearest + circle.radius;
            if x * x + y * y > near * near || x * self.cos + y * self.sin < -circle.radius {
                continue;
            }
            let range = self.hit(circle, specular);
            if range <= nearest {
                (nearest, heard) = (range, true);
            }
        }
        if heard { nearest } else { f64::INFINITY }
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
