//! Cards of Nastran: free, narrow, wide, with tabs, continued in the next line or elsewhere, included.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::super::account::{Treatment, treatment};
use super::super::nastran::TABLE;
use super::super::{DeckEntry, parse};
use super::{Block, Choices, Contents, Wanted, What, choices, config, names, with_include};
use emmy::mesh::CellKind;

/// Lines of cards; continuations that stand elsewhere come last.
#[derive(Default)]
struct Lines {
    all: Vec<String>,
    elsewhere: Vec<String>,
    n_marks: usize,
}

const FREE: usize = 0;
const TABS: usize = 1;
const NARROW: usize = 2;
const WIDE: usize = 3;

impl Lines {
    fn card(&mut self, choices: &mut Choices, name: &str, fields: &[String]) {
        let name = choices.spelled(name);
        let is_marked = choices.below(2) == 0;
        let is_elsewhere = is_marked && choices.once_in(3);
        if choices.once_in(8) {
            // A line of more fields than fit into one.
            self.all.push(format!("{name},{}", fields.join(",")));
            return;
        }
        let mut parts: Vec<(usize, &[String])> = Vec::new();
        for eight in fields.chunks(8) {
            let is_first = parts.is_empty();
            let form =
                [FREE, TABS, NARROW, WIDE][choices.below(if is_first && name.len() == 8 { 1 } else { 4 })];
            match form {
                WIDE => parts.extend(eight.chunks(4).map(|four| (form, four))),
                _ => parts.push((form, eight)),
            }
        }
        let mut own = String::new();
        for (index, (form, fields)) in parts.iter().enumerate() {
            let is_last = index + 1 == parts.len();
            let next = if is_last || !is_marked { String::new() } else { self.mark() };
            let head = match (index, *form) {
                (0, WIDE) => format!("{name}*"),
                (0, _) => name.clone(),
                (_, WIDE) => format!("*{own}"),
                (_, FREE) => format!("+{own}"),
                (_, _) if own.is_empty() => String::new(),
                _ => format!("+{own}"),
            };
            let line = line(*form, &head, fields, &next);
            let line = if choices.once_in(9) { format!("{line} $ a comment, GRID,1") } else { line };
            let lines = if index > 0 && is_elsewhere { &mut self.elsewhere } else { &mut self.all };
            lines.push(line);
            own = next;
        }
    }

    fn mark(&mut self) -> String {
        self.n_marks += 1;
        format!("C{}", self.n_marks)
    }
}

fn line(form: usize, head: &str, fields: &[String], next: &str) -> String {
    let (count, star) = if form == WIDE { (4, "*") } else { (8, "+") };
    let next = if next.is_empty() { String::new() } else { format!("{star}{next}") };
    let mut all = fields.to_vec();
    if !next.is_empty() {
        all.resize(count, String::new());
    }
    match form {
        FREE if next.is_empty() => format!("{head},{}", all.join(",")),
        FREE => format!("{head},{},{next}", all.join(", ")),
        TABS if next.is_empty() => format!("{head}\t{}", all.join("\t")),
        TABS => format!("{head}\t{}\t{next}", all.join("\t")),
        NARROW => {
            format!("{head:<8}{}{next}", all.iter().map(|field| format!("{field:>8}")).collect::<String>())
        }
        _ => format!("{head:<8}{}{next}", all.iter().map(|field| format!("{field:<16}")).collect::<String>()),
    }
}

fn strings<T: ToString>(all: &[T]) -> Vec<String> {
    all.iter().map(T::to_string).collect()
}

/// A whole number as a real one.
fn real(choices: &mut Choices, x: i32) -> String {
    match choices.below(4) {
        0 => format!("{x}."),
        1 => format!("{x}.0"),
        2 => format!("{x}.+0"),
        _ => format!("{x}0.-1"),
    }
}

