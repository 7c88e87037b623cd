//! Mesh files of the L-shaped block in cells that the input has no key word for.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::PathBuf;

use emmy::mesh::{CellKind, Mesh, l_block};

use crate::scratch::Scratch;

/// A VTK file of the block in cells of a kind, with r hexahedra or six times as many tetrahedra per unit length.
///
/// # Errors
/// The message of the system if it cannot be written.
pub(crate) fn block_file(scratch: &Scratch, kind: CellKind, r: u32) -> Result<PathBuf, String> {
    let file = scratch.file(&format!("{kind}-{r}.vtu"));
    if !file.exists() {
        std::fs::write(&file, vtu(kind, r)?).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    Ok(file)
}

/// The L-shaped block in cells of a kind, as the text of a VTK file.
fn vtu(kind: CellKind, r: u32) -> Result<String, String> {
    let block = l_block(1.0 / f64::from(r)).map_err(|error| error.to_string())?;
    let (points, cells) = refined(&block, kind);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid>\n<Piece \
         NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"ascii\">\n",
        points.len(),
        cells.len()
    );
    let failed = |error: std::fmt::Error| error.to_string();
    points.iter().try_for_each(|[x, y, z]| writeln!(text, "{x:?} {y:?} {z:?}")).map_err(failed)?;
    text.push_str(
        "</DataArray></Points>\n<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n",
    );
    let words = |numbers: &[usize]| numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    cells.iter().try_for_each(|nodes| writeln!(text, "{}", words(nodes))).map_err(failed)?;
    let n = kind.n_nodes();
    for (name, numbers) in [
        ("offsets", (1..=cells.len()).map(|cell| n * cell).collect::<Vec<_>>()),
        ("types", vec![usize::from(kind.info().vtk_type); cells.len()]),
    ] {
        let head = format!("</DataArray>\n<DataArray type=\"Int64\" Name=\"{name}\" format=\"ascii\">\n");
        text.push_str(&head);
        text.push_str(&words(&numbers));
    }
    text.push_str("\n</DataArray></Cells>\n</Piece></UnstructuredGrid></VTKFile>\n");
    Ok(text)
}

type Points = Vec<[f64; 3]>;

/// Points and cells of a kind in the place of hex8 cells; six tetrahedra in each.
fn refined(block: &Mesh, kind: CellKind) -> (Points, Vec<Vec<usize>>) {
    let (mut points, mut numbers, mut cells) = (Points::new(), HashMap::new(), Vec::new());
    let mut number = |place: [f64; 3]| {
        *numbers.entry(place.map(|x| (1e6 * x).round() as i64)).or_insert_with(|| {
            points.push(place);
            points.len() - 1
        })
    };
    let reference = kind.info().element.nodes();
    for cell in block.cells() {
        let corner = |local: usize| block.points()[cell.nodes[local] as usize];
        let (low, high) = (corner(0), corner(6));
        let inside = |t: [f64; 3]| [0, 1, 2].map(|d| low[d] + t[d] * (high[d] - low[d]));
        if kind == CellKind::Tet10 {
            for corners in tetrahedra() {
                let place =
                    |xi: &[f64; 3]| [0, 1, 2].map(|d| (0..3).map(|k| xi[k] * corners[k + 1][d]).sum::<f64>());
                cells.push(reference.iter().map(|xi| number(inside(place(xi)))).collect());
            }
        } else {
            let place = |xi: &[f64; 3]| xi.map(|x| 0.5 * (x + 1.0));
            cells.push(reference.iter().map(|xi| number(inside(place(xi)))).collect());
        }
    }
    (points, cells)
}

/// Corners of the six tetrahedra along the diagonal of the unit cube.
fn tetrahedra() -> [[[f64; 3]; 4]; 6] {
    // Even permutations of the axes, then odd ones, whose tetrahedra are turned.
    [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]].map(|order| {
        let mut corners = [[0.0; 3]; 4];
        for (step, axis) in order.into_iter().enumerate() {
            corners[step + 1] = corners[step];
            corners[step + 1][axis] = 1.0;
        }
        if (order[1] + 3 - order[0]) % 3 == 2 {
            corners.swap(1, 2);
        }
        corners
    })
}
