//! Grids of VTK: what becomes of their arrays and of their cells.

use emmy_io::mesh::{Grid, GridArray, MeshFile, Numbers, from_grid};

use crate::meshes::volume;

/// A block of `n` cubes along each edge, as voxels.
fn block(n: usize) -> Grid {
    let m = n + 1;
    let mut grid = Grid::default();
    for i in 0..m * m * m {
        grid.points.push([i % m, i / m % m, i / m / m].map(|x| x as f64));
    }
    for i in 0..n * n * n {
        let first = i % n + (i / n % n) * m + (i / n / n) * m * m;
        let corners = [0, 1, m, m + 1, m * m, m * m + 1, m * m + m, m * m + m + 1];
        add(&mut grid, 11, &corners.map(|corner| (first + corner) as i64));
    }
    grid
}

fn add(grid: &mut Grid, id: i64, nodes: &[i64]) {
    grid.types.push(id);
    grid.connectivity.extend_from_slice(nodes);
    grid.ends.push(grid.connectivity.len() as i64);
}

/// Adds points for a cell away from the block.
fn add_apart(grid: &mut Grid, id: i64, n: usize) {
    let first = grid.points.len() as i64;
    let angle = |i: usize| i as f64 / n as f64 * std::f64::consts::TAU;
    grid.points.extend((0..n).map(|i| [angle(i).cos() - 9.0, angle(i).sin() - 9.0, 0.0]));
    add(grid, id, &(first..first + n as i64).collect::<Vec<i64>>());
}

fn whole(name: &str, numbers: Vec<i64>) -> GridArray {
    GridArray { name: name.to_string(), numbers: Some(Numbers::Whole(numbers)) }
}

fn real(name: &str, numbers: Vec<f64>) -> GridArray {
    GridArray { name: name.to_string(), numbers: Some(Numbers::Real(numbers)) }
}

