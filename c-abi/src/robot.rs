//! The robot: settings, and everything that it remembers from tick to tick, in the caller's memory.

use crate::pointer;
use crate::status::FpStatus;
use crate::storage::{self, Storage};
use crate::text;
use core::ffi::c_char;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::link::settings::{self, SetError};
use fuzzypilot::params::{Mount, Params};
use fuzzypilot::presets;
use fuzzypilot::tick::Robot;
use fuzzypilot::units::{Angle, Metres};

/// The most range sensors of a robot.
pub const FP_SENSORS_MAX: usize = 64;
/// Words of an fp_robot.
pub const FP_ROBOT_WORDS: usize = 490;

/// A place and a heading, world.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpPose {
    /// Forward or east, m / 2^16.
    pub x: i32,
    /// Left or north, m / 2^16.
    pub y: i32,
    /// Counter-clockwise from x, turn / 2^32.
    pub heading: i32,
}

impl From<FpPose> for Pose {
    fn from(pose: FpPose) -> Self {
        Self::new(
            Point::new(Metres::from_bits(pose.x), Metres::from_bits(pose.y)),
            Angle::from_bits(pose.heading),
        )
    }
}

impl From<Pose> for FpPose {
    fn from(pose: Pose) -> Self {
        Self {
            x: pose.at.x.bits(),
            y: pose.at.y.bits(),
            heading: pose.heading.bits(),
        }
    }
}

/// Complete settings to start from.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpPreset {
    /// 0.2 m across, 1 m/s, a tick every 50 ms, tuned tables, guided law.
    SmallRobot = 0,
    /// The chapter's: 0.4 m across, 0.3 m/s, a tick every second, printed tables, guided law.
    ChapterRobot = 1,
}

/// Memory for a robot. What is in it is the library's; it may be copied, and needs no end.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FpRobot {
    /// Not for use.
    pub opaque: [u64; FP_ROBOT_WORDS],
}

/// What lives there.
pub(crate) struct State {
    pub(crate) robot: Robot<FP_SENSORS_MAX>,
    /// Whether the settings are as they were when they were checked.
    pub(crate) started: bool,
}

// SAFETY: integers; fits.
unsafe impl Storage for FpRobot {
    type Tenant = State;
    const MARK: u32 = u32::from_le_bytes(*b"fpR1");
}
const _: () = assert!(storage::fits::<FpRobot>(), "FP_ROBOT_WORDS is too small");

/// sizeof(fp_robot), as the library has it.
#[unsafe(no_mangle)]
pub extern "C" fn fp_robot_size() -> usize {
    size_of::<FpRobot>()
}

/// Takes over everything but the mounts.
fn adopt<const N: usize>(params: &mut Params<FP_SENSORS_MAX>, from: &Params<N>) {
    params.body = from.body;
    params.limits = from.limits;
    params.period = from.period;
    params.latency = from.latency;
    params.integrator = from.integrator;
    params.ring.closed = from.ring.closed;
    params.ring.max_range = from.ring.max_range;
    params.ring.max_age = from.ring.max_age;
    params.ring.gap = from.ring.gap;
    params.ring.radius = from.ring.radius;
    params.ring.residual = from.ring.residual;
    params.follower = from.follower;
    params.avoider = from.avoider;
    params.supervisor = from.supervisor;
    params.guard = from.guard;
}

/// Mounts `count` beams at the robot's centre, evenly all round, the first one looking back: what the presets have.
fn mount(params: &mut Params<FP_SENSORS_MAX>, count: u32) {
    let mounts = &mut params.ring.mounts;
    mounts.clear();
    // Beam i looks at the floor of i · 2^32 / count: whole steps, and a rest that is carried.
    let (last, over) = (
        u32::MAX.checked_div(count).unwrap_or(0),
        u32::MAX.checked_rem(count).unwrap_or(0).wrapping_add(1),
    );
    let (mut turn, mut rest) = (0u32, 0u32);
    for _ in 0..count {
        let mut mount = Mount::default();
        mount.pose.heading = Angle::from_bits(turn.cast_signed()) + Angle::HALF;
        // There is room: the count was checked.
        let _ = mounts.push(mount);
        turn = turn.wrapping_add(last);
        rest = rest.wrapping_add(over);
        if rest >= count {
            rest = rest.wrapping_sub(count);
            turn = turn.wrapping_add(1);
        }
    }
}

