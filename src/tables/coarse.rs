//! Coarse grain: the avoider's two nested controllers. Rows s, the distance to the obstacle; columns an angle.
//!
//! The chapter's signs hold **inside this file only**: θ is positive when the robot's motion points to the right of
//! the line to the obstacle (the obstacle is on its left), Δθ is positive clockwise. In the library's convention θ is
//! the obstacle's bearing and Δθ is minus the change of heading; the avoider converts, once.
//!
//! All peaks are assumed (the figure is lost): inputs evenly spaced, crossing at ½. s is taken as a share of the
//! detection range, so one set of tables serves every range.

use super::fine::turned;
use crate::fuzzy::{
    Activation, Antecedents, Consequents, Partition, Position, RuleTable, Term, Twin, TwinTable,
};
use fixed::FixedI16;
use fixed::types::extra::U14;
use fixed::types::{I8F8, I16F16};

/// Deflection Δθ in degrees, clockwise positive: one step is 0.0039°.
pub type Deflection = I8F8;
/// Speed as a share of Vmax: `I2F14`, one step is 6.1e-5.
pub type SpeedShare = FixedI16<U14>;

/// Names of s's terms: near, middle, far.
pub const DISTANCE_TERMS: [&str; 3] = ["N", "M", "F"];
/// Names of the angles' terms: left, zero, right.
pub const ANGLE_TERMS: [&str; 3] = ["L", "Z", "R"];
/// Names of the speed's terms: small, normal, big.
pub const SPEED_TERMS: [&str; 3] = ["S", "N", "B"];

const L: Term = Term(0);
const Z: Term = Term(1);
const R: Term = Term(2);

const S: Term = Term(0);
const N: Term = Term(1);
const B: Term = Term(2);

/// s as a share of the detection range D: 0, ½, 1; the angle (θ, or Δθ for the second controller): −90°, 0°, 90°.
const ANTECEDENTS: Antecedents<3, 3> = Antecedents {
    rows: Partition::new([I16F16::lit("0"), I16F16::lit("0.5"), I16F16::lit("1")]),
    cols: Partition::new([I16F16::lit("-90"), I16F16::lit("0"), I16F16::lit("90")]),
};

const DEFLECTIONS: Consequents<3, Deflection> = Consequents::new(
    [Deflection::lit("-90"), Deflection::lit("90")],
    [
        Deflection::lit("-90"),
        Deflection::lit("0"),
        Deflection::lit("90"),
    ],
);

/// Thirds of Vmax, evenly spaced (assumed); S is not 0, or a robot that is near would never leave.
const SPEEDS: Consequents<3, SpeedShare> = Consequents::new(
    [SpeedShare::lit("0"), SpeedShare::lit("1")],
    [
        SpeedShare::lit("0.33333"),
        SpeedShare::lit("0.66667"),
        SpeedShare::lit("1"),
    ],
);

/// Table 7.3 with the cell (s = N, θ = R) corrected to R.
#[rustfmt::skip]
const DEFLECTION_CORRECTED: RuleTable<3, 3, Deflection> = RuleTable::new(
    // θ:  L  Z  R     s
    [   [ L, R, R ], // N
        [ Z, R, Z ], // M
        [ Z, R, Z ]],// F
    DEFLECTIONS,
);

/// Table 7.3 as printed.
#[rustfmt::skip]
const DEFLECTION_PRINTED: RuleTable<3, 3, Deflection> = RuleTable::new(
    // θ:  L  Z  R     s
    [   [ L, R, L ], // N
        [ Z, R, Z ], // M
        [ Z, R, Z ]],// F
    DEFLECTIONS,
);

/// Table 7.4.
#[rustfmt::skip]
const SPEED_7_4: RuleTable<3, 3, SpeedShare> = RuleTable::new(
    //     L  Z  R     s
    [   [ S, S, S ], // N
        [ N, S, N ], // M
        [ B, N, B ]],// F
    SPEEDS,
);

/// The avoider's rule base: both controllers over the same partitions.
#[derive(Debug)]
pub struct CoarseTables {
    /// s/D in rows, an angle in columns.
    pub antecedents: Antecedents<3, 3>,
    /// First controller: (s, θ) to Δθ.
    pub deflection: RuleTable<3, 3, Deflection>,
    /// Second controller: (s, Δθ or θ) to speed.
    pub speed: RuleTable<3, 3, SpeedShare>,
    /// Both, for evaluation. What a robot carries; the rest is for people.
    pub twin: &'static CoarseTwin,
}

/// Deflection and speed of all rules, packed.
pub type CoarseTwin = TwinTable<3, 3, 2>;

