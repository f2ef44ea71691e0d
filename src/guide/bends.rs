//! The pieces of a path ahead of a cursor, each worked out once: where it begins, how it bends, and the corner before it.

use super::cursor::Cursor;
use super::local::Local;
use super::path::{Path, next};
use super::preview::CORNER;
use crate::units::{Angle, Metres, PerMetre};
use heapless::Vec;

/// The most pieces.
const AHEAD: usize = 12;

/// The most that are worked out in a tick.
const NEW: usize = 2;

/// A piece ahead.
#[derive(Clone, Copy, Debug)]
struct Bend {
    /// As [`Cursor::driven`] counts.
    begins: i32,
    /// Of the tangent, where it begins; left positive.
    jump: Angle,
    curvature: PerMetre,
}

/// The pieces ahead. Another path needs another.
#[derive(Clone, Debug)]
pub struct Bends {
    ahead: Vec<Bend, AHEAD>,
    /// The last piece known, and where it ends.
    last: usize,
    end: i32,
    begun: bool,
}

impl Default for Bends {
    fn default() -> Self {
        Self::new()
    }
}

impl Bends {
    /// None known yet.
    pub const fn new() -> Self {
        Self {
            ahead: Vec::new(),
            last: 0,
            end: 0,
            begun: false,
        }
    }

    /// Takes over where the cursor is, and works out pieces that begin within `reach` ahead of it: two a tick, twelve in all.
    pub fn follow(&mut self, path: &Path<'_>, cursor: &Cursor, reach: Metres) {
        let here = cursor.driven();
        let ahead = |place: i32| Metres::from_bits(place.wrapping_sub(here));
        while self
            .ahead
            .first()
            .is_some_and(|bend| ahead(bend.begins) <= Metres::ZERO)
        {
            // A dozen at most.
            let rest = self.ahead.get(1..).map(Vec::from_slice);
            self.ahead = rest.and_then(Result::ok).unwrap_or_default();
        }
        if !self.begun || ahead(self.end) < Metres::ZERO {
            self.begun = true;
            self.ahead.clear();
            (self.last, self.end) = cursor.piece_end(path);
        }
        for _ in 0..NEW {
            if ahead(self.end) > reach || self.ahead.is_full() {
                break;
            }
            let Some(next) = next(path, self.last) else {
                break;
            };
            let piece = path.piece(next);
            let local = Local::new(&piece);
            let bend = Bend {
                begins: self.end,
                jump: piece.start_heading() - path.piece(self.last).end_heading(),
                curvature: local.curvature,
            };
            // There is room. One that begins here is not ahead.
            if ahead(bend.begins) > Metres::ZERO {
                let _ = self.ahead.push(bend);
            }
            self.last = next;
            self.end = self.end.wrapping_add(local.length.bits());
        }
    }

    /// Way to the next corner that is known, a jump of the tangent by more than 15°, and the jump, left positive; none within
    /// `reach`.
    pub fn corner(&self, cursor: &Cursor, reach: Metres) -> Option<(Metres, Angle)> {
        self.ahead
            .iter()
            .map(|bend| {
                let way = bend.begins.wrapping_sub(cursor.driven());
                (Metres::from_bits(way), bend.jump)
            })
            .take_while(|(way, _)| *way <= reach)
            .find(|(_, jump)| jump.abs().bits() > CORNER.bits())
    }

    /// Curvature `lead` metres ahead of the cursor, as far as pieces are known.
    pub fn curvature(&self, path: &Path<'_>, cursor: &Cursor, lead: Metres) -> PerMetre {
        let begun = |bend: &&Bend| bend.begins.wrapping_sub(cursor.driven()) < lead.bits();
        match self.ahead.iter().take_while(begun).last() {
            Some(bend) => bend.curvature,
            None => cursor.curvature_ahead(path, Metres::ZERO),
        }
    }
}