fn mesh(grid: Grid) -> MeshFile {
    from_grid("the grid".as_ref(), grid, &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn message(grid: Grid) -> String {
    from_grid("the grid".as_ref(), grid, &[]).unwrap_err().to_string()
}

#[test]
fn whole_numbers_stored_as_reals_give_the_same_groups() {
    let mut grid = block(2);
    grid.cell_arrays = vec![
        whole("a", vec![1, 1, 1, 1, 2, 2, -3, 2]),
        real("b", vec![1.0, 1.0, 1.0, 1.0, 2.0, 2.0, -3.0, 2.0]),
        // NaN stands for no value.
        real("c", [[f64::NAN; 4], [4.0; 4]].concat()),
        real("half", vec![0.5; 8]),
    ];
    let file = mesh(grid);
    let groups = file.mesh.groups();
    for (name, cells) in [("1", vec![0, 1, 2, 3]), ("2", vec![4, 5, 7]), ("-3", vec![6])] {
        for array in ["a", "b"] {
            assert_eq!(groups.cells(&format!("{array}={name}")).unwrap(), cells);
        }
    }
    assert_eq!(groups.cells("c=4").unwrap(), [4, 5, 6, 7]);
    assert_eq!(groups.names().len(), 7);
    let note = "arrays that are left out, because they have other values than up to 64 whole numbers: half";
    assert_eq!(file.notes, [note]);
}

#[test]
fn arrays_on_faces_lines_and_points_give_groups_of_them() {
    let mut grid = block(1);
    add(&mut grid, 8, &[0, 1, 2, 3]); // z = 0
    add(&mut grid, 9, &[4, 5, 7, 6]); // z = 1
    add(&mut grid, 3, &[0, 1]);
    add(&mut grid, 1, &[7]);
    grid.cell_arrays = vec![whole("cell_tags", vec![-6, -7, -8, -9, 0])];
    grid.point_arrays = vec![real("point_tags", vec![0.0, 0.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0])];
    let file = mesh(grid);
    let groups = file.mesh.groups();
    assert_eq!(groups.cells("cell_tags=-6").unwrap(), [0]);
    for (name, z) in [("cell_tags=-7", 0.0), ("cell_tags=-8", 1.0)] {
        assert_eq!(groups.facets(name).unwrap().len(), 1);
        let nodes = file.mesh.group_nodes(name).unwrap();
        assert!(nodes.iter().all(|&node| file.mesh.points()[node as usize][2] == z));
    }
    assert_eq!(groups.nodes["cell_tags=-9"], [0, 1]);
    assert_eq!(groups.nodes["point_tags=2"], [3, 4]);
    // A tag of 0 is none.
    assert_eq!(groups.names().len(), 5);
    assert_eq!(file.notes, ["1 cell that is not solid is in no group and ignored"]);
}

#[test]
fn cells_without_a_solid_behind_them_are_left_out_and_stay_as_nodes_of_their_groups() {
    let mut grid = block(1);
    add(&mut grid, 9, &[0, 1, 3, 2]);
    add_apart(&mut grid, 9, 4);
    add_apart(&mut grid, 5, 3);
    add_apart(&mut grid, 4, 5);
    // A triangle on three corners of the brick, none of its faces, and a line to a point of the triangle.
    add(&mut grid, 5, &[0, 1, 7]);
    add(&mut grid, 3, &[7, 12]);
    grid.cell_arrays = vec![whole("group:skin", vec![0, 1, 1, 0, 0, 1, 0])];
    let file = mesh(grid);
    assert_eq!((file.mesh.n_cells(), volume(&file.mesh)), (1, 1.0));
    assert_eq!(file.mesh.groups().facets("skin").unwrap().len(), 1);
    assert_eq!(file.mesh.groups().nodes["skin"], [0, 1, 7]);
    assert_eq!(
        file.notes,
        [
            "left out, though it may change the motion: 2 VTK type 5 (triangle), 1 VTK type 3 (line), 1 VTK type 4 \
             (polyline), 1 VTK type 9 (quadrilateral)",
            "12 nodes belong to no cell and are left out"
        ]
    );
}

#[test]
fn solid_cells_of_other_kinds_are_named() {
    for (id, n, name) in [
        (42, 4, "cell 8 (counted from 0) is of VTK type 42 (polyhedron of 4 nodes), which is not supported"),
        (72, 64, "VTK type 72 (Lagrange hexahedron of 64 nodes)"),
        (15, 10, "VTK type 15 (pentagonal prism)"),
        (32, 18, "VTK type 32 (biquadratic wedge)"),
    ] {
        let mut grid = block(2);
        add_apart(&mut grid, id, n);
        let message = message(grid);
        assert!(message.starts_with("the grid: ") && message.contains(name), "{message}");
    }
    let mut grid = block(2);
    grid.types[3] = 17;
    assert!(message(grid).contains("cell 3 is of the unknown VTK type 17"));
    let mut points = Grid::default();
    add_apart(&mut points, 1, 1);
    add_apart(&mut points, 1, 1);
    assert!(message(points).contains("no solid or plane cells, only 2 of VTK type 1 (vertex)"));
}

#[test]
fn ghost_and_hidden_cells_are_left_out() {
    let mut grid = block(2);
    // A duplicate cell, a hidden one, and a point of another piece, which is none of a cell.
    grid.cell_arrays = vec![whole("vtkGhostType", vec![0, 1, 32, 0, 0, 0, 0, 2])];
    let file = mesh(grid);
    assert_eq!((file.mesh.n_cells(), volume(&file.mesh)), (6, 6.0));
    // The corners (2, 0, 0) and (0, 2, 0) belong to these cells alone.
    let nodes = "2 nodes belong to no cell and are left out";
    assert_eq!(file.notes, ["2 ghost or hidden cells are left out", nodes]);
}

#[test]
fn lists_that_do_not_fit_are_errors() {
    type Damage = fn(&mut Grid);
    let cases: [(Damage, &str); 5] = [
        (|grid| grid.connectivity[3] = 99, "a cell names node 99, of 8"),
        (|grid| grid.connectivity[3] = -1, "a cell names node -1, of 8"),
        (|grid| grid.ends[0] = 9, "cell 0 of type 11 ends at 9 instead of 8"),
        (|grid| grid.ends.clear(), "0 cells with 1 types"),
        (|grid| grid.cell_arrays.push(whole("a", vec![1, 2])), "array \"a\" has 2 numbers for 1 cells"),
    ];
    for (damage, part) in cases {
        let mut grid = block(1);
        damage(&mut grid);
        let message = message(grid);
        assert!(message.contains(part), "{message}");
    }
}
