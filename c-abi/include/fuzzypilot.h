/* fuzzypilot for C: the fine and coarse fuzzy controllers, and the tick of a robot that follows a path and avoids
 * obstacles. Fixed point, no heap, no global state. How to build and link: docs/c.md.
 *
 * Generated from c-abi/src: change it there.
 *
 * Frames and signs: x forward, y left, counter-clockwise positive. Numbers are integers; "m / 2^16" is a count of
 * 1/65536 metre. FP_Q16 and its like make them from constants.
 *
 * Pointers: one that is null or misaligned is answered with a status. Any other leads to a whole value of its type, or to
 * room for one if it is only written, which nothing else uses during the call. Storages (fp_robot, fp_path,
 * fp_fine) are initialised first. Nothing is kept after a call: what the library must remember, it copies.
 *
 * Every function that answers with a status has changed nothing when it is not FP_STATUS_OK, unless its comment says so.
 * A function may be called from anywhere, from an interrupt too, but not twice at once with the same storage. */


#pragma once

#include <stddef.h>
#include <stdint.h>

/* Integers from constants, rounded to nearest: computed by the compiler. */
#define FP_SCALED(x, steps) ((x) * (steps) + ((x) < 0 ? -0.5 : 0.5))
/* A number with 16 fractional bits: metres, m/s, rad/s, 1/m, m/s^2. */
#define FP_Q16(x) ((int32_t)FP_SCALED(x, 65536.0))
/* Seconds. */
#define FP_Q24(x) ((int32_t)FP_SCALED(x, 16777216.0))
/* A direction in degrees, -180 to 180. */
#define FP_DEGREES(x) ((int32_t)(uint32_t)(int64_t)FP_SCALED(x, 4294967296.0 / 360.0))
/* The sweep of an arc in degrees, -360 to 360. */
#define FP_SWEEP(x) ((int32_t)FP_SCALED(x, 16777216.0 / 360.0))


/// Id of the place of sensor 0 in the robot's frame, x: m / 2^16. Of sensor i it is this plus 4 i; so are those below.
#define FP_MOUNT_X 257

/// Likewise, y: m / 2^16.
#define FP_MOUNT_Y 258

/// Where sensor 0 looks, in the robot's frame: turn / 2^32.
#define FP_MOUNT_HEADING 259

/// Full opening angle of sensor 0's cone, 0 for a beam: turn / 2^32.
#define FP_MOUNT_WIDTH 260

/// Words of an fp_fine.
#define FP_FINE_WORDS 4

/// The most range sensors of a robot.
#define FP_SENSORS_MAX 64

/// Words of an fp_robot.
#define FP_ROBOT_WORDS 490

/// The most segments of a path.
#define FP_SEGMENTS_MAX 64

/// The most points of a path.
#define FP_POINTS_MAX 128

/// Words of an fp_path.
#define FP_PATH_WORDS 200

/// Flag of a path: its end joins its start.
#define FP_PATH_CLOSED 1

/// Flag of a path: segments may start away from where the ones before end; the robot makes its own way across.
#define FP_PATH_GAPS 2

/// Flag of a record: the path's end is reached.
#define FP_FLAG_AT_END 1

/// Flag of a record: the path is over, the robot is not at its end, and its law leads nowhere else.
#define FP_FLAG_MISSED_END 2

/// Flag of a record: the guard had to slow or stop the robot.
#define FP_FLAG_GUARDED 4

/// Flag of a record: a wheel could not be written. Never set here: the caller writes them, and knows.
#define FP_FLAG_DRIVE_FAULT 8

