//! The records that pass between the stages of one tick. Stages never see each other, only these.
//!
//! Frames: *world* is the odometry frame, in which the path is given too; *body* is the robot's, x forward, y left.

use crate::fuzzy::ActiveRules;
use crate::geometry::{Point, Pose, Rotation, root, square};
use crate::params::MAX_BEAMS;
use crate::ports::Fault;
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, RadiansPerSecond};
use heapless::Vec;

/// The most obstacles that one scan yields; nearer ones win.
pub const MAX_OBSTACLES: usize = 8;

/// A circular obstacle, body frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Obstacle {
    /// Centre, body frame.
    pub centre: Point,
    /// Radius, positive.
    pub radius: Metres,
    /// RMS distance of the echoes from the circle.
    pub residual: Metres,
    /// Echoes behind it.
    pub echoes: u8,
}

impl Obstacle {
    /// Direction of the centre, body frame: the chapter's θ.
    pub fn bearing(&self) -> Angle {
        self.centre.direction()
    }

    /// From the robot's rim to the obstacle's surface: the chapter's s. Not below zero.
    pub fn free_distance(&self, robot_radius: Metres) -> Metres {
        (self.centre.norm() - self.radius - robot_radius).max(Metres::ZERO)
    }

    /// Whether the [`free_distance`](Self::free_distance) is below `limit`. Compares squares: no root.
    pub fn is_nearer(&self, robot_radius: Metres, limit: Metres) -> bool {
        let reach = self.radius + robot_radius + limit;
        limit > Metres::ZERO && reach > Metres::ZERO && self.centre.norm_squared() < square(reach)
    }

    /// β/2 of the chapter's unfeasible region: half the angle that the obstacle, its radius grown by `grown`, subtends.
    /// A quarter turn when the robot is inside the grown circle.
    pub fn unfeasible_half_angle(&self, grown: Metres) -> Angle {
        let reach = self.radius + grown;
        let beyond = self.centre.norm_squared().checked_sub(square(reach));
        match beyond {
            None | Some(0) => Angle::QUARTER,
            Some(leg) => Angle::of(root(leg).bits(), reach.bits()),
        }
    }

    /// All that deciding and avoiding ask of the obstacle that is passed, `grown` the growth of its radius.
    pub fn sight(&self, grown: Metres) -> Sight {
        Sight {
            bearing: self.bearing(),
            distance: self.centre.norm(),
            half_angle: self.unfeasible_half_angle(grown),
        }
    }

    /// The edge of the unfeasible region on the side of a `turn`: the bearing and half the angle together, without an
    /// angle in between. Across the centre's direction when the robot is inside the grown circle. Within 0.01°, and as long as
    /// one within 2^-12.
    pub fn unfeasible_edge(&self, grown: Metres, turn: Turn) -> Rotation {
        let reach = self.radius + grown;
        let squared = self.centre.norm_squared();
        let beyond = squared
            .checked_sub(square(reach))
            .filter(|beyond| *beyond > 0);
        let Some(beyond) = beyond else {
            let centre = self.bearing().rotation();
            return match turn {
                Turn::Left => centre.left(),
                Turn::Right => centre.right(),
            };
        };
        let leg = root(beyond);
        // With all lengths in 15 bits the products are short; a thousandth of a degree is lost.
        let bits = 65u32.wrapping_sub(squared.leading_zeros()) >> 1;
        let down = bits.saturating_sub(15);
        let short = |length: Metres| length.bits().wrapping_shr(down);
        let (x, y, leg) = (short(self.centre.x), short(self.centre.y), short(leg));
        let aside = match turn {
            Turn::Left => short(reach),
            Turn::Right => short(reach).wrapping_neg(),
        };
        // The centre's vector turned by asin(reach / distance), as long as distance².
        Rotation::of_length(
            x.wrapping_mul(leg).wrapping_sub(y.wrapping_mul(aside)),
            y.wrapping_mul(leg).wrapping_add(x.wrapping_mul(aside)),
            x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y)) as u32,
        )
    }

    /// Whether the direction `way` lies in the unfeasible region, edges not included: the obstacle, its radius grown by
    /// `grown`, stands on that ray.
    pub fn covers(&self, way: Rotation, grown: Metres) -> bool {
        let (along, beside) = way.along_and_beside(self.centre);
        // Rounded down it is below the reach if and only if it is.
        let beside = (beside.unsigned_abs() >> Rotation::FRACTION) as u32;
        along > 0
            && beside
                < (self.radius + grown)
                    .max(Metres::ZERO)
                    .bits()
                    .unsigned_abs()
    }

    /// [`covers`](Self::covers) for the direction straight ahead.
    pub fn stands_ahead(&self, grown: Metres) -> bool {
        self.centre.x > Metres::ZERO && self.centre.y.abs() < self.radius + grown
    }
}

/// How an obstacle lies before the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sight {
    /// Direction of its centre, body frame.
    pub bearing: Angle,
    /// Distance of its centre.
    pub distance: Metres,
    /// Half the angle of its unfeasible region.
    pub half_angle: Angle,
}

/// What the sensors say this tick.
#[derive(Clone, Debug, Default)]
pub struct Sensed {
    /// Echo points on their sensors' axes, body frame.
    pub echoes: Vec<Point, MAX_BEAMS>,
    /// How far beside its point each echo may really stand: a cone says "somewhere on this arc". In the order of
    /// `echoes`; 0 for beams.
    pub spreads: Vec<Metres, MAX_BEAMS>,
    /// Obstacles, in the order of their nearest echoes, nearest first.
    pub obstacles: Vec<Obstacle, MAX_OBSTACLES>,
    /// Sensors with a valid reading.
    pub valid: u8,
    /// Nearest echo, as distance from the robot's centre; the largest value if there is none.
    pub nearest: Metres,
}

