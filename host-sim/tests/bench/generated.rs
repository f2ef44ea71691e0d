//! Generated worlds: there is a way as promised, and the same number is the same world.

use host_sim::bench::body::JACKAL;
use host_sim::bench::worlds::numbers::Numbers;
use host_sim::bench::worlds::{check::check, generate::KINDS, load, planner};

fn worlds(place: &str, numbers: &str) -> Vec<host_sim::bench::arena::Arena> {
    let numbers = Numbers::parse(numbers).unwrap();
    load(place, &numbers, &JACKAL).unwrap()
}

#[test]
fn every_kind_can_be_passed_or_is_sealed() {
    for kind in KINDS {
        let place = format!("generated:{}", kind.name);
        let arenas = worlds(&place, "0-19");
        assert_eq!(arenas.len(), 20, "{}", kind.name);
        check(&place, &arenas, &JACKAL).unwrap();
        for arena in &arenas {
            let start = [arena.start[0], arena.start[1]];
            // A grid's cell less than the radius that was asked for.
            let way = planner::route(&arena.circles, 0.3, start, arena.goal, 0.0);
            assert_eq!(
                way.is_some(),
                !arena.sealed,
                "{} {}",
                kind.name,
                arena.number
            );
        }
        assert_eq!(arenas[7..9], worlds(&place, "7,8"), "{}", kind.name);
        assert_ne!(arenas[7].circles, arenas[8].circles, "{}", kind.name);
    }
}

#[test]
fn a_full_automaton_is_cleared_along_a_way() {
    let full = worlds("generated:barn,fill=0.5,smooth=0", "0-9");
    check("generated", &full, &JACKAL).unwrap();
    let wide = worlds("generated:barn,fill=0.5,smooth=0,radius=0.6", "0-9");
    for (narrow, wide) in full.iter().zip(&wide) {
        assert!(wide.circles.len() < narrow.circles.len());
        let start = [wide.start[0], wide.start[1]];
        assert!(planner::route(&wide.circles, 0.5, start, wide.goal, 0.0).is_some());
    }
}

#[test]
fn movers_go_to_and_fro_at_their_speed() {
    let arena = &worlds("generated:moving", "3")[0];
    for mover in &arena.movers {
        let length = (mover.to[0] - mover.from[0]).hypot(mover.to[1] - mover.from[1]);
        let there = length / mover.speed;
        let near = |at: [f64; 2], to: [f64; 2]| (at[0] - to[0]).hypot(at[1] - to[1]) < 1e-9;
        assert!(near(mover.at(0.0).at, mover.from));
        assert!(near(mover.at(there).at, mover.to));
        assert!(near(mover.at(2.0 * there).at, mover.from));
        let (a, b) = (mover.at(0.1 * there).at, mover.at(0.2 * there).at);
        let moved = (a[0] - b[0]).hypot(a[1] - b[1]);
        assert!((moved - 0.1 * length).abs() < 1e-9);
    }
}
