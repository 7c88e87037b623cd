//! Linear solvers of other libraries that work on the rows of all ranks.

use std::fmt;

/// Kinds of engines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EngineKind {
    /// A sparse factorisation.
    Factorization,
    /// A cycle of algebraic multigrid.
    Multigrid,
}

impl EngineKind {
    /// Its name, in messages.
    ///
    /// ```
    /// use emmy::team::{Alone, EngineKind, Team};
    /// assert_eq!(EngineKind::Factorization.name(), "factorisation");
    /// assert!(Alone.engine(EngineKind::Factorization).is_none());
    /// ```
    pub const fn name(self) -> &'static str {
        match self {
            EngineKind::Factorization => "factorisation",
            EngineKind::Multigrid => "multigrid",
        }
    }
}

/// An approximate inverse of symmetric matrices whose rows are divided among the ranks of a team, from a library for
/// many processes. Conjugate gradients of this library use it as a preconditioner, so that its accuracy decides only
/// the number of their iterations.
///
/// Every method is a call of all ranks.
pub trait Engine: fmt::Debug + Send {
    /// Its name, for summaries.
    fn name(&self) -> &'static str;

    /// Sets the matrix. The couplings are the same in every call.
    ///
    /// # Errors
    /// A text, on all ranks, if it has no inverse of this matrix or not enough memory for it.
    fn set(&mut self, rows: &OwnRows<'_>) -> Result<(), String>;

    /// Replaces the right-hand side of the own rows by their solution, `[row][3]`: always the same symmetric linear
    /// map. An inverse that fails fills them with NaN.
    fn apply(&mut self, x: &mut [f64]);
}

/// The rows of a symmetric matrix in 3 x 3 blocks that a rank owns. All ranks number their rows one after the other,
/// rank by rank.
#[derive(Debug, Clone, Copy)]
pub struct OwnRows<'a> {
    /// Number of the first own row.
    pub first: usize,
    /// Number of rows of all ranks.
    pub n_of_ranks: usize,
    /// Start of each own row in the couplings, and the end of the last one.
    pub begin: &'a [usize],
    /// Number of the other row of each coupling, among those of all ranks.
    pub columns: &'a [usize],
    /// Blocks by rows, `[coupling][3][3]`. Fixed components have the rows and columns of the unit matrix.
    pub blocks: &'a [f64],
    /// Positions at which rigid motions cost no energy but the kinetic one, `[row][3]`: for the near-null space of
    /// multigrid.
    pub positions: &'a [f64],
}
