//! Keywords of Abaqus: in any case, with spaces, parameters and comments, continued, in parts and included.

use proptest::prelude::*;

use super::super::abaqus::TABLE;
use super::super::account::Treatment;
use super::super::parse;
use super::{Block, Choices, Contents, Wanted, What, choices, config, names, with_include};
use emmy::mesh::CellKind;

/// Lines of a keyword with its data; one that must not be cut by an include has line feeds.
type Lines = Vec<String>;

/// Types of elements that are left out, and their numbers of nodes.
const LEFT_OUT: [(&str, usize); 10] = [
    ("MASS", 1),
    ("ROTARYI", 1),
    ("SPRING2", 2),
    ("DASHPOTA", 2),
    ("GAPUNI", 2),
    ("B31", 2),
    ("B32", 3),
    ("R3D4", 4),
    ("S4R", 4),
    ("U7", 4),
];

/// A keyword line with its parameters.
fn keyword(choices: &mut Choices, name: &str, parameters: &[(&str, &str)]) -> String {
    let mut text = choices.spelled(name);
    // Names that only begin like one of the table keep their spaces.
    if choices.once_in(4) && TABLE.iter().any(|entries| entries.names.contains(&name)) {
        text = text.replace(' ', choices.one(&["", "  "]));
    }
    for (key, value) in parameters {
        let key = choices.spelled(key);
        let value = if choices.once_in(4) { format!("\"{value}\"") } else { value.to_string() };
        let value = if value == "\"\"" { "" } else { &value };
        text += choices.one(&[",", ", ", " ,  ", ",\n", ",\n  "]);
        text += &key;
        if !value.is_empty() {
            text += choices.one(&["=", " = "]);
            text += value;
        }
    }
    text
}

/// A data line of numbers, which may go on in the next line.
fn data(choices: &mut Choices, numbers: &[String]) -> Lines {
    let cut = if choices.once_in(4) { 1 + choices.below(numbers.len()) } else { numbers.len() };
    let comma = choices.one(&[",", ", ", " , "]);
    let (first, rest) = numbers.split_at(cut);
    match rest {
        [] => vec![first.join(comma)],
        _ => vec![first.join(comma) + ",", rest.join(comma)],
    }
}

/// Numbers in a list of any number, some on each line.
fn list(choices: &mut Choices, numbers: &[String]) -> Lines {
    numbers.chunks(1 + choices.below(16)).map(|part| part.join(", ") + choices.one(&["", ","])).collect()
}

