//! Abaqus input by hand: flat, with parts and instances, and the forms that lines may take.

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
    // The tetrahedron is moved by (1, 0, 0) and turned by 90 degrees about the axis through (0, 1, 0) along z.
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
    assert!((emmy::element::quality(mesh).volume - volume(mesh)).abs() < 1e-12);
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
    assert_eq!(file.notes, ["C3D5H is read as pyramid5 without its pressure"]);
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
