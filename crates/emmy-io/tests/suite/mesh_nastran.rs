//! Nastran files written by Gmsh (`meshes/generate.py`), and others by hand.

use crate::meshes::{assert_plane, assert_straight, close, parse_text, read, volume};
use emmy::mesh::CellKind;
use emmy_io::mesh::{parse_with_links, read_with_links};

/// Corners of a unit cube, prism, tetrahedron and pyramid, and the corners at the ends of the edge of each midside node
/// in the order of the Quick Reference Guide (CHEXA, CPENTA, CTETRA, CPYRAM), counted from 1.
type Solid = (&'static str, [CellKind; 2], &'static [[f64; 3]], &'static [[usize; 2]], f64);

const SOLIDS: [Solid; 4] = [
    (
        "CHEXA",
        [CellKind::Hex8, CellKind::Hex20],
        &[
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
            [0.0, 1.0, 1.0],
        ],
        &[[1, 2], [2, 3], [3, 4], [4, 1], [1, 5], [2, 6], [3, 7], [4, 8], [5, 6], [6, 7], [7, 8], [8, 5]],
        1.0,
    ),
    (
        "CPENTA",
        [CellKind::Wedge6, CellKind::Wedge15],
        &[
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0],
        ],
        &[[1, 2], [2, 3], [3, 1], [1, 4], [2, 5], [3, 6], [4, 5], [5, 6], [6, 4]],
        0.5,
    ),
    (
        "CTETRA",
        [CellKind::Tet4, CellKind::Tet10],
        &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        &[[1, 2], [2, 3], [3, 1], [1, 4], [2, 4], [3, 4]],
        1.0 / 6.0,
    ),
    (
        "CPYRAM",
        [CellKind::Pyramid5, CellKind::Pyramid13],
        &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        &[[1, 2], [2, 3], [3, 4], [4, 1], [1, 5], [2, 5], [3, 5], [4, 5]],
        1.0 / 3.0,
    ),
];

#[test]
fn midside_nodes_have_the_order_of_the_guide() {
    for (card, kinds, corners, edges, exact) in SOLIDS {
        let middle = |&[a, b]: &[usize; 2]| [0, 1, 2].map(|i| (corners[a - 1][i] + corners[b - 1][i]) / 2.0);
        let points: Vec<[f64; 3]> = corners.iter().copied().chain(edges.iter().map(middle)).collect();
        for kind in kinds {
            let mut text = "BEGIN BULK\n".to_string();
            for (number, [x, y, z]) in points[..kind.n_nodes()].iter().enumerate() {
                text += &format!("GRID,{},,{x:.1},{y:.1},{z:.1}\n", number + 1);
            }
            let nodes: Vec<String> = (1..=kind.n_nodes()).map(|node| node.to_string()).collect();
            let fields = ["7".to_string(), "3".to_string()].into_iter().chain(nodes).collect::<Vec<_>>();
            let lines: Vec<String> = fields.chunks(8).map(|line| line.join(",")).collect();
            text += &format!("{card},{}\nENDDATA\n", lines.join(",+\n+,"));
            let mesh = parse_text("a.bdf", &text).unwrap_or_else(|error| panic!("{error}\n{text}")).mesh;
            assert_eq!(mesh.cell(0).kind, kind);
            assert_straight(&mesh);
            assert!((volume(&mesh) - exact).abs() < 1e-15 && emmy::mesh::quality(&mesh).inverted.is_empty());
            assert_eq!(mesh.groups().cells("pid_3").unwrap(), [0]);
        }
    }
}

#[test]
fn meshes_of_gmsh_are_those_of_its_own_format() {
    for (name, own) in [("free", "tet10"), ("large", "tet10"), ("hex20", "hex20"), ("wedge15", "wedge15")] {
        let file = read(&format!("nastran-{name}.bdf"));
        let [mesh, own] = [file.mesh, read(&format!("{own}-41-ascii.msh")).mesh];
        assert_eq!((mesh.n_nodes(), mesh.n_cells()), (own.n_nodes(), own.n_cells()), "{name}");
        assert!((volume(&mesh) - 2.0).abs() < 1e-12, "{name}");
        assert_straight(&mesh);
        // The volumes 1 and 2 are the halves; the surfaces and curves have their numbers, too.
        for (half, at) in [("pid_1", 0.5), ("pid_2", 1.5)] {
            let cells = mesh.groups().cells(half).unwrap();
            assert_eq!(cells.len(), mesh.n_cells() / 2);
            let inside = |node: &u32| (mesh.points()[*node as usize][0] - at).abs() <= 0.5;
            assert!(mesh.group_nodes(half).unwrap().iter().all(inside), "{name}");
        }
        assert_plane(&mesh, "pid_1-faces", 0, 0.0);
        assert_eq!(
            mesh.groups().facets("pid_1-faces").unwrap().len(),
            own.groups().facets("clamp").unwrap().len()
        );
        assert!(mesh.groups().nodes.contains_key("pid_1-lines"));
        assert!(
            file.notes.iter().any(|note| note.contains("line elements are read as the nodes")),
            "{:?}",
            file.notes
        );
    }
}

const TET: &str = "GRID    1               0.      0.      0.\nGRID    2               2.+0    0.      0.\n\
                   GRID    3               0.      20.-1   0.\nGRID    4               0.      0.      .2E1\n";

