//! The pilot as a desktop and a board meet it: whole frames through pipes that lose, change, repeat and reorder them,
//! a drive that tells what it was commanded, and time that the test keeps.

use fixed::types::I16F16;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{Path, Segment};
use fuzzypilot::link::frame::{self, Decoder, MAX_FRAME};
use fuzzypilot::link::message::{
    Cause, Counts, MAX_READINGS, PathFault, PathForm, PortFault, Readings, Role, ToHost, ToTarget,
    Why,
};
use fuzzypilot::link::record::{self, RECORD_BYTES};
use fuzzypilot::link::settings;
use fuzzypilot::pilot::{Cadence, GRACE_US, Pilot, SILENCE_US, State};
use fuzzypilot::ports::{
    Fault, Ports, Range, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use fuzzypilot::presets;
use fuzzypilot::signals::TickRecord;
use fuzzypilot::tick::Robot;
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, Seconds};
use std::sync::Mutex;

const RING: usize = 8;
type Flown = Pilot<RING, 4, 6>;

/// Of the settings used here.
const PERIOD_US: u32 = 50_000;

fn new_pilot() -> Flown {
    Pilot::new(presets::small_robot(), Pose::default())
}

fn line() -> [Segment; 1] {
    [Segment::line(Pose::default(), Metres::lit("3"))]
}

/// Numbers that are the same in every run (xorshift).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as u32
    }

    fn below(&mut self, most: usize) -> usize {
        self.roll() as usize % most
    }
}

// ---- the desktop ----

/// An answer, owned.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Said {
    Welcome {
        token: u32,
    },
    State {
        armed: bool,
        cause: Cause,
        token: u32,
        tick: u32,
        uptime_ms: u32,
    },
    Value {
        id: u16,
        value: i32,
    },
    Ack,
    Refused(Why),
    Record(Box<TickRecord>),
}

impl Said {
    fn token(&self) -> u32 {
        match self {
            Self::Welcome { token } | Self::State { token, .. } => *token,
            other => panic!("no token in {other:?}"),
        }
    }

    fn record(self) -> TickRecord {
        match self {
            Self::Record(record) => *record,
            other => panic!("no record but {other:?}"),
        }
    }
}

/// A desktop with a clean wire: what it does to frames, the tests do.
struct Desk {
    sequence: u8,
    decoder: Decoder,
    parts: Vec<u8>,
    now_us: u32,
}

impl Desk {
    fn new() -> Self {
        Self {
            sequence: 200,
            decoder: Decoder::new(),
            parts: Vec::new(),
            now_us: 0,
        }
    }

    /// The next message, as sent.
    fn frame(&mut self, message: &ToTarget<'_>) -> Vec<u8> {
        self.sequence = self.sequence.wrapping_add(1);
        let mut wire = [0; MAX_FRAME];
        frame::encode(self.sequence, message, &mut wire)
            .unwrap()
            .to_vec()
    }

    /// Bytes into the pilot, answers out of it, with their sequence numbers.
    fn deliver<const N: usize, const S: usize, const P: usize>(
        &mut self,
        pilot: &mut Pilot<N, S, P>,
        bytes: &[u8],
    ) -> Vec<(u8, Said)> {
        let mut back = Vec::new();
        for &byte in bytes {
            pilot.receive(byte, self.now_us, &mut |wire: &[u8]| {
                assert!(wire.len() <= MAX_FRAME && wire.ends_with(&[0]));
                back.extend_from_slice(wire);
            });
        }
        let mut said = Vec::new();
        for byte in back {
            let Some(frame) = self.decoder.push(byte) else {
                continue;
            };
            let frame = frame.expect("an answer is a sound frame");
            let answer = match frame.parse().expect("an answer is a message") {
                ToHost::Welcome {
                    token,
                    firmware,
                    ranges,
                    segments,
                    points,
                    record_bytes,
                } => {
                    assert_eq!(firmware, [0, 1, 0]);
                    let room = (
                        usize::from(ranges),
                        usize::from(segments),
                        usize::from(points),
                    );
                    assert_eq!(room, (N, S, P));
                    assert_eq!(usize::from(record_bytes), RECORD_BYTES);
                    Said::Welcome { token }
                }
                ToHost::State {
                    armed,
                    cause,
                    token,
                    tick,
                    uptime_ms,
                    ..
                } => Said::State {
                    armed,
                    cause,
                    token,
                    tick,
                    uptime_ms,
                },
                ToHost::Value { id, value } => Said::Value { id, value },
                ToHost::Ack => Said::Ack,
                ToHost::Refused { why } => Said::Refused(why),
                ToHost::RecordPart { part, bytes } => {
                    if part == 0 {
                        self.parts.clear();
                    }
                    self.parts.extend_from_slice(bytes);
                    let Ok(whole) = self.parts.as_slice().try_into() else {
                        continue;
                    };
                    Said::Record(Box::new(record::decode(whole).expect("a record")))
                }
            };
            said.push((frame.sequence, answer));
        }
        said
    }

    /// Asks over a clean wire; the one answer.
    fn ask<const N: usize, const S: usize, const P: usize>(
        &mut self,
        pilot: &mut Pilot<N, S, P>,
        message: &ToTarget<'_>,
    ) -> Said {
        let frame = self.frame(message);
        let mut said = self.deliver(pilot, &frame);
        assert_eq!(said.len(), 1, "{message:?}: {said:?}");
        let (sequence, answer) = said.remove(0);
        assert_eq!(sequence, self.sequence);
        answer
    }

    fn hello<const N: usize, const S: usize, const P: usize>(
        &mut self,
        pilot: &mut Pilot<N, S, P>,
        role: Role,
    ) -> u32 {
        self.ask(pilot, &ToTarget::Hello { nonce: 77, role })
            .token()
    }

    /// A path of one line.
    fn upload(&mut self, pilot: &mut Flown, length: i32) {
        let begin = ToTarget::PathBegin {
            form: PathForm::Segments,
            count: 1,
            closed: false,
            gaps: false,
        };
        let line = ToTarget::PathLine {
            index: 0,
            x: 0,
            y: 0,
            heading: 0,
            length,
        };
        for message in [begin, line, ToTarget::PathEnd] {
            assert_eq!(self.ask(pilot, &message), Said::Ack);
        }
    }

    /// A session, the path, the start, armed.
    fn fly(&mut self, pilot: &mut Flown, role: Role) {
        pilot
            .set_path(&Path::segments(&line(), false).unwrap())
            .unwrap();
        let token = self.hello(pilot, role);
        assert_eq!(self.ask(pilot, &BEGIN), Said::Ack);
        let armed = self.ask(pilot, &ToTarget::Arm { token });
        assert!(
            matches!(armed, Said::State { armed: true, .. }),
            "{armed:?}"
        );
    }
}

const BEGIN: ToTarget<'static> = ToTarget::Begin {
    x: 0,
    y: 0,
    heading: 0,
};

fn disarmed(pilot: &Flown) -> Cause {
    match pilot.state() {
        State::Disarmed(cause) => cause,
        State::Armed => panic!("armed"),
    }
}

// ---- the board ----

/// Wheels that remember what they were told, and may refuse.
#[derive(Default)]
struct Wheels {
    speed: [MetresPerSecond; 2],
    broken: bool,
}

impl Wheels {
    fn stand(&self) -> bool {
        self.speed == [MetresPerSecond::ZERO; 2]
    }
}

impl WheelDrive for Wheels {
    type Error = ();
    fn set_speed(&mut self, wheel: Side, speed: MetresPerSecond) -> Result<(), ()> {
        if self.broken {
            return Err(());
        }
        self.speed[wheel as usize] = speed;
        Ok(())
    }
}

struct Encoders(WheelCounts);

impl WheelEncoders for Encoders {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        Ok(self.0)
    }
}

struct Free;

impl RangeSensors for Free {
    fn read(&mut self, readings: &mut [RangeReading]) {
        readings.fill(RangeReading::fresh(Range::Clear));
    }
}

/// A board with its pilot.
struct Board {
    pilot: Flown,
    ports: Ports<Wheels, Encoders, Free>,
    now_us: u32,
}

