//! Random decks: a block of cells in every format, written in all forms of its lines and with other lines between them.
//! The block is read unchanged, and the notes account for every line.

mod abaqus;
mod gmsh;
mod nastran;
mod vtk;

use std::collections::{BTreeMap, BTreeSet};

use emmy::mesh::{CellKind, Mesh};
use proptest::prelude::*;

use super::MeshFile;
use super::account::{Entries, Treatment};

/// Random decisions, one after another; beyond their end always the first possibility, so that failures shrink.
#[derive(Debug, Clone)]
struct Choices(std::vec::IntoIter<u32>);

fn choices() -> impl Strategy<Value = Choices> {
    prop::collection::vec(any::<u32>(), 0..1500).prop_map(|numbers| Choices(numbers.into_iter()))
}

fn config() -> ProptestConfig {
    ProptestConfig { failure_persistence: None, ..ProptestConfig::default() }
}

impl Choices {
    fn below(&mut self, n: usize) -> usize {
        self.0.next().map_or(0, |number| number as usize % n)
    }

    /// True with a probability of 1 / n.
    fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }

    fn one<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())].clone()
    }

    fn shuffle<T>(&mut self, all: &mut [T]) {
        (1..all.len()).rev().for_each(|index| all.swap(index, self.below(index + 1)));
    }

    /// A word with letters of random case.
    fn spelled(&mut self, word: &str) -> String {
        match self.below(3) {
            0 => word.to_string(),
            1 => word.to_uppercase(),
            _ => word.to_lowercase(),
        }
    }

    /// Some names, few enough for one note.
    fn few(&mut self, of: &[String]) -> Vec<String> {
        (0..6).map(|_| self.one(of)).collect()
    }
}

/// Names of a table with a treatment; those with all names of one beginning get an end.
fn names(table: &[Entries], of: Treatment, end: &str) -> Vec<String> {
    let entries = table.iter().filter(|entries| entries.treatment == of);
    let names = entries.flat_map(|entries| entries.names);
    names
        .map(|name| {
            name.strip_suffix('*')
                .filter(|own| !own.is_empty())
                .map_or(name.to_string(), |own| format!("{own}{end}"))
        })
        .collect()
}

type Place = [i32; 3];

/// A block of unit cubes, some of them cut into two wedges.
#[derive(Debug)]
struct Block {
    points: Vec<Place>,
    /// The number of each point in the file, without order.
    numbers: Vec<usize>,
    cells: Vec<(CellKind, Vec<usize>)>,
    /// Points of the squares at x = 0, with the cell behind each.
    skin: Vec<(usize, [usize; 4])>,
    /// Points at the greatest x.
    end: Vec<usize>,
}

impl Block {
    fn new(choices: &mut Choices) -> Self {
        let mut n = [1 + choices.below(4), 1 + choices.below(3), 1 + choices.below(2)];
        // Arrays may have more values than become groups.
        n[0] += if choices.once_in(10) { 30 } else { 0 };
        let first = choices.below(1000);
        let mut points = Vec::new();
        for k in 0..=n[2] {
            for j in 0..=n[1] {
                points.extend((0..=n[0]).map(|i| [i, j, k].map(|x| x as i32)));
            }
        }
        let point = |i: usize, j: usize, k: usize| i + (n[0] + 1) * (j + (n[1] + 1) * k);
        let (mut cells, mut skin) = (Vec::new(), Vec::new());
        for k in 0..n[2] {
            for j in 0..n[1] {
                for i in 0..n[0] {
                    let square = [[0, 0], [1, 0], [1, 1], [0, 1]];
                    let corner = |at: usize| point(i + square[at % 4][0], j + square[at % 4][1], k + at / 4);
                    let cell = |of: &[usize]| of.iter().map(|&at| corner(at)).collect::<Vec<usize>>();
                    if choices.below(2) == 0 {
                        cells.push((CellKind::Hex8, cell(&[0, 1, 2, 3, 4, 5, 6, 7])));
                    } else {
                        cells.push((CellKind::Wedge6, cell(&[0, 1, 2, 4, 5, 6])));
                        cells.push((CellKind::Wedge6, cell(&[0, 2, 3, 4, 6, 7])));
                    }
                    if i == 0 {
                        skin.push((cells.len() - 1, [0, 4, 7, 3].map(corner)));
                    }
                }
            }
        }
        let end = (0..points.len()).filter(|&at| points[at][0] == n[0] as i32).collect();
        // Multiples of a number coprime to the prime 1009: all different.
        let numbers = (0..points.len()).map(|index| (index + first) * 389 % 1009 + 1).collect();
        Block { points, numbers, cells, skin, end }
    }

    /// Numbers of points.
    fn numbered(&self, points: &[usize]) -> Vec<String> {
        points.iter().map(|&point| self.numbers[point].to_string()).collect()
    }

    /// Nodes and cells, without groups.
    fn contents(&self) -> Contents {
        let cells = self.cells.iter().map(|(_, nodes)| self.places(nodes)).collect();
        Contents { nodes: self.points.iter().copied().collect(), cells, groups: BTreeMap::new() }
    }

    fn places(&self, points: &[usize]) -> Vec<Place> {
        sorted(points.iter().map(|&point| self.points[point]).collect())
    }