impl Sensed {
    /// Nothing looked at yet.
    pub const fn new() -> Self {
        Self {
            echoes: Vec::new(),
            spreads: Vec::new(),
            obstacles: Vec::new(),
            valid: 0,
            nearest: Metres::ZERO,
        }
    }
}

/// Wheel travel since the last good reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Travel {
    /// Counts of the left and right wheel.
    Counts {
        /// Left wheel.
        left: i32,
        /// Right wheel.
        right: i32,
    },
    /// Unknown, and why.
    Unknown(Fault),
}

/// Where the robot is relative to its path, and where guidance wants it to head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Guidance {
    /// Nearest path point within the cursor's reach, world.
    pub foot: Point,
    /// Signed cross-track error, left of the path positive.
    pub cross_track: Metres,
    /// Distance to the foot: the chapter's d before scaling.
    pub distance: Metres,
    /// Tangent at the foot: the chapter's ζ, world.
    pub tangent: Angle,
    /// Curvature where the next command will act.
    pub curvature: PerMetre,
    /// Direction to steer, body frame; its magnitude is the chapter's φ.
    pub heading_error: Angle,
    /// Path length up to the foot.
    pub progress: Metres,
    /// Path length still to go; the largest value on a closed path.
    pub remaining: Metres,
    /// Times the start of a closed path was passed.
    pub laps: u16,
    /// Speed that bends, corners and the end ahead allow, the robot's top speed at most; that itself in a tick that does
    /// not follow the path.
    pub speed_limit: MetresPerSecond,
    /// The path's end is reached.
    pub at_end: bool,
    /// The path is over, the robot is not at its end, and its law leads nowhere else.
    pub missed_end: bool,
}

/// Which way past an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Turn {
    /// Turn left: the obstacle stays on the right.
    Left,
    /// Turn right: the obstacle stays on the left.
    Right,
}

/// Why the robot stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StopReason {
    /// No valid range reading for longer than allowed.
    NoRanges,
    /// No odometry for longer than allowed.
    NoOdometry,
    /// The path is driven to its end.
    PathEnd,
    /// The path is over, and the robot is not at its end. Only the printed law gives up so; the guided one heads for
    /// the end.
    PathMissed,
}

/// What the higher level decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Decision {
    /// Follow the path.
    Follow,
    /// Pass `obstacle` by turning to `side`.
    Avoid {
        /// The committed side.
        side: Turn,
        /// The obstacle held, body frame of this tick.
        obstacle: Obstacle,
    },
    /// Stand still.
    Stop(StopReason),
}

/// A commanded motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Twist {
    /// Forward speed.
    pub linear: MetresPerSecond,
    /// Yaw rate, counter-clockwise positive.
    pub angular: RadiansPerSecond,
}

impl Twist {
    /// Standing still.
    pub const REST: Self = Self {
        linear: MetresPerSecond::ZERO,
        angular: RadiansPerSecond::ZERO,
    };
}

/// Wheel speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WheelCommand {
    /// Left wheel.
    pub left: MetresPerSecond,
    /// Right wheel.
    pub right: MetresPerSecond,
}

/// Which controller's rules a [`RuleTrace`] holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Controller {
    /// None ran.
    #[default]
    None,
    /// The fine follower: rows φ, columns d, both outputs.
    Fine,
    /// The coarse avoider: rows s, columns angle; `rules` of the deflection, `speed_rules` of the speed.
    Coarse,
}

/// The lower level's inputs, outputs and fired rules, for the record.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RuleTrace {
    /// Which controller ran.
    pub controller: Controller,
    /// d (axis units, up to the axis' end) or s (share of the detection range), as `I16F16` bits.
    pub distance_input: i32,
    /// φ (fine, unsigned) or θ (coarse, chapter's sign), degrees as `I16F16` bits.
    pub angle_input: i32,
    /// Speed on its axis, the output's raw bits: `I3F13` (fine) or `I2F14` (coarse).
    pub speed_output: i16,
    /// Deflection in degrees, `I8F8` bits: unsigned (fine) or clockwise positive (coarse).
    pub deflection_output: i16,
    /// Rules of the (deflection) table.
    pub rules: ActiveRules,
    /// Rules of the coarse speed table; none for the fine controller, whose tables share theirs.
    pub speed_rules: ActiveRules,
}

/// What the lower level wants.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Behaviour {
    /// Desired motion.
    pub twist: Twist,
    /// How it came about.
    pub trace: RuleTrace,
}

/// Everything that one tick decided: the log's line, the replay's frame, the bit-exact digest's input.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TickRecord {
    /// Number of the tick, from 0; wraps.
    pub tick: u32,
    /// Decision of the higher level.
    pub decision: Decision,
    /// Believed pose, world.
    pub pose: Pose,
    /// Relation to the path.
    pub guidance: Guidance,
    /// Obstacles in sight.
    pub obstacles: u8,
    /// Sensors with a valid reading.
    pub valid_ranges: u8,
    /// Nearest echo from the robot's centre.
    pub nearest: Metres,
    /// Lower level's inputs, outputs and rules.
    pub trace: RuleTrace,
    /// Motion that the lower level wanted.
    pub desired: Twist,
    /// Motion that the guard let pass and the drive's limits allow.
    pub twist: Twist,
    /// Wheel speeds commanded.
    pub wheels: WheelCommand,
    /// The guard had to slow or stop the robot.
    pub guarded: bool,
    /// Writing to a wheel failed.
    pub drive_fault: bool,
}
