//! Reactions: the forces of supports on the body, summed over each supported group.

use super::Space;
use super::supports::SupportedGroup;
use crate::tensor::cross;

/// Force of a support on the body and its moment about the origin: means over a step, the impulses over the step size.
///
/// ```
/// use emmy::prelude::*;
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?)
///     .region(Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0))
///     .support(Support::fixed("z-min"))
///     .support(Support::fixed("z-max"))
///     .load(Load::acceleration([3.0, 0.0, 0.0]))
///     .build()?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?;
/// motion.step(0.1)?;
/// assert_eq!(body.supported_groups().collect::<Vec<_>>(), ["z-min", "z-max"]);
/// assert!((motion.reactions()[0].force[0] + 3.0).abs() < 1e-14); // half of the load, 2 * 3
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reaction {
    /// Force on the body \[force\].
    pub force: [f64; 3],
    /// Moment about the origin \[force length\].
    pub moment: [f64; 3],
}

impl Reaction {
    /// Adds a force with its point of action.
    pub(crate) fn add_at(&mut self, q: [f64; 3], force: [f64; 3]) {
        let moment = cross(q, force);
        (0..3).for_each(|d| self.force[d] += force[d]);
        (0..3).for_each(|d| self.moment[d] += moment[d]);
    }

    /// Adds a multiple of another reaction.
    pub(crate) fn add(&mut self, factor: f64, other: &Reaction) {
        (0..3).for_each(|d| self.force[d] += factor * other.force[d]);
        (0..3).for_each(|d| self.moment[d] += factor * other.moment[d]);
    }
}

impl Space {
    /// Groups with supports or springs to the ground, in the order of the supports and then of the springs. A degree of
    /// freedom that two groups hold counts for the first; a group keeps its place after its release.
    pub(crate) fn supported_groups(&self) -> impl ExactSizeIterator<Item = &str> {
        self.supports.groups.iter().map(|group| group.name.as_str())
    }

    /// The supported groups.
    pub(crate) fn groups(&self) -> &[SupportedGroup] {
        &self.supports.groups
    }

    /// A reaction of zero for each supported group.
    pub(crate) fn no_reactions(&self) -> Vec<Reaction> {
        vec![Reaction::default(); self.supports.groups.len()]
    }

    /// Adds the forces of the supports on the body; `force`: by degree of freedom, read at the fixed ones only.
    pub(crate) fn add_reactions(
        &self,
        displacement: &[f64],
        force: impl Fn(usize) -> f64,
        reactions: &mut [Reaction],
    ) {
        for (group, reaction) in self.supports.groups.iter().zip(reactions) {
            for &dof in &group.dofs {
                let mut vector = [0.0; 3];
                vector[dof % 3] = force(dof);
                reaction.add_at(self.position(displacement, dof / 3), vector);
            }
        }
    }

    /// Reactions of all ranks from those at own nodes.
    pub(crate) fn sum_reactions(&self, reactions: &mut [Reaction]) {
        if self.is_shared() && !reactions.is_empty() {
            let parts = |reaction: &Reaction| [reaction.force, reaction.moment].concat();
            let mut sums: Vec<f64> = reactions.iter().flat_map(parts).collect();
            self.ranks.sum("reactions", &mut sums);
            for (reaction, sums) in reactions.iter_mut().zip(sums.as_chunks::<6>().0) {
                let [fx, fy, fz, mx, my, mz] = *sums;
                *reaction = Reaction { force: [fx, fy, fz], moment: [mx, my, mz] };
            }
        }
    }
}