/// Makes a robot in the caller's memory, with a preset's settings (one of fp_preset) and so many range sensors, 1 to
/// FP_SENSORS_MAX: beams at its centre, evenly all round, counter-clockwise, the first one looking back. It rests at
/// `start`, ready to tick. `size` is sizeof(fp_robot).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_init(
    robot: *mut FpRobot,
    size: usize,
    preset: i32,
    sensors: u32,
    start: *const FpPose,
) -> FpStatus {
    static FRESH: Robot<FP_SENSORS_MAX> = Robot::new(presets::small_robot(), REST);
    const REST: Pose = Pose::new(Point::new(Metres::ZERO, Metres::ZERO), Angle::ZERO);
    // SAFETY: the contract of `pointer`; the tenant is written.
    let init = || unsafe {
        let start = Pose::from(*pointer::read(start)?);
        if !(1..=FP_SENSORS_MAX as u32).contains(&sensors) {
            return Err(FpStatus::SettingNotAllowed);
        }
        if !(0..2).contains(&preset) {
            return Err(FpStatus::UnknownChoice);
        }
        storage::move_in(robot, size, |place| {
            let state = place.as_mut_ptr();
            // Byte by byte from flash: on the stack it would need as much again.
            core::ptr::copy_nonoverlapping(&raw const FRESH, &raw mut (*state).robot, 1);
            (&raw mut (*state).started).write(true);
        })?;
        let state = storage::tenant_mut(robot)?;
        let params = state.robot.params_mut();
        if preset == 1 {
            adopt(params, &presets::chapter_robot::<1>());
        }
        mount(params, sensors);
        state
            .robot
            .restart(start)
            .map_err(|_| FpStatus::SettingNotAllowed)
    };
    init().into()
}

/// The raw value of a setting: one of fp_setting, or a mount of a sensor (FP_MOUNT_X and its like).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_get(robot: *const FpRobot, id: u16, value: *mut i32) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let get = || unsafe {
        let (state, place) = (storage::tenant(robot)?, pointer::room(value)?);
        let raw = settings::get(state.robot.params(), id).ok_or(FpStatus::UnknownSetting)?;
        place.write(raw);
        Ok(())
    };
    get().into()
}

/// Changes a setting: one of fp_setting, or a mount of a sensor. Before the next tick comes fp_robot_restart, which
/// checks all of them together. Sensors that are added by a larger FP_SETTING_RING_MOUNTS sit at the robot's centre and
/// look ahead.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_set(robot: *mut FpRobot, id: u16, value: i32) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let set = || unsafe {
        let state = storage::tenant_mut(robot)?;
        settings::set(state.robot.params_mut(), id, value).map_err(|error| match error {
            SetError::UnknownId => FpStatus::UnknownSetting,
            SetError::NotAllowed => FpStatus::SettingNotAllowed,
        })?;
        state.started = false;
        Ok(())
    };
    set().into()
}

/// Checks the settings, forgets everything and begins anew at rest at `start` and at the beginning of its path. If a
/// setting forbids it, nothing is forgotten; `id`, if not null, then tells which, and fp_robot_flaw says why.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_restart(
    robot: *mut FpRobot,
    start: *const FpPose,
    id: *mut u16,
) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let restart = || unsafe {
        let start = Pose::from(*pointer::read(start)?);
        let id = pointer::optional_room(id)?;
        let state = storage::tenant_mut(robot)?;
        state.robot.restart(start).map_err(|error| {
            if let Some(id) = id {
                id.write(settings::id_of(error.field).unwrap_or(0));
            }
            FpStatus::SettingNotAllowed
        })?;
        state.started = true;
        Ok(())
    };
    restart().into()
}

/// Writes why the robot cannot be driven with its settings into `text`, which has room for `room` bytes, its end
/// included: the first setting that forbids it, and what is allowed; cut off where there is no room. Empty if nothing
/// forbids it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_flaw(
    robot: *const FpRobot,
    text: *mut c_char,
    room: usize,
) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let tell = || unsafe {
        let state = storage::tenant(robot)?;
        match state.robot.params().check() {
            Ok(()) => text::write(text, room, &[]),
            Err(error) => text::write(text, room, &[error.field, ": allowed is ", error.allowed]),
        }
    };
    tell().into()
}

/// Writes the name of a setting, and its unit if it has one, into `text`, which has room for `room` bytes, its end
/// included; cut off where there is no room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_setting_text(id: u16, text: *mut c_char, room: usize) -> FpStatus {
    let tell = || {
        let found = settings::describe(id).ok_or(FpStatus::UnknownSetting)?;
        let parts: &[&str] = match found.unit {
            "" => &[found.name],
            unit => &[found.name, ", ", unit],
        };
        // SAFETY: the contract of `pointer`.
        unsafe { text::write(text, room, parts) }
    };
    tell().into()
}

/// Where the robot believes to be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_pose(robot: *const FpRobot, pose: *mut FpPose) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let get = || unsafe {
        let (state, place) = (storage::tenant(robot)?, pointer::room(pose)?);
        place.write(state.robot.pose().into());
        Ok(())
    };
    get().into()
}

/// Puts the robot to the beginning of a new path; where it is, it goes on believing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_restart_path(robot: *mut FpRobot) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let restart = || unsafe {
        storage::tenant_mut(robot)?.robot.restart_path();
        Ok(())
    };
    restart().into()
}
