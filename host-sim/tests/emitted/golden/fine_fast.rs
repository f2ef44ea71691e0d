//! The fuzzy controller `fine`: 2 inputs, 2 outputs, 25 rules.
//!
//! Made by `host-sim fuzzy convert fine.fll --to rust --route fast`:
//! change the design and make it again rather than this file. It needs the crates `fuzzypilot` and `fixed`.
//!
//! Route: fast, `fuzzypilot::fuzzy::TwinTable`: two outputs over evenly spaced terms at once. Only the four
//! rules around an input are evaluated; the work is the same for every input.
//!
//! All numbers are whole steps, which each variable has for itself:
//!
//! | variable | a step | from | to | beyond |
//! |---|---|---|---|---|
//! | input `phi` | 2^-16 | 0 = 0 | 11796480 = 180 | counts as the outermost term |
//! | input `d` | 2^-16 | 0 = 0 | 262144 = 4 | counts as the outermost term |
//! | output `speed` | 2^-25 | 13422592 = 0.4000244140625 | 87240704 = 2.5999755859375 | never |
//! | output `deflection` | 2^-20 | 0 = 0 | 94371840 = 90 | never |
//!
//! It is off the same design in exact arithmetic by at most
//!
//! * 0.000376252 of `speed`
//! * 0.0122011 of `deflection`

// Not everything is needed everywhere.
#![allow(dead_code)]

use fixed::types::I16F16;
use fuzzypilot::fuzzy::{
    Antecedents, Consequents, Partition, Position, RuleTable, Term, TwinTable,
};

/// Place of `phi` among the inputs.
pub const PHI: usize = 0;
/// A step of `phi` is 2^−this.
pub const PHI_FRACTION: i32 = 16;
/// `phi` as a number: `to_bits` gives its steps, `from_bits` takes them.
pub type Phi = fixed::FixedI32<fixed::types::extra::U16>;

/// Place of `d` among the inputs.
pub const D: usize = 1;
/// A step of `d` is 2^−this.
pub const D_FRACTION: i32 = 16;
/// `d` as a number: `to_bits` gives its steps, `from_bits` takes them.
pub type D = fixed::FixedI32<fixed::types::extra::U16>;

/// Place of `speed` among the outputs.
pub const SPEED: usize = 0;
/// A step of `speed` is 2^−this.
pub const SPEED_FRACTION: i32 = 25;
/// `speed` as a number: `to_bits` gives its steps, `from_bits` takes them.
pub type Speed = fixed::FixedI32<fixed::types::extra::U25>;

/// Place of `deflection` among the outputs.
pub const DEFLECTION: usize = 1;
/// A step of `deflection` is 2^−this.
pub const DEFLECTION_FRACTION: i32 = 20;
/// `deflection` as a number: `to_bits` gives its steps, `from_bits` takes them.
pub type Deflection = fixed::FixedI32<fixed::types::extra::U20>;

/// Where the inputs' terms have their peaks.
#[rustfmt::skip]
const INPUTS: Antecedents<5, 5> = Antecedents {
    // phi: VS, S, N, B, VB
    rows: Partition::new([I16F16::lit("0"), I16F16::lit("45"), I16F16::lit("90"), I16F16::lit("135"), I16F16::lit("180")]),
    // d: VN, QN, N, QF, VF
    cols: Partition::new([I16F16::lit("0"), I16F16::lit("1"), I16F16::lit("2"), I16F16::lit("3"), I16F16::lit("4")]),
};

/// `speed` becomes `VS`.
const SPEED_VS: Term = Term(0);
/// `speed` becomes `S`.
const SPEED_S: Term = Term(1);
/// `speed` becomes `N`.
const SPEED_N: Term = Term(2);
/// `speed` becomes `B`.
const SPEED_B: Term = Term(3);
/// `speed` becomes `VB`.
const SPEED_VB: Term = Term(4);
/// `speed` in the table.
type SpeedTable = fixed::FixedI16<fixed::types::extra::U13>;

// if phi is VS and d is VN then speed is S and deflection is VS
// if phi is VS and d is QN then speed is S and deflection is VS
// if phi is VS and d is N then speed is N and deflection is VS
// if phi is VS and d is QF then speed is B and deflection is VS
// if phi is VS and d is VF then speed is VB and deflection is VS
// if phi is S and d is VN then speed is S and deflection is S
// if phi is S and d is QN then speed is S and deflection is N
// if phi is S and d is N then speed is N and deflection is S
// if phi is S and d is QF then speed is N and deflection is S
// if phi is S and d is VF then speed is B and deflection is S
// if phi is N and d is VN then speed is VS and deflection is VS
// if phi is N and d is QN then speed is S and deflection is N
// if phi is N and d is N then speed is S and deflection is N
// if phi is N and d is QF then speed is N and deflection is S
// if phi is N and d is VF then speed is N and deflection is S
// if phi is B and d is VN then speed is VS and deflection is N
// if phi is B and d is QN then speed is VS and deflection is B
// if phi is B and d is N then speed is S and deflection is B
// if phi is B and d is QF then speed is S and deflection is N
// if phi is B and d is VF then speed is N and deflection is N
// if phi is VB and d is VN then speed is VB and deflection is B
// if phi is VB and d is QN then speed is VS and deflection is VB
// if phi is VB and d is N then speed is VS and deflection is B
// if phi is VB and d is QF then speed is S and deflection is B
// if phi is VB and d is VF then speed is N and deflection is N
/// `speed`: a row for each term of `phi`, a column for each of `d`.
#[rustfmt::skip]
const SPEED_RULES: RuleTable<5, 5, SpeedTable> = RuleTable::new(
    // VN        QN        N         QF        VF
    [[SPEED_S , SPEED_S , SPEED_N , SPEED_B , SPEED_VB],  // VS
     [SPEED_S , SPEED_S , SPEED_N , SPEED_N , SPEED_B ],  // S
     [SPEED_VS, SPEED_S , SPEED_S , SPEED_N , SPEED_N ],  // N
     [SPEED_VS, SPEED_VS, SPEED_S , SPEED_S , SPEED_N ],  // B
     [SPEED_VB, SPEED_VS, SPEED_VS, SPEED_S , SPEED_N ]], // VB
    Consequents::new(
        [SpeedTable::lit("0"), SpeedTable::lit("3")],
        [SpeedTable::lit("0.4"), SpeedTable::lit("0.75"), SpeedTable::lit("1.5"), SpeedTable::lit("2.25"), SpeedTable::lit("2.6")],
    ),
);

