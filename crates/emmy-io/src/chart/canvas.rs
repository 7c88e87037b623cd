//! What is drawn: strokes, areas and texts, in points from the upper left corner.

/// A colour, red, green and blue.
pub(super) type Colour = [u8; 3];

/// Okabe and Ito (2008), the darker ones first; yellow, which is too pale on white for a line, is left out.
pub(super) const PALETTE: [Colour; 7] = [
    [0x00, 0x72, 0xB2],
    [0xD5, 0x5E, 0x00],
    [0x00, 0x9E, 0x73],
    [0xCC, 0x79, 0xA7],
    [0xE6, 0x9F, 0x00],
    [0x56, 0xB4, 0xE9],
    [0x00, 0x00, 0x00],
];
pub(super) const INK: Colour = [0x22, 0x22, 0x22];
pub(super) const FAINT: Colour = [0xE4, 0xE4, 0xE4];
pub(super) const MIDDLE: Colour = [0x70, 0x70, 0x70];

/// How a stroke is broken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Dash {
    Solid,
    Dashed,
    Dotted,
}

impl Dash {
    /// Lengths of strokes and gaps.
    pub(super) fn lengths(self) -> Option<[f32; 2]> {
        match self {
            Dash::Solid => None,
            Dash::Dashed => Some([6.0, 4.0]),
            Dash::Dotted => Some([1.5, 3.0]),
        }
    }
}

/// Which end of a text stands at its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// One thing that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Mark {
    Stroke {
        points: Vec<(f32, f32)>,
        colour: Colour,
        width: f32,
        dash: Dash,
    },
    Area {
        points: Vec<(f32, f32)>,
        fill: Colour,
        edge: Colour,
    },
    /// A text on its baseline; `upward`: turned by a right angle, to be read from the right.
    Text {
        at: (f32, f32),
        text: String,
        size: f32,
        colour: Colour,
        anchor: Anchor,
        upward: bool,
    },
}

/// Everything that is drawn, in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Canvas {
    pub(super) width: f32,
    pub(super) height: f32,
    pub(super) marks: Vec<Mark>,
}

impl Canvas {
    pub(super) fn line(&mut self, from: (f32, f32), to: (f32, f32), colour: Colour, width: f32) {
        self.stroke(vec![from, to], colour, width, Dash::Solid);
    }

    pub(super) fn stroke(&mut self, points: Vec<(f32, f32)>, colour: Colour, width: f32, dash: Dash) {
        self.marks.push(Mark::Stroke { points, colour, width, dash });
    }

    pub(super) fn text(&mut self, at: (f32, f32), text: &str, size: f32, anchor: Anchor) {
        self.label(at, text, size, anchor, INK, false);
    }

    pub(super) fn label(
        &mut self,
        at: (f32, f32),
        text: &str,
        size: f32,
        anchor: Anchor,
        colour: Colour,
        upward: bool,
    ) {
        let text = text.to_string();
        self.marks.push(Mark::Text { at, text, size, colour, anchor, upward });
    }

    /// A point of a series; the shape goes with the colour.
    pub(super) fn point(&mut self, at: (f32, f32), colour: usize) {
        let (n_corners, turn, radius) = match colour % PALETTE.len() {
            0 => (24, 0.0, 3.6),
            1 => (4, 0.125, 4.4),
            2 => (3, 0.25, 4.8),
            3 => (4, 0.0, 4.6),
            4 => (3, 0.75, 4.8),
            5 => (6, 0.0, 4.0),
            _ => (5, 0.25, 4.4),
        };
        let corner = |i: i32| {
            let angle = std::f32::consts::TAU * (i as f32 / n_corners as f32 + turn);
            (at.0 + radius * angle.cos(), at.1 - radius * angle.sin())
        };
        let fill = PALETTE[colour % PALETTE.len()];
        self.marks.push(Mark::Area { points: (0..n_corners).map(corner).collect(), fill, edge: [255; 3] });
    }
}