/// Cards of the block, with its groups and what the notes say about them.
fn cards(
    choices: &mut Choices,
    block: &Block,
    wanted: &mut Wanted,
) -> (Vec<(String, Vec<String>)>, Contents) {
    let mut contents = block.contents();
    let mut cards: Vec<(&str, Vec<String>)> = Vec::new();
    // The system 5 has its origin at x = 10.
    let has_system = choices.below(2) == 0;
    let is_default = has_system && choices.below(2) == 0;
    if has_system {
        let fields = ["5", "", "10.", "0.", "0.", "10.", "0.", "1.", "11.", "0.", "0."];
        cards.push(("CORD2R", strings(&fields)));
    }
    if is_default {
        cards.push(("GRDSET", strings(&["", "5"])));
    }
    for (&[x, y, z], number) in block.points.iter().zip(&block.numbers) {
        let is_local = has_system && choices.below(2) == 0;
        let system = match (is_local, is_default) {
            (true, true) | (false, false) => "",
            (true, false) => "5",
            (false, true) => "0",
        };
        let place = [x - if is_local { 10 } else { 0 }, y, z].map(|x| real(choices, x));
        cards.push(("GRID", [vec![number.to_string(), system.to_string()], place.to_vec()].concat()));
    }
    for (index, (kind, nodes)) in block.cells.iter().enumerate() {
        let property = 1000 + choices.below(2);
        let name = if *kind == CellKind::Hex8 { "CHEXA" } else { "CPENTA" };
        cards.push((name, [strings(&[index + 1, property]), block.numbered(nodes)].concat()));
        let group = if property == 1000 { "steel" } else { "pid_1001" };
        contents.group(block, group, What::Cells, [nodes.clone()]);
    }
    let has_shell = choices.below(2) == 0;
    for (index, (_, nodes)) in block.skin.iter().enumerate().filter(|_| choices.below(2) == 0) {
        cards.push(("CQUAD4", [strings(&[500 + index, 1002]), block.numbered(nodes)].concat()));
        contents.group(block, "pid_1002", What::Facets, [nodes.to_vec()]);
        if has_shell {
            wanted.leave_out("CQUAD4");
        }
    }
    if has_shell {
        cards.push(("PSHELL", strings(&["1002", "1", "0.1", "1"])));
    }
    if choices.below(2) == 0 {
        cards.push(("SPC1", [strings(&["7", "123"]), block.numbered(&block.end)].concat()));
        contents.group(block, "spc_7", What::Nodes, [block.end.clone()]);
        let note = "1 constraint (SPC1) fixes nothing without a `support`: groups spc_7";
        wanted.notes.insert(note.to_string());
    }
    if choices.below(2) == 0 {
        let nodes = [block.end[0], block.end[1]];
        cards.push((
            "CBAR",
            [strings(&[700, 1003]), block.numbered(&nodes), strings(&["1.", "0.", "0."])].concat(),
        ));
        contents.group(block, "pid_1003", What::Nodes, [nodes.to_vec()]);
        if choices.below(2) == 0 {
            cards.push(("PBAR", strings(&["1003", "1", "0.1"])));
            wanted.leave_out("CBAR");
        } else {
            wanted.notes.insert("1 line element is read as the nodes at the ends, not as bars".to_string());
        }
    }
    choices.shuffle(&mut cards);
    (cards.into_iter().map(|(name, fields)| (name.to_string(), fields)).collect(), contents)
}

