//! Charts: lines and points over linear or logarithmic axes, as SVG and PNG.
//!
//! A [`Chart`] is data. It is laid out once (`layout`) into a list of strokes, areas and texts (`canvas`), which is then
//! written as SVG (`svg`) or drawn as PNG (`png`): both show the same. The font is a part of the program, so that a
//! picture does not depend on what is installed. Colours are those of Okabe and Ito (2008), which the colour-blind can
//! tell apart; points differ in shape as well.

mod canvas;
mod font;
mod layout;
mod png;
mod scaling;
mod svg;

use std::io;
use std::path::Path;

use crate::directory::replace;
use canvas::Canvas;

/// How an axis is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Equal distances for equal differences.
    #[default]
    Linear,
    /// Equal distances for equal ratios; values that are not positive are left out.
    Log,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// What is on it.
    pub label: String,
    /// How it is divided.
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
    /// Stairs: each value holds from the point before.
    Stairs,
    /// Points.
    Points,
    /// Points joined by a line.
    LineAndPoints,
}

/// Values that belong together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// Points (x, y); a value that is not finite makes a gap.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub style: Style,
    /// Colour and shape of the points: an index into the palette, which starts over at its end.
    pub colour: usize,
}

/// A straight line that shows a slope: of the logarithms where an axis is logarithmic.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// What is written beside it.
    pub label: String,
    /// The slope.
    pub slope: f64,
    /// A point that it goes through.
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
    /// Title; empty for none.
    pub title: String,
    /// Axis of the abscissa.
    pub x: Axis,
    /// Axis of the ordinate.
    pub y: Axis,
    /// What is drawn.
    pub series: Vec<Series>,
    /// Slopes to compare with.
    pub guides: Vec<Guide>,
}

/// Charts side by side under one legend, that of the first chart.
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
        svg::text(&self.canvas())
    }

    /// Writes `STEM.svg` and `STEM.png`.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&self, stem: &Path) -> io::Result<()> {
        write(&self.canvas(), stem)
    }

    fn canvas(&self) -> Canvas {
        layout::chart(self)
    }
}

impl Figure {
    /// The figure as SVG.
    pub fn svg(&self) -> String {
        svg::text(&layout::figure(self))
    }

    /// Writes `STEM.svg` and `STEM.png`.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&self, stem: &Path) -> io::Result<()> {
        write(&layout::figure(self), stem)
    }
}

fn write(canvas: &Canvas, stem: &Path) -> io::Result<()> {
    // Not `with_extension`: the stem may have dots of its own.
    let file = |extension: &str| {
        let mut name = stem.file_name().unwrap_or_default().to_os_string();
        name.push(extension);
        stem.with_file_name(name)
    };
    replace(&file(".svg"), svg::text(canvas).as_bytes())?;
    replace(&file(".png"), &png::bytes(canvas)?)
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
    fn both_files_are_written_whatever_the_values() {
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
