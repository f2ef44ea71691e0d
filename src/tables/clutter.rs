//! Coarse grain for clutter: free travel and the angle to the chosen heading to the deflection wanted and the speed, both
//! from one rule base.
//!
//! Tables 7.3 and 7.4 pass one circle. Among many the geometry chooses the heading, and what is left to the rules is how
//! fast to turn into it and how fast to drive. Rows s are the free travel; columns |α| the angle; the deflection has α's
//! sign, so no side is preferred.

use super::coarse::{CoarseTwin, Deflection, SpeedShare};
use crate::fuzzy::{Antecedents, Consequents, Partition, RuleTable, Term, TwinTable};
use fixed::types::I16F16;

const VS: Term = Term(0);
const S: Term = Term(1);
const N: Term = Term(2);
const B: Term = Term(3);
const VB: Term = Term(4);

/// s from 0 to 1 of its axis; |α| in degrees.
const ANTECEDENTS: Antecedents<3, 3> = Antecedents {
    rows: Partition::new([I16F16::lit("0"), I16F16::lit("0.5"), I16F16::lit("1")]),
    cols: Partition::new([I16F16::lit("0"), I16F16::lit("45"), I16F16::lit("90")]),
};

/// Peaks of the two outputs' terms VS to VB, ascending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peaks {
    /// Of the deflection, 0° to 90°.
    pub deflection: [Deflection; 5],
    /// Of the speed, as shares of the top speed, 0 to 1.
    pub speed: [SpeedShare; 5],
}

impl Peaks {
    /// Both tables with these peaks.
    ///
    /// # Panics
    ///
    /// If peaks do not ascend or lie outside their range; in a `const` or `static` that is a compile error. Not for the control
    /// loop.
    pub const fn tables(&self) -> CoarseTwin {
        let deflections = Consequents::new(
            const { [Deflection::lit("0"), Deflection::lit("90")] },
            self.deflection,
        );
        let speeds = Consequents::new(
            const { [SpeedShare::lit("0"), SpeedShare::lit("1")] },
            self.speed,
        );
        #[rustfmt::skip]
        let deflection: RuleTable<3, 3, Deflection> = RuleTable::new(
            // α:  Z   M   L      s
            [   [ VS, N,  VB ], // N
                [ VS, N,  VB ], // M
                [ VS, N,  VB ]],// F
            deflections,
        );
        #[rustfmt::skip]
        let speed: RuleTable<3, 3, SpeedShare> = RuleTable::new(
            // α:  Z   M   L      s
            [   [ S,  VS, VS ], // N
                [ B,  N,  VS ], // M
                [ VB, B,  VS ]],// F
            speeds,
        );
        TwinTable::new(&ANTECEDENTS, &deflection, &speed)
    }
}

/// Evenly spread peaks to start from.
pub const PEAKS: Peaks = Peaks {
    deflection: [
        Deflection::lit("0"),
        Deflection::lit("30"),
        Deflection::lit("45"),
        Deflection::lit("70"),
        Deflection::lit("90"),
    ],
    speed: [
        SpeedShare::lit("0.05"),
        SpeedShare::lit("0.3"),
        SpeedShare::lit("0.6"),
        SpeedShare::lit("0.8"),
        SpeedShare::lit("1"),
    ],
};

/// Both tables with [`PEAKS`].
pub static CLUTTER: CoarseTwin = PEAKS.tables();
