//! Gmsh files written by Gmsh (`meshes/generate.py`), and a few by hand.

use crate::meshes::{assert_plane, assert_straight, close, parse_text, read, volume};
use emmy::mesh::{CellKind, Mesh};
use emmy_io::mesh::parse;

const FORMATS: [&str; 4] = ["22-ascii", "22-binary", "41-ascii", "41-binary"];

/// Kind, nodes, cells, facets at an end, facets of the skin, nodes of the edge.
const MESHES: [(CellKind, usize, usize, usize, usize, usize); 7] = [
    (CellKind::Hex8, 18, 4, 2, 6, 3),
    (CellKind::Hex20, 51, 4, 2, 6, 5),
    (CellKind::Hex27, 75, 4, 2, 6, 5),
    (CellKind::Tet4, 23, 48, 4, 12, 3),
    (CellKind::Tet10, 113, 48, 4, 12, 5),
    (CellKind::Wedge6, 15, 8, 4, 6, 3),
    (CellKind::Wedge15, 49, 8, 4, 6, 5),
];

#[test]
fn every_kind_in_every_format_has_its_cells_and_groups() {
    for (kind, n_nodes, n_cells, n_end, n_skin, n_edge) in MESHES {
        for format in FORMATS {
            let file = read(&format!("{kind}-{format}.msh"));
            let mesh = &file.mesh;
            assert_eq!((mesh.n_nodes(), mesh.n_cells()), (n_nodes, n_cells), "{kind} {format}");
            assert!(mesh.cells().all(|cell| cell.kind == kind));
            assert!((volume(mesh) - 2.0).abs() < 1e-12);
            assert_straight(mesh);
            assert_groups(mesh, n_end, n_skin, n_edge);
            assert!(file.notes.is_empty(), "{:?}", file.notes);
        }
    }
}

fn assert_groups(mesh: &Mesh, n_end: usize, n_skin: usize, n_edge: usize) {
    let groups = mesh.groups();
    let half = mesh.n_cells() / 2;
    let n_cells = ["left part", "right part", "whole"].map(|name| groups.cells(name).unwrap().len());
    assert_eq!(n_cells, [half, half, 2 * half]);
    let n_facets = ["clamp", "tip", "7", "skin"].map(|name| groups.facets(name).unwrap().len());
    assert_eq!(n_facets, [n_end, n_end, n_end, n_skin]);
    assert_eq!([groups.nodes["edge"].len(), groups.nodes["corner"].len()], [n_edge, 1]);
    assert_eq!(groups.names().len(), 9);
    assert_plane(mesh, "clamp", 0, 0.0);
    assert_plane(mesh, "7", 0, 1.0);
    assert_plane(mesh, "tip", 0, 2.0);
    assert_plane(mesh, "edge", 1, 0.0);
    assert_plane(mesh, "edge", 2, 0.0);
    assert!(close(mesh.points()[groups.nodes["corner"][0] as usize], [0.0; 3]));
}

#[test]
fn one_mesh_is_the_same_in_all_formats() {
    for (kind, ..) in MESHES {
        let first = read(&format!("{kind}-41-binary.msh")).mesh;
        for format in FORMATS {
            let other = read(&format!("{kind}-{format}.msh")).mesh;
            assert!(first.cells().eq(other.cells()), "{kind} {format}");
            assert_eq!(first.groups(), other.groups(), "{kind} {format}");
            // ASCII files have 16 digits.
            assert!(first.points().iter().zip(other.points()).all(|(a, b)| close(*a, *b)));
        }
    }
}

