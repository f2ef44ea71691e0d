//! What the report's pages show: the run's end, what moves, colours, words and figures.

use super::command::sim;
use crate::runs::open_ground;
use host_sim::bench::arena::{Arena, Circle, Mover};
use host_sim::bench::attempt::{Dead, Ending, Setting};
use host_sim::bench::body::{Body, BodyFrame, JACKAL};
use host_sim::bench::controllers::named;
use host_sim::bench::recorded::record;
use host_sim::bench::sensors;
use host_sim::bench::worlds::load;
use host_sim::bench::worlds::numbers::Numbers;
use host_sim::plot::run::run_svg;
use host_sim::plot::thumbnail::{Place, thumbnail_svg};
use host_sim::recording::Recording;
use host_sim::replay;
use serde_json::{Value, json};
use std::fs;
use tempfile::tempdir;

/// A straight way of 6 m past some circles.
fn ground(circles: Vec<Circle>, movers: Vec<Mover>) -> Arena {
    Arena {
        movers,
        ..open_ground(circles)
    }
}

/// A blind robot's run.
fn blind(arena: &Arena, body: Body) -> (Ending, Recording) {
    let mut setting = Setting::new(sensors::named("cone8").unwrap(), 1.0, true);
    setting.body = body;
    let controller = named("pure-pursuit").unwrap()[0];
    let (outcome, recording) = record(&controller, arena, &setting, 0);
    let last = recording.frames.last().unwrap();
    assert!((last.t - outcome.time_s).abs() < 1e-9);
    (outcome.ending, recording)
}

fn cylinder(at: [f64; 2]) -> Circle {
    Circle { at, radius: 0.2 }
}

/// A page and the recordings of the replays that it opens, by file.
fn report(arguments: &[&str]) -> (String, Vec<(String, Value)>) {
    let dir = tempdir().unwrap();
    sim(dir.path())
        .args(["bench", "--report", "r"])
        .args(arguments)
        .assert()
        .success();
    let read = |name: &str| fs::read_to_string(dir.path().join("r").join(name)).unwrap();
    let page = read("index.html");
    let replays = page
        .split("href=\"runs/")
        .skip(1)
        .map(|rest| format!("runs/{}", rest.split_once('"').unwrap().0))
        .map(|file| (file.clone(), embedded(&read(&file))))
        .collect();
    (page, replays)
}

