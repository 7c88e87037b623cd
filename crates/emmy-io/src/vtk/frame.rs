//! One frame as an unstructured grid (`.vtu`).

use std::fmt::Write;

use emmy::body::{FieldName, FieldValues, Place};
use emmy::mesh::Mesh;
use rayon::prelude::*;

use super::array::{data_array, named_components};
use super::marks::marks;
use super::{Precision, cell_type, escaped};

/// The parts that are the same in every frame, as XML.
#[derive(Debug)]
pub(super) struct Frame {
    precision: Precision,
    n_nodes: usize,
    n_cells: usize,
    points_and_cells: String,
    cell_data: String,
    node_groups: String,
}

impl Frame {
    pub(super) fn new(precision: Precision, mesh: &Mesh, region_of_cell: &[u32]) -> Self {
        let offsets = mesh.cells().scan(0, |end, cell| {
            *end += cell.nodes.len() as i64;
            Some(*end)
        });
        let nodes = mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node)));
        let points = data_array("Points", 3, mesh.points().iter().flatten().copied());
        let cells = data_array("connectivity", 1, nodes)
            + &data_array("offsets", 1, offsets)
            + &data_array("types", 1, mesh.cells().map(|cell| cell_type(cell.kind)));
        let groups = |place: Place| -> String {
            let marks = marks(mesh).into_iter().filter(|marks| marks.place == place);
            marks.map(|marks| data_array(&escaped(&marks.name), 1, marks.bits.into_iter())).collect()
        };
        Frame {
            precision,
            n_nodes: mesh.n_nodes(),
            n_cells: mesh.n_cells(),
            points_and_cells: format!("<Points>\n{points}</Points>\n<Cells>\n{cells}</Cells>\n"),
            cell_data: match region_of_cell {
                [] => groups(Place::Cells),
                regions => {
                    data_array("region", 1, regions.iter().map(|&region| region as i32))
                        + &groups(Place::Cells)
                }
            },
            node_groups: groups(Place::Nodes),
        }
    }

    /// The file with the fields at a time.
    pub(super) fn xml(&self, time: f64, fields: &[FieldValues]) -> String {
        let mut xml = format!(
            "{HEAD}<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
             format=\"ascii\">{time:?}</DataArray>\n</FieldData>\n"
        );
        self.push_piece(&mut xml);
        let has_displacement = fields.iter().any(|field| field.name == FieldName::Displacement);
        xml += if has_displacement { "<PointData Vectors=\"displacement\">\n" } else { "<PointData>\n" };
        let arrays: Vec<String> = fields.par_iter().map(|field| array(field, self.precision)).collect();
        let of =
            |place: Place| fields.iter().zip(&arrays).filter(move |(field, _)| field.name.place() == place);
        of(Place::Nodes).for_each(|(_, array)| xml += array);
        xml += &self.node_groups;
        xml += "</PointData>\n<CellData Scalars=\"region\">\n";
        of(Place::Cells).for_each(|(_, array)| xml += array);
        xml += &self.cell_data;
        xml += TAIL;
        xml
    }

    /// Begins the piece: its points and cells.
    fn push_piece(&self, xml: &mut String) {
        let _ =
            writeln!(xml, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", self.n_nodes, self.n_cells);
        *xml += &self.points_and_cells;
    }
}

const HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
                    byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n";
const TAIL: &str = "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";

/// The file of a mesh alone, with its groups, as [`crate::mesh::read`] reads it back.
///
/// ```
/// let mesh = emmy::mesh::l_block(1.0)?;
/// let file = emmy_io::vtk::mesh_file(&mesh);
/// assert_eq!(emmy_io::mesh::parse("l-block.vtu".as_ref(), file.as_bytes())?.mesh, mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mesh_file(mesh: &Mesh) -> String {
    let frame = Frame::new(Precision::Double, mesh, &[]);
    let mut xml = format!("{HEAD}{MESH_MARK}\n");
    frame.push_piece(&mut xml);
    xml + "<PointData>\n" + &frame.node_groups + "</PointData>\n<CellData>\n" + &frame.cell_data + TAIL
}

/// Comment in the file of a mesh that Emmy has written.
pub(crate) const MESH_MARK: &str = "<!-- Written by Emmy: the mesh of a run. -->";

fn array(field: &FieldValues, precision: Precision) -> String {
    let name = field.name.name();
    let components = field.name.components();
    let numbers = field.numbers.iter();
    match precision {
        Precision::Double => named_components(name, components, numbers.copied()),
        Precision::Single => named_components(name, components, numbers.map(|&number| number as f32)),
    }
}