impl Board {
    fn new() -> Self {
        let encoders = Encoders(WheelCounts { left: 0, right: 0 });
        let mut board = Self {
            pilot: new_pilot(),
            ports: Ports {
                drive: Wheels::default(),
                encoders,
                ranges: Free,
            },
            now_us: u32::MAX - 300_000,
        };
        board
            .pilot
            .set_path(&Path::segments(&line(), false).unwrap())
            .unwrap();
        board
    }

    /// A period goes by: the wheels roll, the pilot controls.
    fn period(&mut self) -> Option<TickRecord> {
        self.after(PERIOD_US)
    }

    fn after(&mut self, us: u32) -> Option<TickRecord> {
        self.now_us = self.now_us.wrapping_add(us);
        // A count is 2^-20 m, a speed step 2^-16 m/s: 16 counts a step and second.
        let rolled = |speed: MetresPerSecond| {
            (i64::from(speed.bits()) * 16 * i64::from(us) / 1_000_000) as i32
        };
        let [left, right] = self.ports.drive.speed.map(rolled);
        let counts = &mut self.ports.encoders.0;
        *counts = WheelCounts {
            left: counts.left + left,
            right: counts.right + right,
        };
        let record = self.pilot.control(self.now_us, &mut self.ports);
        if self.pilot.state() != State::Armed {
            assert!(self.ports.drive.broken || record.is_some() || self.ports.drive.stand());
        }
        record
    }
}

/// A board keeps it in a `static`, built while it compiles.
#[test]
fn a_pilot_may_be_a_static() {
    const HOME: Pose = Pose::new(Point::new(Metres::ZERO, Metres::ZERO), Angle::ZERO);
    static PILOT: Mutex<Flown> = Mutex::new(Pilot::new(presets::small_robot(), HOME));
    let pilot = PILOT.lock().unwrap();
    assert_eq!(disarmed(&pilot), Cause::Boot);
    assert_eq!(pilot.robot().params(), &presets::small_robot());
}

#[test]
fn a_robot_rests_until_its_button_is_pressed() {
    let mut board = Board::new();
    for _ in 0..20 {
        assert_eq!(board.period(), None);
        assert!(board.ports.drive.stand());
    }
    assert_eq!(disarmed(&board.pilot), Cause::Boot);
    assert_eq!(board.pilot.button(board.now_us), Ok(State::Armed));
    for tick in 0..10 {
        let record = board.period().expect("a tick");
        assert_eq!(record.tick, tick);
    }
    assert!(!board.ports.drive.stand());
    assert_eq!(
        board.pilot.button(board.now_us),
        Ok(State::Disarmed(Cause::Button))
    );
    assert_eq!(board.period(), None);
    assert!(board.ports.drive.stand());
    // Dead reckoning went on; the button begins anew at home.
    assert!(board.pilot.robot().pose().at.x > Metres::lit("0.05"));
    assert_eq!(board.pilot.button(board.now_us), Ok(State::Armed));
    assert_eq!(board.pilot.robot().pose(), Pose::default());
    assert_eq!(board.period().expect("a tick").tick, 0);
}

#[test]
fn the_end_of_the_path_disarms() {
    let mut board = Board::new();
    board.pilot.button(board.now_us).unwrap();
    let ticks = (0..400).take_while(|_| board.period().is_some()).count();
    assert_eq!(disarmed(&board.pilot), Cause::PathOver);
    assert!((60..300).contains(&ticks), "{ticks}");
    let gone = board.pilot.robot().pose().at.x - Metres::lit("3");
    assert!(gone.abs() < Metres::lit("0.05"), "{gone:?}");
}

#[test]
fn without_path_or_with_unsound_settings_nothing_is_armed() {
    let mut pilot = new_pilot();
    assert_eq!(pilot.button(0), Err(Why::NoPath));
    pilot
        .set_path(&Path::segments(&line(), false).unwrap())
        .unwrap();
    pilot.change_params(|params| params.guard.braking = I16F16::ZERO);
    assert_eq!(pilot.button(0), Err(Why::Setting { id: 81 }));
    assert_eq!(disarmed(&pilot), Cause::Boot);
}

#[test]
fn new_settings_or_a_new_path_disarm() {
    let mut board = Board::new();
    board.pilot.button(board.now_us).unwrap();
    board.pilot.change_params(|_| {});
    assert_eq!(disarmed(&board.pilot), Cause::SettingsChanged);
    board.pilot.button(board.now_us).unwrap();
    board
        .pilot
        .set_path(&Path::segments(&line(), false).unwrap())
        .unwrap();
    assert_eq!(disarmed(&board.pilot), Cause::SettingsChanged);
    let mut desk = Desk::new();
    desk.now_us = board.now_us;
    for change in 0..2 {
        let pilot = &mut board.pilot;
        desk.fly(pilot, Role::Monitor);
        desk.ask(pilot, &ToTarget::Stop);
        match change {
            0 => pilot.change_params(|_| {}),
            _ => pilot
                .set_path(&Path::segments(&line(), false).unwrap())
                .unwrap(),
        }
        let token = desk.ask(pilot, &ToTarget::Status).token();
        let said = desk.ask(pilot, &ToTarget::Arm { token });
        assert_eq!(said, Said::Refused(Why::NotBegun));
    }
    // In the middle of an upload: what comes of it is not put behind the new path.
    let points = ToTarget::PathBegin {
        form: PathForm::Points,
        count: 0,
        closed: false,
        gaps: false,
    };
    assert_eq!(desk.ask(&mut board.pilot, &points), Said::Ack);
    board
        .pilot
        .set_path(&Path::segments(&line(), false).unwrap())
        .unwrap();
    let said = desk.ask(&mut board.pilot, &ToTarget::PathEnd);
    assert_eq!(said, Said::Refused(Why::OutOfSequence { expected: 0 }));
    let long = [line()[0]; 5];
    let path = Path::segments_with_gaps(&long, false).unwrap();
    assert!(board.pilot.set_path(&path).is_err());
    assert_eq!(board.pilot.button(board.now_us), Err(Why::NoPath));
}

#[test]
fn an_emergency_stop_holds() {
    let mut board = Board::new();
    board.pilot.emergency(true);
    assert_eq!(board.pilot.button(board.now_us), Err(Why::Emergency));
    board.pilot.emergency(false);
    board.pilot.button(board.now_us).unwrap();
    board.period().expect("a tick");
    board.pilot.emergency(true);
    assert_eq!(disarmed(&board.pilot), Cause::Emergency);
    assert_eq!(board.period(), None);
    assert!(board.ports.drive.stand());
    // Released, it does not go on by itself.
    board.pilot.emergency(false);
    assert_eq!(board.period(), None);
}

#[test]
fn a_drive_that_does_not_obey_disarms_until_it_does() {
    let mut board = Board::new();
    board.pilot.button(board.now_us).unwrap();
    board.period().expect("a tick");
    board.ports.drive.broken = true;
    assert!(board.period().expect("a tick").drive_fault);
    assert_eq!(disarmed(&board.pilot), Cause::DriveFault);
    board.period();
    assert_eq!(board.pilot.button(board.now_us), Err(Why::DriveFault));
    board.ports.drive.broken = false;
    board.period();
    assert_eq!(board.pilot.button(board.now_us), Ok(State::Armed));
}

#[test]
fn a_control_loop_that_stood_still_disarms() {
    let mut board = Board::new();
    board.pilot.button(board.now_us).unwrap();
    board.period().expect("a tick");
    assert!(board.after(GRACE_US).is_some());
    assert_eq!(board.after(GRACE_US + 1), None);
    assert_eq!(disarmed(&board.pilot), Cause::Overrun);
    assert!(board.ports.drive.stand());
}

#[test]
fn what_reset_the_board_is_told() {
    for cause in [
        Cause::Brownout,
        Cause::Watchdog,
        Cause::Panic,
        Cause::HardFault,
    ] {
        let mut board = Board::new();
        board.pilot.fault(cause);
        let said = Desk::new().ask(&mut board.pilot, &ToTarget::Status);
        assert!(matches!(said, Said::State { armed: false, cause: told, .. } if told == cause));
        board.pilot.button(board.now_us).unwrap();
        board.pilot.fault(cause);
        assert_eq!(disarmed(&board.pilot), cause);
    }
}

// ---- a monitor ----

