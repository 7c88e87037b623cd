//! Errors of schemes over step sizes, from a shared state, against one reference.

use std::path::Path;

use emmy::motion::Samples;
use emmy::time::Scheme;
use emmy_io::convergence::kept::{self, Found, Key};
use emmy_io::convergence::{self, MemberRun, Study};
use emmy_io::input::Problem;

use super::Effort;
use crate::case::Case;
use crate::claim::Item;
use crate::measure::order;
use crate::picture::{Pictures, Series};

/// One curve: a scheme of a degree.
pub(super) struct Member {
    /// Scheme.
    pub scheme: &'static str,
    /// Degree.
    pub degree: usize,
    /// Step sizes, the largest first.
    pub sizes: Vec<f64>,
}

impl Member {
    /// A scheme of degree 1.
    pub(super) fn new(scheme: &'static str, sizes: &[f64]) -> Self {
        Member { scheme, degree: 1, sizes: sizes.to_vec() }
    }
}

/// Reference of the errors: scheme, degree, step size.
pub(super) struct Reference(pub &'static str, pub usize, pub f64);

/// Rows of every curve.
pub(super) struct Curves {
    window: (f64, f64),
    reference: String,
    curves: Vec<(Member, Vec<MemberRun>)>,
}

/// Runs all members from the state of the case at the window's start.
///
/// # Errors
/// The message of a start, a reference or a member that fails.
pub(super) fn study(
    case: &Case,
    window: (f64, f64),
    reference: &Reference,
    members: Vec<Member>,
    folder: &Path,
) -> Result<Curves, String> {
    let problem = case.problem()?;
    let start = convergence::start(&problem, window.0, &mut []).map_err(|error| error.to_string())?;
    let study = |member: &Member| -> Result<Study, String> {
        let scheme = |text: &str, degree| {
            let scheme = Scheme::from_name(text).and_then(|scheme| scheme.with_degree(degree));
            scheme.map_err(|error| error.to_string())
        };
        let Reference(reference, reference_degree, reference_size) = *reference;
        Ok(Study {
            scheme: scheme(member.scheme, member.degree)?,
            from: window.0,
            window,
            sizes: member.sizes.clone(),
            reference_scheme: scheme(reference, reference_degree)?,
            reference_size,
            releases: Vec::new(),
            units: emmy_io::units::Units::default(),
        })
    };
    let studies = members.iter().map(study).collect::<Result<Vec<Study>, String>>()?;
    let mut all = studies[0].clone();
    all.sizes = studies.iter().flat_map(|study| study.sizes.iter().copied()).collect();
    let samples = samples(&problem, &all, &start, folder)?;
    let rows = |study| convergence::members(&problem, study, &start, &samples, |_| ());
    let curves = members.into_iter().zip(studies.iter().map(rows)).collect();
    let Reference(scheme, degree, size) = reference;
    Ok(Curves { window, reference: format!("{}, h = {size}", label(scheme, *degree)), curves })
}

/// The paper's studies: free flight on 1 < t < 2, all schemes with the same steps.
///
/// # Errors
/// As [`study`].
pub(super) fn of_the_paper(
    file: &'static str,
    schemes: &[&'static str],
    effort: Effort,
    pictures: &Pictures,
) -> Result<Curves, String> {
    let members = schemes.iter().map(|scheme| Member::new(scheme, effort.sizes())).collect();
    study(&Case::new(file), (1.0, 2.0), &effort.reference(), members, &pictures.folder)
}

/// The reference: kept in the folder, or else computed and kept.
fn samples(
    problem: &Problem,
    study: &Study,
    start: &emmy::motion::State,
    folder: &Path,
) -> Result<Samples, String> {
    let times = study.sample_times().map_err(|error| error.to_string())?;
    let key = Key::new(problem, study, start).map_err(|error| error.to_string())?;
    if let Found::Samples(samples) = kept::find(folder, &key, &times, study.tolerance()) {
        return Ok(samples);
    }
    let samples = convergence::reference(problem, study, start, &times, &mut Nobody);
    let samples = samples.map_err(|error| format!("the reference: {error}"))?;
    kept::keep(folder, &key, &samples).map_err(|error| error.to_string())?;
    Ok(samples)
}

/// An observer that does nothing.
struct Nobody;

impl emmy::motion::Observer for Nobody {
    fn observe(&mut self, _: emmy::motion::View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        Ok(())
    }
}

/// Name of a scheme of a degree.
fn label(scheme: &str, degree: usize) -> String {
    if degree == 1 { scheme.to_string() } else { format!("{scheme}, k = {degree}") }
}

impl Curves {
    /// (step size, error) of the completed runs of a curve.
    pub(super) fn errors(&self, scheme: &str, degree: usize) -> Vec<(f64, f64)> {
        self.rows(scheme, degree).iter().filter_map(|row| Some((row.step_size, row.error()?))).collect()
    }

    /// Error at one of the step sizes; NaN if that run failed.
    pub(super) fn error(&self, scheme: &str, degree: usize, size: f64) -> f64 {
        let errors = self.errors(scheme, degree);
        errors.iter().find(|point| point.0 == size).map_or(f64::NAN, |point| point.1)
    }

    /// (seconds, error) of the same.
    pub(super) fn costs(&self, scheme: &str, degree: usize) -> Vec<(f64, f64)> {
        self.rows(scheme, degree).iter().filter_map(|row| Some((row.wall_seconds, row.error()?))).collect()
    }

    fn rows(&self, scheme: &str, degree: usize) -> &[MemberRun] {
        let is_it = |member: &Member| member.scheme == scheme && member.degree == degree;
        self.curves.iter().find(|(member, _)| is_it(member)).map_or(&[], |(_, rows)| rows)
    }

    /// Order between the two smallest steps; NaN if there are not two.
    pub(super) fn order(&self, scheme: &str, degree: usize) -> f64 {
        match self.errors(scheme, degree)[..] {
            [.., coarse, fine] => order(coarse, fine),
            _ => f64::NAN,
        }
    }

    /// Error at the smallest step; NaN if there is none.
    pub(super) fn last(&self, scheme: &str) -> f64 {
        self.errors(scheme, 1).last().map_or(f64::NAN, |(_, error)| *error)
    }

    /// Adds the table of errors, and a picture of them over the step size, with lines of some slopes below curves.
    ///
    /// # Errors
    /// The message of a picture that cannot be written.
    pub(super) fn show_errors(
        &self,
        item: &mut Item,
        pictures: &Pictures,
        title: &str,
        guides: &[(i32, &str, usize)],
    ) -> Result<(), String> {
        item.tables.push(self.table());
        let axes = ["step size h".to_string(), self.error_label()];
        let series = self.series(|row| row.step_size);
        let guide = |&(slope, scheme, degree): &(i32, &str, usize)| {
            let below = self.errors(scheme, degree).last().map(|&(size, error)| (size, 0.5 * error));
            below.map(|through| (f64::from(slope), through))
        };
        let guides = guides.iter().filter_map(guide).collect();
        item.pictures.push(pictures.log_log(&format!("{}-error", item.name), title, axes, series, guides)?);
        Ok(())
    }

    /// Adds a picture of the errors over the time of the runs.
    ///
    /// # Errors
    /// The message of a picture that cannot be written.
    pub(super) fn show_costs(&self, item: &mut Item, pictures: &Pictures, title: &str) -> Result<(), String> {
        let axes = ["seconds of a run on one core".to_string(), self.error_label()];
        let series = self.series(|row| row.wall_seconds);
        item.pictures.push(pictures.log_log(&format!("{}-cost", item.name), title, axes, series, vec![])?);
        Ok(())
    }

    fn error_label(&self) -> String {
        let (from, to) = self.window;
        format!("error (80) on {from} < t < {to}; reference: {}", self.reference)
    }

    fn series(&self, x: impl Fn(&MemberRun) -> f64) -> Vec<Series> {
        let point = |row: &MemberRun| Some((x(row), row.error()?));
        let curve = |(member, rows): &(Member, Vec<MemberRun>)| {
            Series::marked(&label(member.scheme, member.degree), rows.iter().filter_map(point).collect())
        };
        self.curves.iter().map(curve).collect()
    }

    /// Errors: a row per step size, a column per curve.
    fn table(&self) -> Vec<Vec<String>> {
        let mut sizes: Vec<f64> = self.curves.iter().flat_map(|(member, _)| member.sizes.clone()).collect();
        sizes.sort_by(|a, b| b.total_cmp(a));
        sizes.dedup();
        let names = self.curves.iter().map(|(member, _)| label(member.scheme, member.degree));
        let cell = |rows: &[MemberRun], size: f64| match rows.iter().find(|row| row.step_size == size) {
            None => String::new(),
            Some(row) => row.error().map_or("no convergence".into(), |error| format!("{error:.3e}")),
        };
        let line = |size: f64| {
            let cells = self.curves.iter().map(|(_, rows)| cell(rows, size));
            std::iter::once(size.to_string()).chain(cells).collect()
        };
        let header = std::iter::once("h".to_string()).chain(names).collect();
        std::iter::once(header).chain(sizes.iter().map(|&size| line(size))).collect()
    }
}

/// Smallest error of a curve (cost, error) at a cost or below, interpolated in logarithms; `None` if all points cost
/// more.
pub(super) fn error_within(curve: &[(f64, f64)], cost: f64) -> Option<f64> {
    let mut points = curve.to_vec();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let between = points.windows(2).find(|pair| pair[0].0 <= cost && cost <= pair[1].0).map(|pair| {
        let part = (cost / pair[0].0).ln() / (pair[1].0 / pair[0].0).ln();
        (pair[0].1.ln() + part * (pair[1].1 / pair[0].1).ln()).exp()
    });
    let cheaper = points.iter().filter(|point| point.0 <= cost).map(|point| point.1);
    cheaper.chain(between).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::error_within;

    #[test]
    fn errors_between_points_follow_the_power_law() {
        // error = cost^-2
        let curve = [(4.0, 1.0 / 16.0), (1.0, 1.0)];
        assert!((error_within(&curve, 2.0).unwrap() - 0.25).abs() < 1e-15);
        assert_eq!((error_within(&curve, 0.5), error_within(&curve, 5.0)), (None, Some(1.0 / 16.0)));
    }
}