#[test]
fn kinds_are_mixed_with_triangles_and_quadrilaterals_between_them() {
    let linear = ("mixed", [CellKind::Hex8, CellKind::Pyramid5, CellKind::Tet4]);
    let quadratic = ("quadratic-mixed", [CellKind::Hex20, CellKind::Pyramid13, CellKind::Tet10]);
    for ((name, kinds), format) in [linear, quadratic].into_iter().flat_map(|mesh| FORMATS.map(|f| (mesh, f)))
    {
        let file = read(&format!("{name}-{format}.msh"));
        let (mesh, groups) = (&file.mesh, file.mesh.groups());
        let count = |kind| mesh.cells().filter(|cell| cell.kind == kind).count();
        assert_eq!(kinds.map(count), [1, 1, 24]);
        assert_straight(mesh);
        assert!((volume(mesh) - 2.0).abs() < 1e-12);
        assert!(emmy::mesh::quality(mesh).inverted.is_empty());
        // The face of the hexahedron below the pyramid is found once, as a face of the first cell.
        let n_facets = ["clamp", "tip", "7", "skin"].map(|name| groups.facets(name).unwrap().len());
        assert_eq!(n_facets, [1, 4, 1, 9]);
        for (name, value) in [("clamp", 0.0), ("7", 1.0), ("tip", 2.0)] {
            assert_plane(mesh, name, 0, value);
        }
        assert!(file.notes.is_empty(), "{:?}", file.notes);
    }
}

#[test]
fn parametric_coordinates_and_partitions_change_nothing() {
    let plain = read("hex20-41-ascii.msh").mesh;
    assert_eq!(read("parametric.msh").mesh, plain);
    for name in ["partitioned-22.msh", "partitioned-41.msh", "partitioned-41-binary.msh"] {
        let mesh = read(name).mesh;
        assert_eq!((mesh.n_nodes(), mesh.n_cells()), (51, 4));
        assert_straight(&mesh);
        assert_groups(&mesh, 2, 6, 5);
    }
}

#[test]
fn other_versions_are_read_as_well() {
    let plain = read("hex20-41-ascii.msh").mesh;
    let same = |name: &str| {
        let mesh = read(name).mesh;
        assert_eq!((mesh.n_nodes(), mesh.n_cells()), (51, 4), "{name}");
        assert!((volume(&mesh) - 2.0).abs() < 1e-12, "{name}");
        assert_straight(&mesh);
        mesh
    };
    for name in ["hex20-40-ascii.msh", "hex20-40-binary.msh", "parametric-22.msh", "parametric-40.msh"] {
        assert_groups(&same(name), 2, 6, 5);
    }
    assert_groups(&same("partitioned-40.msh"), 2, 6, 5);
    // MSH 1 has no names: the groups have their numbers.
    let groups = same("hex20-1.msh").groups().clone();
    for (number, name) in [("1", "left part"), ("2", "right part"), ("3", "whole")] {
        assert_eq!(groups.cells[number].len(), plain.groups().cells[name].len());
    }
    for (number, name) in [("4", "clamp"), ("5", "tip"), ("6", "skin"), ("7", "7")] {
        assert_eq!(groups.facets[number].len(), plain.groups().facets[name].len());
    }
    assert_eq!((groups.nodes["8"].len(), groups.nodes["9"].len()), (5, 1));
}

/// A tetrahedron in MSH 2.x, with a name.
fn tetrahedron(version: &str, name: &str) -> String {
    format!(
        "$MeshFormat\n{version} 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n{name}\n$EndPhysicalNames\n\
         $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"
    )
}

#[test]
fn versions_2_differ_in_their_names_alone_which_lose_trailing_blanks() {
    for (version, name) in [
        ("2", "1 \"body\""),
        ("2.0", "1 \"body  \""),
        ("2.0", "3 1 \"body\""),
        ("2.1", "3 1 \"body\""),
        ("2.2", "3 1 \"body          \""),
    ] {
        let file = parse_text("a.msh", &tetrahedron(version, name)).unwrap();
        assert_eq!(file.mesh.groups().cells("body").unwrap(), [0], "{version}");
        assert!((volume(&file.mesh) - 1.0 / 6.0).abs() < 1e-15 && file.notes.is_empty(), "{:?}", file.notes);
    }
}

/// Two cubes with a common facet, and a quadrilateral `cover` away from them.
const COVER: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n3 1 \"beam\"\n2 2 \"cover\"\n2 3 \"end\"
$EndPhysicalNames\n$Nodes\n16\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 2 0 0\n10 2 1 0\n11 2 0 1\n12 2 1 1
21 5 0 0\n22 6 0 0\n23 6 1 0\n24 5 1 0\n$EndNodes\n$Elements\n5\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 5 2 1 1 2 9 10 3 6 11 12 7
11 3 2 2 2 21 22 23 24\n12 3 2 3 3 9 10 12 11\n13 3 2 3 3 2 9 12 7\n$EndElements\n";

