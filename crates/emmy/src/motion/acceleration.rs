//! How the nodes move in the last step, also relative to a part of the body.

use std::borrow::Cow;

use super::{Motion, ReferenceMotion};
use crate::time::State;

impl Motion<'_> {
    /// Displacement and velocity of all nodes, `[n_nodes][3]`, relative to another motion if one is given. On a team a
    /// call of all ranks.
    pub fn seen_from(&self, reference: Option<&ReferenceMotion>) -> [Cow<'_, [f64]>; 2] {
        self.seen(&self.state, reference)
    }

    /// Mean acceleration of all nodes over the last step, `[n_nodes][3]`, relative to another motion if one is given:
    /// the change of the velocity, or of the relative velocity, over the step size \[length/time^2\]. Empty before the
    /// first step. On a team a call of all ranks.
    ///
    /// So it is defined in every scheme. Times the mass matrix it is the mean force, as reactions are means.
    ///
    /// ```
    /// # use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let weight = Load::acceleration([0.0, 0.0, -10.0]);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(weight).build()?;
    /// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?;
    /// assert!(motion.mean_acceleration(None).is_empty());
    /// motion.step(0.1)?;
    /// assert!((motion.mean_acceleration(None)[2] + 10.0).abs() < 1e-12);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn mean_acceleration(&self, reference: Option<&ReferenceMotion>) -> Vec<f64> {
        if self.state.step == self.last.step {
            return Vec::new();
        }
        let [[_, after], [_, before]] = [&self.state, &self.last].map(|state| self.seen(state, reference));
        let changes = after.iter().zip(&*before).map(|(after, before)| after - before);
        changes.map(|change| change / self.record.step_size).collect()
    }

    fn seen<'s>(&self, state: &'s State, reference: Option<&ReferenceMotion>) -> [Cow<'s, [f64]>; 2] {
        let State { displacement, velocity, .. } = state;
        match reference {
            Some(reference) => reference.seen(self.body, displacement, velocity).map(Cow::Owned),
            None => [displacement, velocity].map(|own| Cow::Borrowed(&own[..])),
        }
    }
}
