//! The functions, called as C calls them: what they give is the library's, and what is wrong is answered, not done.

use fixed::types::I16F16;
use fuzzypilot::behaviour::fine::FineController;
use fuzzypilot::geometry::Pose;
use fuzzypilot::link::settings;
use fuzzypilot::params::{Follower, Limits, Params};
use fuzzypilot::ports::{Fault, Ports, Side, WheelCounts, WheelDrive, WheelEncoders};
use fuzzypilot::presets;
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};
use fuzzypilot::tables::fine::{FineSet, SpeedAxis};
use fuzzypilot::tick::Robot;
use fuzzypilot::units::{Angle, Metres, MetresPerSecond};
use fuzzypilot_c::coarse::*;
use fuzzypilot_c::fine::*;
use fuzzypilot_c::path::*;
use fuzzypilot_c::robot::*;
use fuzzypilot_c::status::{FpStatus, fp_status_text};
use fuzzypilot_c::tick::*;
use std::convert::Infallible;
use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

const ORIGIN: FpPose = FpPose {
    x: 0,
    y: 0,
    heading: 0,
};

fn zeroed<T>() -> T {
    // SAFETY: used for structs of integers and pointers only.
    unsafe { MaybeUninit::zeroed().assume_init() }
}

fn robot(preset: FpPreset, sensors: u32) -> Box<FpRobot> {
    let mut robot: Box<FpRobot> = Box::new(zeroed());
    // SAFETY: the pointers are references.
    let status = unsafe {
        fp_robot_init(
            &mut *robot,
            size_of::<FpRobot>(),
            preset as i32,
            sensors,
            &ORIGIN,
        )
    };
    assert_eq!(status, FpStatus::Ok);
    robot
}

fn line(length: i32) -> FpSegment {
    FpSegment {
        extent: length,
        ..FpSegment::default()
    }
}

fn path(segments: &[FpSegment]) -> FpPath {
    let mut path = zeroed();
    // SAFETY: the pointers are references.
    unsafe {
        assert_eq!(fp_path_init(&mut path, size_of::<FpPath>()), FpStatus::Ok);
        let set = fp_path_set_segments(&mut path, segments.as_ptr(), segments.len(), 0, null_mut());
        assert_eq!(set, FpStatus::Ok);
    }
    path
}

fn text(write: impl FnOnce(*mut std::ffi::c_char, usize) -> FpStatus, room: usize) -> String {
    let mut bytes = vec![0x55u8; room + 1];
    assert_eq!(write(bytes.as_mut_ptr().cast(), room), FpStatus::Ok);
    assert_eq!(bytes[room], 0x55, "more was written than there is room for");
    let text = CStr::from_bytes_until_nul(&bytes[..room]).unwrap();
    text.to_str().unwrap().to_owned()
}

#[test]
fn every_status_has_a_text_of_its_own() {
    let text = |status| {
        // SAFETY: a C string that lives for ever.
        unsafe { CStr::from_ptr(fp_status_text(status)) }
            .to_str()
            .unwrap()
    };
    let last = FpStatus::PathGap as i32;
    let texts: std::collections::BTreeSet<&str> = (-1..=last).map(text).collect();
    assert_eq!(texts.len(), last as usize + 2);
    assert_eq!(text(last + 1), text(-1));
    assert_eq!(text(i32::MIN), text(-1));
}

