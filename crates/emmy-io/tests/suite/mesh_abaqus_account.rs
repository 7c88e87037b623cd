//! Abaqus input with more than a mesh: every keyword and every element is read, without effect, or counted.

use std::collections::BTreeMap;

use crate::mesh_abaqus_bodies::all_notes;
use crate::meshes::{assert_plane, links, parse_text, volume};
use emmy::mesh::CellKind;
use emmy_io::mesh::{MeshFile, MeshOptions, parse_with};

/// Two bricks from x = 0 to x = 2.
const BRICKS: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n9,2,0,0\n10,2,1,0\n\
                      11,2,0,1\n12,2,1,1\n*ELEMENT, TYPE=C3D8, ELSET=beam\n1,1,2,3,4,5,6,7,8\n2,2,9,10,3,6,11,12,7\n";

const LEFT_OUT: &str = "left out, though it may change the motion: ";
const UNKNOWN: &str = "not known, and left out: ";

fn bricks(text: &str) -> MeshFile {
    let file = parse_text("a.inp", &format!("{BRICKS}{text}")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Hex8, 2)]);
    assert_eq!(file.mesh.n_nodes(), 12);
    assert!((volume(&file.mesh) - 2.0).abs() < 1e-12);
    file
}

/// Numbers in the note that begins with some words.
fn counts(file: &MeshFile, beginning: &str) -> BTreeMap<String, usize> {
    let lists: Vec<&str> = file.notes.iter().filter_map(|note| note.strip_prefix(beginning)).collect();
    assert!(lists.len() < 2, "{lists:?}");
    let entry = |entry: &str| {
        let (count, name) = entry.split_once(' ').unwrap();
        (name.to_string(), count.parse().unwrap())
    };
    lists.iter().flat_map(|list| list.split(", ")).map(entry).collect()
}

fn n_facets(file: &MeshFile, group: &str) -> usize {
    file.mesh.groups().facets(group).unwrap().len()
}

#[test]
fn constraints_and_supports_have_their_notes() {
    let file = bricks(
        "*NSET, NSET=end\n9, 10, 11, 12\n*EQUATION\n2\n9, 1, 1., 10, 1, -1.\n*Rigid  Body, NSET=end, REF NODE=12\n\
         *BOUNDARY\n1, 1, 3\n*boundary\n2, 1\n*RIGIDBODY, NSET=end, REF NODE=9\n*MATERIAL, NAME=a\n*ELASTIC\n1., 0.\n",
    );
    assert_eq!(
        all_notes(&file),
        [
            "*RIGID BODY: 1 rigid coupling acts: rigid-end (mesh.leave_out switches it off)",
            &format!("{LEFT_OUT}2 *BOUNDARY"),
            "*EQUATION: 1 is left out, though it may change the motion: line 20 (not of one node in x, y and z with the \
             same weights)",
            "*RIGID BODY: end, end share nodes and are one rigid body, rigid-end",
        ]
    );
    assert_eq!(file.mesh.groups().nodes["end"].len(), 4);
    let unknown = bricks("*WARP FIELD, NAME=a\n1, 2\n*HEADING\n words, and more\n");
    assert_eq!(unknown.notes, [format!("{UNKNOWN}1 *WARP FIELD")]);
}

