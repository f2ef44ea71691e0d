//! How far fixed point can be from `f64` anywhere, not only where it was measured.
//!
//! 1. Each input's terms are compared along their own axis, at thousands of values and many times between any two ends of
//!    their straight pieces, however steep: the greatest difference nearby, a tenth more and a step of a degree, is what
//!    a term may be off. It holds all of rounding the input, straight pieces for curves, rounding the degree.
//! 2. The ranges are cut into boxes, finer where the bound is greatest. In each, every term's least and greatest degree are known, so those of every rule are, and how
//!    far a rule may be off: the minimum and the maximum are off by no more than the worst of their operands, products by the
//!    sum of what their factors are off.
//! 3. An output Σ w·z / Σ w whose weights are off by E in all is off by E · (greatest z − least z) / (Σ w − E), where only
//!    conclusions count that have a weight in the box; a centroid likewise, by its samples. Rounding conclusions and the output
//!    is added.
//!
//! Where rules have little weight that is much, and truly so: the quotient of two small numbers of steps says little. So
//! the bound is told for each of [`STRENGTHS`]. It does not hold within two steps of where a term jumps: there a rounded input
//! may be on the other side.

mod along;
mod quotient;
mod spread;

use super::accuracy::STRENGTHS;
use super::grid::Grid;
use crate::fuzzy::evaluate::{rules, samples};
use crate::fuzzy::lower::Lowered;
use crate::fuzzy::model::System;
use along::{Along, Cell};
use fuzzypilot::fuzzy::Grade;
use fuzzypilot::fuzzy::system::Degree;
use quotient::Target;
use rayon::prelude::*;
use spread::{Spread, of_rule};

/// The greatest error of each output, in its own unit, for each of [`STRENGTHS`].
pub type Bounds = Vec<[f64; STRENGTHS.len()]>;

/// About how many boxes it begins with; those with bounds near the greatest are halved, again and again.
const FIRST_BOXES: usize = 2_000;
/// How near, as a share of the greatest.
const NEAR: f64 = 0.7;
/// Boxes that are looked at more, fewer of a costly system.
const MOST_BOXES: usize = 20_000;
const MOST_WORK: usize = 100_000_000;
/// A step of a degree.
const DEGREE: f64 = 1.0 / Degree::ONE.bits() as f64;
/// Half a step of a set's degree.
const SET: f64 = 0.5 / Grade::ONE.bits() as f64;

/// Finds the bounds of a system's fixed point.
pub fn bounds(system: &System, lowered: &Lowered) -> Bounds {
    let along = Along::all(system, lowered);
    let outputs: Vec<Target> = (0..system.outputs.len())
        .map(|index| Target::new(system, lowered, index))
        .collect();
    let looked_at = |region: Region| {
        let place: Vec<Cell> = along
            .iter()
            .zip(&region)
            .map(|(a, &(from, to))| a.cell(from, to))
            .collect();
        let degrees: Vec<Spread> = rules(system)
            .map(|(block, rule)| of_rule(rule, block, &place))
            .collect();
        let bounds = outputs
            .iter()
            .map(|output| output.bounds(system, &degrees, &place))
            .collect();
        Looked {
            halves: halves(&region, &along, &place),
            bounds,
        }
    };
    let grid = Grid::boxes(system, FIRST_BOXES);
    let mut boxes: Vec<Looked> = regions(&grid).into_par_iter().map(looked_at).collect();
    let mut left = (MOST_WORK / cost(system)).min(MOST_BOXES);
    loop {
        let worst = greatest(&boxes, outputs.len());
        let (near, mut rest): (Vec<Looked>, Vec<Looked>) = boxes
            .into_iter()
            .partition(|b| b.halves.is_some() && b.is_near(&worst));
        if near.is_empty() || left < 2 * near.len() {
            return worst;
        }
        left -= 2 * near.len();
        let halves: Vec<Region> = near
            .into_iter()
            .filter_map(|b| b.halves)
            .flatten()
            .collect();
        rest.par_extend(halves.into_par_iter().map(looked_at));
        boxes = rest;
    }
}

/// A box: from where to where along each input.
type Region = Vec<(f64, f64)>;

/// A box that was looked at.
struct Looked {
    bounds: Bounds,
    /// Its halves, if halving it may make the bounds less.
    halves: Option<[Region; 2]>,
}

impl Looked {
    /// Whether one of its bounds is among the greatest.
    fn is_near(&self, worst: &Bounds) -> bool {
        let mut pairs = self.bounds.iter().flatten().zip(worst.iter().flatten());
        pairs.any(|(own, worst)| *own > 0.0 && *own >= NEAR * worst)
    }
}

fn greatest(boxes: &[Looked], outputs: usize) -> Bounds {
    let mut worst = vec![[0.0_f64; STRENGTHS.len()]; outputs];
    for looked in boxes {
        for (worst, own) in worst
            .iter_mut()
            .flatten()
            .zip(looked.bounds.iter().flatten())
        {
            *worst = worst.max(*own);
        }
    }
    worst
}

