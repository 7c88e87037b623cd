//! Stiffness and mass of a body, linearised about a displacement.

#![allow(non_snake_case)]

use crate::average::Request;
use crate::body::{Assembly, Body};
use crate::error::Result;
use crate::sparse::reduce::dot;
use crate::sparse::{BLOCK, BlockCholesky, Pencil};
use crate::time::classic::Forces;

/// Eigenvalues below this, relative to the largest one, are rounding.
const ROUNDING: f64 = 1e-14;

/// Factor of the shift from one attempt to the next, while the shifted stiffness is indefinite.
const LARGER: f64 = 10.0;

/// The symmetric stiffness of a body at a displacement.
pub(super) struct Linearised {
    assembly: Assembly,
}

impl Linearised {
    /// The stiffness in the reference configuration, without loads.
    ///
    /// # Errors
    /// As [`Linearised::at`].
    pub(super) fn at_reference(body: &Body) -> Result<Self> {
        Linearised::at(body, &vec![0.0; body.n_dofs()], None)
    }

    /// The stiffness at a displacement `[n_nodes][3]`, with the follower pressures of a time.
    ///
    /// # Errors
    /// [`crate::Error::Constrained`], [`crate::Error::Inverted`], [`crate::Error::NotFiniteAt`].
    pub(super) fn at(body: &Body, displacement: &[f64], time: Option<f64>) -> Result<Self> {
        body.check_unconstrained("a search for natural modes")?;
        let mut forces = Forces::new(body);
        forces.assemble(displacement, Request::Tangent)?;
        if let Some(time) = time {
            forces.add_external_tangent(displacement, time)?;
        }
        let mut assembly = forces.assembly;
        assembly.matrix.symmetrize(body.pattern());
        Ok(Linearised { assembly })
    }
}

/// Stiffness, consistent mass, and a factorisation of `K + s M` on the free degrees of freedom.
pub(super) struct BodyPencil<'a> {
    body: &'a Body,
    linearised: &'a mut Linearised,
    factor: BlockCholesky,
    shift: f64,
}

impl<'a> BodyPencil<'a> {
    /// Memory for the factorisation.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(super) fn new(body: &'a Body, linearised: &'a mut Linearised) -> Result<Self> {
        let mut factor = BlockCholesky::new(body.pattern(), 3, body.fixed(), body.node_order()?)?;
        factor.reserve(BLOCK)?;
        Ok(BodyPencil { body, linearised, factor, shift: 0.0 })
    }

    /// Factorises `K + s M` with the smallest of `shift`, 10 `shift`, ... for which it is positive definite: then every
    /// eigenvalue is above -s, unstable ones included.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if the matrix is not finite.
    pub(super) fn factorize(&mut self, shift: f64) -> Result<()> {
        self.shift = shift;
        loop {
            let matrix = &self.linearised.assembly.matrix;
            let mass = self.body.mass();
            let shift = self.shift;
            self.factor.factorize(|entry| {
                let diagonal = if (entry % 9).is_multiple_of(4) { shift * mass[entry / 9] } else { 0.0 };
                matrix.block(entry / 9)[entry % 9] + diagonal
            })?;
            if self.factor.is_definite() {
                return Ok(());
            }
            self.shift = (LARGER * self.shift).max(f64::MIN_POSITIVE);
        }
    }

    /// Absolute value up to which an eigenvalue is rounding.
    pub(super) fn rounding(&self) -> f64 {
        ROUNDING * self.largest_quotient()
    }

    /// Largest quotient of the diagonals of K and the lumped mass over the free degrees of freedom: close to the
    /// largest eigenvalue.
    fn largest_quotient(&self) -> f64 {
        let with_mass = &self.body.fixed()[..self.body.mesh().n_dofs()];
        let free = with_mass.iter().enumerate().filter(|(_, fixed)| !**fixed);
        let quotient = |(dof, _): (usize, &bool)| {
            let node = dof / 3;
            let position = self.body.pattern().position(node, node)?;
            Some(
                self.linearised.assembly.matrix.block(position)[4 * (dof % 3)]
                    / self.body.lumped_mass()[node],
            )
        };
        free.filter_map(quotient).fold(0.0, |largest: f64, value| largest.max(value.abs()))
    }

    /// A shift of the size of the lowest elastic eigenvalue: that of a bar of the body's length in tension, times the
    /// square of its slenderness for bending. A shift within a few powers of ten serves as well.
    pub(super) fn suggested_shift(&mut self) -> f64 {
        let extent = self.body.mesh().extent();
        let lengths = || extent.into_iter().filter(|length| *length > 0.0);
        let longest = lengths().fold(0.0, f64::max);
        let slenderness = (lengths().fold(longest, f64::min) / longest).max(1e-3);
        let quotients = (0..3).filter(|&axis| extent[axis] > 0.0).map(|axis| self.tension(axis));
        let lowest = quotients.filter(|quotient| *quotient > 0.0).fold(f64::INFINITY, f64::min);
        let largest = self.largest_quotient();
        match (lowest.is_finite(), largest > 0.0) {
            (true, _) => (0.1 * lowest * slenderness.powi(2)).max(self.rounding()),
            (false, true) => 1e-6 * largest,
            (false, false) => 1.0,
        }
    }

    /// Rayleigh quotient of a stretch along an axis.
    fn tension(&mut self, axis: usize) -> f64 {
        let points = self.body.mesh().points();
        let centre = points.iter().map(|X| X[axis]).sum::<f64>() / points.len() as f64;
        let mut u = vec![0.0; self.body.n_dofs()];
        u.iter_mut().skip(axis).step_by(3).zip(points).for_each(|(u, X)| *u = X[axis] - centre);
        self.body.space.set_internal_means(&mut u);
        let mut product = u.clone();
        self.linearised.assembly.matrix.multiply(self.body.pattern(), &u, &mut product);
        let stiff = dot(&u, &product);
        self.body.mass_product(&u, &mut product);
        stiff / dot(&u, &product)
    }

    /// Sets fixed components to zero.
    fn hold(&self, product: &mut [f64]) {
        product.iter_mut().zip(self.body.fixed()).filter(|(_, fixed)| **fixed).for_each(|(x, _)| *x = 0.0);
    }
}

impl Pencil for BodyPencil<'_> {
    fn n(&self) -> usize {
        self.body.n_dofs()
    }

    fn free(&self) -> Vec<usize> {
        let with_mass = self.body.mesh().n_dofs();
        (0..with_mass).filter(|&dof| !self.body.fixed()[dof]).collect()
    }

    fn shift(&self) -> f64 {
        self.shift
    }

    fn multiply_mass(&mut self, x: &[f64], product: &mut [f64]) {
        let n = self.n();
        for (x, product) in x.chunks_exact(n).zip(product.chunks_exact_mut(n)) {
            self.body.mass_product(x, product);
            self.hold(product);
        }
    }

    fn multiply_stiffness(&mut self, x: &[f64], product: &mut [f64]) {
        let n = self.n();
        for (x, product) in x.chunks_exact(n).zip(product.chunks_exact_mut(n)) {
            self.linearised.assembly.matrix.multiply(self.body.pattern(), x, product);
            self.hold(product);
        }
    }

    fn solve(&mut self, b: &mut [f64]) {
        let n = self.body.n_dofs();
        let read = |b: &&mut [f64], column: usize, row: usize| b[column * n + row];
        let write = |b: &mut &mut [f64], column: usize, row: usize, value: f64| b[column * n + row] = value;
        self.factor.solve(b.len() / n, &mut &mut *b, read, write);
    }
}
