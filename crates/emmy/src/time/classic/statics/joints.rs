//! The constraints of rigid bodies and joints in the equations of equilibrium.
//!
//! ```math
//! f(u) - F + G(u)^T lambda = 0,    Phi(u) = 0
//! ```

use std::collections::HashMap;

use super::inverse::Inverse;
use crate::average::Request;
use crate::body::{Body, Interface};
use crate::error::Result;
use crate::sparse::StageMatrix;
use crate::time::classic::Forces;
use crate::unknowns::LinearConstraints;

/// Least stiffness of an anchor, over the mean stiffness of a degree of freedom.
const LEAST_ANCHOR: f64 = 1e-3;

/// Anchor of a softened degree of freedom over the moduli of its row, which dominates that row.
const STRONG_ANCHOR: f64 = 2.0;

/// The constraints at an iterate, with the multipliers of the last equilibrium.
#[derive(Debug)]
pub(super) struct Joints {
    /// Multipliers of the equilibrium from which a step starts.
    pub multipliers: Vec<f64>,
    interface: Option<Interface>,
    /// Mean stiffness of a degree of freedom as drawn, which weighs the residuals of the constraints.
    mean_stiffness: f64,
}

impl Joints {
    /// The constraints of a body; `None` if it has none.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    pub(super) fn new(body: &Body) -> Result<Option<Self>> {
        if body.constraints().is_empty() {
            return Ok(None);
        }
        let mut forces = Forces::new(body);
        forces.assemble(&vec![0.0; body.n_dofs()], Request::Tangent)?;
        let free = (0..body.n_dofs()).filter(|&dof| !body.space.inactive()[dof]);
        let diagonal = free.map(|dof| diagonal(body, &forces.assembly.matrix, dof)).filter(|own| *own > 0.0);
        let (n, sum) = diagonal.fold((0.0, 0.0), |(n, sum), own| (n + 1.0, sum + own));
        Ok(Some(Joints {
            multipliers: vec![0.0; body.constraints().len()],
            interface: None,
            mean_stiffness: if n > 0.0 { sum / n } else { 1.0 },
        }))
    }

    /// The constraints, linearised last.
    pub(super) fn interface(&self) -> Option<&Interface> {
        self.interface.as_ref()
    }

    /// The same, to be changed.
    pub(super) fn interface_mut(&mut self) -> Option<&mut Interface> {
        self.interface.as_mut()
    }

    /// Mean stiffness of a degree of freedom.
    pub(super) fn mean_stiffness(&self) -> f64 {
        self.mean_stiffness
    }

    /// Linearises the constraints at a displacement and a time with some multipliers, and factorises the stiffness of
    /// the body, anchored at the joint nodes. Returns whether the stiffness is positive definite for allowed motions.
    ///
    /// Parts that joints alone hold have a singular stiffness of their own. Where the joint nodes are anchored, it is
    /// regular, unless a part can move with them at rest: then the whole is singular, too. A stiffness that is softened
    /// by a force on the masses of rigid bodies needs stronger anchors.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] for a stiffness that is singular or not finite, [`crate::Error::NotFiniteAt`].
    pub(super) fn factorize(
        &mut self,
        (body, stiffness): (&Body, &StageMatrix),
        (displacement, time): (&[f64], f64),
        (multipliers, is_softened): (&[f64], bool),
        inverse: &mut Inverse,
    ) -> Result<bool> {
        let constraints = (body.constraints(), body.space.inactive());
        let constraints = LinearConstraints::new(constraints, displacement, Some(time))?;
        let interface = self.interface.insert(Interface::new(body, constraints, multipliers));
        let dofs = interface.constraints.dofs();
        let least = LEAST_ANCHOR * self.mean_stiffness;
        let own = |dof: usize| match is_softened {
            false => diagonal(body, stiffness, dof),
            true => STRONG_ANCHOR * absolute_row(body, stiffness, dof),
        };
        let anchors: Vec<f64> = dofs.iter().map(|&dof| own(dof).max(least)).collect();
        let entries: HashMap<usize, f64> =
            dofs.iter().zip(&anchors).map(|(&dof, anchor)| (place(body, dof), *anchor)).collect();
        let is_definite = inverse.set_anchored(body, stiffness, &entries)?;
        let n = anchors.len();
        let mut table = vec![0.0; n * n];
        anchors.iter().enumerate().for_each(|(at, anchor)| table[at * n + at] = *anchor);
        interface.factorize(body, &table, |b| inverse.apply(body, b))?;
        Ok(is_definite && interface.is_definite()?)
    }
}

/// Place of the diagonal entry of a degree of freedom in the matrix.
fn place(body: &Body, dof: usize) -> usize {
    9 * body.pattern().coupling(dof / 3, dof / 3) + 4 * (dof % 3)
}

/// Stiffness of a degree of freedom.
fn diagonal(body: &Body, stiffness: &StageMatrix, dof: usize) -> f64 {
    let at = place(body, dof);
    stiffness.block(at / 9)[at % 9]
}

/// Sum of the moduli of the row of a degree of freedom.
fn absolute_row(body: &Body, stiffness: &StageMatrix, dof: usize) -> f64 {
    let row = 3 * (dof % 3)..3 * (dof % 3) + 3;
    let of_block = |at: usize| stiffness.block(at)[row.clone()].iter().map(|entry| entry.abs()).sum::<f64>();
    body.pattern().range(dof / 3).map(of_block).sum()
}
