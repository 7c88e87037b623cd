//! What a stepper remembers, as plain numbers.

use crate::error::{Error, Result};

/// The memory of a stepper between two steps: lists of numbers with names. It says all that the next steps depend on beside the
/// state; what can be made again from it, such as a factorisation, is not in it.
///
/// ```
/// let mut memory = emmy::time::Memory::default();
/// memory.keep("step_size", &[0.5]);
/// assert_eq!(memory.list("step_size")?, [0.5]);
/// assert!(memory.list("acceleration").is_err());
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Memory {
    lists: Vec<(String, Vec<f64>)>,
}

impl Memory {
    /// Keeps a list under a name that is not taken.
    pub fn keep(&mut self, name: &str, list: &[f64]) {
        self.lists.push((name.to_string(), list.to_vec()));
    }

    /// A list by its name.
    ///
    /// # Errors
    /// [`Error::Memory`] if there is none.
    pub fn list(&self, name: &str) -> Result<&[f64]> {
        let found = self.lists.iter().find(|(own, _)| own == name);
        found.map(|(_, list)| &list[..]).ok_or_else(|| misfit(name, "is missing".to_string()))
    }

    /// A list of a given length.
    ///
    /// # Errors
    /// [`Error::Memory`] if there is none, or if it has another length.
    pub fn array<const N: usize>(&self, name: &str) -> Result<[f64; N]> {
        let mut array = [0.0; N];
        self.fill(name, &mut array)?;
        Ok(array)
    }

    /// Copies a list.
    ///
    /// # Errors
    /// [`Error::Memory`] if there is none, or if it has another length.
    pub fn fill(&self, name: &str, target: &mut [f64]) -> Result<()> {
        let list = self.list(name)?;
        if list.len() != target.len() {
            return Err(misfit(name, format!("has {} numbers, not {}", list.len(), target.len())));
        }
        target.copy_from_slice(list);
        Ok(())
    }

    /// A list of one number or none.
    ///
    /// # Errors
    /// [`Error::Memory`] if there is none, or a longer one.
    pub fn option(&self, name: &str) -> Result<Option<f64>> {
        match self.list(name)? {
            [] => Ok(None),
            [value] => Ok(Some(*value)),
            list => Err(misfit(name, format!("has {} numbers, not one or none", list.len()))),
        }
    }

    /// All lists with their names, as they were kept.
    pub fn lists(&self) -> impl Iterator<Item = (&str, &[f64])> {
        self.lists.iter().map(|(name, list)| (name.as_str(), &list[..]))
    }
}

impl FromIterator<(String, Vec<f64>)> for Memory {
    fn from_iter<I: IntoIterator<Item = (String, Vec<f64>)>>(lists: I) -> Self {
        Memory { lists: lists.into_iter().collect() }
    }
}

fn misfit(name: &str, reason: String) -> Error {
    Error::Memory { name: name.to_string(), reason }
}
