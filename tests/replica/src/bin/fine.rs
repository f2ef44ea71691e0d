//! The fine controller counted over a dense grid: three ways to evaluate it, the same inputs.
//!
//! Words in `out`: a checksum of tables of other shapes; the count of nothing and of 1,000 instructions; for a call of one instruction and for each way the
//! least and the greatest count, a checksum of all outputs, and how deep the stack goes below its caller's caller.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use core::mem::MaybeUninit;
    use fuzzypilot::behaviour::fine::{FineController, FineMotion};
    use fuzzypilot::units::{Angle, Metres};
    use replica::clock::{self, now, since};
    use replica::files::Output;
    use replica::fine::{CONTROLLER, grid, mix};
    use replica::owned::Owned;
    use replica::shapes;
    use replica::stack::depth_of;

    static OUTPUT: Owned<Output> = Owned::new(Output::new());

    #[unsafe(no_mangle)]
    extern "C" fn image_main() -> ! {
        // SAFETY: taken once.
        let output = unsafe { OUTPUT.take() };
        if output.create().is_none() {
            semihosting::process::exit(1);
        }
        output.word(shapes::checksum());
        clock::start();
        output.word(clock::empty());
        output.word(clock::thousand());
        count(output, nothing);
        count(output, plain);
        count(output, compiled_in);
        count(output, by_reference);
        semihosting::process::exit(if output.finish().is_some() { 0 } else { 1 })
    }

    /// Raw numbers in; out in the lower half the speed, in the upper one the yaw rate: all in registers.
    type Way = extern "C" fn(&'static FineController, i32, i32) -> u64;

    #[inline(never)]
    fn count(output: &mut Output, way: Way) {
        let (mut least, mut most, mut sum) = (u32::MAX, 0, 0);
        for (d, heading_error) in grid() {
            let (d, heading_error) = (d.bits(), heading_error.bits());
            let begin = now();
            let bits = way(&CONTROLLER, d, heading_error);
            let count = since(begin);
            least = least.min(count);
            most = most.max(count);
            sum = mix(sum, (bits as i32, (bits >> 32) as i32));
        }
        output.word(least);
        output.word(most);
        output.word(sum);
        output.word(depth_of(|| beneath(way)));
    }

    /// Calls from below the stack that a painter leaves alone, and marks the place: one word at the lower end.
    #[inline(never)]
    fn beneath(way: Way) {
        let mut ballast = [const { MaybeUninit::<u32>::uninit() }; 64];
        black_box(&mut ballast)[0].write(0);
        black_box(way(&CONTROLLER, black_box(1 << 15), black_box(1 << 28)));
        black_box(&mut ballast);
    }

    /// One instruction: what calling costs.
    #[unsafe(naked)]
    extern "C" fn nothing(_: &'static FineController, _: i32, _: i32) -> u64 {
        core::arch::naked_asm!(
            #[cfg(target_arch = "arm")]
            "bx lr",
            #[cfg(target_arch = "riscv32")]
            "ret",
        )
    }

    fn packed(motion: &FineMotion) -> u64 {
        u64::from(motion.speed.bits() as u32) | u64::from(motion.yaw_rate.bits() as u32) << 32
    }

    #[inline(never)]
    extern "C" fn plain(controller: &'static FineController, d: i32, error: i32) -> u64 {
        packed(&controller.evaluate_plain(Metres::from_bits(d), Angle::from_bits(error)))
    }

    #[inline(never)]
    extern "C" fn compiled_in(_: &'static FineController, d: i32, error: i32) -> u64 {
        packed(&CONTROLLER.evaluate(Metres::from_bits(d), Angle::from_bits(error)))
    }

    #[inline(never)]
    extern "C" fn by_reference(controller: &'static FineController, d: i32, error: i32) -> u64 {
        packed(&controller.evaluate(Metres::from_bits(d), Angle::from_bits(error)))
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
