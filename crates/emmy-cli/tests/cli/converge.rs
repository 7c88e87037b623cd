//! `emmy converge`: orders, columns, kept references, rejected options.

use super::{BOX, Outcome, Place};

/// A soft block that is stretched, sheared and rotated, so slowly that the steps resolve every mode.
const SOFT: &str = r#"
[mesh]
box = { size = [1, 2, 1], cells = [1, 2, 1] }

[[region]]
density = 1.0
material.neo-hooke = { lambda = 1.0, mu = 0.5 }

[initial]
angular_velocity = [0.2, 0.4, 0.6]
gradient = [[0.4, 0.1, 0.0], [0.0, -0.3, 0.2], [0.1, 0.0, 0.2]]

[time]
scheme = "DGM"
steps = [{ until = 0.2, size = 0.05 }, { until = 1.0, size = 0.1 }]

[newton]
tolerance = 1e-13

[output]
directory = "out"
"#;

/// Rows of `convergence.csv`, as text cells.
fn rows(place: &Place, directory: &str) -> Vec<Vec<String>> {
    let text = place.read(&format!("{directory}/convergence.csv"));
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("step_size,error,order,wall_seconds"));
    lines.map(|line| line.split(',').map(str::to_string).collect()).collect()
}

fn column(rows: &[Vec<String>], index: usize) -> Vec<f64> {
    rows.iter().map(|row| row[index].parse().unwrap()).collect()
}

fn converge(place: &Place, arguments: &[&str]) -> Outcome {
    place.succeed(&[&["converge", "box.toml", "--quiet"], arguments].concat())
}

#[test]
fn order_is_twice_the_degree() {
    for (degree, sizes, reference) in
        [("1", "0.1,0.05,0.025", "0.005"), ("2", "0.25,0.125,0.0625", "0.015625")]
    {
        let place = Place::with(SOFT);
        let degree_flag = format!("time.degree={degree}");
        let flags = ["--set", &degree_flag, "--sizes", sizes, "--reference", reference];
        let table = converge(&place, &flags).stdout;
        assert!(table.starts_with("step size") && table.lines().count() == 4, "{table}");
        let rows = rows(&place, "out-convergence");
        assert!(rows.iter().all(|row| row.len() == 4) && rows[0][2].is_empty());
        assert_eq!(rows[0][1].split(['.', 'e']).nth(1).unwrap().len(), 16, "17 digits");
        let expected = 2.0 * degree.parse::<f64>().unwrap();
        for order in column(&rows[1..], 2) {
            assert!((order - expected).abs() < 0.15, "degree {degree}: {order}");
        }
    }
}

#[test]
fn a_reference_of_higher_degree_gives_the_same_errors() {
    let place = Place::with(SOFT);
    let sizes = ["--sizes", "0.1,0.05"];
    converge(&place, &[&sizes[..], &["--reference", "0.0025", "--output", "fine"]].concat());
    let high = ["--reference", "0.05", "--reference-degree", "4", "--output", "high"];
    converge(&place, &[&sizes[..], &high].concat());
    // Of another scheme too: all converge to the same motion.
    let other = ["--reference-scheme", "FE(4)", "--reference-degree", "4", "--output", "other"];
    converge(&place, &[&sizes[..], &["--reference", "0.05"], &other].concat());
    let [fine, high, other] = ["fine", "high", "other"].map(|directory| column(&rows(&place, directory), 1));
    fine.iter().zip(&high).for_each(|(a, b)| assert!((a - b).abs() < 5e-3 * a, "{a} {b}"));
    high.iter().zip(&other).for_each(|(a, b)| assert!((a - b).abs() < 1e-6 * a, "{a} {b}"));
}

