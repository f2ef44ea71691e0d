//! Plays the navigator's tapes (`replica::navigation`) from the file `tape` and writes the file `out`.
//!
//! | mode | in `out` |
//! |---|---|
//! | records | the settings' and the navigator's size, words; every tick's record |
//! | ticks | words: the count of nothing and of 1,000 instructions; a tick each |
//! | stages | words: the same two, of marks; a tick: its stages in the order of `fuzzypilot::navigate::Stage` |
//! | stack | words: bytes of a tick each |
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use fuzzypilot::navigate::{Setup, Task};
    use replica::clock::{self, Marks, now, since};
    use replica::files::{Input, Output};
    use replica::navigation::{CONES, Course, Engine, Seen, encode, setup, tick};
    use replica::owned::Owned;
    use replica::stack;
    use replica::tape::{self, Mode, Source};

    /// All that is large: statics, because the smallest machine has 16 KiB.
    struct Place {
        input: Input,
        output: Output,
        course: Course,
        seen: Seen,
        setup: Option<Setup<CONES>>,
        engine: Engine,
    }

    static PLACE: Owned<Place> = Owned::new(Place {
        input: Input::new(),
        output: Output::new(),
        course: Course::new(),
        seen: Seen::new(),
        setup: None,
        engine: Engine::new(),
    });

    /// What every run begins with. In flash, because on the way it would not fit on the stack.
    static BLANK: Engine = Engine::new();

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
        put_setup(&mut place.setup)?;
        clock::start();
        match mode {
            Mode::Ticks => calibrate(&mut place.output, clock::empty()),
            Mode::Stages => calibrate(&mut place.output, clock::empty_mark()),
            Mode::Records => {
                place.output.word(size_of::<Setup<CONES>>() as u32);
                place.output.word(size_of::<Engine>() as u32);
            }
            Mode::Stack => {}
        }
        loop {
            let ticks = place.input.word();
            if ticks <= 0 {
                break;
            }
            // SAFETY: a navigator owns nothing outside itself, and nothing happens when it is dropped.
            unsafe { core::ptr::copy_nonoverlapping(&BLANK, &mut place.engine, 1) };
            place.course.read(&mut place.input)?;
            for _ in 0..ticks {
                play(place, mode)?;
            }
        }
        place.output.finish().ok_or("the file `out` is not whole")?;
        match stack::is_sound() {
            true => Ok(()),
            false => Err("the stack ran into the data"),
        }
    }

    /// A call, so that what passes over the stack here is off it again.
    #[inline(never)]
    fn put_setup(place: &mut Option<Setup<CONES>>) -> Result<(), &'static str> {
        *place = Some(setup().map_err(|_| "the settings cannot be driven with")?);
        Ok(())
    }

    fn calibrate(output: &mut Output, empty: u32) {
        output.word(empty);
        output.word(clock::thousand());
    }

    #[inline(never)]
    fn play(place: &mut Place, mode: Mode) -> Result<(), &'static str> {
        place.seen.read(&mut place.input);
        let setup = place.setup.as_ref().ok_or("there are no settings")?;
        let (engine, seen, output) = (&mut place.engine, &place.seen, &mut place.output);
        let path = place.course.path();
        let task = place.course.task(&path);
        match mode {
            Mode::Records => {
                let record = tick(engine, setup, seen, task);
                output.write(&encode(&record, engine.digest()));
            }
            Mode::Ticks => {
                let begin = now();
                black_box(tick(engine, setup, seen, task));
                output.word(since(begin));
            }
            Mode::Stages => {
                let mut marks = Marks::new();
                observed(engine, setup, seen, task, &mut marks);
                for count in marks.counts {
                    output.word(count);
                }
            }
            Mode::Stack => output.word(stack::depth_of(|| {
                black_box(tick(engine, setup, seen, task));
            })),
        }
        Ok(())
    }

    #[inline(never)]
    fn observed(
        engine: &mut Engine,
        setup: &Setup<CONES>,
        seen: &Seen,
        task: Task<'_>,
        marks: &mut Marks,
    ) {
        marks.begin();
        engine.see(setup, &seen.readings);
        black_box(engine.step_observed(setup, seen.pose, task, marks));
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
}

#[cfg(not(target_os = "none"))]
fn main() {}
