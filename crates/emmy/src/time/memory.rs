//! State of a stepper between two steps, as named numbers and words.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::body::Entries;
use crate::error::{Error, Result};

/// State of a stepper between two steps: everything that the next steps depend on besides the [`super::State`] itself.
/// Derived data, such as a factorisation, is not kept. On a team a rank keeps the numbers of its nodes and cells; all
/// else is the same on all ranks.
///
/// ```
/// let mut memory = emmy::time::Memory::default();
/// memory.save_nodal("acceleration", &[0.5, -0.5, 0.0]);
/// memory.save_number("step_size", 0.1);
/// memory.save_word("solver", "direct");
/// assert_eq!(memory.list("acceleration")?, [0.5, -0.5, 0.0]);
/// assert_eq!((memory.number("step_size")?, memory.word("solver")?), (0.1, "direct"));
/// assert!(memory.list("velocity").is_err());
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Memory {
    lists: BTreeMap<String, Vec<f64>>,
    words: BTreeMap<String, String>,
    /// The entities that the lists over nodes and cells belong to.
    entries: BTreeMap<String, Entries>,
}

impl Memory {
    /// Saves a list that is the same on all ranks.
    pub fn save(&mut self, name: &str, list: &[f64]) {
        self.lists.insert(name.to_string(), list.to_vec());
    }

    /// Saves nodal vectors, `[k][n_nodes][3]`.
    pub fn save_nodal(&mut self, name: &str, vectors: &[f64]) {
        self.save(name, vectors);
        self.entries.insert(name.to_string(), Entries::Nodes);
    }

    /// Saves local unknowns, `[function][n]`.
    pub fn save_local(&mut self, name: &str, local: &[f64]) {
        self.save(name, local);
        self.entries.insert(name.to_string(), Entries::Local);
    }

    /// The lists over nodes and cells, by their names.
    pub(crate) fn lists_mut(&mut self) -> impl Iterator<Item = (&str, Entries, &mut Vec<f64>)> {
        let entries = &self.entries;
        self.lists.iter_mut().filter_map(|(name, list)| Some((name.as_str(), *entries.get(name)?, list)))
    }

    /// Saves a number.
    pub fn save_number(&mut self, name: &str, number: f64) {
        self.save(name, &[number]);
    }

    /// Saves a number that may be missing.
    pub fn save_option(&mut self, name: &str, number: Option<f64>) {
        self.save(name, number.as_slice());
    }

    /// Saves a flag.
    pub fn save_flag(&mut self, name: &str, flag: bool) {
        self.save_word(name, if flag { YES } else { NO });
    }

    /// Saves a word, such as the name of a variant.
    pub fn save_word(&mut self, name: &str, word: &str) {
        self.words.insert(name.to_string(), word.to_string());
    }

    /// A list by its name.
    ///
    /// # Errors
    /// [`Error::Memory`] if it is missing.
    pub fn list(&self, name: &str) -> Result<&[f64]> {
        self.lists.get(name).map(Vec::as_slice).ok_or_else(|| missing(name))
    }

    /// A list of a given length.
    ///
    /// # Errors
    /// [`Error::Memory`] if it is missing or has another length.
    pub fn array<const N: usize>(&self, name: &str) -> Result<[f64; N]> {
        let mut array = [0.0; N];
        self.fill(name, &mut array)?;
        Ok(array)
    }

    /// Copies a list.
    ///
    /// # Errors
    /// [`Error::Memory`] if it is missing or has another length.
    pub fn fill(&self, name: &str, target: &mut [f64]) -> Result<()> {
        let list = self.list(name)?;
        if list.len() != target.len() {
            return Err(mismatch(name, format!("has {} numbers, not {}", list.len(), target.len())));
        }
        target.copy_from_slice(list);
        Ok(())
    }

    /// A number.
    ///
    /// # Errors
    /// [`Error::Memory`] if it is missing or a list.
    pub fn number(&self, name: &str) -> Result<f64> {
        self.array(name).map(|[number]| number)
    }

    /// A number that may be missing.
    ///
    /// # Errors
    /// [`Error::Memory`] if it was not kept, or is a longer list.
    pub fn option(&self, name: &str) -> Result<Option<f64>> {
        match self.list(name)? {
            [] => Ok(None),
            [value] => Ok(Some(*value)),
            list => Err(mismatch(name, format!("has {} numbers, not one or none", list.len()))),
        }
    }

    /// A flag.
    ///
    /// # Errors
    /// [`Error::Memory`] if it is missing or another word.
    pub fn flag(&self, name: &str) -> Result<bool> {
        match self.word(name)? {
            YES => Ok(true),
            NO => Ok(false),
            word => Err(mismatch(name, format!("is `{word}`, not `{YES}` or `{NO}`"))),
        }
    }

    /// A word.
    ///
    /// # Errors
    /// [`Error::Memory`] if it is missing.
    pub fn word(&self, name: &str) -> Result<&str> {
        self.words.get(name).map(String::as_str).ok_or_else(|| missing(name))
    }
}

const YES: &str = "yes";
const NO: &str = "no";

fn missing(name: &str) -> Error {
    mismatch(name, "is missing".to_string())
}

fn mismatch(name: &str, reason: String) -> Error {
    Error::Memory { name: name.to_string(), reason }
}
