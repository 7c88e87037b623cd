//! The blocks of the unknowns of a step.

/// Numbers of the unknowns of a step, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Blocks {
    /// Rates, `[k][n_nodes][3]`.
    pub rates: usize,
    /// Multipliers of constraints, `[k][n]`.
    pub multipliers: usize,
    /// Local unknowns, `[function][n]`.
    pub local: usize,
}

impl Blocks {
    /// Number of all unknowns.
    pub(crate) fn len(self) -> usize {
        self.rates + self.multipliers + self.local
    }

    /// Number of unknowns that are not local.
    pub(crate) fn n_global(self) -> usize {
        self.rates + self.multipliers
    }

    /// The blocks of a vector.
    pub(crate) fn split(self, unknowns: &[f64]) -> [&[f64]; 3] {
        let (rates, others) = unknowns.split_at(self.rates);
        let (multipliers, local) = others.split_at(self.multipliers);
        [rates, multipliers, local]
    }

    /// The blocks of a vector that changes.
    pub(crate) fn split_mut(self, unknowns: &mut [f64]) -> [&mut [f64]; 3] {
        let (rates, others) = unknowns.split_at_mut(self.rates);
        let (multipliers, local) = others.split_at_mut(self.multipliers);
        [rates, multipliers, local]
    }
}