/// The recording inside a replay page.
fn embedded(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"recording\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// A page's column as numbers.
fn column(column: &Value) -> Vec<Option<f64>> {
    let digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let scale = column[0].as_f64().unwrap();
    let mut text = column[1].as_str().unwrap().chars().peekable();
    let (mut out, mut value, mut step) = (Vec::new(), 0, Some(0));
    while let Some(&c) = text.peek() {
        let special = "!~^_".contains(c);
        if special || c == '*' {
            text.next();
        }
        let mut times = 1;
        if special {
            step = None;
        } else {
            let (mut sum, mut shift) = (0_i64, 0);
            loop {
                let digit = digits.find(text.next().unwrap()).unwrap() as i64;
                sum += (digit & 31) << shift;
                shift += 5;
                if digit < 32 {
                    break;
                }
            }
            let number = if sum & 1 == 1 { -(sum >> 1) } else { sum >> 1 };
            if c == '*' {
                times = number;
            } else {
                step = Some(number);
            }
        }
        for _ in 0..times {
            value += step.unwrap_or(0);
            out.push(step.map(|_| value as f64 / scale));
        }
    }
    out
}

#[test]
fn a_collision_is_in_its_recording_and_its_place_is_marked() {
    let cases = [
        (JACKAL, [3.0, 0.1], [3.0 - 0.2, 0.1]),
        // Off the middle: the corner meets the disc, not the front.
        (JACKAL, [3.0, 0.3], [3.0 - 0.181, 0.215]),
        (Body::Disc(0.25), [3.0, 0.0], [3.0 - 0.2, 0.0]),
    ];
    for (body, at, touched) in cases {
        let (ending, recording) = blind(&ground(vec![cylinder(at)], Vec::new()), body.clone());
        assert_eq!(ending, Ending::Collision);
        let last = recording.frames.last().unwrap();
        assert!(last.clearance <= 0.0, "{at:?}: {}", last.clearance);
        let before = &recording.frames[recording.frames.len() - 2];
        assert!(before.clearance > 0.0 && recording.ended);
        let contact = recording.contact.unwrap();
        assert!(
            (contact[0] - touched[0]).abs() < 0.02 && (contact[1] - touched[1]).abs() < 0.02,
            "{at:?}: {contact:?}"
        );
        let page = embedded(&replay::html(&recording).unwrap());
        let clearance = column(&page["columns"]["clear"]);
        assert!(clearance.last().unwrap().unwrap() <= 0.0);
        assert!((page["contact"][0].as_f64().unwrap() - contact[0]).abs() < 1e-3);
    }
}

#[test]
fn an_arrival_is_in_its_recording() {
    let (ending, recording) = blind(&ground(Vec::new(), Vec::new()), JACKAL);
    assert_eq!(ending, Ending::Reached);
    let inside = |k: usize| {
        let [x, y, _] = recording.frames[k].truth;
        (x - 6.0).hypot(y) <= 0.5
    };
    let last = recording.frames.len() - 1;
    assert!(inside(last) && !inside(last - 1));
    assert_eq!(recording.contact, None);
}

#[test]
fn what_moves_moves_in_the_recording() {
    let mover = Mover {
        from: [2.0, 1.5],
        to: [2.0, 3.5],
        speed: 0.5,
        radius: 0.25,
    };
    let (_, recording) = blind(&ground(Vec::new(), vec![mover]), JACKAL);
    assert!(recording.obstacles.is_empty());
    let page = embedded(&replay::html(&recording).unwrap());
    assert_eq!(page["movers"][0][0], 0.25);
    let times = column(&page["columns"]["t"]);
    let heights = column(&page["movers"][0][1][1]);
    assert_eq!(heights.len(), recording.frames.len());
    for (time, height) in times.iter().zip(&heights) {
        let (time, height) = (time.unwrap(), height.unwrap());
        // To and fro in 8 s.
        let wanted = 1.5 + 2.0 - (0.5 * time.rem_euclid(8.0) - 2.0).abs();
        assert!((height - wanted).abs() < 2e-3, "{time} s: {height}");
    }
    // The picture has it where it was at the end.
    let thumbnail = |recording: &Recording| {
        let place = Place {
            goal: [6.0, 0.0, 0.5],
            outline: &[],
            touched: false,
        };
        thumbnail_svg(recording, &place).unwrap()
    };
    let last = recording.frames.last().unwrap().movers.clone();
    let mut earlier = recording.clone();
    for frame in earlier.frames.iter_mut().rev().skip(1) {
        frame.movers = last.clone();
    }
    assert_eq!(thumbnail(&earlier), thumbnail(&recording));
    earlier.frames.last_mut().unwrap().movers = vec![[2.0, 1.5]];
    assert_ne!(thumbnail(&earlier), thumbnail(&recording));
}

#[test]
fn a_mode_has_one_colour_in_every_picture() {
    let (_, mut recording) = blind(&ground(Vec::new(), Vec::new()), JACKAL);
    let modes = ["follow", "avoid", "escape", "stop", "blocked", "arrived"];
    let count = recording.frames.len();
    for (k, frame) in recording.frames.iter_mut().enumerate() {
        frame.mode = modes[k * modes.len() / count];
    }
    let figure = run_svg(&recording).unwrap().to_lowercase();
    let page = replay::html(&recording).unwrap();
    for mode in modes {
        let colours: Vec<&str> = page
            .split(&format!("--mode-{mode}: "))
            .skip(1)
            .map(|rest| rest.split_once(';').unwrap().0)
            .collect();
        let [light, dark] = colours[..] else {
            panic!("{mode}: {colours:?}");
        };
        assert!(light != dark && dark.len() == 7);
        // The line of the mode, in the legend if nowhere else.
        let stroke = format!("stroke=\"{light}\"");
        assert!(figure.contains(&stroke), "{mode}: {light}");
    }
    assert!(!page.contains("/* modes"));
}

#[test]
fn a_replay_says_what_was_asked_for_and_leads_back() {
    let forest = ["--worlds", "generated:forest", "--numbers", "0-3"];
    let robot = [
        "--controllers",
        "rpp",
        "--dead",
        "3",
        "--harsh",
        "--time-limit",
        "4",
    ];
    for (task, straight) in [("goal", true), ("path", false)] {
        let (page, replays) = report(&[&forest[..], &robot, &["--task", task]].concat());
        assert!(!replays.is_empty(), "{task}: all arrived");
        let text = words(&page);
        for (file, replay) in replays {
            let [world, _] = file[9..].split('-').collect::<Vec<_>>()[..] else {
                panic!("{file}");
            };
            assert_eq!(replay["straight"], straight);
            assert_eq!(replay["goal"][2], 0.5);
            assert_eq!(replay["clearance_cap"], 1.0);
            assert_eq!(replay["back"], "../index.html");
            assert_eq!(replay["dead"], 3);
            let facts = replay["facts"].as_array().unwrap();
            for fact in [["task", task], ["sensors", "cone16"], ["dead sensor", "3"]] {
                assert!(facts.contains(&json!(fact)), "{fact:?}: {facts:?}");
            }
            let ending = replay["variant"].as_str().unwrap();
            assert!(
                text.contains(&format!("world {world}, seed 0, sensor 3 dead: {ending}")),
                "{ending}"
            );
        }
    }
}

#[test]
fn the_navigator_s_thoughts_are_in_its_replay_and_keep_it_small() {
    let way = ["--worlds", "generated:barn", "--numbers", "3"];
    let arenas = load(way[1], &Numbers::parse(way[3]).unwrap(), &JACKAL).unwrap();
    let mut setting = Setting::new(sensors::named("cone16").unwrap(), 1.0, false);
    setting.dead = Dead::One(2);
    // It never arrives, so that there are as many ticks as there can be.
    let mut arena = arenas[0].clone();
    arena.goal_radius = 1e-9;
    let (outcome, recording) = record(&named("ours").unwrap()[0], &arena, &setting, 0);
    let text = replay::html(&recording).unwrap();
    assert!(
        outcome.time_s > 20.0 && text.len() < 600_000,
        "{}",
        text.len()
    );

    let thoughts = &embedded(&text)["navigator"];
    let [x, y, first, ticks] = [0, 1, 2, 3].map(|k| column(&thoughts["points"][k]));
    let speeds = column(&thoughts["v"]);
    let barrier = column(&thoughts["barrier"]);
    let mut slowed = 0;
    for (tick, frame) in recording.frames.iter().enumerate() {
        let Some(view) = &frame.view else {
            assert!(recording.ended && tick == recording.frames.len() - 1);
            continue;
        };
        assert!((speeds[tick].unwrap() - view.wanted[0]).abs() < 1e-3);
        slowed += u32::from(barrier[tick].unwrap() as u8 & 1);
        assert_eq!(barrier[tick].unwrap() as u8 & 1, u8::from(view.slowed));
        if tick % 50 != 0 {
            continue;
        }
        let there = |k: usize| {
            let first = first[k].unwrap() as usize;
            (first..first + ticks[k].unwrap() as usize).contains(&tick)
        };
        let drawn: Vec<[f64; 2]> = (0..x.len())
            .filter(|k| there(*k))
            .map(|k| [x[k].unwrap(), y[k].unwrap()])
            .collect();
        let frame = BodyFrame::new(frame.believed);
        for point in &view.points {
            let [u, v] = frame.tell(*point);
            let near = |p: &&[f64; 2]| (p[0] - u).hypot(p[1] - v) < 0.012;
            assert!(drawn.iter().find(near).is_some(), "tick {tick}: {u} {v}");
        }
        assert!(drawn.len() <= view.points.len());
    }
    assert!(slowed > 0 && x.len() > 100);
    // Nobody else tells.
    let (_, other) = blind(&ground(Vec::new(), Vec::new()), JACKAL);
    assert!(embedded(&replay::html(&other).unwrap())["navigator"].is_null());
}

/// The words of a page without its marks.
fn words(page: &str) -> String {
    let mut text = String::new();
    for part in page.split('<') {
        text.push(' ');
        text.push_str(part.split_once('>').map_or(part, |(_, rest)| rest));
    }
    text.replace("&nbsp;", " ")
}

/// The cells of the first row of a page that has something in it.
fn cells(page: &str, with: &str) -> Vec<String> {
    let mut rows = page
        .split("<tr>")
        .map(|rest| rest.split('\n').next().unwrap());
    let row = rows.find(|row| row.contains(with)).unwrap();
    let cells = row.split("<td>").skip(1);
    cells.map(|cell| words(cell).trim().to_owned()).collect()
}

#[test]
fn routes_that_nobody_finished_have_no_distance() {
    let routes = ["--worlds", "generated:routes", "--numbers", "0,7"];
    let robot = ["--controllers", "pure-pursuit"];
    let (page, _) = report(&[&routes[..], &robot].concat());
    let line = cells(&page, "<td>line");
    assert!(line[3].parse::<f64>().unwrap() < 0.01 && line[5].is_empty() && line[6] == "100");
    // Blind, it drives into the cylinder.
    assert_eq!(cells(&page, "<td>pass")[3..], ["–", "–", "–", "0"]);
    assert!(page.contains("on it again after m"));
}

#[test]
fn figures_that_there_are_none_of_are_not_zero() {
    let dir = tempdir().unwrap();
    sim(dir.path())
        .args(["bench", "--worlds", "generated:slalom", "--numbers", "0-2"])
        .args(["--task", "goal", "--controllers", "pure-pursuit,vfh"])
        .args(["--report", "r", "--json", "r.json"])
        .assert()
        .success();
    let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    let results: Value = serde_json::from_str(&read("r.json")).unwrap();
    let figures = [&results[0], &results[1]];
    assert_eq!(figures[0]["success"], 0.0);
    assert!(figures[1]["success"].as_f64().unwrap() > 0.0);
    assert!(figures[0]["mean_time_s"].is_null() && figures[1]["mean_time_s"].is_number());
    assert!(figures[0]["median_min_clearance_m"].as_f64().unwrap() <= 0.0);
    let page = read("r/index.html");
    let table = read("r/table.txt");
    let headings = page.split("<th>").skip(1).map(|rest| {
        let heading = rest.split(['<', '\n']).next().unwrap();
        heading.to_owned()
    });
    let headings: Vec<String> = headings.collect();
    for heading in &headings {
        assert!(table.contains(heading.as_str()), "{heading}");
    }
    let cells = cells(&page, "<td>pure-pursuit");
    let cell = |name: &str| &cells[headings.iter().position(|h| h == name).unwrap()];
    assert_eq!(cell("time s"), "–");
    assert_eq!(cell("least clearance m"), "contact");
    assert!(cell("collision %").starts_with("100.0"));
    assert!(cell("cross-track m").parse::<f64>().is_ok());
    assert!(table.contains("contact") && table.contains("–"));
}

#[test]
fn what_trouble_costs_and_dead_sensors_are_on_the_page() {
    // Where nothing stands in the way no sensor is missed.
    let easy = ["--worlds", "generated:routes", "--numbers", "0"];
    let each = ["--dead", "each", "--sensors", "ultrasonic5", "--seeds", "5"];
    let blind = ["--controllers", "pure-pursuit", "--time-limit", "5"];
    let (page, replays) = report(&[&easy[..], &each, &blind].concat());
    let text = words(&page);
    assert!(text.contains("The same with a sound robot"));
    assert!(text.contains("points lost") && text.contains("pure-pursuit, one sensor dead"));
    assert!(text.contains("none is worse than another"));
    assert!(!text.contains("worst: sensor"));
    assert_eq!(replays.len(), 5);
    assert!(text.contains("seed 3, sensor 3 dead: out of time at 5.0 s"));
}

#[test]
fn what_the_route_does_not_know_and_what_moves_is_drawn_and_named() {
    let soon = ["--controllers", "pure-pursuit", "--time-limit", "4"];
    let plain = ["--worlds", "generated:forest", "--numbers", "2"];
    let unmapped = ["--task", "unmapped", "--unmapped", "generated"];
    let moving = ["--worlds", "generated:moving", "--numbers", "2"];
    let cases: [(&[&str], usize, usize); 3] = [
        (&[&soon[..], &plain].concat(), 0, 0),
        (&[&soon[..], &plain, &unmapped].concat(), 3, 0),
        (&[&soon[..], &moving].concat(), 0, 5),
    ];
    let mut discs = Vec::new();
    for (arguments, hollow, movers) in cases {
        let (page, replays) = report(arguments);
        let replay = &replays[0].1;
        let count = |key: &str| replay[key].as_array().unwrap().len();
        assert_eq!((count("unmapped"), count("movers")), (hollow, movers));
        discs.push(count("obstacles"));
        let text = words(&page);
        let names = |name: &str| text.contains(name);
        assert_eq!(names("obstacle that the route does not know"), hollow > 0);
        assert_eq!(names("moving obstacle"), movers > 0);
        assert!(names("start") && names("robot where the run ended"));
        let picture = page.split_once("<svg").unwrap().1;
        let white = picture
            .split("<circle")
            .skip(1)
            .filter(|rest| rest.split('>').next().unwrap().contains("fill=\"#FFFFFF\""));
        assert_eq!(white.count(), hollow);
    }
    // The same trees; only what was put there is hollow.
    assert_eq!(discs[0], discs[1]);
}

#[test]
fn every_colour_of_a_picture_has_one_for_the_dark() {
    let (page, _) = report(&[
        "--worlds",
        "generated:moving",
        "--numbers",
        "0-3",
        "--task",
        "unmapped",
        "--unmapped",
        "generated",
        "--controllers",
        "ours,rpp",
    ]);
    let mut colours = 0;
    for part in ["fill", "stroke"] {
        for rest in page.split(&format!(" {part}=\"#")).skip(1) {
            let colour = rest.split('"').next().unwrap();
            let rule = format!(".runs svg [{part}=\"#{colour}\"]{{{part}:#");
            assert!(page.contains(&rule), "{rule}");
            colours += 1;
        }
    }
    assert!(colours > 20);
}

#[test]
fn a_page_says_how_it_came_about() {
    let dir = tempdir().unwrap();
    let bench = |more: &[&str]| {
        sim(dir.path())
            .args(["bench", "--worlds", "generated:routes", "--numbers", "0-2"])
            .args(["--controllers", "pure-pursuit", "--sensors", "cone8"])
            .args(["--report", "a/r"])
            .args(more)
            .assert()
            .success();
        fs::read_to_string(dir.path().join("a/r/index.html")).unwrap()
    };
    let page = bench(&["--json", "all of it.json"]);
    assert!(page.contains("<title>Navigation bench: task path, cone8</title>"));
    let text = words(&page);
    assert!(text.contains("--sensors cone8 --report a/r --json 'all of it.json'"));
    assert!(text.contains(env!("CARGO_PKG_VERSION")));
    assert!(text.contains(", seed 0;") && text.contains("No run failed."));
    assert!(!text.contains("Only part"));
    let links = page.split("href=\"").skip(1);
    let links: Vec<String> = links
        .map(|rest| rest.split('"').next().unwrap().replace("%20", " "))
        .collect();
    assert_eq!(
        links,
        ["table.txt", "per-world.csv", "../../all of it.json"]
    );
    for link in links {
        assert!(dir.path().join("a/r").join(&link).is_file(), "{link}");
    }

    let text = words(&bench(&[
        "--shard",
        "1/2",
        "--seeds",
        "2",
        "--time-limit",
        "1",
    ]));
    assert!(text.contains("Only part 1/2 of the worlds."));
    assert!(text.contains("seeds 0 to 1;") && !text.contains("No run failed."));
}

#[test]
fn replays_of_an_earlier_report_do_not_stay() {
    let dir = tempdir().unwrap();
    let runs = dir.path().join("r/runs");
    let files = || {
        let mut names: Vec<String> = fs::read_dir(&runs)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    let bench = |numbers: &str| {
        sim(dir.path())
            .args([
                "bench",
                "--worlds",
                "generated:forest",
                "--numbers",
                numbers,
            ])
            .args(["--controllers", "pure-pursuit", "--time-limit", "1"])
            .args(["--report", "r"])
            .assert()
            .success();
    };
    bench("0-1");
    assert_eq!(files(), ["pure-pursuit-0-0.html", "pure-pursuit-1-0.html"]);
    let own = [
        "notes.html",
        "pure-pursuit-01-0.html",
        "vfh-1.html",
        "mine-1-0.html",
    ];
    for name in own {
        fs::write(runs.join(name), "kept").unwrap();
    }
    bench("2");
    let mut wanted = own.map(str::to_owned).to_vec();
    wanted.push("pure-pursuit-2-0.html".to_owned());
    wanted.sort();
    assert_eq!(files(), wanted);
}

#[test]
fn the_discs_of_a_picture_take_little_room() {
    let (page, replays) = report(&[
        "--worlds",
        "generated:barn",
        "--numbers",
        "0",
        "--controllers",
        "rpp",
        "--time-limit",
        "1",
    ]);
    let discs = replays[0].1["obstacles"].as_array().unwrap().len();
    let picture = page.split_once("<svg").unwrap().1;
    let picture = picture.split_once("</svg>").unwrap().0;
    assert!(discs > 100);
    assert_eq!(picture.matches("h0").count(), discs);
    assert!(!picture.contains("opacity=\"1\""));
    assert!(picture.len() < 20 * discs, "{} bytes", picture.len());
}
