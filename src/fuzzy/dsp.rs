//! Four rules weighed in two dozen instructions, where a processor computes with two 16-bit numbers in one register
//! (Cortex-M4 and M7). To the bit what [`weigh`](super::weigh) and [`MirroredTwin`] do without.
#![allow(unsafe_code)]

use super::even::Place;
use super::weigh::{Edge, Weighed};
use super::{InputScale, MirroredTwin};
use core::arch::asm;
use core::mem::offset_of;

/// From the shares in both gaps, r3 of the rows and r5 of the columns, and the left one of two edges, at r4, to r3: the
/// degrees on the left, lr: those on the right, r1 and r2: Σ w·peak of both outputs, and r4: 1/Σw. r5 and r12 are lost.
///
/// A register holds two degrees, negated: −2¹⁵ has 16 bits, and a full degree, 2¹⁵, has not. On the left it is the upper
/// row's that is in the upper half, on the right the lower row's.
macro_rules! four_rules {
    () => {
        concat!(
            // Of the shares the upper 16 bits; what is short of the whole has the complement's bits. Less the largest
            // number and halved, upwards, a share becomes its complement's grade, negated: 1 − f and f, and 1 − g twice.
            "mvn r12, #0\n",
            "mvn lr, r3\n",
            "pkhtb r3, r3, lr, asr #16\n",
            "pkhtb r5, r5, r5, asr #16\n",
            "uhsub16 r3, r3, r12\n",
            "uhsub16 r5, r5, r12\n",
            // The lesser of 1 − f and 1 − g, of f and 1 − g: the left.
            "ssub16 lr, r3, r5\n",
            "sel r3, r3, r5\n",
            // f − (1 − g) + min(1 − f, 1 − g), 1 − f − (1 − g) + min(f, 1 − g): the right.
            "ror lr, lr, #16\n",
            "sadd16 lr, lr, r3\n",
            // Peaks: the left edge crosswise, the right one half by half.
            "ldm r4, {{r1, r2, r4, r5}}\n",
            "smuadx r1, r3, r1\n",
            "smlad r1, lr, r4, r1\n",
            "smuadx r2, r3, r2\n",
            "smlad r2, lr, r5, r2\n",
            // Σw: the degrees times minus one. Then 2³¹ by half of it.
            "smuad r4, r3, r12\n",
            "smlad r4, lr, r12, r4\n",
            "lsr r4, r4, #1\n",
            "lsl r12, r12, #31\n",
            "udiv r4, r12, r4\n",
        )
    };
}

/// As [`weigh`](super::weigh::weigh).
#[inline(always)]
pub(super) fn weigh<const C: usize>(row: &Place, col: &Place, edges: &[Edge; C]) -> Weighed {
    let (on_left, on_right): (u32, u32);
    let (first, second): (i32, i32);
    let reciprocal: u32;
    let gap = col.lower.min(C - 2);
    // SAFETY: reads `edges[gap]` and `edges[gap + 1]`, C of which there are. All else that changes are registers, which
    // are declared, and flags, which the compiler counts as lost.
    unsafe {
        asm!(
            four_rules!(),
            inout("r4") edges.as_ptr().wrapping_add(gap) => reciprocal,
            inout("r3") row.share => on_left,
            inout("r5") col.share => _,
            out("lr") on_right,
            out("r1") first,
            out("r2") second,
            out("r12") _,
            options(pure, readonly, nostack),
        );
    }
    Weighed {
        sums: [first, second],
        degrees: degrees(on_left, on_right),
        reciprocal,
    }
}

/// What [`mirrored`] gives.
pub(super) struct Scaled {
    /// Both outputs, scaled, the second with its sign.
    pub outputs: [i32; 2],
    /// Both [means](super::product::mean).
    pub means: [i32; 2],
    /// As in [`Weighed`].
    pub degrees: [i32; 4],
}

/// [`MirroredTwin::evaluate`], from the settings to the scaled outputs: no register is left over on the way, so the sign
/// of `row` waits in the carry flag.
#[inline(always)]
pub(super) fn mirrored<const R: usize, const C: usize, const GAPS: usize>(
    settings: &MirroredTwin<R, C, GAPS>,
    row: i32,
    col: i32,
) -> Scaled {
    let (on_left, on_right): (u32, u32);
    let (first, second, first_mean, second_mean): (i32, i32, i32, i32);
    const {
        assert!(offset_of!(MirroredTwin<R, C, GAPS>, table) == 0);
        assert!(offset_of!(MirroredTwin<R, C, GAPS>, columns) == 4 && size_of::<InputScale>() == 8);
        assert!(offset_of!(MirroredTwin<R, C, GAPS>, stride) == 12);
    }
    // SAFETY: reads the settings, which begin with the table's address, gain and headroom of the columns, and the size of
    // a row; and of their table, which has R − 1 rows of C edges, two neighbours: a gap, the upper half of a product of
    // 32 bits with R − 1 or C − 1, is below that. All else that changes are registers, which are declared, and flags,
    // which the compiler counts as lost.
    unsafe {
        asm!(
            "ldm r0, {{r4, r5, r12, lr}}",
            // The magnitude, the sign shifted out.
            "eors r2, r2, r2, asr #32",
            "lsl r2, r2, #1",
            // The column's position, as `InputScale::position` finds it.
            "bic r1, r1, r1, asr #31",
            "mul r5, r1, r5",
            "add r12, r1, r12",
            "orr r5, r5, r12, asr #31",
            // Gaps above, shares below; and the edge.
            "mov r12, #{col_gaps}",
            "umull r5, r1, r5, r12",
            ".if {row_gaps} != {col_gaps}",
            "mov r12, #{row_gaps}",
            ".endif",
            "umull r3, r12, r2, r12",
            "mla r4, r12, lr, r4",
            "add r4, r4, r1, lsl #3",
            four_rules!(),
            // Means, as `product::mean` takes them; scales; the sign.
            "lsl r4, r4, #12",
            "smmul r12, r4, r1",
            "smmul r2, r4, r2",
            "ldrd r4, r5, [r0, #{outputs}]",
            "smmul r0, r12, r4",
            "smmul r1, r2, r5",
            "it cs",
            "rsbcs r1, r1, #0",
            row_gaps = const { R - 1 },
            col_gaps = const { C - 1 },
            outputs = const { offset_of!(MirroredTwin<R, C, GAPS>, outputs) },
            inout("r0") settings => first,
            inout("r1") col => second,
            inout("r2") row => second_mean,
            out("r3") on_left,
            out("r4") _,
            out("r5") _,
            out("r12") first_mean,
            out("lr") on_right,
            options(pure, readonly, nostack),
        );
    }
    Scaled {
        outputs: [first, second],
        means: [first_mean, second_mean],
        degrees: degrees(on_left, on_right),
    }
}

/// Row by row, left before right.
#[inline(always)]
fn degrees(on_left: u32, on_right: u32) -> [i32; 4] {
    let upper = |pair: u32| (pair as i32 >> 16).wrapping_neg();
    let lower = |pair: u32| i32::from(pair as i16).wrapping_neg();
    [
        upper(on_left),
        lower(on_right),
        lower(on_left),
        upper(on_right),
    ]
}
