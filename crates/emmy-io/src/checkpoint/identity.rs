//! The run that a checkpoint belongs to: the part of its input that may not change.

use emmy::mesh::Mesh;
use emmy::team::{self, Team};
use serde::{Deserialize, Serialize};

use crate::input::Problem;
use crate::team::other_than_first;

/// Sections of the input that may not change: body, loads, supports and initial state.
const FIXED: [&str; 12] = [
    "mesh",
    "region",
    "mass",
    "load",
    "support",
    "tie",
    "contact",
    "rigid",
    "coupling",
    "joint",
    "initial",
    "equilibrium",
];

/// Keys of `[output]` that define the content of history columns. Other names of columns have their own message.
const FIXED_OUTPUT: [&str; 3] = ["relative_to", "probes", "values"];

/// The run that a checkpoint belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// The input with all defaults filled in.
    pub input: String,
    /// Digest of the mesh: nodes, cells, groups.
    pub mesh: String,
    /// Digest of the tables that loads and supports follow.
    #[serde(default)]
    pub tables: String,
}

/// The checkpoint belongs to another problem.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Mismatch {
    /// A key of the input has another value.
    #[error(
        "`{key}` is {now}, but {before} in the checkpoint: body, loads, supports, initial state and columns of a run cannot change; \
         start another run with `emmy run`"
    )]
    Key {
        /// The key.
        key: String,
        /// Its value now.
        now: String,
        /// Its value in the checkpoint.
        before: String,
    },
    /// The mesh has changed, although the input names the same file.
    #[error(
        "the mesh has changed since the checkpoint: it had {before} and now has {now}; restore the mesh file"
    )]
    Mesh {
        /// The mesh of the checkpoint.
        before: String,
        /// The mesh now.
        now: String,
    },
    /// A table from a file has changed, although the input names the same file.
    #[error(
        "the file of a history has changed since the checkpoint: the tables had {before} and now have {now}; restore the \
         file, or name an old copy with --set, such as --set load.0.history.file=PATH"
    )]
    Tables {
        /// The tables of the checkpoint.
        before: String,
        /// The tables now.
        now: String,
    },
}

impl Identity {
    /// The identity of a problem.
    pub fn new(problem: &Problem) -> Self {
        Identity {
            input: problem.resolved.clone(),
            mesh: problem.mesh_digest(),
            tables: digest_of_tables(problem),
        }
    }

    /// Checks that a problem has the same body, loads and supports.
    ///
    /// # Errors
    /// [`Mismatch`] with the first key that differs.
    pub fn check(&self, now: &Identity) -> Result<(), Mismatch> {
        let table = |text: &str| text.parse::<toml::Table>().unwrap_or_default();
        let (mut before_input, mut now_input) = (table(&self.input), table(&now.input));
        // Files may have moved; their content is in the digests.
        [&mut before_input, &mut now_input].into_iter().for_each(remove_history_files);
        let (old_files, new_files) = (take_mesh_files(&mut before_input), take_mesh_files(&mut now_input));
        let of = |table: &toml::Table, key: &str| table.get(key).cloned();
        for key in FIXED {
            let found = difference(key, of(&before_input, key).as_ref(), of(&now_input, key).as_ref());
            if let Some((key, before, now)) = found {
                return Err(Mismatch::Key { key, before, now });
            }
        }
        let output = |table: &toml::Table, key: &str| table.get("output")?.get(key).cloned();
        for key in FIXED_OUTPUT {
            let [before, now] = [&before_input, &now_input].map(|table| output(table, key));
            let n_entries = |list: &Option<toml::Value>| list.as_ref()?.as_array().map(Vec::len);
            let found = (n_entries(&before) == n_entries(&now))
                .then(|| difference(&format!("output.{key}"), before.as_ref(), now.as_ref()));
            if let Some((key, before, now)) = found.flatten() {
                return Err(Mismatch::Key { key, before, now });
            }
        }
        let is_static = |table: &toml::Table| !table.contains_key("time");
        if is_static(&before_input) != is_static(&now_input) {
            let text = |table: &toml::Table| if is_static(table) { "missing" } else { "given" }.to_string();
            return Err(Mismatch::Key {
                key: "time".into(),
                before: text(&before_input),
                now: text(&now_input),
            });
        }
        if old_files != new_files || self.mesh != now.mesh {
            return Err(Mismatch::Mesh { before: self.mesh.clone(), now: now.mesh.clone() });
        }
        // Checkpoints of earlier versions have no digest.
        if !self.tables.is_empty() && self.tables != now.tables {
            return Err(Mismatch::Tables { before: self.tables.clone(), now: now.tables.clone() });
        }
        Ok(())
    }

