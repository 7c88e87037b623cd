//! Nastran files written by Gmsh (`meshes/generate.py`), and others by hand.

use crate::mesh_abaqus_bodies::all_notes;
use crate::meshes::{assert_plane, assert_straight, close, links, parse_text, read, volume};
use emmy::mesh::CellKind;
use emmy_io::mesh::{MeshOptions, parse_with, read_with};

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
    assert_eq!(groups.names(), ["conm2_9-node", "pid_4", "rbe2_10-nodes", "spc_5", "spc_6", "steel"]);
    assert_eq!((groups.facets("pid_4").unwrap().len(), groups.cells("steel").unwrap()), (1, &[0][..]));
    assert_eq!((&groups.nodes["spc_5"][..], &groups.nodes["spc_6"][..]), (&[0, 1, 2][..], &[1, 3][..]));
    assert!(close(file.mesh.points()[2], [0.0, 2.0, 0.0]) && (volume(&file.mesh) - 4.0 / 3.0).abs() < 1e-15);
    assert_eq!(
        all_notes(&file),
        [
            "RBE2: 1 rigid coupling acts: rbe2_10 (mesh.leave_out switches it off)",
            "CONM2: 1 mass acts: conm2_9 (mesh.leave_out switches it off)",
            "2 constraints (SPC, SPC1) fix nothing without a `support`: groups spc_5, spc_6",
            "left out, though it may change the motion: 1 CTRIA3, 1 FORCE"
        ]
    );
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
    let file = parse_with("a.bdf".as_ref(), text.as_bytes(), &links("pid_8")).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet4, 1), (CellKind::Line2, 1)]);
    let path = crate::meshes::path("nastran-wedge15.bdf");
    assert!(read_with(&path, &MeshOptions::default()).is_ok());
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
        (format!("{system}CTETRA,1,3,1,2,3,4\n"), "a.bdf, line 2: there is no coordinate system 7"),
        (format!("GRDSET,,5\n{TET}"), "a.bdf, line 2: there is no coordinate system 5"),
        (format!("GRDSET,,5\nGRDSET\n{TET}"), "a.bdf, line 2: a second GRDSET"),
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
        (
            format!("{TET}CTETRA,1,3,1,2,3,4,2\n"),
            "element 1 (CTETRA) names node 2 as a corner and as a midside node",
        ),
        (format!("{TET}CTETRA,1,3,1,2,x,4\n"), "expected a grid point in CTETRA, found \"x\""),
        (format!("{TET}CTETRA,1,3,1,2,3,4\nCTRIA3,1,3,1,2,3\n"), "a.bdf, line 6: element 1 exists already"),
        (format!("{TET}CTETRA,1,3,1,3,2,2\n"), "a.bdf: element 1 (tet4) is inverted"),
        (format!("{TET}INCLUDE 'more.bdf'\n"), "a.bdf, line 5: the file more.bdf cannot be read"),
        (format!("{TET}INCLUDE 'more.bdf\n"), "a.bdf, line 5: INCLUDE without a path"),
        (format!("=,*1\n{TET}"), "a.bdf, line 1: `=` repeats the card above, and there is none"),
        (format!("{TET}=3\n"), "a.bdf, line 5: `=3` repeats the card above, and there is none with `=`"),
        (format!("{TET}=,*1,,*x\n"), "a.bdf, line 5: the field 0. by *x of GRID cannot be incremented"),
        (
            format!("{TET}=,*1\n=4000000000\n"),
            "a.bdf, line 6: lines with `=` ask for more than 1000000 cards",
        ),
        (format!("{TET}=,*0\n"), "a.bdf, line 5: node 4 exists already"),
        (format!("{TET}CTETRA_,1,3,1,2,3\n"), "element 1 (CTETRA_) has 3 nodes instead of 4 or 10"),
        (
            format!("{TET}CHEXA_* 1               1               1               2\n"),
            "a.bdf, line 5: solid cells of the kind CHEXA_* are not read; meshio changes the order of their nodes in large fields",
        ),
        (format!("{TET}CHEX8,1,1,1,2,3,4\n"), "a.bdf, line 5: solid cells of the kind CHEX8 are not read"),
        (format!("{TET}CGEN,CHEXA,1\n"), "a.bdf, line 5: CGEN makes grid points or cells, and is not read"),
        (format!("{TET}BEGIN SUPER=2\n"), "a.bdf, line 5: BEGIN SUPER=2 makes grid points or cells"),
        (
            format!("{TET}CBAR,1,1,1,2\nCONM2,3,1,,2.5\n"),
            "a.bdf: the file has no solid or plane cells, only 1 CBAR, 1 CONM2; the body must be",
        ),
        (
            format!("{TET}CBAR,1,1,1,2\nCFOO,3,1,1,2,3\n"),
            "a.bdf: the file has no solid or plane cells, only 1 CBAR; the body must be",
        ),
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

