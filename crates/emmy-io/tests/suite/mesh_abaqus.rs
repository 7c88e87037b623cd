//! Abaqus input by hand: flat, with parts and instances, and all forms of lines.

use crate::meshes::{assert_plane, assert_straight, close, parse_text, read, volume};
use emmy::mesh::CellKind;

#[test]
fn a_flat_file() {
    let file = read("flat.inp");
    let mesh = &file.mesh;
    assert_eq!((mesh.n_nodes(), mesh.n_cells()), (12, 2));
    assert!((volume(mesh) - 2.0).abs() < 1e-12);
    let groups = mesh.groups();
    assert_eq!(groups.cells("Bricks").unwrap(), [0, 1]);
    assert_eq!(groups.cells("second").unwrap(), [1]);
    assert_eq!(groups.cells("both of them").unwrap(), [0, 1]);
    assert_eq!(groups.nodes["Foot"].len(), 4);
    assert_eq!(groups.nodes["Some"], [0, 2, 4, 6]);
    assert_eq!(groups.nodes["of-second"].len(), 8);
    assert_eq!(groups.nodes["free"].len(), 4);
    assert_plane(mesh, "Foot", 0, 0.0);
    assert_plane(mesh, "free", 0, 2.0);
    assert_plane(mesh, "left", 0, 0.0);
    assert_plane(mesh, "right", 0, 2.0);
    assert_plane(mesh, "top", 2, 1.0);
    assert_eq!(groups.facets("top").unwrap().len(), 2);
    assert!(!groups.names().contains(&"_hidden"));
    assert_eq!(
        file.notes,
        [
            "C3D8R is read as hex8 and integrated fully",
            "node set \"Some\" names 1 node that the file does not have",
            "1 node belongs to no cell and is left out"
        ]
    );
}

#[test]
fn an_instance_is_translated_and_then_rotated() {
    // The tetrahedron is moved by (1, 0, 0) and rotated by 90 degrees about the axis through (0, 1, 0) along z.
    let mesh = read("assembly.inp").mesh;
    assert!(close(mesh.points()[0], [1.0, 2.0, 0.0]));
    assert!(close(mesh.points()[1], [1.0, 3.0, 0.0]));
    assert!(close(mesh.points()[2], [0.0, 2.0, 0.0]));
    assert!(close(mesh.points()[3], [1.0, 2.0, 1.0]));
}

#[test]
fn two_instances_have_their_own_numbers_and_sets() {
    let mesh = read("assembly.inp").mesh;
    let groups = mesh.groups();
    assert_eq!((mesh.n_nodes(), mesh.n_cells()), (8, 2));
    assert!((volume(&mesh) - 2.0 / 6.0).abs() < 1e-12);
    assert!(close(mesh.points()[4], [0.0, 0.0, 7.0]));
    assert_eq!(groups.cells("Solid").unwrap(), [0, 1]);
    assert_eq!(groups.cells("Turned.Solid").unwrap(), [0]);
    assert_eq!(groups.cells("Lifted").unwrap(), [1]);
    assert_eq!(groups.nodes["Tips"], [3, 7]);
    assert_eq!(groups.nodes["Lifted.Base"], [4, 5, 6]);
    assert_eq!(groups.nodes["base"], [4], "the assembly's own set takes the name");
    assert!(!groups.nodes.contains_key("Base"));
    assert_plane(&mesh, "floor", 2, 7.0);
    assert_plane(&mesh, "Turned.back", 0, 1.0);
    assert_plane(&mesh, "wall", 0, 1.0);
    assert_eq!(groups.nodes["contact"], [4, 5, 6]);
}

#[test]
fn quadratic_cells_go_on_over_lines_and_includes_are_followed() {
    let file = read("quadratic.inp");
    let kinds: Vec<CellKind> = file.mesh.cells().map(|cell| cell.kind).collect();
    assert_eq!(kinds, [CellKind::Hex20, CellKind::Tet10]);
    assert_straight(&file.mesh);
    assert!((volume(&file.mesh) - 1.0 - 1.0 / 6.0).abs() < 1e-12);
    assert_plane(&file.mesh, "brick-s3", 1, 0.0);
    assert_plane(&file.mesh, "tet-s4", 0, 5.0);
    assert_eq!(file.notes, ["C3D10M is read as plain tet10", "C3D20R is read as hex20 and integrated fully"]);
}

