//! A twin table between physical units, for what is symmetrical: raw numbers in, raw numbers out.
//!
//! Where left and right are alike, a rule base of one half is enough: the first input's magnitude is looked up, and the
//! second output takes its sign.

use super::even::Position;
use super::scale::{InputScale, OutputScale};
use super::{Twin, TwinTable};

/// A [`TwinTable`] and the scales around it.
///
/// The rows' input is a signed binary number, as an angle is: it needs no scale. The order of the fields is that in which
/// the Cortex-M4's instructions load them.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MirroredTwin<const R: usize, const C: usize, const GAPS: usize> {
    pub(super) table: &'static TwinTable<R, C, GAPS>,
    pub(super) columns: InputScale,
    /// Bytes from one row of the table to the next.
    #[cfg(dsp)]
    pub(super) stride: u32,
    pub(super) outputs: [OutputScale; 2],
}

/// What one evaluation gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mirrored<const R: usize, const C: usize> {
    /// The first output, scaled.
    pub first: i32,
    /// The second output, scaled, with the sign of the rows' input.
    pub second: i32,
    /// Where the magnitude of the rows' input lies on its axis.
    pub row: Position,
    /// Where the columns' input lies on its axis.
    pub column: Position,
    /// The outputs on their axes, and the rules.
    pub twin: Twin<R, C>,
}

impl<const R: usize, const C: usize, const GAPS: usize> MirroredTwin<R, C, GAPS> {
    /// From the tables, the columns' scale and that of each output; these take a [`Twin`]'s
    /// [more bits](Twin::EXTRA_BITS).
    pub const fn new(
        table: &'static TwinTable<R, C, GAPS>,
        columns: InputScale,
        outputs: [OutputScale; 2],
    ) -> Self {
        Self {
            table,
            columns,
            #[cfg(dsp)]
            stride: TwinTable::<R, C, GAPS>::STRIDE,
            outputs,
        }
    }

    /// Both outputs, scaled. `row` is signed, in steps of 2⁻³¹ of the rows' axis; a negative one's magnitude is taken one
    /// step less. `column` is a raw number, see [`InputScale::position`].
    #[inline(always)]
    pub fn evaluate(&self, row: i32, column: i32) -> Mirrored<R, C> {
        #[cfg(not(dsp))]
        return self.evaluate_plain(row, column);
        #[cfg(dsp)]
        {
            let scaled = super::dsp::mirrored(self, row, column);
            // Who does not look at these pays nothing for them.
            let (row, column) = (magnitude(row), self.columns.position(column));
            let [first, second] = scaled.outputs;
            Mirrored {
                first,
                second,
                row,
                column,
                twin: Twin::of(row, column, scaled.means, scaled.degrees),
            }
        }
    }

    /// [`evaluate`](Self::evaluate) without any processor's own instructions: the same result on every one.
    #[inline(always)]
    pub fn evaluate_plain(&self, row: i32, column: i32) -> Mirrored<R, C> {
        let sign = row >> 31;
        let (row, column) = (magnitude(row), self.columns.position(column));
        let twin = self.table.evaluate_plain(row, column);
        let [first, second] = self.outputs;
        Mirrored {
            first: first.apply(twin.first),
            second: (second.apply(twin.second) ^ sign).wrapping_sub(sign),
            row,
            column,
            twin,
        }
    }
}

/// 2^31 steps are the axis: of its 2^32 steps, two each.
#[inline(always)]
const fn magnitude(row: i32) -> Position {
    Position::from_bits(((row ^ (row >> 31)) as u32) << 1)
}
