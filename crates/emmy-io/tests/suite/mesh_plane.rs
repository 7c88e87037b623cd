//! Meshes without solid cells: bodies in plane strain, from every format.

use crate::meshes::parse_text;
use emmy::body::{FieldName, FieldValues};
use emmy::mesh::{CellKind, Facet, Mesh};
use emmy_io::mesh::MeshFile;
use emmy_io::vtk::{FrameFiles, Precision};

/// A square of two triangles of Gmsh, the second clockwise, beside a quadrilateral; the left edge is a physical curve,
/// and a line and a point are in no group.
fn v2() -> String {
    let nodes = "6\n1 0 0 0.5\n2 1 0 0.5\n3 1 1 0.5\n4 0 1 0.5\n5 2 0 0.5\n6 2 1 0.5\n";
    let elements = "6\n1 15 2 0 1 1\n2 1 2 0 1 1 2\n3 1 2 8 4 4 1\n4 2 2 7 1 1 2 3\n5 2 2 7 1 1 4 3\n6 3 2 9 2 2 5 6 3\n";
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 8 \"left\"\n2 7 \"square\"\n2 9 \"rest\"\n\
         $EndPhysicalNames\n$Nodes\n{nodes}$EndNodes\n$Elements\n{elements}$EndElements\n"
    )
}

fn area(mesh: &Mesh) -> f64 {
    emmy::mesh::quality(mesh).volume
}

fn assert_square(file: &MeshFile) {
    let (mesh, groups) = (&file.mesh, file.mesh.groups());
    let kinds: Vec<CellKind> = mesh.cells().map(|cell| cell.kind).collect();
    assert_eq!(kinds, [CellKind::Tri3, CellKind::Tri3, CellKind::Quad4]);
    assert!((area(mesh) - 2.0).abs() < 1e-14);
    assert_eq!(groups.cells("square").unwrap(), [0, 1]);
    assert_eq!(groups.cells("rest").unwrap(), [2]);
    let [left] = groups.facets("left").unwrap() else { panic!("{groups:?}") };
    assert_eq!(left.cell, 1);
    for node in mesh.group_nodes("left").unwrap() {
        assert_eq!(mesh.points()[node as usize][0], 0.0);
    }
}

#[test]
fn gmsh() {
    let file = parse_text("a.msh", &v2()).unwrap();
    assert_square(&file);
    assert_eq!(
        file.notes,
        [
            "1 element of dimension 0 in no physical group is ignored",
            "1 element of dimension 1 in no physical group is ignored",
            "1 cell was numbered the other way round (clockwise) and turned",
        ]
    );
}

#[test]
fn quadratic_cells_of_gmsh_have_their_nodes_where_vtk_has_them() {
    // tri6 (9) and quad9 (10) side by side: 3 x 3 points of [0, 1]^2, [1, 2] x [0, 1], and a triangle on top.
    let points: Vec<[f64; 2]> = (0..9).map(|n| [0.5 * f64::from(n % 3), 0.5 * f64::from(n / 3)]).collect();
    let mut nodes = String::from("12\n");
    for (index, [x, y]) in points.iter().chain(&[[0.0, 2.0], [0.5, 1.5], [0.0, 1.5]]).enumerate() {
        nodes += &format!("{} {x} {y} 0\n", index + 1);
    }
    let elements = "2\n1 10 2 1 1 1 3 9 7 2 6 8 4 5\n2 9 2 1 1 7 9 10 8 11 12\n";
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}$EndNodes\n$Elements\n{elements}$EndElements\n"
    );
    let mesh = parse_text("a.msh", &text).unwrap().mesh;
    assert!((area(&mesh) - 1.5).abs() < 1e-14);
    let quality = emmy::mesh::quality(&mesh);
    assert!((quality.jacobian_ratio.value - 1.0).abs() < 1e-14, "{quality:?}");
}

#[test]
fn abaqus() {
    let text = "*Node\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 2, 0\n6, 2, 1\n*Element, type=CPE3, elset=square\n1, 1,2,3\n\
                2, 1,4,3\n*Element, type=CPE4R, elset=rest\n3, 2,5,6,3\n*Surface, name=left\n2, S1\n*Surface, name=right\nrest, S2\n";
    let file = parse_text("a.inp", text).unwrap();
    assert_square(&file);
    assert_eq!(file.mesh.groups().facets("right").unwrap(), [Facet { cell: 2, local: 1 }]);
    assert_eq!(
        file.notes,
        [
            "CPE4R is read as quad4 and integrated fully",
            "1 cell was numbered the other way round (clockwise) and turned"
        ]
    );
}

