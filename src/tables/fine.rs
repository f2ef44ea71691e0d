//! Fine grain: the follower's tables. Rows φ, columns d; outputs speed and deflection share the antecedents.
//!
//! Axes: d on `[0, 4]` (D̄ = 4, derived), φ in degrees on `[0, 180]`, speed on `[0, 3.0]`, deflection in degrees on
//! `[0, 90]`. "Derived" is the only value that fits the chapter's worked example, "assumed" our choice where the
//! figures are lost.

use crate::fuzzy::{
    Activation, Antecedents, Consequents, InputScale, Partition, Position, RuleTable, Term,
    TwinTable,
};
use fixed::FixedI16;
use fixed::types::extra::U13;
use fixed::types::{I8F8, I16F16};

/// Speed on its axis: `I3F13`, one step is 1.22e-4.
pub type Speed = FixedI16<U13>;
/// Deflection in degrees: one step is 0.0039°.
pub type Deflection = I8F8;

/// Top of the speed axis. The text gives v's domain as [0, 0.3] and the robot's top speed as 0.3, while the peaks
/// that it uses are 0.4 and 0.75: read as 10 × m/s, [0, 3.0] (assumed; see [`SpeedAxis`]).
pub const SPEED_AXIS: Speed = Speed::lit("3.0");

/// Names of d's terms: very near, quite near, near, quite far, very far.
pub const DISTANCE_TERMS: [&str; 5] = ["VN", "QN", "N", "QF", "VF"];
/// Names of φ's and both outputs' terms: very small, small, normal, big, very big.
pub const TERMS: [&str; 5] = ["VS", "S", "N", "B", "VB"];

const VS: Term = Term(0);
const S: Term = Term(1);
const N: Term = Term(2);
const B: Term = Term(3);
const VB: Term = Term(4);

/// φ: 0, 45, 90, 135, 180 (derived); d: 0, 1, 2, 3, 4 (derived).
const ANTECEDENTS: Antecedents<5, 5> = Antecedents {
    rows: Partition::new([
        I16F16::lit("0"),
        I16F16::lit("45"),
        I16F16::lit("90"),
        I16F16::lit("135"),
        I16F16::lit("180"),
    ]),
    cols: Partition::new([
        I16F16::lit("0"),
        I16F16::lit("1"),
        I16F16::lit("2"),
        I16F16::lit("3"),
        I16F16::lit("4"),
    ]),
};

/// VS 0.4 and S 0.75 given; N 1.5, B 2.25, VB 2.6 assumed, symmetric about 1.5.
const SPEEDS: Consequents<5, Speed> = Consequents::new(
    [Speed::lit("0"), SPEED_AXIS],
    [
        Speed::lit("0.4"),
        Speed::lit("0.75"),
        Speed::lit("1.5"),
        Speed::lit("2.25"),
        Speed::lit("2.6"),
    ],
);

/// N 45 and B 70 given; S 20 assumed by symmetry; VS 0 and VB 90 assumed.
const DEFLECTIONS: Consequents<5, Deflection> = Consequents::new(
    [Deflection::lit("0"), Deflection::lit("90")],
    [
        Deflection::lit("0"),
        Deflection::lit("20"),
        Deflection::lit("45"),
        Deflection::lit("70"),
        Deflection::lit("90"),
    ],
);

/// Table 7.1.
#[rustfmt::skip]
const SPEED_7_1: RuleTable<5, 5, Speed> = RuleTable::new(
    // d:  VN  QN  N   QF  VF      φ
    [   [  S,  S,  N,  B, VB ], // VS
        [  S,  S,  N,  N,  B ], // S
        [ VS,  S,  S,  N,  N ], // N
        [ VS, VS,  S,  S,  N ], // B
        [ VB, VS, VS,  S,  N ]],// VB
    SPEEDS,
);

/// Table 7.2.
#[rustfmt::skip]
const DEFLECTION_7_2: RuleTable<5, 5, Deflection> = RuleTable::new(
    // d:  VN  QN  N   QF  VF      φ
    [   [ VS, VS, VS, VS, VS ], // VS
        [  S,  N,  S,  S,  S ], // S
        [ VS,  N,  N,  S,  S ], // N
        [  N,  B,  B,  N,  N ], // B
        [  B, VB,  B,  B,  N ]],// VB
    DEFLECTIONS,
);

/// Table 7.2 with the cell (d = N, φ = N) as the worked example's prose has it: B.
#[rustfmt::skip]
const DEFLECTION_PROSE: RuleTable<5, 5, Deflection> = RuleTable::new(
    // d:  VN  QN  N   QF  VF      φ
    [   [ VS, VS, VS, VS, VS ], // VS
        [  S,  N,  S,  S,  S ], // S
        [ VS,  N,  B,  S,  S ], // N
        [  N,  B,  B,  N,  N ], // B
        [  B, VB,  B,  B,  N ]],// VB
    DEFLECTIONS,
);

/// Tuned: fast when aligned, slow when not, so that a corner is turned before it is left behind. All columns are equal
/// because under the `guided` law the distance already acts through the guidance direction. Chosen by hand on the
/// built-in scenarios at 1 m/s: `host-sim sweep square line-offset facing-away slalom`.
#[rustfmt::skip]
const SPEED_TUNED: RuleTable<5, 5, Speed> = RuleTable::new(
    // d:  VN  QN  N   QF  VF      φ
    [   [ VB, VB, VB, VB, VB ], // VS
        [  N,  N,  N,  N,  N ], // S
        [  S,  S,  S,  S,  S ], // N
        [ VS, VS, VS, VS, VS ], // B
        [ VS, VS, VS, VS, VS ]],// VB
    Consequents::new(
        [Speed::lit("0"), SPEED_AXIS],
        [Speed::lit("0"), Speed::lit("0.3"), Speed::lit("1.2"), Speed::lit("2.4"), SPEED_AXIS],
    ),
);

