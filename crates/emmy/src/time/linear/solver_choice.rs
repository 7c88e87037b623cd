//! The choice of the kind of solver by cost.

use crate::body::Body;
use crate::sparse::{SolverChoice, SolverKind};

/// Seconds of a step on one core of an AMD EPYC, where memory limits all solvers, from profiles of the block of `benches`
/// at r = 2 to 8. Internal nodes are condensed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Costs {
    /// An iteration of conjugate gradients with an incomplete factor: 2 ns for each coupling of nodes. A step takes 12
    /// sqrt(c) of them.
    iteration: f64,
    /// Six solutions at 1.6 ns for an entry of the factor, which has about `15 n^(4/3)` entries for n degrees of freedom,
    /// as nested dissection gives in three dimensions; and a tenth of a factorisation, 14 s for n = 197 thousand.
    direct: f64,
    /// Six solutions at 16 ns for each coupling and V-cycle, six V-cycles of linear cells and 15 of quadratic ones, and a
    /// tenth of the setup, 800 ns for each coupling.
    multigrid: f64,
}

impl Costs {
    pub(super) fn of(body: &Body) -> Self {
        let mesh = body.mesh();
        let is_linear = mesh.cells().all(|cell| cell.kind == cell.kind.linear());
        Costs::new(mesh.n_dofs(), body.pattern().n_outer_blocks(), is_linear)
    }

    fn new(n_dofs: usize, n_couplings: usize, is_linear: bool) -> Self {
        let (n, n_couplings) = (n_dofs as f64, n_couplings as f64);
        let n_cycles = if is_linear { 6.0 } else { 15.0 };
        Costs {
            iteration: 2.0e-9 * n_couplings,
            direct: 6.0 * 1.6e-9 * 15.0 * n.powf(4.0 / 3.0) + 1.4 * (n / 197e3).powf(1.7),
            multigrid: (6.0 * n_cycles * 16e-9 + 80e-9) * n_couplings,
        }
    }

    /// The cheapest of the usable kinds for a stiffness number; the last resort is a factorisation. The present kind stays
    /// unless another one is clearly cheaper.
    ///
    /// The measured times of factorisations and of conjugate gradients with an incomplete factor cross at c = 170
    /// (r = 2) and above 600 (r = 4).
    pub(super) fn cheapest(
        &self,
        stiffness: f64,
        is_usable: impl Fn(SolverKind) -> bool,
        present: Option<SolverKind>,
    ) -> SolverChoice {
        let is_cheaper = self.multigrid < self.direct || !is_usable(SolverKind::Direct);
        let (large, cost) = match is_usable(SolverKind::Multigrid) && is_cheaper {
            true => (SolverKind::Multigrid, self.multigrid),
            false => (SolverKind::Direct, self.direct),
        };
        let is_iterative_usable = is_usable(SolverKind::Iterative);
        let limit = if is_iterative_usable { (cost / (12.0 * self.iteration)).powi(2) } else { 0.0 };
        let kind = if stiffness < limit * inertia(present) { SolverKind::Iterative } else { large };
        SolverChoice { kind, stiffness, limit: Some(limit), engine: None }
    }
}

/// The solver of a team with engines of some kinds for a body of all ranks: conjugate gradients with an incomplete factor on
/// each rank where they take fewer iterations than a cycle of multigrid costs; else a factorisation of small bodies, and
/// multigrid of large ones. Each kind that failed is followed by the next one, a factorisation last.
pub(super) fn on_team(
    n_dofs: usize,
    stiffness: f64,
    (engines, failed): (&[SolverKind], &[SolverKind]),
    present: Option<SolverKind>,
) -> SolverChoice {
    use SolverKind::{Direct, Iterative, Multigrid};
    let order = if n_dofs <= LARGEST_FACTOR { [Direct, Multigrid] } else { [Multigrid, Direct] };
    let is_left = |kind: &SolverKind| engines.contains(kind) && !failed.contains(kind);
    let last = [Direct, Multigrid].into_iter().find(|kind| engines.contains(kind));
    let Some(large) = order.into_iter().find(is_left).or(last) else {
        return SolverChoice { kind: Iterative, stiffness, limit: None, engine: None };
    };
    let limit = if failed.contains(&Iterative) { 0.0 } else { TEAM_LIMIT };
    let kind = if stiffness < limit * inertia(present) { Iterative } else { large };
    SolverChoice { kind, stiffness, limit: Some(limit), engine: None }
}

/// Stiffness number from which on a team multigrid pays with a stiffness that is kept over some five steps: Courant number
/// 120 on the block of `benches`, with PETSc's GAMG.
const TEAM_LIMIT: f64 = 5e3;

/// Degrees of freedom of all ranks up to which a factorisation takes less time than multigrid, about.
const LARGEST_FACTOR: usize = 100_000;

/// Factor on the limit of the stiffness number, so that the present kind stays near it.
fn inertia(present: Option<SolverKind>) -> f64 {
    match present {
        Some(SolverKind::Iterative) => SWITCH_RATIO,
        Some(SolverKind::Direct | SolverKind::Multigrid) => SWITCH_RATIO.recip(),
        None => 1.0,
    }
}

