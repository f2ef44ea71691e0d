//! Navigation through clutter: the second, larger tick. It is a module of its own beside [`tick::Robot`](crate::tick::Robot),
//! because a robot that only follows paths and passes single obstacles must pay neither its memory nor its instructions.
//!
//! ```text
//!  echoes ─▶ memory ─▶ near ─▶ polar map ─▶ supervise ─▶ follow: fine tables      ─▶ barrier ─▶ twist
//!  pose              predicted  feasible                  avoid:  field, heading,     arc,
//!                    body       headings                          coarse tables       brake gate
//!                                                         escape: back, arcs
//! ```
//!
//! With what is left of a tick then the [guide field](Field) for the next one is worked out.
//!
//! The geometry decides where the robot can go, the rule tables how it turns and how fast it drives there, and the barrier
//! has the last word. Everything is integers; nothing allocates; every loop is bounded.
//!
//! The design follows the polar histogram methods (Ulrich and Borenstein, *VFH+*, ICRA 1998) in its map and choice of the
//! heading, and dynamic-window methods (Fox, Burgard and Thrun, *The dynamic window approach*, 1997) in its admissible
//! speeds.

mod along;
mod barrier;
mod digest;
mod doubt;
mod escape;
mod field;
mod footprint;
mod heading;
mod health;
mod known;
mod mark;
mod memory;
mod near;
mod params;
mod places;
mod polar;
pub mod presets;
mod sensors;
mod stage;
mod steer;
mod steps;
mod supervisor;
mod trajectory;
mod way_back;

pub use barrier::{BarrierParams, Guarded, gate, slow};
pub use doubt::DoubtParams;
pub use field::{Field, FieldParams};
pub use footprint::{Footprint, MAX_VERTICES, Outline};
pub use heading::{Heading, HeadingParams};
pub use health::{Health, HealthParams};
pub use memory::{CAPACITY, Memory, MemoryParams};
pub use near::{MAX_NEAR, Motion, Near};
pub use params::{NavigatorParams, Setup};
pub use polar::{Free, MapParams, PolarMap, SECTORS};
pub use sensors::{Echo, Echoes, Eyes, RangeSet, SENSORS};
pub use stage::{Probe, Stage};
pub use steer::SteerParams;
pub use steps::{Bearing, Steps, Vector};
pub use supervisor::{Manoeuvre, SupervisorParams};
pub use trajectory::{Brakes, MAX_STEPS, Trajectory};

use crate::behaviour::follower::follow;
use crate::geometry::{Point, Pose};
use crate::guide::{Bends, Cursor, Path, pace};
use crate::ports::RangeReading;
use crate::signals::{Guidance, Twist};
use crate::units::{Angle, Metres, MetresPerSecond, RadiansPerSecond};
use heading::{Wanted, choose};
use memory::insertion_range;

/// Where to go.
#[derive(Clone, Copy, Debug)]
pub enum Task<'a> {
    /// To a place of the world, whichever way.
    Goal(Point),
    /// Along a path, around what it does not know.
    Path(&'a Path<'a>),
}

/// What one tick decided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NavigationRecord {
    /// What the navigator does.
    pub manoeuvre: Manoeuvre,
    /// The twist to drive.
    pub twist: Twist,
    /// The twist that the manoeuvre wanted.
    pub wanted: Twist,
    /// What the barrier made of it.
    pub guarded: Guarded,
    /// Heading chosen, if one was admissible; body frame.
    pub heading: Option<Heading>,
    /// Direction wanted, body frame.
    pub direction: Angle,
    /// Distance of the nearest known point to the outline.
    pub clearance: Metres,
    /// Points remembered.
    pub points: u16,
    /// Sensors that seem dead, a bit each in the order of their mounts.
    pub dead: u32,
}

