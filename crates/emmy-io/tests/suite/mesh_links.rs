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

/// A tetrahedron with a bar along its edge, one from its tip, a spring, and two connectors, one of them to the ground.
const ABAQUS: &str = "*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, 0, 0, 3\n*Element, type=C3D4, elset=body\n\
    1, 1,2,3,4\n*Element, type=T3D2, elset=edge\n2, 1,2\n*Element, type=T3D2, elset=bars\n3, 4,5\n\
    *Element, type=SPRINGA, elset=springs\n4, 4,1\n*Element, type=CONN3D2, elset=pins\n5, 2,3\n6, ,4\n";

const EDGES: &str = "elements of type T3D2 are read as edges of the cells beside them, not as links: no region with a material for \
    links has their group";

#[test]
fn trusses_of_abaqus_beside_cells_are_links_on_request() {
    let read = |links: &[&str]| {
        let links = links.iter().map(|group| group.to_string()).collect();
        let options = emmy_io::mesh::MeshOptions { links, ..Default::default() };
        parse_with("a.inp".as_ref(), ABAQUS.as_bytes(), &options).unwrap()
    };
    let file = read(&[]);
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet4, 1)]);
    let nodes = ["edge", "springs", "pins"].map(|group| file.mesh.groups().nodes[group].clone());
    assert_eq!(nodes, [vec![0, 1], vec![0, 3], vec![1, 2, 3]]);
    // A bar from the tip is no edge.
    let left_out = "left out, though it may change the motion: 2 CONN3D2, 1 SPRINGA, 1 T3D2";
    assert_eq!(file.notes, [EDGES, left_out, "1 node belongs to no cell and is left out"]);
    let file = read(&["bars", "pins"]);
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet4, 1), (CellKind::Line2, 2)]);
    assert_eq!(["bars", "pins"].map(|group| file.mesh.groups().cells(group).unwrap()[0]), [1, 2]);
    assert_eq!(file.mesh.groups().nodes["edge"], [0, 1]);
    let left_out = "left out, though it may change the motion: 1 CONN3D2, 1 SPRINGA";
    assert_eq!(file.notes, ["CONN3D2 is read as line2", EDGES, left_out]);
}

#[test]
fn lines_of_abaqus_in_a_plane_are_edges() {
    let deck = "*Node\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*Element, type=CPE4, elset=body\n1, 1,2,3,4\n\
                *Element, type=T2D2, elset=foot\n2, 1,2\n*Element, type=T2D2, elset=diagonal\n3, 1,3\n";
    let file = parse("a.inp".as_ref(), deck.as_bytes()).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Quad4, 1)]);
    assert_eq!(file.mesh.groups().facets("foot").unwrap().len(), 1);
    assert_eq!(file.mesh.groups().nodes["diagonal"], [0, 2]);
    let left_out = "left out, though it may change the motion: 1 T2D2";
    assert_eq!(file.notes, [EDGES.replace("T3D2", "T2D2"), left_out.to_string()]);
}

#[test]
fn links_of_instances_are_named_by_set_or_instance() {
    let part = ABAQUS.replace("6, ,4\n", "6, 4\n");
    let deck = format!(
        "*Part, name=P\n{part}*End Part\n*Instance, name=P-1, part=P\n*End Instance\n*Instance, name=P-2, part=P\n\
         5, 0, 0\n*End Instance\n*Element, type=CONN3D2, elset=ground\n1, , P-1.3\n2, P-2.3,\n"
    );
    let n_links = |group: &str| {
        let mesh = parse_with("a.inp".as_ref(), deck.as_bytes(), &links(group)).unwrap().mesh;
        assert_eq!((mesh.counts_by_kind()[0], mesh.groups().nodes["ground"].len()), ((CellKind::Tet4, 2), 2));
        mesh.n_cells() - 2
    };
    // An instance has five lines, of which one is grounded.
    assert_eq!(["bars", "P-2.bars", "P-1", "ground"].map(n_links), [2, 1, 4, 0]);
}

#[test]
fn a_region_of_links_needs_no_group_of_edges() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tet.inp"), ABAQUS).unwrap();
    let read = |regions: &str| {
        let text = format!(
            "[mesh]\nfile = \"tet.inp\"\n[[region]]\ngroup = \"body\"\ndensity = 1.0\nmaterial.neo-hooke = {{ \
             youngs_modulus = 1000.0, poissons_ratio = 0.3 }}\n{regions}[time]\nscheme = \"DGM\"\nsteps = [{{ until = 1.0, \
             size = 0.1 }}]\n"
        );
        std::fs::write(folder.path().join("input.toml"), text).unwrap();
        let input = folder.path().join("input.toml");
        let problem = emmy_io::input::read(&input, &emmy_io::input::Overrides::default());
        problem.map(|problem| problem.body.mesh().n_cells()).map_err(|error| error.to_string())
    };
    assert_eq!(read(""), Ok(1));
    let springs = "[[region]]\ngroup = \"springs\"\nmaterial.spring = { stiffness = 5.0 }\n";
    assert_eq!(read(springs), Ok(2));
    assert_eq!(read(&springs.replace("springs", "cells:springs")), Ok(2));
}

#[test]
fn a_link_without_length_is_rejected() {
    let deck = "*Node\n1, 0, 0, 0\n2, 0, 0, 0\n*Element, type=T3D2\n7, 1,2\n";
    let message = parse("a.inp".as_ref(), deck.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("element 7 (line2) is inverted or degenerate"), "{message}");
}
