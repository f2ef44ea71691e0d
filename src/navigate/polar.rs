//! Polar feasibility map: how far the footprint can drive in each of 64 directions after turning in place into it, and how
//! far it can turn.
//!
//! 64 sectors, because a binary angle's upper six bits are then the sector. *Hard* is the free travel of the footprint
//! with a small margin: no heading below a least hard travel is admissible. *Soft* is that with a comfortable margin: it
//! costs.
//!
//! Cost: a sector is worked out when it is first asked for, by one pass over the points near; the choice of a heading asks
//! for few of them.

use super::digest::Digest;
use super::footprint::Outline;
use super::near::{Near, Spot};
use super::steps::{Bearing, Steps};
use crate::units::{Angle, Metres};

/// Sectors of the map.
pub const SECTORS: usize = 64;

/// Binary angle of a sector, as a power of two.
const SECTOR_BITS: u32 = 26;

/// The map's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapParams {
    /// How far it looks, from the outline's front.
    pub look: Metres,
    /// Lateral margin that must stay free.
    pub hard: Metres,
    /// Lateral margin that should stay free.
    pub soft: Metres,
    /// Margin that turning in place must keep.
    pub turning: Metres,
}

/// Free travel in a sector, from the outline's front.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Free {
    /// With the hard margin; 0 where it is less than the least that is of use.
    pub hard: Steps,
    /// With the soft margin: not more.
    pub soft: Steps,
}

/// The map, body frame.
#[derive(Clone, Debug)]
pub struct PolarMap {
    hard: [i16; SECTORS],
    soft: [i16; SECTORS],
    /// The sectors worked out, 32 to a word.
    known: [u32; SECTORS / 32],
    widths: Widths,
    /// How far the robot can turn in place to the left and to the right, up to half a turn.
    pub left: Angle,
    /// To the right; positive.
    pub right: Angle,
}

/// The middles of the sectors.
static MIDDLES: [Bearing; SECTORS] = middles();

/// A sector's angle.
pub(super) fn middle(sector: usize) -> Angle {
    Angle::from_bits(((sector & 63) as i32).wrapping_shl(SECTOR_BITS))
}

impl Default for PolarMap {
    fn default() -> Self {
        Self::new()
    }
}

impl PolarMap {
    /// Nothing free.
    pub const fn new() -> Self {
        Self {
            hard: [0; SECTORS],
            soft: [0; SECTORS],
            known: [0; SECTORS / 32],
            widths: Widths::NONE,
            left: Angle::ZERO,
            right: Angle::ZERO,
        }
    }

    /// Free travel in a sector among the points that the map was [drawn](Self::draw) for.
    pub fn free(&mut self, near: &Near, sector: usize) -> Free {
        let slot = sector & (SECTORS - 1);
        let (word, bit) = (slot >> 5, 1u32.wrapping_shl(slot as u32));
        if self.known[word] & bit == 0 {
            self.known[word] |= bit;
            (self.hard[slot], self.soft[slot]) = self.widths.look(near, MIDDLES[slot]);
        }
        let [hard, soft] = [self.hard[slot], self.soft[slot]];
        Free {
            hard: Steps::from_bits(hard.into()),
            soft: Steps::from_bits(soft.into()),
        }
    }

    /// Sectors worked out so far.
    pub(super) fn looked(&self) -> u32 {
        let [lower, upper] = self.known.map(u32::count_ones);
        lower.wrapping_add(upper)
    }

    pub(super) fn digest(&self, digest: &mut Digest) {
        let known = |slot: usize| self.known[slot >> 5 & 1].wrapping_shr(slot as u32) & 1 == 1;
        for (slot, (hard, soft)) in self.hard.iter().zip(&self.soft).enumerate() {
            if known(slot) {
                digest.pair(*hard, *soft);
            }
        }
        digest.word(self.left.bits().cast_unsigned());
        digest.word(self.right.bits().cast_unsigned());
    }

    /// Whether the robot can turn in place by an angle.
    pub fn can_turn(&self, angle: Angle) -> bool {
        let room = if angle.is_left() {
            self.left
        } else {
            self.right
        };
        angle.abs().bits() <= room.bits()
    }

    /// Begins a new map. Free travel below `least` is not worked out.
    pub fn draw(&mut self, params: &MapParams, near: &Near, outline: &Outline, least: Steps) {
        self.known = [0; SECTORS / 32];
        self.widths = Widths {
            look: Steps::of(params.look).bits() as i16,
            least,
            front: outline.front,
            graze: outline.half_width - const { Steps::lit("0.02") },
            hard: outline.half_width + Steps::of(params.hard),
            soft: outline.half_width + Steps::of(params.soft.max(params.hard)),
        };
        let margin = Steps::of(params.turning);
        self.left = room(near, outline, margin, true);
        self.right = room(near, outline, margin, false);
    }
}

