//! A rank's part of a body: its numbers in the whole mesh, its border, and the calls that reductions are made of.

use std::sync::{Arc, Mutex, PoisonError};

use super::{Neighbour, Parcel, Team, text_of};
use crate::error::{Error, Result};

/// The part of a body that a rank computes: its numbers in the whole mesh, and calls of all ranks. Own nodes come
/// first, then guests. [`crate::body::Body::ranks`] has it.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::mesh::{Share, owners};
/// use emmy::team::{Team, Threads};
/// let mesh = mesh::block([4.0, 1.0, 1.0], [4, 1, 1])?;
/// let owners = owners(&mesh, 2)?;
/// let sums = Threads::run(2, |team| -> emmy::Result<f64> {
///     let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
///     let body = Body::shared(Share::new(&mesh, &owners, team.rank()), team).region(rubber).build()?;
///     let part = body.ranks();
///     let mut n = [part.n_own() as f64];
///     part.sum("own nodes", &mut n);
///     Ok(n[0])
/// });
/// assert!(sums.unwrap().into_iter().all(|n| n.unwrap() == 20.0));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Subdomain {
    team: Arc<dyn Team>,
    pub(crate) n_own: usize,
    pub(crate) n_nodes_of_ranks: usize,
    pub(crate) nodes: Vec<u32>,
    pub(crate) cells: Vec<u32>,
    counts: Vec<bool>,
    neighbours: Vec<Neighbour>,
    parcels: Mutex<Vec<Parcel>>,
}

/// Numbers of kinds of errors.
const INVERTED: f64 = 1.0;
const NOT_FINITE: f64 = 2.0;

impl Subdomain {
    pub(crate) fn new(
        team: Arc<dyn Team>,
        [n_own, n_nodes_of_ranks]: [usize; 2],
        nodes: Vec<u32>,
        (cells, counts): (Vec<u32>, Vec<bool>),
        neighbours: Vec<Neighbour>,
    ) -> Self {
        let parcels = neighbours.iter().map(|neighbour| Parcel { rank: neighbour.rank, ..Parcel::default() });
        Subdomain {
            team,
            n_own,
            n_nodes_of_ranks,
            nodes,
            cells,
            counts,
            parcels: Mutex::new(parcels.collect()),
            neighbours,
        }
    }

    /// The whole body on a team of one.
    pub(crate) fn whole(team: Arc<dyn Team>, n_nodes: usize, n_cells: usize) -> Self {
        let [nodes, cells] = [n_nodes, n_cells].map(|n| (0..n as u32).collect());
        Subdomain::new(team, [n_nodes; 2], nodes, (cells, vec![true; n_cells]), Vec::new())
    }

    /// The team.
    pub fn team(&self) -> &Arc<dyn Team> {
        &self.team
    }

    /// Number of own nodes.
    pub fn n_own(&self) -> usize {
        self.n_own
    }

    /// Number of nodes of the whole mesh.
    pub fn n_nodes_of_ranks(&self) -> usize {
        self.n_nodes_of_ranks
    }

    /// Number in the whole mesh of each node.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The own node with a number in the whole mesh; `None` if another rank owns it.
    pub fn own_node(&self, whole: usize) -> Option<usize> {
        self.nodes[..self.n_own].binary_search_by(|&node| (node as usize).cmp(&whole)).ok()
    }

    /// Number in the whole mesh of each cell; ascending among those that count here, which come first, and among the
    /// others.
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// Whether each cell counts here; the others count on another rank, which computes them too.
    pub fn counts(&self) -> &[bool] {
        &self.counts
    }

    /// The ranks with which nodes are exchanged.
    pub fn neighbours(&self) -> impl Iterator<Item = usize> {
        self.neighbours.iter().map(|neighbour| neighbour.rank)
    }

    /// Number of this rank.
    pub fn rank(&self) -> usize {
        self.team.rank()
    }

    /// Number of ranks.
    pub fn size(&self) -> usize {
        self.team.size()
    }

    /// [`Team::sum`].
    pub fn sum(&self, name: &'static str, values: &mut [f64]) {
        self.team.sum(name, values);
    }

    /// [`Team::largest`].
    pub fn largest(&self, name: &'static str, values: &mut [f64]) {
        self.team.largest(name, values);
    }

    /// Which of some things are true on some rank.
    pub fn any<const N: usize>(&self, name: &'static str, own: [bool; N]) -> [bool; N] {
        let mut numbers = own.map(|own| f64::from(u8::from(own)));
        self.largest(name, &mut numbers);
        numbers.map(|number| number > 0.0)
    }

    /// The lowest number of all ranks; `None` if no rank has one.
    pub fn lowest(&self, name: &'static str, own: Option<usize>) -> Option<usize> {
        let mut most = [own.map_or(f64::NEG_INFINITY, |own| -(own as f64))];
        self.largest(name, &mut most);
        (most[0] != f64::NEG_INFINITY).then_some(-most[0] as usize)
    }

