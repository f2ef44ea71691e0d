//! The fine controller counted over a dense grid: three ways to evaluate it, the same inputs.
//!
//! Words in `out`: the count of nothing and of 1,000 instructions; for each way the least and the greatest count and a
//! checksum of all outputs; the deepest stack of the last way.
#![cfg_attr(target_os = "none", no_std, no_main)]

// The player's: it needs more of them.
#[cfg(target_os = "none")]
#[path = "../image/clock.rs"]
#[allow(dead_code)]
mod clock;
#[cfg(target_os = "none")]
#[path = "../image/files.rs"]
#[allow(dead_code)]
mod files;
#[cfg(target_os = "none")]
#[path = "../image/stack.rs"]
#[allow(dead_code)]
mod stack;

#[cfg(target_os = "none")]
mod image {
    use crate::clock::{self, now, since};
    use crate::files::Output;
    use crate::stack;
    use fuzzypilot::behaviour::fine::FineController;
    use fuzzypilot::units::{Angle, Metres};
    use replica::fine::{Bits, CONTROLLER, grid, mix};
    use replica::owned::Owned;

    static OUTPUT: Owned<Output> = Owned::new(Output::new());

    #[unsafe(no_mangle)]
    extern "C" fn image_main() -> ! {
        // SAFETY: taken once.
        let output = unsafe { OUTPUT.take() };
        if output.create().is_none() {
            semihosting::process::exit(1);
        }
        clock::start();
        output.word(clock::empty());
        output.word(clock::thousand());
        count(output, plain);
        count(output, compiled_in);
        count(output, by_reference);
        let depth = stack::depth_of(|| {
            core::hint::black_box(by_reference(
                &CONTROLLER,
                Metres::lit("0.1"),
                Angle::QUARTER,
            ));
        });
        output.word(depth);
        semihosting::process::exit(if output.finish().is_some() { 0 } else { 1 })
    }

    type Way = fn(&FineController, Metres, Angle) -> Bits;

    #[inline(never)]
    fn count(output: &mut Output, way: Way) {
        let (mut least, mut most, mut sum) = (u32::MAX, 0, 0);
        for (d, heading_error) in grid() {
            let begin = now();
            let bits = way(&CONTROLLER, d, heading_error);
            let count = since(begin);
            least = least.min(count);
            most = most.max(count);
            sum = mix(sum, bits);
        }
        output.word(least);
        output.word(most);
        output.word(sum);
    }

    #[inline(never)]
    fn plain(controller: &FineController, d: Metres, heading_error: Angle) -> Bits {
        let motion = controller.evaluate_plain(d, heading_error);
        (motion.speed.bits(), motion.yaw_rate.bits())
    }

    #[inline(never)]
    fn compiled_in(_: &FineController, d: Metres, heading_error: Angle) -> Bits {
        let motion = CONTROLLER.evaluate(d, heading_error);
        (motion.speed.bits(), motion.yaw_rate.bits())
    }

    #[inline(never)]
    fn by_reference(controller: &FineController, d: Metres, heading_error: Angle) -> Bits {
        let motion = controller.evaluate(d, heading_error);
        (motion.speed.bits(), motion.yaw_rate.bits())
    }

    #[unsafe(no_mangle)]
    extern "C" fn image_fault() -> ! {
        semihosting::process::exit(1)
    }

    #[panic_handler]
    fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
        semihosting::process::exit(1)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