/// Two cells, as cards without `ENDDATA`.
const CELLS: &str = "CHEXA,1,1,1,2,3,4,5,6\n,7,8\nCHEXA,2,1,2,9,10,3,6,11\n,12,7\n";

/// Their corners.
const CORNERS: [[f64; 3]; 12] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
    [2.0, 0.0, 0.0],
    [2.0, 1.0, 0.0],
    [2.0, 0.0, 1.0],
    [2.0, 1.0, 1.0],
];

/// Grid points with the coordinates of a function, in a system.
fn grids(system: &str, coordinates: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let grid = |(index, point): (usize, &[f64; 3])| {
        let [a, b, c] = coordinates(*point);
        format!("GRID,{},{system},{a:?},{b:?},{c:?}\n", index + 1)
    };
    CORNERS.iter().enumerate().map(grid).collect()
}

fn has_note(notes: &[String], text: &str) {
    assert!(notes.iter().any(|note| note.contains(text)), "{text}\n{notes:?}");
}

#[test]
fn cells_repeat_with_increments() {
    let mut text = "BEGIN BULK\n".to_string();
    for x in [0, 1, 2, 3] {
        for (node, [y, z, w]) in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].iter().enumerate() {
            text += &format!("GRID,{},,{}.,{z}.,{w}.\n", 10 * x + node as i32 + 1, 3 * x + y);
        }
    }
    let fixed = "=             *1       =     *10     *10     *10     *10\n=(2)\n";
    for copies in ["=,*1,=,*10,*10,*10,*10\n=2\n", "=,*(1),=,*(10),*10,*10,*10\n=(2)\n", fixed] {
        let mesh = parse_text("a.bdf", &format!("{text}CTETRA,1,1,1,2,3,4\n{copies}ENDDATA\n")).unwrap().mesh;
        assert_eq!((mesh.n_cells(), mesh.n_nodes()), (4, 16), "{copies}");
        // Four tetrahedra of a sixth each.
        assert!((volume(&mesh) - 2.0 / 3.0).abs() < 1e-15, "{copies}");
        assert_eq!(mesh.groups().cells("pid_1").unwrap().len(), 4);
    }
    // Grid points along x, and cells between them with continuations.
    let row = "GRID,1\n=,*1,,*1.\n=3\nGRID,11,,0.,1.\n=,*1,=,*1.,==\n=(3)\nGRID,21,,0.,0.,1.\n=,*1,=,*1.,==\n=3\n\
               GRID,31,,0.,1.,1.\n=,*1,=,*1.,==\n=3\nCHEXA,1,7,1,2,12,11,21,22\n,32,31\n=,*1,=,*1,*1,*1,*1,*1,*1\n,*1,*1\n=2\nENDDATA\n";
    let file = parse_text("a.bdf", row).unwrap();
    assert_eq!((file.mesh.n_cells(), file.mesh.n_nodes(), file.notes.len()), (4, 20, 0), "{:?}", file.notes);
    assert!((volume(&file.mesh) - 4.0).abs() < 1e-14);
}

#[test]
fn tabs_lead_to_the_next_field() {
    let grid =
        |(index, [x, y, z]): (usize, &[f64; 3])| format!("GRID\t{}\t\t{x:.6}{y:.6}{z:.6}\n", index + 1);
    let nodes: String = CORNERS.iter().enumerate().map(grid).collect();
    let file = parse_text("a.bdf", &format!("BEGIN BULK\n{nodes}{CELLS}ENDDATA\n")).unwrap();
    assert_eq!((file.mesh.n_cells(), file.notes.len()), (2, 0));
    assert!((volume(&file.mesh) - 2.0).abs() < 1e-15);
}

