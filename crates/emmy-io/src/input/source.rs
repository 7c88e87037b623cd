//! Where the body of a problem comes from.

use std::sync::Arc;

use emmy::body::{Body, BodyBuilder};
use emmy::mesh::{Mesh, owners};
use emmy::team::{self, Team};

use super::fault::{Fault, InputError};
use super::parts::CheckedMesh;
use super::problem::Problem;
use crate::checkpoint::digest;
use crate::shares;

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

    /// The mesh, on a team of rank 0 alone, and there also its digest.
    pub(super) fn mesh(
        self,
        read: impl FnOnce() -> Result<CheckedMesh, InputError>,
    ) -> Result<(Option<CheckedMesh>, Option<String>), InputError> {
        let Source::Team(team) = self else { return Ok((Some(read()?), None)) };
        let mesh = self.agree((team.rank() == 0).then(read).transpose())?;
        let own = mesh.as_ref().map(|mesh| digest(&mesh.file.mesh)).unwrap_or_default();
        Ok((mesh, Some(team::text_of(&**team, 0, &own))))
    }

    /// The builder of a body of a mesh; each rank of a team has its share from rank 0.
    pub(super) fn builder(self, mesh: Option<Mesh>) -> Result<BodyBuilder, InputError> {
        let no_mesh = || InputError::from(Fault::new("no mesh"));
        let Source::Team(team) = self else { return Ok(Body::builder(mesh.ok_or_else(no_mesh)?)) };
        let owners = mesh.as_ref().map(|mesh| owners(mesh, team.size())).transpose();
        let owners = self.agree(owners.map_err(|error| Fault::new(error.to_string()).into()))?;
        let whole = mesh.as_ref().zip(owners.as_deref());
        Ok(Body::shared(shares::distribute(&**team, whole), team.clone()))
    }
}
