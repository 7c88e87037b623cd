//! The motions.

use emmy::Result;
use emmy::body::{
    Body, InitialVelocity, Load, LoadKind, PointMass, PointTerms, Region, TimeFunction, Viscosity,
};
use emmy::material::{Link, NeoHooke};
use emmy::mesh::{self, CellKind, MeshBuilder};
use emmy::motion::State;

use super::fork;

/// Names of the cases.
pub(super) const NAMES: [&str; 5] = ["orbit", "block", "pulse", "damped", "fork"];

/// A motion with its numerical parameters.
#[derive(Debug)]
pub(super) struct Case {
    /// Key word, and name of the files.
    pub name: &'static str,
    /// The moving body, in a few words.
    pub title: &'static str,
    /// The body.
    pub body: Body,
    /// Its state at the start, at time 0.
    pub start: State,
    /// Time at which errors are measured.
    pub end: f64,
    /// Numbers of equal steps for degree 1, 2, 3.
    pub counts: [Vec<usize>; 3],
    /// Tolerances for degree 1, 2, 3.
    pub tolerances: [Vec<f64>; 3],
    /// Degrees and numbers of equal steps of the reference, and of a second reference for comparison.
    pub references: [(usize, usize); 2],
    /// Goal for the speed of adaptive steps relative to equal steps of the same error.
    pub goal: Option<f64>,
}

impl Case {
    /// The case of a name.
    ///
    /// # Errors
    /// A message if the body cannot be built.
    pub(super) fn named(name: &str) -> std::result::Result<Case, String> {
        let case = match name {
            "orbit" => orbit(),
            "block" => block(),
            "pulse" => pulse(),
            "damped" => damped(),
            _ => tuning_fork(),
        };
        case.map_err(|error| format!("{name}: {error}"))
    }

    /// The case with its shortest runs only.
    pub(super) fn quick(mut self) -> Self {
        self.counts.iter_mut().for_each(|counts| counts.truncate(3));
        self.tolerances.iter_mut().for_each(|tolerances| tolerances.truncate(2));
        self
    }
}

/// A geometric sequence of numbers.
fn counts(first: usize, n: i32, ratio: f64) -> Vec<usize> {
    (0..n).map(|i| (first as f64 * ratio.powi(i)).round() as usize).collect()
}

fn tolerances(first: f64, n: i32, ratio: f64) -> Vec<f64> {
    (0..n).map(|i| first * ratio.powi(i)).collect()
}

/// Two bodies of masses 2 and 1 on an orbit of eccentricity 0.9, from their largest distance, 2.3 revolutions.
fn orbit() -> Result<Case> {
    let mut builder = MeshBuilder::new();
    let ends = [[1.0 / 3.0, 0.0, 0.0], [-2.0 / 3.0, 0.0, 0.0]].map(|point| builder.point(point));
    builder.node_group("star", [ends[0]]);
    builder.node_group("comet", [ends[1]]);
    builder.cell(CellKind::Line2, &ends)?;
    let mass = |group: &str, mass| PointMass { group: group.into(), mass };
    let nodal = PointTerms { masses: vec![mass("star", 2.0), mass("comet", 1.0)], ..PointTerms::default() };
    let region = Region::links(Link::attraction(3.0)?, 0.0);
    let body = Body::builder(builder.build()?).region(region).point_terms(nodal.clone()).build()?;
    // v^2 = g/mu (1 - e)/r at the largest distance r = 1 = a (1 + e), mu = 2/3; period tau sqrt(a^3 mu/g).
    let (e, speed) = (0.9, 0.45f64.sqrt());
    let moving = |group: &str, rate| InitialVelocity {
        group: Some(group.into()),
        velocity: [0.0, rate, 0.0],
        ..InitialVelocity::default()
    };
    let start =
        State::initial(&body, 0.0, &[moving("star", speed / 3.0), moving("comet", -2.0 / 3.0 * speed)])?;
    let period = std::f64::consts::TAU * ((1.0f64 + e).powi(-3) / 4.5).sqrt();
    Ok(Case {
        name: "orbit",
        title: "Orbit of eccentricity 0.9, 2.3 revolutions",
        body,
        start,
        end: 2.3 * period,
        counts: [counts(1000, 8, 2.0), counts(200, 8, 2.0), counts(140, 7, 2.0)],
        tolerances: [tolerances(1e-5, 5, 0.1), tolerances(1e-4, 6, 0.1), tolerances(1e-4, 6, 0.1)],
        references: [(6, 4000), (5, 8000)],
        goal: Some(3.0),
    })
}

