//! Everything about the robot and its tuning that is fixed while it drives. Build one, [`Params::checked`] it once,
//! keep it in flash.

use crate::geometry::Pose;
use crate::tables::coarse::{CoarseSet, SpeedInput};
use crate::tables::fine::{FineSet, SpeedAxis};
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, Seconds};
use fixed::types::{I16F16, U0F32};
use heapless::Vec;

/// Body and wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Radius of the disc that encloses the robot, about the middle of its axle.
    pub radius: Metres,
    /// Track width: distance between the wheels' contact points.
    pub track: Metres,
    /// Wheel travel a count, metres.
    pub metres_per_count: U0F32,
}

/// What the drive may ask of the robot. All positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Top speed.
    pub speed: MetresPerSecond,
    /// Top yaw rate, rad/s.
    pub yaw_rate: I16F16,
    /// Linear acceleration and braking, m/s².
    pub acceleration: I16F16,
    /// Yaw acceleration, rad/s².
    pub yaw_acceleration: I16F16,
    /// Top rim speed of a wheel.
    pub wheel_speed: MetresPerSecond,
}

/// How wheel travel becomes a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Integrator {
    /// Along the mean heading of the tick, chord-corrected: exact on arcs to third order.
    #[default]
    Arc,
    /// Equation 7.1: translate along the old heading, then turn.
    Euler,
}

/// Which guidance law gives φ and the direction to steer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Law {
    /// Vector-field guidance with curvature feed-forward: φ is measured against the tangent, turned towards the path
    /// by an angle that grows with the cross-track error (Nelson et al. 2007).
    #[default]
    Guided,
    /// As printed: φ is measured against the tangent itself. On a straight path it never closes a lateral offset.
    Paper,
}

/// The follower's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    /// Guidance law.
    pub law: Law,
    /// Rule tables.
    pub tables: FineSet,
    /// Reading of the speed axis.
    pub speed_axis: SpeedAxis,
    /// Units of the d axis a metre: 1 in the chapter's world, 10 for a small robot (0.4 m is then "very far").
    pub distance_scale: I16F16,
    /// Deflection to yaw rate, 1/s. `1/period` turns the whole deflection within one tick, as equation 7.1 does.
    pub deflection_rate: I16F16,
    /// Gain of the vector field, 1/m: how soon the guidance direction turns towards the path.
    pub approach_gain: PerMetre,
    /// Largest angle of the guidance direction to the tangent, reached far from the path.
    pub approach_angle: Angle,
    /// Within this cross-track error the path's curvature is fed forward.
    pub feed_forward_band: Metres,
    /// Lateral acceleration allowed in bends, m/s².
    pub lateral_acceleration: I16F16,
    /// Speed at a corner of the path (a jump of its tangent), reached by braking before it.
    pub corner_speed: MetresPerSecond,
    /// The cursor looks this far along the path to find its first place, and never further in one tick.
    pub reach: Metres,
    /// An open path counts as driven when less than this remains…
    pub arrival: Metres,
    /// …and its end is not farther away than this.
    pub end_radius: Metres,
}

/// The avoider's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Avoider {
    /// Rule tables.
    pub tables: CoarseSet,
    /// What the speed table reads.
    pub speed_input: SpeedInput,
    /// Detection range D: top of the s axis.
    pub range: Metres,
    /// Added to obstacle and robot radius when the unfeasible angle β is computed.
    pub margin: Metres,
    /// Deflection to yaw rate, 1/s.
    pub deflection_rate: I16F16,
    /// How far past the unfeasible region's edge the tables may turn the robot; see `behaviour::avoider`.
    pub overshoot: Angle,
}

