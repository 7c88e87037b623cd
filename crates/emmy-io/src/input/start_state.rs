//! The state from which the motion of a problem starts.

use std::path::Path;

use emmy::equilibrium::Equilibrium;
use emmy::internals::number::{short, short_below};
use emmy::internals::time::CentralDifferences;
use emmy::motion::{MarchError, Motion, Observer, State};
use emmy::team::Team;
use emmy::time::Scheme;

use super::fault::{Fault, InputError};
use super::problem::Problem;
use super::start::Start;
use crate::checkpoint::{self, CheckpointError};

/// Why there is no start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// An impossible start, or no equilibrium.
    #[error(transparent)]
    March(#[from] MarchError),
    /// The state of another run cannot be taken.
    #[error("`initial.state`: {0}")]
    Run(String),
    /// Explicit steps are unstable there.
    #[error(transparent)]
    Unstable(#[from] InputError),
}

impl From<emmy::Error> for StartError {
    fn from(error: emmy::Error) -> Self {
        StartError::March(error.into())
    }
}

impl Problem {
    /// The start of the motion. An equilibrium is solved for; observers see its increments.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn start_state(&self, observers: &mut [&mut dyn Observer]) -> Result<State, StartError> {
        match &self.start {
            Start::Undeformed => Ok(State::initial(&self.body, self.plan.start(), &self.initial)?),
            Start::Equilibrium { load_steps } => {
                let body = self.scheme.body(&self.body);
                let equilibrium = Equilibrium::new(body, self.plan.start(), *load_steps)?;
                Ok(equilibrium.start(self.newton, &self.initial, observers)?)
            }
            Start::Run(directory) => self.state_of(directory),
        }
    }

    /// The motion at its start, as the run and the sweep march it: with the reactions of an equilibrium, and with cuts.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn motion(&self, observers: &mut [&mut dyn Observer]) -> Result<Motion<'_>, StartError> {
        let state = self.start_state(observers)?;
        if matches!(self.start, Start::Equilibrium { .. }) {
            self.critical_step(Some(&state))?;
        }
        self.motion_from(state)
    }

    /// The motion from a given state at the start. Step sizes are not checked.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn motion_from(&self, state: State) -> Result<Motion<'_>, StartError> {
        let motion = Motion::starting(&self.body, self.scheme, self.newton, state)?;
        let mut motion = self.settled(motion);
        if matches!(self.start, Start::Equilibrium { .. }) || self.is_static() {
            motion = motion.with_static_reactions()?;
        }
        Ok(motion)
    }

    /// A motion with the cuts and the reference of the input.
    pub fn settled<'a>(&self, mut motion: Motion<'a>) -> Motion<'a> {
        motion.allow_cuts(self.smallest_step);
        motion.relative_to(self.quantities.reference().cloned())
    }

    /// The critical step of an explicit scheme at a state, or at the undeformed body; `None` for other schemes.
    ///
    /// # Errors
    /// [`InputError`] if the plan has larger steps than are stable.
    pub fn critical_step(&self, state: Option<&State>) -> Result<Option<f64>, InputError> {
        if self.scheme != Scheme::CentralDifferences {
            return Ok(None);
        }
        let displacement =
            state.map_or_else(|| vec![0.0; self.body.n_dofs()], |state| state.displacement.clone());
        let critical = CentralDifferences::critical_steps(&self.body, &displacement);
        let [critical, limit] = critical.map_err(|error| Fault::new(error.to_string()))?;
        let largest = self.plan.largest_step();
        if largest <= limit {
            return Ok(Some(critical));
        }
        let message = format!(
            "`time.steps`: steps of {} are unstable: the critical step of {} is {} here (2/omega_max)",
            short(largest),
            self.scheme,
            short(critical)
        );
        let help = format!("take steps of at most {}, or an implicit scheme such as DGM", short_below(limit));
        Err(Fault::new(message).help(help).into())
    }

    /// Checks the start; returns its state unless that is an equilibrium, which is not solved for.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn check_start(&self) -> Result<Option<State>, StartError> {
        if let Some(equilibrium) = self.equilibrium()? {
            equilibrium.check()?;
        }
        match self.start {
            Start::Equilibrium { .. } => Ok(None),
            Start::Undeformed | Start::Run(_) => self.start_state(&mut []).map(Some),
        }
    }

    /// The equilibrium from which the motion starts, or to which a static analysis leads.
    ///
    /// # Errors
    /// [`emmy::Error::Plan`].
    pub fn equilibrium(&self) -> emmy::Result<Option<Equilibrium<'_>>> {
        let body = self.scheme.body(&self.body);
        let equilibrium = |time, load_steps| Equilibrium::new(body, time, load_steps).map(Some);
        match self.start {
            Start::Equilibrium { load_steps } => equilibrium(self.plan.start(), load_steps),
            _ if self.is_static() => equilibrium(self.plan.end(), self.plan.n_steps()),
            Start::Undeformed | Start::Run(_) => Ok(None),
        }
    }

    /// The state about which the body of this input vibrates: the equilibrium, or the last state of another run, from
    /// which the motion starts; `None` for the undeformed body.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn state_of_vibration(&self) -> Result<Option<State>, StartError> {
        match (self.equilibrium()?, &self.start) {
            (Some(equilibrium), _) => Ok(Some(equilibrium.start(self.newton, &[], &mut [])?)),
            (None, Start::Run(directory)) => self.state_of(directory).map(Some),
            (None, _) => Ok(None),
        }
    }

    /// Numbers of nodes and cells of the whole mesh.
    pub fn mesh_size(&self) -> [usize; 2] {
        let cells = self.body.regions().iter().map(|region| region.n_cells);
        [self.body.ranks().n_nodes_of_ranks(), cells.sum()]
    }

    /// Digest of the whole mesh.
    pub(crate) fn mesh_digest(&self) -> String {
        self.digest.clone().unwrap_or_else(|| checkpoint::digest(self.body.mesh()))
    }

    /// Whether the run is a static analysis, whose time is the load fraction.
    pub fn is_static(&self) -> bool {
        self.scheme == Scheme::Static
    }

    /// The last state of another run.
    fn state_of(&self, directory: &Path) -> Result<State, StartError> {
        let own = std::fs::canonicalize(&self.output.directory).ok();
        let is_other = match own.is_some() && own == std::fs::canonicalize(directory).ok() {
            true => Err(StartError::Run(OWN_DIRECTORY.to_string())),
            false => Ok(()),
        };
        self.agree(is_other, StartError::Run)?;
        let unusable = |error: CheckpointError| StartError::Run(error.to_string());
        let team: &dyn Team = &**self.body.ranks().team();
        let (checkpoint, damaged) = checkpoint::newest(directory, team).map_err(unusable)?;
        // The other checkpoint may be older.
        if let Some(reasons) = damaged {
            return Err(StartError::Run(format!("the last state is not certain: {reasons}")));
        }
        let (theirs, own) = (&checkpoint.identity.mesh, self.mesh_digest());
        if *theirs != own {
            return Err(StartError::Run(format!(
                "the run in {} has another mesh: {theirs}, here {own}",
                directory.display()
            )));
        }
        Ok(checkpoint.state(&self.body).map_err(unusable)?.transferred(&self.body, self.plan.start())?)
    }
}

/// Why a run cannot start from itself.
const OWN_DIRECTORY: &str =
    "it is the output directory of this run, which would replace it; give another `output.directory`";
