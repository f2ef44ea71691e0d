//! The navigator's higher level: which manoeuvre runs, and when to admit that none leads on.

use crate::geometry::{Point, square};
use crate::signals::Twist;
use crate::units::{Metres, MetresPerSecond, RadiansPerSecond, Seconds};

/// What the navigator does.
///
/// ```text
///               the path ahead is not free
///   ┌────────┐ ────────────────────────────▶ ┌───────┐  no admissible heading, ┌────────┐
///   │ Follow │                               │ Avoid │ ──────────────────────▶ │ Escape │
///   └────────┘ ◀──────────────────────────── └───────┘ ◀────────────────────── └────────┘
///        │       free again, after a dwell      │  ▲     moved away, or tried long enough
///        │                                      │  │ resume
///        │ at the goal                          ▼  │
///        ▼                  no progress   ┌─────────┐
///   ┌─────────┐             for long      │ Blocked │
///   │ Arrived │                           └─────────┘
///   └─────────┘
/// ```
///
/// Without progress every manoeuvre but Arrived ends in Blocked. After its pause that goes on to Avoid, or at once to Escape
/// where the robot must back out of a dead end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Manoeuvre {
    /// On the path, by the fine tables.
    Follow,
    /// Among obstacles, by map, guide field and coarse tables.
    #[default]
    Avoid,
    /// Out of a place where nothing is admissible, or only what leads on into a dead end: back the way that it came, along
    /// another short arc, or turning.
    Escape,
    /// Stands and says so: there is no way on. For a pause at first, then it tries again; in the end for good, until
    /// [`Navigator::resume`](super::Navigator::resume).
    Blocked,
    /// Stands at the goal.
    Arrived,
}

/// Thresholds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupervisorParams {
    /// Length of path that must be free to follow it (in the first ticks of a path, as far as it is known), at rest…
    pub enter: Metres,
    /// …and this long a way more.
    pub enter_time: Seconds,
    /// Distance to the outline that the path must leave.
    pub path_margin: Metres,
    /// Distance to the outline below which following ends.
    pub leave: Metres,
    /// Least ticks of avoiding.
    pub dwell: u16,
    /// Ticks without an admissible heading, or with none but into a dead end, before an escape.
    pub stuck: u16,
    /// Ticks of standing before an escape.
    pub still: u16,
    /// Way after which an escape may end…
    pub escape: Metres,
    /// …and ticks after which it does; three times as many while it must back out of a dead end.
    pub escape_ticks: u16,
    /// Who stays this near to where he was…
    pub progress: Metres,
    /// …for this many ticks makes no progress: it stops, says so, and, the third time at one place and every fourth
    /// after that, forgets doubtful points. Places are noted nine times in that time, so it may take a ninth longer.
    pub patience: u16,
    /// Ticks of standing before it tries again.
    pub pause: u16,
    /// That often at one place, and the robot is blocked for good.
    pub strikes: u8,
    /// Who comes no nearer to the goal by `progress` for this many ticks, pauses not counted, is blocked for good.
    pub give_up: u16,
    /// The goal is reached within this distance.
    pub arrival: Metres,
}

/// What a decision is made from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Situation {
    /// The path ahead can be followed; never without a path.
    pub path_free: bool,
    /// The path can be followed with room to spare.
    pub path_clear: bool,
    /// There is an admissible heading.
    pub admissible: bool,
    /// It must back out: the way leads back, there is no room to turn into it, and ahead is a dead end.
    pub back_out: bool,
    /// The last command.
    pub last: Twist,
    /// Where the robot is.
    pub at: Point,
    /// Way to go to the goal.
    pub to_go: Metres,
    /// The goal is reached.
    pub at_goal: bool,
}

/// What was decided.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Decided {
    /// What to do.
    pub manoeuvre: Manoeuvre,
    /// Doubtful points are to be forgotten: the robot has made no progress here several times.
    pub forget: bool,
    /// The place in the direction wanted is to be shunned: going there led nowhere. Who must back out shuns a place on the way
    /// back by that: fewer arrive where nothing or what lies ahead is shunned instead.
    pub shun: bool,
}

/// The third stall at one place makes it forget, and every fourth after that: what it knows is what leads it out of a dead
/// end, so it is given up only after others have failed. With fewer strikes than three it never forgets, nor who stalls at two
/// places in turn.
const FORGET: u8 = 4;

/// So many times as long may an escape take that backs out of a dead end.
const BACK_OUT: u16 = 3;

/// Places noted in a row.
const NOTED: usize = 9;

/// Where the robot was, at even times, and which of these places it has left since.
#[derive(Clone, Copy, Debug)]
struct Trail {
    places: [Point; NOTED],
    /// A bit for each place that it has not left.
    stayed: u16,
    next: u8,
    ticks: u16,
}

impl Trail {
    const NONE: Self = Self {
        places: [Point::new(Metres::ZERO, Metres::ZERO); NOTED],
        stayed: 0,
        next: 0,
        ticks: 0,
    };

