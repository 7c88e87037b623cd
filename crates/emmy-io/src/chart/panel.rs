//! Draws one chart and the legend.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::{Ruler, superscript};
use super::{Axis, Chart, Guide, Scale, Series, Style};
use crate::picture::{Area, Drawn, INK, stroke, text, units, width, writing};

/// Okabe and Ito (2008), dark colours first; without yellow, which is too pale for a line on white, and with a grey.
const PALETTE: [RGBColor; 8] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
    RGBColor(0x00, 0x00, 0x00),
    RGBColor(0x8C, 0x8C, 0x8C),
];
const GRID: RGBColor = RGBColor(0xE0, 0xE0, 0xE0);
const FAINT: RGBColor = RGBColor(0xF2, 0xF2, 0xF2);
const MIDDLE: RGBColor = RGBColor(0x70, 0x70, 0x70);
// Sizes in points.
const TITLE: f64 = 13.0;
const LABEL: f64 = 11.5;
const SMALL_TEXT: f64 = 10.5;
/// Height of a row of the legend.
const ROW: f64 = 18.0;
/// Length of the line before a name in the legend.
const SAMPLE: f64 = 26.0;
/// Width of every line.
const LINE: f64 = 1.8;
/// A series with more points is thinned.
const MAX_POINTS: usize = 4000;

/// A point of the canvas.
type CanvasPoint = (i32, i32);

/// The legend of some series within a width in points; series without a name are left out.
pub(super) struct Legend<'a> {
    /// Series of each row, each with its width in units.
    rows: Vec<Vec<(&'a Series, i32)>>,
}

impl<'a> Legend<'a> {
    pub(super) fn new(series: &'a [Series], most: f64) -> Self {
        let mut rows: Vec<Vec<(&Series, i32)>> = Vec::new();
        let mut used = 0;
        for series in series.iter().filter(|series| !series.label.is_empty()) {
            let own = units(SAMPLE + 28.0) + width(&series.label, &writing(SMALL_TEXT));
            used += own;
            if rows.is_empty() || used > units(most) {
                rows.push(Vec::new());
                used = own;
            }
            rows.last_mut().into_iter().for_each(|row| row.push((series, own)));
        }
        Legend { rows }
    }

    /// Height in points.
    pub(super) fn height(&self) -> f64 {
        8.0 + ROW * self.rows.len() as f64
    }

    /// Draws the legend with its rows centred.
    pub(super) fn draw(&self, area: &Area<'_>) -> Drawn {
        let sample = units(SAMPLE);
        let gap = units(8.0);
        for (i, row) in self.rows.iter().enumerate() {
            let whole: i32 = row.iter().map(|(_, own)| own).sum();
            let mut x = ((area.dim_in_pixel().0 as i32 - whole) / 2).max(gap);
            let y = units(8.0 + ROW * (i as f64 + 0.5));
            for (series, own) in row {
                draw_series(area, series, &[vec![(x, y), (x + sample, y)]], &[(x + sample / 2, y)])?;
                text(area, &series.label, &writing(SMALL_TEXT), HPos::Left, (x + sample + gap, y))?;
                x += own;
            }
        }
        Ok(())
    }
}

/// Lines and points of a series.
fn draw_series(
    area: &Area<'_>,
    series: &Series,
    lines: &[Vec<CanvasPoint>],
    points: &[CanvasPoint],
) -> Drawn {
    let pen = stroke(PALETTE[series.colour % PALETTE.len()], LINE);
    // When the palette repeats, lines are dashed.
    let style = match series.style {
        Style::Line | Style::Stairs | Style::LineAndPoints if series.colour >= PALETTE.len() => Style::Dashed,
        style => style,
    };
    for line in lines.iter().filter(|line| line.len() > 1 && series.style != Style::Points) {
        let points = line.iter().copied();
        match style {
            Style::Dashed => area.draw(&DashedPathElement::new(points, units(6.0), units(4.0), pen))?,
            Style::Dotted => area.draw(&DashedPathElement::new(points, units(1.6), units(3.0), pen))?,
            _ => area.draw(&PathElement::new(line.clone(), pen))?,
        }
    }
    let is_marked = matches!(series.style, Style::Points | Style::LineAndPoints);
    points.iter().filter(|_| is_marked).try_for_each(|&at| area.draw(&point(at, series.colour)))
}

/// A point of a series; each colour has a shape.
fn point(at: CanvasPoint, colour: usize) -> Polygon<CanvasPoint> {
    let (n_corners, turn, radius) = match colour % PALETTE.len() {
        0 => (24, 0.0, 3.6),
        1 => (4, 0.125, 4.4),
        2 => (3, 0.25, 4.8),
        3 => (4, 0.0, 4.6),
        4 => (3, 0.75, 4.8),
        5 => (6, 0.0, 4.0),
        6 => (5, 0.25, 4.4),
        _ => (4, 0.125, 3.2),
    };
    let corner = |i: i32| {
        let angle = std::f64::consts::TAU * (f64::from(i) / f64::from(n_corners) + turn);
        (at.0 + units(radius * angle.cos()), at.1 - units(radius * angle.sin()))
    };
    Polygon::new((0..n_corners).map(corner).collect::<Vec<_>>(), PALETTE[colour % PALETTE.len()])
}

