//! The fine controller and nothing else: its size, and what it is linked with. It links only where nothing can panic.
//! Never run. With the feature `one-panic` it has an `unwrap` of what is known at run time only, to see it refused.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use fuzzypilot::units::{Angle, Metres};
    use replica::fine::{Bits, CONTROLLER};
    use replica::shell::halt;

    unsafe extern "C" {
        /// Nowhere defined: who panics does not link.
        fn the_fine_controller_can_panic() -> !;
    }

    #[unsafe(no_mangle)]
    extern "C" fn image_main() -> ! {
        loop {
            black_box(fine_controller(
                black_box(Metres::ZERO),
                black_box(Angle::ZERO),
            ));
        }
    }

    #[unsafe(no_mangle)]
    #[inline(never)]
    fn fine_controller(d: Metres, heading_error: Angle) -> Bits {
        #[cfg(feature = "one-panic")]
        let d = Metres::from_bits(i32::from(i16::try_from(d.bits()).unwrap()));
        let motion = CONTROLLER.evaluate(d, heading_error);
        (motion.speed.bits(), motion.yaw_rate.bits())
    }

    #[unsafe(no_mangle)]
    extern "C" fn image_fault() -> ! {
        halt()
    }

    #[panic_handler]
    fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
        // SAFETY: never called, or the image would not have been linked.
        unsafe { the_fine_controller_can_panic() }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
