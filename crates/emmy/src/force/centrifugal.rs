//! The centrifugal force on all masses, for an observer that turns.

use std::sync::Arc;

use super::integral::Scratch;
use super::interface::{Book, Force, ForceMemory, OverTime, Side};
use super::source::Site;
use super::step::{StepInput, StepStart};
use crate::average::{Request, Rule};
use crate::error::{Error, Result};
use crate::input::{Load, TimeFunction};
use crate::nodal;
use crate::sparse::RowPart;
use crate::tensor::dot3;

/// The centrifugal force of the consistent mass, linear in the positions: it stretches a body and softens it.
///
/// ```math
/// F_A = Omega^2 sum_B M_AB P (X_B + u_B - c),    P = 1 - a a^T
/// ```
#[derive(Debug, Clone)]
pub(super) struct CentrifugalForce {
    number: usize,
    time_function: TimeFunction,
    /// Omega a \[1/time\].
    spin: [f64; 3],
    /// Omega^2 P \[1/time^2\].
    square: [[f64; 3]; 3],
    masses: Arc<Masses>,
}

/// The masses before ties, which move the force to the nodes that others follow.
#[derive(Debug)]
struct Masses {
    /// Node of the force, node of the position, place in the pattern, and the mass; ascending.
    couplings: Vec<(u32, u32, u32, f64)>,
    /// X - c of each node.
    arms: Vec<[f64; 3]>,
}

impl CentrifugalForce {
    /// The force for an observer that turns about an axis of any length through a point.
    ///
    /// # Errors
    /// [`Error::Rotation`] for an axis without a direction, no speed, or a factor over time.
    pub(super) fn new(
        number: usize,
        load: &Load,
        (axis, about, speed): ([f64; 3], [f64; 3], f64),
        site: &Site<'_>,
    ) -> Result<Self> {
        let fail = |reason: &str| Err(Error::Rotation { reason: reason.to_string() });
        // The largest component first, so that no square overflows.
        let largest = axis.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let scaled = axis.map(|x| x / largest);
        let length = dot3(scaled, scaled).sqrt();
        if !(largest > 0.0 && length.is_finite()) {
            return fail("its axis must have a direction: three finite numbers, not all zero");
        }
        if !(speed.is_finite() && speed != 0.0) {
            return fail("its speed must be a finite number other than zero, in radians per time");
        }
        if !about.iter().all(|x| x.is_finite()) {
            return fail("the point on its axis must have finite coordinates");
        }
        if load.time_function != TimeFunction::constant() {
            return fail("its speed is constant: the load has no factor over time");
        }
        let a = scaled.map(|x| x / length);
        let square = [0, 1, 2]
            .map(|i| [0, 1, 2].map(|j| speed * speed * (if i == j { 1.0 } else { 0.0 } - a[i] * a[j])));
        let rows = (0..site.n_own).flat_map(|row| site.pattern.range(row).map(move |at| (row, at)));
        let coupling = |(row, at): (usize, usize)| {
            let column = site.pattern.row(row)[at - site.pattern.range(row).start];
            let mass = site.mass[at];
            (mass != 0.0).then_some((row as u32, column, at as u32, mass))
        };
        let arm = |X: &[f64; 3]| [0, 1, 2].map(|d| X[d] - about[d]);
        let masses = Masses {
            couplings: rows.filter_map(coupling).collect(),
            arms: site.mesh.points().iter().map(arm).collect(),
        };
        Ok(CentrifugalForce {
            number,
            time_function: load.time_function.clone(),
            spin: a.map(|x| speed * x),
            square,
            masses: Arc::new(masses),
        })
    }

    /// The force of a coupling at factor 1, by the displacement of its second node.
    fn force(&self, &(_, column, _, mass): &(u32, u32, u32, f64), u: impl Fn(usize) -> f64) -> [f64; 3] {
        let arm = self.masses.arms[column as usize];
        let moved = [0, 1, 2].map(|d| mass * (arm[d] + u(nodal::dof(column as usize, d))));
        self.square.map(|row| dot3(row, moved))
    }
}

impl Force for CentrifugalForce {
    fn book(&self) -> Book {
        Book::Work
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        ForceMemory::new(vec![0.0; rule.degree()])
    }

    fn begin(&self, start: &StepStart<'_>, memory: &mut ForceMemory, _: &mut [f64]) -> Result<bool> {
        self.stage_factors(start, memory.of_mut::<Vec<f64>>())
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        memory: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let (k, n, mean) = (step.rule.degree(), step.displacement.len(), step.rule.mean());
        let factors = memory.of::<Vec<f64>>();
        for coupling in &self.masses.couplings {
            let &(row, _, position, mass) = coupling;
            if !sink.owns(row) {
                continue;
            }
            for (i, factor) in factors.iter().enumerate() {
                let force = self.force(coupling, |dof| {
                    let rates = (0..k).map(|j| mean.rates[i * k + j] * step.rates[j * n + dof]);
                    mean.start[i] * step.displacement[dof] + rates.sum::<f64>()
                });
                sink.add_force(i, row, force.map(|f| factor * f));
            }
            if request == Request::Stress {
                continue;
            }
            for (stages, rate) in mean.rates.iter().enumerate() {
                let block = sink.block_mut(position as usize, stages);
                let weight = step.tangent_factor * factors[stages / k] * rate * mass;
                block.iter_mut().zip(self.square.as_flattened()).for_each(|(sum, s)| *sum -= weight * s);
            }
        }
        Ok(())
    }

    fn observer_spin(&self) -> Option<[f64; 3]> {
        Some(self.spin)
    }

    fn over_time(&self) -> Option<&dyn OverTime> {
        Some(self)
    }
}

impl OverTime for CentrifugalForce {
    fn number(&self) -> usize {
        self.number
    }

    fn time_function(&self) -> &TimeFunction {
        &self.time_function
    }

    fn in_proportion(&self, time: f64, _: usize) -> Arc<dyn Force> {
        let time_function = TimeFunction::ramp(self.time_function.value_before(time));
        Arc::new(CentrifugalForce { time_function, ..self.clone() })
    }

    fn add_unit_force(&self, force: &mut [f64]) {
        for coupling in &self.masses.couplings {
            let own = self.force(coupling, |_| 0.0);
            let sum = nodal::at_mut(force, coupling.0 as usize);
            (0..3).for_each(|d| sum[d] += own[d]);
        }
    }
}
