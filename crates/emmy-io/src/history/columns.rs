//! The columns of a history, each described once.

use emmy::motion::{Record, View};
use serde_json::{Value, json};

use super::Number::{self, Limit, Missing, Real, Whole};
use super::measures::{Extreme, Measures};
use crate::input::Problem;
use crate::units::Units;

/// The numbers of a row.
struct Step<'a> {
    record: &'a Record,
    /// Duration of the run so far.
    wall_seconds: f64,
}

/// A column: its name, its meaning, the number of a step in it, and which histories have it.
struct Column {
    name: &'static str,
    /// Dimension, such as `mass·length/time`; empty for a pure number.
    dimension: &'static str,
    meaning: &'static str,
    number: fn(&Step<'_>) -> Number,
    is_in: fn(&HistoryColumns) -> bool,
}

/// Number of the first columns, which every history has.
const N_REQUIRED: usize = 19;

/// Name of the column of words.
pub(super) const LIMITED_BY: &str = "limited_by";

const ENERGY: &str = "energy";
const MOMENTUM: &str = "mass·length/time";
const ANGULAR_MOMENTUM: &str = "mass·length²/time";

/// The columns of the whole body, in their order in the file.
const COLUMNS: [Column; 26] = [
    always("step", "", "number of the step; 0: the start", |step| Whole(step.record.step)),
    always("time", "time", "time at its end", |step| Real(step.record.time)),
    always("step_size", "time", "its size; 0 at the start", |step| Real(step.record.step_size)),
    always("kinetic_energy", ENERGY, "T", |step| Real(step.record.kinetic_energy)),
    always("strain_energy", ENERGY, "V", |step| Real(step.record.strain_energy)),
    always("external_work", ENERGY, WORK, |step| Real(step.record.external_work)),
    always("total_energy", ENERGY, "T + V, with contact T + V + V_c", |step| Real(step.record.total_energy)),
    always("energy_residual", ENERGY, ENERGY_RESIDUAL, |step| Real(step.record.energy_residual)),
    always("linear_momentum_x", MOMENTUM, "linear momentum", |step| Real(step.record.linear_momentum[0])),
    always("linear_momentum_y", MOMENTUM, "linear momentum", |step| Real(step.record.linear_momentum[1])),
    always("linear_momentum_z", MOMENTUM, "linear momentum", |step| Real(step.record.linear_momentum[2])),
    always("angular_momentum_x", ANGULAR_MOMENTUM, ANGULAR, |step| Real(step.record.angular_momentum[0])),
    always("angular_momentum_y", ANGULAR_MOMENTUM, ANGULAR, |step| Real(step.record.angular_momentum[1])),
    always("angular_momentum_z", ANGULAR_MOMENTUM, ANGULAR, |step| Real(step.record.angular_momentum[2])),
    always("linear_momentum_residual", MOMENTUM, MOMENTUM_RESIDUAL, |step| {
        Real(step.record.linear_momentum_residual)
    }),
    always("angular_momentum_residual", ANGULAR_MOMENTUM, ANGULAR_RESIDUAL, |step| {
        Real(step.record.angular_momentum_residual)
    }),
    always("newton_iterations", "", "linear systems solved in this step", |step| {
        Whole(step.record.newton_iterations)
    }),
    always("wall_seconds", "", "wall time since the start of the run, in seconds", |step| {
        Real(step.wall_seconds)
    }),
    always("smallest_determinant", "", DETERMINANT, |step| Real(step.record.smallest_determinant)),
    Column {
        name: "local_error",
        dimension: "",
        meaning: "with adaptive steps only: estimated or (`\"sampled\"`) extrapolated error of the step, relative to the \
                  scales",
        number: |step| Real(step.record.local_error),
        is_in: |own| own.is_adaptive,
    },
    Column {
        name: LIMITED_BY,
        dimension: "",
        meaning: "with adaptive steps only: what set the size, as a word: `start` (sizes still grow from the first one), `error`, \
                  `corrections` (Newton's iteration took many, or failed), `kink` (of a load or a driven support, at the end of \
                  the step or from which sizes still grow), `load` (a smooth one, which longer steps do not resolve), `output`, \
                  `phase`, `max_size`, `min_size`; empty at the start",
        number: |step| step.record.step_limit.map_or(Missing, Limit),
        is_in: |own| own.is_adaptive,
    },
    Column {
        name: "dissipated_energy",
        dimension: ENERGY,
        meaning: "with viscosity, drag, dampers in joints or a dissipative scheme only: energy that they have dissipated since the start",
        number: |step| Real(step.record.dissipated_energy),
        is_in: |own| own.dissipates,
    },
    Column {
        name: "degree",
        dimension: "",
        meaning: "with `max_degree` only: degree of the step's element",
        number: |step| Whole(step.record.degree),
        is_in: |own| own.has_degrees,
    },
    Column {
        name: "contact_energy",
        dimension: ENERGY,
        meaning: "with contact only: energy V_c of the layers",
        number: |step| Real(step.record.contact_energy),
        is_in: |own| own.has_contact,
    },
    Column {
        name: "smallest_gap",
        dimension: "",
        meaning: "with contact only: smallest gap at the end of the step over the thickness of its layer; empty where nothing is \
                  near",
        number: |step| step.record.smallest_gap.map_or(Missing, Real),
        is_in: |own| own.has_contact,
    },
    Column {
        name: "contact_points",
        dimension: "",
        meaning: "with contact only: number of points and nodes whose layer stores energy at the end of the step; edges do not count",
        number: |step| Whole(step.record.contact_points),
        is_in: |own| own.has_contact,
    },
];

const WORK: &str =
    "work of the loads, and of the reactions of supports and obstacles that move, since the start";
const ENERGY_RESIDUAL: &str = "change of the total energy in this step, minus the external work in it, plus the dissipated energy in it";
const ANGULAR: &str = "angular momentum about the origin";
const MOMENTUM_RESIDUAL: &str =
    "norm of the change of linear momentum in this step minus the impulse of loads and reactions";
const ANGULAR_RESIDUAL: &str = "norm of the same for the angular momentum; with plane cells of its z component, because the planes bear couples about x and y";
const DETERMINANT: &str =
    "smallest det F at the quadrature points at the end of the step; `inf` for a body of links only";

const fn always(
    name: &'static str,
    dimension: &'static str,
    meaning: &'static str,
    number: fn(&Step<'_>) -> Number,
) -> Column {
    Column { name, dimension, meaning, number, is_in: |_| true }
}

/// A column, described.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnInfo {
    /// Name in the header.
    pub name: String,
    /// Dimension, such as `mass·length/time`; empty for a pure number.
    pub dimension: String,
    /// Meaning in a line.
    pub meaning: String,
}

impl From<&Column> for ColumnInfo {
    fn from(column: &Column) -> Self {
        ColumnInfo {
            name: column.name.to_string(),
            dimension: column.dimension.to_string(),
            meaning: column.meaning.to_string(),
        }
    }
}

/// A column of a static analysis, where some have another meaning.
fn in_statics(column: ColumnInfo) -> ColumnInfo {
    let (dimension, meaning) = match column.name.as_str() {
        "time" => ("", "load fraction"),
        "step_size" => ("", "increment of the load fraction"),
        "linear_momentum_residual" => ("force", "norm of the resultant of all forces"),
        "angular_momentum_residual" => {
            ("force·length", "norm of the moment of all forces about the origin; with plane cells about z")
        }
        _ => return column,
    };
    ColumnInfo { dimension: dimension.to_string(), meaning: meaning.to_string(), ..column }
}

/// All columns of the whole body.
#[cfg(test)]
pub(crate) fn every_column() -> impl Iterator<Item = ColumnInfo> {
    COLUMNS.iter().map(ColumnInfo::from)
}

/// Names of the columns that every history has.
pub fn required() -> impl Iterator<Item = &'static str> {
    COLUMNS[..N_REQUIRED].iter().map(|column| column.name)
}