#[test]
fn elements_that_are_not_solid_do_not_refuse_a_file() {
    let types = [
        ("MASS", "12"),
        ("ROTARYI", "12"),
        ("SPRING1", "12"),
        ("SPRING2", "1, 12"),
        ("DASHPOTA", "1, 12"),
        ("GAPUNI", "1, 12"),
        ("DCOUP3D", "12"),
        ("B31", "1, 12"),
        ("B32", "1, 2, 12"),
        ("PIPE31", "1, 12, ,"),
        ("R3D4", "1, 2, 12, 4"),
        ("COH3D8", "1, 2, 3, 4, 9, 10, 11, 12"),
        ("CIN3D8", "1, 2, 3, 4, 9, 10, 11, 12"),
        ("AC3D4", "1, 2, 3, 12"),
        ("U1", "1, 2, 3,\n 12"),
        ("S4", "1, 2, 12, 4"),
        ("M3D3", "1, 2, 12"),
    ];
    for (element_type, nodes) in types {
        let file = bricks(&format!("*ELEMENT, TYPE={element_type}, ELSET=other\n3, {nodes}\n4, {nodes}\n"));
        assert_eq!(file.notes, [format!("{LEFT_OUT}2 {element_type}")]);
        let others = &file.mesh.groups().nodes["other"];
        let n_nodes = nodes.split(',').filter(|node| !node.trim().is_empty()).count();
        assert_eq!(others.len(), n_nodes, "{element_type}");
        let tip = file.mesh.points().iter().position(|point| *point == [2.0, 1.0, 1.0]).unwrap();
        assert!(others.contains(&(tip as u32)), "{element_type}");
        assert_eq!(file.mesh.groups().names(), ["beam", "other"]);
    }
    let last = bricks("*ELEMENT, TYPE=U2, ELSET=other\n3, 1, 12,\n*NSET, NSET=a\n1\n");
    assert_eq!(last.notes, [format!("{LEFT_OUT}1 U2")]);
    assert_eq!(last.mesh.groups().nodes["other"].len(), 2);
    for element_type in ["C3D8P", "C3D27", "CAX4", "SC8R", "CCL12", "NEW1"] {
        let text = format!("{BRICKS}*ELEMENT, TYPE={element_type}\n3, 1, 2, 3, 4, 5, 6, 7, 8\n");
        let error = parse_text("a.inp", &text).unwrap_err().to_string();
        assert!(error.contains(&format!("elements of type {element_type} are not supported")), "{error}");
    }
}

#[test]
fn links_stay_links_and_sets_with_cells_keep_these_alone() {
    let text = "*ELEMENT, TYPE=SPRINGA, ELSET=springs\n3, 1, 12\n*ELEMENT, TYPE=MASS\n4, 12\n*ELSET, ELSET=both\n1, 4\n\
                *NSET, NSET=of-mass, ELSET=lump\n";
    let text = text.replace("TYPE=MASS", "TYPE=MASS, ELSET=lump");
    let text = format!("{BRICKS}{text}");
    let file = parse_with("a.inp".as_ref(), text.as_bytes(), &links("springs")).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Hex8, 2), (CellKind::Line2, 1)]);
    let groups = file.mesh.groups();
    assert_eq!((groups.cells("springs").unwrap(), groups.cells("both").unwrap()), (&[2][..], &[0][..]));
    assert!(!groups.nodes.contains_key("both"));
    assert_eq!(groups.nodes["of-mass"], groups.nodes["lump"]);
    assert_eq!(file.notes, ["SPRINGA is read as line2".to_string(), format!("{LEFT_OUT}1 MASS")]);
}

#[test]
fn lines_beside_solid_cells_are_left_out_unless_a_region_wants_links() {
    let lines = "*ELEMENT, TYPE=SPRINGA, ELSET=springs\n3, 1, 12\n*ELEMENT, TYPE=CONN3D2\n4, 2, 12\n\
                 *ELEMENT, TYPE=T3D2, ELSET=bars\n5, 1, 7\n6, 2, 7\n*ELEMENT, TYPE=SPRINGA\n7, 4, 9\n";
    let file = bricks(lines);
    assert_eq!(file.notes, [format!("{LEFT_OUT}2 SPRINGA, 2 T3D2, 1 CONN3D2")]);
    let groups = ["springs", "bars"].map(|group| file.mesh.groups().nodes[group].clone());
    assert_eq!(groups, [vec![0, 11], vec![0, 1, 6]]);
}