#[test]
fn results_do_not_depend_on_the_threads_and_the_shared_start() {
    let place = Place::with(SOFT);
    let flags = ["--sizes", "0.1,0.2,0.05", "--from", "0.2", "--window", "0.4,1", "--reference", "0.02"];
    for threads in ["1", "3"] {
        converge(&place, &[&flags[..], &["--threads", threads, "--output", threads]].concat());
    }
    let [one, three] = ["1", "3"].map(|directory| rows(&place, directory));
    assert_eq!(column(&one, 0), [0.1, 0.2, 0.05]);
    one.iter().zip(&three).for_each(|(a, b)| assert_eq!(a[..3], b[..3]));
    // Only the steps before --from come from the input.
    let before = [&flags[..], &["--output", "other", "--set", "time.steps.1.size=0.4"]].concat();
    converge(&place, &before);
    assert_eq!(column(&rows(&place, "other"), 1), column(&one, 1));
    converge(&place, &[&flags[..], &["--output", "third", "--set", "time.steps.0.size=0.1"]].concat());
    assert_ne!(column(&rows(&place, "third"), 1), column(&one, 1));
}

#[test]
fn times_inside_a_step_of_the_reference_are_interpolated_and_said() {
    let place = Place::with(SOFT);
    let flags = ["--sizes", "0.1,0.05", "--output"];
    let hit = converge(&place, &[&flags[..], &["hit", "--reference", "0.01"]].concat());
    assert_eq!(hit.stderr, "");
    let between = converge(&place, &[&flags[..], &["between", "--reference", "0.011"]].concat());
    assert!(between.stderr.contains("are interpolated"), "{}", between.stderr);
    let [hit, between] = ["hit", "between"].map(|directory| column(&rows(&place, directory), 1));
    hit.iter().zip(&between).for_each(|(a, b)| assert!((a - b).abs() < 2e-2 * a, "{a} {b}"));
}

#[test]
fn the_reference_is_kept_and_never_trusted_blindly() {
    let place = Place::with(SOFT);
    let study = |more: &[&str]| {
        let flags = ["--sizes", "0.1,0.05", "--reference", "0.01", "--output", "out", "--json"];
        let outcome = converge(&place, &[&flags[..], more].concat());
        let json: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
        (json["reference"]["kept"].as_bool().unwrap(), outcome.stderr, json)
    };
    let (kept, _, first) = study(&[]);
    assert!(!kept);
    let files = place.names("out/reference");
    assert_eq!(files.len(), 1);
    let file = format!("out/reference/{}", files[0]);
    let modified = || std::fs::metadata(place.path(&file)).unwrap().modified().unwrap();
    let before = modified();
    let (kept, _, second) = study(&["--set", "output.every=7"]);
    assert!(kept && modified() == before);
    let errors = |json: &serde_json::Value| [0, 1].map(|i| json["rows"][i]["error"].as_f64().unwrap());
    assert_eq!(errors(&first), errors(&second));
    // Fewer sizes are served by the same file.
    let some = converge(&place, &["--sizes", "0.1", "--reference", "0.01", "--output", "out", "--json"]);
    assert!(some.stdout.contains("\"kept\":true"), "{}", some.stdout);
    // A damaged result is computed again, with the same numbers.
    let mut bytes = std::fs::read(place.path(&file)).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(place.path(&file), bytes).unwrap();
    let (kept, said, third) = study(&[]);
    assert!(!kept && said.contains("is damaged"), "{said}");
    assert_eq!(errors(&first), errors(&third));
    assert!(study(&[]).0);
    // A change of the motion needs another reference.
    for more in [["--set", "region.0.density=1.5"], ["--set", "newton.tolerance=1e-12"], ["--to", "0.9"]] {
        assert!(!study(&more).0, "{more:?}");
    }
    assert_eq!(place.names("out/reference").len(), 4);
}

