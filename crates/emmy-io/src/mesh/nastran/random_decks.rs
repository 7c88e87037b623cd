//! Random decks: whatever is between the lines of a mesh, every line is accounted for, and the mesh is the same.

use std::collections::BTreeMap;

use super::super::account::{Treatment, treatment};
use super::super::parse;
use super::TABLE;

/// Random numbers (Knuth's linear congruential generator).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) % n as u64) as usize
    }

    fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }
}

/// A card in one of the forms: free, small, with tabs, large.
fn written(random: &mut Random, name: &str, fields: &[String]) -> String {
    let form = random.below(if name.len() < 8 { 4 } else { 2 });
    let per_line = if form == 3 { 4 } else { 8 };
    let mark = format!("C{}", random.below(1000));
    let chunks: Vec<&[String]> = fields.chunks(per_line).collect();
    let mut text = String::new();
    for (index, chunk) in chunks.iter().enumerate() {
        let is_last = index + 1 == chunks.len();
        let next = if is_last { String::new() } else { format!("+{mark}{index}") };
        let own = format!("+{mark}{}", index.wrapping_sub(1));
        let blank = String::new();
        let all: Vec<&String> = (0..per_line).map(|field| chunk.get(field).unwrap_or(&blank)).collect();
        let first = if index == 0 { name } else { &own };
        let line = match form {
            0 => format!("{first},{},{next}", all.iter().map(|f| f.as_str()).collect::<Vec<_>>().join(",")),
            1 => format!("{first:<8}{}{next}", all.iter().map(|f| format!("{f:>8}")).collect::<String>()),
            2 => {
                format!("{first}\t{}\t{next}", all.iter().map(|f| f.as_str()).collect::<Vec<_>>().join("\t"))
            }
            _ => {
                let first = if index == 0 { format!("{name}*") } else { own.replace('+', "*") };
                let wide: String = all.iter().map(|f| format!("{f:<16}")).collect();
                format!("{first:<8}{wide}{}", next.replace('+', "*"))
            }
        };
        text += line.trim_end_matches([' ', '\t']);
        text += "\n";
    }
    text
}

/// Names of the table with a treatment.
fn names(of: Treatment) -> Vec<String> {
    let entries = TABLE.iter().filter(|entries| entries.treatment == of);
    let name = |name: &&str| name.strip_suffix('*').map_or(name.to_string(), |begin| format!("{begin}9"));
    entries.flat_map(|entries| entries.names.iter().map(name).collect::<Vec<_>>()).collect()
}

/// A row of hexahedra: cards with their fields.
fn row_of_cells(n: usize) -> Vec<(&'static str, Vec<String>)> {
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let grid = |x: usize, corner: usize| {
        let [y, z] = corners[corner];
        let number = 10 * x + corner + 1;
        [number.to_string(), String::new(), format!("{x}."), format!("{y}."), format!("{z}.")].to_vec()
    };
    let cell = |x: usize| {
        let nodes = (0..8).map(|corner| (10 * (x + corner / 4) + corner % 4 + 1).to_string());
        [(x + 1).to_string(), "3".to_string()].into_iter().chain(nodes).collect()
    };
    let grids = (0..=n).flat_map(|x| (0..4).map(move |corner| ("GRID", grid(x, corner))));
    grids.chain((0..n).map(|x| ("CHEXA", cell(x)))).collect()
}

/// Counts and names in a note that begins with a text.
fn counts(notes: &[String], begin: &str) -> BTreeMap<String, usize> {
    let list = notes.iter().find_map(|note| note.strip_prefix(begin)).unwrap_or_default();
    let entry = |text: &str| {
        let (count, name) = text.split_once(' ').unwrap();
        (name.to_string(), count.parse().unwrap())
    };
    list.split(", ").filter(|text| !text.is_empty()).map(entry).collect()
}

