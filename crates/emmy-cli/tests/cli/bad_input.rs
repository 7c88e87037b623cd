//! Bad inputs: exit code 2, the right line, the right words, and nothing written.

use super::{BOX, Place};

/// What is changed in [`BOX`], and what the message must say.
struct Case {
    from: &'static str,
    to: &'static str,
    says: &'static [&'static str],
}

const fn case(from: &'static str, to: &'static str, says: &'static [&'static str]) -> Case {
    Case { from, to, says }
}

const MATERIAL: &str = "material.neo-hooke = { lambda = 1000.0, mu = 500.0 }";
const STEPS: &str = "steps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]";
const TRACTION: &str = "traction = [0.0, 0.0, 10.0]";
const HISTORY: &str = "history = [[0.0, 0.0], [0.5, 1.0]]";
const MESH: &str = "box = { size = [1, 2, 1], cells = [1, 2, 1] }";
const FIX: &str = "fix = [\"x\", \"y\", \"z\"]";
const PROBES: &str = "probes = [{ name = \"tip\", point = [0, 2, 0] }]";

/// Faults on the line that was changed.
const CASES: &[Case] = &[
    // Keys that are not keys.
    case("title =", "titel =", &["unknown key `titel`", "did you mean `title`?"]),
    case(
        "density = 2.0",
        "densty = 2.0",
        &["unknown key `densty` in [[region]]", "did you mean `density`?", "`material`"],
    ),
    case("density = 2.0", "density = 2.0\nrho = 1.0", &["did you mean `density`?"]),
    case("group = \"body\"", "grupo = \"body\"", &["unknown key `grupo`"]),
    case("mu = 500.0", "mv = 500.0", &["unknown key `mv`", "did you mean `mu`?"]),
    case("scheme = \"AS(2)\"", "scheme = \"AS(2)\"\nevery = 2", &["`every` belongs in [output]"]),
    case("tolerance = 1e-10", "tol = 1e-10", &["unknown key `tol` in [newton]", "`tolerance`"]),
    case("max_iterations", "max-iterations", &["did you mean `max_iterations`?"]),
    case("[limits]", "[limit]", &["unknown key `limit`", "did you mean `limits`?"]),
    case("size = 0.1 }", "dt = 0.1 }", &["did you mean `size`?"]),
    case("point = [0, 2, 0]", "at = [0, 2, 0]", &["unknown key `at` in a probe"]),
    case("cells = [1, 2, 1]", "cels = [1, 2, 1]", &["did you mean `cells`?"]),
    // Kinds of values.
    case("density = 2.0", "density = \"2.0\"", &["`density` must be a number, not a string"]),
    case("density = 2.0", "density = nan", &["`density` must be a finite number"]),
    case("density = 2.0", "density = inf", &["`density` must be a finite number"]),
    case("density = 2.0", "density = 1e999", &["`density` must be a finite number"]),
    case("density = 2.0", "density = 99999999999999999999", &["too large"]),
    case("density = 2.0", "density = -2.0", &["`density` must be positive, not -2"]),
    case("density = 2.0", "density = 0", &["`density` must be positive"]),
    case("density = 2.0", "density = 2.0.1", &["not valid TOML"]),
    case("density = 2.0", "density = 2.0\ndensity = 2.0", &["duplicate key"]),
    case(TRACTION, "traction = [0.0, 1.0]", &["`traction` must have 3 numbers, not 2"]),
    case(TRACTION, "traction = [0.0, nan, 1.0]", &["finite"]),
    case(TRACTION, "traction = 1.0", &["`traction` must be a list of 3 numbers, not a number"]),
    case("degree = 1", "degree = 1.5", &["`degree` must be a whole number, not 1.5"]),
    case("degree = 1", "degree = 0", &["`degree` must be at least 1"]),
    case(
        "every = 2",
        "every = 2\nfields = [\"cauchy_stres\"]",
        &[
            "`cauchy_stres` is not a field; there is `displacement`, `velocity`",
            "did you mean `cauchy_stress`?",
        ],
    ),
    case("every = 2", "every = 2\nfields = \"velocity\"", &["`fields` must be a list of fields, such as"]),
    case(
        "every = 2",
        "every = 2\nfields = [\"velocity\", \"velocity\"]",
        &["the field `velocity` is there twice"],
    ),
    case(
        "every = 2",
        "every = 2\nformat = \"vtk\"",
        &["`vtk` is not a format of frames; there is `vtu`, `vtkhdf`", "did you mean `vtu`?"],
    ),
    case(
        "every = 2",
        "every = 2\nprecision = \"float\"",
        &["`float` is not a precision", "`double`, `single`"],
    ),
    case("every = 2", "every = -1", &["`every` must be at least 0"]),
    case("every = 2", "every = 2\ncheckpoint_every = 0.5", &["`checkpoint_every` must be a whole number"]),
    case("velocity = [0, 0, 0]", "velocity = [0, 0, \"fast\"]", &["must be a number, not a string"]),
    case(
        "velocity = [0, 0, 0]",
        "gradient = [[0, 0, 0], [0, 0, 0]]",
        &["`gradient` must have 3 rows, not 2"],
    ),
    // One of several.
    case(
        MESH,
        "l-block.cell_size = 1\nfile = \"a.msh\"",
        &["more than one source", "`l-block`, `box`, `rectangle`, `network`, `file`"],
    ),
    case(
        TRACTION,
        "traction = [0, 0, 1]\nforce = [0, 0, 1]",
        &["more than one kind of load", "`acceleration`"],
    ),
    case(TRACTION, "nodal_force = 10.0", &["`nodal_force` must be a list of 3 numbers, not a number"]),
    case(TRACTION, "pressure = [0, 0, 10]", &["`pressure` must be a number, not a list"]),
    case(TRACTION, "pressure = nan", &["`pressure` must be a finite number"]),
    case(TRACTION, "presure = 10", &["unknown key `presure` in [[load]]", "did you mean `pressure`?"]),
    case(
        TRACTION,
        "pressure = 10\ntraction = [0, 0, 1]",
        &["more than one kind of load", "`nodal_force`, `pressure`"],
    ),
    case(TRACTION, "point_force = [0, 0, 10]", &["did you mean `nodal_force`?"]),
    case(
        "group = \"y-max\"\ntraction",
        "group = \"y-mx\"\nnodal_force",
        &["no group `y-mx` of nodes, facets or cells", "did you mean `y-max`?"],
    ),
    case(MATERIAL, "material = {}", &["exactly one of `saint-venant-kirchhoff`, `neo-hooke`"]),
    case(MATERIAL, "material = \"neo-hooke\"", &["`material` must be a table"]),
    case(MATERIAL, "material.mooney = { mu = 1 }", &["unknown key `mooney`", "`neo-hooke`"]),
    case("mu = 500.0", "poissons_ratio = 0.3", &["exactly one pair"]),
    case(
        "lambda = 1000.0, mu",
        "mu",
        &["either `lambda` and `mu`, or `youngs_modulus` and `poissons_ratio`"],
    ),
    // Out of range.
    case("mu = 500.0", "mu = -500.0", &["mu = -500 must be positive"]),
    case(
        "lambda = 1000.0, mu = 500.0",
        "youngs_modulus = 1.0, poissons_ratio = 0.5",
        &["poissons_ratio = 0.5"],
    ),
    case("size = [1, 2, 1]", "size = [1, -2, 1]", &["`size` must be positive"]),
    case("cells = [1, 2, 1]", "cells = [1, 0, 1]", &["`cells` must be at least 1, not 0"]),
    case("cells = [1, 2, 1]", "cells = [100000, 100000, 1]", &["1.0e10 cells"]),
    case(MESH, "rectangle = { size = [1, 2, 1], cells = [1, 2] }", &["`size` must have 2 numbers, not 3"]),
    case(MESH, "rectangle = { size = [1, 0], cells = [1, 2] }", &["`size` must be positive"]),
    case(MESH, "rectangle = { size = [1, 1], cells = [1, 0] }", &["`cells` must be at least 1"]),
    case(
        MESH,
        "rectangle = { siez = [1, 1], cells = [1, 1] }",
        &["unknown key `siez` in rectangle", "`size`"],
    ),
    case(MESH, "rectangel = { size = [1, 1], cells = [1, 1] }", &["did you mean `rectangle`?"]),
    case("density = 2.0", "density = 2.0\nthickness = 0", &["`thickness` must be positive, not 0"]),
    case("density = 2.0", "density = 2.0\nthikness = 1", &["did you mean `thickness`?"]),
    case(MESH, "l-block = { cell_size = 0.3 }", &["1, 1/2, 1/3"]),
    case(MESH, "l-block = { cell_size = 1e-9 }", &["cells; the most is"]),
    case(MESH, "file = \"none.msh\"", &["none.msh"]),
    case("[[region]]", "scale = 0.0\n[[region]]", &["`scale` must be positive"]),
    case(HISTORY, "history = [[0.5, 0.0], [0.0, 1.0]]", &["times must not go back"]),
    case(HISTORY, "history = []", &["no entries"]),
    case(HISTORY, "history = [[0.5, 0.0, 1.0]]", &["must have 2 numbers"]),
    case(HISTORY, "history = 1.0", &["a list of [time, value] or an expression", "not a number"]),
    case(HISTORY, "history = \"\"", &["`history` must not be empty"]),
    case(HISTORY, "history = \"2 * sine(t)\"", &["`sine` is not known", "did you mean `sin`?", ":16"]),
    case(HISTORY, "history = \"sin(t\"", &["a `)` is missing"]),
    case(HISTORY, "history = \"2*x\"", &["`x` is not known", "`t`, `pi`, `e`, `sin`"]),
    case(HISTORY, "history = 'max(t, 1)'", &["`max` is not smooth", "table"]),
    case(HISTORY, "history = \"1/(t - 0.25)\"", &["not a finite number at t = 0.25", "inf"]),
    case(HISTORY, "history = \"sqrt(t)\"", &["the rate of `sqrt(t)` is not a finite number at t = 0"]),
    case("AS(2)", "as2", &["not a scheme", "did you mean \"AS(2)\"?", "DGM"]),
    case("AS(2)", "DMG", &["not a scheme", "did you mean \"DGM\"?"]),
    case("AS(2)", "leapfrog", &["not a scheme", "emmy list schemes"]),
    case(STEPS, "steps = []", &["`steps` is empty"]),
    case(
        STEPS,
        "steps = [{ until = 0.5, size = 0.1 }, { until = 0.2, size = 0.1 }]",
        &["phase 2 of `steps`", "time goes forward"],
    ),
    case(STEPS, "steps = [{ until = 1e300, size = 0.1 }]", &["phase 1 of `steps`", "until 1e300 are more"]),
    case("density = 2.0", "density = -1e300", &["not -1e300"]),
    case(STEPS, "steps = [{ until = 0.5, size = -0.1 }]", &["`size` must be positive"]),
    case(STEPS, "until = 0.5", &["`until` of [time] goes with `adaptive`"]),
    case(STEPS, "adaptive = { tolerance = 0 }\nuntil = 0.5", &["`tolerance` must be between 0 and 1, not 0"]),
    case(STEPS, "adaptive = { tolerance = -1e-3 }\nuntil = 0.5", &["`tolerance` must be between 0 and 1"]),
    case(
        STEPS,
        "adaptive = { tolerance = 1e-4, min_size = 0.2, max_size = 0.1 }\nuntil = 0.5",
        &["`min_size` 0.2 is larger than max_size = 0.1", "min_size = 0.2"],
    ),
    case(
        STEPS,
        "adaptive = { tolerance = 1e-4, first_size = 0.2, max_size = 0.1 }\nuntil = 0.5",
        &["`first_size` 0.2 is not between min_size and max_size"],
    ),
    case(STEPS, "adaptive = { tol = 1e-4 }\nuntil = 0.5", &["unknown key `tol`", "`tolerance`"]),
    case(
        STEPS,
        "adaptive = { tolerance = 1e-4 }\nuntil = -0.5",
        &["the run must end after t = 0", "not at -0.5"],
    ),
    case(
        STEPS,
        "adaptive = { tolerance = 1e-4 }\nuntil = 0.5\nsmallest_step = 0.1",
        &["`smallest_step` goes with `steps`"],
    ),
    case(
        "steps = [",
        "adaptive = { tolerance = 1e-4 }\nuntil = 0.5\nsteps = [",
        &["`adaptive` takes the place of `steps`", "this one", "and this one"],
    ),
    case("tolerance = 1e-10", "tolerance = 2", &["less than 1"]),
    case("max_iterations = 20", "max_iterations = 0", &["at least 1"]),
    case("kind = \"auto\"", "kind = \"pardiso\"", &["`pardiso` is not a solver", "`auto`"]),
    case("energy = 1e-2", "energy = -1", &["`energy` must be positive"]),
    case("directory = \"out\"", "directory = \"\"", &["must not be empty"]),
    // Names.
    case("group = \"y-max\"", "group = \"y-mx\"", &["no group `y-mx`", "did you mean `y-max`?", "`z-min`"]),
    case("group = \"y-max\"", "group = \"body\"", &["`body` is there, but has no facets"]),
    case("group = \"y-min\"", "group = \"floor\"", &["no group `floor`", "`y-min`"]),
    case("group = \"body\"", "group = \"bdy\"", &["did you mean `body`?"]),
    case("velocity = [0, 0, 0]", "group = \"tip\"", &["no group `tip`"]),
    case("fix = [\"x\", \"y\", \"z\"]", "fix = [\"x\", \"w\"]", &["`w` is not a component"]),
    case("fix = [\"x\", \"y\", \"z\"]", "fix = []", &["`fix` is empty"]),
    case(FIX, "fixed = [\"x\"]", &["unknown key `fixed`", "did you mean `fix`?"]),
    case(FIX, "move = { x = 1.0 }", &["`x` must be a list of [time, value] or an expression"]),
    case(FIX, "move = {}", &["`move` is empty"]),
    case(FIX, "move = { u = \"t\" }", &["unknown key `u` in move", "`x`, `y`, `z`"]),
    case(FIX, "move = { x = \"1 + t\" }", &["`x` is 1 at t = 0", "start from 0"]),
    case(FIX, "move = { x = \"t*\" }", &["`x`: the expression ends"]),
    case(FIX, "move = { y = [[0, 0], [1, 0], [1, 2]] }", &["`y`: a motion that jumps, at t = 1"]),
    case(FIX, "move = { y = \"t*ln(t)\" }", &["`y`", "not a finite number"]),
    case(FIX, "fix = [\"x\"]\nmove = { x = \"t\" }", &["`x` is both fixed and moved"]),
    case(FIX, "displacement = { x = \"t\" }", &["did you mean `move`?"]),
    case(FIX, "symmetry = 1", &["`symmetry` must be true or false"]),
    case(FIX, "symmetry = false", &["`symmetry` is true or left out"]),
    case(FIX, "symetry = true", &["did you mean `symmetry`?"]),
    case(FIX, "spring = 1.0\nuntil = 1.0", &["`until` does not go with `spring`"]),
    case(FIX, "fix = [\"x\"]\nuntil = 0.0", &["`until` must be positive"]),
    case(FIX, "fix = [\"x\"]\nuntill = 1.0", &["did you mean `until`?"]),
    case(FIX, "rotate = { angle = \"t\" }", &["`axis` is missing in rotate"]),
    case(FIX, "rotate = { axis = [0, 0, 1] }", &["`angle` is missing in rotate"]),
    case(FIX, "rotate = { axis = [0, 0, 0], angle = \"t\" }", &["`axis` of a rotation", "direction"]),
    case(FIX, "rotate = { axis = [0, 0, 1], center = [0, 0, 0], angle = \"t\" }", &["did you mean `about`?"]),
    case(FIX, "rotate = { axis = [0, 0, 1], angle = \"cos(t)\" }", &["`angle` is 1 at t = 0"]),
    case(FIX, "fix = [\"y\"]\nrotate = { axis = [0, 0, 1], angle = \"t\" }", &["all components"]),
    case(PROBES, "probes = [{ name = \"a,b\", point = [0, 0, 0] }]", &["letters, digits"]),
    case(PROBES, "probes = [{ name = \"linear_momentum\", point = [0, 0, 0] }]", &["already"]),
    case(
        PROBES,
        "probes = [{ name = \"a\", point = [0, 0, 0] }, { name = \"a\", point = [0, 2, 0] }]",
        &["two probes are named `a`"],
    ),
];

