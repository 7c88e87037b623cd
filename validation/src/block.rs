//! The paper's block (Section 5): two bodies, one load, and runs of them.

use emmy::body::{Body, History, Load, LoadKind, Region};
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
use emmy::time::Scheme;
use emmy_io::convergence::{ErrorNorm, Samples};

/// Times that differ by less are the same.
const SAME_TIME: f64 = 1e-9;

/// The tractions on the end faces: (256, 512, 768)/9 on y = 10, the opposite on x = 6, a hat over 0 < t < 1.
fn loads() -> Vec<Load> {
    let history = History::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]).expect("times go forward");
    let load = |group: &str, sign: f64| Load {
        kind: LoadKind::Traction {
            group: group.into(),
            traction: [256.0, 512.0, 768.0].map(|t| sign * t / 9.0),
        },
        history: history.clone(),
    };
    vec![load("face-a", 1.0), load("face-b", -1.0)]
}

fn body(region: Region) -> Body {
    let mesh = emmy::mesh::l_block(1.0).expect("1 is 1/1");
    Body::new(mesh, vec![region], &[], &loads()).expect("the paper's block is well-posed")
}

/// Section 5.1.1: St. Venant-Kirchhoff, E = 1e7, nu = 0.3, density 1.
pub fn quasi_rigid() -> Body {
    body(Region::new(None, 1.0, SaintVenantKirchhoff::from_engineering(1e7, 0.3).expect("in range")))
}

/// Section 5.1.2: neo-Hooke, lambda = 1000, mu = 500, density 0.5.
pub fn large_strain() -> Body {
    body(Region::new(None, 0.5, NeoHooke::new(1000.0, 500.0).expect("in range")))
}

/// What became of a run.
pub struct Run {
    /// Records from the start on, or from the state that the run started from.
    pub records: Vec<Record>,
    /// States at the same times.
    pub states: Vec<State>,
    /// The message of a step that failed.
    pub failure: Option<String>,
}

impl Run {
    /// Records after a time.
    pub fn after(&self, time: f64) -> &[Record] {
        &self.records[self.records.partition_point(|record| record.time < time - 1e-9)..]
    }

    /// The displacements at all times, as a reference for other runs.
    pub fn samples(&self) -> Samples {
        let displacement = self.states.iter().flat_map(|state| state.displacement.iter().copied()).collect();
        let times = self.states.iter().map(|state| state.time).collect();
        Samples { times, n_dofs: self.end().displacement.len(), displacement }
    }

    /// Error norm (80) against a reference, which must have a sample at each of the run's times.
    pub fn error(&self, reference: &Samples) -> Result<f64, String> {
        let mut norm = ErrorNorm::new(reference, self.states[0].time, SAME_TIME);
        match self.states.iter().find(|state| !norm.see(state.time, &state.displacement)) {
            Some(state) => Err(format!("the reference has no state at t = {}", state.time)),
            None => Ok(norm.error()),
        }
    }

    /// The last state.
    pub fn end(&self) -> &State {
        &self.states[self.states.len() - 1]
    }
}

/// Phases `(until, size)` of a plan.
pub type Phases<'a> = &'a [(f64, f64)];

/// Runs a body from rest.
pub fn run(body: &Body, scheme: Scheme, degree: usize, phases: Phases<'_>) -> Run {
    let state = State::initial(body, 0.0, &[]).expect("no initial motion");
    run_from(body, scheme, degree, phases, state)
}

/// Runs a body from a state; a step that fails ends the run.
pub fn run_from(body: &Body, scheme: Scheme, degree: usize, phases: Phases<'_>, state: State) -> Run {
    let plan = phases.iter().map(|&(until, size)| Phase { until, size }).collect();
    let plan = StepPlan::new(state.time, plan).expect("plans go forward");
    let mut motion =
        Motion::new(body, scheme, degree, NewtonSettings::default(), state).expect("scheme fits degree");
    let mut run =
        Run { records: vec![motion.record().clone()], states: vec![motion.state().clone()], failure: None };
    for step in plan.steps() {
        if let Err(error) = motion.step(step.size, step.end) {
            run.failure = Some(error.to_string());
            break;
        }
        run.records.push(motion.record().clone());
        run.states.push(motion.state().clone());
    }
    run
}

/// Parses a scheme that stands in the source.
pub fn scheme(name: &str) -> Scheme {
    name.parse().expect("a scheme of the paper")
}
