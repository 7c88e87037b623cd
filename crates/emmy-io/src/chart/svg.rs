//! A canvas as SVG: texts stay texts.

use std::fmt::Write;

use super::canvas::{Anchor, Canvas, Colour, Mark};
use crate::directory::MARK;

const FONTS: &str = "'DejaVu Sans', Verdana, Arial, sans-serif";

/// The SVG file.
pub(super) fn text(canvas: &Canvas) -> String {
    let (width, height) = (canvas.width, canvas.height);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\" stroke-linejoin=\"round\">\n<!-- {} -->\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        MARK.trim_start_matches("# ")
    );
    canvas.marks.iter().for_each(|mark| add(&mut svg, mark));
    svg + "</svg>\n"
}

fn add(svg: &mut String, mark: &Mark) {
    // Writing to a string cannot fail.
    let _ = match mark {
        Mark::Stroke { points, colour, width, dash } => {
            let dash =
                dash.lengths().map_or(String::new(), |[on, off]| format!(" stroke-dasharray=\"{on} {off}\""));
            let (points, colour) = (list(points), hex(*colour));
            writeln!(
                svg,
                "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dash}/>"
            )
        }
        Mark::Area { points, fill, edge } => {
            let (points, fill, edge) = (list(points), hex(*fill), hex(*edge));
            writeln!(
                svg,
                "<polygon points=\"{points}\" fill=\"{fill}\" stroke=\"{edge}\" stroke-width=\"0.7\"/>"
            )
        }
        Mark::Text { at: (x, y), text, size, colour, anchor, upward } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let turn =
                if *upward { format!(" transform=\"rotate(-90 {x:.2} {y:.2})\"") } else { String::new() };
            let (text, fill) = (escaped(text), hex(*colour));
            writeln!(
                svg,
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size}\" fill=\"{fill}\" text-anchor=\"{anchor}\"{turn}>{text}</text>"
            )
        }
    };
}

fn list(points: &[(f32, f32)]) -> String {
    points.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect::<Vec<_>>().join(" ")
}

fn hex(colour: Colour) -> String {
    format!("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2])
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