#[test]
fn local_systems_are_placed() {
    let mean_of = |text: &str| {
        let file = parse_text("a.bdf", text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert!((volume(&file.mesh) - 2.0).abs() < 1e-12, "{text}");
        crate::meshes::mean(file.mesh.points())
    };
    let plain = |point| point;
    let shifted = "CORD2R,5,,10.,0.,0.,10.,0.,1.\n,10.,1.,0.\n";
    // The axis x of this system is y, its y is -x.
    let turned = mean_of(&format!("{shifted}{}{CELLS}", grids("5", plain)));
    assert!(close(turned, [10.0 - 0.5, 1.0, 0.5]), "{turned:?}");
    let shifted = "CORD2R,5,,10.,0.,0.,10.,0.,1.\n,11.,0.,0.\n";
    assert!(close(mean_of(&format!("{shifted}{}{CELLS}", grids("5", plain))), [11.0, 0.5, 0.5]));
    // GRDSET, after the grid points; one that names the basic system stays there.
    let default = format!("{}{CELLS}{shifted}GRDSET,,5\n", grids("", plain));
    assert!(close(mean_of(&default), [11.0, 0.5, 0.5]));
    assert!(close(mean_of(&format!("{}{CELLS}{shifted}GRDSET,,5\n", grids("0", plain))), [1.0, 0.5, 0.5]));
    // Polar coordinates of every corner, about an axis parallel to z through (-1, -1, 0).
    let polar = |[x, y, z]: [f64; 3]| [(x + 1.0).hypot(y + 1.0), (y + 1.0).atan2(x + 1.0).to_degrees(), z];
    let cylinder = "CORD2C,6,,-1.,-1.,0.,-1.,-1.,1.\n,0.,-1.,0.\n";
    assert!(close(mean_of(&format!("{cylinder}{}{CELLS}", grids("6", polar))), [1.0, 0.5, 0.5]));
    // Angle from the axis z, then about it.
    let spherical = |[x, y, z]: [f64; 3]| {
        let (x, y, z) = (x + 1.0, y + 1.0, z + 1.0);
        [(x * x + y * y + z * z).sqrt(), x.hypot(y).atan2(z).to_degrees(), y.atan2(x).to_degrees()]
    };
    let sphere = "CORD2S,6,,-1.,-1.,-1.,-1.,-1.,1.\n,0.,-1.,-1.\n";
    assert!(close(mean_of(&format!("{sphere}{}{CELLS}", grids("6", spherical))), [1.0, 0.5, 0.5]));
    // A system in a cylindrical one: origin r = 3, theta = 90, its z along z, its x along -x.
    let nested =
        "CORD2C,1,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,2,1,3.,90.,0.,3.,90.,1.\n,5.,143.13010235415598,0.\n";
    assert!(close(mean_of(&format!("{nested}{}{CELLS}", grids("2", plain))), [-1.0, 2.5, 0.5]));
    // Two systems by grid points, which lie in a local one themselves; z of system 8 is its y.
    let points = "GRID,91,5,1.,0.,0.\nGRID,92,5,1.,1.,0.\nGRID,93,5,2.,0.,0.\nCORD1R,7,91,93,92,8,91,92,93\n";
    let by_grids = format!("{shifted}{points}{}{CELLS}", grids("8", plain));
    assert!(close(mean_of(&by_grids), [12.0, 0.5, -0.5]), "{:?}", mean_of(&by_grids));
    for (kind, coordinates) in [("C", &polar as &dyn Fn([f64; 3]) -> [f64; 3]), ("S", &spherical)] {
        let z = if kind == "S" { -1.0 } else { 0.0 };
        let points = format!(
            "GRID,91,,-1.,-1.,{z:?}\nGRID,92,,-1.,-1.,5.\nGRID,93,,0.,-1.,{z:?}\nCORD1{kind},7,91,92,93\n"
        );
        let mean = mean_of(&format!("{points}{}{CELLS}", grids("7", coordinates)));
        assert!(close(mean, [1.0, 0.5, 0.5]), "{kind} {mean:?}");
    }
    let cases = [
        (
            "CORD2R,5,6,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,6,5,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n",
            "is a system given in itself?",
        ),
        ("CORD1R,5,1,2,3\n", "is a system given in itself?"),
        ("CORD1R,5,71,2,3\n", "a.bdf, line 1: there is no grid point 71"),
        ("CORD2R,5,6,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n", "a.bdf, line 1: there is no coordinate system 6"),
        (
            "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,0.,3.\n",
            "line 1: the three points of coordinate system 5 lie on one line",
        ),
        (
            "CORD2R,5,,0.,0.,0.,0.,0.,0.\n,0.,0.,3.\n",
            "the three points of coordinate system 5 lie on one line",
        ),
        ("CORD1R,5,1,2,3,5,1,2,3\n", "line 1: coordinate system 5 exists already"),
        ("CORD2R,0,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n", "coordinate system 0 exists already"),
    ];
    for (systems, message) in cases {
        let error =
            parse_text("a.bdf", &format!("{systems}{}{CELLS}", grids("5", plain))).unwrap_err().to_string();
        assert!(error.contains(message), "{error}\n{message}");
    }
}

#[test]
fn files_include_others() {
    let folder = std::env::temp_dir().join(format!("emmy-nastran-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("a long/name")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write(
        "main.bdf",
        "SOL 101\nCEND\nBEGIN BULK\nINCLUDE 'a long/\n   name/\n  cells.bulk' $ cells\ninclude \"a long\\name\\end.bulk\"\n,12,7\nENDDATA\n",
    );
    write("a long/name/cells.bulk", "INCLUDE grids.bulk\nCHEXA,1,1,1,2,3,4,5,6\n,7,8\n");
    write("a long/name/grids.bulk", &grids("", |point| point));
    write("a long/name/end.bulk", "$ Femap Property 1 : steel\nCHEXA,2,1,2,9,10,3,6,11\n");
    let file = emmy_io::mesh::read(&folder.join("main.bdf")).unwrap();
    assert_eq!((file.mesh.n_cells(), file.notes.len()), (2, 0), "{:?}", file.notes);
    assert!((volume(&file.mesh) - 2.0).abs() < 1e-15);
    assert_eq!(file.mesh.groups().cells("steel").unwrap().len(), 2);
    let names = ["main.bdf", "a long/name/cells.bulk", "a long/name/grids.bulk", "a long/name/end.bulk"];
    let same = |(path, name): (&std::path::PathBuf, &str)| {
        path.canonicalize().unwrap() == folder.join(name).canonicalize().unwrap()
    };
    assert!(file.files.len() == 4 && file.files.iter().zip(names).all(same), "{:?}", file.files);
    // A fault has the line of its own file, and a file that includes itself ends.
    write("main.bdf", "INCLUDE 'wrong.bulk'\n");
    write("wrong.bulk", "GRID,1\nGRID,x\n");
    let error = emmy_io::mesh::read(&folder.join("main.bdf")).unwrap_err().to_string();
    assert!(error.contains("wrong.bulk, line 2: expected the number of a grid point"), "{error}");
    write("main.bdf", "INCLUDE 'main.bdf'\nINCLUDE 'main.bdf'\n");
    let error = emmy_io::mesh::read(&folder.join("main.bdf")).unwrap_err().to_string();
    assert!(
        error.contains("main.bdf, line 1: the file ") && error.contains("main.bdf includes itself;"),
        "{error}"
    );
    write("main.bdf", "INCLUDE 'other.bulk'\n");
    write("other.bulk", "$ one\nINCLUDE 'a long/../main.bdf'\n");
    let error = emmy_io::mesh::read(&folder.join("main.bdf")).unwrap_err().to_string();
    assert!(
        error.contains("other.bulk, line 2: ") && error.contains("includes itself through another file"),
        "{error}"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn missing_midside_nodes_are_put_on_their_edges() {
    let sheet = "GRID,1,,0,0,0.\nGRID,2,,1,0,0.\nGRID,3,,1,1,0.\nGRID,4,,0,1,0.\nGRID,5,,0.5,0,0.\nGRID,7,,0.5,1,0.\n\
                 GRID,8,,0,0.5,0.\nCQUAD8,1,7,1,2,3,4,5,\n,7,8,,,,,90.\nENDDATA\n";
    let file = parse_text("a.bdf", sheet).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Quad8, 1)]);
    assert!(close(file.mesh.points()[file.mesh.cell(0).nodes[5] as usize], [1.0, 0.5, 0.0]));
    has_note(&file.notes, "1 midside node was missing, and is put at the middle of the edge");
    let nine = sheet
        .replace("GRID,8", "GRID,9,,0.4,0.6,0.\nGRID,8")
        .replace("CQUAD8", "CQUAD9")
        .replace("7,8,,", "7,8,9,");
    let file = parse_text("a.bdf", &nine).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Quad9, 1)]);
    let places = [5, 8].map(|i| file.mesh.points()[file.mesh.cell(0).nodes[i] as usize]);
    assert!(close(places[0], [1.0, 0.5, 0.0]) && close(places[1], [0.4, 0.6, 0.0]), "{places:?}");
    // Two tetrahedra at the face 1, 2, 3: one new node on its edge 2-3, which both have; the edge 1-3 has one already.
    let text = format!(
        "{TET}GRID,5,,0.,0.,-2.\nGRID,6,,1.,0.,0.\nGRID,7,,0.,1.,0.\nCTETRA,1,3,1,2,3,4,6,0\n,7\nCTETRA,2,3,1,3,2,5,\n,6\nENDDATA\n"
    );
    let file = parse_text("a.bdf", &text).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet10, 2)]);
    // Five corners and nine edges.
    assert_eq!(file.mesh.n_nodes(), 5 + 9);
    assert_straight(&file.mesh);
    has_note(&file.notes, "7 midside nodes were missing, and are put at the middle of the edge");
    // A linear cell does not follow the new nodes of the face.
    let text = text.replace("CTETRA,2,3,1,3,2,5,\n,6\n", "CTETRA,2,3,1,3,2,5\n");
    let file = parse_text("a.bdf", &text).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet4, 1), (CellKind::Tet10, 1)]);
    has_note(&file.notes, "edge; 1 linear cell lies at these edges, not joined to the new nodes");
}

