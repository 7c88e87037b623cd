//! VTU files written by VTK and meshio (`meshes/generate_vtu.py`), and Emmy's own frames read back.

use std::path::Path;

use crate::meshes::{assert_plane, assert_straight, parse_text, path, read, volume};
use emmy::body::{FieldName, FieldValues};
use emmy::mesh::{CellKind, Facet, Mesh};
use emmy_io::vtk::{FrameFiles, Precision};

const WAYS: [&str; 11] = [
    "vtk-ascii",
    "vtk-inline-plain",
    "vtk-inline-zlib",
    "vtk-raw-plain",
    "vtk-raw-zlib",
    "vtk-base64-plain",
    "vtk-base64-zlib",
    "vtk-big-endian",
    "meshio-ascii",
    "meshio-plain",
    "meshio-zlib",
];

/// The array of real numbers.
const LEFT_OUT: &str =
    "arrays that are left out, because they have other values than up to 64 whole numbers: quality";

const MIRRORED: &str = "1 cell was numbered the other way round (negative volume) and turned";

fn kinds(mesh: &Mesh) -> Vec<CellKind> {
    mesh.cells().map(|cell| cell.kind).collect()
}

fn assert_groups(mesh: &Mesh) {
    let groups = mesh.groups();
    assert_eq!(groups.cells("top").unwrap(), [1]);
    assert_eq!(groups.cells("region=0").unwrap(), [0, 1]);
    assert_eq!(groups.cells("region=1").unwrap(), [2, 3]);
    assert_eq!(groups.facets("left").unwrap(), [Facet { cell: 0, local: 0 }]);
    assert_eq!(groups.facets("bottom").unwrap(), [Facet { cell: 0, local: 4 }]);
    assert_eq!(groups.nodes["apex"], [8]);
    assert_eq!(groups.names(), ["apex", "bottom", "left", "region=0", "region=1", "region=5", "top"]);
    assert_eq!(groups.facets("region=5").unwrap(), groups.facets("bottom").unwrap());
    assert_plane(mesh, "left", 0, 0.0);
    assert_plane(mesh, "bottom", 2, 0.0);
}

#[test]
fn one_mesh_is_the_same_in_every_way_of_writing() {
    for way in WAYS {
        let file = read(&format!("{way}.vtu"));
        assert_eq!(
            kinds(&file.mesh),
            [CellKind::Hex8, CellKind::Pyramid5, CellKind::Wedge6, CellKind::Tet4],
            "{way}"
        );
        assert!((volume(&file.mesh) - 2.0).abs() < 1e-14);
        assert_groups(&file.mesh);
        assert_eq!(file.mesh, read("vtk-ascii.vtu").mesh, "{way}");
        // meshio reverses the wedges of VTK.
        let notes: &[&str] = if way.starts_with("meshio") { &[LEFT_OUT, MIRRORED] } else { &[LEFT_OUT] };
        assert_eq!(file.notes, notes, "{way}");
    }
}

#[test]
fn a_wedge_may_have_its_base_the_other_way_round() {
    let file = read("mirrored.vtu");
    assert_eq!(file.mesh.cell(2).nodes, [1, 9, 2, 5, 10, 6]);
    assert_eq!(file.notes, [LEFT_OUT, MIRRORED]);
    assert_groups(&file.mesh);
}

#[test]
fn quadratic_cells_and_voxels_have_their_nodes_where_vtk_has_them() {
    let file = read("quadratic.vtu");
    assert_eq!(
        kinds(&file.mesh),
        [CellKind::Hex20, CellKind::Hex27, CellKind::Tet10, CellKind::Wedge15, CellKind::Hex8]
    );
    assert_straight(&file.mesh);
    assert!((volume(&file.mesh) - 1.0 - 1.0 - 1.0 / 6.0 - 0.5 - 1.0).abs() < 1e-14);
}

#[test]
fn lagrange_cells_of_two_orders_have_their_nodes_where_vtk_has_them() {
    // The version of the legacy file has the order of the edges of a hexahedron before VTK 9.
    for name in ["lagrange.vtu", "lagrange-old.vtk"] {
        let file = read(name);
        assert_eq!(
            kinds(&file.mesh),
            [CellKind::Hex8, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10, CellKind::Wedge6]
        );
        assert_straight(&file.mesh);
        assert!((volume(&file.mesh) - 1.0 - 1.0 - 1.0 / 6.0 - 1.0 / 6.0 - 0.5).abs() < 1e-6, "{name}");
    }
}

