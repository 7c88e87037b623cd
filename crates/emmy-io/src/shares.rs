//! Shares of a mesh for the ranks of a team: sent by rank 0, or read from the folder of a mesh that was split before.
//!
//! | file of a folder | content |
//! |---|---|
//! | `0000.share`, `0001.share`, .. | header, the share of a rank as MessagePack, CRC-32 |
//! | `index.json` | the [`Index`], written last |

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use emmy::mesh::{Mesh, Share, Shares};
use emmy::team::{Parcel, Team};
use serde::{Deserialize, Serialize};

use crate::message::counted;
use crate::stored;
use crate::whole_file::{self, named, remove, replace};

/// Name of the index.
pub const INDEX: &str = "index.json";

/// First line of the file of a share; its number is that of the format.
const HEADER: &str = "emmy share 2\n";

/// The index of a folder of shares.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Index {
    /// That Emmy wrote the folder, and which version.
    pub writer: String,
    /// Number of shares.
    pub parts: usize,
    /// Digest of the whole mesh.
    pub digest: String,
    /// The source of the mesh.
    pub source: MeshSource,
    /// Number of nodes of the whole mesh.
    pub nodes: usize,
    /// Number of cells of the whole mesh.
    pub cells: usize,
}

/// The source of a mesh.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshSource {
    /// The section `[mesh]` of the input, without the folder of a file.
    pub section: String,
    /// CRC-32 of the mesh file; `None` for a built-in shape.
    pub checksum: Option<u32>,
}

/// A folder of shares that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SharesError {
    /// The mesh is split into another number of parts.
    #[error("the mesh in {path} is split into {}, but the team has {}", counted(*.parts, "part", "parts"), counted(*.size, "rank", "ranks"))]
    Parts {
        /// The folder.
        path: PathBuf,
        /// Number of its parts.
        parts: usize,
        /// Number of ranks.
        size: usize,
    },
    /// A file is damaged, or is of another mesh.
    #[error("{path} {reason}; split the mesh again")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: String,
    },
    /// An error of the system.
    #[error("{0}")]
    System(#[from] io::Error),
}

/// Gives each rank its share of a mesh that rank 0 alone has, with the owner of each node: a call of all ranks. Rank 0
/// makes and sends one share after another, so that no other rank holds more than its own.
///
/// # Panics
/// If rank 0 has no mesh, or a rank owns no node.
pub fn distribute(team: &dyn Team, whole: Option<(&Mesh, &[u32])>) -> Share {
    let shares = whole.filter(|_| team.rank() == 0).map(|(mesh, owners)| Shares::new(mesh, owners));
    assert!(team.rank() > 0 || shares.is_some(), "rank 0 has the mesh");
    let mut own = shares.as_ref().map(|shares| shares.share(0));
    for rank in 1..team.size() {
        let outgoing = shares.as_ref().map_or_else(Vec::new, |shares| words(&shares.share(rank)));
        let mut length = [outgoing.len() as f64];
        team.sum("length of a share", &mut length);
        let mut parcels = match team.rank() {
            0 => vec![Parcel { rank, outgoing, incoming: Vec::new() }],
            receiver if receiver == rank => {
                vec![Parcel { rank: 0, outgoing, incoming: vec![0.0; length[0] as usize] }]
            }
            _ => Vec::new(),
        };
        team.exchange("share", &mut parcels);
        if team.rank() == rank {
            own = parcels.pop().map(|parcel| share(&parcel.incoming));
        }
    }
    own.expect("every rank below the size of the team has received its share")
}

/// The bytes of a share in the bits of numbers, which a team can send; the first number is that of the bytes.
fn words(share: &Share) -> Vec<f64> {
    let mut bytes = rmp_serde::to_vec(share).expect("lists and numbers can always be encoded");
    let mut words = vec![bytes.len() as f64];
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    words.extend(bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)));
    words
}

fn share(words: &[f64]) -> Share {
    let bytes: Vec<u8> = words[1..].iter().flat_map(|word| word.to_le_bytes()).collect();
    rmp_serde::from_slice(&bytes[..words[0] as usize]).expect("the bytes are those that rank 0 has sent")
}

/// Splits a mesh into the shares of all ranks, a file each; `owners`: rank of each node. Shares of another mesh in the
/// folder are replaced.
///
/// # Errors
/// Errors of the system, with the path.
///
/// # Panics
/// If there is not one owner for each node, or if a rank owns none.
pub fn write(directory: &Path, mesh: &Mesh, owners: &[u32], source: MeshSource) -> io::Result<Index> {
    std::fs::create_dir_all(directory).map_err(named(directory))?;
    // Without an index, the files cannot be used before all are there.
    remove(&directory.join(INDEX))?;
    let shares = Shares::new(mesh, owners);
    for rank in 0..shares.size() {
        let mut bytes = HEADER.as_bytes().to_vec();
        stored::append(&mut bytes, 0, &shares.share(rank))?;
        replace(&file(directory, rank), &bytes)?;
    }
    let index = Index {
        writer: format!("Written by Emmy {}", env!("CARGO_PKG_VERSION")),
        parts: shares.size(),
        digest: crate::checkpoint::digest(mesh),
        source,
        nodes: mesh.n_nodes(),
        cells: mesh.n_cells(),
    };
    let text = serde_json::to_string_pretty(&index).map_err(io::Error::other)?;
    replace(&directory.join(INDEX), format!("{text}\n").as_bytes())?;
    Ok(index)
}

