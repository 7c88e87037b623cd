//! Forces and matrices of a body at one displacement and time, for schemes from outside.

use super::classic::Forces;
use crate::average::{Request, Rule};
use crate::body::{BlockRow, Body};
use crate::error::{Error, Result};
use crate::force::{StepDamping, StepInput};
use crate::quadrature::gauss;

/// Part of the stiffness in the sum from which [`Body::damping`] takes the viscosity: its rounding does not count
/// there.
const STIFFNESS_PART: f64 = 1e-8;

/// Given motion of a body at a time; see [`Body::prescribed`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prescribed {
    /// The driven degrees of freedom, `3 node + component`.
    pub dofs: Vec<usize>,
    /// Displacement of each \[length\].
    pub displacement: Vec<f64>,
    /// Velocity of each \[length/time\].
    pub velocity: Vec<f64>,
}

impl Body {
    /// Internal force f(u) of a displacement, `[n_nodes][3]` \[force\]: the derivative of [`Body::strain_energy`].
    /// Springs and attractions to the ground are included, loads are not. [`PointForces`](super::PointForces) evaluates
    /// it without new memory.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(0.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// let points = body.mesh().points();
    /// let stretched: Vec<f64> = points.iter().flat_map(|X| [X[0], 0.0, 0.0]).collect();
    /// let force = body.internal_force(&stretched)?;
    /// // P_11 = mu (lambda - 1/lambda) with lambda = 2, on the unit area x = 1.
    /// let right: f64 = (0..8).filter(|&node| points[node][0] == 1.0).map(|node| force[3 * node]).sum();
    /// assert!((right - 750.0).abs() < 1e-10);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Inverted`]; [`Error::Length`] for another number of entries; [`Error::NotOnTeam`] for a part of a body.
    pub fn internal_force(&self, displacement: &[f64]) -> Result<Vec<f64>> {
        let mut forces = self.forces_at("an internal force at a displacement", displacement)?;
        forces.assemble(displacement, Request::Stress)?;
        let mut internal = vec![0.0; self.n_dofs()];
        forces.assembly.matrix.copy_force(&mut internal);
        Ok(internal)
    }

    /// Stiffness K = df/du at a displacement `[n_nodes][3]` \[force/length\]: for each row of nodes, its columns in
    /// ascending order and the 3x3 blocks, row by row. Supports and loads are not included.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(0.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// let rows = body.stiffness(&[0.0; 24])?;
    /// // A translation needs no force.
    /// let force: f64 = rows[0].iter().map(|(_, block)| block[0]).sum();
    /// assert!(rows.len() == 8 && force.abs() < 1e-10);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Body::internal_force`].
    pub fn stiffness(&self, displacement: &[f64]) -> Result<Vec<BlockRow>> {
        let mut forces = self.forces_at("a stiffness at a displacement", displacement)?;
        forces.assemble(displacement, Request::Tangent)?;
        Ok(forces.assembly.matrix.block_rows(self.pattern()))
    }

    /// All loads F(t, u) at a time, `[n_nodes][3]` \[force\]; those that follow the body at a displacement
    /// `[n_nodes][3]`. At a jump the load after it counts.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(0.0, 500.0)?, 2.0);
    /// let inflated = Load::pressure("x-max", 3.0).over([(0.0, 0.0), (1.0, 1.0)])?;
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(inflated).build()?;
    /// // The face is twice as large, and half of the pressure acts.
    /// let wider: Vec<f64> = body.mesh().points().iter().flat_map(|X| [0.0, X[1], 0.0]).collect();
    /// let force = body.external_force(0.5, &wider)?;
    /// assert!((force.iter().sum::<f64>() + 3.0).abs() < 1e-14);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`]; otherwise as [`Body::internal_force`].
    pub fn external_force(&self, time: f64, displacement: &[f64]) -> Result<Vec<f64>> {
        let mut forces = self.forces_at("loads at a displacement", displacement)?;
        let mut external = vec![0.0; self.n_dofs()];
        forces.external(displacement, time, &mut external)?;
        Ok(external)
    }

