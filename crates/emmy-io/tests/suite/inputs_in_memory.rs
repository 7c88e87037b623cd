//! Inputs that a program builds: places are paths, a mesh and functions stand beside numbers, bodies are shared.

use std::sync::Arc;

use emmy::body::{Field, TimeFunction};
use emmy::mesh::{CellKind, Mesh, MeshBuilder};
use emmy_io::checkpoint::Identity;
use emmy_io::input::{self, Overrides, Place, Problem, Tree};
use emmy_io::results::Results;
use emmy_io::summary::Status;

fn table<const N: usize>(entries: [(&str, Tree); N]) -> Tree {
    Tree::Table(entries.into_iter().map(|(key, value)| (key.to_string(), value)).collect())
}

fn text(text: &str) -> Tree {
    Tree::Text(text.to_string())
}

fn numbers<const N: usize>(numbers: [f64; N]) -> Tree {
    Tree::List(numbers.map(Tree::Number).into())
}

fn rubber() -> Tree {
    table([("neo-hooke", table([("lambda", Tree::Number(1000.0)), ("mu", Tree::Number(500.0))]))])
}

fn steps(until: f64) -> Tree {
    let phase = table([("until", Tree::Number(until)), ("size", Tree::Number(0.1))]);
    table([("scheme", text("DGM")), ("steps", Tree::List(vec![phase]))])
}

/// A block with a load.
fn block(mesh: &Arc<Mesh>, load: Tree, time: Tree) -> Tree {
    let region = table([("density", Tree::Number(2.0)), ("material", rubber())]);
    table([
        ("mesh", Tree::Mesh(mesh.clone())),
        ("region", region),
        ("load", Tree::List(vec![load])),
        ("time", time),
    ])
}

fn pull(history: Tree) -> Tree {
    table([("group", text("x-max")), ("traction", numbers([0.0, 0.0, 3.0])), ("history", history)])
}

fn mesh() -> Arc<Mesh> {
    Arc::new(emmy::mesh::block([2.0, 1.0, 1.0], [2, 1, 1]).unwrap())
}

fn build(tree: &Tree, known: Option<&Problem>) -> Result<Problem, input::InputError> {
    input::build(tree, &Overrides::default(), known)
}

/// A history t by a function.
fn growing() -> Tree {
    Tree::TimeFunction(TimeFunction::of_times("<function growing>7", |times, values| {
        values.copy_from_slice(times)
    }))
}

#[test]
fn faults_have_paths_and_missing_groups() {
    let load = |group: &str| table([("group", text(group)), ("traction", numbers([0.0, 0.0, 1.0]))]);
    let error = build(&block(&mesh(), load("x-mux"), steps(1.0)), None).unwrap_err();
    let fault = &error.faults()[0];
    assert_eq!(fault.place().and_then(Place::path), Some("load[0].group"));
    assert_eq!(fault.suggestion(), Some("did you mean `x-max`?"));
    let missing = fault.missing_group().unwrap();
    assert!(missing.name == "x-mux" && missing.available.contains(&"x-max".to_string()));
    assert!(error.to_string().starts_with("load[0].group: the mesh has no group `x-mux`"), "{error}");

    let region = table([("density", Tree::Number(-1.0)), ("material", rubber())]);
    let two = table([("mesh", Tree::Mesh(mesh())), ("region", region), ("time", steps(-1.0))]);
    let faults = build(&two, None).unwrap_err();
    let paths: Vec<_> = faults.faults().iter().map(|fault| fault.place().and_then(Place::path)).collect();
    assert_eq!(paths, [Some("region.density"), Some("time.steps[0]")]);
}

