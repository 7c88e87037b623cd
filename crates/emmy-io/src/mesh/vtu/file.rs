//! The XML around the arrays.

use std::borrow::Cow;
use std::path::Path;

use roxmltree::{Document, Node};

use super::super::{MeshError, Place, Result};
use super::array::{Encoding, from_base64, from_bits, from_bytes, from_text, payload, size};
use super::cell::renumber_old_hexahedra;
use super::grid::is_needed;
use super::{Grid, GridArray, Numbers};
use crate::input::suggest::did_you_mean;
use crate::message;

/// Largest number of points and cells of a file: more do not fit into memory, and compressed ones may need only a few
/// bytes.
const MOST: usize = 100_000_000;

const UNSTRUCTURED: &str = "in ParaView, save it as VTK UnstructuredGrid file (.vtu)";

const DAMAGED: &str = "the file is damaged or cut off, write it again";

/// XML text of a file and the appended data after it, which need not be text.
pub(super) struct Parts<'a> {
    pub(super) xml: Cow<'a, str>,
    /// Data after the underscore.
    appended: &'a [u8],
    appended_is_raw: bool,
}

impl<'a> Parts<'a> {
    pub(super) fn new(file: &Path, bytes: &'a [u8]) -> Result<Self> {
        let tag = b"<AppendedData";
        let found = bytes.windows(tag.len()).position(|window| window == tag);
        let text = |bytes: &'a [u8]| {
            let bad = |error: std::str::Utf8Error| {
                let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
                malformed(Place::line(file, line), "text that is not UTF-8".to_string())
            };
            std::str::from_utf8(bytes).map_err(bad)
        };
        let Some(start) = found else {
            return Ok(Parts { xml: text(bytes)?.into(), appended: &[], appended_is_raw: true });
        };
        let rest = &bytes[start..];
        let tag_end = rest.iter().position(|&byte| byte == b'>').unwrap_or(rest.len());
        let underscore = rest[tag_end..].iter().position(|&byte| byte == b'_');
        let begin = underscore.map_or(rest.len(), |at| tag_end + at + 1);
        let appended_is_raw = !rest[..tag_end].windows(6).any(|window| window == b"base64");
        let xml = format!("{}</VTKFile>", text(&bytes[..start])?).into();
        Ok(Parts { xml, appended: &rest[begin..], appended_is_raw })
    }
}

fn malformed(place: Place, problem: String) -> MeshError {
    MeshError::Malformed { place, problem, advice: DAMAGED }
}

/// A piece of an unstructured grid.
pub(super) struct Piece<'a, 'input> {
    file: &'a Path,
    parts: &'a Parts<'a>,
    document: &'a Document<'input>,
    encoding: Encoding,
    piece: Node<'a, 'input>,
    pub(super) n_points: usize,
    pub(super) n_cells: usize,
}

/// Name and numbers of an array.
pub(super) struct Array<'a, 'input> {
    pub(super) name: &'a str,
    pub(super) components: usize,
    numeric_type: &'a str,
    node: Node<'a, 'input>,
}

/// A number of points or cells.
fn count(piece: Node<'_, '_>, name: &str) -> Option<usize> {
    piece.attribute(name)?.trim().parse::<u32>().ok().map(|count| count as usize)
}

/// The document, or the reason why it is invalid.
pub(super) fn document<'a>(file: &Path, parts: &'a Parts<'a>) -> Result<Document<'a>> {
    Document::parse(&parts.xml).map_err(|error| {
        let place = Place::line(file, error.pos().row as usize);
        malformed(place, format!("the XML cannot be read: {error}"))
    })
}

/// The grids in the pieces of a file.
pub(super) fn grids(file: &Path, parts: &Parts<'_>, document: &Document<'_>) -> Result<Vec<Grid>> {
    Piece::all(file, parts, document)?.iter().map(Piece::grid).collect()
}

impl<'a, 'input> Piece<'a, 'input> {
    /// The pieces of a file that have cells.
    pub(super) fn all(
        file: &'a Path,
        parts: &'a Parts<'a>,
        document: &'a Document<'input>,
    ) -> Result<Vec<Self>> {
        let root = document.root_element();
        let grid = child(root, "UnstructuredGrid").filter(|_| root.has_tag_name("VTKFile"));
        let grid = grid.ok_or_else(|| {
            let other = root.attribute("type").filter(|_| root.has_tag_name("VTKFile"));
            let (found, advice) = match other {
                Some(kind @ ("ImageData" | "RectilinearGrid" | "StructuredGrid")) => {
                    (format!(", but {kind}"), "save it as a legacy file of VTK (.vtk), which is read")
                }
                Some(kind) => (format!(", but {}", message::name(kind)), UNSTRUCTURED),
                None => (String::new(), UNSTRUCTURED),
            };
            MeshError::Malformed {
                place: place(file, document, root),
                problem: format!("no unstructured grid of VTK{found}"),
                advice,
            }
        })?;
        let encoding = encoding(root, place(file, document, root))?;
        let pieces = grid.children().filter(|node| node.has_tag_name("Piece"));
        let filled = pieces.filter(|&piece| count(piece, "NumberOfCells") != Some(0));
        let piece = |node| Piece::new(file, parts, document, encoding, node);
        filled.map(piece).collect()
    }