/// All that the navigator remembers from tick to tick.
#[derive(Clone, Debug)]
pub struct Navigator<const N: usize> {
    echoes: Echoes<N>,
    health: Health<N>,
    memory: Memory,
    near: Near,
    map: PolarMap,
    field: Field,
    cursor: Cursor,
    places: places::Places,
    bends: Bends,
    supervisor: supervisor::State,
    /// What the barrier looks along.
    way: Trajectory,
    escape: escape::Escape,
    way_back: way_back::WayBack,
    ground: known::KnownGround,
    /// The last command, and the one before.
    last: Twist,
    before: Twist,
    /// The last heading chosen, world.
    chosen: Angle,
    /// Ticks since the path was last contradicted; saturates.
    quiet: u16,
}

impl<const N: usize> Default for Navigator<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// How far from the middle of the body points are looked at, at most, and how much farther than new ones are taken up.
const LOOK: Steps = Steps::lit("2");
const BEYOND: Steps = Steps::lit("0.45");

/// With more points near than that they are looked at less far away: in a crowd what is nearest decides.
const CROWD: usize = 50;
const LESS: Steps = Steps::lit("0.4");

/// Units of work that the guide field gets in every tick, whatever the tick has cost.
const LEAST: i32 = 12;

impl<const N: usize> Navigator<N> {
    /// A robot at rest that has seen nothing.
    pub const fn new() -> Self {
        Self {
            echoes: Echoes::new(),
            health: Health::new(),
            memory: Memory::new(),
            near: Near::new(),
            map: PolarMap::new(),
            field: Field::new(),
            cursor: Cursor::new(),
            places: places::Places::new(),
            bends: Bends::new(),
            supervisor: supervisor::State::new(),
            way: Trajectory::new(),
            escape: escape::Escape::new(),
            way_back: way_back::WayBack::new(),
            ground: known::KnownGround::new(),
            last: Twist::REST,
            before: Twist::REST,
            chosen: Angle::ZERO,
            quiet: u16::MAX,
        }
    }

    /// Begins a new task; what was seen stays known.
    pub fn restart(&mut self) {
        self.cursor = Cursor::new();
        self.places.clear();
        self.bends = Bends::new();
        self.supervisor = supervisor::State::new();
        self.field.reset();
        self.field.forgive();
        self.quiet = u16::MAX;
    }

    /// Tries again after [`Manoeuvre::Blocked`].
    pub fn resume(&mut self) {
        self.supervisor = supervisor::State::new();
    }

    /// Takes over the readings of single sensors, in the order of their mounts.
    pub fn see(&mut self, setup: &Setup<N>, readings: &[RangeReading]) {
        self.echoes.take(&setup.eyes, readings, self.last.linear);
    }

    /// Takes over a lidar's scan: direction (body frame) and range of each beam, a range of 0 for no return.
    pub fn see_scan(&mut self, setup: &Setup<N>, beams: impl IntoIterator<Item = (Angle, Metres)>) {
        self.echoes.reduce(&setup.eyes, beams);
    }

    /// The remembered points.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// One control period, after [`Navigator::see`]: `pose` is the believed one. Call it every period.
    pub fn step(&mut self, setup: &Setup<N>, pose: Pose, task: Task<'_>) -> NavigationRecord {
        self.step_observed(setup, pose, task, &mut ())
    }

