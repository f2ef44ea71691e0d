//! The colours of what a robot does, the same in figures, on the bench's page and in the replay, which takes them as
//! CSS variables. The hues are Okabe and Ito's, which the colour blind can tell apart, and a red dark enough to differ
//! from the orange in lightness as well; on a dark ground each is another shade of the same hue.

use super::INK;
use super::run::{OBSTACLE, PATH};
use plotters::style::RGBColor;
use std::fmt::Write;

/// A mode's colour.
#[derive(Clone, Copy, Debug)]
pub struct Hue {
    /// The mode.
    pub mode: &'static str,
    /// Red, green and blue on a light ground.
    pub light: RGBColor,
    /// On a dark one.
    pub dark: RGBColor,
    /// How much the mode matters where several share a pixel, up to [`GRAVEST`].
    pub rank: u8,
}

/// What matters most.
pub const GRAVEST: u8 = 4;

pub(super) const STOP: RGBColor = RGBColor(0xA8, 0x10, 0x24);
const STOP_IN_THE_DARK: RGBColor = RGBColor(0xE5, 0x38, 0x3B);

/// The modes that have a colour of their own.
#[rustfmt::skip]
pub const MODES: [Hue; 6] = [
    hue("follow",  RGBColor(0x00, 0x72, 0xB2), RGBColor(0x4A, 0x90, 0xE0), 0),
    hue("avoid",   RGBColor(0xE6, 0x9F, 0x00), RGBColor(0xF0, 0xA2, 0x2E), 2),
    hue("escape",  RGBColor(0xCC, 0x79, 0xA7), RGBColor(0xD7, 0x70, 0xB0), 3),
    hue("stop",    STOP,                       STOP_IN_THE_DARK,           GRAVEST),
    hue("blocked", STOP,                       STOP_IN_THE_DARK,           GRAVEST),
    hue("arrived", RGBColor(0x56, 0xB4, 0xE9), RGBColor(0xA8, 0xDC, 0xF8), 1),
];

/// The colour of any other.
pub const OTHER: Hue = hue(
    "other",
    RGBColor(0x77, 0x77, 0x77),
    RGBColor(0x70, 0x7A, 0x84),
    1,
);

const fn hue(mode: &'static str, light: RGBColor, dark: RGBColor, rank: u8) -> Hue {
    Hue {
        mode,
        light,
        dark,
        rank,
    }
}

/// What else is drawn, by the name of its CSS variable: on a light ground and on a dark one.
const REST: [(&str, RGBColor, RGBColor); 4] = [
    (
        "page",
        RGBColor(0xFF, 0xFF, 0xFF),
        RGBColor(0x13, 0x1A, 0x20),
    ),
    ("ink", INK, RGBColor(0xE7, 0xED, 0xF2)),
    ("disc", OBSTACLE, RGBColor(0x8B, 0x98, 0xA5)),
    ("route", PATH, RGBColor(0x7B, 0x88, 0x94)),
];

/// The style sheet of a page with pictures in it: all colours as variables, and in the dark the pictures' own as well.
pub fn sheet(pictures: &str) -> String {
    let rest = |dark: bool| {
        let mut text = String::new();
        for (name, light, in_the_dark) in REST {
            let colour = if dark { in_the_dark } else { light };
            let _ = write!(text, "--{name}: {}; ", hex(colour));
        }
        text
    };
    let mut text = format!(
        ":root{{color-scheme:light dark;{}{}}}\n@media (prefers-color-scheme:dark){{\n:root{{{}{}}}\n",
        css(false),
        rest(false),
        css(true),
        rest(true)
    );
    let modes = MODES.iter().chain([&OTHER]);
    let modes = modes.map(|hue| (hue.light, hue.dark));
    let rest = REST.iter().map(|(_, light, dark)| (*light, *dark));
    for (light, dark) in modes.chain(rest) {
        // As the drawing library spells it.
        let (light, dark) = (hex(light).to_uppercase(), hex(dark));
        for part in ["fill", "stroke"] {
            let _ = writeln!(text, "{pictures} [{part}=\"{light}\"]{{{part}:{dark}}}");
        }
    }
    text.push_str("}\n");
    text
}

/// A mode's hue, if it has one of its own.
pub fn known(mode: &str) -> Option<&'static Hue> {
    MODES.iter().find(|hue| hue.mode == mode)
}

/// As HTML has it.
pub fn hex(colour: RGBColor) -> String {
    format!("#{:02x}{:02x}{:02x}", colour.0, colour.1, colour.2)
}

/// All hues as CSS variables `--mode-…`.
pub fn css(dark: bool) -> String {
    let mut text = String::new();
    for hue in MODES.iter().chain([&OTHER]) {
        let colour = if dark { hue.dark } else { hue.light };
        let _ = write!(text, "--mode-{}: {}; ", hue.mode, hex(colour));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    type Matrix = [[f64; 3]; 3];

    /// Colours in linear light as who lacks a cone sees them: Machado, Oliveira and Fernandes 2009 (doi
    /// 10.1109/TVCG.2009.113), severity 1.
    #[rustfmt::skip]
    const EYES: [(&str, Matrix); 4] = [
        ("all cones", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        ("protanopia", [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]),
        ("deuteranopia", [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]),
        ("tritanopia", [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]),
    ];

    fn times(matrix: &Matrix, v: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
    }

    /// In Oklab, where distance is difference to the eye.
    fn seen(RGBColor(r, g, b): RGBColor, eye: &Matrix) -> [f64; 3] {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        let light = times(eye, [linear(r), linear(g), linear(b)]).map(|c| c.clamp(0.0, 1.0));
        let cones = [
            [0.4122214708, 0.5363325363, 0.0514459929],
            [0.2119034982, 0.6806995451, 0.1073969566],
            [0.0883024619, 0.2817188376, 0.6299787005],
        ];
        let lab = [
            [0.2104542553, 0.7936177850, -0.0040720468],
            [1.9779984951, -2.4285922050, 0.4505937099],
            [0.0259040371, 0.7827717662, -0.8086757660],
        ];
        times(&lab, times(&cones, light).map(f64::cbrt))
    }

    #[test]
    fn modes_differ_to_every_eye_on_either_ground() {
        let told_apart: Vec<&Hue> = MODES
            .iter()
            .chain([&OTHER])
            .filter(|hue| hue.mode != "stop")
            .collect();
        for (eye, matrix) in &EYES {
            for (k, a) in told_apart.iter().enumerate() {
                for b in &told_apart[..k] {
                    for (x, y) in [(a.light, b.light), (a.dark, b.dark)] {
                        let (x, y) = (seen(x, matrix), seen(y, matrix));
                        let apart: f64 = x.iter().zip(y).map(|(p, q)| (p - q) * (p - q)).sum();
                        let apart = apart.sqrt();
                        assert!(apart > 0.07, "{eye}: {} and {}: {apart}", a.mode, b.mode);
                    }
                }
            }
        }
    }
}