#[test]
fn sets_names_and_shells_become_groups() {
    let text = format!(
        "SOL 101\nCEND\nLOAD = 2\nBEGIN BULK\n$ANSA_NAME_COMMENT;3;PSOLID;steel;\n{TET}CTETRA  1       3       1       2       3       4\n\
         CTRIA3  2       4       1       2       3       .5\nPSOLID  3       1\nPSHELL  4       1       .1\nMAT1    1       2.1+5           .3      7.85-9\n\
         SPC1    5       123     1       THRU    3\nSPC     6       4       123     0.      2       123     0.\nCONM2   9       1               2.5\n\
         RBE2    10      1       123     2       3\nFORCE   2       1               5.      1.      0.      0.\nENDDATA\n"
    );
    let file = parse_text("a.nas", &text).unwrap();
    let groups = file.mesh.groups();
    assert_eq!(groups.names(), ["pid_4", "spc_5", "spc_6", "steel"]);
    assert_eq!((groups.facets("pid_4").unwrap().len(), groups.cells("steel").unwrap()), (1, &[0][..]));
    assert_eq!((&groups.nodes["spc_5"][..], &groups.nodes["spc_6"][..]), (&[0, 1, 2][..], &[1, 3][..]));
    assert!(close(file.mesh.points()[2], [0.0, 2.0, 0.0]) && (volume(&file.mesh) - 4.0 / 3.0).abs() < 1e-15);
    assert_eq!(file.notes, ["elements that are not read: 1 CONM2, 1 RBE2"]);
}

#[test]
fn a_plane_of_shells_is_a_body_in_plane_strain() {
    let text = "$ a plate\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nCQUAD4,1,1,1,2,3,4,0.,.1\nCBAR,2,2,1,2,0.,0.,1.\n";
    let file = parse_text("a.dat", text).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Quad4, 1)]);
    assert_eq!(file.mesh.groups().facets("pid_2").unwrap().len(), 1);
}

#[test]
fn lines_of_a_group_for_links_are_cells() {
    let text = format!("{TET}CTETRA,1,3,1,2,3,4\nCROD,2,8,1,4\n");
    let file = parse_with_links("a.bdf".as_ref(), text.as_bytes(), &["pid_8".to_string()]).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet4, 1), (CellKind::Line2, 1)]);
    let path = crate::meshes::path("nastran-wedge15.bdf");
    assert!(read_with_links(&path, &[]).is_ok());
}

#[test]
fn the_content_decides_about_dat() {
    let deck = "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n";
    let gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";
    let nastran = format!("{TET}CTETRA,1,3,1,2,3,4\n");
    for text in [deck, gmsh, &nastran, &format!("$ x\n{nastran}")] {
        assert_eq!(parse_text("a.dat", text).unwrap().mesh.n_cells(), 1, "{text}");
    }
}

#[test]
fn faults_have_their_line_and_their_card() {
    let system = TET.replacen("GRID    2               ", "GRID    2       7       ", 1);
    let broken = TET.replacen("2.+0", "2.x0", 1);
    let twice = TET.replacen("GRID    2", "GRID    1", 1);
    let cases = [
        (format!("{system}CTETRA,1,3,1,2,3,4\n"), "a.bdf, line 2: coordinates in system 7 are not supported"),
        (format!("GRDSET,,5\n{TET}"), "a.bdf, line 1: coordinates in system 5"),
        (
            format!("{broken}CTETRA,1,3,1,2,3,4\n"),
            "a.bdf, line 2: expected a coordinate in GRID, found \"2.x0\"",
        ),
        (format!("{twice}CTETRA,1,3,1,2,3,4\n"), "a.bdf, line 2: node 1 exists already"),
        (format!("{TET}CTETRA,1,3,1,2,3,9\n"), "a.bdf, line 5: element 1 names node 9"),
        (
            format!("{TET}CTETRA,1,3,1,2,3\n"),
            "a.bdf, line 5: element 1 (CTETRA) has 3 nodes instead of 4 or 10",
        ),
        (format!("{TET}CTETRA,1,3,1,2,3,4,2\n"), "element 1 (CTETRA) has 5 nodes instead of 4 or 10"),
        (format!("{TET}CTETRA,1,3,1,2,x,4\n"), "expected a grid point in CTETRA, found \"x\""),
        (format!("{TET}CTETRA,1,3,1,2,3,4\nCTRIA3,1,3,1,2,3\n"), "a.bdf, line 6: element 1 exists already"),
        (format!("{TET}CTETRA,1,3,1,3,2,2\n"), "a.bdf: element 1 (tet4) is inverted"),
        (format!("{TET}INCLUDE 'more.bdf'\n"), "a.bdf, line 5: INCLUDE is not supported"),
        (TET.to_string(), "a.bdf: the mesh has no solid or plane cells; the body must be in it as GRID"),
        (
            "GRID,1,,1.+999,0.,0.\n".to_string(),
            "a.bdf, line 1: node 1 has a coordinate that is not a finite number",
        ),
    ];
    for (text, message) in cases {
        let error = parse_text("a.bdf", &text).unwrap_err().to_string();
        assert!(error.contains(message), "{error}\n{message}");
    }
}