#[test]
fn every_line_is_accounted_for() {
    let [no_effect, left_out] = [Treatment::NoEffect, Treatment::LeftOut].map(names);
    for (name, expected) in [(&no_effect, Treatment::NoEffect), (&left_out, Treatment::LeftOut)] {
        name.iter().for_each(|name| assert_eq!(treatment(TABLE, name), Some(expected), "{name}"));
    }
    for seed in 0..400 {
        let random = &mut Random(seed);
        let n = 1 + random.below(6);
        let mut cards = row_of_cells(n);
        // A card may come in any order.
        for index in (1..cards.len()).rev() {
            cards.swap(index, random.below(index + 1));
        }
        // Few names, since a note does not list many.
        let few =
            |random: &mut Random, of: &[String]| (0..6).map(|_| random.one(of).clone()).collect::<Vec<_>>();
        let unknown: Vec<String> = (0..6).map(|i| format!("X{}Q{i}", random.below(9999))).collect();
        let kinds = [few(random, &no_effect), few(random, &left_out), unknown];
        let mut drawn = [BTreeMap::new(), BTreeMap::new(), BTreeMap::new()];
        let mut text =
            String::from(if random.below(2) == 0 { "SOL 101\nCEND\nLOAD = 2\nBEGIN BULK\n" } else { "" });
        for (name, fields) in &cards {
            while random.below(3) == 0 {
                let kind = random.below(4);
                if kind == 3 {
                    text += *random.one(&["$ a comment, GRID,1\n", "\n", "   \n"]);
                    continue;
                }
                let name = random.one(&kinds[kind]).clone();
                let fields: Vec<String> =
                    (0..1 + random.below(20)).map(|_| (1 + random.below(99)).to_string()).collect();
                text += &written(random, &name, &fields);
                *drawn[kind].entry(name).or_insert(0) += 1;
            }
            text += &written(random, name, fields);
        }
        let has_end = random.below(2) == 0;
        text += if has_end { "ENDDATA\n" } else { "" };
        let file = parse("a.bdf".as_ref(), text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let notes = &file.notes;
        let mesh = &file.mesh;
        assert_eq!((mesh.n_nodes(), mesh.n_cells()), (4 * (n + 1), n), "{text}");
        assert!((emmy::mesh::quality(mesh).volume - n as f64).abs() < 1e-12 * n as f64, "{text}");
        let left_out = counts(notes, "left out, though it may change the motion: ");
        assert_eq!(left_out, drawn[1], "{notes:?}\n{text}");
        assert_eq!(counts(notes, "not known, and left out: "), drawn[2], "{notes:?}\n{text}");
        assert_eq!(notes.iter().any(|note| note.contains("no ENDDATA")), !has_end);
        let n_notes =
            usize::from(!has_end) + usize::from(!drawn[1].is_empty()) + usize::from(!drawn[2].is_empty());
        // Groups of springs and dampers may have no node of a cell.
        let others = notes.iter().filter(|note| !note.starts_with("node group"));
        assert_eq!(others.count(), n_notes, "{notes:?}\n{text}");
    }
}

/// A name that is read must be known to the reader, and a refused one must be an error.
#[test]
fn the_reader_knows_every_name_of_its_table() {
    let nodes = "GRID,1\nGRID,2,,1.\nGRID,3,,,1.\nGRID,4,,,,1.\nCTETRA,99,1,1,2,3,4\n";
    for name in names(Treatment::Read) {
        let text = format!("{nodes}{name},x\nENDDATA\n");
        match (&*name, parse("a.bdf".as_ref(), text.as_bytes())) {
            (_, Err(error)) => assert!(error.to_string().starts_with("a.bdf, line 6: "), "{name}: {error}"),
            // GRDSET takes its fields from the second one; names of properties of lines are all that is read of them.
            ("GRDSET", Ok(_)) => {}
            (name, Ok(_)) => assert!(name.starts_with('P'), "{name}"),
        }
    }
    for name in names(Treatment::Refused) {
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
