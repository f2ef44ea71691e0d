//! The arithmetic of `fuzzypilot::fuzzy::system` in C, function by function. A source has those that it calls.
//!
//! C leaves open what a shift of a negative number is and what a conversion gives that does not fit; nothing here does
//! either. Divisions are done bit by bit: the same steps for every number, and no library's routine.

/// A function: its name, its text, and what it calls.
struct Function {
    name: &'static str,
    text: &'static str,
    calls: &'static [&'static str],
}

/// In an order in which none is called before it is known.
const FUNCTIONS: [Function; 15] = [
    Function {
        name: "least",
        text: "
/* The smaller of two degrees. */
static uint32_t least(uint32_t a, uint32_t b)
{
    return (a < b) ? a : b;
}
",
        calls: &[],
    },
    Function {
        name: "most",
        text: "
/* The larger of two degrees. */
static uint32_t most(uint32_t a, uint32_t b)
{
    return (a > b) ? a : b;
}
",
        calls: &[],
    },
    Function {
        name: "product",
        text: "
/* The product of two degrees, rounded to nearest. */
static uint32_t product(uint32_t a, uint32_t b)
{
    return (uint32_t)((((uint64_t)a * b) + UINT64_C(0x800000)) >> 24);
}
",
        calls: &[],
    },
    Function {
        name: "complement",
        text: "
/* NOT. */
static uint32_t complement(uint32_t degree)
{
    return FULL - degree;
}
",
        calls: &[],
    },
    Function {
        name: "limited",
        text: "
/* x, or the end of [low, high] that it is beyond. */
static int32_t limited(int64_t x, int32_t low, int32_t high)
{
    const int64_t above = (x < low) ? low : x;
    return (int32_t)((above > high) ? high : above);
}
",
        calls: &[],
    },
    Function {
        name: "shifted",
        text: "
/* x / 2^shift, rounded down, for a shift below 63. */
static int64_t shifted(int64_t x, uint32_t shift)
{
    const uint64_t bits = (uint64_t)((x < 0) ? (-1 - x) : x) >> shift;
    return (x < 0) ? (-1 - (int64_t)bits) : (int64_t)bits;
}
",
        calls: &[],
    },
    Function {
        name: "added",
        text: "
/* a + b modulo 2^32. */
static int32_t added(int32_t a, uint32_t b)
{
    const uint32_t sum = (uint32_t)a + b;
    return (sum <= UINT32_C(0x7fffffff)) ? (int32_t)sum : (-1 - (int32_t)(UINT32_MAX - sum));
}
",
        calls: &[],
    },
    Function {
        name: "membership",
        text: "
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
",
        calls: &["shifted"],
    },
    Function {
        name: "reduce",
        text: "
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
",
        calls: &[],
    },
    Function {
        name: "quotient",
        text: "
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
",
        calls: &[],
    },
    Function {
        name: "rounded",
        text: "
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
",
        calls: &["reduce", "quotient"],
    },
    Function {
        name: "linear",
        text: "
/* constant + sum of coefficient * input / 2^shift, rounded to nearest, within the limit. */
static int32_t linear(const int32_t coefficients[], const int32_t inputs[], uint32_t count, uint32_t shift,
                      int32_t constant)
{
    int64_t sum = (int64_t)((UINT64_C(1) << shift) >> 1);
    uint32_t i;
    for (i = 0U; i < count; i++)
    {
        sum += (int64_t)coefficients[i] * inputs[i];
    }
    return limited(shifted(sum, shift) + constant, -LIMIT, LIMIT);
}
",
        calls: &["shifted", "limited"],
    },
    Function {
        name: "add",
        text: "
/* One conclusion of a weighted average. */
static void add(int64_t *sum, uint64_t *weight, uint32_t degree, int32_t value)
{
    *sum += (int64_t)degree * value;
    *weight += degree;
}
",
        calls: &[],
    },
    Function {
        name: "place",
        text: "
/* The mean place among samples, in 2^-21 of a place. */
static uint32_t place(uint64_t moment, uint64_t area)
{
    uint64_t top = moment;
    uint64_t bottom = area;
    reduce(&top, &bottom);
    return quotient((top << 21) + (bottom >> 1), (uint32_t)bottom);
}
",
        calls: &["reduce", "quotient"],
    },
    Function {
        name: "sample",
        text: "
/* The output at a place among samples. */
static int32_t sample(uint32_t at, int32_t low, uint32_t offset, uint32_t step, uint32_t shift)
{
    const uint64_t half = (UINT64_C(1) << shift) >> 1;
    const uint64_t distance = (((uint64_t)(at + offset) * step) + half) >> shift;
    return added(low, (uint32_t)distance);
}
",
        calls: &["added"],
    },
];

/// The functions that a text calls, and those that they call.
pub fn called_by(text: &str) -> String {
    let mut called: Vec<bool> = FUNCTIONS
        .iter()
        .map(|function| calls(text, function.name))
        .collect();
    // No function calls one behind it.
    for (i, function) in FUNCTIONS.iter().enumerate().rev() {
        if called[i] {
            for (j, other) in FUNCTIONS.iter().enumerate() {
                called[j] |= function.calls.contains(&other.name);
            }
        }
    }
    let functions = FUNCTIONS.iter().zip(called).filter(|(_, called)| *called);
    functions.map(|(function, _)| function.text).collect()
}

fn calls(text: &str, name: &str) -> bool {
    let call = format!("{name}(");
    text.match_indices(&call).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_called_is_there() {
        assert_eq!(called_by("x = at_least(1); /* most */"), "");
        let text = called_by("x = place(a, b);");
        assert!(
            text.contains("reduce(") && text.contains("quotient(") && !text.contains("rounded(")
        );
    }

    #[test]
    fn a_function_is_known_before_it_is_called() {
        for (i, function) in FUNCTIONS.iter().enumerate() {
            let known = FUNCTIONS[..i].iter().map(|f| f.name);
            assert!(
                function
                    .calls
                    .iter()
                    .all(|call| known.clone().any(|k| k == *call))
            );
            for other in &FUNCTIONS {
                let called = other.name != function.name && calls(function.text, other.name);
                assert_eq!(
                    called,
                    function.calls.contains(&other.name),
                    "{} {}",
                    function.name,
                    other.name
                );
            }
        }
    }
}
