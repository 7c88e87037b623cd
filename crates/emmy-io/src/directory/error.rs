//! Why a directory cannot be written to.

use std::io;
use std::path::PathBuf;

/// Why a directory cannot be written to.
#[derive(Debug, thiserror::Error)]
pub enum DirectoryError {
    /// It is a file.
    #[error("{path} is not a directory; name another one with --output")]
    NotADirectory {
        /// The path.
        path: PathBuf,
    },
    /// It holds files that are not from a run.
    #[error(
        "the directory {path} holds files that are not from a run of Emmy (such as {example}); nothing was written, \
         name another directory with --output"
    )]
    Foreign {
        /// The path.
        path: PathBuf,
        /// One of the files.
        example: String,
    },
    /// It holds files, but not results of the expected kind.
    #[error(
        "the directory {path} holds files, but no {kind} of Emmy (there is {example}, but no {witness} that Emmy wrote); \
         nothing was written, name another directory with --output"
    )]
    OfAnotherKind {
        /// The path.
        path: PathBuf,
        /// The expected kind of results.
        kind: &'static str,
        /// The file by which results of this kind are recognized.
        witness: &'static str,
        /// One of the files.
        example: String,
    },
    /// Another run writes into it.
    #[error(
        "another run of Emmy is writing into {path}; wait for it, or name another directory with --output"
    )]
    Busy {
        /// The path.
        path: PathBuf,
    },
    /// The run would remove or overwrite a file that it reads.
    #[error(
        "the run reads {file}, which is among the files in {path} that it would remove or overwrite; nothing was changed, \
         name another directory with --output or move that file"
    )]
    Source {
        /// The directory.
        path: PathBuf,
        /// The file.
        file: PathBuf,
    },
    /// An error of the system.
    #[error("cannot write to {path}: {error}")]
    System {
        /// The path.
        path: PathBuf,
        /// The message of the system.
        #[source]
        error: io::Error,
    },
    /// A file cannot be written, though the directory can be used: a full disk.
    #[error("cannot write to {path}: {error}")]
    File {
        /// The directory.
        path: PathBuf,
        /// The message of the system.
        #[source]
        error: io::Error,
    },
}