/// The paper's block: at rest, a load until t = 1, then free flight.
fn block() -> Result<Case> {
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 0.5);
    let hat = TimeFunction::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)])?;
    let load = |group: &str, sign: f64| Load {
        kind: LoadKind::Traction {
            group: group.into(),
            traction: [256.0, 512.0, 768.0].map(|t| sign * t / 9.0),
        },
        time_function: hat.clone(),
    };
    let body = Body::builder(mesh::l_block(1.0)?)
        .region(rubber)
        .load(load("face-a", 1.0))
        .load(load("face-b", -1.0))
        .build()?;
    let start = State::initial(&body, 0.0, &[])?;
    Ok(Case {
        name: "block",
        title: "The paper's block: rest, load until t = 1, free flight until t = 2",
        body,
        start,
        end: 2.0,
        counts: [counts(40, 7, 2.0), counts(40, 6, 2.0), counts(40, 5, 2.0)],
        tolerances: [tolerances(1e-3, 5, 0.1), tolerances(1e-3, 5, 0.1), tolerances(1e-3, 5, 0.1)],
        references: [(4, 1280), (3, 2560)],
        goal: Some(1.0),
    })
}

/// A beam of rubber that is hit at one end, for a thousandth of the time, and then flies.
fn pulse() -> Result<Case> {
    let body = beam(rubber()?, 4.0, 0.0)?;
    let start = State::initial(&body, 0.0, &[])?;
    Ok(Case {
        name: "pulse",
        title: "A beam after a pulse of a thousandth of the time",
        body,
        start,
        end: 4.0,
        counts: [counts(200, 6, 2.0), counts(200, 5, 2.0), counts(200, 4, 2.0)],
        tolerances: [tolerances(1e-4, 5, 0.1), tolerances(1e-4, 6, 0.1), tolerances(1e-4, 6, 0.1)],
        references: [(4, 4000), (5, 2500)],
        goal: None,
    })
}

/// The same beam with viscosity and drag: it rings for a tenth of the time and coasts, slower and slower, for the rest.
fn damped() -> Result<Case> {
    let viscosity = Viscosity { time: 0.01, ..Viscosity::default() };
    let body = beam(rubber()?.with_viscosity(viscosity), 40.0, 0.5)?;
    let start = State::initial(&body, 0.0, &[])?;
    Ok(Case {
        name: "damped",
        title: "A damped beam after a pulse of a thousandth of the time",
        body,
        start,
        end: 40.0,
        counts: [counts(200, 9, 2.0), counts(200, 8, 2.0), counts(200, 7, 2.0)],
        tolerances: [tolerances(1e-4, 5, 0.1), tolerances(1e-4, 6, 0.1), tolerances(1e-4, 6, 0.1)],
        references: [(4, 12800), (5, 9000)],
        goal: Some(3.0),
    })
}

fn rubber() -> Result<Region> {
    Ok(Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0))
}

/// A beam of 1 x 1 x 3 with a transverse pulse on one end, at the start of a motion of some duration.
fn beam(region: Region, duration: f64, drag: f64) -> Result<Body> {
    // A table, not a smooth function: adaptive steps end at its kinks and large steps integrate them exactly, so that
    // neither misses it.
    let width = 1e-3 * duration;
    let time_function = TimeFunction::new(vec![(0.0, 0.0), (0.5 * width, 1.0), (width, 0.0)])?;
    // The same impulse for any duration.
    let traction = [1.2 / width, 0.4 / width, 0.0];
    let kind = LoadKind::Traction { group: "z-max".into(), traction };
    Body::builder(mesh::block([1.0, 1.0, 3.0], [2, 1, 6])?)
        .region(region)
        .load(Load { kind, time_function })
        .drag(drag)
        .build()
}

/// A tuning fork that rings, three periods.
fn tuning_fork() -> Result<Case> {
    let body = fork::body()?;
    let start = fork::start(&body)?;
    Ok(Case {
        name: "fork",
        title: "A tuning fork in its lowest modes, three periods",
        body,
        start,
        end: 3.0,
        counts: [counts(30, 7, 2.0), counts(30, 5, 2.0), counts(30, 4, 2.0)],
        tolerances: [tolerances(1e-4, 5, 0.1), tolerances(1e-4, 6, 0.1), tolerances(1e-4, 6, 0.1)],
        references: [(4, 1000), (5, 700)],
        goal: None,
    })
}