#[test]
fn a_silent_monitor_stops_nothing_and_a_stop_always_does() {
    let mut board = Board::new();
    let mut desk = Desk::new();
    desk.now_us = board.now_us;
    desk.fly(&mut board.pilot, Role::Monitor);
    for _ in 0..2 * SILENCE_US / PERIOD_US {
        if board.period().is_none() {
            break;
        }
    }
    assert_eq!(disarmed(&board.pilot), Cause::PathOver);

    board.pilot.button(board.now_us).unwrap();
    let last = board.period().expect("a tick");
    assert_eq!(desk.ask(&mut board.pilot, &ToTarget::Record).record(), last);
    // Its sequence number is of the past: a stop is a stop.
    desk.sequence = desk.sequence.wrapping_sub(9);
    let said = desk.ask(&mut board.pilot, &ToTarget::Stop);
    assert!(matches!(
        said,
        Said::State {
            armed: false,
            cause: Cause::StopCommand,
            ..
        }
    ));
    assert_eq!(board.period(), None);
    assert!(board.ports.drive.stand());
    // Nor did it make old frames new; how it is, it tells always.
    assert_eq!(
        desk.ask(&mut board.pilot, &ToTarget::Get { id: 1 }),
        Said::Refused(Why::Replayed)
    );
    let said = desk.ask(&mut board.pilot, &ToTarget::Status);
    assert!(matches!(said, Said::State { armed: false, .. }), "{said:?}");
    assert_eq!(
        desk.ask(&mut board.pilot, &ToTarget::Get { id: 1 }),
        Said::Refused(Why::Replayed)
    );
}

#[test]
fn the_very_same_stop_stops_again() {
    let mut board = Board::new();
    let mut desk = Desk::new();
    desk.hello(&mut board.pilot, Role::Monitor);
    let stop = desk.frame(&ToTarget::Stop);
    desk.deliver(&mut board.pilot, &stop);
    board.pilot.button(board.now_us).unwrap();
    assert_eq!(board.pilot.state(), State::Armed);
    let said = desk.deliver(&mut board.pilot, &stop);
    assert!(
        matches!(said[..], [(_, Said::State { armed: false, .. })]),
        "{said:?}"
    );
    assert_eq!(disarmed(&board.pilot), Cause::StopCommand);
    assert_eq!(board.period(), None);
    assert!(board.ports.drive.stand());
    // Its number is taken all the same.
    let get = ToTarget::Get { id: 45 };
    let said = desk.ask(&mut board.pilot, &get);
    assert!(matches!(said, Said::Value { .. }), "{said:?}");
}

#[test]
fn a_period_that_the_board_cannot_keep_is_refused_by_its_own_clock() {
    let refused = Err(Why::Setting {
        id: settings::PERIOD,
    });
    for (millis, kept) in [
        (5_i64, true),
        (20, true),
        (50, true),
        (100, true),
        (7, false),
        (12, false),
        (105, false),
        (1000, false),
    ] {
        let mut board = Board::new();
        board.pilot.keep(Cadence {
            step_us: 5_000,
            longest_us: 100_000,
        });
        board.pilot.change_params(|params| {
            params.period = Seconds::from_bits(((millis << 24) / 1000) as i32);
        });
        let pressed = board.pilot.button(board.now_us).map(|_| ());
        assert_eq!(pressed, if kept { Ok(()) } else { refused }, "{millis} ms");
        let mut desk = Desk::new();
        desk.hello(&mut board.pilot, Role::Monitor);
        let begun = desk.ask(&mut board.pilot, &BEGIN);
        assert_eq!(begun == Said::Ack, kept, "{millis} ms: {begun:?}");
        // In lock-step the clock is the desktop's.
        desk.hello(&mut board.pilot, Role::Lockstep);
        assert_eq!(desk.ask(&mut board.pilot, &BEGIN), Said::Ack);
    }
}

#[test]
fn a_stop_needs_no_session() {
    let mut board = Board::new();
    board.pilot.button(board.now_us).unwrap();
    let said = Desk::new().ask(&mut board.pilot, &ToTarget::Stop);
    assert!(matches!(
        said,
        Said::State {
            armed: false,
            cause: Cause::StopCommand,
            ..
        }
    ));
}

#[test]
fn a_new_session_disarms() {
    for role in [Role::Monitor, Role::Lockstep] {
        let mut board = Board::new();
        board.pilot.button(board.now_us).unwrap();
        Desk::new().hello(&mut board.pilot, role);
        assert_eq!(disarmed(&board.pilot), Cause::NewSession);
    }
}

#[test]
fn without_a_session_only_hello_stop_and_status_are_heard() {
    let mut pilot = new_pilot();
    let mut desk = Desk::new();
    assert!(matches!(
        desk.ask(&mut pilot, &ToTarget::Status),
        Said::State { .. }
    ));
    for message in [
        ToTarget::Get { id: 1 },
        ToTarget::Set { id: 1, value: 1 },
        BEGIN,
        ToTarget::PathEnd,
        ToTarget::Arm { token: 0 },
        ToTarget::Record,
    ] {
        let said = desk.ask(&mut pilot, &message);
        assert_eq!(said, Said::Refused(Why::NoSession), "{message:?}");
    }
}

#[test]
fn settings_are_changed_while_disarmed_and_checked_at_begin() {
    let mut board = Board::new();
    let pilot = &mut board.pilot;
    let mut desk = Desk::new();
    let token = desk.hello(pilot, Role::Monitor);
    let id = settings::id_of("follower.approach_gain").unwrap();
    assert_eq!(
        desk.ask(pilot, &ToTarget::Get { id }),
        Said::Value { id, value: 2 << 16 }
    );
    assert_eq!(desk.ask(pilot, &BEGIN), Said::Ack);
    assert_eq!(
        desk.ask(pilot, &ToTarget::Set { id, value: 3 << 16 }),
        Said::Ack
    );
    assert_eq!(
        desk.ask(pilot, &ToTarget::Get { id }),
        Said::Value { id, value: 3 << 16 }
    );
    // Changed since they were checked.
    assert_eq!(
        desk.ask(pilot, &ToTarget::Arm { token }),
        Said::Refused(Why::NotBegun)
    );
    assert_eq!(desk.ask(pilot, &ToTarget::Set { id, value: 0 }), Said::Ack);
    assert_eq!(desk.ask(pilot, &BEGIN), Said::Refused(Why::Setting { id }));
    assert_eq!(
        desk.ask(pilot, &ToTarget::Arm { token }),
        Said::Refused(Why::NotBegun)
    );
    assert_eq!(
        desk.ask(pilot, &ToTarget::Set { id, value: 3 << 16 }),
        Said::Ack
    );
    let law = settings::id_of("follower.law").unwrap();
    let refused = desk.ask(pilot, &ToTarget::Set { id: law, value: 2 });
    assert_eq!(refused, Said::Refused(Why::Setting { id: law }));
    for message in [ToTarget::Get { id: 9 }, ToTarget::Set { id: 9, value: 0 }] {
        assert_eq!(
            desk.ask(pilot, &message),
            Said::Refused(Why::UnknownId { id: 9 })
        );
    }
    assert_eq!(desk.ask(pilot, &BEGIN), Said::Ack);
    desk.ask(pilot, &ToTarget::Arm { token });
    for message in [
        ToTarget::Set { id, value: 1 },
        BEGIN,
        ToTarget::PathBegin {
            form: PathForm::Points,
            count: 2,
            closed: false,
            gaps: false,
        },
    ] {
        let said = desk.ask(pilot, &message);
        assert_eq!(said, Said::Refused(Why::NotDisarmed), "{message:?}");
    }
    assert_eq!(pilot.state(), State::Armed);
    assert_eq!(
        desk.ask(pilot, &ToTarget::Get { id }),
        Said::Value { id, value: 3 << 16 }
    );
}

