//! Bad files, each with a message that names the fault, its place, and something to try.

use crate::meshes::{bytes, parse_text, path};

/// Nodes of a tetrahedron in MSH 2.2; lines 1 to 10.
const V2: &str =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
/// The same in MSH 4.1; lines 1 to 14.
const V4: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1 2 3 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n";
/// Nodes of a tetrahedron in Abaqus; lines 1 to 5.
const INP: &str = "*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n";

/// Checks that the message of a file has all the parts.
#[track_caller]
fn assert_message(name: &str, text: &str, parts: &[&str]) {
    let message = parse_text(name, text).expect_err(text).to_string();
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is not in: {message}");
    }
}

#[test]
fn files_of_no_known_format() {
    let no_such = emmy_io::mesh::read("no/such.msh".as_ref()).unwrap_err().to_string();
    assert!(no_such.starts_with("no/such.msh: cannot be read: "), "{no_such}");
    assert_message("a.xyz", "solid cube", &["a.xyz: not a mesh file", ".msh", ".inp"]);
    // Known other formats by their extension, with any content.
    assert_message(
        "a.cgns",
        "CDF",
        &["a mesh of CGNS is not read", "`gmsh -3 a.cgns -format msh41 -o a.msh`"],
    );
    assert_message("a.op2", "XXXX", &["a binary result of Nastran is not read", "bulk data file (.bdf)"]);
    assert_message("a.NAS", "$ Nastran\n", &["a.NAS: the mesh has no solid or plane cells", "GRID"]);
    assert_message("a.vtk", "# vtk DataFile Version 2.0\n", &["a.vtk, line 1: expected ASCII or BINARY"]);
    assert_message("a.unv", "    -1\n", &["a mesh of I-deas", "`gmsh -3 a.unv -format msh41 -o a.msh`"]);
    assert_message("a.med", "HDF", &["a mesh of Salome", "`gmsh a.med -save -format msh41 -o a.msh`"]);
    assert_message("a.step", "ISO-10303-21;\n", &["a geometry, no mesh, is not read", "`gmsh -3 a.step"]);
    assert_message("a.stl", "solid cube", &["a surface of triangles (STL) is not read", "Surface Loop"]);
    assert_message(
        "a.geo",
        "Point(1) = {0, 0, 0, 1};\n",
        &["a script of Gmsh is not read", "`gmsh -3 a.geo"],
    );
    assert_message("a.msh", " \n", &["a.msh, line 1: the file is empty"]);
    assert_message("a.inp", "", &["a.inp, line 1: the file is empty"]);
    assert_message("a.msh", "GAMBIT\n1 2 3", &["line 1: the file does not begin with $MeshFormat"]);
    assert_message(
        "a.inp",
        "1, 0, 0\n",
        &["line 1: expected a keyword such as *Heading", "found \"1, 0, 0\""],
    );
}

#[test]
fn bad_gmsh_headers() {
    let cases: [(&str, &[&str]); 9] = [
        ("$MeshFormat\n3 0 8\n$EndMeshFormat\n", &["line 2: version 3 of", "4.0 and 4.1", "-format msh41"]),
        ("$MeshFormat\n4.2 0 8\n$EndMeshFormat\n", &["version 4.2"]),
        ("$NOD\n1\n1 0 0 0\n$EndNodes\n", &["line 4: expected $EndNOD, found \"$EndNodes\""]),
        ("$MeshFormat\n4.1 0\n", &["line 2: expected version, file type, data size", "\"4.1 0\""]),
        ("$MeshFormat\n4.1 0 4\n", &["line 2: data size 4"]),
        ("$MeshFormat\n4.1 5 8\n1234", &["file type 5 is neither 0 (ASCII) nor 1 (binary)"]),
        ("$MeshFormat\n4.1 1 8\nabcd", &["mark of the byte order is not 1"]),
        ("$MeshFormat\n4.1 0 8\n", &["expected $EndMeshFormat, found the end of the file"]),
        ("$Nodes\n", &["does not begin with $MeshFormat"]),
    ];
    for (text, parts) in cases {
        assert_message("a.msh", text, parts);
    }
}