#[test]
fn the_fine_controller_is_the_librarys() {
    for (tables, set) in [FineSet::Printed, FineSet::PrintedProse, FineSet::Tuned]
        .into_iter()
        .enumerate()
    {
        for (axis, speed_axis) in [SpeedAxis::Scaled, SpeedAxis::Literal]
            .into_iter()
            .enumerate()
        {
            let settings = FpFineSettings {
                tables: tables as i32,
                speed_axis: axis as i32,
                distance_scale: 10 << 16,
                deflection_rate: 324_534,
                top_speed: 1 << 16,
            };
            let mut fine = zeroed();
            let small: Params<1> = presets::small_robot();
            let wanted = FineController::new(
                &Follower {
                    tables: set,
                    speed_axis,
                    distance_scale: I16F16::lit("10"),
                    deflection_rate: I16F16::from_bits(324_534),
                    ..small.follower
                },
                &Limits {
                    speed: MetresPerSecond::lit("1"),
                    ..small.limits
                },
            );
            // SAFETY: the pointers are references.
            unsafe {
                let status = fp_fine_init(&mut fine, size_of::<FpFine>(), &settings);
                assert_eq!(status, FpStatus::Ok);
            }
            for d in (-20_000..80_000).step_by(7919) {
                for error in (i32::MIN..i32::MAX).step_by(123_456_789) {
                    let mut motion = FpFineMotion::default();
                    // SAFETY: the pointers are references.
                    let status = unsafe { fp_fine_evaluate(&fine, d, error, &mut motion) };
                    assert_eq!(status, FpStatus::Ok);
                    let of = wanted.evaluate(Metres::from_bits(d), Angle::from_bits(error));
                    assert_eq!(motion.speed, of.speed.bits());
                    assert_eq!(motion.yaw_rate, of.yaw_rate.bits());
                }
            }
        }
    }
}

#[test]
fn tables_are_the_librarys_with_their_rules() {
    for (tables, set) in [FineSet::Printed, FineSet::PrintedProse, FineSet::Tuned]
        .into_iter()
        .enumerate()
    {
        for [d, phi] in [
            [0, 0],
            [78_643, 100 << 16],
            [-1, 181 << 16],
            [3 << 16, 45 << 16],
        ] {
            let mut output = FpFineOutput::default();
            // SAFETY: the pointer is a reference.
            let status = unsafe { fp_fine_tables_evaluate(tables as i32, d, phi, &mut output) };
            assert_eq!(status, FpStatus::Ok);
            let wanted = set
                .tables()
                .evaluate(I16F16::from_bits(d), I16F16::from_bits(phi));
            assert_eq!(output.speed, wanted.speed.to_bits());
            assert_eq!(output.deflection, wanted.deflection.to_bits());
            let rules = wanted.activation.fired();
            assert_eq!(usize::from(output.rule_count), rules.len());
            for (found, wanted) in output.rules.iter().zip(&rules) {
                assert_eq!(
                    (found.row, found.col, found.degree),
                    (wanted.row, wanted.col, wanted.degree.bits())
                );
            }
        }
    }
    for (tables, set) in [CoarseSet::Corrected, CoarseSet::Printed]
        .into_iter()
        .enumerate()
    {
        for (input, which) in [SpeedInput::Deflection, SpeedInput::Bearing]
            .into_iter()
            .enumerate()
        {
            for [s, theta] in [[0, 60 << 16], [20_000, -(30 << 16)], [1 << 17, 0]] {
                let mut output = FpCoarseOutput::default();
                // SAFETY: the pointer is a reference.
                let status = unsafe {
                    fp_coarse_evaluate(tables as i32, input as i32, s, theta, &mut output)
                };
                assert_eq!(status, FpStatus::Ok);
                let (s, theta) = (I16F16::from_bits(s), I16F16::from_bits(theta));
                let wanted = set.tables().evaluate(s, theta, which);
                assert_eq!(output.deflection, wanted.deflection.to_bits());
                assert_eq!(output.speed, wanted.speed.to_bits());
                let fired = [wanted.deflection_rules.fired(), wanted.speed_rules.fired()];
                let found = [
                    (output.deflection_rules, output.deflection_rule_count),
                    (output.speed_rules, output.speed_rule_count),
                ];
                for (wanted, (rules, count)) in fired.iter().zip(found) {
                    assert_eq!(usize::from(count), wanted.len());
                    assert!(
                        rules
                            .iter()
                            .zip(wanted)
                            .all(|(a, b)| a.degree == b.degree.bits())
                    );
                }
            }
        }
    }
}

