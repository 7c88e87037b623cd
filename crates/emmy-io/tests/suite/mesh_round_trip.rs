//! Random meshes, written as Gmsh, Abaqus and VTK by this test, are read unchanged.

use std::fmt::Write;

use crate::meshes::parse_text;
use emmy::mesh::{Cell, CellKind, Mesh, MeshBuilder};
use proptest::prelude::*;

/// A mesh, and the additional data of its file.
#[derive(Debug)]
struct Sample {
    mesh: Mesh,
    /// Number of each node in the file, without order.
    numbers: Vec<usize>,
    /// Group of each cell: `left` or `right`.
    is_left: Vec<bool>,
    /// Corner nodes of the facets of the group `skin`.
    skin: Vec<Vec<u32>>,
    /// Nodes of the group `probe`.
    probe: Vec<u32>,
}

/// Corners of the six tetrahedra around the diagonal of a hexahedron, by their numbers in it.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

/// Kind and nodes of the cells of a block, optionally cut into tetrahedra.
fn cells(block: &Mesh, tetrahedra: bool) -> Vec<(CellKind, Vec<u32>)> {
    let cut = |cell: Cell<'_>| -> Vec<(CellKind, Vec<u32>)> {
        match tetrahedra {
            true => TETRAHEDRA.map(|four| (CellKind::Tet4, four.map(|i| cell.nodes[i]).to_vec())).to_vec(),
            false => vec![(CellKind::Hex8, cell.nodes.to_vec())],
        }
    };
    block.cells().flat_map(cut).collect()
}

/// Some of many, chosen by the bits of random numbers.
fn is_chosen(bits: &[u64], index: usize) -> bool {
    bits[index / 64 % bits.len()] >> (index % 64) & 1 == 1
}

fn sample() -> impl Strategy<Value = Sample> {
    let shape = (1..4_usize, 1..4_usize, 1..3_usize, any::<bool>());
    let sizes = (1e-3..1e3, 1e-3..1e3, 1e-3..1e3);
    let bits = prop::collection::vec(any::<u64>(), 12);
    (shape, sizes, bits, -0.05..0.05, 1..1000_usize).prop_map(
        |((nx, ny, nz, tetrahedra), (a, b, c), bits, shake, first)| {
            let block = emmy::mesh::block([a, b, c], [nx, ny, nz]).unwrap();
            let edges = [a / nx as f64, b / ny as f64, c / nz as f64];
            let shaken = |(index, point): (usize, &[f64; 3])| -> [f64; 3] {
                let angle = |axis: usize| ((3 * index + axis) as f64 * 1.7).sin();
                [0, 1, 2].map(|axis| point[axis] + shake * edges[axis] * angle(axis))
            };
            let points: Vec<[f64; 3]> = block.points().iter().enumerate().map(shaken).collect();
            let n = points.len();
            // Multiples of a number coprime to the prime 1009: all different, and in no order.
            let numbers = (0..n).map(|index| (index + first) * 389 % 1009 + 1).collect();
            built(points, numbers, &cells(&block, tetrahedra), &bits)
        },
    )
}

fn built(points: Vec<[f64; 3]>, numbers: Vec<usize>, cells: &[(CellKind, Vec<u32>)], bits: &[u64]) -> Sample {
    let mut builder = MeshBuilder::new();
    points.iter().for_each(|&point| {
        builder.point(point);
    });
    let is_left: Vec<bool> = (0..cells.len()).map(|index| is_chosen(bits, index)).collect();
    for (index, (kind, nodes)) in cells.iter().enumerate() {
        let cell = builder.cell(*kind, nodes).unwrap();
        builder.cell_group(if is_left[index] { "left" } else { "right" }, [cell]);
    }
    let corners = |(kind, nodes): &(CellKind, Vec<u32>)| -> Vec<u32> {
        let facet = &kind.facets()[0];
        facet.nodes[..facet.kind.n_corners()].iter().map(|&local| nodes[local]).collect()
    };
    // The first cell always has a facet in the group, so that the group is not empty.
    let in_skin = |index: &usize| *index == 0 || is_chosen(bits, index + 300);
    let skin: Vec<Vec<u32>> = (0..cells.len()).filter(in_skin).map(|index| corners(&cells[index])).collect();
    builder.facet_group_by_nodes("skin", skin.clone());
    let probe: Vec<u32> =
        (0..points.len() as u32).filter(|&node| node == 0 || is_chosen(bits, node as usize + 600)).collect();
    builder.node_group("probe", probe.iter().copied());
    Sample { mesh: builder.build().unwrap(), numbers, is_left, skin, probe }
}

impl Sample {
    fn number(&self, node: u32) -> usize {
        self.numbers[node as usize]
    }

    /// Numbers of nodes in a row.
    fn joined(&self, nodes: &[u32], between: &str) -> String {
        nodes.iter().map(|&node| self.number(node).to_string()).collect::<Vec<_>>().join(between)
    }