/// Three squares of one property.
const SHEET: &str = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,2.,0.,0.\nGRID,4,,0.,1.,0.\nGRID,5,,1.,1.,0.\nGRID,6,,2.,1.,0.\n\
    GRID,7,,3.,0.,0.\nGRID,8,,3.,1.,0.\nCQUAD4,1,7,1,2,5,4\nCQUAD4,2,7,2,3,6,5\nCQUAD4,3,7,3,7,8,6\nMAT1,1,2.1+11,,.3,7850.\n";

#[test]
fn shells_are_plane_strain_on_request_only() {
    let plane = MeshOptions { plane_shells: true, ..MeshOptions::default() };
    let area = |properties: &str, options: &MeshOptions| {
        let text = format!("{SHEET}{properties}ENDDATA\n");
        parse_with("a.bdf".as_ref(), text.as_bytes(), options)
            .map(|file| (emmy::mesh::quality(&file.mesh).volume, file.notes))
    };
    for shell in ["PSHELL,7,1,0.01,1,,1\n", "PCOMP,7\n,1,.1,45.\n"] {
        let error = area(shell, &MeshOptions::default()).unwrap_err().to_string();
        let card = &shell[..shell.find(',').unwrap()];
        assert!(
            error.contains(&format!("a.bdf, line 9: element 1 (CQUAD4) is a shell with {card} 7")),
            "{error}"
        );
        assert!(error.contains("shells = \"plane-strain\""), "{error}");
        let (area, notes) = area(shell, &plane).unwrap();
        assert!((area - 3.0).abs() < 1e-15);
        assert_eq!(notes, ["3 shells are read as cells in plane strain; their thickness is not read"]);
    }
    let (_, notes) = area("", &MeshOptions::default()).unwrap();
    assert_eq!(notes, ["3 elements without PSHELL or PCOMP are read as cells in plane strain"]);
    // Properties that say plane strain themselves.
    for property in ["PLPLANE,7,1\n", "PSHELL,7,1,.1,-1\n"] {
        assert_eq!(area(property, &MeshOptions::default()).unwrap().1, Vec::<String>::new());
    }
}