#[test]
fn robots_have_the_presets_settings() {
    fn same<const N: usize>(preset: FpPreset, wanted: &Params<N>) {
        let robot = robot(preset, N as u32);
        for setting in settings::list(N) {
            let mut value = 0;
            // SAFETY: the pointers are references.
            let status = unsafe { fp_robot_get(&*robot, setting.id, &mut value) };
            assert_eq!(status, FpStatus::Ok);
            assert_eq!(
                Some(value),
                settings::get(wanted, setting.id),
                "{setting:?}"
            );
        }
    }
    same::<8>(FpPreset::SmallRobot, &presets::small_robot());
    same::<64>(FpPreset::SmallRobot, &presets::small_robot());
    same::<7>(FpPreset::SmallRobot, &presets::small_robot());
    same::<1>(FpPreset::ChapterRobot, &presets::chapter_robot());
    same::<33>(FpPreset::ChapterRobot, &presets::chapter_robot());
}

#[test]
fn settings_are_checked_before_the_robot_drives() {
    let (mut robot, path) = (robot(FpPreset::SmallRobot, 2), path(&[line(1 << 16)]));
    let readings = [FpReading::default(); 2];
    let inputs = FpInputs {
        readings: readings.as_ptr(),
        reading_count: 2,
        ..zeroed()
    };
    let mut record = FpRecord::default();
    // SAFETY: the pointers are references.
    unsafe {
        let set = |robot: &mut FpRobot, id, value| fp_robot_set(robot, id, value);
        assert_eq!(set(&mut robot, 999, 0), FpStatus::UnknownSetting);
        assert_eq!(set(&mut robot, 22, 2), FpStatus::SettingNotAllowed);
        assert_eq!(set(&mut robot, 256, 65), FpStatus::SettingNotAllowed);
        // Refused, and so nothing has changed.
        assert_eq!(
            fp_robot_tick(&mut *robot, &path, &inputs, &mut record),
            FpStatus::Ok
        );
        assert_eq!(set(&mut robot, 10, 0), FpStatus::Ok);
        let tick = fp_robot_tick(&mut *robot, &path, &inputs, &mut record);
        assert_eq!(tick, FpStatus::NotStarted);
        assert_eq!(fp_robot_rest(&mut *robot, &inputs), FpStatus::NotStarted);
        let mut id = 0;
        let restart = fp_robot_restart(&mut *robot, &ORIGIN, &mut id);
        assert_eq!((restart, id), (FpStatus::SettingNotAllowed, 10));
        let flaw = text(|at, room| fp_robot_flaw(&*robot, at, room), 80);
        assert_eq!(flaw, "limits.speed: allowed is above 0");
        let cut = text(|at, room| fp_robot_flaw(&*robot, at, room), 8);
        assert_eq!(cut, "limits.");
        assert_eq!(set(&mut robot, 10, 1 << 15), FpStatus::Ok);
        let restart = fp_robot_restart(&mut *robot, &ORIGIN, null_mut());
        assert_eq!(restart, FpStatus::Ok);
        assert_eq!(text(|at, room| fp_robot_flaw(&*robot, at, room), 80), "");
        assert_eq!(
            fp_robot_tick(&mut *robot, &path, &inputs, &mut record),
            FpStatus::Ok
        );
        assert_eq!(record.tick, 0);
        // With more sensors, as many readings belong to it.
        assert_eq!(set(&mut robot, 256, 3), FpStatus::Ok);
        assert_eq!(
            fp_robot_restart(&mut *robot, &ORIGIN, null_mut()),
            FpStatus::Ok
        );
        let tick = fp_robot_tick(&mut *robot, &path, &inputs, &mut record);
        assert_eq!(tick, FpStatus::WrongSize);
        assert_eq!(
            text(|at, room| fp_setting_text(12, at, room), 80),
            "limits.acceleration, m/s^2"
        );
        assert_eq!(
            text(|at, room| fp_setting_text(22, at, room), 80),
            "integrator"
        );
        assert_eq!(text(|at, room| fp_setting_text(22, at, room), 1), "");
        let mut byte = 0;
        assert_eq!(fp_setting_text(999, &mut byte, 1), FpStatus::UnknownSetting);
        assert_eq!(fp_setting_text(22, &mut byte, 0), FpStatus::WrongSize);
    }
}

