//! The closing report of a run, on standard error.

use std::path::Path;

use emmy::body::FieldName;
use emmy::motion::{ContactStatistics, Extreme, RunStatistics, StepLimit};
use emmy_io::accuracy::Accuracy;
use emmy_io::history::Extreme as FieldExtreme;
use emmy_io::input::Problem;
use emmy_io::message::counted;
use emmy_io::results::Results;
use emmy_io::summary::{self, FEW_DIGITS, Status};

use crate::host::{Host, message};
use crate::print::number;

/// The end of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Closing<'a> {
    pub host: &'a dyn Host,
    pub problem: &'a Problem,
    pub results: &'a Results,
    /// Wall-clock time of the run, without the files that end it.
    pub seconds: f64,
    pub accuracy: Option<&'a Accuracy>,
}

impl Closing<'_> {
    /// Prints steps, solver, largest residuals and files of the run.
    pub(super) fn report(&self, status: Status, page: Option<&Path>) {
        let Closing { results, problem, .. } = *self;
        let statistics = results.statistics();
        message!(
            self.host,
            "{}: {} to {} in {:.2} s, {}",
            status.name(),
            match problem.is_static() {
                true => counted(statistics.steps, "increment", "increments"),
                false => counted(statistics.steps, "step", "steps"),
            },
            moment(problem, statistics.time),
            self.seconds,
            counted(statistics.newton_iterations, "correction", "corrections")
        );
        self.work(statistics);
        if problem.is_static() {
            self.resultants(statistics)
        } else {
            self.residuals(statistics)
        }
        self.contacts(statistics);
        if let Some(accuracy) = self.accuracy {
            message!(self.host, "accuracy in time: {}", accuracy.text);
        }
        self.largest();
        let directory = results.directory();
        let mut files = vec![directory.join("history.csv"), directory.join("summary.json")];
        files.extend(results.collection());
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        message!(self.host, "written: {}", files.join(", "));
        if let Some(page) = page {
            message!(self.host, "to look at: {}", page.display());
        }
    }

    /// Prints the largest displacement, and the largest values of other fields with those of the regions.
    fn largest(&self) {
        let Closing { results, problem, .. } = *self;
        let units = problem.units;
        let statistics = results.statistics();
        let (most, to) = match (statistics.largest_relative_displacement, &problem.quantities.relative_to) {
            (Some(most), Some(name)) => (most, format!(" relative to {name}")),
            _ => (statistics.largest_displacement, String::new()),
        };
        if most.value > 0.0 {
            let value = units.number(most.value, "length");
            let at = units.vector(most.point, "length");
            message!(
                self.host,
                "largest displacement{to}: {value} at {}, node {} at {at}",
                moment(problem, most.time),
                most.node
            );
        }
        let is_other = |own: &&FieldExtreme| own.field != FieldName::Displacement.name();
        let (of_body, of_regions): (Vec<&FieldExtreme>, Vec<&FieldExtreme>) =
            results.extremes().iter().filter(is_other).partition(|own| own.region.is_none());
        for extreme in of_body.into_iter().filter(|own| own.value != 0.0) {
            let name = extreme.field.replace('_', " ").replace("von mises", "von Mises");
            let of = if results.is_in_every_step(&extreme.field) { "" } else { " of the frames" };
            message!(self.host, "largest {name}{of}: {}", self.place(extreme));
            for row in of_regions.iter().filter(|own| own.field == extreme.field) {
                let region = row.region.as_deref().unwrap_or_default();
                message!(self.host, "  in {region}: {}", self.place(row));
            }
        }
    }

    /// A largest value with its time and place.
    fn place(&self, extreme: &FieldExtreme) -> String {
        let FieldExtreme { field, value, time, member, is_cell, point, .. } = extreme;
        let units = self.problem.units;
        let value = units.number(*value, FieldName::from_name(field).map_or("", FieldName::dimension));
        let time = moment(self.problem, *time);
        let kind = if *is_cell { "cell" } else { "node" };
        format!("{value} at {time}, {kind} {member} at {}", units.vector(*point, "length"))
    }

    fn work(&self, statistics: &RunStatistics) {
        if let Some(solver) = statistics.solver {
            message!(
                self.host,
                "linear solver: {solver}; stiffness refactored {}, exact tangent used in {}",
                counted(statistics.refactorizations, "time", "times"),
                counted(statistics.steps_with_exact_tangent, "step", "steps")
            );
        }
        if statistics.rejections > 0 {
            message!(
                self.host,
                "rejected because of their error: {}",
                counted(statistics.rejections, "step", "steps")
            );
        }
        if let Some(limits) = limits(statistics) {
            message!(self.host, "step size limited by: {limits}");
        }
        let digits = statistics.digits_left();
        if statistics.steps_at_rounding_floor > 0 && digits >= FEW_DIGITS {
            message!(self.host, "digits left after rounding: {digits:.1}, which is harmless");
        }
    }

    fn residuals(&self, statistics: &RunStatistics) {
        let units = self.problem.units;
        let part = |extreme: Extreme, whole: f64| if whole > 0.0 { extreme.value / whole } else { 0.0 };
        let energy = statistics.worst_energy_residual;
        let angular_momentum = statistics.worst_angular_momentum_residual;
        let residual = |name: &str, worst: Extreme, dimension: &str, relative: Option<(f64, &str)>| {
            let relative =
                relative.map_or(String::new(), |(part, of)| format!(", {part:.1e} of the largest {of}"));
            let value = units.with_unit(format!("{:.2e}", worst.value), dimension);
            message!(self.host, "  {name:<17}{value} (step {}{relative})", worst.step);
        };
        message!(self.host, "worst balance of a step:");
        let (size, of) = statistics.energy_size();
        residual("energy", energy, "energy", Some((part(energy, size), of)));
        residual("linear momentum", statistics.worst_linear_momentum_residual, "mass·length/time", None);
        let (size, of) = statistics.angular_momentum_size();
        let relative = Some((part(angular_momentum, size), of));
        residual("angular momentum", angular_momentum, "mass·length²/time", relative);
        self.constraints();
    }

    /// The smallest gap, and the force and the times of each contact.
    fn contacts(&self, statistics: &RunStatistics) {
        let Closing { problem, .. } = *self;
        let units = problem.units;
        let Some(energy) = statistics.largest_contact_energy else { return };
        let what = if problem.is_static() { "increment" } else { "step" };
        let gap = statistics.smallest_gap.map_or("nothing was near".to_string(), |gap| {
            format!("smallest gap {:.3} of the thickness of the layer ({what} {})", gap.value, gap.step)
        });
        message!(self.host, "contact: {gap}, largest energy {}", units.number(energy, "energy"));
        for own in &statistics.contacts {
            let ContactStatistics { name, largest_force, largest_force_time, first_time, last_time, .. } =
                own;
            let [at, first, last] = [largest_force_time, first_time, last_time]
                .map(|time| time.map_or(String::new(), |time| moment(problem, time)));
            let lasts = match problem.is_static() {
                true => String::new(),
                false => format!(", in contact for {}", units.number(own.duration, "time")),
            };
            let contacts = counted(own.intervals, "contact", "contacts");
            match largest_force {
                Some(force) => message!(
                    self.host,
                    "  {name}: largest force {} at {at}; {contacts} from {first} to {last}{lasts}",
                    units.number(*force, "force")
                ),
                None => message!(self.host, "  {name}: no force"),
            }
        }
    }

    /// How well the constraints of joints and rigid bodies were kept.
    fn constraints(&self) {
        if let Some(worst) = self.results.worst_constraint() {
            message!(
                self.host,
                "worst constraint:  {:.2e} of the size of the mechanism, at {}; rounding up to {:.1e}",
                worst.largest,
                moment(self.problem, worst.largest_time),
                self.results.statistics().constraint_rounding.unwrap_or(0.0)
            );
        }
    }

    /// Resultant and moment of all forces, which vanish in equilibrium.
    fn resultants(&self, statistics: &RunStatistics) {
        let units = self.problem.units;
        let text = |value: f64, dimension: &str| units.with_unit(format!("{value:.2e}"), dimension);
        let Extreme { value, step } = statistics.worst_linear_momentum_residual;
        message!(self.host, "largest resultant of all forces: {} (increment {step})", text(value, "force"));
        let Extreme { value, step } = statistics.worst_angular_momentum_residual;
        message!(
            self.host,
            "largest moment of all forces:    {} (increment {step})",
            text(value, "force·length")
        );
    }

    /// Prints warnings and notes about the results.
    pub(super) fn warnings(&self) {
        for warning in summary::warnings(self.results.statistics()) {
            message!(self.host, "warning: {warning}");
        }
        if let Some(note) = self.accuracy.and_then(|accuracy| accuracy.note.as_ref()) {
            self.host.statement(&format!("note: {note}"));
        }
        if !self.problem.is_static() {
            for note in summary::notes(self.results.statistics(), &self.problem.body) {
                self.host.statement(&format!("note: {note}"));
            }
        }
    }
}

/// The limits of adaptive step sizes, with the share of the steps; `None` without such steps.
fn limits(statistics: &RunStatistics) -> Option<String> {
    let words = |limit: StepLimit| match limit {
        StepLimit::Start => "growth from the first size",
        StepLimit::Kink => "kinks of a load or a support",
        StepLimit::Load => "smooth loads or supports",
        StepLimit::Output => "output times",
        StepLimit::Phase => "ends of phases",
        limit => limit.name(),
    };
    let steps: usize = statistics.step_limits.counts().map(|(_, count)| count).sum();
    let share = |(limit, count): (StepLimit, usize)| {
        format!("{} {:.0} %", words(limit), 100.0 * count as f64 / steps as f64)
    };
    let shares: Vec<String> = statistics.step_limits.counts().map(share).collect();
    (steps > 0).then(|| shares.join(", "))
}

/// A time, or the load fraction of a static analysis.
fn moment(problem: &Problem, time: f64) -> String {
    match problem.is_static() {
        true => format!("load fraction {}", number(time)),
        false => format!("t = {}", problem.units.number(time, "time")),
    }
}
