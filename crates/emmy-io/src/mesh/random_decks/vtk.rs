//! Grids of VTK in memory, in XML and in legacy files, with arrays of all kinds in all encodings.

mod legacy;
mod xml;

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::super::account::Treatment;
use super::super::vtu::TABLE;
use super::super::{Grid, GridArray, Numbers, from_grid, parse};
use super::{Block, Choices, Contents, Wanted, What, choices, config, names};
use emmy::mesh::CellKind;

/// Values of an array: with their type in XML, three numbers each, or text.
#[derive(Debug, Clone)]
enum Values {
    Whole(&'static str, Vec<i64>),
    Real(&'static str, Vec<f64>),
    Vectors(Vec<f64>),
    Text(usize),
}

#[derive(Debug, Clone)]
struct Array {
    name: String,
    values: Values,
}

impl Array {
    fn in_memory(&self) -> GridArray {
        let numbers = match &self.values {
            Values::Whole(_, numbers) => Some(Numbers::Whole(numbers.clone())),
            Values::Real(_, numbers) => Some(Numbers::Real(numbers.clone())),
            Values::Vectors(_) | Values::Text(_) => None,
        };
        GridArray { name: self.name.clone(), numbers }
    }
}

/// The role of a grid cell in the body.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    Cell,
    Facet,
    Nodes,
    LeftOut,
}

/// A grid, with its points in the block.
struct Drawn {
    grid: Grid,
    parts: Vec<Part>,
    nodes: Vec<Vec<usize>>,
    on_points: Vec<Array>,
    on_cells: Vec<Array>,
}

fn cells(choices: &mut Choices, block: &Block, wanted: &mut Wanted) -> Drawn {
    let mut all: Vec<(i64, Part, Vec<usize>)> = Vec::new();
    for (kind, nodes) in &block.cells {
        let mut nodes = nodes.clone();
        let id = match (kind, choices.below(3)) {
            (CellKind::Hex8, 0) => 12,
            (CellKind::Hex8, 1) => 72,
            (CellKind::Hex8, _) => {
                nodes.swap(2, 3);
                nodes.swap(6, 7);
                11
            }
            (_, 0) => 73,
            _ => 13,
        };
        all.push((id, Part::Cell, nodes));
    }
    for (_, nodes) in &block.skin {
        if !choices.once_in(3) {
            continue;
        }
        all.push((choices.one(&[9, 7]), Part::Facet, nodes.to_vec()));
    }
    // Surfaces and lines besides faces.
    let first = &block.cells[0].1;
    let nodes = |locals: &[usize]| locals.iter().map(|&local| first[local]).collect::<Vec<usize>>();
    let is_hexahedron = first.len() == 8;
    let oblique = if is_hexahedron { [0, 1, 6, 7] } else { [0, 1, 5, 3] };
    for _ in 0..choices.below(4) {
        let (id, part, nodes, name) = match choices.below(6) {
            0 => (9, Part::LeftOut, nodes(&oblique), "VTK type 9 (quadrilateral)"),
            1 => (7, Part::LeftOut, nodes(&[0, 1, 2, 3, 5]), "VTK type 7 (polygon)"),
            2 => (3, Part::Nodes, nodes(&[0, 1]), ""),
            3 => (4, Part::Nodes, nodes(if is_hexahedron { &[0, 1, 5] } else { &[0, 1, 4] }), ""),
            // A diagonal of a face.
            4 => {
                (3, Part::LeftOut, nodes(if is_hexahedron { &[0, 5] } else { &[0, 4] }), "VTK type 3 (line)")
            }
            _ => (1, Part::Nodes, nodes(&[2]), ""),
        };
        if part == Part::LeftOut {
            wanted.leave_out(name);
        }
        all.push((id, part, nodes));
    }
    choices.shuffle(&mut all);
    let mut grid =
        Grid { points: block.points.iter().map(|point| point.map(f64::from)).collect(), ..Grid::default() };
    let (mut parts, mut of_cells) = (Vec::new(), Vec::new());
    for (id, part, nodes) in all {
        grid.types.push(id);
        grid.connectivity.extend(nodes.iter().map(|&node| node as i64));
        grid.ends.push(grid.connectivity.len() as i64);
        parts.push(part);
        of_cells.push(nodes);
    }
    Drawn { grid, parts, nodes: of_cells, on_points: Vec::new(), on_cells: Vec::new() }
}

/// The expected use of an array.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Use {
    /// Groups of its values.
    Values,
    /// The same, but 0 is none on what is no cell of the body.
    Tags,
    /// A group of what is not 0.
    Group,
    Nothing,
    LeftOut,
}