#[test]
fn arming_takes_the_newest_token() {
    let mut board = Board::new();
    let pilot = &mut board.pilot;
    let mut desk = Desk::new();
    let first = desk.hello(pilot, Role::Monitor);
    let second = desk.hello(pilot, Role::Monitor);
    assert_eq!(desk.ask(pilot, &BEGIN), Said::Ack);
    for token in [first, second ^ 1, 0] {
        assert_eq!(
            desk.ask(pilot, &ToTarget::Arm { token }),
            Said::Refused(Why::Token)
        );
    }
    let arm = desk.frame(&ToTarget::Arm { token: second });
    let armed = desk.deliver(pilot, &arm).remove(0).1;
    assert_eq!(pilot.state(), State::Armed);
    assert_ne!(armed.token(), second);
    // Arming and disarming renew it; and the frame that armed does not arm again, not even at once.
    let stopped = desk.ask(pilot, &ToTarget::Stop);
    assert_eq!(desk.deliver(pilot, &arm)[0].1, Said::Refused(Why::Replayed));
    for token in [second, armed.token()] {
        assert_eq!(
            desk.ask(pilot, &ToTarget::Arm { token }),
            Said::Refused(Why::Token)
        );
    }
    assert_eq!(disarmed(pilot), Cause::StopCommand);
    desk.ask(
        pilot,
        &ToTarget::Arm {
            token: stopped.token(),
        },
    );
    assert_eq!(pilot.state(), State::Armed);
}

/// A whole recorded session, played back at another time, arms nothing.
#[test]
fn a_session_played_back_arms_nothing() {
    let mut board = Board::new();
    let mut desk = Desk::new();
    let mut tape = Vec::new();
    let hello = desk.frame(&ToTarget::Hello {
        nonce: 5,
        role: Role::Monitor,
    });
    let token = desk.deliver(&mut board.pilot, &hello)[0].1.token();
    tape.extend(hello);
    for message in [BEGIN, ToTarget::Arm { token }] {
        let frame = desk.frame(&message);
        desk.deliver(&mut board.pilot, &frame);
        tape.extend(frame);
    }
    assert_eq!(board.pilot.state(), State::Armed);
    for fresh in [false, true] {
        if fresh {
            board = Board::new();
        }
        desk.now_us += 1_234_567;
        desk.deliver(&mut board.pilot, &tape);
        assert_ne!(board.pilot.state(), State::Armed);
    }
}

#[test]
fn a_repeated_frame_is_answered_and_not_acted_upon_again() {
    let mut board = Board::new();
    let pilot = &mut board.pilot;
    let mut desk = Desk::new();
    let hello = desk.frame(&ToTarget::Hello {
        nonce: 1,
        role: Role::Monitor,
    });
    let welcome = desk.deliver(pilot, &hello);
    desk.now_us += 5;
    assert_eq!(desk.deliver(pilot, &hello), welcome);
    let begin = ToTarget::PathBegin {
        form: PathForm::Segments,
        count: 2,
        closed: false,
        gaps: false,
    };
    assert_eq!(desk.ask(pilot, &begin), Said::Ack);
    let first = ToTarget::PathLine {
        index: 0,
        x: 0,
        y: 0,
        heading: 0,
        length: 1 << 16,
    };
    let frame = desk.frame(&first);
    let said = desk.deliver(pilot, &frame);
    assert_eq!(said[0].1, Said::Ack);
    assert_eq!(desk.deliver(pilot, &frame), said);
    // Stored once: the second piece is due.
    let refused = desk.ask(pilot, &first);
    assert_eq!(refused, Said::Refused(Why::OutOfSequence { expected: 1 }));
    // Another frame under the same number is not the same frame.
    desk.sequence = desk.sequence.wrapping_sub(1);
    assert_eq!(
        desk.ask(pilot, &ToTarget::PathEnd),
        Said::Refused(Why::Replayed)
    );
    // Repeated later, it is of the past.
    assert_eq!(
        desk.deliver(pilot, &frame)[0].1,
        Said::Refused(Why::Replayed)
    );
}

#[test]
fn up_to_31_lost_frames_are_bridged() {
    let mut pilot = new_pilot();
    let mut desk = Desk::new();
    desk.hello(&mut pilot, Role::Monitor);
    desk.sequence = desk.sequence.wrapping_add(31);
    let get = ToTarget::Get { id: 45 };
    let said = desk.ask(&mut pilot, &get);
    assert!(matches!(said, Said::Value { .. }), "{said:?}");
    desk.sequence = desk.sequence.wrapping_add(32);
    let said = desk.ask(&mut pilot, &get);
    assert_eq!(said, Said::Refused(Why::Replayed));
    // A hello begins anew with any number.
    desk.hello(&mut pilot, Role::Monitor);
    let said = desk.ask(&mut pilot, &get);
    assert!(matches!(said, Said::Value { .. }), "{said:?}");
}

#[test]
fn a_path_comes_piece_by_piece() {
    let mut pilot = new_pilot();
    let pilot = &mut pilot;
    let mut desk = Desk::new();
    desk.hello(pilot, Role::Monitor);
    let begin = |form, count, closed| ToTarget::PathBegin {
        form,
        count,
        closed,
        gaps: false,
    };
    let point = |index, x| ToTarget::PathPoint {
        index,
        x: x << 16,
        y: 0,
        heading: 0,
    };
    let out_of_sequence = |expected| Said::Refused(Why::OutOfSequence { expected });

    assert_eq!(desk.ask(pilot, &BEGIN), Said::Refused(Why::NoPath));
    assert_eq!(desk.ask(pilot, &point(0, 0)), out_of_sequence(0));
    assert_eq!(desk.ask(pilot, &ToTarget::PathEnd), out_of_sequence(0));
    let too_many = |most| Said::Refused(Why::TooMany { most });
    assert_eq!(
        desk.ask(pilot, &begin(PathForm::Points, 7, false)),
        too_many(6)
    );
    assert_eq!(
        desk.ask(pilot, &begin(PathForm::Segments, 5, false)),
        too_many(4)
    );

    assert_eq!(
        desk.ask(pilot, &begin(PathForm::Points, 3, true)),
        Said::Ack
    );
    assert_eq!(desk.ask(pilot, &point(1, 0)), out_of_sequence(0));
    assert_eq!(desk.ask(pilot, &point(0, 0)), Said::Ack);
    let arc = ToTarget::PathArc {
        index: 1,
        x: 0,
        y: 0,
        radius: 1 << 16,
        from: 0,
        sweep: 1 << 22,
    };
    assert_eq!(desk.ask(pilot, &arc), out_of_sequence(1));
    assert_eq!(desk.ask(pilot, &point(1, 1)), Said::Ack);
    assert_eq!(desk.ask(pilot, &ToTarget::PathEnd), out_of_sequence(2));
    assert_eq!(desk.ask(pilot, &BEGIN), Said::Refused(Why::NoPath));
    assert_eq!(desk.ask(pilot, &point(2, 2)), Said::Ack);
    assert_eq!(desk.ask(pilot, &point(3, 3)), too_many(3));
    assert_eq!(desk.ask(pilot, &ToTarget::PathEnd), Said::Ack);
    assert_eq!(desk.ask(pilot, &ToTarget::PathEnd), out_of_sequence(0));
    let path = pilot.path().expect("a path");
    assert_eq!((path.length(), path.is_closed()), (Metres::lit("4"), true));
    let token = desk.ask(pilot, &ToTarget::Status).token();
    let arm = ToTarget::Arm { token };
    assert_eq!(desk.ask(pilot, &arm), Said::Refused(Why::NotBegun));
    assert_eq!(desk.ask(pilot, &BEGIN), Said::Ack);

    // Pieces that are no path.
    let fault = |error| Said::Refused(Why::Path { error });
    assert_eq!(
        desk.ask(pilot, &begin(PathForm::Points, 2, false)),
        Said::Ack
    );
    assert_eq!(desk.ask(pilot, &BEGIN), Said::Refused(Why::NoPath));
    for index in 0..2 {
        assert_eq!(desk.ask(pilot, &point(index, 5)), Said::Ack);
    }
    let degenerate = fault(PathFault::Degenerate { piece: 0 });
    assert_eq!(desk.ask(pilot, &ToTarget::PathEnd), degenerate);
    assert_eq!(
        desk.ask(pilot, &begin(PathForm::Points, 0, false)),
        Said::Ack
    );
    assert_eq!(
        desk.ask(pilot, &ToTarget::PathEnd),
        fault(PathFault::TooShort)
    );

    let line = |index, x| ToTarget::PathLine {
        index,
        x: x << 16,
        y: 0,
        heading: 0,
        length: 1 << 16,
    };
    for gaps in [false, true] {
        let begin = ToTarget::PathBegin {
            form: PathForm::Segments,
            count: 3,
            closed: false,
            gaps,
        };
        assert_eq!(desk.ask(pilot, &begin), Said::Ack);
        for message in [line(0, 0), line(1, 1), line(2, 3)] {
            assert_eq!(desk.ask(pilot, &message), Said::Ack);
        }
        let expected = if gaps {
            Said::Ack
        } else {
            fault(PathFault::Gap { piece: 2 })
        };
        assert_eq!(desk.ask(pilot, &ToTarget::PathEnd), expected);
        // Begun with the path before, not with this one.
        let token = desk.ask(pilot, &ToTarget::Status).token();
        let arm = ToTarget::Arm { token };
        assert_eq!(desk.ask(pilot, &arm), Said::Refused(Why::NotBegun));
        assert_eq!(desk.ask(pilot, &BEGIN) == Said::Ack, gaps);
    }
    let begin = ToTarget::PathBegin {
        form: PathForm::Segments,
        count: 1,
        closed: true,
        gaps: false,
    };
    assert_eq!(desk.ask(pilot, &begin), Said::Ack);
    let circle = ToTarget::PathArc {
        index: 0,
        x: 0,
        y: 0,
        radius: 1 << 16,
        from: 7,
        sweep: 1 << 24,
    };
    assert_eq!(desk.ask(pilot, &circle), Said::Ack);
    assert_eq!(desk.ask(pilot, &ToTarget::PathEnd), Said::Ack);
    let expected = [Segment::Arc {
        centre: Point::default(),
        radius: Metres::lit("1"),
        from: Angle::from_bits(7),
        sweep: 1 << 24,
    }];
    assert_eq!(pilot.path(), Path::segments(&expected, true).ok());
}

