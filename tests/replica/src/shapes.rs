//! Twin tables of other shapes than the fine controller's, to compare what each processor's own instructions make of them.

use crate::fine::{grid, mix};
use fixed::FixedI16;
use fixed::types::I16F16;
use fixed::types::extra::U8;
use fuzzypilot::fuzzy::{
    Antecedents, Consequents, InputScale, MirroredTwin, OutputScale, Partition, RuleTable, Term,
    TwinTable,
};

/// A checksum over the grid of one table with fewer rows than columns and one with more, neither with 2^n gaps alone.
pub fn checksum() -> u32 {
    static FLAT: TwinTable<3, 6, 2> = twin();
    static STEEP: TwinTable<7, 2, 6> = twin();
    over_grid(&FLAT).wrapping_add(over_grid(&STEEP))
}

fn over_grid<const R: usize, const C: usize, const GAPS: usize>(
    table: &'static TwinTable<R, C, GAPS>,
) -> u32 {
    let scales = [OutputScale::new(1, 3), OutputScale::new(1, 700)];
    let mirrored = MirroredTwin::new(table, InputScale::new(163_840), scales);
    grid().fold(0, |sum, (d, error)| {
        let out = mirrored.evaluate(error.bits(), d.bits());
        // The table alone takes another way to the same.
        let twin = table.evaluate(out.row, out.column);
        let degrees = twin
            .activation
            .degrees()
            .map(|grade| i32::from(grade.bits()));
        let same = i32::from(twin == out.twin);
        let sum = mix(sum, (out.first, out.second));
        let sum = mix(sum, (degrees[0] ^ degrees[3], degrees[1] ^ degrees[2]));
        mix(sum, (out.twin.first, out.twin.second.wrapping_add(same)))
    })
}

/// Neighbours differ, by everything a format has.
const fn twin<const R: usize, const C: usize, const GAPS: usize>() -> TwinTable<R, C, GAPS> {
    let (mut rows, mut cols) = ([I16F16::ZERO; R], [I16F16::ZERO; C]);
    let mut cells = [[[Term(0); C]; R]; 2];
    let mut row = 0;
    while row < R {
        rows[row] = I16F16::from_bits((row as i32) << 16);
        let mut col = 0;
        while col < C {
            cols[col] = I16F16::from_bits((col as i32) << 16);
            cells[0][row][col] = Term((row as u8 + 2 * col as u8) % 4);
            cells[1][row][col] = Term((3 * row as u8 + col as u8) % 4);
            col += 1;
        }
        row += 1;
    }
    let inputs = Antecedents {
        rows: Partition::new(rows),
        cols: Partition::new(cols),
    };
    let peaks = [
        FixedI16::<U8>::from_bits(-i16::MAX),
        FixedI16::from_bits(-12_345),
        FixedI16::from_bits(7),
        FixedI16::MAX,
    ];
    let range = [peaks[0], peaks[3]];
    let [first, second] = cells;
    TwinTable::new(
        &inputs,
        &RuleTable::new(first, Consequents::new(range, peaks)),
        &RuleTable::new(second, Consequents::new(range, peaks)),
    )
}