/// Reads the share of a rank of a team of some size, and the index. The outcome may differ between ranks.
///
/// # Errors
/// [`SharesError`].
pub fn read(directory: &Path, rank: usize, size: usize) -> Result<(Share, Index), SharesError> {
    let index = read_index(directory)?;
    if index.parts != size {
        return Err(SharesError::Parts { path: directory.to_path_buf(), parts: index.parts, size });
    }
    let path = file(directory, rank);
    let bytes = whole_file::read(&path).map_err(named(&path))?;
    let damaged = |reason: &str| SharesError::Damaged { path: path.clone(), reason: reason.to_string() };
    let content =
        bytes.strip_prefix(HEADER.as_bytes()).ok_or_else(|| damaged("is not a share of this version"))?;
    stored::verified(&bytes).ok_or_else(|| damaged("is damaged"))?;
    let share: Share = rmp_serde::from_slice(&content[..content.len() - 4])
        .map_err(|error| damaged(&format!("is not a share ({error})")))?;
    match share.rank() == rank && share.n_nodes_of_ranks() == index.nodes {
        true => Ok((share, index)),
        false => Err(damaged("is the share of another rank or mesh")),
    }
}

/// Reads the index of a folder.
///
/// # Errors
/// [`SharesError`].
pub fn read_index(directory: &Path) -> Result<Index, SharesError> {
    let path = directory.join(INDEX);
    let bytes = whole_file::read(&path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => {
            let message =
                format!("{} holds no mesh that was split: there is no {INDEX}", directory.display());
            io::Error::new(ErrorKind::NotFound, message)
        }
        _ => named(&path)(error),
    })?;
    serde_json::from_slice(&bytes).map_err(|error| SharesError::Damaged {
        path,
        reason: format!("is not an index of shares ({error})"),
    })
}

/// File of the share of a rank.
fn file(directory: &Path, rank: usize) -> PathBuf {
    directory.join(format!("{rank:04}.share"))
}

#[cfg(test)]
mod tests {
    use emmy::mesh::{l_block, owners};
    use emmy::team::Threads;

    use super::*;

    #[test]
    fn shares_from_rank_0_are_those_of_the_mesh() {
        let mesh = l_block(1.0).unwrap();
        for size in [1, 2, 5] {
            let owners = owners(&mesh, size).unwrap();
            let of_ranks = Threads::run(size, |team| {
                distribute(&*team, (team.rank() == 0).then_some((&mesh, &owners[..])))
            });
            for (rank, share) in of_ranks.unwrap().into_iter().enumerate() {
                assert_eq!(share, Share::new(&mesh, &owners, rank));
            }
        }
    }

    #[test]
    fn shares_are_read_back_and_damage_is_found() {
        let place = tempfile::tempdir().unwrap();
        let mesh = l_block(1.0).unwrap();
        let of_ranks = owners(&mesh, 3).unwrap();
        let source = MeshSource { section: "l-block = { cell_size = 1 }".to_string(), checksum: None };
        let index = write(place.path(), &mesh, &of_ranks, source).unwrap();
        assert_eq!((index.parts, index.nodes, index.cells), (3, 224, 117));
        for rank in 0..3 {
            let expected = Share::new(&mesh, &of_ranks, rank);
            assert_eq!(read(place.path(), rank, 3).unwrap(), (expected, index.clone()));
        }
        let message = |rank, size| read(place.path(), rank, size).unwrap_err().to_string();
        assert!(message(0, 4).contains("is split into 3 parts, but the team has 4 ranks"));
        let path = file(place.path(), 1);
        let whole = std::fs::read(&path).unwrap();
        for place in (0..whole.len()).step_by(97) {
            let mut damaged = whole.clone();
            damaged[place] ^= 8;
            std::fs::write(&path, &damaged).unwrap();
            assert!(message(1, 3).contains("0001.share is "), "{}", message(1, 3));
        }
        std::fs::write(&path, std::fs::read(file(place.path(), 2)).unwrap()).unwrap();
        assert!(message(1, 3).contains("is the share of another rank or mesh"));
        std::fs::remove_file(place.path().join(INDEX)).unwrap();
        assert!(message(1, 3).contains("holds no mesh that was split"));
    }
}
