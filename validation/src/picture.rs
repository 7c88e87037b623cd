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

    /// Points without a line.
    pub(crate) fn points(label: &str, points: Vec<(f64, f64)>) -> Self {
        Series { label: label.into(), points, style: Style::Points }
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
    let colours = colours(&series);
    let drawn = series.into_iter().zip(colours).enumerate().map(|(place, (series, colour))| Drawn {
        colour,
        label: series.label,
        points: series.points,
        style: if series.style == Style::Line { Style::of_line(place, y.scale) } else { series.style },
    });
    Chart { title: title.into(), series: drawn.collect(), x, y, guides: Vec::new() }
}

/// Families of schemes, in the order of their colours.
const SCHEMES: [&str; 8] =
    ["DGM", "AS(", "Newmark", "FE(", "HHT", "generalized-alpha", "Bathe", "central-differences"];

/// Colours of curves: a scheme has the same one in all pictures. Further ones of its family in the same picture take
/// colours that are left.
fn colours(series: &[Series]) -> Vec<usize> {
    let family = |series: &Series| {
        let label = series.label.strip_prefix("Emmy, ").unwrap_or(&series.label);
        SCHEMES.iter().position(|name| label.starts_with(name))
    };
    let families: Vec<Option<usize>> = series.iter().map(family).collect();
    if families.iter().all(Option::is_none) {
        return (0..series.len()).collect();
    }
    let mut left = (0..SCHEMES.len()).rev().filter(|colour| !families.contains(&Some(*colour))).cycle();
    let own = |(place, family): (usize, &Option<usize>)| match family {
        Some(colour) if !families[..place].contains(family) => *colour,
        _ => left.next().unwrap_or(place),
    };
    families.iter().enumerate().map(own).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schemes_keep_their_colours() {
        let of = |labels: &[&str]| {
            colours(&labels.iter().map(|label| Series::line(label, vec![])).collect::<Vec<_>>())
        };
        assert_eq!(of(&["Bathe", "AS(5)", "Emmy, DGM"]), [6, 1, 0]);
        assert_eq!(of(&["FE(1)", "DGM", "FE(5)", "DGM, k = 2"]), [3, 0, 7, 6]);
        assert_eq!(of(&["x", "y"]), [0, 1]);
    }
}