#[test]
fn what_is_beside_the_cells_is_left_out_and_its_sets_are_groups() {
    let nodes = grids("", |point| point);
    let text = format!(
        "{nodes}{CELLS}PSOLID,1,1\nGRID,21,,5.,0.,0.\nGRID,22,,6.,0.,0.\nGRID,23,,6.,1.,0.\nGRID,24,,5.,1.,0.\n$ Femap Property 4 : cover\n\
         CQUAD4,11,4,21,22,23,24\nCQUAD4,12,4,10,9,22,23\nPSHELL,4,1,.1\nCQUAD4,13,5,9,10,12,11\nCELAS1,21,6,9,1,10,1\nPELAS,6,100.\n\
         CBUSH,22,7,11\nCBEAM,23,8,1,21\nPBEAML,8,1\nCONM2,24,3,,2.5\nMPC,1,9,1,1.,10,1,-1.\nTEMPD,1,20.\nTIC,1,9,1,.1\nPLOAD4,1,1,2.\nSPC1,5,12,1,THRU,4,9\nFOO,1\nENDDATA\n"
    );
    let file = parse_text("a.bdf", &text).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Hex8, 2)]);
    assert!((volume(&file.mesh) - 2.0).abs() < 1e-15);
    let groups = file.mesh.groups();
    let names = ["conm2_24-node", "cover", "pid_1", "pid_5", "pid_6", "pid_7", "pid_8", "spc_5"];
    assert_eq!(groups.names(), names);
    assert_eq!((groups.facets("pid_5").unwrap().len(), groups.nodes["cover"].len()), (1, 2));
    assert_eq!(
        (groups.nodes["pid_6"].len(), groups.nodes["pid_7"].len(), groups.nodes["pid_8"].len()),
        (2, 1, 1)
    );
    assert_eq!(groups.nodes["spc_5"].len(), 5);
    let left_out = "1 CBEAM, 1 PLOAD4, 1 TEMPD, 1 TIC";
    has_note(
        &file.notes,
        "CELAS1: 1 is left out (21): its component is not along the line between its grid points",
    );
    has_note(&file.notes, "MPC: 1 is left out (grid point 9): they are not one for each");
    has_note(&file.notes, &format!("left out, though it may change the motion: 2 CQUAD4, {left_out}"));
    has_note(&file.notes, "not known, and left out: 1 FOO");
    has_note(&file.notes, "1 constraint (SPC1) fixes nothing without a `support`: groups spc_5");
}