#[test]
fn paths_are_checked() {
    let mut path: FpPath = zeroed();
    let mut length = 0;
    let mut piece = 99;
    // SAFETY: the pointers are references, the counts theirs.
    unsafe {
        assert_eq!(fp_path_length(&path, &mut length), FpStatus::NotInitialised);
        assert_eq!(fp_path_init(&mut path, size_of::<FpPath>()), FpStatus::Ok);
        assert_eq!(fp_path_length(&path, &mut length), FpStatus::NoPath);
        let mut set = |path: &mut FpPath, segments: &[FpSegment], flags| {
            piece = 99;
            let at = segments.as_ptr();
            let status = fp_path_set_segments(path, at, segments.len(), flags, &mut piece);
            (status, piece)
        };
        let metre = line(1 << 16);
        let beyond = FpSegment {
            x: 1 << 17,
            ..metre
        };
        let odd = FpSegment { kind: 2, ..metre };
        assert_eq!(set(&mut path, &[], 0), (FpStatus::PathTooShort, 0));
        assert_eq!(set(&mut path, &[metre], 0), (FpStatus::Ok, 99));
        assert_eq!(set(&mut path, &[metre], 4), (FpStatus::UnknownChoice, 99));
        assert_eq!(set(&mut path, &[metre; 65], 2), (FpStatus::PathTooLong, 99));
        // Refused before the path was touched.
        assert_eq!(fp_path_length(&path, &mut length), FpStatus::Ok);
        assert_eq!(length, 1 << 16);
        assert_eq!(set(&mut path, &[metre; 64], 2), (FpStatus::Ok, 99));
        assert_eq!(set(&mut path, &[metre, beyond], 0), (FpStatus::PathGap, 1));
        assert_eq!(fp_path_length(&path, &mut length), FpStatus::NoPath);
        assert_eq!(set(&mut path, &[metre, beyond], 2), (FpStatus::Ok, 99));
        assert_eq!(
            set(&mut path, &[metre, line(0)], 2),
            (FpStatus::PathDegenerate, 1)
        );
        assert_eq!(
            set(&mut path, &[metre, odd], 0),
            (FpStatus::UnknownChoice, 1)
        );
        let arc = FpSegment {
            kind: 1,
            extent: 1 << 16,
            sweep: 1 << 24,
            ..FpSegment::default()
        };
        assert_eq!(set(&mut path, &[arc], FP_PATH_CLOSED), (FpStatus::Ok, 99));
        assert_eq!(fp_path_length(&path, &mut length), FpStatus::Ok);
        assert_eq!(length, 411_774, "a circle of radius 1");

        let points: Vec<FpPose> = (0..129)
            .map(|i| FpPose {
                x: i << 16,
                ..ORIGIN
            })
            .collect();
        let mut set =
            |count, flags| fp_path_set_points(&mut path, points.as_ptr(), count, flags, null_mut());
        assert_eq!(set(129, 0), FpStatus::PathTooLong);
        assert_eq!(set(2, FP_PATH_GAPS), FpStatus::UnknownChoice);
        assert_eq!(set(1, 0), FpStatus::PathTooShort);
        assert_eq!(set(128, 0), FpStatus::Ok);
        assert_eq!(set(usize::MAX, 0), FpStatus::WrongSize);
        assert_eq!(fp_path_length(&path, &mut length), FpStatus::Ok);
        assert_eq!(length, 127 << 16);
        let same = [ORIGIN; 3];
        let status = fp_path_set_points(&mut path, same.as_ptr(), 3, 0, &mut piece);
        assert_eq!((status, piece), (FpStatus::PathDegenerate, 0));
    }
}

