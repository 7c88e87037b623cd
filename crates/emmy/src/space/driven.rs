//! Degrees of freedom of a body whose motion is given.

use super::{Space, Supports};
use crate::average::Rule;
use crate::error::{Error, Result};
use crate::input::{SAME_TIME, SignalTarget, Span};
use crate::space::drive::{AT_ONCE, Drive, Fault, apply};

/// Rates of the degrees of freedom with a given motion in a step; nothing for a body without.
#[derive(Debug)]
pub(crate) struct DrivenRates(Vec<f64>);

impl DrivenRates {
    /// Memory for k stages.
    pub(crate) fn new(space: &Space, k: usize) -> Self {
        DrivenRates(vec![0.0; if space.is_driven() { k * space.n_dofs() } else { 0 }])
    }

    /// Sets the rates of a step that starts at a displacement.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(crate) fn set(&mut self, space: &Space, rule: &Rule, span: Span, displacement: &[f64]) -> Result<()> {
        space.driven_rates(rule, span.start, span.size, displacement, &mut self.0)
    }

    /// Inserts the rates among those of all degrees of freedom, `[k][n_nodes][3]`.
    pub(crate) fn insert(&self, space: &Space, rates: &mut [f64]) {
        let n = space.n_dofs();
        for (rates, driven) in rates.chunks_exact_mut(n).zip(self.0.chunks_exact(n)) {
            space.driven_dofs().for_each(|dof| rates[dof] = driven[dof]);
        }
    }
}

impl Space {
    /// The given motions.
    pub(crate) fn drives(&self) -> &[Drive] {
        &self.supports.drives
    }

    /// The same nodes with motions that grow evenly, from no displacement at t = 0 to that of a time at t = 1.
    pub(crate) fn in_proportion(&self, time: f64) -> Space {
        let drives = self.drives().iter().map(|drive| drive.in_proportion(time)).collect();
        self.with_supports(Supports { drives, ..self.supports.clone() })
    }

    /// Whether some degrees of freedom have a given motion.
    pub(crate) fn is_driven(&self) -> bool {
        !self.supports.drives.is_empty()
    }

    /// Degrees of freedom with a given motion; [`Space::fixed`] counts them too.
    pub(crate) fn driven_dofs(&self) -> impl Iterator<Item = usize> + '_ {
        self.supports.drives.iter().flat_map(Drive::dofs)
    }

    /// Sets the displacement of the driven degrees of freedom to the given motion at a time; the others are unchanged.
    pub(crate) fn set_driven_displacement(&self, time: f64, displacement: &mut [f64]) {
        for drive in &self.supports.drives {
            let map = drive.map(time);
            for (dof, component, offset) in drive.entries() {
                displacement[dof] = apply(&map[component], offset);
            }
        }
    }

    /// Sets the rates x_i of the driven degrees of freedom in a step that starts at a displacement, so that the step
    /// ends at the given motion; the others are unchanged. `rates: [k][n_nodes][3]`.
    ///
    /// ```math
    /// x_i = (1/b_i) integral_0^1 l_i u' dalpha
    /// ```
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    fn driven_rates(
        &self,
        rule: &Rule,
        time: f64,
        h: f64,
        displacement: &[f64],
        rates: &mut [f64],
    ) -> Result<()> {
        let n = self.n_dofs();
        for drive in &self.supports.drives {
            let mut of_stages = [[[0.0; 4]; 3]; AT_ONCE];
            let of_stages = &mut of_stages[..rule.degree()];
            let set = drive.set_stage_rates(rule, time, h, of_stages);
            set.map_err(|fault| not_finite(drive.support, fault))?;
            let start = drive.map(time);
            for (rate, rates) in of_stages.iter().zip(rates.chunks_exact_mut(n)) {
                for (dof, component, offset) in drive.entries() {
                    // A path of constant rate corrects the rounding of earlier steps.
                    let behind = apply(&start[component], offset) - displacement[dof];
                    rates[dof] = apply(&rate[component], offset) + behind;
                }
            }
        }
        Ok(())
    }

    /// Sets the velocity of the fixed degrees of freedom: zero, the rate of the given motion, or at tied nodes that of
    /// the nodes that they follow. At a kink it is the rate after it, at the end of a support the rate before it. Free
    /// degrees of freedom are unchanged. `step_size`: size of the step that ends or starts here.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(crate) fn set_given_velocity(&self, time: f64, step_size: f64, velocity: &mut [f64]) -> Result<()> {
        velocity.iter_mut().zip(self.fixed()).filter(|(_, fixed)| **fixed).for_each(|(v, _)| *v = 0.0);
        for drive in &self.supports.drives {
            let same = SAME_TIME * step_size;
            let ends = drive.until.is_some_and(|until| time > until - same);
            let rate = drive.finite_rate(time, if ends { -same } else { same });
            let rate = rate.map_err(|fault| not_finite(drive.support, fault))?;
            for (dof, component, offset) in drive.entries() {
                velocity[dof] = apply(&rate[component], offset);
            }
        }
        self.follow(velocity);
        Ok(())
    }

    /// Displacement and velocity, `[n_nodes][3]`, with those of the driven degrees of freedom at a time, the velocity
    /// after a kink, and zero elsewhere.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(crate) fn prescribed(&self, time: f64) -> Result<[Vec<f64>; 2]> {
        let mut given = [(); 2].map(|()| vec![0.0; self.n_dofs()]);
        for drive in self.drives() {
            let mut map = [[[0.0; 4]; 3]];
            drive.set_maps(&[time], &mut map).map_err(|fault| not_finite(drive.support, fault))?;
        }
        self.set_driven_displacement(time, &mut given[0]);
        let next = (f64::EPSILON * time.abs()).max(f64::MIN_POSITIVE);
        self.set_given_velocity(time, next / SAME_TIME, &mut given[1])?;
        Ok(given)
    }

    /// Largest distance of the given motion at a time from the displacement of its nodes \[length\].
    pub(crate) fn driven_distance(&self, time: f64, displacement: &[f64]) -> f64 {
        let of_drive = |drive: &Drive| {
            let map = drive.map(time);
            let distance = |(dof, i, offset): (usize, usize, &[f64; 3])| {
                (apply(&map[i], offset) - displacement[dof]).abs()
            };
            drive.entries().map(distance).fold(0.0, f64::max)
        };
        let mut most = [self.supports.drives.iter().map(of_drive).fold(0.0, f64::max)];
        self.largest_of_ranks("distance of driven nodes", &mut most);
        most[0]
    }
}

/// The error of a moving support whose function is not a finite number.
fn not_finite(number: usize, (text, found): Fault<'_>) -> Error {
    SignalTarget::Support(number).not_finite(text, found)
}
