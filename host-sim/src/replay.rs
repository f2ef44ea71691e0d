//! The replay page: one self-contained HTML file that plays a run in any browser, also from disk and offline.
//!
//! The recording goes in column by column: every quantity becomes one string over all ticks, rounded to a fixed step
//! and written as differences, which is several times shorter than the serde form and quick to decode.

use std::collections::HashMap;
use std::hash::Hash;

use anyhow::{Context, Result, ensure};
use serde::Serialize;

use crate::plot::palette;
use crate::recording::{Frame, NavigatorView, Recording, TableView};

const TEMPLATE: &str = include_str!("../assets/replay.html");
const PLACEHOLDER: &str = "__RECORDING__";

/// Where the page's style sheet takes the modes' colours, and whether those of a dark ground.
const PALETTES: [(&str, bool); 2] = [("/* modes */", false), ("/* modes, dark */", true)];

/// Steps per unit for poses, times, speeds and signals.
const FINE: f64 = 1e4;
/// Steps per unit for ranges, the path and activation degrees: one millimetre, one thousandth.
const COARSE: f64 = 1e3;

/// Writes the replay page of a run.
///
/// The page needs no network and no other file. Values are rounded to 0.1 mm (poses, signals) or 1 mm (ranges, path);
/// no tick is left out.
///
/// # Errors
///
/// When a rule that fired lies outside of [`Recording::tables`], or when the recording cannot be written as JSON.
pub fn html(rec: &Recording) -> Result<String> {
    let (head, tail) = TEMPLATE
        .split_once(PLACEHOLDER)
        .context("the replay template has no place for the recording")?;
    let mut head = head.to_owned();
    for (place, dark) in PALETTES {
        head = head.replace(place, &palette::css(dark));
    }
    let json = script_safe(&serde_json::to_string(&Page::new(rec)?).context("recording as JSON")?);
    let mut page = String::with_capacity(head.len() + json.len() + tail.len());
    page.push_str(&head);
    page.push_str(&json);
    page.push_str(tail);
    Ok(page)
}

