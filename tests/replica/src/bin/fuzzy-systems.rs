//! Evaluates the systems of `replica::systems` and counts the instructions. The file `out` holds words: the count of
//! nothing and of 1,000 instructions; then of every evaluation its count, its outputs and its rules' digest.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use fuzzypilot::fuzzy::system::{Controller, Evaluation};
    use replica::clock;
    use replica::files::Output;
    use replica::owned::Owned;
    use replica::systems::{
        CROWD, CURVED, Crowd, Curved, MAMDANI, Mamdani, NUMBERS, TABLE, Table, digest, inputs,
    };

    static OUTPUT: Owned<Output> = Owned::new(Output::new());

    // Each a call, so that what is counted is the evaluation and nothing else.
    #[inline(never)]
    fn table(inputs: [i32; 2]) -> Evaluation<9, 1> {
        TABLE.evaluate(inputs)
    }

    #[inline(never)]
    fn curved(inputs: [i32; 3]) -> Evaluation<6, 2> {
        CURVED.evaluate(inputs)
    }

    #[inline(never)]
    fn mamdani(inputs: [i32; 2]) -> Evaluation<4, 2> {
        MAMDANI.evaluate(inputs)
    }

    #[inline(never)]
    fn crowd(inputs: [i32; 1]) -> Evaluation<320, 1> {
        CROWD.evaluate(inputs)
    }

    fn play<const I: usize, const T: usize, const R: usize, const O: usize>(
        output: &mut Output,
        controller: &Controller<'static, I, T, R, O>,
        evaluate: fn([i32; I]) -> Evaluation<R, O>,
    ) {
        for number in 0..NUMBERS {
            let inputs = black_box(inputs::<I>(controller.system(), number));
            let begin = clock::now();
            let evaluation = black_box(evaluate(inputs));
            output.word(clock::since(begin));
            for value in evaluation.outputs {
                output.word(value as u32);
            }
            output.word(digest(&evaluation.rules));
        }
    }

    fn run() -> Result<(), &'static str> {
        // SAFETY: taken here alone, and `run` is called once.
        let output = unsafe { OUTPUT.take() };
        output.create().ok_or("the file `out` cannot be written")?;
        clock::start();
        output.word(clock::empty());
        output.word(clock::thousand());
        play(output, &TABLE as &Table, black_box(table));
        play(output, &CURVED as &Curved, black_box(curved));
        play(output, &MAMDANI as &Mamdani, black_box(mamdani));
        play(output, &CROWD as &Crowd, black_box(crowd));
        output.finish().ok_or("the file `out` is not whole")
    }

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
}

#[cfg(not(target_os = "none"))]
fn main() {}
