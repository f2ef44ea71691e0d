//! The navigator's settings, and what is made of them once before the first tick.

use super::barrier::BarrierParams;
use super::doubt::DoubtParams;
use super::field::{Costs, FieldParams};
use super::footprint::{Footprint, Outline};
use super::heading::{HeadingParams, Weights};
use super::health::HealthParams;
use super::memory::MemoryParams;
use super::polar::MapParams;
use super::sensors::{Eyes, RangeSet};
use super::steer::SteerParams;
use super::supervisor::SupervisorParams;
use super::trajectory::Brakes;
use crate::behaviour::fine::FineController;
use crate::params::{Follower, Limits, ParamError};
use crate::units::{Metres, MetresPerSecond, RadiansPerSecond, Seconds};
use fixed::types::I16F16;

/// All settings of a navigator with up to `N` range sensors.
#[derive(Clone, Debug)]
pub struct NavigatorParams<const N: usize> {
    /// The robot's outline.
    pub footprint: Footprint,
    /// What the drive may ask of the robot. The yaw acceleration is also the brake gate's.
    pub limits: Limits,
    /// Top speed backward; positive.
    pub reverse: MetresPerSecond,
    /// Control period.
    pub period: Seconds,
    /// Time from a command to its effect.
    pub latency: Seconds,
    /// Range sensors.
    pub sensors: RangeSet<N>,
    /// When one of them counts as dead.
    pub health: HealthParams,
    /// What an echo may still mean to a fast robot.
    pub doubt: DoubtParams,
    /// Local memory.
    pub memory: MemoryParams,
    /// Polar map.
    pub map: MapParams,
    /// Guide field.
    pub field: FieldParams,
    /// Choice of the heading.
    pub heading: HeadingParams,
    /// From the heading to the twist.
    pub steer: SteerParams,
    /// Path following on free stretches.
    pub follower: Follower,
    /// Modes.
    pub supervisor: SupervisorParams,
    /// Last barrier.
    pub barrier: BarrierParams,
}

/// [Checked](NavigatorParams::setup) settings, made ready. Nothing in it changes while the robot drives: it may lie in flash.
#[derive(Clone, Debug)]
pub struct Setup<const N: usize> {
    pub(super) params: NavigatorParams<N>,
    pub(super) outline: Outline,
    pub(super) eyes: Eyes<N>,
    pub(super) costs: Costs,
    pub(super) weights: Weights,
    pub(super) brakes: Brakes,
    pub(super) fine: FineController,
}

impl<const N: usize> NavigatorParams<N> {
    /// The settings made ready, if the robot can be driven with them.
    ///
    /// # Errors
    ///
    /// The first field that forbids it, and what is allowed.
    pub fn setup(self) -> Result<Setup<N>, ParamError> {
        self.check()?;
        let angular = RadiansPerSecond::new(self.limits.yaw_acceleration);
        let brakes = Brakes {
            period: self.period,
            linear: per(self.limits.acceleration, self.period),
            angular: RadiansPerSecond::from_bits(per(angular.get(), self.period).bits()),
        };
        Ok(Setup {
            outline: self.footprint.outline(),
            eyes: Eyes::new(&self.sensors, self.memory.arc),
            costs: Costs::new(&self.field),
            weights: Weights::new(&self.heading),
            brakes,
            fine: FineController::new(&self.follower, &self.limits),
            params: self,
        })
    }

    /// Whether the robot can be driven with these settings.
    ///
    /// # Errors
    ///
    /// The first field that forbids it, and what is allowed.
    pub fn check(&self) -> Result<(), ParamError> {
        self.footprint.check()?;
        self.sensors.check()?;
        self.field.check()?;
        self.doubt.check()?;
        let limits = &self.limits;
        let range = |ok, field, allowed| {
            if ok {
                Ok(())
            } else {
                Err(ParamError { field, allowed })
            }
        };
        let positive = |ok, field| range(ok, field, "above 0");
        positive(limits.speed > MetresPerSecond::ZERO, "limits.speed")?;
        range(
            limits.speed <= const { MetresPerSecond::lit("4") },
            "limits.speed",
            "up to 4 m/s",
        )?;
        positive(limits.yaw_rate > 0, "limits.yaw_rate")?;
        positive(limits.acceleration > 0, "limits.acceleration")?;
        positive(limits.yaw_acceleration > 0, "limits.yaw_acceleration")?;
        positive(self.reverse > MetresPerSecond::ZERO, "reverse")?;
        range(
            (const { Seconds::lit("0.005") }..=const { Seconds::lit("0.2") })
                .contains(&self.period),
            "period",
            "5 to 200 ms",
        )?;
        range(
            (Seconds::ZERO..=const { Seconds::lit("0.5") }).contains(&self.latency),
            "latency",
            "0 to 0.5 s",
        )?;
        range(
            (const { Metres::lit("0.5") }..=const { Metres::lit("3.5") })
                .contains(&self.memory.keep),
            "memory.keep",
            "0.5 to 3.5 m",
        )?;
        range(
            (I16F16::ZERO..=I16F16::ONE).contains(&self.memory.arc),
            "memory.arc",
            "0 to 1",
        )?;
        range(
            self.memory.lifetime <= 3200,
            "memory.lifetime",
            "up to 3200 ticks",
        )?;
        range(
            (const { Metres::lit("0.2") }..=const { Metres::lit("3") }).contains(&self.map.look),
            "map.look",
            "0.2 to 3 m",
        )?;
        range(
            self.barrier.braking > 0 && self.barrier.braking <= limits.acceleration,
            "barrier.braking",
            "above 0, up to limits.acceleration",
        )?;
        range(
            (I16F16::ZERO..=I16F16::ONE).contains(&self.barrier.share),
            "barrier.share",
            "0 to 1",
        )?;
        range(
            self.supervisor.patience >= 9,
            "supervisor.patience",
            "9 ticks or more",
        )?;
        positive(self.health.doubts > 0, "health.doubts")?;
        positive(self.health.speed > MetresPerSecond::ZERO, "health.speed")?;
        let margins = [
            (self.barrier.margin, "barrier.margin"),
            (self.barrier.behind, "barrier.behind"),
            (self.barrier.gate, "barrier.gate"),
        ];
        for (margin, field) in margins {
            let most = const { Metres::lit("0.5") };
            range((Metres::ZERO..=most).contains(&margin), field, "0 to 0.5 m")?;
        }
        Ok(())
    }
}

/// What a rate per second makes in a period.
pub(super) fn per(rate: I16F16, period: Seconds) -> MetresPerSecond {
    MetresPerSecond::from_bits(MetresPerSecond::new(rate).over(period).bits())
}
