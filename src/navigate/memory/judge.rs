//! What a tick's echoes say of a remembered point.

use super::{Memory, MemoryParams, Record, SURE, UNIT};
use crate::integer::proper_fraction;
use crate::navigate::footprint::Outline;
use crate::navigate::sensors::{Echo, Echoes, Eyes, View};
use crate::navigate::steps::{Bearing, Steps, Vector};

/// Deeper than this inside the robot a point is wrong: there the robot stands.
const DEEP: Steps = Steps::lit("0.03");

/// What a range's noise may be.
const NOISE: Steps = Steps::lit("0.01");

/// A tick's echoes made ready for many points.
pub(super) struct Judge<'a, const N: usize> {
    outline: &'a Outline,
    eyes: &'a Eyes<N>,
    echoes: &'a Echoes<N>,
    bands: [Band; N],
    /// Sensors that hear something, a bit each.
    pub heard: u32,
    snap: bool,
    /// The body in the points' frame.
    body: Vector,
    forward: Bearing,
    /// Squares: beyond the first a point is dropped, within the second it may lie inside the robot.
    keep: u32,
    reach: u32,
    lifetime: u8,
    now: u8,
}

/// What an echo says of the points in its cone, by the squares of their distances from the sensor; all 0 where there is no
/// echo.
#[derive(Clone, Copy)]
struct Band {
    /// What is nearer is disproved.
    disproved: u32,
    /// What is between these two is supported.
    near: u32,
    far: u32,
    /// And explains the echo, if it is nearer than this.
    explained: u32,
}

/// Points farther away than this are looked at less often.
const FAR_AWAY: Steps = Steps::lit("1.3");

/// Bits of a record's sensor that are its index.
pub(super) const SENSOR: u8 = 31;

/// Bit of a record's sensor: it was far away when it was last looked at.
pub(super) const FAR: u8 = 1 << 6;

/// Bit of a record's sensor: it was not seen when it was last looked at.
pub(super) const UNSEEN: u8 = 1 << 7;

impl<'a, const N: usize> Judge<'a, N> {
    pub fn new(
        params: &MemoryParams,
        outline: &'a Outline,
        eyes: &'a Eyes<N>,
        echoes: &'a Echoes<N>,
        memory: &Memory,
    ) -> Self {
        const NONE: Band = Band {
            disproved: 0,
            near: 0,
            far: 0,
            explained: 0,
        };
        let [disproof, support, nearer] =
            [params.disproof, params.support, params.nearer].map(Steps::of);
        let mut heard = 0;
        let bands = core::array::from_fn(|index| {
            let Some(range) = echoes.as_slice().get(index).copied().and_then(Echo::range) else {
                return NONE;
            };
            heard |= 1u32.wrapping_shl(index as u32);
            let square = |limit: Steps| limit.max(Steps::ZERO).squared();
            Band {
                disproved: square(range - disproof),
                near: square(range - support),
                far: square(range + support),
                explained: square(range + nearer),
            }
        });
        Self {
            outline,
            eyes,
            echoes,
            bands,
            heard,
            snap: params.snap,
            body: memory.body,
            forward: memory.forward,
            keep: Steps::of(params.keep).squared(),
            reach: outline.reach.squared(),
            lifetime: (params.lifetime >> UNIT) as u8,
            now: (memory.tick >> UNIT) as u8,
        }
    }

    /// Supports or doubts a point; whether it is kept. Sets the bits of sensors whose echo it explains, and `behind` if it lies
    /// a little behind an echo.
    #[inline(always)]
    pub fn keeps(&self, record: &mut Record, explained: &mut u32, behind: &mut bool) -> bool {
        let seen = record.at() - self.body;
        let away = seen.norm_squared();
        if away > self.keep || self.now.wrapping_sub(record.seen) > self.lifetime {
            return false;
        }
        let far = if away > const { FAR_AWAY.squared() } {
            FAR
        } else {
            0
        };
        let place = seen.in_frame(self.forward);
        if away < self.reach && self.outline.covers(place, DEEP) {
            return false;
        }
        let mut hint = record.sensor();
        let mut unseen = UNSEEN;
        let kept = self
            .eyes
            .seeing(place, &mut hint, |index, eye, from_eye, view| {
                let Some(band) = self.bands.get(index) else {
                    return true;
                };
                unseen = 0;
                let distance = from_eye.norm_squared();
                if view == View::Sure && distance < band.disproved {
                    record.confidence = record.confidence.saturating_sub(1);
                    return record.confidence > 0;
                }
                if distance < band.far && distance >= band.near {
                    record.confidence = SURE;
                    record.seen = self.now;
                    if distance < band.explained {
                        *explained |= 1u32.wrapping_shl(index as u32);
                    } else {
                        *behind = true;
                    }
                    if self.snap
                        && let Some(range) =
                            self.echoes.as_slice().get(index).and_then(|e| e.range())
                        && distance >= (range + NOISE).squared()
                    {
                        let place = eye.at + drawn(from_eye, range);
                        record.move_to(self.body + place.turned(self.forward));
                    }
                }
                true
            });
        record.eye = hint | unseen | far;
        kept
    }
}

/// A place seen from its sensor, drawn half the way in to `range`.
fn drawn(from_eye: Vector, range: Steps) -> Vector {
    let distance = from_eye.norm();
    let wanted = (distance + range).half();
    let share = proper_fraction(
        wanted.min(distance).bits().max(0).unsigned_abs(),
        distance.bits().max(1).unsigned_abs(),
    );
    let share = (share >> 10) as i32;
    Vector::new(from_eye.x.share(share), from_eye.y.share(share))
}