#[test]
fn another_version_is_told_so() {
    let mut pilot = new_pilot();
    let mut desk = Desk::new();
    // Version 2, sequence number 10, message 1; the CRC is Python's zlib.crc32(bytes([2, 10, 1])).
    let wire = [8, 2, 10, 1, 0x60, 0xd5, 0x2d, 0x71, 0];
    assert_eq!(
        desk.deliver(&mut pilot, &wire),
        [(10, Said::Refused(Why::Version))]
    );
    assert_eq!(pilot.counters().version, 1);
}

#[test]
fn roles_have_their_own_messages() {
    let mut pilot = new_pilot();
    let mut desk = Desk::new();
    desk.hello(&mut pilot, Role::Monitor);
    let mut room = [0; MAX_READINGS];
    let (readings, _) = Readings::pack(&[RangeReading::NEVER_SEEN], &mut room);
    let counts = Counts::Known { left: 0, right: 0 };
    for message in [
        ToTarget::Ranges {
            scan: 0,
            first: 0,
            readings,
        },
        ToTarget::Inputs {
            tick: 0,
            time_us: 0,
            scan: 0,
            counts,
        },
    ] {
        assert_eq!(desk.ask(&mut pilot, &message), Said::Refused(Why::Role));
    }
    assert_eq!(
        desk.ask(&mut pilot, &ToTarget::Record),
        Said::Refused(Why::NoRecord)
    );
    desk.hello(&mut pilot, Role::Lockstep);
    assert_eq!(pilot.button(0), Err(Why::Role));
}

// ---- lock-step ----

/// A plant on the desktop: wheels that obey at once, sensors that see anything.
struct Plant {
    dice: Dice,
    time_us: u32,
    scan: u8,
    counts: WheelCounts,
    readings: [RangeReading; RING],
}

impl Plant {
    fn new(seed: u64) -> Self {
        Self {
            dice: Dice(seed),
            time_us: 4_294_000_000,
            scan: 250,
            counts: WheelCounts { left: 5, right: -5 },
            readings: [RangeReading::NEVER_SEEN; RING],
        }
    }

    /// A period on: the wheels roll as commanded, the sensors look.
    fn period(&mut self, speeds: [MetresPerSecond; 2]) {
        self.time_us = self.time_us.wrapping_add(PERIOD_US);
        self.scan = self.scan.wrapping_add(1);
        let [left, right] = speeds.map(|speed| speed.bits() * 16 / 20);
        self.counts.left = self.counts.left.wrapping_add(left);
        self.counts.right = self.counts.right.wrapping_add(right);
        for reading in &mut self.readings {
            let range = match self.dice.below(8) {
                0 => Range::Invalid(Fault::Bus),
                1..5 => Range::Clear,
                _ => Range::Echo(Metres::from_bits(30_000 + self.dice.below(120_000) as i32)),
            };
            let age = Seconds::from_bits(self.dice.below(2) as i32 * 1_000_000);
            *reading = RangeReading { range, age };
        }
    }

    /// The frames of one tick: the ring, then what triggers it.
    fn frames(&self, desk: &mut Desk, tick: u32) -> Vec<Vec<u8>> {
        let mut frames = Vec::new();
        let mut first = 0;
        while first < RING {
            let mut room = [0; MAX_READINGS];
            let (readings, count) = Readings::pack(&self.readings[first..], &mut room);
            // Two frames at least, so that one of them can be lost.
            let (readings, count) = match count {
                RING => Readings::pack(&self.readings[first..first + 5], &mut room),
                _ => (readings, count),
            };
            let ranges = ToTarget::Ranges {
                scan: self.scan,
                first: first as u8,
                readings,
            };
            frames.push(desk.frame(&ranges));
            first += count;
        }
        assert!(frames.len() >= 2);
        frames.push(desk.frame(&self.inputs(tick)));
        frames
    }

    fn inputs(&self, tick: u32) -> ToTarget<'static> {
        ToTarget::Inputs {
            tick,
            time_us: self.time_us,
            scan: self.scan,
            counts: Ok(self.counts).into(),
        }
    }
}

/// The same tick without a link.
struct Direct {
    robot: Robot<RING>,
    segments: [Segment; 1],
}

impl Direct {
    fn new() -> Self {
        let robot = Robot::new(presets::small_robot(), Pose::default());
        Self {
            robot,
            segments: line(),
        }
    }

    fn tick(&mut self, counts: WheelCounts, readings: &[RangeReading; RING]) -> TickRecord {
        let path = Path::segments(&self.segments, false).unwrap();
        let mut ports = Ports {
            drive: Wheels::default(),
            encoders: Encoders(counts),
            ranges: Seen(*readings),
        };
        self.robot.tick(&path, &mut ports)
    }
}

struct Seen([RangeReading; RING]);

impl RangeSensors for Seen {
    fn read(&mut self, readings: &mut [RangeReading]) {
        readings.copy_from_slice(&self.0);
    }
}

/// A lock-step session with the same robot beside it.
struct Bench {
    pilot: Flown,
    desk: Desk,
    plant: Plant,
    direct: Direct,
    speeds: [MetresPerSecond; 2],
    tick: u32,
}

impl Bench {
    fn new() -> Self {
        let mut bench = Self {
            pilot: new_pilot(),
            desk: Desk::new(),
            plant: Plant::new(1),
            direct: Direct::new(),
            speeds: [MetresPerSecond::ZERO; 2],
            tick: 0,
        };
        bench.desk.fly(&mut bench.pilot, Role::Lockstep);
        bench
    }

    /// Frames to the pilot, answers back.
    fn send(&mut self, frames: &[Vec<u8>]) -> Vec<Said> {
        self.desk.now_us = self.desk.now_us.wrapping_add(3_000);
        let said = frames
            .iter()
            .flat_map(|frame| self.desk.deliver(&mut self.pilot, frame));
        said.map(|(_, said)| said).collect()
    }

    /// The record of a tick must be that of the robot without a link.
    fn compare(&mut self, record: &TickRecord, readings: &[RangeReading; RING]) {
        let direct = self.direct.tick(self.plant.counts, readings);
        assert_eq!(
            record::encode(record),
            record::encode(&direct),
            "{record:#?} {direct:#?}"
        );
        self.speeds = [record.wheels.left, record.wheels.right];
        self.tick += 1;
    }

    /// A period of the plant, its frames changed by `pipe` on their way, the answers.
    fn period(&mut self, pipe: impl FnOnce(Vec<Vec<u8>>) -> Vec<Vec<u8>>) -> Vec<Said> {
        self.plant.period(self.speeds);
        let frames = self.plant.frames(&mut self.desk, self.tick);
        self.send(&pipe(frames))
    }

