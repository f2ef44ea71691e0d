//! The settings of [`Params`] by number: one table of ids, names, units and formats. Ids are a contract with everybody
//! who wrote one down: they are never given to another setting.
//!
//! A setting travels as the raw integer of its [`Format`]. [`set`] takes what the format can hold; whether the settings
//! can be driven with together, [`Params::check`] says.

use crate::params::{Integrator, Law, MAX_BEAMS, Mount, Params};
use crate::tables::coarse::{CoarseSet, SpeedInput};
use crate::tables::fine::{FineSet, SpeedAxis};
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, Seconds};
use fixed::types::{I16F16, U0F32};

/// What the raw integer of a setting means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Multiples of 2⁻¹⁶.
    Q16,
    /// Multiples of 2⁻²⁴.
    Q24,
    /// Multiples of 2⁻³², unsigned: the 32 bits of a number from 0 to below 1.
    Q32,
    /// Multiples of 2⁻³² turn, half a turn either way.
    Turn,
    /// A whole number from 0 to this.
    Whole(u16),
    /// One of these by its place, 0 first.
    Choice(&'static [&'static str]),
}

/// A setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Its number.
    pub id: u16,
    /// The field, as it is written in the code.
    pub name: &'static str,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// What its raw integer means.
    pub format: Format,
}

/// Why a setting was not changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetError {
    /// No setting has this id, or it belongs to a sensor that is not mounted.
    UnknownId,
    /// The format cannot hold the value.
    NotAllowed,
}

/// A type whose values are raw integers on the wire.
trait Raw {
    fn raw(&self) -> i32;
    /// Whether the value can be taken; if not, it stays.
    fn take(&mut self, raw: i32) -> bool;
}

macro_rules! raw_bits {
    ($($type:ty),*) => {$(
        impl Raw for $type {
            fn raw(&self) -> i32 {
                self.bits()
            }
            fn take(&mut self, raw: i32) -> bool {
                *self = Self::from_bits(raw);
                true
            }
        }
    )*};
}

raw_bits!(Metres, MetresPerSecond, PerMetre, Seconds, Angle);

impl Raw for I16F16 {
    fn raw(&self) -> i32 {
        self.to_bits()
    }
    fn take(&mut self, raw: i32) -> bool {
        *self = Self::from_bits(raw);
        true
    }
}

impl Raw for U0F32 {
    fn raw(&self) -> i32 {
        self.to_bits().cast_signed()
    }
    fn take(&mut self, raw: i32) -> bool {
        *self = Self::from_bits(raw.cast_unsigned());
        true
    }
}

impl Raw for u16 {
    fn raw(&self) -> i32 {
        i32::from(*self)
    }
    fn take(&mut self, raw: i32) -> bool {
        Self::try_from(raw).map(|whole| *self = whole).is_ok()
    }
}

/// An enum's values in the order of their numbers, and what they are called.
macro_rules! choices {
    ($($names:ident $type:ty { $($name:literal $value:expr,)* })*) => {$(
        const $names: Format = Format::Choice(&[$($name),*]);
        impl Raw for $type {
            fn raw(&self) -> i32 {
                [$($value),*].iter().position(|value| value == self).map_or(-1, |i| i as i32)
            }
            fn take(&mut self, raw: i32) -> bool {
                let value = usize::try_from(raw).ok().and_then(|i| [$($value),*].get(i).copied());
                value.map(|value| *self = value).is_some()
            }
        }
    )*};
}

choices! {
    NO_YES bool { "no" false, "yes" true, }
    INTEGRATORS Integrator { "arc" Integrator::Arc, "euler" Integrator::Euler, }
    LAWS Law { "guided" Law::Guided, "paper" Law::Paper, }
    FINE_SETS FineSet {
        "printed" FineSet::Printed, "printed prose" FineSet::PrintedProse, "tuned" FineSet::Tuned,
    }
    SPEED_AXES SpeedAxis { "scaled" SpeedAxis::Scaled, "literal" SpeedAxis::Literal, }
    COARSE_SETS CoarseSet { "corrected" CoarseSet::Corrected, "printed" CoarseSet::Printed, }
    SPEED_INPUTS SpeedInput { "deflection" SpeedInput::Deflection, "bearing" SpeedInput::Bearing, }
}

