//! The last barrier before the wheels: the straight corridor ahead must be free over the braking distance. It sees
//! echoes, knows nothing of paths, rules or modes, and may only slow or stop.

use crate::geometry::leg;
use crate::params::Guard;
use crate::signals::{Sensed, Twist};
use crate::units::{Metres, MetresPerSecond, Seconds, saturate};

/// Limits the speed so that the robot's disc, grown by the margin, stops before the nearest echo in its corridor.
///
/// With braking a and reaction time T (a period and the latency) a speed v needs v·T + v²/2a. Half of the free
/// distance is granted to each term: v ≤ free/2T and v ≤ √(a·free). Turning in place stays allowed; a disc turns
/// freely. Returns the twist and whether it was limited.
pub fn guard(
    params: &Guard,
    radius: Metres,
    reaction: Seconds,
    sensed: &Sensed,
    wanted: Twist,
) -> (Twist, bool) {
    let reach = radius + params.margin;
    let mut free = Metres::MAX;
    for echo in &sensed.echoes {
        if echo.x > Metres::ZERO && echo.y.abs() < reach {
            free = free.min((echo.x - leg(reach, echo.y)).max(Metres::ZERO));
        }
    }
    if free == Metres::MAX || wanted.linear <= MetresPerSecond::ZERO {
        return (wanted, false);
    }
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
