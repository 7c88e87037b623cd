//! Given motions and the range of the constraints in a step.

use super::constraint::Constraint;
use super::constraints::Constraints;
use super::range::Range;
use crate::average::Rule;
use crate::error::Result;
use crate::force::StepInput;
use crate::input::{SAME_TIME, Span};
use crate::polynomial::lagrange_integral;

/// Given motions at the times of a step, and the range of the constraints.
///
/// Constraints that follow from the others are the rule: a planar loop of hinges has three, Bricard's mechanism seven.
/// Of all constraints a step takes those in the range of G(q) at its start, `C^T Phi` with an orthonormal basis C, and
/// multipliers `Lambda_i = C mu_i`; the others hold at the end of the step because they follow there. Both are written
/// with all constraints and the projection `P = C C^T`, so that a change of rank changes no numbers of unknowns:
///
/// ```math
/// P C_i = 0,    (1 - P) Lambda_i = 0
/// ```
#[derive(Debug)]
pub(crate) struct ConstraintStep {
    span: Span,
    /// Numbers of the driven constraints.
    driven: Vec<usize>,
    /// The driven constraints at the k stages, at the end and at the start.
    at: Vec<Vec<Constraint>>,
    n_stages: usize,
    /// `L_j(alpha)`, the integrals of the basis at points of the path of a step, `[PATH][k]`.
    path: Vec<f64>,
    range: Range,
}

impl ConstraintStep {
    /// Memory for steps of k stages.
    pub(crate) fn new(constraints: &Constraints, k: usize) -> Self {
        let is_driven = |c: &usize| constraints.rows()[*c].drive.is_some();
        let driven: Vec<usize> = (0..constraints.len()).filter(is_driven).collect();
        let rows: Vec<Constraint> = driven.iter().map(|&c| constraints.rows()[c].clone()).collect();
        let at = if driven.is_empty() { Vec::new() } else { vec![rows; k + 2] };
        ConstraintStep {
            span: Span::at(0.0),
            path: Vec::with_capacity(PATH * k),
            driven,
            at,
            n_stages: k,
            range: Range::new(constraints),
        }
    }