/// Names of all columns of the whole body, including those that a history may lack.
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
    /// Whether viscosity, drag, dampers or the scheme dissipate energy: column `dissipated_energy`.
    pub dissipates: bool,
    /// Whether degrees are adaptive: column `degree`.
    pub has_degrees: bool,
    /// Whether there is contact: columns `contact_energy`, `smallest_gap`, `contact_points`.
    pub has_contact: bool,
    /// Whether the time is the load fraction of a static analysis.
    pub is_static: bool,
    /// Probes, reactions, joints, rigid bodies, extremes, values of groups.
    measures: Measures,
}

impl HistoryColumns {
    /// The columns of a problem.
    pub fn of(problem: &Problem) -> Self {
        let Problem { body, scheme, .. } = problem;
        let adaptivity = problem.plan.adaptivity();
        HistoryColumns {
            dissipates: body.dissipates() || scheme.dissipation().is_some(),
            is_adaptive: adaptivity.is_some(),
            has_degrees: adaptivity.is_some_and(|adaptivity| adaptivity.degrees.is_some()),
            has_contact: body.contacts().next().is_some(),
            is_static: problem.is_static(),
            measures: Measures::new(body, &problem.quantities),
        }
    }

    /// Whether there is a column of the largest value of a field.
    pub(crate) fn has_extreme(&self, field: &str) -> bool {
        self.measures.has_extreme(field)
    }

    /// Number of the columns after those of the whole body.
    pub(super) fn n_asked(&self) -> usize {
        self.measures.columns().len()
    }

    /// All columns.
    pub fn described(&self) -> impl Iterator<Item = ColumnInfo> {
        let own = COLUMNS.iter().filter(|column| (column.is_in)(self)).map(ColumnInfo::from);
        own.map(|column| if self.is_static { in_statics(column) } else { column })
            .chain(self.measures.columns())
    }

    /// Names of all columns.
    pub fn names(&self) -> Vec<String> {
        self.described().map(|column| column.name).collect()
    }

    /// `columns.json`: name, unit and meaning of every column.
    pub fn with_units(&self, units: Units) -> Value {
        let system = units.system();
        let unit = |dimension: &str| system.map_or(String::new(), |system| system.unit(dimension));
        let object = |ColumnInfo { name, dimension, meaning }| {
            let unit = if name == "wall_seconds" { "s".to_string() } else { unit(&dimension) };
            json!({ "column": name, "unit": unit, "dimension": dimension, "meaning": meaning })
        };
        self.described().map(object).collect()
    }

    /// The row of a step, in the order of [`HistoryColumns::names`]; `wall_seconds`: duration of the run so far. On a
    /// team a call of all ranks, which get the same numbers.
    pub fn row(&self, view: View<'_>, wall_seconds: f64) -> Row {
        let mut numbers = self.numbers(view.record, wall_seconds);
        let extremes = self.measures.add_to(view, &mut numbers);
        Row { numbers, extremes }
    }

    /// The numbers of a step for the whole body.
    pub(crate) fn numbers(&self, record: &Record, wall_seconds: f64) -> Vec<Number> {
        let step = Step { record, wall_seconds };
        COLUMNS.iter().filter(|column| (column.is_in)(self)).map(|column| (column.number)(&step)).collect()
    }
}
