//! A table's output has the format of its consequents.
use fixed::types::{I4F12, I8F8};
use fuzzypilot::fuzzy::{Consequents, RuleTable, Term};

const PEAKS: Consequents<1, I4F12> = Consequents::new([I4F12::lit("0"), I4F12::lit("3")], [I4F12::lit("1")]);
pub static SPEED: RuleTable<2, 2, I8F8> = RuleTable::new([[Term(0); 2]; 2], PEAKS);

fn main() {}
