//! Built-in round shapes and parts of a mesh in inputs: masses, centres, groups, entries of decks, motion.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use emmy::body::RegionSummary;
use emmy_io::input::{self, Overrides, Problem};
use emmy_io::mesh;

const REST: &str = "[time]\nscheme = 'DGM'\ndegree = 1\nsteps = [{ until = 1.0, size = 0.02 }]\n";

fn try_read(directory: &Path, text: &str) -> Result<Problem, String> {
    let file = directory.join("input.toml");
    std::fs::write(&file, text).unwrap();
    input::read(&file, &Overrides::default()).map_err(|error| error.to_string())
}

fn problem(text: &str) -> Problem {
    let temp = tempfile::tempdir().unwrap();
    try_read(temp.path(), text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// One region of a density for each of some groups.
fn regions(groups: &[(&str, f64)]) -> String {
    let region = |(group, density): &(&str, f64)| {
        format!(
            "[[region]]\ngroup = '{group}'\ndensity = {density:?}\nmaterial.neo-hooke = {{ lambda = 1000, mu = 500 }}\n"
        )
    };
    groups.iter().map(region).collect()
}

fn summary(mesh: &str) -> RegionSummary {
    let problem = problem(&format!("[mesh]\n{mesh}\n{}{REST}", regions(&[("body", 2.0)])));
    problem.body.regions()[0].clone()
}

/// Volume, mass and centre, and the second moment of the mass about the z axis, of n cells against the exact body: the
/// error falls with the square of the size of a cell.
fn assert_second_order(shape: impl Fn(usize) -> String, volume: f64, centre: [f64; 3], about_z: f64) {
    let errors = [1, 2, 4].map(|n| {
        let problem = problem(&format!("[mesh]\n{}\n{}{REST}", shape(n), regions(&[("body", 2.0)])));
        let own = &problem.body.regions()[0];
        assert!((own.mass / own.volume - 2.0).abs() < 1e-13);
        let off = (0..3).map(|i| (own.centre[i] - centre[i]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-13, "{:?}", own.centre);
        let inertia = inertia(&problem, 0)[2][2];
        [1.0 - own.volume / volume, 1.0 - inertia / (2.0 * about_z)]
    });
    for i in [0, 1] {
        for pair in errors.windows(2) {
            let order = (pair[0][i] / pair[1][i]).log2();
            assert!(pair[1][i] > 0.0 && (order - 2.0).abs() < 0.1, "{order} {errors:?}");
        }
    }
}

/// Inertia tensor of a region about the origin, by quadrature of the mesh: the points of 3 Gauss points along each axis
/// integrate the squares of the positions of hex8 cells exactly up to the fourth power.
fn inertia(problem: &Problem, region: usize) -> [[f64; 3]; 3] {
    let mesh = problem.body.mesh();
    let group = mesh.groups().cells.values().nth(region).unwrap().clone();
    let [points, weights] = [[-(0.6f64.sqrt()), 0.0, 0.6f64.sqrt()], [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0]];
    let mut second = [[0.0; 3]; 3];
    for cell in group {
        let x: Vec<[f64; 3]> =
            mesh.cell(cell as usize).nodes.iter().map(|&node| mesh.points()[node as usize]).collect();
        for (a, b, c) in (0..27).map(|i| (i / 9, i / 3 % 3, i % 3)) {
            let xi = [points[a], points[b], points[c]];
            let (place, det) = at(&x, xi);
            let weight = 2.0 * weights[a] * weights[b] * weights[c] * det;
            (0..9).for_each(|i| second[i / 3][i % 3] += weight * place[i / 3] * place[i % 3]);
        }
    }
    let trace = second[0][0] + second[1][1] + second[2][2];
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { trace - second[i][i] } else { -second[i][j] }))
}

/// Position and determinant of the map of a hex8 cell.
fn at(x: &[[f64; 3]], xi: [f64; 3]) -> ([f64; 3], f64) {
    let corners = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]];
    let corner = |i: usize| {
        let [a, b, _] = corners[i % 4];
        [a, b, if i < 4 { -1 } else { 1 }].map(f64::from)
    };
    let (mut place, mut jacobian) = ([0.0; 3], [[0.0; 3]; 3]);
    for (i, x) in x.iter().enumerate() {
        let factor = [0, 1, 2].map(|j| 0.5 * (1.0 + corner(i)[j] * xi[j]));
        for j in 0..3 {
            place[j] += factor[0] * factor[1] * factor[2] * x[j];
            for k in 0..3 {
                let others: f64 = (0..3).filter(|other| *other != k).map(|other| factor[other]).product();
                jacobian[j][k] += 0.5 * corner(i)[k] * others * x[j];
            }
        }
    }
    let [a, b, c] = jacobian;
    let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
    (place, a[0] * minor(1, 2) - a[1] * minor(0, 2) + a[2] * minor(0, 1))
}

