//! Choice of the heading: the cheapest admissible sector of the polar map, refined between its neighbours.
//!
//! A sector is admissible if the footprint can turn into it in place and then drive at least a least distance: that is the
//! hard check, and no rule table comes after it that could overrule it. Free travel is asked for only where the turn alone
//! does not cost more than the cheapest heading known.

use super::near::Near;
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
    /// Points of the memory that the tick has looked at.
    pub judged: u32,
    /// Whether there is one matters more than which.
    pub briefly: bool,
}

/// The cheapest admissible heading; none if the robot can go nowhere.
pub fn choose(
    params: &HeadingParams,
    weights: &Weights,
    map: &mut PolarMap,
    near: &Near,
    wanted: &Wanted,
) -> Option<Heading> {
    let horizon = wanted
        .distance
        .max(const { Steps::lit("0.3") })
        .min(wanted.look);
    let mut costs = Costs {
        weights,
        wanted,
        map,
        near,
        least: Steps::of(params.least).min(wanted.distance),
        horizon,
        reciprocal: proper_fraction(1 << 8, horizon.bits().unsigned_abs().max(1 << 8)) >> 8,
    };
    let mut best = (u32::MAX, None);
    let mut consider = |costs: &mut Costs<'_>, sector: usize| {
        if let Some(cost) = costs.below(sector, best.0) {
            best = (cost, Some(sector));
        }
        best.0
    };
    // What may be cheap first, then from the direction wanted outward, as long as the turn away from it alone is not dearer.
    let wanted_sector = sector_of(wanted.direction);
    consider(&mut costs, wanted_sector);
    consider(&mut costs, sector_of(wanted.last));
    let mut most = consider(&mut costs, 0);
    let points = near.spots().len() as u32;
    let enough = if wanted.briefly { BRIEFLY } else { ENOUGH };
    let looks = LOOKS.saturating_sub(wanted.judged.wrapping_mul(JUDGED));
    let enough = enough.min(looks.checked_div(points).unwrap_or(ENOUGH));
    for step in 1..=SECTORS / 2 {
        let least_off = Angle::from_bits(((step as i32) << 26).wrapping_sub(1 << 25));
        if Weights::angle(weights.toward, least_off) >= most || costs.map.looked() >= enough {
            break;
        }
        consider(&mut costs, wanted_sector.wrapping_add(step) & (SECTORS - 1));
        most = consider(&mut costs, wanted_sector.wrapping_sub(step) & (SECTORS - 1));
    }
    let sector = best.1?;
    let free = costs.map.free(near, sector);
    Some(Heading {
        angle: refined(sector, wanted.direction, &mut costs),
        hard: free.hard,
        soft: free.soft,
    })
}

/// When so many sectors were looked along, the best one so far has to do: that bounds a tick. Fewer where many points are
/// near, or where whether there is a heading matters more than which.
const ENOUGH: u32 = 16;
/// About so many looks at points are left to all sectors together…
const LOOKS: u32 = 450;
/// …less so many for every point that the memory has judged.
const JUDGED: u32 = 2;
const BRIEFLY: u32 = 5;

/// The sector that an angle lies in.
fn sector_of(angle: Angle) -> usize {
    (angle + HALF_SECTOR).bits().cast_unsigned() as usize >> 26
}

const HALF_SECTOR: Angle = Angle::from_bits(1 << 25);

/// What headings cost.
struct Costs<'a> {
    weights: &'a Weights,
    wanted: &'a Wanted,
    map: &'a mut PolarMap,
    near: &'a Near,
    /// Least free travel.
    least: Steps,
    /// Free travel beyond this is worth nothing.
    horizon: Steps,
    /// 2⁸ a horizon, 24 fractional bits.
    reciprocal: u32,
}

impl Costs<'_> {
    /// What the turn costs.
    fn turning(&self, sector: usize) -> u32 {
        let (weights, wanted) = (self.weights, self.wanted);
        let angle = middle(sector);
        Weights::angle(weights.toward, angle - wanted.direction)
            .wrapping_add(Weights::angle(weights.ahead, angle))
            .wrapping_add(Weights::angle(weights.commitment, angle - wanted.last))
    }

    fn admissible(&mut self, sector: usize) -> bool {
        self.map.can_turn(middle(sector)) && self.map.free(self.near, sector).hard >= self.least
    }

    /// What too little room in the sector itself costs.
    fn tightness(&mut self, sector: usize) -> u32 {
        let free = self.map.free(self.near, sector);
        let weights = self.weights;
        (self.taken(free.soft).wrapping_mul(weights.soft) >> 12)
            .wrapping_add(self.taken(free.hard).wrapping_mul(weights.hard) >> 12)
    }

    /// And in those beside it.
    fn beside(&mut self, sector: usize) -> u32 {
        let [left, right] = [sector.wrapping_add(1), sector.wrapping_sub(1)]
            .map(|beside| self.map.free(self.near, beside).soft);
        let taken = self.taken(left).wrapping_add(self.taken(right));
        taken.wrapping_mul(self.weights.neighbours) >> 12
    }

    /// The part of the horizon that is not free, 12 fractional bits.
    fn taken(&self, free: Steps) -> u32 {
        let free = free.min(self.horizon).bits().max(0).unsigned_abs();
        4096u32.saturating_sub(free.wrapping_mul(self.reciprocal) >> 12)
    }

    fn cost(&mut self, sector: usize) -> u32 {
        self.turning(sector)
            .wrapping_add(self.tightness(sector))
            .wrapping_add(self.beside(sector))
    }

    /// The cost of an admissible sector, if it is less than `most`.
    fn below(&mut self, sector: usize, most: u32) -> Option<u32> {
        let turning = self.turning(sector);
        if turning >= most || !self.admissible(sector) {
            return None;
        }
        let own = turning.wrapping_add(self.tightness(sector));
        if own >= most {
            return None;
        }
        let cost = own.wrapping_add(self.beside(sector));
        (cost < most).then_some(cost)
    }
}

/// Between the sectors: the wanted direction itself if it lies in the sector, else the vertex of the parabola through
/// the costs of the sector and its neighbours.
fn refined(sector: usize, direction: Angle, costs: &mut Costs<'_>) -> Angle {
    let centre = middle(sector);
    let off = direction - centre;
    if off.abs().bits() <= HALF_SECTOR.bits() {
        return direction;
    }
    let [left, right] = [sector.wrapping_add(1) & 63, sector.wrapping_sub(1) & 63];
    if !costs.admissible(left) || !costs.admissible(right) {
        return centre;
    }
    let [left, own, right] = [left, sector, right].map(|s| costs.cost(s).min(1 << 20) as i32);
    let bend = left.wrapping_add(right).wrapping_sub(own.wrapping_mul(2));
    // (right − left) / 2·bend sectors to the left, within half a sector.
    let shift = crate::integer::ratio(1 << 25, right.wrapping_sub(left), bend);
    centre + Angle::from_bits(shift).limit(HALF_SECTOR)
}
