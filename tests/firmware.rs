//! What every board does around the pilot: a machine on modelled motors, its button and lamp, the crash word, the pipe.

use fuzzypilot::firmware::crash;
use fuzzypilot::firmware::kit;
use fuzzypilot::firmware::panel::{self, BreakInput, Button, Lamp};
use fuzzypilot::firmware::pipe::Pipe;
use fuzzypilot::firmware::{Board, BoardPilot, Event, Machine, Panel, RANGES, STEP_US};
use fuzzypilot::link::frame::{self, Decoder, MAX_FRAME};
use fuzzypilot::link::message::{Cause, Counts, PathForm, Role, ToHost, ToTarget, Why};
use fuzzypilot::link::settings;
use fuzzypilot::params::Params;
use fuzzypilot::pilot::State;
use fuzzypilot::ports::bridge::{Bridge, Effort, Motor};
use fuzzypilot::ports::quadrature::{QuadratureCounter, QuadratureEncoders};
use fuzzypilot::ports::ring::Sample;
use fuzzypilot::ports::wheel_loop::WheelLoop;
use fuzzypilot::ports::{Fault, NoPin, Range};
use std::cell::Cell;
use std::collections::VecDeque;
use std::rc::Rc;

/// A wheel with its motor and encoder: effort, speed, travel; mounted so that forward is `forward`.
#[derive(Clone, Debug)]
struct Wheel {
    state: Rc<Cell<(f64, f64, f64)>>,
    forward: f64,
    blocked: Rc<Cell<bool>>,
}

impl Wheel {
    fn new(forward: f64) -> Self {
        Self {
            state: Rc::default(),
            forward,
            blocked: Rc::default(),
        }
    }

    fn effort(&self) -> f64 {
        self.state.get().0
    }

    fn travel(&self) -> f64 {
        self.forward * self.state.get().2
    }

    fn roll(&self, dt: f64) {
        let (effort, speed, travel) = self.state.get();
        let goal = effort.signum() * (effort.abs() - 0.08).max(0.0);
        let speed = match self.blocked.get() {
            true => 0.0,
            false => speed + (goal - speed) * (dt / 0.06),
        };
        self.state.set((effort, speed, travel + speed * dt));
    }
}

impl Motor for Wheel {
    type Error = core::convert::Infallible;
    fn drive(&mut self, effort: Effort) -> Result<(), Self::Error> {
        let (_, speed, travel) = self.state.get();
        self.state
            .set((f64::from(effort.bits()) / 32_767.0, speed, travel));
        Ok(())
    }
    fn brake(&mut self) -> Result<(), Self::Error> {
        self.drive(Effort::ZERO)
    }
    fn coast(&mut self) -> Result<(), Self::Error> {
        self.drive(Effort::ZERO)
    }
}

impl QuadratureCounter for Wheel {
    type Raw = u16;
    fn raw(&mut self) -> Result<u16, Fault> {
        Ok((self.state.get().2 / 0.000_141_81).floor() as i64 as u16)
    }
}

type Model = Machine<'static, Wheel, Wheel, NoPin, QuadratureEncoders<Wheel, Wheel>>;

/// A timer with a break input.
#[derive(Debug, Default)]
struct Timer {
    pressed: bool,
    noted: bool,
    outputs: bool,
}

impl Timer {
    fn press(&mut self, pressed: bool) {
        self.pressed = pressed;
        self.noted |= pressed;
        self.outputs &= !pressed;
    }
}

impl BreakInput for Timer {
    fn pressed(&mut self) -> bool {
        self.pressed
    }
    fn tripped(&mut self) -> bool {
        self.noted
    }
    fn forget(&mut self) {
        self.noted = self.pressed;
    }
    fn enable(&mut self) {
        self.outputs = !self.pressed;
    }
}

/// The board that the machine sees.
#[derive(Default)]
struct Bench {
    panel: Panel,
    now: u32,
    due: bool,
    samples: Vec<Sample>,
    /// What comes by the serial port, and what was said to it.
    heard: VecDeque<u8>,
    said: Vec<u8>,
    timer: Timer,
    feeds: u32,
    fed_us: Option<u32>,
    /// Longest time without a feed.
    hungry_us: u32,
    refused: Vec<Why>,
    states: Vec<State>,
}