macro_rules! settings {
    ($($id:literal $unit:literal $format:expr => $first:ident $(.$then:ident)? $([$index:literal])?;)*) => {
        /// The settings by ascending id, without the mounts of the sensors.
        pub const SETTINGS: &[Setting] = &[$(
            Setting {
                id: $id,
                name: concat!(stringify!($first) $(, ".", stringify!($then))? $(, "[", $index, "]")?),
                unit: $unit,
                format: $format,
            },
        )*];

        fn field<const N: usize>(params: &Params<N>, id: u16) -> Option<&dyn Raw> {
            Some(match id {
                $($id => &params.$first $(.$then)? $([$index])?,)*
                _ => return None,
            })
        }

        fn field_mut<const N: usize>(params: &mut Params<N>, id: u16) -> Option<&mut dyn Raw> {
            Some(match id {
                $($id => &mut params.$first $(.$then)? $([$index])?,)*
                _ => return None,
            })
        }
    };
}

use Format::{Q16, Q24, Q32, Turn, Whole};

#[rustfmt::skip]
settings! {
     1 "m"        Q16               => body.radius;
     2 "m"        Q16               => body.track;
     3 "m/count"  Q32               => body.metres_per_count;
    10 "m/s"      Q16               => limits.speed;
    11 "rad/s"    Q16               => limits.yaw_rate;
    12 "m/s^2"    Q16               => limits.acceleration;
    13 "rad/s^2"  Q16               => limits.yaw_acceleration;
    14 "m/s"      Q16               => limits.wheel_speed;
    20 "s"        Q24               => period;
    21 "s"        Q24               => latency;
    22 ""         INTEGRATORS       => integrator;
    30 ""         NO_YES            => ring.closed;
    31 "m"        Q16               => ring.max_range;
    32 "s"        Q24               => ring.max_age;
    33 "m"        Q16               => ring.gap;
    34 "m"        Q16               => ring.radius[0];
    35 "m"        Q16               => ring.radius[1];
    36 "m"        Q16               => ring.residual;
    40 ""         LAWS              => follower.law;
    41 ""         FINE_SETS         => follower.tables;
    42 ""         SPEED_AXES        => follower.speed_axis;
    43 "1/m"      Q16               => follower.distance_scale;
    44 "1/s"      Q16               => follower.deflection_rate;
    45 "1/m"      Q16               => follower.approach_gain;
    46 "turn"     Turn              => follower.approach_angle;
    47 "m"        Q16               => follower.feed_forward_band;
    48 "m/s^2"    Q16               => follower.lateral_acceleration;
    49 "m/s"      Q16               => follower.corner_speed;
    50 "m"        Q16               => follower.reach;
    51 "m"        Q16               => follower.arrival;
    52 "m"        Q16               => follower.end_radius;
    60 ""         COARSE_SETS       => avoider.tables;
    61 ""         SPEED_INPUTS      => avoider.speed_input;
    62 "m"        Q16               => avoider.range;
    63 "m"        Q16               => avoider.margin;
    64 "1/s"      Q16               => avoider.deflection_rate;
    65 "turn"     Turn              => avoider.overshoot;
    70 "m"        Q16               => supervisor.enter;
    71 "m"        Q16               => supervisor.exit;
    72 "ticks"    Whole(u16::MAX)   => supervisor.dwell;
    73 "turn"     Turn              => supervisor.clear;
    74 "turn"     Turn              => supervisor.tie;
    75 "m"        Q16               => supervisor.same;
    76 "ticks"    Whole(u16::MAX)   => supervisor.patience;
    80 "m"        Q16               => guard.margin;
    81 "m/s^2"    Q16               => guard.braking;
}

/// Id of the control period.
pub const PERIOD: u16 = 20;

/// Id of the number of sensors; the mounts of sensor `i` follow it at `MOUNTS + 1 + 4 · i`: x, y, heading, width.
pub const MOUNTS: u16 = 256;

