//! One linear solver for each mode of the stage equations.

use std::sync::Arc;

use super::decoupling::{StageMode, modes};
use super::solver_choice::{Costs, factorization_cost};
use crate::average::Request;
use crate::body::{Assembly, Body};
use crate::error::{Error, Result};
use crate::force::StepInput;
use crate::sparse::{
    Condensation, Couplings, Direct, DirectPair, Iterative, Multigrid, SharedRows, Shifted, ShiftedSolver,
    Solver, SolverChoice, SolverKind, StageMatrix, SweepOrder, TeamSolver, inverse,
};
use crate::team::{Engine, EngineKind};
use crate::tensor::Mat3;
use crate::time::Memory;
use crate::time::stage_coefficients::StageCoefficients;

/// A stiffness for the solvers of the modes.
#[derive(Debug)]
pub(super) struct Stiffness<'a> {
    /// K with the viscosities C, `(K + 2 rate C) / (1 + 2 rate t_v)` with the mean time t_v of the body.
    pub matrix: &'a StageMatrix,
    /// Rate of the viscosities in the matrix \[1/time\].
    pub viscous_rate: f64,
    /// K alone, if the viscosities are [`separated`].
    pub elastic: Option<&'a mut ElasticStiffness>,
    /// The step without viscosities at which K is taken.
    pub undamped: &'a StepInput<'a>,
    /// Positions of the nodes, `[n_nodes][3]`.
    pub positions: &'a [f64],
    /// Part of M + s^2 K that is not the stiffness of projected volumes.
    pub soft_part: f64,
}

/// K without viscosities, assembled when a factorisation asks for it.
#[derive(Debug, Default)]
pub(super) struct ElasticStiffness {
    assembly: Option<Assembly>,
    /// Whether it is K at the present displacement.
    is_current: bool,
}

impl ElasticStiffness {
    /// Tells that K is taken at another displacement.
    pub(super) fn invalidate(&mut self) {
        self.is_current = false;
    }

    fn assemble(&mut self, body: &Body, undamped: &StepInput<'_>) -> Result<&StageMatrix> {
        let assembly = self.assembly.get_or_insert_with(|| body.assembly_to_keep(undamped.rule));
        if !self.is_current {
            body.assemble(undamped, Request::Tangent, &[0.0], assembly)?;
            self.is_current = true;
        }
        Ok(&assembly.matrix)
    }
}

/// The modes of the stage equations with their solvers.
#[derive(Debug)]
pub(super) struct ModeSolvers {
    modes: Vec<StageMode>,
    /// Coefficients of the inertia without drag, and of the response, `[i k + j]`.
    mass: Vec<f64>,
    response: Vec<f64>,
    /// The time s of the present modes, if they depend on it.
    modes_for: Option<f64>,
    solvers: Vec<Box<dyn ShiftedSolver>>,
    /// Condensation of the internal nodes, if the body has some: the solvers see the nodes of the mesh alone.
    condensation: Option<Condensation>,
    /// The time s of the solvers.
    time_scale: f64,
    /// Their stiffness number.
    number: f64,
    /// The requested solver.
    requested: Solver,
    /// Kinds that failed with [`Solver::Auto`].
    failed: Vec<SolverKind>,
    /// Kinds from which [`Solver::Auto`] chooses: all; on a team conjugate gradients and its engines.
    kinds: Vec<SolverKind>,
    costs: Costs,
    choice: Option<SolverChoice>,
    n_dofs: usize,
    columns: Vec<f64>,
}