/// The boxes between a grid's points.
fn regions(grid: &Grid) -> Vec<Region> {
    let mut regions: Vec<Region> = vec![Vec::new()];
    for axis in &grid.axes {
        regions = regions
            .into_iter()
            .flat_map(|region| {
                let longer = |two: &[f64]| [&region[..], &[(two[0], two[1])]].concat();
                axis.windows(2).map(longer).collect::<Vec<_>>()
            })
            .collect();
    }
    regions
}

/// Across the input whose terms' degrees differ most in it.
fn halves(region: &Region, along: &[Along], place: &[Cell]) -> Option<[Region; 2]> {
    let differ = |cell: &Cell| {
        let apart = cell.terms.iter().map(|spread| spread.high - spread.low);
        apart.fold(0.0, f64::max)
    };
    let wide = |input: usize| region[input].1 - region[input].0 > 8.0 * along[input].step;
    let across = (0..region.len())
        .filter(|&input| wide(input) && differ(&place[input]) > 0.0)
        .max_by(|&a, &b| differ(&place[a]).total_cmp(&differ(&place[b])))?;
    let (from, to) = region[across];
    let middle = from + (to - from) / 2.0;
    let half = |ends: (f64, f64)| {
        let mut half = region.clone();
        half[across] = ends;
        half
    };
    Some([half((from, middle)), half((middle, to))])
}

