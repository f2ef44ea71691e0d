//! One number for what a navigator knows, so that two of them can be compared deeper than by what they command.

use super::Navigator;
use crate::geometry::Point;

/// A checksum of words in their order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Digest(u32);

impl Digest {
    pub fn word(&mut self, word: u32) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(0x9E37_79B9);
    }

    /// Two halves in a word.
    pub fn pair(&mut self, upper: i16, lower: i16) {
        self.word(u32::from(upper.cast_unsigned()) << 16 | u32::from(lower.cast_unsigned()));
    }

    pub fn point(&mut self, point: Point) {
        self.word(point.x.bits().cast_unsigned());
        self.word(point.y.bits().cast_unsigned());
    }
}

impl<const N: usize> Navigator<N> {
    /// A checksum of the memory's points, the points near the robot, the polar map, the guide field and the last commands:
    /// the same on every architecture. No part of a tick.
    pub fn digest(&self) -> u32 {
        let mut digest = Digest::default();
        self.memory.digest(&mut digest);
        self.near.digest(&mut digest);
        self.map.digest(&mut digest);
        self.field.digest(&mut digest);
        for twist in [self.last, self.before] {
            digest.word(twist.linear.bits().cast_unsigned());
            digest.word(twist.angular.bits().cast_unsigned());
        }
        digest.word(self.chosen.bits().cast_unsigned());
        digest.0
    }
}
