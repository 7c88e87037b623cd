//! Arrays of bytes and bits in files of VTK.

use emmy_io::mesh::{Grid, MeshFile, MeshOptions, from_grid, parse, parse_with};

use crate::meshes::volume;

/// A row of `n` voxels in a legacy file, up to its arrays.
fn row(n: usize, encoding: &str) -> String {
    format!(
        "# vtk DataFile Version 5.1\nrow\n{encoding}\nDATASET STRUCTURED_POINTS\nDIMENSIONS {} 2 2\nORIGIN 0 0 0\n\
         SPACING 1 1 1\nCELL_DATA {n}\n",
        n + 1
    )
}

fn read(bytes: &[u8]) -> MeshFile {
    let name = if bytes.starts_with(b"<") { "row.vtu" } else { "row.vtk" };
    parse(name.as_ref(), bytes).unwrap_or_else(|error| panic!("{error}"))
}

/// Bytes as VTK writes them into text: divided by 255, with six digits.
fn colors(name: &str, bytes: &[u8]) -> String {
    let numbers: Vec<String> = bytes.iter().map(|&byte| format!("{:.6}", f64::from(byte) / 255.0)).collect();
    format!("COLOR_SCALARS {name} 1\n{}\n", numbers.join(" "))
}

#[test]
fn every_byte_of_color_scalars_is_a_tag() {
    let all: Vec<u8> = (0..=255).collect();
    let binary = [row(256, "BINARY").as_bytes(), b"COLOR_SCALARS cell_tags 1\n", &all].concat();
    for bytes in [(row(256, "ASCII") + &colors("cell_tags", &all)).into_bytes(), binary] {
        let file = read(&bytes);
        let groups = file.mesh.groups();
        assert_eq!((groups.names().len(), &file.notes[..]), (256, &[][..]));
        for tag in 0..256 {
            assert_eq!(groups.cells(&format!("cell_tags={tag}")).unwrap(), [tag]);
        }
    }
}

#[test]
fn ghosts_in_color_scalars_are_left_out() {
    // Bit 1: the cell belongs to another piece.
    let file = read((row(4, "ASCII") + &colors("vtkGhostType", &[0, 1, 0, 1])).as_bytes());
    assert_eq!((file.mesh.n_cells(), volume(&file.mesh)), (2, 2.0));
    // The last cell is one of them: the nodes at its end belong to no other.
    assert_eq!(
        file.notes,
        ["2 ghost or hidden cells are left out", "4 nodes belong to no cell and are left out"]
    );
}

#[test]
fn arrays_on_points_that_are_left_out_have_their_reason() {
    let text = row(2, "ASCII")
        + "SCALARS part int\nLOOKUP_TABLE default\n1 2\nPOINT_DATA 12\nSCALARS part int\nLOOKUP_TABLE default\n\
           1 1 1 1 1 1 1 1 1 1 1 1\nSCALARS facets:end int\nLOOKUP_TABLE default\n0 0 0 0 0 0 0 0 0 0 0 1\n";
    assert_eq!(
        read(text.as_bytes()).notes,
        [
            "arrays that are left out, because they are on points, and cells have arrays of the same names: part",
            "arrays that are left out, because they are on points, and facets are told by arrays on cells: facets:end",
        ]
    );
}

#[test]
fn misspelt_elements_and_wedges_of_18_nodes_are_told() {
    let piece = |inside: &str| {
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n\
             {inside}</Piece></UnstructuredGrid></VTKFile>"
        );
        parse("a.vtu".as_ref(), text.as_bytes()).unwrap_err().to_string()
    };
    let section = piece("<CellDat/>");
    assert!(
        section.starts_with(
            "a.vtu, line 2: the element <CellDat> is not known (did you mean `CellData`?); correct its name"
        ),
        "{section}"
    );
    let array = piece("<PointData>\n<DataAray/></PointData>");
    assert!(
        array.starts_with(
            "a.vtu, line 3: the element <DataAray> is not known (did you mean `DataArray`?); correct its name"
        ),
        "{array}"
    );
    for id in [32, 73] {
        let grid = Grid {
            points: vec![[0.0; 3]; 18],
            types: vec![id],
            ends: vec![18],
            connectivity: (0..18).collect(),
            ..Grid::default()
        };
        let error = from_grid("the grid".as_ref(), grid, &[]).unwrap_err().to_string();
        assert!(
            error.contains("`Mesh.SecondOrderIncomplete = 1`") && error.contains("Tetrahedralize"),
            "{error}"
        );
    }
}

#[test]
fn bits_are_a_group_in_every_form() {
    // Cells 0, 2 and 9 of 10: the bits 10100000 01......
    let ascii = "SCALARS group:some bit\nLOOKUP_TABLE default\n1 0 1 0 0 0 0 0 0 1\n";
    let field = "FIELD FieldData 1\ngroup:some 1 10 bit\n1 0 1 0 0 0 0 0 0 1\n";
    let binary =
        [row(10, "BINARY").as_bytes(), b"FIELD FieldData 1\ngroup:some 1 10 bit\n\xa0\x40\n"].concat();
    let legacy = [ascii, field].map(|array| (row(10, "ASCII") + array).into_bytes());
    // Base64 of the length 2, 0, 0, 0 and the two bytes.
    let xml = [("ascii", "1 0 1 0 0 0 0 0 0 1"), ("binary", "AgAAAKBA")].map(|(format, array)| {
        let points: Vec<String> =
            (0..4).flat_map(|k| (0..11).map(move |i| format!("{i} {} {}", k % 2, k / 2))).collect();
        let nodes = |i: usize| [0, 1, 11, 12, 22, 23, 33, 34].map(|corner| (i + corner).to_string()).join(" ");
        let cells: Vec<String> = (0..10).map(nodes).collect();
        let ends: Vec<String> = (1..11).map(|i| (8 * i).to_string()).collect();
        format!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\
             <UnstructuredGrid><Piece NumberOfPoints=\"44\" NumberOfCells=\"10\"><CellData>\
             <DataArray type=\"Bit\" Name=\"group:some\" format=\"{format}\">{array}</DataArray></CellData><Points>\
             <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{}</DataArray></Points><Cells>\
             <DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">{}</DataArray>\
             <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{}</DataArray>\
             <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{}</DataArray>\
             </Cells></Piece></UnstructuredGrid></VTKFile>",
            points.join(" "),
            cells.join(" "),
            ends.join(" "),
            ["11"; 10].join(" ")
        )
        .into_bytes()
    });
    for bytes in legacy.into_iter().chain(xml).chain([binary]) {
        let file = read(&bytes);
        assert_eq!(file.mesh.groups().cells("some").unwrap(), [0, 2, 9]);
        assert_eq!(file.notes, [""; 0]);
    }
}

#[test]
fn a_wish_for_plane_shells_without_effect_is_noted() {
    let options = MeshOptions { plane_shells: true, ..MeshOptions::default() };
    let file = parse_with("row.vtk".as_ref(), row(2, "ASCII").as_bytes(), &options).unwrap();
    let note = "`shells` has no effect on files of Gmsh and VTK: without solid cells, their surfaces are cells in plane strain";
    assert_eq!(file.notes, [note]);
}
