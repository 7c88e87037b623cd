//! Groups of the mesh with a record of their names.

use std::collections::{HashMap, HashSet};

use emmy::mesh::Facet;

use super::Assembly;

/// Names of the groups that the mesh has so far.
#[derive(Debug, Default)]
pub(super) struct GroupNames {
    cells: HashSet<String>,
    facets: HashSet<String>,
    nodes: HashSet<String>,
    /// Whether groups of a few nodes are recorded, for the notes on points of entries.
    records_small: bool,
    /// Groups of a few nodes.
    small: HashMap<String, Vec<u32>>,
}

/// Largest number of nodes that is recorded.
const FEW: usize = 16;

impl GroupNames {
    pub(super) fn new(records_small: bool) -> Self {
        GroupNames { records_small, ..GroupNames::default() }
    }

    /// Whether some group has a name.
    pub(super) fn contains(&self, name: &str) -> bool {
        [&self.cells, &self.facets, &self.nodes].iter().any(|names| names.contains(name))
    }

    /// Groups of a few nodes, with these.
    pub(super) fn small(&self) -> impl Iterator<Item = (&str, &[u32])> {
        let small = self.small.iter().filter(|(_, nodes)| (1..=FEW).contains(&nodes.len()));
        small.map(|(name, nodes)| (name.as_str(), nodes.as_slice()))
    }

    /// The name in the input of a group of facets; groups of another kind may have it too.
    pub(super) fn of_facets(&self, name: &str) -> Option<String> {
        self.qualified("facets", &self.facets, name)
    }

    /// The same of a group of nodes.
    pub(super) fn of_nodes(&self, name: &str) -> Option<String> {
        self.qualified("nodes", &self.nodes, name)
    }

    /// The same of a group of cells.
    pub(super) fn of_cells(&self, name: &str) -> Option<String> {
        self.qualified("cells", &self.cells, name)
    }

    fn qualified(&self, kind: &str, own: &HashSet<String>, name: &str) -> Option<String> {
        let n = [&self.cells, &self.facets, &self.nodes].iter().filter(|names| names.contains(name)).count();
        own.contains(name).then(|| if n > 1 { format!("{kind}:{name}") } else { name.to_string() })
    }
}

impl Assembly<'_> {
    pub(super) fn cell_group(&mut self, name: &str, cells: impl IntoIterator<Item = u32>) {
        self.group_names.cells.insert(name.to_string());
        self.builder.cell_group(name, cells);
    }

    pub(super) fn facet_group(&mut self, name: &str, facets: impl IntoIterator<Item = Facet>) {
        self.group_names.facets.insert(name.to_string());
        self.builder.facet_group(name, facets);
    }

    pub(super) fn node_group(&mut self, name: &str, nodes: impl IntoIterator<Item = u32>) {
        self.group_names.nodes.insert(name.to_string());
        if !self.group_names.records_small {
            return self.builder.node_group(name, nodes);
        }
        let own = self.group_names.small.entry(name.to_string()).or_default();
        let record = |&node: &u32| {
            // One more than a few says that there are more.
            if own.len() <= FEW && !own.contains(&node) {
                own.push(node);
            }
        };
        self.builder.node_group(name, nodes.into_iter().inspect(record));
    }
}