#[test]
fn legacy_files_have_the_same_mesh() {
    for name in ["legacy-42-ascii", "legacy-42-binary", "legacy-51-ascii", "legacy-51-binary"] {
        let file = read(&format!("{name}.vtk"));
        assert_eq!(file.mesh, read("vtk-ascii.vtu").mesh, "{name}");
        assert_eq!(file.notes, [format!("{LEFT_OUT}, a name of parts")], "{name}");
    }
}

#[test]
fn regular_grids_of_legacy_files_have_a_cell_for_each_cell() {
    for name in ["legacy-points", "legacy-rectilinear", "legacy-structured"] {
        let mesh = read(&format!("{name}.vtk")).mesh;
        assert_eq!((kinds(&mesh), mesh.n_nodes()), (vec![CellKind::Hex8; 12], 36), "{name}");
        assert!((volume(&mesh) - 12.0).abs() < 1e-12);
        for cell in mesh.cells() {
            assert!((crate::meshes::cell_volume(&mesh, cell) - 1.0).abs() < 1e-12, "{name}");
        }
        assert_eq!(mesh.groups().cells("material=1").unwrap(), [0, 1, 2, 3, 4, 5]);
        assert_eq!(mesh.groups().names(), ["material=1", "material=2"]);
    }
}

#[test]
fn pieces_are_joined_without_their_ghost_cells() {
    let whole = read("vtk-ascii.vtu").mesh;
    let ghost = "1 ghost or hidden cell is left out";
    // The second piece of the first file has the brick again; the files share its face and an edge of its neighbours.
    for (name, joined, ghost) in [("two-pieces.vtu", 8, Some(ghost)), ("parallel.pvtu", 6, None)] {
        let file = read(name);
        let mesh = &file.mesh;
        assert_eq!((kinds(mesh), mesh.n_nodes()), (kinds(&whole), whole.n_nodes()), "{name}");
        assert!((volume(mesh) - 2.0).abs() < 1e-14, "{name}");
        assert_groups(mesh);
        let note = format!("2 pieces of the grid are joined; {joined} repeated nodes are left out");
        let notes: Vec<String> =
            [Some(note.as_str()), ghost, Some(LEFT_OUT)].into_iter().flatten().map(str::to_string).collect();
        assert_eq!(file.notes, notes);
    }
    assert_eq!(read("parallel.pvtu").files.len(), 3);
}

#[test]
fn bad_legacy_files_are_told_with_their_line() {
    let ascii = std::fs::read_to_string(path("legacy-51-ascii.vtk")).unwrap();
    let cases: [(&str, &str, &[&str]); 8] = [
        ("DataFile Version", "DataFile", &["a.vtk, line 1: the first line is not"]),
        ("ASCII", "TEXT", &["a.vtk, line 3: expected ASCII or BINARY"]),
        (
            "UNSTRUCTURED_GRID",
            "POLYDATA",
            &["a.vtk, line 4: DATASET POLYDATA is not read, only UNSTRUCTURED_GRID"],
        ),
        ("POINTS 12", "POINTS 99999999", &["a.vtk, line 6: 299999997 numbers are announced, but the rest"]),
        ("CELL_TYPES 5", "CELL_TYPES 4", &["the keyword 9 is not known"]),
        ("CELL_DATA 5", "CELL_SETS 5", &["the keyword CELL_SETS is not known"]),
        ("CONNECTIVITY", "NODES", &["CELLS without CONNECTIVITY"]),
        ("OFFSETS vtktypeint64", "OFFSETS complex", &["numbers of type complex are not read"]),
    ];
    for (from, to, parts) in cases {
        assert!(ascii.contains(from), "{from} is not in the file");
        let message = parse_text("a.vtk", &ascii.replacen(from, to, 1)).expect_err(from).to_string();
        for part in parts {
            assert!(message.contains(part), "\"{part}\" is not in: {message}");
        }
    }
    // Cut anywhere, a binary file is an error or the mesh without its last arrays; it never panics.
    let binary = crate::meshes::bytes("legacy-51-binary.vtk");
    for n in 0..binary.len() {
        let _ = emmy_io::mesh::parse("a.vtk".as_ref(), &binary[..n]);
    }
}

/// The frame of a mesh at rest, as written by a run.
fn frame(mesh: &Mesh, directory: &Path) -> Mesh {
    let (n, region_of_cell) = (mesh.n_dofs(), vec![0; mesh.n_cells()]);
    let displacement = FieldValues { name: FieldName::Displacement, numbers: vec![0.0; n] };
    let mut frames =
        FrameFiles::create(&directory.join("out"), Precision::Double, mesh, &region_of_cell).unwrap();
    frames.write(0, 0.0, &[displacement]).unwrap();
    emmy_io::mesh::read(&directory.join("out/frames/out_000000.vtu")).unwrap().mesh
}