#[test]
fn elements_between_instances_are_left_out_unless_a_region_wants_links() {
    let text = format!(
        "*PART, NAME=P\n{BRICKS}*ELEMENT, TYPE=MASS, ELSET=lump\n7, 12\n*END PART\n*ASSEMBLY, NAME=A\n\
         *INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n*INSTANCE, NAME=P-2, PART=P\n5., 0., 0.\n*END INSTANCE\n\
         *ELEMENT, TYPE=SPRINGA, ELSET=springs\n1, P-1.12, P-2.8\n*ELEMENT, TYPE=DASHPOTA\n2, P-1.12, P-2.8\n\
         *CONNECTOR SECTION, ELSET=springs\n*END ASSEMBLY\n"
    );
    let file = parse_text("a.inp", &text).unwrap();
    assert_eq!(file.notes, [format!("{LEFT_OUT}2 MASS, 1 *CONNECTOR SECTION, 1 DASHPOTA, 1 SPRINGA")]);
    assert_eq!((file.mesh.counts_by_kind(), volume(&file.mesh)), (vec![(CellKind::Hex8, 4)], 4.0));
    let ends = &file.mesh.groups().nodes["springs"];
    let mut ends: Vec<[f64; 3]> = ends.iter().map(|&node| file.mesh.points()[node as usize]).collect();
    ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert_eq!(ends, [[2.0, 1.0, 1.0], [5.0, 1.0, 1.0]]);
    assert_eq!(file.mesh.groups().nodes["lump"].len(), 2);
    let linked = parse_with("a.inp".as_ref(), text.as_bytes(), &links("springs")).unwrap().mesh;
    let &[cell] = linked.groups().cells("springs").unwrap() else { panic!("one link") };
    let ends = linked.cell(cell as usize).nodes.iter().map(|&node| linked.points()[node as usize]);
    assert_eq!(ends.collect::<Vec<_>>(), [[2.0, 1.0, 1.0], [5.0, 1.0, 1.0]]);
    assert_eq!(linked.counts_by_kind(), [(CellKind::Hex8, 4), (CellKind::Line2, 1)]);
    let nowhere = text.replace("1, P-1.12, P-2.8", "1, P-1.12, P-2.99");
    let error = parse_with("a.inp".as_ref(), nowhere.as_bytes(), &links("springs")).unwrap_err().to_string();
    assert!(error.contains("element 1 names node 99, which the file does not define"), "{error}");
    let solid =
        text.replace("SPRINGA", "C3D4").replace("1, P-1.12, P-2.8\n", "1, P-1.12, P-1.8, P-1.1, P-1.2\n");
    let error = parse_text("a.inp", &solid).unwrap_err().to_string();
    assert!(error.contains("element 1 of type C3D4 has nodes of an instance"), "{error}");
}

#[test]
fn shells_beside_a_solid_are_left_out_and_facets_stay() {
    let nodes = "*NODE\n21,5,0,0\n22,6,0,0\n23,6,1,0\n24,5,1,0\n";
    let cover = bricks(&format!("{nodes}*ELEMENT, TYPE=S4, ELSET=cover\n11, 21, 22, 23, 24\n"));
    assert!(cover.mesh.groups().nodes["cover"].is_empty());
    assert_eq!(counts(&cover, LEFT_OUT), BTreeMap::from([("S4".to_string(), 1)]));
    assert_eq!(cover.notes.iter().filter(|note| note.contains("read as faces")).count(), 0);
    // The bottom of the first brick, and a shell that shares an edge with it.
    let text = format!(
        "{nodes}*ELEMENT, TYPE=S4, ELSET=skirt\n11, 1, 4, 3, 2\n12, 1, 4, 24, 21\n*ELEMENT, TYPE=S3, ELSET=edge\n13, 1, 4, 21\n"
    );
    let mixed = bricks(&text);
    assert_eq!(n_facets(&mixed, "skirt"), 1);
    assert_plane(&mixed.mesh, "skirt", 2, 0.0);
    assert!(!mixed.mesh.groups().nodes.contains_key("skirt"));
    assert_eq!(mixed.mesh.groups().nodes["edge"].len(), 2);
    assert_eq!(counts(&mixed, LEFT_OUT), BTreeMap::from([("S3".to_string(), 1), ("S4".to_string(), 1)]));
    let faces = "elements of type S4 are read as faces of the solid cells beside them";
    assert_eq!(mixed.notes.iter().filter(|note| *note == faces).count(), 1);
}

