//! Polar feasibility map: how far the footprint can drive in each of 64 directions after turning in place into it, and how
//! far it can turn.
//!
//! 64 sectors, because a binary angle's upper six bits are then the sector. *Hard* is the free travel of the footprint
//! with a small margin: no heading below a least hard travel is admissible. *Soft* is that with a comfortable margin: it
//! costs.
//!
//! Cost: a point touches only the sectors in whose corridor it lies, found outward from its own direction.

use super::digest::Digest;
use super::footprint::Outline;
use super::near::{Near, Spot};
use super::steps::{Bearing, Steps, Vector};
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

/// The map, body frame.
#[derive(Clone, Debug)]
pub struct PolarMap {
    hard: [i16; SECTORS],
    soft: [i16; SECTORS],
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
            left: Angle::ZERO,
            right: Angle::ZERO,
        }
    }

    /// Free travel with the hard margin in a sector, from the outline's front.
    pub fn hard(&self, sector: usize) -> Steps {
        Steps::from_bits(self.hard.get(sector & 63).copied().unwrap_or(0).into())
    }

    /// Free travel with the soft margin in a sector, not more than the hard one.
    pub fn soft(&self, sector: usize) -> Steps {
        Steps::from_bits(self.soft.get(sector & 63).copied().unwrap_or(0).into())
    }

    pub(super) fn digest(&self, digest: &mut Digest) {
        for (hard, soft) in self.hard.iter().zip(&self.soft) {
            digest.pair(*hard, *soft);
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

    /// Draws the map anew.
    pub fn draw(&mut self, params: &MapParams, near: &Near, outline: &Outline) {
        let look = Steps::of(params.look).bits() as i16;
        self.hard = [look; SECTORS];
        self.soft = [look; SECTORS];
        let widths = Widths {
            front: outline.front,
            graze: outline.half_width - const { Steps::lit("0.02") },
            hard: outline.half_width + Steps::of(params.hard),
            soft: outline.half_width + Steps::of(params.soft.max(params.hard)),
        };
        for spot in near.spots() {
            let own = spot.at().half_sector().wrapping_add(1) >> 1;
            self.mark(own as usize, spot.at(), &widths);
        }
        let margin = Steps::of(params.turning);
        self.left = room(near, outline, margin, true);
        self.right = room(near, outline, margin, false);
    }

    /// Enters a point into the sectors in whose corridors it lies, from its own outward: to the left, then to the right.
    fn mark(&mut self, own: usize, at: Vector, widths: &Widths) {
        /// A point this far behind the front line is beside the robot, no more before it.
        const PASSED: Steps = Steps::lit("-0.12");
        /// A quarter turn and the own sector's other half to either side are enough.
        const FARTHEST: usize = 16;
        let mut sector = own;
        let mut step = 1usize;
        let mut last = own.wrapping_add(FARTHEST);
        loop {
            let place = at.in_frame(MIDDLES[sector & (SECTORS - 1)]);
            let beside = place.y.abs();
            if place.x < Steps::ZERO || beside >= widths.soft || sector == last {
                if step != 1 {
                    break;
                }
                step = usize::MAX;
                sector = own.wrapping_sub(1);
                last = own.wrapping_sub(FARTHEST + 1);
                continue;
            }
            let slot = sector & (SECTORS - 1);
            sector = sector.wrapping_add(step);
            let ahead = place.x - widths.front;
            if ahead > Steps::ZERO {
                let free = ahead.bits() as i16;
                if free < self.soft[slot] {
                    self.soft[slot] = free;
                }
                if beside < widths.hard && free < self.hard[slot] {
                    self.hard[slot] = free;
                }
            } else if ahead > PASSED
                && (beside <= widths.graze || ahead == Steps::ZERO)
                && beside < widths.hard
            {
                self.soft[slot] = 0;
                self.hard[slot] = 0;
            }
        }
    }
}

struct Widths {
    front: Steps,
    /// Flanks that touch no more than this slide along.
    graze: Steps,
    hard: Steps,
    soft: Steps,
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
            let here = outline.clearance(spot.at().in_frame(turn));
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
