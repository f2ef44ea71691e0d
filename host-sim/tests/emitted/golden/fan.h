/* The fuzzy controller "fan": 2 inputs, 1 output, 6 rules.

   Made by `host-sim fuzzy convert fan.fll --to c`:
   change the design and make it again rather than this file.

   It is off the same design in exact arithmetic by at most, where some rule has a degree of
   - fan: 1/2: 0.000835779, 1/8: 0.000835779, 1/64: 0.000835779, any: 0.000835779
*/

#ifndef FAN_H
#define FAN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How many. */
#define FAN_INPUTS 2U
#define FAN_OUTPUTS 1U
#define FAN_TERMS 5U
#define FAN_RULES 6U
/* A full degree; 0 is none. */
#define FAN_FULL UINT32_C(0x1000000)

/* Places of the inputs. */
enum
{
    FAN_TEMPERATURE = 0,
    FAN_HUMIDITY = 1
};

/* Places of the outputs. */
enum
{
    FAN_FAN = 0
};

/* Places of the inputs' terms, among those of all inputs. */
enum
{
    FAN_TEMPERATURE_COOL = 0,
    FAN_TEMPERATURE_WARM = 1,
    FAN_TEMPERATURE_HOT = 2,
    FAN_HUMIDITY_DRY = 3,
    FAN_HUMIDITY_DAMP = 4
};

/* Places of the output's terms. */
enum
{
    FAN_FAN_LOW = 0,
    FAN_FAN_MID = 1,
    FAN_FAN_HIGH = 2
};

/* The input "temperature": 18 to 32; values beyond the range count as its nearer end.
   A step is 2^-FAN_TEMPERATURE_FRACTION. */
#define FAN_TEMPERATURE_FRACTION (16)
#define FAN_TEMPERATURE_LEAST INT32_C(1179648)
#define FAN_TEMPERATURE_MOST INT32_C(2097152)

/* The input "humidity": 30 to 80; values beyond the range count as its nearer end.
   A step is 2^-FAN_HUMIDITY_FRACTION. */
#define FAN_HUMIDITY_FRACTION (16)
#define FAN_HUMIDITY_LEAST INT32_C(1966080)
#define FAN_HUMIDITY_MOST INT32_C(5242880)

/* The output "fan": 0 to 100; no value is beyond.
   A step is 2^-FAN_FAN_FRACTION. */
#define FAN_FAN_FRACTION (16)
#define FAN_FAN_LEAST INT32_C(0)
#define FAN_FAN_MOST INT32_C(6553600)
/* Where no rule fires: 0. */
#define FAN_FAN_DEFAULT INT32_C(0)

/* From inputs to outputs, each in steps of its variable; every number is allowed.
   Every rule's degree goes to `degrees`, 6 of them, unless it is NULL. */
void fan_evaluate(const int32_t in[FAN_INPUTS], int32_t out[FAN_OUTPUTS], uint32_t *degrees);

#ifdef __cplusplus
}
#endif

#endif /* FAN_H */