    /// [`Navigator::step`], watched.
    pub fn step_observed<P: Probe>(
        &mut self,
        setup: &Setup<N>,
        pose: Pose,
        task: Task<'_>,
        probe: &mut P,
    ) -> NavigationRecord {
        let p = &setup.params;
        let outline = &setup.outline;
        self.health.update(&p.health, self.echoes.of(&setup.eyes));
        self.memory.update(
            &p.memory,
            outline,
            &setup.eyes,
            &self.echoes,
            pose,
            self.last.linear,
            |at| self.field.notice(at),
        );
        let dead = self.health.dead();
        let some = if dead == 0 { 0 } else { 32 };
        for (index, eye) in (0..some).zip(setup.eyes.as_slice()) {
            if dead >> index & 1 == 1
                && let Some(range) = Health::<N>::lent(&p.health, self.echoes.as_slice(), index)
            {
                self.memory.assume(&p.memory, index as u8, eye, range);
            }
        }
        probe.mark(Stage::Remember);
        self.way_back.follow(pose, self.last.linear);
        self.ground.follow(pose);
        // What is decided now acts after the latency; until then the last command does.
        let moved = Motion::of(setup.brakes.mean(self.before, self.last), p.latency);
        let ahead = moved.from(pose);
        let look = self.look(setup);
        self.near
            .collect(self.memory.seen_from(moved, look), outline);
        probe.mark(Stage::Near);
        self.map
            .draw(&p.map, &self.near, outline, Steps::of(p.heading.least));
        probe.mark(Stage::Map);

        let course = self.course(setup, pose, ahead, task);
        probe.mark(Stage::Course);
        // Who follows a free path needs none.
        let follows = course.free && self.supervisor.follows();
        let heading = if follows {
            None
        } else {
            choose(
                &p.heading,
                &setup.weights,
                &mut self.map,
                &self.near,
                &Wanted {
                    direction: course.direction,
                    last: self.chosen - ahead.heading,
                    distance: course.distance,
                    look: Steps::of(p.map.look),
                    judged: self.memory.judged(),
                    briefly: self.supervisor.escapes(),
                },
            )
        };
        probe.mark(Stage::Heading);
        let decided = self.supervisor.decide(
            &p.supervisor,
            &supervisor::Situation {
                path_free: course.free,
                path_clear: course.clear,
                admissible: follows || heading.is_some(),
                back_out: !follows && self.must_back_out(p, pose.at, &course, heading.as_ref()),
                last: self.last,
                at: pose.at,
                to_go: course.to_go,
                at_goal: course.at_goal,
            },
        );
        if decided.forget {
            self.memory.forget_doubtful(&setup.eyes, outline);
        }
        if decided.shun {
            let tried = Point::polar(
                const { Metres::lit("0.45") },
                ahead.heading + course.direction,
            );
            self.field.shun(&p.field, ahead.at + tried);
        }
        probe.mark(Stage::Supervise);
        let manoeuvre = decided.manoeuvre;
        let wanted = self.behave(setup, task, manoeuvre, &course, heading.as_ref(), ahead);
        probe.mark(Stage::Behave);
        let guarded = self.guard(setup, wanted);
        probe.mark(Stage::Guard);
        if course.guided {
            self.look_for_way(setup, pose, &course, decided.forget, guarded.looked);
        }
        probe.mark(Stage::Field);
        self.before = core::mem::replace(&mut self.last, guarded.twist);
        NavigationRecord {
            manoeuvre,
            twist: guarded.twist,
            wanted,
            guarded,
            heading,
            direction: course.direction,
            clearance: self.near.clearance().metres(),
            points: self.memory.len() as u16,
            dead,
        }
    }

    /// A slice of the guide field, with what the tick has left: the last part of a tick, so that its cost is known. The way
    /// that it finds is the next tick's.
    fn look_for_way(
        &mut self,
        setup: &Setup<N>,
        pose: Pose,
        course: &Course,
        forgot: bool,
        looked: u32,
    ) {
        /// What forgetting costs.
        const FORGETTING: i32 = 70;
        let p = &setup.params.field;
        let spent = self.spent(course.guidance.is_some(), looked);
        let spent = spent.wrapping_add(if forgot { FORGETTING } else { 0 });
        let left = i32::from(p.tick).wrapping_sub(spent).max(LEAST);
        self.field
            .work(p, left, &setup.costs, &self.memory, pose.at, course.carrot);
    }

    /// What this tick has cost, about, in the field's [units](FieldParams::budget): fitted to what `cargo navigation` counts
    /// on a Cortex-M4F. Of a thousand ticks one costs 80 more. `looked` is what the guard [looked at](Guarded::looked).
    fn spent(&self, planned: bool, looked: u32) -> i32 {
        let [near, sectors, judged] = [
            self.near.spots().len() as u32,
            self.map.looked(),
            self.memory.judged(),
        ];
        let quarters = near
            .wrapping_mul(9)
            .wrapping_add(sectors.wrapping_mul(26))
            .wrapping_add(judged.wrapping_mul(10))
            .wrapping_add(looked.wrapping_add(self.escape.looked_at).wrapping_mul(6));
        (quarters >> 2)
            .wrapping_add(67)
            .wrapping_add(if planned { 43 } else { 0 }) as i32
    }

