//! Which linear solver a step uses, and why.

use std::fmt;

/// The linear solver that the settings ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// The cheaper one: see [`SolverChoice`].
    #[default]
    Auto,
    /// Sparse Cholesky factorisation.
    Direct,
    /// Conjugate gradients, preconditioned by an incomplete Cholesky factor.
    Iterative,
}

/// All there are, with their names.
pub const SOLVERS: [(&str, Solver, &str); 3] = [
    ("auto", Solver::Auto, "conjugate gradients or Cholesky factorisation, by what the first step asks for"),
    ("direct", Solver::Direct, "sparse Cholesky factorisation, kept over steps"),
    (
        "iterative",
        Solver::Iterative,
        "conjugate gradients with an incomplete Cholesky factor, kept over steps",
    ),
];

/// Kinds of linear solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolverKind {
    /// Sparse Cholesky factorisation.
    Direct,
    /// Conjugate gradients, preconditioned by an incomplete Cholesky factor.
    Iterative,
}

impl SolverKind {
    /// All kinds.
    pub const ALL: [SolverKind; 2] = [SolverKind::Direct, SolverKind::Iterative];

    /// Key word, as in [`SOLVERS`]; in files.
    pub const fn name(self) -> &'static str {
        match self {
            SolverKind::Direct => "direct",
            SolverKind::Iterative => "iterative",
        }
    }
}

/// The solver that was chosen.
///
/// Conjugate gradients need about `sqrt(c)` iterations, c being the stiffness number
///
/// ```math
/// c = max_dof s^2 |lambda| K_dd / m_d
/// ```
///
/// (s: time scale of the stage equations, the step size of a time element; lambda: largest eigenvalue of the stage coupling; m:
/// lumped mass): the square of the number of cells that a wave crosses in a step, but for a factor. The fill of a factorisation
/// grows with the number of nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverChoice {
    /// Its kind.
    pub kind: SolverKind,
    /// The stiffness number.
    pub stiffness: f64,
    /// Stiffness number up to which conjugate gradients are chosen; `None` where a solver was requested, or where conjugate
    /// gradients failed.
    pub limit: Option<f64>,
}

impl fmt::Display for SolverChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.kind {
            SolverKind::Direct => "Cholesky factorisation",
            SolverKind::Iterative => "conjugate gradients with incomplete Cholesky factors",
        };
        write!(f, "{name} (stiffness number {:.2e}", self.stiffness)?;
        match self.limit {
            Some(limit) => write!(f, "; iterative up to {limit:.1e})"),
            None => write!(f, ")"),
        }
    }
}