#[test]
fn wedges_and_pyramids_have_their_faces_where_abaqus_has_them() {
    let file = read("wedges.inp");
    let mesh = &file.mesh;
    let kinds: Vec<CellKind> = mesh.cells().map(|cell| cell.kind).collect();
    assert_eq!(kinds, [CellKind::Wedge15, CellKind::Hex8, CellKind::Pyramid5, CellKind::Wedge6]);
    assert!((volume(mesh) - 0.5 - 1.0 - 1.0 / 3.0 - 0.5).abs() < 1e-12);
    assert!((emmy::mesh::quality(mesh).volume - volume(mesh)).abs() < 1e-12);
    assert_straight(mesh);
    for (group, axis, value, n_nodes) in [
        ("curved-s1", 2, 0.0, 6),
        ("curved-s2", 2, 1.0, 6),
        ("curved-s3", 1, 0.0, 8),
        ("curved-s5", 0, 0.0, 8),
        ("roof-s1", 2, 1.0, 4),
        ("bottom", 2, 0.0, 5),
        ("front", 1, 0.0, 6),
    ] {
        assert_plane(mesh, group, axis, value);
        assert_eq!(mesh.group_nodes(group).unwrap().len(), n_nodes, "{group}");
    }
    let slope = mesh.group_nodes("slope").unwrap();
    assert!(slope.iter().map(|&node| mesh.points()[node as usize]).all(|[_, y, z]| z == 1.0 + 2.0 * y));
    assert_eq!(
        file.notes,
        ["C3D5H is read as pyramid5 without its pressure; formulation = \"projected-volume\" has one"]
    );
}

const BRICK: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
                     *ELEMENT,TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n";

#[test]
fn faces_of_the_brick_lie_where_abaqus_has_them() {
    let planes = [(1, 2, 0.0), (2, 2, 1.0), (3, 1, 0.0), (4, 0, 1.0), (5, 1, 1.0), (6, 0, 0.0)];
    for (face, axis, value) in planes {
        let text = format!("{BRICK}*Surface, name=face\n1, S{face}\n");
        let mesh = parse_text("brick.inp", &text).unwrap().mesh;
        assert_plane(&mesh, "face", axis, value);
        assert_eq!(mesh.group_nodes("face").unwrap().len(), 4);
    }
}

#[test]
fn a_brick_that_is_whole_has_no_notes() {
    assert!(parse_text("brick.inp", BRICK).unwrap().notes.is_empty());
}

#[test]
fn plane_stress_elements_beside_solid_ones_are_faces() {
    // From Gmsh: a box [0, 1] x [0, 1] x [0, 2] with the groups body, foot (z = 0) and top (z = 2), all elements saved.
    for (name, kind, faces) in
        [("gmsh-solid.inp", CellKind::Tet4, "CPS3"), ("gmsh-solid-quadratic.inp", CellKind::Tet10, "CPS6")]
    {
        let file = read(name);
        let (mesh, groups) = (&file.mesh, file.mesh.groups());
        assert_eq!(mesh.counts_by_kind(), [(kind, groups.cells("body").unwrap().len())], "{name}");
        assert!((volume(mesh) - 2.0).abs() < 1e-12, "{name}");
        assert_plane(mesh, "foot", 2, 0.0);
        assert_plane(mesh, "top", 2, 2.0);
        for group in ["foot", "top"] {
            assert!((area(mesh, group) - 1.0).abs() < 1e-12, "{name}: {group}");
            assert!(
                !groups.cells.contains_key(group) && !groups.nodes.contains_key(group),
                "{name}: {group}"
            );
        }
        let note = format!("elements of type {faces} are read as faces of the solid cells beside them");
        assert!(file.notes.contains(&note), "{name}: {:?}", file.notes);
    }
}

/// Area of the triangles of a group of facets.
fn area(mesh: &emmy::mesh::Mesh, group: &str) -> f64 {
    let of_facet = |&facet: &emmy::mesh::Facet| {
        let corners: Vec<[f64; 3]> =
            mesh.facet_nodes(facet).map(|node| mesh.points()[node as usize]).collect();
        let [a, b] = [1, 2].map(|i| [0, 1, 2].map(|j| corners[i][j] - corners[0][j]));
        let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        normal.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0
    };
    mesh.groups().facets(group).unwrap().iter().map(of_facet).sum()
}