impl Board for Bench {
    fn now_us(&mut self) -> u32 {
        self.now
    }
    fn due(&mut self) -> bool {
        std::mem::take(&mut self.due)
    }
    fn panel(&mut self) -> Panel {
        let emergency = panel::emergency(&mut self.timer);
        Panel {
            emergency: emergency || self.panel.emergency,
            ..self.panel
        }
    }
    fn sample(&mut self) -> Option<Sample> {
        self.samples.pop()
    }
    fn received(&mut self) -> Option<u8> {
        self.heard.pop_front()
    }
    fn send(&mut self, frame: &[u8]) {
        self.said.extend(frame);
    }
    fn stack(&mut self) -> u32 {
        0
    }
    fn lamp(&mut self, _: bool) {}
    fn feed(&mut self) {
        self.feeds += 1;
        let since = self.now.wrapping_sub(self.fed_us.unwrap_or(self.now));
        self.hungry_us = self.hungry_us.max(since);
        self.fed_us = Some(self.now);
    }
    fn own(&mut self, params: &mut Params<RANGES>) {
        *params = kit::params();
    }

    fn log(&mut self, event: Event) {
        match event {
            Event::State(state) => self.states.push(state),
            Event::Refused(why) => self.refused.push(why),
        }
    }
}

/// A robot on its bench.
struct Robot {
    machine: Model,
    wheels: [Wheel; 2],
    board: Bench,
}

impl Robot {
    fn new(reset: Cause) -> Self {
        Self::with(BoardPilot::new(kit::params(), kit::HOME), reset)
    }

    fn with(pilot: BoardPilot, reset: Cause) -> Self {
        let pilot = Box::leak(Box::new(pilot));
        kit::lay_path(pilot);
        let [left, right] = [Wheel::new(1.0), Wheel::new(-1.0)];
        let bridge = Bridge::new(left.clone(), right.clone());
        let drive = WheelLoop::new(bridge, kit::wheels()).unwrap();
        let encoders = QuadratureEncoders::new(left.clone(), right.clone())
            .reverse(false, true)
            .at_most(kit::COUNTS_A_STEP);
        Self {
            machine: Machine::new(pilot, drive, encoders, reset),
            wheels: [left, right],
            board: Bench {
                now: u32::MAX - 500_000,
                ..Bench::default()
            },
        }
    }

    /// So many seconds, with clear readings from every sensor every 50 ms.
    fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds * 200.0) as u32 {
            let board = &mut self.board;
            board.now = board.now.wrapping_add(STEP_US);
            if board.now % 50_000 < STEP_US {
                board.samples.extend((0..kit::SENSORS).map(|index| Sample {
                    index,
                    range: Range::Clear,
                    at_us: board.now,
                }));
            }
            board.due = true;
            self.machine.run(board);
            for wheel in &self.wheels {
                wheel.roll(0.005);
            }
        }
    }

    fn press(&mut self) {
        self.board.panel.button = true;
        self.run(0.1);
        self.board.panel.button = false;
        self.run(0.1);
    }

    fn state(&self) -> State {
        self.machine.state()
    }

    fn efforts(&self) -> [f64; 2] {
        self.wheels.each_ref().map(Wheel::effort)
    }
}

#[test]
fn the_kit_is_sound() {
    let params = kit::params();
    assert_eq!(params.check(), Ok(()));
    let headings: Vec<i32> = params
        .ring
        .mounts
        .iter()
        .map(|mount| mount.pose.heading.bits())
        .collect();
    assert_eq!(headings.len(), kit::SENSORS);
    assert!(headings.is_sorted(), "counter-clockwise: {headings:?}");
    let mut places: Vec<usize> = kit::ECHOES.into_iter().chain(kit::LASERS).collect();
    places.sort_unstable();
    assert_eq!(places, (0..kit::SENSORS).collect::<Vec<_>>());
}

