//! Cells of known quality.

use super::*;
use crate::element::element;
use crate::mesh::{CellKind, MeshBuilder, block};

fn mesh_of(kind: CellKind, points: &[[f64; 3]]) -> Mesh {
    let mut builder = MeshBuilder::new();
    let nodes: Vec<u32> = points.iter().map(|&point| builder.point(point)).collect();
    builder.cell(kind, &nodes).unwrap();
    builder.build().unwrap()
}

/// Nodes of the unit cube.
fn unit_cube(kind: CellKind) -> Vec<[f64; 3]> {
    element(kind).nodes().iter().map(|xi| xi.map(|x| 0.5 * (x + 1.0))).collect()
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-14, "{a} is not {b}");
}

#[test]
fn a_block_of_equal_bricks_is_perfect_but_for_its_aspect() {
    let mesh = block([2.0, 2.0, 4.0], [2, 2, 2]).unwrap();
    let quality = quality(&mesh);
    near(quality.volume, 16.0);
    near(quality.jacobian_ratio.value, 1.0);
    near(quality.scaled_jacobian.value, 1.0);
    assert_eq!((quality.aspect_ratio, quality.inverted), (Worst { value: 2.0, cell: 0 }, vec![]));
    assert_eq!(check(&mesh), Ok(()));
}

/// Volume, scaled Jacobian and aspect ratio of the reference cell itself.
fn reference(kind: CellKind) -> [f64; 3] {
    match kind.linear() {
        CellKind::Tet4 => [1.0 / 6.0, 0.5f64.sqrt(), 2f64.sqrt()],
        // Corner (1, 0): edges of lengths 1 and sqrt 2 span 1.
        CellKind::Tri3 => [0.5, 0.5f64.sqrt() * 2.0 / 3f64.sqrt(), 2f64.sqrt()],
        CellKind::Quad4 => [4.0, 1.0, 1.0],
        CellKind::Line2 => [2.0, 1.0, 1.0],
        // Corner (1, 0): edges of lengths 1, sqrt 2 and 2 span a prism of volume 2.
        CellKind::Wedge6 => [1.0, 0.5f64.sqrt() * 2.0 / 3f64.sqrt(), 2.0],
        // Corner of the base: edges of lengths 2, 2 and sqrt 3 span 4.
        CellKind::Pyramid5 => [4.0 / 3.0, (2.0f64 / 3.0).sqrt(), 2.0 / 3f64.sqrt()],
        _ => [8.0, 1.0, 1.0],
    }
}

#[test]
fn undistorted_kinds_have_the_numbers_of_their_reference_cells() {
    for kind in CellKind::ALL {
        let quality = quality(&mesh_of(kind, element(kind).nodes()));
        let [volume, scaled_jacobian, aspect_ratio] = reference(kind);
        near(quality.volume, volume);
        near(quality.jacobian_ratio.value, 1.0);
        near(quality.scaled_jacobian.value, scaled_jacobian);
        near(quality.aspect_ratio.value, aspect_ratio);
    }
}

#[test]
fn wedges_and_pyramids_with_edges_of_one_length_are_perfect() {
    let wedge = element(CellKind::Wedge6).nodes();
    let wedge: Vec<_> = wedge.iter().map(|&[x, y, z]| [x + 0.5 * y, 0.75f64.sqrt() * y, 0.5 * z]).collect();
    let pyramid = element(CellKind::Pyramid5).nodes();
    let pyramid: Vec<_> = pyramid.iter().map(|&[x, y, z]| [x, y, 2f64.sqrt() * z]).collect();
    for (kind, points) in [(CellKind::Wedge6, wedge), (CellKind::Pyramid5, pyramid)] {
        let quality = quality(&mesh_of(kind, &points));
        near(quality.scaled_jacobian.value, 1.0);
        near(quality.aspect_ratio.value, 1.0);
    }
}

#[test]
fn a_steep_pyramid_is_bad_at_its_apex_and_a_flat_one_at_its_base() {
    // Height h over the base [-1, 1]^2: edges sqrt(2 + h^2); three span 4 h at the apex, 4 h at the base.
    let with_height = |h: f64| {
        let mut points = element(CellKind::Pyramid5).nodes().to_vec();
        points[4][2] = h;
        quality(&mesh_of(CellKind::Pyramid5, &points)).scaled_jacobian.value
    };
    near(with_height(10.0), 2f64.sqrt() * 40.0 / 102f64.powf(1.5));
    near(with_height(0.1), 2f64.sqrt() * 0.1 / 2.01f64.sqrt());
}

#[test]
fn a_pyramid_folded_over_its_base_is_inverted() {
    // The apex below the base: det(dX/dxi) is minus its height everywhere.
    let mut points = element(CellKind::Pyramid5).nodes().to_vec();
    points[4][2] = -0.25;
    let mesh = mesh_of(CellKind::Pyramid5, &points);
    assert_eq!(check(&mesh), Err(Error::InvertedCell { cell: 0, kind: CellKind::Pyramid5, det: -0.25 }));
    // A corner of the base drawn beyond the diagonal between its neighbours.
    let mut points = element(CellKind::Pyramid5).nodes().to_vec();
    points[0] = [0.2, 0.2, 0.0];
    let folded = quality(&mesh_of(CellKind::Pyramid5, &points));
    assert!(folded.jacobian_ratio.value < 0.0 && folded.scaled_jacobian.value < 0.0);
}

