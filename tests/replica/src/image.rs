//! What the player does.
//!
//! | mode | words in `out` |
//! |---|---|
//! | ticks | first the count of nothing and of 1,000 instructions; a tick: itself, one evaluation of the fine controller with its inputs (0 where they were not asked) |
//! | stages | the same two, of marks; a tick: its stages in the order of [`Stage`](fuzzypilot::tick::Stage) |
//! | stack | a tick: bytes of stack |

use fuzzypilot::behaviour::fine::FineController;
use fuzzypilot::geometry::Pose;
use fuzzypilot::guide::Path;
use fuzzypilot::link::record::encode;
use fuzzypilot::params::Law;
use fuzzypilot::ports::Ports;
use fuzzypilot::presets;
use fuzzypilot::signals::{Controller, TickRecord, Twist};
use fuzzypilot::tick::Robot;
use fuzzypilot::units::{Angle, Metres};
use replica::clock::{self, Clock, now, since};
use replica::files::{Input, Output};
use replica::owned::Owned;
use replica::stack;
use replica::tape::{self, Inputs, Mode, NoWheels, Source, Store};

/// All that is large: statics, because the smallest machine has 16 KiB.
struct Place {
    input: Input,
    output: Output,
    path: Store,
    inputs: Inputs,
    /// A robot of the size that is counted…
    small: Option<Robot<8>>,
    /// …and one for every ring.
    large: Option<Robot<64>>,
}

static PLACE: Owned<Place> = Owned::new(Place {
    input: Input::new(),
    output: Output::new(),
    path: Store::new(),
    inputs: Inputs::new(),
    small: None,
    large: None,
});

#[unsafe(no_mangle)]
extern "C" fn image_main() -> ! {
    match run() {
        Ok(()) => semihosting::process::exit(0),
        Err(why) => {
            semihosting::eprintln!("{why}");
            semihosting::process::exit(1)
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn image_fault() -> ! {
    semihosting::eprintln!("the image faulted");
    semihosting::process::exit(1)
}

#[panic_handler]
fn panicked(info: &core::panic::PanicInfo<'_>) -> ! {
    semihosting::eprintln!("{info}");
    semihosting::process::exit(1)
}

/// Plays all tapes.
fn run() -> Result<(), &'static str> {
    // SAFETY: taken here alone, and `run` is called once.
    let place = unsafe { PLACE.take() };
    place.input.open().ok_or("the file `tape` cannot be read")?;
    place
        .output
        .create()
        .ok_or("the file `out` cannot be written")?;
    let mode = tape::open(&mut place.input).ok_or("the file `tape` is no tape of this form")?;
    stack::guard();
    put_robot(&mut place.small);
    put_robot(&mut place.large);
    clock::start();
    let player = Player {
        input: &mut place.input,
        output: &mut place.output,
        path: &mut place.path,
        inputs: &mut place.inputs,
        mode,
    };
    player.all(place.small.as_mut(), place.large.as_mut())?;
    match stack::is_sound() {
        true => Ok(()),
        false => Err("the stack ran into the data"),
    }
}

/// A call, so that what passes over the stack here is off it again.
#[inline(never)]
fn put_robot<const N: usize>(place: &mut Option<Robot<N>>) {
    *place = Some(Robot::new(presets::small_robot(), Pose::default()));
}

/// What it takes to play.
struct Player<'a> {
    input: &'a mut Input,
    output: &'a mut Output,
    path: &'a mut Store,
    inputs: &'a mut Inputs,
    mode: Mode,
}

impl Player<'_> {
    fn all(
        mut self,
        mut small: Option<&mut Robot<8>>,
        mut large: Option<&mut Robot<64>>,
    ) -> Result<(), &'static str> {
        match self.mode {
            Mode::Ticks => self.calibrate(clock::empty()),
            Mode::Stages => self.calibrate(clock::empty_stage()),
            Mode::Records | Mode::Stack => {}
        }
        loop {
            let ticks = self.input.word();
            if ticks <= 0 {
                return self.output.finish().ok_or("the file `out` is not whole");
            }
            let sensors = self.input.word() as usize;
            match (small.as_deref_mut(), large.as_deref_mut()) {
                (Some(robot), _) if sensors <= 8 => self.play(robot, ticks, sensors)?,
                (_, Some(robot)) => self.play(robot, ticks, sensors)?,
                _ => return Err("there is no robot"),
            }
        }
    }

    fn calibrate(&mut self, empty: u32) {
        self.output.word(empty);
        self.output.word(clock::thousand());
    }

    fn play<const N: usize>(
        &mut self,
        robot: &mut Robot<N>,
        ticks: i32,
        sensors: usize,
    ) -> Result<(), &'static str> {
        tape::load(self.input, robot, self.path)?;
        let path = self.path.path().ok_or("there is no path")?;
        for _ in 0..ticks {
            self.inputs.read(self.input, sensors);
            match self.mode {
                Mode::Records => {
                    let record = tick(robot, &path, self.inputs);
                    self.output.write(&encode(&record));
                }
                Mode::Ticks => {
                    let begin = now();
                    let record = tick(robot, &path, self.inputs);
                    let whole = since(begin);
                    self.output.word(whole);
                    self.output.word(inference(robot, &record));
                }
                Mode::Stages => {
                    let mut clock = Clock::new();
                    observed(robot, &path, self.inputs, &mut clock);
                    for count in clock.counts {
                        self.output.word(count);
                    }
                }
                Mode::Stack => {
                    let depth = stack::depth_of(|| {
                        core::hint::black_box(tick(robot, &path, self.inputs));
                    });
                    self.output.word(depth);
                }
            }
        }
        Ok(())
    }
}

/// The tick as a firmware calls it.
#[inline(never)]
fn tick<const N: usize>(robot: &mut Robot<N>, path: &Path<'_>, inputs: &Inputs) -> TickRecord {
    robot.tick(path, &mut ports(inputs))
}

#[inline(never)]
fn observed<const N: usize>(
    robot: &mut Robot<N>,
    path: &Path<'_>,
    inputs: &Inputs,
    clock: &mut Clock,
) {
    clock.begin();
    core::hint::black_box(robot.tick_observed(path, &mut ports(inputs), clock));
}

fn ports(inputs: &Inputs) -> Ports<NoWheels, &Inputs, &Inputs> {
    Ports {
        drive: NoWheels,
        encoders: inputs,
        ranges: inputs,
    }
}

/// The count of one evaluation of the fine controller with the tick's inputs.
fn inference<const N: usize>(robot: &Robot<N>, record: &TickRecord) -> u32 {
    if record.trace.controller != Controller::Fine {
        return 0;
    }
    let params = robot.params();
    let fine = FineController::new(&params.follower, &params.limits);
    let guidance = &record.guidance;
    let d = match params.follower.law {
        Law::Paper => guidance.distance,
        Law::Guided => guidance.cross_track.abs(),
    };
    let begin = now();
    let out = evaluate(&fine, d, guidance.heading_error);
    let count = since(begin);
    core::hint::black_box(out);
    count
}

#[inline(never)]
fn evaluate(fine: &FineController, d: Metres, heading_error: Angle) -> Twist {
    let motion = fine.evaluate(d, heading_error);
    Twist {
        linear: motion.speed,
        angular: motion.yaw_rate,
    }
}
