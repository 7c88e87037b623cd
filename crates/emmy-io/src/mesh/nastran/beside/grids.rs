//! Grid points: their places, the directions of their components, and whether they are nodes of cells.

use std::collections::HashMap;

use super::super::super::abaqus::Deck;
use super::super::range::Range;
use super::super::system::{Grid, Placement, System};
use super::fields::{Outcome, Reason};
use crate::vector::distance;

/// Part of the size of the grid that is rounding of coordinates.
const ROUNDING: f64 = 1e-7;

pub(super) struct Grids<'a> {
    deck: &'a Deck,
    grids: &'a [Grid],
    placement: Placement<'a>,
    /// The system of displacements of grid points that name none.
    default: u64,
    is_of_cell: Vec<bool>,
    /// Diagonal of the box around all grid points.
    size: f64,
}

impl<'a> Grids<'a> {
    /// `defaults`: the systems of coordinates and of displacements of grid points that name none.
    pub(super) fn new(
        deck: &'a Deck,
        systems: &'a HashMap<u64, System>,
        grids: &'a [Grid],
        defaults: [u64; 2],
        is_of_cell: Vec<bool>,
    ) -> Self {
        let extent = |axis: usize| {
            let all = deck.root.points.iter().map(|point| point[axis]);
            let [least, most] = all.fold([f64::MAX, f64::MIN], |[a, b], x| [a.min(x), b.max(x)]);
            most - least
        };
        let placement = Placement::new(deck, systems, grids, defaults[0]);
        let size = extent(0).hypot(extent(1)).hypot(extent(2));
        Grids { deck, grids, placement, default: defaults[1], is_of_cell, size }
    }

    /// Place in the file; midside nodes that were made are no grid points.
    pub(super) fn index(&self, grid: u64) -> Option<usize> {
        let index = *self.deck.root.nodes.get(&grid)? as usize;
        (index < self.grids.len()).then_some(index)
    }

    pub(super) fn known(&self, grid: u64) -> Outcome<()> {
        match self.index(grid) {
            Some(_) => Ok(()),
            None => Err(Reason::fault(format!("there is no grid point {grid}"))),
        }
    }

    /// Known grid points of a range.
    pub(super) fn within(&self, range: &Range) -> Vec<u64> {
        // A range may be much longer than the list of grid points, or much shorter.
        if range.last.saturating_sub(range.first) < self.grids.len() as u64 {
            let own = |grid: &u64| range.contains(*grid) && self.index(*grid).is_some();
            return (range.first..=range.last).filter(own).collect();
        }
        let own = |grid: &&Grid| range.contains(grid.number);
        self.grids.iter().filter(own).map(|grid| grid.number).collect()
    }

    /// The place of a grid point that is known.
    pub(super) fn place(&self, grid: u64) -> [f64; 3] {
        self.index(grid).map_or([0.0; 3], |index| self.deck.root.points[index])
    }

    pub(super) fn is_of_cell(&self, grid: u64) -> bool {
        self.index(grid).is_some_and(|index| self.is_of_cell[index])
    }

    /// Whether a grid point is known and belongs to no cell.
    pub(super) fn is_unused(&self, grid: u64) -> bool {
        self.index(grid).is_some_and(|index| !self.is_of_cell[index])
    }

    /// Whether two places are one, to rounding.
    pub(super) fn is_near(&self, a: [f64; 3], b: [f64; 3]) -> bool {
        distance(a, b) <= ROUNDING * self.size
    }

    /// Directions of the components 1, 2, 3 of the motion of a grid point.
    pub(super) fn directions(&mut self, grid: u64) -> Outcome<[[f64; 3]; 3]> {
        let system =
            self.index(grid).and_then(|index| self.grids[index].displacement).unwrap_or(self.default);
        self.axes(system, grid)
    }

    /// Directions of the components 1, 2, 3 of a system at a grid point.
    pub(super) fn axes(&mut self, system: u64, grid: u64) -> Outcome<[[f64; 3]; 3]> {
        let place = self.place(grid);
        let Some(index) = self.index(grid) else { return Err(Reason::fault("its grid point is not there")) };
        let axes = self.placement.directions(system, self.grids[index].at, place);
        axes.map_err(|_| Reason::fault(format!("there is no coordinate system {system}")))
    }
}

/// The sum of a place and multiples of three axes.
pub(super) fn shifted(place: [f64; 3], axes: &[[f64; 3]; 3], by: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| place[i] + (0..3).map(|axis| by[axis] * axes[axis][i]).sum::<f64>())
}
