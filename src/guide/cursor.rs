//! The cursor: how far along the path the robot is. It moves forward only, and looks at no more than [`LOOK`] pieces
//! in one tick, so a path that crosses itself or comes back past itself cannot confuse it.

use super::path::Path;
use crate::geometry::{Point, Pose, square};
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre};
use fixed::types::I16F16;

/// The most pieces that one tick looks at. Points closer than a thirty-second of what the robot drives in a tick
/// leave the cursor behind; space them wider.
pub const LOOK: usize = 32;

/// A jump of the tangent by more than this is a corner.
const CORNER: Angle = Angle::deg("15");

/// Progress along a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cursor {
    piece: usize,
    along: Metres,
    /// Path length before the current piece, this lap.
    base: Metres,
    laps: u16,
}

/// Where the cursor stands after a move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fix {
    /// Nearest place and tangent within reach.
    pub foot: Pose,
    /// Signed cross-track error against that tangent, left positive.
    pub cross_track: Metres,
    /// Distance to the foot.
    pub distance: Metres,
    /// Path length up to the foot, this lap.
    pub progress: Metres,
    /// Path length left; the largest value on a closed path.
    pub remaining: Metres,
    /// Completed laps of a closed path.
    pub laps: u16,
}

impl Cursor {
    /// At the start of a path.
    pub const fn new() -> Self {
        Self {
            piece: 0,
            along: Metres::ZERO,
            base: Metres::ZERO,
            laps: 0,
        }
    }

    /// Moves on to the place of the path nearest to `place`, at most `reach` metres ahead and never back.
    pub fn advance(&mut self, path: &Path<'_>, place: Point, reach: Metres) -> Fix {
        let mut budget = reach.max(Metres::ZERO);
        for _ in 0..LOOK {
            let piece = path.piece(self.piece);
            let length = piece.length();
            let nearest = piece.project(place, self.along);
            let along = nearest.min(self.along + budget).max(self.along);
            let last = !path.is_closed() && self.piece.saturating_add(1) >= path.count();
            if along < length || last {
                self.along = along.min(length);
                break;
            }
            budget = budget - (length - self.along);
            self.along = Metres::ZERO;
            self.piece = self.piece.saturating_add(1);
            self.base = self.base + length;
            if self.piece >= path.count() {
                self.piece = 0;
                self.base = Metres::ZERO;
                self.laps = self.laps.saturating_add(1);
            }
        }
        let (foot, forward) = path.piece(self.piece).frame(self.along);
        let offset = place - foot.at;
        let progress = self.base + self.along;
        Fix {
            foot,
            cross_track: forward.back(offset).y,
            distance: offset.norm(),
            progress,
            remaining: if path.is_closed() {
                Metres::MAX
            } else {
                path.length() - progress
            },
            laps: self.laps,
        }
    }

    /// Curvature `lead` metres ahead of the cursor.
    pub fn curvature_ahead(&self, path: &Path<'_>, lead: Metres) -> PerMetre {
        let mut left = self.along + lead.max(Metres::ZERO);
        let mut index = self.piece;
        for _ in 0..LOOK {
            let piece = path.piece(index);
            let length = piece.length();
            let Some(next) = Self::next(path, index).filter(|_| left > length) else {
                return piece.curvature();
            };
            left = left - length;
            index = next;
        }
        path.piece(index).curvature()
    }

    /// Square of the speed that the path ahead allows, m²/s² with 32 fractional bits: what braking at `braking` m/s²
    /// still brings down to √(`lateral`/κ) in every bend, to `corner` at every corner of more than 15° and to rest at
    /// an open end. Looks as far as braking from `top` needs, over [`LOOK`] pieces at most.
    pub fn speed_limit_squared(
        &self,
        path: &Path<'_>,
        top: MetresPerSecond,
        braking: I16F16,
        lateral: I16F16,
        corner: Metres,
    ) -> u64 {
        let brake = |from: u64, distance: Metres| {
            let gain = u64::from(braking.to_bits().unsigned_abs())
                .saturating_mul(u64::from(distance.max(Metres::ZERO).bits().unsigned_abs()));
            from.saturating_add(gain.saturating_mul(2))
        };
        let mut limit = u64::MAX;
        let mut ahead = Metres::ZERO - self.along;
        let mut index = self.piece;
        for _ in 0..LOOK {
            let piece = path.piece(index);
            let length = piece.length();
            limit = limit.min(brake(piece.bend_speed_squared(length, lateral), ahead));
            ahead = ahead + length;
            let Some(next) = Self::next(path, index) else {
                return limit.min(brake(0, ahead));
            };
            let jump = path.piece(next).start_heading() - piece.end_heading();
            if jump.abs().bits() > CORNER.bits() {
                limit = limit.min(brake(square(corner), ahead));
            }
            if brake(0, ahead) > square(Metres::from_bits(top.bits())) {
                break;
            }
            index = next;
        }
        limit
    }

    fn next(path: &Path<'_>, index: usize) -> Option<usize> {
        let next = index.saturating_add(1);
        match next < path.count() {
            true => Some(next),
            false => path.is_closed().then_some(0),
        }
    }
}