/// Keywords with nodes, cells, sets and surfaces.
fn body(choices: &mut Choices, block: &Block, shift: i32, wanted: &mut Wanted) -> (Vec<Lines>, Contents) {
    let mut contents = block.contents();
    let mut all: Vec<Lines> = Vec::new();
    let n = 1 + choices.below(block.points.len());
    let points: Vec<usize> = (0..block.points.len()).collect();
    for part in points.chunks(n) {
        let mut lines = vec![keyword(choices, "*NODE", &[])];
        for &point in part {
            let [x, y, z] = block.points[point];
            let x = x - shift;
            let place = match choices.below(3) {
                0 => format!("{x}, {y}, {z}"),
                1 => format!("{x}., {y}.0 ,{z}.E0"),
                _ => format!("  {x}.D+0,{y}.D0,{z}.d0"),
            };
            lines.push(format!("{},{place}", block.numbers[point]));
        }
        all.push(lines);
    }
    let mut sets: [Vec<String>; 2] = Default::default();
    let has_own = choices.below(2) == 0;
    for (index, (kind, nodes)) in block.cells.iter().enumerate() {
        let number = (index + 1).to_string();
        let set = choices.below(2);
        let name = ["left", "Right"][set];
        let (element_type, note) = match (kind, choices.below(3)) {
            (CellKind::Hex8, 0) => ("C3D8R", "C3D8R is read as hex8 and integrated fully"),
            (CellKind::Hex8, _) => ("C3D8", ""),
            _ => ("C3D6", ""),
        };
        wanted.notes.extend((!note.is_empty()).then(|| note.to_string()));
        let in_line = [("TYPE", element_type), ("ELSET", name)];
        let mut lines = vec![keyword(choices, "*ELEMENT", if has_own { &in_line[..1] } else { &in_line })];
        lines.extend(data(choices, &[vec![number.clone()], block.numbered(nodes)].concat()));
        all.push(lines);
        sets[set].push(number);
        contents.group(block, name, What::Cells, [nodes.clone()]);
    }
    for (name, numbers) in
        ["left", "right"].iter().zip(&sets).filter(|(_, numbers)| has_own && !numbers.is_empty())
    {
        let mut lines =
            vec![keyword(choices, "*ELSET", &[("ELSET", if *name == "left" { "left" } else { "Right" })])];
        lines.extend(list(choices, numbers));
        all.push(lines);
    }
    if choices.below(2) == 0 {
        let mut lines = vec![keyword(choices, "*NSET", &[("NSET", "end"), ("UNSORTED", "")])];
        lines.extend(list(choices, &block.numbered(&block.end)));
        all.push(lines);
        contents.group(block, "end", What::Nodes, [block.end.clone()]);
    }
    if choices.below(2) == 0 {
        let mut lines = vec![keyword(choices, "*SURFACE", &[("NAME", "skin"), ("TYPE", "ELEMENT")])];
        for (cell, _) in &block.skin {
            // The face x = 0 of a hexahedron is its sixth, that of the second wedge its fifth.
            let face = if block.cells[*cell].0 == CellKind::Hex8 { "S6" } else { "S5" };
            lines.push(format!("{}, {}", cell + 1, choices.spelled(face)));
        }
        all.push(lines);
        contents.group(block, "skin", What::Facets, block.skin.iter().map(|(_, nodes)| nodes.to_vec()));
    }
    for (index, (_, nodes)) in block.skin.iter().enumerate() {
        if !choices.once_in(3) {
            continue;
        }
        let mut lines = vec![keyword(choices, "*ELEMENT", &[("ELSET", "cover"), ("TYPE", "M3D4")])];
        lines.extend(data(choices, &[vec![(500 + index).to_string()], block.numbered(nodes)].concat()));
        all.push(lines);
        contents.group(block, "cover", What::Facets, [nodes.to_vec()]);
        wanted
            .notes
            .insert("elements of type M3D4 are read as faces of the solid cells beside them".to_string());
    }
    for number in (700..).take(choices.below(4)) {
        let (element_type, n_nodes) = choices.one(&LEFT_OUT);
        // These corners of the first cube are no face of a cell.
        let hexahedron = if block.cells[0].0 == CellKind::Hex8 { [0, 1, 6, 7] } else { [0, 1, 5, 3] };
        let nodes: Vec<usize> = hexahedron.iter().take(n_nodes).map(|&at| block.cells[0].1[at]).collect();
        let is_in_set = choices.below(2) == 0;
        let both = [("TYPE", element_type), ("ELSET", "lump")];
        let mut lines = vec![keyword(choices, "*ELEMENT", if is_in_set { &both } else { &both[..1] })];
        lines.push(format!("{number}, {}", block.numbered(&nodes).join(", ")));
        all.push(lines);
        wanted.leave_out(element_type);
        if is_in_set {
            contents.group(block, "lump", What::Nodes, [nodes]);
        }
    }
    choices.shuffle(&mut all);
    (all, contents)
}