/// What came of a call.
enum fp_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// Done.
    FP_STATUS_OK = 0,
    /// A pointer is null.
    FP_STATUS_NULL_POINTER = 1,
    /// A pointer is not a multiple of its type's alignment.
    FP_STATUS_MISALIGNED = 2,
    /// A size or count is not the one of this library: header and library are of different versions, or the number of
    /// readings is not the number of sensors.
    FP_STATUS_WRONG_SIZE = 3,
    /// The storage was not initialised.
    FP_STATUS_NOT_INITIALISED = 4,
    /// A number stands for none of the choices.
    FP_STATUS_UNKNOWN_CHOICE = 5,
    /// No setting has this id, or it belongs to a sensor that is not mounted.
    FP_STATUS_UNKNOWN_SETTING = 6,
    /// The setting may not have this value, alone or beside the others.
    FP_STATUS_SETTING_NOT_ALLOWED = 7,
    /// Settings have changed since fp_robot_restart checked them.
    FP_STATUS_NOT_STARTED = 8,
    /// No path was set.
    FP_STATUS_NO_PATH = 9,
    /// A path needs at least two points or one segment.
    FP_STATUS_PATH_TOO_SHORT = 10,
    /// The path has more pieces than there is room for.
    FP_STATUS_PATH_TOO_LONG = 11,
    /// A piece of the path has no length, no positive radius, or a sweep of none or over a turn.
    FP_STATUS_PATH_DEGENERATE = 12,
    /// A segment of the path does not start where the one before ends.
    FP_STATUS_PATH_GAP = 13,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_status fp_status;
#else
typedef int32_t fp_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Ids of settings, for fp_robot_get and fp_robot_set.
enum fp_setting
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// body.radius: m / 2^16.
    FP_SETTING_BODY_RADIUS = 1,
    /// body.track: m / 2^16.
    FP_SETTING_BODY_TRACK = 2,
    /// body.metres_per_count: m/count / 2^32, unsigned.
    FP_SETTING_BODY_METRES_PER_COUNT = 3,
    /// limits.speed: m/s / 2^16.
    FP_SETTING_LIMITS_SPEED = 10,
    /// limits.yaw_rate: rad/s / 2^16.
    FP_SETTING_LIMITS_YAW_RATE = 11,
    /// limits.acceleration: m/s^2 / 2^16.
    FP_SETTING_LIMITS_ACCELERATION = 12,
    /// limits.yaw_acceleration: rad/s^2 / 2^16.
    FP_SETTING_LIMITS_YAW_ACCELERATION = 13,
    /// limits.wheel_speed: m/s / 2^16.
    FP_SETTING_LIMITS_WHEEL_SPEED = 14,
    /// period: s / 2^24.
    FP_SETTING_PERIOD = 20,
    /// latency: s / 2^24.
    FP_SETTING_LATENCY = 21,
    /// integrator: 0 arc, 1 euler.
    FP_SETTING_INTEGRATOR = 22,
    /// ring.closed: 0 no, 1 yes.
    FP_SETTING_RING_CLOSED = 30,
    /// ring.max_range: m / 2^16.
    FP_SETTING_RING_MAX_RANGE = 31,
    /// ring.max_age: s / 2^24.
    FP_SETTING_RING_MAX_AGE = 32,
    /// ring.gap: m / 2^16.
    FP_SETTING_RING_GAP = 33,
    /// ring.radius, smallest: m / 2^16.
    FP_SETTING_RING_RADIUS_SMALLEST = 34,
    /// ring.radius, largest: m / 2^16.
    FP_SETTING_RING_RADIUS_LARGEST = 35,
    /// ring.residual: m / 2^16.
    FP_SETTING_RING_RESIDUAL = 36,
    /// follower.law: 0 guided, 1 paper.
    FP_SETTING_FOLLOWER_LAW = 40,
    /// follower.tables: one of fp_fine_tables.
    FP_SETTING_FOLLOWER_TABLES = 41,
    /// follower.speed_axis: one of fp_speed_axis.
    FP_SETTING_FOLLOWER_SPEED_AXIS = 42,
    /// follower.distance_scale: 1/m / 2^16.
    FP_SETTING_FOLLOWER_DISTANCE_SCALE = 43,
    /// follower.deflection_rate: 1/s / 2^16.
    FP_SETTING_FOLLOWER_DEFLECTION_RATE = 44,
    /// follower.approach_gain: 1/m / 2^16.
    FP_SETTING_FOLLOWER_APPROACH_GAIN = 45,
    /// follower.approach_angle: turn / 2^32.
    FP_SETTING_FOLLOWER_APPROACH_ANGLE = 46,
    /// follower.feed_forward_band: m / 2^16.
    FP_SETTING_FOLLOWER_FEED_FORWARD_BAND = 47,
    /// follower.lateral_acceleration: m/s^2 / 2^16.
    FP_SETTING_FOLLOWER_LATERAL_ACCELERATION = 48,
    /// follower.corner_speed: m/s / 2^16.
    FP_SETTING_FOLLOWER_CORNER_SPEED = 49,
    /// follower.reach: m / 2^16.
    FP_SETTING_FOLLOWER_REACH = 50,
    /// follower.arrival: m / 2^16.
    FP_SETTING_FOLLOWER_ARRIVAL = 51,
    /// follower.end_radius: m / 2^16.
    FP_SETTING_FOLLOWER_END_RADIUS = 52,
    /// avoider.tables: one of fp_coarse_tables.
    FP_SETTING_AVOIDER_TABLES = 60,
    /// avoider.speed_input: one of fp_speed_input.
    FP_SETTING_AVOIDER_SPEED_INPUT = 61,
    /// avoider.range: m / 2^16.
    FP_SETTING_AVOIDER_RANGE = 62,
    /// avoider.margin: m / 2^16.
    FP_SETTING_AVOIDER_MARGIN = 63,
    /// avoider.deflection_rate: 1/s / 2^16.
    FP_SETTING_AVOIDER_DEFLECTION_RATE = 64,
    /// avoider.overshoot: turn / 2^32.
    FP_SETTING_AVOIDER_OVERSHOOT = 65,
    /// supervisor.enter: m / 2^16.
    FP_SETTING_SUPERVISOR_ENTER = 70,
    /// supervisor.exit: m / 2^16.
    FP_SETTING_SUPERVISOR_EXIT = 71,
    /// supervisor.dwell: ticks, 0 to 65535.
    FP_SETTING_SUPERVISOR_DWELL = 72,
    /// supervisor.clear: turn / 2^32.
    FP_SETTING_SUPERVISOR_CLEAR = 73,
    /// supervisor.tie: turn / 2^32.
    FP_SETTING_SUPERVISOR_TIE = 74,
    /// supervisor.same: m / 2^16.
    FP_SETTING_SUPERVISOR_SAME = 75,
    /// supervisor.patience: ticks, 0 to 65535.
    FP_SETTING_SUPERVISOR_PATIENCE = 76,
    /// guard.margin: m / 2^16.
    FP_SETTING_GUARD_MARGIN = 80,
    /// guard.braking: m/s^2 / 2^16.
    FP_SETTING_GUARD_BRAKING = 81,
    /// ring.mounts: number of range sensors, 1 to FP_SENSORS_MAX.
    FP_SETTING_RING_MOUNTS = 256,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_setting fp_setting;