    /// How far from the middle of the body points matter.
    fn look(&self, setup: &Setup<N>) -> Steps {
        let look = (insertion_range(&setup.params.memory, self.last.linear) + BEYOND).min(LOOK);
        if self.near.spots().len() > CROWD {
            look - LESS
        } else {
            look
        }
    }

    /// Where to head: along the path while it is free, else by the guide field.
    fn course(&mut self, setup: &Setup<N>, pose: Pose, ahead: Pose, task: Task<'_>) -> Course {
        let p = &setup.params;
        let mut course = match task {
            Task::Goal(goal) => Course::to(goal, pose.at, p.supervisor.arrival),
            Task::Path(path) => self.along(setup, path, pose, ahead),
        };
        let mut head_for = course.carrot;
        if course.guided {
            head_for = self.field.guide(&p.field, pose.at).unwrap_or(course.carrot);
        } else {
            self.field.reset();
        }
        let toward = |place: Point| (place - ahead.at).direction() - ahead.heading;
        course.direction = toward(head_for);
        course.distance = Steps::of((course.carrot - ahead.at).norm());
        // The field knows directions by its cells only. Where the straight way is free and not far off, it is better.
        let straight = toward(course.carrot);
        let off = (course.direction - straight).abs();
        if course.guided && off.bits() < p.field.straight.bits() {
            let wide = setup.outline.half_width + Steps::of(p.map.soft);
            let look = course.distance.min(Steps::of(p.map.look));
            if self.near.corridor(Bearing::of(straight), wide, look) >= look {
                course.direction = straight;
            }
        }
        course
    }

    /// Whether the robot must back out: the way leads back, there is no room to turn into it, and ahead is a dead end, as it
    /// made no progress here before, or its best heading is soon closed; while it escapes already any heading counts as such.
    fn must_back_out(
        &self,
        p: &NavigatorParams<N>,
        at: Point,
        course: &Course,
        heading: Option<&Heading>,
    ) -> bool {
        const BACK: Angle = Angle::deg("110");
        /// One and a half lengths of the presets' body, whatever the body. What lies beyond the map's look is not seen free.
        const SOON: Steps = Steps::lit("0.8");
        let escapes = self.supervisor.escapes();
        let dead_end = || {
            self.supervisor.stalled_near(&p.supervisor, at)
                || heading.is_some_and(|heading| escapes || heading.hard < SOON)
        };
        course.guided
            && course.direction.abs().bits() > BACK.bits()
            && dead_end()
            && !self.map.can_turn(course.direction)
            && !self.map.can_turn(-course.direction)
    }

    /// The twist that the manoeuvre wants.
    fn behave(
        &mut self,
        setup: &Setup<N>,
        task: Task<'_>,
        manoeuvre: Manoeuvre,
        course: &Course,
        heading: Option<&Heading>,
        ahead: Pose,
    ) -> Twist {
        let p = &setup.params;
        if manoeuvre != Manoeuvre::Escape {
            self.escape.reset();
        }
        match (manoeuvre, heading, &course.guidance, task) {
            (Manoeuvre::Follow, _, Some(guidance), Task::Path(path)) => {
                self.chosen = ahead.heading;
                let pace = pace(&p.follower, &p.limits, path, &mut self.cursor, guidance);
                let mut twist = follow(
                    &setup.fine,
                    &p.follower,
                    &p.limits,
                    p.period,
                    guidance,
                    self.last,
                )
                .twist;
                twist.linear = twist.linear.min(approach(course.to_go)).min(pace);
                twist
            }
            (Manoeuvre::Escape, ..) => {
                self.chosen = ahead.heading;
                self.escape.drive(
                    &self.near,
                    &setup.outline,
                    &self.map,
                    &p.barrier,
                    course.direction,
                    &escape::Behind {
                        pose: ahead,
                        way_back: &self.way_back,
                        ground: &self.ground,
                        eyes: &setup.eyes,
                        dead: self.health.dead(),
                    },
                )
            }
            (Manoeuvre::Blocked | Manoeuvre::Arrived, ..) => Twist::REST,
            (_, Some(heading), ..) => {
                self.chosen = ahead.heading + heading.angle;
                let mut twist = steer::steer(&p.steer, &p.limits, heading, self.near.clearance());
                twist.linear = twist.linear.min(approach(course.to_go));
                twist
            }
            (_, None, ..) => turn_toward(course.direction, &self.map),
        }
    }

