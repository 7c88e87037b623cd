//! All mistakes of an input are reported at once, in the order of the file.

use std::collections::BTreeMap;

use emmy_io::input::{self, Fault, Overrides};

/// Inputs with a mark on each line with mistakes: their number. Kinds, ranges, words, unknown and missing keys, rules
/// and meaning; several in one table, several in one list of tables.
const INPUTS: [&str; 2] = [
    r#"title = 3                                               #! 1
units.system = "mm-t-z"                                 #! 1
[mesh]
box = { size = [1, 2, 1], cells = [1, 2, 1] }
[[region]]
group = "body"
densty = 2.0                                            #! 1
material.neo-hooke = { lambda = "1000", mu = -500.0 }   #! 2
viscosity = { bulk = 0, shear = [1] }                   #! 2
[[load]]
group = "y-mux"                                         #! 1
traction = [0, 0, 10]
[[load]]
group = "y-max"
traction = [0, 0]                                       #! 1
history = 7                                             #! 1
[[load]]                                                #! 1
pressure = 10
[[load]]
group = "y-max"
pressure = 10
history = "2*sine(t)"                                   #! 1
[[support]]
group = "y-min"
fix = ["x", "w", 3]                                     #! 2
until = -1                                              #! 1
[[support]]
group = "y-min"
fix = ["x"]                                             #! 1
move = { x = "t" }
[[mass]]                                                #! 1
group = "body"
[initial]
velocity = [0, 0, "fast"]                               #! 1
[time]
scheme = "AS2"                                          #! 1
degree = 9                                              #! 1
steps = [{ until = 0.5, size = 0 }, { untill = 1, size = 0.1 }] #! 2
[newton]
tolerance = 2                                           #! 1
max_iterations = 2.5                                    #! 1
[solver]
kind = "pardiso"                                        #! 1
[output]
every = -1                                              #! 1
fields = ["velocity", "velocity"]                       #! 1
probes = [{ name = "a,b", point = [0, 0, 0] }]          #! 1
[limits]
energi = 1                                              #! 1
"#,
    // Faults of meaning alone, in sound tables.
    r#"
[mesh]
box = { size = [1, 2, 1], cells = [1, 2, 1] }
[[region]]
group = "bdy"                                           #! 1
density = 2.0
material.neo-hooke = { lambda = 1000.0, mu = 500.0 }
[[region]]
density = 1.0
material.ogden = { mu = [1, 2], alpha = [2], bulk_modulus = 9 } #! 1
pressure = "linear"                                     #! 1
[[load]]
group = "y-max"
pressure = 1
history = "1/(t - 0.25)"                                #! 1
[[load]]
body_force = [0, "x +", 0]                              #! 1
[[load]]
drag = 0.5
history = "t"                                           #! 1
[[support]]
group = "y-min"
fix = ["x"]                                             #! 1
move = { x = "t" }
[[support]]
group = "x-min"
rotate = { axis = [0, 0, 0], angle = "t" }              #! 1
[[support]]
group = "floor"                                         #! 1
fix = ["x"]
[[support]]
group = "y-max"
move = { x = "x +", y = "1 + t" }                       #! 2
spring = 1
until = 0.25                                            #! 1
[time]
scheme = "AS(2)"
steps = [{ until = 0.5, size = 0.1 }]
[initial]
group = "tip"                                           #! 1
[output]
probes = [{ name = "a", point = [0, 0, 0] }, { name = "a", point = [0, 2, 0] }] #! 1
values = [{ name = "b", quantity = "cauchy_stress", measure = "max" }]          #! 1
"#,
];

/// The faults of an input beside a mesh of one rope, with flags `--set`.
fn faults(text: &str, flags: &[&str]) -> Vec<Fault> {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("input.toml");
    std::fs::write(&file, text).unwrap();
    std::fs::write(directory.path().join("rope.inp"), ROPE).unwrap();
    let set = flags.iter().map(|flag| flag.to_string()).collect();
    let error = input::read(&file, &Overrides { set, ..Default::default() }).unwrap_err();
    error.faults().to_vec()
}