/// What each sensor has.
const MOUNT: [(&str, &str, Format); 4] = [
    ("ring.mounts[i].pose.at.x", "m", Q16),
    ("ring.mounts[i].pose.at.y", "m", Q16),
    ("ring.mounts[i].pose.heading", "turn", Turn),
    ("ring.mounts[i].width", "turn", Turn),
];

/// Which sensor an id belongs to, and which of [`MOUNT`] it is.
fn mount_of(id: u16) -> Option<(usize, usize)> {
    let place = usize::from(id.checked_sub(MOUNTS)?.checked_sub(1)?);
    Some((place >> 2, place & 3))
}

/// What the setting is; mounts for any sensor that [`MAX_BEAMS`] allows.
pub fn describe(id: u16) -> Option<Setting> {
    if id == MOUNTS {
        return Some(Setting {
            id,
            name: "ring.mounts",
            unit: "",
            format: Whole(MAX_BEAMS as u16),
        });
    }
    if let Some((sensor, part)) = mount_of(id) {
        let (name, unit, format) = *MOUNT.get(part)?;
        return (sensor < MAX_BEAMS).then_some(Setting {
            id,
            name,
            unit,
            format,
        });
    }
    SETTINGS.iter().find(|setting| setting.id == id).copied()
}

/// Every setting that a robot with `sensors` range sensors has, by ascending id.
pub fn list(sensors: usize) -> impl Iterator<Item = Setting> {
    let mounts = sensors.min(MAX_BEAMS).saturating_mul(MOUNT.len());
    let ids = (MOUNTS..).take(mounts.saturating_add(1));
    SETTINGS.iter().copied().chain(ids.filter_map(describe))
}

/// The id of the field that a [`ParamError`](crate::params::ParamError) names; of the first, if it names several.
pub fn id_of(field: &str) -> Option<u16> {
    let first = field.split(',').next().unwrap_or(field);
    if first == "ring.mounts" {
        return Some(MOUNTS);
    }
    let names = |setting: &&Setting| {
        let rest = setting.name.strip_prefix(first);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('['))
    };
    SETTINGS.iter().find(names).map(|setting| setting.id)
}

/// The raw value of a setting.
pub fn get<const N: usize>(params: &Params<N>, id: u16) -> Option<i32> {
    if id == MOUNTS {
        return i32::try_from(params.ring.mounts.len()).ok();
    }
    let Some((sensor, part)) = mount_of(id) else {
        return field(params, id).map(Raw::raw);
    };
    let mount = params.ring.mounts.get(sensor)?;
    Some(match part {
        0 => mount.pose.at.x.bits(),
        1 => mount.pose.at.y.bits(),
        2 => mount.pose.heading.bits(),
        _ => mount.width.bits(),
    })
}

/// Changes a setting. Sensors that are added sit at the robot's centre and look ahead.
///
/// # Errors
///
/// Nothing has changed.
pub fn set<const N: usize>(params: &mut Params<N>, id: u16, raw: i32) -> Result<(), SetError> {
    if id == MOUNTS {
        let count = usize::try_from(raw).map_err(|_| SetError::NotAllowed)?;
        if count > N {
            return Err(SetError::NotAllowed);
        }
        let mounts = &mut params.ring.mounts;
        mounts.truncate(count);
        while mounts.len() < count && mounts.push(Mount::default()).is_ok() {}
        return Ok(());
    }
    let Some((sensor, part)) = mount_of(id) else {
        let field = field_mut(params, id).ok_or(SetError::UnknownId)?;
        return match field.take(raw) {
            true => Ok(()),
            false => Err(SetError::NotAllowed),
        };
    };
    let mounts = &mut params.ring.mounts;
    let mount = mounts.get_mut(sensor).ok_or(SetError::UnknownId)?;
    match part {
        0 => mount.pose.at.x = Metres::from_bits(raw),
        1 => mount.pose.at.y = Metres::from_bits(raw),
        2 => mount.pose.heading = Angle::from_bits(raw),
        _ => mount.width = Angle::from_bits(raw),
    }
    Ok(())
}
