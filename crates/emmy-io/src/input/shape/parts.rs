//! `mesh.parts`: several bodies, each with a source and a place of its own.

use std::path::{Path, PathBuf};

use emmy::mesh::Placement;

use super::built_in::{BuiltIn, SHAPES, few_cells, with_shapes};
use super::{LINKS, of_file, of_shape, with_file};
use crate::input::description::{Described, Kind, NUMBER, POSITIVE, Section, vector};
use crate::input::fault::{Fault, Place};
use crate::input::table::{Item, Read, Table};
use crate::mesh::{MeshFile, MeshOptions, joined};

/// An entry of `mesh.parts`.
pub(in crate::input) static PARTS: Described = Described::new(|| {
    let section = Section::new("parts", "A part of the mesh: exactly one source").must(
        "name",
        Kind::Text,
        "",
        "Its name, and that of the group of its cells: letters, digits, `_` and `-`",
    );
    with_file(with_shapes(section))
        .exactly_one(&[&SHAPES[..], &["file"]].concat())
        .may("scale", POSITIVE, "", "Factor on its coordinates")
        .absent("1")
        .may("turn", Kind::Table(&TURN), "", "Rotation after `scale`")
        .absent("none")
        .may("at", vector(), "length", "Shift after `turn`: the place of its origin")
        .absent("the origin")
});

/// `turn` of a part.
pub(in crate::input) static TURN: Described = Described::new(|| {
    Section::new("turn", "Rotation of a part")
        .must("axis", vector(), "", "Direction of the axis, of any length")
        .must("angle", NUMBER, "radian", "Angle, counter-clockwise seen from the tip of the axis")
        .may("about", vector(), "length", "A point of the axis, after `scale`")
        .absent("the origin of the part")
});

/// A part of the mesh.
#[derive(Debug)]
pub(super) struct Part {
    name: String,
    /// Place of its name.
    name_place: Place,
    source: Source,
    /// Place of the source's value.
    place: Place,
    scale: Option<f64>,
    placement: Placement,
    /// Place of its rotation, else of the part.
    turn_place: Place,
}

#[derive(Debug)]
enum Source {
    BuiltIn(BuiltIn),
    File(PathBuf),
}

impl Part {
    fn read(table: &Table<'_>, directory: &Path) -> Result<Self, Fault> {
        let item = table.chosen();
        let source = match BuiltIn::read(item)? {
            Some(shape) => Source::BuiltIn(shape),
            None => Source::File(directory.join(<&str>::read(item))),
        };
        let name: Item<'_> = table.must("name");
        let turn = table.item("turn");
        let placement = turn.map(placement).transpose()?.unwrap_or_default();
        Ok(Part {
            name: <&str>::read(name).to_string(),
            name_place: name.place().clone(),
            source,
            place: item.place().clone(),
            scale: table.may("scale"),
            placement: placement.shifted(table.may("at").unwrap_or_default()),
            turn_place: turn.map_or(table.place, |turn| turn.place()).clone(),
        })
    }

    /// The mesh at its place.
    fn mesh(&self, options: &MeshOptions) -> Result<MeshFile, Fault> {
        let file = match &self.source {
            Source::BuiltIn(shape) => of_shape(shape, &self.place),
            Source::File(path) => {
                // Groups of links have the name of the part before them; a region without a group has all links.
                let own =
                    |group: &String| Some(group.strip_prefix(&self.name)?.strip_prefix('-')?.to_string());
                let all = options.links.iter().filter(|group| *group == LINKS).cloned();
                let links = all.chain(options.links.iter().filter_map(own)).collect();
                of_file(path, &MeshOptions { links, ..*options }, &self.place)
            }
        }?;
        let file = file.scaled(self.scale.unwrap_or(1.0));
        let file = file.map_err(|error| Fault::at(&self.place, error.to_string(), "from here"))?;
        file.placed(&self.placement)
            .map_err(|error| Fault::at(&self.turn_place, error.to_string(), "this rotation"))
    }

    /// Its mesh file.
    pub(super) fn file(&self) -> Option<&Path> {
        match &self.source {
            Source::File(path) => Some(path),
            Source::BuiltIn(_) => None,
        }
    }
}

fn placement(turn: Item<'_>) -> Result<Placement, Fault> {
    let table = Table::read(turn);
    let axis: Item<'_> = table.must("axis");
    let about = table.may("about").unwrap_or_default();
    Placement::default()
        .turned(Read::read(axis), table.must("angle"), about)
        .map_err(|_| axis.fault("`axis` of a rotation must have a direction", "zero"))
}

/// Reads the parts; paths are relative to `directory`.
pub(super) fn read(item: Item<'_>, directory: &Path) -> Result<Vec<Part>, Fault> {
    let mut parts: Vec<Part> = Vec::new();
    let mut count = 0.0;
    for own in item.items() {
        let part = Part::read(&Table::read(own), directory)?;
        if let Some(first) = parts.iter().find(|other| other.name == part.name) {
            let message = format!("two parts are named `{}`", part.name);
            return Err(Fault::at(&part.name_place, message, "second").label(&first.name_place, "first"));
        }
        if let Source::BuiltIn(shape) = &part.source {
            count += shape.count();
            few_cells(count, &own)?;
        }
        parts.push(part);
    }
    Ok(parts)
}

/// The mesh of all parts, with the remarks of their readers.
pub(super) fn mesh(parts: &[Part], options: &MeshOptions, place: &Place) -> Result<MeshFile, Fault> {
    let mut files = Vec::new();
    for part in parts {
        files.push((part.name.clone(), part.mesh(options)?));
    }
    joined(files).map_err(|error| {
        let name = match &error {
            emmy::Error::PartName { part }
            | emmy::Error::GroupOfPartExists { part, .. }
            | emmy::Error::MixedParts { part } => part,
            _ => return Fault::at(place, error.to_string(), "these parts"),
        };
        let place = parts.iter().find(|part| part.name == *name).map_or(place, |part| &part.name_place);
        Fault::at(place, error.to_string(), "this part")
    })
}
