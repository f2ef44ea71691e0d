//! Three rows have two gaps, not three.
use fixed::types::{I8F8, I16F16};
use fuzzypilot::fuzzy::{Antecedents, Consequents, Partition, RuleTable, Term, TwinTable};

const INPUTS: Antecedents<3, 2> = Antecedents {
    rows: Partition::new([I16F16::lit("0"), I16F16::lit("1"), I16F16::lit("2")]),
    cols: Partition::new([I16F16::lit("0"), I16F16::lit("1")]),
};
const SPEED: RuleTable<3, 2, I8F8> = RuleTable::new(
    [[Term(0); 2]; 3],
    Consequents::new([I8F8::lit("0"), I8F8::lit("3")], [I8F8::lit("1")]),
);

pub static TWIN: TwinTable<3, 2, 3> = TwinTable::new(&INPUTS, &SPEED, &SPEED);

fn main() {}