    /// Replaces the numbers of all ranks by those of one.
    pub fn take_from(&self, rank: usize, name: &'static str, values: &mut [f64]) {
        if self.rank() != rank {
            values.fill(0.0);
        }
        self.sum(name, values);
    }

    /// The numbers of all ranks, `[rank][values]`.
    pub fn gather(&self, name: &'static str, own: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.size() * own.len()];
        all[self.rank() * own.len()..(self.rank() + 1) * own.len()].copy_from_slice(own);
        self.sum(name, &mut all);
        all
    }

    /// Replaces the values of guests by those of their owners. `read` and `write` pass the numbers of a node, `width`
    /// of them, in the same order.
    pub fn exchange<V: ?Sized>(
        &self,
        name: &'static str,
        width: usize,
        values: &mut V,
        read: impl Fn(&V, usize, &mut [f64]),
        write: impl Fn(&mut V, usize, &[f64]),
    ) {
        let mut parcels = self.parcels.lock().unwrap_or_else(PoisonError::into_inner);
        for (parcel, neighbour) in parcels.iter_mut().zip(&self.neighbours) {
            parcel.outgoing.resize(width * neighbour.outgoing.len(), 0.0);
            parcel.incoming.resize(width * neighbour.incoming.len(), 0.0);
            let nodes = neighbour.outgoing.iter().zip(parcel.outgoing.chunks_exact_mut(width));
            nodes.for_each(|(&node, numbers)| read(values, node as usize, numbers));
        }
        self.team.exchange(name, &mut parcels);
        for (parcel, neighbour) in parcels.iter().zip(&self.neighbours) {
            let nodes = neighbour.incoming.iter().zip(parcel.incoming.chunks_exact(width));
            nodes.for_each(|(&node, numbers)| write(values, node as usize, numbers));
        }
    }

    /// Checks that the parts of all ranks are those of one partition of one mesh.
    ///
    /// # Errors
    /// [`Error::NotOnTeam`], on all ranks.
    pub(crate) fn check_partition(&self) -> Result<()> {
        let n = self.n_nodes_of_ranks as f64;
        let mut own = [self.n_own as f64];
        self.sum("own nodes", &mut own);
        let mut bounds = [n, -n];
        self.largest("nodes of the mesh", &mut bounds);
        match own == [n] && bounds == [n, -n] {
            true => Ok(()),
            false => Err(Error::NotOnTeam { what: "a body of shares of different partitions".to_string() }),
        }
    }

    /// The same outcome on all ranks: the error of the lowest rank that has one, with cells and nodes of the whole
    /// mesh.
    pub(crate) fn agree<T>(&self, outcome: Result<T>) -> Result<T> {
        let own = outcome.as_ref().err().map(|_| self.rank());
        let Some(rank) = self.lowest("outcome", own) else { return outcome };
        let own = outcome.err().map(|error| self.in_whole_numbers(error));
        // The errors whose kind decides how a motion continues are the same on all ranks; others keep their message.
        let (kind, numbers, text) = match &own {
            Some(Error::Inverted { cell, det }) => (INVERTED, [*cell as f64, *det], String::new()),
            Some(Error::NotFiniteAt { what, time, value }) => (NOT_FINITE, [*time, *value], what.clone()),
            error => (0.0, [0.0; 2], error.as_ref().map(Error::to_string).unwrap_or_default()),
        };
        let mut head = [kind, numbers[0], numbers[1]];
        self.take_from(rank, "error", &mut head);
        let [kind, first, second] = head;
        if kind == INVERTED {
            return Err(Error::Inverted { cell: first as usize, det: second });
        }
        let message = text_of(&*self.team, rank, &text);
        if kind == NOT_FINITE {
            return Err(Error::NotFiniteAt { what: message, time: first, value: second });
        }
        let mut differs = [f64::from(u8::from(own.is_none() || text != message))];
        self.largest("message of all ranks", &mut differs);
        match own {
            Some(error) if differs[0] == 0.0 => Err(error),
            _ => Err(Error::OnRank { rank, message }),
        }
    }

    /// The error with the numbers of the whole mesh.
    fn in_whole_numbers(&self, error: Error) -> Error {
        let whole = |cell: usize| self.cells.get(cell).map_or(cell, |&cell| cell as usize);
        match error {
            Error::Inverted { cell, det } => Error::Inverted { cell: whole(cell), det },
            Error::InvertedCell { cell, kind, det } => Error::InvertedCell { cell: whole(cell), kind, det },
            Error::WrongMaterial { cell, kind } => Error::WrongMaterial { cell: whole(cell), kind },
            Error::RegionCover { cell, count } => Error::RegionCover { cell: whole(cell), count },
            Error::Formulation { cell, reason } => Error::Formulation { cell: whole(cell), reason },
            Error::NoMass { node, position } => {
                Error::NoMass { node: self.nodes.get(node).map_or(node, |&node| node as usize), position }
            }
            error => error,
        }
    }
}
