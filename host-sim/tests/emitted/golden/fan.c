/* The fuzzy controller "fan": 2 inputs, 1 output, 6 rules.

   Made by `host-sim fuzzy convert fan.fll --to c`:
   change the design and make it again rather than this file.

   It is off the same design in exact arithmetic by at most, where some rule has a degree of
   - fan: 1/2: 0.000835779, 1/8: 0.000835779, 1/64: 0.000835779, any: 0.000835779
*/

#include "fan.h"

/* The smaller of two degrees. */
static uint32_t least(uint32_t a, uint32_t b)
{
    return (a < b) ? a : b;
}

/* x, or the end of [low, high] that it is beyond. */
static int32_t limited(int64_t x, int32_t low, int32_t high)
{
    const int64_t above = (x < low) ? low : x;
    return (int32_t)((above > high) ? high : above);
}

/* x / 2^shift, rounded down, for a shift below 63. */
static int64_t shifted(int64_t x, uint32_t shift)
{
    const uint64_t bits = (uint64_t)((x < 0) ? (-1 - x) : x) >> shift;
    return (x < 0) ? (-1 - (int64_t)bits) : (int64_t)bits;
}

/* A membership function's straight piece: d steps from `from` the degree is
   start + (d * 2^shift * slope) / 2^32. */
typedef struct
{
    int32_t from;
    uint32_t start;
    int32_t slope;
    uint32_t shift;
} piece_t;

/* The degree to which x is a term of `count` pieces: on the last that begins at x or before it. */
static uint32_t membership(const piece_t pieces[], uint32_t count, int32_t x)
{
    uint32_t first = 0U;
    uint32_t left = count;
    while (left > 1U)
    {
        const uint32_t half = left / 2U;
        first += (pieces[first + half].from <= x) ? half : 0U;
        left -= half;
    }
    const piece_t *const piece = &pieces[first];
    const uint32_t distance = (x > piece->from) ? ((uint32_t)x - (uint32_t)piece->from) : 0U;
    const int64_t rise = (int64_t)(distance << piece->shift) * piece->slope;
    return piece->start + (uint32_t)shifted(rise + INT64_C(0x80000000), 32U);
}

/* Halves both as often as it takes to bring the divisor, below 2^45, below 2^30. */
static void reduce(uint64_t *value, uint64_t *divisor)
{
    uint32_t step = 8U;
    while (step > 0U)
    {
        const uint32_t shift = (((*divisor >> 29) >> step) != 0U) ? step : 0U;
        *value >>= shift;
        *divisor >>= shift;
        step /= 2U;
    }
}

/* value / divisor, rounded down; the divisor is below 2^30, the quotient below 2^32. Of a divisor of 0 it is a number
   without meaning. */
static uint32_t quotient(uint64_t value, uint32_t divisor)
{
    uint32_t rest = (uint32_t)(value >> 32);
    uint32_t low = (uint32_t)value;
    uint32_t found = 0U;
    uint32_t bit;
    for (bit = 0U; bit < 32U; bit++)
    {
        rest = (rest << 1) | (low >> 31);
        low <<= 1;
        found <<= 1;
        if (rest >= divisor)
        {
            rest -= divisor;
            found |= 1U;
        }
    }
    return found;
}

/* value / divisor, rounded to nearest, ties away from zero; the quotient is below 2^31 in magnitude. */
static int32_t rounded(int64_t value, uint64_t divisor)
{
    uint64_t top = (value < 0) ? ((uint64_t)(-1 - value) + 1U) : (uint64_t)value;
    uint64_t bottom = divisor;
    uint32_t found;
    reduce(&top, &bottom);
    found = quotient(top + (bottom >> 1), (uint32_t)bottom) & UINT32_C(0x7fffffff);
    return (value < 0) ? -(int32_t)found : (int32_t)found;
}

/* One conclusion of a weighted average. */
static void add(int64_t *sum, uint64_t *weight, uint32_t degree, int32_t value)
{
    *sum += (int64_t)degree * value;
    *weight += degree;
}

/* temperature is cool. */
static const piece_t pieces_temperature_cool[2] =
{
    { INT32_C(1179648), UINT32_C(16777216), (-INT32_C(44739243)), 12U },
    { INT32_C(1572864), UINT32_C(0), INT32_C(0), 0U },
};

