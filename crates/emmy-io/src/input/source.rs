//! Where the body of a problem comes from.

use std::fmt;
use std::sync::Arc;

use emmy::body::{Body, BodyBuilder};
use emmy::mesh::{Mesh, Share, owners};
use emmy::team::{self, Team};

use super::fault::{Fault, InputError};
use super::parts::CheckedMesh;
use super::problem::Problem;
use crate::checkpoint::digest;

/// Where the body of a problem comes from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Source<'a> {
    /// This process alone; the body of a known problem is taken if it is the same.
    Alone(Option<&'a Problem>),
    /// A team, of which this process is a rank.
    Team(&'a Arc<dyn Team>),
}

impl<'a> Source<'a> {
    /// The problem whose body may be taken.
    pub(super) fn known(self) -> Option<&'a Problem> {
        match self {
            Source::Alone(known) => known,
            Source::Team(_) => None,
        }
    }

    /// The same outcome on all ranks.
    pub(super) fn agree<T>(self, own: Result<T, InputError>) -> Result<T, InputError> {
        match self {
            Source::Alone(_) => own,
            Source::Team(team) => team::agree(&**team, own, |message| Fault::new(message).into()),
        }
    }

    /// The mesh, and on a team its digest.
    pub(super) fn mesh(
        self,
        read: impl FnOnce() -> Result<CheckedMesh, InputError>,
    ) -> Result<(CheckedMesh, Option<String>), InputError> {
        let mesh = self.agree(read())?;
        let digest = matches!(self, Source::Team(_)).then(|| digest(&mesh.file.mesh));
        Ok((mesh, digest))
    }

    /// The builder of a body of a mesh.
    pub(super) fn builder(self, mesh: Mesh) -> Result<BodyBuilder, InputError> {
        let Source::Team(team) = self else { return Ok(Body::builder(mesh)) };
        let fault = |error: &dyn fmt::Display| Fault::new(error.to_string());
        let owners = owners(&mesh, team.size()).map_err(|error| fault(&error))?;
        Ok(Body::shared(Share::new(&mesh, &owners, team.rank()), team.clone()))
    }
}
