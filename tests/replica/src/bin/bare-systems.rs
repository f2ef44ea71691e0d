//! The systems of `replica::systems` and nothing else. Its panic handler calls what nobody has written: that it links shows
//! that no evaluation can panic. Never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use replica::shell::halt;
    use replica::systems::{CROWD, CURVED, MAMDANI, TABLE};

    #[unsafe(no_mangle)]
    extern "C" fn image_main() -> ! {
        loop {
            let inputs = black_box([0; 3]);
            let [x, y, _] = inputs;
            black_box(TABLE.evaluate([x, y]));
            black_box(CURVED.evaluate(inputs));
            black_box(MAMDANI.evaluate([x, y]));
            black_box(CROWD.evaluate([x]));
            // And one that is not known here.
            let (mut terms, mut rules, mut outputs) = black_box(Default::default());
            let system = black_box(TABLE.system());
            let _ = black_box(evaluate(
                system,
                &inputs,
                &mut terms,
                &mut rules,
                &mut outputs,
            ));
        }
    }

    use fuzzypilot::fuzzy::system::{Degree, System, WrongSize};

    fn evaluate(
        system: &System<'_>,
        inputs: &[i32; 3],
        terms: &mut [Degree; 6],
        rules: &mut [Degree; 9],
        outputs: &mut [i32; 1],
    ) -> Result<(), WrongSize> {
        let inputs = inputs.get(..2).unwrap_or_default();
        system.evaluate(inputs, terms, rules, outputs)
    }

    #[unsafe(no_mangle)]
    extern "C" fn image_fault() -> ! {
        halt()
    }

    #[panic_handler]
    fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
        unsafe extern "C" {
            fn a_panic_is_left_in_the_image() -> !;
        }
        // SAFETY: there is no such function; the linker says so if it is ever called.
        unsafe { a_panic_is_left_in_the_image() }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
