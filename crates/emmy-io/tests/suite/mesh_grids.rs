//! Grids of VTK: what becomes of their arrays and of their cells.

use std::collections::BTreeSet;

use emmy_io::mesh::{Grid, GridArray, MeshFile, Numbers, from_grid};
use proptest::prelude::*;

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

/// An array of a random kind on a number of cells or points, and what it must give.
fn array(n: usize) -> impl Strategy<Value = (Vec<f64>, u8)> {
    let few = prop::collection::vec((-9..9_i32).prop_map(f64::from), n);
    let many = Just((0..n).map(|i| (i / 2) as f64).collect::<Vec<f64>>());
    let halves = prop::collection::vec((0..9_i32).prop_map(|i| f64::from(i) + 0.5), n);
    let numbering = Just((0..n).map(|i| i as f64).collect::<Vec<f64>>());
    prop_oneof![
        few.clone().prop_map(|numbers| (numbers, 0)),
        few.prop_map(|numbers| (numbers, 1)),
        many.prop_map(|numbers| (numbers, 2)),
        halves.prop_map(|numbers| (numbers, 3)),
        numbering.prop_map(|numbers| (numbers, 4)),
        Just((Vec::new(), 5)),
        Just((vec![0.5; n], 6)),
    ]
}

/// Names in the note on arrays.
fn left_out(file: &MeshFile) -> BTreeSet<String> {
    let note = file.notes.iter().find_map(|note| note.strip_prefix("arrays that are left out, "));
    let names = note.and_then(|note| note.split_once(": ")).map_or("", |(_, names)| names);
    names.split(", ").filter(|name| !name.is_empty()).map(str::to_string).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..Default::default() })]

    /// Every array gives its groups, or is in the note, or is known to have no effect; every cell is one of the body, or
    /// counted in a note. The body stays the same.
    #[test]
    fn every_array_and_cell_is_accounted_for(
        on_cells in prop::collection::vec(array(6 * 6 * 6 + 3), 0..5),
        on_points in prop::collection::vec(array(7 * 7 * 7), 0..5),
        n_apart in prop::collection::vec(0..4_usize, 3),
    ) {
        let mut grid = block(6);
        add(&mut grid, 8, &[0, 1, 7, 8]);
        add(&mut grid, 3, &[0, 1]);
        add(&mut grid, 1, &[0]);
        let (n_cells, n_points) = (grid.types.len(), grid.points.len());
        for (&n, (id, n_nodes)) in n_apart.iter().zip([(9, 4), (4, 5), (7, 6)]) {
            (0..n).for_each(|_| add_apart(&mut grid, id, n_nodes));
        }
        let (n_more_cells, n_more_points) = (grid.types.len() - n_cells, grid.points.len() - n_points);
        let (mut wanted_groups, mut wanted_note) = (BTreeSet::new(), BTreeSet::new());
        let parts = [(&on_cells, "c", n_more_cells), (&on_points, "p", n_more_points)];
        for (arrays, prefix, n_more) in parts {
            let mut all = Vec::new();
            for (index, (numbers, kind)) in arrays.iter().enumerate() {
                let name = if *kind == 6 { format!("vtk{prefix}{index}") } else { format!("{prefix}{index}") };
                // The cells and points apart have no value.
                let with_rest = [numbers.clone(), vec![f64::NAN; n_more]].concat();
                let array = match kind {
                    0 if n_more == 0 => whole(&name, numbers.iter().map(|&x| x as i64).collect()),
                    5 => GridArray { name: name.clone(), numbers: None },
                    _ => real(&name, with_rest),
                };
                all.push(array);
                match kind {
                    0 | 1 => wanted_groups.extend(numbers.iter().map(|x| format!("{name}={x}"))),
                    2 | 3 | 5 if prefix == "c" => drop(wanted_note.insert(name.clone())),
                    2 | 3 | 5 => drop(wanted_note.insert(format!("{name} (points)"))),
                    _ => {}
                }
                // The values of the few other cells are in range in any case.
                if *kind == 2 || *kind == 4 {
                    wanted_groups.extend(numbers.iter().skip(216).map(|x| format!("{name}={x}")).filter(|_| prefix == "c"));
                }
            }
            if prefix == "c" { grid.cell_arrays = all } else { grid.point_arrays = all }
        }
        let file = mesh(grid);
        let found: BTreeSet<String> = file.mesh.groups().names().iter().map(|name| name.to_string()).collect();
        prop_assert_eq!(found, wanted_groups);
        prop_assert_eq!(left_out(&file), wanted_note);
        prop_assert_eq!((file.mesh.n_cells(), file.mesh.n_nodes()), (216, 343));
        prop_assert!((volume(&file.mesh) - 216.0).abs() < 1e-10);
        let note = file.notes.iter().find(|note| note.starts_with("left out, though")).cloned().unwrap_or_default();
        for (n, name) in n_apart.iter().zip(["9 (quadrilateral)", "4 (polyline)", "7 (polygon)"]) {
            let part = format!("{n} VTK type {name}");
            prop_assert_eq!(note.contains(&part), *n > 0, "{} in {}", part, note);
        }
    }
}
