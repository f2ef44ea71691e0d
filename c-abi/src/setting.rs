//! The settings' ids by name. They are the link's (`fuzzypilot::link::settings`), and so are their meanings; a test
//! compares.

/// Ids of settings, for fp_robot_get and fp_robot_set.
#[repr(u16)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpSetting {
    /// body.radius: m / 2^16.
    BodyRadius = 1,
    /// body.track: m / 2^16.
    BodyTrack = 2,
    /// body.metres_per_count: m/count / 2^32, unsigned.
    BodyMetresPerCount = 3,
    /// limits.speed: m/s / 2^16.
    LimitsSpeed = 10,
    /// limits.yaw_rate: rad/s / 2^16.
    LimitsYawRate = 11,
    /// limits.acceleration: m/s^2 / 2^16.
    LimitsAcceleration = 12,
    /// limits.yaw_acceleration: rad/s^2 / 2^16.
    LimitsYawAcceleration = 13,
    /// limits.wheel_speed: m/s / 2^16.
    LimitsWheelSpeed = 14,
    /// period: s / 2^24.
    Period = 20,
    /// latency: s / 2^24.
    Latency = 21,
    /// integrator: 0 arc, 1 euler.
    Integrator = 22,
    /// ring.closed: 0 no, 1 yes.
    RingClosed = 30,
    /// ring.max_range: m / 2^16.
    RingMaxRange = 31,
    /// ring.max_age: s / 2^24.
    RingMaxAge = 32,
    /// ring.gap: m / 2^16.
    RingGap = 33,
    /// ring.radius, smallest: m / 2^16.
    RingRadiusSmallest = 34,
    /// ring.radius, largest: m / 2^16.
    RingRadiusLargest = 35,
    /// ring.residual: m / 2^16.
    RingResidual = 36,
    /// follower.law: 0 guided, 1 paper.
    FollowerLaw = 40,
    /// follower.tables: one of fp_fine_tables.
    FollowerTables = 41,
    /// follower.speed_axis: one of fp_speed_axis.
    FollowerSpeedAxis = 42,
    /// follower.distance_scale: 1/m / 2^16.
    FollowerDistanceScale = 43,
    /// follower.deflection_rate: 1/s / 2^16.
    FollowerDeflectionRate = 44,
    /// follower.approach_gain: 1/m / 2^16.
    FollowerApproachGain = 45,
    /// follower.approach_angle: turn / 2^32.
    FollowerApproachAngle = 46,
    /// follower.feed_forward_band: m / 2^16.
    FollowerFeedForwardBand = 47,
    /// follower.lateral_acceleration: m/s^2 / 2^16.
    FollowerLateralAcceleration = 48,
    /// follower.corner_speed: m/s / 2^16.
    FollowerCornerSpeed = 49,
    /// follower.reach: m / 2^16.
    FollowerReach = 50,
    /// follower.arrival: m / 2^16.
    FollowerArrival = 51,
    /// follower.end_radius: m / 2^16.
    FollowerEndRadius = 52,
    /// avoider.tables: one of fp_coarse_tables.
    AvoiderTables = 60,
    /// avoider.speed_input: one of fp_speed_input.
    AvoiderSpeedInput = 61,
    /// avoider.range: m / 2^16.
    AvoiderRange = 62,
    /// avoider.margin: m / 2^16.
    AvoiderMargin = 63,
    /// avoider.deflection_rate: 1/s / 2^16.
    AvoiderDeflectionRate = 64,
    /// avoider.overshoot: turn / 2^32.
    AvoiderOvershoot = 65,
    /// supervisor.enter: m / 2^16.
    SupervisorEnter = 70,
    /// supervisor.exit: m / 2^16.
    SupervisorExit = 71,
    /// supervisor.dwell: ticks, 0 to 65535.
    SupervisorDwell = 72,
    /// supervisor.clear: turn / 2^32.
    SupervisorClear = 73,
    /// supervisor.tie: turn / 2^32.
    SupervisorTie = 74,
    /// supervisor.same: m / 2^16.
    SupervisorSame = 75,
    /// supervisor.patience: ticks, 0 to 65535.
    SupervisorPatience = 76,
    /// guard.margin: m / 2^16.
    GuardMargin = 80,
    /// guard.braking: m/s^2 / 2^16.
    GuardBraking = 81,
    /// ring.mounts: number of range sensors, 1 to FP_SENSORS_MAX.
    RingMounts = 256,
}

/// Id of the place of sensor 0 in the robot's frame, x: m / 2^16. Of sensor i it is this plus 4 i; so are those below.
pub const FP_MOUNT_X: u16 = 257;
/// Likewise, y: m / 2^16.
pub const FP_MOUNT_Y: u16 = 258;
/// Where sensor 0 looks, in the robot's frame: turn / 2^32.
pub const FP_MOUNT_HEADING: u16 = 259;
/// Full opening angle of sensor 0's cone, 0 for a beam: turn / 2^32.
pub const FP_MOUNT_WIDTH: u16 = 260;
