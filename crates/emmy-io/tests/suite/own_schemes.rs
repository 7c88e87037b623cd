//! The files of a run by a stepper from outside.

use emmy::body::Reaction;
use emmy::motion::{Motion, State};
use emmy::time::{PointForces, StepOutcome, Stepper};
use emmy_io::input::{self, Overrides};
use emmy_io::results::Results;
use emmy_io::summary::Status;

const INPUT: &str = "\
    mesh.box = { size = [1, 2, 1], cells = [1, 2, 1] }\n\
    region = [{ density = 2, material.neo-hooke = { lambda = 10, mu = 5 } }]\n\
    initial = { gradient = [[0.1, 0, 0], [0, 0.2, 0], [0, 0, 0]] }\n\
    support = [{ group = 'y-min', fix = ['x', 'y', 'z'] }]\n\
    time = { scheme = 'DGM', steps = [{ until = 0.5, size = 0.05 }] }\n\
    output = { every = 5, checkpoint_every = 4, reactions = ['y-min'] }\n";

/// The semi-implicit Euler method, with the lumped mass.
#[derive(Debug)]
struct Euler<'a>(PointForces<'a>);

impl Stepper for Euler<'_> {
    fn name(&self) -> &'static str {
        "semi-implicit Euler"
    }

    fn advance(&mut self, state: &mut State, h: f64) -> emmy::Result<StepOutcome> {
        let body = self.0.body();
        let net = self.0.evaluate(&state.displacement, state.time)?;
        for dof in (0..body.n_dofs()).filter(|&dof| !body.fixed()[dof]) {
            let mass = body.lumped_mass()[dof / 3];
            state.momentum[dof] = mass * state.velocity[dof] + h * net[dof];
            state.velocity[dof] = state.momentum[dof] / mass;
            state.displacement[dof] += h * state.velocity[dof];
        }
        self.0.begin();
        self.0.book(h, &state.velocity, None)?;
        StepOutcome::new(body, state, self.0.end(h))
    }

    fn reactions(&self) -> &[Reaction] {
        self.0.reactions()
    }
}

#[test]
fn history_frames_checkpoints_and_summary_are_written() {
    let temp = tempfile::tempdir().unwrap();
    let folder = temp.path();
    let file = folder.join("box.toml");
    std::fs::write(&file, INPUT).unwrap();
    let overrides = Overrides { output: Some(folder.join("out")), ..Overrides::default() };
    let mut problem = input::read(&file, &overrides).unwrap();
    problem.scheme = emmy::time::Scheme::Own("semi-implicit Euler");
    let state = State::initial(&problem.body, 0.0, &problem.initial).unwrap();
    let stepper = Euler(PointForces::new(&problem.body).unwrap());
    let mut motion = Motion::with_stepper(&problem.body, stepper).unwrap().from(state).unwrap();
    let mut results = Results::create(&problem).unwrap();
    motion.march(&problem.plan, &mut [&mut results]).unwrap();
    assert!(results.finish(&problem, &motion, Status::Done, None).error.is_none());

    let text = |name: &str| std::fs::read_to_string(folder.join("out").join(name)).unwrap();
    let history = text("history.csv");
    let rows: Vec<Vec<&str>> = history.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 11);
    let last = |name: &str| -> f64 {
        let column =
            rows[0].iter().position(|own| *own == name).unwrap_or_else(|| panic!("{name}: {history}"));
        rows[11][column].parse().unwrap()
    };
    assert_eq!(last("total_energy"), motion.record().total_energy);
    assert_eq!(last("y-min_force_y"), motion.reactions()[0].force[1]);
    assert!(motion.reactions()[0].force[1].abs() > 0.1);
    assert!(text("summary.json").contains("\"semi-implicit Euler\""));
    let frames = std::fs::read_dir(folder.join("out/frames")).unwrap().count();
    assert_eq!(frames, 3);
    assert!(folder.join("out/checkpoint").read_dir().unwrap().count() > 0);
}