#[test]
fn every_fault_is_shown_on_its_line() {
    for Case { from, to, says } in CASES {
        assert!(BOX.contains(from), "{from}");
        let input = BOX.replacen(from, to, 1);
        let first = BOX.lines().zip(input.lines()).position(|(a, b)| a != b).unwrap() + 1;
        let last = first + to.matches('\n').count();
        let outcome = refused(&input, &["run", "box.toml"], says);
        let lines: Vec<String> = (first..=last).map(|line| format!("box.toml:{line}:")).collect();
        assert!(lines.iter().any(|line| outcome.contains(line)), "{to}: line {first}\n{outcome}");
    }
}

/// Sections and keys that are left out.
const MISSING: &[(&str, &[&str])] = &[
    ("[mesh]\nbox = { size = [1, 2, 1], cells = [1, 2, 1] }\n", &["box.toml", "`mesh` is missing"]),
    (
        "box = { size = [1, 2, 1], cells = [1, 2, 1] }\n",
        &["box.toml:3:", "exactly one of `l-block`, `box`, `rectangle`, `network`, `file`"],
    ),
    ("density = 2.0\n", &["box.toml:6:", "`density` is missing in [[region]]"]),
    ("material.neo-hooke = { lambda = 1000.0, mu = 500.0 }\n", &["box.toml:6:", "`material` is missing"]),
    ("group = \"y-max\"\n", &["box.toml:11:", "`group` is missing in [[load]]"]),
    (
        "traction = [0.0, 0.0, 10.0]\n",
        &["box.toml:11:", "`traction`, `force`, `nodal_force`, `pressure`, `acceleration`, `attraction`"],
    ),
    (
        "fix = [\"x\", \"y\", \"z\"]\n",
        &["box.toml:16:", "at least one of `fix`, `move`, `rotate`, `symmetry`, `spring`"],
    ),
    ("scheme = \"AS(2)\"\n", &["box.toml:23:", "`scheme` is missing in [time]"]),
    (", size = 0.1", &["box.toml:26:", "`size` is missing"]),
    ("name = \"tip\", ", &["box.toml:38:", "`name` is missing in a probe"]),
    ("kind = \"auto\"\n", &["box.toml:32:", "`kind` is missing in [solver]"]),
];