    /// A period without faults.
    fn clean(&mut self) {
        let mut said = self.period(|frames| frames);
        assert_eq!(said.len(), 1, "{said:?}");
        let readings = self.plant.readings;
        self.compare(&said.remove(0).record(), &readings);
    }

    /// Arms anew, after the fault; how many frames it takes.
    fn recover(&mut self) -> usize {
        let status = self.desk.ask(&mut self.pilot, &ToTarget::Status);
        assert!(matches!(status, Said::State { armed: false, .. }));
        // Armed again, but no tick came: the stale ones command nothing.
        let armed = self.desk.ask(
            &mut self.pilot,
            &ToTarget::Arm {
                token: status.token(),
            },
        );
        assert!(
            matches!(armed, Said::State { armed: true, .. }),
            "{armed:?}"
        );
        2
    }
}

const MISSING: RangeReading = RangeReading::fresh(Range::Invalid(Fault::Timeout));

#[test]
fn lock_step_is_the_tick_bit_for_bit() {
    let mut bench = Bench::new();
    for _ in 0..2_000 {
        bench.clean();
    }
    assert_eq!(bench.pilot.state(), State::Armed);
    // The session ends, another begins with the same plant: the same again.
    bench.desk.fly(&mut bench.pilot, Role::Lockstep);
    bench.direct = Direct::new();
    bench.tick = 0;
    for _ in 0..50 {
        bench.clean();
    }
}

#[test]
fn encoder_faults_come_through() {
    let mut bench = Bench::new();
    bench.clean();
    bench.plant.period(bench.speeds);
    let counts = Counts::Unknown {
        fault: PortFault::Bus,
    };
    let (time_us, scan) = (bench.plant.time_us, bench.plant.scan);
    let inputs = ToTarget::Inputs {
        tick: 1,
        time_us,
        scan,
        counts,
    };
    let record = bench.desk.ask(&mut bench.pilot, &inputs).record();
    assert_eq!(record.valid_ranges, 0);
    let State::Armed = bench.pilot.state() else {
        panic!("disarmed")
    };
}

#[test]
fn the_boards_own_wheels_stand_in_lock_step() {
    let mut board = Board::new();
    let mut bench = Bench::new();
    std::mem::swap(&mut board.pilot, &mut bench.pilot);
    board.ports.drive.speed = [MetresPerSecond::lit("1"); 2];
    assert_eq!(board.period(), None);
    assert!(board.ports.drive.stand());
    assert_eq!(board.pilot.state(), State::Armed);
}

/// Every frame twice: each tick is driven once, and its record comes twice.
#[test]
fn repeated_frames_do_not_tick_twice() {
    let mut bench = Bench::new();
    for _ in 0..100 {
        let said = bench.period(|frames| frames.into_iter().flat_map(|f| [f.clone(), f]).collect());
        let [Said::Record(first), Said::Record(second)] = said.as_slice() else {
            panic!("{said:?}");
        };
        assert_eq!(first, second);
        let (record, readings) = ((**first).clone(), bench.plant.readings);
        bench.compare(&record, &readings);
    }
}

/// A lost reading is missing, whatever stood there before; the rest of the tick is as always.
#[test]
fn lost_ranges_are_missing_and_never_old() {
    let mut bench = Bench::new();
    for round in 0..100 {
        let lost = round % 2;
        let mut first = 0;
        let said = bench.period(|mut frames| {
            first = if lost == 0 { 0 } else { 5.min(RING) };
            frames.remove(lost);
            frames
        });
        let [Said::Record(record)] = said.as_slice() else {
            panic!("{said:?}")
        };
        // Which of them were in the lost frame.
        let mut room = [0; MAX_READINGS];
        let fits = Readings::pack(&bench.plant.readings, &mut room).1;
        let split = if fits == RING { 5 } else { fits };
        let range = if lost == 0 { 0..split } else { split..RING };
        let mut readings = bench.plant.readings;
        readings[range].fill(MISSING);
        bench.compare(&record.clone(), &readings);
        bench.clean();
    }
    assert_eq!(bench.pilot.state(), State::Armed);
}

/// Ranges that come after their inputs are of the past; before the next tick's they would be another scan's.
#[test]
fn reordered_ranges_are_missing() {
    let mut bench = Bench::new();
    for _ in 0..50 {
        let said = bench.period(|mut frames| {
            frames.rotate_right(1);
            frames
        });
        assert!(matches!(said[0], Said::Record(_)), "{said:?}");
        assert!(
            said[1..]
                .iter()
                .all(|said| *said == Said::Refused(Why::Replayed))
        );
        let record = said[0].clone().record();
        bench.compare(&record, &[MISSING; RING]);
        bench.clean();
    }
}

/// Readings of a tick that never came are not taken for the next one's.
#[test]
fn a_scan_belongs_to_its_inputs() {
    let mut bench = Bench::new();
    bench.clean();
    // The inputs are lost, and the desktop does not send them again but goes on, without readings.
    bench.period(|mut frames| {
        frames.pop();
        frames
    });
    bench.plant.period(bench.speeds);
    let inputs = bench.plant.inputs(bench.tick);
    let record = bench.desk.ask(&mut bench.pilot, &inputs).record();
    bench.compare(&record, &[MISSING; RING]);
    // Nor are those of a tick that came, should the next one carry the same number.
    bench.clean();
    let scan = bench.plant.scan;
    bench.plant.period(bench.speeds);
    bench.plant.scan = scan;
    let inputs = bench.plant.inputs(bench.tick);
    let record = bench.desk.ask(&mut bench.pilot, &inputs).record();
    bench.compare(&record, &[MISSING; RING]);
}

/// A lost or corrupt trigger that is sent again: nobody notices.
#[test]
fn inputs_sent_again_make_good() {
    let mut bench = Bench::new();
    for round in 0..60 {
        let said = bench.period(|mut frames| {
            let inputs = frames.pop().unwrap();
            let mut damaged = inputs.clone();
            match round % 3 {
                0 => damaged.clear(),
                1 => damaged[4] ^= 0x40,
                _ => damaged.truncate(5),
            }
            // An own terminator ends what the damaged one left.
            frames.extend([damaged, vec![0], inputs]);
            frames
        });
        let record = said.last().cloned().expect("an answer").record();
        let readings = bench.plant.readings;
        bench.compare(&record, &readings);
    }
    let counters = bench.pilot.counters();
    assert!(counters.truncated + counters.corrupt >= 40, "{counters:?}");
}

#[test]
fn missing_inputs_disarm() {
    for (skipped, cause) in [
        (3, None),
        (4, Some(Cause::LinkTimeout)),
        (400, Some(Cause::LinkTimeout)),
    ] {
        let mut bench = Bench::new();
        for _ in 0..20 {
            bench.clean();
        }
        for _ in 0..skipped {
            bench.plant.period(bench.speeds);
        }
        let said = bench.period(|frames| frames);
        match cause {
            // As long as it is within the grace, one tick takes the place of all.
            None => assert!(matches!(said.as_slice(), [Said::Record(_)]), "{said:?}"),
            Some(cause) => {
                assert_eq!(disarmed(&bench.pilot), cause);
                // The next inputs do not drive either.
                let said = bench.period(|frames| frames);
                assert!(
                    matches!(said[0], Said::State { armed: false, .. }),
                    "{said:?}"
                );
                assert!(bench.recover() <= 5);
                let said = bench.period(|frames| frames);
                // Where the wheels rolled to was not lost: the pose is that of a robot which ticked on.
                assert_eq!(said.len(), 1);
                let record = said[0].clone().record();
                assert_eq!(record.tick, 20);
                let travelled = bench.plant.counts.left - 5;
                let expected = Metres::from_bits(travelled / 16);
                assert!((record.pose.at.x - expected).abs() < Metres::lit("0.02") || skipped > 50);
            }
        }
    }
}

#[test]
fn inputs_out_of_sequence_disarm() {
    type Change = fn(&mut Bench);
    let changes: [(&str, Change); 4] = [
        ("a tick left out", |bench| bench.tick += 1),
        ("a tick again", |bench| bench.tick -= 1),
        ("no time", |bench| bench.plant.time_us -= PERIOD_US),
        ("time back", |bench| bench.plant.time_us -= 2 * PERIOD_US),
    ];
    for (what, change) in changes {
        let mut bench = Bench::new();
        bench.clean();
        bench.clean();
        change(&mut bench);
        let said = bench.period(|frames| frames);
        assert!(
            matches!(
                said[0],
                Said::State {
                    armed: false,
                    cause: Cause::Sequence,
                    ..
                }
            ),
            "{what}"
        );
        bench.recover();
    }
}

