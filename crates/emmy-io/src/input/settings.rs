//! `[newton]`, `[solver]`, `[output]`, `[limits]`.

use std::path::PathBuf;

use emmy::body::FieldName;
use emmy::internals::sparse::{SOLVERS, Solver};
use emmy::motion::{NewtonSettings, StepPlan};

use super::description::{BELOW_ONE, Described, Kind, POSITIVE, Section, list, whole, word, words};
use super::fault::{Fault, Place};
use super::quantities::{PROBE, RELATIVE_TO, VALUE, field, of_extremes};
use super::table::{Item, Table};
use crate::vtk::{Format, Precision};

/// Output files and directory.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Directory of the results, relative to the working directory.
    pub directory: PathBuf,
    /// Steps between frames, besides the first and the last; 0: only these two.
    pub every: usize,
    /// Time between frames, instead of steps.
    pub interval: Option<f64>,
    /// Format of the frames.
    pub format: Format,
    /// Precision of their fields.
    pub precision: Precision,
    /// Fields in the frames; fields that the body does not have are left out.
    pub fields: Vec<FieldName>,
    /// Steps between checkpoints; 0: no checkpoints.
    pub checkpoint_every: usize,
    /// Steps between rows of `newton.csv` and between steps in `run.log`; 0: none.
    pub log_every: usize,
}

/// Limits that end a run early (exit code 4).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Largest accumulated energy residual over the largest T + |V|.
    pub energy: Option<f64>,
    /// Largest accumulated angular momentum residual over the largest |L|.
    pub angular_momentum: Option<f64>,
}

/// `[newton]`.
pub(super) static NEWTON: Described = Described::new(|| {
    Section::new("[newton]", "When the iteration of a step ends")
        .may("tolerance", BELOW_ONE, "", "Relative size of the residual at which a step counts as solved")
        .default("1e-10")
        .may("max_iterations", whole(1), "", "Iterations after which a step fails and is cut")
        .default("20")
});

/// `[solver]`.
pub(super) static SOLVER: Described = Described::new(|| {
    Section::new("[solver]", "Solver of the linear systems").must(
        "kind",
        word("a solver", SOLVERS.map(|(name, ..)| name)),
        "",
        "`iterative`: conjugate gradients with an incomplete Cholesky factor; `multigrid`: conjugate gradients with \
         multigrid, for large stiff bodies; `direct`: sparse Cholesky factorisation; `auto`: the cheapest of them; \
         `emmy list solvers` explains them",
    )
});

/// `[output]`.
pub(super) static OUTPUT: Described = Described::new(|| {
    Section::new("[output]", "What is written, and where")
        .may(
            "directory",
            Kind::Text,
            "",
            "Directory of the results, relative to the working directory; `--output` overrides it",
        )
        .absent("the name of the input file without `.toml`")
        .may(
            "every",
            whole(0),
            "",
            "Steps between frames, besides the first and the last state; 0: no frames",
        )
        .default("1")
        .may(
            "interval",
            POSITIVE,
            "time",
            "Time between frames, in place of `every`; these times are met exactly",
        )
        .may("format", word("a format of frames", Format::ALL.map(Format::name)), "", FORMATS)
        .default("\"vtu\"")
        .may("precision", word("a precision of frames", Precision::ALL.map(Precision::name)), "", PRECISIONS)
        .default("\"double\"")
        .may("fields", words("a field", FieldName::ALL.map(FieldName::name)), "", FIELDS)
        .default(DEFAULT_FIELDS)
        .may(
            "checkpoint_every",
            whole(0),
            "",
            "Steps between checkpoints, besides the start and the last state; 0: none",
        )
        .default("50")
        .may(
            "log_every",
            whole(0),
            "",
            "Steps between rows of `newton.csv` and between steps in `run.log`; 0: none",
        )
        .default("1")
        .may("reactions", Kind::Words(0, Box::new(Kind::Text)), "", REACTIONS)
        .absent("every support's group")
        .may("joints", Kind::Words(0, Box::new(Kind::Text)), "", JOINTS)
        .absent("every joint")
        .may("probes", list(0, Kind::Table(&PROBE)), "", "Nodes whose path or fields go into the history")
        .default("[]")
        .may("extremes", words("a field with a largest value", of_extremes()), "", EXTREMES)
        .absent("none")
        .may(
            "values",
            list(0, Kind::Table(&VALUE)),
            "",
            "Means, totals and largest values of fields in groups",
        )
        .absent("none")
        .may("relative_to", Kind::Text, "", RELATIVE_TO)
        .absent("`\"ground\"`")
});

const FORMATS: &str = "Files of the frames: `.vtu` files and a collection of them, or one `.vtkhdf` file (ParaView 5.12, VTK 9.3)";
const PRECISIONS: &str = "Precision of the fields in the frames; points and the history are always double";
const FIELDS: &str = "Fields in the frames; `emmy list fields` explains them";
const REACTIONS: &str =
    "Groups of supports whose reactions go into the history, as `GROUP_force_x` to `GROUP_moment_z`";