    /// Type of the cells in Gmsh, in Abaqus and in VTK.
    fn types(&self) -> (u8, &'static str, u8) {
        match self.mesh.cell(0).kind {
            CellKind::Tet4 => (4, "C3D4", 10),
            _ => (5, "C3D8", 12),
        }
    }

    /// Type of a facet in Gmsh and in VTK.
    fn facet_types(facet: &[u32]) -> (u8, u8) {
        if facet.len() == 3 { (2, 5) } else { (3, 9) }
    }

    /// Cells of a side by index.
    fn side(&self, left: bool) -> Vec<usize> {
        (0..self.is_left.len()).filter(|&cell| self.is_left[cell] == left).collect()
    }

    fn gmsh_22(&self) -> String {
        let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n0 4 \"probe\"\n2 3 \"skin\"\n3 1 \"left\"\n\
                        3 2 \"right\"\n$EndPhysicalNames\n"
            .to_string();
        let _ = writeln!(text, "$Nodes\n{}", self.mesh.n_nodes());
        for (node, [x, y, z]) in self.mesh.points().iter().enumerate() {
            let _ = writeln!(text, "{} {x:?} {y:?} {z:?}", self.numbers[node]);
        }
        let n = self.mesh.n_cells() + self.skin.len() + self.probe.len();
        let _ = writeln!(text, "$EndNodes\n$Elements\n{n}");
        for (index, cell) in self.mesh.cells().enumerate() {
            let (side, nodes) = (if self.is_left[index] { 1 } else { 2 }, self.joined(cell.nodes, " "));
            let _ = writeln!(text, "{} {} 2 {side} 1 {nodes}", index + 1, self.types().0);
        }
        for (number, facet) in (9000..).zip(&self.skin) {
            let kind = Self::facet_types(facet).0;
            let _ = writeln!(text, "{number} {kind} 2 3 1 {}", self.joined(facet, " "));
        }
        for (number, &node) in (19_000..).zip(&self.probe) {
            let _ = writeln!(text, "{number} 15 2 4 1 {}", self.number(node));
        }
        text + "$EndElements\n"
    }

    fn gmsh_41(&self) -> String {
        let box_and = |group: u8| format!("0 0 0 1 1 1 1 {group} 0");
        let mut text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n0 4 \"probe\"\n2 3 \"skin\"\n3 1 \"left\"\n\
                        3 2 \"right\"\n$EndPhysicalNames\n"
            .to_string();
        let _ = writeln!(text, "$Entities\n1 0 1 2\n1 0 0 0 1 4\n1 {}", box_and(3));
        let _ = writeln!(text, "1 {}\n2 {}\n$EndEntities", box_and(1), box_and(2));
        let n = self.mesh.n_nodes();
        let _ = writeln!(text, "$Nodes\n1 {n} 1 1009\n3 1 0 {n}");
        self.numbers.iter().for_each(|number| writeln!(text, "{number}").unwrap());
        self.mesh.points().iter().for_each(|[x, y, z]| writeln!(text, "{x:?} {y:?} {z:?}").unwrap());
        // Cells of one block stand together; blocks of one cell each keep their order.
        let n_facets = self.skin.len();
        let (n_blocks, n) =
            (self.mesh.n_cells() + n_facets + 1, self.mesh.n_cells() + n_facets + self.probe.len());
        let _ = writeln!(text, "$EndNodes\n$Elements\n{n_blocks} {n} 1 29999");
        for (index, cell) in self.mesh.cells().enumerate() {
            let entity = if self.is_left[index] { 1 } else { 2 };
            let _ = writeln!(
                text,
                "3 {entity} {} 1\n{} {}",
                self.types().0,
                index + 1,
                self.joined(cell.nodes, " ")
            );
        }
        for (number, facet) in (9000..).zip(&self.skin) {
            let kind = Self::facet_types(facet).0;
            let _ = writeln!(text, "2 1 {kind} 1\n{number} {}", self.joined(facet, " "));
        }
        let _ = writeln!(text, "0 1 15 {}", self.probe.len());
        for (number, &node) in (19_000..).zip(&self.probe) {
            let _ = writeln!(text, "{number} {}", self.number(node));
        }
        text + "$EndElements\n"
    }

