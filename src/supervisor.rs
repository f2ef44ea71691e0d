//! The higher level: which sub-task runs. Thresholds, dwell and side commitment are assumed; the chapter gives none,
//! and with a single threshold robots chatter.

use crate::geometry::{Frame, Point, Pose, square};
use crate::params::{Avoider, Supervisor};
use crate::signals::{Decision, Guidance, Obstacle, Sensed, Sight, StopReason, Travel, Turn};
use crate::units::{Angle, Metres};

/// The mode of the higher level.
///
/// ```text
///               enters_avoid                     every arrow is the function of that name
///   ┌────────┐ ─────────────▶ ┌───────┐
///   │ Follow │                │ Avoid │ ⟲ retarget: next obstacle in the way, same side
///   └────────┘ ◀───────────── └───────┘
///     ▲    │    leaves_avoid      │
///     │    │ stops                │ stops
///     │    ▼                      ▼
///     │  ┌───────────────────────────┐
///     └──│           Stop            │
/// resumes└───────────────────────────┘
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Following the path.
    Follow,
    /// Passing an obstacle, committed to a side.
    Avoid,
    /// Standing still.
    Stop(StopReason),
}

/// An obstacle that was passed or is being passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// Its centre, world frame.
    pub centre: Point,
    /// Its last estimate, body frame.
    pub obstacle: Obstacle,
    /// The side committed to.
    pub side: Turn,
    /// Ticks since it was last seen.
    pub unseen: u16,
}

/// What the higher level remembers.
#[derive(Clone, Copy, Debug)]
pub struct SupervisorState {
    mode: Mode,
    /// Ticks in this mode, saturating.
    dwelt: u16,
    /// Ticks without any valid range.
    blind: u16,
    /// Ticks without odometry.
    lost: u16,
    /// Ticks since both are back.
    healthy: u16,
    held: Option<Held>,
    /// Of the one held, while it is being passed.
    sight: Sight,
}

impl Default for SupervisorState {
    fn default() -> Self {
        Self::new()
    }
}

/// What a decision is made from.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The robot's radius.
    pub robot_radius: Metres,
    /// The sensors.
    pub sensed: &'a Sensed,
    /// Odometry of this tick.
    pub travel: Travel,
    /// Believed pose.
    pub pose: Frame,
    /// Relation to the path.
    pub guidance: &'a Guidance,
}

impl SupervisorState {
    /// At the start of a path.
    pub const fn new() -> Self {
        Self {
            mode: Mode::Follow,
            // The first obstacle may stand right at the start: no dwell before it.
            dwelt: u16::MAX,
            blind: 0,
            lost: 0,
            healthy: 0,
            held: None,
            sight: Sight {
                bearing: Angle::ZERO,
                distance: Metres::ZERO,
                half_angle: Angle::ZERO,
            },
        }
    }

    /// Current mode.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Of the obstacle that the last decision avoids.
    pub fn sight(&self) -> Sight {
        self.sight
    }

    /// Decides for one tick.
    pub fn decide(
        &mut self,
        params: &Supervisor,
        avoider: &Avoider,
        now: &Situation<'_>,
    ) -> Decision {
        self.watch(now);
        self.track(params, now);
        let before = self.mode;
        let reason = self.stops(params, now);
        let threat = threat(params, avoider, now);
        self.mode = match (self.mode, reason) {
            (_, Some(reason)) => Mode::Stop(reason),
            (Mode::Stop(_), None) if self.resumes(params, now) => Mode::Follow,
            (Mode::Follow, None) => match self.enters_avoid(params, now, threat) {
                Some(held) => {
                    self.held = Some(held);
                    Mode::Avoid
                }
                None => Mode::Follow,
            },
            (stopped @ Mode::Stop(_), None) => stopped,
            (Mode::Avoid, None) => {
                self.retarget(params, now, threat);
                Mode::Avoid
            }
        };
        if let (Mode::Avoid, Some(held)) = (self.mode, &self.held) {
            self.sight = held.obstacle.sight(now.robot_radius + avoider.margin);
            if before == Mode::Avoid && self.leaves_avoid(params, now, threat) {
                self.mode = Mode::Follow;
            }
        }
        let changed = core::mem::discriminant(&before) != core::mem::discriminant(&self.mode);
        self.dwelt = if matches!(before, Mode::Stop(_)) && changed {
            // What happened while standing does not delay the next decision.
            u16::MAX
        } else if changed {
            1
        } else {
            self.dwelt.saturating_add(1)
        };
        match (self.mode, &self.held) {
            (Mode::Avoid, Some(held)) => Decision::Avoid {
                side: held.side,
                obstacle: held.obstacle,
            },
            (Mode::Stop(reason), _) => Decision::Stop(reason),
            _ => Decision::Follow,
        }
    }