#[test]
fn surfaces_that_are_no_face_of_a_cell_are_left_out_and_counted() {
    let file = parse_text("frame.msh", COVER).unwrap();
    let groups = file.mesh.groups();
    assert_eq!(file.mesh.n_cells(), 2);
    assert!((volume(&file.mesh) - 2.0).abs() < 1e-15);
    assert_eq!((groups.facets("end").unwrap().len(), groups.nodes["end"].len()), (1, 4));
    assert!(!groups.facets.contains_key("cover") && groups.nodes["cover"].is_empty());
    let left_out = "2 facets are no faces of a cell, such as a shell, and left out; their nodes stay in the groups of nodes";
    assert!(file.notes.contains(&format!("{left_out} \"cover\", \"end\"")), "{:?}", file.notes);
}

#[test]
fn a_plane_mesh_in_another_plane_says_so() {
    let plate = |z: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 {z} 1\n4 0 0 1\n$EndNodes\n\
             $Elements\n1\n1 3 2 1 1 1 2 3 4\n$EndElements\n"
        )
    };
    let message = |z| parse_text("a.msh", &plate(z)).unwrap_err().to_string();
    assert!(message("0").contains("all of them lie in another plane: turn the mesh into the x-y plane"));
    assert!(message("0.1").contains("Gmsh saves only what is in a physical group"));
}

/// Numbers from 0 to n - 1 of a linear congruential generator.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n
    }
}

#[test]
fn every_section_of_a_random_file_is_accounted_for() {
    const NO_EFFECT: [&str; 4] = ["NodeData", "ElementData", "Comments", "InterpolationScheme"];
    const UNKNOWN: [&str; 3] = ["Foo", "nodes", "PeriodicX"];
    let mut random = Random(37);
    for _ in 0..200 {
        let text = tetrahedron(["2.1", "2.2"][random.below(2)], "3 1 \"body\"");
        let (mut n_periodic, mut n_unknown) = (0, [0; 3]);
        let sections =
            text.split_inclusive('\n').map(str::to_string).fold(vec![String::new()], |mut all, line| {
                let ends = line.starts_with("$End");
                all.last_mut().unwrap().push_str(&line);
                if ends {
                    all.push(String::new());
                }
                all
            });
        let mut drawn = String::new();
        for section in sections {
            drawn += &section;
            for _ in 0..random.below(3) {
                let name = match random.below(3) {
                    0 => NO_EFFECT[random.below(4)],
                    1 => {
                        n_periodic += 1;
                        "Periodic"
                    }
                    _ => {
                        let which = random.below(3);
                        n_unknown[which] += 1;
                        UNKNOWN[which]
                    }
                };
                drawn += &format!("${name}\n{}\nsome \"text\" 1 2 3\n$End{name}\n", random.below(9));
            }
        }
        let file = parse_text("a.msh", &drawn).unwrap();
        assert_eq!((file.mesh.n_nodes(), file.mesh.n_cells()), (4, 1));
        assert!((volume(&file.mesh) - 1.0 / 6.0).abs() < 1e-15);
        let note = |start: &str| file.notes.iter().find(|note| note.starts_with(start));
        let left_out = note("left out, though it may change the motion: ");
        assert_eq!(left_out.is_some(), n_periodic > 0);
        assert!(
            left_out.is_none_or(|note| note.ends_with(&format!(": {n_periodic} Periodic"))),
            "{left_out:?}"
        );
        let unknown = note("not known, and left out: ");
        let counts = unknown.map_or("", |note| &note["not known, and left out: ".len()..]);
        let mut found: Vec<&str> = counts.split(", ").filter(|part| !part.is_empty()).collect();
        let mut wanted: Vec<String> = UNKNOWN
            .iter()
            .zip(n_unknown)
            .filter(|(_, n)| *n > 0)
            .map(|(name, n)| format!("{n} {name}"))
            .collect();
        found.sort_unstable();
        wanted.sort_unstable();
        assert_eq!(found, wanted);
        assert_eq!(file.notes.len(), usize::from(left_out.is_some()) + usize::from(unknown.is_some()));
    }
}

