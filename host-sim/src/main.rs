//! Command line of host-sim.
use host_sim::*;
fn main() {
    for name in std::env::args().skip(1) {
        let s = match scenario::load(&name) {
            Ok(s) => s,
            Err(e) => {
                eprintln!("{e}");
                continue;
            }
        };
        let mut m = metrics::Metrics::new(&s, 1);
        let verbose = std::env::var("V").is_ok();
        match run::simulate(&s, 1, &mut |st| {
            m.observe(&st);
            if verbose {
                println!(
                    "{:4} {:?} truth {:.2?} e {:.3} clr {:.2} v {:.3} w {:.3} he {:.1} g {}",
                    st.record.tick,
                    match st.record.decision {
                        fuzzypilot::signals::Decision::Avoid { side, obstacle } => format!(
                            "{side:?} b{:.0} s{:.2} r{:.2}",
                            si::from_angle(obstacle.bearing()).to_degrees(),
                            si::from_metres(
                                obstacle.free_distance(fuzzypilot::units::Metres::lit("0.2"))
                            ),
                            si::from_metres(obstacle.radius)
                        ),
                        d => format!("{d:?}"),
                    },
                    st.truth,
                    st.cross_track,
                    st.clearance.0,
                    si::from_speed(st.record.twist.linear),
                    si::from_rate(st.record.twist.angular),
                    si::from_angle(st.record.guidance.heading_error).to_degrees(),
                    st.record.guarded
                );
            }
        }) {
            Ok(e) => println!("{}", serde_json::to_string(&m.finish(e)).unwrap()),
            Err(e) => println!("{name}: {e}"),
        }
    }
}