#[test]
fn bad_gmsh_sections() {
    let header = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    let cases: [(&str, &[&str]); 9] = [
        ("$Nodes\n3\n1 0 0 0\n1 1 0 0\n", &["line 7: node 1 exists already"]),
        ("$Nodes\n1\n1 0 nan 0\n", &["line 6: node 1 has a coordinate that is not a finite number"]),
        ("$Nodes\n1\n1 0 1e999 0\n", &["line 6: node 1 has a coordinate"]),
        ("$Nodes\n9999999999\n1 0 0 0\n", &["line 5: 9999999999 nodes are announced", "cut off"]),
        ("$Nodes\n2\n1 0 0 0\n$EndNodes\n", &["line 7: expected an integer, found \"$EndNodes\""]),
        ("$Nodes\n1\n1 0 0 0\n2 0 0 0\n$EndNodes\n", &["line 7: expected $EndNodes, found \"2\""]),
        ("$Nodes\n1\n1 0 0", &["line 6: expected a number, found the end of the file"]),
        ("$NodeData\n1\n", &["section $NodeData has no $EndNodeData"]),
        ("$PhysicalNames\n1\n3 1 body\n", &["line 6: expected dimension, number and \"name\"", "3 1 body"]),
    ];
    for (text, parts) in cases {
        assert_message("a.msh", &format!("{header}{text}"), parts);
    }
    assert_message("a.msh", &format!("{header}$EndNodes\n"), &["line 4: $EndNodes without its beginning"]);
}

#[test]
fn bad_gmsh_elements() {
    let v2: [(&str, &[&str]); 8] = [
        ("1\n1 4 2 0 1 1 2 3 5\n", &["line 13: element 1 names node 5, which the file does not define"]),
        (
            "1\n1 13 2 0 1 1 2 3 4 1 2 3 4 1 2 3 4 1 2 3 4 1 2\n",
            &[
                "line 13: elements of type wedge18",
                "set `Mesh.SecondOrderIncomplete = 1` before meshing: Gmsh then makes hex20, wedge15 and pyramid13",
            ],
        ),
        (
            "1\n1 777 2 0 1\n",
            &["line 13: elements of type 777 of Gmsh", "hex8, hex20, hex27, tet4, tet10, wedge6"],
        ),
        ("1\n1 4 99999 0 1\n", &["line 13: 99999 tags are announced"]),
        ("2\n1 4 2 0 1 1 2 3 4\n1 4 2 0 1 4 3 2 1\n", &["line 14: element 1 exists already"]),
        (
            "2\n1 4 2 7 1 1 2 3 4\n2 4 2 7 1 1 2 3 4\n",
            &["line 14: element 2 has the nodes and the group of element 1"],
        ),
        (
            "1\n1 1 2 7 1 1 2\n",
            &["a.msh: the file has no solid or plane cells, only 1 line; mesh the volume"],
        ),
        (
            // Two lines, of which one is in no group, and a point.
            "3\n1 1 2 7 1 1 2\n2 1 2 0 1 2 3\n3 15 2 7 1 1\n",
            &["a.msh: the file has no solid or plane cells, only 2 lines and 1 point; mesh the volume"],
        ),
    ];
    for (text, parts) in v2 {
        assert_message("a.msh", &format!("{V2}$Elements\n{text}$EndElements\n"), parts);
    }
    let v4: [(&str, &[&str]); 4] = [
        ("1 1 1 1\n3 1 4 1\n1 1 2 3 5\n", &["line 16: element 1 names node 5"]),
        ("1 1 1 1\n3 1 4 88888888\n1 1 2 3 4\n", &["line 15: 88888888 elements are announced"]),
        ("1 2 1 2\n3 1 4 2\n1 1 2 3 4\n1 1 2 3 4\n", &["line 17: element 1 exists already"]),
        (
            "1 1 1 1\n3 1 14 1\n1 1 2 3 4 1 2 3 4 1 2 3 4 1 2\n",
            &["elements of type pyramid14", "`Mesh.SecondOrderIncomplete = 1`"],
        ),
    ];
    for (text, parts) in v4 {
        assert_message("a.msh", &format!("{V4}$Elements\n{text}$EndElements\n"), parts);
    }
    assert_message("a.msh", &V4.replace("3 1 0 4", "9 1 0 4"), &["line 6: a block of nodes of dimension 9"]);
    assert_message(
        "a.msh",
        &V4.replace("1 2 3 4", "1 -2 3 4"),
        &["line 7: expected a whole number, found \"-2\""],
    );
}