#[test]
fn cells_in_no_group_are_kept_and_other_elements_told() {
    for name in ["all-22.msh", "all-41.msh"] {
        let file = read(name);
        assert_eq!(file.mesh.n_cells(), 4);
        assert!(file.mesh.groups().names().is_empty());
        assert_eq!(file.notes[2], "18 elements of dimension 2 in no physical group are ignored");
    }
}

const SPARSE: &str = "$Comments\nby hand\n$EndComments\n$MeshFormat\n4.1 0 8\n$EndMeshFormat
$Periodic\n0\n$EndPeriodic
$Nodes\n2 6 7 1000000000000\n3 1 0 4\n1000000000000\n7\n12\n9\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 9 0 2\n77\n78\n5 5 5\n6 6 6\n$EndNodes
$Elements\n1 1 3 3\n3 1 4 1\n3 1000000000000 7 12 9\n$EndElements\n$NodeData\n1\n\"u\"\n$EndNodeData\n";

#[test]
fn node_numbers_may_have_gaps_and_nodes_without_cell_are_told() {
    let file = parse_text("sparse.msh", SPARSE).unwrap();
    assert_eq!(file.mesh.points()[0], [0.0; 3]);
    assert_eq!(file.mesh.cell(0).nodes, [0, 1, 2, 3]);
    let periodic = "left out, though it may change the motion: 1 Periodic";
    assert_eq!(file.notes, [periodic, "2 nodes belong to no cell and are left out"]);
}

/// A tetrahedron in MSH 2.2, binary with the most significant byte first.
fn big_endian() -> Vec<u8> {
    let mut bytes = b"$MeshFormat\n2.2 1 8\n".to_vec();
    let ints =
        |bytes: &mut Vec<u8>, ints: &[i32]| bytes.extend(ints.iter().flat_map(|int| int.to_be_bytes()));
    ints(&mut bytes, &[1]);
    bytes.extend(b"\n$EndMeshFormat\n$Nodes\n4\n");
    for (node, point) in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].iter().enumerate() {
        ints(&mut bytes, &[node as i32 + 1]);
        bytes.extend(point.iter().flat_map(|x: &f64| x.to_be_bytes()));
    }
    bytes.extend(b"\n$EndNodes\n$Elements\n1\n");
    ints(&mut bytes, &[4, 1, 2, 1, 5, 5, 1, 2, 3, 4]);
    bytes.extend(b"\n$EndElements\n");
    bytes
}

#[test]
fn either_byte_order_is_read() {
    let mesh = parse("big.msh".as_ref(), &big_endian()).unwrap().mesh;
    assert_eq!(mesh.groups().cells("5").unwrap(), [0]);
    assert!((volume(&mesh) - 1.0 / 6.0).abs() < 1e-15);
}

#[test]
fn a_facet_without_cell_is_left_out_and_its_nodes_stay() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 3 \"lid\"\n$EndPhysicalNames
$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 2 2 2\n$EndNodes
$Elements\n2\n1 4 2 1 1 10 20 30 40\n2 2 2 3 1 20 30 50\n$EndElements\n";
    let file = parse_text("lid.msh", text).unwrap();
    assert_eq!(file.mesh.groups().nodes["lid"], [1, 2]);
    assert!(file.notes[0].starts_with("1 facet is no face of a cell"), "{:?}", file.notes);
}

#[test]
fn surfaces_alone_are_told_from_a_mesh_in_a_plane() {
    // A box whose foot and top are physical groups, but not its volume.
    let error = emmy_io::mesh::read(&crate::meshes::path("surfaces-alone.msh")).unwrap_err().to_string();
    for part in ["the file has triangles only", "put the volume into one too", "Mesh.SaveAll = 1"] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn control_characters_in_names_are_replaced() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"a\u{1b}b\"\n$EndPhysicalNames\n\
        $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";
    let file = parse("a.msh".as_ref(), text.as_bytes()).unwrap();
    assert_eq!(file.mesh.groups().names(), ["a_b"]);
    assert_eq!(file.notes, ["the name \"a\\u{1b}b\" has control characters: it is read as \"a_b\""]);
}
