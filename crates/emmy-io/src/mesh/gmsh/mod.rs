//! Gmsh: the MSH format, versions 1, 2.0 to 2.2, 4.0 and 4.1, ASCII and binary (Gmsh reference manual, "MSH file
//! format").

mod cursor;
mod draft;
mod partition;
mod shape;
mod v1;
mod v2;
mod v4;

use std::ops::RangeInclusive;
use std::path::Path;

use super::account::{Account, Entries, Treatment};
use super::{MeshError, MeshFile, Result, without_mark};
use crate::message;
use cursor::{Cursor, Encoding};
use draft::Draft;
use shape::Shape;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    V1,
    /// 2.0, whose physical names may have no dimension.
    V20,
    /// 2.1 and 2.2.
    V2,
    V40,
    V41,
}

/// Sections, as the reader treats them.
pub(in crate::mesh) const TABLE: &[Entries] = &[
    Entries {
        treatment: Treatment::Read,
        what: "nodes, elements, physical groups",
        names: &[
            "MeshFormat",
            "PhysicalNames",
            "Entities",
            "PartitionedEntities",
            "Nodes",
            "ParametricNodes",
            "Elements",
            "NOD",
            "ELM",
        ],
    },
    Entries {
        treatment: Treatment::Read,
        what: "copies of cells of other partitions: left out of the file of one partition",
        names: &["GhostElements"],
    },
    Entries {
        treatment: Treatment::NoEffect,
        what: "remarks, fields of results, parametrizations",
        names: &[
            "Comments",
            "NodeData",
            "ElementData",
            "ElementNodeData",
            "InterpolationScheme",
            "Parametrizations",
        ],
    },
    Entries { treatment: Treatment::LeftOut, what: "nodes that move together", names: &["Periodic"] },
];

/// Beginnings of the sections with entities.
const ENTITIES: [&str; 2] = ["$Entities", "$PartitionedEntities"];

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
    let mut account = Account::default();
    // Elements before the entities that have their physical groups.
    let mut postponed = Vec::new();
    while let Some(section) = cursor.section()? {
        use Version::{V1, V2, V20, V40, V41};
        match (section, version) {
            ("PhysicalNames", _) => physical_names(&mut cursor, version, &mut draft)?,
            ("NOD", V1) | ("Nodes", V2 | V20) => v2::nodes(&mut cursor, &mut draft)?,
            ("ParametricNodes", V2 | V20) => v2::parametric_nodes(&mut cursor, &mut draft)?,
            ("Nodes", V40 | V41) => v4::nodes(&mut cursor, version, &mut draft)?,
            ("ELM", V1) => v1::elements(&mut cursor, &mut draft)?,
            ("Elements", V2 | V20) => v2::elements(&mut cursor, &mut draft)?,
            ("Elements", V40 | V41) if entities.is_empty() && cursor.has_ahead(ENTITIES) => {
                postponed.push(cursor.offset());
                cursor.skip_section(section)?;
            }
            ("Elements", V40 | V41) => v4::elements(&mut cursor, version, &mut draft, &entities)?,
            ("Entities", V40 | V41) => v4::entities(&mut cursor, version, &mut entities)?,
            ("PartitionedEntities", V40 | V41) => {
                v4::partitioned_entities(&mut cursor, version, &mut draft, &mut entities)?;
            }
            ("GhostElements", V40 | V41) => v4::ghosts(&mut cursor, version, &mut draft)?,
            _ => {
                account.add(TABLE, section);
                cursor.skip_section(section)?;
            }
        }
        cursor.end(section)?;
    }
    for start in postponed {
        cursor.back_to(start);
        v4::elements(&mut cursor, version, &mut draft, &entities)?;
        cursor.end("Elements")?;
    }
    draft.notes.extend(account.notes());
    draft.mesh(&cursor, links)
}

/// Reads up to the end of `$MeshFormat` and sets the encoding.
fn version(cursor: &mut Cursor) -> Result<Version> {
    loop {
        let start = cursor.offset();
        match cursor.section()? {
            Some("MeshFormat") => break,
            Some("Comments") => cursor.skip_section("Comments")?,
            Some("NOD") => {
                cursor.back_to(start);
                return Ok(Version::V1);
            }
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
        Ok(2.0) => Version::V20,
        Ok(2.1 | 2.2) => Version::V2,
        Ok(4.0) => Version::V40,
        Ok(4.1) => Version::V41,
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

/// `$PhysicalNames`: text in both encodings. Some programs fill names with blanks.
fn physical_names(cursor: &mut Cursor, version: Version, draft: &mut Draft) -> Result<()> {
    let count = cursor.count_line("physical names", 4)?;
    for _ in 0..count {
        let start = cursor.offset();
        let line = cursor.line()?;
        let Some((dims, tag, name)) = physical_name(line, version) else {
            return Err(cursor
                .malformed(start, format!("expected dimension, number and \"name\", found {}", cut(line))));
        };
        let name = name.trim_end();
        draft.notes.extend(message::note_on_name(name));
        for dim in dims {
            draft.names.insert((dim, tag), message::name(name).into_owned());
        }
    }
    Ok(())
}

/// Dimensions, number and name of a physical group; in MSH 2.0 some programs write no dimension.
fn physical_name(line: &str, version: Version) -> Option<(RangeInclusive<u8>, u64, &str)> {
    let (numbers, name) = line.split_once('"')?;
    let (name, _) = name.rsplit_once('"')?;
    let numbers =
        numbers.split_whitespace().map(|number| number.parse().ok()).collect::<Option<Vec<i64>>>()?;
    let (dims, tag) = match numbers[..] {
        [tag] if version == Version::V20 => (0..=3, tag),
        [dim, tag, ..] => u8::try_from(dim).ok().map(|dim| (dim..=dim, tag))?,
        _ => return None,
    };
    Some((dims, tag.unsigned_abs(), name))
}

/// The text found, short enough for a message.
fn cut(line: &str) -> String {
    line.chars().take(80).collect()
}

/// The element type of a number.
fn shape(cursor: &Cursor, start: usize, id: i64) -> Result<&'static Shape> {
    let is_polygon = matches!(id, 34 | 35);
    let unknown = || match id {
        20..=200 if !is_polygon => {
            let problem = format!("elements of type {id} of Gmsh have an order above 2");
            MeshError::Malformed { place: cursor.place(start), problem, advice: shape::HIGHER_ORDER }
        }
        _ => draft::unsupported(cursor, start, format!("{id} of Gmsh")),
    };
    Shape::of(id).ok_or_else(unknown)
}