/// Draws a chart.
pub(super) fn draw(area: &Area<'_>, chart: &Chart) -> Drawn {
    let (x, y) = rulers(chart);
    let mut builder = ChartBuilder::on(area);
    builder.margin_top(units(if chart.title.is_empty() { 12.0 } else { 30.0 })).margin_right(units(18.0));
    builder.margin_left(units(8.0)).margin_bottom(units(6.0));
    builder.x_label_area_size(units(38.0)).y_label_area_size(units(66.0));
    text(area, &chart.title, &writing(TITLE), HPos::Left, (units(74.0), units(18.0)))?;
    let mut context = builder.build_cartesian_2d(x, y)?;
    (context.configure_mesh())
        .bold_line_style(stroke(GRID, 0.8))
        .light_line_style(stroke(FAINT, 0.8))
        .axis_style(stroke(INK, 1.0))
        .set_all_tick_mark_size(units(3.0))
        .label_style(writing(SMALL_TEXT))
        .axis_desc_style(writing(LABEL))
        .x_desc(with_power(&chart.x, x.power))
        .y_desc(with_power(&chart.y, y.power))
        .draw()?;
    let place = |(a, b): (f64, f64)| Some(context.backend_coord(&(x.coordinate(a)?, y.coordinate(b)?)));
    let canvas = area.use_screen_coord();
    chart
        .guides
        .iter()
        .try_for_each(|guide| draw_guide(&canvas, guide, guide_ends(chart, guide).map(place)))?;
    for series in &chart.series {
        let lines: Vec<_> = lines(series, place).iter().map(|line| thinned(line)).collect();
        let points: Vec<CanvasPoint> = lines.iter().flatten().copied().collect();
        draw_series(&canvas, series, &lines, &points)?;
    }
    let corners = [(x.low, y.low), (x.high, y.low), (x.high, y.high), (x.low, y.high), (x.low, y.low)];
    context.draw_series([PathElement::new(corners, stroke(INK, 1.0))])?;
    Ok(())
}

/// Both axes, with room for all points and guides.
fn rulers(chart: &Chart) -> (Ruler, Ruler) {
    let points = || chart.series.iter().flat_map(|series| &series.points).copied();
    let ends = chart.guides.iter().flat_map(|guide| guide_ends(chart, guide));
    let room = if chart.x.scale == Scale::Log { 0.08 } else { 0.0 };
    let x = Ruler::over(chart.x.scale, points().map(|(x, _)| x), room);
    (x, Ruler::over(chart.y.scale, points().chain(ends).map(|(_, y)| y), 0.06))
}

/// The ends of a guide at the ends of the data.
fn guide_ends(chart: &Chart, guide: &Guide) -> [(f64, f64); 2] {
    let values = |of: fn(&(f64, f64)) -> f64| chart.series.iter().flat_map(|s| &s.points).map(of);
    let x = Ruler::over(chart.x.scale, values(|point| point.0), 0.0);
    let y = Ruler::over(chart.y.scale, values(|point| point.1), 0.0);
    let through = x.coordinate(guide.through.0).zip(y.coordinate(guide.through.1));
    [x.low, x.high].map(|end| {
        let height = through.map_or(f64::NAN, |(x0, y0)| y0 + guide.slope * (end - x0));
        (x.value(end), y.value(height))
    })
}

/// A dashed line with its label below it.
fn draw_guide(area: &Area<'_>, guide: &Guide, ends: [Option<CanvasPoint>; 2]) -> Drawn {
    let [Some(from), Some(to)] = ends else { return Ok(()) };
    let pen = stroke(MIDDLE, 1.1);
    area.draw(&DashedPathElement::new([from, to], units(6.0), units(4.0), pen))?;
    let at = |a: i32, b: i32| a + (0.56 * f64::from(b - a)) as i32;
    let at = (at(from.0, to.0) + units(8.0), at(from.1, to.1) + units(9.0));
    text(area, &guide.label, &writing(SMALL_TEXT).color(&MIDDLE), HPos::Left, at)
}

fn with_power(axis: &Axis, power: i32) -> String {
    if power == 0 { axis.label.clone() } else { format!("{} (×10{})", axis.label, superscript(power)) }
}

/// Sequences of points without a gap.
fn lines(series: &Series, place: impl Fn((f64, f64)) -> Option<CanvasPoint>) -> Vec<Vec<CanvasPoint>> {
    let places: Vec<Option<CanvasPoint>> = series.points.iter().map(|&point| place(point)).collect();
    let lines = places.split(Option::is_none).map(|line| line.iter().copied().flatten().collect());
    if series.style == Style::Stairs { lines.map(stairs).collect() } else { lines.collect() }
}

/// Stairs: each value from the previous point on.
fn stairs(points: Vec<CanvasPoint>) -> Vec<CanvasPoint> {
    let step = |pair: &[CanvasPoint]| [(pair[0].0, pair[1].1), pair[1]];
    points.first().copied().into_iter().chain(points.windows(2).flat_map(step)).collect()
}

/// First, lowest, highest and last point of each of many groups, if there are more points than can be distinguished.
fn thinned(points: &[CanvasPoint]) -> Vec<CanvasPoint> {
    if points.len() <= MAX_POINTS {
        return points.to_vec();
    }
    let group = |group: &[CanvasPoint]| {
        let low = (0..group.len()).min_by_key(|&i| group[i].1).unwrap_or(0);
        let high = (0..group.len()).max_by_key(|&i| group[i].1).unwrap_or(0);
        let mut kept = vec![0, low, high, group.len() - 1];
        kept.sort_unstable();
        kept.dedup();
        kept.into_iter().map(|i| group[i]).collect::<Vec<_>>()
    };
    points.chunks(points.len().div_ceil(MAX_POINTS / 4)).flat_map(group).collect()
}
