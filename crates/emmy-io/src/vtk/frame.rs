//! One frame as an unstructured grid (`.vtu`).

use std::fmt::Write;

use emmy::mesh::Mesh;
use emmy::motion::State;

use super::array::data_array;
use super::{FACETS, GROUP, cell_type, escaped};

/// What is the same in every frame, as XML.
#[derive(Debug)]
pub(super) struct Frame {
    n_nodes: usize,
    n_cells: usize,
    points_and_cells: String,
    cell_data: String,
    node_groups: String,
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
            cell_data: data_array("region", 1, region_of_cell.iter().map(|&region| region as i32))
                + &cell_groups(mesh)
                + &facet_groups(mesh),
            node_groups: node_groups(mesh),
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
        xml += &self.node_groups;
        let _ = writeln!(xml, "</PointData>\n<CellData Scalars=\"region\">\n{}</CellData>", self.cell_data);
        xml += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
        xml
    }
}

/// An array for each group, 1 for its members.
fn node_groups(mesh: &Mesh) -> String {
    let groups = mesh.groups().nodes.iter();
    groups
        .map(|(name, nodes)| marks(GROUP, name, mesh.n_nodes(), nodes.iter().map(|&node| (node, 1))))
        .collect()
}

fn cell_groups(mesh: &Mesh) -> String {
    let groups = mesh.groups().cells.iter();
    groups
        .map(|(name, cells)| marks(GROUP, name, mesh.n_cells(), cells.iter().map(|&cell| (cell, 1))))
        .collect()
}

/// An array of the cells for each group, with a bit for each of their faces.
fn facet_groups(mesh: &Mesh) -> String {
    let groups = mesh.groups().facets.iter();
    let bits = |facet: &emmy::mesh::Facet| (facet.cell, 1 << facet.local);
    groups.map(|(name, facets)| marks(FACETS, name, mesh.n_cells(), facets.iter().map(bits))).collect()
}

fn marks(prefix: &str, name: &str, n: usize, members: impl Iterator<Item = (u32, u8)>) -> String {
    let mut values = vec![0; n];
    members.for_each(|(member, bits)| values[member as usize] |= bits);
    data_array::<u8>(&escaped(&format!("{prefix}{name}")), 1, values.into_iter())
}