#[test]
fn round_bodies_have_the_mass_and_inertia_of_the_exact_ones() {
    let (inner, outer, height) = (0.5f64, 2.0f64, 3.0);
    let area = PI * (outer.powi(2) - inner.powi(2));
    assert_second_order(
        |n| format!("ring = {{ inner = 0.5, outer = 2, height = 3, cells = [2, {}, 1] }}", 12 * n),
        area * height,
        [0.0, 0.0, 1.5],
        area * height * (inner.powi(2) + outer.powi(2)) / 2.0,
    );
    assert_second_order(
        |n| format!("cylinder = {{ radius = 2, height = 3, cells = [{}, 1] }}", 4 * n),
        PI * 4.0 * height,
        [0.0, 0.0, 1.5],
        PI * 4.0 * height * 4.0 / 2.0,
    );
    let ball = 4.0 / 3.0 * PI * 8.0;
    assert_second_order(
        |n| format!("ball = {{ radius = 2, cells = {} }}", 4 * n),
        ball,
        [0.0; 3],
        ball * 4.0 * 0.4,
    );
}

#[test]
fn parts_have_their_masses_at_their_places() {
    let input = format!(
        "[mesh]\nparts = [\n\
         {{ name = 'left', box = {{ size = [1, 2, 3], cells = [1, 2, 3] }}, scale = 2, turn = {{ axis = [0, 0, 5], \
         angle = {FRAC_PI_2:?}, about = [1, 2, 0] }}, at = [10, 0, 0.5] }},\n\
         {{ name = 'right', ball = {{ radius = 1, cells = 2 }}, at = [0, 5, 0] }},\n]\nscale = 0.5\n{}{REST}",
        regions(&[("left", 2.0), ("right", 3.0)])
    );
    let problem = problem(&input);
    let [left, right] = [0, 1].map(|i| &problem.body.regions()[i]);
    // The box of 2, 4 and 6 with the centre (1, 2, 3), turned about its middle line, shifted; then all halved.
    assert!((left.volume - 6.0).abs() < 1e-14 && (left.mass - 12.0).abs() < 1e-14);
    let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-14);
    assert!(close(left.centre, [5.5, 1.0, 1.75]), "{:?}", left.centre);
    assert!(close(right.centre, [0.0, 2.5, 0.0]), "{:?}", right.centre);
    let bare = summary("ball = { radius = 0.5, cells = 2 }");
    assert!((right.mass / bare.mass - 1.5).abs() < 1e-14, "{} {}", right.mass, bare.mass);
    // Turned by a quarter, the edge along x has the length of that along y.
    let mesh = problem.body.mesh();
    let nodes = mesh.volume_nodes("left").unwrap();
    let x = nodes.iter().map(|&node| mesh.points()[node as usize][0]);
    assert!((x.clone().fold(f64::MIN, f64::max) - x.fold(f64::MAX, f64::min) - 2.0).abs() < 1e-14);
    let names = mesh.groups().names();
    assert_eq!(names[..3], ["left", "left-x-max", "left-x-min"]);
    assert_eq!(names[7..], ["right", "right-surface"]);
    assert!(
        problem.notes.iter().all(|note| note.starts_with("nothing moves this body")),
        "{:?}",
        problem.notes
    );
    // The faces turn with the part: `x-max` looks along y.
    let face = mesh.group_nodes("left-x-max").unwrap();
    assert!(face.iter().all(|&node| (mesh.points()[node as usize][1] - 1.5).abs() < 1e-14));
}

