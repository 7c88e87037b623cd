//! Cells whose nodes are numbered the other way round, from every format.

use crate::meshes::{parse_text, volume};

/// Two tetrahedra with a common face, of the volumes 1/6 and 1/3.
const POINTS: [[f64; 3]; 5] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
const CELLS: [[usize; 4]; 2] = [[0, 1, 2, 3], [1, 4, 2, 3]];

/// The tetrahedra, some of them mirrored, in a format.
fn text(format: &str, mirrored: [bool; 2]) -> String {
    let mut cells = CELLS;
    cells.iter_mut().zip(mirrored).filter(|(_, mirrored)| *mirrored).for_each(|(cell, _)| cell.swap(1, 2));
    let rows = |separator: &str, head: &dyn Fn(usize) -> String, first: usize| -> String {
        let row = |(i, nodes): (usize, &[usize; 4])| {
            let nodes: Vec<String> = nodes.iter().map(|node| (node + first).to_string()).collect();
            format!("{}{}\n", head(i + 1), nodes.join(separator))
        };
        cells.iter().enumerate().map(row).collect()
    };
    let points = |separator: &str, head: &dyn Fn(usize) -> String| -> String {
        let row = |(i, [x, y, z]): (usize, &[f64; 3])| {
            format!("{}{x:?}{separator}{y:?}{separator}{z:?}\n", head(i + 1))
        };
        POINTS.iter().enumerate().map(row).collect()
    };
    match format {
        "msh" => format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n{}$EndNodes\n$Elements\n2\n{}$EndElements\n",
            points(" ", &|i| format!("{i} ")),
            rows(" ", &|i| format!("{i} 4 2 1 1 "), 1)
        ),
        "inp" => format!(
            "*Node\n{}*Element, type=C3D4\n{}",
            points(",", &|i| format!("{i},")),
            rows(",", &|i| format!("{i},"), 1)
        ),
        "bdf" => points(",", &|i| format!("GRID,{i},,")) + &rows(",", &|i| format!("CTETRA,{i},1,"), 1),
        _ => format!(
            "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid>\
             <Piece NumberOfPoints=\"5\" NumberOfCells=\"2\"><Points>\
             <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{}</DataArray></Points><Cells>\
             <DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">{}</DataArray>\
             <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4 8</DataArray>\
             <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 10</DataArray>\
             </Cells></Piece></UnstructuredGrid></VTKFile>",
            points(" ", &|_| String::new()),
            rows(" ", &|_| String::new(), 0)
        ),
    }
}

#[test]
fn mirrored_cells_are_turned_with_a_note_in_every_format() {
    for format in ["msh", "inp", "bdf", "vtu"] {
        let read = |mirrored| parse_text(&format!("a.{format}"), &text(format, mirrored)).unwrap();
        let right = read([false; 2]);
        assert!((volume(&right.mesh) - 0.5).abs() < 1e-15, "{format}");
        for (mirrored, note) in [
            ([true, false], "1 cell was numbered the other way round (negative volume) and turned"),
            ([true, true], "all 2 cells are numbered the other way round (negative volume) and were turned"),
        ] {
            let turned = read(mirrored);
            assert_eq!(turned.mesh, right.mesh, "{format}");
            let mut others = turned.notes.clone();
            others.retain(|own| !own.starts_with(note));
            assert_eq!(
                (others.len() + 1, &others),
                (turned.notes.len(), &right.notes),
                "{format} {turned:?}"
            );
        }
    }
}