impl ModeSolvers {
    /// The modes of a body; their solvers are created with the first stiffness.
    ///
    /// # Errors
    /// [`crate::Error::Linear`]; [`crate::Error::NotOnTeam`] for a factorisation by a team without engine.
    pub(super) fn new(body: &Body, coefficients: &StageCoefficients, requested: Solver) -> Result<Self> {
        let (k, n) = (coefficients.rule.degree(), body.n_dofs());
        let is_alone = !body.space.is_shared();
        let is_here =
            |kind: &SolverKind| is_alone || *kind == SolverKind::Iterative || engine(body, *kind).is_some();
        let kinds: Vec<SolverKind> = SolverKind::ALL.into_iter().filter(is_here).collect();
        if requested == Solver::Direct && !kinds.contains(&SolverKind::Direct) {
            return Err(no_factorization());
        }
        Ok(ModeSolvers {
            modes: modes(&coefficients.inverse_mass, &coefficients.response)?,
            mass: coefficients.mass.clone(),
            response: coefficients.response.clone(),
            modes_for: None,
            solvers: Vec::new(),
            condensation: None,
            time_scale: 0.0,
            number: 0.0,
            requested,
            failed: Vec::new(),
            kinds,
            costs: Costs::of(body),
            choice: None,
            n_dofs: n,
            columns: vec![0.0; if k > 1 { 2 * n } else { n }],
        })
    }

    /// Modulus of the largest eigenvalue of `m^-1 w`.
    pub(super) fn largest_modulus(&self) -> f64 {
        self.modes.iter().map(StageMode::modulus).fold(0.0, f64::max)
    }

    /// The solver, once there is one.
    pub(super) fn choice(&self) -> Option<SolverChoice> {
        self.choice
    }

    /// Whether the present solver is of a kind.
    fn is(&self, kind: SolverKind) -> bool {
        self.choice.is_some_and(|choice| choice.kind == kind)
    }

    /// Whether conjugate gradients solve systems that the mass dominates.
    pub(super) fn is_of_mass(&self) -> bool {
        self.is(SolverKind::Iterative) && self.number < LEAST_OF_STIFFNESS
    }

    /// Cost of a new stiffness, in corrections with the old one.
    pub(super) fn refactorization_cost(&self) -> f64 {
        let costs = self.solvers.iter().map(|solver| solver.refactorization_cost());
        costs.fold(0.0, f64::max)
    }

    /// Sets the solvers to a stiffness and a time s.
    ///
    /// # Errors
    /// [`crate::Error::Linear`].
    pub(super) fn set(&mut self, body: &Body, mut stiffness: Stiffness<'_>, time_scale: f64) -> Result<()> {
        if body.dissipates() && self.modes_for != Some(time_scale) {
            self.set_modes(body, time_scale)?;
        }
        // In 16 bits a stiffness of projected volumes is indefinite, and sweeps do not smooth its volumes.
        let is_stiff = stiffness.soft_part < MIN_SOFT_FRACTION;
        let scale = time_scale * time_scale * self.largest_modulus();
        let number = scale * stiffness_over_mass(body, stiffness.matrix);
        self.time_scale = time_scale;
        self.number = number;
        loop {
            let chosen = self.choose(body, number, is_stiff);
            let done = body.space.agree(chosen).and_then(|()| self.factorize(body, &mut stiffness, number));
            let done = body.space.agree(done);
            let Err(error) = &done else { return done };
            match self
                .choice
                .filter(|_| self.requested == Solver::Auto && !is_stiff)
                .map(|choice| choice.kind)
            {
                Some(kind) if body.space.is_shared() && !self.failed.contains(&kind) => self.exclude(kind),
                Some(SolverKind::Direct)
                    if matches!(error, Error::OutOfMemory { .. })
                        && !body.space.is_shared()
                        && !self.failed.contains(&SolverKind::Multigrid) =>
                {
                    self.exclude(SolverKind::Direct);
                }
                _ => return done,
            }
        }
    }

