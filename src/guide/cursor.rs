//! The cursor: how far along the path the robot is. It moves forward only, and looks at no more than [`LOOK`] pieces
//! in one tick, so a path that crosses itself or comes back past itself cannot confuse it.

use super::local::Local;
use super::path::{Path, next};
use super::preview::{Allowed, Preview};
use super::track::Track;
use crate::geometry::{Point, Pose, square};
use crate::units::{Metres, MetresPerSecond, PerMetre};
use fixed::types::I16F16;

/// The most pieces that one tick looks at. Points closer than a thirty-second of what the robot drives in a tick
/// leave the cursor behind; space them wider.
pub const LOOK: usize = 32;

/// Progress along a path, and what was seen of it ahead. A new path needs a new cursor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cursor {
    piece: usize,
    along: Metres,
    /// Path length before the current piece, this lap.
    base: Metres,
    /// The same since the start, wrapping.
    driven: i32,
    laps: u16,
    /// The current piece, once it was looked at.
    local: Option<Local>,
    preview: Preview,
}

impl Default for Cursor {
    fn default() -> Self {
        Self::new()
    }
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
            driven: 0,
            laps: 0,
            local: None,
            preview: Preview::new(),
        }
    }

    /// Whether it still stands at the start of the path.
    pub fn is_at_start(&self) -> bool {
        self.piece == 0 && self.along == Metres::ZERO && self.laps == 0
    }

    /// Moves on by `way` metres, whatever lies between: for a robot that has left the path and meets it again farther on.
    /// At an open path's end, or after [`LOOK`] pieces, it stays.
    pub fn skip(&mut self, path: &Path<'_>, way: Metres) {
        let mut along = self.along + way.max(Metres::ZERO);
        for _ in 0..LOOK {
            let local = Local::new(&path.piece(self.piece));
            let Some(next) = next(path, self.piece).filter(|_| along >= local.length) else {
                self.along = along.min(local.length);
                break;
            };
            along = along - local.length;
            self.enter(path, next, local.length);
        }
    }

    /// Begins a piece, after one of this length.
    fn enter(&mut self, path: &Path<'_>, piece: usize, length: Metres) {
        self.along = Metres::ZERO;
        self.base = self.base + length;
        self.driven = self.driven.wrapping_add(length.bits());
        if piece == 0 {
            self.base = Metres::ZERO;
            self.laps = self.laps.saturating_add(1);
        }
        self.piece = piece;
        self.preview.reached(piece, self.driven);
        self.local = Some(Local::new(&path.piece(piece)));
    }

    /// Moves on to the place of the path nearest to `place`, at most `reach` metres ahead and never back.
    pub fn advance(&mut self, path: &Path<'_>, place: Point, reach: Metres) -> Fix {
        let mut budget = reach.max(Metres::ZERO);
        let first = || Local::new(&path.piece(self.piece));
        let local = self.local.get_or_insert_with(first);
        for _ in 0..LOOK {
            let length = local.length;
            let nearest = local.project(place, self.along);
            let along = nearest.min(self.along + budget).max(self.along);
            let next = next(path, self.piece).filter(|_| along >= length);
            let Some(next) = next else {
                self.along = along.min(length);
                break;
            };
            budget = budget - (length - self.along);
            self.along = Metres::ZERO;
            self.base = self.base + length;
            self.driven = self.driven.wrapping_add(length.bits());
            if next == 0 {
                self.base = Metres::ZERO;
                self.laps = self.laps.saturating_add(1);
            }
            self.piece = next;
            self.preview.reached(next, self.driven);
            *local = Local::new(&path.piece(next));
        }
        let (foot, forward) = local.frame(self.along);
        let Point {
            x: ahead,
            y: cross_track,
        } = forward.back(place - foot.at);
        let progress = self.base + self.along;
        Fix {
            foot,
            cross_track,
            distance: length(ahead, cross_track),
            progress,
            remaining: if path.is_closed() {
                Metres::MAX
            } else {
                path.length() - progress
            },
            laps: self.laps,
        }
    }

    /// Its place, to go on along the path from.
    pub fn track(&self) -> Track {
        Track::new(self.piece, self.along)
    }

    /// Way along the path since the start, metres with 16 fractional bits; wraps.
    pub fn driven(&self) -> i32 {
        self.driven.wrapping_add(self.along.bits())
    }

    /// The piece that it is on, and where that ends, as [`Cursor::driven`] counts.
    pub(super) fn piece_end(&self, path: &Path<'_>) -> (usize, i32) {
        let length = match &self.local {
            Some(local) => local.length,
            None => path.piece(self.piece).length(),
        };
        (self.piece, self.driven.wrapping_add(length.bits()))
    }

    /// Curvature `lead` metres ahead of the cursor.
    pub fn curvature_ahead(&self, path: &Path<'_>, lead: Metres) -> PerMetre {
        let mut left = self.along + lead.max(Metres::ZERO);
        if let Some(local) = &self.local
            && left <= local.length
        {
            return local.curvature;
        }
        let mut index = self.piece;
        for _ in 0..LOOK {
            let piece = path.piece(index);
            let length = piece.length();
            let Some(next) = next(path, index).filter(|_| left > length) else {
                return piece.curvature();
            };
            left = left - length;
            index = next;
        }
        path.piece(index).curvature()
    }

    /// Square of the speed that the path ahead allows, m²/s² with 32 fractional bits: what braking at `braking` m/s²
    /// still brings down to √(`lateral`/κ) in every bend, to `corner` at every corner of more than 15° and to rest at
    /// an open end. Looks as far as braking from `top` needs. In one tick a few pieces are looked at anew; where that is
    /// not as far as it needs, the rest may be an end, too.
    pub fn speed_limit_squared(
        &mut self,
        path: &Path<'_>,
        top: MetresPerSecond,
        braking: I16F16,
        lateral: I16F16,
        corner: Metres,
    ) -> u64 {
        let here = self.driven();
        let allowed = Allowed {
            top,
            braking,
            lateral,
            corner,
        };
        self.preview.limit_squared(path, here, &allowed)
    }
}

/// Length of the vector from the foot. There it is at a right angle to the path, except at an end: nearly always it is
/// |beside|, and no root is needed.
fn length(ahead: Metres, beside: Metres) -> Metres {
    // √(a² + b²) is less than a²/2b more than b.
    if square(ahead) <= u64::from(beside.bits().unsigned_abs()) << 1 {
        beside.abs()
    } else {
        Point::new(ahead, beside).norm()
    }
}
