//! The root of the tree of an input, and names in tables that may have faults.

use emmy::internals::material::ModelCells;

use super::fault::Faults;
use super::shape::LINKS;
use super::table::Table;
use super::{material, nodal, walk};

/// The root of the tree. Every table is checked before it is read, and one with faults does not hinder the others.
pub(super) struct Root<'a> {
    pub(super) table: Table<'a>,
    pub(super) faults: Faults,
}

impl<'a> Root<'a> {
    /// The tables of a section, with those that have faults.
    pub(super) fn raw(&self, key: &str) -> impl Iterator<Item = Table<'a>> + use<'a> {
        let items = self.table.item(key).map(|item| item.items());
        items.into_iter().flatten().filter_map(|item| item.table())
    }

    /// The tables of a section that are right.
    pub(super) fn tables(&mut self, key: &str) -> Vec<Table<'a>> {
        self.table.item(key).map(|item| walk::tables(item, &mut self.faults)).unwrap_or_default()
    }

    /// Reads every table of a section that is right.
    pub(super) fn each<T>(
        &mut self,
        key: &str,
        read: impl Fn(&Table<'a>, &mut Faults) -> Option<T>,
    ) -> Vec<T> {
        let tables = self.tables(key);
        tables.iter().filter_map(|table| read(table, &mut self.faults)).collect()
    }

    /// Reads the table of a section.
    pub(super) fn one<T>(
        &mut self,
        key: &str,
        read: impl Fn(&Table<'a>, &mut Faults) -> Option<T>,
    ) -> Option<T> {
        self.each(key, read).pop()
    }

    /// Names of the rigid bodies and couplings, also of those with faults; `None` if a name cannot be read.
    pub(super) fn rigid_bodies(&self) -> Option<Vec<String>> {
        let sections = ["rigid", "coupling", "mass"];
        if self.faults.are_many() || walk::meant(&self.table).any(|key| sections.contains(&key)) {
            return None;
        }
        let text = |table: &Table<'a>| Some(table.item("name")?.text()?.to_string());
        let named = self.raw("rigid").chain(self.raw("coupling")).map(|table| text(&table));
        let masses = (1..).zip(self.raw("mass")).filter(|(_, table)| table.item("at").is_some());
        let masses = masses.map(|(number, table)| match table.item("name") {
            Some(_) => text(&table),
            None => Some(nodal::name_of(number)),
        });
        named.chain(masses).collect()
    }

    /// Groups that the supports name, and contacts, also in tables with faults; `None` if a name cannot be read.
    pub(super) fn supported_groups(&self) -> Option<Vec<String>> {
        if self.faults.are_many() || walk::meant(&self.table).any(|key| ["support", "contact"].contains(&key))
        {
            return None;
        }
        let mut groups = Vec::new();
        for support in self.table.item("support").into_iter().flat_map(|supports| supports.items()) {
            let group = support.table()?.item("group").filter(|group| group.text().is_some())?.name();
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        for (table, number) in self.raw("contact").zip(1..) {
            groups.push(match table.item("name") {
                Some(name) => name.text()?.to_string(),
                None => format!("contact-{number}"),
            });
        }
        Some(groups)
    }

    /// Groups of the regions of links, also of regions with faults. A region with an unknown material may be one.
    pub(super) fn link_groups(&self) -> Vec<String> {
        let is_solid = |region: &Table<'_>| {
            let mut cells = region.item("material").into_iter().flat_map(material::cells);
            cells.any(|cells| cells == ModelCells::Solids)
        };
        let links = self.raw("region").filter(|region| !is_solid(region));
        let names = links.map(|region| region.group().map_or_else(|| LINKS.to_string(), |(name, _)| name));
        // `cells:NAME` means the cells of a group, unless a group itself has such a name.
        let with_own = |name: String| {
            let own = name.strip_prefix("cells:").map(str::to_string);
            std::iter::once(name).chain(own)
        };
        names.flat_map(with_own).collect()
    }
}