#[test]
fn nothing_solid_is_an_error_that_says_what_is_there() {
    let nodes = "*NODE\n1,0,0,0\n2,2,0,0\n3,2,1,0\n4,0,1,0\n";
    let sheet = format!(
        "{nodes}*ELEMENT, TYPE=S4, ELSET=sheet\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=T3D2, ELSET=rim\n2, 1, 2\n"
    );
    let error = parse_text("a.inp", &sheet).unwrap_err().to_string();
    assert!(error.starts_with("a.inp: the file has no solid or plane cells, only 1 S4; shells"), "{error}");
    let frame = format!("{nodes}*ELEMENT, TYPE=B31\n1, 1, 2\n2, 2, 3\n*ELEMENT, TYPE=MASS\n3, 3\n");
    let error = parse_text("a.inp", &frame).unwrap_err().to_string();
    assert!(
        error.starts_with("a.inp: the file has no solid or plane cells, only 2 B31, 1 MASS; make the body"),
        "{error}"
    );
}

#[test]
fn shells_are_in_plane_strain_if_the_input_says_so() {
    let text = "*NODE\n1,0,0,0\n2,2,0,0\n3,2,1,0\n4,0,1,0\n*ELEMENT, TYPE=S4, ELSET=sheet\n1, 1, 2, 3, 4\n\
                *ELEMENT, TYPE=T3D2, ELSET=rim\n2, 1, 2\n3, 2, 4\n";
    let options = MeshOptions { plane_shells: true, ..MeshOptions::default() };
    let file = parse_with("a.inp".as_ref(), text.as_bytes(), &options).unwrap();
    assert_eq!(file.mesh.counts_by_kind(), [(CellKind::Quad4, 1)]);
    assert_eq!(emmy::mesh::quality(&file.mesh).volume, 2.0);
    assert_eq!((file.mesh.groups().cells("sheet").unwrap(), n_facets(&file, "rim")), (&[0][..], 1));
    let note = "elements of type S4 are read as cells in plane strain, without their thickness";
    assert!(file.notes.iter().any(|own| own == note), "{:?}", file.notes);
    // A diagonal is no edge of the cell.
    assert_eq!(counts(&file, LEFT_OUT).values().sum::<usize>(), 1);
}

#[test]
fn lines_of_three_nodes_are_edges_of_quadratic_cells() {
    // The middle comes second, as in Abaqus and Gmsh, or last, as in meshio.
    let nodes = "*NODE\n1,0,0\n2,2,0\n3,0,2\n4,1,0\n5,1,1\n6,0,1\n*ELEMENT, TYPE=CPE6\n1,1,2,3,4,5,6\n";
    for lines in ["2,1,4,2\n3,2,5,3", "2,1,2,4\n3,2,3,5"] {
        let text = format!("{nodes}*ELEMENT, TYPE=T3D3, ELSET=rim\n{lines}\n*NSET, NSET=end\n1,\n");
        let file = parse_text("a.inp", &text).unwrap();
        assert_eq!((n_facets(&file, "rim"), file.mesh.group_nodes("rim").unwrap().len()), (2, 5), "{lines}");
        assert!(counts(&file, LEFT_OUT).is_empty(), "{:?}", file.notes);
    }
}