    /// Counts the ticks without ranges, without odometry, and with both.
    fn watch(&mut self, now: &Situation<'_>) {
        let count = |bad: bool, ticks: u16| if bad { ticks.saturating_add(1) } else { 0 };
        self.blind = count(now.sensed.valid == 0, self.blind);
        self.lost = count(matches!(now.travel, Travel::Unknown(_)), self.lost);
        self.healthy = count(self.blind == 0 && self.lost == 0, self.healthy);
    }

    /// Carries the held obstacle along with odometry, and takes over what the sensors see of it.
    fn track(&mut self, params: &Supervisor, now: &Situation<'_>) {
        let Some(held) = &mut self.held else { return };
        let expected = now.pose.to_body(held.centre);
        let seen = now
            .sensed
            .obstacles
            .iter()
            .map(|o| ((o.centre - expected).norm_squared(), o))
            .filter(|(miss, _)| *miss <= square(params.same))
            .min_by_key(|(miss, _)| *miss);
        match seen {
            Some((_, obstacle)) => {
                // Halfway to the new estimate: one noisy fit must not swing the manoeuvre.
                let half = |a: Metres, b: Metres| Metres::from_bits((a + b).bits() >> 1);
                held.obstacle = Obstacle {
                    centre: Point::new(
                        half(expected.x, obstacle.centre.x),
                        half(expected.y, obstacle.centre.y),
                    ),
                    radius: half(held.obstacle.radius, obstacle.radius),
                    ..*obstacle
                };
                held.centre = now.pose.to_world(held.obstacle.centre);
                held.unseen = 0;
            }
            None => {
                held.obstacle.centre = expected;
                held.unseen = held.unseen.saturating_add(1);
            }
        }
    }

    /// Any mode → Stop: sensing or odometry is gone for longer than patience allows, or the path is driven.
    pub fn stops(&self, params: &Supervisor, now: &Situation<'_>) -> Option<StopReason> {
        if now.guidance.at_end {
            Some(StopReason::PathEnd)
        } else if now.guidance.missed_end {
            Some(StopReason::PathMissed)
        } else if self.blind > params.patience {
            Some(StopReason::NoRanges)
        } else if self.lost > params.patience {
            Some(StopReason::NoOdometry)
        } else {
            None
        }
    }

    /// Stop → Follow: nothing stops the robot any more, and has not for the dwell time. The end of a path is final; a
    /// robot that is pushed away from it does not set off again.
    pub fn resumes(&self, params: &Supervisor, now: &Situation<'_>) -> bool {
        let over = matches!(
            self.mode,
            Mode::Stop(StopReason::PathEnd | StopReason::PathMissed)
        );
        !over && self.stops(params, now).is_none() && self.healthy >= params.dwell.max(1)
    }

    /// Follow → Avoid: an obstacle nearer than `enter` covers the way that guidance wants, or one nearer than half of
    /// that covers the way the robot points. The side is committed here.
    pub fn enters_avoid(
        &self,
        params: &Supervisor,
        now: &Situation<'_>,
        threat: Option<&Obstacle>,
    ) -> Option<Held> {
        if self.dwelt < params.dwell {
            return None;
        }
        let obstacle = *threat?;
        let centre = now.pose.to_world(obstacle.centre);
        let side = match &self.held {
            Some(last) if (last.centre - centre).norm_squared() <= square(params.same) => last.side,
            _ => choose_side(params, now, &obstacle),
        };
        Some(Held {
            centre,
            obstacle,
            side,
            unseen: 0,
        })
    }

    /// Avoid → Follow: the obstacle is beyond `exit` or out of sight for longer than patience, or the way that
    /// guidance wants clears its unfeasible region on the committed side; and there is no threat.
    pub fn leaves_avoid(
        &self,
        params: &Supervisor,
        now: &Situation<'_>,
        threat: Option<&Obstacle>,
    ) -> bool {
        let Some(held) = &self.held else { return true };
        if self.dwelt < params.dwell || threat.is_some() {
            return false;
        }
        let Sight {
            bearing,
            distance,
            half_angle,
        } = self.sight;
        let mirror = |angle: Angle| match held.side {
            Turn::Right => angle,
            Turn::Left => -angle,
        };
        let needed = half_angle + params.clear;
        let way = mirror(bearing - now.guidance.heading_error);
        let heading = mirror(bearing);
        let far = distance - held.obstacle.radius - now.robot_radius > params.exit;
        let gone = held.unseen > params.patience;
        let clears = |angle: Angle| angle.abs().bits() > needed.bits();
        let passed = way.is_left() && clears(way);
        // A way that leads back from the obstacle has no side.
        let away = way.abs().bits() > Angle::QUARTER.bits();
        // The way may also have swung clear on the other side, if the robot already points there.
        let other_side = !way.is_left() && clears(way) && !heading.is_left() && clears(heading);
        far || gone || passed || away || other_side
    }

