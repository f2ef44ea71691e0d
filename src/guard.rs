//! The last barrier before the wheels: the straight corridor ahead must be free over the braking distance. It sees
//! echoes, knows nothing of paths, rules or modes, and may only slow or stop.

use crate::geometry::{leg, root, square};
use crate::integer::{quotient, saturate};
use crate::params::Guard;
use crate::signals::{Sensed, Twist};
use crate::units::{Metres, MetresPerSecond, Seconds};

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
    if wanted.linear <= MetresPerSecond::ZERO {
        return (wanted, false);
    }
    let (period, latency) = timing;
    let reaction = period + latency;
    let slowing = MetresPerSecond::new(params.braking).over(latency);
    let faster = MetresPerSecond::from_bits(slowing.bits() >> 1);
    let under_way = (last.linear.max(MetresPerSecond::ZERO) + faster).over(latency);
    let braking = u64::from(params.braking.to_bits().unsigned_abs());
    // What `free` leaves for either term.
    let granted = |free: Metres| {
        let free = (free - under_way).max(Metres::ZERO);
        let squared = braking.wrapping_mul(free.bits().unsigned_abs().into());
        (i64::from(free.bits()) << 23, squared)
    };
    // Products say whether the speed is within both limits; a division and a root are for one that is not.
    let needs = i64::from(wanted.linear.bits()).wrapping_mul(reaction.bits().into());
    let needs_squared = square(Metres::from_bits(wanted.linear.bits()));
    let passes = |free: Metres| {
        let (room, squared) = granted(free);
        needs <= room && needs_squared <= squared
    };
    let reach = radius + params.margin;
    // Nearer than its x less the whole reach no echo can be: mostly that says enough.
    let mut nearest = Metres::MAX;
    let mut spreads = sensed.spreads.iter();
    for echo in &sensed.echoes {
        let wide = reach + spreads.next().copied().unwrap_or_default();
        if echo.x > Metres::ZERO && echo.y < wide && echo.y > -wide {
            nearest = nearest.min(echo.x);
        }
    }
    if nearest == Metres::MAX || passes(nearest - reach) {
        return (wanted, false);
    }
    let mut free = Metres::MAX;
    let mut spreads = sensed.spreads.iter();
    for echo in &sensed.echoes {
        let spread = spreads.next().copied().unwrap_or_default();
        // The place nearest to the corridor's middle that the echo may come from.
        let beside = (echo.y.abs() - spread).max(Metres::ZERO);
        if echo.x > Metres::ZERO && beside < reach && echo.x - reach < free {
            free = free.min((echo.x - leg(reach, beside)).max(Metres::ZERO));
        }
    }
    if passes(free) {
        return (wanted, false);
    }
    let (room, squared) = granted(free);
    let by_reaction = quotient(room, reaction.bits()).map_or(i32::MAX, saturate);
    let limit = MetresPerSecond::from_bits(by_reaction.min(root(squared).bits()));
    let guarded = Twist {
        linear: limit,
        angular: wanted.angular,
    };
    (guarded, true)
}