    /// Takes over a tick's place. Whether the robot has stayed near the oldest place for all the time since: near a place
    /// that was noted at any time, so that it does not matter when a stall began.
    fn stalls(&mut self, params: &SupervisorParams, at: Point) -> bool {
        if let Some(left) = self.ticks.checked_sub(1) {
            self.ticks = left;
            return false;
        }
        self.ticks = (params.patience / NOTED as u16).saturating_sub(1);
        // Noted every few ticks, so a little beside where a stall began.
        let reach = square(params.progress + const { Metres::lit("0.1") });
        for (bit, place) in (0..16u32).zip(&self.places) {
            if (at - *place).norm_squared() > reach {
                self.stayed &= !(1 << bit);
            }
        }
        let Some(oldest) = self.places.get_mut(usize::from(self.next)) else {
            return false;
        };
        *oldest = at;
        let bit = 1u16 << self.next;
        let stalled = self.stayed & bit != 0;
        self.stayed |= bit;
        self.next = if usize::from(self.next) + 1 < NOTED {
            self.next.wrapping_add(1)
        } else {
            0
        };
        stalled
    }
}

/// What the higher level remembers.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    manoeuvre: Manoeuvre,
    dwelt: u16,
    stuck: u16,
    still: u16,
    /// Where the escape began.
    from: Point,
    trail: Trail,
    /// How often it made no progress within twice `progress` of a place.
    strikes: u8,
    struck: Point,
    least: Metres,
    since_least: u16,
}

impl State {
    pub const fn new() -> Self {
        Self {
            manoeuvre: Manoeuvre::Avoid,
            dwelt: 0,
            stuck: 0,
            still: 0,
            from: Point::new(Metres::ZERO, Metres::ZERO),
            trail: Trail::NONE,
            strikes: 0,
            struck: Point::new(Metres::ZERO, Metres::ZERO),
            least: Metres::MAX,
            since_least: 0,
        }
    }

    /// Whether it is on the path.
    pub fn follows(&self) -> bool {
        self.manoeuvre == Manoeuvre::Follow
    }

    /// Whether it is on its way out of a place.
    pub fn escapes(&self) -> bool {
        self.manoeuvre == Manoeuvre::Escape
    }

    /// The manoeuvre of this tick, and what it means for what is remembered.
    pub fn decide(&mut self, params: &SupervisorParams, now: &Situation) -> Decided {
        let given_up = self.strikes >= params.strikes || self.since_least >= params.give_up;
        if self.manoeuvre == Manoeuvre::Blocked && (given_up || self.dwelt < params.pause) {
            self.dwelt = self.dwelt.saturating_add(1);
            return Decided {
                manoeuvre: Manoeuvre::Blocked,
                ..Decided::default()
            };
        }
        if self.manoeuvre == Manoeuvre::Blocked {
            self.trail = Trail::NONE;
        }
        let stalled = self.watch(params, now);
        // Who brakes past the goal has still arrived.
        let stays = self.manoeuvre == Manoeuvre::Arrived && now.to_go < params.progress;
        let next = if now.at_goal || stays {
            Manoeuvre::Arrived
        } else if stalled || self.since_least >= params.give_up {
            Manoeuvre::Blocked
        } else {
            self.next(params, now)
        };
        let begins = next != self.manoeuvre;
        if begins {
            self.manoeuvre = next;
            self.dwelt = 0;
            self.stuck = 0;
            self.still = 0;
            self.from = now.at;
        }
        self.dwelt = self.dwelt.saturating_add(1);
        Decided {
            manoeuvre: next,
            forget: stalled && self.strikes % FORGET == FORGET - 1,
            shun: stalled || (begins && next == Manoeuvre::Escape),
        }
    }

    fn next(&mut self, params: &SupervisorParams, now: &Situation) -> Manoeuvre {
        let count = |ticks: u16, on: bool| if on { ticks.saturating_add(1) } else { 0 };
        let admissible = now.admissible && !now.back_out;
        self.stuck = count(self.stuck, !admissible);
        self.still = count(self.still, stands(now.last));
        let moved = |from: Point, by: Metres| (now.at - from).norm_squared() > square(by);
        match self.manoeuvre {
            Manoeuvre::Follow if now.path_free && self.still < params.still => Manoeuvre::Follow,
            Manoeuvre::Avoid if self.stuck >= params.stuck || self.still >= params.still => {
                Manoeuvre::Escape
            }
            Manoeuvre::Avoid if now.path_clear && self.dwelt >= params.dwell => Manoeuvre::Follow,
            Manoeuvre::Escape => {
                let out = admissible && moved(self.from, params.escape);
                let times = if now.back_out { BACK_OUT } else { 1 };
                if out || self.dwelt >= params.escape_ticks.saturating_mul(times) {
                    Manoeuvre::Avoid
                } else {
                    Manoeuvre::Escape
                }
            }
            Manoeuvre::Blocked if now.back_out => Manoeuvre::Escape,
            _ => Manoeuvre::Avoid,
        }
    }

