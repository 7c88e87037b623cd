//! A canvas as PNG.

use std::io;

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::canvas::{Anchor, Canvas, Colour, Mark};
use super::font;

/// Pixels a point.
const SCALE: f32 = 2.5;

/// The PNG file.
pub(super) fn bytes(canvas: &Canvas) -> io::Result<Vec<u8>> {
    let (width, height) = ((SCALE * canvas.width).ceil() as u32, (SCALE * canvas.height).ceil() as u32);
    let too_large = || io::Error::other(format!("a picture of {width} x {height} pixels cannot be drawn"));
    let mut pixmap = Pixmap::new(width, height).ok_or_else(too_large)?;
    pixmap.fill(Color::WHITE);
    canvas.marks.iter().for_each(|mark| draw(&mut pixmap, mark));
    pixmap.encode_png().map_err(io::Error::other)
}

fn draw(pixmap: &mut Pixmap, mark: &Mark) {
    let place = Transform::from_scale(SCALE, SCALE);
    match mark {
        Mark::Stroke { points, colour, width, dash } => {
            let Some(path) = path(points, false) else { return };
            let dash = dash.lengths().and_then(|lengths| StrokeDash::new(lengths.to_vec(), 0.0));
            let (line_cap, line_join) = (LineCap::Butt, LineJoin::Round);
            let stroke = Stroke { width: *width, line_cap, line_join, dash, ..Stroke::default() };
            pixmap.stroke_path(&path, &paint(*colour), &stroke, place, None);
        }
        Mark::Area { points, fill, edge } => {
            let Some(path) = path(points, true) else { return };
            pixmap.fill_path(&path, &paint(*fill), FillRule::Winding, place, None);
            pixmap.stroke_path(
                &path,
                &paint(*edge),
                &Stroke { width: 0.7, ..Stroke::default() },
                place,
                None,
            );
        }
        Mark::Text { at: (x, y), text, size, colour, anchor, upward } => {
            let shift = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => -0.5 * font::width(text, *size),
                Anchor::End => -font::width(text, *size),
            };
            let mut builder = PathBuilder::new();
            font::outline(text, *size, &mut builder);
            let Some(path) = builder.finish() else { return };
            let turn = Transform::from_rotate(if *upward { -90.0 } else { 0.0 });
            let place = place.pre_translate(*x, *y).pre_concat(turn).pre_translate(shift, 0.0);
            pixmap.fill_path(&path, &paint(*colour), FillRule::Winding, place, None);
        }
    }
}

fn path(points: &[(f32, f32)], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    builder.move_to(first.0, first.1);
    rest.iter().for_each(|(x, y)| builder.line_to(*x, *y));
    if closed {
        builder.close();
    }
    builder.finish()
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(colour[0], colour[1], colour[2], 255);
    paint.anti_alias = true;
    paint
}
