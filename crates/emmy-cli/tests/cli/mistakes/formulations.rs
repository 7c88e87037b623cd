//! Formulations of cells that are not there for a kind of cell, a material or a scheme.

use super::{MATERIAL, MESH, Mistake, changed};

/// [`super::BOX`] with further keys of its region.
fn region(name: &str, keys: &str) -> Mistake {
    changed(name, MATERIAL, &format!("{MATERIAL}\n{keys}"))
}

/// The same with one cell of a kind from a file.
fn cell(name: &str, keys: &str, kind: u8, points: &[[u8; 3]]) -> Mistake {
    let number = |(i, point): (usize, &[u8; 3])| {
        let [x, y, z] = point.map(|x| f64::from(x) / 2.0);
        format!("{} {x} {y} {z}\n", i + 1)
    };
    let nodes: String = points.iter().enumerate().map(number).collect();
    let numbers: Vec<String> = (1..=points.len()).map(|node| node.to_string()).collect();
    let mesh = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n{dim} 1 \"body\"\n$EndPhysicalNames\n$Nodes\n{n}\n{nodes}\
         $EndNodes\n$Elements\n1\n1 {kind} 2 1 1 {numbers}\n$EndElements\n",
        dim = if points.iter().any(|point| point[2] > 0) { 3 } else { 2 },
        n = points.len(),
        numbers = numbers.join(" "),
    );
    let nothing_else = &["--set", "load=[]", "--set", "support=[]", "--set", "output.probes=[]"];
    region(name, keys).and(MESH, "file = \"cell.msh\"").beside("cell.msh", mesh).with(nothing_else).unseen()
}

/// Corners and middles of edges in the order of Gmsh, in halves.
const TET10: [[u8; 3]; 10] = [
    [0, 0, 0],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [0, 1, 1],
    [1, 0, 1],
];
const TRI6: [[u8; 3]; 6] = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]];
const HEX20: [[u8; 3]; 20] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [2, 2, 2],
    [0, 2, 2],
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [2, 1, 0],
    [2, 0, 1],
    [1, 2, 0],
    [2, 2, 1],
    [0, 2, 1],
    [1, 0, 2],
    [0, 1, 2],
    [2, 1, 2],
    [1, 2, 2],
];

const PROJECTED: &str = "formulation = 'projected-volume'";
const MODES: &str = "formulation = 'incompatible-modes'";

pub(super) fn all() -> Vec<Mistake> {
    [words(), pairs(), materials_and_schemes()].into_iter().flatten().collect()
}

fn words() -> Vec<Mistake> {
    vec![
        region("formulation-misspelt", "formulation = 'projected_volume'"),
        region("formulation-of-another-program", "formulation = 'F-bar'"),
        region("formulation-by-number", "formulation = 2"),
        changed("formulation-of-the-material", "mu = 500.0", "mu = 500.0, formulation = 'standard'"),
        region("pressure-of-second-order", &format!("{PROJECTED}\npressure = 'quadratic'")),
        region("pressure-without-formulation", "pressure = 'constant'"),
        region("pressure-of-incompatible-modes", &format!("{MODES}\npressure = 'constant'")),
    ]
}

/// Pairs of a displacement and a pressure that lock or have deformations without energy.
fn pairs() -> Vec<Mistake> {
    let linear = format!("{PROJECTED}\npressure = 'linear'");
    vec![
        region("linear-pressure-in-hex8", &linear).unseen(),
        cell("constant-pressure-in-hex20", &format!("{PROJECTED}\npressure = 'constant'"), 17, &HEX20),
        cell("linear-pressure-in-tet10", &linear, 11, &TET10),
        cell("linear-pressure-in-tri6", &linear, 9, &TRI6),
        cell("projected-tet4", PROJECTED, 4, &TET10[..4]),
        cell("projected-tri3", PROJECTED, 2, &TRI6[..3]),
        cell("incompatible-modes-of-tet10", MODES, 11, &TET10),
        cell("incompatible-modes-of-hex20", MODES, 17, &HEX20),
    ]
}

fn materials_and_schemes() -> Vec<Mistake> {
    let projected = |name: &str, material: &str| region(name, PROJECTED).and(MATERIAL, material).unseen();
    vec![
        projected(
            "projected-wood",
            "material.orthotropic = { youngs_modulus_1 = 1e4, youngs_modulus_2 = 800, youngs_modulus_3 = 500, \
             poissons_ratio_12 = 0.37, poissons_ratio_13 = 0.47, poissons_ratio_23 = 0.43, mu_12 = 700, mu_13 = 600, \
             mu_23 = 30, axis_1 = [0, 1, 0], axis_2 = [0, 0, 1] }",
        ),
        projected("projected-cork", "material.neo-hooke = { lambda = 0.0, mu = 500.0 }"),
        region("projected-links", PROJECTED)
            .and(MESH, super::meshes::NETWORK)
            .and(MATERIAL, "material.bar = { youngs_modulus = 1e3, area = 1.0 }")
            .with(&["--set", "region.0.group=links", "--set", "support=[]", "--set", "load=[]"])
            .unseen(),
        region("explicit-incompatible-modes", MODES)
            .and("scheme = \"AS(2)\"\ndegree = 1", "scheme = \"central-differences\"")
            .unseen(),
    ]
}
