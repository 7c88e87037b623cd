//! Stiffness and mass of a body, linearised about a displacement.

#![allow(non_snake_case)]

use std::borrow::Cow;

use crate::average::Request;
use crate::body::{Assembly, Body, Interface};
use crate::error::Result;
use crate::sparse::reduce::dot;
use crate::sparse::{BLOCK, CoupledCholesky, Pencil};
use crate::tensor::cross;
use crate::time::State;
use crate::time::classic::Forces;
use crate::unknowns::LinearConstraints;

/// Eigenvalues below this, relative to the largest one, are rounding.
const ROUNDING: f64 = 1e-14;

/// Factor of the shift from one attempt to the next, while the shifted stiffness is indefinite.
const LARGER: f64 = 10.0;

/// The symmetric stiffness of a body at a displacement, and its constraints there.
pub(super) struct Linearised {
    assembly: Assembly,
    interface: Option<Interface>,
}

impl Linearised {
    /// The stiffness in the reference configuration, without loads.
    ///
    /// # Errors
    /// As [`Linearised::about`].
    pub(super) fn at_reference(body: &Body) -> Result<Self> {
        Linearised::new(body, Forces::new(body), &vec![0.0; body.n_dofs()], None)
    }

    /// The stiffness at a state, with the follower pressures of its time.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], [`crate::Error::NotFiniteAt`].
    pub(super) fn about(body: &Body, state: &State) -> Result<Self> {
        let mut forces = Forces::new(body);
        forces.take_history(state);
        Linearised::new(body, forces, &state.displacement, Some(state.time))
    }

    fn new(body: &Body, mut forces: Forces<'_>, displacement: &[f64], time: Option<f64>) -> Result<Self> {
        let interface = match body.constraints().is_empty() {
            true => None,
            false => {
                let force = forces.unbalanced(displacement, time)?;
                let constraints = (body.constraints(), body.space.inactive());
                let mut constraints = LinearConstraints::new(constraints, displacement, time)?;
                let multipliers = constraints.balancing(&force);
                Some(Interface::new(body, constraints, &multipliers))
            }
        };
        forces.assemble(displacement, Request::Tangent)?;
        if let Some(time) = time {
            forces.add_external_tangent(displacement, time)?;
        }
        let mut assembly = forces.assembly;
        assembly.matrix.symmetrize(body.pattern());
        Ok(Linearised { assembly, interface })
    }
}

/// Stiffness, consistent mass, and a factorisation of `K + s M` on the free degrees of freedom.
pub(super) struct BodyPencil<'a> {
    body: &'a Body,
    linearised: &'a mut Linearised,
    factor: CoupledCholesky,
    shift: f64,
}

impl<'a> BodyPencil<'a> {
    /// Memory for the factorisation.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(super) fn new(body: &'a Body, linearised: &'a mut Linearised) -> Result<Self> {
        let mut factor = CoupledCholesky::new(body.pattern(), body.fixed(), body.node_order()?)?;
        factor.reserve(BLOCK)?;
        Ok(BodyPencil { body, linearised, factor, shift: 0.0 })
    }

    /// Number of modes.
    pub(super) fn n_modes(&self) -> usize {
        n_free(self.body)
            - self.linearised.interface.as_ref().map_or(0, |own| own.constraints.dependent().len())
    }

    /// Factorises `K + s M` with the smallest of `shift`, 10 `shift`, ... for which it is positive definite: then every
    /// eigenvalue is above -s, unstable ones included.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if the matrix is not finite.
    pub(super) fn factorize(&mut self, shift: f64) -> Result<()> {
        self.shift = shift;
        loop {
            let (mass, shift) = (self.body.carried_mass(), self.shift);
            let of_body = (self.body.pattern(), self.body.fixed());
            let matrix = &self.linearised.assembly.matrix;
            self.factor.factorize(of_body, matrix, |at| shift * mass[at / 9])?;
            if self.factor.cholesky.is_definite() && self.constrain()? {
                return Ok(());
            }
            self.shift = (LARGER * self.shift).max(f64::MIN_POSITIVE);
        }
    }

    /// Takes the constraints into the factorised system. Returns whether it is positive definite.
    fn constrain(&mut self) -> Result<bool> {
        let Some(interface) = &mut self.linearised.interface else { return Ok(true) };
        let carriers = interface.carriers(self.body, self.shift);
        interface.factorize(self.body, &carriers, |b| solve(&mut self.factor, self.body, b))?;
        Ok(!interface.is_loaded() || interface.is_definite()?)
    }

    /// Absolute value up to which an eigenvalue is rounding.
    pub(super) fn rounding(&self) -> f64 {
        ROUNDING * self.largest_quotient()
    }

    /// Largest quotient of the diagonals of K and the lumped mass over the free degrees of freedom: close to the
    /// largest eigenvalue.
    fn largest_quotient(&self) -> f64 {
        let Body { mechanism, .. } = self.body;
        let with_mass = &self.body.fixed()[..self.body.mesh().n_dofs()];
        let free = with_mass.iter().enumerate().filter(|(_, fixed)| !**fixed);
        // The lumped mass of a rigid body is in its centre.
        let mass = |node: usize, position: usize| match mechanism.is_rigid(node) {
            true => self.body.carried_mass()[position],
            false => self.body.lumped_mass()[node],
        };
        let quotient = |(dof, _): (usize, &bool)| {
            let node = dof / 3;
            let position = self.body.pattern().position(node, node)?;
            Some(self.linearised.assembly.matrix.block(position)[4 * (dof % 3)] / mass(node, position))
        };
        let of_joints = self.linearised.interface.iter().flat_map(Interface::diagonal);
        let of_joints = of_joints.filter(|(dof, _)| !self.body.fixed()[*dof]).map(|(dof, stiffness)| {
            let node = dof / 3;
            stiffness / mass(node, self.body.pattern().coupling(node, node))
        });
        let all = free.filter_map(quotient).chain(of_joints);
        all.fold(0.0, |largest: f64, value| largest.max(value.abs()))
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

    /// Products with the gyroscopic matrix of an angular velocity s, `G x = M (s x x)`, projected like those with the
    /// mass.
    pub(super) fn multiply_gyroscopic(&self, spin: [f64; 3], x: &[f64], product: &mut [f64]) {
        let n = self.body.n_dofs();
        for (x, product) in x.chunks_exact(n).zip(product.chunks_exact_mut(n)) {
            let turned: Vec<[f64; 3]> =
                self.allowed(x).as_chunks().0.iter().map(|x| cross(spin, *x)).collect();
            self.body.mass_product(turned.as_flattened(), product);
            self.hold(product);
        }
    }

    /// The displacement `(K + s M)^-1 f` under a force.
    pub(super) fn displacement(&mut self, mut force: Vec<f64>) -> Vec<f64> {
        self.hold(&mut force);
        self.solve(&mut force);
        let mut displacement = self.allowed(&force).into_owned();
        self.body.space.follow(&mut displacement);
        displacement
    }

    /// The motion that the constraints allow with the free degrees of freedom of a vector.
    fn allowed<'x>(&self, x: &'x [f64]) -> Cow<'x, [f64]> {
        let mut x = Cow::Borrowed(x);
        if let Some(interface) = &self.linearised.interface {
            interface.constraints.complete(x.to_mut());
        }
        x
    }

    /// Sets fixed components to zero, and moves those that follow others to these.
    fn hold(&self, product: &mut [f64]) {
        if let Some(interface) = &self.linearised.interface {
            interface.constraints.gather(product);
        }
        product.iter_mut().zip(self.body.fixed()).filter(|(_, fixed)| **fixed).for_each(|(x, _)| *x = 0.0);
    }
}

