//! Motions by a stepper from outside.

use super::stepping::check_state;
use super::{Motion, Snapshot};
use crate::body::Body;
use crate::error::{Error, Result};
use crate::newton::NewtonSettings;
use crate::time::{BodyFeature, Scheme, State, Stepper};

impl<'a> Motion<'a> {
    /// A motion from rest at t = 0 by a stepper of one's own, which was made for this body; [`Motion::from`] gives it
    /// another start. Plans, observers, records, cuts of failing steps and snapshots work as with the schemes of the
    /// library. [`Stepper`] has an example.
    ///
    /// An explicit scheme with the lumped mass is for [`Body::lumped`], on which loads by accelerations act on that
    /// mass.
    ///
    /// # Errors
    /// [`Error::Scheme`] for a body that the stepper cannot integrate ([`Stepper::integrates`]), and for one with
    /// supports that are released, because the stepper keeps its body; [`Error::NotOnTeam`] for a part of a body;
    /// those of [`State::initial`] and [`Stepper::start`].
    pub fn with_stepper(body: &'a Body, stepper: impl Stepper + 'a) -> Result<Self> {
        let scheme = Scheme::Own(stepper.name());
        let refused = |reason: String| Err(Error::Scheme { scheme: scheme.name(), reason });
        body.space.check_whole("a stepper from outside")?;
        scheme.check_body(body)?;
        if let Some(feature) = BodyFeature::of(body).find(|feature| !stepper.integrates(*feature)) {
            return refused(format!(
                "the body has {}, which the stepper does not integrate (`Stepper::integrates`)",
                feature.words()
            ));
        }
        if body.release().is_some() {
            return refused("the body has supports that are released, but the stepper keeps its body".into());
        }
        Motion::with_own(body, scheme, Box::new(stepper), State::initial(body, 0.0, &[])?)
    }

    /// A motion by a stepper of one's own that continues from a snapshot, as [`Motion::resumed`] does by a scheme.
    ///
    /// # Errors
    /// As [`Motion::with_stepper`], [`Motion::starting`] and [`Stepper::restore`].
    pub fn resumed_with_stepper(
        body: &'a Body,
        stepper: impl Stepper + 'a,
        snapshot: Snapshot,
    ) -> Result<Self> {
        let mut state = snapshot.state.clone();
        body.space.agree(check_state(body, &state))?;
        // The stepper may have a mass of its own; the snapshot then brings its momentum back.
        body.mass_product(&state.velocity, &mut state.momentum);
        Motion::with_stepper(body, stepper)?.from(state)?.continued(snapshot)
    }

    /// A motion that starts from a state with a stepper that is there.
    pub(super) fn with_own(
        body: &'a Body,
        scheme: Scheme,
        mut stepper: Box<dyn Stepper + 'a>,
        state: State,
    ) -> Result<Self> {
        Motion::made(body, (scheme, NewtonSettings::default()), state, |state| {
            stepper.start(state)?;
            Ok(stepper)
        })
    }
}