/// Makes JSON safe inside a script element: without `<` no text in it can end the element or open a comment.
fn script_safe(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[derive(Serialize)]
struct Page<'a> {
    scenario: &'a str,
    variant: &'a str,
    /// As text: JavaScript numbers lose the low bits of a `u64`.
    seed: String,
    period: f64,
    robot_radius: f64,
    outline: &'a [[f64; 2]],
    obstacles: Vec<(&'a str, f64, f64, f64)>,
    /// x, y, radius.
    unmapped: Vec<[f64; 3]>,
    /// Radius, and x and y over the ticks.
    movers: Vec<(f64, [Column; 2])>,
    path: Vec<[Column; 2]>,
    beams: Vec<[f64; 5]>,
    tables: &'a [TableView],
    ticks: usize,
    modes: Vec<&'a str>,
    notes: Vec<&'a str>,
    columns: Columns,
    ranges: Vec<Column>,
    signals: Vec<(&'a str, Column)>,
    rules: Vec<(usize, usize, usize, Column)>,
    navigator: Option<Thoughts>,
    ended: bool,
    contact: Option<[f64; 2]>,
    goal: Option<[f64; 3]>,
    straight: bool,
    clearance_cap: Option<f64>,
    dead: Option<usize>,
    facts: &'a [(String, String)],
    back: Option<&'a str>,
}

#[derive(Serialize)]
struct Columns {
    t: Column,
    x: Column,
    y: Column,
    h: Column,
    bx: Column,
    by: Column,
    bh: Column,
    mode: Column,
    note: Column,
    cross: Column,
    clear: Column,
    v: Column,
    w: Column,
    wl: Column,
    wr: Column,
    ex: Column,
    ey: Column,
    er: Column,
}

impl<'a> Page<'a> {
    fn new(rec: &'a Recording) -> Result<Self> {
        let frames = &rec.frames;
        let fine = |value: &dyn Fn(&Frame) -> f64| {
            Column::new(FINE, frames.iter().map(|frame| Some(value(frame))))
        };
        let estimate = |part: usize| {
            Column::new(
                COARSE,
                frames.iter().map(|frame| frame.estimate.map(|e| e[part])),
            )
        };

        let mut modes = Names::default();
        let mut notes = Names::default();
        let mode = Column::new(1.0, frames.iter().map(|f| Some(modes.index(f.mode) as f64)));
        let note = Column::new(1.0, frames.iter().map(|f| Some(notes.index(f.note) as f64)));

        // A name may come twice in a tick: its occurrence is part of the key.
        let mut signals: Sparse<(&str, usize)> = Sparse::new(frames.len());
        let mut rules: Sparse<(usize, usize, usize)> = Sparse::new(frames.len());
        for (tick, frame) in frames.iter().enumerate() {
            for (at, &(name, value)) in frame.signals.iter().enumerate() {
                let before = frame.signals[..at].iter().filter(|s| s.0 == name).count();
                signals.set((name, before), tick, value);
            }
            for fired in &frame.fired {
                let (table, row, col) = (fired.table, fired.row, fired.col);
                ensure!(
                    rec.tables
                        .get(table)
                        .is_some_and(|t| row < t.row_terms.len() && col < t.col_terms.len()),
                    "tick {tick}: no rule at row {row}, column {col} of table {table}"
                );
                let most = rules
                    .get(&(table, row, col), tick)
                    .map_or(fired.degree, |known| known.max(fired.degree));
                rules.set((table, row, col), tick, most);
            }
        }

        Ok(Page {
            scenario: &rec.scenario,
            variant: &rec.variant,
            seed: rec.seed.to_string(),
            period: rec.period,
            robot_radius: rec.robot_radius,
            outline: &rec.outline,
            obstacles: rec
                .obstacles
                .iter()
                .map(|d| {
                    (
                        d.name.as_str(),
                        rounded(d.x),
                        rounded(d.y),
                        rounded(d.radius),
                    )
                })
                .collect(),
            unmapped: rec
                .unmapped
                .iter()
                .map(|d| [d.x, d.y, d.radius].map(rounded))
                .collect(),
            movers: rec
                .movers
                .iter()
                .enumerate()
                .map(|(mover, radius)| {
                    let along = |k: usize| {
                        let at = |f: &Frame| f.movers.get(mover).map(|place| place[k]);
                        Column::new(COARSE, frames.iter().map(at))
                    };
                    (rounded(*radius), [along(0), along(1)])
                })
                .collect(),
            path: rec
                .path
                .iter()
                .map(|line| [0, 1].map(|k| Column::new(COARSE, line.iter().map(|p| Some(p[k])))))
                .collect(),
            beams: rec
                .beams
                .iter()
                .map(|b| [b.x, b.y, b.heading, b.width, b.max_range].map(rounded))
                .collect(),
            tables: &rec.tables,
            ticks: frames.len(),
            columns: Columns {
                t: fine(&|f| f.t),
                x: fine(&|f| f.truth[0]),
                y: fine(&|f| f.truth[1]),
                h: fine(&|f| f.truth[2]),
                bx: fine(&|f| f.believed[0]),
                by: fine(&|f| f.believed[1]),
                bh: fine(&|f| f.believed[2]),
                mode,
                note,
                cross: fine(&|f| f.cross_track),
                clear: fine(&|f| f.clearance),
                v: fine(&|f| f.twist[0]),
                w: fine(&|f| f.twist[1]),
                wl: fine(&|f| f.wheels[0]),
                wr: fine(&|f| f.wheels[1]),
                ex: estimate(0),
                ey: estimate(1),
                er: estimate(2),
            },
            modes: modes.list,
            notes: notes.list,
            ranges: (0..rec.beams.len())
                .map(|k| {
                    let ranges = frames.iter().map(|f| f.ranges.get(k).copied().flatten());
                    Column::new(COARSE, ranges)
                })
                .collect(),
            signals: signals
                .columns(FINE)
                .map(|((name, _), column)| (name, column))
                .collect(),
            rules: rules
                .columns(COARSE)
                .map(|((table, row, col), column)| (table, row, col, column))
                .collect(),
            navigator: Thoughts::of(frames),
            ended: rec.ended,
            contact: rec.contact.map(|place| place.map(rounded)),
            goal: rec.goal.map(|goal| goal.map(rounded)),
            straight: rec.straight,
            clearance_cap: rec.clearance_cap,
            dead: rec.dead,
            facts: &rec.facts,
            back: rec.back.as_deref(),
        })
    }
}

/// What a navigator thinks, over the ticks.
#[derive(Serialize)]
struct Thoughts {
    /// Remembered points: x, y in the world as the robot believes it, first tick, number of ticks. One each as long as it
    /// is remembered, as most are for many ticks.
    points: [Column; 4],
    heading: Column,
    direction: Column,
    v: Column,
    w: Column,
    /// 1 slowed, 2 changed by the gate, 4 trapped.
    barrier: Column,
    /// Sensors taken for dead, a bit each.
    dead: Column,
}

impl Thoughts {
    fn of(frames: &[Frame]) -> Option<Self> {
        if frames.iter().all(|frame| frame.view.is_none()) {
            return None;
        }
        let column = |scale: f64, value: &dyn Fn(&NavigatorView) -> Option<f64>| {
            Column::new(
                scale,
                frames.iter().map(|f| f.view.as_ref().and_then(value)),
            )
        };
        let flags = |flags: &[bool]| {
            let bits = flags.iter().enumerate().map(|(k, on)| u8::from(*on) << k);
            f64::from(bits.sum::<u8>())
        };
        Some(Self {
            points: remembered(frames),
            heading: column(COARSE, &|v| v.heading),
            direction: column(COARSE, &|v| Some(v.direction)),
            v: column(COARSE, &|v| Some(v.wanted[0])),
            w: column(COARSE, &|v| Some(v.wanted[1])),
            barrier: column(1.0, &|v| Some(flags(&[v.slowed, v.gated, v.trapped]))),
            dead: column(1.0, &|v| {
                Some(v.dead.iter().map(|sensor| (1_u64 << sensor) as f64).sum())
            }),
        })
    }
}

/// Steps per metre for remembered points: their own place is no better known than to a centimetre.
const POINTS: f64 = 100.0;

/// How far a point may be from the place that it has been drawn at so far to be the same, in these steps: more than
/// rounding moves it.
const SAME: f64 = 0.8;

/// [`Thoughts::points`].
fn remembered(frames: &[Frame]) -> [Column; 4] {
    /// Place, first tick, and the last tick in which it was there.
    type Point = ([f64; 2], usize, usize);
    let mut gone: Vec<Point> = Vec::new();
    let mut held: Vec<Point> = Vec::new();
    for (tick, frame) in frames.iter().enumerate() {
        let [x, y, heading] = frame.believed;
        let (sin, cos) = heading.sin_cos();
        let points = frame.view.iter().flat_map(|view| &view.points);
        for [ahead, aside] in points {
            let at = [x + ahead * cos - aside * sin, y + ahead * sin + aside * cos];
            let at = at.map(|part| part * POINTS);
            let near = |(place, ..): &&mut Point| {
                (place[0] - at[0]).abs() <= SAME && (place[1] - at[1]).abs() <= SAME
            };
            match held.iter_mut().find(near) {
                Some((.., seen)) => *seen = tick,
                None => held.push((at.map(f64::round), tick, tick)),
            }
        }
        gone.extend(held.extract_if(.., |(.., seen)| *seen < tick));
    }
    gone.append(&mut held);
    gone.sort_by_key(|(_, first, _)| *first);
    let column =
        |value: &dyn Fn(&Point) -> f64| Column::new(1.0, gone.iter().map(|p| Some(value(p))));
    let place = |k: usize| Column::new(POINTS, gone.iter().map(|p| Some(p.0[k] / POINTS)));
    [
        place(0),
        place(1),
        column(&|(_, first, _)| *first as f64),
        column(&|(_, first, seen)| (seen - first + 1) as f64),
    ]
}

/// Rounded to 0.1 mm; what is not finite stays so and becomes `null` in JSON.
fn rounded(x: f64) -> f64 {
    (x * FINE).round() / FINE
}

/// Distinct names in order of appearance.
#[derive(Default)]
struct Names<'a> {
    list: Vec<&'a str>,
}

impl<'a> Names<'a> {
    fn index(&mut self, name: &'a str) -> usize {
        self.list
            .iter()
            .position(|&known| known == name)
            .unwrap_or_else(|| {
                self.list.push(name);
                self.list.len() - 1
            })
    }
}

/// Quantities that are there in some ticks only, in order of first appearance.
struct Sparse<K> {
    ticks: usize,
    index: HashMap<K, usize>,
    rows: Vec<(K, Vec<Option<f64>>)>,
}

impl<K: Copy + Eq + Hash> Sparse<K> {
    fn new(ticks: usize) -> Self {
        Sparse {
            ticks,
            index: HashMap::new(),
            rows: Vec::new(),
        }
    }

    fn get(&self, key: &K, tick: usize) -> Option<f64> {
        self.index.get(key).and_then(|&at| self.rows[at].1[tick])
    }

    fn set(&mut self, key: K, tick: usize, value: f64) {
        let at = *self.index.entry(key).or_insert_with(|| {
            self.rows.push((key, vec![None; self.ticks]));
            self.rows.len() - 1
        });
        self.rows[at].1[tick] = Some(value);
    }

    fn columns(self, scale: f64) -> impl Iterator<Item = (K, Column)> {
        self.rows
            .into_iter()
            .map(move |(key, values)| (key, Column::new(scale, values)))
    }
}

/// Steps per unit, and one token a value: the difference to the last number in steps as a base64 VLQ (as in source
/// maps), or `!` for none, `~` for NaN, `^` and `_` for the infinities; `*` and a count repeat the last token.
/// JSON has no infinities of its own, and the page has to tell them from "none".
#[derive(Serialize)]
struct Column(f64, String);

impl Column {
    fn new(scale: f64, values: impl IntoIterator<Item = Option<f64>>) -> Self {
        let mut text = String::new();
        let mut last = 0;
        let mut token = String::new();
        let mut previous = String::new();
        let mut repeats = 0;
        for value in values {
            token.clear();
            match value {
                None => token.push('!'),
                Some(x) if x.is_nan() => token.push('~'),
                Some(x) if x.is_infinite() => token.push(if x > 0.0 { '^' } else { '_' }),
                Some(x) => {
                    // Zigzagged differences of numbers up to this stay exact in JavaScript.
                    const MOST: f64 = 2e15;
                    let steps = (x * scale).round().clamp(-MOST, MOST) as i64;
                    vlq(steps - last, &mut token);
                    last = steps;
                }
            }
            if token == previous {
                repeats += 1;
            } else {
                repeat(&previous, repeats, &mut text);
                text.push_str(&token);
                repeats = 0;
                std::mem::swap(&mut previous, &mut token);
            }
        }
        repeat(&previous, repeats, &mut text);
        Column(scale, text)
    }
}

fn repeat(token: &str, times: usize, out: &mut String) {
    let mut short = String::from("*");
    vlq(times as i64, &mut short);
    if token.len() * times <= short.len() {
        out.extend(std::iter::repeat_n(token, times));
    } else {
        out.push_str(&short);
    }
}

fn vlq(value: i64, out: &mut String) {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut rest = value.unsigned_abs() << 1 | u64::from(value < 0);
    loop {
        let more = if rest > 31 { 32 } else { 0 };
        out.push(char::from(DIGITS[(rest & 31 | more) as usize]));
        rest >>= 5;
        if rest == 0 {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{BeamView, Disc, FiredView};

    fn frame(t: f64) -> Frame {
        Frame {
            t,
            truth: [t, 0.0, 0.0],
            believed: [t, 0.0, 0.0],
            mode: "follow",
            note: "",
            cross_track: 0.0,
            clearance: f64::INFINITY,
            twist: [1.0, 0.0],
            wheels: [1.0, 1.0],
            ..Frame::default()
        }
    }

    fn recording(frames: Vec<Frame>) -> Recording {
        Recording {
            scenario: "test".into(),
            variant: "none".into(),
            seed: u64::MAX,
            period: 0.05,
            robot_radius: 0.25,
            outline: Vec::new(),
            obstacles: Vec::new(),
            path: Vec::new(),
            beams: Vec::new(),
            tables: Vec::new(),
            frames,
            ..Recording::default()
        }
    }

    fn table(rows: usize, cols: usize) -> TableView {
        let terms = |n: usize| (0..n).map(|k| format!("T{k}")).collect::<Vec<_>>();
        TableView {
            title: "rules".into(),
            row_input: "a".into(),
            col_input: "b".into(),
            row_terms: terms(rows),
            col_terms: terms(cols),
            cells: vec![terms(cols); rows],
        }
    }

    fn embedded(page: &str) -> serde_json::Value {
        let open = r#"<script type="application/json" id="recording">"#;
        let from = page.find(open).expect("data element") + open.len();
        let to = from + page[from..].find("</script>").expect("its end");
        serde_json::from_str(&page[from..to]).expect("valid JSON")
    }

    /// The page's decoder, in Rust.
    fn decode(Column(scale, text): &Column) -> Vec<Option<f64>> {
        let digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut chars = text.chars().peekable();
        let (mut out, mut value, mut last) = (Vec::new(), 0, Err(None));
        while let Some(&c) = chars.peek() {
            let mut number = |skip: bool| {
                if skip {
                    chars.next();
                }
                let (mut sum, mut shift) = (0_i64, 0);
                loop {
                    let digit = digits.find(chars.next().unwrap()).unwrap() as i64;
                    sum += (digit & 31) << shift;
                    shift += 5;
                    if digit < 32 {
                        break if sum & 1 == 1 { -(sum >> 1) } else { sum >> 1 };
                    }
                }
            };
            let mut times = 1;
            match c {
                '*' => times = number(true),
                '!' | '~' | '^' | '_' => {
                    chars.next();
                    last = Err(match c {
                        '!' => None,
                        '~' => Some(f64::NAN),
                        '^' => Some(f64::INFINITY),
                        _ => Some(f64::NEG_INFINITY),
                    });
                }
                _ => last = Ok(number(false)),
            }
            for _ in 0..times {
                out.push(match last {
                    Ok(step) => {
                        value += step;
                        Some(value as f64 / scale)
                    }
                    Err(special) => special,
                });
            }
        }
        out
    }

    /// Reproducible noise in `0..1` without a dependency.
    fn noise() -> impl FnMut() -> f64 {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    #[test]
    fn placeholder_is_replaced_exactly_once() {
        assert_eq!(TEMPLATE.matches(PLACEHOLDER).count(), 1);
        let page = html(&recording(vec![frame(0.0)])).unwrap();
        assert!(!page.contains(PLACEHOLDER));

        // A recording that holds the placeholder itself keeps it as plain text.
        let mut rec = recording(vec![frame(0.0)]);
        rec.scenario = PLACEHOLDER.into();
        let page = html(&rec).unwrap();
        assert_eq!(page.matches(PLACEHOLDER).count(), 1);
        assert_eq!(embedded(&page)["scenario"], PLACEHOLDER);
    }

    #[test]
    fn names_cannot_break_out_of_the_data() {
        let hostile = "</title></script><script>alert(1)</script><!-- & \" \\ \u{2028}";
        let mut rec = recording(vec![frame(0.0)]);
        rec.scenario = hostile.into();
        rec.variant = hostile.into();
        rec.obstacles.push(Disc {
            name: hostile.into(),
            x: 1.0,
            y: 2.0,
            radius: 0.5,
        });
        let mut hostile_table = table(1, 1);
        hostile_table.cells[0][0] = hostile.into();
        rec.tables.push(hostile_table);
        let page = html(&rec).unwrap();

        assert_eq!(
            page.matches("<script").count(),
            TEMPLATE.matches("<script").count()
        );
        assert_eq!(
            page.matches("<!--").count(),
            TEMPLATE.matches("<!--").count()
        );
        assert!(!page.contains("alert(1)</"));
        let data = embedded(&page);
        assert_eq!(data["scenario"], hostile);
        assert_eq!(data["obstacles"][0][0], hostile);
        assert_eq!(data["tables"][0]["cells"][0][0], hostile);
        assert_eq!(data["seed"], "18446744073709551615");
    }

    #[test]
    fn page_asks_for_nothing_outside_itself() {
        assert!(TEMPLATE.contains("default-src 'none'"));
        let known = "http://www.w3.org/2000/svg";
        assert!(!TEMPLATE.replace(known, "").contains("://"));
    }

    #[test]
    fn columns_keep_every_kind_of_value() {
        let values = [
            Some(1.0),
            Some(f64::INFINITY),
            Some(f64::INFINITY),
            Some(f64::NEG_INFINITY),
            Some(f64::NAN),
            None,
            None,
            Some(-0.25),
            Some(0.1234),
            None,
            Some(1e300),
            Some(-1e300),
        ];
        let back = decode(&Column::new(1e3, values));
        let debug = |v: &[Option<f64>]| format!("{v:?}");
        let mut expected = values;
        expected[8] = Some(0.123);
        expected[10] = Some(2e12);
        expected[11] = Some(-2e12);
        assert_eq!(debug(&back), debug(&expected));
        assert_eq!(decode(&Column::new(1e3, [])), []);
    }

    #[test]
    fn columns_round_to_half_a_step_and_do_not_drift() {
        let mut random = noise();
        let mut at = 0.0;
        let values: Vec<_> = (0..5000)
            .map(|k| {
                at += random() - 0.5;
                (k % 7 != 0).then_some(at)
            })
            .collect();
        let back = decode(&Column::new(COARSE, values.iter().copied()));
        assert_eq!(back.len(), values.len());
        for (a, b) in values.iter().zip(back) {
            assert_eq!(a.is_none(), b.is_none());
            assert!((a.unwrap_or(0.0) - b.unwrap_or(0.0)).abs() <= 0.5001 / COARSE);
        }
    }

    #[test]
    fn long_stillness_is_short() {
        let still = Column::new(FINE, vec![Some(3.5); 20_000]);
        assert!(still.1.len() < 16, "{}", still.1);
        assert_eq!(decode(&still), vec![Some(3.5); 20_000]);
        let clock = Column::new(FINE, (0..20_000).map(|k| Some(f64::from(k) * 0.05)));
        assert!(clock.1.len() < 16, "{}", clock.1);
    }

    #[test]
    fn values_that_are_not_finite_stay_valid_json() {
        let mut rec = recording(vec![frame(0.0), frame(f64::NAN)]);
        rec.period = f64::NAN;
        rec.beams.push(BeamView {
            x: 0.0,
            y: 0.0,
            heading: 0.0,
            width: 0.0,
            max_range: f64::INFINITY,
        });
        rec.frames[0].ranges = vec![None];
        let data = embedded(&html(&rec).unwrap());
        assert_eq!(data["columns"]["clear"][1], "^^");
        assert_eq!(data["columns"]["t"][1], "A~");
        // The second frame has no reading for the sensor at all: same as none.
        assert_eq!(data["ranges"][0][1], "!!");
        assert!(data["beams"][0][4].is_null());
        assert!(data["period"].is_null());
    }

    #[test]
    fn empty_recording_still_makes_a_page() {
        assert_eq!(embedded(&html(&recording(Vec::new())).unwrap())["ticks"], 0);
    }

    #[test]
    fn signals_and_rules_become_columns() {
        let mut rec = recording(vec![frame(0.0), frame(0.05)]);
        rec.tables.push(table(3, 3));
        rec.frames[0].signals = vec![("a", 1.0), ("a", 2.0)];
        rec.frames[1].signals = vec![("b", f64::NAN)];
        let fired = |degree| FiredView {
            table: 0,
            row: 2,
            col: 1,
            degree,
        };
        rec.frames[1].fired = vec![fired(0.5), fired(0.25)];
        let data = embedded(&html(&rec).unwrap());
        assert_eq!(data["signals"].as_array().unwrap().len(), 3);
        assert_eq!(data["signals"][2], serde_json::json!(["b", [FINE, "!~"]]));
        let half = Column::new(COARSE, [None, Some(0.5)]);
        assert_eq!(
            data["rules"],
            serde_json::json!([[0, 2, 1, [COARSE, half.1]]])
        );
    }

    #[test]
    fn rule_outside_of_the_tables_is_an_error() {
        let mut rec = recording(vec![frame(0.0)]);
        rec.tables.push(table(3, 3));
        rec.frames[0].fired.push(FiredView {
            table: 0,
            row: 3,
            col: 0,
            degree: 1.0,
        });
        let message = html(&rec).unwrap_err().to_string();
        assert!(message.contains("row 3"), "{message}");
    }

    #[test]
    fn five_thousand_ticks_of_sixty_four_noisy_ranges_stay_small() {
        let mut random = noise();
        let mut frames = Vec::new();
        for k in 0..5000 {
            let mut f = frame(f64::from(k) * 0.05);
            f.truth = [random() * 40.0, random() * 40.0, random() * 6.0 - 3.0];
            f.believed = f.truth.map(|x| x + 0.1 * random());
            f.cross_track = random() - 0.5;
            f.clearance = random() * 10.0;
            f.twist = [random(), random()];
            f.wheels = [random(), random()];
            f.estimate = Some([random() * 40.0, random() * 40.0, random()]);
            // Worse than any sensor: every reading anywhere in 30 m.
            f.ranges = (0..64).map(|_| Some(random() * 30.0)).collect();
            f.signals = ["a", "b", "c", "d", "e", "f", "g", "h"]
                .map(|name| (name, random()))
                .to_vec();
            f.fired = (0..16)
                .map(|n| FiredView {
                    table: n / 4,
                    row: (n + k as usize) % 5,
                    col: n % 5,
                    degree: random(),
                })
                .collect();
            frames.push(f);
        }
        let mut rec = recording(frames);
        rec.tables = vec![table(5, 5); 4];
        let beam = BeamView {
            x: 0.0,
            y: 0.0,
            heading: 0.0,
            width: 0.0,
            max_range: 30.0,
        };
        rec.beams = vec![beam; 64];
        let size = html(&rec).unwrap().len();
        assert!(size < 4_000_000, "{size} bytes");
    }
}