#[test]
fn a_table_is_checked_alone() {
    let check = |section: &str, tree: Tree| input::check(section, &tree).map_err(|error| error.to_string());
    assert_eq!(check("material", rubber()), Ok(()));
    let bad = table([(
        "neo-hooke",
        table([("youngs_modulus", Tree::Number(1.0)), ("poissons_ratio", Tree::Number(0.5))]),
    )]);
    assert!(check("material", bad).unwrap_err().starts_with("neo-hooke.poissons_ratio: "));
    assert_eq!(check("support", table([("group", text("a")), ("spring", Tree::Number(2.0))])), Ok(()));
    let without_size = check("mass", table([("group", text("a"))])).unwrap_err();
    assert!(without_size.contains("`mass`") && without_size.contains("`total`"), "{without_size}");
    assert!(check("viscosity", table([("shear", Tree::Number(-1.0))])).unwrap_err().starts_with("shear: "));
    assert!(
        check("viscosity", table([])).unwrap_err().contains("needs at least one of `time`, `shear`, `bulk`")
    );
    assert!(check("adaptive", table([("tolerance", Tree::Number(0.0))])).is_err());
    assert!(check("meshes", Tree::Boolean(true)).unwrap_err().contains("not a section"));
}

/// A history by a function has the bits of the expression, and a field those of the vector.
#[test]
fn functions_stand_in_place_of_histories_and_vectors() {
    let mesh = mesh();
    let end = |load: Tree| {
        let problem = build(&block(&mesh, load, steps(1.0)), None).unwrap();
        let mut motion = problem.motion(&mut []).unwrap();
        motion.march(&problem.plan, &mut []).unwrap();
        motion.record().total_energy
    };
    let expected = end(pull(text("t")));
    // The momentum at t = 1 is 3/2, the mass 4: the energy of the centre of mass alone is p^2/(2 m).
    assert!(expected > 1.5 * 1.5 / 8.0);
    assert!((end(pull(growing())) / expected - 1.0).abs() < 1e-13);
    let field = Field::of_points("<function f>1", |_, t, values| values.fill([0.0, 0.0, 3.0 * t]));
    let by_field = table([("group", text("x-max")), ("traction", Tree::Field(field))]);
    assert!((end(by_field) / expected - 1.0).abs() < 1e-13);
}

#[test]
fn a_body_is_shared_by_problems_that_have_the_same() {
    let mesh = mesh();
    let first = build(&block(&mesh, pull(text("t")), steps(1.0)), None).unwrap();
    let is_shared = |other: &Problem| std::ptr::eq(first.body.mesh(), other.body.mesh());
    let longer = build(&block(&mesh, pull(text("t")), steps(3.0)), Some(&first)).unwrap();
    assert!(is_shared(&longer) && longer.plan.end() == 3.0);
    let other = build(&block(&mesh, pull(text("2*t")), steps(1.0)), Some(&first)).unwrap();
    assert!(!is_shared(&other));
    assert!(!is_shared(&build(&block(&mesh, pull(text("t")), steps(1.0)), None).unwrap()));
    // Numbers beside an expression differ in their last digits.
    let weight = |z: f64| {
        let components = Tree::List(vec![text("0*t"), Tree::Number(1.0), Tree::Number(z)]);
        table([("body_force", components)])
    };
    let first = build(&block(&mesh, weight(1.0000001), steps(1.0)), None).unwrap();
    let is_shared = |other: &Problem| std::ptr::eq(first.body.mesh(), other.body.mesh());
    assert!(is_shared(&build(&block(&mesh, weight(1.0000001), steps(2.0)), Some(&first)).unwrap()));
    assert!(!is_shared(&build(&block(&mesh, weight(1.0000002), steps(2.0)), Some(&first)).unwrap()));
}

