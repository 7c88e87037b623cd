//! References kept on disk, each under a key with everything that it depends on.
//!
//! A file consists of the key, the samples, and a checksum. It is used only if it is complete and its key is the same;
//! otherwise the reference is computed again.

use std::borrow::Cow;
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

use emmy::motion::{Samples, State};
use serde::{Deserialize, Serialize};

use super::Study;
use crate::checkpoint::identity;
use crate::input::Problem;
use crate::stored;
use crate::whole_file::{self, named, replace};

const HEADER: &str = "emmy reference 2\n";
const DAMAGED: &str = "is damaged";

/// Everything that a reference depends on, as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key(String);

impl Key {
    /// The key of the reference of a study that starts from a state.
    ///
    /// # Errors
    /// Errors of the system when the mesh file is read.
    pub fn new(problem: &Problem, study: &Study, state: &State) -> io::Result<Self> {
        let mut key = String::new();
        let (start, end) = study.window;
        // Writing to a string cannot fail.
        let _ = writeln!(key, "version = {}", env!("CARGO_PKG_VERSION"));
        let _ = writeln!(
            key,
            "scheme = {}, degree {}",
            study.reference_scheme.name(),
            study.reference_scheme.degree()
        );
        let _ =
            writeln!(key, "steps = {:?} from {:?} by {start:?} to {end:?}", study.reference_size, study.from);
        let _ = writeln!(key, "state = {:016x}", state_sum(state));
        // The path of the mesh in the input has lost characters that are not UTF-8.
        let mesh = problem.files.get(1).map(PathBuf::as_path);
        key.push_str(&relevant_input(&problem.resolved, mesh)?);
        let _ = writeln!(key, "tables = {}", identity::digest_of_tables(problem));
        Ok(Key(key))
    }

    /// Path of the file in the directory of a study.
    pub fn path(&self, directory: &Path) -> PathBuf {
        directory.join("reference").join(format!("{:016x}.samples", checksum(self.0.as_bytes())))
    }
}

/// The part of the resolved input that determines a motion from a given state, with a checksum of the mesh file instead
/// of its path, and without the paths of histories.
fn relevant_input(resolved: &str, mesh: Option<&Path>) -> io::Result<String> {
    let mut input: toml::Table = resolved.parse().map_err(io::Error::other)?;
    ["title", "output", "limits", "initial"].into_iter().for_each(|section| drop(input.remove(section)));
    if let Some(time) = input.get_mut("time").and_then(toml::Value::as_table_mut) {
        ["scheme", "degree", "steps"].into_iter().for_each(|key| drop(time.remove(key)));
    }
    identity::remove_history_files(&mut input);
    let mut result = Ok(());
    if let Some(toml::Value::Table(section)) = input.get_mut("mesh") {
        let is_one = section.contains_key("file");
        identity::for_each_mesh_file(section, &mut |own| {
            let Some(file) = own.get_mut("file") else { return };
            let named = Path::new(file.as_str().unwrap_or_default());
            match whole_file::read(mesh.filter(|_| is_one).unwrap_or(named)) {
                Ok(content) => {
                    let sum = checksum(&content);
                    *file = toml::Value::String(format!("{} bytes, sum {sum:016x}", content.len()));
                }
                Err(error) => result = Err(error),
            }
        });
    }
    result.map(|()| input.to_string())
}

pub(crate) fn state_sum(state: &State) -> u64 {
    let numbers = state.displacement.iter().chain(&state.momentum).chain(&state.velocity);
    checksum(&numbers.flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>())
}

/// The 64-bit checksum of Fowler, Noll and Vo (FNV-1a).
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

/// Result of a search for kept samples.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// There is no file for the key.
    Nothing,
    /// The file cannot be used, for this reason.
    Unusable(&'static str),
    /// The samples.
    Samples(Samples),
}

/// Looks for the samples of a key at some times.
pub fn find(directory: &Path, key: &Key, times: &[f64], tolerance: f64) -> Found {
    match whole_file::read(&key.path(directory)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Found::Nothing,
        Err(_) => Found::Unusable("cannot be read"),
        Ok(bytes) => match decoded(&bytes, key) {
            Err(reason) => Found::Unusable(reason),
            Ok(samples) if !samples.cover(times, tolerance) => Found::Unusable("lacks some of the times"),
            Ok(samples) => Found::Samples(samples),
        },
    }
}