#[test]
fn constraints_of_grid_points_are_groups() {
    let mut nodes = grids("", |point| point).replace("GRID,1,,0.0,0.0,0.0\n", "GRID,1,,0.,0.,0.,,3456\n");
    nodes = nodes.replace("GRID,2,,1.0,0.0,0.0\n", "GRID,2,,1.,0.,0.,,0\n");
    let file = parse_text("a.bdf", &format!("{nodes}{CELLS}ENDDATA\n")).unwrap();
    assert_eq!(file.mesh.groups().nodes["ps_3"], [0]);
    let file = parse_text("a.bdf", &format!("GRDSET,,,,,,,21456\n{nodes}{CELLS}ENDDATA\n")).unwrap();
    assert_eq!((file.mesh.groups().nodes["ps_3"].len(), file.mesh.groups().nodes["ps_12"].len()), (1, 10));
    has_note(&file.notes, "11 constraints (GRID) fix nothing without a `support`: groups ps_12, ps_3");
    // In a plane, z is fixed anyway.
    let sheet = SHEET
        .replace("GRID,1,,0.,0.,0.", "GRID,1,,0.,0.,0.,,3")
        .replace("GRID,2,,1.,0.,0.", "GRID,2,,1.,0.,0.,,13");
    let file = parse_text("a.bdf", &format!("{sheet}ENDDATA\n")).unwrap();
    assert_eq!((file.mesh.groups().nodes.len(), &file.mesh.groups().nodes["ps_1"][..]), (1, &[1][..]));
    // Links are in space.
    let truss = "GRID,1,,0.,0.,0.,,13\nGRID,2,,1.,0.,2.,,3\nCROD,1,4,1,2\nENDDATA\n";
    let file = parse_with("a.bdf".as_ref(), truss.as_bytes(), &links("pid_4")).unwrap();
    let nodes = &file.mesh.groups().nodes;
    assert_eq!((nodes.len(), &nodes["ps_13"][..], &nodes["ps_3"][..]), (2, &[0][..], &[1][..]));
}