    /// Whether the memory of the stepper is still valid: body, loads, supports, scheme, degree, error estimator, limits
    /// of the degree and linear solver are the same.
    pub fn has_same_stepper(&self, now: &Identity) -> bool {
        let of = |text: &str| {
            let table = text.parse::<toml::Table>().unwrap_or_default();
            let value = |section: &str, key: &str| Some(table.get(section)?.get(key)?.to_string());
            let solver = value("solver", "kind").unwrap_or_else(|| "\"auto\"".into());
            let adaptive = table.get("time").and_then(|time| time.get("adaptive"));
            let of_adaptive = |key: &str| Some(adaptive?.get(key)?.to_string());
            let control = ["estimator", "min_degree", "max_degree"].map(of_adaptive);
            (value("time", "scheme"), value("time", "degree"), control, solver, body_of(&table))
        };
        of(&self.input) == of(&now.input) && (self.tables.is_empty() || self.tables == now.tables)
    }
}

/// The first key at which the resolved input of this rank and those of others differ, as the end of a sentence: a call
/// of all ranks of a team. Paths of files may differ. `None`: all have the same input.
pub(crate) fn other_input(team: &dyn Team, resolved: &str) -> Option<String> {
    let table = |text: &str| {
        let mut table = text.parse::<toml::Table>().unwrap_or_default();
        remove_history_files(&mut table);
        take_mesh_files(&mut table);
        table
    };
    let own = table(resolved).to_string();
    let rank = other_than_first(team, "input", &own)?;
    let [first, other] = [0, rank].map(|rank| toml::Value::Table(table(&team::text_of(team, rank, &own))));
    let key = match difference("", Some(&first), Some(&other)) {
        Some((key, here, there)) => {
            format!(": `{}` is {there} there, and {here} on rank 0", key.trim_start_matches('.'))
        }
        None => String::new(),
    };
    Some(format!("rank {rank} has another input{key}"))
}

/// The sections that describe body, loads and supports, without the paths of files.
fn body_of(input: &toml::Table) -> toml::Table {
    let is_start = |key: &str| ["initial", "equilibrium"].contains(&key);
    let mut body: toml::Table = input
        .clone()
        .into_iter()
        .filter(|(key, _)| FIXED.contains(&key.as_str()) && !is_start(key))
        .collect();
    remove_history_files(&mut body);
    take_mesh_files(&mut body);
    body.iter_mut().for_each(|(_, value)| forget_numbers(value));
    body
}

/// Removes the numbers of functions of a program from their texts, `<function name>3`: they differ between processes.
fn forget_numbers(value: &mut toml::Value) {
    match value {
        toml::Value::String(text) if text.starts_with("<function ") => {
            text.truncate(text.rfind('>').map_or(text.len(), |end| end + 1));
        }
        toml::Value::Array(items) => items.iter_mut().for_each(forget_numbers),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, value)| forget_numbers(value)),
        _ => {}
    }
}

/// Removes the paths of mesh files, and returns how many there are.
fn take_mesh_files(input: &mut toml::Table) -> usize {
    let mut count = 0;
    if let Some(toml::Value::Table(mesh)) = input.get_mut("mesh") {
        for_each_mesh_file(mesh, &mut |own| count += usize::from(own.remove("file").is_some()));
    }
    count
}

/// Calls a function with every table of `[mesh]` that names a file: itself, and its parts.
pub(crate) fn for_each_mesh_file(mesh: &mut toml::Table, visit: &mut dyn FnMut(&mut toml::Table)) {
    if mesh.contains_key("file") {
        visit(mesh);
    }
    let Some(toml::Value::Array(parts)) = mesh.get_mut("parts") else { return };
    let parts = parts.iter_mut().filter_map(toml::Value::as_table_mut);
    parts.filter(|part| part.contains_key("file")).for_each(visit);
}

/// Removes the paths of the files of histories from a resolved input.
pub(crate) fn remove_history_files(input: &mut toml::Table) {
    fn remove(value: &mut toml::Value) {
        match value {
            toml::Value::Array(items) => items.iter_mut().for_each(remove),
            toml::Value::Table(table) => {
                if ["time", "value"].iter().all(|key| table.contains_key(*key)) {
                    table.remove("file");
                }
                table.iter_mut().for_each(|(_, value)| remove(value));
            }
            _ => {}
        }
    }
    for section in ["load", "support", "joint"] {
        input.get_mut(section).into_iter().for_each(remove);
    }
}

/// The first key at which two values differ, with both as text.
fn difference(
    key: &str,
    before: Option<&toml::Value>,
    now: Option<&toml::Value>,
) -> Option<(String, String, String)> {
    use toml::Value::{Array, Table};
    match (before, now) {
        (before, now) if before == now => None,
        (Some(Table(before)), Some(Table(now))) => before
            .keys()
            .chain(now.keys())
            .find_map(|name| difference(&format!("{key}.{name}"), before.get(name), now.get(name))),
        (Some(Array(before)), Some(Array(now))) if before.len() == now.len() => {
            let mut items = before.iter().zip(now).enumerate();
            items.find_map(|(i, (a, b))| difference(&format!("{key}.{i}"), Some(a), Some(b)))
        }
        (before, now) => {
            let text =
                |value: Option<&toml::Value>| value.map_or("missing".to_string(), toml::Value::to_string);
            Some((key.to_string(), text(before), text(now)))
        }
    }
}

