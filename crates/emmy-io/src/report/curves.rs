//! Charts over the frequency, in place of a run.

use std::path::Path;

use serde_json::{Value, json};

use super::run::{RunData, name_of, shortened};
use crate::chart::{Axis, Chart, Figure, Scale, Series};

/// Spectra or a harmonic response for a page.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Curves<'a> {
    /// Heading of the page.
    pub(crate) heading: &'a str,
    /// The settings from which they follow.
    pub(crate) caption: &'a str,
    /// The charts, whose series have the abscissae of the first one.
    pub(crate) figure: &'a Figure,
    /// The input, if it is part of the page.
    pub(crate) input: Option<&'a str>,
    /// Files of the directory to which the page links.
    pub(crate) files: &'a [&'a str],
}

/// Gathers the charts for the page of a directory.
pub(super) fn gather(directory: &Path, curves: &Curves<'_>) -> RunData {
    let first = curves.figure.charts.first();
    let points = first.and_then(|chart| chart.series.first()).map_or(&[][..], |series| &series.points);
    let name = name_of(directory);
    let manifest = json!({
        "name": name,
        "href": "",
        "title": curves.heading,
        "caption": curves.caption,
        "input": curves.input.map(|input| shortened(input.to_string())),
        "files": curves.files,
        "abscissa": first.map(|chart| axis(&chart.x)),
        "frequencies": points.iter().map(|(x, _)| x).collect::<Vec<_>>(),
        "curves": curves.figure.charts.iter().map(chart).collect::<Vec<_>>(),
    });
    RunData { name, manifest, arrays: String::new() }
}

fn axis(axis: &Axis) -> Value {
    json!({ "label": axis.label, "log": axis.scale == Scale::Log })
}

/// A chart; numbers that are not finite are null.
fn chart(chart: &Chart) -> Value {
    let line = |series: &Series| {
        let values: Vec<f64> = series.points.iter().map(|(_, y)| *y).collect();
        json!({ "label": series.label, "values": values })
    };
    json!({ "axis": axis(&chart.y), "lines": chart.series.iter().map(line).collect::<Vec<_>>() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_and_numbers_are_those_of_the_charts() {
        let series =
            Series { label: "tip".into(), points: vec![(1.0, 0.5), (2.0, f64::NAN)], ..Series::default() };
        let (x, y) = (Axis::linear("f [Hz]"), Axis::log("amplitude [m]"));
        let figure =
            Figure { charts: vec![Chart { x, y, series: vec![series], ..Chart::default() }], columns: 1 };
        let curves = Curves { heading: "h", caption: "c", figure: &figure, input: None, files: &["a.csv"] };
        let page = gather(Path::new("."), &curves).manifest;
        assert_eq!(page["frequencies"], json!([1.0, 2.0]));
        assert_eq!(page["abscissa"], json!({ "label": "f [Hz]", "log": false }));
        let line = json!({ "label": "tip", "values": [0.5, null] });
        assert_eq!(
            page["curves"][0],
            json!({ "axis": { "label": "amplitude [m]", "log": true }, "lines": [line] })
        );
    }
}
