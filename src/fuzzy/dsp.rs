//! Four rules weighed in two dozen instructions, where a processor computes with two 16-bit numbers in one register
//! (Cortex-M4 and M7). To the bit what [`weigh`](super::weigh) does without.
#![allow(unsafe_code)]

use super::even::Place;
use super::weigh::{Edge, Weighed};
use core::arch::asm;

/// As [`weigh`](super::weigh::weigh).
#[inline(always)]
pub(super) fn weigh<const C: usize>(row: &Place, col: &Place, edges: &[Edge; C]) -> Weighed {
    // Two degrees a register, negated, lower half and upper half: above left and below left…
    let on_left: u32;
    // …below right and above right.
    let on_right: u32;
    let (first, second): (i32, i32);
    let reciprocal: u32;
    let gap = col.lower.min(C - 2);
    // SAFETY: reads `edges[gap]` and `edges[gap + 1]`, C of which there are. All else that changes are registers, which
    // are declared, and flags, which the compiler counts as lost.
    unsafe {
        asm!(
            "add {edges}, {edges}, {left}, lsl #3",
            // Of the shares the upper 16 bits, and half of that, rounded: the grades f and 1 − f, and g twice, negated.
            // What is short of the whole has the complement's bits.
            "mvn {right}, {rows}",
            "pkhtb {right}, {right}, {rows}, asr #16",
            "pkhtb {cols}, {cols}, {cols}, asr #16",
            "mov {left}, #0",
            "uhsub16 {right}, {left}, {right}",
            "uhsub16 {cols}, {left}, {cols}",
            // Differences f − g, 1 − f − g; by their signs the lesser of f and g, 1 − f and g.
            "ssub16 {left}, {right}, {cols}",
            "sel {right}, {right}, {cols}",
            // 1 − f − g + min(f, g), f − g + min(1 − f, g).
            "ror {left}, {left}, #16",
            "sadd16 {left}, {left}, {right}",
            // Peaks: the left edge half by half, the right one crosswise.
            "ldrd {rows}, {cols}, [{edges}]",
            "ldrd {last}, {edges}, [{edges}, #8]",
            "smuad {rows}, {left}, {rows}",
            "smladx {rows}, {right}, {last}, {rows}",
            "smuad {cols}, {left}, {cols}",
            "smladx {cols}, {right}, {edges}, {cols}",
            // Σw: the degrees times minus one. Then 2³¹ by half of it.
            "mvn {edges}, #0",
            "smuad {last}, {left}, {edges}",
            "smlad {last}, {right}, {edges}, {last}",
            "lsr {last}, {last}, #1",
            "lsl {edges}, {edges}, #31",
            "udiv {last}, {edges}, {last}",
            edges = inout(reg) edges.as_ptr() => _,
            left = inout(reg) gap => on_left,
            right = out(reg) on_right,
            rows = inout(reg) row.share => first,
            cols = inout(reg) col.share => second,
            last = out(reg) reciprocal,
            options(pure, readonly, nostack),
        );
    }
    let (above_left, below_left) = halves(on_left);
    let (below_right, above_right) = halves(on_right);
    Weighed {
        sums: [first, second],
        degrees: [above_left, above_right, below_left, below_right],
        reciprocal,
    }
}

/// Both degrees.
#[inline(always)]
fn halves(pair: u32) -> (i32, i32) {
    (
        i32::from(pair as i16).wrapping_neg(),
        (pair as i32 >> 16).wrapping_neg(),
    )
}
