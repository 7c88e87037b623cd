//! The font: DejaVu Sans (free, Bitstream Vera licence), a part of the program.

use std::sync::LazyLock;

use tiny_skia::PathBuilder;
use ttf_parser::{Face, OutlineBuilder};

static FACE: LazyLock<Option<Face<'static>>> = LazyLock::new(|| Face::parse(dejavu::sans::regular(), 0).ok());

/// Width of a text of a size.
pub(super) fn width(text: &str, size: f32) -> f32 {
    let Some(face) = &*FACE else { return 0.0 };
    text.chars().map(|c| advance(face, c)).sum::<f32>() * size / f32::from(face.units_per_em())
}

/// Outlines of a text of a size, its baseline starting at the origin.
pub(super) fn outline(text: &str, size: f32, path: &mut PathBuilder) {
    let Some(face) = &*FACE else { return };
    let scale = size / f32::from(face.units_per_em());
    let mut start = 0.0;
    for c in text.chars() {
        if let Some(glyph) = face.glyph_index(c) {
            let _ = face.outline_glyph(glyph, &mut Pen { path, scale, start });
        }
        start += scale * advance(face, c);
    }
}

fn advance(face: &Face<'_>, c: char) -> f32 {
    let glyph = face.glyph_index(c).unwrap_or_default();
    f32::from(face.glyph_hor_advance(glyph).unwrap_or_default())
}

/// Brings outlines from the units of the font to those of the canvas.
struct Pen<'a> {
    path: &'a mut PathBuilder,
    scale: f32,
    start: f32,
}

impl Pen<'_> {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.start + self.scale * x, -self.scale * y)
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_every_character_of_the_axes() {
        let face = FACE.as_ref().unwrap();
        for c in "0123456789.,-+×()|·⁰¹²³⁴⁵⁶⁷⁸⁹⁻−∆Δαβνλμρ‖≤".chars() {
            assert!(face.glyph_index(c).is_some(), "{c}");
        }
        assert!((width("0000", 10.0) - 4.0 * width("0", 10.0)).abs() < 1e-4 && width("0", 10.0) > 4.0);
    }
}