/// The supervisor's thresholds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor {
    /// Avoiding may begin when the free distance to the obstacle is below this…
    pub enter: Metres,
    /// …and ends when it is above this; larger than `enter`.
    pub exit: Metres,
    /// Least number of ticks in a mode before it may change to another (stopping is always immediate).
    pub dwell: u16,
    /// Angle by which the way must clear the unfeasible region before avoiding ends.
    pub clear: Angle,
    /// Obstacle bearings within this count as straight ahead: ties break right, as Table 7.3 does.
    pub tie: Angle,
    /// An obstacle that reappears within this distance of the last one keeps its side.
    pub same: Metres,
    /// Ticks without any valid range, or without odometry, before the robot stops.
    pub patience: u16,
}

/// The last barrier's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guard {
    /// Distance that must stay free around the robot's disc.
    pub margin: Metres,
    /// Braking deceleration that it counts on, m/s²; at most the robot's own.
    pub braking: I16F16,
}

/// The most sensors in a ring.
pub const MAX_BEAMS: usize = 64;

/// One range sensor of the ring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mount {
    /// Where it sits and looks, in the robot's frame.
    pub pose: Pose,
    /// Full opening angle of its cone; 0 for a beam.
    pub width: Angle,
}

/// A ring of up to `N` range sensors, ordered counter-clockwise by direction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RingGeometry<const N: usize> {
    /// The sensors, at least one.
    pub mounts: Vec<Mount, N>,
    /// Whether the last one's neighbour is the first (a full circle).
    pub closed: bool,
    /// Largest range that counts; farther echoes are read as clear.
    pub max_range: Metres,
    /// Readings older than this are invalid.
    pub max_age: Seconds,
    /// Two neighbouring echoes farther apart than this belong to different obstacles.
    pub gap: Metres,
    /// Obstacle radii outside this range are not believed; a fit beyond it is replaced by the smallest circle that
    /// the echoes allow.
    pub radius: [Metres; 2],
    /// Echoes with a fit worse than this (RMS distance from the circle) are not believed to be one circle.
    pub residual: Metres,
}

/// All settings of a robot with up to `N` range sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct Params<const N: usize> {
    /// Body and wheels.
    pub body: Body,
    /// Limits.
    pub limits: Limits,
    /// Control period.
    pub period: Seconds,
    /// Time from a command to its effect; the guidance predicts the pose over it.
    pub latency: Seconds,
    /// Odometry rule.
    pub integrator: Integrator,
    /// Sensors.
    pub ring: RingGeometry<N>,
    /// Follower.
    pub follower: Follower,
    /// Avoider.
    pub avoider: Avoider,
    /// Supervisor.
    pub supervisor: Supervisor,
    /// Guard.
    pub guard: Guard,
}

/// A setting that cannot be driven with: which, and what is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParamError {
    /// The field, as it is written in the code.
    pub field: &'static str,
    /// What it may be.
    pub allowed: &'static str,
}

impl core::fmt::Display for ParamError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}: allowed is {}", self.field, self.allowed)
    }
}

impl core::error::Error for ParamError {}

impl<const N: usize> Params<N> {
    /// The settings, if the robot can be driven with them; else the first field that forbids it.
    pub fn checked(self) -> Result<Self, ParamError> {
        self.check().map(|()| self)
    }