#[test]
fn a_wedge_with_its_ends_exchanged_is_inverted() {
    let nodes = element(CellKind::Wedge15).nodes();
    let mirrored: Vec<_> = nodes.iter().map(|&[x, y, z]| [x, y, -z]).collect();
    assert!(matches!(
        check(&mesh_of(CellKind::Wedge15, &mirrored)),
        Err(Error::InvertedCell { cell: 0, .. })
    ));
}

#[test]
fn a_corner_pushed_in_gives_the_numbers_worked_out_by_hand() {
    // X = u - 0.2 u v w (1, 1, 1), so det = 1 - 0.2 (v w + u w + u v): 0.4 at the corner, 0.85 on average.
    let mut points = unit_cube(CellKind::Hex8);
    points[6] = [0.8; 3];
    let quality = quality(&mesh_of(CellKind::Hex8, &points));
    near(quality.volume, 0.85);
    near(quality.jacobian_ratio.value, 0.4 / 0.85);
    near(quality.scaled_jacobian.value, 0.4 / 0.72f64.powf(1.5));
    near(quality.aspect_ratio.value, 1.0 / 0.72f64.sqrt());
}

#[test]
fn a_curved_edge_gives_the_numbers_worked_out_by_hand() {
    // X = xi + d N_4 with d = (0, 0, -0.1) and N_4 = 4 b_0 xi_1, so det = 1 + 0.4 xi_1.
    let mut points = element(CellKind::Tet10).nodes().to_vec();
    points[4][2] = -0.1;
    let quality = quality(&mesh_of(CellKind::Tet10, &points));
    near(quality.volume, 1.0 / 6.0 + 0.4 / 24.0);
    near(quality.jacobian_ratio.value, 1.0 / 1.1);
    near(quality.scaled_jacobian.value, 0.5f64.sqrt());
}

#[test]
fn the_regular_tetrahedron_is_perfect_and_a_flat_one_is_not() {
    let regular = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]];
    let best = quality(&mesh_of(CellKind::Tet4, &regular));
    near(best.scaled_jacobian.value, 1.0);
    near(best.aspect_ratio.value, 1.0);
    // Four corners of a square, two of them lifted by 1/100: all edges alike, but hardly any volume.
    let flat = [[0.0; 3], [1.0, 0.0, 0.01], [1.0, 1.0, 0.0], [0.0, 1.0, 0.01]];
    let sliver = quality(&mesh_of(CellKind::Tet4, &flat));
    assert!(sliver.scaled_jacobian.value.abs() < 0.03 && sliver.aspect_ratio.value < 1.5);
}

#[test]
fn an_inverted_cell_is_named() {
    let mut builder = MeshBuilder::new();
    for point in element(CellKind::Tet4).nodes() {
        builder.point(*point);
    }
    builder.cell(CellKind::Tet4, &[0, 1, 2, 3]).unwrap();
    builder.cell(CellKind::Tet4, &[0, 2, 1, 3]).unwrap();
    let mesh = builder.build().unwrap();
    let expected = Error::InvertedCell { cell: 1, kind: CellKind::Tet4, det: -1.0 };
    assert_eq!(check(&mesh).unwrap_err(), expected);
    let quality = quality(&mesh);
    assert_eq!((quality.inverted, quality.jacobian_ratio), (vec![1], Worst { value: -1.0, cell: 1 }));
    assert_eq!(quality.volume, 0.0);
}

#[test]
fn a_cell_without_volume_is_rejected() {
    let mut points = unit_cube(CellKind::Hex8);
    points.iter_mut().for_each(|point| point[2] = 0.0);
    let mesh = mesh_of(CellKind::Hex8, &points);
    assert!(matches!(check(&mesh), Err(Error::InvertedCell { det: 0.0, .. })));
    assert_eq!(quality(&mesh).inverted, [0]);
}

#[test]
fn a_wedge_made_of_a_hexahedron_is_allowed_but_bad() {
    let mut points = unit_cube(CellKind::Hex8);
    (points[3], points[7]) = (points[2], points[6]);
    let mesh = mesh_of(CellKind::Hex8, &points);
    let quality = quality(&mesh);
    assert_eq!(check(&mesh), Ok(()));
    near(quality.volume, 0.5);
    assert_eq!((quality.jacobian_ratio.value, quality.scaled_jacobian.value), (0.0, 0.0));
    assert_eq!(quality.aspect_ratio.value, f64::INFINITY);
}

#[test]
fn a_corner_folded_inside_out_shows_at_the_node_before_it_does_inside() {
    // det = 1 - 0.5 (v w + u w + u v): -0.5 at the corner, but positive at all Gauss points (0.07 at the nearest).
    let mut points = unit_cube(CellKind::Hex8);
    points[6] = [0.5; 3];
    let mesh = mesh_of(CellKind::Hex8, &points);
    assert_eq!(check(&mesh), Ok(()));
    near(quality(&mesh).jacobian_ratio.value, -0.5 / 0.625);
}

#[test]
fn volumes_too_large_for_a_number_are_told_from_inverted_cells() {
    let length = |x: f64| block([x; 3], [1; 3]).map(|mesh| check(&mesh));
    assert_eq!(length(1e100).unwrap(), Ok(()));
    // (1e160)^3 is beyond the largest double, 1.8e308.
    assert!(matches!(length(1e160).unwrap(), Err(Error::NotFinite { .. })));
}
