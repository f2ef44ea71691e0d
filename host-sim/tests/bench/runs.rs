//! Runs and campaigns: what navigators meet, and that nothing depends on threads.

use host_sim::bench::arena::{Arena, Circle};
use host_sim::bench::attempt::{Dead, Ending, Outcome, Setting, drive};
use host_sim::bench::body::JACKAL;
use host_sim::bench::campaign::Campaign;
use host_sim::bench::controllers::{CONTROLLERS, named};
use host_sim::bench::discs::Discs;
use host_sim::bench::navigator::{Command, Inputs, Mode, Navigator};
use host_sim::bench::odometry::Drift;
use host_sim::bench::ranging::Disturbance;
use host_sim::bench::sensors;
use host_sim::bench::worlds::load;
use host_sim::bench::worlds::numbers::Numbers;

pub fn open_ground(circles: Vec<Circle>) -> Arena {
    Arena {
        number: 1,
        circles,
        unmapped: 0,
        movers: Vec::new(),
        start: [0.0; 3],
        goal: [6.0, 0.0],
        goal_radius: 0.5,
        sealed: false,
        route: vec![[0.0, 0.0], [6.0, 0.0]],
        course: None,
    }
}

fn setting() -> Setting {
    Setting::new(sensors::named("cone16").unwrap(), 1.0, true)
}

/// Says the same for ever.
struct Always(Command);

impl Navigator for Always {
    fn tick(&mut self, _: &Inputs<'_>) -> Command {
        self.0
    }
}

fn run(arena: &Arena, setting: &Setting, navigator: &mut dyn Navigator) -> Outcome {
    drive(
        arena,
        &Discs::new(&arena.circles),
        setting,
        0,
        navigator,
        &mut |_| {},
    )
}

fn ahead(speed: f64, mode: Mode) -> Always {
    Always(Command {
        speed,
        yaw_rate: 0.0,
        mode,
    })
}

#[test]
fn every_baseline_crosses_open_ground() {
    let arena = open_ground(Vec::new());
    for planned in [true, false] {
        let mut setting = setting();
        setting.planned = planned;
        for controller in CONTROLLERS {
            let mut navigator = (controller.build)(&setting.mission(&arena));
            let outcome = run(&arena, &setting, navigator.as_mut());
            assert_eq!(outcome.ending, Ending::Reached, "{}", controller.name);
            assert!(outcome.time_s < 9.0, "{}: {outcome:?}", controller.name);
        }
    }
}

#[test]
fn the_vehicle_starts_after_the_latency_and_speeds_up_as_fast_as_it_may() {
    let arena = open_ground(Vec::new());
    let outcome = run(&arena, &setting(), &mut ahead(5.0, Mode::Follow));
    // 5.5 m at 1 m/s, reached after 0.4 s at 2.5 m/s² (0.2 s lost), and 0.05 s of latency.
    assert!((outcome.time_s - 5.75).abs() < 0.011, "{outcome:?}");
    assert!(outcome.cross_track_rms_m < 1e-12);
}

#[test]
fn contact_ends_a_run_where_the_bumper_meets_the_disc() {
    let arena = open_ground(vec![Circle {
        at: [3.0, 0.2],
        radius: 0.1,
    }]);
    let outcome = run(&arena, &setting(), &mut ahead(1.0, Mode::Follow));
    assert_eq!(outcome.ending, Ending::Collision);
    assert!(outcome.min_clearance_m <= 0.0 && outcome.score == 0.0);
    // The front meets the disc's side at 2.9 m: 2.646 m of way.
    assert!((outcome.time_s - 2.9).abs() < 0.02, "{outcome:?}");
}

#[test]
fn standing_still_is_a_stall_unless_it_is_reported() {
    let arena = open_ground(Vec::new());
    let mut setting = setting();
    setting.time_limit = 30.0;
    let silent = run(&arena, &setting, &mut ahead(0.0, Mode::Follow));
    assert_eq!(silent.ending, Ending::Timeout);
    assert!(silent.longest_stall_s > 29.0);
    let blocked = run(&arena, &setting, &mut ahead(0.0, Mode::Blocked));
    assert_eq!(blocked.ending, Ending::Blocked);
    assert!((blocked.time_s - 10.0).abs() < 1e-9 && blocked.longest_stall_s == 0.0);
    let lost = run(&arena, &setting, &mut ahead(0.0, Mode::Arrived));
    assert_eq!(lost.ending, Ending::Timeout);
}

#[test]
fn commands_that_are_no_numbers_stop_the_vehicle() {
    let arena = open_ground(Vec::new());
    let mut setting = setting();
    setting.time_limit = 2.0;
    let outcome = run(&arena, &setting, &mut ahead(f64::NAN, Mode::Follow));
    assert_eq!(outcome.ending, Ending::Timeout);
    assert!(outcome.omega_rate_rms == 0.0 && outcome.longest_stall_s > 1.9);
}

fn campaign(threads: usize, first: u64) -> Vec<host_sim::bench::campaign::Run> {
    let mut setting = setting();
    setting.disturbance = Disturbance::HARSH;
    setting.drift = Drift {
        distance: 0.02,
        yaw: 0.03,
    };
    setting.dead = Dead::BySeed;
    setting.time_limit = 20.0;
    let campaign = Campaign {
        arenas: load("generated:moving", &Numbers::parse("0-5").unwrap(), &JACKAL).unwrap(),
        seeds: (first..3).collect(),
        setting,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| campaign.run(&named("vfh").unwrap()[0], &|| ()))
}

#[test]
fn results_depend_on_world_and_seed_and_on_nothing_else() {
    let alone = campaign(1, 0);
    assert_eq!(alone.len(), 18);
    assert_eq!(campaign(4, 0), alone);
    // Fewer runs before it change nothing in a run.
    let later: Vec<_> = alone.iter().filter(|r| r.seed >= 2).cloned().collect();
    assert_eq!(campaign(2, 2), later);
    // And seeds do make a difference.
    assert_ne!(alone[0].outcome, alone[1].outcome);
}