#else
typedef uint16_t fp_setting;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Which fine tables.
enum fp_fine_tables
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// As the chapter prints them.
    FP_FINE_TABLES_PRINTED = 0,
    /// As printed, but one cell as the chapter's worked example has it in words.
    FP_FINE_TABLES_PRINTED_PROSE = 1,
    /// Tuned for the guided law.
    FP_FINE_TABLES_TUNED = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_fine_tables fp_fine_tables;
#else
typedef int32_t fp_fine_tables;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// How the speed axis of the fine tables, 0 to 3, becomes metres per second.
enum fp_speed_axis
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// Its top is the robot's top speed.
    FP_SPEED_AXIS_SCALED = 0,
    /// It is metres per second as it stands.
    FP_SPEED_AXIS_LITERAL = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_speed_axis fp_speed_axis;
#else
typedef int32_t fp_speed_axis;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Which coarse tables.
enum fp_coarse_tables
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// The misprinted cell corrected.
    FP_COARSE_TABLES_CORRECTED = 0,
    /// As the chapter prints them.
    FP_COARSE_TABLES_PRINTED = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_coarse_tables fp_coarse_tables;
#else
typedef int32_t fp_coarse_tables;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// What the coarse speed table reads along its columns.
enum fp_speed_input
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// The deflection just decided.
    FP_SPEED_INPUT_DEFLECTION = 0,
    /// The bearing theta.
    FP_SPEED_INPUT_BEARING = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_speed_input fp_speed_input;