#[test]
fn a_file_that_is_cut_off_has_a_note() {
    let text = format!("{}{CELLS}ENDDATA\n", grids("", |point| point));
    let notes = |text: &str| parse_text("a.bdf", text).unwrap().notes;
    assert_eq!(notes(&text), Vec::<String>::new());
    let cut = text.find("CHEXA,2").unwrap();
    has_note(&notes(&text[..cut]), "a.bdf: there is no ENDDATA at the end; is the file cut off?");
    let announced =
        text[..cut].replace("CHEXA,1,1,1,2,3,4,5,6\n,7,8", "CHEXA,1,1,1,2,3,4,5,6,+A\n+A,7,8,,,,,,,+B");
    has_note(&notes(&announced), "a.bdf, line 14: 1 line announces a continuation that is not there");
    has_note(&notes(&format!("+Q,7\n{text}GRID,99\n")), "a.bdf, line 1: 1 line continues no card");
    has_note(&notes(&format!("{text}GRID,99\n")), "a.bdf, line 18: 1 line after ENDDATA is not read");
}

#[test]
fn an_input_asks_for_shells_in_plane_strain() {
    let folder = std::env::temp_dir().join(format!("emmy-nastran-shells-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("sheet.bdf"), format!("{SHEET}PSHELL,7,1,.01\nENDDATA\n")).unwrap();
    let read = |mesh: &str| {
        let rest = "[[region]]\ndensity = 1.0\nmaterial.neo-hooke = { youngs_modulus = 1000.0, poissons_ratio = 0.3 }\n\
                    [time]\nscheme = \"DGM\"\nsteps = [{ until = 1.0, size = 0.1 }]\n";
        std::fs::write(folder.join("input.toml"), format!("[mesh]\n{mesh}\n{rest}")).unwrap();
        let problem = emmy_io::input::read(&folder.join("input.toml"), &emmy_io::input::Overrides::default());
        problem.map(|problem| problem.body.mesh().n_cells()).map_err(|error| error.to_string())
    };
    let file = "file = \"sheet.bdf\"";
    assert!(read(file).unwrap_err().contains("element 1 (CQUAD4) is a shell with PSHELL 7"));
    assert_eq!(read(&format!("{file}\nshells = \"plane-strain\"")), Ok(3));
    let other = read(&format!("{file}\nshells = \"plane-stress\"")).unwrap_err();
    assert!(
        other.contains("`plane-stress` is not a treatment of shells; there is `plane-strain`"),
        "{other}"
    );
    let built_in = "rectangle = { size = [1, 1], cells = [1, 1] }\nshells = \"plane-strain\"";
    assert!(read(built_in).unwrap_err().contains("`shells` is a key of mesh files"));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn ends_of_springs_have_a_group_of_their_own() {
    let springs = [
        "CELAS1,5,1,1,1",
        "CELAS1,5,1,1,1,2,1",
        "CDAMP1,5,1,1,1",
        "CMASS1,5,1,1,1",
        "CBUSH,5,1,1,,,,,0",
        "CGAP,5,1,1",
        "CBUSH1D,5,1,1",
    ];
    for spring in springs {
        let text = format!("{TET}CTETRA,1,1,1,2,3,4\nPSOLID,1,1\n{spring}\nENDDATA\n");
        let file = parse_text("a.bdf", &text).unwrap();
        assert_eq!(file.mesh.group_nodes("pid_1").unwrap().len(), 4, "{spring}");
        let n_ends = if spring.ends_with(",2,1") { 2 } else { 1 };
        assert_eq!(file.mesh.groups().nodes["pid_1-ends"].len(), n_ends, "{spring}");
        // Without solid cells of that number it is free.
        let file = parse_text("a.bdf", &text.replace("CTETRA,1,1,", "CTETRA,1,7,")).unwrap();
        assert_eq!(file.mesh.groups().names(), ["pid_1", "pid_7"], "{spring}");
    }
}

#[test]
fn continuations_that_belong_to_nothing_have_a_note() {
    let text = format!("{}{CELLS}ENDDATA\n", grids("", |point| point));
    let after = |card: &str, line: &str| {
        let text = text.replacen(card, &format!("{card}{line}"), 1);
        let file = parse_text("a.bdf", &text).unwrap();
        assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Hex8, 2)], "{line}");
        assert!((volume(&file.mesh) - 2.0).abs() < 1e-15);
        file.notes
    };
    let stray =
        |line: usize| format!("a.bdf, line {line}: 1 line continues no card, here for the first time");
    let grid = "GRID,3,,1.0,1.0,0.0\n";
    assert_eq!(after(grid, "+Q,1,2,3\n"), [stray(4)]);
    assert_eq!(after(",7,8\n", "+ZZ,1,2\n"), [stray(15)]);
    // A blank mark belongs to the card above, which has no second line.
    for line in ["+,1,2,3\n", ",1,2,3\n", "        5\n"] {
        let note = "a.bdf, line 3: 1 card has fields after the last one of its kind, which are not read, here for the first time";
        assert_eq!(after(grid, line), [note], "{line}");
    }
    for line in ["+\n", ",,\n", "*\n"] {
        assert_eq!(after(grid, line), [""; 0], "{line}");
    }
}