/// `deflection` becomes `VS`.
const DEFLECTION_VS: Term = Term(0);
/// `deflection` becomes `S`.
const DEFLECTION_S: Term = Term(1);
/// `deflection` becomes `N`.
const DEFLECTION_N: Term = Term(2);
/// `deflection` becomes `B`.
const DEFLECTION_B: Term = Term(3);
/// `deflection` becomes `VB`.
const DEFLECTION_VB: Term = Term(4);
/// `deflection` in the table.
type DeflectionTable = fixed::FixedI16<fixed::types::extra::U8>;

// if phi is VS and d is VN then speed is S and deflection is VS
// if phi is VS and d is QN then speed is S and deflection is VS
// if phi is VS and d is N then speed is N and deflection is VS
// if phi is VS and d is QF then speed is B and deflection is VS
// if phi is VS and d is VF then speed is VB and deflection is VS
// if phi is S and d is VN then speed is S and deflection is S
// if phi is S and d is QN then speed is S and deflection is N
// if phi is S and d is N then speed is N and deflection is S
// if phi is S and d is QF then speed is N and deflection is S
// if phi is S and d is VF then speed is B and deflection is S
// if phi is N and d is VN then speed is VS and deflection is VS
// if phi is N and d is QN then speed is S and deflection is N
// if phi is N and d is N then speed is S and deflection is N
// if phi is N and d is QF then speed is N and deflection is S
// if phi is N and d is VF then speed is N and deflection is S
// if phi is B and d is VN then speed is VS and deflection is N
// if phi is B and d is QN then speed is VS and deflection is B
// if phi is B and d is N then speed is S and deflection is B
// if phi is B and d is QF then speed is S and deflection is N
// if phi is B and d is VF then speed is N and deflection is N
// if phi is VB and d is VN then speed is VB and deflection is B
// if phi is VB and d is QN then speed is VS and deflection is VB
// if phi is VB and d is N then speed is VS and deflection is B
// if phi is VB and d is QF then speed is S and deflection is B
// if phi is VB and d is VF then speed is N and deflection is N
/// `deflection`: a row for each term of `phi`, a column for each of `d`.
#[rustfmt::skip]
const DEFLECTION_RULES: RuleTable<5, 5, DeflectionTable> = RuleTable::new(
    // VN             QN             N              QF             VF
    [[DEFLECTION_VS, DEFLECTION_VS, DEFLECTION_VS, DEFLECTION_VS, DEFLECTION_VS],  // VS
     [DEFLECTION_S , DEFLECTION_N , DEFLECTION_S , DEFLECTION_S , DEFLECTION_S ],  // S
     [DEFLECTION_VS, DEFLECTION_N , DEFLECTION_N , DEFLECTION_S , DEFLECTION_S ],  // N
     [DEFLECTION_N , DEFLECTION_B , DEFLECTION_B , DEFLECTION_N , DEFLECTION_N ],  // B
     [DEFLECTION_B , DEFLECTION_VB, DEFLECTION_B , DEFLECTION_B , DEFLECTION_N ]], // VB
    Consequents::new(
        [DeflectionTable::lit("0"), DeflectionTable::lit("90")],
        [DeflectionTable::lit("0"), DeflectionTable::lit("20"), DeflectionTable::lit("45"), DeflectionTable::lit("70"), DeflectionTable::lit("90")],
    ),
);

/// Both tables in one, which is all of them that is kept; for positions that are at hand, see `TwinTable::evaluate`.
#[rustfmt::skip]
pub static RULES: TwinTable<5, 5, 4> = TwinTable::new(&INPUTS, &SPEED_RULES, &DEFLECTION_RULES);

/// The outputs for inputs, each in steps of its variable.
#[inline]
pub fn evaluate(inputs: [i32; 2]) -> [i32; 2] {
    let [row, column] = inputs;
    let row = position::<0, 11796480>(row);
    let column = position::<0, 262144>(column);
    let twin = RULES.evaluate(row, column);
    [twin.first, twin.second]
}

/// Where `x` lies between two numbers of steps; what is beyond counts as the nearer one.
#[inline]
fn position<const FIRST: i32, const LAST: i32>(x: i32) -> Position {
    let (reciprocal, shift) = const {
        let span = LAST.wrapping_sub(FIRST) as u32;
        let shift = span.leading_zeros();
        (((1u64 << 62) / ((span as u64) << shift)) as u32, shift)
    };
    let distance = x.clamp(FIRST, LAST).wrapping_sub(FIRST) as u32;
    let wide = u64::from(distance.wrapping_shl(shift)).wrapping_mul(u64::from(reciprocal)) >> 30;
    Position::from_bits(wide.min(u64::from(u32::MAX)) as u32)
}