#else
typedef int32_t fp_speed_input;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Complete settings to start from.
enum fp_preset
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// 0.2 m across, 1 m/s, a tick every 50 ms, tuned tables, guided law.
    FP_PRESET_SMALL_ROBOT = 0,
    /// The chapter's: 0.4 m across, 0.3 m/s, a tick every second, printed tables, guided law.
    FP_PRESET_CHAPTER_ROBOT = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_preset fp_preset;
#else
typedef int32_t fp_preset;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// What a segment is.
enum fp_segment_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// A straight line.
    FP_SEGMENT_KIND_LINE = 0,
    /// A circular arc.
    FP_SEGMENT_KIND_ARC = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_segment_kind fp_segment_kind;
#else
typedef int32_t fp_segment_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Why encoders or a sensor have nothing usable to say.
enum fp_fault
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// There is no fault.
    FP_FAULT_NONE = 0,
    /// Nothing was ever received.
    FP_FAULT_NEVER_SEEN = 1,
    /// No answer in time.
    FP_FAULT_TIMEOUT = 2,
    /// The bus, the pin or the sensor itself reported an error.
    FP_FAULT_BUS = 3,
    /// The value is outside what the sensor can measure.
    FP_FAULT_OUT_OF_RANGE = 4,
    /// The last reading is older than allowed.
    FP_FAULT_STALE = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_fault fp_fault;
#else
typedef int32_t fp_fault;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// What a range sensor saw. Zeroed memory says: nothing usable.
enum fp_reading_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// No usable reading; never taken for free space.
    FP_READING_KIND_INVALID = 0,
    /// Nothing up to the sensor's largest range.
    FP_READING_KIND_CLEAR = 1,
    /// An echo.
    FP_READING_KIND_ECHO = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_reading_kind fp_reading_kind;
#else
typedef int32_t fp_reading_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// What the higher level decided.
enum fp_decision
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// Follow the path.
    FP_DECISION_FOLLOW = 0,
    /// Pass the obstacle held; fp_record.detail is one of fp_side.
    FP_DECISION_AVOID = 1,
    /// Stand still; fp_record.detail is one of fp_stop.
    FP_DECISION_STOP = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_decision fp_decision;
#else
typedef int32_t fp_decision;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Which way past an obstacle.
enum fp_side
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// It turns left: the obstacle stays on the right.
    FP_SIDE_LEFT = 0,
    /// It turns right.
    FP_SIDE_RIGHT = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_side fp_side;
#else
typedef int32_t fp_side;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Why the robot stands.
enum fp_stop
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// No valid range reading for longer than allowed.
    FP_STOP_NO_RANGES = 0,
    /// No encoder counts for longer than allowed.
    FP_STOP_NO_ODOMETRY = 1,
    /// The path is driven to its end.
    FP_STOP_PATH_END = 2,
    /// The path is over, and the robot is not at its end.
    FP_STOP_PATH_MISSED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_stop fp_stop;
#else
typedef int32_t fp_stop;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Which controller's rules a record holds.
enum fp_controller
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /// None ran.
    FP_CONTROLLER_NONE = 0,
    /// The fine one: rows phi, columns d.
    FP_CONTROLLER_FINE = 1,
    /// The coarse ones: rows s, columns an angle.
    FP_CONTROLLER_COARSE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fp_controller fp_controller;
#else
typedef int32_t fp_controller;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/// Memory for a fine controller. What is in it is the library's; it may be copied, and needs no end.
typedef struct fp_fine {
    /// Not for use.
    uint64_t opaque[FP_FINE_WORDS];
} fp_fine;

