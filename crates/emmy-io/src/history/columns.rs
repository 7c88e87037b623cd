//! The columns of a history, each described once.

use emmy::motion::{Record, View};

use super::Number::{self, Real, Whole};
use super::measures::{Extreme, Measures};
use crate::input::Problem;

/// The numbers of a row.
struct Step<'a> {
    record: &'a Record,
    /// Duration of the run so far.
    wall_seconds: f64,
}

/// A column: its name, the number of a step in it, and which histories have it.
struct Column {
    name: &'static str,
    number: fn(&Step<'_>) -> Number,
    is_in: fn(&HistoryColumns) -> bool,
}

/// Number of the first columns, which every history has.
const N_REQUIRED: usize = 19;

/// The columns of the whole body, in their order in the file.
const COLUMNS: [Column; 22] = [
    always("step", |step| Whole(step.record.step)),
    always("time", |step| Real(step.record.time)),
    always("step_size", |step| Real(step.record.step_size)),
    always("kinetic_energy", |step| Real(step.record.kinetic_energy)),
    always("strain_energy", |step| Real(step.record.strain_energy)),
    always("external_work", |step| Real(step.record.external_work)),
    always("total_energy", |step| Real(step.record.total_energy)),
    always("energy_residual", |step| Real(step.record.energy_residual)),
    always("linear_momentum_x", |step| Real(step.record.linear_momentum[0])),
    always("linear_momentum_y", |step| Real(step.record.linear_momentum[1])),
    always("linear_momentum_z", |step| Real(step.record.linear_momentum[2])),
    always("angular_momentum_x", |step| Real(step.record.angular_momentum[0])),
    always("angular_momentum_y", |step| Real(step.record.angular_momentum[1])),
    always("angular_momentum_z", |step| Real(step.record.angular_momentum[2])),
    always("linear_momentum_residual", |step| Real(step.record.linear_momentum_residual)),
    always("angular_momentum_residual", |step| Real(step.record.angular_momentum_residual)),
    always("newton_iterations", |step| Whole(step.record.newton_iterations)),
    always("wall_seconds", |step| Real(step.wall_seconds)),
    always("smallest_determinant", |step| Real(step.record.smallest_determinant)),
    Column {
        name: "local_error",
        number: |step| Real(step.record.local_error),
        is_in: |own| own.is_adaptive,
    },
    Column {
        name: "dissipated_energy",
        number: |step| Real(step.record.dissipated_energy),
        is_in: |own| own.dissipates,
    },
    Column { name: "degree", number: |step| Whole(step.record.degree), is_in: |own| own.has_degrees },
];

const fn always(name: &'static str, number: fn(&Step<'_>) -> Number) -> Column {
    Column { name, number, is_in: |_| true }
}

/// Names of the columns that every history has.
pub fn required() -> impl Iterator<Item = &'static str> {
    COLUMNS[..N_REQUIRED].iter().map(|column| column.name)
}

/// Names of all columns of the whole body, also of those that a history may not have.
pub(crate) fn fixed_names() -> impl Iterator<Item = &'static str> {
    COLUMNS.iter().map(|column| column.name)
}

/// A row of a history.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// A number for each column.
    pub numbers: Vec<Number>,
    /// The largest values, with their places, of [`crate::input::Quantities::extremes`].
    pub extremes: Vec<Extreme>,
}

/// The columns of a history.
#[derive(Debug, Default)]
pub struct HistoryColumns {
    /// Whether step sizes are adaptive: column `local_error`.
    pub is_adaptive: bool,
    /// Whether viscosity, drag or the scheme dissipate energy: column `dissipated_energy`.
    pub dissipates: bool,
    /// Whether degrees are adaptive: column `degree`.
    pub has_degrees: bool,
    /// Reactions, probes, extremes, values of groups.
    measures: Measures,
}

impl HistoryColumns {
    /// The columns of a problem.
    pub fn of(problem: &Problem) -> Self {
        let Problem { body, scheme, .. } = problem;
        let adaptivity = problem.plan.adaptivity();
        HistoryColumns {
            dissipates: body.is_viscous() || body.drag() > 0.0 || scheme.dissipation().is_some(),
            is_adaptive: adaptivity.is_some(),
            has_degrees: adaptivity.is_some_and(|adaptivity| adaptivity.degrees.is_some()),
            measures: Measures::new(body, &problem.quantities),
        }
    }

    /// Whether there is a column of the largest value of a field.
    pub(crate) fn has_extreme(&self, field: &str) -> bool {
        self.measures.has_extreme(field)
    }

    /// Names of all columns.
    pub fn names(&self) -> Vec<String> {
        let own = COLUMNS.iter().filter(|column| (column.is_in)(self)).map(|column| column.name.to_string());
        own.chain(self.measures.columns()).collect()
    }

    /// The row of a step, in the order of [`HistoryColumns::names`]; `wall_seconds`: duration of the run so far.
    pub fn row(&self, view: View<'_>, wall_seconds: f64) -> Row {
        let mut numbers = self.numbers(view.record, wall_seconds);
        let extremes = self.measures.add_to(view, &mut numbers);
        Row { numbers, extremes }
    }

    /// The numbers of a step for the whole body.
    pub(super) fn numbers(&self, record: &Record, wall_seconds: f64) -> Vec<Number> {
        let step = Step { record, wall_seconds };
        COLUMNS.iter().filter(|column| (column.is_in)(self)).map(|column| (column.number)(&step)).collect()
    }
}
