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
//! A frame takes a whole number of chunks of each field, the last of them padded with zeros, so that chunks are written
//! once and compressed in parallel. A slash in the name of a group, which would be a path in HDF5, is written as
//! U+2215.

mod chunks;
mod journal;
mod reader;
mod writer;

use std::io;
use std::path::{Path, PathBuf};

use emmy::body::{FieldName, Place};
use rust_hdf5::H5File;

pub use reader::SeriesReader;
pub use writer::Series;

use super::name_of;
use crate::whole_file;

/// Attribute with the program that wrote the file.
const CREATOR: &str = "Creator";

/// Whether a file is a series of frames that Emmy wrote.
pub(crate) fn is_series(path: &Path) -> bool {
    let creator = || H5File::open(path).and_then(|file| file.attr_string(CREATOR));
    whole_file::check_kind(path).is_ok() && creator().is_ok_and(|creator| creator.starts_with("Emmy"))
}

/// The series of a directory and its fields, if it can be read and has a frame.
pub(crate) fn series_fields(directory: &Path) -> Option<(PathBuf, Vec<FieldName>)> {
    let path = directory.join(format!("{}.vtkhdf", name_of(directory)));
    let series = SeriesReader::open(&path).ok().filter(|series| !series.times().is_empty())?;
    Some((path, series.fields()))
}

/// Groups of the fields, and of their offsets.
const fn groups(place: Place) -> [&'static str; 2] {
    match place {
        Place::Nodes => ["VTKHDF/PointData", "VTKHDF/Steps/PointDataOffsets"],
        Place::Cells => ["VTKHDF/CellData", "VTKHDF/Steps/CellDataOffsets"],
    }
}

/// Name of the dataset of a group.
fn without_slash(name: &str) -> String {
    name.replace('/', "\u{2215}")
}

/// An error of HDF5 as an error of the system.
fn rejected(error: rust_hdf5::Hdf5Error) -> io::Error {
    io::Error::other(error)
}