/// Digest of nodes, cells and groups.
pub(crate) fn digest(mesh: &Mesh) -> String {
    let mut sum = crc32fast::Hasher::new();
    mesh.points().as_flattened().iter().for_each(|x| sum.update(&x.to_le_bytes()));
    for cell in mesh.cells() {
        sum.update(cell.kind.name().as_bytes());
        cell.nodes.iter().for_each(|node| sum.update(&node.to_le_bytes()));
    }
    sum.update(format!("{:?}", mesh.groups()).as_bytes());
    format!("{} nodes, {} cells, checksum {:08x}", mesh.n_nodes(), mesh.n_cells(), sum.finalize())
}

/// Digest of the tables that loads, supports and joints follow.
pub(crate) fn digest_of_tables(problem: &Problem) -> String {
    let tables =
        problem.time_functions().map(|function| function.acceleration().unwrap_or(function).entries());
    let mut sum = crc32fast::Hasher::new();
    let mut rows = 0;
    for (time, factor) in tables.flatten() {
        [time, factor].iter().for_each(|number| sum.update(&number.to_le_bytes()));
        rows += 1;
    }
    format!("{rows} rows, checksum {:08x}", sum.finalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity(input: &str) -> Identity {
        Identity { input: input.to_string(), mesh: "8 nodes".to_string(), tables: "2 rows".to_string() }
    }

    #[test]
    fn changes_that_are_allowed_and_changes_that_are_not() {
        let old = "mesh = { file = '/a/m.msh', scale = 1.0 }\n[[load]]\ntraction = [1, 2, 3]\n[time]\nscheme = 'DGM'\ndegree = 1\n";
        let check = |new: &str| identity(old).check(&identity(new)).map_err(|error| error.to_string());
        assert_eq!(check(&old.replace("/a/", "/b/").replace("DGM", "AS(2)")), Ok(()));
        for (from, to, key) in [
            ("scale = 1.0", "scale = 2.0", "`mesh.scale` is 2.0, but 1.0"),
            ("[1, 2, 3]", "[1, 2, 4]", "`load.0.traction.2` is 4, but 3"),
            ("[1, 2, 3]", "[1, 2, 3]\n[[support]]\ngroup = 'a'", "`support` is [{"),
            ("[1, 2, 3]", "[1, 2, 3]\n[[tie]]\nfollower = 'a'", "`tie` is [{"),
            ("[1, 2, 3]", "[1, 2, 3]\n[[contact]]\nname = 'a'", "`contact` is [{"),
            ("[1, 2, 3]", "[1, 2, 3]\n[[rigid]]\nname = 'a'", "`rigid` is [{"),
            ("[1, 2, 3]", "[1, 2, 3]\n[[coupling]]\nname = 'a'", "`coupling` is [{"),
            ("[1, 2, 3]", "[1, 2, 3]\n[[joint]]\nname = 'a'", "`joint` is [{"),
        ] {
            let error = check(&old.replace(from, to)).unwrap_err();
            assert!(error.contains(key), "{error}");
        }
        let other = Identity { mesh: "9 nodes".into(), ..identity(old) };
        assert!(matches!(identity(old).check(&other), Err(Mismatch::Mesh { .. })));
        let other = Identity { tables: "3 rows".into(), ..identity(old) };
        assert!(matches!(identity(old).check(&other), Err(Mismatch::Tables { .. })));
        let measured = |file: &str| {
            identity(&format!("{old}[[support]]\nmove.x = {{ file = '{file}', time = 't', value = 'x' }}"))
        };
        assert_eq!(measured("a.csv").check(&measured("/b/c.csv")), Ok(()));
        assert!(identity(old).has_same_stepper(&identity(&format!("{old}[solver]\nkind = 'auto'\n"))));
        assert!(!identity(old).has_same_stepper(&identity(&old.replace("degree = 1", "degree = 2"))));
        // A stepper may remember accelerations, which depend on the loads, and none of where a mesh comes from.
        assert!(!identity(old).has_same_stepper(&identity(&old.replace("[1, 2, 3]", "[1, 2, 4]"))));
        assert!(identity(old).has_same_stepper(&identity(&old.replace("/a/m.msh", "/b/n.msh"))));
        for section in ["tie", "contact", "rigid", "coupling", "joint"] {
            assert!(!identity(old).has_same_stepper(&identity(&format!("{old}[[{section}]]\nname = 'a'\n"))));
        }
        let pushed =
            |history: &str| identity(&old.replace("[1, 2, 3]", &format!("[1, 2, 3]\nhistory = '{history}'")));
        assert!(pushed("<function ramp>1").has_same_stepper(&pushed("<function ramp>7")));
        assert!(!pushed("<function ramp>1").has_same_stepper(&pushed("<function wave>1")));
    }
}
