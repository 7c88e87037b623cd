//! All frames in one `.vtkhdf`: the transient unstructured grid of VTK's file formats, version 2.0.
//!
//! ```text
//! /VTKHDF                         Version = [2, 0], Type = "UnstructuredGrid"
//!   Points, Connectivity, Offsets, Types, NumberOfPoints, ..     once: the mesh does not change
//!   PointData/NAME, CellData/NAME                                fields: frame after frame; groups: once
//!   Steps                         NSteps
//!     Values                      times
//!     PointOffsets, ..            0 for every frame: the one mesh
//!     PointDataOffsets/NAME, ..   row at which each frame begins
//! ```
//!
//! A frame takes a whole number of chunks of each field, the last of which is filled up with zeros: no chunk is written twice, and
//! all are compressed side by side. A slash in the name of a group, which HDF5 would take for a path, is written as U+2215.

mod chunks;
mod journal;
mod reader;
mod writer;

use std::io;

use emmy::body::fields::Place;

pub use reader::SeriesReader;
pub use writer::Series;

/// Attribute of the file that tells who wrote it.
pub(crate) const CREATOR: &str = "Creator";

/// Groups of the fields, and of their offsets.
const fn groups(place: Place) -> [&'static str; 2] {
    match place {
        Place::Nodes => ["VTKHDF/PointData", "VTKHDF/Steps/PointDataOffsets"],
        Place::Cells => ["VTKHDF/CellData", "VTKHDF/Steps/CellDataOffsets"],
    }
}

/// A name of a group of the mesh as that of a dataset.
fn without_slash(name: &str) -> String {
    name.replace('/', "\u{2215}")
}

/// What HDF5 refuses, as what the system refuses.
fn refused(error: rust_hdf5::Hdf5Error) -> io::Error {
    io::Error::other(error)
}
