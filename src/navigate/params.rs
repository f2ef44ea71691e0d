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
    /// Control period, 5 to 100 ms: none drives farther than 0.15 m, and 23 of them stop the robot.
    pub period: Seconds,
    /// Time from a command to its effect, two periods at most.
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

/// [Checked](NavigatorParams::setup) settings, made ready when the program starts; nothing in it changes while the robot drives.
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

    /// The least margin of the brake gate: 1 cm, or three tenths of what the outline's farthest place turns in a period. That
    /// place is looked at twice a period: half of such a step must not carry it past a point, and it drives on meanwhile.
    pub fn least_gate(&self) -> Metres {
        let turned = I16F16::from_bits(per(self.limits.yaw_rate, self.period).bits());
        let swept = self.footprint.outline().reach.metres().scale(turned);
        // Rounded up.
        let share = swept.scale(const { I16F16::lit("0.3") });
        Metres::from_bits(share.bits().saturating_add(1)).max(const { Metres::lit("0.01") })
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
            (const { Seconds::lit("0.005") }..=const { Seconds::lit("0.1") })
                .contains(&self.period),
            "period",
            "5 to 100 ms",
        )?;
        // What acts until then is known of two commands.
        let two = Seconds::from_bits(self.period.bits().wrapping_mul(2));
        range(
            (Seconds::ZERO..=two).contains(&self.latency),
            "latency",
            "0 to two periods",
        )?;
        // In longer steps a corner may pass a point that neither end of one shows.
        range(
            limits.speed.over(self.period) <= const { Metres::lit("0.151") },
            "limits.speed",
            "up to 0.15 m a period",
        )?;
        range(
            self.reverse.over(self.period) <= const { Metres::lit("0.151") },
            "reverse",
            "up to 0.15 m a period",
        )?;
        // Braking is followed to its end only then; a period's part of it is rounded.
        let stops = |most: i32, rate: I16F16| {
            let braked = i64::from(per(rate, self.period).bits()).wrapping_mul(BRAKING);
            i64::from(most) <= braked.saturating_add(BRAKING)
        };
        range(
            stops(limits.speed.bits(), limits.acceleration),
            "limits.acceleration",
            "enough to stop from limits.speed in 23 periods",
        )?;
        range(
            stops(self.reverse.bits(), limits.acceleration),
            "reverse",
            "what limits.acceleration stops in 23 periods",
        )?;
        range(
            stops(limits.yaw_rate.to_bits(), limits.yaw_acceleration),
            "limits.yaw_acceleration",
            "enough to stop from limits.yaw_rate in 23 periods",
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
        let most = const { Metres::lit("0.5") };
        let margins = [
            (self.barrier.margin, "barrier.margin"),
            (self.barrier.behind, "barrier.behind"),
        ];
        for (margin, field) in margins {
            range((Metres::ZERO..=most).contains(&margin), field, "0 to 0.5 m")?;
        }
        range(
            (self.least_gate()..=most).contains(&self.barrier.gate),
            "barrier.gate",
            "0.01 to 0.5 m, and no less than NavigatorParams::least_gate",
        )
    }
}

/// Periods after which a robot that brakes has come to rest: one less than the barrier looks ahead.
const BRAKING: i64 = super::trajectory::MAX_STEPS as i64 / 2 - 1;

/// What a rate per second makes in a period.
pub(super) fn per(rate: I16F16, period: Seconds) -> MetresPerSecond {
    MetresPerSecond::from_bits(MetresPerSecond::new(rate).over(period).bits())
}
