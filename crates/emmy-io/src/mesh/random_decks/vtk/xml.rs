//! XML: text, base64 and raw data, in place or appended, compressed or not.

use std::io::Write;

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{Compression, write::ZlibEncoder};

use super::{Array, Choices, Drawn, Values};

/// How the numbers of a file are written.
struct Form {
    is_big: bool,
    is_long: bool,
    is_compressed: bool,
    appended_is_raw: bool,
}

/// Bytes of numbers of a type.
pub(super) fn bytes(kind: &str, numbers: &[f64], is_big: bool) -> Vec<u8> {
    let of = |x: &f64| {
        let mut bytes = match kind {
            "Int8" => (*x as i8).to_le_bytes().to_vec(),
            "UInt8" => (*x as u8).to_le_bytes().to_vec(),
            "Int16" => (*x as i16).to_le_bytes().to_vec(),
            "Int32" => (*x as i32).to_le_bytes().to_vec(),
            "Int64" => (*x as i64).to_le_bytes().to_vec(),
            "Float32" => (*x as f32).to_le_bytes().to_vec(),
            _ => x.to_le_bytes().to_vec(),
        };
        if is_big {
            bytes.reverse();
        }
        bytes
    };
    numbers.iter().flat_map(of).collect()
}

/// Type, components and numbers of an array; text has no numbers.
pub(super) fn numbers(values: &Values) -> (&'static str, usize, Vec<f64>) {
    match values {
        Values::Whole(kind, numbers) => (kind, 1, numbers.iter().map(|&x| x as f64).collect()),
        Values::Real(kind, numbers) => (kind, 1, numbers.clone()),
        Values::Vectors(numbers) => ("Float32", 3, numbers.clone()),
        Values::Text(_) => ("String", 1, Vec::new()),
    }
}

impl Form {
    fn header(&self, numbers: &[usize]) -> Vec<u8> {
        let numbers: Vec<f64> = numbers.iter().map(|&n| n as f64).collect();
        bytes(if self.is_long { "Int64" } else { "Int32" }, &numbers, self.is_big)
    }

    /// The header of an array, and its data.
    fn packed(&self, choices: &mut Choices, data: &[u8]) -> [Vec<u8>; 2] {
        if !self.is_compressed {
            return [self.header(&[data.len()]), data.to_vec()];
        }
        let size = choices.one(&[32768, 64, 24]);
        let mut compressed = Vec::new();
        let mut sizes = vec![data.len().div_ceil(size), size, data.len() % size];
        for block in data.chunks(size) {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(block).unwrap();
            let block = encoder.finish().unwrap();
            sizes.push(block.len());
            compressed.extend(block);
        }
        [self.header(&sizes), compressed]
    }

    fn array(&self, choices: &mut Choices, name: &str, values: &Values, appended: &mut Vec<u8>) -> String {
        let (kind, n, numbers) = numbers(values);
        let mut head = format!("<DataArray type=\"{kind}\" Name=\"{name}\"");
        if n > 1 || choices.below(2) == 0 {
            head += &format!(" NumberOfComponents=\"{n}\"");
        }
        let data = bytes(kind, &numbers, self.is_big);
        match choices.below(3) {
            _ if kind == "String" => format!("{head} format=\"ascii\">97 98 0 97 0</DataArray>\n"),
            0 => {
                let words: Vec<String> = numbers.iter().map(|x| x.to_string()).collect();
                format!(
                    "{head} format=\"ascii\">\n{}\n</DataArray>\n",
                    words.join(choices.one(&[" ", "\n", "  "]))
                )
            }
            1 => {
                let [header, data] = self.packed(choices, &data).map(|part| STANDARD.encode(part));
                format!("{head} format=\"binary\">\n  {header}{data}\n</DataArray>\n")
            }
            _ => {
                head += &format!(" format=\"appended\" offset=\"{}\"/>\n", appended.len());
                for part in self.packed(choices, &data) {
                    match self.appended_is_raw {
                        true => appended.extend(part),
                        false => appended.extend(STANDARD.encode(part).into_bytes()),
                    }
                }
                head
            }
        }
    }
}

/// The bytes of a file.
pub(super) fn written(choices: &mut Choices, drawn: &Drawn) -> Vec<u8> {
    let [is_big, is_long, is_compressed, appended_is_raw] = [0; 4].map(|_| choices.below(2) == 0);
    let form = Form { is_big, is_long, is_compressed, appended_is_raw };
    let mut appended = Vec::new();
    let grid = &drawn.grid;
    let whole = |numbers: &[i64]| Values::Whole("Int64", numbers.to_vec());
    let points = Values::Vectors(grid.points.concat());
    let types = Values::Whole("UInt8", grid.types.clone());
    let mut section = |name: &str, arrays: &[(&str, &Values)], choices: &mut Choices| {
        let arrays = arrays.iter().map(|(name, values)| form.array(choices, name, values, &mut appended));
        format!("<{name}>\n{}</{name}>\n", arrays.collect::<String>())
    };
    let of = |arrays: &'_ [Array]| {
        arrays.iter().map(|own| (own.name.clone(), own.values.clone())).collect::<Vec<_>>()
    };
    let (on_points, on_cells) = (of(&drawn.on_points), of(&drawn.on_cells));
    fn lent(arrays: &[(String, Values)]) -> Vec<(&str, &Values)> {
        arrays.iter().map(|(name, values)| (name.as_str(), values)).collect()
    }
    let (ends, nodes) = (whole(&grid.ends), whole(&grid.connectivity));
    let mut cells = vec![("connectivity", &nodes), ("offsets", &ends), ("types", &types)];
    choices.shuffle(&mut cells);
    let mut sections = vec![
        section("Points", &[("Points", &points)], choices),
        section("Cells", &cells, choices),
        section("PointData", &lent(&on_points), choices),
        section("CellData", &lent(&on_cells), choices),
    ];
    choices.shuffle(&mut sections);
    let order = if is_big { "BigEndian" } else { "LittleEndian" };
    let header = if is_long { " header_type=\"UInt64\"" } else { "" };
    let compressor = if is_compressed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{order}\"{header}{compressor}>\n\
         <UnstructuredGrid>\n<!-- a comment -->\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n{}</Piece>\n\
         </UnstructuredGrid>\n",
        grid.points.len(),
        grid.types.len(),
        sections.concat()
    )
    .into_bytes();
    let encoding = if appended_is_raw { "raw" } else { "base64" };
    if !appended.is_empty() {
        text.extend(format!("<AppendedData encoding=\"{encoding}\">\n_").into_bytes());
        text.extend(appended);
        text.extend(b"\n</AppendedData>\n");
    }
    text.extend(b"</VTKFile>\n");
    text
}