#[test]
fn wrong_inputs_drive_no_tick() {
    let (mut robot, path) = (robot(FpPreset::SmallRobot, 1), path(&[line(1 << 16)]));
    let mut record = FpRecord::default();
    let mut tick = |fault, reading: FpReading| {
        let inputs = FpInputs {
            counts_fault: fault,
            readings: &reading,
            reading_count: 1,
            ..zeroed()
        };
        // SAFETY: the pointers are references.
        let status = unsafe { fp_robot_tick(&mut *robot, &path, &inputs, &mut record) };
        (status, record.tick, record.valid_ranges)
    };
    let clear = FpReading {
        kind: 1,
        ..FpReading::default()
    };
    let odd = FpReading { kind: 3, ..clear };
    let odder = FpReading {
        kind: 0,
        fault: 6,
        ..clear
    };
    assert_eq!(tick(0, clear), (FpStatus::Ok, 0, 1));
    assert_eq!(tick(6, clear).0, FpStatus::UnknownChoice);
    assert_eq!(tick(-1, clear).0, FpStatus::UnknownChoice);
    assert_eq!(tick(0, odd).0, FpStatus::UnknownChoice);
    assert_eq!(tick(0, odder).0, FpStatus::UnknownChoice);
    assert_eq!(tick(5, FpReading::default()), (FpStatus::Ok, 1, 0));
}

/// Ports of the library's own robot, beside the one for C.
struct Counted(i32);

impl WheelEncoders for Counted {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        let [left, right] = [self.0, self.0 / 2];
        Ok(WheelCounts { left, right })
    }
}

impl WheelDrive for Counted {
    type Error = Infallible;

    fn set_speed(&mut self, _: Side, _: MetresPerSecond) -> Result<(), Infallible> {
        Ok(())
    }
}

#[test]
fn dead_reckoning_goes_on_at_rest() {
    let mut robot = robot(FpPreset::SmallRobot, 1);
    let mut beside = Robot::new(presets::small_robot::<1>(), Pose::default());
    let mut pose = FpPose::default();
    for counts in [0, 1 << 17, 1 << 18] {
        let mut ports = Ports {
            drive: Counted(counts),
            encoders: Counted(counts),
            ranges: (),
        };
        beside.rest(&mut ports);
        let inputs = FpInputs {
            left: counts,
            right: counts / 2,
            ..zeroed()
        };
        // SAFETY: the pointers are references.
        unsafe {
            assert_eq!(fp_robot_rest(&mut *robot, &inputs), FpStatus::Ok);
            assert_eq!(fp_robot_pose(&*robot, &mut pose), FpStatus::Ok);
        }
        assert_eq!(pose, FpPose::from(beside.pose()));
    }
    assert!(pose.x > 0 && pose.heading < 0, "{pose:?}");
}

