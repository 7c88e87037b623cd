//! Names that denote cells and facets at once.

use emmy_io::input::{self, Overrides, Problem};

/// Two cubes along x: the volumes `left` and `right`, the surface `left` at x = 0, and `between` at x = 1.
const BAR: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n3 1 \"left\"\n3 2 \"right\"\n2 3 \"left\"\n2 4 \"between\"
$EndPhysicalNames\n$Nodes\n12\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 2 0 0\n10 2 1 0
11 2 0 1\n12 2 1 1\n$EndNodes\n$Elements\n4\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 5 2 2 2 2 9 10 3 6 11 12 7\n3 3 2 3 3 1 4 8 5
4 3 2 4 4 2 3 7 6\n$EndElements\n";

/// The problem with more entries of its input.
fn problem(more: &str) -> Result<Problem, String> {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("bar.msh"), BAR).unwrap();
    let text = format!(
        "[mesh]\nfile = \"bar.msh\"\n[[region]]\ndensity = 1.0\nmaterial.neo-hooke = {{ youngs_modulus = 1000.0, \
         poissons_ratio = 0.3 }}\n{more}\n[time]\nscheme = \"DGM\"\nsteps = [{{ until = 1.0, size = 0.1 }}]\n"
    );
    let path = directory.path().join("input.toml");
    std::fs::write(&path, text).unwrap();
    input::read(&path, &Overrides::default()).map_err(|error| {
        let near: Vec<&str> = error.faults().iter().filter_map(|fault| fault.suggestion()).collect();
        format!("{error}; {}", near.join("; "))
    })
}

fn fixed(group: &str) -> (usize, Vec<String>) {
    let support = format!("[[support]]\ngroup = \"{group}\"\nfix = [\"x\", \"y\", \"z\"]");
    let problem = problem(&support).unwrap();
    (problem.body.n_dofs() - problem.body.n_free_dofs(), problem.notes)
}

#[test]
fn a_support_means_the_facets_and_says_how_to_choose() {
    // Four nodes of the face, eight of the cube.
    let (n_fixed, notes) = fixed("left");
    assert_eq!(n_fixed, 12);
    let note =
        "`left` is a group of facets and of cells: support means the facets; `cells:left` would be the cells";
    assert!(notes.contains(&note.to_string()), "{notes:?}");
    for (group, n) in [("facets:left", 12), ("cells:left", 24), ("right", 24), ("between", 12)] {
        let (n_fixed, notes) = fixed(group);
        assert_eq!(n_fixed, n, "{group}");
        assert!(!notes.iter().any(|note| note.contains(" is a group of ")), "{group} {notes:?}");
    }
    let absent = problem("[[support]]\ngroup = \"nodes:left\"\nfix = [\"x\"]").unwrap_err();
    assert!(absent.contains("has no group `nodes:left`"), "{absent}");
    for (wrong, near) in
        [("facets:lefft", "facets:left"), ("facet:left", "facets:left"), ("betwen", "between")]
    {
        let error =
            problem(&format!("[[load]]\ngroup = \"{wrong}\"\ntraction = [1.0, 0.0, 0.0]")).unwrap_err();
        assert!(error.contains(&format!("did you mean `{near}`?")), "{error}");
    }
}

#[test]
fn initial_velocities_and_accelerations_mean_the_cells() {
    // Mass 1 of the left cube at the velocity 2: the shared nodes move too.
    let more = "[[initial]]\ngroup = \"left\"\nvelocity = [2.0, 0.0, 0.0]\n[[load]]\ngroup = \"left\"\nacceleration = [0, 0, -3.0]";
    let problem = problem(more).unwrap();
    let velocity = problem.check_start().unwrap().unwrap().velocity;
    assert_eq!(velocity.iter().filter(|v| **v == 2.0).count(), 8);
    let force = problem.body.load_resultants()[0].force;
    assert!((force[2] + 3.0).abs() < 1e-14, "{force:?}");
}

#[test]
fn masses_and_attractions_say_what_a_name_of_two_kinds_means() {
    for (group, x, has_note) in [("left", 0.0, true), ("facets:left", 0.0, false), ("cells:left", 0.5, false)]
    {
        let problem = problem(&format!("[[mass]]\ngroup = \"{group}\"\ntotal = 2.0")).unwrap();
        // The bar of mass 2 has its centre at x = 1.
        let masses = problem.body.lumped_mass();
        let moment: f64 =
            masses.iter().zip(problem.body.mesh().points()).map(|(mass, point)| mass * point[0]).sum();
        let centre = moment / masses.iter().sum::<f64>();
        assert!((centre - (2.0 + 2.0 * x) / 4.0).abs() < 1e-14, "{group} {centre}");
        let note = "`left` is a group of facets and of cells: spread mass means the facets; `cells:left` would be the cells";
        assert_eq!(problem.notes.contains(&note.to_string()), has_note, "{:?}", problem.notes);
    }
    let pull =
        problem("[[load]]\ngroup = \"left\"\nattraction = { centre = [9.0, 0.0, 0.0], strength = 1.0 }")
            .unwrap();
    let note = "`left` is a group of cells and of facets: attraction means the cells; `facets:left` would be the facets";
    assert!(pull.notes.contains(&note.to_string()), "{:?}", pull.notes);
}

#[test]
fn a_fault_of_a_group_has_the_notes_on_the_mesh() {
    // Tags that are no whole numbers give no group.
    let directory = tempfile::tempdir().unwrap();
    let tet = "# vtk DataFile Version 3.0\ntet\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n\
               4 0 1 2 3\nCELL_TYPES 1\n10\nCELL_DATA 1\nSCALARS material double 1\nLOOKUP_TABLE default\n1.5\n";
    std::fs::write(directory.path().join("tet.vtk"), tet).unwrap();
    let text = "[mesh]\nfile = \"tet.vtk\"\n[[region]]\ngroup = \"material=1\"\ndensity = 1.0\nmaterial.neo-hooke = { lambda = 1.0, mu = 1.0 }\n\
                [time]\nscheme = \"DGM\"\nsteps = [{ until = 1.0, size = 0.1 }]\n";
    let path = directory.path().join("input.toml");
    std::fs::write(&path, text).unwrap();
    let error = input::read(&path, &Overrides::default()).unwrap_err();
    let advice = error.faults()[0].advice().unwrap();
    assert!(
        advice.contains("notes on the mesh: arrays that are left out") && advice.contains("material"),
        "{advice}"
    );
}

#[test]
fn a_pressure_inside_is_an_error_and_a_traction_is_not() {
    let error = problem("[[load]]\ngroup = \"between\"\npressure = 3.0").unwrap_err();
    assert!(error.contains("the facet at [1, 0.5, 0.5] has cells on both sides"), "{error}");
    let pressed = problem("[[load]]\ngroup = \"left\"\npressure = 3.0").unwrap();
    assert!((pressed.body.load_resultants()[0].force[0] - 3.0).abs() < 1e-14);
    let pulled = problem("[[load]]\ngroup = \"between\"\ntraction = [3.0, 0.0, 0.0]").unwrap();
    assert!((pulled.body.load_resultants()[0].force[0] - 3.0).abs() < 1e-14);
}
