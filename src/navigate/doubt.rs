//! What an echo may still mean. It says that something stands somewhere across a cone; the memory makes points of it, between
//! which the true place may lie until the cone's edges have moved over it. A slow robot sees it in time. A fast one must be
//! able to stop for the worst of what its foremost echoes may mean.

use super::footprint::Outline;
use super::sensors::{Echo, Eyes};
use super::steps::Steps;
use crate::geometry::root;
use crate::params::ParamError;
use crate::units::{MetresPerSecond, Seconds};
use fixed::types::I16F16;

/// The settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubtParams {
    /// Up to this speed only what is remembered counts.
    pub careful: MetresPerSecond,
    /// Deceleration that stops the robot before an echo wherever it may stand across its cone, m/s².
    pub braking: I16F16,
}

impl DoubtParams {
    /// Whether the robot can drive with them.
    ///
    /// # Errors
    ///
    /// The first field that forbids it.
    pub fn check(&self) -> Result<(), ParamError> {
        let checks = [
            (
                self.careful >= MetresPerSecond::ZERO,
                "doubt.careful",
                "0 or more",
            ),
            (self.braking > I16F16::ZERO, "doubt.braking", "above 0"),
        ];
        match checks.into_iter().find(|(ok, ..)| !ok) {
            Some((_, field, allowed)) => Err(ParamError { field, allowed }),
            None => Ok(()),
        }
    }

    /// The speed that the echoes ahead allow, `careful` at least: √(2·a·s), s being the way of the front to the nearest place
    /// of a cone's arc that lies before the outline, less what is driven in `reaction` at `speed`.
    pub(super) fn cap<const N: usize>(
        &self,
        eyes: &Eyes<N>,
        echoes: &[Echo],
        outline: &Outline,
        speed: MetresPerSecond,
        reaction: Seconds,
    ) -> MetresPerSecond {
        let mut nearest = Steps::MAX;
        for (eye, echo) in eyes.as_slice().iter().zip(echoes) {
            let (Echo::Across(range), Some(direction)) = (*echo, eye.ahead) else {
                continue;
            };
            let across = direction.ahead(range);
            let beside = if eye.heading.is_left() {
                across.y
            } else {
                -across.y
            };
            let ahead = eye.at.x + across.x - outline.front;
            if (eye.at.y + beside).abs() < outline.half_width {
                nearest = nearest.min(ahead);
            }
        }
        if nearest == Steps::MAX {
            return MetresPerSecond::MAX;
        }
        let room = nearest - Steps::of(speed.abs().over(reaction));
        let squared = u64::from(self.braking.to_bits().unsigned_abs())
            .saturating_mul(room.max(Steps::ZERO).metres().bits().unsigned_abs().into())
            .saturating_mul(2);
        MetresPerSecond::from_bits(root(squared).bits()).max(self.careful)
    }
}