#[test]
fn the_button_drives_a_metre_and_it_stands_again() {
    let mut robot = Robot::new(Cause::Boot);
    robot.run(1.0);
    assert_eq!(robot.efforts(), [0.0; 2]);
    robot.press();
    robot.run(2.0);
    assert_eq!(robot.state(), State::Armed);
    robot.run(6.0);
    for wheel in &robot.wheels {
        assert!((0.93..1.05).contains(&wheel.travel()), "{}", wheel.travel());
    }
    assert_eq!(robot.efforts(), [0.0; 2]);
    let [boot, over] = [Cause::Boot, Cause::PathOver].map(State::Disarmed);
    assert_eq!(robot.board.states, [boot, State::Armed, over]);
}

#[test]
fn a_button_that_is_down_from_the_start_arms_nothing() {
    let mut robot = Robot::new(Cause::Boot);
    robot.board.panel.button = true;
    robot.run(2.0);
    robot.board.panel.button = false;
    robot.run(1.0);
    assert_eq!(robot.state(), State::Disarmed(Cause::Boot));
    robot.press();
    assert_eq!(robot.state(), State::Armed);
}

#[test]
fn a_second_press_stops() {
    let mut robot = Robot::new(Cause::Boot);
    robot.run(0.5);
    robot.press();
    robot.run(0.5);
    assert!(robot.efforts().iter().all(|&effort| effort != 0.0));
    robot.press();
    assert_eq!(robot.state(), State::Disarmed(Cause::Button));
    assert_eq!(robot.efforts(), [0.0; 2]);
}

#[test]
fn the_emergency_stop_stops_and_blocks() {
    let mut robot = Robot::new(Cause::Boot);
    robot.board.panel.emergency = true;
    robot.run(0.5);
    robot.press();
    assert_eq!(robot.board.refused, [Why::Emergency]);
    robot.board.panel.emergency = false;
    robot.press();
    robot.run(0.5);
    assert!(robot.efforts().iter().all(|&effort| effort != 0.0));
    // One step later the wheels are off, wherever the control period is.
    robot.board.panel.emergency = true;
    robot.run(0.005);
    assert_eq!(robot.efforts(), [0.0; 2]);
    assert_eq!(robot.state(), State::Disarmed(Cause::Emergency));
    // Released, it does not go on by itself.
    robot.board.panel.emergency = false;
    robot.run(1.0);
    assert_eq!(robot.efforts(), [0.0; 2]);
    assert_eq!(robot.state(), State::Disarmed(Cause::Emergency));
}

#[test]
fn an_emergency_stop_between_two_looks_is_one() {
    let mut robot = Robot::new(Cause::Boot);
    robot.run(0.5);
    robot.press();
    robot.run(0.5);
    assert!(robot.board.timer.outputs);
    assert!(robot.efforts().iter().all(|&effort| effort != 0.0));
    robot.board.timer.press(true);
    robot.board.timer.press(false);
    robot.run(0.005);
    assert_eq!(robot.state(), State::Disarmed(Cause::Emergency));
    assert_eq!(robot.efforts(), [0.0; 2]);
    // The outputs are let drive when there is nothing to drive any more.
    assert!(!robot.board.timer.outputs);
    robot.run(0.5);
    assert!(robot.board.timer.outputs);
    assert_eq!(robot.state(), State::Disarmed(Cause::Emergency));
    robot.press();
    assert_eq!(robot.state(), State::Armed);
    // Held, it stays one.
    robot.board.timer.press(true);
    robot.run(0.5);
    assert!(!robot.board.timer.outputs);
    robot.press();
    assert_eq!(robot.board.refused, [Why::Emergency]);
}

impl Robot {
    /// Sends a message with this sequence number; the answers' bytes.
    fn tell(&mut self, sequence: u8, message: &ToTarget<'_>) -> Vec<u8> {
        let mut wire = [0; MAX_FRAME];
        let frame = frame::encode(sequence, message, &mut wire).unwrap();
        self.board.heard.extend(frame.iter());
        self.machine.run(&mut self.board);
        std::mem::take(&mut self.board.said)
    }