/// What a fine controller is made of.
typedef struct fp_fine_settings {
    /// Rule tables: one of fp_fine_tables.
    int32_t tables;
    /// Reading of the speed axis: one of fp_speed_axis.
    int32_t speed_axis;
    /// Units of the d axis (0 to 4) a metre, 1/m / 2^16. Above 0.
    int32_t distance_scale;
    /// Deflection to yaw rate, 1/s / 2^16. Above 0.
    int32_t deflection_rate;
    /// Top speed, m/s / 2^16. Above 0.
    int32_t top_speed;
} fp_fine_settings;

/// What a fine controller wants.
typedef struct fp_fine_motion {
    /// Forward speed, m/s / 2^16.
    int32_t speed;
    /// Yaw rate towards the heading error, rad/s / 2^16, left positive.
    int32_t yaw_rate;
} fp_fine_motion;

/// A rule that fired.
typedef struct fp_rule {
    /// Row of its cell in the rule table, from 0.
    uint8_t row;
    /// Column of its cell, from 0.
    uint8_t col;
    /// Activation degree, 1 / 2^15: 32768 is 1.
    uint16_t degree;
} fp_rule;

/// Outputs of the fine tables on their own axes.
typedef struct fp_fine_output {
    /// Speed on its axis, 0 to 3, 1 / 2^13.
    int16_t speed;
    /// Deflection, unsigned, degrees / 2^8.
    int16_t deflection;
    /// Rules that fired, in the tables' reading order: row phi, column d; both outputs share them.
    struct fp_rule rules[4];
    /// How many of them are used: 1, 2 or 4.
    uint8_t rule_count;
} fp_fine_output;

/// Outputs of the coarse controllers.
typedef struct fp_coarse_output {
    /// Deflection, clockwise positive, degrees / 2^8.
    int16_t deflection;
    /// Share of the top speed, 1 / 2^14.
    int16_t speed;
    /// Rules of the deflection table that fired, in its reading order: row s, column theta.
    struct fp_rule deflection_rules[4];
    /// Rules of the speed table.
    struct fp_rule speed_rules[4];
    /// How many of deflection_rules are used: 1, 2 or 4.
    uint8_t deflection_rule_count;
    /// How many of speed_rules are used: 1, 2 or 4.
    uint8_t speed_rule_count;
} fp_coarse_output;

/// Memory for a robot. What is in it is the library's; it may be copied, and needs no end.
typedef struct fp_robot {
    /// Not for use.
    uint64_t opaque[FP_ROBOT_WORDS];
} fp_robot;

/// A place and a heading, world.
typedef struct fp_pose {
    /// Forward or east, m / 2^16.
    int32_t x;
    /// Left or north, m / 2^16.
    int32_t y;
    /// Counter-clockwise from x, turn / 2^32.
    int32_t heading;
} fp_pose;

/// Memory for a path: FP_SEGMENTS_MAX segments or FP_POINTS_MAX points. What is in it is the library's; it may be
/// copied, and needs no end.
typedef struct fp_path {
    /// Not for use.
    uint64_t opaque[FP_PATH_WORDS];
} fp_path;

/// A line or a circular arc. fp_line and fp_arc fill it.
typedef struct fp_segment {
    /// One of fp_segment_kind.
    int32_t kind;
    /// Start of a line, centre of an arc: world, m / 2^16.
    int32_t x;
    /// Likewise.
    int32_t y;
    /// Of a line its heading, of an arc the direction from its centre to its first point: turn / 2^32.
    int32_t direction;
    /// Length of a line, radius of an arc: m / 2^16, above 0.
    int32_t extent;
    /// Angle that an arc sweeps, turn / 2^24, counter-clockwise positive, at most one turn either way. Not read of a
    /// line.
    int32_t sweep;
} fp_segment;

/// A range sensor's latest reading.
typedef struct fp_reading {
    /// Distance of the echo from the sensor, m / 2^16. Read of an echo only.
    int32_t range;
    /// Time since it was measured, s / 2^24.
    int32_t age;
    /// One of fp_reading_kind.
    uint8_t kind;
    /// One of fp_fault. Read of an invalid one only; FP_FAULT_NONE then counts as FP_FAULT_NEVER_SEEN.
    uint8_t fault;
} fp_reading;

