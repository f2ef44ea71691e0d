//! Places of a path, evenly spaced along it and kept from tick to tick: as the robot goes on, those behind it are dropped and
//! a few beyond the last are worked out.

use super::steps::retain;
use crate::geometry::Point;
use crate::guide::{Cursor, Path, Track};
use crate::units::Metres;
use heapless::Vec;

/// Their distance along the path.
pub(super) const SPACING: Metres = Metres::lit("0.25");

/// The most places.
pub(super) const PLACES: usize = 16;

/// The most that are worked out in a tick.
const NEW: usize = 2;

/// The places ahead of a cursor.
#[derive(Clone, Debug)]
pub(super) struct Places {
    at: Vec<Point, PLACES>,
    /// Where the first one is, as [`Cursor::driven`] counts.
    first: i32,
    /// Behind the last one; none at the path's end.
    track: Option<Track>,
}

impl Places {
    pub const fn new() -> Self {
        Self {
            at: Vec::new(),
            first: 0,
            track: None,
        }
    }

    /// Forgets them all: the path is another.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// Takes over where the cursor is and looks `reach` farther: to the first place beyond that.
    pub fn follow(&mut self, path: &Path<'_>, cursor: &Cursor, reach: Metres) {
        let here = cursor.driven();
        // An open path's end stays.
        let stays = usize::from(self.track.is_none());
        let mut left = self.at.len();
        retain(&mut self.at, |_| {
            let passed = self.first.wrapping_sub(here) < 0 && left > stays;
            left = left.wrapping_sub(1);
            if passed {
                self.first = self.first.wrapping_add(SPACING.bits());
            }
            !passed
        });
        if self.at.is_empty() {
            self.first = here;
            self.track = Some(cursor.track());
        }
        for _ in 0..NEW {
            let known = SPACING.bits().wrapping_mul(self.at.len() as i32);
            let last = self.first.wrapping_sub(here).wrapping_add(known);
            let Some(track) = self
                .track
                .as_mut()
                .filter(|_| last <= reach.bits().saturating_add(SPACING.bits()))
            else {
                break;
            };
            if self.at.is_full() {
                break;
            }
            // None: pieces are so short that the next tick has to go on.
            let Some(mark) = track.step(path, SPACING) else {
                break;
            };
            // There is room.
            let _ = self.at.push(mark.at.at);
            if mark.is_end {
                self.track = None;
            }
        }
    }

    pub fn as_slice(&self) -> &[Point] {
        &self.at
    }

    /// Way along the path from the cursor to the first one; below zero at an open path's end.
    pub fn way(&self, cursor: &Cursor) -> Metres {
        Metres::from_bits(self.first.wrapping_sub(cursor.driven()))
    }
}

#[cfg(test)]
mod tests {
    use super::{PLACES, Places, SPACING};
    use crate::geometry::{Point, Pose};
    use crate::guide::{Cursor, Path, Segment};
    use crate::units::{Angle, Metres};

    #[test]
    fn places_stay_where_they_are_while_the_robot_goes_on() {
        // 6 m along x in pieces of 1, 2 and 3 m.
        let line = |x: &str, length: &str| {
            let at = Point::new(Metres::lit(x), Metres::ZERO);
            Segment::line(Pose::new(at, Angle::ZERO), Metres::lit(length))
        };
        let segments = [line("0", "1"), line("1", "2"), line("3", "3")];
        let path = Path::segments(&segments, false).unwrap();
        let mut cursor = Cursor::new();
        let mut places = Places::new();
        let reach = Metres::lit("1.5");
        let mut driven = Metres::ZERO;
        for tick in 0..140 {
            places.follow(&path, &cursor, reach);
            let first = places.way(&cursor);
            let list = places.as_slice();
            assert!(list.len() <= PLACES && !list.is_empty());
            for (index, place) in (0..).zip(list) {
                // From the start on every 0.25 m there is one, and one at the end.
                let off = (place.x.bits() + 8) % SPACING.bits();
                assert!(off < 16, "{tick}: {place:?}");
                let way = first.bits() + SPACING.bits() * index;
                let wanted = (driven.bits() + way).min(6 << 16);
                assert!((place.x.bits() - wanted).abs() < 16, "{tick}: {place:?}");
            }
            // None behind, but for the end; and as far as was asked for, once the first few ticks have filled it.
            let at_end = list.len() == 1 && list[0].x.bits() > (6 << 16) - 16;
            assert!(
                at_end || (0..SPACING.bits()).contains(&first.bits()),
                "{tick}: {first:?}"
            );
            if tick > 4 {
                let last = list[list.len() - 1].x - driven;
                let to_end = Metres::lit("6") - driven;
                assert!(
                    last.bits() >= reach.min(to_end).bits() - 16,
                    "{tick}: {last:?}"
                );
            }
            let on = Metres::lit("0.04");
            cursor.skip(&path, on);
            driven = (driven + on).min(Metres::lit("5.99"));
        }
    }

    #[test]
    fn a_jump_beyond_all_of_them_begins_anew() {
        let start = Pose::new(Point::default(), Angle::ZERO);
        let segments = [Segment::line(start, Metres::lit("20"))];
        let path = Path::segments(&segments, false).unwrap();
        let mut cursor = Cursor::new();
        let mut places = Places::new();
        places.follow(&path, &cursor, Metres::lit("1"));
        cursor.skip(&path, Metres::lit("9.1"));
        places.follow(&path, &cursor, Metres::lit("1"));
        assert_eq!(places.way(&cursor), Metres::ZERO);
        assert!((places.as_slice()[0].x - Metres::lit("9.1")).abs().bits() < 16);
    }
}