/// How a sector is looked along.
#[derive(Clone, Copy, Debug)]
struct Widths {
    look: i16,
    least: Steps,
    front: Steps,
    /// Flanks that touch no more than this slide along.
    graze: Steps,
    hard: Steps,
    soft: Steps,
}

impl Widths {
    const NONE: Self = Self {
        look: 0,
        least: Steps::ZERO,
        front: Steps::ZERO,
        graze: Steps::ZERO,
        hard: Steps::ZERO,
        soft: Steps::ZERO,
    };

    /// Free travel with the hard and with the soft margin in a direction.
    fn look(&self, near: &Near, direction: Bearing) -> (i16, i16) {
        /// A point this far behind the front line is beside the robot, no more before it.
        const PASSED: Steps = Steps::lit("-0.12");
        let (mut hard, mut soft) = (self.look, self.look);
        let [cos, sin] = direction.bits().map(i32::from);
        // What is behind or too far ahead to matter goes by one product sum and one comparison. 14 more fractional bits.
        let reach = |hard: i16| {
            let reach = self.front.bits().wrapping_add(hard.into());
            reach.wrapping_shl(14).cast_unsigned()
        };
        let mut most = reach(hard);
        for spot in near.spots() {
            let (x, y) = (spot.at().x.bits(), spot.at().y.bits());
            let along = x.wrapping_mul(cos).wrapping_add(y.wrapping_mul(sin));
            if along.cast_unsigned() >= most {
                continue;
            }
            let beside = y.wrapping_mul(cos).wrapping_sub(x.wrapping_mul(sin)) >> 14;
            let beside = Steps::from_bits(beside.wrapping_abs());
            if beside >= self.soft {
                continue;
            }
            let ahead = Steps::from_bits(along >> 14) - self.front;
            let narrow = beside < self.hard;
            if narrow {
                let stands_before = ahead > Steps::ZERO && ahead < self.least;
                let grazes = beside <= self.graze || ahead == Steps::ZERO;
                if stands_before || (ahead <= Steps::ZERO && ahead > PASSED && grazes) {
                    return (0, 0);
                }
            }
            if ahead > Steps::ZERO {
                // Less than the look range.
                let free = ahead.bits() as i16;
                soft = soft.min(free);
                if narrow {
                    hard = hard.min(free);
                    most = reach(hard);
                }
            }
        }
        (hard, soft)
    }
}

/// How far the robot can turn in place to one side: until a point comes closer than `margin` while it comes closer still.
/// In half sectors, half a turn at most.
fn room(near: &Near, outline: &Outline, margin: Steps, left: bool) -> Angle {
    /// Half sectors in half a turn.
    const HALF_TURN: i32 = 64;
    let reach = (outline.reach + margin).squared();
    // What the farthest point moves in a half sector: 0.0491 of its distance.
    let pace = (outline.reach.bits().wrapping_mul(805) >> 14).wrapping_add(2);
    let mut free = HALF_TURN;
    let close = |spot: &&Spot| spot.at().norm_squared() < reach;
    for spot in near.spots().iter().filter(close) {
        let mut before = spot.clearance();
        let skipped = |clearance: Steps| {
            (clearance - margin)
                .bits()
                .max(0)
                .checked_div(pace)
                .unwrap_or(0)
        };
        let mut step = skipped(before).wrapping_add(1);
        while step <= free {
            let angle = Angle::from_bits(step.wrapping_shl(SECTOR_BITS - 1));
            let turn = Bearing::of(if left { angle } else { -angle });
            let here = outline.clearance_at_least(spot.at().in_frame(turn));
            if here < margin && here < before {
                free = step.wrapping_sub(1);
                break;
            }
            before = here;
            step = step.wrapping_add(1).wrapping_add(skipped(here));
        }
    }
    if free >= HALF_TURN {
        return Angle::from_bits(i32::MAX);
    }
    Angle::from_bits(free.wrapping_shl(SECTOR_BITS - 1))
}

/// Cosines and sines of the sectors, by turning again and again by 1/64 of a turn.
const fn middles() -> [Bearing; SECTORS] {
    // cos and sin of 2π/64, 30 fractional bits.
    const COS: i64 = 1_068_571_464;
    const SIN: i64 = 105_245_103;
    let mut table = [Bearing::AHEAD; SECTORS];
    let (mut cos, mut sin) = (1i64 << 30, 0i64);
    let mut i = 0;
    while i < SECTORS {
        table[i] = Bearing::from_bits(
            ((cos + (1 << 15)) >> 16) as i16,
            ((sin + (1 << 15)) >> 16) as i16,
        );
        (cos, sin) = (
            (cos * COS - sin * SIN + (1 << 29)) >> 30,
            (sin * COS + cos * SIN + (1 << 29)) >> 30,
        );
        i += 1;
    }
    table
}
