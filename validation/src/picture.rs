//! Pictures of the items, through the charts and drawings of `emmy_io`.

use std::path::PathBuf;

use emmy::mesh::Mesh;
use emmy_io::chart::{Axis, Chart, Figure, Guide, Series as Drawn, Style};
use emmy_io::drawing::{Arrangement, Configuration, Drawing, Viewpoint};

use crate::case::Run;

/// A named curve.
pub(crate) struct Series {
    label: String,
    points: Vec<(f64, f64)>,
    style: Style,
}

impl Series {
    /// A line.
    pub(crate) fn line(label: &str, points: Vec<(f64, f64)>) -> Self {
        Series { label: label.into(), points, style: Style::Line }
    }

    /// A line with its points marked.
    pub(crate) fn marked(label: &str, points: Vec<(f64, f64)>) -> Self {
        Series { label: label.into(), points, style: Style::LineAndPoints }
    }
}

/// Where pictures are written. Every method returns the name of the file.
pub(crate) struct Pictures {
    /// The folder.
    pub folder: PathBuf,
}

impl Pictures {
    /// A chart with linear axes.
    pub(crate) fn linear(
        &self,
        stem: &str,
        title: &str,
        [x, y]: [&str; 2],
        series: Vec<Series>,
    ) -> Result<String, String> {
        self.write(stem, chart(title, Axis::linear(x), Axis::linear(y), series))
    }

    /// A chart with a logarithmic ordinate.
    pub(crate) fn log_y(
        &self,
        stem: &str,
        title: &str,
        [x, y]: [&str; 2],
        series: Vec<Series>,
    ) -> Result<String, String> {
        self.write(stem, chart(title, Axis::linear(x), Axis::log(y), series))
    }

    /// A chart with logarithmic axes and lines of some slopes through points.
    pub(crate) fn log_log(
        &self,
        stem: &str,
        title: &str,
        [x, y]: [String; 2],
        series: Vec<Series>,
        guides: Vec<(f64, (f64, f64))>,
    ) -> Result<String, String> {
        let mut chart = chart(title, Axis::log(x), Axis::log(y), series);
        let guide = |(slope, through)| Guide { label: format!("order {slope}"), slope, through };
        chart.guides = guides.into_iter().map(guide).collect();
        self.write(stem, chart)
    }

    /// The configurations of a run at some times, side by side.
    pub(crate) fn configurations(
        &self,
        stem: &str,
        mesh: &Mesh,
        run: &Run,
        times: &[f64],
    ) -> Result<String, String> {
        let configuration = |&time: &f64| {
            let index = run.records.partition_point(|record| record.time < time - 1e-9);
            let positions = run.positions.get(index).cloned().unwrap_or_default();
            Configuration { label: format!("t = {time}"), positions }
        };
        let drawing = Drawing {
            mesh,
            configurations: times.iter().map(configuration).collect(),
            arrangement: Arrangement::Beside(times.len().min(5)),
            view: Viewpoint::default(),
            below: Figure::default(),
        };
        drawing.write(&self.folder.join(stem)).map_err(|error| format!("{stem}: {error}"))?;
        Ok(format!("{stem}.svg"))
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
