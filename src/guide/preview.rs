//! How fast the path ahead may be driven: bends, corners and the end are looked at once, as they come into braking
//! distance, and kept while they still bind.

use super::path::{Path, next};
use crate::geometry::square;
use crate::units::{Angle, Metres, MetresPerSecond};
use fixed::types::I16F16;

/// The most pieces that one tick looks at anew.
const STRIDE: usize = 4;

/// The most bounds kept; a power of two. When there are more, nothing further is looked at until one is passed.
const WINDOW: usize = 8;

/// A jump of the tangent by more than this is a corner.
pub(super) const CORNER: Angle = Angle::deg("15");

/// What the path allows: settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowed {
    /// The speed from which braking is looked ahead for.
    pub(crate) top: MetresPerSecond,
    /// Braking, m/s².
    pub(crate) braking: I16F16,
    /// Lateral acceleration in bends, m/s².
    pub(crate) lateral: I16F16,
    /// At corners, m/s.
    pub(crate) corner: Metres,
}

/// A bound on the speed along a stretch: squared, m²/s² with 32 fractional bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Bound {
    /// Where it begins, and where it is behind: path lengths driven since the start, wrapping.
    from: i32,
    until: i32,
    squared: u64,
}

/// The bounds ahead. Each one binds somewhere before it begins: one that another farther on makes superfluous is gone.
/// So of all that begin ahead of the robot the first binds here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Preview {
    bounds: [Bound; WINDOW],
    first: u8,
    count: u8,
    /// The next piece to look at.
    piece: usize,
    /// Where it begins, path length driven since the start, wrapping.
    horizon: i32,
    /// Tangent there, once a piece was looked at.
    heading: Option<Angle>,
    /// There is no piece any more.
    ended: bool,
}

impl Preview {
    pub(crate) const fn new() -> Self {
        Self {
            bounds: [Bound {
                from: 0,
                until: 0,
                squared: 0,
            }; WINDOW],
            first: 0,
            count: 0,
            piece: 0,
            horizon: 0,
            heading: None,
            ended: false,
        }
    }

    /// The cursor went on to `piece`, which begins at `start`: what was not looked at before it never will be.
    pub(crate) fn reached(&mut self, piece: usize, start: i32) {
        if !self.ended && start.wrapping_sub(self.horizon) > 0 {
            (self.piece, self.horizon, self.heading) = (piece, start, None);
        }
    }

    /// Square of the speed allowed at `here`, m²/s² with 32 fractional bits: what braking still brings down to the
    /// bound of every bend and corner, and to rest at an open end. What has not been looked at yet may be an end, too.
    pub(crate) fn limit_squared(&mut self, path: &Path<'_>, here: i32, allowed: &Allowed) -> u64 {
        while let Some(bound) = self.get(0)
            && bound.until.wrapping_sub(here) <= 0
        {
            self.first = self.first.wrapping_add(1);
            self.count = self.count.wrapping_sub(1);
        }
        let top = square(Metres::from_bits(allowed.top.bits()));
        let mut blind = allowed.brake(0, self.horizon, here);
        for _ in 0..STRIDE {
            // A piece brings three bounds at most: a corner, a bend, the end.
            if self.ended || blind > top || usize::from(self.count) > WINDOW - 3 {
                break;
            }
            self.look(path, allowed);
            blind = allowed.brake(0, self.horizon, here);
        }
        let mut limit = if self.ended || blind > top {
            u64::MAX
        } else {
            blind
        };
        // The first may be the bend that the robot is in, which does not ease with the distance; the second is ahead.
        for index in 0..2 {
            let Some(bound) = self.get(index) else { break };
            limit = limit.min(allowed.brake(bound.squared, bound.from, here));
        }
        limit
    }

    /// Looks at one more piece.
    fn look(&mut self, path: &Path<'_>, allowed: &Allowed) {
        let piece = path.piece(self.piece);
        let length = piece.length();
        if let Some(before) = self.heading {
            let jump = piece.start_heading() - before;
            if jump.abs().bits() > CORNER.bits() {
                self.push(self.horizon, self.horizon, square(allowed.corner), allowed);
            }
        }
        let end = self.horizon.wrapping_add(length.bits());
        let bend = piece.bend_speed_squared(length, allowed.lateral);
        if bend < u64::MAX {
            self.push(self.horizon, end, bend, allowed);
        }
        self.horizon = end;
        self.heading = Some(piece.end_heading());
        match next(path, self.piece) {
            Some(next) => self.piece = next,
            None => {
                self.ended = true;
                // Never behind.
                self.push(end, end.wrapping_add(1), 0, allowed);
            }
        }
    }

    /// Adds a bound behind all others. One before it that does not bind any more goes.
    fn push(&mut self, from: i32, until: i32, squared: u64, allowed: &Allowed) {
        while let Some(last) = self.count.checked_sub(1).and_then(|last| self.get(last))
            && last.squared >= allowed.brake(squared, from, last.from)
        {
            self.count = self.count.wrapping_sub(1);
        }
        let place = usize::from(self.first.wrapping_add(self.count)) % WINDOW;
        if let Some(bound) = self.bounds.get_mut(place) {
            *bound = Bound {
                from,
                until,
                squared,
            };
            self.count = self.count.wrapping_add(1);
        }
    }

    fn get(&self, index: u8) -> Option<&Bound> {
        let place = usize::from(self.first.wrapping_add(index)) % WINDOW;
        self.bounds.get(place).filter(|_| index < self.count)
    }
}

impl Allowed {
    /// Square of the speed at `here` that braking brings down to `squared` at `there`, or that itself behind it.
    fn brake(&self, squared: u64, there: i32, here: i32) -> u64 {
        let distance = there.wrapping_sub(here).max(0).unsigned_abs();
        // 31 bits each: twice the product fits.
        let gain = u64::from(self.braking.to_bits().unsigned_abs()).wrapping_mul(distance.into());
        squared.saturating_add(gain << 1)
    }
}
