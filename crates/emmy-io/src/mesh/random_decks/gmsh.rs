//! Sections of Gmsh: all versions, as text or in binary, in any order.

use proptest::prelude::*;

use super::super::account::Treatment;
use super::super::gmsh::TABLE;
use super::super::parse;
use super::{Block, Choices, Contents, Wanted, What, choices, config, names};
use emmy::mesh::CellKind;

const VERSIONS: [&str; 6] = ["1", "2.0", "2.1", "2.2", "4.0", "4.1"];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// The bytes of a section.
struct Bytes {
    all: Vec<u8>,
    encoding: Encoding,
    /// Between numbers as text.
    gap: &'static str,
}

impl Bytes {
    fn number<const N: usize>(&mut self, text: &str, little: [u8; N]) {
        match self.encoding {
            Encoding::Text => self.all.extend([text.as_bytes(), self.gap.as_bytes()].concat()),
            Encoding::Little => self.all.extend(little),
            Encoding::Big => self.all.extend(little.iter().rev()),
        }
    }

    fn int(&mut self, number: usize) {
        self.number(&number.to_string(), (number as i32).to_le_bytes());
    }

    fn size(&mut self, number: usize) {
        self.number(&number.to_string(), (number as u64).to_le_bytes());
    }

    fn reals(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|x| self.number(&format!("{x:?}"), x.to_le_bytes()));
    }

    fn line(&mut self, text: &str) {
        self.all.extend(format!("{text}\n").into_bytes());
    }
}

/// An element with its physical groups.
#[derive(Debug, Clone)]
struct Element {
    number: usize,
    id: usize,
    dim: usize,
    groups: Vec<usize>,
    nodes: Vec<usize>,
}

/// Names of the physical groups 1 to 5, where they have one, and their dimensions.
const NAMES: [(usize, &str); 5] = [(3, "left"), (3, ""), (2, "skin"), (1, ""), (0, "end")];

fn elements(
    choices: &mut Choices,
    block: &Block,
    is_named: bool,
    wanted: &mut Wanted,
) -> (Vec<Element>, Contents) {
    let mut contents = block.contents();
    let mut elements = Vec::new();
    let mut n_ignored = [0; 3];
    let mut add = |id: usize, dim: usize, groups: &[usize], points: &[usize], what: What| {
        if groups.is_empty() && dim < 3 {
            n_ignored[dim] += 1;
        }
        for &group in groups {
            let name = NAMES[group - 1].1;
            let name = if name.is_empty() || !is_named { group.to_string() } else { name.to_string() };
            contents.group(block, &name, what, [points.to_vec()]);
        }
        let nodes = points.iter().map(|&point| block.numbers[point]).collect();
        elements.push(Element { number: elements.len() + 1, id, dim, groups: groups.to_vec(), nodes });
    };
    for (kind, nodes) in &block.cells {
        let groups = choices.one(&[&[][..], &[1], &[2], &[1, 2]]);
        add(if *kind == CellKind::Hex8 { 5 } else { 6 }, 3, groups, nodes, What::Cells);
    }
    for (_, nodes) in &block.skin {
        add(3, 2, choices.one(&[&[][..], &[3]]), nodes, What::Facets);
    }
    if choices.below(2) == 0 {
        add(1, 1, choices.one(&[&[][..], &[4]]), &block.end[..2], What::Nodes);
    }
    for &point in &block.end {
        if choices.below(2) == 0 {
            continue;
        }
        add(15, 0, choices.one(&[&[][..], &[5]]), &[point], What::Nodes);
    }
    for (dim, &n) in n_ignored.iter().enumerate().filter(|(_, n)| **n > 0) {
        let are = if n == 1 {
            "element of dimension X in no physical group is"
        } else {
            "elements of dimension X in no physical group are"
        };
        wanted.notes.insert(format!("{n} {are} ignored").replace('X', &dim.to_string()));
    }
    choices.shuffle(&mut elements);
    (elements, contents)
}

/// Runs of elements of one type and the same groups, each with the number of its entity.
fn entities(elements: &[Element]) -> Vec<(usize, &[Element])> {
    let mut known: Vec<(usize, &[usize])> = Vec::new();
    let mut runs = Vec::new();
    for run in elements.chunk_by(|a, b| a.id == b.id && a.groups == b.groups) {
        let key = (run[0].dim, &run[0].groups[..]);
        let at = known.iter().position(|own| *own == key).unwrap_or_else(|| {
            known.push(key);
            known.len() - 1
        });
        runs.push((at + 1, run));
    }
    runs
}

fn write_names(out: &mut Bytes, version: &str) {
    let named = NAMES.iter().enumerate().filter(|(_, (_, name))| !name.is_empty());
    out.line(&named.clone().count().to_string());
    for (index, (dim, name)) in named {
        let dim = if version == "2.0" { String::new() } else { format!("{dim} ") };
        // Salome fills names with blanks.
        out.line(&format!("{dim}{} \"{name}   \"", index + 1));
    }
}

fn write_entities(out: &mut Bytes, version: &str, elements: &[Element]) {
    let runs = entities(elements);
    let of = |dim: usize| {
        let mut own: Vec<(usize, &[usize])> = runs
            .iter()
            .filter(|(_, run)| run[0].dim == dim)
            .map(|(at, run)| (*at, &run[0].groups[..]))
            .collect();
        own.sort_unstable();
        own.dedup();
        own
    };
    (0..4).for_each(|dim| out.size(of(dim).len()));
    for dim in 0..4 {
        for (at, groups) in of(dim) {
            out.int(at);
            out.reals(&[0.5; 6][..if dim == 0 && version == "4.1" { 3 } else { 6 }]);
            out.size(groups.len());
            groups.iter().for_each(|&group| out.int(group));
            if dim > 0 {
                out.size(2);
                [1, 2].into_iter().for_each(|bound| out.int(bound));
            }
        }
    }
}

