//! Statistics of the contacts of a body over a motion.

use serde::{Deserialize, Serialize};

use crate::body::{Body, Reaction};

/// The force of a contact over a run. The force is that of the history: the resultant on the body, its mean over a
/// step. It is exactly zero in a step in which no layer acts.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::body::{Contact, Obstacle};
/// let floor = Obstacle::Plane { point: [0.0, 0.0, -0.1], normal: [0.0, 0.0, 1.0] };
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?)
///     .region(Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0))
///     .contact(Contact::with_obstacle("z-min", floor).named("floor"))
///     .build()?;
/// let falls = InitialVelocity { velocity: [0.0, 0.0, -2.0], ..InitialVelocity::default() };
/// let start = State::initial(&body, 0.0, &[falls])?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(start)?;
/// motion.march(&StepPlan::new(0.0, vec![Phase { until: 0.2, size: 0.01 }])?, &mut [])?;
/// let floor = &motion.statistics().contacts[0];
/// let (first, last) = (floor.first_time.unwrap(), floor.last_time.unwrap());
/// assert!(floor.name == "floor" && floor.intervals == 1 && first > 0.0 && last < 0.2);
/// // Its impulse is the change of the momentum, and the force is never more than the largest.
/// let impulse = motion.record().linear_momentum[2] + 2.0;
/// assert!(impulse > 2.0 && impulse < floor.largest_force.unwrap() * floor.duration);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ContactStatistics {
    /// Name of the contact.
    pub name: String,
    /// Largest norm of its force \[force\]; `None` if it had none.
    pub largest_force: Option<f64>,
    /// Time at the end of the step with this force \[time\].
    pub largest_force_time: Option<f64>,
    /// Number of contacts, one after another: intervals of steps with a force between steps without.
    pub intervals: usize,
    /// Time at the start of the first step with a force \[time\]; `None` if there is none.
    pub first_time: Option<f64>,
    /// Time at the end of the last step with a force \[time\].
    pub last_time: Option<f64>,
    /// Duration of the contact: the sum of the sizes of the steps with a force \[time\].
    pub duration: f64,
}

impl ContactStatistics {
    /// Adds a step, given by the end of the step before, its end and its size, with the force in it.
    fn add(&mut self, [before, time, step_size]: [f64; 3], force: [f64; 3]) {
        let force = force.iter().map(|f| f * f).sum::<f64>().sqrt();
        if force == 0.0 {
            return;
        }
        self.intervals += usize::from(self.last_time != Some(before));
        self.first_time.get_or_insert(time - step_size);
        self.last_time = Some(time);
        self.duration += step_size;
        if self.largest_force.is_none_or(|largest| force > largest) {
            (self.largest_force, self.largest_force_time) = (Some(force), Some(time));
        }
    }

    /// Adds a step, given by the end of the step before, its end and its size, to the statistics of all contacts of a
    /// body, or with the size zero a state at rest. `reactions`: by supported group; empty where they are not known.
    pub(super) fn add_all(
        all: &mut Vec<ContactStatistics>,
        body: &Body,
        step: [f64; 3],
        reactions: &[Reaction],
    ) {
        for (number, contact) in body.contacts().enumerate() {
            if number == all.len() {
                all.push(ContactStatistics { name: contact.name.clone(), ..ContactStatistics::default() });
            }
            let mut groups = body.supported_groups().zip(reactions);
            if let Some((_, reaction)) = groups.find(|(name, _)| *name == contact.name) {
                all[number].add(step, reaction.force);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_steps_with_a_force() {
        let mut own = ContactStatistics::default();
        let sizes = [(0.25, 0.0), (0.25, 3.0), (0.5, -4.0), (0.5, 0.0), (0.25, 4.0), (0.25, 0.0)];
        let mut time = 1.0;
        for (step_size, force) in sizes {
            let before = time;
            time += step_size;
            own.add([before, time, step_size], [0.0, force, 0.0]);
        }
        assert_eq!(own.intervals, 2);
        assert_eq!((own.largest_force, own.largest_force_time), (Some(4.0), Some(2.0)));
        assert_eq!((own.first_time, own.last_time, own.duration), (Some(1.25), Some(2.75), 1.0));
    }
}