/// What a tick depends on.
typedef struct fp_inputs {
    /// Cumulative encoder counts of the left wheel, forward positive; they wrap, only differences matter.
    int32_t left;
    /// Of the right wheel.
    int32_t right;
    /// One of fp_fault: with any but FP_FAULT_NONE the counts are unknown in this tick, and the next good ones contain
    /// the travel in between.
    int32_t counts_fault;
    /// The latest reading of every sensor, in the order of the mounts. Not kept.
    const struct fp_reading *readings;
    /// How many they are: as many as sensors are mounted.
    size_t reading_count;
} fp_inputs;

/// A motion.
typedef struct fp_twist {
    /// Forward speed, m/s / 2^16.
    int32_t linear;
    /// Yaw rate, rad/s / 2^16, counter-clockwise positive.
    int32_t angular;
} fp_twist;

/// Wheel speeds.
typedef struct fp_wheels {
    /// Left wheel, m/s / 2^16, forward positive.
    int32_t left;
    /// Right wheel, m/s / 2^16, forward positive.
    int32_t right;
} fp_wheels;

/// Everything that one tick decided. Its memory is the record's canonical form, byte by byte: what logs and frames hold,
/// and what is the same on every architecture. What a record does not have is zero.
typedef struct fp_record {
    /// Number of the tick, from 0; wraps.
    uint32_t tick;
    /// One of fp_decision.
    uint8_t decision;
    /// Side of the avoidance or reason of the stop.
    uint8_t detail;
    /// FP_FLAG_AT_END and its like.
    uint8_t flags;
    /// One of fp_controller.
    uint8_t controller;
    /// Centre of the obstacle that is passed, body frame (x forward, y left), m / 2^16.
    int32_t held_x;
    /// Likewise.
    int32_t held_y;
    /// Its radius, m / 2^16.
    int32_t held_radius;
    /// RMS distance of its echoes from the circle, m / 2^16.
    int32_t held_residual;
    /// Where the robot believes to be.
    struct fp_pose pose;
    /// Nearest place of the path, world, m / 2^16.
    int32_t foot_x;
    /// Likewise.
    int32_t foot_y;
    /// Signed cross-track error, left of the path positive, m / 2^16.
    int32_t cross_track;
    /// Distance to the foot, m / 2^16.
    int32_t distance;
    /// Tangent at the foot, world, turn / 2^32.
    int32_t tangent;
    /// Curvature where the next command will act, 1/m / 2^16, left positive.
    int32_t curvature;
    /// Direction to steer, body frame, turn / 2^32.
    int32_t heading_error;
    /// Path length up to the foot, m / 2^16.
    int32_t progress;
    /// Path length to go, m / 2^16; 2^31 - 1 on a closed path.
    int32_t remaining;
    /// Speed that bends, corners and the end ahead allow, m/s / 2^16.
    int32_t speed_limit;
    /// Times the start of a closed path was passed.
    uint16_t laps;
    /// Obstacles in sight.
    uint8_t obstacles;
    /// Sensors with a valid reading.
    uint8_t valid_ranges;
    /// Nearest echo from the robot's centre, m / 2^16; 2^31 - 1 without any.
    int32_t nearest;
    /// Echoes behind the obstacle that is passed.
    uint8_t held_echoes;
    /// How many of rule are used.
    uint8_t rule_count;
    /// How many of speed_rule are used.
    uint8_t speed_rule_count;
    /// 0.
    uint8_t reserved;
    /// d on its axis (fine), or s as a share of the detection range (coarse), 1 / 2^16.
    int32_t distance_input;
    /// phi (fine), or theta, clockwise positive (coarse), degrees / 2^16.
    int32_t angle_input;
    /// Speed on its axis, 1 / 2^13 (fine), or as a share of the top speed, 1 / 2^14 (coarse).
    int16_t speed_output;
    /// Deflection, degrees / 2^8: unsigned (fine), or clockwise positive (coarse).
    int16_t deflection_output;
    /// Rules that fired; of the coarse ones, those of the deflection table.
    struct fp_rule rule[4];
    /// Rules of the coarse speed table.
    struct fp_rule speed_rule[4];
    /// What the lower level wanted.
    struct fp_twist desired;
    /// What the guard let pass and the limits allow.
    struct fp_twist twist;
    /// Wheel speeds to command now.
    struct fp_wheels wheels;
} fp_record;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/// A status in words; never null, lives for ever.
const char *fp_status_text(int32_t status);