const ROPE: &str = "*Node\n1, 0.0, 0.0, 0.0\n2, 1.0, 0.0, 0.0\n*Element, type=T3D2, elset=rope\n1, 1, 2\n";

/// Numbers of faults by their lines, in the order of the report.
fn lines_of_faults(text: &str) -> Vec<usize> {
    let line = |fault: &Fault| fault.place().unwrap_or_else(|| panic!("{fault}")).line();
    faults(text, &[]).iter().map(line).collect()
}

fn counted(lines: &[usize]) -> BTreeMap<usize, usize> {
    let mut counts = BTreeMap::new();
    lines.iter().for_each(|line| *counts.entry(*line).or_default() += 1);
    counts
}

#[test]
fn every_mistake_of_a_file_is_reported_at_once() {
    for input in INPUTS {
        let lines = input.lines().enumerate();
        let marked = lines.filter_map(|(i, line)| Some((i + 1, line.split_once("#! ")?.1.parse().unwrap())));
        let marked: BTreeMap<usize, usize> = marked.collect();
        assert!(marked.values().sum::<usize>() >= 10);
        let found = lines_of_faults(input);
        assert_eq!(counted(&found), marked);
        assert!(found.is_sorted());
    }
}

const GOOD: &str = "mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }\n[[region]]\ndensity = 1\n\
                    material.neo-hooke = { lambda = 1, mu = 1 }\n[[load]]\ngroup = \"x-max\"\npressure = 1\n\
                    [[support]]\ngroup = \"x-min\"\nfix = [\"x\"]\n[time]\nscheme = \"DGM\"\n\
                    steps = [{ until = 1, size = 0.1 }]\n";

/// [`GOOD`] with a change, and the messages and advice of its faults.
fn changed(from: &str, to: &str) -> Vec<(String, Option<String>)> {
    let input = GOOD.replacen(from, to, 1);
    assert!(input != GOOD, "{from}");
    let advice = |fault: &Fault| fault.advice().map(str::to_string);
    faults(&input, &[]).iter().map(|fault| (fault.to_string(), advice(fault))).collect()
}

/// The key that a misspelt one is meant to be is not reported as missing, and neither is a table with faults.
#[test]
fn one_mistake_is_one_fault() {
    for (key, other) in [
        ("density", "densty"),
        ("density", "rho"),
        ("pressure", "presure"),
        ("fix", "fixed"),
        ("neo-hooke", "neohook"),
        ("lambda = 1, mu", "lambda = 1, shear_modul"),
        ("scheme", "shceme"),
        ("steps", "stpes"),
        ("mesh.box", "mesh.bocks"),
        ("[time]", "[tiem]"),
        ("size = 0.1", "dt = 0.1"),
        ("\"DGM\"", "3"),
        ("group = \"x-max\"", "grup = \"x-max\""),
        ("density = 1\nmaterial.neo-hooke", "material.neo_hooke"),
        ("density = 1\nmaterial", "materil"),
        ("[[support]]\ngroup = \"x-min\"\nfix", "[[support]]\ngroup = \"floor\"\nspring = 1\nfix"),
        ("[time]", "region = [1, 2, 3]\n[time]"),
        // A misspelt material may have no mass.
        ("density = 1\nmaterial.neo-hooke = { lambda = 1, mu = 1 }", "material.sprng = { stiffness = 2 }"),
        ("density = 1\nmaterial.neo-hooke = { lambda = 1, mu = 1 }", "material.atraction = { strength = 1 }"),
        ("density = 1\nmaterial.neo-hooke = { lambda = 1, mu = 1 }", "mterial.spring = { stiffness = 2 }"),
        ("[time]", "[units]\nlength = \"mm\"\n[time]"),
        ("[\"x\"]", "[\"x\", \"y\", \"x\"]"),
        // A support without a group that can be read may be the one of a reaction.
        (
            "group = \"x-min\"\nfix = [\"x\"]",
            "grup = \"x-min\"\nfix = [\"x\"]\n[output]\nreactions = [\"x-min\"]",
        ),
        (
            "[[support]]\ngroup = \"x-min\"\nfix = [\"x\"]",
            "[[suport]]\ngroup = \"x-min\"\nfix = [\"x\"]\n[output]\nreactions = [\"x-min\"]",
        ),
    ] {
        let changed = changed(key, other);
        assert_eq!(changed.len(), 1, "{other}: {changed:?}");
    }
}