/// Both controllers' results, before they are rounded to their formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nested {
    /// The first one's evaluation: Δθ is its first output, [`Twin::EXTRA_BITS`] finer than [`Deflection`].
    pub turn: Twin<3, 3>,
    /// The second one's: the speed is its second output, as much finer than [`SpeedShare`].
    pub pace: Twin<3, 3>,
}

/// Equations 7.4 and 7.5, nested, on positions of the axes: what half of a [`Twin`] is not asked for is not computed.
#[inline(always)]
pub fn nested(twin: &CoarseTwin, s: Position, theta: Position, input: SpeedInput) -> Nested {
    let turn = twin.evaluate(s, theta);
    let angle = match input {
        SpeedInput::Deflection => deflected(turn.first),
        SpeedInput::Bearing => theta,
    };
    Nested {
        turn,
        pace: twin.evaluate(s, angle),
    }
}

/// The position of a Δθ, 2^-20° a step, on the angles' axis: 180° are 2^32 steps of it.
#[inline(always)]
fn deflected(wide: i32) -> Position {
    // 1024 / 45 with 27 fractional bits, rounded down: no Δθ reaches past the axis' end.
    const GAIN: u64 = (1024 << 27) / 45;
    let from_start = wide.wrapping_add(90 << 20).cast_unsigned();
    Position::from_bits((u64::from(from_start).wrapping_mul(GAIN) >> 27) as u32)
}

/// What one evaluation of a [`CoarseTables`] gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoarseOutput {
    /// Deflection in degrees, clockwise positive.
    pub deflection: Deflection,
    /// Share of Vmax.
    pub speed: SpeedShare,
    /// Rules of the deflection table.
    pub deflection_rules: Activation<3, 3>,
    /// Rules of the speed table.
    pub speed_rules: Activation<3, 3>,
}

impl CoarseTables {
    /// Equations 7.4 and 7.5, nested: `s` as a share of the detection range on `[0, 1]`, `theta` in degrees on
    /// `[-90, 90]`, chapter's sign; both saturate.
    pub fn evaluate(&self, s: I16F16, theta: I16F16, input: SpeedInput) -> CoarseOutput {
        let share = match s.to_bits() {
            ..=0 => Position::FIRST,
            share @ 1..0x1_0000 => Position::from_bits(share.cast_unsigned() << 16),
            _ => Position::LAST,
        };
        let theta = turned(theta.saturating_add(const { I16F16::lit("90") }));
        let Nested { turn, pace } = nested(self.twin, share, theta, input);
        let ([deflection, _], [_, speed]) = (turn.rounded(), pace.rounded());
        CoarseOutput {
            deflection: Deflection::from_bits(deflection),
            speed: SpeedShare::from_bits(speed),
            deflection_rules: turn.activation,
            speed_rules: pace.activation,
        }
    }
}

// Statics of their own, so that an image without people in it holds nothing else.
static CORRECTED_TWIN: CoarseTwin = TwinTable::new(&ANTECEDENTS, &DEFLECTION_CORRECTED, &SPEED_7_4);
static PRINTED_TWIN: CoarseTwin = TwinTable::new(&ANTECEDENTS, &DEFLECTION_PRINTED, &SPEED_7_4);

/// Tables 7.3 and 7.4, erratum mended.
pub static CORRECTED: CoarseTables = CoarseTables {
    antecedents: ANTECEDENTS,
    deflection: DEFLECTION_CORRECTED,
    speed: SPEED_7_4,
    twin: &CORRECTED_TWIN,
};

/// Tables 7.3 and 7.4 as printed.
pub static PRINTED: CoarseTables = CoarseTables {
    antecedents: ANTECEDENTS,
    deflection: DEFLECTION_PRINTED,
    speed: SPEED_7_4,
    twin: &PRINTED_TWIN,
};

/// Which Table 7.3 to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CoarseSet {
    /// Cell (s = N, θ = R) is R, as the text and the table's symmetry demand.
    #[default]
    Corrected,
    /// *Erratum*: that cell as printed, L: near an obstacle on its left the robot turns left, into it.
    Printed,
}

impl CoarseSet {
    /// The tables themselves.
    pub fn tables(self) -> &'static CoarseTables {
        match self {
            Self::Corrected => &CORRECTED,
            Self::Printed => &PRINTED,
        }
    }

    /// The tables packed for evaluation.
    pub const fn twin(self) -> &'static CoarseTwin {
        match self {
            Self::Corrected => &CORRECTED_TWIN,
            Self::Printed => &PRINTED_TWIN,
        }
    }
}

/// What Table 7.4 reads along its columns. *Erratum*: it is headed θ, but equation 7.5 and the text feed Δθ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SpeedInput {
    /// Δθ, the deflection just decided (equation 7.5).
    #[default]
    Deflection,
    /// θ, as the table's heading has it.
    Bearing,
}
