//! All tables of the input, and advice on words that are not keys.

use super::description::{Described, Kind, Section};
use super::suggest::did_you_mean;
use super::{
    equilibrium, initial, load, material, measured, nodal, region, settings, shape, support, synonyms, time,
    units,
};

/// The whole input.
pub(super) static ROOT: Described = Described::new(|| {
    Section::new("the input", "Motion of an elastic body; units are any consistent set")
        .may("title", Kind::Text, "", "Any text; it goes into the summary")
        .may("units", Kind::Table(&units::UNITS), "", "System of units, for results with units")
        .must("mesh", Kind::Table(&shape::MESH), "", "Source of the cells")
        .must("region", Kind::Tables(&region::REGION), "", "Material of the cells; one or more")
        .may("mass", Kind::Tables(&nodal::MASS), "", "Masses besides those of the cells; none, one or more")
        .may("load", Kind::Tables(&load::LOAD), "", "Loads on the body; none, one or more")
        .may(
            "support",
            Kind::Tables(&support::SUPPORT),
            "",
            "Nodes that are held or driven; none, one or more",
        )
        .may("initial", Kind::Tables(&initial::INITIAL), "", "Velocities at the start; none, one or more")
        .absent("at rest")
        .may(
            "equilibrium",
            Kind::Table(&equilibrium::EQUILIBRIUM),
            "",
            "Start from the static equilibrium under the loads at t = 0; without `time` a static analysis",
        )
        .absent("starts undeformed")
        .may("time", Kind::Table(&time::TIME), "", "Scheme, degree and steps")
        .absent("a static analysis, which needs `equilibrium`")
        .may("newton", Kind::Table(&settings::NEWTON), "", "End of the iteration of a step")
        .default("{}")
        .may("solver", Kind::Table(&settings::SOLVER), "", "Solver of the linear systems")
        .may("output", Kind::Table(&settings::OUTPUT), "", "Files of the results, and their place")
        .default("{}")
        .may("limits", Kind::Table(&settings::LIMITS), "", "Limits that end a run early")
        .at_least_one(&["time", "equilibrium"])
});

/// Largest number of materials in a message about the tables of a key.
const MAX_MODELS: usize = 3;

impl Section {
    /// The key of this table meant by an unknown word, or the table to which the word belongs.
    pub(super) fn advice(&self, word: &str) -> Option<String> {
        if word.split_once('.').is_some_and(|(first, _)| self.has(first)) {
            return Some(format!("without the quotes: {word}"));
        }
        let mut synonyms = synonyms::of(word);
        let first = synonyms.clone().next();
        let here = synonyms.find(|key| self.has(key)).map(|key| format!("did you mean `{key}`?"));
        here.or_else(|| did_you_mean(word, self.names()))
            .or_else(|| self.elsewhere(word))
            .or_else(|| first.and_then(|key| self.elsewhere(key)))
    }

    /// The table that has a key: the enclosing table, if it has it; all such tables if a few materials have it.
    fn elsewhere(&self, word: &str) -> Option<String> {
        let own = self.name.trim_matches('`');
        let all = all();
        let mut tables = all.iter().filter(|table| table.has(word));
        let around = tables.clone().find(|table| table.has(own));
        let models: Vec<&str> =
            material::sections().filter(|table| table.has(word)).map(|table| table.name).collect();
        let table = around.or_else(|| tables.next())?;
        let name = match models.len() {
            _ if !models.contains(&table.name) => table.name.to_string(),
            0..=MAX_MODELS => models.join(" or "),
            _ => "a material".to_string(),
        };
        Some(format!("`{word}` belongs in {name}"))
    }
}

/// Every table, each before the tables in it; tables with the same keys and the same name once.
pub(super) fn all() -> Vec<&'static Section> {
    fn add(section: &'static Section, all: &mut Vec<&'static Section>) {
        if all.iter().any(|other| std::ptr::eq(*other, section)) {
            return;
        }
        all.push(section);
        section.keys.iter().for_each(|key| add_of(&key.kind, all));
    }
    fn add_of(kind: &Kind, all: &mut Vec<&'static Section>) {
        match kind {
            Kind::Table(section) | Kind::Tables(section) => add(section, all),
            Kind::TimeFunction => add(&measured::MEASURED, all),
            Kind::List(_, of) | Kind::Exactly(_, of) => add_of(of, all),
            _ => {}
        }
    }
    let mut sections = Vec::new();
    add(&ROOT, &mut sections);
    sections
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_keys_are_unique_and_described() {
        for section in all() {
            for (index, key) in section.keys.iter().enumerate() {
                assert!(section.keys[..index].iter().all(|other| other.name != key.name), "{}", key.name);
                assert!(
                    !key.doc.is_empty() && !key.doc.trim_end_matches("...").ends_with('.'),
                    "{} {}",
                    section.name,
                    key.name
                );
            }
        }
    }
}
