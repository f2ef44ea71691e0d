//! The piece of a path that the robot is on, with all that does not change while it is there worked out once: then a tick
//! needs no division and no root to find its place on it.

use super::path::{Piece, Segment, tangent};
use crate::geometry::{Point, Pose, Rotation, square};
use crate::integer::{Reciprocal, saturate};
use crate::units::{Angle, Metres, PerMetre};

/// 2^32 / 2π: arc length by radius, as a binary angle.
const TURN: u32 = 683_565_276;

/// A piece, ready to be driven along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Local {
    pub(crate) length: Metres,
    pub(crate) curvature: PerMetre,
    form: Form,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Line {
        start: Pose,
        forward: Rotation,
    },
    Arc {
        centre: Point,
        radius: Metres,
        from: Angle,
        left: bool,
        /// Binary angle a metre.
        turn: Reciprocal,
    },
    Chord {
        from: Pose,
        /// Along the chord.
        forward: Rotation,
        /// How far the tangent turns from end to end.
        turn: Angle,
        /// Share of the chord, 30 fractional bits, a metre.
        share: Reciprocal,
    },
}

impl Local {
    pub(crate) fn new(piece: &Piece) -> Self {
        match *piece {
            Piece::Segment(segment) => Self::of_segment(&segment),
            Piece::Chord { from, to } => {
                let chord = to.at - from.at;
                let length = chord.norm();
                let share = Reciprocal::new(1 << 30, length.bits().unsigned_abs());
                let part = |x: i32| saturate(share.times(x));
                let turn = to.heading - from.heading;
                // Radians with 16 fractional bits by metres with 16: per metre, 16 of them.
                let curvature = share.times(turn.radians().to_bits()) >> 14;
                Self {
                    length,
                    curvature: PerMetre::from_bits(saturate(curvature)),
                    form: Form::Chord {
                        from,
                        forward: Rotation::from_bits(part(chord.x.bits()), part(chord.y.bits())),
                        turn,
                        share,
                    },
                }
            }
        }
    }

    fn of_segment(segment: &Segment) -> Self {
        let form = match *segment {
            Segment::Line { start, .. } => Form::Line {
                start,
                forward: start.heading.rotation(),
            },
            Segment::Arc {
                centre,
                radius,
                from,
                sweep,
            } => Form::Arc {
                centre,
                radius,
                from,
                left: sweep >= 0,
                turn: Reciprocal::new(TURN, radius.bits().unsigned_abs()),
            },
        };
        Self {
            length: segment.length(),
            curvature: segment.curvature(),
            form,
        }
    }

    /// Path length from the piece's start to the place on its line or circle that is nearest to `place`; below zero
    /// before the start, above the length behind the end. On a circle the solution within half a turn of `hint` is
    /// meant, and nearer to the centre than a quarter of the radius it is `hint` itself.
    pub(crate) fn project(&self, place: Point, hint: Metres) -> Metres {
        match self.form {
            Form::Line { start, forward } => forward.along(place - start.at),
            Form::Chord { from, forward, .. } => forward.along(place - from.at),
            Form::Arc {
                centre,
                radius,
                from,
                left,
                turn,
            } => {
                let offset = place - centre;
                // Near the centre the nearest place says nothing and turns about with every step: stay.
                if offset.norm_squared() < square(radius) >> 4 {
                    return hint;
                }
                let out = offset.direction();
                let swept = if left { out - from } else { from - out };
                let ahead = swept - Angle::from_bits(turn.times(hint.bits()) as i32);
                hint + along_arc(radius, i64::from(ahead.bits()))
            }
        }
    }

    /// Place and tangent at `along`, which is on the piece, with the rotation into the tangent's direction.
    pub(crate) fn frame(&self, along: Metres) -> (Pose, Rotation) {
        match self.form {
            Form::Line { start, forward } => {
                let at = start.at + forward.ahead(along);
                (Pose::new(at, start.heading), forward)
            }
            Form::Arc {
                centre,
                radius,
                from,
                left,
                turn,
            } => {
                let swept = Angle::from_bits(turn.times(along.bits()) as i32);
                let out = if left { from + swept } else { from - swept };
                let outward = out.rotation();
                let forward = if left {
                    outward.left()
                } else {
                    outward.right()
                };
                let at = centre + outward.ahead(radius);
                (Pose::new(at, tangent(out, left)), forward)
            }
            Form::Chord {
                from,
                forward,
                turn,
                share,
            } => {
                let along = along.max(Metres::ZERO).min(self.length);
                // The arc through both points bulges from the chord by κ·along·(length − along)/2, to its right when
                // it turns left.
                let rest = i64::from((self.length - along).bits());
                let bulge = i64::from(along.bits()).wrapping_mul(rest) >> 16;
                let bulge = bulge.saturating_mul(i64::from(self.curvature.bits())) >> 17;
                let aside = Metres::from_bits(saturate(bulge.wrapping_neg()));
                let place = from.at + forward.forth(Point::new(along, aside));
                // At most one, 2^30.
                let share = share.times(along.bits());
                let turned = i64::from(turn.bits()).wrapping_mul(share) >> 30;
                let heading = from.heading + Angle::from_bits(turned as i32);
                (Pose::new(place, heading), heading.rotation())
            }
        }
    }
}

/// Arc length of `turns` (32 fractional bits, at most one turn either way) at `radius`.
pub(super) fn along_arc(radius: Metres, turns: i64) -> Metres {
    // 2π with 20 fractional bits. The products stay below 2^62 for every radius.
    const TURN: i64 = 6_588_397;
    let turn_metres = ((turns >> 2).wrapping_mul(i64::from(radius.bits()))) >> 22;
    Metres::from_bits(saturate(turn_metres.wrapping_mul(TURN) >> 28))
}
