//! SVG to PNG with the embedded faces only, so that a picture looks alike on every machine, fonts installed or not.

use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// Largest side of a picture, pixels.
const LARGEST: f32 = 16_384.0;

/// Rasterises a figure on white; `scale` is PNG pixels a pixel of the figure.
///
/// # Errors
/// When the text is no SVG, the scale is not positive, or the picture would be absurdly large.
pub fn png(svg: &str, scale: f32) -> Result<Vec<u8>> {
    ensure!(
        scale.is_finite() && scale > 0.0,
        "scale must be positive, not {scale}"
    );
    let mut options = Options {
        font_family: "Ubuntu".to_owned(),
        ..Options::default()
    };
    let fonts = options.fontdb_mut();
    // The second face only lends glyphs that the first lacks.
    for face in [
        epaint_default_fonts::UBUNTU_LIGHT,
        epaint_default_fonts::HACK_REGULAR,
    ] {
        fonts.load_font_source(fontdb::Source::Binary(Arc::new(face)));
    }
    let tree = Tree::from_str(&spelt(svg), &options).context("cannot read the figure")?;
    let (width, height) = (
        (tree.size().width() * scale).ceil(),
        (tree.size().height() * scale).ceil(),
    );
    ensure!(
        width <= LARGEST && height <= LARGEST,
        "{width} by {height} pixels are too many"
    );
    let mut picture =
        Pixmap::new(width as u32, height as u32).context("cannot make a picture of that size")?;
    picture.fill(Color::WHITE);
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut picture.as_mut(),
    );
    picture.encode_png().context("cannot encode the picture")
}

/// Letters of scripts that the embedded faces lack, such as Chinese, spelt in ASCII: a font with them would be larger than the
/// whole program. The SVG keeps them, and whoever shows it has the fonts.
fn spelt(svg: &str) -> String {
    let lacks = |c: char| {
        let beyond_cyrillic = c >= '\u{530}' && !('\u{1d00}'..'\u{2e00}').contains(&c);
        beyond_cyrillic && c.is_alphanumeric()
    };
    let mut text = String::with_capacity(svg.len());
    for c in svg.chars() {
        match lacks(c) {
            false => text.push(c),
            true => {
                let ascii = deunicode::deunicode_char(c).unwrap_or("?").trim();
                text.extend(ascii.chars().filter(|c| !matches!(c, '<' | '>' | '&')));
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{CENTRED, INK, document};

    fn dark_pixels(png: &[u8]) -> usize {
        let picture = Pixmap::decode_png(png).unwrap();
        picture
            .pixels()
            .iter()
            .filter(|pixel| pixel.red() < 128)
            .count()
    }

    #[test]
    fn text_appears_without_any_installed_font() {
        let with = |text: &str| {
            let svg = document(200.0, 40.0, |canvas| {
                canvas.text(text, (100.0, 20.0), 20.0, INK, CENTRED)
            })
            .unwrap();
            png(&svg, 2.0).unwrap()
        };
        assert!(with("φ [°] − seed 7").starts_with(b"\x89PNG\r\n\x1a\n"));
        assert_eq!(dark_pixels(&with(" ")), 0);
        assert!(dark_pixels(&with("Hhh")) > 200);
        assert!(dark_pixels(&with("φ")) > 30);
        // A box is what a missing letter would be.
        assert_eq!(with("温度"), with("WenDu"));
        assert_ne!(with("Größe"), with("Grosse"));
    }

    #[test]
    fn nonsense_is_an_error() {
        let svg = document(10.0, 10.0, |_| Ok(())).unwrap();
        assert!(png(&svg, 0.0).is_err());
        assert!(png(&svg, f32::NAN).is_err());
        assert!(png(&svg, 1e9).is_err());
        assert!(png("<svg", 1.0).is_err());
    }
}