    /// Whether the robot can be driven with these settings; else the first field that forbids it.
    pub fn check(&self) -> Result<(), ParamError> {
        let positive = |ok: bool, field| check(ok, field, "above 0");
        positive(self.body.radius > Metres::ZERO, "body.radius")?;
        positive(self.body.track > Metres::ZERO, "body.track")?;
        positive(
            self.body.metres_per_count > U0F32::ZERO,
            "body.metres_per_count",
        )?;
        positive(self.limits.speed > MetresPerSecond::ZERO, "limits.speed")?;
        positive(self.limits.yaw_rate > 0, "limits.yaw_rate")?;
        positive(self.limits.acceleration > 0, "limits.acceleration")?;
        positive(self.limits.yaw_acceleration > 0, "limits.yaw_acceleration")?;
        positive(
            self.limits.wheel_speed > MetresPerSecond::ZERO,
            "limits.wheel_speed",
        )?;
        const SHORTEST: Seconds = Seconds::lit("0.001");
        const LONGEST: Seconds = Seconds::lit("2");
        check(
            (SHORTEST..=LONGEST).contains(&self.period),
            "period",
            "1 ms to 2 s",
        )?;
        check(
            (Seconds::ZERO..=LONGEST).contains(&self.latency),
            "latency",
            "0 to 2 s",
        )?;
        check(
            (1..=MAX_BEAMS).contains(&self.ring.mounts.len()),
            "ring.mounts",
            "1 to 64 sensors",
        )?;
        positive(self.ring.max_range > Metres::ZERO, "ring.max_range")?;
        positive(self.ring.gap > Metres::ZERO, "ring.gap")?;
        check(
            self.ring.radius[0] > Metres::ZERO && self.ring.radius[1] >= self.ring.radius[0],
            "ring.radius",
            "0 < smallest <= largest",
        )?;
        check(
            self.ring.max_age >= Seconds::ZERO,
            "ring.max_age",
            "0 or more",
        )?;
        positive(self.ring.residual > Metres::ZERO, "ring.residual")?;
        positive(self.follower.distance_scale > 0, "follower.distance_scale")?;
        positive(
            self.follower.corner_speed > MetresPerSecond::ZERO,
            "follower.corner_speed",
        )?;
        check(
            self.follower.arrival >= Metres::ZERO,
            "follower.arrival",
            "0 or more",
        )?;
        positive(
            self.follower.end_radius > Metres::ZERO,
            "follower.end_radius",
        )?;
        check(
            self.follower.approach_angle.bits() > 0
                && self.follower.approach_angle.bits() <= Angle::QUARTER.bits(),
            "follower.approach_angle",
            "above 0, up to 90 degrees",
        )?;
        positive(
            self.follower.deflection_rate > 0,
            "follower.deflection_rate",
        )?;
        positive(
            self.follower.approach_gain > PerMetre::ZERO,
            "follower.approach_gain",
        )?;
        check(
            self.follower.feed_forward_band >= Metres::ZERO,
            "follower.feed_forward_band",
            "0 or more",
        )?;
        positive(self.follower.reach > Metres::ZERO, "follower.reach")?;
        positive(
            self.follower.lateral_acceleration > 0,
            "follower.lateral_acceleration",
        )?;
        positive(self.avoider.range > Metres::ZERO, "avoider.range")?;
        check(
            self.avoider.margin >= Metres::ZERO,
            "avoider.margin",
            "0 or more",
        )?;
        positive(self.avoider.deflection_rate > 0, "avoider.deflection_rate")?;
        check(
            self.avoider.overshoot.bits() >= 0,
            "avoider.overshoot",
            "0 to 180 degrees",
        )?;
        let acute = |angle: Angle| (0..Angle::QUARTER.bits()).contains(&angle.bits());
        check(
            acute(self.supervisor.clear),
            "supervisor.clear",
            "0 to below 90 degrees",
        )?;
        check(
            acute(self.supervisor.tie),
            "supervisor.tie",
            "0 to below 90 degrees",
        )?;
        check(
            self.supervisor.same >= Metres::ZERO,
            "supervisor.same",
            "0 or more",
        )?;
        check(
            self.supervisor.exit > self.supervisor.enter
                && self.supervisor.enter > Metres::ZERO
                && self.supervisor.enter <= self.avoider.range,
            "supervisor.enter, supervisor.exit",
            "0 < enter < exit, enter <= avoider.range",
        )?;
        check(
            self.guard.margin >= Metres::ZERO,
            "guard.margin",
            "0 or more",
        )?;
        check(
            self.guard.braking > 0 && self.guard.braking <= self.limits.acceleration,
            "guard.braking",
            "above 0, up to limits.acceleration",
        )
    }
}

fn check(ok: bool, field: &'static str, allowed: &'static str) -> Result<(), ParamError> {
    if ok {
        Ok(())
    } else {
        Err(ParamError { field, allowed })
    }
}
