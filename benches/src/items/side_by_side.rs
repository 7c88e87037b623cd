//! Motions of Emmy, DOLFINx and CalculiX side by side, the others measured in the same session or recorded.

use super::Settings;
use crate::job::Job;
use crate::machine::times_faster;
use crate::outcome::Outcome;
use crate::peers::Recorded;
use crate::report::{Goal, Limit, Table, number, number_or_dash};
use crate::scratch::Scratch;
use crate::session::{Runs, step_seconds};
use crate::work::{CALCULIX, Work};

/// Relative tolerances for the energies of DOLFINx and of CalculiX, which prints seven digits, over the total energy.
const AGREEMENT: [f64; 2] = [1e-8, 1e-6];
/// The scheme of DOLFINx.
const SCHEME: &str = "FE(1)";
/// The motions of the other programs.
pub(super) const OTHERS: &str = "DOLFINx with the same cells, points and mid-point rule, which is FE(1), with energies \
    equal to 1e-8. CalculiX with St. Venant-Kirchhoff material and the trapezoidal rule, with energies equal to those \
    of Newmark(0.25,0.5) to 1e-6; not with blocks of tet10 and the soft bracket, where its mass is another, nor with \
    the stiff block of hex20, where it diverges. -: not run. An asterisk marks recorded figures.";

/// A time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Figure {
    /// Of a step, without the first two.
    Step,
    /// Of the whole run with its start.
    WithStart,
}

impl Figure {
    /// CPU seconds.
    pub(super) fn of(self, outcome: &Outcome) -> f64 {
        match self {
            Figure::Step => step_seconds(outcome),
            Figure::WithStart => outcome.cpu_seconds_with_start.unwrap_or(f64::NAN),
        }
    }
}

/// The runs.
#[derive(Debug)]
pub(super) struct SideBySide {
    schemes: Vec<&'static str>,
    rows: Vec<Row>,
}

#[derive(Debug)]
struct Row {
    work: Work,
    emmy: Vec<Runs>,
    /// Emmy with the equations of CalculiX.
    like_calculix: Option<Runs>,
    others: Vec<(&'static str, Seconds)>,
}

/// Times of another program or solver: of a step, of the whole run.
#[derive(Debug)]
enum Seconds {
    Measured(Runs),
    Recorded([f64; 2]),
}

impl SideBySide {
    /// Runs every motion by every scheme of Emmy and, if it should, every solver of DOLFINx, and CalculiX.
    ///
    /// # Errors
    /// The message of the first run that fails, or if the energies of two programs differ.
    pub(super) fn measure(
        settings: &Settings,
        works: &[Work],
        schemes: &[&'static str],
    ) -> Result<Self, String> {
        let scratch = Scratch::new("side-by-side")?;
        let recorded = Recorded::read()?.side_by_side;
        let python = |name| settings.peers.as_ref().and_then(|pythons| pythons.of(name));
        let pythons = [python("dolfinx"), python(CALCULIX)];
        let mut rows = Vec::new();
        for &work in works {
            let case = work.case(&scratch)?;
            let cases = schemes.iter().map(|scheme| Job::case(&case.clone().scheme(scheme, 1)));
            let mut jobs = cases.collect::<Result<Vec<_>, _>>()?;
            let solvers = work.solvers();
            let job = |solver: &&'static str| {
                let python = pythons[usize::from(*solver == CALCULIX)].as_ref()?;
                Some((*solver, work.job(python, solver)))
            };
            let (installed, others): (Vec<_>, Vec<_>) = solvers.iter().filter_map(job).unzip();
            jobs.extend(others);
            if installed.contains(&CALCULIX) {
                jobs.push(Job::case(&work.like_calculix(&scratch)?)?);
            }
            let mut emmy = settings.session.in_turns(&jobs)?;
            let measured = emmy.split_off(schemes.len());
            let known = recorded.get(&work.to_string());
            let seconds = |solver: &'static str| {
                let index = installed.iter().position(|name| *name == solver);
                let recorded = || Some(Seconds::Recorded(*known?.get(solver)?));
                let seconds = index.map(|index| Seconds::Measured(measured[index].clone()));
                Some((solver, seconds.or_else(recorded)?))
            };
            let others = solvers.iter().copied().filter_map(seconds).collect();
            let row = Row { work, emmy, like_calculix: measured.get(installed.len()).cloned(), others };
            if let Some(scheme) = schemes.iter().position(|scheme| *scheme == SCHEME) {
                row.check_energies(scheme)?;
            }
            rows.push(row);
        }
        Ok(SideBySide { schemes: schemes.to_vec(), rows })
    }