/// Prepares a fine controller in the caller's memory; `size` is sizeof(fp_fine).
fp_status fp_fine_init(struct fp_fine *fine, size_t size, const struct fp_fine_settings *settings);

/// Evaluates a fine controller: speed and yaw rate for a distance to the path (m / 2^16; below 0 counts as 0, above the
/// d axis as its end) and a heading error (turn / 2^32, left positive). The same number of instructions for every
/// input.
fp_status fp_fine_evaluate(const struct fp_fine *fine,
                           int32_t distance,
                           int32_t heading_error,
                           struct fp_fine_motion *motion);

/// Evaluates fine tables (one of fp_fine_tables) on their own axes, and tells the rules: d from 0 to 4, 1 / 2^16, phi
/// from 0 to 180 degrees, degrees / 2^16; both saturate at the ends.
fp_status fp_fine_tables_evaluate(int32_t tables, int32_t d, int32_t phi, struct fp_fine_output *output);

/// Evaluates coarse tables (one of fp_coarse_tables, read by one of fp_speed_input): s is the free distance to the
/// obstacle as a share of the detection range, from 0 to 1, 1 / 2^16; theta the obstacle's bearing in the chapter's
/// sign, from -90 to 90, left positive, degrees / 2^16. Both saturate at the ends.
fp_status fp_coarse_evaluate(int32_t tables,
                             int32_t speed_input,
                             int32_t s,
                             int32_t theta,
                             struct fp_coarse_output *output);

/// sizeof(fp_robot), as the library has it.
size_t fp_robot_size(void);

/// Makes a robot in the caller's memory, with a preset's settings (one of fp_preset) and so many range sensors, 1 to
/// FP_SENSORS_MAX: beams at its centre, evenly all round, counter-clockwise, the first one looking back. It rests at
/// `start`, ready to tick. `size` is sizeof(fp_robot).
fp_status fp_robot_init(struct fp_robot *robot,
                        size_t size,
                        int32_t preset,
                        uint32_t sensors,
                        const struct fp_pose *start);

/// The raw value of a setting: one of fp_setting, or a mount of a sensor (FP_MOUNT_X and its like).
fp_status fp_robot_get(const struct fp_robot *robot, uint16_t id, int32_t *value);

/// Changes a setting: one of fp_setting, or a mount of a sensor. Before the next tick comes fp_robot_restart, which
/// checks all of them together. Sensors that are added by a larger FP_SETTING_RING_MOUNTS sit at the robot's centre and
/// look ahead.
fp_status fp_robot_set(struct fp_robot *robot, uint16_t id, int32_t value);

/// Checks the settings, forgets everything and begins anew at rest at `start` and at the beginning of its path. If a
/// setting forbids it, nothing is forgotten; `id`, if not null, then tells which, and fp_robot_flaw says why.
fp_status fp_robot_restart(struct fp_robot *robot, const struct fp_pose *start, uint16_t *id);

/// Writes why the robot cannot be driven with its settings into `text`, which has room for `room` bytes, its end
/// included: the first setting that forbids it, and what is allowed; cut off where there is no room. Empty if nothing
/// forbids it.
fp_status fp_robot_flaw(const struct fp_robot *robot, char *text, size_t room);

/// Writes the name of a setting, and its unit if it has one, into `text`, which has room for `room` bytes, its end
/// included; cut off where there is no room.
fp_status fp_setting_text(uint16_t id, char *text, size_t room);