    /// `number`: the stiffness number.
    fn factorize(&mut self, body: &Body, given: &mut Stiffness<'_>, number: f64) -> Result<()> {
        let Stiffness { matrix: mut stiffness, positions, viscous_rate, undamped, .. } = *given;
        let (mut mass, mut fixed) = (body.carried_mass(), body.space.inactive());
        let elastic = given.elastic.as_mut().filter(|_| self.is(SolverKind::Direct));
        let elastic = elastic.map(|elastic| elastic.assemble(body, undamped)).transpose()?;
        let elastic = elastic
            .map(|elastic| (elastic, [stiffness, elastic].map(|matrix| stiffness_over_mass(body, matrix))));
        if let Some(condensation) = &mut self.condensation {
            body.space.agree(condensation.condense(body.pattern(), stiffness, body.fixed()))?;
            (stiffness, mass) = (&condensation.stiffness, &condensation.mass);
            fixed = &fixed[..3 * condensation.pattern.n_rows()];
        }
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            let (shift, elastic, number) = match &elastic {
                None => (shift(mode, self.time_scale), None, number),
                Some((elastic, ratios)) => {
                    let shifts = separate_shifts(mode, self.time_scale, viscous_rate, body.viscous_time());
                    let moduli = shifts.map(|[re, im]| re.hypot(im));
                    let number = moduli[0] * ratios[0] + moduli[1] * ratios[1];
                    (shifts[0], Some((*elastic, shifts[1])), number)
                }
            };
            let in_single_precision = number <= MOST_IN_SINGLE_PRECISION;
            let system = Shifted { stiffness, mass, fixed, positions, shift, elastic, in_single_precision };
            solver.factorize(&system)?;
        }
        Ok(())
    }

    /// Sets the modes of a body with viscosity or drag. Viscosities are represented by a time t_v that multiplies the
    /// stiffness.
    ///
    /// ```math
    /// m_ij + s alpha delta_ij,    w_ij + t_v/s delta_ij
    /// ```
    fn set_modes(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        let mass = with_diagonal(&self.mass, time_scale * body.drag());
        let response = with_diagonal(&self.response, body.viscous_time() / time_scale);
        self.modes = modes(&inverse(&mass), &response)?;
        self.modes_for = Some(time_scale);
        Ok(())
    }

    /// Creates the requested solvers, or with [`Solver::Auto`] the cheapest ones. Existing solvers are replaced only
    /// when another kind has become clearly cheaper. `is_stiff`: projected volumes need a factorisation.
    fn choose(&mut self, body: &Body, number: f64, is_stiff: bool) -> Result<()> {
        let kind = match self.requested {
            // Blocks in 16 bits would limit the contraction of corrections that are exact otherwise.
            Solver::Auto if body.mesh().n_cells() == 0 => Some(SolverKind::Direct),
            Solver::Auto => None,
            Solver::Iterative if !is_stiff => Some(SolverKind::Iterative),
            Solver::Multigrid if !is_stiff => Some(SolverKind::Multigrid),
            Solver::Direct | Solver::Iterative | Solver::Multigrid => Some(SolverKind::Direct),
        };
        let present = self.choice.filter(|_| !self.solvers.is_empty()).map(|choice| choice.kind);
        if kind.is_some() && present.is_some() {
            return Ok(());
        }
        if is_stiff && !self.kinds.contains(&SolverKind::Direct) {
            body.space.check_whole("a factorisation, which these stiff projected volumes need, without MUMPS (feature `petsc` of emmy-mpi)")?;
        }
        let failed: &[SolverKind] = if is_stiff { &SolverKind::ALL } else { &self.failed };
        let choice = match kind {
            Some(kind) => SolverChoice { kind, stiffness: number, limit: None, engine: None },
            None => self.costs.cheapest(number, (&self.kinds, failed), present),
        };
        if present == Some(choice.kind) {
            return Ok(());
        }
        self.solvers.clear();
        self.choice = Some(choice);
        self.create(body, choice)
    }

    fn create(&mut self, body: &Body, choice: SolverChoice) -> Result<()> {
        self.condensation = body.condensation(body.carried_mass());
        let pattern = self.condensation.as_ref().map_or(body.pattern(), |condensation| &condensation.pattern);
        let fixed = &body.space.inactive()[..3 * pattern.n_rows()];
        let order = || -> Result<Vec<usize>> {
            Ok(body.node_order()?.iter().copied().filter(|&node| node < pattern.n_rows()).collect())
        };
        let part = body.space.shared();
        let needs_sweep = choice.kind != SolverKind::Direct || part.is_some();
        let sweep = needs_sweep.then(|| Arc::new(SweepOrder::new(pattern)));
        let shared = || part.cloned().zip(sweep.as_ref()).map(|(own, sweep)| SharedRows::new(own, sweep));
        let is_mixed = body.has_local();
        for mode in &self.modes {
            if let (Some(sweep), Some(rows), Some(engine)) = (&sweep, shared(), engine(body, choice.kind)) {
                self.choice = Some(SolverChoice { engine: Some(engine.name()), ..choice });
                let on = (sweep.clone(), rows);
                let costs = (setup_cost(body, choice.kind), is_mixed);
                self.solvers.push(match mode.n_columns() {
                    1 => Box::new(TeamSolver::<1>::new(pattern, fixed, on, engine, costs)),
                    _ => Box::new(TeamSolver::<2>::new(pattern, fixed, on, engine, costs)),
                });
                continue;
            }
            self.solvers.push(match (&sweep, choice.kind, mode.n_columns()) {
                (Some(sweep), SolverKind::Iterative, 1) => {
                    Box::new(Iterative::<1>::new(fixed, sweep.clone(), shared()))
                }
                (Some(sweep), SolverKind::Iterative, _) => {
                    Box::new(Iterative::<2>::new(fixed, sweep.clone(), shared()))
                }
                (Some(sweep), SolverKind::Multigrid, 1) => {
                    Box::new(Multigrid::<1>::new(pattern, fixed, sweep.clone())?.on(shared()))
                }
                (Some(sweep), SolverKind::Multigrid, _) => {
                    Box::new(Multigrid::<2>::new(pattern, fixed, sweep.clone())?.on(shared()))
                }
                (_, SolverKind::Direct, _) if part.is_some() => return Err(no_factorization()),
                (_, _, 2) => Box::new(DirectPair::new(pattern, fixed, &order()?)?),
                _ => Box::new(Direct::new(pattern, fixed, &order()?)?),
            });
        }
        Ok(())
    }

    /// Whether [`ModeSolvers::couple`] works: several stages have couplings that no change of basis decouples.
    pub(super) fn takes_couplings(&self) -> bool {
        matches!(&self.solvers[..], [solver] if solver.takes_couplings())
    }

    /// Adds `R^T A R` to the linearised stage equations, in the place of earlier couplings, with the symmetric part A
    /// of some and the rotation R of each node.
    pub(super) fn couple(&mut self, couplings: &Couplings, R: &dyn Fn(usize) -> Mat3<f64>) {
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            solver.couple(couplings, (mode.forward[0] * mode.backward[0], R));
        }
    }

    /// Solves mode by mode to a relative tolerance and adds the solutions to z; `r`, `z`: `[k][n_nodes][3]`. Returns
    /// the number of iterations, `None` if a solver missed the tolerance.
    pub(super) fn solve(&mut self, r: &[f64], z: &mut [f64], tolerance: f64) -> Option<usize> {
        let mut total = Some(0);
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            let columns = &mut self.columns[..self.n_dofs * mode.n_columns()];
            mode.restrict(r, columns);
            let [re, im] = shift(mode, self.time_scale);
            let square = re * re + im * im;
            let condensation = (self.condensation.as_mut(), [re / square, -im / square]);
            let iterations = condensed(condensation, columns, mode.n_columns(), |columns| {
                solver.solve(columns, tolerance)
            });
            total = iterations.and_then(|n| total.map(|total| total + n));
            mode.add_to(&mode.backward, columns, z);
        }
        total
    }

    /// Adds a linear map of r to z that approximates [`ModeSolvers::solve`].
    pub(super) fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            let columns = &mut self.columns[..self.n_dofs * mode.n_columns()];
            mode.restrict(r, columns);
            let [re, im] = shift(mode, self.time_scale);
            let square = re * re + im * im;
            let (inverse, backward) = match solver.is_exact() {
                true => ([re / square, -im / square], &mode.backward),
                false => ([1.0 / square.sqrt(), 0.0], &mode.turned),
            };
            let condensation = (self.condensation.as_mut(), inverse);
            condensed(condensation, columns, mode.n_columns(), |columns| solver.precondition(columns));
            mode.add_to(backward, columns, z);
        }
    }

    /// Changes to another kind from the next stiffness on if the present one failed with [`Solver::Auto`]; `is_shared`:
    /// by a team.
    pub(super) fn fall_back(&mut self, is_shared: bool) {
        let replaceable = self.choice.filter(|choice| is_shared || choice.kind != SolverKind::Direct);
        if let (Solver::Auto, Some(choice)) = (self.requested, replaceable) {
            self.exclude(choice.kind);
        }
    }

    fn exclude(&mut self, kind: SolverKind) {
        self.failed.push(kind);
        self.solvers.clear();
    }

    /// Keeps the memory that the next steps depend on.
    pub(super) fn save(&self, memory: &mut Memory) {
        for (name, kind) in FAILED {
            memory.save_flag(name, self.failed.contains(&kind));
        }
        memory.save_flag("solver.is_ready", !self.solvers.is_empty());
        memory.save_flag("solver.is_chosen", self.choice.is_some());
        if let Some(choice) = self.choice {
            memory.save_word("solver.kind", choice.kind.name());
            memory.save_number("solver.stiffness", choice.stiffness);
            memory.save_option("solver.limit", choice.limit);
        }
    }

    /// Restores the data of [`ModeSolvers::save`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`], [`crate::Error::Linear`].
    pub(super) fn restore(&mut self, body: &Body, memory: &Memory) -> Result<()> {
        self.failed.clear();
        for (name, kind) in FAILED {
            if memory.flag(name)? {
                self.failed.push(kind);
            }
        }
        self.choice = None;
        if memory.flag("solver.is_chosen")? {
            let name = memory.word("solver.kind")?;
            let kind = SolverKind::named(name).ok_or_else(|| Error::Memory {
                name: "solver.kind".to_string(),
                reason: format!("is `{name}`, which is no solver"),
            })?;
            let limit = memory.option("solver.limit")?;
            self.choice = Some(SolverChoice {
                kind,
                stiffness: memory.number("solver.stiffness")?,
                limit,
                engine: None,
            });
        }
        self.solvers.clear();
        let is_ready = memory.flag("solver.is_ready")?;
        // The run may come from another number of ranks, which had other solvers: the next stiffness has one of its
        // own.
        let has_direct = self.kinds.contains(&SolverKind::Direct);
        self.choice = self.choice.filter(|choice| choice.kind != SolverKind::Direct || has_direct);
        let created = self.choice.filter(|_| is_ready).map_or(Ok(()), |choice| self.create(body, choice));
        body.space.agree(created)
    }
}

