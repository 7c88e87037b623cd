//! Links between points.

use emmy::mesh::{CellKind, Mesh, MeshBuilder};

use crate::input::description::{Described, Kind, Section, exactly, list, vector, whole};
use crate::input::fault::Fault;
use crate::input::table::{Item, Read, Table};
use crate::message;

/// `mesh.network`.
pub(super) static NETWORK: Described = Described::new(|| {
    Section::new("network", "Links between points")
        .must("points", list(0, vector()), "length", "Positions of the points, counted from 0")
        .must("links", list(1, exactly(2, whole(0))), "", "Pairs of points, such as `[[0, 1], [1, 2]]`")
        .may(
            "groups",
            Kind::Groups,
            "",
            "Groups of points by name, such as `{ star = [0], planets = [1, 2] }`",
        )
        .may("link_groups", Kind::Groups, "", "Groups of links by name, counted from 0")
});

/// Points, links between them, and named groups of both.
#[derive(Debug)]
pub(super) struct Network {
    points: Vec<[f64; 3]>,
    links: Vec<[u32; 2]>,
    groups: Vec<(String, Vec<u32>)>,
    link_groups: Vec<(String, Vec<u32>)>,
    /// Remarks on names.
    pub(super) notes: Vec<String>,
}

impl Network {
    /// Reads the table.
    pub(super) fn read(table: Table<'_>) -> Result<Self, Fault> {
        let points: Vec<[f64; 3]> = table.must("points");
        let links: Vec<Item<'_>> = table.must("links");
        let links = links.iter().map(|item| link(item, points.len())).collect::<Result<Vec<_>, _>>()?;
        let groups = |key: &str, what: &str, n: usize| -> Result<Vec<(String, Vec<u32>)>, Fault> {
            let items = table.item(key).map(|item| item.items()).unwrap_or_default();
            items.iter().map(|item| Ok((item.key.to_string(), members(item, what, n)?))).collect()
        };
        let groups_of_links = groups("link_groups", "links", links.len())?;
        let groups = groups("groups", "points", points.len())?;
        let names = groups.iter().chain(&groups_of_links).map(|(name, _)| name);
        let notes = names.filter_map(|name| message::note_on_name(name)).collect();
        let read = |groups: Vec<(String, Vec<u32>)>| {
            groups.into_iter().map(|(name, members)| (message::name(&name).into_owned(), members)).collect()
        };
        Ok(Network { groups: read(groups), link_groups: read(groups_of_links), points, links, notes })
    }

    /// Number of links.
    pub(super) fn n_links(&self) -> usize {
        self.links.len()
    }

    /// The mesh.
    pub(super) fn mesh(&self) -> emmy::Result<Mesh> {
        let mut builder = MeshBuilder::new();
        self.points.iter().for_each(|&point| {
            builder.point(point);
        });
        for link in &self.links {
            builder.cell(CellKind::Line2, link)?;
        }
        builder.cell_group("links", 0..self.links.len() as u32);
        self.groups.iter().for_each(|(name, nodes)| builder.node_group(name, nodes.iter().copied()));
        self.link_groups.iter().for_each(|(name, links)| builder.cell_group(name, links.iter().copied()));
        let mesh = builder.build()?;
        emmy::mesh::check(&mesh)?;
        Ok(mesh)
    }
}

/// A link between two points.
fn link(item: &Item<'_>, n_points: usize) -> Result<[u32; 2], Fault> {
    let [a, b]: [usize; 2] = Read::read(*item);
    if a == b {
        return Err(item.fault(format!("a link from point {a} to itself"), "two different points"));
    }
    within(item, a.max(b), "points", n_points)?;
    Ok([a as u32, b as u32])
}

fn within(item: &Item<'_>, number: usize, what: &str, n: usize) -> Result<(), Fault> {
    if number < n {
        return Ok(());
    }
    Err(item.fault(format!("there is no number {number} among the {n} {what}, counted from 0"), "too large"))
}

fn members(group: &Item<'_>, what: &str, n: usize) -> Result<Vec<u32>, Fault> {
    let number = |item: &Item<'_>| {
        let number = usize::read(*item);
        within(item, number, what, n)?;
        Ok(number as u32)
    };
    group.items().iter().map(number).collect()
}