#[test]
fn a_set_without_a_face_stands_for_its_free_faces() {
    // A bar of two cubes has 10 free faces, each of its ends 5.
    let file = bricks(
        "*SURFACE, NAME=skin, TYPE=ELEMENT\nbeam,\n*SURFACE, NAME=half\n2\n*SURFACE, NAME=all, TYPE=ELEMENT\n",
    );
    assert_eq!(["skin", "half", "all"].map(|group| n_facets(&file, group)), [10, 5, 10]);
    assert_eq!(file.mesh.group_nodes("half").unwrap().len(), 8);
    assert!(file.notes.is_empty(), "{:?}", file.notes);
    let plane = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n5,2,0\n*ELEMENT, TYPE=CPE4, ELSET=a\n1,1,2,3,4\n*ELEMENT, TYPE=CPE3, ELSET=a\n\
                 2,2,5,3\n*SURFACE, NAME=rim\na,\n";
    assert_eq!(n_facets(&parse_text("a.inp", plane).unwrap(), "rim"), 5);
}

#[test]
fn surfaces_are_combined() {
    let surfaces = "*SURFACE, NAME=skin\nbeam,\n*SURFACE, NAME=_a, INTERNAL\n1, S1\n2, S1\n1, S6\n*SURFACE, NAME=b\n2, S1\n2, S4\n\
                    *SURFACE, NAME=sum, COMBINE=UNION\n_a, b\n*SURFACE, NAME=both, COMBINE=Intersection\n_a, b\n\
                    *SURFACE, NAME=rest, COMBINE=DIFFERENCE\nskin, sum\n*SURFACE, NAME=sharp, CROP\nskin\n0,0,0,1,1,1\n";
    let file = bricks(surfaces);
    // _a has three facets, b two, and both have the bottom of the second brick.
    assert_eq!(["sum", "both", "rest"].map(|group| n_facets(&file, group)), [4, 1, 6]);
    assert_plane(&file.mesh, "both", 2, 0.0);
    assert!(!file.mesh.groups().names().contains(&"_a"));
    assert_eq!(file.notes, ["surface \"sharp\" is cut to a box (CROP): left out"]);
    let text = format!("{BRICKS}*SURFACE, NAME=sum, COMBINE=UNION\nnone\n");
    let error = parse_text("a.inp", &text).unwrap_err().to_string();
    assert!(error.contains("line 18: there is no surface \"none\" above"), "{error}");
    let error = parse_text("a.inp", &text.replace("UNION", "SUM")).unwrap_err().to_string();
    assert!(
        error.contains("line 17: surfaces can be combined by UNION, INTERSECTION or DIFFERENCE, not SUM"),
        "{error}"
    );
    let part = format!(
        "*PART, NAME=P\n{BRICKS}*SURFACE, NAME=foot\n1, S6\n*END PART\n*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n\
         *INSTANCE, NAME=P-2, PART=P\n5, 0, 0\n*END INSTANCE\n*SURFACE, NAME=feet, COMBINE=UNION\nP-1.foot, P-2.foot\n"
    );
    assert_eq!(n_facets(&parse_text("a.inp", &part).unwrap(), "feet"), 2);
}

#[test]
fn surfaces_of_shells_are_facets_of_the_solid_behind_them() {
    let shells = "*ELEMENT, TYPE=S4, ELSET=skirt\n11, 1, 4, 3, 2\n12, 1, 2, 11, 5\n";
    let file = bricks(&format!("{shells}*SURFACE, NAME=out\nskirt, SPOS\n*SURFACE, NAME=line\nskirt, E1\n"));
    assert_eq!(n_facets(&file, "out"), 1);
    assert_eq!(n_facets(&file, "line"), 0);
    let notes = [
        "surface \"out\" has 1 element that is left out",
        "surface \"line\": edges of shells and ends of beams are left out",
    ];
    assert!(notes.iter().all(|note| file.notes.iter().any(|own| own == note)), "{:?}", file.notes);
}

#[test]
fn names_have_no_blanks_at_their_ends() {
    let file = bricks(
        "*ELSET, ELSET=\"first \"\n1\n*NSET, NSET= tip  , UNSORTED\n12 ,\n*SURFACE, NAME=\"all of it  \"\nfirst ,\n",
    );
    assert_eq!(file.mesh.groups().names(), ["all of it", "beam", "first", "tip"]);
}
