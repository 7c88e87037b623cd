//! Charts: lines and points over linear or logarithmic axes, as SVG and PNG.
//!
//! A [`Chart`] is data, which plotters lays out. The colours of Okabe and Ito (2008) can be distinguished by
//! colour-blind readers; points also differ in shape.

mod axis;
mod panel;

use std::io;
use std::path::Path;

use crate::picture::{self, Area, Drawn, units};
pub(crate) use axis::superscript;
use panel::Legend;

/// Size of a single chart, in points.
const SIZE: (f64, f64) = (560.0, 420.0);
/// Size of a chart in a figure, in points.
const BESIDE: (f64, f64) = (480.0, 300.0);

/// How an axis is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Equal distances for equal differences.
    #[default]
    Linear,
    /// Equal distances for equal ratios; values that are not positive are not drawn.
    Log,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// Label.
    pub label: String,
    /// Scale.
    pub scale: Scale,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>) -> Self {
        Axis { label: label.into(), scale: Scale::Linear }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>) -> Self {
        Axis { label: label.into(), scale: Scale::Log }
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// A line.
    #[default]
    Line,
    /// A dashed line.
    Dashed,
    /// A dotted line.
    Dotted,
    /// Stairs: each value holds from the previous point on.
    Stairs,
    /// Points.
    Points,
    /// Points connected by a line.
    LineAndPoints,
}

impl Style {
    /// The style of one line among others, which shows those below it where they coincide: solid, dashed, dotted, in
    /// turns. On a logarithmic axis all are solid, because curves are rarely smooth there.
    ///
    /// ```
    /// use emmy_io::chart::{Scale, Style};
    /// assert_eq!([0, 1, 3].map(|i| Style::of_line(i, Scale::Linear)), [Style::Line, Style::Dashed, Style::Line]);
    /// ```
    pub fn of_line(index: usize, scale: Scale) -> Style {
        match (scale, index % 3) {
            (Scale::Log, _) | (_, 0) => Style::Line,
            (_, 1) => Style::Dashed,
            _ => Style::Dotted,
        }
    }
}

/// A curve or a set of points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// Points (x, y); a value that is not finite makes a gap.
    pub points: Vec<(f64, f64)>,
    /// Style.
    pub style: Style,
    /// Colour and shape of the points: an index into the palette, which repeats.
    pub colour: usize,
}

/// A straight line with a given slope; on logarithmic axes, the slope of the logarithms.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// Label.
    pub label: String,
    /// The slope.
    pub slope: f64,
    /// A point on the line.
    pub through: (f64, f64),
}

/// A chart.
///
/// ```
/// use emmy_io::chart::{Axis, Chart, Guide, Series, Style};
/// let chart = Chart {
///     title: "Error over step size".into(),
///     x: Axis::log("step size h"),
///     y: Axis::log("error"),
///     series: vec![Series {
///         label: "DGM".into(),
///         points: vec![(0.04, 1.6e-3), (0.02, 4e-4), (0.01, 1e-4)],
///         style: Style::LineAndPoints,
///         colour: 0,
///     }],
///     guides: vec![Guide { label: "order 2".into(), slope: 2.0, through: (0.01, 5e-5) }],
/// };
/// assert!(chart.svg().starts_with("<svg"));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Title; may be empty.
    pub title: String,
    /// Axis of the abscissa.
    pub x: Axis,
    /// Axis of the ordinate.
    pub y: Axis,
    /// The series.
    pub series: Vec<Series>,
    /// Slopes for comparison.
    pub guides: Vec<Guide>,
}

/// Charts side by side, under a legend of the first one in a row; a row with the series of the one above has none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// The charts, row by row.
    pub charts: Vec<Chart>,
    /// Number of columns.
    pub columns: usize,
}

impl Chart {
    /// The chart as SVG.
    pub fn svg(&self) -> String {
        let sheet = Sheet::new(std::slice::from_ref(self), 1, SIZE);
        picture::svg(sheet.size(), |area| sheet.draw(area))
    }

    /// Writes `STEM.svg` and `STEM.png`.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&self, stem: &Path) -> io::Result<()> {
        picture::write(&self.svg(), stem)
    }
}

