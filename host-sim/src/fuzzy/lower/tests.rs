use super::lower;
use crate::fuzzy::evaluate::{Evaluator, Exact};
use crate::fuzzy::random;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

#[test]
fn stats() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut all = Vec::new();
    for n in 0..400 {
        let model = random::system(&mut rng);
        let lowered = match lower(&model) {
            Ok(l) => l,
            Err(e) => {
                println!("{n}: {e}");
                continue;
            }
        };
        let exact = Exact::new(&model);
        lowered.open(|fixed| {
            for _ in 0..200 {
                let x: Vec<f64> = model
                    .inputs
                    .iter()
                    .zip(&lowered.tables().inputs)
                    .map(|(i, l)| {
                        let (a, b) = (*i.range.start(), *i.range.end());
                        l.format
                            .value(l.format.nearest(a + (b - a) * rng.random_range(0.0..=1.0)))
                    })
                    .collect();
                let (a, b) = (exact.evaluate(&x), fixed.evaluate(&x));
                let w = a.rules.iter().cloned().fold(0.0, f64::max);
                for (r, s) in a.rules.iter().zip(&b.rules) {
                    all.push((f64::abs(r - s), w, n, "rule"));
                }
                for ((p, q), o) in a.outputs.iter().zip(&b.outputs).zip(&model.outputs) {
                    if let (Some(p), Some(q)) = (p, q) {
                        let e = (p - q).abs() / (o.range.end() - o.range.start());
                        let kind = if matches!(
                            o.defuzzifier,
                            crate::fuzzy::model::Defuzzifier::WeightedAverage
                        ) {
                            "avg"
                        } else {
                            "cen"
                        };
                        all.push((e, w, n, kind));
                    }
                }
            }
        });
    }
    for kind in ["rule", "avg", "cen"] {
        for (lo, hi) in [
            (0.0, 1e-6),
            (1e-6, 1e-3),
            (1e-3, 1e-2),
            (1e-2, 0.1),
            (0.1, 1.01),
        ] {
            let mut v: Vec<_> = all
                .iter()
                .filter(|a| a.3 == kind && a.1 >= lo && a.1 < hi)
                .collect();
            v.sort_by(|a, b| a.0.total_cmp(&b.0));
            if v.is_empty() {
                continue;
            }
            println!(
                "{kind} {lo}..{hi}: n {} median {:.1e} p99 {:.1e} max {:?}",
                v.len(),
                v[v.len() / 2].0,
                v[v.len() * 99 / 100].0,
                v[v.len() - 1]
            );
        }
    }
}