#[test]
fn lines_beside_faces_are_edges_unless_links_are_asked_for() {
    let file = read("gmsh-solid.inp");
    // A curve of a box is parallel to an axis: two coordinates equal those of a corner.
    let nodes = &file.mesh.groups().nodes["Line1"];
    let points: Vec<[f64; 3]> = nodes.iter().map(|&node| file.mesh.points()[node as usize]).collect();
    let constant = |axis: usize| points.iter().all(|point| point[axis] == points[0][axis]);
    assert_eq!([0, 1, 2].into_iter().filter(|&axis| constant(axis)).count(), 2, "{points:?}");
    let edges = "elements of type T3D2 are read as edges of the cells beside them, not as links";
    assert!(file.notes.iter().any(|note| note.starts_with(edges)), "{:?}", file.notes);
    let links =
        emmy_io::mesh::read_with(&crate::meshes::path("gmsh-solid.inp"), &crate::meshes::links("Line1"))
            .unwrap();
    let (kind, n_links) = *links.mesh.counts_by_kind().last().unwrap();
    // Neighbouring lines share a node.
    assert_eq!((kind, n_links + 1), (CellKind::Line2, nodes.len()));
    assert_eq!(links.mesh.groups().nodes["Line2"], file.mesh.groups().nodes["Line2"]);
}

#[test]
fn a_last_line_without_line_feed_may_be_cut_off() {
    let text = "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4\n1, 1,2,3,4\n";
    assert!(parse_text("a.inp", text).unwrap().notes.is_empty());
    let notes = parse_text("a.inp", text.trim_end()).unwrap().notes;
    assert_eq!(notes, ["a.inp: the last line has no line feed at its end; is the file cut off?"]);
}

#[test]
fn control_characters_in_names_are_replaced() {
    let text = "*Node, nset=a\u{1b}b\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=c\u{7}\n1, 1,2,3,4\n";
    let file = parse_text("a.inp", text).unwrap();
    assert_eq!(file.mesh.groups().names(), ["a_b", "c_"]);
    assert_eq!(
        file.notes,
        [
            "a.inp, line 1: control characters are read as `_`",
            "a.inp, line 6: control characters are read as `_`"
        ]
    );
}

#[test]
fn a_collapsed_brick_is_noted() {
    let nodes = "*Node\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n";
    let text = format!("{nodes}*Element, type=C3D8\n17, 1,2,3,4,5,6,7,7\n");
    let notes = parse_text("a.inp", &text).unwrap().notes;
    let expected = "1 cell has two corners at one place (aspect ratio inf), the first is element 17 (hex8)";
    assert!(notes.iter().any(|note| note.starts_with(expected)), "{notes:?}");
}