    /// The table of a time; an asterisk marks recorded numbers.
    pub(super) fn table(&self, figure: Figure) -> Table {
        let mut solvers: Vec<&str> = Vec::new();
        for (solver, _) in self.rows.iter().flat_map(|row| &row.others) {
            if !solvers.contains(solver) {
                solvers.push(solver);
            }
        }
        let ratios = self.schemes.iter().map(|scheme| format!("best / {scheme}"));
        let heading = ["motion".to_string()].into_iter().chain(self.schemes.iter().map(|s| s.to_string()));
        let heading = heading.chain(solvers.iter().map(|solver| solver.to_string()));
        let ratios = ratios.filter(|_| !solvers.is_empty());
        let mut table = Table::with_heading(1, heading.chain(ratios).collect());
        for row in &self.rows {
            let mut words = vec![row.work.to_string()];
            words.extend(row.emmy.iter().map(|runs| number(runs.median(|o| figure.of(o)))));
            words.extend(solvers.iter().map(|solver| row.seconds(solver, figure)));
            if !solvers.is_empty() {
                let ratios = (0..self.schemes.len()).map(|scheme| row.ratio(scheme, figure));
                words.extend(ratios.map(number_or_dash));
            }
            table.push(words);
        }
        table
    }

    /// The runs of a scheme, one for each motion.
    pub(super) fn of(&self, scheme: &str) -> Vec<Runs> {
        let index = self.schemes.iter().position(|name| *name == scheme);
        self.rows.iter().filter_map(|row| row.emmy.get(index?).cloned()).collect()
    }

    /// A goal for each chosen motion with figures of others: the fastest of them over a scheme of Emmy.
    pub(super) fn goals(&self, scheme: &str, figure: Figure, chosen: impl Fn(&Work) -> bool) -> Vec<Goal> {
        let Some(index) = self.schemes.iter().position(|name| *name == scheme) else { return Vec::new() };
        let what = match figure {
            Figure::Step => "a step",
            Figure::WithStart => "all steps with the start",
        };
        let goal = |row: &Row| {
            let statement = format!("{}: {what} of the fastest of the others over {scheme}", row.work);
            Some(Goal::new(statement, Limit::AtLeast(times_faster()), row.ratio(index, figure)?))
        };
        self.rows.iter().filter(|row| chosen(&row.work)).filter_map(goal).collect()
    }
}

impl Row {
    /// An error if energies of DOLFINx are not those of a scheme, or those of CalculiX not those of its equations.
    fn check_energies(&self, scheme: usize) -> Result<(), String> {
        for (solver, seconds) in &self.others {
            let Seconds::Measured(runs) = seconds else { continue };
            let is_calculix = *solver == CALCULIX;
            let emmy = if is_calculix { self.like_calculix.as_ref() } else { self.emmy.get(scheme) };
            let difference = emmy.map_or(f64::NAN, |emmy| difference(emmy.last(), runs.last()));
            if difference.is_nan() || difference > AGREEMENT[usize::from(is_calculix)] {
                let message = format!("the energies differ from those of {solver} by");
                return Err(format!("{}: {message} {difference:.1e} of the total energy", self.work));
            }
        }
        Ok(())
    }

    fn seconds(&self, solver: &str, figure: Figure) -> String {
        match self.others.iter().find(|(name, _)| *name == solver) {
            Some((_, Seconds::Measured(runs))) => number(runs.median(|o| figure.of(o))),
            Some((_, Seconds::Recorded(seconds))) => number(seconds[figure as usize]) + "*",
            None => "-".into(),
        }
    }

    /// Time of the fastest of the others over that of a scheme.
    fn ratio(&self, scheme: usize, figure: Figure) -> Option<f64> {
        let emmy = &self.emmy[scheme];
        let ratio = |(_, seconds): &(_, Seconds)| match seconds {
            Seconds::Measured(runs) => runs.ratio(emmy, |o| figure.of(o)),
            Seconds::Recorded(seconds) => seconds[figure as usize] / emmy.median(|o| figure.of(o)),
        };
        self.others.iter().map(ratio).reduce(f64::min)
    }
}

/// Largest difference of kinetic and strain energy over the total energy of the second run.
fn difference(a: &Outcome, b: &Outcome) -> f64 {
    let [kinetic, strain] = [a.kinetic_energy - b.kinetic_energy, a.strain_energy - b.strain_energy];
    (kinetic.abs() + strain.abs()) / (b.kinetic_energy + b.strain_energy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_are_compared_over_their_sum() {
        let of =
            |kinetic_energy, strain_energy| Outcome { kinetic_energy, strain_energy, ..Outcome::default() };
        assert!((difference(&of(3.0, 1.0), &of(3.5, 0.5)) - 0.25).abs() < 1e-15);
        assert!(difference(&of(f64::NAN, 1.0), &of(3.0, 1.0)).is_nan());
    }
}
