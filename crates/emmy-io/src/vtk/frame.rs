//! One frame as an unstructured grid (`.vtu`).

use std::fmt::Write;

use emmy::mesh::{CellKind, Mesh};
use emmy::motion::State;

use super::array::data_array;

/// What is the same in every frame, as XML.
#[derive(Debug)]
pub(super) struct Frame {
    n_nodes: usize,
    n_cells: usize,
    points_and_cells: String,
    cell_data: String,
}

/// Number of a cell type in VTK.
fn cell_type(kind: CellKind) -> u8 {
    match kind {
        CellKind::Hex8 => 12,
        CellKind::Hex20 => 25,
        CellKind::Hex27 => 29,
        CellKind::Tet4 => 10,
        CellKind::Tet10 => 24,
        CellKind::Wedge6 => 13,
        CellKind::Wedge15 => 26,
        CellKind::Pyramid5 => 14,
    }
}

impl Frame {
    pub(super) fn new(mesh: &Mesh, region_of_cell: &[u32]) -> Self {
        let offsets = mesh.cells().scan(0, |end, cell| {
            *end += cell.nodes.len() as i64;
            Some(*end)
        });
        let nodes = mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node)));
        let points = data_array("Points", 3, mesh.points().iter().flatten().copied());
        let cells = data_array("connectivity", 1, nodes)
            + &data_array("offsets", 1, offsets)
            + &data_array("types", 1, mesh.cells().map(|cell| cell_type(cell.kind)));
        Frame {
            n_nodes: mesh.n_nodes(),
            n_cells: mesh.n_cells(),
            points_and_cells: format!("<Points>\n{points}</Points>\n<Cells>\n{cells}</Cells>\n"),
            cell_data: data_array("region", 1, region_of_cell.iter().map(|&region| region as i32)),
        }
    }

    /// The file of a state.
    pub(super) fn xml(&self, state: &State) -> String {
        let mut xml =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" ");
        xml += "byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n";
        xml += "<UnstructuredGrid>\n<FieldData>\n";
        let time = state.time;
        let _ = writeln!(
            xml,
            "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{time:?}</DataArray>"
        );
        let _ = writeln!(
            xml,
            "</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
            self.n_nodes, self.n_cells
        );
        xml += &self.points_and_cells;
        xml += "<PointData Vectors=\"displacement\">\n";
        xml += &data_array("displacement", 3, state.displacement.iter().copied());
        xml += &data_array("velocity", 3, state.velocity.iter().copied());
        let _ = writeln!(xml, "</PointData>\n<CellData Scalars=\"region\">\n{}</CellData>", self.cell_data);
        xml += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
        xml
    }
}
