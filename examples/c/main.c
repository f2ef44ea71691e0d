/* The fine controller by itself, then a robot that drives 100 ticks along a path with an obstacle on it: the library's
 * own example in C. The same file runs on a desktop and on bare metal (build says how); what it prints is the same
 * everywhere, to the last digit. */

#include "fuzzypilot.h"
#include "say.h"

enum { SENSORS = 16, TICKS = 100 };

/* FNV-1a over every byte that the library gives: two digests are equal if the bytes are. */
static uint64_t digest = 14695981039346656037u;

static void add(const void *bytes, size_t count) {
    for (const uint8_t *at = bytes; count > 0; count--) {
        digest = (digest ^ *at++) * 1099511628211u;
    }
}

/* The world: a robot that moves as its wheels are told to, and a disc. Integers, so that it is the same everywhere. */

typedef struct {
    int32_t x, y; /* m / 2^16; of a direction, 1 / 2^30 */
} vector;

typedef struct {
    vector at, ahead;
    int32_t left, right; /* encoder counts, 2^-20 m each */
} world;

static const vector DISC = {FP_Q16(1.4), FP_Q16(0.03)};
static const int32_t RADIUS = FP_Q16(0.12);

static int32_t times(int32_t a, int32_t b) { /* b is 1 / 2^30 */
    return (int32_t)((int64_t)a * b >> 30);
}

static vector turned(vector v, vector by) {
    vector turned = {times(v.x, by.x) - times(v.y, by.y), times(v.x, by.y) + times(v.y, by.x)};
    return turned;
}

static int32_t root(int32_t square) {
    int32_t root = 0;
    for (int32_t bit = 1 << 15; bit > 0; bit >>= 1) {
        if ((int64_t)(root + bit) * (root + bit) <= square) {
            root += bit;
        }
    }
    return root;
}

/* One control period, 1/20 s. */
static void move(world *w, fp_wheels told) {
    /* A wheel's way is its speed (m/s / 2^16) by 20, in counts: times 16. */
    w->left += told.left * 4 / 5;
    w->right += told.right * 4 / 5;
    int32_t way = (told.left + told.right) / 40;
    w->at.x += times(way, w->ahead.x);
    w->at.y += times(way, w->ahead.y);
    /* The wheels are 0.16 m apart: radians / 2^30 from m/s / 2^16 in 1/20 s. */
    vector turn = {1 << 30, (told.right - told.left) * 5120};
    w->ahead = turned(w->ahead, turn);
    /* Back to length one: times (3 - length^2) / 2. */
    int32_t square = times(w->ahead.x, w->ahead.x) + times(w->ahead.y, w->ahead.y);
    int32_t factor = (int32_t)((3 * ((int64_t)1 << 30) - square) / 2);
    w->ahead.x = times(w->ahead.x, factor);
    w->ahead.y = times(w->ahead.y, factor);
}

/* Sixteen beams all round, counter-clockwise, the first one looking back. */
static void look(const world *w, fp_reading readings[SENSORS]) {
    static const vector STEP = {992008094, 410903207}; /* 22.5 degrees */
    vector beam = {-w->ahead.x, -w->ahead.y};
    vector disc = {DISC.x - w->at.x, DISC.y - w->at.y};
    for (int i = 0; i < SENSORS; i++) {
        int32_t along = times(disc.x, beam.x) + times(disc.y, beam.y);
        int32_t beside = times(disc.x, beam.y) - times(disc.y, beam.x);
        fp_reading reading = {0, 0, FP_READING_KIND_CLEAR, FP_FAULT_NONE};
        if (along > 0 && beside > -RADIUS && beside < RADIUS) {
            reading.range = along - root(RADIUS * RADIUS - beside * beside);
            reading.kind = FP_READING_KIND_ECHO;
        }
        readings[i] = reading;
        beam = turned(beam, STEP);
    }
}

/* What the caller of every function does. */
static int done(fp_status status, const char *what) {
    if (status != FP_STATUS_OK) {
        say(what);
        say(": ");
        say(fp_status_text(status));
        say("\n");
    }
    return status == FP_STATUS_OK;
}