    fn new(
        file: &'a Path,
        parts: &'a Parts<'a>,
        document: &'a Document<'input>,
        encoding: Encoding,
        piece: Node<'a, 'input>,
    ) -> Result<Self> {
        let at = |node: Node<'_, '_>| place(file, document, node);
        let [n_points, n_cells] = ["NumberOfPoints", "NumberOfCells"].map(|name| count(piece, name));
        let missing =
            || malformed(at(piece), "<Piece> without its NumberOfPoints or NumberOfCells".to_string());
        let (n_points, n_cells) = n_points.zip(n_cells).ok_or_else(missing)?;
        for (n, what) in [(n_points, "points"), (n_cells, "cells")] {
            if n > MOST {
                return Err(malformed(at(piece), format!("{n} {what}, more than the {MOST} that are read")));
            }
        }
        for section in elements(piece) {
            check_name(section, &SECTIONS, at)?;
            elements(section).try_for_each(|array| check_name(array, &ARRAYS, at))?;
        }
        Ok(Piece { file, parts, document, encoding, piece, n_points, n_cells })
    }

    /// Its points, cells and arrays.
    pub(super) fn grid(&self) -> Result<Grid> {
        let (points, types, ends, connectivity) = self.points_and_cells()?;
        let arrays = |section: &str, n: usize| {
            let array = |array: Array<'a, 'input>| {
                let is_read =
                    array.components == 1 && size(array.numeric_type).is_some() && is_needed(array.name);
                let numbers = if is_read { Some(self.numbers(&array, Some(n))?) } else { None };
                Ok(GridArray { name: array.name.to_string(), numbers })
            };
            self.arrays(section).into_iter().map(array).collect::<Result<Vec<GridArray>>>()
        };
        let (point_arrays, cell_arrays) =
            (arrays("PointData", self.n_points)?, arrays("CellData", self.n_cells)?);
        Ok(Grid { points, types, ends, connectivity, cell_arrays, point_arrays })
    }

    /// Points, and types, ends and connectivity of the cells.
    #[allow(clippy::type_complexity)]
    pub(super) fn points_and_cells(&self) -> Result<(Vec<[f64; 3]>, Vec<i64>, Vec<i64>, Vec<i64>)> {
        let coordinates = self.required("Points", "", Some(3 * self.n_points))?.into_reals();
        let points: Vec<[f64; 3]> = coordinates.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
        let types = self.required_whole("Cells", "types", Some(self.n_cells))?;
        let ends = self.required_whole("Cells", "offsets", Some(self.n_cells))?;
        let n = ends.last().and_then(|&end| usize::try_from(end).ok());
        let mut connectivity = self.required_whole("Cells", "connectivity", n)?;
        if self.is_older_than_2_1() {
            renumber_old_hexahedra(&types, &ends, &mut connectivity);
        }
        Ok((points, types, ends, connectivity))
    }

    fn is_older_than_2_1(&self) -> bool {
        let version = self.document.root_element().attribute("version").unwrap_or_default();
        let mut numbers = version.split('.').map(|number| number.trim().parse::<u32>().unwrap_or(0));
        [numbers.next().unwrap_or(0), numbers.next().unwrap_or(0)] < [2, 1]
    }

    /// Arrays of a section, such as `Points` or `CellData`.
    pub(super) fn arrays(&self, section: &str) -> Vec<Array<'a, 'input>> {
        let arrays = child(self.piece, section).into_iter().flat_map(|section| section.children());
        let array = |node: Node<'a, 'input>| Array {
            name: node.attribute("Name").unwrap_or_default(),
            components: node.attribute("NumberOfComponents").map_or(Some(1), |n| n.parse().ok()).unwrap_or(1),
            numeric_type: node.attribute("type").unwrap_or_default(),
            node,
        };
        arrays.filter(Node::is_element).map(array).collect()
    }

    /// Numbers of a required array: the only one of its section if `name` is empty.
    pub(super) fn required(&self, section: &str, name: &str, n: Option<usize>) -> Result<Numbers> {
        let array = self.arrays(section).into_iter().find(|array| name.is_empty() || array.name == name);
        let missing = || malformed(self.place(self.piece), format!("<{section}> without the array {name}"));
        self.numbers(&array.ok_or_else(missing)?, n)
    }