/* temperature is warm. */
static const piece_t pieces_temperature_warm[3] =
{
    { INT32_C(1179648), UINT32_C(0), INT32_C(44739243), 12U },
    { INT32_C(1572864), UINT32_C(16777216), (-INT32_C(67108864)), 11U },
    { INT32_C(2097152), UINT32_C(0), INT32_C(0), 0U },
};

/* temperature is hot. */
static const piece_t pieces_temperature_hot[2] =
{
    { INT32_C(1572864), UINT32_C(0), INT32_C(67108864), 11U },
    { INT32_C(2097152), UINT32_C(16777216), INT32_C(0), 0U },
};

/* humidity is dry. */
static const piece_t pieces_humidity_dry[2] =
{
    { INT32_C(1966080), UINT32_C(16777216), (-INT32_C(42949673)), 9U },
    { INT32_C(5242880), UINT32_C(0), INT32_C(0), 0U },
};

/* humidity is damp. */
static const piece_t pieces_humidity_damp[2] =
{
    { INT32_C(1966080), UINT32_C(0), INT32_C(42949673), 9U },
    { INT32_C(5242880), UINT32_C(16777216), INT32_C(0), 0U },
};

void fan_evaluate(const int32_t in[FAN_INPUTS], int32_t out[FAN_OUTPUTS], uint32_t *degrees)
{
    int32_t x[FAN_INPUTS];
    uint32_t terms[FAN_TERMS];
    uint32_t own[FAN_RULES];
    uint32_t *const rules = (degrees != NULL) ? degrees : own;

    x[FAN_TEMPERATURE] = limited(in[FAN_TEMPERATURE], FAN_TEMPERATURE_LEAST, FAN_TEMPERATURE_MOST);
    terms[FAN_TEMPERATURE_COOL] = membership(pieces_temperature_cool, 2U, x[FAN_TEMPERATURE]);
    terms[FAN_TEMPERATURE_WARM] = membership(pieces_temperature_warm, 3U, x[FAN_TEMPERATURE]);
    terms[FAN_TEMPERATURE_HOT] = membership(pieces_temperature_hot, 2U, x[FAN_TEMPERATURE]);

    x[FAN_HUMIDITY] = limited(in[FAN_HUMIDITY], FAN_HUMIDITY_LEAST, FAN_HUMIDITY_MOST);
    terms[FAN_HUMIDITY_DRY] = membership(pieces_humidity_dry, 2U, x[FAN_HUMIDITY]);
    terms[FAN_HUMIDITY_DAMP] = membership(pieces_humidity_damp, 2U, x[FAN_HUMIDITY]);

    /* if temperature is cool and humidity is dry then fan is low */
    rules[0] = least(terms[FAN_TEMPERATURE_COOL], terms[FAN_HUMIDITY_DRY]);
    /* if temperature is cool and humidity is damp then fan is low */
    rules[1] = least(terms[FAN_TEMPERATURE_COOL], terms[FAN_HUMIDITY_DAMP]);
    /* if temperature is warm and humidity is dry then fan is low */
    rules[2] = least(terms[FAN_TEMPERATURE_WARM], terms[FAN_HUMIDITY_DRY]);
    /* if temperature is warm and humidity is damp then fan is mid */
    rules[3] = least(terms[FAN_TEMPERATURE_WARM], terms[FAN_HUMIDITY_DAMP]);
    /* if temperature is hot and humidity is dry then fan is mid */
    rules[4] = least(terms[FAN_TEMPERATURE_HOT], terms[FAN_HUMIDITY_DRY]);
    /* if temperature is hot and humidity is damp then fan is high */
    rules[5] = least(terms[FAN_TEMPERATURE_HOT], terms[FAN_HUMIDITY_DAMP]);

    /* fan */
    {
        int64_t sum = 0;
        uint64_t weight = 0U;
        int32_t value;
        value = INT32_C(0); /* low */
        add(&sum, &weight, rules[0], value);
        add(&sum, &weight, rules[1], value);
        add(&sum, &weight, rules[2], value);
        value = INT32_C(2621440); /* mid */
        add(&sum, &weight, rules[3], value);
        add(&sum, &weight, rules[4], value);
        value = INT32_C(6553600); /* high */
        add(&sum, &weight, rules[5], value);
        value = rounded(sum, weight);
        out[FAN_FAN] = (weight == 0U) ? FAN_FAN_DEFAULT : limited(value, FAN_FAN_LEAST, FAN_FAN_MOST);
    }
}
