//! The last barrier before the wheels: the straight corridor ahead must be free over the braking distance. It sees
//! echoes, knows nothing of paths, rules or modes, and may only slow or stop.

use crate::geometry::leg;
use crate::params::Guard;
use crate::signals::{Sensed, Twist};
use crate::units::{Metres, MetresPerSecond, Seconds, saturate};

/// Limits the speed so that the robot's disc, grown by the margin, stops before the nearest echo in its corridor.
///
/// What is still to be driven on commands already under way, (v + a·L/2)·L with v the speed commanded last, a the
/// braking and L the latency, is taken from the free distance first. With reaction time T (a period and the latency) a
/// speed v then needs v·T + v²/2a; half of the rest is granted to each term: v ≤ free/2T and v ≤ √(a·free). Turning in
/// place stays allowed; a disc turns freely. Returns the twist and whether it was limited.
///
/// `timing` is period and latency; `last` the twist commanded in the tick before.
pub fn guard(
    params: &Guard,
    radius: Metres,
    timing: (Seconds, Seconds),
    sensed: &Sensed,
    last: Twist,
    wanted: Twist,
) -> (Twist, bool) {
    let (period, latency) = timing;
    let reaction = period + latency;
    let reach = radius + params.margin;
    let mut free = Metres::MAX;
    for (i, echo) in sensed.echoes.iter().enumerate() {
        // The place nearest to the corridor's middle that the echo may come from.
        let spread = sensed.spreads.get(i).copied().unwrap_or_default();
        let beside = (echo.y.abs() - spread).max(Metres::ZERO);
        if echo.x > Metres::ZERO && beside < reach {
            free = free.min((echo.x - leg(reach, beside)).max(Metres::ZERO));
        }
    }
    if free == Metres::MAX || wanted.linear <= MetresPerSecond::ZERO {
        return (wanted, false);
    }
    let slowing = MetresPerSecond::new(params.braking).over(latency);
    let faster = MetresPerSecond::from_bits(slowing.bits() >> 1);
    let under_way = (last.linear.max(MetresPerSecond::ZERO) + faster).over(latency);
    let free = (free - under_way).max(Metres::ZERO);
    let distance = u64::from(free.bits().unsigned_abs());
    let by_reaction = (i64::from(free.bits()) << 23)
        .checked_div(i64::from(reaction.bits()))
        .map_or(i32::MAX, saturate);
    let braking = u64::from(params.braking.to_bits().unsigned_abs());
    let by_braking = saturate(braking.saturating_mul(distance).isqrt() as i64);
    let limit = MetresPerSecond::from_bits(by_reaction.min(by_braking));
    if wanted.linear <= limit {
        return (wanted, false);
    }
    let guarded = Twist {
        linear: limit,
        angular: wanted.angular,
    };
    (guarded, true)
}