static void say_number(const char *name, int64_t number) {
    char digits[24];
    char *at = digits + sizeof digits - 1;
    uint64_t rest = number < 0 ? -(uint64_t)number : (uint64_t)number;
    *at = 0;
    do {
        *--at = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest > 0);
    if (number < 0) {
        *--at = '-';
    }
    say(name);
    say(" ");
    say(at);
    say("\n");
}

static int fine(void) {
    fp_fine_settings settings = {FP_FINE_TABLES_PRINTED, FP_SPEED_AXIS_SCALED, FP_Q16(1), FP_Q16(1), FP_Q16(3)};
    fp_fine controller;
    if (!done(fp_fine_init(&controller, sizeof controller, &settings), "fp_fine_init")) {
        return 0;
    }
    /* The chapter's worked example: 1.2 from the path, 100 degrees off. */
    fp_fine_motion motion;
    if (!done(fp_fine_evaluate(&controller, FP_Q16(1.2), FP_DEGREES(100), &motion), "fp_fine_evaluate")) {
        return 0;
    }
    say_number("speed, m/s / 2^16:", motion.speed);
    say_number("yaw rate, rad/s / 2^16:", motion.yaw_rate);
    for (int32_t d = 0; d <= 5; d++) {
        for (int32_t step = -11; step <= 11; step++) {
            fp_fine_evaluate(&controller, d * FP_Q16(1), step * FP_DEGREES(15), &motion);
            add(&motion, sizeof motion);
        }
    }
    fp_coarse_output coarse;
    for (int32_t s = 0; s <= 1 << 16; s += 1 << 13) {
        for (int32_t degrees = -90; degrees <= 90; degrees += 15) {
            int32_t theta = degrees * 65536;
            fp_coarse_evaluate(FP_COARSE_TABLES_CORRECTED, FP_SPEED_INPUT_DEFLECTION, s, theta, &coarse);
            add(&coarse.deflection, sizeof coarse.deflection);
            add(&coarse.speed, sizeof coarse.speed);
        }
    }
    return 1;
}

static fp_robot robot;
static fp_path path;

static int drive(void) {
    const fp_pose start = {0, 0, 0};
    const fp_segment segments[] = {
        fp_line(0, 0, 0, FP_Q16(3)),
        fp_arc(FP_Q16(3), FP_Q16(1), FP_Q16(1), FP_DEGREES(-90), FP_SWEEP(90)),
    };
    if (!done(fp_robot_init(&robot, sizeof robot, FP_PRESET_SMALL_ROBOT, SENSORS, &start), "fp_robot_init") ||
        !done(fp_robot_set(&robot, FP_SETTING_LIMITS_SPEED, FP_Q16(0.8)), "fp_robot_set") ||
        !done(fp_robot_restart(&robot, &start, NULL), "fp_robot_restart") ||
        !done(fp_path_init(&path, sizeof path), "fp_path_init") ||
        !done(fp_path_set_segments(&path, segments, sizeof segments / sizeof *segments, 0, NULL), "fp_path_set_segments")) {
        return 0;
    }
    world w = {{0, 0}, {1 << 30, 0}, 0, 0};
    fp_reading readings[SENSORS];
    fp_record record;
    int avoided = 0;
    for (int tick = 0; tick < TICKS; tick++) {
        look(&w, readings);
        fp_inputs inputs = {w.left, w.right, FP_FAULT_NONE, readings, SENSORS};
        if (!done(fp_robot_tick(&robot, &path, &inputs, &record), "fp_robot_tick")) {
            return 0;
        }
        add(&record, sizeof record);
        avoided += record.decision == FP_DECISION_AVOID;
        move(&w, record.wheels);
    }
    say_number("ticks:", TICKS);
    say_number("of these avoiding:", avoided);
    say_number("at x, m / 2^16:", record.pose.x);
    say_number("at y, m / 2^16:", record.pose.y);
    return 1;
}

int main(void) {
    if (!fine() || !drive()) {
        return 1;
    }
    char hex[] = "digest: 0000000000000000\n";
    for (int i = 0; i < 16; i++) {
        hex[8 + i] = "0123456789abcdef"[digest >> (60 - 4 * i) & 15];
    }
    say(hex);
    return 0;
}
