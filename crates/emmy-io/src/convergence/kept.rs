//! References kept on disk, each under a key of all that it depends on.
//!
//! A file is text of the key, then numbers, then a checksum over everything before. It is used only if every part is as
//! it should be and the key is the same, letter by letter; anything else is computed anew.

use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

use emmy::motion::{Samples, State};

use super::Study;
use crate::input::Problem;
use crate::whole_file::replace;

const HEADER: &str = "emmy reference 1\n";

/// Everything that a reference depends on, as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key(String);

impl Key {
    /// The key of a study's reference that starts from a state.
    ///
    /// # Errors
    /// What the system refuses when the mesh file is read.
    pub fn new(problem: &Problem, study: &Study, state: &State) -> io::Result<Self> {
        let mut key = String::new();
        let (start, end) = study.window;
        // Writing to a string cannot fail.
        let _ = writeln!(key, "version = {}", env!("CARGO_PKG_VERSION"));
        let _ = writeln!(key, "scheme = {}, degree {}", study.reference_scheme, study.reference_degree);
        let _ =
            writeln!(key, "steps = {:?} from {:?} by {start:?} to {end:?}", study.reference_size, study.from);
        let _ = writeln!(key, "state = {:016x}", state_sum(state));
        // The input may have lost what is not UTF-8 of the path of the mesh.
        let mesh = problem.files.get(1).map(PathBuf::as_path);
        key.push_str(&what_matters(&problem.resolved, mesh)?);
        Ok(Key(key))
    }

    /// Path of the file in a study's directory.
    pub fn path(&self, directory: &Path) -> PathBuf {
        directory.join("reference").join(format!("{:016x}.samples", checksum(self.0.as_bytes())))
    }
}

/// The resolved input without what does not change a motion from a given state, and with the content of the mesh file
/// in place of its path.
fn what_matters(resolved: &str, mesh: Option<&Path>) -> io::Result<String> {
    let mut input: toml::Table = resolved.parse().map_err(io::Error::other)?;
    ["title", "output", "limits", "initial"].into_iter().for_each(|section| drop(input.remove(section)));
    if let Some(time) = input.get_mut("time").and_then(toml::Value::as_table_mut) {
        ["scheme", "degree", "steps"].into_iter().for_each(|key| drop(time.remove(key)));
    }
    if let Some(file) = input.get_mut("mesh").and_then(|mesh| mesh.get_mut("file")) {
        let path = mesh.unwrap_or(Path::new(file.as_str().unwrap_or_default()));
        let content = std::fs::read(path)?;
        *file = toml::Value::String(format!("{} bytes, sum {:016x}", content.len(), checksum(&content)));
    }
    Ok(input.to_string())
}

fn state_sum(state: &State) -> u64 {
    let numbers = state.displacement.iter().chain(&state.momentum).chain(&state.velocity);
    checksum(&numbers.flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>())
}

