//! A bare shell around the experiment's tick with eight ranges: settings, their check, path, record. What the library
//! adds to `without-tick` is its footprint. Never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use core::mem::MaybeUninit;
    use fixed::types::I16F16;
    use fuzzypilot::geometry::{Point, Pose};
    use fuzzypilot::guide::{Path, Segment};
    use fuzzypilot::ports::Ports;
    use fuzzypilot::presets;
    use fuzzypilot::tick::Robot;
    use fuzzypilot::units::{Angle, Metres};
    use replica::owned::Owned;
    use replica::shell::{Pins, halt};

    static ROBOT: Owned<MaybeUninit<Robot<8>>> = Owned::new(MaybeUninit::uninit());

    static PATH: [Segment; 2] = [
        Segment::arc(
            Point::new(Metres::lit("8"), Metres::lit("10")),
            Metres::lit("8"),
            Angle::deg("180"),
            I16F16::lit("-180"),
        ),
        Segment::arc(
            Point::new(Metres::lit("24"), Metres::lit("10")),
            Metres::lit("8"),
            Angle::deg("180"),
            I16F16::lit("180"),
        ),
    ];

    #[unsafe(no_mangle)]
    extern "C" fn image_main() -> ! {
        let settings = presets::chapter_robot().checked();
        let (Ok(settings), Ok(path)) = (settings, Path::segments(black_box(&PATH), false)) else {
            halt()
        };
        // SAFETY: taken once.
        let place = unsafe { ROBOT.take() };
        let robot = place.write(Robot::new(settings, Pose::default()));
        let mut ports = Ports {
            drive: Pins,
            encoders: Pins,
            ranges: Pins,
        };
        loop {
            black_box(robot.tick(&path, &mut ports));
        }
    }

    #[unsafe(no_mangle)]
    extern "C" fn image_fault() -> ! {
        halt()
    }

    #[panic_handler]
    fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
        halt()
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