/// An array for `n` cells or points.
fn array(choices: &mut Choices, name: &str, n: usize) -> (Array, Use) {
    const WHOLE: [&str; 4] = ["Int8", "Int16", "Int32", "Int64"];
    const REAL: [&str; 2] = ["Float32", "Float64"];
    let mut name = name.to_string();
    let few: Vec<i64> = (0..n).map(|_| choices.below(6) as i64 - 3).collect();
    let reals = |numbers: &[i64], rest: f64| numbers.iter().map(|&x| x as f64 + rest).collect::<Vec<f64>>();
    let (values, own) = match choices.below(9) {
        0 => (Values::Whole(choices.one(&WHOLE), few), Use::Values),
        1 => {
            let mut numbers = reals(&few, 0.0);
            // No value, but not everywhere.
            numbers.iter_mut().skip(1).filter(|_| choices.once_in(5)).for_each(|x| *x = f64::NAN);
            (Values::Real(choices.one(&REAL), numbers), Use::Values)
        }
        2 => (Values::Whole(choices.one(&WHOLE[1..]), (0..n as i64).map(|i| i / 2).collect()), Use::Values),
        3 => (Values::Whole(choices.one(&WHOLE[1..]), (0..n as i64).collect()), Use::Values),
        4 => (Values::Real(choices.one(&REAL), reals(&few, 0.5)), Use::LeftOut),
        5 => (Values::Vectors(reals(&[&few[..], &few, &few].concat(), 0.25)), Use::LeftOut),
        6 => (Values::Text(n), Use::LeftOut),
        7 => {
            name = format!("group:{name}");
            (Values::Whole(choices.one(&WHOLE), few), Use::Group)
        }
        _ => {
            name = format!("{}{name}", choices.one(&["vtk", "VTK"]));
            (Values::Real(choices.one(&REAL), reals(&few, 0.5)), Use::Nothing)
        }
    };
    (Array { name, values }, own)
}

