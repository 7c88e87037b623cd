//! Where everything stands in a chart.

use super::canvas::{Anchor, Canvas, Dash, FAINT, INK, MIDDLE, PALETTE};
use super::font;
use super::scaling::{Scaling, superscript};
use super::{Axis, Chart, Figure, Guide, Scale, Series, Style};

const SIZE: (f32, f32) = (560.0, 420.0);
const PANEL: (f32, f32) = (480.0, 300.0);
const LEFT: f32 = 74.0;
const RIGHT: f32 = 18.0;
const BOTTOM: f32 = 46.0;
const TITLE: f32 = 13.0;
const LABEL: f32 = 11.5;
const SMALL: f32 = 10.5;
/// Height of a row of the legend.
const ROW: f32 = 18.0;
/// Length of the line before a name in the legend.
const SAMPLE: f32 = 26.0;
/// Points of a series beyond this number are thinned.
const MOST_POINTS: usize = 4000;

/// A rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy)]
struct Frame {
    left: f32,
    top: f32,
    right: f32,
    bottom: f32,
}

/// A chart by itself, with its legend.
pub(super) fn chart(chart: &Chart) -> Canvas {
    let (width, height) = SIZE;
    let rows = legend_rows(&chart.series, width - 2.0 * RIGHT);
    let legend = ROW * rows.len() as f32;
    let mut canvas = Canvas { width, height: height + legend, marks: Vec::new() };
    let top = add_legend(&mut canvas, &rows, 8.0);
    let frame = Frame { left: 0.0, top, right: width, bottom: height + legend };
    Panel::new(chart, frame).draw(&mut canvas);
    canvas
}

/// Charts side by side under the legend of the first.
pub(super) fn figure(figure: &Figure) -> Canvas {
    let columns = figure.columns.clamp(1, figure.charts.len().max(1));
    let n_rows = figure.charts.len().div_ceil(columns);
    let width = PANEL.0 * columns as f32;
    let series = figure.charts.first().map_or(&[][..], |chart| &chart.series);
    let rows = legend_rows(series, width - 2.0 * RIGHT);
    let mut canvas = Canvas { width, height: 0.0, marks: Vec::new() };
    let top = add_legend(&mut canvas, &rows, 8.0);
    canvas.height = top + PANEL.1 * n_rows as f32;
    for (i, chart) in figure.charts.iter().enumerate() {
        let (left, top) = (PANEL.0 * (i % columns) as f32, top + PANEL.1 * (i / columns) as f32);
        let frame = Frame { left, top, right: left + PANEL.0, bottom: top + PANEL.1 };
        Panel::new(chart, frame).draw(&mut canvas);
    }
    canvas
}

/// The series of each row of the legend; those without a name, or only one, need none.
fn legend_rows(series: &[Series], width: f32) -> Vec<Vec<(&Series, f32)>> {
    let mut rows: Vec<Vec<(&Series, f32)>> = Vec::new();
    let mut used = f32::INFINITY;
    for series in series.iter().filter(|series| !series.label.is_empty()) {
        let own = SAMPLE + 8.0 + font::width(&series.label, SMALL) + 20.0;
        if used + own > width {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += own;
        if let Some(row) = rows.last_mut() {
            row.push((series, own));
        }
    }
    rows
}

/// Draws the legend and returns where it ends.
fn add_legend(canvas: &mut Canvas, rows: &[Vec<(&Series, f32)>], mut top: f32) -> f32 {
    for row in rows {
        let whole: f32 = row.iter().map(|(_, own)| own).sum();
        let mut x = (0.5 * (canvas.width - whole)).max(8.0);
        let y = top + 0.5 * ROW;
        for (series, own) in row {
            add_series(canvas, series, 2.0, vec![vec![(x, y), (x + SAMPLE, y)]], vec![(x + 0.5 * SAMPLE, y)]);
            canvas.text((x + SAMPLE + 8.0, y + 4.0), &series.label, SMALL, Anchor::Start);
            x += own;
        }
        top += ROW;
    }
    top
}

/// Lines and points of a series.
fn add_series(
    canvas: &mut Canvas,
    series: &Series,
    width: f32,
    lines: Vec<Vec<(f32, f32)>>,
    points: Vec<(f32, f32)>,
) {
    let colour = PALETTE[series.colour % PALETTE.len()];
    // Once the palette starts over, lines are dashed.
    let again = series.colour >= PALETTE.len();
    let dash = match series.style {
        Style::Dashed => Dash::Dashed,
        Style::Dotted => Dash::Dotted,
        _ if again => Dash::Dashed,
        _ => Dash::Solid,
    };
    if series.style != Style::Points {
        for line in lines.into_iter().filter(|line| line.len() > 1) {
            canvas.stroke(line, colour, width, dash);
        }
    }
    if matches!(series.style, Style::Points | Style::LineAndPoints) {
        points.into_iter().for_each(|at| canvas.point(at, series.colour));
    }
}

/// A chart in its place.
struct Panel<'a> {
    chart: &'a Chart,
    /// The place of title, axes and labels.
    outer: Frame,
    /// The place of the curves.
    inner: Frame,
    x: Scaling,
    y: Scaling,
}

