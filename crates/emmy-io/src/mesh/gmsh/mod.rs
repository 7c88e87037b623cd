//! Gmsh: the MSH format, versions 2.2 and 4.1, ASCII and binary (Gmsh reference manual, "MSH file format").

mod cursor;
mod draft;
mod shape;
mod v2;
mod v4;

use std::path::Path;

use super::{MeshError, MeshFile, Result, without_mark};
use crate::message;
use cursor::{Cursor, Encoding};
use draft::Draft;
use shape::Shape;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    V2,
    V4,
}

/// Number of a kind of cell.
#[cfg(test)]
pub(super) fn number(kind: emmy::mesh::CellKind) -> Option<i64> {
    Shape::of_kind(kind).map(|shape| shape.id)
}

/// The mesh in the bytes of an MSH file; lines in the groups `links` are cells.
pub(super) fn mesh(file: &Path, bytes: &[u8], links: &[String]) -> Result<MeshFile> {
    let mut cursor = Cursor::new(file, without_mark(bytes));
    let version = version(&mut cursor)?;
    let mut draft = Draft::new(version);
    let mut entities = v4::Entities::new();
    while let Some(section) = cursor.section()? {
        match (section, version) {
            ("PhysicalNames", _) => physical_names(&mut cursor, &mut draft)?,
            ("Nodes", Version::V2) => v2::nodes(&mut cursor, &mut draft)?,
            ("Nodes", Version::V4) => v4::nodes(&mut cursor, &mut draft)?,
            ("Elements", Version::V2) => v2::elements(&mut cursor, &mut draft)?,
            ("Elements", Version::V4) => v4::elements(&mut cursor, &mut draft, &entities)?,
            ("Entities", Version::V4) => v4::entities(&mut cursor, &mut entities)?,
            ("PartitionedEntities", Version::V4) => v4::partitioned_entities(&mut cursor, &mut entities)?,
            _ => cursor.skip_section(section)?,
        }
        cursor.end(section)?;
    }
    draft.mesh(&cursor, links)
}

/// Reads up to the end of `$MeshFormat` and sets the encoding.
fn version(cursor: &mut Cursor) -> Result<Version> {
    loop {
        let start = cursor.offset();
        match cursor.section()? {
            Some("MeshFormat") => break,
            Some("Comments") => cursor.skip_section("Comments")?,
            Some("NOD") => return Err(unsupported_version(cursor, start, "1")),
            _ => return Err(not_gmsh(cursor, start)),
        }
        cursor.end("Comments")?;
    }
    let start = cursor.offset();
    let line = cursor.line()?;
    let fields: Vec<&str> = line.split_whitespace().collect();
    let [number, binary, data_size] = fields[..] else {
        return Err(cursor
            .malformed(start, format!("expected version, file type, data size; found \"{}\"", cut(line))));
    };
    let version = match number.parse::<f64>() {
        Ok(2.2) => Version::V2,
        Ok(4.1) => Version::V4,
        _ => return Err(unsupported_version(cursor, start, number)),
    };
    if data_size != "8" {
        return Err(
            cursor.malformed(start, format!("data size {data_size}; only numbers of 8 bytes are read"))
        );
    }
    cursor.encoding = encoding(cursor, start, binary)?;
    cursor.end("MeshFormat")?;
    Ok(version)
}

/// A binary file begins with the integer 1, which shows its byte order.
fn encoding(cursor: &mut Cursor, start: usize, file_type: &str) -> Result<Encoding> {
    if file_type == "0" {
        return Ok(Encoding::Ascii);
    }
    cursor.encoding = Encoding::LittleEndian;
    match (file_type, cursor.int()?) {
        ("1", 1) => Ok(Encoding::LittleEndian),
        ("1", 0x0100_0000) => Ok(Encoding::BigEndian),
        ("1", _) => Err(cursor.malformed(start, "the mark of the byte order is not 1".to_string())),
        _ => {
            Err(cursor.malformed(start, format!("file type {file_type} is neither 0 (ASCII) nor 1 (binary)")))
        }
    }
}

fn not_gmsh(cursor: &Cursor, start: usize) -> MeshError {
    MeshError::Malformed {
        place: cursor.place(start),
        problem: "the file does not begin with $MeshFormat".to_string(),
        advice: "is it empty, or not an MSH file of Gmsh?",
    }
}

fn unsupported_version(cursor: &Cursor, start: usize, version: &str) -> MeshError {
    MeshError::UnsupportedVersion { place: cursor.place(start), version: version.to_string() }
}

/// `$PhysicalNames`: text in both encodings.
fn physical_names(cursor: &mut Cursor, draft: &mut Draft) -> Result<()> {
    let count = cursor.count_line("physical names", 6)?;
    for _ in 0..count {
        let start = cursor.offset();
        let line = cursor.line()?;
        let Some((key, name)) = physical_name(line) else {
            return Err(cursor
                .malformed(start, format!("expected dimension, number and \"name\", found {}", cut(line))));
        };
        draft.notes.extend(message::note_on_name(name));
        draft.names.insert(key, message::name(name).into_owned());
    }
    Ok(())
}

fn physical_name(line: &str) -> Option<((u8, u64), &str)> {
    let (numbers, name) = line.split_once('"')?;
    let (name, _) = name.rsplit_once('"')?;
    let mut numbers = numbers.split_whitespace();
    let dim = numbers.next()?.parse().ok()?;
    let tag = numbers.next()?.parse::<i64>().ok()?;
    Some(((dim, tag.unsigned_abs()), name))
}

/// The text found, short enough for a message.
fn cut(line: &str) -> String {
    line.chars().take(80).collect()
}

/// The element type of a number.
fn shape(cursor: &Cursor, start: usize, id: i64) -> Result<&'static Shape> {
    Shape::of(id).ok_or_else(|| draft::unsupported(cursor, start, format!("{id} of Gmsh")))
}
