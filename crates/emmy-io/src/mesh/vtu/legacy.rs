//! Legacy files of VTK (`.vtk`), versions 1 to 5.1, ASCII or binary (VTK File Formats, "Simple Legacy Formats").

use std::path::Path;

use super::super::error::Position;
use super::array::{Encoding, from_bits, from_bytes, from_text, size};
use super::cell::{PIXEL, VOXEL, renumber_old_hexahedra};
use super::{Grid, GridArray, MeshError, Numbers, Place, Result};

/// Numbers in binary files: the largest byte first.
const BINARY: Encoding = Encoding { big_endian: true, header: 4, compressed: false };

/// The grid in the bytes of a file.
pub(super) fn grid(file: &Path, bytes: &[u8]) -> Result<Grid> {
    let mut reader = Reader { file, bytes, at: 0, begin: 0, is_binary: false };
    reader.grid().map_err(|problem| MeshError::Malformed {
        place: reader.place(),
        problem,
        advice: "the file is damaged or cut off; write it again, or save it as VTK UnstructuredGrid file (.vtu)",
    })
}

type Outcome<T> = std::result::Result<T, String>;

struct Reader<'a> {
    file: &'a Path,
    bytes: &'a [u8],
    at: usize,
    /// Beginning of the present line or array.
    begin: usize,
    is_binary: bool,
}

/// Data set before its arrays.
#[derive(Default)]
struct Geometry {
    points: Vec<[f64; 3]>,
    dimensions: Option<[usize; 3]>,
    origin: [f64; 3],
    spacing: [f64; 3],
    axes: [Vec<f64>; 3],
    /// Number of nodes and nodes of each cell, of files before version 5.
    cells: Option<Vec<i64>>,
    ends: Vec<i64>,
    connectivity: Vec<i64>,
    types: Vec<i64>,
}

/// The part of a file that arrays belong to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Whole,
    Points(usize),
    Cells(usize),
}

