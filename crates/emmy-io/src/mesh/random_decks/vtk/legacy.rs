//! Legacy files: text or binary, cells of versions before and after 5.

use super::xml::{bytes, numbers};
use super::{Array, Choices, Drawn, Values};

struct File {
    all: Vec<u8>,
    is_binary: bool,
}

/// Types of legacy files.
fn kind_of(kind: &str) -> &'static str {
    match kind {
        "Int8" => "signed_char",
        "Int16" => "short",
        "Int32" => "int",
        "Int64" => "vtktypeint64",
        "Float32" => "float",
        _ => "double",
    }
}

impl File {
    fn line(&mut self, text: &str) {
        self.all.extend(format!("{text}\n").into_bytes());
    }

    fn numbers(&mut self, kind: &str, numbers: &[f64]) {
        if self.is_binary {
            self.all.extend(bytes(kind, numbers, true));
            self.line("");
        } else {
            let words: Vec<String> = numbers.iter().map(|x| x.to_string()).collect();
            words.chunks(9).for_each(|line| self.line(&line.join(" ")));
        }
    }

    fn whole(&mut self, kind: &str, numbers: &[i64]) {
        self.numbers(kind, &numbers.iter().map(|&x| x as f64).collect::<Vec<f64>>());
    }

    /// An array of its own, or one in a field.
    fn array(&mut self, choices: &mut Choices, array: &Array, n: usize) {
        let name = array.name.replace(' ', "%20");
        let (kind, components, own) = numbers(&array.values);
        let is_field = matches!(array.values, Values::Text(_)) || choices.below(2) == 0;
        if is_field {
            self.line(&format!(
                "FIELD FieldData 1\n{name} {components} {n} {}",
                if kind == "String" { "string" } else { kind_of(kind) }
            ));
        } else if components == 3 {
            self.line(&format!("VECTORS {name} {}", kind_of(kind)));
        } else {
            let one = choices.one(&["", " 1"]);
            self.line(&format!("SCALARS {name} {}{one}\nLOOKUP_TABLE default", kind_of(kind)));
        }
        match array.values {
            // Each text has its length before it.
            Values::Text(n) if self.is_binary => {
                (0..n).for_each(|_| self.all.extend(b"\xc2ab"));
                self.line("");
            }
            Values::Text(n) => (0..n).for_each(|_| self.line("a%20b")),
            _ => self.numbers(kind, &own),
        }
        if choices.once_in(4) {
            self.line("METADATA\nINFORMATION 0\n");
        }
    }
}

/// The bytes of a file.
pub(super) fn written(choices: &mut Choices, drawn: &Drawn) -> Vec<u8> {
    let is_binary = choices.below(2) == 0;
    let version = choices.one(&["2.0", "3.0", "4.2", "5.1"]);
    let grid = &drawn.grid;
    let mut file = File { all: Vec::new(), is_binary };
    let form = if is_binary { "BINARY" } else { "ASCII" };
    file.line(&format!("# vtk DataFile Version {version}\na title\n{form}\nDATASET UNSTRUCTURED_GRID"));
    file.line(&format!("POINTS {} double", grid.points.len()));
    file.numbers("Float64", &grid.points.concat());
    let n = grid.types.len();
    if version == "5.1" {
        file.line(&format!("CELLS {} {}\nOFFSETS vtktypeint64", n + 1, grid.connectivity.len()));
        file.whole("Int64", &[&[0], &grid.ends[..]].concat());
        file.line("CONNECTIVITY vtktypeint64");
        file.whole("Int64", &grid.connectivity);
    } else {
        let cells =
            drawn.nodes.iter().flat_map(|nodes| std::iter::once(nodes.len()).chain(nodes.iter().copied()));
        let cells: Vec<i64> = cells.map(|x| x as i64).collect();
        file.line(&format!("CELLS {n} {}", cells.len()));
        file.whole("Int32", &cells);
    }
    file.line(&format!("CELL_TYPES {n}"));
    file.whole("Int32", &grid.types);
    let mut parts = [("POINT_DATA", &drawn.on_points, grid.points.len()), ("CELL_DATA", &drawn.on_cells, n)];
    choices.shuffle(&mut parts);
    for (name, arrays, n) in parts {
        file.line(&format!("{name} {n}"));
        arrays.iter().for_each(|array| file.array(choices, array, n));
    }
    file.all
}