/// Adds arrays of all kinds, their groups and the notes on them.
fn add_arrays(
    choices: &mut Choices,
    block: &Block,
    drawn: &mut Drawn,
    contents: &mut Contents,
    wanted: &mut Wanted,
) {
    let mut left_out = Vec::new();
    let no_effect = names(TABLE, Treatment::NoEffect, "9");
    let n_points = block.points.len();
    for index in 0..choices.below(5) {
        let (array, own) = array(choices, &format!("p{index}"), n_points);
        let labels = labels(&array);
        match own {
            Use::Group => {
                let members = (0..n_points).filter(|&at| labels[at].is_some_and(|value| value != 0));
                contents.group(block, &array.name["group:".len()..], What::Nodes, members.map(|at| vec![at]));
            }
            // The numbers of the points.
            Use::Values if n_values(&labels) > 1 && n_values(&labels) == labels.iter().flatten().count() => {}
            Use::Values if n_values(&labels) <= 64 => {
                for (at, value) in labels.iter().enumerate().filter_map(|(at, value)| Some((at, (*value)?))) {
                    contents.group(block, &format!("{}={value}", array.name), What::Nodes, [vec![at]]);
                }
            }
            Use::Values | Use::LeftOut => left_out.push(format!("{} (points)", array.name)),
            Use::Nothing | Use::Tags => {}
        }
        drawn.on_points.push(array);
    }
    let n_cells = drawn.parts.len();
    let mut is_used = vec![false; n_cells];
    for index in 0..choices.below(5) {
        let (mut array, mut own) = array(choices, &format!("c{index}"), n_cells);
        if own == Use::Values && choices.once_in(4) {
            array.name = choices.one(&["cell_tags", "gmsh:physical", "medit:ref"]).to_string();
            own = Use::Tags;
        } else if own == Use::LeftOut && choices.once_in(4) {
            array.name = choices.one(&no_effect);
            own = Use::Nothing;
        }
        if drawn.on_cells.iter().any(|known| known.name == array.name) {
            continue;
        }
        let labels = labels(&array);
        let mut all: Vec<(String, usize)> = Vec::new();
        let mut is_left_out = own == Use::LeftOut;
        for of_body in [true, false] {
            let is_of = |at: &usize| (drawn.parts[*at] == Part::Cell) == of_body;
            let of: Vec<(usize, i64)> =
                (0..n_cells).filter(is_of).filter_map(|at| Some((at, (*labels.get(at)?)?))).collect();
            let n_values = n_values(&of.iter().map(|(_, value)| Some(*value)).collect::<Vec<_>>());
            let name = |value: i64| format!("{}={value}", array.name);
            match own {
                Use::Group => {
                    let name = &array.name["group:".len()..];
                    all.extend(
                        of.iter().filter(|(_, value)| *value != 0).map(|(at, _)| (name.to_string(), *at)),
                    );
                }
                Use::Tags => {
                    let has_tag = |(_, value): &&(usize, i64)| of_body || *value != 0;
                    all.extend(of.iter().filter(has_tag).map(|(at, value)| (name(*value), *at)));
                }
                Use::Values if n_values <= 64 => all.extend(of.iter().map(|(at, value)| (name(*value), *at))),
                // The numbers of the cells.
                Use::Values if n_values == of.len() => {}
                Use::Values => is_left_out = true,
                Use::Nothing | Use::LeftOut => {}
            }
        }
        if is_left_out {
            left_out.push(array.name.clone());
        }
        if own == Use::Group && all.is_empty() {
            contents.group(block, &array.name["group:".len()..], What::Cells, []);
        }
        for (name, at) in all {
            let what = match drawn.parts[at] {
                Part::Cell => What::Cells,
                Part::Facet => What::Facets,
                Part::Nodes | Part::LeftOut => What::Nodes,
            };
            contents.group(block, &name, what, [drawn.nodes[at].clone()]);
            is_used[at] = true;
        }
        drawn.on_cells.push(array);
    }
    if !left_out.is_empty() {
        let note = "arrays that are left out, because they have other values than up to 64 whole numbers: ";
        wanted.notes.insert(format!("{note}{}", left_out.join(", ")));
    }
    let is_unused = |at: &usize| matches!(drawn.parts[*at], Part::Facet | Part::Nodes) && !is_used[*at];
    match (0..n_cells).filter(is_unused).count() {
        0 => {}
        1 => _ = wanted.notes.insert("1 cell that is not solid is in no group and ignored".to_string()),
        n => _ = wanted.notes.insert(format!("{n} cells that are not solid are in no group and ignored")),
    }
}

fn labels(array: &Array) -> Vec<Option<i64>> {
    match &array.values {
        Values::Whole(_, numbers) => numbers.iter().copied().map(Some).collect(),
        Values::Real(_, numbers) => numbers.iter().map(|x| (!x.is_nan()).then_some(*x as i64)).collect(),
        Values::Vectors(_) | Values::Text(_) => Vec::new(),
    }
}

fn n_values(labels: &[Option<i64>]) -> usize {
    labels.iter().flatten().map(|&value| (value, ())).collect::<BTreeMap<i64, ()>>().len()
}

proptest! {
    #![proptest_config(config())]

    /// The same grid through the three doors.
    #[test]
    fn every_array_and_cell_is_accounted_for(mut choices in choices()) {
        let choices = &mut choices;
        let block = Block::new(choices);
        let (mut wanted, mut contents) = (Wanted::default(), block.contents());
        let mut drawn = cells(choices, &block, &mut wanted);
        add_arrays(choices, &block, &mut drawn, &mut contents, &mut wanted);
        let mut grid = drawn.grid.clone();
        grid.point_arrays = drawn.on_points.iter().map(Array::in_memory).collect();
        grid.cell_arrays = drawn.on_cells.iter().map(Array::in_memory).collect();
        let shown = format!("{grid:?}");
        let read = from_grid("the grid".as_ref(), grid, &[]).unwrap_or_else(|error| panic!("{error}\n{shown}"));
        wanted.check(&read, &block, &contents, &|| shown.clone());
        for (name, bytes) in [("a.vtu", xml::written(choices, &drawn)), ("a.vtk", legacy::written(choices, &drawn))] {
            let text = || String::from_utf8_lossy(&bytes).into_owned();
            let read = parse(name.as_ref(), &bytes).unwrap_or_else(|error| panic!("{error}\n{}", text()));
            wanted.check(&read, &block, &contents, &text);
        }
    }
}