/// Keeps samples under their key; a file is replaced as a whole.
///
/// # Errors
/// Errors of the system.
pub fn keep(directory: &Path, key: &Key, samples: &Samples) -> io::Result<()> {
    let path = key.path(directory);
    let folder = directory.join("reference");
    std::fs::create_dir_all(&folder).map_err(named(&folder))?;
    replace(&path, &encoded(key, samples)?)
}

/// A reference as stored.
#[derive(Serialize, Deserialize)]
struct StoredReference<'a> {
    key: Cow<'a, str>,
    times: Cow<'a, [f64]>,
    n_dofs: usize,
    displacement: Cow<'a, [f64]>,
}

fn encoded(key: &Key, samples: &Samples) -> io::Result<Vec<u8>> {
    let mut bytes = HEADER.as_bytes().to_vec();
    let Samples { times, n_dofs, displacement } = samples;
    let reference = StoredReference {
        key: Cow::Borrowed(&key.0),
        times: Cow::Borrowed(times),
        n_dofs: *n_dofs,
        displacement: Cow::Borrowed(displacement),
    };
    stored::append(&mut bytes, 0, &reference)?;
    Ok(bytes)
}

fn decoded(bytes: &[u8], key: &Key) -> Result<Samples, &'static str> {
    let content = stored::verified(bytes).ok_or(DAMAGED)?;
    let content = content.strip_prefix(HEADER.as_bytes()).ok_or("is not a reference of this version")?;
    let stored: StoredReference<'_> = rmp_serde::from_slice(content).map_err(|_| DAMAGED)?;
    if stored.key != key.0 {
        return Err("is of another study");
    }
    let samples = Samples {
        times: stored.times.into_owned(),
        n_dofs: stored.n_dofs,
        displacement: stored.displacement.into_owned(),
    };
    let n_numbers = samples.times.len().checked_mul(samples.n_dofs);
    if n_numbers == Some(samples.displacement.len()) { Ok(samples) } else { Err(DAMAGED) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> Samples {
        Samples {
            times: vec![0.0, 0.1 + 0.2],
            n_dofs: 3,
            displacement: vec![1.0, -0.0, 1e-300, 4.0, 5.0, 6.0],
        }
    }

    #[test]
    fn kept_results_are_found_and_nothing_else() {
        let temp = tempfile::tempdir().unwrap();
        let find = |key: &Key, times: &[f64]| find(temp.path(), key, times, 1e-15);
        let key = Key("scheme = DGM".into());
        assert_eq!(find(&key, &[]), Found::Nothing);
        keep(temp.path(), &key, &samples()).unwrap();
        assert_eq!(find(&key, &[0.3]), Found::Samples(samples()));
        assert_eq!(find(&key, &[0.2]), Found::Unusable("lacks some of the times"));
        let other = Key("scheme = AS(1)".into());
        std::fs::copy(key.path(temp.path()), other.path(temp.path())).unwrap();
        assert_eq!(find(&other, &[]), Found::Unusable("is of another study"));
    }

    #[test]
    fn every_damage_is_detected() {
        let key = Key("key".into());
        let whole = encoded(&key, &samples()).unwrap();
        assert_eq!(decoded(&whole, &key), Ok(samples()));
        for length in 0..whole.len() {
            assert!(decoded(&whole[..length], &key).is_err());
            let mut flipped = whole.clone();
            flipped[length] ^= 4;
            assert!(decoded(&flipped, &key).is_err());
        }
        // A valid checksum does not make a valid file.
        for n_dofs in [0, 2, usize::MAX] {
            let odd = encoded(&key, &Samples { n_dofs, ..samples() }).unwrap();
            assert_eq!(decoded(&odd, &key), Err(DAMAGED), "{n_dofs}");
        }
    }

    #[test]
    fn the_key_has_only_the_data_of_a_motion() {
        let input = |output: &str, mu: &str| {
            format!(
                "title = 'a'\n[mesh]\nscale = 2.0\n[time]\nscheme = 'DGM'\n[region]\nmu = {mu}\n[output]\n{output}\n"
            )
        };
        let key = |output: &str, mu: &str| relevant_input(&input(output, mu), None).unwrap();
        assert_eq!(key("every = 1", "3.0"), key("every = 2", "3.0"));
        assert_ne!(key("every = 1", "3.0"), key("every = 1", "3.5"));
        assert!(key("", "1.0").contains("scale"));
    }
}