#[test]
fn frames_come_back_as_the_mesh_with_all_its_groups() {
    let names = ["hex8", "hex20", "hex27", "tet4", "tet10", "wedge6", "wedge15", "mixed", "quadratic-mixed"];
    let files = names.map(|name| format!("{name}-41-binary.msh"));
    for name in files.iter().map(String::as_str).chain(["wedges.inp", "assembly.inp"]) {
        let (mesh, temp) = (read(name).mesh, tempfile::tempdir().unwrap());
        let back = frame(&mesh, temp.path());
        assert_eq!(back.points(), mesh.points(), "{name}");
        assert!(back.cells().eq(mesh.cells()), "{name}");
        let mut groups = back.groups().clone();
        // The number of the region is an array too.
        assert_eq!(groups.cells.remove("region=0").unwrap().len(), mesh.n_cells());
        assert_eq!(&groups, mesh.groups(), "{name}");
    }
}

#[test]
fn group_names_may_hold_any_character() {
    let mut builder = emmy::mesh::MeshBuilder::new();
    let nodes = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|p| builder.point(p));
    builder.cell(CellKind::Tet4, &nodes).unwrap();
    builder.node_group("a \"b\" <c> & d'é", [2]);
    let (mesh, temp) = (builder.build().unwrap(), tempfile::tempdir().unwrap());
    assert_eq!(frame(&mesh, temp.path()).groups().nodes, mesh.groups().nodes);
}

#[test]
fn bad_files_are_told_with_their_line() {
    let ascii = std::fs::read_to_string(path("vtk-ascii.vtu")).unwrap();
    let cases: [(&str, &str, &[&str]); 11] = [
        ("<UnstructuredGrid>", "<PolyData>", &["a.vtu, line 61", "the XML cannot be read"]),
        (
            "NumberOfCells=\"5\"",
            "NumberOfCells=\"6\"",
            &["a.vtu, line 56: array \"types\": 5 numbers instead of 6"],
        ),
        ("NumberOfPoints=\"12\"", "", &["line 3: <Piece> without its NumberOfPoints"]),
        ("NumberOfCells=\"5\"", "NumberOfCells=\"0\"", &["a.vtu: the mesh has no solid or plane cells"]),
        ("format=\"ascii\"", "format=\"binary\"", &["line 5: array \"group:apex\"", "bytes are announced"]),
        ("0 0 1 1 5", "0 0 x 1 5", &["array \"region\": expected a number, found \"x\""]),
        (
            "12 14 13 10 9",
            "12 14 13 42 9",
            &["a.vtu: cell 3 (counted from 0) is of VTK type 42 (polyhedron of 4"],
        ),
        ("8 13 19 23 27", "8 13 20 23 27", &["cell 2 of type 13 ends at 20 instead of 19"]),
        ("0.5 0.5 2", "0.5 0.5 nan", &["coordinate", "not a finite number"]),
        ("0 1 2 3 4 5", "0 1 2 3 4 99", &["a cell names node 99, of 12"]),
        ("header_type", "compressor=\"vtkLZ4DataCompressor\" header_type", &["save it compressed by ZLib"]),
    ];
    for (from, to, parts) in cases {
        assert!(ascii.contains(from), "{from} is not in the file");
        let message = parse_text("a.vtu", &ascii.replacen(from, to, 1)).expect_err(from).to_string();
        for part in parts {
            assert!(message.contains(part), "\"{part}\" is not in: {message}");
        }
    }
    let html = parse_text("a.vtu", "<html></html>").unwrap_err().to_string();
    assert!(html.contains("a.vtu, line 1: no unstructured grid of VTK"), "{html}");
    for (kind, part) in [("ImageData", "legacy file of VTK (.vtk)"), ("PolyData", "UnstructuredGrid file")] {
        let text = format!("<VTKFile type=\"{kind}\" version=\"1.0\"><{kind}/></VTKFile>");
        let message = parse_text("a.vti", &text).unwrap_err().to_string();
        assert!(
            message.starts_with(&format!("a.vti, line 1: no unstructured grid of VTK, but {kind}; ")),
            "{message}"
        );
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn texts_of_legacy_files_follow_their_head_and_need_no_line_after_them() {
    let ascii = std::fs::read_to_string(path("legacy-51-ascii.vtk")).unwrap();
    let texts = "CELL_DATA 5\nFIELD FieldData 1\nnames 1 5 string\na%20b\n\nc\nd\ne\n";
    let with_texts = parse_text("a.vtk", &ascii.replacen("CELL_DATA 5\n", texts, 1)).unwrap();
    let without = read("legacy-51-ascii.vtk");
    assert_eq!(with_texts.mesh, without.mesh);
    assert!(with_texts.notes.iter().any(|note| note.contains("names")), "{:?}", with_texts.notes);
}