    /// Avoid → Avoid: another obstacle in the way takes the held one's place once that is passed or it is the nearer;
    /// the side stays.
    pub fn retarget(
        &mut self,
        params: &Supervisor,
        now: &Situation<'_>,
        threat: Option<&Obstacle>,
    ) {
        let (Some(held), Some(obstacle)) = (&mut self.held, threat) else {
            return;
        };
        // Both in the body frame of this tick.
        if (obstacle.centre - held.obstacle.centre).norm_squared() > square(params.same) {
            held.centre = now.pose.to_world(obstacle.centre);
            held.obstacle = *obstacle;
            held.unseen = 0;
        }
    }
}

/// A threat: the nearest obstacle in the way, if any. Half the margin is enough here: what is steered around with the whole
/// margin does not come into the way again by a noisy estimate.
pub fn threat<'a>(
    params: &Supervisor,
    avoider: &Avoider,
    now: &Situation<'a>,
) -> Option<&'a Obstacle> {
    if now.sensed.obstacles.is_empty() {
        return None;
    }
    let grown = now.robot_radius + Metres::from_bits(avoider.margin.bits() >> 1);
    let way = now.guidance.heading_error.rotation();
    let near = Metres::from_bits(params.enter.bits() >> 1);
    // What stands beyond the path's end is nobody's business.
    let [far, near] = [params.enter, near].map(|limit| {
        let limit = limit.min(now.guidance.remaining);
        (limit > Metres::ZERO).then_some(now.robot_radius + limit)
    });
    now.sensed.obstacles.iter().find(|obstacle| {
        let squared = obstacle.centre.norm_squared();
        let within = |rim: Option<Metres>| {
            rim.is_some_and(|rim| squared < square((obstacle.radius + rim).max(Metres::ZERO)))
        };
        within(far)
            && (obstacle.covers(way, grown) || (obstacle.stands_ahead(grown) && within(near)))
    })
}

/// Which way past: away from the arc's centre when the obstacle stands inside the arc (inside rule); else right when
/// it is on the left or straight ahead, left when it is on the right.
fn choose_side(params: &Supervisor, now: &Situation<'_>, obstacle: &Obstacle) -> Turn {
    if let Some(inside) = inside_rule(now, obstacle) {
        return inside;
    }
    let off = obstacle.bearing() - now.guidance.heading_error;
    if !off.is_left() && off.abs().bits() > params.tie.bits() {
        Turn::Left
    } else {
        Turn::Right
    }
}

/// The inside rule: on a circular path whose centre lies on the obstacle's side, pass outside. An obstacle whose
/// centre is within a quarter of its radius of the path is on neither side.
pub fn inside_rule(now: &Situation<'_>, obstacle: &Obstacle) -> Option<Turn> {
    let curvature = i64::from(now.guidance.curvature.bits());
    if curvature == 0 {
        return None;
    }
    // In the path's frame at the foot the circle's centre is (0, 1/κ): a point (x, y) is nearer to it than 1/|κ| − s
    // if and only if y towards the centre exceeds s + (x² + y² − s²)·|κ|/2. No centre is computed: with a small κ it
    // would lie beyond every coordinate.
    let foot = Pose::new(now.guidance.foot, now.guidance.tangent);
    let at = foot.to_body(now.pose.to_world(obstacle.centre));
    let slack = Metres::from_bits(obstacle.radius.bits() >> 2);
    let squares = at.norm_squared().saturating_sub(square(slack)) >> 16;
    let sagitta = i64::try_from(squares)
        .unwrap_or(i64::MAX)
        .saturating_mul(curvature.abs())
        >> 17;
    let inward = if curvature > 0 { at.y } else { -at.y };
    if i64::from((inward - slack).bits()) <= sagitta {
        return None;
    }
    Some(if curvature < 0 {
        Turn::Left
    } else {
        Turn::Right
    })
}
