//! Lines of mesh files as links: cells on request, edges otherwise.

use emmy::mesh::CellKind;
use emmy_io::mesh::{parse, parse_with};

use crate::meshes::links;

/// A tetrahedron, two lines from its tip in the physical curve `springs`, one along an edge in `edge`.
const GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"springs\"\n1 2 \"edge\"\n3 3 \"body\"\n\
    $EndPhysicalNames\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 2\n6 1 0 2\n$EndNodes\n$Elements\n4\n\
    1 1 2 1 1 4 5\n2 1 2 1 1 4 6\n3 1 2 2 2 1 2\n4 4 2 3 1 1 2 3 4\n$EndElements\n";

#[test]
fn lines_of_gmsh_are_cells_in_the_groups_that_are_named() {
    let file = parse_with("a.msh".as_ref(), GMSH.as_bytes(), &links("springs")).unwrap();
    let (mesh, groups) = (&file.mesh, file.mesh.groups());
    assert_eq!(mesh.counts_by_kind(), [(CellKind::Tet4, 1), (CellKind::Line2, 2)]);
    assert_eq!((groups.cells("springs").unwrap().len(), groups.cells("body").unwrap().len()), (2, 1));
    assert_eq!((groups.nodes["edge"].len(), mesh.n_nodes()), (2, 6));
    for &cell in groups.cells("springs").unwrap() {
        assert_eq!(mesh.points()[mesh.cell(cell as usize).nodes[0] as usize], [0.0, 0.0, 1.0]);
    }
}

#[test]
fn lines_are_no_cells_unless_they_are_asked_for() {
    let file = parse("a.msh".as_ref(), GMSH.as_bytes()).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet4, 1)]);
    assert_eq!(file.mesh.groups().nodes["springs"].len(), 1);
    let beams = "2 lines are no edges of a cell, such as a beam, and left out; their nodes stay in the groups of nodes \"springs\"";
    assert_eq!(file.notes, [beams, "2 nodes belong to no cell and are left out"]);
}

#[test]
fn a_file_of_lines_alone_is_a_network() {
    let start = GMSH.find("$Elements").unwrap();
    let text = format!("{}$Elements\n2\n1 1 2 1 1 4 5\n2 1 2 1 1 5 6\n$EndElements\n", &GMSH[..start]);
    let file = parse_with("a.msh".as_ref(), text.as_bytes(), &links("springs")).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Line2, 2)]);
    assert!((emmy::mesh::quality(&file.mesh).volume - 2.0).abs() < 1e-15);
    let none = parse("a.msh".as_ref(), text.as_bytes()).unwrap_err().to_string();
    assert!(none.contains("the file has no solid or plane cells, only 2 lines"), "{none}");
}

#[test]
fn trusses_of_abaqus_are_links_in_any_case() {
    let deck = "*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, 0, 0, 3\n*Element, type=C3D4, elset=body\n\
                1, 1,2,3,4\n*Element, type=T3D2, elset=bars\n2, 4,5\n*Element, type=SPRINGA, elset=springs\n3, 5,1\n";
    let file = parse("a.inp".as_ref(), deck.as_bytes()).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet4, 1), (CellKind::Line2, 2)]);
    assert_eq!(file.mesh.groups().cells("bars").unwrap(), [1]);
    assert_eq!(file.mesh.groups().cells("springs").unwrap(), [2]);
    assert_eq!(file.notes, ["SPRINGA is read as line2"]);
}

#[test]
fn a_link_without_length_is_rejected() {
    let deck = "*Node\n1, 0, 0, 0\n2, 0, 0, 0\n*Element, type=T3D2\n7, 1,2\n";
    let message = parse("a.inp".as_ref(), deck.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("element 7 (line2) is inverted or degenerate"), "{message}");
}