/// Springs, dampers and masses make a group of the grid points at their ends.
fn add_ends(block: &Block, name: &str, fields: &[String], contents: &mut Contents) {
    let field = |index: usize| fields.get(index).map_or("", String::as_str);
    if ["CELAS1", "CDAMP1", "CMASS1"].contains(&name) {
        let of = |end: usize| block.numbers.iter().position(|number| number.to_string() == field(end));
        for point in [2, 4].into_iter().filter_map(of) {
            contents.group(block, &format!("pid_{}", field(1)), What::Nodes, [vec![point]]);
        }
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn every_card_is_accounted_for(mut choices in choices()) {
        let choices = &mut choices;
        let block = Block::new(choices);
        let mut wanted = Wanted::default();
        let (cards, mut contents) = cards(choices, &block, &mut wanted);
        let few = [Treatment::NoEffect, Treatment::LeftOut].map(|of| choices.few(&names(TABLE, of, "9")));
        let mut lines = Lines::default();
        if choices.below(2) == 0 {
            lines.all.extend(["SOL 101", "CEND", "LOAD = 2", choices.one(&["BEGIN BULK", "begin  bulk"])].map(str::to_string));
        }
        lines.all.push("$HMNAME PROP  1000\"steel\" 4".to_string());
        for (name, fields) in &cards {
            while choices.once_in(3) {
                let fields: Vec<String> = (0..1 + choices.below(20)).map(|_| (1 + choices.below(999)).to_string()).collect();
                let name = match choices.below(4) {
                    0 => choices.one(&few[0]),
                    1 => {
                        let name = choices.one(&few[1]);
                        wanted.leave_out(&name);
                        add_ends(&block, &name, &fields, &mut contents);
                        name
                    }
                    2 => {
                        let name = format!("X{}Q", choices.below(6));
                        wanted.count_unknown(&name);
                        name
                    }
                    _ => {
                        lines.all.push(choices.one(&["$ a comment, GRID,1", "", "   ", "\t"]).to_string());
                        continue;
                    }
                };
                lines.card(choices, &name, &fields);
            }
            lines.card(choices, name, fields);
        }
        let Lines { all: mut lines, mut elsewhere, .. } = lines;
        choices.shuffle(&mut elsewhere);
        lines.extend(elsewhere);
        let end = choices.one(&["\n", "\r\n"]);
        let include = choices.one(&["INCLUDE 'more.bdf'", "include more.bdf", "Include \"more.bdf\" $ more"]);
        let folder = choices.once_in(3).then(|| with_include(choices, &mut lines, end, "more.bdf", include));
        let file = folder.as_ref().map_or("a.bdf".into(), |folder| folder.path().join("a.bdf"));
        if choices.below(2) == 0 {
            lines.push(choices.one(&["ENDDATA", "enddata", "ENDDATA  $ end"]).to_string());
        } else {
            wanted.notes.insert(format!("{}: there is no ENDDATA at the end; is the file cut off?", file.display()));
        }
        lines.push(String::new());
        let text = lines.join(end);
        let read = parse(&file, text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        wanted.check(&read, &block, &contents, &|| text.clone());
    }
}

/// A rigid element, mass or spring of a number, with random grid points.
fn beside(choices: &mut Choices, grids: &[usize], number: usize) -> (&'static str, Vec<String>) {
    let few = |choices: &mut Choices| -> Vec<String> {
        (0..1 + choices.below(5)).map(|_| choices.one(grids).to_string()).collect()
    };
    let [a, b] = [choices.one(grids), choices.one(grids)].map(|grid| grid.to_string());
    let own = number.to_string();
    let component = (1 + choices.below(4)).to_string();
    let value = choices.one(&["2.5", "2.5", "1.", "0.", "-1.", "x"]).to_string();
    let fields = |fields: &[&str]| strings(fields);
    match choices.below(9) {
        0 => {
            let of = choices.one(&["123456", "123", "123", "12"]);
            ("RBE2", [fields(&[&own, &a, of]), few(choices)].concat())
        }
        1 => {
            let of = choices.one(&["123", "123456", "3"]);
            let second = [fields(&[&value, "123"]), few(choices)].concat();
            ("RBE3", [fields(&[&own, "", &a, of, "1.", "123"]), few(choices), second].concat())
        }
        2 => ("RBAR", fields(&[&own, &a, &b, choices.one(&["123456", "123456", "123"])])),
        3 => ("RROD", fields(&[&own, &a, &b, "1"])),
        4 => {
            let offset = choices.one(&["", "0.", "1.5"]);
            (
                "CONM2",
                fields(&[
                    &own,
                    &a,
                    choices.one(&["", "-1", "5"]),
                    &value,
                    offset,
                    "",
                    "",
                    "",
                    offset,
                    "",
                    "1.",
                ]),
            )
        }
        5 => ("CELAS2", fields(&[&own, &value, &a, &component])),
        6 => ("CELAS2", fields(&[&own, &value, &a, &component, &b, &component])),
        7 => ("CDAMP2", fields(&[&own, &value, &a, &component, &b, &component])),
        _ => ("CMASS2", fields(&[&own, &value, &a, &component])),
    }
}

proptest! {
    #![proptest_config(config())]

    /// Every rigid element, mass and spring is part of an entry, or a note names it. Groups of entries are in the mesh.
    #[test]
    fn everything_beside_the_mesh_acts_or_is_named(mut choices in choices()) {
        let choices = &mut choices;
        let block = Block::new(choices);
        let (mut cards, contents) = cards(choices, &block, &mut Wanted::default());
        let mut grids = block.numbers.clone();
        grids.truncate(8);
        for number in 5001..5005 {
            let place = [choices.below(4), choices.below(2), 0].map(|x| format!("{x}."));
            cards.push(("GRID".to_string(), [vec![number.to_string(), "0".to_string()], place.to_vec()].concat()));
            grids.push(number);
        }
        grids.extend(choices.once_in(5).then_some(9999));
        // A note has ten names.
        let own: Vec<_> = (70001..70001 + choices.below(10)).map(|number| beside(choices, &grids, number)).collect();
        let (set, ends) = (choices.below(3) + 1, [choices.one(&grids), choices.one(&grids)]);
        let equations = (0..choices.below(4)).map(|component| {
            let fields = [set, ends[0], component + 1].map(|x| x.to_string());
            let rest = [ends[1], component + 1].map(|x| x.to_string());
            [&fields[..], &["1.".to_string()], &rest, &["-1.".to_string()]].concat()
        });
        let equations: Vec<Vec<String>> = equations.collect();
        cards.extend(own.iter().map(|(name, fields)| (name.to_string(), fields.clone())));
        cards.extend(equations.iter().map(|fields| ("MPC".to_string(), fields.clone())));
        choices.shuffle(&mut cards);
        let mut lines = Lines::default();
        lines.all.push("$HMNAME PROP  1000\"steel\" 4".to_string());
        cards.iter().for_each(|(name, fields)| lines.card(choices, name, fields));
        let text = [lines.all, lines.elsewhere, vec!["ENDDATA".to_string(), String::new()]].concat().join("\n");
        let read = parse("a.bdf".as_ref(), text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let of_entry = |entry: &DeckEntry| [entry.card(), format!("{} {}", entry.kind, entry.name)];
        let named: Vec<String> = read.entries.iter().flat_map(of_entry).chain(read.notes.iter().cloned()).collect();
        for (name, fields) in &own {
            let is_there = named.iter().any(|text| text.contains(name) && text.contains(&fields[0]));
            prop_assert!(is_there, "{name} {}\n{named:#?}\n{text}", fields[0]);
        }
        prop_assert!(equations.is_empty() || named.iter().any(|text| text.contains("MPC")), "{named:#?}\n{text}");
        let groups = read.mesh.groups();
        let mut names = BTreeSet::new();
        for entry in &read.entries {
            prop_assert!(names.insert(&entry.name), "{}\n{text}", entry.name);
            let group = |key: &str| entry.table.get(key)?.as_str();
            let used: Vec<&str> = ["group", "leader", "follower"].into_iter().filter_map(group).collect();
            for group in &used {
                let n = groups.nodes.get(*group).map(Vec::len);
                let is_point = read.entries.iter().any(|other| other.name == *group);
                prop_assert!(n.is_some_and(|n| n > 0) || is_point, "{group}\n{text}");
            }
            let weighted = if entry.section == "tie" { "leader" } else { "group" };
            if let Some(weights) = entry.table.get("weights").and_then(|weights| weights.as_array()) {
                let n = group(weighted).map(|name| groups.nodes[name].len());
                prop_assert_eq!(n, Some(weights.len()), "{}", text);
            }
        }
        prop_assert_eq!((read.mesh.n_nodes(), read.mesh.n_cells()), (block.points.len(), block.cells.len()));
        let found = Contents::of(&read.mesh);
        prop_assert!(contents.groups.iter().all(|(name, members)| found.groups.get(name) == Some(members)), "{text}");
    }
}

#[test]
fn the_table_treats_every_name_as_it_says() {
    for of in Treatment::ALL {
        names(TABLE, of, "9").iter().for_each(|name| assert_eq!(treatment(TABLE, name), Some(of), "{name}"));
    }
}

/// A name that is read must be known to the reader, and a refused one must be an error.
#[test]
fn the_reader_knows_every_name_of_its_table() {
    let nodes = "GRID,1\nGRID,2,,1.\nGRID,3,,,1.\nGRID,4,,,,1.\nCTETRA,99,1,1,2,3,4\n";
    for name in names(TABLE, Treatment::Read, "9") {
        let text = format!("{nodes}{name},x\nENDDATA\n");
        match (&*name, parse("a.bdf".as_ref(), text.as_bytes())) {
            // These are left out with their place, because the mesh is good without them.
            (name, Ok(file)) if !name.starts_with('P') && name != "GRDSET" => {
                let note =
                    format!("a.bdf, line 6: {name}: 1 is left out (line 6): \"x\" is not a whole number");
                assert!(file.notes.contains(&note), "{name}: {:?}", file.notes);
            }
            (_, Err(error)) => assert!(error.to_string().starts_with("a.bdf, line 6: "), "{name}: {error}"),
            // GRDSET takes its fields from the second one; names of properties of lines are all that is read of them.
            ("GRDSET", Ok(_)) => {}
            (name, Ok(_)) => assert!(name.starts_with('P'), "{name}"),
        }
    }
    for name in names(TABLE, Treatment::Refused, "9") {
        let text = format!("{nodes}{name},1,2\nENDDATA\n");
        let error = parse("a.bdf".as_ref(), text.as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with("a.bdf, line 6: ") && error.contains("not read"), "{error}");
    }
    for name in ["CHEX8", "CTETRAX", "CPENT6", "CBRICK"] {
        let text = format!("{nodes}{name},1,2\nENDDATA\n");
        let error = parse("a.bdf".as_ref(), text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(&format!("solid cells of the kind {name} are not read")), "{error}");
    }
}