/// The engine of the team for a kind of solver.
fn engine(body: &Body, kind: SolverKind) -> Option<Box<dyn Engine>> {
    let kind = match kind {
        SolverKind::Direct => EngineKind::Factorization,
        SolverKind::Multigrid => EngineKind::Multigrid,
        SolverKind::Iterative => return None,
    };
    body.space.shared()?.team().engine(kind)
}

fn no_factorization() -> Error {
    let what = "a factorisation without MUMPS (feature `petsc` of emmy-mpi)";
    Error::NotOnTeam { what: what.to_string() }
}

/// Cost of a new stiffness with an engine, in solutions.
fn setup_cost(body: &Body, kind: SolverKind) -> f64 {
    match kind {
        SolverKind::Direct => factorization_cost(body.n_dofs_of_ranks()),
        // As in one process.
        SolverKind::Iterative | SolverKind::Multigrid => 16.0,
    }
}

/// Solves for the columns of all nodes by a solver of the nodes of the mesh; `inverse_shift`: 1/lambda of the solver.
fn condensed<T>(
    (condensation, inverse_shift): (Option<&mut Condensation>, [f64; 2]),
    columns: &mut [f64],
    n_columns: usize,
    solve: impl FnOnce(&mut [f64]) -> T,
) -> T {
    let Some(condensation) = condensation else { return solve(columns) };
    let outcome = solve(condensation.reduce(columns, n_columns));
    condensation.expand(inverse_shift, columns, n_columns);
    outcome
}

