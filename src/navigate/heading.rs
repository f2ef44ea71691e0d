//! Choice of the heading: the cheapest admissible sector of the polar map, refined between its neighbours.
//!
//! A sector is admissible if the footprint can turn into it in place and then drive at least a least distance: that is the
//! hard check, and no rule table comes after it that could overrule it.

use super::polar::{PolarMap, SECTORS, middle};
use super::steps::Steps;
use crate::integer::proper_fraction;
use crate::units::{Angle, Metres};
use fixed::types::I16F16;

/// The choice's settings: what a heading costs, each weight 0 to 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingParams {
    /// Least free travel of an admissible heading.
    pub least: Metres,
    /// A radian away from the direction wanted.
    pub toward: I16F16,
    /// A radian away from straight ahead.
    pub ahead: I16F16,
    /// A radian away from the last choice.
    pub commitment: I16F16,
    /// No free travel with the soft margin, beside all of it.
    pub soft: I16F16,
    /// No free travel with the hard margin, beside all of it.
    pub hard: I16F16,
    /// No free travel with the soft margin in a neighbouring sector.
    pub neighbours: I16F16,
}

/// A heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heading {
    /// Body frame.
    pub angle: Angle,
    /// Free travel with the hard margin in its sector.
    pub hard: Steps,
    /// Free travel with the soft margin in its sector.
    pub soft: Steps,
}

/// Weights for integers: costs have 12 fractional bits.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    toward: u32,
    ahead: u32,
    commitment: u32,
    soft: u32,
    hard: u32,
    neighbours: u32,
}

impl Weights {
    pub(super) fn new(params: &HeadingParams) -> Self {
        let weight = |w: I16F16| w.to_bits().clamp(0, 4 << 16).unsigned_abs();
        // For binary angles of 16 bits: 2π / 2^16 radians, 12 more fractional bits in and out.
        let angle = |w: I16F16| ((u64::from(weight(w)).wrapping_mul(25_736)) >> 16) as u32;
        let share = |w: I16F16| weight(w) >> 4;
        Self {
            toward: angle(params.toward) / 16,
            ahead: angle(params.ahead) / 16,
            commitment: angle(params.commitment) / 16,
            soft: share(params.soft),
            hard: share(params.hard),
            neighbours: share(params.neighbours),
        }
    }

    /// Cost of an angle: |Δ| of 16 bits times a weight of 16 − 4 fractional bits.
    fn angle(weight: u32, off: Angle) -> u32 {
        (off.abs().bits().unsigned_abs() >> 16).wrapping_mul(weight) >> 12
    }
}

/// What is wanted of a heading.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Direction, body frame.
    pub direction: Angle,
    /// The last choice, body frame.
    pub last: Angle,
    /// Distance to the carrot.
    pub distance: Steps,
    /// Look range of the map.
    pub look: Steps,
}

/// The cheapest admissible heading; none if the robot can go nowhere.
pub fn choose(
    params: &HeadingParams,
    weights: &Weights,
    map: &PolarMap,
    wanted: &Wanted,
) -> Option<Heading> {
    let least = Steps::of(params.least).min(wanted.distance);
    let horizon = wanted
        .distance
        .max(const { Steps::lit("0.3") })
        .min(wanted.look);
    // Free travel as a share of the horizon, 12 fractional bits: by a product.
    let reciprocal = proper_fraction(1 << 8, horizon.bits().unsigned_abs().max(1 << 8));
    let taken = |free: Steps| {
        let free = free.min(horizon).bits().max(0).unsigned_abs();
        // free · 2^8 / horizon · 2^24 / 2^20.
        4096u32.saturating_sub(free.wrapping_mul(reciprocal >> 8) >> 12)
    };
    let admissible = |sector: usize| map.hard(sector) >= least && map.can_turn(middle(sector));
    let turning = |sector: usize| {
        let angle = middle(sector);
        Weights::angle(weights.toward, angle - wanted.direction)
            .wrapping_add(Weights::angle(weights.ahead, angle))
            .wrapping_add(Weights::angle(weights.commitment, angle - wanted.last))
    };
    let tightness = |sector: usize| {
        let [left, right] = [sector.wrapping_add(1), sector.wrapping_sub(1)];
        let beside = taken(map.soft(left)).wrapping_add(taken(map.soft(right)));
        (taken(map.soft(sector)).wrapping_mul(weights.soft) >> 12)
            .wrapping_add(taken(map.hard(sector)).wrapping_mul(weights.hard) >> 12)
            .wrapping_add(beside.wrapping_mul(weights.neighbours) >> 12)
    };
    let cost = |sector: usize| turning(sector).wrapping_add(tightness(sector));
    let mut best = None::<(usize, u32)>;
    for sector in 0..SECTORS {
        // What the turn alone costs rules most sectors out.
        let dearer = |known: u32| best.is_some_and(|(_, least)| known >= least);
        if !admissible(sector) {
            continue;
        }
        let turn = turning(sector);
        if dearer(turn) {
            continue;
        }
        let cost = turn.wrapping_add(tightness(sector));
        if !dearer(cost) {
            best = Some((sector, cost));
        }
    }
    let (sector, _) = best?;
    Some(Heading {
        angle: refined(sector, wanted.direction, admissible, cost),
        hard: map.hard(sector),
        soft: map.soft(sector),
    })
}

/// Between the sectors: the wanted direction itself if it lies in the sector, else the vertex of the parabola through
/// the costs of the sector and its neighbours.
fn refined(
    sector: usize,
    direction: Angle,
    admissible: impl Fn(usize) -> bool,
    cost: impl Fn(usize) -> u32,
) -> Angle {
    const HALF: Angle = Angle::from_bits(1 << 25);
    let centre = middle(sector);
    let off = direction - centre;
    if off.abs().bits() <= HALF.bits() {
        return direction;
    }
    let [left, right] = [sector.wrapping_add(1) & 63, sector.wrapping_sub(1) & 63];
    if !admissible(left) || !admissible(right) {
        return centre;
    }
    let [left, own, right] = [left, sector, right].map(|s| cost(s).min(1 << 20) as i32);
    let bend = left.wrapping_add(right).wrapping_sub(own.wrapping_mul(2));
    // (right − left) / 2·bend sectors to the left, within half a sector.
    let shift = crate::integer::ratio(1 << 25, right.wrapping_sub(left), bend);
    centre + Angle::from_bits(shift).limit(HALF)
}