    /// A lock-step session: settings, a path to the left and backwards wheels that are none of the robot's own, and ticks.
    fn in_the_loop(&mut self) {
        let (id, value) = (
            3,
            (kit::params().body.metres_per_count.to_bits() / 3).cast_signed(),
        );
        let hello = ToTarget::Hello {
            nonce: 5,
            role: Role::Lockstep,
        };
        let token = self.token(1, &hello);
        let path = ToTarget::PathBegin {
            form: PathForm::Segments,
            count: 1,
            closed: false,
            gaps: false,
        };
        let line = ToTarget::PathLine {
            index: 0,
            x: 1 << 16,
            y: 1 << 16,
            heading: 1 << 30,
            length: 9 << 16,
        };
        let begin = ToTarget::Begin {
            x: 1 << 16,
            y: 1 << 16,
            heading: 1 << 30,
        };
        let mounts = ToTarget::Set { id: 256, value: 1 };
        let set = ToTarget::Set { id, value };
        let fast = ToTarget::Set {
            id: 10,
            value: 3 << 14,
        };
        let end = ToTarget::PathEnd;
        let arm = ToTarget::Arm { token };
        let messages = [mounts, set, fast, path, line, end, begin, arm];
        for (message, sequence) in messages.iter().zip(2..) {
            assert!(!self.tell(sequence, message).is_empty());
        }
        assert_eq!(self.state(), State::Armed);
        for tick in 0..5 {
            let inputs = ToTarget::Inputs {
                tick,
                time_us: 20_000 * (tick + 1),
                scan: 0,
                counts: Counts::Known { left: 0, right: 0 },
            };
            self.run(0.02);
            // Three parts of a record.
            assert!(self.tell(20 + tick as u8, &inputs).len() > 150);
            assert_eq!(self.efforts(), [0.0; 2]);
        }
    }

    /// The token of what is answered by one.
    fn token(&mut self, sequence: u8, message: &ToTarget<'_>) -> u32 {
        let mut decoder = Decoder::new();
        let said = self.tell(sequence, message);
        let answers = said.into_iter().find_map(|byte| match decoder.push(byte) {
            Some(Ok(frame)) => match frame.parse() {
                Some(ToHost::Welcome { token, .. } | ToHost::State { token, .. }) => Some(token),
                _ => None,
            },
            _ => None,
        });
        answers.expect("a token")
    }

    /// What it answers by a state.
    fn asked(&mut self, message: &ToTarget<'_>) -> (bool, [i32; 2]) {
        let mut decoder = Decoder::new();
        for byte in self.tell(1, message) {
            let Some(Ok(frame)) = decoder.push(byte) else {
                continue;
            };
            if let Some(ToHost::State {
                armed, left, right, ..
            }) = frame.parse()
            {
                return (armed, [left, right]);
            }
        }
        panic!("no state");
    }
}

/// After hardware in the loop the button does what it does on a robot that was just switched on: nothing that was sent for
/// the simulated robot moves the real wheels.
#[test]
fn a_plant_leaves_neither_settings_nor_path_to_the_wheels() {
    let drive = |robot: &mut Robot| {
        robot.press();
        let mut efforts = Vec::new();
        for _ in 0..1000 {
            robot.run(0.005);
            efforts.push(robot.efforts());
        }
        efforts
    };
    let mut fresh = Robot::new(Cause::Boot);
    fresh.run(1.0);
    let expected = drive(&mut fresh);
    type End = fn(&mut Robot);
    let ends: [(&str, End); 3] = [
        ("silence", |robot| robot.run(10.5)),
        ("a monitor", |robot| {
            let hello = ToTarget::Hello {
                nonce: 6,
                role: Role::Monitor,
            };
            robot.token(90, &hello);
        }),
        ("a stop, then silence", |robot| {
            robot.token(90, &ToTarget::Stop);
            robot.run(10.5);
        }),
    ];
    for (what, end) in ends {
        let mut robot = Robot::new(Cause::Boot);
        robot.run(0.2);
        robot.in_the_loop();
        end(&mut robot);
        assert!(matches!(robot.state(), State::Disarmed(_)), "{what}");
        robot.run(1.0);
        assert_eq!(robot.efforts(), [0.0; 2], "{what}");
        let efforts = drive(&mut robot);
        assert_eq!(robot.board.refused, [], "{what}");
        for (wheel, fresh) in robot.wheels.iter().zip(&fresh.wheels) {
            let gone = (wheel.travel() - fresh.travel()).abs();
            assert!(gone < 0.02, "{what}: {} m", wheel.travel());
        }
        let fast = |efforts: &[[f64; 2]]| {
            efforts
                .as_flattened()
                .iter()
                .fold(0.0, |m: f64, e| m.max(e.abs()))
        };
        let (own, plant) = (fast(&expected), fast(&efforts));
        assert!(
            (own - plant).abs() < 0.1,
            "{what}: {plant} instead of {own}"
        );
        assert_eq!(robot.efforts(), [0.0; 2], "{what}");
    }
}

