//! Where the body of a problem comes from.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use emmy::body::{Body, BodyBuilder};
use emmy::mesh::{Mesh, owners};
use emmy::team::{self, Team};

use super::fault::{Fault, InputError};
use super::formulation::Formulations;
use super::problem::Problem;
use crate::checkpoint::identity::for_each_mesh_file;
use crate::checkpoint::{digest, other_input};
use crate::mesh::MeshFile;
use crate::shares::{self, MeshSource};
use crate::team::other_than_first;
use crate::whole_file::{self, named};

/// A mesh in which every group was found, and the formulations of its cells.
#[derive(Debug, Clone)]
pub(super) struct CheckedMesh {
    pub(super) file: MeshFile,
    pub(super) formulations: Formulations,
}

/// Where the body of a problem comes from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Source<'a> {
    /// This process alone; the body of a known problem is taken if it is the same.
    Alone(Option<&'a Problem>),
    /// A team, of which this process is a rank.
    Team(&'a Arc<dyn Team>),
    /// A team whose ranks read their shares from a folder.
    Parts(&'a Arc<dyn Team>, &'a Path),
}

/// Advice for ranks with different inputs.
const ONE_INPUT: &str = "all ranks compute one body: give each the same files and flags";

impl<'a> Source<'a> {
    /// The problem whose body may be taken.
    pub(super) fn known(self) -> Option<&'a Problem> {
        match self {
            Source::Alone(known) => known,
            Source::Team(_) | Source::Parts(..) => None,
        }
    }

    fn team(self) -> Option<&'a dyn Team> {
        match self {
            Source::Alone(_) => None,
            Source::Team(team) | Source::Parts(team, _) => Some(&**team),
        }
    }

    /// Checks that all ranks have read the same input, before they build anything together.
    pub(super) fn check_input(self, resolved: &str) -> Result<(), InputError> {
        match self.team().and_then(|team| other_input(team, resolved)) {
            Some(message) => Err(Fault::new(message).help(ONE_INPUT).into()),
            None => Ok(()),
        }
    }

    /// Checks that mesh and tables are the same on all ranks; `name` and `what` say what they are.
    pub(super) fn check_digest(self, name: &'static str, what: &str, digest: &str) -> Result<(), InputError> {
        let Some(team) = self.team() else { return Ok(()) };
        let Some(rank) = other_than_first(team, name, digest) else { return Ok(()) };
        let [first, other] = [0, rank].map(|rank| team::text_of(team, rank, digest));
        let message = format!("rank {rank} has {what}: {other} there, and {first} on rank 0");
        Err(Fault::new(message).help(ONE_INPUT).into())
    }

    /// The same outcome on all ranks.
    pub(super) fn agree<T>(self, own: Result<T, InputError>) -> Result<T, InputError> {
        match self {
            Source::Alone(_) => own,
            Source::Team(team) | Source::Parts(team, _) => {
                team::agree(&**team, own, |message| Fault::new(message).into())
            }
        }
    }

    /// The mesh, on a team of rank 0 alone, and its digest. Shares in a folder must be those of the mesh of the input,
    /// whose text is `resolved`.
    pub(super) fn mesh(
        self,
        resolved: &str,
        read: impl FnOnce() -> Result<CheckedMesh, InputError>,
    ) -> Result<(Option<CheckedMesh>, Option<String>), InputError> {
        let team = match self {
            Source::Alone(_) => return Ok((Some(read()?), None)),
            Source::Parts(team, folder) => {
                let digest = self.agree(digest_of_parts(folder, resolved, team.rank() == 0))?;
                self.check_digest("mesh", "parts of another mesh", &digest)?;
                return Ok((None, Some(digest)));
            }
            Source::Team(team) => team,
        };
        let mesh = self.agree((team.rank() == 0).then(read).transpose())?;
        let own = mesh.as_ref().map(|mesh| digest(&mesh.file.mesh)).unwrap_or_default();
        Ok((mesh, Some(team::text_of(&**team, 0, &own))))
    }

    /// The builder of a body of a mesh; each rank of a team has its share from rank 0.
    pub(super) fn builder(self, mesh: Option<Mesh>) -> Result<BodyBuilder, InputError> {
        let no_mesh = || InputError::from(Fault::new("no mesh"));
        let team = match self {
            Source::Alone(_) => return Ok(Body::builder(mesh.ok_or_else(no_mesh)?)),
            Source::Parts(team, folder) => {
                let share = shares::read(folder, team.rank(), team.size());
                let share = self.agree(share.map_err(|error| Fault::new(error.to_string()).into()));
                return Ok(Body::shared(share?.0, team.clone()));
            }
            Source::Team(team) => team,
        };
        let owners = mesh.as_ref().map(|mesh| owners(mesh, team.size())).transpose();
        let owners = self.agree(owners.map_err(|error| Fault::new(error.to_string()).into()))?;
        let whole = mesh.as_ref().zip(owners.as_deref());
        Ok(Body::shared(shares::distribute(&**team, whole), team.clone()))
    }
}

/// The digest of the whole mesh of a folder of shares, if they are those of an input. One rank alone compares the mesh
/// file, which need not be there.
fn digest_of_parts(folder: &Path, resolved: &str, compares_file: bool) -> Result<String, InputError> {
    let index = shares::read_index(folder).map_err(|error| Fault::new(error.to_string()))?;
    let (section, files) = mesh_section(resolved);
    let rejected = |message: String| Err(Fault::new(message).help("`emmy split` writes them again").into());
    let shares = format!("the shares in {}", folder.display());
    if index.source.section != section {
        return rejected(format!("{shares} are of another `[mesh]` than that of the input"));
    }
    if compares_file
        && !files.is_empty()
        && files.iter().all(|file| file.exists())
        && index.source.checksum != Some(checksum(&files)?)
    {
        let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        return rejected(format!("{shares} are of another content of {}", names.join(", ")));
    }
    Ok(index.digest)
}

/// The source of the mesh in a resolved input.
pub(super) fn mesh_source(resolved: &str) -> Result<MeshSource, InputError> {
    let (section, files) = mesh_section(resolved);
    let checksum = if files.is_empty() { None } else { Some(checksum(&files)?) };
    Ok(MeshSource { section, checksum })
}

/// The section `[mesh]` of a resolved input, without the folders of files, which may move; and the files.
fn mesh_section(resolved: &str) -> (String, Vec<PathBuf>) {
    let table = resolved.parse::<toml::Table>().unwrap_or_default();
    let Some(toml::Value::Table(mut mesh)) = table.get("mesh").cloned() else { return Default::default() };
    let mut files = Vec::new();
    for_each_mesh_file(&mut mesh, &mut |own| {
        let Some(toml::Value::String(file)) = own.get_mut("file") else { return };
        let path = PathBuf::from(&*file);
        *file = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
        files.push(path);
    });
    (mesh.to_string(), files)
}

/// CRC-32 of files of any size, one after the other.
fn checksum(paths: &[PathBuf]) -> Result<u32, InputError> {
    let (mut hasher, mut bytes) = (crc32fast::Hasher::new(), vec![0; 1 << 20]);
    for path in paths {
        let unreadable = |error| Fault::new(named(path)(error).to_string());
        let mut file = whole_file::open(path).map_err(unreadable)?;
        loop {
            match file.read(&mut bytes).map_err(unreadable)? {
                0 => break,
                n => hasher.update(&bytes[..n]),
            }
        }
    }
    Ok(hasher.finalize())
}
