//! The graph of a pattern, and the calls of METIS (Karypis and Kumar 1998).

use std::ptr;
use std::sync::{Mutex, PoisonError};

use super::Pattern;
use crate::error::{Error, Result};

/// METIS uses one random sequence for the whole process, restarted by each call: sequential calls always give the same
/// result, concurrent calls would not.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Couplings of the outer rows with each other, without those of a row with itself.
pub(super) struct Graph {
    /// Start of the neighbours of each row, `[n + 1]`: ascending, from 0 to the number of neighbours.
    begin: Vec<i32>,
    /// Neighbours, below n.
    neighbours: Vec<i32>,
}

impl Graph {
    /// The graph of a pattern.
    ///
    /// # Errors
    /// [`Error::Linear`] if the pattern is too large for the 32-bit indices of METIS.
    pub(super) fn new(pattern: &Pattern) -> Result<Self> {
        if pattern.n_blocks() > i32::MAX as usize {
            return Err(Error::Linear { reason: "more than 2^31 couplings: too many for METIS".into() });
        }
        let n = pattern.n_outer();
        let mut begin = vec![0i32];
        let mut neighbours = Vec::with_capacity(pattern.n_blocks() - n);
        for row in 0..n {
            let is_other = |&&column: &&u32| column as usize != row && (column as usize) < n;
            let others = pattern.row(row).iter().filter(is_other);
            neighbours.extend(others.map(|&column| column as i32));
            begin.push(neighbours.len() as i32);
        }
        Ok(Graph { begin, neighbours })
    }

    /// Whether no two rows are coupled: METIS divides by the number of couplings.
    pub(super) fn is_empty(&self) -> bool {
        self.neighbours.is_empty()
    }

    /// Nested dissection: `order[new] = old`.
    ///
    /// # Errors
    /// [`Error::Linear`].
    #[allow(unsafe_code)]
    pub(super) fn dissect(mut self) -> Result<Vec<i32>> {
        let n = self.begin.len() - 1;
        let (mut order, mut inverse) = (vec![0i32; n], vec![0i32; n]);
        let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: `begin` has n + 1 ascending entries that end at `neighbours.len()`, every neighbour is below n (both
        // by construction of `Pattern`), the two results have n entries, and METIS takes null for weights and options.
        let status = unsafe {
            metis_sys::METIS_NodeND(
                &mut (n as i32),
                self.begin.as_mut_ptr(),
                self.neighbours.as_mut_ptr(),
                ptr::null_mut(),
                ptr::null_mut(),
                order.as_mut_ptr(),
                inverse.as_mut_ptr(),
            )
        };
        checked(status, order)
    }

    /// The part of each row, below `n_parts`; parts have about equal numbers of couplings and few couplings with
    /// others.
    ///
    /// # Errors
    /// [`Error::Linear`].
    #[allow(unsafe_code)]
    pub(super) fn partition(mut self, n_parts: usize) -> Result<Vec<i32>> {
        let n = self.begin.len() - 1;
        let mut weights: Vec<i32> = self.begin.windows(2).map(|range| 1 + range[1] - range[0]).collect();
        let mut parts = vec![0i32; n];
        // Better parts if there are few of them, less time if there are many.
        let divide =
            if n_parts <= 8 { metis_sys::METIS_PartGraphRecursive } else { metis_sys::METIS_PartGraphKway };
        let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: as in `dissect`; `weights` and `parts` have n entries, there is one constraint, and METIS takes null
        // for the other weights, targets and options.
        let status = unsafe {
            divide(
                &mut (n as i32),
                &mut 1,
                self.begin.as_mut_ptr(),
                self.neighbours.as_mut_ptr(),
                weights.as_mut_ptr(),
                ptr::null_mut(),
                ptr::null_mut(),
                &mut (n_parts as i32),
                ptr::null_mut(),
                ptr::null_mut(),
                ptr::null_mut(),
                &mut 0,
                parts.as_mut_ptr(),
            )
        };
        checked(status, parts)
    }
}

fn checked(status: i32, result: Vec<i32>) -> Result<Vec<i32>> {
    if status == metis_sys::rstatus_et_METIS_OK {
        return Ok(result);
    }
    Err(Error::Linear { reason: format!("METIS failed with status {status}") })
}