#[test]
fn a_lock_step_session_that_falls_silent_is_over() {
    let mut board = Board::new();
    let mut bench = Bench::new();
    bench.clean();
    std::mem::swap(&mut board.pilot, &mut bench.pilot);
    board.now_us = bench.desk.now_us;
    let mut periods = 0;
    while board.pilot.role() == Role::Lockstep && periods < 1_000 {
        assert_eq!(board.period(), None);
        periods += 1;
    }
    assert_eq!(periods, SILENCE_US / PERIOD_US + 1);
    assert_eq!(disarmed(&board.pilot), Cause::LinkTimeout);
    // The desktop comes back and is told; the robot is its own again.
    std::mem::swap(&mut board.pilot, &mut bench.pilot);
    let said = bench.period(|mut frames| frames.split_off(frames.len() - 1));
    assert_eq!(said, [Said::Refused(Why::NoSession)]);
    std::mem::swap(&mut board.pilot, &mut bench.pilot);
    assert_eq!(board.pilot.robot().pose(), Pose::default());
    bench.desk.now_us = board.now_us;
    bench.desk.hello(&mut board.pilot, Role::Monitor);
    let said = bench.desk.ask(&mut board.pilot, &ToTarget::Record);
    assert_eq!(said, Said::Refused(Why::NoRecord));
    assert_foreign(&mut board, &mut bench.desk);
}

/// Nothing makes the robot drive with what a plant has left; its own settings and path do.
fn assert_foreign(board: &mut Board, desk: &mut Desk) {
    let begin = |board: &mut Board, desk: &mut Desk| desk.ask(&mut board.pilot, &BEGIN);
    assert!(board.pilot.is_orphaned());
    for _ in 0..2 {
        assert_eq!(board.pilot.button(board.now_us), Err(Why::Foreign));
        assert_eq!(begin(board, desk), Said::Refused(Why::Foreign));
        let token = desk.ask(&mut board.pilot, &ToTarget::Status).token();
        let said = desk.ask(&mut board.pilot, &ToTarget::Arm { token });
        assert_eq!(said, Said::Refused(Why::NotBegun));
        assert_eq!(board.period(), None);
        assert!(board.ports.drive.stand());
        // A path alone changes nothing: the settings are the plant's all the same.
        desk.upload(&mut board.pilot, 2 << 16);
    }
    let home = Pose::new(Point::new(Metres::lit("1"), Metres::lit("2")), Angle::ZERO);
    let own = |params: &mut _| *params = presets::small_robot();
    board.pilot.restore(home, own);
    assert!(!board.pilot.is_orphaned() && board.pilot.path().is_none());
    assert_eq!(board.pilot.button(board.now_us), Err(Why::NoPath));
    let segments = [Segment::line(home, Metres::lit("3"))];
    let path = Path::segments(&segments, false).unwrap();
    board.pilot.set_path(&path).unwrap();
    assert_eq!(board.pilot.button(board.now_us), Ok(State::Armed));
    assert_eq!(board.pilot.robot().pose(), home);
    assert_eq!(board.pilot.robot().params(), &presets::small_robot());
    assert_eq!(board.period().expect("a tick").tick, 0);
}

/// Settings and path of a plant are nothing to the board's own wheels, however the session ends.
#[test]
fn nobody_drives_with_what_a_plant_has_left() {
    let mut board = Board::new();
    let mut desk = Desk::new();
    desk.now_us = board.now_us;
    desk.fly(&mut board.pilot, Role::Lockstep);
    assert_eq!(board.period(), None);
    assert!(!board.pilot.is_orphaned());
    desk.hello(&mut board.pilot, Role::Monitor);
    assert_foreign(&mut board, &mut desk);
    // Not by a second plant in between, nor by one that has changed nothing.
    desk.hello(&mut board.pilot, Role::Lockstep);
    desk.hello(&mut board.pilot, Role::Lockstep);
    desk.hello(&mut board.pilot, Role::Monitor);
    assert_foreign(&mut board, &mut desk);
}

/// Pose, record and permission of one role are nothing to the other, nor to the next plant.
#[test]
fn a_plant_leaves_nothing_behind() {
    for role in [Role::Monitor, Role::Lockstep] {
        let mut bench = Bench::new();
        for _ in 0..20 {
            bench.clean();
        }
        let token = bench.desk.hello(&mut bench.pilot, role);
        assert_eq!(bench.pilot.robot().pose(), Pose::default());
        for (message, why) in [
            (ToTarget::Arm { token }, Why::NotBegun),
            (ToTarget::Record, Why::NoRecord),
        ] {
            let said = bench.desk.ask(&mut bench.pilot, &message);
            assert_eq!(said, Said::Refused(why));
        }
        // A monitor that comes back, however, finds what it left.
        bench.desk.hello(&mut bench.pilot, Role::Monitor);
        let own = |params: &mut _| *params = presets::small_robot();
        bench.pilot.restore(Pose::default(), own);
        bench.desk.upload(&mut bench.pilot, 3 << 16);
        assert_eq!(bench.desk.ask(&mut bench.pilot, &BEGIN), Said::Ack);
        let token = bench.desk.hello(&mut bench.pilot, Role::Monitor);
        let said = bench.desk.ask(&mut bench.pilot, &ToTarget::Arm { token });
        assert!(matches!(said, Said::State { armed: true, .. }), "{said:?}");
    }
}

/// `Begin` says where a run begins, for the button, too.
#[test]
fn a_run_begins_where_begin_says() {
    let mut bench = Bench::new();
    for _ in 0..5 {
        bench.clean();
    }
    bench.desk.ask(&mut bench.pilot, &ToTarget::Stop);
    let there = ToTarget::Begin {
        x: 1 << 16,
        y: -2 << 16,
        heading: 1 << 30,
    };
    assert_eq!(bench.desk.ask(&mut bench.pilot, &there), Said::Ack);
    bench.recover();
    let said = bench.period(|frames| frames);
    assert!(
        matches!(
            said[0],
            Said::State {
                cause: Cause::Sequence,
                ..
            }
        ),
        "tick 5 of the last run"
    );
    bench.recover();
    bench.tick = 0;
    let said = bench.period(|frames| frames);
    assert_eq!(said[0].clone().record().tick, 0);
    // The board's own run, too, begins where its own desktop says.
    let mut board = Board::new();
    bench.desk.now_us = board.now_us;
    bench.desk.hello(&mut board.pilot, Role::Monitor);
    assert_eq!(bench.desk.ask(&mut board.pilot, &there), Said::Ack);
    assert_eq!(board.pilot.button(board.now_us), Ok(State::Armed));
    let (x, y) = (Metres::lit("1"), Metres::lit("-2"));
    assert_eq!(
        board.pilot.robot().pose(),
        Pose::new(Point::new(x, y), Angle::QUARTER)
    );
}

/// Wheels that are pushed while the robot is disarmed are followed.
#[test]
fn dead_reckoning_goes_on_while_disarmed() {
    let mut bench = Bench::new();
    bench.desk.ask(&mut bench.pilot, &ToTarget::Stop);
    bench.period(|frames| frames);
    bench.plant.counts.left += 1 << 20;
    bench.plant.counts.right += 1 << 20;
    let said = bench.period(|frames| frames);
    assert!(
        matches!(
            said[0],
            Said::State {
                armed: false,
                tick: 0,
                ..
            }
        ),
        "{said:?}"
    );
    let off = bench.pilot.robot().pose().at.x - Metres::lit("1");
    assert!(off.abs() < Metres::lit("0.001"), "{off:?}");
}

/// However fast the robot was commanded before, it sets off from rest.
#[test]
fn no_command_outlives_its_arming() {
    let mut bench = Bench::new();
    for _ in 0..20 {
        bench.clean();
    }
    assert!(bench.speeds[0] > MetresPerSecond::lit("0.3"));
    bench.desk.ask(&mut bench.pilot, &ToTarget::Stop);
    bench.recover();
    bench.tick = 20;
    let said = bench.period(|frames| frames);
    let record = said[0].clone().record();
    // 2.5 m/s² over a period.
    assert!(
        record.twist.linear <= MetresPerSecond::lit("0.126"),
        "{record:?}"
    );
}

