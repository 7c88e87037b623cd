//! The force of each kind of load.

use std::sync::Arc;

use super::centrifugal::CentrifugalForce;
use super::dead::DeadLoad;
use super::field_load::FieldLoad;
use super::frame_load::{Action, FrameLoad};
use super::interface::Force;
use super::source::{ForceSource, Site};
use super::surface_pressure::SurfacePressure;
use crate::error::Result;
use crate::input::{FieldDomain, Load, LoadKind};

impl ForceSource for Load {
    fn force(&self, number: usize, site: &Site<'_>) -> Result<Arc<dyn Force>> {
        Ok(match &self.kind {
            LoadKind::Traction { group, traction } => {
                Arc::new(DeadLoad::traction(number, self, group, *traction, site)?)
            }
            LoadKind::Force { group, force } => Arc::new(DeadLoad::total(number, self, group, *force, site)?),
            LoadKind::NodalForce { group, force } => {
                Arc::new(DeadLoad::nodal(number, self, group, *force, site)?)
            }
            LoadKind::Moment { group, moment, follow } => {
                let action = if *follow { Action::FollowingMoment } else { Action::Moment };
                Arc::new(FrameLoad::new(number, self, group, (action, *moment), site)?)
            }
            LoadKind::FollowingForce { group, force } => {
                Arc::new(FrameLoad::new(number, self, group, (Action::FollowingForce, *force), site)?)
            }
            LoadKind::Acceleration { group, acceleration } => {
                Arc::new(DeadLoad::acceleration(number, self, group.as_deref(), *acceleration, site)?)
            }
            LoadKind::Pressure { group, pressure } => {
                Arc::new(SurfacePressure::new(number, self, group, *pressure, site)?)
            }
            LoadKind::Rotation { axis, about, speed } => {
                Arc::new(CentrifugalForce::new(number, self, (*axis, *about, *speed), site)?)
            }
            LoadKind::TractionField { group, field } => {
                Arc::new(FieldLoad::new(number, self, (field, FieldDomain::Facets(group)), site)?)
            }
            LoadKind::BodyForceField { group, field } => {
                Arc::new(FieldLoad::new(number, self, (field, FieldDomain::Cells(group.as_deref())), site)?)
            }
            LoadKind::AccelerationField { group, field } => {
                Arc::new(FieldLoad::new(number, self, (field, FieldDomain::Masses(group.as_deref())), site)?)
            }
        })
    }
}