    /// The facets are not written: Abaqus names them by cell and face.
    fn abaqus(&self) -> String {
        let mut text = "*Heading\nrandom\n*Node\n".to_string();
        for (node, [x, y, z]) in self.mesh.points().iter().enumerate() {
            let _ = writeln!(text, "{}, {x:?}, {y:?}, {z:?}", self.numbers[node]);
        }
        let _ = writeln!(text, "*Element, type={}", self.types().1);
        for (index, cell) in self.mesh.cells().enumerate() {
            let _ = writeln!(text, "{}, {}", index + 1, self.joined(cell.nodes, ", "));
        }
        for (name, left) in [("left", true), ("right", false)] {
            let cells: Vec<String> = self.side(left).iter().map(|cell| (cell + 1).to_string()).collect();
            if !cells.is_empty() {
                let _ = writeln!(text, "*Elset, elset={name}\n{}", cells.join("\n"));
            }
        }
        let _ = writeln!(text, "*Nset, nset=probe\n{}", self.joined(&self.probe, "\n"));
        text
    }

    fn vtu(&self) -> String {
        let listed = |nodes: &[u32]| nodes.iter().map(|node| node.to_string()).collect::<Vec<_>>().join(" ");
        let mut connectivity: Vec<(u8, String, usize)> = Vec::new();
        for cell in self.mesh.cells() {
            connectivity.push((self.types().2, listed(cell.nodes), cell.nodes.len()));
        }
        for facet in &self.skin {
            connectivity.push((Self::facet_types(facet).1, listed(facet), facet.len()));
        }
        let mut end = 0;
        let offsets: Vec<u32> = connectivity
            .iter()
            .map(|(_, _, n)| {
                end += *n as u32;
                end
            })
            .collect();
        let flags = |is_in: &dyn Fn(usize) -> bool, n: usize| {
            (0..n).map(|index| if is_in(index) { "1" } else { "0" }).collect::<Vec<_>>().join(" ")
        };
        let array = |name: &str, kind: &str, data: &str| {
            format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{data}</DataArray>")
        };
        let (n_cells, n) = (self.mesh.n_cells(), connectivity.len());
        let left = flags(&|index| index < n_cells && self.is_left[index], n);
        let right = flags(&|index| index < n_cells && !self.is_left[index], n);
        let skin = flags(&|index| index >= n_cells, n);
        let probe = flags(&|index| self.probe.contains(&(index as u32)), self.mesh.n_nodes());
        let [left, right] =
            [("group:left", left), ("group:right", right)].map(|(name, data)| array(name, "Int32", &data));
        let points: String =
            self.mesh.points().iter().map(|[x, y, z]| format!("{x:?} {y:?} {z:?}\n")).collect();
        let types = connectivity.iter().map(|(id, ..)| id.to_string()).collect::<Vec<_>>().join(" ");
        let nodes = connectivity.iter().map(|(_, nodes, _)| nodes.as_str()).collect::<Vec<_>>().join("\n");
        format!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
             <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{n}\">\n\
             <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray></Points>\n\
             <Cells>{}{}{}</Cells>\n<CellData>{left}{right}{}</CellData>\n<PointData>{}</PointData>\n\
             </Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
            self.mesh.n_nodes(),
            array("connectivity", "Int64", &nodes),
            array("offsets", "Int64", &listed(&offsets)),
            array("types", "UInt8", &types),
            array("group:skin", "Int32", &skin),
            array("group:probe", "Int32", &probe),
        )
    }

    /// Compares a mesh read back by the coordinates of its nodes: a file may number them in any order.
    fn assert_same(&self, name: &str, text: &str, with_facets: bool) {
        let read = parse_text(name, text).unwrap_or_else(|error| panic!("{error}\n{text}")).mesh;
        let corners = |mesh: &Mesh| -> Vec<Vec<[f64; 3]>> {
            let point = |node: &u32| mesh.points()[*node as usize];
            mesh.cells().map(|cell| cell.nodes.iter().map(point).collect()).collect()
        };
        assert_eq!(corners(&read), corners(&self.mesh), "{name}");
        // A group of a VTU file without a cell is empty.
        let side = |mesh: &Mesh, name: &str| mesh.groups().cells.get(name).cloned().unwrap_or_default();
        for group in ["left", "right"] {
            assert_eq!(side(&read, group), side(&self.mesh, group), "{name}");
        }
        let places = |mesh: &Mesh, group: &str| -> Vec<[f64; 3]> {
            let mut places: Vec<[f64; 3]> =
                mesh.group_nodes(group).unwrap().iter().map(|&node| mesh.points()[node as usize]).collect();
            places.sort_by(|a, b| a.partial_cmp(b).unwrap());
            places
        };
        assert_eq!(places(&read, "probe"), places(&self.mesh, "probe"), "{name}");
        if with_facets {
            assert_eq!(
                read.groups().facets("skin").unwrap(),
                self.mesh.groups().facets("skin").unwrap(),
                "{name}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_random_mesh_comes_back(sample in sample()) {
        sample.assert_same("a.msh", &sample.gmsh_22(), true);
        sample.assert_same("b.msh", &sample.gmsh_41(), true);
        sample.assert_same("c.inp", &sample.abaqus(), false);
        sample.assert_same("d.vtu", &sample.vtu(), true);
    }
}