/// A start with a fault is neither the undeformed body nor an equilibrium, so that nothing follows from it.
#[test]
fn a_faulty_start_has_no_further_faults() {
    let moved = GOOD.replacen("fix = [\"x\"]", "move = { x = \"cos(t)\" }", 1);
    assert_eq!(faults(&moved, &[]).len(), 1);
    for start in [
        "[initial]\nstate = 3\n",
        "[equilibrium]\nload_steps = 0\n",
        "[equilibrium]\nload_steps = \"abc\"\n",
        "[equilibrium]\nload_seps = 5\n",
        "[equiibrium]\nload_steps = 5\n",
        "[inital]\nstate = \"another-run\"\n",
    ] {
        assert_eq!(faults(&(moved.clone() + start), &[]).len(), 1, "{start}");
    }
    let (body, _) = GOOD.split_once("[time]").unwrap();
    for velocity in ["", "[initial]\nvelocity = [1, 0, 0]\n"] {
        let alone = format!("{body}{velocity}[equilibrium]\nload_steps = 0\n");
        assert_eq!(faults(&alone, &[]).len(), 1, "{velocity}");
    }
}

/// Lines of a mesh file are cells if a region of links has their group, even if the region has a fault.
#[test]
fn a_faulty_region_of_links_keeps_its_cells() {
    for material in ["bar = { youngs_modulus = -1, area = 1 }", "barr = { youngs_modulus = 1, area = 1 }"] {
        let input = format!(
            "mesh.file = \"rope.inp\"\n[[region]]\ngroup = \"rope\"\ndensity = 1\nmaterial.{material}\n[[load]]\n\
             group = \"rope\"\nacceleration = [0, 0, 1]\n[time]\nscheme = \"DGM\"\nsteps = [{{ until = 1, size = 0.1 }}]\n"
        );
        let faults = faults(&input, &[]);
        assert_eq!(faults.len(), 1, "{faults:?}");
        assert_eq!(faults[0].place().unwrap().line(), 5);
    }
}

/// An entry in place of a list has this advice, and a place that is the whole value.
#[test]
fn an_entry_alone_needs_brackets() {
    let hgo = "holzapfel-gasser-ogden = { mu = 1, bulk_modulus = 1, k1 = 1, k2 = 1, fibres = [1, 1, 0] }";
    for (from, to, message) in [
        ("[{ until = 1, size = 0.1 }]", "{ until = 1, size = 0 }", "`steps` must be a list, not a table"),
        ("pressure = 1", "pressure = 1\nhistory = [0, 1]", "such as \"sin(2*pi*t)\", not a single entry"),
        ("neo-hooke = { lambda = 1, mu = 1 }", hgo, "a list of lists of 3 numbers, not a single entry"),
    ] {
        let all = changed(from, to);
        let [(text, advice)] = &all[..] else { panic!("{all:?}") };
        assert!(text.contains(message), "{text}");
        assert_eq!(advice.as_deref(), Some("put square brackets around it"), "{text}");
        let input = GOOD.replacen(from, to, 1);
        let place = faults(&input, &[])[0].place().unwrap().clone();
        let line = input.lines().nth(place.line() - 1).unwrap();
        assert!(line[place.column() - 1..].starts_with(['[', '{', '"']), "{line}");
        assert!(line[..place.column() - 1].ends_with(" = "), "{line}");
    }
}

