//! The benchmark's files, read and refused.

use flate2::{Compression, write::GzEncoder};
use host_sim::bench::arena::Arena;
use host_sim::bench::body::JACKAL;
use host_sim::bench::worlds::load;
use host_sim::bench::worlds::numbers::Numbers;
use std::fs;
use std::io::Write;
use std::path::Path;
use tempfile::tempdir;

const COMMON: &str = r#"{"start": [-2.25, 3.0, 1.57], "goal": [-2.25, 13.0], "goal_radius": 1.0, "cyl_radius": 0.075,
    "common_cylinders_xy": [[-4.425, 0.075], [-0.075, 0.075]]}"#;
const LINE: &str =
    r#"{"w": 7, "cyl": [[-1.0, 6.5]], "path": [[-2.175, 5.075], [-2.325, 5.225]], "len": 10.0}"#;

fn read(place: &Path) -> Result<Vec<Arena>, String> {
    let place = place.to_str().unwrap();
    load(place, &Numbers::All, &JACKAL).map_err(|e| e.to_string())
}

fn lines(dir: &Path, common: &str, text: &str) -> Result<Vec<Arena>, String> {
    fs::write(dir.join("common.json"), common).unwrap();
    let file = dir.join("worlds.jsonl");
    fs::write(&file, text).unwrap();
    read(&file)
}

fn sdf(cylinders: &[[f64; 2]]) -> String {
    let models: String = cylinders
        .iter()
        .map(|[x, y]| {
            format!(
                "<model name='c'><static>1</static><pose frame=''>{x} {y} 0 0 0 0</pose><link name='link'>
                 <collision name='collision'><geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry></collision>
                 <visual name='v'><geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry></visual>
                 </link></model>"
            )
        })
        .collect();
    format!(
        "<sdf version='1.6'><world name='default'><model name='ground_plane'><link name='link'><collision name='collision'>
         <geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>{models}</world></sdf>"
    )
}

fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 16 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

fn folder(dir: &Path, world: &str, path: &[u8]) -> Result<Vec<Arena>, String> {
    fs::create_dir_all(dir.join("path_files")).unwrap();
    fs::write(dir.join("world_7.world"), world).unwrap();
    fs::write(dir.join("path_files/path_7.npy"), path).unwrap();
    read(dir)
}