#[test]
fn what_is_missing_is_named_where_it_should_be() {
    for (part, says) in MISSING {
        assert!(BOX.contains(part), "{part}");
        refused(&BOX.replacen(part, "", 1), &["run", "box.toml"], says);
    }
    refused("", &["run", "box.toml"], &["`mesh` is missing", "`region` is missing", "`time` is missing"]);
    refused("region = []\n", &["run", "box.toml"], &["at least one region"]);
}

#[test]
fn thickness_belongs_to_plane_cells() {
    let thick = BOX.replacen("density = 2.0", "density = 2.0\nthickness = 0.5", 1);
    refused(&thick, &["run", "box.toml"], &["box.toml:6:", "this region has none", "leave `thickness` out"]);
}

#[test]
fn regions_must_cover_the_cells_once() {
    let second = "[[region]]\ngroup = \"body\"\ndensity = 1.0\nmaterial.neo-hooke = { lambda = 1.0, mu = 1.0 }\n\n[[load]]";
    let twice = BOX.replacen("[[load]]", second, 1);
    refused(&twice, &["run", "box.toml"], &["cell 0 belongs to two regions", "first", "second"]);
    let without_group = twice.replacen("group = \"body\"\n", "", 1);
    refused(&without_group, &["run", "box.toml"], &["only where there is one region"]);
}

