//! All mistakes of an input are reported at once, in the order of the file.

use std::collections::BTreeMap;

use emmy_io::input::{self, Overrides};

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
[time]
scheme = "AS(2)"
steps = [{ until = 0.5, size = 0.1 }]
[initial]
group = "tip"                                           #! 1
[output]
probes = [{ name = "a", point = [0, 0, 0] }, { name = "a", point = [0, 2, 0] }] #! 1
"#,
];

/// Numbers of faults by their lines, in the order of the report.
fn lines_of_faults(text: &str) -> Vec<usize> {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("input.toml");
    std::fs::write(&file, text).unwrap();
    let error = input::read(&file, &Overrides::default()).unwrap_err();
    let line = |fault: &input::Fault| fault.place().unwrap_or_else(|| panic!("{fault}")).line();
    error.faults().iter().map(line).collect()
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

/// The key that a misspelt one is meant to be is not reported as missing, and neither is a table with faults.
#[test]
fn one_mistake_is_one_fault() {
    let good = "mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }\n[[region]]\ndensity = 1\n\
                material.neo-hooke = { lambda = 1, mu = 1 }\n[[load]]\ngroup = \"x-max\"\npressure = 1\n[[support]]\n\
                group = \"x-min\"\nfix = [\"x\"]\n[time]\nscheme = \"DGM\"\nsteps = [{ until = 1, size = 0.1 }]\n";
    for (key, other) in [
        ("density", "densty"),
        ("density", "rho"),
        ("pressure", "presure"),
        ("fix", "fixed"),
        ("neo-hooke", "neohook"),
        ("lambda = 1, mu", "lambda = 1, shear_modulus"),
        ("scheme", "shceme"),
        ("steps", "stpes"),
        ("mesh.box", "mesh.bocks"),
        ("[time]", "[tiem]"),
        ("size = 0.1", "dt = 0.1"),
        ("\"DGM\"", "3"),
        ("group = \"x-max\"", "grup = \"x-max\""),
    ] {
        let input = good.replacen(key, other, 1);
        assert!(input != good);
        assert_eq!(lines_of_faults(&input).len(), 1, "{other}");
    }
}
