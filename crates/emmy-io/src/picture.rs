//! Pictures, for charts and drawings: plotters writes SVG, resvg converts it to PNG.
//!
//! The font (DejaVu Sans, Bitstream Vera licence) is part of the program, so that pictures do not depend on installed
//! fonts.

use std::io;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use resvg::tiny_skia::{IntSize, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use crate::directory::MARK;
use crate::whole_file::replace;

/// Units of the canvas per point. plotters has integer coordinates, and curves need finer ones than points.
const UNITS: f64 = 10.0;
/// Pixels per point in PNG.
pub(crate) const PIXELS: f32 = 2.5;
const FAMILY: &str = "DejaVu Sans, Verdana, Arial, sans-serif";
/// plotters writes text smaller than requested by this factor.
const SHRINKING: f64 = 1.24;

pub(crate) const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);

/// A part of the canvas, in units.
pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Result of drawing.
pub(crate) type Drawn = Result<(), DrawingAreaErrorKind<io::Error>>;

/// Units of a length in points.
pub(crate) fn units(points: f64) -> i32 {
    (UNITS * points).round() as i32
}

/// A line of a width in points.
pub(crate) fn stroke(colour: RGBColor, width: f64) -> ShapeStyle {
    ShapeStyle { color: colour.to_rgba(), filled: false, stroke_width: units(width) as u32 }
}

/// Text of a size in points.
pub(crate) fn writing(size: f64) -> TextStyle<'static> {
    static FONT: LazyLock<()> = LazyLock::new(|| {
        // plotters only measures with the font; an error would misplace the text slightly.
        let _ = plotters::style::register_font(FAMILY, FontStyle::Normal, dejavu::sans::regular());
    });
    LazyLock::force(&FONT);
    (FAMILY, UNITS * size * SHRINKING).into_font().color(&INK)
}

/// Text whose start, middle or end, at half its height, is at a point.
pub(crate) fn text(area: &Area<'_>, text: &str, style: &TextStyle<'_>, side: HPos, at: (i32, i32)) -> Drawn {
    if text.is_empty() {
        return Ok(());
    }
    area.draw(&Text::new(text, at, style.pos(Pos::new(side, VPos::Center))))
}

/// Width of a text in units.
pub(crate) fn width(text: &str, style: &TextStyle<'_>) -> i32 {
    style.font.box_size(text).map_or(0, |(width, _)| width as i32)
}

/// A picture of a size in points, as SVG.
pub(crate) fn svg(size: (f64, f64), draw: impl FnOnce(&Area<'_>) -> Drawn) -> String {
    overlay(size, |area| area.fill(&WHITE).and_then(|()| draw(area)))
}

/// A picture of a size in points without ground, as SVG.
pub(crate) fn overlay((width, height): (f64, f64), draw: impl FnOnce(&Area<'_>) -> Drawn) -> String {
    let mut svg = String::new();
    let area =
        SVGBackend::with_string(&mut svg, (units(width) as u32, units(height) as u32)).into_drawing_area();
    // Writing to a string cannot fail.
    let _ = draw(&area).and_then(|()| area.present());
    drop(area);
    let header = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\" \
         stroke-linejoin=\"round\">\n<!-- {} -->\n",
        units(width),
        units(height),
        MARK.trim_start_matches("# ")
    );
    let content = svg.split_once('\n').map_or("", |(_, content)| content);
    header + content
}

/// Writes `STEM.svg` and `STEM.png`.
pub(crate) fn write(svg: &str, stem: &Path) -> io::Result<()> {
    // Not `with_extension`: the stem may contain dots.
    let file = |extension: &str| {
        let mut name = stem.file_name().unwrap_or_default().to_os_string();
        name.push(extension);
        stem.with_file_name(name)
    };
    replace(&file(".svg"), svg.as_bytes())?;
    replace(&file(".png"), &png(svg)?)
}

fn png(svg: &str) -> io::Result<Vec<u8>> {
    let tree = tree(svg)?;
    let [width, height] = size(&tree);
    drawn(&tree, Pixmap::new(width, height))
}

/// A picture over others, as PNG. `pixels`: red, green, blue and 255 of each pixel, of which a point has [`PIXELS`].
pub(crate) fn png_over(svg: &str, pixels: Vec<u8>) -> io::Result<Vec<u8>> {
    let tree = tree(svg)?;
    let [width, height] = size(&tree);
    drawn(&tree, IntSize::from_wh(width, height).and_then(|size| Pixmap::from_vec(pixels, size)))
}

fn tree(svg: &str) -> io::Result<Tree> {
    static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(dejavu::sans::regular().to_vec());
        Arc::new(fonts)
    });
    let options = Options { fontdb: FONTS.clone(), ..Options::default() };
    Tree::from_str(svg, &options).map_err(io::Error::other)
}

/// Width and height in pixels.
fn size(tree: &Tree) -> [u32; 2] {
    let size = tree.size().to_int_size().scale_by(PIXELS);
    size.map_or([0; 2], |size| [size.width(), size.height()])
}

fn drawn(tree: &Tree, pixmap: Option<Pixmap>) -> io::Result<Vec<u8>> {
    let mut pixmap = pixmap.ok_or_else(|| io::Error::other("the picture is too large to be drawn"))?;
    resvg::render(tree, Transform::from_scale(PIXELS, PIXELS), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(io::Error::other)
}