/// Where the robot believes to be.
fp_status fp_robot_pose(const struct fp_robot *robot, struct fp_pose *pose);

/// Puts the robot to the beginning of a new path; where it is, it goes on believing.
fp_status fp_robot_restart_path(struct fp_robot *robot);

/// Prepares memory for a path, without one; `size` is sizeof(fp_path).
fp_status fp_path_init(struct fp_path *path, size_t size);

/// Sets a path of `count` segments that follow each other, copied and checked; flags are FP_PATH_CLOSED and
/// FP_PATH_GAPS, or 0. After an error in the segments themselves there is no path; `piece`, if not null, then tells which
/// segment is to blame, from 0.
fp_status fp_path_set_segments(struct fp_path *path,
                               const struct fp_segment *segments,
                               size_t count,
                               uint32_t flags,
                               size_t *piece);

/// Sets a path through `count` points, each with the tangent's direction as heading, copied and checked; flags are
/// FP_PATH_CLOSED or 0. After an error in the points themselves there is no path; `piece`, if not null, then tells
/// which gap between points is to blame, from 0.
fp_status fp_path_set_points(struct fp_path *path,
                             const struct fp_pose *points,
                             size_t count,
                             uint32_t flags,
                             size_t *piece);

/// Length of the path, m / 2^16; of a closed one, of a lap.
fp_status fp_path_length(const struct fp_path *path, int32_t *length);

/// sizeof(fp_path), as the library has it.
size_t fp_path_size(void);

/// One control period: call it every FP_SETTING_PERIOD, then command both wheels as `record` says. If no call follows
/// within 200 ms of when it was due, the wheels are to be stopped.
fp_status fp_robot_tick(struct fp_robot *robot,
                        const struct fp_path *path,
                        const struct fp_inputs *inputs,
                        struct fp_record *record);

/// A control period without driving: both wheels are to stand, and dead reckoning goes on. Only the counts of `inputs`
/// are read.
fp_status fp_robot_rest(struct fp_robot *robot, const struct fp_inputs *inputs);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

/* A straight line from (x, y). */
static inline fp_segment fp_line(int32_t x, int32_t y, int32_t heading, int32_t length) {
    fp_segment segment = {FP_SEGMENT_KIND_LINE, x, y, heading, length, 0};
    return segment;
}

/* An arc about (x, y) that begins in direction `from` of its centre. */
static inline fp_segment fp_arc(int32_t x, int32_t y, int32_t radius, int32_t from, int32_t sweep) {
    fp_segment segment = {FP_SEGMENT_KIND_ARC, x, y, from, radius, sweep};
    return segment;
}

/* For the check of fp_robot's alignment below. */
struct fp_aligned {
    char first;
    fp_robot robot;
};
struct fp_aligned_word {
    char first;
    uint64_t word;
};

/* What the library was compiled with: a compiler that packs or pads otherwise is told so here. */
#if defined(__cplusplus) && __cplusplus >= 201103L
#define FP_STATIC_ASSERT(true, text) static_assert(true, text)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define FP_STATIC_ASSERT(true, text) _Static_assert(true, text)
#else
#define FP_STATIC_ASSERT(true, text) extern char fp_static_assert[(true) ? 1 : -1]
#endif
FP_STATIC_ASSERT(sizeof(fp_record) == 156 && offsetof(fp_record, rule) == 100, "fp_record: another layout");
FP_STATIC_ASSERT(sizeof(fp_robot) == 8 * FP_ROBOT_WORDS, "fp_robot: another size");
FP_STATIC_ASSERT(sizeof(fp_path) == 8 * FP_PATH_WORDS, "fp_path: another size");
FP_STATIC_ASSERT(sizeof(fp_fine) == 8 * FP_FINE_WORDS, "fp_fine: another size");
FP_STATIC_ASSERT(offsetof(struct fp_aligned, robot) == offsetof(struct fp_aligned_word, word), "fp_robot: alignment");
FP_STATIC_ASSERT(sizeof(fp_reading) == 12 && sizeof(fp_segment) == 24 && sizeof(fp_pose) == 12, "another layout");
