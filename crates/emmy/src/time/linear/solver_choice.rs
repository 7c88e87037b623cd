//! The choice of the kind of solver by cost.

use crate::body::Body;
use crate::sparse::{SolverChoice, SolverKind};

/// Seconds of a step on one core, where memory limits all solvers, from steps of the block of `benches` at r = 2 and 4
/// with sizes between 0.02 and 0.2. Internal nodes are condensed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Costs {
    /// An iteration of conjugate gradients with an incomplete factor: 2.5 ns for each coupling of nodes. A step takes
    /// 12 sqrt(c) of them.
    iteration: f64,
    /// Ten solutions at 0.55 ns for an entry of the factor, which has about `15 n^(4/3)` entries for n degrees of
    /// freedom, as nested dissection gives in three dimensions; and a tenth of a factorisation, 10 s for n = 197
    /// thousand.
    direct: f64,
    /// 28 V-cycles of linear cells, 70 of quadratic ones, at 13 ns for each coupling; and a tenth of the setup, 800 ns
    /// for each coupling.
    multigrid: f64,
}

impl Costs {
    /// Of a body; on a team a call of all ranks, and a factorisation is one of MUMPS.
    pub(super) fn of(body: &Body) -> Self {
        let mesh = body.mesh();
        let n_quadratic = mesh.cells().filter(|cell| cell.kind != cell.kind.linear()).count();
        let Some(part) = body.space.shared() else {
            return Costs::new(mesh.n_dofs(), body.pattern().n_outer_blocks(), n_quadratic == 0);
        };
        let n_couplings: usize = (0..part.n_own()).map(|row| body.pattern().n_outer_columns(row)).sum();
        let mut of_ranks = [part.n_own() as f64, n_couplings as f64, n_quadratic as f64];
        part.sum("nodes, couplings and quadratic cells", &mut of_ranks);
        let [n_nodes, n_couplings, n_quadratic] = of_ranks;
        Costs::new(3 * n_nodes as usize, n_couplings as usize, n_quadratic == 0.0).with_engines()
    }

    /// The costs by MUMPS and GAMG.
    fn with_engines(self) -> Self {
        Costs { direct: MUMPS * self.direct, multigrid: GAMG * self.multigrid, ..self }
    }

    fn new(n_dofs: usize, n_couplings: usize, is_linear: bool) -> Self {
        let (n, n_couplings) = (n_dofs as f64, n_couplings as f64);
        let n_cycles = if is_linear { 28.0 } else { 70.0 };
        Costs {
            iteration: 2.5e-9 * n_couplings,
            direct: 10.0 * 0.55e-9 * 15.0 * n.powf(4.0 / 3.0) + (n / 197e3).powf(1.7),
            multigrid: (n_cycles * 13e-9 + 80e-9) * n_couplings,
        }
    }

    fn of_kind(&self, kind: SolverKind) -> f64 {
        if kind == SolverKind::Multigrid { self.multigrid } else { self.direct }
    }

    /// The cheapest kind that has not failed, for a stiffness number; if all have, a factorisation. The present kind
    /// stays unless another one is clearly cheaper.
    pub(super) fn cheapest(
        &self,
        stiffness: f64,
        (kinds, failed): (&[SolverKind], &[SolverKind]),
        present: Option<SolverKind>,
    ) -> SolverChoice {
        let large =
            [SolverKind::Direct, SolverKind::Multigrid].into_iter().filter(|kind| kinds.contains(kind));
        let left = large.clone().filter(|kind| !failed.contains(kind));
        let cheapest = left.min_by(|&kind, &other| self.of_kind(kind).total_cmp(&self.of_kind(other)));
        let Some(large) = cheapest.or(large.into_iter().next()) else {
            return SolverChoice { kind: SolverKind::Iterative, stiffness, limit: None, engine: None };
        };
        let ratio = self.of_kind(large) / (12.0 * self.iteration);
        let limit = if failed.contains(&SolverKind::Iterative) { 0.0 } else { ratio * ratio };
        let kind = if stiffness < limit * inertia(present) { SolverKind::Iterative } else { large };
        SolverChoice { kind, stiffness, limit: Some(limit), engine: None }
    }
}

/// Costs of factorisations by MUMPS and of GAMG on two ranks in those of [`Costs`]. A step took 0.20 and 0.31 s (7
/// thousand degrees of freedom, tet10), 0.42 and 0.29 s (4 thousand, hex8), 3.7 and 1.1 s (27 thousand, hex8).
const MUMPS: f64 = 8.0;
const GAMG: f64 = 3.0;

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
            1 => (672, 4_000),
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
        costs.cheapest(stiffness, (&SolverKind::ALL, excluded), present).kind
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
    fn a_team_takes_its_engines() {
        let (small, large) = (l_block(1), l_block(8));
        let kind = |costs: Costs, stiffness, engines: &[SolverKind], failed: &[SolverKind]| {
            costs.cheapest(stiffness, (&[&[Iterative], engines].concat(), failed), None).kind
        };
        let both = [Direct, Multigrid];
        assert_eq!([small, large].map(|costs| kind(costs, 1e5, &both, &[])), both);
        // Without one of the engines, or both.
        assert_eq!([small, large].map(|costs| kind(costs, 1e5, &[Direct], &[])), [Direct; 2]);
        assert_eq!([small, large].map(|costs| kind(costs, 1e5, &[Multigrid], &[])), [Multigrid; 2]);
        assert_eq!([small, large].map(|costs| kind(costs, 1e9, &[], &[])), [Iterative; 2]);
        assert_eq!(kind(small, 1e9, &[], &[Iterative]), Iterative);
        // After failures.
        assert_eq!(kind(small, 1.0, &both, &[Iterative]), Direct);
        assert_eq!(kind(small, 1e5, &both, &[Direct]), Multigrid);
        assert_eq!(kind(large, 1e5, &both, &[Multigrid]), Direct);
        for costs in [small, large] {
            assert_eq!(kind(costs, 1e5, &both, &[Direct, Multigrid]), Direct);
            assert_eq!(kind(costs, 1.0, &[Multigrid], &[Iterative, Multigrid]), Multigrid);
        }
    }

    /// The kind that took less time on two ranks, by MUMPS and GAMG (see [`MUMPS`]), and conjugate gradients below.
    #[test]
    fn a_team_takes_what_was_faster() {
        let kind = |costs: Costs, stiffness| {
            costs.with_engines().cheapest(stiffness, (&SolverKind::ALL, &[]), None).kind
        };
        // The bracket of `examples`, of tet10.
        let bracket = Costs::new(6_723, 49_500, false);
        assert_eq!([280.0, 2.8e4].map(|stiffness| kind(bracket, stiffness)), [Iterative, Direct]);
        for (costs, below) in [(l_block(2), 50.0), (l_block(4), 210.0)] {
            assert_eq!([below, 2.1e3].map(|stiffness| kind(costs, stiffness)), [Iterative, Multigrid]);
        }
    }

    #[test]
    fn a_kind_stays_near_the_limit() {
        let costs = l_block(4);
        let limit = costs.cheapest(1.0, (&SolverKind::ALL, &[]), None).limit.unwrap();
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