#[test]
fn a_wheel_turned_by_hand_is_told() {
    let mut robot = Robot::new(Cause::Boot);
    robot.run(0.1);
    let (_, before) = robot.asked(&ToTarget::Status);
    // 0.1 m and 0.2 m forward.
    for _ in 0..20 {
        for (wheel, metres) in robot.wheels.iter().zip([0.1, 0.2]) {
            let (effort, speed, travel) = wheel.state.get();
            let travel = travel + wheel.forward * metres / 20.0;
            wheel.state.set((effort, speed, travel));
        }
        // No further than a step may count.
        robot.run(0.005);
    }
    let (armed, after) = robot.asked(&ToTarget::Status);
    assert!(!armed);
    let counted = [after[0] - before[0], after[1] - before[1]];
    assert!((705..=706).contains(&counted[0]), "{counted:?}");
    assert!((1410..=1411).contains(&counted[1]), "{counted:?}");
}

#[test]
fn the_wheel_loops_measure_as_the_odometry_does() {
    // A count of twice the length: the same speed is half as many.
    let speeds = [1, 2].map(|times| {
        let mut pilot = BoardPilot::new(kit::params(), kit::HOME);
        let bits = kit::params().body.metres_per_count.to_bits() * times;
        pilot.change_params(|params| settings::set(params, 3, bits.cast_signed()).unwrap());
        let mut robot = Robot::with(pilot, Cause::Boot);
        robot.run(0.5);
        robot.press();
        robot.run(1.3);
        let travel = robot.wheels[0].travel();
        robot.run(0.2);
        assert_eq!(robot.state(), State::Armed);
        (robot.wheels[0].travel() - travel) / 0.2
    });
    let [once, twice] = speeds;
    assert!((0.45..0.55).contains(&once), "{once}");
    assert!((0.45..0.55).contains(&(twice * 2.0)), "{twice}");
}

#[test]
fn a_stalled_wheel_stays_off_for_two_seconds() {
    let mut robot = Robot::new(Cause::Boot);
    robot.run(0.5);
    robot.press();
    robot.run(0.3);
    robot.wheels[1].blocked.set(true);
    robot.run(1.5);
    assert_eq!(robot.state(), State::Disarmed(Cause::DriveFault));
    assert_eq!(robot.efforts(), [0.0; 2]);
    robot.press();
    assert_eq!(robot.board.refused, [Why::DriveFault]);
    robot.wheels[1].blocked.set(false);
    robot.run(2.0);
    robot.press();
    assert_eq!(robot.state(), State::Armed);
}

#[test]
fn control_periods_follow_the_setting() {
    // The watchdog is fed by a control period only; none is longer than 100 ms.
    for (millis, a_second) in [
        (20, 50),
        (50, 20),
        (100, 10),
        (5, 200),
        (7, 200),
        (8, 100),
        (250, 10),
        (1000, 10),
    ] {
        let mut pilot = BoardPilot::new(kit::params(), kit::HOME);
        let period = ((i64::from(millis) << 24) / 1000) as i32;
        pilot.change_params(|params| settings::set(params, 20, period).unwrap());
        let mut robot = Robot::with(pilot, Cause::Boot);
        robot.run(1.0);
        assert_eq!(robot.board.feeds, a_second, "{millis} ms");
    }
}