#[test]
fn lines_of_three_nodes_have_their_middle_at_either_place() {
    let nodes = "*Node\n1, 0, 0\n2, 2, 0\n3, 0, 2\n4, 1, 0\n5, 1, 1\n6, 0, 1\n*Element, type=CPE6, elset=body\n1, 1,2,3,4,5,6\n";
    let lines = |lines: &str| {
        let text = format!("{nodes}*Element, type=T2D3, elset=foot\n{lines}\n");
        parse_text("a.inp", &text).unwrap()
    };
    for foot in ["2, 1, 4, 2", "2, 1, 2, 4", "2, 2, 4, 1"] {
        let file = lines(foot);
        assert_eq!(file.mesh.groups().facets("foot").unwrap(), [Facet { cell: 0, local: 0 }], "{foot}");
    }
    // The middle of another edge.
    for foot in ["2, 1, 5, 2", "2, 1, 2, 6"] {
        let file = lines(foot);
        assert_eq!(
            (file.mesh.groups().nodes["foot"].len(), file.mesh.groups().facets.len()),
            (3, 0),
            "{foot}"
        );
        assert_eq!(file.notes, ["left out, though it may change the motion: 1 T2D3"]);
    }
}

#[test]
fn frames_come_back_with_all_their_groups() {
    let mesh = parse_text("a.msh", &v2()).unwrap().mesh;
    let temp = tempfile::tempdir().unwrap();
    let displacement = FieldValues { name: FieldName::Displacement, numbers: vec![0.0; mesh.n_dofs()] };
    let mut frames = FrameFiles::create(&temp.path().join("out"), Precision::Double, &mesh, &[0; 3]).unwrap();
    frames.write(0, 0.0, &[displacement]).unwrap();
    let back = emmy_io::mesh::read(&temp.path().join("out/frames/out_000000.vtu")).unwrap();
    assert_eq!(back.mesh.points(), mesh.points());
    assert!(back.mesh.cells().eq(mesh.cells()));
    let mut groups = back.mesh.groups().clone();
    assert_eq!(groups.cells.remove("region=0").unwrap().len(), 3);
    assert_eq!(&groups, mesh.groups());
    assert_eq!(back.notes, [""; 0]);
}

#[test]
fn triangles_of_a_solid_are_still_its_faces() {
    let nodes = "4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
    let elements = "3\n1 2 2 0 1 1 2 3\n2 2 2 5 1 1 2 4\n3 4 2 7 1 1 2 3 4\n";
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}$EndNodes\n$Elements\n{elements}$EndElements\n"
    );
    let file = parse_text("a.msh", &text).unwrap();
    assert_eq!((file.mesh.n_cells(), file.mesh.cell(0).kind), (1, CellKind::Tet4));
    assert_eq!(file.mesh.groups().facets("5").unwrap(), [Facet { cell: 0, local: 2 }]);
    assert_eq!(file.notes, ["1 element of dimension 2 in no physical group is ignored"]);
}

#[test]
fn a_plane_body_lies_in_a_plane() {
    let message = parse_text("a.msh", &v2().replace("6 2 1 0.5", "6 2 1 0.7")).unwrap_err().to_string();
    assert!(message.contains("node 6 is at z = 0.7 and the first one at z = 0.5"), "{message}");
}

