//! Places along the path ahead of the cursor.

use super::cursor::LOOK;
use super::local::Local;
use super::path::{Path, next};
use crate::geometry::Pose;
use crate::units::Metres;

/// Places evenly spaced along the path ahead, the first one at the cursor; the last is an open path's end. It ends there,
/// or after [`LOOK`] pieces.
#[derive(Clone, Debug)]
pub struct Ahead<'a> {
    path: Path<'a>,
    /// The piece at hand, while there is one.
    piece: Option<(usize, Local)>,
    /// The next place on it.
    along: Metres,
    spacing: Metres,
    left: usize,
}

impl<'a> Ahead<'a> {
    pub(super) fn new(path: &Path<'a>, piece: usize, along: Metres, spacing: Metres) -> Self {
        Self {
            path: *path,
            piece: Some((piece, Local::new(&path.piece(piece)))),
            along,
            spacing: spacing.max(const { Metres::lit("0.01") }),
            left: LOOK,
        }
    }
}

impl Iterator for Ahead<'_> {
    type Item = Pose;

    fn next(&mut self) -> Option<Pose> {
        for _ in 0..LOOK {
            let (index, local) = self.piece.as_ref()?;
            if self.along <= local.length {
                let (pose, _) = local.frame(self.along);
                self.along = self.along + self.spacing;
                return Some(pose);
            }
            let Some(next) = next(&self.path, *index) else {
                let (end, _) = local.frame(local.length);
                self.piece = None;
                return Some(end);
            };
            self.left = self.left.saturating_sub(1);
            if self.left == 0 {
                self.piece = None;
                return None;
            }
            self.along = self.along - local.length;
            self.piece = Some((next, Local::new(&self.path.piece(next))));
        }
        None
    }
}
