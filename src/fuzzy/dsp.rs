//! Four rules weighed in eight instructions, where a processor computes with two 16-bit numbers in one register
//! (Cortex-M4 and M7). To the bit what [`weigh`](super::weigh) does without.
#![allow(unsafe_code)]

use super::even::{FULL, Place};
use super::weigh::{Edge, Weighed};
use core::arch::asm;

/// As [`weigh`](super::weigh::weigh).
#[inline(always)]
pub(super) fn weigh(row: &Place, col: &Place, left: Edge, right: Edge) -> Weighed {
    let (f, g) = (row.upper, col.upper);
    // Two degrees a register, lower half and upper half: above left, below left…
    let on_left: u32;
    // …and below right, above right.
    let on_right: u32;
    let (first, second): (i32, i32);
    // SAFETY: register to register. All else that changes are flags, and the compiler counts them as lost.
    unsafe {
        asm!(
            // Differences f − g, 1 − f − g; by their signs the weaker of f and g, 1 − f and g: negated, the larger.
            "ssub16 {left}, {right}, {cols}",
            "sel {right}, {right}, {cols}",
            // 1 − f − g + min(f, g), f − g + min(1 − f, g).
            "ror {left}, {left}, #16",
            "sadd16 {left}, {left}, {right}",
            // The left edge half by half, the right one crosswise.
            "smuad {first}, {left}, {first}",
            "smladx {first}, {right}, {right_first}, {first}",
            "smuad {second}, {left}, {second}",
            "smladx {second}, {right}, {right_second}, {second}",
            left = out(reg) on_left,
            right = inout(reg) pair(f, FULL.wrapping_sub(f)) => on_right,
            cols = in(reg) pair(g, g),
            first = inout(reg) left.first => first,
            second = inout(reg) left.second => second,
            right_first = in(reg) right.first,
            right_second = in(reg) right.second,
            options(pure, nomem, nostack),
        );
    }
    let (above_left, below_left) = halves(on_left);
    let (below_right, above_right) = halves(on_right);
    Weighed {
        sums: [first, second],
        degrees: [above_left, above_right, below_left, below_right],
        excess: g.wrapping_sub(below_right).wrapping_sub(above_right) as u32,
    }
}

#[inline(always)]
fn pair(lower: i32, upper: i32) -> u32 {
    (lower as u32 & 0xffff) | (upper as u32) << 16
}

#[inline(always)]
fn halves(pair: u32) -> (i32, i32) {
    (i32::from(pair as i16), pair as i32 >> 16)
}