/// Keywords and comments that are not read.
fn others(choices: &mut Choices, few: &[Vec<String>; 2], wanted: &mut Wanted) -> Lines {
    let name = match choices.below(4) {
        0 => choices.one(&few[0]),
        1 => {
            let name = choices.one(&few[1]);
            wanted.leave_out(&name);
            name
        }
        2 => {
            let name = format!("*ZEBRA {}X", choices.below(6));
            wanted.count_unknown(&name);
            name
        }
        _ => {
            return vec![
                choices.one(&["** a comment, *NODE", "**", "", "   ", "  ** *BOUNDARY,"]).to_string(),
            ];
        }
    };
    let parameters = [("NAME", "a, b"), ("TYPE", "VELOCITY"), ("OP", "NEW"), ("NLGEOM", "")];
    let n = choices.below(4);
    let mut lines = vec![keyword(choices, &name, &parameters[..n])];
    for _ in 0..choices.below(4) {
        lines.push(
            choices.one(&["1, 2, 3.", "left, S1, 1.", "some words", ",", "** in between", ""]).to_string(),
        );
    }
    lines
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn every_keyword_is_accounted_for(mut choices in choices()) {
        let choices = &mut choices;
        let block = Block::new(choices);
        let mut wanted = Wanted::default();
        let is_part = choices.once_in(3);
        let shift = if is_part { 3 } else { 0 };
        let (body, mut contents) = body(choices, &block, shift, &mut wanted);
        let few = [Treatment::NoEffect, Treatment::LeftOut].map(|of| choices.few(&names(TABLE, of, " X9")));
        let mut all: Vec<Lines> = vec![vec!["*HEADING".to_string(), "words, and more".to_string()]];
        if is_part {
            all.push(vec![keyword(choices, "*PART", &[("NAME", "Arm")])]);
        }
        all.extend(body);
        if is_part {
            all.push(vec![keyword(choices, "*END PART", &[])]);
            all.push(vec![keyword(choices, "*ASSEMBLY", &[("NAME", "All")])]);
            let instance = keyword(choices, "*INSTANCE", &[("NAME", "Arm-1"), ("PART", "arm")]);
            all.push(vec![instance, "3., 0., 0.".to_string()]);
            all.push(vec![keyword(choices, "*END INSTANCE", &[])]);
            all.push(vec![keyword(choices, "*END ASSEMBLY", &[])]);
            for ((name, what), members) in contents.groups.clone() {
                contents.groups.insert((format!("Arm-1.{name}"), what), members);
            }
            contents.groups.insert(("Arm-1".to_string(), What::Cells), contents.cells.clone());
        }
        let mut lines: Lines = Vec::new();
        for own in all {
            lines.extend(own);
            while choices.once_in(3) {
                lines.extend(others(choices, &few, &mut wanted));
            }
        }
        let end = choices.one(&["\n", "\r\n"]);
        let include = keyword(choices, "*INCLUDE", &[("INPUT", "more.inp")]);
        let folder = choices.once_in(3).then(|| with_include(choices, &mut lines, end, "more.inp", &include));
        let file = folder.as_ref().map_or("a.inp".into(), |folder| folder.path().join("a.inp"));
        if choices.below(2) == 0 {
            lines.push(String::new());
        }
        let text = lines.join("\n").replace('\n', end);
        if !text.ends_with('\n') {
            let note = "the last line has no line feed at its end; is the file cut off?";
            wanted.notes.insert(format!("{}: {note}", file.display()));
        }
        let read = parse(&file, text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        wanted.check(&read, &block, &contents, &|| text.clone());
    }
}

/// Keywords with entries of the input.
const CARDS: [&str; 17] = [
    "*TIE",
    "*COUPLING",
    "*KINEMATIC",
    "*DISTRIBUTING",
    "*KINEMATIC COUPLING",
    "*DISTRIBUTING COUPLING",
    "*RIGID BODY",
    "*MPC",
    "*EQUATION",
    "*MASS",
    "*ROTARY INERTIA",
    "*SPRING",
    "*DASHPOT",
    "*CONNECTOR SECTION",
    "*CONNECTOR BEHAVIOR",
    "*ORIENTATION",
    "*BOUNDARY",
];

/// A card with parameters and data of any kind, right or wrong.
fn card(choices: &mut Choices, block: &Block) -> Lines {
    let nodes = block.numbered(&block.end);
    let node = |choices: &mut Choices| match choices.below(4) {
        0 => "2001".to_string(),
        1 => "2002".to_string(),
        _ => choices.one(&nodes),
    };
    let mut parameters = Vec::new();
    for _ in 0..choices.below(4) {
        let key = choices.one(&[
            "REF NODE",
            "NSET",
            "ELSET",
            "SURFACE",
            "NAME",
            "CONSTRAINT NAME",
            "BEHAVIOR",
            "TYPE",
        ]);
        let value = match key {
            "REF NODE" => node(choices),
            "NSET" => choices.one(&["end", "none", "points"]).to_string(),
            "ELSET" => choices.one(&["lump", "left", "springs", "none"]).to_string(),
            "SURFACE" => choices.one(&["skin", "end-nodes", "none"]).to_string(),
            _ => choices.one(&["one", "Two", "end", "ISOTROPIC"]).to_string(),
        };
        parameters.push((key, value));
    }
    let name = choices.one(&CARDS);
    let parameters: Vec<(&str, &str)> =
        parameters.iter().map(|(key, value)| (*key, value.as_str())).collect();
    let mut lines = vec![keyword(choices, name, &parameters)];
    for _ in 0..choices.below(4) {
        let fields: Vec<String> = (0..1 + choices.below(5))
            .map(|_| match choices.below(6) {
                0 => node(choices),
                1 => choices.one(&["end", "points", "skin", "end-nodes", "none", ""]).to_string(),
                2 => choices.one(&["BEAM", "PIN", "TIE", "LINK", "HINGE", "JOIN", "SLOT", "one"]).to_string(),
                3 => choices.below(7).to_string(),
                _ => choices.one(&["1.5", "-1.", "0.D0", "1.E300", "nan", "x"]).to_string(),
            })
            .collect();
        lines.push(fields.join(", "));
    }
    lines
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn cards_of_any_form_leave_the_mesh_as_it_is(mut choices in choices()) {
        let choices = &mut choices;
        let block = Block::new(choices);
        let (body, contents) = body(choices, &block, 0, &mut Wanted::default());
        let mut lines: Lines = body.into_iter().flatten().collect();
        lines.extend(["*NODE, NSET=points", "2001, 20., 1., 2.", "2002, 30., 0., 0."].map(str::to_string));
        let [end, other] = [block.end[0], block.cells[0].1[0]].map(|point| block.numbers[point]);
        lines.push(format!("*ELEMENT, TYPE=SPRINGA, ELSET=springs\n801, {end}, {other}\n802, {end}, 2001"));
        lines.push("*ELEMENT, TYPE=CONN3D2, ELSET=springs\n803, 2001, 2002".to_string());
        lines.push("*SURFACE, NAME=end-nodes, TYPE=NODE".to_string());
        lines.push(end.to_string());
        for _ in 0..choices.below(12) {
            lines.extend(card(choices, &block));
        }
        let text = lines.join("\n") + "\n";
        let file = parse("a.inp".as_ref(), text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let read = Contents::of(&file.mesh);
        prop_assert_eq!((&read.nodes, &read.cells), (&contents.nodes, &contents.cells));
        let mut names = std::collections::HashSet::new();
        let own: Vec<&str> = file.entries.iter().map(|entry| entry.name.as_str()).collect();
        for entry in &file.entries {
            prop_assert!(names.insert(&entry.name), "{} twice\n{}", entry.name, text);
            for key in ["group", "follower", "leader"] {
                let group = entry.table.get(key).and_then(|group| group.as_str());
                let is_known = |group: &str| own.contains(&group) || file.mesh.group_nodes(group).is_ok();
                prop_assert!(group.is_none_or(is_known), "{group:?}\n{text}");
            }
            let weights = entry.table.get("weights").and_then(|weights| weights.as_array());
            let group = entry.table.get("leader").or(entry.table.get("group")).and_then(|group| group.as_str());
            if let (Some(weights), Some(group)) = (weights, group) {
                prop_assert_eq!(weights.len(), file.mesh.group_nodes(group).unwrap().len());
            }
        }
    }
}