    /// Whether it made no progress near a place, the last time that it made none.
    pub fn stalled_near(&self, params: &SupervisorParams, at: Point) -> bool {
        let near = square(params.progress + params.progress);
        self.strikes > 0 && (at - self.struck).norm_squared() <= near
    }

    /// The progress watchdog.
    fn watch(&mut self, params: &SupervisorParams, now: &Situation) -> bool {
        if now.to_go < self.least - params.progress || self.least == Metres::MAX {
            self.least = now.to_go;
            self.since_least = 0;
        }
        self.since_least = self.since_least.saturating_add(1);
        if !self.trail.stalls(params, now.at) {
            return false;
        }
        if !self.stalled_near(params, now.at) {
            self.struck = now.at;
            self.strikes = 0;
        }
        self.strikes = self.strikes.saturating_add(1);
        true
    }
}

/// Whether a command hardly moves the robot.
fn stands(twist: Twist) -> bool {
    const SLOW: MetresPerSecond = MetresPerSecond::lit("0.04");
    const TURN: RadiansPerSecond = RadiansPerSecond::lit("0.15");
    twist.linear.abs() < SLOW && twist.angular.abs() < TURN
}

#[cfg(test)]
mod tests {
    use super::{FORGET, Manoeuvre, Situation, State, SupervisorParams};
    use crate::geometry::Point;
    use crate::navigate::presets;
    use crate::signals::Twist;
    use crate::units::{Metres, MetresPerSecond, RadiansPerSecond};
    use heapless::Vec;

    fn params() -> SupervisorParams {
        presets::jackal::<16>().supervisor
    }

    /// Turns on the spot, far from the goal.
    fn here() -> Situation {
        Situation {
            path_free: false,
            path_clear: false,
            admissible: true,
            back_out: false,
            last: Twist {
                linear: MetresPerSecond::ZERO,
                angular: RadiansPerSecond::lit("1"),
            },
            at: Point::new(Metres::ZERO, Metres::ZERO),
            to_go: Metres::lit("9"),
            at_goal: false,
        }
    }

    #[test]
    fn every_fourth_stall_at_a_place_makes_it_forget() {
        let params = SupervisorParams {
            give_up: u16::MAX,
            ..params()
        };
        let mut state = State::new();
        let (mut stalls, mut forgot, mut ticks) = (0, Vec::<u8, 4>::new(), 0u32);
        while stalls < 9 {
            ticks += 1;
            assert!(ticks < 1200, "{stalls}");
            let decided = state.decide(&params, &here());
            // While it avoids only a stall makes it shun a way.
            stalls += u8::from(decided.shun);
            if decided.forget {
                assert_eq!(decided.manoeuvre, Manoeuvre::Blocked);
                forgot.push(stalls).unwrap();
            }
        }
        assert_eq!(forgot, [FORGET - 1, 2 * FORGET - 1]);
    }

    /// The manoeuvres of so many ticks, each with how long it lasted.
    fn lasted(now: &Situation, ticks: u32) -> Vec<(Manoeuvre, u16), 64> {
        let (params, mut state) = (params(), State::new());
        let mut all = Vec::<(Manoeuvre, u16), 64>::new();
        for _ in 0..ticks {
            let manoeuvre = state.decide(&params, now).manoeuvre;
            match all.last_mut() {
                Some((last, ticks)) if *last == manoeuvre => *ticks += 1,
                _ => all.push((manoeuvre, 1)).unwrap(),
            }
        }
        all
    }

    #[test]
    fn who_must_back_out_escapes_for_longer_and_again_at_once() {
        let params = SupervisorParams {
            patience: u16::MAX,
            ..params()
        };
        let escape = |back_out: bool| {
            let now = Situation {
                admissible: back_out,
                back_out,
                ..here()
            };
            let mut state = State::new();
            let ticks = (0..400).map(|_| state.decide(&params, &now).manoeuvre);
            ticks
                .skip_while(|manoeuvre| *manoeuvre != Manoeuvre::Escape)
                .take_while(|manoeuvre| *manoeuvre == Manoeuvre::Escape)
                .count()
        };
        assert_eq!(escape(false), usize::from(params.escape_ticks));
        assert_eq!(escape(true), 3 * usize::from(params.escape_ticks));

        let after_a_pause = |back_out: bool| {
            let all = lasted(&Situation { back_out, ..here() }, 200);
            let pause = all
                .iter()
                .position(|(manoeuvre, _)| *manoeuvre == Manoeuvre::Blocked);
            all[pause.unwrap() + 1].0
        };
        assert_eq!(after_a_pause(true), Manoeuvre::Escape);
        assert_eq!(after_a_pause(false), Manoeuvre::Avoid);
    }

    #[test]
    fn a_heading_is_none_to_who_must_back_out() {
        let now = Situation {
            back_out: true,
            ..here()
        };
        assert_eq!(
            lasted(&now, 20)[0],
            (Manoeuvre::Avoid, params().stuck - 1),
            "escapes as soon as no heading was admissible for so long"
        );
        assert_eq!(lasted(&here(), 20), [(Manoeuvre::Avoid, 20)]);
    }
}