/// Unknown groups are reported at once, each at its name, beside other faults of the same table.
#[test]
fn unknown_groups_of_the_whole_input_are_reported_at_once() {
    let text = r#"mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }
[[region]]
density = 1
material.neo-hooke = { lambda = 1, mu = 1 }
[[load]]
group = "x-mx"
history = "t +"
pressure = 1
[[support]]
group = "floor"
fix = ["x"]
[output]
reactions = [
"floor",
"flor",
"x-min",
]
[[output.probes]]
name = "a"
point = [0, 0, 0]
group = "bdy"
[[output.probes]]
name = "b"
point = [0, 0, 0]
group = "x-min"
[[output.values]]
name = "c"
quantity = "velocity"
group = "y-mx"
[[output.values]]
name = "d"
quantity = "velocity"
group = "y-max"
[time]
scheme = "DGM"
steps = [{ until = 1, size = 0.1 }]
"#;
    assert_eq!(lines_of_faults(text), [6, 7, 10, 15, 16, 21, 25, 29]);
    // The groups of `[output]` alone.
    let text = text.replacen("x-mx", "x-max", 1).replacen("t +", "t", 1).replace("floor", "y-min");
    assert_eq!(lines_of_faults(&text), [15, 16, 21, 25, 29]);
    let text = text.replacen("\"flor\",\n\"x-min\",", "\n", 1);
    assert_eq!(lines_of_faults(&text), [21, 25, 29]);
    // Fields that the body does not have.
    let input = format!(
        "{GOOD}[output]\nextremes = [\"axial_force\"]\n[[output.values]]\nname = \"a\"\nquantity = \"axial_force\""
    );
    assert_eq!(faults(&input, &[]).len(), 2);
}

/// Different mistakes in all entries of a list are different faults; the same mistake in all of them is one.
#[test]
fn entries_of_a_list_have_their_own_faults() {
    let size = |size: &str| changed("size = [1, 1, 1]", &format!("size = {size}")).len();
    assert_eq!(size("[0, \"a\", -1]"), 3);
    assert_eq!(size("[-1, -1, -1]"), 1);
    assert_eq!(size("[-1, -1, 1]"), 2);
    // The last of 101 entries is right.
    let entries = format!("[{}[9, 9]]", "[0], ".repeat(100));
    assert_eq!(changed("pressure = 1", &format!("pressure = 1\nhistory = {entries}")).len(), 100);
    assert_eq!(changed("[{ until = 1, size = 0.1 }]", "[{ until = 1 }, { until = 2 }]").len(), 2);
}

/// Squares of such numbers are infinite, wherever they stand.
#[test]
fn numbers_beyond_all_use_are_rejected() {
    for (from, to) in [
        ("fix = [\"x\"]", "spring = 1e200"),
        ("pressure = 1", "traction = [0, 0, 1e200]"),
        ("pressure = 1", "pressure = 1\nhistory = [[0, 0], [1, -1e200]]"),
        ("group = \"x-max\"\npressure = 1", "attraction = { centre = [0, 0, 9], strength = 1e200 }"),
        ("neo-hooke = { lambda = 1, mu = 1 }", "ogden = { mu = [1e200], alpha = [2], bulk_modulus = 1 }"),
        ("mu = 1", "mu = 1e200"),
    ] {
        let all = changed(from, to);
        assert!(all.len() == 1 && all[0].0.contains("must not be beyond 1e150"), "{to}: {all:?}");
    }
}

/// The name of a program's function stands in files only where a program may give one.
#[test]
fn only_functions_are_those_of_a_program() {
    let traction = changed("pressure = 1", "traction = \"<function f>\"");
    assert!(traction[0].0.contains("a file cannot hold the function"), "{traction:?}");
    let force = changed("pressure = 1", "force = \"<function f>\"");
    assert!(force[0].0.contains("`force` must be a list of 3 numbers, not a string"), "{force:?}");
}

#[test]
fn faults_of_flags_have_their_order() {
    let flags = ["time.scheme=DGX", "newton.tolerance=2", "time.degree=none"];
    let faults = faults(&GOOD.replacen("pressure = 1", "pressure = \"a\"", 1), &flags);
    let sources: Vec<&str> = faults.iter().map(|fault| fault.place().unwrap().source_name()).collect();
    assert!(
        sources[..3].iter().all(|name| *name == "--set") && sources[3].ends_with("input.toml"),
        "{sources:?}"
    );
    let keys = ["DGX", "`tolerance`", "`degree`", "`pressure`"];
    assert!(faults.iter().zip(keys).all(|(fault, key)| fault.message().contains(key)), "{faults:?}");
}