/// The 64-bit checksum of Fowler, Noll and Vo (FNV-1a).
fn checksum(bytes: &[u8]) -> u64 {
    let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

/// What was found on disk.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// Nothing under the key.
    Nothing,
    /// A file that is damaged, or not of this key; why.
    Unusable(&'static str),
    /// The samples.
    Samples(Samples),
}

/// Looks for the samples of a key at some times.
pub fn find(directory: &Path, key: &Key, times: &[f64], tolerance: f64) -> Found {
    match std::fs::read(key.path(directory)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Found::Nothing,
        Err(_) => Found::Unusable("cannot be read"),
        Ok(bytes) => match decoded(&bytes, key) {
            Err(reason) => Found::Unusable(reason),
            Ok(samples) if !samples.cover(times, tolerance) => Found::Unusable("lacks some of the times"),
            Ok(samples) => Found::Samples(samples),
        },
    }
}

/// Keeps samples under their key; the file is whole at every moment.
///
/// # Errors
/// What the system refuses.
pub fn keep(directory: &Path, key: &Key, samples: &Samples) -> io::Result<()> {
    let path = key.path(directory);
    std::fs::create_dir_all(directory.join("reference"))?;
    replace(&path, &encoded(key, samples))
}

fn encoded(key: &Key, samples: &Samples) -> Vec<u8> {
    let mut bytes = HEADER.as_bytes().to_vec();
    let sizes = [key.0.len(), samples.times.len(), samples.n_dofs];
    sizes.iter().for_each(|size| bytes.extend((*size as u64).to_le_bytes()));
    bytes.extend(key.0.as_bytes());
    let numbers = samples.times.iter().chain(&samples.displacement);
    numbers.for_each(|number| bytes.extend(number.to_le_bytes()));
    let sum = checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

fn decoded(bytes: &[u8], key: &Key) -> Result<Samples, &'static str> {
    const DAMAGED: &str = "is damaged";
    let (content, sum) = bytes.split_last_chunk::<8>().ok_or(DAMAGED)?;
    if checksum(content) != u64::from_le_bytes(*sum) {
        return Err(DAMAGED);
    }
    let rest = content.strip_prefix(HEADER.as_bytes()).ok_or("is not a reference of this version")?;
    let (sizes, rest) = rest.split_at_checked(24).ok_or(DAMAGED)?;
    let [key_length, n_times, n_dofs] = [0, 8, 16]
        .map(|i| sizes[i..i + 8].iter().rev().fold(0, |sum: usize, byte| sum << 8 | usize::from(*byte)));
    let (text, rest) = rest.split_at_checked(key_length).ok_or(DAMAGED)?;
    if text != key.0.as_bytes() {
        return Err("is of another study");
    }
    let numbers: Vec<f64> =
        rest.as_chunks::<8>().0.iter().map(|number| f64::from_le_bytes(*number)).collect();
    let expected = n_times.checked_mul(n_dofs).and_then(|size| size.checked_add(n_times));
    if expected != Some(numbers.len()) || rest.len() % 8 != 0 {
        return Err(DAMAGED);
    }
    let (times, displacement) = numbers.split_at(n_times);
    Ok(Samples { times: times.to_vec(), n_dofs, displacement: displacement.to_vec() })
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
    fn what_is_kept_is_found_and_nothing_else() {
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
    fn every_damage_is_seen() {
        let key = Key("key".into());
        let whole = encoded(&key, &samples());
        assert_eq!(decoded(&whole, &key), Ok(samples()));
        for length in 0..whole.len() {
            assert!(decoded(&whole[..length], &key).is_err());
            let mut flipped = whole.clone();
            flipped[length] ^= 4;
            assert!(decoded(&flipped, &key).is_err());
        }
        // A whole checksum does not make a whole file.
        for sizes in [[u64::MAX, 2, 3], [3, u64::MAX, 3], [3, 2, u64::MAX], [3, 2, 2]] {
            let mut odd = whole[..whole.len() - 8].to_vec();
            let at = HEADER.len();
            sizes
                .iter()
                .enumerate()
                .for_each(|(i, size)| odd[at + 8 * i..at + 8 * i + 8].copy_from_slice(&size.to_le_bytes()));
            let sum = checksum(&odd);
            odd.extend(sum.to_le_bytes());
            assert!(decoded(&odd, &key).is_err(), "{sizes:?}");
        }
    }

    #[test]
    fn only_what_matters_is_in_the_key() {
        let input = |output: &str, mu: &str| {
            format!(
                "title = 'a'\n[mesh]\nscale = 2.0\n[time]\nscheme = 'DGM'\n[region]\nmu = {mu}\n[output]\n{output}\n"
            )
        };
        let key = |output: &str, mu: &str| what_matters(&input(output, mu), None).unwrap();
        assert_eq!(key("every = 1", "3.0"), key("every = 2", "3.0"));
        assert_ne!(key("every = 1", "3.0"), key("every = 1", "3.5"));
        assert!(key("", "1.0").contains("scale"));
    }
}
