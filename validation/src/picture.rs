//! Pictures of the items, through the charts of `emmy_io`.

use std::path::PathBuf;

use emmy_io::chart::{Axis, Chart, Guide, Series as Drawn, Style};

/// A named curve.
pub struct Series {
    label: String,
    points: Vec<(f64, f64)>,
    style: Style,
}

impl Series {
    /// A line.
    pub fn line(label: &str, points: Vec<(f64, f64)>) -> Self {
        Series { label: label.into(), points, style: Style::Line }
    }

    /// A line with its points marked.
    pub fn marked(label: &str, points: Vec<(f64, f64)>) -> Self {
        Series { label: label.into(), points, style: Style::LineAndPoints }
    }
}

/// Where pictures are written.
pub struct Pictures {
    /// The folder.
    pub folder: PathBuf,
}

impl Pictures {
    /// A chart with linear axes; returns the name of the file.
    pub fn linear(
        &self,
        stem: &str,
        title: &str,
        x: &str,
        y: &str,
        series: Vec<Series>,
    ) -> Result<String, String> {
        self.write(stem, chart(title, Axis::linear(x), Axis::linear(y), series))
    }

    /// A chart with a logarithmic ordinate.
    pub fn log_y(
        &self,
        stem: &str,
        title: &str,
        x: &str,
        y: &str,
        series: Vec<Series>,
    ) -> Result<String, String> {
        self.write(stem, chart(title, Axis::linear(x), Axis::log(y), series))
    }

    /// A chart with logarithmic axes and a line of a slope below the curves.
    pub fn log_log(
        &self,
        stem: &str,
        title: &str,
        [x, y]: [&str; 2],
        series: Vec<Series>,
        slope: f64,
    ) -> Result<String, String> {
        let points = series.iter().flat_map(|series| &series.points);
        let lowest = points.min_by(|a, b| a.1.total_cmp(&b.1)).copied();
        let mut chart = chart(title, Axis::log(x), Axis::log(y), series);
        let guide =
            |(x, y): (f64, f64)| Guide { label: format!("order {slope}"), slope, through: (x, 0.5 * y) };
        chart.guides = lowest.map(guide).into_iter().collect();
        self.write(stem, chart)
    }

    fn write(&self, stem: &str, chart: Chart) -> Result<String, String> {
        chart.write(&self.folder.join(stem)).map_err(|error| format!("{stem}: {error}"))?;
        Ok(format!("{stem}.svg"))
    }
}

fn chart(title: &str, x: Axis, y: Axis, series: Vec<Series>) -> Chart {
    let drawn = series.into_iter().enumerate();
    let drawn = drawn.map(|(colour, series)| Drawn {
        label: series.label,
        points: series.points,
        style: series.style,
        colour,
    });
    Chart { title: title.into(), x, y, series: drawn.collect(), guides: Vec::new() }
}
