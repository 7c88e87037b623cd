//! How each node of a body moves, and the geometry of its cells.

#![allow(non_snake_case)]

pub(crate) mod drive;
pub(crate) mod geometry;
pub(crate) mod internal_nodes;
pub(crate) mod supports;

pub(crate) use geometry::CellTable;
pub(crate) use internal_nodes::InternalNodes;