    fn volume(&self) -> f64 {
        let volume = |kind: CellKind| if kind == CellKind::Hex8 { 1.0 } else { 0.5 };
        self.cells.iter().map(|(kind, _)| volume(*kind)).sum()
    }
}

/// Nodes, cells and groups by their places.
#[derive(Debug, Default, PartialEq)]
struct Contents {
    nodes: BTreeSet<Place>,
    cells: BTreeSet<Vec<Place>>,
    groups: BTreeMap<(String, What), BTreeSet<Vec<Place>>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum What {
    Cells,
    Facets,
    Nodes,
}

fn sorted(mut places: Vec<Place>) -> Vec<Place> {
    places.sort_unstable();
    places
}

impl Contents {
    /// Adds members to a group, each with its points; a group of nodes has their points one by one.
    fn group(
        &mut self,
        block: &Block,
        name: &str,
        what: What,
        members: impl IntoIterator<Item = Vec<usize>>,
    ) {
        let group = self.groups.entry((name.to_string(), what)).or_default();
        for member in members {
            match what {
                What::Nodes => group.extend(member.iter().map(|&point| vec![block.points[point]])),
                _ => _ = group.insert(block.places(&member)),
            }
        }
    }

    fn of(mesh: &Mesh) -> Self {
        let place = |node: u32| {
            mesh.points()[node as usize].map(|x| {
                assert!((x - x.round()).abs() < 1e-9, "{x}");
                x.round() as i32
            })
        };
        let places = |nodes: &mut dyn Iterator<Item = u32>| sorted(nodes.map(place).collect());
        let cell = |index: u32| places(&mut mesh.cell(index as usize).nodes.iter().copied());
        let mut groups = BTreeMap::new();
        for (name, cells) in &mesh.groups().cells {
            groups.insert((name.clone(), What::Cells), cells.iter().map(|&index| cell(index)).collect());
        }
        for (name, facets) in &mesh.groups().facets {
            let facets = facets.iter().map(|&facet| places(&mut mesh.facet_nodes(facet)));
            groups.insert((name.clone(), What::Facets), facets.collect());
        }
        for (name, nodes) in &mesh.groups().nodes {
            groups.insert((name.clone(), What::Nodes), nodes.iter().map(|&node| vec![place(node)]).collect());
        }
        let cells = (0..mesh.n_cells() as u32).map(cell).collect();
        Contents { nodes: (0..mesh.n_nodes() as u32).map(place).collect(), cells, groups }
    }
}

/// The expected content of the notes.
#[derive(Debug, Default)]
struct Wanted {
    left_out: BTreeMap<String, usize>,
    unknown: BTreeMap<String, usize>,
    /// Other notes.
    notes: BTreeSet<String>,
}

impl Wanted {
    fn leave_out(&mut self, name: &str) {
        *self.left_out.entry(name.to_string()).or_default() += 1;
    }

    fn count_unknown(&mut self, name: &str) {
        *self.unknown.entry(name.to_string()).or_default() += 1;
    }

    /// Compares a file that was read with what it must have.
    fn check(&self, file: &MeshFile, block: &Block, contents: &Contents, text: &dyn Fn() -> String) {
        const BEGINNINGS: [&str; 2] =
            ["left out, though it may change the motion: ", "not known, and left out: "];
        let counts = BEGINNINGS.map(|beginning| {
            let lists: Vec<&str> =
                file.notes.iter().filter_map(|note| note.strip_prefix(beginning)).collect();
            assert!(lists.len() < 2, "{lists:?}\n{}", text());
            let entry = |entry: &str| {
                let (count, name) = entry.split_once(' ').unwrap();
                (name.to_string(), count.parse().unwrap())
            };
            lists.iter().flat_map(|list| list.split(", ")).map(entry).collect::<BTreeMap<String, usize>>()
        });
        assert_eq!(counts[0], self.left_out, "left out\n{}", text());
        assert_eq!(counts[1], self.unknown, "unknown\n{}", text());
        let is_other = |note: &&String| !BEGINNINGS.iter().any(|beginning| note.starts_with(beginning));
        let others: Vec<&String> = file.notes.iter().filter(is_other).collect();
        assert_eq!(others.len(), self.notes.len(), "{others:?} {:?}\n{}", self.notes, text());
        assert_eq!(others.into_iter().cloned().collect::<BTreeSet<String>>(), self.notes, "{}", text());
        assert_eq!((file.mesh.n_nodes(), file.mesh.n_cells()), (block.points.len(), block.cells.len()));
        assert_eq!(&Contents::of(&file.mesh), contents, "{}", text());
        let volume = emmy::mesh::quality(&file.mesh).volume;
        assert!((volume - block.volume()).abs() < 1e-12 * volume, "{volume}\n{}", text());
    }
}

/// Puts some of the lines into another file of a folder, which a line of the first one includes.
fn with_include(
    choices: &mut Choices,
    lines: &mut Vec<String>,
    end: &str,
    name: &str,
    include: &str,
) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let first = choices.below(lines.len());
    let n = 1 + choices.below(lines.len() - first);
    let mut own: Vec<String> = lines.splice(first..first + n, [include.to_string()]).collect();
    own.push(String::new());
    std::fs::write(folder.path().join(name), own.join(end)).unwrap();
    folder
}