/// Tuned: one deflection step a φ term, whatever the distance.
#[rustfmt::skip]
const DEFLECTION_TUNED: RuleTable<5, 5, Deflection> = RuleTable::new(
    // d:  VN  QN  N   QF  VF      φ
    [   [ VS, VS, VS, VS, VS ], // VS
        [  N,  N,  N,  N,  N ], // S
        [  B,  B,  B,  B,  B ], // N
        [ VB, VB, VB, VB, VB ], // B
        [ VB, VB, VB, VB, VB ]],// VB
    DEFLECTIONS,
);

/// A follower's rule base: what turns (φ, d) into speed and deflection.
#[derive(Debug)]
pub struct FineTables {
    /// φ in rows, d in columns.
    pub antecedents: Antecedents<5, 5>,
    /// Speed on its axis, [`SPEED_AXIS`] at most.
    pub speed: RuleTable<5, 5, Speed>,
    /// Deflection in degrees, unsigned: the sign of the turn comes from geometry.
    pub deflection: RuleTable<5, 5, Deflection>,
    /// Both, for evaluation. What a robot carries; the rest is for people.
    pub twin: &'static FineTwin,
}

/// Speed and deflection of all rules, packed.
pub type FineTwin = TwinTable<5, 5, 4>;

/// What one evaluation of a [`FineTables`] gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FineOutput {
    /// Speed on its axis.
    pub speed: Speed,
    /// Deflection in degrees.
    pub deflection: Deflection,
    /// The rules behind both.
    pub activation: Activation<5, 5>,
}

impl FineTables {
    /// Equations 7.2 and 7.3: `d` on `[0, 4]`, `phi` in degrees on `[0, 180]`; both saturate at the ends. The robot
    /// comes to the same result without axes: [`behaviour::fine`](crate::behaviour::fine).
    pub fn evaluate(&self, d: I16F16, phi: I16F16) -> FineOutput {
        // Four units are the axis, 2^32 steps: 2^14 of them a count.
        const D: InputScale = InputScale::new(1 << 14);
        let twin = self.twin.evaluate(turned(phi), D.position(d.to_bits()));
        let [speed, deflection] = twin.rounded();
        FineOutput {
            speed: Speed::from_bits(speed),
            deflection: Deflection::from_bits(deflection),
            activation: twin.activation,
        }
    }
}

/// Position on an axis of 180° = 2^32 steps, from its start: a count of 2^-16° is 2^14 / 45 of them.
pub(super) fn turned(phi: I16F16) -> Position {
    let count = phi.to_bits().clamp(0, 180 << 16) as u32;
    let of_2_26 = ((count << 8) + 22) / 45;
    match of_2_26 {
        0..0x400_0000 => Position::from_bits(of_2_26 << 6),
        _ => Position::LAST,
    }
}

// The packed tables are statics of their own, so that an image without people in it holds nothing else.
static PRINTED_TWIN: FineTwin = TwinTable::new(&ANTECEDENTS, &SPEED_7_1, &DEFLECTION_7_2);
static PROSE_TWIN: FineTwin = TwinTable::new(&ANTECEDENTS, &SPEED_7_1, &DEFLECTION_PROSE);
static TUNED_TWIN: FineTwin = TwinTable::new(&ANTECEDENTS, &SPEED_TUNED, &DEFLECTION_TUNED);

/// Tables 7.1 and 7.2 as printed.
pub static PRINTED: FineTables = FineTables {
    antecedents: ANTECEDENTS,
    speed: SPEED_7_1,
    deflection: DEFLECTION_7_2,
    twin: &PRINTED_TWIN,
};

/// As printed, but the cell (d = N, φ = N) of Table 7.2 as the worked example's prose has it.
pub static PRINTED_PROSE: FineTables = FineTables {
    antecedents: ANTECEDENTS,
    speed: SPEED_7_1,
    deflection: DEFLECTION_PROSE,
    twin: &PROSE_TWIN,
};

/// The tuned set for the `guided` law.
pub static TUNED: FineTables = FineTables {
    antecedents: ANTECEDENTS,
    speed: SPEED_TUNED,
    deflection: DEFLECTION_TUNED,
    twin: &TUNED_TWIN,
};

/// Which fine tables to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FineSet {
    /// Tables 7.1 and 7.2. The cell (N, N) of Table 7.2 is N there and in the printed peak, 45.
    Printed,
    /// *Erratum*: the worked example's prose concludes B for that cell; the printed Δφ = 52° contradicts it (it
    /// would be 56°).
    PrintedProse,
    /// The tuned set.
    #[default]
    Tuned,
}

impl FineSet {
    /// The tables themselves.
    pub fn tables(self) -> &'static FineTables {
        match self {
            Self::Printed => &PRINTED,
            Self::PrintedProse => &PRINTED_PROSE,
            Self::Tuned => &TUNED,
        }
    }

    /// The tables packed for evaluation.
    pub const fn twin(self) -> &'static FineTwin {
        match self {
            Self::Printed => &PRINTED_TWIN,
            Self::PrintedProse => &PROSE_TWIN,
            Self::Tuned => &TUNED_TWIN,
        }
    }
}

/// How the speed axis becomes metres per second. *Erratum*: its printed domain [0, 0.3] cannot hold the peaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SpeedAxis {
    /// The axis' top, 3.0, is the robot's top speed.
    #[default]
    Scaled,
    /// The axis is metres per second as it stands; everything above the robot's top speed saturates there, so the
    /// speed table says nothing at all on a 0.3 m/s robot.
    Literal,
}