    /// Sets the times of a step, and the range of the constraints to that at its start.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn begin(
        &mut self,
        body: (&Constraints, &[bool]),
        rule: &Rule,
        span: Span,
        start: &[f64],
    ) -> Result<()> {
        self.span = span;
        let times = rule.nodes().iter().map(|&alpha| span.time(alpha)).chain([span.end, span.start]);
        for (time, rows) in times.zip(&mut self.at) {
            rows.iter_mut().try_for_each(|row| row.set_time(time, 0.0))?;
        }
        if self.path.is_empty() {
            let points = (1..=PATH).map(|m| m as f64 / PATH as f64);
            let of_point = |alpha| (0..rule.degree()).map(move |j| lagrange_integral(rule.nodes(), j, alpha));
            self.path.extend(points.flat_map(of_point));
        }
        self.set_range(body, self.n_stages + 1, &|dof| start[dof]);
        Ok(())
    }

    /// Sets a single time, in place of a stage, on the side of a kink that the sign of `shift` gives, and the range of
    /// the constraints there.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn set_time(
        &mut self,
        body: (&Constraints, &[bool]),
        [time, shift]: [f64; 2],
        u: &dyn Fn(usize) -> f64,
    ) -> Result<()> {
        self.span = Span::at(time);
        self.at.iter_mut().take(1).flatten().try_for_each(|row| row.set_time(time, shift))?;
        self.set_range(body, 0, u);
        Ok(())
    }

    /// Sets an instant in place of a stage, without one the given motions as drawn, and the range of the constraints
    /// there.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn set_instant(
        &mut self,
        body: (&Constraints, &[bool]),
        time: Option<f64>,
        u: &dyn Fn(usize) -> f64,
    ) -> Result<()> {
        if let Some(time) = time {
            return self.set_time(body, [time, 0.0], u);
        }
        self.set_range(body, 0, u);
        Ok(())
    }

    /// Whether the rate of a given motion jumps in the step, or a joint is released.
    pub(crate) fn has_kink(&self, constraints: &Constraints) -> bool {
        let same = SAME_TIME * self.span.size;
        let [after, until] = [self.span.start, self.span.end].map(|time| time + same);
        let mut drives = self.at.first().into_iter().flatten().filter_map(|row| row.drive.as_ref());
        let is_released = constraints.release().is_some_and(|time| after < time && time <= until);
        is_released || drives.any(|drive| drive.has_kink(after, until))
    }

    /// The integrals of the basis at each point of the path of the step.
    pub(crate) fn path(&self) -> impl Iterator<Item = &[f64]> {
        self.path.chunks_exact(self.n_stages)
    }

    /// Whether the constraints hold at the end of a step. If not, their range becomes that at the end: the step may
    /// have begun where some depend on each other that do not elsewhere.
    pub(crate) fn hold(&mut self, body: (&Constraints, &[bool]), step: &StepInput<'_>) -> Held {
        let end = |dof: usize| step.displacement_at_end(dof);
        let start = |dof: usize| step.displacement[dof];
        let largest = |stage: usize, u: &dyn Fn(usize) -> f64| {
            (0..body.0.len()).fold(0.0f64, |most, c| most.max(self.row(body.0, stage, c).value(u).abs()))
        };
        let residual = match self.opposed(body.0, step) {
            Some(_) => body.0.size(),
            None => largest(self.n_stages, &end),
        };
        // Without a factor on that of the start: short steps would double it, and again, where given motions contradict
        // each other.
        if residual <= TOLERANCE * body.0.size() + largest(self.n_stages + 1, &start) {
            return Held::Yes;
        }
        self.set_range(body, self.n_stages, &end);
        Held::No { residual }
    }

    /// The first constraint whose given angle is half a turn off at the end of a step.
    pub(crate) fn opposed<'s>(
        &'s self,
        constraints: &'s Constraints,
        step: &StepInput<'_>,
    ) -> Option<&'s Constraint> {
        let end = |dof: usize| step.displacement_at_end(dof);
        let rows = self.driven.iter().map(|&c| self.row(constraints, self.n_stages, c));
        rows.into_iter().find(|row| row.is_opposed(&end))
    }

    /// The residuals of all constraints at the end of a step.
    pub(crate) fn residuals_at_end(&self, constraints: &Constraints, step: &StepInput<'_>) -> Vec<f64> {
        let end = |dof: usize| step.displacement_at_end(dof);
        (0..constraints.len()).map(|c| self.row(constraints, self.n_stages, c).value(&end)).collect()
    }

    fn set_range(&mut self, body: (&Constraints, &[bool]), stage: usize, u: &dyn Fn(usize) -> f64) {
        let mut range = std::mem::take(&mut self.range);
        range.set(body.0, (0..body.0.len()).map(|c| self.row(body.0, stage, c)), body.1, u);
        self.range = range;
    }

    /// A constraint at a stage, or at the end with the stage k.
    pub(crate) fn row<'s>(&'s self, constraints: &'s Constraints, stage: usize, c: usize) -> &'s Constraint {
        let row = &constraints.rows()[c];
        match row.drive {
            None => row,
            Some(_) => &self.at[stage][self.driven.partition_point(|&driven| driven < c)],
        }
    }

    /// Whether some constraint has a given motion.
    pub(crate) fn is_driven(&self) -> bool {
        !self.driven.is_empty()
    }

    /// The step.
    pub(crate) fn span(&self) -> Span {
        self.span
    }

    /// Step size \[time\].
    pub(crate) fn step_size(&self) -> f64 {
        self.span.size
    }

    /// The range of the constraints.
    pub(crate) fn range(&self) -> &Range {
        &self.range
    }

    /// Projects numbers of the constraints on their range.
    pub(crate) fn project(&self, values: &mut [f64]) {
        self.range.project(values);
    }
}

/// Number of points of the path of a step at which angles are counted on: enough for some turns.
const PATH: usize = 64;

/// Whether constraints hold at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Held {
    /// They do.
    Yes,
    /// They do not; their largest residual \[length\].
    No { residual: f64 },
}

/// Largest residual of a constraint, over the size of the body, that a step may add.
const TOLERANCE: f64 = 1e-10;
