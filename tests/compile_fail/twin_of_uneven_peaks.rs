//! A twin table finds its gap by one product: 0, 1, 3 are not evenly spaced.
use fixed::types::{I8F8, I16F16};
use fuzzypilot::fuzzy::{Antecedents, Consequents, Partition, RuleTable, Term, TwinTable};

const INPUTS: Antecedents<3, 2> = Antecedents {
    rows: Partition::new([I16F16::lit("0"), I16F16::lit("1"), I16F16::lit("3")]),
    cols: Partition::new([I16F16::lit("0"), I16F16::lit("1")]),
};
const SPEED: RuleTable<3, 2, I8F8> = RuleTable::new(
    [[Term(0); 2]; 3],
    Consequents::new([I8F8::lit("0"), I8F8::lit("3")], [I8F8::lit("1")]),
);

pub static TWIN: TwinTable<3, 2, 2> = TwinTable::new(&INPUTS, &SPEED, &SPEED);

fn main() {}