#[test]
fn cells_of_meshio_are_those_of_the_guide() {
    // As meshio 5.3.5 writes a cell of ten nodes, with its fields after a blank property.
    let points: Vec<[f64; 3]> = {
        let (_, _, corners, edges, _) = SOLIDS[2];
        let middle = |&[a, b]: &[usize; 2]| [0, 1, 2].map(|i| (corners[a - 1][i] + corners[b - 1][i]) / 2.0);
        corners.iter().copied().chain(edges.iter().map(middle)).collect()
    };
    let grid = |(index, [x, y, z]): (usize, &[f64; 3])| {
        format!("GRID*   {:<32}{x:>16.1}{y:>16.1}\n*       {z:>16.1}\n", index + 1)
    };
    let grids: String = points.iter().enumerate().map(grid).collect();
    let cell = "CTETRA_ 1               1       2       3       4       5       6       +11     \n\
                +11     7       8       9       10      \n";
    let file = parse_text(
        "a.bdf",
        &format!("$ Nastran file written by meshio v5.3.5\nBEGIN BULK\n{grids}{cell}ENDDATA\n"),
    );
    let file = file.unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Tet10, 1)]);
    assert_straight(&file.mesh);
    assert!((volume(&file.mesh) - 1.0 / 6.0).abs() < 1e-15 && file.notes.is_empty(), "{:?}", file.notes);
}

#[test]
fn a_list_of_grid_points_may_leave_some_out() {
    let text = |spc: &str| format!("{}{CELLS}{spc}ENDDATA\n", grids("", |point| point));
    let file = parse_text("a.bdf", &text("SPC1,5,1,5,THRU,12,EXCEPT,7\n")).unwrap();
    assert_eq!(file.mesh.groups().nodes["spc_5"], [4, 5, 7, 8, 9, 10, 11]);
    let file = parse_text("a.bdf", &text("SPC1,5,1,5,FOO\n")).unwrap();
    assert_eq!(file.mesh.groups().nodes["spc_5"], [4]);
    has_note(&file.notes, "a.bdf, line 17: the field FOO of SPC1 is not read");
}

#[test]
fn pyramids_of_gmsh_have_its_own_order() {
    // As Gmsh 4 writes its own reference pyramid, whose base is a square of side 2 and whose height is 1.
    let points = "-1.00000-1.000000.00E+00 1.000000-1.000000.00E+00 1.0000001.0000000.00E+00 -1.000001.0000000.00E+00 \
                  0.00E+000.00E+001.000000 0.00E+00-1.000000.00E+00 -1.000000.00E+000.00E+00 -0.50000-0.500000.500000 \
                  1.0000000.00E+000.00E+00 0.500000-0.500000.500000 0.00E+001.0000000.00E+00 0.5000000.5000000.500000 \
                  -0.500000.5000000.500000";
    let grids =
        points.split(' ').zip(1..).map(|(point, number)| format!("GRID    {number:<8}0       {point}\n"));
    let cell = "CPYRAM  1       1       1       2       3       4       5       6       +E1     \n\
                +E1     7       8       9       10      11      12      13      \n";
    let text = format!("$ Created by Gmsh\n{}{cell}ENDDATA\n", grids.collect::<String>());
    let file = parse_text("a.bdf", &text).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Pyramid13, 1)]);
    assert_straight(&file.mesh);
    assert!((volume(&file.mesh) - 4.0 / 3.0).abs() < 1e-15 && file.notes.is_empty(), "{:?}", file.notes);
}