impl<'a> Panel<'a> {
    fn new(chart: &'a Chart, outer: Frame) -> Self {
        let points = || chart.series.iter().flat_map(|series| &series.points).copied();
        let room = if chart.x.scale == Scale::Log { 0.08 } else { 0.0 };
        let x = Scaling::over(chart.x.scale, points().map(|(x, _)| x), room);
        let bare = Scaling::over(chart.x.scale, points().map(|(x, _)| x), 0.0);
        let y = Scaling::over(chart.y.scale, points().map(|(_, y)| y), 0.0);
        let ends = chart.guides.iter().flat_map(|guide| guide_ends(guide, bare, y)).map(|(_, y)| y);
        let y = Scaling::over(chart.y.scale, points().map(|(_, y)| y).chain(ends), 0.06);
        let top = outer.top + if chart.title.is_empty() { 12.0 } else { 32.0 };
        let inner =
            Frame { left: outer.left + LEFT, top, right: outer.right - RIGHT, bottom: outer.bottom - BOTTOM };
        Panel { chart, outer, inner, x, y }
    }

    fn draw(&self, canvas: &mut Canvas) {
        let Frame { left, top, right, bottom } = self.inner;
        canvas.text((left, self.outer.top + 22.0), &self.chart.title, TITLE, Anchor::Start);
        self.x_ticks(canvas);
        self.y_ticks(canvas);
        self.chart.guides.iter().for_each(|guide| self.guide(canvas, guide));
        for (i, series) in self.chart.series.iter().enumerate() {
            let lines = self.lines(&series.points).into_iter();
            let lines = lines.map(|line| if series.style == Style::Stairs { stairs(&line) } else { line });
            let lines: Vec<_> = lines.map(|line| thinned(&line)).collect();
            let points = lines.iter().flatten().copied().collect();
            add_series(canvas, series, self.width(i), lines, points);
        }
        let corners = vec![(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        canvas.stroke(corners, INK, 1.0, Dash::Solid);
    }

    fn x_ticks(&self, canvas: &mut Canvas) {
        let Frame { left, top, right, bottom } = self.inner;
        let (ticks, power) = self.x.ticks();
        for tick in ticks {
            let x = left + tick.at as f32 * (right - left);
            if tick.label.is_some() {
                canvas.line((x, top), (x, bottom), FAINT, 0.8);
            }
            canvas.line((x, bottom), (x, bottom - if tick.label.is_some() { 5.0 } else { 3.0 }), INK, 0.8);
            canvas.text((x, bottom + 16.0), &tick.label.unwrap_or_default(), SMALL, Anchor::Middle);
        }
        let middle = (0.5 * (left + right), bottom + 36.0);
        canvas.text(middle, &with_power(&self.chart.x, power), LABEL, Anchor::Middle);
    }

    fn y_ticks(&self, canvas: &mut Canvas) {
        let Frame { left, top, right, bottom } = self.inner;
        let (ticks, power) = self.y.ticks();
        for tick in ticks {
            let y = bottom - tick.at as f32 * (bottom - top);
            if tick.label.is_some() {
                canvas.line((left, y), (right, y), FAINT, 0.8);
            }
            canvas.line((left, y), (left + if tick.label.is_some() { 5.0 } else { 3.0 }, y), INK, 0.8);
            canvas.text((left - 6.0, y + 4.0), &tick.label.unwrap_or_default(), SMALL, Anchor::End);
        }
        let middle = (self.outer.left + 18.0, 0.5 * (top + bottom));
        canvas.label(middle, &with_power(&self.chart.y, power), LABEL, Anchor::Middle, INK, true);
    }

    /// Width of a line: wider where others lie on top, so that curves that fall together can all be seen.
    fn width(&self, index: usize) -> f32 {
        let is_line = |series: &&Series| !matches!(series.style, Style::Points | Style::LineAndPoints);
        let above = self.chart.series[index + 1..].iter().filter(is_line);
        let above = above.filter(|series| series.style == self.chart.series[index].style).count();
        // Less so on a logarithmic axis, where curves are rarely smooth.
        let more = if self.chart.y.scale == Scale::Linear { 1.1 } else { 0.6 };
        1.4 + more * above.min(3) as f32
    }

    fn at(&self, (x, y): (f64, f64)) -> Option<(f32, f32)> {
        let Frame { left, top, right, bottom } = self.inner;
        let (x, y) = (self.x.place(x)? as f32, self.y.place(y)? as f32);
        Some((left + x * (right - left), bottom - y * (bottom - top)))
    }

    /// Points on the canvas, in runs without gaps. What a logarithmic axis cannot show is left out without a gap.
    fn lines(&self, points: &[(f64, f64)]) -> Vec<Vec<(f32, f32)>> {
        let mut lines = vec![Vec::new()];
        for &(x, y) in points {
            match self.at((x, y)) {
                Some(at) => lines.iter_mut().last().into_iter().for_each(|line| line.push(at)),
                None if !(x.is_finite() && y.is_finite()) => lines.push(Vec::new()),
                None => {}
            }
        }
        lines.retain(|line| !line.is_empty());
        lines
    }

    /// A dashed line with its label at the upper end.
    fn guide(&self, canvas: &mut Canvas, guide: &Guide) {
        let points: Vec<f64> = self.chart.series.iter().flat_map(|s| s.points.iter().map(|p| p.0)).collect();
        let bare = Scaling::over(self.chart.x.scale, points.into_iter(), 0.0);
        let ends: Vec<_> =
            guide_ends(guide, bare, self.y).into_iter().filter_map(|point| self.at(point)).collect();
        let [from, to] = ends[..] else { return };
        canvas.stroke(vec![from, to], MIDDLE, 1.1, Dash::Dashed);
        // Below the line, where a line of this slope leaves room.
        let at = (from.0 + 0.56 * (to.0 - from.0) + 8.0, from.1 + 0.56 * (to.1 - from.1) + 13.0);
        canvas.label(at, &guide.label, SMALL, Anchor::Start, MIDDLE, false);
    }
}

/// Each value from the point before on.
fn stairs(points: &[(f32, f32)]) -> Vec<(f32, f32)> {
    let step = |pair: &[(f32, f32)]| [(pair[0].0, pair[1].1), pair[1]];
    points.first().copied().into_iter().chain(points.windows(2).flat_map(step)).collect()
}

/// Where a guide crosses the ends of the data.
fn guide_ends(guide: &Guide, x: Scaling, y: Scaling) -> Vec<(f64, f64)> {
    let (Some(x0), Some(y0)) = (x.coordinate(guide.through.0), y.coordinate(guide.through.1)) else {
        return Vec::new();
    };
    let end = |at: f64| {
        let x1 = x.coordinate_at(at);
        (x.value(x1), y.value(y0 + guide.slope * (x1 - x0)))
    };
    vec![end(0.0), end(1.0)]
}

fn with_power(axis: &Axis, power: Option<i32>) -> String {
    match power {
        Some(power) => format!("{} (×10{})", axis.label, superscript(power)),
        None => axis.label.clone(),
    }
}

/// First, lowest, highest and last point of each of many groups, if there are more points than can be told apart.
fn thinned(points: &[(f32, f32)]) -> Vec<(f32, f32)> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let group = |group: &[(f32, f32)]| {
        let by_height = |a: &&(f32, f32), b: &&(f32, f32)| a.1.total_cmp(&b.1);
        let (low, high) = (group.iter().min_by(by_height), group.iter().max_by(by_height));
        let mut kept: Vec<(f32, f32)> =
            [group.first(), low, high, group.last()].into_iter().flatten().copied().collect();
        kept.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.dedup();
        kept
    };
    points.chunks(points.len().div_ceil(MOST_POINTS / 4)).flat_map(group).collect()
}