/// Components of the inertia of a box about its centre, turned by an angle about the z axis.
#[test]
fn inertia_turns_with_a_part() {
    let angle = 0.3f64;
    let input = format!(
        "[mesh]\nparts = [{{ name = 'a', box = {{ size = [1, 2, 3], cells = [1, 1, 1] }}, turn = {{ axis = [0, 0, 1], \
         angle = {angle:?}, about = [0.5, 1, 1.5] }}, at = [-0.5, -1, -1.5] }}]\n{}{REST}",
        regions(&[("a", 2.0)])
    );
    let own = inertia(&problem(&input), 0);
    let [x, y, z] = [4.0 + 9.0, 1.0 + 9.0, 1.0 + 4.0].map(|squares: f64| 12.0 * squares / 12.0);
    let (s, c) = angle.sin_cos();
    let expected =
        [[c * c * x + s * s * y, c * s * (x - y), 0.0], [c * s * (x - y), s * s * x + c * c * y, 0.0]];
    for i in 0..2 {
        (0..3).for_each(|j| assert!((own[i][j] - expected[i][j]).abs() < 1e-13, "{own:?} {expected:?}"));
    }
    assert!((own[2][2] - z).abs() < 1e-13);
}

/// Two parts that share a face after `merge` fly as one body, and two others beside them: momenta and energy stay.
#[test]
fn parts_fly() {
    let cube = "box = { size = [1, 1, 1], cells = [1, 1, 1] }";
    for (merge, n_bodies) in [("", 3), ("merge = 1e-9", 2)] {
        let input = format!(
            "[mesh]\nparts = [{{ name = 'a', {cube} }}, {{ name = 'b', {cube}, at = [1, 0, 0] }}, \
             {{ name = 'c', cylinder = {{ radius = 0.5, height = 1, cells = [2, 1] }}, turn = {{ axis = [1, 1, 0], \
             angle = 1 }}, at = [0, 0, 3] }}]\n{merge}\n{}{REST}[[initial]]\nvelocity = [1, 2, 3]\n\
             angular_velocity = [0.5, 1, 2]\n\
             gradient = [[3, 0, 0], [0, -3, 0], [0, 0, 0]]\n[[initial]]\ngroup = 'c'\nvelocity = [0, 0, 5]\n",
            regions(&[("a", 2.0), ("b", 1.0), ("c", 3.0)])
        );
        let problem = problem(&input);
        assert_eq!(problem.body.mesh().parts().len(), n_bodies);
        let is_note = |note: &String| note.starts_with("4 nodes lie where another one does");
        assert_eq!(problem.notes.iter().any(is_note), merge.is_empty(), "{:?}", problem.notes);
        let mut motion = problem.motion(&mut []).unwrap();
        let first = motion.record().clone();
        motion.march(&problem.plan, &mut []).unwrap();
        let last = motion.record();
        // Tolerances of the residuals of 50 steps.
        for i in 0..3 {
            assert!((last.linear_momentum[i] - first.linear_momentum[i]).abs() < 1e-11, "{last:?}");
            assert!((last.angular_momentum[i] - first.angular_momentum[i]).abs() < 1e-10, "{last:?}");
        }
        assert!((last.total_energy / first.total_energy - 1.0).abs() < 1e-10, "{last:?}");
        assert!(last.strain_energy > 1e-2 * last.total_energy, "{last:?}");
    }
}