fn write_nodes(out: &mut Bytes, version: &str, block: &Block) {
    let n = block.points.len();
    let point = |at: usize| block.points[at].map(f64::from);
    if !version.starts_with('4') {
        out.line(&n.to_string());
        for at in 0..n {
            out.int(block.numbers[at]);
            out.reals(&point(at));
        }
        return;
    }
    // Two blocks, the first with the parameters of a curve.
    let parts = [(0..n / 2, 1), (n / 2..n, 0)];
    out.size(parts.len());
    (0..if version == "4.1" { 3 } else { 1 }).for_each(|_| out.size(n));
    for (part, is_parametric) in parts {
        let entity = if version == "4.1" { [1, 9] } else { [9, 1] };
        entity.into_iter().for_each(|number| out.int(number));
        out.int(is_parametric);
        out.size(part.len());
        let parameters = &[0.25][..is_parametric];
        if version == "4.1" {
            part.clone().for_each(|at| out.size(block.numbers[at]));
        }
        for at in part {
            if version == "4.0" {
                out.int(block.numbers[at]);
            }
            out.reals(&point(at));
            out.reals(parameters);
        }
    }
}

fn write_elements(out: &mut Bytes, version: &str, elements: &[Element]) {
    if version.starts_with('4') {
        let runs = entities(elements);
        out.size(runs.len());
        (0..if version == "4.1" { 3 } else { 1 }).for_each(|_| out.size(elements.len()));
        for (at, run) in runs {
            let entity = if version == "4.1" { [run[0].dim, at] } else { [at, run[0].dim] };
            entity.into_iter().for_each(|number| out.int(number));
            out.int(run[0].id);
            out.size(run.len());
            for element in run {
                let number =
                    |&number: &usize| if version == "4.1" { out.size(number) } else { out.int(number) };
                std::iter::once(&element.number).chain(&element.nodes).for_each(number);
            }
        }
        return;
    }
    // An element of two groups is there twice.
    let lines: Vec<(&Element, usize)> = elements
        .iter()
        .flat_map(|element| {
            let groups = if element.groups.is_empty() { vec![0] } else { element.groups.clone() };
            groups.into_iter().map(move |group| (element, group))
        })
        .collect();
    out.line(&lines.len().to_string());
    for (element, group) in lines {
        let head = match (version, out.encoding) {
            ("1", _) => vec![element.number, element.id, group, 9, element.nodes.len()],
            (_, Encoding::Text) => vec![element.number, element.id, 2, group, 9],
            _ => vec![element.id, 1, 2, element.number, group, 9],
        };
        head.iter().chain(&element.nodes).for_each(|&number| out.int(number));
        if out.encoding == Encoding::Text {
            out.line("");
        }
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn every_section_is_accounted_for(mut choices in choices()) {
        let choices = &mut choices;
        let block = Block::new(choices);
        let mut wanted = Wanted::default();
        let version = choices.one(&VERSIONS);
        let encodings = [Encoding::Text, Encoding::Little, Encoding::Big];
        let encoding = if version == "1" { Encoding::Text } else { choices.one(&encodings) };
        let gap = choices.one(&[" ", "\n", "\r\n", "  \t"]);
        let is_named = version != "1" && choices.below(2) == 0;
        let (elements, contents) = elements(choices, &block, is_named, &mut wanted);
        let mut sections = if version == "1" { vec!["NOD", "ELM"] } else { vec!["Nodes", "Elements"] };
        if is_named {
            sections.push("PhysicalNames");
        }
        if version.starts_with('4') {
            sections.push("Entities");
        }
        let few = [Treatment::NoEffect, Treatment::LeftOut].map(|of| choices.few(&names(TABLE, of, "")));
        let mut others = Vec::new();
        while choices.below(3) > 0 {
            let name = match choices.below(3) {
                0 => choices.one(&few[0]),
                1 => {
                    let name = choices.one(&few[1]);
                    wanted.leave_out(&name);
                    name
                }
                _ => {
                    let name = format!("Zebra{}", choices.below(6));
                    wanted.count_unknown(&name);
                    name
                }
            };
            others.push(name);
        }
        sections.extend(others.iter().map(String::as_str));
        choices.shuffle(&mut sections);
        // By its first section a file shows that its version is 1.
        sections.sort_by_key(|section| *section != "NOD");
        let mut out = Bytes { all: Vec::new(), encoding, gap };
        if version != "1" {
            out.line(&format!("$MeshFormat\n{version} {} 8", usize::from(encoding != Encoding::Text)));
            if encoding != Encoding::Text {
                out.int(1);
                out.line("");
            }
            out.line("$EndMeshFormat");
        }
        for section in sections {
            out.line(&format!("${section}"));
            match section {
                "PhysicalNames" => write_names(&mut out, version),
                "Entities" => write_entities(&mut out, version, &elements),
                "Nodes" | "NOD" => write_nodes(&mut out, version, &block),
                "Elements" | "ELM" => write_elements(&mut out, version, &elements),
                _ => out.line(choices.one(&["1\n2 3 4\n5", "words\n\"more words\"", "", "$1.0 Nodes"])),
            }
            let end = if version == "1" && section.len() == 3 { "END" } else { "End" };
            let lines = if choices.below(2) == 0 { "\n" } else { "" };
            out.line(&format!("\n${end}{section}{lines}"));
        }
        let text = || String::from_utf8_lossy(&out.all).into_owned();
        let read = parse("a.msh".as_ref(), &out.all).unwrap_or_else(|error| panic!("{error}\n{}", text()));
        wanted.check(&read, &block, &contents, &text);
    }
}