#[test]
fn errors_of_binary_files_name_the_byte() {
    let whole = bytes("hex8-41-binary.msh");
    let message = |bytes: &[u8]| emmy_io::mesh::parse("a.msh".as_ref(), bytes).unwrap_err().to_string();
    assert!(message(&whole[..whole.len() - 100]).starts_with("a.msh, byte "));
    let nodes = whole.windows(6).position(|window| window == b"$Nodes").unwrap() + 7;
    let mut lying = whole.clone();
    lying[nodes..nodes + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    let lie = message(&lying);
    assert!(lie.contains("18446744073709551615 blocks of nodes are announced"), "{lie}");
    let wedges = emmy_io::mesh::read(&path("wedge18.msh")).unwrap_err().to_string();
    assert!(wedges.contains(", byte ") && wedges.contains("wedge18"), "{wedges}");
}

#[test]
fn names_must_be_utf8() {
    let mut name = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"".to_vec();
    name.extend(b"\xff\"\n$EndPhysicalNames\n");
    let message = emmy_io::mesh::parse("a.msh".as_ref(), &name).unwrap_err().to_string();
    assert!(message.contains("line 6: text that is not UTF-8"), "{message}");
    let message = emmy_io::mesh::parse("a.inp".as_ref(), b"*Node, nset=\xe4\n").unwrap_err().to_string();
    assert!(message.contains("line 1: text that is not UTF-8; save the file as UTF-8"), "{message}");
}

#[test]
fn bad_abaqus_nodes_and_elements() {
    let cases: [(&str, &[&str]); 16] = [
        ("*Element, type=C3D4\n1, 1, 2, 3, 5\n", &["line 7: element 1 names node 5"]),
        ("*Element, type=C3D4\n1, 1, 2, 3\n", &["line 7: element 1 of type C3D4 has 3 nodes instead of 4"]),
        ("*Element, type=C3D4\n1, 1, 2, 3,\n", &["line 7: element 1 of type C3D4 has 3 nodes instead of 4"]),
        ("*Element, type=C3D4\n1, 1, 2, 3, 4, 1\n", &["has 5 nodes instead of 4"]),
        ("*Element, type=C3D4\n1, 1, 2, 3, x\n", &["line 7: expected a whole number, found \"x\""]),
        ("*Element, type=C3D4\n1,1,2,3,4\n1,1,2,3,4\n", &["line 8: element 1 exists already"]),
        (
            "*Element, type=S4\n1,1,2,3,4\n",
            &[
                "a.inp: the file has no solid or plane cells, only 1 S4; shells",
                "plane-strain",
                "C3D8",
                "C3D10",
            ],
        ),
        ("*Element, type=c3d15v\n", &["line 6: elements of type C3D15V"]),
        ("*Element\n", &["line 6: *ELEMENT without type="]),
        ("*Node\n4, 0, 0, 0\n", &["line 7: node 4 exists already"]),
        ("*Node\n5, 0, nan, 0\n", &["line 7: node 5 has a coordinate that is not a finite number"]),
        ("*Node\n5, 0\n", &["line 7: node 5 has fewer than two coordinates"]),
        ("*Node\n5, 0, 0, zero\n", &["line 7: expected a number, found \"zero\""]),
        ("*Node, system=C\n", &["line 6: coordinates of system C are not supported"]),
        (
            "*Elgen\n1, 10\n",
            &["line 6: *ELGEN makes or moves nodes or elements", "write out all nodes and elements"],
        ),
        ("*Nset, nset=a\n1\n", &["the mesh has no solid or plane cells; the body must be in it"]),
    ];
    for (text, parts) in cases {
        assert_message("a.inp", &format!("{INP}{text}"), parts);
    }
}

#[test]
fn bad_abaqus_sets_and_surfaces() {
    let cases: [(&str, &[&str]); 12] = [
        ("*Elset\n", &["line 8: *ELSET without elset="]),
        ("*Elset, elset=a\nb\n", &["line 9: there is no element set \"b\" here or above"]),
        ("*Nset, nset=a\nb\n", &["line 9: there is no node set \"b\""]),
        ("*Nset, nset=a, elset=b\n", &["line 8: there is no element set \"b\""]),
        ("*Nset, nset=a, generate\n3, 1\n", &["line 9: expected first, last and step", "\"3, 1\""]),
        ("*Nset, nset=a, generate\n1, 3, 0\n", &["line 9: expected first, last and step"]),
        ("*Nset, nset=a, instance=Arm\n1\n", &["line 8: there is no instance \"Arm\" above, only: none"]),
        ("*Surface, name=a\n1, S5\n", &["line 9: element 1 (tet4) has no face S5"]),
        ("*Surface, name=a\n1, SPOS\n", &["line 9: expected a face S1 ... S6", "\"SPOS\""]),
        ("*Surface, name=a\n7, S1\n", &["line 9: there is no element 7"]),
        ("*Surface, name=a\nbody, S1\n", &["line 9: there is no element set \"body\""]),
        ("*Surface, type=NODE, name=a\nfoot\n", &["line 9: there is no node set \"foot\""]),
    ];
    for (text, parts) in cases {
        assert_message("a.inp", &format!("{INP}*Element, type=C3D4\n1, 1, 2, 3, 4\n{text}"), parts);
    }
}

#[test]
fn bad_abaqus_assemblies() {
    let part = format!("*Part, name=Tet\n{INP}*Element, type=C3D4\n1, 1, 2, 3, 4\n*End Part\n");
    let cases: [(&str, &[&str]); 8] = [
        ("", &["the mesh has no solid or plane cells; it has parts but no *Instance"]),
        ("*Part, name=TET\n", &["line 10: part \"TET\" exists already"]),
        ("*Instance, name=a, part=Arm\n", &["line 10: there is no part \"Arm\" above, only: Tet"]),
        ("*Instance, name=a\n", &["line 10: *INSTANCE without part="]),
        ("*Instance, name=a, part=Tet\n*Instance, name=A, part=Tet\n", &["line 11: instance \"A\" exists"]),
        (
            "*Instance, name=a, part=Tet\n1,2,3,4\n",
            &["line 11: expected a translation (3 numbers) or a rotation"],
        ),
        (
            "*Instance, name=a, part=Tet\n0,0,0,0,0,0,9\n",
            &["line 11: the two points of the axis", "must differ"],
        ),
        ("*Include, input=no-such.inp\n", &["line 10: the file no-such.inp cannot be read"]),
    ];
    for (text, parts) in cases {
        assert_message("a.inp", &format!("{part}{text}"), parts);
    }
    let circle = emmy_io::mesh::read(&path("circle.inp")).unwrap_err().to_string();
    assert!(
        circle.contains("circle.inp, line 2: the file ") && circle.contains("includes itself"),
        "{circle}"
    );
    // Each file includes the next one; the last one is not there.
    let folder = tempfile::tempdir().unwrap();
    for (name, line) in [("inp", "*INCLUDE, INPUT=NEXT.inp\n"), ("bdf", "INCLUDE 'NEXT.bdf'\n")] {
        for number in 0..20 {
            let line = line.replace("NEXT", &(number + 1).to_string());
            std::fs::write(folder.path().join(format!("{number}.{name}")), line).unwrap();
        }
        let message = emmy_io::mesh::read(&folder.path().join(format!("0.{name}"))).unwrap_err().to_string();
        let expected = format!("16.{name}, line 1: more than 16 files, each included by the one before");
        assert!(message.contains(&expected), "{message}");
    }
}

#[test]
fn cells_that_are_inverted_or_there_twice_have_their_own_numbers() {
    let inverted = "is inverted or degenerate: det(dX/dxi) = 0 at one of its points, and the mirrored";
    let (one, other) =
        ("a.msh: element 7 (tet4) ", "a.msh: element 9 has the nodes of element 7; remove one");
    let elements = |text: &str| format!("{V2}$Elements\n{text}$EndElements\n");
    assert_message("a.msh", &elements("1\n7 4 2 0 1 1 3 2 2\n"), &[one, inverted]);
    assert_message("a.msh", &elements("2\n7 4 2 1 1 1 2 3 4\n9 4 2 2 1 2 3 1 4\n"), &[other]);
    let elements = |text: &str| format!("{V4}$Elements\n1 2 7 9\n{text}$EndElements\n");
    assert_message("a.msh", &elements("3 1 4 1\n7 1 3 2 2\n"), &[one, inverted]);
    assert_message("a.msh", &elements("3 1 4 2\n7 1 2 3 4\n9 1 2 3 4\n"), &[other]);
    let inp = |text: &str| format!("{INP}*Element, type=C3D4\n{text}");
    assert_message("a.inp", &inp("7, 1, 3, 2, 2\n"), &["a.inp: element 7 (tet4) ", inverted]);
    assert_message(
        "a.inp",
        &inp("7, 1, 2, 3, 4\n9, 1, 2, 4, 3\n"),
        &["element 9 has the nodes of element 7"],
    );
    let part =
        format!("*Part, name=Tet\n{}*End Part\n*Instance, name=Arm, part=Tet\n", inp("7, 1, 3, 2, 2\n"));
    assert_message("a.inp", &part, &["a.inp: element 7 of instance Arm (tet4) is inverted"]);
    let vtu = std::fs::read_to_string(path("vtk-ascii.vtu")).unwrap();
    let vtu = vtu.replacen("9 11 10 0", "9 9 10 0", 1);
    assert_message("a.vtu", &vtu, &["a.vtu: cell 3 (counted from 0) (tet4) is inverted"]);
}

#[test]
fn nodes_at_one_place_are_noted() {
    let text = "5, 0, 0, 0\n6, 1, 0, 0\n7, 0, 1, 0\n8, 0, 0, -1\n*Element, type=C3D4\n1, 1, 2, 3, 4\n2, 5, 7, 6, 8\n";
    let file = parse_text("a.inp", &format!("{INP}{text}")).unwrap();
    let note = "3 nodes lie where another one does, the first at [0, 0, 0]: cells on both sides are not joined there";
    assert_eq!(file.notes, [note]);
}

#[test]
fn what_is_missing_may_be_on_lines_that_are_not_known() {
    let tet = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, ELSET=body\n1, 1,2,3,4\n";
    let grids = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n";
    let no_cells = "the mesh has no solid or plane cells; ";
    let cases = [
        ("a.inp", tet.replace("*ELEMENT", "*ELEMET"), no_cells, "1 *ELEMET (did you mean *ELEMENT?)"),
        ("a.inp", tet.replace("*NODE", "*NODES"), "names node 1, which", "1 *NODES (did you mean *NODE?)"),
        (
            "a.inp",
            tet.replace("C3D4", "MASS").replace("1, 1,2,3,4", "1, 4") + "*WARP FIELD\n1\n",
            "only 1 MASS",
            "1 *WARP FIELD",
        ),
        (
            "a.inp",
            format!("{tet}*ELSETS, ELSET=a\n1\n*NSET, NSET=b, ELSET=a\n"),
            "no element set \"a\"",
            "1 *ELSETS (did you mean *ELSET?)",
        ),
        (
            "a.bdf",
            format!("{grids}CQUAD5,1,1,1,2,3,4\nCQUAD5,2,1,1,2,3,4\n"),
            no_cells,
            "2 CQUAD5 (did you mean",
        ),
        ("a.bdf", format!("{grids}FOOEL,1,1,1,2,3,4\nCONM2,3,1,,2.5\n"), "only 1 CONM2", "1 FOOEL"),
        (
            "a.bdf",
            format!("{}CTETRA,1,1,1,2,3,4\n", grids.replacen("GRID", "GRIDD9", 1)),
            "names node 1, which",
            "1 GRIDD9",
        ),
        (
            "a.bdf",
            format!("{}CTETRA,1,1,1,2,3,4\n", grids.replacen("GRID,1,", "GRID,1,5", 1)),
            "no coordinate system 5",
            "",
        ),
        (
            "a.bdf",
            format!("{grids}ENDDATA\nCTETRA,1,1,1,2,3,4\n"),
            no_cells,
            "a.bdf, line 6: 1 line after ENDDATA is not read",
        ),
    ];
    for (name, text, error, suspects) in cases {
        let message = parse_text(name, &text).unwrap_err().to_string();
        assert!(message.contains(error) && message.contains(suspects), "{message}");
        assert!(suspects.is_empty() || message.find(error) < message.find(suspects), "{message}");
    }
    let folder = tempfile::tempdir().unwrap();
    let main = folder.path().join("a.bdf");
    std::fs::write(&main, "INCLUDE 'g.bdf'\nCTETRA,1,1,1,2,3,4\nENDDATA\n").unwrap();
    std::fs::write(folder.path().join("g.bdf"), format!("{grids}ENDDATA\n")).unwrap();
    let message = emmy_io::mesh::read(&main).unwrap_err().to_string();
    let place = folder.path().join("g.bdf").display().to_string();
    let rest = format!("a.bdf, line 2: 2 lines after ENDDATA of {place}, line 5 are not read");
    assert!(message.contains(no_cells) && message.contains(&rest), "{message}");
}

#[test]
fn elements_beside_the_cells_may_name_a_node_that_is_not_there() {
    let tet = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, ELSET=body\n1, 1,2,3,4\n";
    for (kind, nodes) in [("T3D2", "1, 99"), ("B31", "1, 99"), ("S3", "1, 2, 99"), ("T3D3", "1, 2, 99")] {
        let text = format!("{tet}*ELEMENT, TYPE={kind}, ELSET=other\n2, {nodes}\n");
        let file = parse_text("a.inp", &text).unwrap();
        assert_eq!(file.notes, [format!("left out, though it may change the motion: 1 {kind}")]);
        assert_eq!(file.mesh.groups().nodes["other"].len(), nodes.split(',').count() - 1, "{kind}");
    }
    let grids =
        "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nCTETRA,1,1,1,2,3,4\n";
    for (card, nodes) in [("CBAR", "1,99"), ("CTRIA3", "1,2,99")] {
        let file = parse_text("a.bdf", &format!("{grids}{card},2,7,{nodes}\nENDDATA\n")).unwrap();
        let left_out = format!("left out, though it may change the motion: 1 {card}");
        let missing = "node set \"pid_7\" names 1 node that the file does not have".to_string();
        assert_eq!(file.notes, [left_out, missing]);
        assert_eq!(file.mesh.groups().nodes["pid_7"].len(), nodes.split(',').count() - 1, "{card}");
    }
}