impl Figure {
    /// The charts on a sheet of a width in points.
    pub(crate) fn sheet(&self, width: f64) -> Sheet<'_> {
        let columns = self.columns.clamp(1, self.charts.len().max(1));
        Sheet::new(&self.charts, columns, (width / columns as f64, BESIDE.1))
    }

    /// The figure as SVG.
    pub fn svg(&self) -> String {
        let sheet = self.sheet(BESIDE.0 * self.columns.clamp(1, self.charts.len().max(1)) as f64);
        picture::svg(sheet.size(), |area| sheet.draw(area))
    }

    /// Writes `STEM.svg` and `STEM.png`.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&self, stem: &Path) -> io::Result<()> {
        picture::write(&self.svg(), stem)
    }
}

/// Charts of one size, row by row under the legend of the first.
pub(crate) struct Sheet<'a> {
    charts: &'a [Chart],
    /// Rows and columns.
    grid: (usize, usize),
    /// Size of a chart.
    size: (f64, f64),
    /// Of each row; `None` for the series of the row above.
    legends: Vec<Option<Legend<'a>>>,
}

impl<'a> Sheet<'a> {
    fn new(charts: &'a [Chart], columns: usize, size: (f64, f64)) -> Self {
        let columns = columns.clamp(1, charts.len().max(1));
        let rows: Vec<&[Series]> = charts.chunks(columns).map(|row| &row[0].series[..]).collect();
        let keys = |series: &'a [Series]| series.iter().map(|own| (&own.label, own.colour, own.style));
        let legend = |row: usize| {
            let is_new = row == 0 || !keys(rows[row]).eq(keys(rows[row - 1]));
            is_new.then(|| Legend::new(rows[row], size.0 * columns as f64))
        };
        let legends = (0..rows.len()).map(legend).collect();
        Sheet { charts, grid: (rows.len(), columns), size, legends }
    }

    /// Width and height in points.
    pub(crate) fn size(&self) -> (f64, f64) {
        let (rows, columns) = self.grid;
        let legends: f64 = self.legends.iter().flatten().map(Legend::height).sum();
        (self.size.0 * columns as f64, legends + self.size.1 * rows as f64)
    }

    pub(crate) fn draw(&self, area: &Area<'_>) -> Drawn {
        let mut rest = area.clone();
        for (row, legend) in self.charts.chunks(self.grid.1).zip(&self.legends) {
            if let Some(legend) = legend {
                let (above, below) = rest.split_vertically(units(legend.height()));
                legend.draw(&above)?;
                rest = below;
            }
            let (own, below) = rest.split_vertically(units(self.size.1));
            let panels = own.split_evenly((1, self.grid.1));
            panels.iter().zip(row).try_for_each(|(area, chart)| panel::draw(area, chart))?;
            rest = below;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<(f64, f64)>, x: Axis, y: Axis) -> Chart {
        let series = Series { label: "a < b & \"c\"".into(), points, style: Style::LineAndPoints, colour: 9 };
        let guides = vec![Guide { label: "order 2".into(), slope: 2.0, through: (0.01, 1e-4) }];
        Chart { title: "title".into(), x, y, series: vec![series], guides }
    }

    #[test]
    fn both_files_are_written_for_any_values() {
        let temp = tempfile::tempdir().unwrap();
        let log = || Axis::log("x");
        let linear = || Axis::linear("x");
        for points in [
            vec![],
            vec![(0.1, 0.2)],
            vec![(0.1, 0.2), (0.1, 0.2)],
            vec![(0.0, 0.0), (-1.0, 1e-300), (1.0, 1e300)],
            vec![(0.04, 1e-3), (0.02, f64::NAN), (0.01, f64::INFINITY)],
            vec![(1e9, -5500.0), (2e9, -5500.000001)],
            vec![(-1e308, -1e300), (1e308, 1e300), (5e-324, 5e-324)],
        ] {
            for (x, y) in [(log(), log()), (linear(), linear()), (linear(), log())] {
                let chart = chart(points.clone(), x, y);
                let stem = temp.path().join("v1.5 chart");
                chart.write(&stem).unwrap();
                let svg = std::fs::read_to_string(temp.path().join("v1.5 chart.svg")).unwrap();
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{points:?}\n{svg}");
                assert!(svg.contains("a &lt; b &amp; "), "{svg}");
                let png = std::fs::read(temp.path().join("v1.5 chart.png")).unwrap();
                assert!(png.starts_with(b"\x89PNG"));
            }
        }
    }

    #[test]
    fn long_series_are_thinned_but_keep_their_extremes() {
        let mut points: Vec<(f64, f64)> = (0..200_000).map(|i| (f64::from(i), 0.0)).collect();
        points[77_777].1 = 1.0;
        let svg = chart(points, Axis::linear("t"), Axis::linear("E")).svg();
        assert!(svg.len() < 400_000, "{}", svg.len());
    }
}