/// Cost of a factorisation on a team, in solutions, by the measured times of [`Costs`].
pub(super) fn factorization_cost(n_dofs: usize) -> f64 {
    let n = n_dofs as f64;
    (14.0 * (n / 197e3).powf(1.7) / (1.6e-9 * 15.0 * n.powf(4.0 / 3.0))).max(4.0)
}

/// Factor beyond the limit of the stiffness number at which solvers are replaced.
const SWITCH_RATIO: f64 = 4.0;

#[cfg(test)]
mod tests {
    use super::SolverKind::{Direct, Iterative, Multigrid};
    use super::*;

    /// The L-block with cells of 1/r: its degrees of freedom and about the number of its couplings.
    fn l_block(r: usize) -> Costs {
        let (n_dofs, n_couplings) = match r {
            2 => (3_969, 29_000),
            4 => (26_871, 212_000),
            _ => (196_875, 1_640_000),
        };
        Costs::new(n_dofs, n_couplings, true)
    }

    fn kind(
        costs: Costs,
        stiffness: f64,
        excluded: &[SolverKind],
        present: Option<SolverKind>,
    ) -> SolverKind {
        costs.cheapest(stiffness, |kind| !excluded.contains(&kind), present).kind
    }

    #[test]
    fn small_numbers_are_iterative_and_large_bodies_take_multigrid() {
        for r in [2, 4, 8] {
            assert_eq!(kind(l_block(r), 10.0, &[], None), Iterative);
        }
        assert_eq!([2, 8].map(|r| kind(l_block(r), 1e5, &[], None)), [Direct, Multigrid]);
    }

    #[test]
    fn every_kind_has_a_fall_back() {
        let (small, large) = (l_block(2), l_block(8));
        assert_eq!(kind(small, 10.0, &[Iterative], None), Direct);
        assert_eq!(kind(large, 10.0, &[Iterative], None), Multigrid);
        assert_eq!(kind(large, 1e5, &[Multigrid], None), Direct);
        // Without memory for a factorisation.
        assert_eq!(kind(small, 1e5, &[Direct], None), Multigrid);
        assert_eq!(kind(small, 1e5, &[Direct], Some(Multigrid)), Multigrid);
        assert_eq!(kind(small, 1e5, &[Direct, Multigrid], None), Direct);
    }

    #[test]
    fn a_team_takes_engines_for_stiff_bodies() {
        let (small, large, both) = (50_000, 500_000, [Direct, Multigrid]);
        let kind = |n_dofs, stiffness, engines: &[SolverKind], failed: &[SolverKind]| {
            on_team(n_dofs, stiffness, (engines, failed), None).kind
        };
        assert_eq!([small, large].map(|n| kind(n, 4e3, &both, &[])), [Iterative; 2]);
        assert_eq!([small, large].map(|n| kind(n, 6e3, &both, &[])), [Direct, Multigrid]);
        // Without one of the engines, or both.
        assert_eq!([small, large].map(|n| kind(n, 6e3, &[Direct], &[])), [Direct; 2]);
        assert_eq!([small, large].map(|n| kind(n, 6e3, &[Multigrid], &[])), [Multigrid; 2]);
        assert_eq!([small, large].map(|n| kind(n, 1e9, &[], &[])), [Iterative; 2]);
        assert_eq!(kind(small, 1e9, &[], &[Iterative]), Iterative);
        // After failures.
        assert_eq!(kind(small, 1.0, &both, &[Iterative]), Direct);
        assert_eq!(kind(small, 1e5, &both, &[Direct]), Multigrid);
        assert_eq!(kind(large, 1e5, &both, &[Multigrid]), Direct);
        for n_dofs in [small, large] {
            assert_eq!(kind(n_dofs, 1e5, &both, &[Direct, Multigrid]), Direct);
            assert_eq!(kind(n_dofs, 1.0, &[Multigrid], &[Iterative, Multigrid]), Multigrid);
        }
        let with = |stiffness, present| on_team(small, stiffness, (&both, &[]), Some(present)).kind;
        assert_eq!([2e4 - 1.0, 2e4].map(|stiffness| with(stiffness, Iterative)), [Iterative, Direct]);
        assert_eq!([1250.0 - 1.0, 1250.0].map(|stiffness| with(stiffness, Direct)), [Iterative, Direct]);
    }

    #[test]
    fn a_kind_stays_near_the_limit() {
        let costs = l_block(4);
        let limit = costs.cheapest(1.0, |_| true, None).limit.unwrap();
        let large = kind(costs, 1e9, &[], None);
        for (stiffness, from_iterative, from_large) in [
            (limit / 5.0, Iterative, Iterative),
            (limit / 3.0, Iterative, large),
            (3.0 * limit, Iterative, large),
            (5.0 * limit, large, large),
        ] {
            assert_eq!(kind(costs, stiffness, &[], Some(Iterative)), from_iterative);
            assert_eq!(kind(costs, stiffness, &[], Some(large)), from_large);
        }
    }
}
