//! Small files that request very much are rejected before anything is allocated.

use std::fmt::Write;
use std::fs;

use crate::meshes::parse_text;

#[track_caller]
fn assert_rejected(name: &str, text: &str, parts: &[&str]) {
    let message = parse_text(name, text).expect_err(text).to_string();
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is not in: {message}");
    }
}

#[test]
fn counts_of_gmsh() {
    let header = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    for section in [
        "$Nodes\n1 9000000000 1 9\n3 1 0 9000000000\n1\n",
        "$Elements\n9000000000 1 1 1\n3 1 4 1\n",
        "$Entities\n0 0 0 9000000000\n",
    ] {
        assert_rejected("a.msh", &format!("{header}{section}"), &["9000000000", "room for at most"]);
    }
}

#[test]
fn counts_of_vtu() {
    for counts in [
        "NumberOfPoints=\"4294967295\" NumberOfCells=\"1\"",
        "NumberOfPoints=\"1\" NumberOfCells=\"4294967295\"",
    ] {
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>\n<Piece {counts}></Piece></UnstructuredGrid></VTKFile>"
        );
        assert_rejected("a.vtu", &text, &["line 2", "4294967295", "more than the 100000000"]);
    }
}

#[test]
fn entities_of_xml_are_not_expanded() {
    let mut text = "<?xml version=\"1.0\"?>\n<!DOCTYPE a [<!ENTITY b \"0 0 0 0\">\n".to_string();
    for letter in 'c'..='z' {
        let before = char::from(letter as u8 - 1);
        let _ = writeln!(text, "<!ENTITY {letter} \"{}\">", format!("&{before};").repeat(10));
    }
    assert_rejected("a.vtu", &(text + "]>\n<VTKFile>&z;</VTKFile>"), &["the XML cannot be read"]);
}

/// Forty lines each in forty files, three levels deep, would be 64,000 files to read.
#[test]
fn includes_of_includes() {
    let directory = tempfile::tempdir().unwrap();
    for level in 0..3 {
        let line = format!("*Include, input=level-{}.inp\n", level + 1);
        fs::write(directory.path().join(format!("level-{level}.inp")), line.repeat(40)).unwrap();
    }
    fs::write(directory.path().join("level-3.inp"), "** nothing\n").unwrap();
    let error = emmy_io::mesh::read(&directory.path().join("level-0.inp")).unwrap_err().to_string();
    assert!(error.contains("more than 1000 files are included"), "{error}");
}

#[cfg(unix)]
#[test]
fn includes_that_never_end() {
    assert_rejected("a.inp", "*Include, input=/dev/zero\n", &["line 1", "/dev/zero", "not a regular file"]);
}