/// lambda of a mode.
fn shift(mode: &StageMode, time_scale: f64) -> [f64; 2] {
    mode.eigenvalue.map(|part| time_scale * time_scale * part)
}

/// Whether factorisations of a body take its viscosities apart from K. They need not for degree 1, where K contains
/// them exactly at its own time s, and cannot where internal nodes are condensed or by a team, which have one matrix.
pub(super) fn separated(body: &Body, degree: usize) -> bool {
    let has_one_matrix = body.space.is_shared() || body.space.has_internal_nodes();
    degree > 1 && !has_one_matrix && body.has_uneven_viscosity()
}

/// The factors a, b with which `M + a K_v + b K` is `M + s^2 lambda K + s nu C`, for `K_v = (K + 2 rate C)/(1 + 2 rate
/// t_v)`; lambda without the mean viscosity that the eigenvalue of the mode contains, `nu t_v/s`.
fn separate_shifts(mode: &StageMode, s: f64, viscous_rate: f64, viscous_time: f64) -> [[f64; 2]; 2] {
    let rate = 2.0 * viscous_rate;
    let viscous = mode.inverse_mass.map(|nu| s * nu / rate);
    let elastic = |part: usize| {
        s * s * mode.eigenvalue[part] - s * viscous_time * mode.inverse_mass[part] - viscous[part]
    };
    [viscous.map(|part| (1.0 + rate * viscous_time) * part), [elastic(0), elastic(1)]]
}