#[test]
fn no_period_starves_the_watchdog() {
    for millis in [5, 20, 100, 101, 250, 1000, 2000] {
        let mut pilot = BoardPilot::new(kit::params(), kit::HOME);
        let period = ((i64::from(millis) << 24) / 1000) as i32;
        pilot.change_params(|params| settings::set(params, 20, period).unwrap());
        let mut robot = Robot::with(pilot, Cause::Boot);
        robot.run(5.0);
        let hungry = robot.board.hungry_us;
        assert!((1..=100_000).contains(&hungry), "{millis} ms: {hungry} µs");
        // What cannot be kept is not driven.
        robot.press();
        let refused: &[Why] = match millis {
            5 | 20 | 100 => &[],
            _ => &[Why::Setting { id: 20 }],
        };
        assert_eq!(robot.board.refused, refused, "{millis} ms");
    }
}

#[test]
fn the_last_reset_is_told() {
    let mut robot = Robot::new(Cause::Watchdog);
    robot.run(0.1);
    assert_eq!(robot.board.states, [State::Disarmed(Cause::Watchdog)]);
}

#[test]
fn a_bouncing_button_counts_once() {
    let mut button = Button::new();
    let mut presses = 0;
    let mut sample = |down, times| {
        for _ in 0..times {
            presses += u32::from(button.sample(down));
        }
    };
    sample(false, 20);
    for _ in 0..5 {
        sample(true, 2);
        sample(false, 2);
    }
    sample(true, 50);
    sample(false, 3);
    sample(true, 50);
    sample(false, 50);
    assert_eq!(presses, 1);
}

#[test]
fn the_lamp_tells_the_states_apart() {
    let round = |state, emergency| {
        let mut lamp = Lamp::new();
        let shines: Vec<bool> = (0..200).map(|_| lamp.step(state, emergency)).collect();
        // The second round is the first.
        assert!(
            shines
                .iter()
                .all(|&shine| lamp.step(state, emergency) == shine)
        );
        let on = shines.iter().filter(|&&shine| shine).count();
        let blinks = shines.windows(2).filter(|pair| pair[0] && !pair[1]).count();
        (on, blinks)
    };
    assert_eq!(round(State::Armed, false), (200, 0));
    assert_eq!(round(State::Disarmed(Cause::PathOver), false), (100, 1));
    assert_eq!(round(State::Disarmed(Cause::Emergency), true), (40, 2));
    assert_eq!(round(State::Disarmed(Cause::Watchdog), false), (100, 10));
}

#[test]
fn a_crash_leaves_its_cause() {
    for cause in [Cause::Panic, Cause::HardFault] {
        assert_eq!(crash::cause(crash::word(cause)), Some(cause));
    }
    for noise in [0, u32::MAX, 0xCCCC_CCCC, crash::word(Cause::Boot)] {
        assert_eq!(crash::cause(noise), None);
    }
}

#[test]
fn a_pipe_keeps_the_order_between_two_threads() {
    static PIPE: Pipe<16> = Pipe::new();
    const TIMES: u32 = 20_000;
    let pusher = std::thread::spawn(|| {
        for i in 0..TIMES {
            while !PIPE.push(&i.to_le_bytes()) {
                std::thread::yield_now();
            }
        }
    });
    for i in 0..TIMES {
        let bytes = loop {
            if let Some(bytes) = PIPE.pop_all() {
                break bytes;
            }
            std::thread::yield_now();
        };
        assert_eq!(u32::from_le_bytes(bytes), i);
    }
    pusher.join().unwrap();
    assert!(PIPE.is_empty());
}

#[test]
fn a_pipe_takes_all_or_nothing() {
    let pipe: Pipe<8> = Pipe::new();
    for round in 0..20u8 {
        assert!(pipe.push(&[round; 4]));
        assert!(!pipe.push(&[0; 4]));
        assert!(pipe.push(&[round; 3]));
        assert!(!pipe.push(&[0]));
        assert_eq!(pipe.pop_all(), Some([round; 7]));
        assert_eq!(pipe.pop(), None);
    }
}