    /// Barrier and gate.
    fn guard(&mut self, setup: &Setup<N>, wanted: Twist) -> Guarded {
        let p = &setup.params;
        let outline = &setup.outline;
        let room = (self.map.left, self.map.right);
        // Who drives no faster anyway need not ask.
        let doubted = if p.limits.speed <= p.doubt.careful {
            p.limits.speed
        } else {
            p.doubt.cap(
                &setup.eyes,
                self.echoes.as_slice(),
                outline,
                self.last.linear,
                p.period + p.latency,
            )
        };
        let healthy = self.health.cap(&p.health, &setup.eyes);
        let fastest = p.limits.speed.min(healthy).min(doubted);
        let wanted = Twist {
            linear: wanted.linear.min(fastest).max(-p.reverse),
            angular: wanted
                .angular
                .limit(RadiansPerSecond::new(p.limits.yaw_rate)),
        };
        let (slowed, looked) = slow(
            &mut self.way,
            &p.barrier,
            &self.near,
            &setup.outline,
            room,
            setup.brakes,
            self.last,
            wanted,
        );
        let gentle = Brakes {
            angular: RadiansPerSecond::from_bits(
                params::per(p.steer.yaw_acceleration, p.period).bits(),
            ),
            ..setup.brakes
        };
        let stepped = gentle.toward(self.last, slowed);
        let guarded = gate(
            &mut self.way,
            &p.barrier,
            &self.near,
            &setup.outline,
            setup.brakes,
            self.last,
            stepped,
        );
        Guarded {
            slowed: slowed != wanted,
            looked: guarded.looked.wrapping_add(looked),
            ..guarded
        }
    }
}

/// What the task asks for this tick.
#[derive(Clone, Debug, Default)]
struct Course {
    /// The place to reach, world.
    carrot: Point,
    /// By the guide field.
    guided: bool,
    free: bool,
    clear: bool,
    to_go: Metres,
    at_goal: bool,
    guidance: Option<Guidance>,
    /// Body frame.
    direction: Angle,
    distance: Steps,
}

impl Course {
    fn to(goal: Point, at: Point, arrival: Metres) -> Self {
        let to_go = (goal - at).norm();
        Self {
            carrot: goal,
            guided: true,
            to_go,
            at_goal: to_go < arrival,
            ..Self::default()
        }
    }
}

/// Speed at which 1 m/s² still stops at the goal: √(2·s), and 0.05 m/s so that it is reached.
fn approach(to_go: Metres) -> MetresPerSecond {
    if to_go > const { Metres::lit("8") } {
        return MetresPerSecond::MAX;
    }
    let root = crate::geometry::root(u64::from(to_go.bits().max(0).unsigned_abs()) << 17);
    MetresPerSecond::from_bits(root.bits()) + const { MetresPerSecond::lit("0.05") }
}

/// In place towards a direction, or to the side with more room if that way is closed.
fn turn_toward(direction: Angle, map: &PolarMap) -> Twist {
    const RATE: RadiansPerSecond = RadiansPerSecond::lit("1");
    let left = if map.can_turn(direction) {
        direction.is_left()
    } else {
        map.left.bits() >= map.right.bits()
    };
    Twist {
        linear: MetresPerSecond::ZERO,
        angular: if left { RATE } else { -RATE },
    }
}
