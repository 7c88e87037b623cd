//! Entries of decks besides their meshes.

use emmy::body::Coupling;
use emmy::mesh::Mesh;
use serde::{Deserialize, Serialize};

use crate::message::counted;

/// A rigid element, coupling, tie, mass, spring or joint of a mesh file, as a table of the input.
///
/// It acts as if it stood in the input, which can refer to its name or leave it out (`mesh.leave_out`).
///
/// ```
/// let deck = b"*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n";
/// assert_eq!(emmy_io::mesh::parse("tet.inp".as_ref(), deck)?.entries, []);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeckEntry {
    /// Its name, of letters, digits, `_` and `-`; no other entry of the file has it.
    pub name: String,
    /// Section of the input: `rigid`, `coupling`, `tie`, `mass`, `support` or `joint`.
    pub section: String,
    /// Its card or keyword: `RBE2`, `*TIE`.
    pub kind: String,
    /// Its number, name or place in the file.
    pub label: String,
    /// Words for one and for several of its kind: `rigid coupling acts`, `rigid couplings act`.
    pub words: [String; 2],
    /// Its table in the input, in the lengths of the file.
    pub table: toml::Table,
}

impl DeckEntry {
    /// Its card with the label, such as `RBE2 12`.
    pub fn card(&self) -> String {
        format!("{} {}", self.kind, self.label)
    }

    /// The entry as TOML text.
    ///
    /// # Errors
    /// Those of TOML.
    pub fn to_text(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// The entry of a text of [`DeckEntry::to_text`].
    ///
    /// # Errors
    /// Those of TOML.
    pub fn of_text(text: &str) -> Result<Self, toml::de::Error> {
        toml::from_str(text)
    }

    /// The distributing coupling that it is.
    fn distributing(&self) -> Option<Coupling> {
        let table = &self.table;
        let text = |key: &str| table.get(key)?.as_str();
        let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
        let numbers =
            |key: &str| table.get(key)?.as_array()?.iter().map(number).collect::<Option<Vec<f64>>>();
        let is_one = self.section == "coupling" && text("kind") == Some("distributing");
        let point = numbers("point").filter(|_| is_one)?.try_into().ok()?;
        Some(Coupling { weights: numbers("weights"), ..Coupling::new(&self.name, text("group")?, point) })
    }
}

/// The entries of a deck that act in its mesh when some are switched off, and sentences on those that act, on those
/// that cannot, and on those that are switched off.
///
/// A distributing coupling whose point cannot follow its group does not act. Neither does an entry that names a
/// coupling or a rigid body that does not act.
///
/// ```
/// let deck = b"*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n*Element, type=C3D4\n1, 1,2,3,4\n\
///     *Nset, nset=face\n1,2,3\n*Surface, type=node, name=face\nface\n\
///     *Coupling, constraint name=grip, ref node=5, surface=face\n*Kinematic\n";
/// let file = emmy_io::mesh::parse("tet.inp".as_ref(), deck)?;
/// let acting = |off: &[String]| emmy_io::mesh::acting_entries(&file.entries, &file.mesh, off);
/// let (entries, notes) = acting(&[]);
/// assert_eq!(entries[0].card(), "*COUPLING grip");
/// assert_eq!(notes, ["*COUPLING: 1 rigid coupling acts: grip (mesh.leave_out switches it off)"]);
/// assert_eq!(acting(&["grip".into()]), (vec![], vec!["switched off by `mesh.leave_out`: grip".into()]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn acting_entries(
    entries: &[DeckEntry],
    mesh: &Mesh,
    switched_off: &[String],
) -> (Vec<DeckEntry>, Vec<String>) {
    let mut acting: Vec<&DeckEntry> =
        entries.iter().filter(|entry| !switched_off.contains(&entry.name)).collect();
    let mut reasons = Vec::new();
    let mut lost: Vec<&str> = Vec::new();
    acting.retain(|entry| {
        let Some(coupling) = entry.distributing() else { return true };
        let Err(error) = emmy::internals::body::check_coupling(mesh, &coupling) else {
            return true;
        };
        reasons.push(format!("{} is left out: {error}", entry.name));
        lost.push(&entry.name);
        false
    });
    // Other entries may name couplings and rigid bodies.
    let is_off = |entry: &&DeckEntry| {
        switched_off.contains(&entry.name) && ["coupling", "rigid"].contains(&entry.section.as_str())
    };
    lost.extend(entries.iter().filter(is_off).map(|entry| entry.name.as_str()));
    acting.retain(|entry| {
        let named = lost.iter().find(|own| names(&entry.table, own));
        reasons.extend(named.map(|own| format!("{} is left out with {own}", entry.name)));
        named.is_none()
    });
    let mut notes = notes_by_kind(&acting);
    notes.extend(reasons);
    if !switched_off.is_empty() {
        notes.push(format!("switched off by `mesh.leave_out`: {}", switched_off.join(", ")));
    }
    (acting.into_iter().cloned().collect(), notes)
}

/// A sentence for each kind of entry, in the order of the first of each.
fn notes_by_kind(entries: &[&DeckEntry]) -> Vec<String> {
    let mut kinds: Vec<(&DeckEntry, Vec<String>)> = Vec::new();
    for entry in entries {
        let is_alike = |own: &DeckEntry| (&own.kind, &own.words) == (&entry.kind, &entry.words);
        match kinds.iter_mut().find(|(first, _)| is_alike(first)) {
            Some((_, names)) => names.push(entry.name.clone()),
            None => kinds.push((entry, vec![entry.name.clone()])),
        }
    }
    let note = |(first, names): &(&DeckEntry, Vec<String>)| {
        let [one, many] = &first.words;
        let them = if names.len() == 1 { "it" } else { "them" };
        let count = counted(names.len(), one, many);
        format!("{}: {count}: {} (mesh.leave_out switches {them} off)", first.kind, first_names(names))
    };
    kinds.iter().map(note).collect()
}

/// Whether a table, or a table in it, has a name among its texts.
fn names(table: &toml::Table, name: &str) -> bool {
    let is_name = |value: &toml::Value| value.as_str() == Some(name);
    table.values().any(|value| match value {
        toml::Value::Table(inner) => names(inner, name),
        toml::Value::Array(items) => items.iter().any(is_name),
        value => is_name(value),
    })
}

/// The first names of a list, with the number of the others.
pub(super) fn first_names(names: &[String]) -> String {
    const MAX_NAMES: usize = 10;
    let first = names[..names.len().min(MAX_NAMES)].join(", ");
    match names.len().saturating_sub(MAX_NAMES) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}