/// A square matrix with a number added to its diagonal.
fn with_diagonal(matrix: &[f64], value: f64) -> Vec<f64> {
    let mut matrix = matrix.to_vec();
    let k = matrix.len().isqrt();
    (0..k).for_each(|i| matrix[i * k + i] += value);
    matrix
}

/// Largest ratio of a diagonal entry of K to the mass of its node; internal nodes have none.
fn stiffness_over_mass(body: &Body, stiffness: &StageMatrix) -> f64 {
    let (pattern, inactive) = (body.pattern(), body.space.inactive());
    let of_node = |node: usize| {
        let diagonal = stiffness.block(pattern.position(node, node).unwrap_or(0));
        let free = (0..3).filter(move |a| !inactive[3 * node + a]);
        free.map(|a| diagonal[4 * a].abs()).fold(0.0, f64::max) / body.lumped_mass()[node]
    };
    let mut most = [(0..body.mesh().n_dofs() / 3).map(of_node).fold(0.0, f64::max)];
    body.space.largest_of_ranks("stiffness over mass", &mut most);
    most[0]
}

/// Names in checkpoints of the kinds that may fail.
const FAILED: [(&str, SolverKind); 3] = [
    ("solver.failed.iterative", SolverKind::Iterative),
    ("solver.failed.multigrid", SolverKind::Multigrid),
    ("solver.failed.direct", SolverKind::Direct),
];

/// Largest stiffness number for factors in single precision. It bounds the condition number of `M + lambda K`, and a
/// solution loses about 1e-9 times it. With 1e6, GMRES with the exact tangent of a stiff body that turns takes a
/// correction more: it does not notice that rounding.
const MOST_IN_SINGLE_PRECISION: f64 = 1e5;

/// Stiffness number below which the mass dominates. On the L-block at r = 4, with h = 0.02 to 0.5 and degrees 1 to 3,
/// the basis of the rates that strain a body costs up to a half below 20, nothing at 50, and saves a half and more from
/// 170 on, where a step turns by 0.2 rad.
const LEAST_OF_STIFFNESS: f64 = 30.0;

/// Smallest part of M + s^2 K beside projected volumes for conjugate gradients without a factorisation.
const MIN_SOFT_FRACTION: f64 = 1.0 / 30.0;
