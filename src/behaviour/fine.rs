//! The fine controller in physical units: metres and a heading error in, m/s and rad/s out.
//!
//! The axes of the tables and the robot's own scales meet here, once: [`FineController::new`] folds d's scale, the top
//! speed and the deflection rate into one factor each. In a `const` they are the code's own constants.

use crate::fuzzy::{InputScale, Mirrored, MirroredTwin, OutputScale, Position, Twin};
use crate::params::{Follower, Limits};
use crate::signals::{Controller, RuleTrace};
use crate::tables::fine::{Deflection, FineTwin, SPEED_AXIS, Speed, SpeedAxis};
use crate::units::{Angle, Metres, MetresPerSecond, RadiansPerSecond};

/// Fine tables and the scales of their inputs and outputs.
#[derive(Clone, Copy, Debug)]
pub struct FineController(MirroredTwin<5, 5, 4>);

/// What one evaluation gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FineMotion {
    /// Forward speed.
    pub speed: MetresPerSecond,
    /// Yaw rate towards the heading error, with its sign.
    pub yaw_rate: RadiansPerSecond,
    /// d on its axis.
    distance: Position,
    /// φ on its axis.
    angle: Position,
    twin: Twin<5, 5>,
}

impl FineController {
    /// Of [checked](crate::params::Params::check) settings: tables, d's scale, reading of the speed axis, top speed,
    /// deflection rate.
    ///
    /// A scale is kept to 16 significant bits, d's to a quarter of its own step.
    pub const fn new(follower: &Follower, limits: &Limits) -> Self {
        Self::of(follower.tables.twin(), follower, limits)
    }

    /// Like [`new`](Self::new) with tables of one's own instead of the settings'.
    pub const fn of(twin: &'static FineTwin, follower: &Follower, limits: &Limits) -> Self {
        // One axis unit is a quarter of d's axis, 2^30 of its 2^32 steps: 2^14 a count of 2^-16.
        let units = follower.distance_scale.to_bits();
        let distance = if units > 0 {
            (units as u32 + 2) >> 2
        } else {
            0
        };
        let top = if limits.speed.bits() > 0 {
            limits.speed.bits() as u64
        } else {
            0
        };
        let extra = Twin::<5, 5>::EXTRA_BITS;
        let axis = (SPEED_AXIS.to_bits() as u64) << extra;
        let speed = match follower.speed_axis {
            SpeedAxis::Scaled => OutputScale::new(top, axis),
            SpeedAxis::Literal => OutputScale::new(1 << 16, 1 << (Speed::FRAC_NBITS + extra)),
        };
        let rate = follower.deflection_rate.to_bits();
        let rate = if rate > 0 { rate as u64 } else { 0 };
        // π in Q30 by 180°.
        let radians = (3_373_259_426, 180 << (Deflection::FRAC_NBITS + extra + 30));
        let yaw_rate = OutputScale::new(rate * radians.0, radians.1);
        let distance = InputScale::new(distance);
        // Half a turn is the angle's axis.
        Self(MirroredTwin::new(twin, distance, [speed, yaw_rate]))
    }

    /// Equations 7.2 and 7.3 with their scales. d below 0 counts as 0, above its axis as its end; the magnitude of a
    /// heading error to the right is taken one step of 2⁻³² of a turn less.
    #[inline(always)]
    pub fn evaluate(&self, d: Metres, heading_error: Angle) -> FineMotion {
        FineMotion::of(self.0.evaluate(heading_error.bits(), d.bits()))
    }

    /// [`evaluate`](Self::evaluate) without any processor's own instructions: the same result on every one.
    #[inline(always)]
    pub fn evaluate_plain(&self, d: Metres, heading_error: Angle) -> FineMotion {
        FineMotion::of(self.0.evaluate_plain(heading_error.bits(), d.bits()))
    }
}

impl FineMotion {
    #[inline(always)]
    fn of(mirrored: Mirrored<5, 5>) -> Self {
        Self {
            speed: MetresPerSecond::from_bits(mirrored.first),
            yaw_rate: RadiansPerSecond::from_bits(mirrored.second),
            distance: mirrored.column,
            angle: mirrored.row,
            twin: mirrored.twin,
        }
    }

    /// Inputs and outputs on their axes, and the rules.
    pub fn trace(&self) -> RuleTrace {
        let [speed_output, deflection_output] = self.twin.rounded();
        // 180 · 2^16 of 2^32 steps are 45 of 2^14.
        let degrees = (self.angle.bits() >> 7)
            .wrapping_mul(45)
            .wrapping_add(1 << 6)
            >> 7;
        RuleTrace {
            controller: Controller::Fine,
            distance_input: ((self.distance.bits() >> 13).wrapping_add(1) >> 1) as i32,
            angle_input: degrees as i32,
            speed_output,
            deflection_output,
            rules: self.twin.activation.rules(),
            ..RuleTrace::default()
        }
    }
}