#[test]
fn the_folder_and_the_lines_are_the_same_world() {
    let dir = tempdir().unwrap();
    let from_lines = lines(dir.path(), COMMON, LINE).unwrap();
    assert_eq!(from_lines.len(), 1);
    let cells: Vec<u8> = [16_i64, 0, 15, 1]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let world = sdf(&[[-4.425, 0.075], [-0.075, 0.075], [-1.0, 6.5]]);
    let from_folder = folder(dir.path(), &world, &npy("<i8", "(2, 2)", &cells)).unwrap();
    assert_eq!(from_folder[0].circles, from_lines[0].circles);
    assert_eq!(from_folder[0].route.len(), 4);
    for (a, b) in from_folder[0].route.iter().zip(&from_lines[0].route) {
        assert!(
            (a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9,
            "{a:?} {b:?}"
        );
    }
    // Other kinds of numbers, too.
    let floats: Vec<u8> = [16_f32, 0.0, 15.0, 1.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let again = folder(dir.path(), &world, &npy("<f4", "(2, 2)", &floats)).unwrap();
    assert_eq!(again, from_folder);
}

#[test]
fn packed_lines_are_read_and_half_of_them_refused() {
    let dir = tempdir().unwrap();
    let plain = lines(dir.path(), COMMON, LINE).unwrap();
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(LINE.as_bytes()).unwrap();
    let packed = packer.finish().unwrap();
    let file = dir.path().join("worlds.jsonl.gz");
    fs::write(&file, &packed).unwrap();
    assert_eq!(read(&file).unwrap(), plain);
    fs::write(&file, &packed[..packed.len() / 2]).unwrap();
    let message = read(&file).unwrap_err();
    assert!(
        message.contains("worlds.jsonl.gz: found a gzip file that is broken or cut short"),
        "{message}"
    );
}

#[test]
fn what_is_wrong_in_lines_is_named_with_its_line() {
    let dir = tempdir().unwrap();
    let cases = [
        ("", "no world"),
        ("{\"w\": 7, \"cyl\": [[-1.0", "worlds.jsonl:1: found EOF"),
        ("{\"w\": 7}", "missing field `cyl`"),
        (
            "{\"w\": 7, \"cyl\": [[1e9, 0]], \"path\": []}",
            "coordinates from -1000 to 1000 m",
        ),
        (
            &format!("{LINE}\n\n{LINE}"),
            "worlds.jsonl:3: found world 7 a second time",
        ),
        ("\u{0}\u{1}", "worlds.jsonl:1"),
    ];
    for (text, part) in cases {
        let message = lines(dir.path(), COMMON, text).unwrap_err();
        assert!(message.contains(part), "{text:?}: {message}");
    }
    let message = lines(dir.path(), "{\"start\": 1}", LINE).unwrap_err();
    assert!(message.contains("common.json:1"), "{message}");
}

#[test]
fn what_is_wrong_in_the_folder_is_named_with_its_file() {
    let dir = tempdir().unwrap();
    let message = read(dir.path()).unwrap_err();
    assert!(message.contains("no world_N.world"), "{message}");
    let good = sdf(&[[1.0, 1.0]]);
    let path = npy("<i8", "(1, 2)", &[0; 16]);
    folder(dir.path(), &good, &path).unwrap();
    let cases: [(&str, &[u8], &str); 9] = [
        (&good[..good.len() / 2], &path, "world_7.world: found"),
        ("<sdf version='1.6'/>", &path, "no cylinder"),
        (
            &good.replace("1 1 0 0 0 0", "1 x 0 0 0 0"),
            &path,
            "world_7.world:2: found a pose",
        ),
        (
            &good.replace("0.075", "-1"),
            &path,
            "a cylinder without a radius",
        ),
        (
            &good,
            &path[..path.len() - 1],
            "path_7.npy: found a file that ends after",
        ),
        (&good, &path[..20], "a file that ends after 20 bytes"),
        (&good, b"PK\x03\x04", "a file of another kind"),
        (
            &good,
            &npy("<i8", "(1, 3)", &[0; 24]),
            "an array with the header",
        ),
        (&good, &npy("<c8", "(1, 2)", &[0; 16]), "an array of `<c8`"),
    ];
    for (world, path, part) in cases {
        let message = folder(dir.path(), world, path).unwrap_err();
        assert!(
            message.contains(part) && message.contains("allowed"),
            "{part}: {message}"
        );
    }
}

/// Set to the folder with the benchmark's worlds as JSON lines, the test below reads them all.
const DATA: &str = "FUZZYPILOT_BARN";

#[test]
fn the_benchmarks_own_worlds_have_the_lengths_that_are_published() {
    let Ok(folder) = std::env::var(DATA) else {
        eprintln!("skipped: {DATA} names no folder with worlds-dev.jsonl.gz");
        return;
    };
    let file = Path::new(&folder).join("worlds-dev.jsonl.gz");
    let arenas = read(&file).unwrap();
    assert_eq!(arenas.len(), 250);
    assert!((arenas[0].route_length() - 12.4312).abs() < 1e-3);
    let raw = read(&Path::new(&folder).join("raw")).unwrap();
    for arena in raw {
        let same = arenas.iter().find(|a| a.number == arena.number).unwrap();
        let mut both = [&arena, same].map(|a| {
            let mut at: Vec<_> = a
                .circles
                .iter()
                .map(|c| c.at.map(|x| (x * 1e4).round() as i64))
                .collect();
            at.sort_unstable();
            at
        });
        both[0].dedup();
        both[1].dedup();
        assert_eq!(both[0], both[1], "world {}", arena.number);
    }
}