/// What looking at a box costs, about.
fn cost(system: &System) -> usize {
    let rules = rules(system).count();
    let samples: usize = system
        .outputs
        .iter()
        .map(|output| samples(output).len())
        .sum();
    8 * rules + samples * rules.min(16) + 100
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::check::{Jumps, class, strength};
    use crate::fuzzy::evaluate::{Evaluator, Exact};
    use crate::fuzzy::lower::lower;
    use crate::fuzzy::model::{Input, Rule, Shape, Term};
    use crate::fuzzy::random;
    use crate::fuzzy::sample::{fan, rule};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use std::ops::RangeInclusive;

    /// The greatest error in each class at random points, by output: some of them anywhere, some between two knots of a
    /// term, however narrow it is; points near jumps left out.
    fn measured(system: &System, lowered: &Lowered, rng: &mut Pcg64Mcg, points: usize) -> Bounds {
        let exact = Exact::new(system);
        let mut worst = vec![[0.0_f64; STRENGTHS.len()]; system.outputs.len()];
        let jumps = Jumps::of(system, lowered);
        for _ in 0..points {
            let mut value = |input: &Input| {
                let term = &input.terms[rng.random_range(0..input.terms.len())];
                let knots = term.shape.knots();
                let knot = rng.random_range(0..knots.len());
                let next = knots[(knot + 1).min(knots.len() - 1)];
                let near = knots[knot] + (next - knots[knot]) * rng.random_range(0.0..=1.0);
                let near = near.clamp(*input.range.start(), *input.range.end());
                let free = rng.random_range(input.range.clone());
                if rng.random_bool(0.6) { near } else { free }
            };
            let point: Vec<f64> = system.inputs.iter().map(&mut value).collect();
            if jumps.near(&point) {
                continue;
            }
            let (expected, found) = (exact.evaluate(&point), lowered.evaluate(&point));
            for (index, worst) in worst.iter_mut().enumerate() {
                let strength = strength(system, index, &expected);
                if let (Some(a), Some(b)) = (expected.outputs[index], found.outputs[index])
                    && strength > 0.0
                {
                    let worst = &mut worst[class(strength)];
                    *worst = worst.max((a - b).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn random_systems_stay_within() {
        stay_within(30, 11, random::system, STRENGTHS.len());
    }

    #[test]
    fn random_steps_stay_within() {
        // Where next to nothing fires beside a step, the bound is the whole range and the error next to nothing.
        stay_within(30, 12, random::stepped, STRENGTHS.len() - 1);
    }

    fn stay_within(systems: usize, seed: u64, random: fn(&mut Pcg64Mcg) -> System, near: usize) {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut tightest = [0.0_f64; STRENGTHS.len()];
        for _ in 0..systems {
            let system = random(&mut rng);
            let Ok(lowered) = lower(&system) else {
                continue;
            };
            let bounds = bounds(&system, &lowered);
            let measured = measured(&system, &lowered, &mut rng, 500);
            for ((output, bound), worst) in system.outputs.iter().zip(&bounds).zip(&measured) {
                for class in 0..STRENGTHS.len() {
                    assert!(
                        worst[class] <= bound[class],
                        "class {class} of {}: {} above {} in\n{system:#?}",
                        output.name,
                        worst[class],
                        bound[class],
                    );
                    if bound[class] > 0.0 {
                        tightest[class] = tightest[class].max(worst[class] / bound[class]);
                    }
                }
            }
        }
        // Bounds that nothing comes near would hold as well, and tell nothing.
        let near = &tightest[..near];
        assert!(near.iter().all(|share| *share > 0.05), "{tightest:?}");
    }

    /// A tooth that ends in a jump, narrower than any box of three inputs with so many knots.
    #[test]
    fn a_tooth_in_the_middle_of_a_box_is_bounded() {
        let mut system = fan();
        let terms: Vec<Shape> = (0..9)
            .map(|i| f64::from(i) / 8.0)
            .map(|peak| Shape::Triangle {
                left: peak - 0.125,
                peak,
                right: peak + 0.125,
            })
            .collect();
        let tooth = Shape::Points(vec![(0.307_14, 0.0), (0.307_2, 1.0), (0.307_2, 0.0)]);
        let flat = Shape::Ramp {
            from: -2.0,
            to: -1.0,
        };
        system.inputs.push(system.inputs[0].clone());
        let sample = system.inputs[0].terms[0].clone();
        for (index, input) in system.inputs.iter_mut().enumerate() {
            let extra = [tooth.clone(), flat.clone()];
            let shapes = terms
                .iter()
                .chain(extra.iter().take(2 * usize::from(index == 0)));
            input.name = format!("input{index}");
            input.range = 0.0..=1.0;
            input.terms = shapes
                .map(|shape| Term {
                    shape: shape.clone(),
                    ..sample.clone()
                })
                .collect();
        }
        let weighted = |literal, conclusion, weight| Rule {
            weight,
            ..rule(&[literal], &[conclusion])
        };
        system.blocks[0].rules = vec![
            weighted((0, 9, false), (0, 2), 1.0),
            weighted((0, 10, false), (0, 0), 0.5),
        ];
        let lowered = lower(&system).unwrap();
        let bounds = bounds(&system, &lowered)[0];
        let measured = measured(&system, &lowered, &mut Pcg64Mcg::seed_from_u64(3), 20_000)[0];
        assert!(measured.iter().any(|off| *off > 1.0), "{measured:?}");
        for (measured, bound) in measured.into_iter().zip(bounds) {
            assert!(measured <= bound, "{measured} above {bound}");
        }
    }

    /// One steep curve beside a weak rule that holds everywhere: what the curve is off is what the output is off.
    fn steep(shape: Shape, range: RangeInclusive<f64>) -> System {
        let mut system = fan();
        system.inputs.truncate(1);
        let flat = Shape::Trapezoid {
            left: f64::NEG_INFINITY,
            rise: 0.0,
            fall: 1.0,
            right: f64::INFINITY,
        };
        system.inputs[0].range = range;
        system.inputs[0].terms.truncate(2);
        system.inputs[0].terms[0].shape = shape;
        system.inputs[0].terms[1].shape = flat;
        let mut weak = rule(&[(0, 1, false)], &[(0, 0)]);
        weak.weight = 0.05;
        system.blocks[0].rules = vec![rule(&[(0, 0, false)], &[(0, 2)]), weak];
        system
    }

    #[test]
    fn what_is_narrower_than_any_even_grid_is_bounded_too() {
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        let mut tightest = 0.0_f64;
        for design in 0..20 {
            let range = 10.0_f64.powf(rng.random_range(0.0..6.0));
            let at = range * rng.random_range(0.1..0.9);
            let width = range * 10.0_f64.powf(rng.random_range(-5.5..-4.3));
            let shape = match design % 5 {
                0 => Shape::Spline {
                    from: at,
                    to: at + width,
                },
                1 => Shape::Spline {
                    from: at + width,
                    to: at,
                },
                2 => Shape::Gaussian {
                    mean: at,
                    deviation: width,
                },
                3 => Shape::Bell {
                    centre: at,
                    width,
                    slope: rng.random_range(0.7..5.0),
                },
                _ => Shape::Sigmoid {
                    inflection: at,
                    slope: 1.0 / width,
                },
            };
            let system = steep(shape, 0.0..=range);
            let lowered = lower(&system).unwrap();
            let bound = bounds(&system, &lowered)[0];
            let measured = measured(&system, &lowered, &mut rng, 4000)[0];
            for (class, (measured, bound)) in measured.into_iter().zip(bound).enumerate() {
                assert!(
                    measured <= bound,
                    "class {class}: {measured} above {bound}: {system:#?}"
                );
                tightest = tightest.max(measured / bound);
            }
        }
        assert!(tightest > 0.3, "{tightest}");
    }

    #[test]
    fn a_complete_table_of_triangles_is_right_to_some_steps() {
        let fan = fan();
        let bounds = bounds(&fan, &lower(&fan).unwrap());
        assert!(
            bounds[0][0] > 0.0 && bounds[0][0] < 100.0 * 1e-4,
            "{bounds:?}"
        );
    }
}
