//! One frame as an unstructured grid (`.vtu`), or the list of its pieces (`.pvtu`).

use std::fmt::Write;

use emmy::body::{FieldName, FieldValues, Place};
use emmy::mesh::Mesh;
use rayon::prelude::*;

use super::array::{data_array, named_components};
use super::grid::{Grid, REGION, on_grid};
use super::{Precision, escaped};

/// The parts that are the same in every frame, as XML.
#[derive(Debug)]
pub(super) struct Frame {
    precision: Precision,
    n_nodes: usize,
    n_cells: usize,
    points_and_cells: String,
    /// Arrays at nodes and in cells.
    point_data: String,
    cell_data: String,
}

impl Frame {
    pub(super) fn new(precision: Precision, grid: &Grid<'_>) -> Self {
        let points = data_array("Points", 3, grid.mesh.points().iter().flatten().copied());
        let cells = data_array("connectivity", 1, grid.connectivity().into_iter())
            + &data_array("offsets", 1, grid.ends().into_iter())
            + &data_array("types", 1, grid.types().into_iter());
        let groups = |place: Place| -> String {
            let marks = grid.marks().into_iter().filter(|marks| marks.place == place);
            marks.map(|marks| data_array(&escaped(&marks.name), 1, marks.bits.into_iter())).collect()
        };
        Frame {
            precision,
            n_nodes: grid.mesh.n_nodes(),
            n_cells: grid.n_cells(),
            points_and_cells: format!("<Points>\n{points}</Points>\n<Cells>\n{cells}</Cells>\n"),
            point_data: groups(Place::Nodes),
            cell_data: match grid.regions() {
                None => groups(Place::Cells),
                Some(regions) => data_array(REGION, 1, regions.into_iter()) + &groups(Place::Cells),
            },
        }
    }

    /// The piece of a rank, with the numbers of its nodes and cells in the whole mesh.
    pub(super) fn numbered(mut self, nodes: &[u32], cells: &[u32], rank: usize) -> Self {
        let whole = |numbers: &[u32]| numbers.iter().map(|&number| i64::from(number)).collect::<Vec<_>>();
        self.point_data += &data_array(NODE, 1, whole(nodes).into_iter());
        self.cell_data += &data_array(CELL, 1, whole(cells).into_iter());
        self.cell_data += &data_array("rank", 1, cells.iter().map(|_| rank as i32));
        self
    }

    /// The list of the pieces of a frame.
    pub(super) fn list(&self, fields: &[FieldValues], sources: impl Iterator<Item = String>) -> String {
        let empty = |field: &FieldValues| FieldValues { name: field.name, numbers: Vec::new() };
        let of = |place: Place| -> String {
            let fields = fields.iter().filter(|field| field.name.place() == place);
            fields.map(|field| declared(&array(&empty(field), 0, self.precision))).collect()
        };
        let mut xml = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" {ATTRIBUTES}>\n<PUnstructuredGrid GhostLevel=\"0\">\n"
        );
        xml += &point_data(fields, "PPointData");
        xml += &(of(Place::Nodes) + &declared(&self.point_data));
        xml += "</PPointData>\n<PCellData Scalars=\"region\">\n";
        xml += &(of(Place::Cells) + &declared(&self.cell_data));
        let points = declared(&data_array::<f64>("Points", 3, std::iter::empty()));
        let _ = writeln!(xml, "</PCellData>\n<PPoints>\n{points}</PPoints>");
        for source in sources {
            let _ = writeln!(xml, "<Piece Source=\"{}\"/>", escaped(&source));
        }
        xml + "</PUnstructuredGrid>\n</VTKFile>\n"
    }

    /// The file with the fields at a time.
    pub(super) fn xml(&self, time: f64, fields: &[FieldValues]) -> String {
        let mut xml = format!(
            "{}<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
             format=\"ascii\">{time:?}</DataArray>\n</FieldData>\n",
            head()
        );
        self.push_piece(&mut xml);
        xml += &point_data(fields, "PointData");
        let arrays: Vec<String> =
            fields.par_iter().map(|field| array(field, self.n_cells, self.precision)).collect();
        let of =
            |place: Place| fields.iter().zip(&arrays).filter(move |(field, _)| field.name.place() == place);
        of(Place::Nodes).for_each(|(_, array)| xml += array);
        xml += &self.point_data;
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

/// Array of the numbers of nodes in the whole mesh, in pieces.
pub(crate) const NODE: &str = "node";

/// Array of the numbers of cells in the whole mesh, in pieces.
pub(crate) const CELL: &str = "cell";

/// Attributes of every grid.
const ATTRIBUTES: &str =
    "version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"";
const TAIL: &str = "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";

fn head() -> String {
    format!("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" {ATTRIBUTES}>\n<UnstructuredGrid>\n")
}

/// Begins the arrays at nodes in an element.
fn point_data(fields: &[FieldValues], element: &str) -> String {
    let has_displacement = fields.iter().any(|field| field.name == FieldName::Displacement);
    let vectors = if has_displacement { " Vectors=\"displacement\"" } else { "" };
    format!("<{element}{vectors}>\n")
}

/// The declarations of some arrays in a list of pieces.
fn declared(arrays: &str) -> String {
    let declaration = |array: &str| {
        let (attributes, _) = array.strip_prefix("<DataArray")?.split_once(" format=\"")?;
        Some(format!("<PDataArray{attributes}/>\n"))
    };
    arrays.lines().filter_map(declaration).collect()
}

/// The file of a mesh alone, with its groups, as [`crate::mesh::read`] reads it back.
///
/// ```
/// let mesh = emmy::mesh::l_block(1.0)?;
/// let file = emmy_io::vtk::mesh_file(&mesh);
/// assert_eq!(emmy_io::mesh::parse("l-block.vtu".as_ref(), file.as_bytes())?.mesh, mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mesh_file(mesh: &Mesh) -> String {
    let frame = Frame::new(Precision::Double, &Grid::new(mesh, None));
    let mut xml = format!("{}{MESH_MARK}\n", head());
    frame.push_piece(&mut xml);
    xml + "<PointData>\n" + &frame.point_data + "</PointData>\n<CellData>\n" + &frame.cell_data + TAIL
}

/// Comment in the file of a mesh that Emmy has written.
pub(crate) const MESH_MARK: &str = "<!-- Written by Emmy: the mesh of a run. -->";

fn array(field: &FieldValues, n_cells: usize, precision: Precision) -> String {
    let name = field.name.name();
    let components = field.name.components();
    let numbers = on_grid(field, n_cells);
    let numbers = numbers.iter();
    match precision {
        Precision::Double => named_components(name, components, numbers.copied()),
        Precision::Single => named_components(name, components, numbers.map(|&number| number as f32)),
    }
}