const JOINTS: &str =
    "Joints whose forces and coordinates go into the history, as `NAME_force_x`, `NAME_angle` and more";
const EXTREMES: &str =
    "Fields whose largest value goes into the history in each step, as `max_FIELD`; of a vector its norm";
const DEFAULT_FIELDS: &str = "[\"displacement\", \"velocity\", \"momentum_density\", \"cauchy_stress\", \
    \"second_piola_kirchhoff_stress\", \"von_mises_stress\", \"principal_stretches\", \
    \"strain_energy_density\", \"axial_force\"]";

/// `[limits]`.
pub(super) static LIMITS: Described = Described::new(|| {
    Section::new("[limits]", "What ends a run early (exit code 4)")
        .may("energy", POSITIVE, "", "Largest accumulated energy residual, as a part of the largest T + |V| so far")
        .absent("no limit")
        .may(
            "angular_momentum",
            POSITIVE,
            "",
            "Largest accumulated angular momentum residual, as a part of the largest norm of the angular momentum so far, or of the largest possible one of a body that does not turn",
        )
        .absent("no limit")
});

pub(super) fn newton(table: &Table<'_>) -> NewtonSettings {
    let (tolerance, max_iterations) = (table.must("tolerance"), table.must("max_iterations"));
    NewtonSettings { tolerance, max_iterations, ..Default::default() }
}

pub(super) fn solver(table: &Table<'_>) -> Solver {
    table.must::<Item<'_>>("kind").one_of(SOLVERS.map(|(name, solver, _)| (name, solver)))
}

pub(super) fn output(table: &Table<'_>) -> Result<Output, Fault> {
    let word = |key: &str| table.must::<Item<'_>>(key);
    let fields: Vec<Item<'_>> = table.must("fields");
    Ok(Output {
        directory: table.must::<&str>("directory").into(),
        every: table.may("every").unwrap_or(0),
        interval: interval(table)?,
        format: word("format").one_of(Format::ALL.map(|format| (format.name(), format))),
        precision: word("precision").one_of(Precision::ALL.map(|precision| (precision.name(), precision))),
        fields: fields.into_iter().map(field).collect(),
        checkpoint_every: table.must("checkpoint_every"),
        log_every: table.must("log_every"),
    })
}

fn interval(table: &Table<'_>) -> Result<Option<f64>, Fault> {
    let Some(interval) = table.item("interval") else { return Ok(None) };
    if let Some(every) = table.item("every") {
        let message = "frames are counted by steps or by time: give `every` or `interval`";
        let fault = Fault::at(every.key_place, message, "this one").label(interval.key_place, "and this one");
        return Err(fault.help("`interval` is a time, `every` a number of steps"));
    }
    Ok(table.may("interval"))
}

/// The plan that meets the times of the frames.
pub(super) fn plan_with_frames(plan: StepPlan, output: &Output, place: &Place) -> Result<StepPlan, Fault> {
    let Some(interval) = output.interval else { return Ok(plan) };
    plan.with_interval(interval).map_err(|error| {
        let fault = Fault::at(place, format!("`interval`: {}", reason(&error)), "not met by the steps");
        fault.help("give steps of which it is a multiple, or adaptive ones: those meet every such time")
    })
}

fn reason(error: &emmy::Error) -> String {
    match error {
        emmy::Error::Plan { reason, .. } => reason.clone(),
        other => other.to_string(),
    }
}

impl Output {
    /// Whether frames are written.
    pub fn has_frames(&self) -> bool {
        self.every > 0 || self.interval.is_some()
    }

    /// Number of the frames of a plan; unknown if frames are written every n adaptive steps.
    pub fn n_frames(&self, plan: &StepPlan) -> Option<usize> {
        let duration = plan.end() - plan.start();
        match (self.interval, self.every) {
            // The last one may lie at the end, or differ from it by rounding.
            (Some(interval), _) => Some((duration / interval * (1.0 - 1e-12)).ceil() as usize + 1),
            (None, 0) => Some(0),
            (None, _) if plan.adaptivity().is_some() => None,
            (None, every) => Some(plan.n_steps().div_ceil(every) + 1),
        }
    }

    /// Whether a state gets a frame, by its step or by its time in a plan.
    pub fn is_frame(&self, plan: &StepPlan, step: usize, time: f64) -> bool {
        match self.interval {
            Some(_) => step == 0 || plan.is_output(time),
            None => step.is_multiple_of(self.every),
        }
    }
}

pub(super) fn limits(table: &Table<'_>) -> Limits {
    Limits { energy: table.may("energy"), angular_momentum: table.may("angular_momentum") }
}