    /// Whole numbers of a required array.
    pub(super) fn required_whole(&self, section: &str, name: &str, n: Option<usize>) -> Result<Vec<i64>> {
        match self.required(section, name, n)? {
            Numbers::Whole(numbers) => Ok(numbers),
            Numbers::Real(_) => {
                Err(malformed(self.place(self.piece), format!("array {name} of numbers that are not whole")))
            }
        }
    }

    /// Numbers of an array, `n` of them.
    pub(super) fn numbers(&self, array: &Array<'a, 'input>, n: Option<usize>) -> Result<Numbers> {
        let wrong = |problem: String| {
            malformed(self.place(array.node), format!("array \"{}\": {problem}", array.name))
        };
        let numbers = self.decoded(array, n).map_err(wrong)?;
        let found = numbers.len();
        match n {
            Some(n) if n != found => Err(wrong(format!("{found} numbers instead of {n}"))),
            _ => Ok(numbers),
        }
    }

    fn decoded(&self, array: &Array<'a, 'input>, n: Option<usize>) -> Result<Numbers, String> {
        let most = n.map_or(usize::MAX, |n| n.saturating_mul(size(array.numeric_type).unwrap_or(8)));
        let text = || array.node.text().unwrap_or_default();
        let bytes = match array.node.attribute("format") {
            Some("ascii") => return from_text(array.numeric_type, text()),
            Some("binary") => payload(self.encoding, &from_base64(text().as_bytes())?, most)?,
            Some("appended") => self.appended(array.node, most)?,
            other => return Err(format!("format {other:?} is not ascii, binary or appended")),
        };
        match n {
            Some(n) if array.numeric_type == "Bit" => from_bits(&bytes, n),
            _ => from_bytes(array.numeric_type, self.encoding, &bytes),
        }
    }

    fn appended(&self, node: Node<'_, '_>, most: usize) -> Result<Vec<u8>, String> {
        let offset = node.attribute("offset").and_then(|offset| offset.trim().parse::<usize>().ok());
        let bytes = offset.and_then(|offset| self.parts.appended.get(offset..));
        let bytes = bytes.ok_or("its offset lies beyond the appended data")?;
        if self.parts.appended_is_raw {
            return payload(self.encoding, bytes, most);
        }
        let next =
            self.document.descendants().filter_map(|node| node.attribute("offset")?.trim().parse().ok());
        let next = next.filter(|&next: &usize| Some(next) > offset).min();
        let length = next.unwrap_or(usize::MAX) - offset.unwrap_or_default();
        let end = bytes.iter().position(|&byte| byte == b'<').unwrap_or(bytes.len());
        payload(self.encoding, &from_base64(&bytes[..length.min(end)])?, most)
    }

    pub(super) fn place(&self, node: Node<'_, '_>) -> Place {
        place(self.file, self.document, node)
    }
}

pub(super) fn no_cells(file: &Path) -> MeshError {
    MeshError::NoCells { file: file.to_path_buf(), advice: "save the volume, not only its surface" }
}

fn place(file: &Path, document: &Document<'_>, node: Node<'_, '_>) -> Place {
    Place::line(file, document.text_pos_at(node.range().start).row as usize)
}

/// Elements of a piece, and those of each of them.
const SECTIONS: [&str; 5] = ["PointData", "CellData", "Points", "Cells", "FieldData"];
const ARRAYS: [&str; 2] = ["DataArray", "Array"];

fn elements<'a, 'input>(node: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(Node::is_element)
}

/// The name of an element must be known; otherwise a misspelt one would be left out.
fn check_name(node: Node<'_, '_>, known: &[&str], at: impl Fn(Node<'_, '_>) -> Place) -> Result<()> {
    let name = node.tag_name().name();
    if known.contains(&name) {
        return Ok(());
    }
    let near = did_you_mean(name, known.iter().copied());
    let near = near.unwrap_or_else(|| format!("there is {}", known.join(", ")));
    Err(MeshError::Malformed {
        place: at(node),
        problem: format!("the element <{}> is not known ({near})", message::name(name)),
        advice: "correct its name, or remove it",
    })
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// Encoding of binary arrays, from the root element.
fn encoding(root: Node<'_, '_>, place: Place) -> Result<Encoding> {
    let compressed = match root.attribute("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => {
            return Err(MeshError::Malformed {
                place,
                problem: format!("compressed by {other}"),
                advice: "save it compressed by ZLib, or not at all",
            });
        }
    };
    let header = if root.attribute("header_type") == Some("UInt64") { 8 } else { 4 };
    Ok(Encoding { big_endian: root.attribute("byte_order") == Some("BigEndian"), header, compressed })
}