impl Pencil for BodyPencil<'_> {
    fn n(&self) -> usize {
        self.body.n_dofs()
    }

    fn free(&self) -> Vec<usize> {
        let with_mass = self.body.mesh().n_dofs();
        let mut is_given = self.body.fixed()[..with_mass].to_vec();
        let dependent = self.linearised.interface.iter().flat_map(|own| own.constraints.dependent());
        dependent.for_each(|dof| is_given[dof] = true);
        (0..with_mass).filter(|&dof| !is_given[dof]).collect()
    }

    fn shift(&self) -> f64 {
        self.shift
    }

    fn multiply_mass(&mut self, x: &[f64], product: &mut [f64]) {
        let n = self.n();
        for (x, product) in x.chunks_exact(n).zip(product.chunks_exact_mut(n)) {
            self.body.mass_product(&self.allowed(x), product);
            self.hold(product);
        }
    }

    fn multiply_stiffness(&mut self, x: &[f64], product: &mut [f64]) {
        let n = self.n();
        for (x, product) in x.chunks_exact(n).zip(product.chunks_exact_mut(n)) {
            let x = self.allowed(x);
            self.linearised.assembly.matrix.multiply(self.body.pattern(), &x, product);
            if let Some(interface) = &self.linearised.interface {
                interface.add_product(&x, product);
            }
            self.hold(product);
        }
    }

    fn solve(&mut self, b: &mut [f64]) {
        let BodyPencil { body, linearised, factor, .. } = self;
        solve(factor, body, b);
        if let Some(interface) = &linearised.interface {
            interface.correct(body, |b| solve(factor, body, b), b);
        }
    }
}

/// Applies the inverse of the factorised matrix to columns, `[columns][n_nodes][3]`.
fn solve(factor: &mut CoupledCholesky, body: &Body, b: &mut [f64]) {
    let n = body.n_dofs();
    let read = |b: &&mut [f64], column: usize, row: usize| b[column * n + row];
    let write = |b: &mut &mut [f64], column: usize, row: usize, value: f64| b[column * n + row] = value;
    factor.cholesky.solve(b.len() / n, &mut &mut *b, read, write);
}

/// Number of degrees of freedom that follow from others in the reference configuration.
pub(super) fn n_dependent(body: &Body) -> usize {
    let rest = vec![0.0; body.n_dofs()];
    let drawn = LinearConstraints::new((body.constraints(), body.space.inactive()), &rest, None);
    // Constraints as drawn have no function of time that could fail.
    drawn.map_or(0, |own| own.dependent().len())
}

/// Number of free degrees of freedom with mass, as if there were no constraints.
pub(super) fn n_free(body: &Body) -> usize {
    body.fixed()[..body.mesh().n_dofs()].iter().filter(|fixed| !**fixed).count()
}
