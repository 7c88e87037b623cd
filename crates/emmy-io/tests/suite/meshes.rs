//! Functions shared by the tests of the mesh readers.

use std::fs;
use std::path::PathBuf;

use emmy::mesh::{Cell, Mesh};
use emmy_io::mesh::{MeshError, MeshFile, MeshOptions, parse};

pub(crate) fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name)
}

pub(crate) fn bytes(name: &str) -> Vec<u8> {
    fs::read(path(name)).unwrap()
}

pub(crate) fn read(name: &str) -> MeshFile {
    emmy_io::mesh::read(&path(name)).unwrap_or_else(|error| panic!("{error}"))
}

/// Lines of a group as cells.
pub(crate) fn links(group: &str) -> MeshOptions {
    MeshOptions { links: vec![group.to_string()], ..MeshOptions::default() }
}

pub(crate) fn parse_text(name: &str, text: &str) -> Result<MeshFile, MeshError> {
    parse(name.as_ref(), text.as_bytes())
}

/// Volume by the divergence theorem, a third of the flux of X; exact for cells with plane faces.
pub(crate) fn volume(mesh: &Mesh) -> f64 {
    mesh.cells().map(|cell| cell_volume(mesh, cell)).sum()
}

pub(crate) fn cell_volume(mesh: &Mesh, cell: Cell) -> f64 {
    let point = |local: usize| mesh.points()[cell.nodes[local] as usize];
    let mut volume = 0.0;
    for facet in cell.kind.facets() {
        let corners: Vec<[f64; 3]> =
            facet.nodes[..facet.kind.n_corners()].iter().map(|&n| point(n)).collect();
        let centre = mean(&corners);
        for i in 0..corners.len() {
            volume += determinant(centre, corners[i], corners[(i + 1) % corners.len()]) / 6.0;
        }
    }
    volume
}

pub(crate) fn mean(points: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|i| points.iter().map(|point| point[i]).sum::<f64>() / points.len() as f64)
}

fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

pub(crate) fn close(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12)
}

/// Checks that the nodes of a group lie in a plane `X[axis] = value`.
pub(crate) fn assert_plane(mesh: &Mesh, group: &str, axis: usize, value: f64) {
    for node in mesh.group_nodes(group).unwrap() {
        let point = mesh.points()[node as usize];
        assert!((point[axis] - value).abs() < 1e-12, "{group}: node {node} at {point:?}");
    }
}

/// Checks that every node beyond the corners is in the middle of the corners of its edge, face or cell: a wrong order
/// would displace one.
pub(crate) fn assert_straight(mesh: &Mesh) {
    for cell in mesh.cells() {
        assert!(cell_volume(mesh, cell) > 0.0);
        let point = |local: usize| mesh.points()[cell.nodes[local] as usize];
        for facet in cell.kind.facets() {
            let n = facet.kind.n_corners();
            let corners: Vec<[f64; 3]> = facet.nodes[..n].iter().map(|&local| point(local)).collect();
            for (i, &local) in facet.nodes[n..].iter().enumerate() {
                let middle = if i < n { mean(&[corners[i], corners[(i + 1) % n]]) } else { mean(&corners) };
                assert!(close(point(local), middle), "{} node {local}", cell.kind);
            }
        }
        if cell.nodes.len() == 27 {
            assert!(close(point(26), mean(&(0..8).map(point).collect::<Vec<_>>())));
        }
    }
}
