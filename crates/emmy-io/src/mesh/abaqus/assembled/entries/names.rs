//! Names of entries, which differ from one another and from the groups of the mesh.

use std::collections::{HashMap, HashSet};

use super::super::groups::GroupNames;

/// Names that the input keeps for other things.
const TAKEN: [&str; 3] = ["ground", "linear_momentum", "angular_momentum"];

/// The names of the entries.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>,
    /// The last number of each word.
    last: HashMap<String, usize>,
}

impl Names {
    /// A new name: that of the file in letters, digits, `_` and `-`, with a number where it is not free; without one in
    /// the file, a word with a number.
    pub(super) fn entry(&mut self, name: Option<&str>, word: &str, groups: &GroupNames) -> String {
        match name.map(safe).filter(|name| !name.is_empty()) {
            Some(name) => self.free(&name, groups),
            None => self.numbered(word, groups, 0),
        }
    }

    /// The name itself if it is free, else with the first number from 2 on.
    pub(super) fn free(&mut self, name: &str, groups: &GroupNames) -> String {
        match self.take(name.to_string(), groups) {
            Some(name) => name,
            None => self.numbered(name, groups, 1),
        }
    }

    /// The word with the next number after the last one, or after the least one.
    fn numbered(&mut self, word: &str, groups: &GroupNames, least: usize) -> String {
        let mut number = self.last.get(word).copied().unwrap_or(least);
        loop {
            number += 1;
            if let Some(name) = self.take(format!("{word}-{number}"), groups) {
                self.last.insert(word.to_string(), number);
                return name;
            }
        }
    }

    fn take(&mut self, name: String, groups: &GroupNames) -> Option<String> {
        let is_free = !TAKEN.contains(&name.as_str()) && !groups.contains(&name);
        (is_free && self.taken.insert(name.clone())).then_some(name)
    }
}

/// A name in letters, digits, `_` and `-`.
pub(super) fn safe(name: &str) -> String {
    let is_safe = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    name.trim().chars().map(|c| if is_safe(c) { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_safe_and_differ() {
        let groups = GroupNames::default();
        let mut names = Names::default();
        let mut new = |name| names.entry(name, "tie", &groups);
        assert_eq!(new(Some("Arm-1.Top face")), "Arm-1-Top-face");
        assert_eq!(new(Some("Arm-1 Top face")), "Arm-1-Top-face-2");
        assert_eq!([new(None), new(Some("ground")), new(None)], ["tie-1", "ground-2", "tie-2"]);
    }
}
