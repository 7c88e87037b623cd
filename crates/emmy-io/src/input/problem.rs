//! Everything a run needs, built from an input.

use std::path::PathBuf;
use std::sync::Arc;

use emmy::body::{
    Body, Coupling, InitialVelocity, Joint, Load, PointTerms, RigidBody, Support, TimeFunction,
};
use emmy::mesh::Mesh;
use emmy::motion::{NewtonSettings, StepPlan};
use emmy::time::Scheme;

use super::formulation::Formulations;
use super::quantities::Quantities;
use super::settings::{Limits, Output};
use super::start::Start;
use crate::units::Units;

/// Options of the command line for an input.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Overrides {
    /// `--set KEY=VALUE`, in order.
    pub set: Vec<String>,
    /// `--until T`: end of the run; the plan is cut, or its last phase is extended.
    pub until: Option<f64>,
    /// `--dt H`: size of the steps, where the plan has one phase.
    pub step_size: Option<f64>,
    /// `--degree K`: degree of the time elements.
    pub degree: Option<usize>,
    /// `--output DIR`.
    pub output: Option<PathBuf>,
    /// `--parts DIR` of a team: the folder of [`crate::shares`] from which each rank reads its part of the mesh.
    pub parts: Option<PathBuf>,
    /// `--step H` of a resumed run: a time, and the size of the later steps.
    pub step: Option<(f64, f64)>,
    /// Whether the body alone is meant, for a program that computes its equilibria and modes: there is no motion yet,
    /// whatever `[time]` says.
    pub is_of_body: bool,
}

/// A complete, checked problem: everything that the library needs to compute a motion, and the output to write.
///
/// ```
/// use emmy_io::input::{self, Overrides};
/// # let directory = std::env::temp_dir().join(format!("emmy-doc-{}", std::process::id()));
/// # std::fs::create_dir_all(&directory)?;
/// # let path = directory.join("block.toml");
/// # std::fs::write(&path, "mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }\n\
/// #     time = { scheme = 'DGM', steps = [{ until = 1, size = 0.1 }] }\n\
/// #     region = [{ density = 2, material.neo-hooke = { lambda = 1, mu = 1 } }]\n")?;
/// let problem = input::read(&path, &Overrides { until: Some(2.0), ..Default::default() })?;
/// assert_eq!((problem.body.n_dofs(), problem.plan.n_steps()), (24, 20));
/// # std::fs::remove_dir_all(&directory)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Problem {
    /// Title.
    pub title: Option<String>,
    /// Units of all numbers, if they are given.
    pub units: Units,
    /// The body: mesh, regions, supports and loads.
    pub body: Body,
    /// The mesh, if it was given in memory: a run writes it beside its results.
    pub mesh_in_memory: Option<Arc<Mesh>>,
    /// Supports.
    pub supports: Vec<Support>,
    /// Masses besides those of the cells, springs to the ground, attraction to points.
    pub nodal: PointTerms,
    /// Rigid bodies.
    pub rigid: Vec<RigidBody>,
    /// Distributing couplings; rigid ones are rigid bodies.
    pub couplings: Vec<Coupling>,
    /// Joints.
    pub joints: Vec<Joint>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Initial velocities.
    pub initial: Vec<InitialVelocity>,
    /// The state to which the initial velocities belong.
    pub start: Start,
    /// Scheme; [`Scheme::Static`] for a static analysis.
    pub scheme: Scheme,
    /// Step plan; of a static analysis over the load fraction.
    pub plan: StepPlan,
    /// Smallest size of a cut step; `None`: 1/1024 of the planned one.
    pub smallest_step: Option<f64>,
    /// Settings of Newton's iteration.
    pub newton: NewtonSettings,
    /// Output files and directory.
    pub output: Output,
    /// Quantities in the history besides those of the whole body.
    pub quantities: Quantities,
    /// Limits that end a run early.
    pub limits: Limits,
    /// Formulations of the cells, for `emmy check`.
    pub formulations: Formulations,
    /// Remarks from the mesh reader, and on keys without effect.
    pub notes: Vec<String>,
    /// The source files: the input, the files of the mesh, the files of histories.
    pub files: Vec<PathBuf>,
    /// The input with all values in effect, as TOML that gives the same run.
    pub resolved: String,
    /// On a team, the digest of the whole mesh.
    pub(crate) digest: Option<String>,
}

impl Problem {
    /// The functions of time that loads, supports and joints follow.
    pub fn time_functions(&self) -> impl Iterator<Item = &TimeFunction> {
        let loads = self.loads.iter().map(|load| &load.time_function);
        let supports = self.supports.iter().flat_map(|support| support.time_functions());
        let joints = self.joints.iter().flat_map(|joint| joint.drive.iter().chain(&joint.motor));
        loads.chain(supports).chain(joints)
    }
}