#[test]
fn the_node_beside_the_plane_has_its_number() {
    let sheet = "GRID,101,,0.,0.,0.\nGRID,102,,1.,0.,0.\nGRID,103,,1.,1.,1.\nGRID,104,,0.,1.,1.\nCQUAD4,7,3,101,102,103,104\n";
    let error = |name: &str, text: &str| parse_text(name, text).unwrap_err().to_string();
    let turned = "all of them lie in another plane: turn the mesh into the x-y plane";
    let message = error("a.bdf", sheet);
    assert!(message.starts_with("a.bdf: the file has quadrilaterals only and no solid cells"), "{message}");
    assert!(message.contains("(node 103 is at z = 1 and the first one at z = 0)"), "{message}");
    assert!(message.ends_with(turned), "{message}");
    let warped = error("a.bdf", &sheet.replace("104,,0.,1.,1.", "104,,0.,1.,0."));
    assert!(warped.contains("node 103 is at") && !warped.contains(turned), "{warped}");
    let part =
        "*Part, name=P\n*Node\n11, 0, 0\n12, 1, 0\n13, 0, 1\n*Element, type=CPE3\n1, 11,12,13\n*End Part\n";
    let text = format!(
        "{part}*Instance, name=P-1, part=P\n*End Instance\n*Instance, name=P-2, part=P\n3, 0, 0\n3, 0, 0, 4, 0, 0, 90\n*End Instance\n"
    );
    let message = error("a.inp", &text);
    assert!(message.contains("node 13 of instance P-2 is at z = 1 and the first one at z = 0"), "{message}");
    let message =
        error("a.inp", &text.replacen("3, 0, 0\n", "0, 0, 2\n", 1).replace("3, 0, 0, 4, 0, 0, 90\n", ""));
    assert!(
        message.contains("triangles only") && message.contains("node 11 of instance P-2 is at z = 2"),
        "{message}"
    );
}

#[test]
fn cells_in_plane_strain_are_not_beside_solid_ones() {
    let text = "*Node\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n*Element, type=C3D8\n\
                1, 1,2,3,4,5,6,7,8\n*Element, type=CPE4\n2, 5,6,7,8\n3, 1,2,6,5\n";
    let message = parse_text("a.inp", text).unwrap_err().to_string();
    let expected = "a.inp, line 13: element 2 (CPE4) is a cell in plane strain beside solid cells, such as element 1 (C3D8)";
    assert!(message.starts_with(expected), "{message}");
}

/// Notes on an input of plane cells.
fn notes(more: &str) -> Vec<String> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("input.toml");
    let text = format!(
        "[mesh]\nrectangle = {{ size = [2.0, 1.0], cells = [4, 2] }}\n[[region]]\ndensity = 1.0\n\
         material.neo-hooke = {{ youngs_modulus = 1000.0, poissons_ratio = 0.3 }}\n{more}\n\
         [time]\nscheme = \"DGM\"\nsteps = [{{ until = 1.0, size = 0.1 }}]\n"
    );
    std::fs::write(&path, text).unwrap();
    emmy_io::input::read(&path, &emmy_io::input::Overrides::default()).unwrap().notes
}

#[test]
fn what_acts_along_z_in_plane_strain_has_a_note() {
    let effect = "z is without effect, since cells in plane strain do not move along it";
    for (entry, what) in [
        ("[[load]]\ngroup = \"x-max\"\ntraction = [0.0, 0.0, 3.0]", "load of `x-max`"),
        ("[[load]]\ngroup = \"x-max\"\nforce = [1.0, 0.0, 3.0]", "load of `x-max`"),
        ("[[load]]\ngroup = \"x-max\"\nnodal_force = [1.0, 0.0, 3.0]", "load of `x-max`"),
        ("[[load]]\nacceleration = [0.0, 0.0, -9.81]", "load"),
        ("[[load]]\nbody_force = [\"0\", \"0\", \"x\"]", "load"),
        ("[[initial]]\ngroup = \"x-max\"\nvelocity = [0.0, 0.0, 1.0]", "initial velocity of `x-max`"),
        ("[[initial]]\nangular_velocity = [1.0, 0.0, 0.0]", "initial velocity"),
    ] {
        assert_eq!(notes(entry), [format!("{what}: {effect}")], "{entry}");
    }
    for entry in [
        "[[load]]\nacceleration = [0.0, -9.81, 0.0]",
        "[[initial]]\nangular_velocity = [0.0, 0.0, 1.0]",
        "[[mass]]\nname = \"weight\"\nat = [2.0, 0.5, 0.0]\nmass = 1.0\ngroup = \"x-max\"\ncoupling = \"distributing\"\n\
         [[load]]\nacceleration = [0.0, -9.81, 0.0]",
    ] {
        assert_eq!(notes(entry), [""; 0], "{entry}");
    }
}
