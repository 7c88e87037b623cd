//! `[[tie]]`: nodes that follow the points of another group.

use std::collections::HashSet;

use emmy::body::{Body, InitialVelocity, Tie, TieKind, TieSummary};
use emmy::internals::material::Bounds;
use emmy::mesh::Mesh;

use super::description::{Described, Kind, NUMBER, Section, list};
use super::fault::{Fault, Place};
use super::placed::Members;
use super::table::{Item, Table};
use crate::units::Units;

/// Kinds of ties.
const KINDS: [&str; 2] = ["mortar", "nodes"];

/// `[[tie]]`.
pub(super) static TIE: Described = Described::new(|| {
    Section::new("[[tie]]", "Nodes that follow the points of another group, on which they lie")
        .must("follower", Kind::Text, "", "Group of facets, nodes or cells, whose nodes follow")
        .must(
            "leader",
            Kind::Text,
            "",
            "Group that they follow: its facets; if it has none its nodes, which they must meet, else its cells",
        )
        .may(
            "kind",
            Kind::Word("a kind of tie", KINDS.to_vec(), |_| None),
            "",
            "`mortar`: by integrals over two surfaces, so that a uniform stress passes exactly between plane facets; \
             `nodes`: each node follows the nearest point of the leader",
        )
        .absent("`mortar` where both groups have facets, else `nodes`")
        .may(
            "tolerance",
            Kind::Number(Bounds::AtLeast(0.0)),
            "",
            "Largest shift of a follower onto the leader, relative to the longest edge of the facet or cell there; of \
             a node onto a node, to the shortest edge at the follower",
        )
        .default("0.05")
        .may(
            "weights",
            list(1, NUMBER),
            "",
            "For a follower of one node: weights of the nodes of the leader, in the order of their numbers, with the sum 1",
        )
        .absent("by `kind`")
        .may("partial", Kind::True, "", "Nodes beyond `tolerance`, and those of the leader itself, stay free")
        .absent("they are an error")
});

/// A tie with the places of its table and of the names of its groups.
#[derive(Debug)]
pub(super) struct PlacedTie {
    tie: Tie,
    place: Place,
    follower: Place,
    leader: Place,
}

/// Reads one tie.
pub(super) fn read(table: &Table<'_>) -> Result<PlacedTie, Fault> {
    let [follower, leader] = ["follower", "leader"].map(|key| table.must::<Item<'_>>(key));
    if follower.name() == leader.name() {
        let message = format!("`{}` cannot follow itself", leader.name());
        return Err(leader.fault(message, "leader").label(follower.place(), "follower"));
    }
    let kind = table.item("kind").map(|item| match item.text() {
        Some("nodes") => TieKind::Nodes,
        _ => TieKind::Mortar,
    });
    let weights = table.item("weights").and_then(|_| table.may::<Vec<f64>>("weights"));
    if let (Some(item), Some(TieKind::Mortar), Some(_)) = (table.item("kind"), kind, &weights) {
        return Err(item.fault("`weights` are those of a node; by mortar they are integrals", "leave it out"));
    }
    let partial = table.item("partial").is_some();
    let tie = Tie { kind, weights, partial, ..Tie::new(follower.name(), leader.name()) };
    let tie = tie.with_tolerance(table.must("tolerance"));
    let [follower, leader] = [follower, leader].map(|item| item.place().clone());
    Ok(PlacedTie { tie, place: table.place.clone(), follower, leader })
}

impl PlacedTie {
    /// The groups with their places.
    pub(super) fn groups(&self) -> [(String, Place, Members); 2] {
        let PlacedTie { tie, follower, leader, .. } = self;
        [(&tie.follower, follower), (&tie.leader, leader)]
            .map(|(name, place)| (name.clone(), place.clone(), Members::Nodes))
    }

    /// The names of the groups.
    pub(super) fn names(&self) -> [&str; 2] {
        [&self.tie.follower, &self.tie.leader]
    }

    /// The fault of a tie on several ranks.
    pub(super) fn not_on_ranks(&self) -> Fault {
        Fault::at(&self.place, "several ranks do not compute a body with ties", "this tie")
    }

    /// The tie and the place of its table.
    pub(super) fn into_parts(self) -> (Tie, Place) {
        (self.tie, self.place)
    }
}

/// Whether a tie joins two nodes at one place.
pub(super) fn joins(mesh: &Mesh, ties: &[PlacedTie]) -> impl Fn([u32; 2]) -> bool + use<> {
    let nodes = |name: &str| -> HashSet<u32> { mesh.group_nodes(name).into_iter().flatten().collect() };
    let sides: Vec<[HashSet<u32>; 2]> = ties.iter().map(|tie| tie.names().map(nodes)).collect();
    move |[a, b]| {
        let joins = |[follower, leader]: &[HashSet<u32>; 2]| {
            follower.contains(&a) && leader.contains(&b) || follower.contains(&b) && leader.contains(&a)
        };
        sides.iter().any(joins)
    }
}

/// Largest shift of the followers of a tie \[length\], unless it is rounding.
///
/// ```
/// use emmy::prelude::*;
/// let points = [0.0, 1.0, 1.02, 2.0].map(|x| [x, 0.0, 0.0]);
/// let bars = Mesh::from_cells(CellKind::Line2, &points, &[[0, 1], [2, 3]])?
///     .with_node_group("end", [1])?
///     .with_node_group("start", [2])?;
/// let bar = Region::links(Link::bar(200.0, 0.5)?, 1.0);
/// let body = Body::builder(bars).region(bar).tie(Tie::nodes("start", "end")).build()?;
/// let shift = emmy_io::input::shift_of_followers(&body, &body.ties()[0]);
/// assert!((shift.unwrap() - 0.02).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn shift_of_followers(body: &Body, tie: &TieSummary) -> Option<f64> {
    (tie.largest_shift > 1e-9 * body.mesh().diagonal()).then_some(tie.largest_shift)
}