    /// Given displacement and velocity of the driven degrees of freedom at a time; those of supports that are released
    /// by then are none. At a kink the velocity is the rate after it.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(0.0, 500.0)?, 2.0);
    /// let path = TimeFunction::new(vec![(0.0, 0.0), (2.0, 1.0)])?;
    /// let driven = Support::driven("x-max", [Some(path), None, None]);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).support(driven).build()?;
    /// let given = body.prescribed(1.0)?;
    /// assert_eq!((given.dofs.len(), given.displacement[3], given.velocity[3]), (4, 0.5, 0.5));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`] if a function of time is not finite.
    pub fn prescribed(&self, time: f64) -> Result<Prescribed> {
        if let Some((_, released)) = self.release().filter(|(until, _)| *until <= time) {
            return released.prescribed(time);
        }
        let [displacement, velocity] = self.space.prescribed(time)?;
        let dofs: Vec<usize> = self.space.driven_dofs().collect();
        let of_driven = |all: Vec<f64>| dofs.iter().map(|&dof| all[dof]).collect();
        Ok(Prescribed { displacement: of_driven(displacement), velocity: of_driven(velocity), dofs })
    }

    /// Damping C = df/dv at rest in the reference configuration \[force time/length\]: viscosity, and drag times the
    /// mass; rows as those of [`Body::stiffness`], empty without damping. At large strains a viscous force depends on
    /// the displacement, too.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(0.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).drag(0.3).build()?;
    /// let rows = body.damping()?;
    /// let sum: f64 = rows.iter().flatten().map(|(_, block)| block[0]).sum();
    /// assert!((sum - 0.3 * 2.0).abs() < 1e-15);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotOnTeam`] for a part of a body.
    pub fn damping(&self) -> Result<Vec<BlockRow>> {
        self.space.check_whole("a damping matrix")?;
        if !self.dissipates() {
            return Ok(vec![BlockRow::new(); self.pattern().n_rows()]);
        }
        // The derivative by the rates of a step is that of the elasticity, and the viscosity over its size.
        let size = STIFFNESS_PART * self.viscous_time();
        let rule = Rule::standard(1, &gauss(1));
        let rest = vec![0.0; self.n_dofs()];
        let mut assembly = self.assembly(&rule);
        let mut tangent = |inverse_step_size: f64| -> Result<Vec<BlockRow>> {
            let damping = StepDamping { inverse_step_size, dissipation: 0.0 };
            let step = StepInput { tangent_factor: 1.0, damping, ..StepInput::undamped(&rule, &rest, &rest) };
            self.assemble(&step, Request::Tangent, &[0.0], &mut assembly)?;
            Ok(assembly.matrix.block_rows(self.pattern()))
        };
        let elastic = tangent(0.0)?;
        let mut damping = if self.is_viscous() { tangent(1.0 / size)? } else { elastic.clone() };
        let entries = damping.iter_mut().flatten().zip(elastic.iter().flatten());
        for (((_, block), (_, elastic)), mass) in entries.zip(self.mass()) {
            for (at, (entry, elastic)) in block.iter_mut().zip(elastic).enumerate() {
                let of_drag = if at % 4 == 0 { self.drag() * mass } else { 0.0 };
                *entry = size * (*entry - elastic) + of_drag;
            }
        }
        Ok(damping)
    }

    /// The forces at a displacement, whose length is checked.
    fn forces_at(&self, what: &str, displacement: &[f64]) -> Result<Forces<'_>> {
        self.space.check_whole(what)?;
        self.check_vector("a displacement", displacement)?;
        Ok(Forces::new(self))
    }

    /// Checks the length of a vector of this body.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub(crate) fn check_vector(&self, what: &'static str, vector: &[f64]) -> Result<()> {
        let (found, expected) = (vector.len(), self.n_dofs());
        if found == expected { Ok(()) } else { Err(Error::Length { what, found, expected }) }
    }
}