#[test]
fn pictures_and_input_stand_beside_the_table() {
    let place = Place::with(SOFT);
    let outcome = place.succeed(&["converge", "box.toml", "--sizes", "0.2,0.1"]);
    let files = ["convergence.csv", "convergence.png", "convergence.svg", "reference", "study.toml"];
    assert_eq!(place.names("out-convergence"), files);
    let svg = place.read("out-convergence/convergence.svg");
    assert!(svg.contains("DGM, degree 1") && svg.contains("order 2") && svg.contains("step size h"));
    for part in ["reference: step", "h = 0.1: error", "written: "] {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    assert!(outcome.stdout.contains("relative error"), "{}", outcome.stdout);
    place.succeed(&["check", "out-convergence/study.toml"]);
}

/// A clamped block under a sudden load, with few iterations allowed.
fn loaded(max_iterations: usize) -> Place {
    let input = BOX
        .replace("traction = [0.0, 0.0, 10.0]\nhistory = [[0.0, 0.0], [0.5, 1.0]]", "traction = [0, 0, 100]")
        .replace("max_iterations = 20", &format!("max_iterations = {max_iterations}"));
    Place::with(&input)
}

#[test]
fn a_member_that_does_not_converge_leaves_its_row_empty() {
    let place = loaded(3);
    let flags = ["--to", "0.2", "--sizes", "0.1,0.002,0.001", "--reference", "0.0005", "--quiet"];
    let outcome = place.emmy(&[&["converge", "box.toml"], &flags[..]].concat());
    assert_eq!(outcome.code, 3, "{}", outcome.stderr);
    for part in [
        "1 of 3 members did not converge",
        "h = 0.1: no convergence in step 1",
        "the other members are written",
    ] {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    let rows = rows(&place, "out-convergence");
    assert_eq!([&rows[0][1], &rows[0][2], &rows[1][2]], ["", "", ""]);
    assert!(column(&rows[2..], 2)[0] > 1.5 && column(&rows, 3).iter().all(|&seconds| seconds > 0.0));
    assert!(outcome.stdout.contains("no convergence"), "{}", outcome.stdout);
}

#[test]
fn a_reference_that_does_not_converge_ends_the_study() {
    let place = loaded(1);
    let outcome = place.emmy(&["converge", "box.toml", "--sizes", "0.02", "--quiet"]);
    assert_eq!(outcome.code, 3, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("the reference did not converge"), "{}", outcome.stderr);
    assert_eq!(place.names("out-convergence"), ["study.toml"]);
}

/// Arguments after `--sizes 0.2,0.1`, and the expected parts of the message.
const BAD: &[(&[&str], &[&str])] = &[
    (&["--sizes", "0"], &["--sizes", "positive"]),
    (&["--sizes=-0.1,0.2"], &["--sizes", "positive"]),
    (&["--sizes", "nan"], &["--sizes", "finite"]),
    (&["--sizes", "0.1,inf"], &["--sizes", "finite"]),
    (&["--sizes", "0.1,small"], &["--sizes", "small"]),
    (&["--sizes", ""], &["--sizes"]),
    (&["--sizes", "0.1,"], &["--sizes"]),
    (&["--sizes", "0.1,0.2,0.1"], &["--sizes", "twice"]),
    (&["--sizes", "1.5"], &["--sizes", "larger than the window", "1 long"]),
    (&["--sizes", "0.4", "--window", "0.5,0.8"], &["--sizes", "larger than the window"]),
    (&["--sizes", "1e-14"], &["--sizes", "more than 1e12 steps"]),
    (&["--sizes", "1e-9"], &["--sizes", "GB"]),
    (&[], &["--sizes"]),
    (&["--sizes", "0.2,0.1", "--reference", "0.1"], &["--reference", "smallest", "--reference-degree"]),
    (&["--sizes", "0.2,0.1", "--reference", "0"], &["--reference", "positive"]),
    (&["--sizes", "0.2,0.1", "--reference", "-0.01"], &["--reference", "positive"]),
    (&["--sizes", "0.2,0.1", "--reference", "nan"], &["--reference", "positive"]),
    (&["--sizes", "0.2,0.1", "--reference", "1e-14"], &["--reference", "more than 1e12 steps"]),
    (
        &["--sizes", "0.2,0.1", "--reference", "2", "--reference-degree", "3"],
        &["--reference 2", "the window"],
    ),
    (&["--sizes", "0.2,0.1", "--reference-scheme", "DMG"], &["--reference-scheme", "DMG", "DGM"]),
    (
        &["--sizes", "0.2,0.1", "--reference-scheme", "FE(1)", "--reference-degree", "2"],
        &["at least 2 points"],
    ),
    (&["--sizes", "0.2,0.1", "--reference-degree", "9"], &["--reference-degree 9", "between 1 and 8"]),
    (&["--sizes", "0.2,0.1", "--reference-degree", "0"], &["--reference-degree 0", "less than the degree 1"]),
    (
        &["--sizes", "0.1", "--set", "time.scheme=AS(2)", "--reference-degree", "3"],
        &["--reference-degree 3", "at least 3 points", "--reference"],
    ),
    (&["--sizes", "0.1", "--from", "1"], &["--from 1", "from t = 0 to t = 1"]),
    (&["--sizes", "0.1", "--from", "-1"], &["--from -1", "from t = 0 to t = 1"]),
    (&["--sizes", "0.1", "--from", "nan"], &["--from NaN"]),
    (&["--sizes", "0.1", "--to", "1.5"], &["--to 1.5", "from t = 0 to t = 1"]),
    (&["--sizes", "0.1", "--from", "0.5", "--to", "0.5"], &["--to 0.5", "after t = 0.5"]),
    (&["--sizes", "0.1", "--window", "0.5"], &["--window 0.5", "two times, not 1"]),
    (&["--sizes", "0.1", "--window", "0.5,0.2"], &["--window 0.5,0.2", "the earlier one first"]),
    (&["--sizes", "0.1", "--window", "0.5,2"], &["--window 0.5,2", "to t = 1"]),
    (&["--sizes", "0.1", "--from", "0.5", "--window", "0.2,1"], &["--window 0.2,1", "from t = 0.5"]),
    (&["--sizes", "0.1", "--window", "a,b"], &["--window"]),
    (&["--sizes", "0.1", "--set", "time.scheme=FE(0)"], &["not a scheme"]),
    (&["--sizes", "0.1", "--output", "box.toml"], &["box.toml is not a directory"]),
    (&["--sizes", "0.1", "--output", "."], &["no convergence study of Emmy", "box.toml"]),
];

#[test]
fn bad_arguments_end_with_2_and_write_nothing() {
    let place = Place::with(SOFT);
    for (arguments, says) in BAD {
        let outcome = place.emmy(&[&["converge", "box.toml", "--quiet"], *arguments].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{arguments:?}\n{}", outcome.stderr);
        says.iter().for_each(|part| assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr));
    }
    assert_eq!(place.names("."), ["box.toml"]);
}

#[test]
fn a_run_is_not_written_over() {
    let place = Place::with(SOFT);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let outcome = place.emmy(&["converge", "box.toml", "--sizes", "0.1", "--output", "out"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("--output"), "{}", outcome.stderr);
    assert!(!place.names("out").contains(&"study.toml".to_string()));
}

/// Fig. 13 of the paper: the large-strain block, which shares its state at t = 1.
#[test]
#[ignore = "half a minute; `.ci/run` and `just validate` run it"]
fn the_block_of_the_paper_converges_with_order_two() {
    let place = Place::new();
    place.succeed(&["new", "l-block"]);
    let flags = ["--sizes", "0.04,0.02,0.01", "--from", "1", "--to", "2", "--reference", "0.001"];
    place.succeed(&[&["converge", "l-block.toml", "--output", "study"], &flags[..]].concat());
    let orders = column(&rows(&place, "study")[1..], 2);
    println!("orders {orders:?}");
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.3), "{orders:?}");
}