impl Reader<'_> {
    fn place(&self) -> Place {
        let line = 1 + self.bytes[..self.begin].iter().filter(|&&byte| byte == b'\n').count();
        let position = if self.is_binary { Position::Byte(self.begin) } else { Position::Line(line) };
        Place { file: self.file.to_path_buf(), position }
    }

    /// The next line, which may be empty.
    fn raw_line(&mut self) -> Option<String> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.begin = self.at;
        self.at += (end + 1).min(rest.len());
        Some(String::from_utf8_lossy(&rest[..end]).trim().to_string())
    }

    /// The words of the next line that is not empty.
    fn words(&mut self) -> Option<Vec<String>> {
        loop {
            let line = self.raw_line()?;
            if !line.is_empty() {
                return Some(line.split_ascii_whitespace().map(str::to_string).collect());
            }
        }
    }

    /// The words of the next line that is not empty, which is not taken unless it begins with a word.
    fn words_if(&mut self, first: &str) -> Option<Vec<String>> {
        let before = (self.at, self.begin);
        let words = self.words().filter(|words| words[0].eq_ignore_ascii_case(first));
        if words.is_none() {
            (self.at, self.begin) = before;
        }
        words
    }

    /// `n` numbers of a type.
    fn numbers(&mut self, kind: &str, n: usize) -> Outcome<Numbers> {
        let kind = kind.to_ascii_lowercase();
        let numeric_type =
            numeric_type(&kind).ok_or_else(|| format!("numbers of type {kind} are not read"))?;
        self.begin = self.at;
        let rest = &self.bytes[self.at..];
        let cut_off =
            || format!("{n} numbers are announced, but the rest of the file has only {} bytes", rest.len());
        if self.is_binary {
            let is_bits = numeric_type == "Bit";
            let n_bytes =
                if is_bits { Some(n.div_ceil(8)) } else { size(numeric_type).unwrap_or(8).checked_mul(n) };
            let bytes = n_bytes.and_then(|n_bytes| rest.get(..n_bytes)).ok_or_else(cut_off)?;
            self.at += bytes.len();
            return if is_bits { from_bits(bytes, n) } else { from_bytes(numeric_type, BINARY, bytes) };
        }
        let text = self.ascii(n).ok_or_else(cut_off)?;
        from_text(numeric_type, &text)
    }

    /// The text of `n` words.
    fn ascii(&mut self, n: usize) -> Option<String> {
        let rest = &self.bytes[self.at..];
        if n > rest.len() {
            return None;
        }
        let (mut end, mut found) = (0, 0);
        while found < n {
            let start = end + rest[end..].iter().position(|byte| !byte.is_ascii_whitespace())?;
            end =
                start + rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
            found += 1;
        }
        self.at += end;
        Some(String::from_utf8_lossy(&rest[..end]).into_owned())
    }

    fn whole(&mut self, kind: &str, n: usize) -> Outcome<Vec<i64>> {
        match self.numbers(kind, n)? {
            Numbers::Whole(numbers) => Ok(numbers),
            Numbers::Real(_) => Err(format!("numbers of type {kind} where whole ones are needed")),
        }
    }

    fn grid(&mut self) -> Outcome<Grid> {
        let header = self.raw_line().unwrap_or_default();
        let version = header.strip_prefix("# vtk DataFile Version").map(str::trim);
        let version = version.ok_or("the first line is not `# vtk DataFile Version x.y`")?;
        let major: u32 = version.split('.').next().and_then(|number| number.parse().ok()).unwrap_or(0);
        self.raw_line();
        self.is_binary = match self.words().and_then(|words| words.into_iter().next()) {
            Some(word) if word.eq_ignore_ascii_case("ASCII") => false,
            Some(word) if word.eq_ignore_ascii_case("BINARY") => true,
            _ => return Err("expected ASCII or BINARY in the third line".to_string()),
        };
        let data = self.words_if("DATASET").and_then(|words| words.get(1).cloned()).unwrap_or_default();
        let data = data.to_ascii_uppercase();
        const KNOWN: [&str; 4] =
            ["UNSTRUCTURED_GRID", "STRUCTURED_POINTS", "RECTILINEAR_GRID", "STRUCTURED_GRID"];
        if !KNOWN.contains(&&*data) {
            return Err(format!("DATASET {data} is not read, only {}", KNOWN.join(", ")));
        }
        let mut geometry = Geometry { spacing: [1.0; 3], ..Geometry::default() };
        let (mut point_arrays, mut cell_arrays) = (Vec::new(), Vec::new());
        let mut section = Section::Whole;
        while let Some(words) = self.words() {
            let keyword = words[0].to_ascii_uppercase();
            match &*keyword {
                "POINT_DATA" => section = Section::Points(number(&words, 1)?),
                "CELL_DATA" => section = Section::Cells(number(&words, 1)?),
                "METADATA" => while self.raw_line().is_some_and(|line| !line.is_empty()) {},
                _ if self.geometry(&mut geometry, &keyword, &words)? => {}
                _ => {
                    let arrays = self.arrays(&keyword, &words, section)?;
                    match section {
                        Section::Whole => {}
                        Section::Points(_) => point_arrays.extend(arrays),
                        Section::Cells(_) => cell_arrays.extend(arrays),
                    }
                }
            }
        }
        let mut grid = geometry.grid(&data)?;
        (grid.point_arrays, grid.cell_arrays) = (point_arrays, cell_arrays);
        if major < 5 {
            renumber_old_hexahedra(&grid.types, &grid.ends, &mut grid.connectivity);
        }
        Ok(grid)
    }

    /// Reads a part of the geometry; `false`: the keyword is none of it.
    fn geometry(&mut self, geometry: &mut Geometry, keyword: &str, words: &[String]) -> Outcome<bool> {
        match keyword {
            "POINTS" => {
                let n: usize = number(words, 1)?;
                let numbers = self.numbers(word(words, 2)?, n.saturating_mul(3))?.into_reals();
                geometry.points = numbers.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
            }
            "CELLS" => {
                let (n, size) = (number(words, 1)?, number(words, 2)?);
                if let Some(offsets) = self.words_if("OFFSETS") {
                    geometry.ends = self.whole(word(&offsets, 1)?, n)?.split_off(1.min(n));
                    let kind = self.words_if("CONNECTIVITY").ok_or("CELLS without CONNECTIVITY")?;
                    geometry.connectivity = self.whole(word(&kind, 1)?, size)?;
                } else {
                    geometry.cells = Some(self.whole("int", size)?);
                }
            }
            "CELL_TYPES" => geometry.types = self.whole("int", number(words, 1)?)?,
            "DIMENSIONS" => {
                geometry.dimensions = Some([number(words, 1)?, number(words, 2)?, number(words, 3)?]);
            }
            "ORIGIN" => geometry.origin = [number(words, 1)?, number(words, 2)?, number(words, 3)?],
            "SPACING" | "ASPECT_RATIO" => {
                geometry.spacing = [number(words, 1)?, number(words, 2)?, number(words, 3)?];
            }
            "X_COORDINATES" | "Y_COORDINATES" | "Z_COORDINATES" => {
                let axis = usize::from(keyword.as_bytes()[0] - b'X');
                geometry.axes[axis] = self.numbers(word(words, 2)?, number(words, 1)?)?.into_reals();
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Arrays of a keyword.
    fn arrays(&mut self, keyword: &str, words: &[String], section: Section) -> Outcome<Vec<GridArray>> {
        let n = match section {
            Section::Whole => 0,
            Section::Points(n) | Section::Cells(n) => n,
        };
        let (name, kind, components) = match keyword {
            "FIELD" => {
                let n_arrays: usize = number(words, 2)?;
                let mut arrays = Vec::new();
                for _ in 0..n_arrays {
                    if self.words_if("METADATA").is_some() {
                        while self.raw_line().is_some_and(|line| !line.is_empty()) {}
                    }
                    let head = self.words().ok_or("the file ends inside of a FIELD")?;
                    let [components, tuples] = [number(&head, 1)?, number(&head, 2)?];
                    arrays.push(self.array(word(&head, 0)?, word(&head, 3)?, components, tuples)?);
                }
                return Ok(arrays);
            }
            "LOOKUP_TABLE" => {
                let kind = if self.is_binary { "unsigned_char" } else { "float" };
                self.numbers(kind, number::<usize>(words, 2)?.saturating_mul(4))?;
                return Ok(Vec::new());
            }
            "COLOR_SCALARS" => return Ok(vec![self.colors(word(words, 1)?, number(words, 2)?, n)?]),
            "SCALARS" => {
                let components = words.get(3).map_or(Ok(1), |_| number(words, 3))?;
                self.words_if("LOOKUP_TABLE");
                (word(words, 1)?, word(words, 2)?, components)
            }
            "VECTORS" | "NORMALS" => (word(words, 1)?, word(words, 2)?, 3),
            "TENSORS" => (word(words, 1)?, word(words, 2)?, 9),
            "TENSORS6" => (word(words, 1)?, word(words, 2)?, 6),
            "TEXTURE_COORDINATES" => (word(words, 1)?, word(words, 3)?, number(words, 2)?),
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => (word(words, 1)?, word(words, 2)?, 1),
            _ => return Err(format!("the keyword {} is not known", words[0])),
        };
        Ok(vec![self.array(name, kind, components, n)?])
    }

    /// An array of bytes, which VTK writes as text divided by 255.
    fn colors(&mut self, name: &str, components: usize, tuples: usize) -> Outcome<GridArray> {
        if self.is_binary {
            return self.array(name, "unsigned_char", components, tuples);
        }
        let mut array = self.array(name, "float", components, tuples)?;
        let whole = |numbers: Numbers| {
            Numbers::Whole(numbers.into_reals().into_iter().map(|x| (255.0 * x).round() as i64).collect())
        };
        array.numbers = array.numbers.map(whole);
        Ok(array)
    }

    /// An array of a number of tuples.
    fn array(&mut self, name: &str, kind: &str, components: usize, tuples: usize) -> Outcome<GridArray> {
        let n = components.saturating_mul(tuples);
        let name = decoded(name);
        match &*kind.to_ascii_lowercase() {
            "string" | "utf8_string" if self.is_binary => (0..n).try_for_each(|_| self.skip_text())?,
            // One on each line, percent-encoded.
            "string" | "utf8_string" => {
                (0..n).try_for_each(|_| self.raw_line().map(drop).ok_or("the file ends inside of texts"))?;
            }
            kind => {
                let numbers = self.numbers(kind, n)?;
                return Ok(GridArray { name, numbers: (components == 1).then_some(numbers) });
            }
        }
        Ok(GridArray { name, numbers: None })
    }

    /// Passes a text with its length, whose bytes the first two bits count.
    fn skip_text(&mut self) -> Outcome<()> {
        let cut_off = "the file ends inside of texts";
        let first = *self.bytes.get(self.at).ok_or(cut_off)?;
        let n_bytes = [8, 4, 2, 1][usize::from(first >> 6)];
        let head = self.bytes.get(self.at..self.at + n_bytes).ok_or(cut_off)?;
        let length = head.iter().enumerate().fold(0_usize, |length, (i, &byte)| {
            (length << 8) | usize::from(if i == 0 { byte & 0x3f } else { byte })
        });
        let end = (self.at + n_bytes).checked_add(length).filter(|&end| end <= self.bytes.len());
        self.at = end.ok_or(cut_off)?;
        Ok(())
    }
}

impl Geometry {
    fn grid(self, data: &str) -> Outcome<Grid> {
        if data != "UNSTRUCTURED_GRID" {
            return self.regular(data);
        }
        let (mut ends, mut connectivity) = (self.ends, self.connectivity);
        if let Some(cells) = self.cells {
            let mut rest = &cells[..];
            while let Some((&n, after)) = rest.split_first() {
                let nodes = usize::try_from(n).ok().and_then(|n| after.split_at_checked(n));
                let (nodes, after) =
                    nodes.ok_or_else(|| format!("cell {} has {n} nodes in CELLS", ends.len()))?;
                connectivity.extend_from_slice(nodes);
                ends.push(connectivity.len() as i64);
                rest = after;
            }
        }
        if ends.len() != self.types.len() {
            return Err(format!("{} cells in CELLS and {} in CELL_TYPES", ends.len(), self.types.len()));
        }
        Ok(Grid { points: self.points, types: self.types, ends, connectivity, ..Grid::default() })
    }

    /// A grid of rows, columns and layers.
    fn regular(self, data: &str) -> Outcome<Grid> {
        /// Largest number of points.
        const MOST: usize = 100_000_000;
        let n = self.dimensions.ok_or("no DIMENSIONS")?;
        let n_points = n.iter().try_fold(1_usize, |all, &n| all.checked_mul(n)).filter(|&n| n <= MOST);
        let n_points = n_points.ok_or_else(|| format!("more points than the {MOST} that are read"))?;
        if data == "RECTILINEAR_GRID" && (0..3).any(|axis| self.axes[axis].len() != n[axis]) {
            return Err("other numbers of coordinates than DIMENSIONS".to_string());
        }
        if data == "STRUCTURED_GRID" && self.points.len() != n_points {
            return Err(format!("{} points instead of the {n_points} of DIMENSIONS", self.points.len()));
        }
        let is_bent = data == "STRUCTURED_GRID";
        let mut grid = Grid { points: self.points, ..Grid::default() };
        if !is_bent {
            let place = |axis: usize, i: usize| match data {
                "RECTILINEAR_GRID" => self.axes[axis][i],
                _ => self.origin[axis] + i as f64 * self.spacing[axis],
            };
            for k in 0..n[2] {
                for j in 0..n[1] {
                    grid.points.extend((0..n[0]).map(|i| [place(0, i), place(1, j), place(2, k)]));
                }
            }
        }
        let steps = [1, n[0], n[0] * n[1]];
        let wide: Vec<usize> = (0..3).filter(|&axis| n[axis] > 1).collect();
        let mut corners = vec![0];
        for &axis in &wide {
            let next: Vec<usize> = corners.iter().map(|corner| corner + steps[axis]).collect();
            corners.extend(next);
        }
        let id = match (wide.len(), is_bent) {
            (3, true) => 12,
            (3, false) => VOXEL,
            (2, true) => 9,
            (2, false) => PIXEL,
            (1, _) => 3,
            _ => 1,
        };
        if is_bent && wide.len() > 1 {
            // The corners of a hexahedron go round.
            corners.chunks_exact_mut(4).for_each(|face| face.swap(2, 3));
        }
        let cells = n.map(|n| n.saturating_sub(1).max(1));
        for k in 0..cells[2] {
            for j in 0..cells[1] {
                for i in 0..cells[0] {
                    let first = i * steps[0] + j * steps[1] + k * steps[2];
                    grid.connectivity.extend(corners.iter().map(|corner| (first + corner) as i64));
                    grid.ends.push(grid.connectivity.len() as i64);
                    grid.types.push(id);
                }
            }
        }
        Ok(grid)
    }
}

/// Type of XML files for a type; identifiers are written with 32 bits.
fn numeric_type(kind: &str) -> Option<&'static str> {
    Some(match kind {
        "bit" => "Bit",
        "char" | "signed_char" | "vtktypeint8" => "Int8",
        "unsigned_char" | "vtktypeuint8" => "UInt8",
        "short" | "vtktypeint16" => "Int16",
        "unsigned_short" | "vtktypeuint16" => "UInt16",
        "int" | "vtkidtype" | "vtktypeint32" => "Int32",
        "unsigned_int" | "vtktypeuint32" => "UInt32",
        "long" | "long_long" | "vtktypeint64" => "Int64",
        "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => "UInt64",
        "float" => "Float32",
        "double" => "Float64",
        _ => return None,
    })
}

fn word(words: &[String], index: usize) -> Outcome<&str> {
    words.get(index).map(String::as_str).ok_or_else(|| format!("{} lacks its word {index}", words[0]))
}

fn number<T: std::str::FromStr>(words: &[String], index: usize) -> Outcome<T> {
    let word = word(words, index)?;
    word.parse().map_err(|_| format!("expected a number in {}, found \"{word}\"", words[0]))
}

/// A name with its percent-encoded characters.
fn decoded(name: &str) -> String {
    let mut bytes = Vec::with_capacity(name.len());
    let mut rest = name.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()).filter(|_| first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
