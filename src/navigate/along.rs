//! A path's part of a tick: where the robot is on it, whether it is free, where to meet it again, and what a follower does
//! before a bend begins.

use super::places::{PLACES, SPACING};
use super::steps::{Steps, Vector};
use super::{Course, Navigator, NavigatorParams, Setup};
use crate::geometry::{Pose, root};
use crate::guide::{Path, guide};
use crate::integer::ratio;
use crate::signals::Guidance;
use crate::units::{Metres, PerMetre, Seconds};

/// Ticks without contradiction after which a path counts as free.
const QUIET: u16 = 5;

/// Places from the first free one behind what stands on a path to the carrot.
const BEHIND: usize = 3;

impl<const N: usize> Navigator<N> {
    /// Moves the cursor and looks along the path ahead of it.
    pub(super) fn along(
        &mut self,
        setup: &Setup<N>,
        path: &Path<'_>,
        pose: Pose,
        ahead: Pose,
    ) -> Course {
        let p = &setup.params;
        let timing = (p.period, p.latency);
        self.cut_corner(p, path);
        let mut guidance = guide(
            &p.follower,
            &p.limits,
            timing,
            path,
            &mut self.cursor,
            pose,
            self.last,
        );
        guidance.curvature = self.bend_ahead(p, path, &guidance);
        let speed = Metres::from_bits(self.last.linear.abs().over(p.supervisor.enter_time).bits());
        let need = p.supervisor.enter + speed;
        let reach = setup.outline.half_width + Steps::of(p.supervisor.path_margin);
        let frame = ahead.frame();
        let mut short = guidance.foot;
        let mut carrot = guidance.foot;
        let look = self.look(setup).metres() + const { Metres::lit("0.2") };
        // The place ahead that is nearest to the robot, where that is nearer than the cursor.
        let mut nearest = ((guidance.foot - pose.at).norm_squared(), Metres::ZERO);
        let mut places = heapless::Vec::<Vector, PLACES>::new();
        self.places.follow(path, &self.cursor, look);
        let first = self.places.way(&self.cursor);
        let mut far = first;
        for place in self.places.as_slice() {
            carrot = *place;
            if far <= const { Metres::lit("0.7") } {
                short = *place;
            }
            let away = (*place - pose.at).norm_squared();
            if away < nearest.0 {
                nearest = (away, far);
            }
            let body = Vector::of(frame.to_body(*place));
            far = far + SPACING;
            if places.push(body).is_err() || far > look {
                break;
            }
        }
        let mut touched = self.near.touching(&places, reach);
        far = first;
        // Where something stands on the path, it is met again soon behind that.
        let behind = usize::try_from(32u32.wrapping_sub(touched.leading_zeros())).unwrap_or(0);
        if touched != 0
            && let Some(place) = places.get(behind.wrapping_add(BEHIND))
        {
            carrot = ahead.to_world(place.point());
        }
        let contradicted = touched != 0;
        let mut free = true;
        while touched != 0 {
            free &= touched & 1 == 0 || far > need;
            touched >>= 1;
            far = far + SPACING;
        }
        if nearest.1 > Metres::ZERO {
            self.cursor.skip(path, nearest.1);
        }
        self.quiet = if contradicted {
            0
        } else {
            self.quiet.saturating_add(1)
        };
        let close = guidance.cross_track.abs() < const { Metres::lit("0.45") };
        // A path that nothing contradicts any more is met again soon, without the field.
        let strayed = guidance.cross_track.abs() > const { Metres::lit("0.6") };
        let guided = self.quiet < QUIET || strayed;
        let touching = self.near.clearance() < Steps::of(p.supervisor.leave);
        Course {
            carrot: if guided { carrot } else { short },
            guided,
            free: free && close && !touching,
            clear: !contradicted && close && !touching,
            to_go: guidance.remaining,
            at_goal: guidance.at_end,
            guidance: Some(guidance),
            ..Course::default()
        }
    }

    /// Turns early: the cursor goes on to a corner when half of the turn there takes as long as the way to it.
    fn cut_corner(&mut self, p: &NavigatorParams<N>, path: &Path<'_>) {
        let reach = const { Metres::lit("1") };
        self.bends.follow(path, &self.cursor, reach);
        let Some((way, jump)) = self.bends.corner(&self.cursor, reach) else {
            return;
        };
        // Speeding up for half of the angle Δ and slowing down for the other takes twice √(Δ/a).
        let turn = jump.abs().radians().to_bits();
        let squared = ratio(1 << 16, turn, p.steer.yaw_acceleration.to_bits().max(1));
        let half = root(u64::from(squared.unsigned_abs()) << 16).bits();
        let half = Seconds::from_bits(half.saturating_mul(1 << 8));
        // Meanwhile the tables slow it down to about 5/8.
        let while_turning = self.last.linear.abs().over(half + p.latency);
        if way <= while_turning.scale(const { fixed::types::I16F16::lit("0.625") }) {
            self.cursor.skip(path, way);
        }
    }

    /// Curvature to steer by: where it changes, that of the place that is reached when half of the change is made.
    fn bend_ahead(&self, p: &NavigatorParams<N>, path: &Path<'_>, guidance: &Guidance) -> PerMetre {
        let speed = self.last.linear.abs();
        let soon = |time: Seconds| self.bends.curvature(path, &self.cursor, speed.over(time));
        let most = const { Seconds::lit("0.3") };
        let change = speed.on_arc((soon(most) - guidance.curvature).abs());
        if change.bits() == 0 {
            return guidance.curvature;
        }
        let whole = ratio(
            1 << 24,
            change.bits(),
            p.steer.yaw_acceleration.to_bits().max(1),
        );
        let half = Seconds::from_bits((whole >> 1).wrapping_add(p.period.bits() >> 1));
        soon(half.min(most))
    }
}
