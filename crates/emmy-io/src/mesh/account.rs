//! The treatment of the entries in a file: cards of Nastran, keywords of Abaqus, sections of Gmsh, arrays of
//! VTK.

use std::collections::BTreeMap;

use crate::input::suggest::nearest;

/// The treatment of an entry by a reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Treatment {
    /// It is read.
    Read,
    /// It has no effect on the motion.
    NoEffect,
    /// It would change the motion, and is left out, with a note.
    LeftOut,
    /// It makes nodes or cells in a way that is not read: an error.
    Refused,
}

#[cfg(test)]
impl Treatment {
    /// All, in the order of the documentation.
    pub(crate) const ALL: [Treatment; 4] =
        [Treatment::Read, Treatment::NoEffect, Treatment::LeftOut, Treatment::Refused];

    /// Words of the documentation.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Treatment::Read => "read",
            Treatment::NoEffect => "without effect on the motion",
            Treatment::LeftOut => "would change the motion: left out, with a note",
            Treatment::Refused => "makes nodes or cells: an error",
        }
    }
}

/// Entries of one treatment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entries {
    pub(crate) treatment: Treatment,
    /// Their common description in the documentation, such as `rigid elements and constraints`.
    #[cfg_attr(not(test), expect(dead_code))]
    pub(crate) what: &'static str,
    /// Names in upper case; one that ends with `*` stands for all names that begin so.
    pub(crate) names: &'static [&'static str],
}

/// Treatment of a name in upper case: first by entries with the whole name, then by their beginnings; `None`: unknown.
pub(crate) fn treatment(table: &[Entries], name: &str) -> Option<Treatment> {
    let whole = |entries: &&Entries| entries.names.contains(&name);
    let begins = |entries: &&Entries| {
        entries.names.iter().any(|own| own.strip_suffix('*').is_some_and(|own| name.starts_with(own)))
    };
    table.iter().find(whole).or_else(|| table.iter().find(begins)).map(|entries| entries.treatment)
}

/// Entries of a file that are not read, counted by their names.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Account {
    left_out: BTreeMap<String, usize>,
    unknown: BTreeMap<String, usize>,
}

impl Account {
    /// Counts an entry by its treatment in a table, which is returned; the name is in upper case.
    pub(crate) fn add(&mut self, table: &[Entries], name: &str) -> Option<Treatment> {
        let treatment = treatment(table, name);
        match treatment {
            Some(Treatment::Read | Treatment::NoEffect | Treatment::Refused) => {}
            Some(Treatment::LeftOut) => self.leave_out(name),
            None => *self.unknown.entry(name.to_string()).or_default() += 1,
        }
        treatment
    }

    /// Counts an entry that would change the motion, such as an element of a kind that is not read.
    pub(crate) fn leave_out(&mut self, name: &str) {
        *self.left_out.entry(name.to_string()).or_default() += 1;
    }

    /// Entries that would change the motion, as `2 CONM2, 1 RBE2`; `None`: there is none.
    pub(crate) fn left_out(&self) -> Option<String> {
        listed(&self.left_out)
    }

    /// A note on the entries that would change the motion, and one on the unknown ones.
    pub(crate) fn notes(&self) -> Vec<String> {
        let left_out = self.left_out().map(|all| format!("left out, though it may change the motion: {all}"));
        let unknown = listed(&self.unknown).map(|all| format!("{UNKNOWN}{all}"));
        left_out.into_iter().chain(unknown).collect()
    }

    /// The unknown entries, each with the nearest name that a table reads: one of them may be misspelt.
    pub(crate) fn suspects(&self, table: &[Entries]) -> Option<String> {
        let read = || {
            let read = table.iter().filter(|entries| entries.treatment == Treatment::Read);
            read.flat_map(|entries| entries.names).copied()
        };
        let suggestion = |name: &str| {
            nearest(name, read()).map(|own| format!(" (did you mean {own}?)")).unwrap_or_default()
        };
        listed_with(&self.unknown, suggestion).map(|all| format!("{UNKNOWN}{all}"))
    }
}

const UNKNOWN: &str = "not known, and left out: ";

/// Names of a note at most.
const MAX_NAMES: usize = 20;

/// Counts and names, the most frequent first.
fn listed(counts: &BTreeMap<String, usize>) -> Option<String> {
    listed_with(counts, |_| String::new())
}

/// The same with a remark on each name.
fn listed_with(counts: &BTreeMap<String, usize>, remark: impl Fn(&str) -> String) -> Option<String> {
    let mut all: Vec<(&String, &usize)> = counts.iter().collect();
    all.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    let more = all.len().saturating_sub(MAX_NAMES);
    let shown: Vec<String> = all
        .iter()
        .take(MAX_NAMES)
        .map(|(name, count)| format!("{count} {}{}", crate::message::name(name), remark(name)))
        .collect();
    let rest = if more > 0 { format!(" and {more} other names") } else { String::new() };
    (!shown.is_empty()).then(|| shown.join(", ") + &rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &[Entries] = &[
        Entries { treatment: Treatment::LeftOut, what: "rigid elements", names: &["RBE*", "MPC"] },
        Entries { treatment: Treatment::NoEffect, what: "numbers of rows", names: &["RBEX", "PARAM"] },
    ];

    #[test]
    fn whole_names_come_before_beginnings() {
        let found = ["RBE2", "RBEX", "PARAM", "MPC", "MPCADD"].map(|name| treatment(TABLE, name));
        let (left_out, no_effect) = (Some(Treatment::LeftOut), Some(Treatment::NoEffect));
        assert_eq!(found, [left_out, no_effect, no_effect, left_out, None]);
    }

    #[test]
    fn every_entry_is_counted_once() {
        let mut account = Account::default();
        assert_eq!(account.notes(), Vec::<String>::new());
        for name in ["MPC", "FOO", "RBE2", "PARAM", "RBE2"] {
            account.add(TABLE, name);
        }
        account.leave_out("CONM2");
        assert_eq!(account.left_out().unwrap(), "2 RBE2, 1 CONM2, 1 MPC");
        assert_eq!(
            account.notes(),
            [
                "left out, though it may change the motion: 2 RBE2, 1 CONM2, 1 MPC",
                "not known, and left out: 1 FOO"
            ]
        );
        for i in 0..25 {
            account.add(TABLE, &format!("X{i}"));
        }
        assert!(account.notes()[1].ends_with(" and 6 other names"), "{:?}", account.notes());
    }
}