/// Notes on tied nodes whose initial velocity is not that of the nodes that they follow.
pub(super) fn notes_on_start(body: &Body, initial: &[InitialVelocity]) -> Vec<String> {
    let notes = |field: &InitialVelocity| -> Option<[Option<String>; 2]> {
        let group = field.group.as_ref()?;
        let nodes = body.mesh().volume_nodes(group).ok()?;
        let points = body.couplings();
        let is_point = |node: u32| points.iter().any(|point| point.node == node);
        // A point that leads starts with the mean velocity of its nodes.
        let is_apart = |node: &&u32| {
            let mean = points.iter().find(|point| point.leads && point.node == **node);
            let leaders =
                mean.map(|point| &point.weights[..]).or(body.leaders_of(**node)).into_iter().flatten();
            leaders.filter(|own| !is_point(own.0)).any(|(leader, _)| nodes.binary_search(leader).is_err())
        };
        let (rigid, tied): (Vec<u32>, Vec<u32>) =
            nodes.iter().filter(is_apart).partition(|node| body.rigid_body_of(**node).is_some());
        let what = |n: usize| if n == 1 { "node starts" } else { "nodes start" };
        let of_tied = (!tied.is_empty()).then(|| {
            let (n, what) = (tied.len(), what(tied.len()));
            format!("initial velocity of `{group}`: {n} tied {what} with the velocity of the nodes followed instead")
        });
        let of_rigid = rigid.first().map(|node| {
            let (n, what) = (rigid.len(), what(rigid.len()));
            let name = body.rigid_body_of(*node).unwrap_or_default();
            format!(
                "initial velocity of `{group}`: {n} {what} with the velocity of a rigid body instead; give one to `{name}`"
            )
        });
        Some([of_tied, of_rigid])
    };
    initial.iter().filter_map(notes).flatten().flatten().collect()
}

/// Notes on followers that were moved, and on nodes that stay free.
pub(super) fn notes(body: &Body, units: Units) -> Vec<String> {
    let notes = |tie: &TieSummary| {
        let of_tie = format!("tie of `{}` to `{}`", tie.follower, tie.leader);
        let shift = shift_of_followers(body, tie).map(|shift| units.number(shift, "length"));
        let moved = shift.map(|shift| format!("{of_tie}: nodes are moved by up to {shift}"));
        let (n, all) = (tie.n_free, tie.n_free + tie.n_followers);
        let free =
            (n > 0).then(|| format!("{of_tie}: {n} of {all} nodes are beyond its tolerance and stay free"));
        [moved, free]
    };
    body.ties().iter().flat_map(notes).flatten().collect()
}

/// The fault of a body with an impossible tie, or with ties on several ranks.
pub(super) fn fault(error: &emmy::Error, places: &[Place]) -> Option<Fault> {
    let place = match error {
        emmy::Error::Tie { number, .. } => places.get(*number),
        emmy::Error::NotOnTeam { .. } => places.first(),
        _ => None,
    };
    Some(Fault::at(place?, error.to_string(), "this tie"))
}
