//! The linear solver of a step, and the reason for it.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The requested linear solver. A team's engine ([`crate::team::Engine`]) factorises and runs multigrid. Without an
/// engine, each rank runs multigrid on its own rows, and factorisations are rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// The cheaper one: see [`SolverChoice`].
    #[default]
    Auto,
    /// Sparse Cholesky factorisation.
    Direct,
    /// Conjugate gradients, preconditioned by an incomplete Cholesky factor; stiff projected volumes are factorised in
    /// any case.
    Iterative,
    /// Conjugate gradients, preconditioned by multigrid; stiff projected volumes are factorised in any case.
    Multigrid,
}

/// All solvers with their names.
pub const SOLVERS: [(&str, Solver, &str); 4] = [
    (Solver::Auto.name(), Solver::Auto, "the cheapest of the others, by size and stiffness number"),
    (Solver::Direct.name(), Solver::Direct, "sparse Cholesky factorisation, kept over steps"),
    (
        Solver::Iterative.name(),
        Solver::Iterative,
        "conjugate gradients with an incomplete Cholesky factor, kept over steps",
    ),
    (
        Solver::Multigrid.name(),
        Solver::Multigrid,
        "conjugate gradients with multigrid by smoothed aggregation, kept over steps",
    ),
];

/// Kinds of linear solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolverKind {
    /// Sparse Cholesky factorisation.
    Direct,
    /// Conjugate gradients, preconditioned by an incomplete Cholesky factor.
    Iterative,
    /// Conjugate gradients, preconditioned by multigrid.
    Multigrid,
}

impl SolverKind {
    /// All kinds.
    pub(crate) const ALL: [SolverKind; 3] =
        [SolverKind::Direct, SolverKind::Iterative, SolverKind::Multigrid];

    /// Key word, in the input and in checkpoints.
    pub const fn name(self) -> &'static str {
        match self {
            SolverKind::Direct => "direct",
            SolverKind::Iterative => "iterative",
            SolverKind::Multigrid => "multigrid",
        }
    }

    /// The kind of a name; `None` if there is none.
    pub fn named(name: &str) -> Option<SolverKind> {
        SolverKind::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

impl Solver {
    /// Its name in the input.
    pub const fn name(self) -> &'static str {
        match self {
            Solver::Auto => "auto",
            Solver::Direct => SolverKind::Direct.name(),
            Solver::Iterative => SolverKind::Iterative.name(),
            Solver::Multigrid => SolverKind::Multigrid.name(),
        }
    }

    /// The solver of a name; `None` if there is none.
    ///
    /// ```
    /// use emmy::motion::Solver;
    /// assert_eq!(Solver::named("direct"), Some(Solver::Direct));
    /// ```
    pub fn named(name: &str) -> Option<Solver> {
        SOLVERS.into_iter().find(|(own, ..)| *own == name).map(|(_, solver, _)| solver)
    }
}

/// The chosen solver.
///
/// Conjugate gradients need about `sqrt(c)` iterations, c being the stiffness number
///
/// ```math
/// c = max_dof s^2 |lambda| K_dd / m_d
/// ```
///
/// (s: time scale of the stage equations, the step size of a time element; lambda: largest eigenvalue of the stage
/// coupling; m: lumped mass). Up to a factor, c is the square of the number of cells that a wave crosses in a step. The
/// fill of a factorisation grows with the number of nodes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SolverChoice {
    /// Its kind.
    pub kind: SolverKind,
    /// The stiffness number.
    pub stiffness: f64,
    /// Stiffness number up to which conjugate gradients with an incomplete factor are chosen; `None` if there was no
    /// choice.
    pub limit: Option<f64>,
    /// Name of the engine of a team ([`crate::team::Engine`]) that factorises or does the cycles.
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub engine: Option<&'static str>,
}

impl fmt::Display for SolverChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.kind {
            SolverKind::Direct => "Cholesky factorisation",
            SolverKind::Iterative => "conjugate gradients with incomplete Cholesky factors",
            SolverKind::Multigrid => "conjugate gradients with multigrid",
        };
        f.write_str(name)?;
        if let Some(engine) = self.engine {
            write!(f, " by {engine}")?;
        }
        write!(f, " (stiffness number {:.2e}", self.stiffness)?;
        match self.limit {
            Some(limit) => write!(f, "; iterative up to {limit:.1e})"),
            None => write!(f, ")"),
        }
    }
}