/// A run with a mesh in memory writes it, and its input is read back as the same run; a function has no place in a
/// file.
#[test]
fn the_files_of_a_run_hold_its_mesh() {
    let temp = tempfile::tempdir().unwrap();
    let directory = temp.path().join("out");
    let mut builder = MeshBuilder::new();
    for x in [0.0, 1.0, 2.0] {
        builder.point([x, 0.0, 0.0]);
    }
    for link in [[0, 1], [1, 2]] {
        builder.cell(CellKind::Line2, &link).unwrap();
    }
    builder.cell_group("links", [0, 1]);
    builder.node_group("end", [2]);
    let network = Arc::new(builder.build().unwrap());
    let bar = table([("bar", table([("youngs_modulus", Tree::Number(10.0)), ("area", Tree::Number(1.0))]))]);
    let links = table([
        ("mesh", Tree::Mesh(network)),
        ("region", table([("density", Tree::Number(1.0)), ("material", bar)])),
        (
            "load",
            table([
                ("group", text("end")),
                ("nodal_force", numbers([1.0, 0.0, 0.0])),
                ("history", text("t")),
            ]),
        ),
        ("time", steps(0.2)),
    ]);
    for tree in [block(&mesh(), pull(text("t")), steps(0.2)), links] {
        let overrides = Overrides { output: Some(directory.clone()), ..Overrides::default() };
        let problem = input::build(&tree, &overrides, None).unwrap();
        let mut results = Results::create(&problem).unwrap();
        let mut motion = problem.motion(&mut []).unwrap();
        motion.march(&problem.plan, &mut [&mut results]).unwrap();
        assert!(results.finish(&problem, &motion, Status::Done, None).error.is_none());
        let read = input::read(&directory.join("input.toml"), &overrides).unwrap();
        assert_eq!(read.body.mesh(), problem.body.mesh());
        assert_eq!(Identity::new(&problem).check(&Identity::new(&read)), Ok(()));
    }
    let function =
        input::build(&block(&mesh(), pull(growing()), steps(0.2)), &Overrides::default(), None).unwrap();
    assert!(function.resolved.contains("history = \"<function growing>\""), "{}", function.resolved);
    std::fs::write(temp.path().join("mesh.vtu"), emmy_io::vtk::mesh_file(&mesh())).unwrap();
    std::fs::write(temp.path().join("input.toml"), &function.resolved).unwrap();
    let error = input::read(&temp.path().join("input.toml"), &Overrides::default()).unwrap_err().to_string();
    assert!(error.contains("a file cannot hold the function that a program gave here"), "{error}");
    for key in ["traction", "body_force", "acceleration"] {
        let text = function.resolved.replace("\"<function growing>\"", "\"t\"");
        let text = text.replace("traction = [0.0, 0.0, 3.0]", &format!("{key} = \"<function f>\""));
        let text = if key == "traction" { text } else { text.replace("group = \"x-max\"", "") };
        std::fs::write(temp.path().join("input.toml"), text).unwrap();
        let error =
            input::read(&temp.path().join("input.toml"), &Overrides::default()).unwrap_err().to_string();
        assert!(error.contains(&format!("`{key}`: a file cannot hold the function")), "{error}");
    }
    // A table has no name, and is written as it is.
    let table_of_time = TimeFunction::new(vec![(0.0, 0.0), (1.0, 2.0)]).unwrap();
    let table = block(&mesh(), pull(Tree::TimeFunction(table_of_time)), steps(0.2));
    let table = input::build(&table, &Overrides::default(), None).unwrap();
    std::fs::write(temp.path().join("input.toml"), &table.resolved).unwrap();
    let read = input::read(&temp.path().join("input.toml"), &Overrides::default()).unwrap();
    let force = |problem: &Problem| {
        let mut force = vec![0.0; problem.body.n_dofs()];
        problem.body.loads_at(0.75, &mut force).unwrap();
        force
    };
    assert_eq!(force(&read), force(&table));
    assert!(force(&read).iter().sum::<f64>() > 0.0);
}

#[test]
fn a_mesh_of_others_is_not_overwritten() {
    let temp = tempfile::tempdir().unwrap();
    let directory = temp.path().join("out");
    let overrides = Overrides { output: Some(directory.clone()), ..Overrides::default() };
    let problem = input::build(&block(&mesh(), pull(text("t")), steps(0.2)), &overrides, None).unwrap();
    drop(Results::create(&problem).unwrap());
    // A second run replaces its own mesh, but not one of another program.
    drop(Results::create(&problem).unwrap());
    std::fs::write(directory.join("mesh.vtu"), "mine").unwrap();
    assert!(Results::create(&problem).unwrap_err().to_string().contains("Emmy has not written"));
    assert_eq!(std::fs::read_to_string(directory.join("mesh.vtu")).unwrap(), "mine");
}