#[test]
fn a_ring_larger_than_mounted_is_refused() {
    let mut bench = Bench::new();
    let mut room = [0; MAX_READINGS];
    let two = [RangeReading::fresh(Range::Clear); 2];
    let (readings, _) = Readings::pack(&two, &mut room);
    for (first, fits) in [(6, true), (7, false), (255, false)] {
        let frame = bench.desk.frame(&ToTarget::Ranges {
            scan: 0,
            first,
            readings,
        });
        let expected = match fits {
            true => vec![],
            false => vec![Said::Refused(Why::TooMany { most: RING as u16 })],
        };
        assert_eq!(bench.send(&[frame]), expected);
    }
}

/// A message of any bytes.
struct Raw<'a>(&'a [u8]);

impl serde::Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeTuple;
        // Of a tuple, postcard writes the elements alone.
        let mut tuple = to.serialize_tuple(self.0.len())?;
        for byte in self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

#[test]
fn what_is_not_understood_is_refused() {
    let mut bench = Bench::new();
    for message in [
        // No such message; a status with a byte too many; a reading with an unknown tag, after a sound one.
        &[15][..],
        &[1, 0],
        &[12, 1, 0, 4, 1, 0, 3, 1],
    ] {
        bench.desk.sequence = bench.desk.sequence.wrapping_add(1);
        let mut wire = [0; MAX_FRAME];
        let frame = frame::encode(bench.desk.sequence, &Raw(message), &mut wire);
        let said = bench.send(&[frame.unwrap().to_vec()]);
        assert_eq!(said, [Said::Refused(Why::Malformed)], "{message:?}");
    }
    // The session goes on.
    bench.clean();
}

#[test]
fn uptime_survives_wrapping_and_late_stamps() {
    let mut pilot = new_pilot();
    let mut desk = Desk::new();
    for (now_us, uptime) in [
        (u32::MAX - 1_999, 0),
        (3_000, 5),
        (2_000, 5),
        (4_000, 6),
        (4_000 + (1 << 31) - 1, 2_147_489),
    ] {
        desk.now_us = now_us;
        let said = desk.ask(&mut pilot, &ToTarget::Status);
        assert!(
            matches!(said, Said::State { uptime_ms, .. } if uptime_ms == uptime),
            "{said:?}"
        );
    }
}

// ---- hostile frames ----

/// Frames of honest sessions, to be recorded, changed and played back.
fn tape() -> Vec<Vec<u8>> {
    let mut tape = Vec::new();
    for role in [Role::Monitor, Role::Lockstep] {
        let mut board = Board::new();
        let mut desk = Desk::new();
        let mut plant = Plant::new(3);
        let hello = desk.frame(&ToTarget::Hello { nonce: 9, role });
        let token = desk.deliver(&mut board.pilot, &hello)[0].1.token();
        tape.push(hello);
        let messages = [
            ToTarget::Status,
            ToTarget::Get { id: 45 },
            ToTarget::Set {
                id: 45,
                value: 2 << 16,
            },
            ToTarget::PathBegin {
                form: PathForm::Segments,
                count: 1,
                closed: false,
                gaps: false,
            },
            ToTarget::PathLine {
                index: 0,
                x: 0,
                y: 0,
                heading: 0,
                length: 3 << 16,
            },
            ToTarget::PathEnd,
            BEGIN,
            ToTarget::Arm { token },
        ];
        for message in &messages {
            let frame = desk.frame(message);
            desk.deliver(&mut board.pilot, &frame);
            tape.push(frame);
        }
        assert_eq!(board.pilot.state(), State::Armed);
        for tick in 0..10 {
            plant.period([MetresPerSecond::ZERO; 2]);
            tape.extend(plant.frames(&mut desk, tick));
        }
        tape.push(desk.frame(&ToTarget::Record));
    }
    tape
}

/// 10,000 frames that nobody honest sent, at a robot that is one arm message away from driving.
#[test]
fn hostile_frames_move_nothing_and_are_survived() {
    let tape = tape();
    let mut dice = Dice(0x5eed);
    for role in [Role::Monitor, Role::Lockstep] {
        let mut board = Board::new();
        let mut desk = Desk::new();
        let mut counted = board.pilot.counters();
        for round in 0..10_000 {
            if round % 500 == 0 {
                // Whatever came before: five good frames, and the robot is armed; a sixth disarms it.
                board.pilot.receive(0, desk.now_us, &mut |_| {});
                let token = desk.hello(&mut board.pilot, role);
                if board.pilot.is_orphaned() {
                    let own = |params: &mut _| *params = presets::small_robot();
                    board.pilot.restore(Pose::default(), own);
                }
                if board.pilot.path().is_none() {
                    board
                        .pilot
                        .set_path(&Path::segments(&line(), false).unwrap())
                        .unwrap();
                }
                assert_eq!(desk.ask(&mut board.pilot, &BEGIN), Said::Ack, "{round}");
                let armed = desk.ask(&mut board.pilot, &ToTarget::Arm { token });
                assert!(
                    matches!(armed, Said::State { armed: true, .. }),
                    "{round}: {armed:?}"
                );
                desk.ask(&mut board.pilot, &ToTarget::Stop);
                counted = board.pilot.counters();
            }
            let mut frame = tape[dice.below(tape.len())].clone();
            match dice.below(4) {
                0 => frame = (0..dice.below(100)).map(|_| dice.roll() as u8).collect(),
                1 => frame.truncate(dice.below(frame.len())),
                2 => {
                    for _ in 0..=dice.below(3) {
                        let at = dice.below(frame.len());
                        frame[at] ^= 1 << dice.below(8);
                    }
                }
                _ => {}
            }
            desk.now_us = desk.now_us.wrapping_add(1_000);
            let said = desk.deliver(&mut board.pilot, &frame);
            let records = said
                .iter()
                .filter(|(_, said)| matches!(said, Said::Record(_)))
                .count();
            assert_eq!(records, 0, "{round}: {frame:02x?}");
            assert!(
                matches!(board.pilot.state(), State::Disarmed(_)),
                "{round}: {frame:02x?}"
            );
            if round % 7 == 0 {
                board.now_us = desk.now_us;
                assert_eq!(board.period(), None);
                assert!(board.ports.drive.stand());
                desk.now_us = board.now_us;
            }
            let now = board.pilot.counters();
            let grown = |now: u32, before: u32| now.checked_sub(before).expect("counts up");
            let steps = grown(now.good, counted.good)
                + grown(now.overlong.into(), counted.overlong.into())
                + grown(now.truncated.into(), counted.truncated.into())
                + grown(now.corrupt.into(), counted.corrupt.into())
                + grown(now.version.into(), counted.version.into());
            assert!(steps as usize <= frame.iter().filter(|byte| **byte == 0).count());
            counted = now;
        }
        let counters = board.pilot.counters();
        assert!(counters.good > 1_000 && counters.truncated > 500 && counters.corrupt > 500);
    }
}

/// Sound frames with any message inside, at a robot that may be anything: nothing arms it but its token.
#[test]
fn any_sound_message_is_survived() {
    let mut dice = Dice(0xf00d);
    let mut board = Board::new();
    let mut desk = Desk::new();
    desk.hello(&mut board.pilot, Role::Lockstep);
    for _ in 0..50_000 {
        let mut message: Vec<u8> = (0..dice.below(24)).map(|_| dice.roll() as u8).collect();
        if let Some(tag) = message.first_mut() {
            *tag %= 16;
        }
        desk.sequence = desk.sequence.wrapping_add(1);
        let mut wire = [0; MAX_FRAME];
        let frame = frame::encode(desk.sequence, &Raw(&message), &mut wire)
            .unwrap()
            .to_vec();
        desk.now_us = desk.now_us.wrapping_add(1_000);
        for (_, said) in desk.deliver(&mut board.pilot, &frame) {
            assert!(!matches!(said, Said::Record(_)));
        }
        assert!(matches!(board.pilot.state(), State::Disarmed(_)));
        board.now_us = desk.now_us;
        assert_eq!(board.period(), None);
        desk.now_us = board.now_us;
    }
}