#[test]
fn pointers_and_sizes_are_checked() {
    use FpStatus::{Misaligned, NotInitialised, NullPointer, WrongSize};
    let mut robot = robot(FpPreset::SmallRobot, 1);
    let mut fresh: FpRobot = zeroed();
    let mut path = path(&[line(1 << 16)]);
    let (mut fine, mut motion): (FpFine, _) = (zeroed(), FpFineMotion::default());
    let settings = FpFineSettings {
        tables: 0,
        speed_axis: 0,
        distance_scale: 1,
        deflection_rate: 1,
        top_speed: 1,
    };
    let (mut record, mut value) = (FpRecord::default(), 0);
    let reading = FpReading::default();
    let inputs = FpInputs {
        readings: &reading,
        reading_count: 1,
        ..zeroed()
    };
    let nowhere = FpInputs {
        readings: null(),
        ..inputs
    };
    // SAFETY: what is neither null nor misaligned is a reference.
    unsafe {
        let askew = (&raw mut fresh).byte_add(4);
        let size = size_of::<FpRobot>();
        assert_eq!(fp_robot_size(), size);
        assert_eq!(fp_path_size(), size_of::<FpPath>());
        assert_eq!(fp_robot_init(null_mut(), size, 0, 8, &ORIGIN), NullPointer);
        assert_eq!(fp_robot_init(askew, size, 0, 8, &ORIGIN), Misaligned);
        assert_eq!(
            fp_robot_init(&mut fresh, size - 8, 0, 8, &ORIGIN),
            WrongSize
        );
        assert_eq!(fp_robot_init(&mut fresh, size, 0, 8, null()), NullPointer);
        assert_eq!(
            fp_robot_init(&mut fresh, size, 2, 8, &ORIGIN),
            FpStatus::UnknownChoice
        );
        for sensors in [0, 65, u32::MAX] {
            let status = fp_robot_init(&mut fresh, size, 0, sensors, &ORIGIN);
            assert_eq!(status, FpStatus::SettingNotAllowed);
        }
        assert_eq!(fp_robot_get(&fresh, 1, &mut value), NotInitialised);
        assert_eq!(fp_robot_get(&*robot, 1, null_mut()), NullPointer);
        assert_eq!(fp_robot_set(&mut fresh, 1, 1), NotInitialised);
        assert_eq!(fp_robot_restart_path(&mut fresh), NotInitialised);
        assert_eq!(
            fp_robot_restart(&mut *robot, null(), null_mut()),
            NullPointer
        );
        assert_eq!(fp_robot_pose(&*robot, null_mut()), NullPointer);
        assert_eq!(fp_robot_flaw(&*robot, null_mut(), 8), NullPointer);
        assert_eq!(
            fp_robot_tick(&mut fresh, &path, &inputs, &mut record),
            NotInitialised
        );
        assert_eq!(
            fp_robot_tick(&mut *robot, null(), &inputs, &mut record),
            NullPointer
        );
        assert_eq!(
            fp_robot_tick(&mut *robot, &path, null(), &mut record),
            NullPointer
        );
        assert_eq!(
            fp_robot_tick(&mut *robot, &path, &nowhere, &mut record),
            NullPointer
        );
        assert_eq!(
            fp_robot_tick(&mut *robot, &path, &inputs, null_mut()),
            NullPointer
        );
        assert_eq!(fp_robot_rest(&mut *robot, null()), NullPointer);
        assert_eq!(fp_path_init(&mut path, 0), WrongSize);
        let set = fp_path_set_segments(&mut path, null(), 1, 0, null_mut());
        assert_eq!(set, NullPointer);
        assert_eq!(fp_fine_evaluate(&fine, 0, 0, &mut motion), NotInitialised);
        assert_eq!(fp_fine_init(&mut fine, 0, &settings), WrongSize);
        for broken in [
            FpFineSettings {
                top_speed: 0,
                ..settings
            },
            FpFineSettings {
                distance_scale: -1,
                ..settings
            },
            FpFineSettings {
                deflection_rate: 0,
                ..settings
            },
        ] {
            let status = fp_fine_init(&mut fine, size_of::<FpFine>(), &broken);
            assert_eq!(status, FpStatus::SettingNotAllowed);
        }
        let odd = FpFineSettings {
            tables: 3,
            ..settings
        };
        let status = fp_fine_init(&mut fine, size_of::<FpFine>(), &odd);
        assert_eq!(status, FpStatus::UnknownChoice);
        assert_eq!(
            fp_fine_init(&mut fine, size_of::<FpFine>(), &settings),
            FpStatus::Ok
        );
        assert_eq!(fp_fine_evaluate(&fine, 0, 0, null_mut()), NullPointer);
        assert_eq!(fp_fine_tables_evaluate(0, 0, 0, null_mut()), NullPointer);
        assert_eq!(fp_coarse_evaluate(0, 0, 0, 0, null_mut()), NullPointer);
        assert_eq!(
            fp_coarse_evaluate(2, 0, 0, 0, null_mut()),
            FpStatus::UnknownChoice
        );
        assert_eq!(
            fp_coarse_evaluate(0, 2, 0, 0, null_mut()),
            FpStatus::UnknownChoice
        );
        // A storage may be copied.
        let copy = *robot;
        assert_eq!(fp_robot_get(&copy, 1, &mut value), FpStatus::Ok);
    }
}

#[test]
fn the_page_has_the_sizes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/c.md");
    let page = std::fs::read_to_string(path).unwrap();
    for (name, size) in [
        ("fp_robot", size_of::<FpRobot>()),
        ("fp_path", size_of::<FpPath>()),
        ("fp_fine", size_of::<FpFine>()),
    ] {
        let row = page.lines().find(|l| l.starts_with(&format!("| `{name}`")));
        let cell = row.and_then(|row| row.split('|').nth(2)).unwrap();
        assert_eq!(cell.trim().replace(',', ""), size.to_string(), "{name}");
    }
}
