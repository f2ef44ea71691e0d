//! `docs/link.md` and the golden frames against the code: a script that was written from the page must be understood.
//! The page's tables are read here and used to encode; what comes out must be the library's bytes.
//!
//! `tests/golden/link.jsonl` holds frames that `examples/link.py --self-test` checks, too. To write it anew after a
//! change of protocol: `GOLDEN=write cargo test --test link_document`.

use fuzzypilot::link::frame::{self, Frame, MAX_FRAME};
use fuzzypilot::link::message::{
    Cause, Counts, MAX_READINGS, PathFault, PathForm, PortFault, Reading, Readings, Role, ToHost,
    ToTarget, Why,
};
use fuzzypilot::link::record::RECORD_BYTES;
use fuzzypilot::link::settings::{self, Format};
use fuzzypilot::ports::{Fault, Range, RangeReading};
use fuzzypilot::units::{Metres, Seconds};
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{Debug, Write};
use std::path::PathBuf;

fn file(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn document() -> String {
    std::fs::read_to_string(file("docs/link.md")).unwrap()
}

// ---- the page ----

/// A variant as the page has it.
#[derive(Debug)]
struct Variant {
    tag: u8,
    name: String,
    fields: Vec<(String, String)>,
}

/// The tables under headings that name a type.
fn types(document: &str) -> BTreeMap<String, Vec<Variant>> {
    let mut types: BTreeMap<String, Vec<Variant>> = BTreeMap::new();
    let (mut name, mut has_fields) = (None, false);
    for line in document.lines() {
        if let Some(heading) = line.strip_prefix('#') {
            let heading = heading.trim_start_matches('#').trim();
            name = heading
                .strip_prefix('`')
                .and_then(|name| name.strip_suffix('`'));
        }
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        if cells[0] == "tag" {
            has_fields = cells.get(2) == Some(&"fields");
        }
        let (Some(of), Ok(tag), [_, variant, rest @ ..]) = (name, cells[0].parse(), &cells[..])
        else {
            continue;
        };
        let fields = rest
            .first()
            .filter(|_| has_fields)
            .copied()
            .unwrap_or_default();
        let fields = fields
            .split("`,")
            .filter_map(|field| field.trim().split_once(" `"));
        types.entry(of.to_owned()).or_default().push(Variant {
            tag,
            name: variant.trim_matches('`').to_owned(),
            fields: fields
                .map(|(name, of)| (name.to_owned(), of.trim_matches('`').to_owned()))
                .collect(),
        });
    }
    types
}

// ---- values ----

/// A message's parts, as `Debug` shows them.
#[derive(Clone, Debug, PartialEq)]
enum Value {
    Number(i64),
    Bool(bool),
    List(Vec<Value>),
    Variant(String, Vec<(String, Value)>),
}

fn value(of: &impl Debug) -> Value {
    let text = format!("{of:?}");
    let (value, rest) = parse(&text);
    assert_eq!(rest, "", "{text}");
    value
}

/// Reads what derived `Debug` writes.
fn parse(text: &str) -> (Value, &str) {
    let text = text.trim_start();
    let end = text
        .find(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_'))
        .unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    if let Some(mut rest) = text.strip_prefix('[') {
        let mut list = Vec::new();
        loop {
            if let Some(rest) = rest.trim_start().strip_prefix(']') {
                return (Value::List(list), rest);
            }
            let (item, after) = parse(rest);
            list.push(item);
            rest = after.strip_prefix(',').unwrap_or(after);
        }
    }
    if let Ok(number) = word.parse() {
        return (Value::Number(number), rest);
    }
    if let Ok(truth) = word.parse() {
        return (Value::Bool(truth), rest);
    }
    // A newtype is what it holds.
    if let Some(inner) = rest.strip_prefix('(') {
        let (value, rest) = parse(inner);
        return (value, rest.strip_prefix(')').unwrap());
    }
    let Some(mut rest) = rest.strip_prefix(" {") else {
        return (Value::Variant(word.to_owned(), Vec::new()), rest);
    };
    let mut fields = Vec::new();
    loop {
        if let Some(rest) = rest.trim_start().strip_prefix('}') {
            return (Value::Variant(word.to_owned(), fields), rest);
        }
        let (name, after) = rest.trim_start().split_once(": ").unwrap();
        let (value, after) = parse(after);
        fields.push((name.to_owned(), value));
        rest = after.strip_prefix(',').unwrap_or(after);
    }
}

fn json(value: &Value) -> String {
    match value {
        Value::Number(number) => number.to_string(),
        Value::Bool(truth) => truth.to_string(),
        Value::List(items) => {
            let items: Vec<_> = items.iter().map(json).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Variant(name, fields) => {
            let fields: Vec<_> = fields
                .iter()
                .map(|(name, value)| format!("\"{name}\": {}", json(value)))
                .collect();
            format!("{{\"{name}\": {{{}}}}}", fields.join(", "))
        }
    }
}

/// Encodes by the page alone.
struct Encoder {
    types: BTreeMap<String, Vec<Variant>>,
    used: BTreeSet<(String, String)>,
}

fn varint(mut number: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while number >= 128 {
        bytes.push((number % 128) as u8 + 128);
        number /= 128;
    }
    bytes.push(number as u8);
    bytes
}

impl Encoder {
    fn encode(&mut self, of: &str, value: &Value) -> Vec<u8> {
        match (of, value) {
            ("u8", Value::Number(n)) => vec![u8::try_from(*n).unwrap()],
            ("bool", Value::Bool(truth)) => vec![u8::from(*truth)],
            ("u16" | "u32", Value::Number(n)) => varint(u64::try_from(*n).unwrap()),
            ("i32", Value::Number(n)) if *n < 0 => varint((-2 * n - 1) as u64),
            ("i32", Value::Number(n)) => varint(2 * *n as u64),
            ("[u8; 3]", Value::List(items)) => items
                .iter()
                .flat_map(|item| self.encode("u8", item))
                .collect(),
            ("bytes", Value::List(items)) => {
                let bytes: Vec<u8> = items
                    .iter()
                    .flat_map(|item| self.encode("u8", item))
                    .collect();
                [varint(bytes.len() as u64), bytes].concat()
            }
            ("Readings", Value::List(items)) => {
                let bytes: Vec<u8> = items
                    .iter()
                    .flat_map(|item| self.encode("Reading", item))
                    .collect();
                [varint(bytes.len() as u64), bytes].concat()
            }
            (_, Value::Variant(name, values)) => {
                let variants = self
                    .types
                    .get(of)
                    .unwrap_or_else(|| panic!("no table for {of}"));
                let place = variants.iter().position(|variant| variant.name == *name);
                let place = place.unwrap_or_else(|| panic!("{of} has no row for {name}"));
                let variant = &variants[place];
                assert_eq!(usize::from(variant.tag), place, "{of}::{name}");
                let (tag, fields) = (variant.tag, variant.fields.clone());
                self.used.insert((of.to_owned(), name.clone()));
                let names: Vec<_> = values.iter().map(|(name, _)| name).collect();
                let documented: Vec<_> = fields.iter().map(|(name, _)| name).collect();
                assert_eq!(names, documented, "fields of {of}::{name}");
                let mut bytes = vec![tag];
                for ((_, of), (_, value)) in fields.iter().zip(values) {
                    bytes.extend(self.encode(of, value));
                }
                bytes
            }
            _ => panic!("{value:?} is no {of}"),
        }
    }
}

// ---- samples ----

fn readings() -> Vec<RangeReading> {
    let faults = [
        Fault::NeverSeen,
        Fault::Timeout,
        Fault::Bus,
        Fault::OutOfRange,
        Fault::Stale,
    ];
    let mut readings = vec![
        RangeReading::fresh(Range::Echo(Metres::lit("1.5"))),
        RangeReading::fresh(Range::Clear),
        RangeReading {
            range: Range::Echo(Metres::lit("0.25")),
            age: Seconds::lit("0.05"),
        },
    ];
    readings.extend(faults.map(|fault| RangeReading::fresh(Range::Invalid(fault))));
    readings
}

fn to_target(room: &mut [u8; MAX_READINGS]) -> Vec<ToTarget<'_>> {
    let (packed, count) = Readings::pack(&readings(), room);
    assert_eq!(count, readings().len());
    vec![
        ToTarget::Hello {
            nonce: 0,
            role: Role::Monitor,
        },
        ToTarget::Hello {
            nonce: u32::MAX,
            role: Role::Lockstep,
        },
        ToTarget::Status,
        ToTarget::Get { id: 45 },
        ToTarget::Get { id: 300 },
        ToTarget::Set {
            id: 256,
            value: 65_536,
        },
        ToTarget::Set {
            id: u16::MAX,
            value: i32::MIN,
        },
        ToTarget::Begin {
            x: 0,
            y: -1,
            heading: i32::MAX,
        },
        ToTarget::PathBegin {
            form: PathForm::Points,
            count: 128,
            closed: true,
            gaps: false,
        },
        ToTarget::PathBegin {
            form: PathForm::Segments,
            count: 2,
            closed: false,
            gaps: true,
        },
        ToTarget::PathPoint {
            index: 127,
            x: 1,
            y: 64,
            heading: -64,
        },
        ToTarget::PathLine {
            index: 0,
            x: -8192,
            y: 8192,
            heading: 1 << 30,
            length: 3 << 16,
        },
        ToTarget::PathArc {
            index: u16::MAX,
            x: i32::MIN,
            y: i32::MAX,
            radius: i32::MIN,
            from: i32::MIN,
            sweep: -(1 << 24),
        },
        ToTarget::PathEnd,
        ToTarget::Arm { token: 0x8000_0001 },
        ToTarget::Stop,
        ToTarget::Ranges {
            scan: 255,
            first: 63,
            readings: packed,
        },
        ToTarget::Inputs {
            tick: 1_000_000,
            time_us: u32::MAX,
            scan: 0,
            counts: Counts::Known {
                left: -300,
                right: i32::MAX,
            },
        },
        ToTarget::Inputs {
            tick: 0,
            time_us: 50_000,
            scan: 128,
            counts: Counts::Unknown {
                fault: PortFault::Timeout,
            },
        },
        ToTarget::Record,
    ]
}

const CAUSES: [Cause; 15] = [
    Cause::Boot,
    Cause::StopCommand,
    Cause::Button,
    Cause::Emergency,
    Cause::LinkTimeout,
    Cause::Sequence,
    Cause::NewSession,
    Cause::SettingsChanged,
    Cause::DriveFault,
    Cause::PathOver,
    Cause::Overrun,
    Cause::Brownout,
    Cause::Watchdog,
    Cause::Panic,
    Cause::HardFault,
];

fn to_host() -> Vec<ToHost<'static>> {
    let state = |cause, most: u32| ToHost::State {
        armed: most == 0,
        cause,
        token: most,
        uptime_ms: most,
        tick: most,
        good: most,
        overlong: most as u16,
        truncated: most as u16,
        corrupt: most as u16,
        version: most as u16,
        stack: most,
        left: most as i32 / 2,
        right: if most == 0 { 0 } else { i32::MIN },
    };
    let mut said = vec![
        ToHost::Welcome {
            firmware: [0, 1, 255],
            ranges: 64,
            segments: 32,
            points: 128,
            record_bytes: RECORD_BYTES as u16,
            token: u32::MAX,
        },
        state(Cause::Boot, u32::MAX),
        ToHost::Value { id: 3, value: -1 },
        ToHost::Ack,
        ToHost::RecordPart {
            part: 2,
            bytes: &[7; 52],
        },
        ToHost::RecordPart {
            part: 0,
            bytes: &[0, 1, 0],
        },
    ];
    said.extend(CAUSES.map(|cause| state(cause, 0)));
    let whys = [
        Why::Malformed,
        Why::Version,
        Why::NoSession,
        Why::Replayed,
        Why::Role,
        Why::NotDisarmed,
        Why::Token,
        Why::NotBegun,
        Why::Emergency,
        Why::DriveFault,
        Why::UnknownId { id: 9 },
        Why::Setting { id: 300 },
        Why::NoPath,
        Why::Path {
            error: PathFault::TooShort,
        },
        Why::Path {
            error: PathFault::TooMany,
        },
        Why::Path {
            error: PathFault::Degenerate { piece: 127 },
        },
        Why::Path {
            error: PathFault::Gap { piece: 4096 },
        },
        Why::OutOfSequence { expected: 128 },
        Why::TooMany { most: 32 },
        Why::NoRecord,
        Why::Foreign,
    ];
    said.extend(whys.map(|why| ToHost::Refused { why }));
    said
}

/// A message, how it is called and its bytes in a frame.
struct Sample {
    from: &'static str,
    value: Value,
    sequence: u8,
    wire: Vec<u8>,
}

fn samples() -> Vec<Sample> {
    let mut samples = Vec::new();
    let mut sample = |from, value, message: &dyn Fn(u8) -> Vec<u8>| {
        let sequence = (samples.len() as u8).wrapping_mul(37);
        let wire = message(sequence);
        samples.push(Sample {
            from,
            value,
            sequence,
            wire,
        });
    };
    let mut room = [0; MAX_READINGS];
    for message in to_target(&mut room) {
        let mut shown = value(&message);
        if let (Value::Variant(_, fields), ToTarget::Ranges { readings, .. }) =
            (&mut shown, &message)
        {
            let readings = readings
                .iter()
                .map(|reading| value(&Reading::from(reading.unwrap())));
            fields[2].1 = Value::List(readings.collect());
        }
        sample("desktop", shown, &|sequence| wire(sequence, &message));
    }
    for message in to_host() {
        sample("robot", value(&message), &|sequence| {
            wire(sequence, &message)
        });
    }
    samples
}

fn wire(sequence: u8, message: &impl serde::Serialize) -> Vec<u8> {
    let mut wire = [0; MAX_FRAME];
    frame::encode(sequence, message, &mut wire)
        .expect("it fits")
        .to_vec()
}

/// The message inside a frame.
fn message(wire: &[u8]) -> Vec<u8> {
    let mut decoder = frame::Decoder::new();
    let mut message = None;
    for byte in wire {
        if let Some(Ok(frame)) = decoder.push(*byte) {
            message = Some(frame.message.to_vec());
        }
    }
    message.expect("a frame")
}

// ---- tests ----

#[test]
fn messages_have_the_bytes_that_the_page_gives() {
    let mut encoder = Encoder {
        types: types(&document()),
        used: BTreeSet::new(),
    };
    for sample in samples() {
        let of = if sample.from == "desktop" {
            "ToTarget"
        } else {
            "ToHost"
        };
        let bytes = encoder.encode(of, &sample.value);
        assert_eq!(bytes, message(&sample.wire), "{:?}", sample.value);
    }
    let mut rows = BTreeSet::new();
    for (of, variants) in &encoder.types {
        rows.extend(
            variants
                .iter()
                .map(|variant| (of.clone(), variant.name.clone())),
        );
    }
    let unused: Vec<_> = rows.difference(&encoder.used).collect();
    assert!(
        unused.is_empty(),
        "in the page, but in no sample: {unused:?}"
    );
}

/// The code has no variant that the page does not know.
#[test]
fn tables_of_the_page_are_complete() {
    fn known<M: DeserializeOwned>(bytes: &[u8]) -> bool {
        Frame {
            sequence: 0,
            check: 0,
            message: bytes,
        }
        .parse::<M>()
        .is_some()
    }
    /// Whether any message begins with this tag.
    fn any(tag: u8, parses: impl Fn(&[u8]) -> bool) -> bool {
        (1..24).any(|length| {
            let mut bytes = vec![0; length];
            bytes[0] = tag;
            parses(&bytes)
        })
    }
    let types = types(&document());
    type Parses = fn(&[u8]) -> bool;
    let parses: [(&str, Parses); 10] = [
        ("ToTarget", |bytes| {
            Frame {
                sequence: 0,
                check: 0,
                message: bytes,
            }
            .parse::<ToTarget<'_>>()
            .is_some()
        }),
        ("ToHost", |bytes| {
            Frame {
                sequence: 0,
                check: 0,
                message: bytes,
            }
            .parse::<ToHost<'_>>()
            .is_some()
        }),
        ("Role", known::<Role>),
        ("PathForm", known::<PathForm>),
        ("Counts", known::<Counts>),
        ("Reading", known::<Reading>),
        ("PortFault", known::<PortFault>),
        ("Cause", known::<Cause>),
        ("Why", known::<Why>),
        ("PathFault", known::<PathFault>),
    ];
    for (of, parses) in parses {
        let rows = types[of].len() as u8;
        assert!(any(rows - 1, parses), "{of} has more rows than variants");
        assert!(!any(rows, parses), "{of} has a variant without a row");
    }
    assert_eq!(types.len(), parses.len(), "{:?}", types.keys());
}

#[test]
fn worked_examples_of_the_page_hold() {
    let document = document();
    let mut encoder = Encoder {
        types: BTreeMap::new(),
        used: BTreeSet::new(),
    };
    let mut seen = 0;
    for (number, of, text) in [
        (100, "u16", "| 100 | `u16` | `64` |"),
        (300, "u16", "| 300 | `u16` | `ac 02` ("),
        (0, "i32", "| 0 | `i32` | `00` |"),
        (-1, "i32", "| −1 | `i32` | `01` |"),
        (1, "i32", "| 1 | `i32` | `02` |"),
        (65_536, "i32", "| 65536 (1 m) | `i32` | `80 80 08` ("),
        (
            i64::from(i32::MIN),
            "i32",
            "| −2147483648 | `i32` | `ff ff ff ff 0f` |",
        ),
    ] {
        assert!(document.contains(text), "{text}");
        let bytes = encoder.encode(of, &Value::Number(number));
        assert!(text.contains(&format!("`{}`", hex(&bytes))), "{text}");
        let posted = if of == "u16" {
            message(&wire(0, &ToTarget::Get { id: number as u16 }))[1..].to_vec()
        } else {
            message(&wire(
                0,
                &ToHost::Value {
                    id: 0,
                    value: number as i32,
                },
            ))[2..]
                .to_vec()
        };
        assert_eq!(posted, bytes, "{text}");
        seen += 1;
    }
    assert_eq!(
        seen,
        document.matches("| `i32` | `").count() + document.matches("| `u16` | `").count()
    );
    let stop = format!("wire     {}\n", hex(&wire(7, &ToTarget::Stop)));
    assert!(document.contains(&stop), "{stop}");
}

fn hex(bytes: &[u8]) -> String {
    let bytes: Vec<_> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    bytes.join(" ")
}

fn settings_table(settings: impl Iterator<Item = settings::Setting>) -> String {
    let mut table = String::from("| id | setting | unit | format |\n|---|---|---|---|\n");
    for setting in settings {
        let format = match setting.format {
            Format::Q16 => "Q16".to_owned(),
            Format::Q24 => "Q24".to_owned(),
            Format::Q32 => "Q32".to_owned(),
            Format::Turn => "turn".to_owned(),
            Format::Whole(most) => format!("0 to {most}"),
            Format::Choice(names) => names.join(", "),
        };
        let (id, name, unit) = (setting.id, setting.name, setting.unit);
        let row = format!("| {id} | {name} | {unit} | {format} |");
        writeln!(table, "{}", row.replace("|  |", "| |")).unwrap();
    }
    table
}

/// Ids, names, units and formats are a contract; this is its text.
#[test]
fn the_page_lists_the_settings() {
    let document = document();
    let table = settings_table(settings::SETTINGS.iter().copied());
    assert!(document.contains(&table), "the page should have\n{table}");
    let all: Vec<_> = settings::list(64).collect();
    assert_eq!(all.len(), settings::SETTINGS.len() + 1 + 4 * 64);
    let mut mounts = String::new();
    let first = settings_table(settings::list(1).skip(settings::SETTINGS.len()));
    for line in first.lines() {
        // The ids of all sensors in one row.
        let line = match line
            .strip_prefix("| ")
            .and_then(|rest| rest.split_once(" | "))
        {
            Some((id, rest)) if rest.starts_with("ring.mounts[i]") => {
                format!("| {id} + 4·i | {rest}")
            }
            _ => line.to_owned(),
        };
        writeln!(mounts, "{line}").unwrap();
    }
    assert!(document.contains(&mounts), "the page should have\n{mounts}");
    for (place, setting) in all[settings::SETTINGS.len() + 1..].iter().enumerate() {
        assert_eq!(usize::from(setting.id), 257 + place);
    }
}

#[test]
fn golden_frames() {
    let mut lines = String::new();
    for Sample {
        from,
        value,
        sequence,
        wire,
    } in samples()
    {
        let (message, wire) = (json(&value), hex(&wire));
        let head = format!("{{\"from\": \"{from}\", \"sequence\": {sequence}");
        writeln!(
            lines,
            "{head}, \"message\": {message}, \"wire\": \"{wire}\"}}"
        )
        .unwrap();
    }
    let golden = file("tests/golden/link.jsonl");
    if std::env::var("GOLDEN").is_ok_and(|wish| wish == "write") {
        std::fs::create_dir_all(golden.parent().unwrap()).unwrap();
        std::fs::write(&golden, &lines).unwrap();
    }
    let stored = std::fs::read_to_string(&golden).unwrap();
    assert!(
        stored == lines,
        "the frames are not those of {}",
        golden.display()
    );
}