/// Least time of three readings of a text.
fn seconds(text: &str) -> f64 {
    let times = (0..3).map(|_| {
        let start = std::time::Instant::now();
        parse_text("a.inp", text).unwrap();
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}

#[test]
fn the_time_for_an_assembly_grows_with_its_instances_alone() {
    let assembly = |n: usize| {
        let mut text = "*Part, name=P\n*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n\
                        *Surface, name=s\n1, S1\n*End Part\n*Assembly, name=A\n"
            .to_string();
        (0..n).for_each(|i| {
            text += &format!("*Instance, name=P-{i}, part=P\n{}, 0, 0\n*End Instance\n", 2 * i);
            text += &format!("*Surface, name=s-{i}\nP-{i}.1, S2\n");
        });
        text
    };
    // Sixteen times as many take sixteen times as long; a search among all would take 256 times as long.
    let ratio = seconds(&assembly(16_000)) / seconds(&assembly(1_000));
    assert!(ratio < 64.0, "{ratio}");
}

#[test]
fn a_deck_in_the_style_of_prepomax_is_read() {
    let file = read("prepomax.inp");
    let mesh = &file.mesh;
    assert_eq!(mesh.counts_by_kind(), [(CellKind::Hex8, 1), (CellKind::Tet10, 1)]);
    assert_straight(mesh);
    assert!((volume(mesh) - (1.0 + 8.0 / 6.0)).abs() < 1e-14);
    let groups = mesh.groups();
    assert_eq!(groups.cells("Solid_part-1").unwrap().len() + groups.cells("Solid_part-2").unwrap().len(), 2);
    assert_eq!(groups.cells("Internal_Selection-1_Solid_Section-1").unwrap().len(), 2);
    assert_eq!((groups.nodes["Node_Set-1"].len(), groups.facets("Surface-1").unwrap().len()), (2, 1));
    assert_plane(mesh, "Internal_Selection-1_Fixed-1", 0, 0.0);
    assert_plane(mesh, "Surface-1", 2, 0.0);
    assert_eq!(
        file.notes,
        [
            "C3D8I is read as plain hex8; its modes are those of formulation = \"incompatible-modes\"",
            "left out, though it may change the motion: 1 *BOUNDARY, 1 *CLOAD, 1 *DLOAD"
        ]
    );
}

#[test]
fn lines_of_three_nodes_are_edges_of_solid_cells() {
    let deck = std::fs::read_to_string(crate::meshes::path("prepomax.inp")).unwrap();
    let line = "*Element, Type=T3D3, Elset=Line1\n7, 1, 5, 2\n** Node sets";
    let file = parse_text("a.inp", &deck.replacen("** Node sets", line, 1)).unwrap();
    assert_eq!(file.mesh.groups().nodes["Line1"].len(), 3);
    assert_plane(&file.mesh, "Line1", 1, 0.0);
    let note = "elements of type T3D3 are read as edges of the cells beside them";
    assert!(file.notes.iter().any(|own| own == note), "{:?}", file.notes);
    let alone = "*Node\n1,0,0,0\n2,1,0,0\n3,2,0,0\n*Element, type=T3D3\n1, 1,2,3\n";
    let error = parse_text("a.inp", alone).unwrap_err().to_string();
    assert!(error.contains("no solid or plane cells, only 1 T3D3"), "{error}");
}

#[test]
fn pyramids_of_thirteen_nodes_have_the_order_of_gmsh() {
    // As Gmsh 4 writes its own reference pyramid, whose base is a square of side 2 and whose height is 1.
    let text = "*Heading\n p.inp\n*NODE\n1, -1, -1, 0\n2, 1, -1, 0\n3, 1, 1, 0\n4, -1, 1, 0\n5, 0, 0, 1\n6, 0, -1, 0\n7, -1, 0, 0\n\
                8, -0.5, -0.5, 0.5\n9, 1, 0, 0\n10, 0.5, -0.5, 0.5\n11, 0, 1, 0\n12, 0.5, 0.5, 0.5\n13, -0.5, 0.5, 0.5\n\
                ******* E L E M E N T S *************\n*ELEMENT, type=C3D13, ELSET=Volume1\n\
                1, 1, 2, 3, 4, 5, 6, 9, 11, 7, 8, 10, 12, 13\n*SURFACE, NAME=base\n1, S1\n";
    let file = parse_text("p.inp", text).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Pyramid13, 1)]);
    assert_straight(&file.mesh);
    assert!((volume(&file.mesh) - 4.0 / 3.0).abs() < 1e-15 && file.notes.is_empty(), "{:?}", file.notes);
    assert_plane(&file.mesh, "base", 2, 0.0);
    assert_eq!(file.mesh.group_nodes("base").unwrap().len(), 8);
}

#[test]
fn instances_of_other_analyses_and_parameters_are_named() {
    let old = parse_text("a.inp", "*INSTANCE, LIBRARY=old, INSTANCE=Arm-1\n").unwrap_err().to_string();
    assert!(old.starts_with("a.inp, line 1: *INSTANCE of another analysis (old) is not read; "), "{old}");
    let number = parse_text("a.inp", "*PARAMETER\nl = 2.\n*NODE\n1, <l>, 0, 0\n").unwrap_err().to_string();
    assert!(number.starts_with("a.inp, line 4: the parameter <l> is not evaluated; "), "{number}");
}

/// Programs on Windows write backslashes, and solvers look into the folder in which they run.
#[test]
fn included_files_are_found_from_the_first_file_too() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    write("main.inp", "*INCLUDE, INPUT=parts\\nodes.inp\n*ELEMENT, TYPE=C3D4\n1, 1,2,3,4\n");
    write("parts/nodes.inp", "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n*INCLUDE, INPUT=parts/last.inp\n");
    write("parts/last.inp", "4,0,0,1\n");
    let file = emmy_io::mesh::read(&folder.path().join("main.inp")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((file.mesh.n_nodes(), file.files.len()), (4, 3));
}