#[test]
fn supports_must_agree_with_each_other_and_with_the_scheme() {
    let moved = BOX.replacen(FIX, "move = { x = \"t\" }", 1);
    let beside = "[[support]]\ngroup = \"x-min\"\nfix = [\"x\"]\n\n[initial]";
    let twice = moved.replacen("[initial]", beside, 1);
    refused(
        &twice,
        &["run", "box.toml"],
        &["`x` of the node at [0, 0, 0]", "two supports", "first", "second"],
    );
    let plane = "rectangle = { size = [1, 2], cells = [1, 2] }";
    let plane = BOX.replacen(MESH, plane, 1).replacen(FIX, "rotate = { axis = [0, 1, 0], angle = \"t\" }", 1);
    refused(&plane, &["run", "box.toml"], &["box.toml:17:", "plane cells stay in their plane"]);
    let classic = moved.replacen("AS(2)", "Bathe", 1);
    refused(&classic, &["run", "box.toml"], &["Bathe cannot move a support", "time elements only", "DGM"]);
}

#[test]
fn oblique_planes_of_symmetry_are_refused() {
    let input = BOX.replacen(MESH, "file = \"tet.inp\"", 1).replacen(FIX, "symmetry = true", 1);
    let load = input.find("[[load]]").unwrap()..input.find("[[support]]").unwrap();
    let input = input.replace(&input[load], "").replace("y-min", "slope");
    let deck = "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n\
                *Surface, name=slope\n1, S3\n*Surface, name=floor\n1, S1\n";
    let place = Place::with(&input);
    place.write("tet.inp", deck);
    let outcome = place.emmy(&["check", "box.toml"]);
    assert_eq!(outcome.code, 2);
    for part in ["box.toml:12:", "normal to the x, y or z axis", "oblique planes are not supported"] {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    place.write("box.toml", &input.replace("slope", "floor"));
    let report = place.emmy(&["check", "box.toml"]);
    assert!(
        report.stdout.contains("floor: z fixed, 3 degrees of freedom"),
        "{} {}",
        report.stdout,
        report.stderr
    );
}

#[test]
fn flags_are_named_in_their_faults() {
    for (flags, says) in [
        (&["--set", "time.shceme=DGM"][..], &["--set", "unknown key `shceme`", "did you mean `scheme`?"][..]),
        (&["--set", "time.scheme=DGX"], &["--set", "not a scheme"]),
        (&["--set", "load.1.traction=[1,2,3]"], &["--set", "the list has 1"]),
        (&["--set", "load.0.traction=[1,2]"], &["--set", "must have 3 numbers"]),
        (&["--set", "load.0.traction=[1,2,"], &["--set", "not valid TOML: unclosed array"]),
        (&["--set", "title"], &["--set title", "no `=`"]),
        (&["--set", "title.x=1"], &["--set", "`title` is a string, in which there is nothing to set"]),
        (&["--set", "newton.tolerance=nan"], &["--set", "finite"]),
        (&["--until", "0"], &["--until 0"]),
        (&["--until", "-1"], &["--until -1"]),
        (&["--until", "nan"], &["--until NaN"]),
    ] {
        let arguments = [&["run", "box.toml"], flags].concat();
        refused(BOX, &arguments, says);
    }
}

#[test]
fn all_faults_are_shown_at_once() {
    let input = BOX.replace("density", "densty").replace("y-max", "y-mux").replace("AS(2)", "AS(0)");
    refused(&input, &["check", "box.toml"], &["densty", "y-mux", "AS(0)", "3 faults"]);
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    let place = Place::new();
    std::fs::write(place.path("box.toml"), b"title = \"a\"\n\xff\xfe").unwrap();
    let outcome = place.emmy(&["run", "box.toml"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("box.toml:2: the file is not UTF-8"), "{}", outcome.stderr);
}

#[test]
fn an_inverted_cell_is_named_with_its_file_and_a_remedy() {
    let input = BOX.replacen(MESH, "file = \"tet.inp\"", 1).replace("y-min", "body");
    let load = input.find("[[load]]").unwrap()..input.find("[[support]]").unwrap();
    let place = Place::with(&input.replace(&input[load], ""));
    // The second cell has two nodes in each other's place.
    let deck = "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,0,0,-1\n\
                *Element, type=C3D4, elset=body\n1, 1,2,3,4\n2, 1,2,3,5\n";
    place.write("tet.inp", deck);
    let outcome = place.emmy(&["check", "box.toml"]);
    assert_eq!(outcome.code, 2);
    for part in ["tet.inp: element 2 (tet4) is inverted", "orientation"] {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
}

/// Runs a bad input and returns the message.
fn refused(input: &str, arguments: &[&str], says: &[&str]) -> String {
    let place = Place::with(input);
    let outcome = place.emmy(arguments);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{input}\n{}", outcome.stderr);
    for part in says {
        assert!(outcome.stderr.contains(part), "\"{part}\" is not in\n{}", outcome.stderr);
    }
    assert_eq!(place.names("."), ["box.toml"], "{input}");
    outcome.stderr
}
