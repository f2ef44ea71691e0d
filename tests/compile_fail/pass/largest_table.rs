//! What the limits allow: seven terms everywhere, uneven peaks, two outputs of different formats on one activation.
use fixed::types::{I4F12, I8F8, I16F16};
use fuzzypilot::fuzzy::{Antecedents, Consequents, Partition, RuleTable, Term};

const AXIS: Partition<7> = Partition::new([
    I16F16::MIN,
    I16F16::lit("-3"),
    I16F16::lit("-2.99999"),
    I16F16::lit("0"),
    I16F16::lit("0.5"),
    I16F16::lit("900"),
    I16F16::MAX,
]);
static INPUTS: Antecedents<7, 7> = Antecedents { rows: AXIS, cols: AXIS };
static TURN: RuleTable<7, 7, I8F8> = RuleTable::new(
    [[Term(0), Term(1), Term(2), Term(3), Term(4), Term(5), Term(6)]; 7],
    Consequents::new(
        [I8F8::MIN, I8F8::MAX],
        [
            I8F8::lit("-127.99609375"),
            I8F8::lit("-1"),
            I8F8::lit("0"),
            I8F8::lit("0.5"),
            I8F8::lit("1"),
            I8F8::lit("2"),
            I8F8::MAX,
        ],
    ),
);
static SPEED: RuleTable<7, 7, I4F12> = RuleTable::new(
    [[Term(1); 7]; 7],
    Consequents::scaled(
        [I16F16::lit("0"), I16F16::lit("40")],
        [I16F16::lit("10"), I16F16::lit("40")],
        I16F16::lit("0.125"),
    ),
);

fn main() {
    let activation = INPUTS.activate(I16F16::lit("7"), I16F16::lit("0"));
    assert_eq!(TURN.defuzzify(&activation), I8F8::lit("0.5"));
    assert_eq!(SPEED.defuzzify(&activation), I4F12::lit("5"));
    let beyond = INPUTS.activate(I16F16::MIN, I16F16::MAX);
    assert_eq!(TURN.defuzzify(&beyond), I8F8::MAX);
}
