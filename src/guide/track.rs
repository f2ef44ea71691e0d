//! Going along a path in even steps, from place to place and from tick to tick.

use super::cursor::LOOK;
use super::local::Local;
use super::path::{Path, next};
use crate::geometry::Pose;
use crate::units::Metres;

/// A place on a path, to go on from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Track {
    piece: usize,
    along: Metres,
}

/// A place that a [`Track`] came by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Place and tangent.
    pub at: Pose,
    /// An open path's end: nothing comes after it.
    pub is_end: bool,
}

impl Track {
    pub(super) const fn new(piece: usize, along: Metres) -> Self {
        Self { piece, along }
    }

    /// The place where it is, and `spacing` on, 0.01 m at least. None where [`LOOK`] pieces were not enough to come there:
    /// it is on its way then, and the next call goes on.
    pub fn step(&mut self, path: &Path<'_>, spacing: Metres) -> Option<Mark> {
        for _ in 0..LOOK {
            let local = Local::new(&path.piece(self.piece));
            if self.along <= local.length {
                let (at, _) = local.frame(self.along);
                self.along = self.along + spacing.max(const { Metres::lit("0.01") });
                return Some(Mark { at, is_end: false });
            }
            let Some(next) = next(path, self.piece) else {
                let (at, _) = local.frame(local.length);
                return Some(Mark { at, is_end: true });
            };
            self.along = self.along - local.length;
            self.piece = next;
        }
        None
    }
}