/// A rigid element, its mass and a spring between two points, in two parts: names, places and directions.
#[test]
fn entries_of_a_deck_move_with_their_part() {
    let temp = tempfile::tempdir().unwrap();
    let deck = format!(
        "{}RBE2,901,90,123456,9,10,11,12\nGRID,90,,3.,.5,.5\nCONM2,902,90,,2.\n,.1,,.2,,,.3\nENDDATA\n",
        crate::mesh_nastran_beside::BLOCK
    );
    std::fs::write(temp.path().join("a.bdf"), deck).unwrap();
    let input = |mesh: &str, region: &str| {
        format!(
            "[mesh]\n{mesh}\n{}{REST}",
            regions(&[(&format!("{region}pid_1"), 2.0), (&format!("{region}pid_2"), 2.0)])
        )
    };
    let part = format!(
        "{{ name = 'p', file = 'a.bdf', scale = 0.5, turn = {{ axis = [0, 0, 1], angle = {FRAC_PI_2:?} }}, at = [0, 0, 7] }}"
    );
    let problem = try_read(temp.path(), &input(&format!("parts = [{part}]"), "p-")).unwrap();
    let body = &problem.rigid[0];
    assert_eq!((body.name.as_str(), body.group.as_deref()), ("p-rbe2_901", Some("p-rbe2_901-nodes")));
    let mass = problem.rigid.iter().map(|own| own.mass).sum::<f64>();
    assert_eq!(mass, 2.0);
    let notes = problem.notes.join("\n");
    assert!(notes.contains("p-rbe2_901 (mesh.leave_out switches it off)"), "{notes}");
    assert!(notes.contains("1 node lies where another one does, the first at [-0.5, 0.5, 7.5]"), "{notes}");
    // Its name is that of the part, and `leave_out` knows it.
    let off = input(&format!("parts = [{part}]\nleave_out = ['p-rbe2_901', 'p-conm2_902']"), "p-");
    let without = try_read(temp.path(), &off).unwrap();
    assert!(without.rigid.is_empty(), "{:?}", without.notes);
    // The resolved input is the same problem, without the reader.
    let again = try_read(temp.path(), &problem.resolved).unwrap();
    assert_eq!(format!("{:?}", again.rigid), format!("{:?}", problem.rigid));
    assert_eq!(again.resolved, problem.resolved);
    assert!(problem.resolved.contains("leave_out = [\"p-rbe2_901\""), "{}", problem.resolved);
    let absolute = temp.path().join("a.bdf");
    assert!(problem.resolved.contains(&format!("file = {:?}", absolute.display().to_string())));
}

#[test]
fn entries_are_placed_and_renamed() {
    let file = crate::mesh_nastran_beside::read("RBE2,901,90,123456,9,10,11,12\nGRID,90,,3.,.5,.5\n");
    let turn = emmy::mesh::Placement::default().turned([0.0, 0.0, 1.0], FRAC_PI_2, [0.0; 3]).unwrap();
    let group = file.entries[0].table["group"].as_str().unwrap().to_string();
    let joined =
        mesh::joined(vec![("p".into(), file.placed(&turn.shifted([1.0, 0.0, 0.0])).unwrap())]).unwrap();
    let own = &joined.entries[0];
    assert_eq!((own.name.as_str(), own.card().as_str()), ("p-rbe2_901", "RBE2 901 of part p"));
    assert_eq!(own.table["name"].as_str(), Some("p-rbe2_901"));
    assert_eq!(own.table["group"].as_str(), Some(format!("p-{group}").as_str()));
    assert_eq!(own.table["point"].to_string(), "[0.5, 3.0, 0.5]");
}

/// Lines of a file in a part are links if a region names their group.
#[test]
fn links_of_a_part_are_named_with_it() {
    let temp = tempfile::tempdir().unwrap();
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 2 \"spring\"\n3 1 \"tet\"\n$EndPhysicalNames\n\
        $Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 3\n$EndNodes\n\
        $Elements\n2\n1 4 2 1 1 1 2 3 4\n2 1 2 2 1 4 5\n$EndElements\n";
    std::fs::write(temp.path().join("a.msh"), mesh).unwrap();
    let input = format!(
        "[mesh]\nparts = [{{ name = 'p', file = 'a.msh' }}]\n{}[[region]]\ngroup = 'p-spring'\ndensity = 1\n\
         material.bar = {{ area = 1, youngs_modulus = 1 }}\n{REST}",
        regions(&[("p-tet", 2.0)])
    );
    let problem = try_read(temp.path(), &input).unwrap();
    assert_eq!(problem.body.mesh().groups().cells("p-spring").unwrap().len(), 1);
    assert_eq!(problem.body.regions()[1].volume, 2.0);
}

/// Parts in plane strain are turned and shifted in their plane.
#[test]
fn plane_parts_stay_in_their_plane() {
    let plane = "rectangle = { size = [2, 1], cells = [2, 1] }";
    let input = format!(
        "[mesh]\nparts = [{{ name = 'a', {plane}, turn = {{ axis = [0, 0, -1], angle = 0.2 }} }}, {{ name = 'b', {plane}, \
         at = [0, 5, 0] }}]\n{}{REST}",
        regions(&[("a", 2.0), ("b", 2.0)])
    );
    let problem = problem(&input);
    assert!(problem.body.regions().iter().all(|region| (region.volume - 2.0).abs() < 1e-14));
    assert_eq!(problem.body.mesh().groups().facets("b-y-max").unwrap().len(), 2);
}
