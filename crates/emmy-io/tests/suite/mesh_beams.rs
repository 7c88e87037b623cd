//! Lines beside solid cells: edges, and beams, which are left out.

use emmy_io::mesh::{Grid, GridArray, Numbers, from_grid};

use crate::meshes::{links, parse_text, volume};

/// Two bricks side by side along x, with node 1 + i at x = i / 4.
fn gmsh(lines: &str, n_lines: usize) -> String {
    let nodes: String = (0..12).map(|i| format!("{} {} {} {}\n", i + 1, i / 4, i % 2, i / 2 % 2)).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n3 1 \"body\"\n1 2 \"beam\"\n1 3 \"rim\"\n$EndPhysicalNames\n\
         $Nodes\n12\n{nodes}$EndNodes\n$Elements\n{}\n1 5 2 1 1 1 5 6 2 3 7 8 4\n2 5 2 1 1 5 9 10 6 7 11 12 8\n{lines}$EndElements\n",
        2 + n_lines
    )
}

#[test]
fn a_line_of_gmsh_that_is_no_edge_is_left_out_with_a_note() {
    // From corner to corner of the body; along an edge of each brick.
    let text = gmsh("3 1 2 2 1 1 12\n4 1 2 3 1 1 5\n5 1 2 3 1 10 9\n", 3);
    let file = parse_text("a.msh", &text).unwrap();
    let groups = file.mesh.groups();
    assert_eq!((&groups.nodes["beam"][..], &groups.nodes["rim"][..]), (&[0, 11][..], &[0, 4, 8, 9][..]));
    let note = "1 line is no edge of a cell, such as a beam, and left out; their nodes stay in the groups of nodes \"beam\"";
    assert_eq!(file.notes, [note]);
    // As a link it is a cell.
    let file = emmy_io::mesh::parse_with("a.msh".as_ref(), text.as_bytes(), &links("beam")).unwrap();
    assert_eq!((file.mesh.n_cells(), file.notes), (3, Vec::new()));
}

#[test]
fn a_line_of_vtk_that_is_no_edge_is_left_out_with_a_note() {
    let bricks = [[0, 4, 5, 1, 2, 6, 7, 3], [4, 8, 9, 5, 6, 10, 11, 7]];
    // VTK types: line, polyline, quadratic line; an edge each, then with a diagonal.
    let edges: [(i64, &[i64]); 3] = [(3, &[0, 4]), (4, &[0, 4, 8, 9]), (21, &[0, 4, 2])];
    let beams: [(i64, &[i64]); 3] = [(3, &[0, 11]), (4, &[0, 4, 9]), (21, &[4, 9, 2])];
    let mut grid = Grid {
        points: (0..12).map(|i| [i / 4, i % 2, i / 2 % 2].map(f64::from)).collect(),
        types: vec![12, 12],
        ends: vec![8, 16],
        connectivity: bricks.concat(),
        ..Grid::default()
    };
    for (id, nodes) in edges.into_iter().chain(beams) {
        grid.types.push(id);
        grid.connectivity.extend(nodes);
        grid.ends.push(grid.connectivity.len() as i64);
    }
    let group = |name: &str, numbers: [i64; 8]| GridArray {
        name: format!("group:{name}"),
        numbers: Some(Numbers::Whole(numbers.to_vec())),
    };
    grid.cell_arrays = vec![group("rim", [0, 0, 1, 1, 1, 0, 0, 0]), group("beam", [0, 0, 0, 0, 0, 1, 1, 1])];
    let file = from_grid("the grid".as_ref(), grid, &[]).unwrap();
    let groups = file.mesh.groups();
    assert_eq!((file.mesh.n_cells(), volume(&file.mesh)), (2, 2.0));
    assert_eq!(groups.nodes["rim"], [0, 2, 4, 8, 9]);
    assert_eq!(groups.nodes["beam"], [0, 2, 4, 9, 11]);
    assert_eq!(
        file.notes,
        [
            "left out, though it may change the motion: 1 VTK type 21 (quadratic line), 1 VTK type 3 (line), 1 VTK type 4 (polyline)"
        ]
    );
}
