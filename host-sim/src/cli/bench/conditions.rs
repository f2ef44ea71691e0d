//! The options that say what is not as it should be.

use crate::cli::{BadInput, number};
use clap::{Args, ValueEnum};
use host_sim::bench::attempt::{Arrival, Dead, Setting};
use host_sim::bench::odometry::Drift;
use host_sim::bench::ranging::Disturbance;

/// What the robot is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Task {
    /// The planner's path.
    Path,
    /// The straight line from start to goal.
    Goal,
    /// The planner's path, and cylinders that it does not know.
    Unmapped,
}

impl Task {
    /// Whether the robot is given the planner's path.
    pub const fn planned(self) -> bool {
        !matches!(self, Self::Goal)
    }

    /// As it is asked for.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Goal => "goal",
            Self::Unmapped => "unmapped",
        }
    }
}

/// Whose pose decides whether the goal is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum JudgedBy {
    /// The true pose.
    Truth,
    /// The pose that odometry believes.
    Belief,
}

/// What goes wrong.
#[derive(Args, Debug)]
pub struct Trouble {
    /// 2 cm of range noise, 5 % of readings lost, 2 % cross-talk, no echo beyond 60° incidence; each may be given another value.
    #[arg(long)]
    harsh: bool,
    /// Standard deviation of ranges, m; 0.01 when left out.
    #[arg(long, value_name = "M", value_parser = number(0.0, 1.0), allow_hyphen_values = true)]
    noise: Option<f64>,
    /// Share of readings lost.
    #[arg(long, value_name = "SHARE", value_parser = number(0.0, 1.0), allow_hyphen_values = true)]
    dropout: Option<f64>,
    /// Share of readings in which a sensor hears its neighbours' pulses, too.
    #[arg(long, value_name = "SHARE", value_parser = number(0.0, 1.0), allow_hyphen_values = true)]
    cross_talk: Option<f64>,
    /// Incidence beyond which no echo comes back, degrees.
    #[arg(long, value_name = "DEG", value_parser = number(0.0, 90.0), allow_hyphen_values = true)]
    specular: Option<f64>,
    /// A sensor that hears nothing, from 0 at the right; `each`: another one with every seed.
    #[arg(long, value_name = "SENSOR")]
    dead: Option<String>,
    /// Standard deviations of odometry's scale errors, in per cent of distance and of turned angle, such as 2,3.
    #[arg(long, value_name = "PERCENT,PERCENT")]
    drift: Option<String>,
    /// Whose pose decides whether the goal is reached.
    #[arg(long, value_enum, default_value_t = JudgedBy::Truth)]
    arrival: JudgedBy,
    /// Longest run, s.
    #[arg(long, default_value_t = 100.0, value_parser = number(1.0, 3600.0), allow_hyphen_values = true)]
    time_limit: f64,
}

impl Trouble {
    /// Puts it into a setting.
    pub fn apply(&self, setting: &mut Setting) -> Result<(), BadInput> {
        setting.disturbance = self.disturbance();
        setting.drift = match &self.drift {
            None => Drift::default(),
            Some(text) => drift(text)?,
        };
        setting.dead = match self.dead.as_deref() {
            None => Dead::None,
            Some("each") => Dead::BySeed,
            Some(text) => match text.parse() {
                Ok(sensor) if sensor < setting.sensors.len() => Dead::One(sensor),
                _ => {
                    return Err(BadInput(format!(
                        "--dead {text}: no such sensor; allowed: each, or a number from 0 to {}",
                        setting.sensors.len() - 1
                    )));
                }
            },
        };
        setting.arrival = match self.arrival {
            JudgedBy::Truth => Arrival::True,
            JudgedBy::Belief => Arrival::Believed,
        };
        setting.time_limit = self.time_limit;
        Ok(())
    }

    /// Whether every sensor is dead in turn.
    pub fn each_dead(&self) -> bool {
        self.dead.as_deref() == Some("each")
    }

    fn disturbance(&self) -> Disturbance {
        let base = if self.harsh {
            Disturbance::HARSH
        } else {
            Disturbance::MILD
        };
        Disturbance {
            noise: self.noise.unwrap_or(base.noise),
            dropout: self.dropout.unwrap_or(base.dropout),
            cross_talk: self.cross_talk.unwrap_or(base.cross_talk),
            specular: self.specular.map_or(base.specular, f64::to_radians),
        }
    }

    /// All of it in words, the same words for the same trouble.
    pub fn words(&self) -> String {
        let d = self.disturbance();
        let mut words = vec![format!("noise {} m", d.noise)];
        if d.dropout > 0.0 {
            words.push(format!("dropout {}", d.dropout));
        }
        if d.cross_talk > 0.0 {
            words.push(format!("cross-talk {}", d.cross_talk));
        }
        if d.specular < std::f64::consts::FRAC_PI_2 {
            words.push(format!("specular {:.1} deg", d.specular.to_degrees()));
        }
        if let Some(dead) = &self.dead {
            words.push(format!("dead {dead}"));
        }
        if let Some(drift) = &self.drift {
            words.push(format!("drift {drift} %"));
        }
        if self.arrival == JudgedBy::Belief {
            words.push("arrival as believed".to_owned());
        }
        words.push(format!("{} s at most", self.time_limit));
        words.join(", ")
    }
}

fn drift(text: &str) -> Result<Drift, BadInput> {
    let per_cent = |text: &str| {
        text.parse::<f64>()
            .ok()
            .filter(|x| (0.0..=50.0).contains(x))
            .map(|x| x / 100.0)
    };
    text.split_once(',')
        .and_then(|(distance, yaw)| {
            Some(Drift {
                distance: per_cent(distance)?,
                yaw: per_cent(yaw)?,
            })
        })
        .ok_or_else(|| {
            BadInput(format!(
                "--drift {text}: allowed are two numbers from 0 to 50, such as 2,3"
            ))
        })
}
