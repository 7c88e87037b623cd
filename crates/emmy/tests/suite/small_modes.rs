//! Natural modes of small bodies against eigenvalues by Jacobi's rotations, and against closed forms.

#![allow(non_snake_case)]

use emmy::body::{Body, Formulation, PointTerms, Region, Support};
use emmy::material::{Link, NeoHooke};
use emmy::mesh::{self, Mesh};
use emmy::modes::{Mode, lowest_elastic_mode, lowest_elastic_mode_about, modes, modes_about, n_modes};
use emmy::motion::State;

use crate::shared::points::{masses, network};

/// Lower triangle L of `A = L L^T`.
fn cholesky(A: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = A.len();
    let mut L = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let rest = A[i][j] - (0..j).map(|k| L[i][k] * L[j][k]).sum::<f64>();
            L[i][j] = if i == j { rest.sqrt() } else { rest / L[j][j] };
        }
    }
    L
}

/// Columns of `L^-1 B`.
fn forward(L: &[Vec<f64>], mut B: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = L.len();
    for column in 0..n {
        for i in 0..n {
            let rest = B[i][column] - (0..i).map(|k| L[i][k] * B[k][column]).sum::<f64>();
            B[i][column] = rest / L[i][i];
        }
    }
    B
}

fn transposed(A: &[Vec<f64>]) -> Vec<Vec<f64>> {
    (0..A.len()).map(|i| A.iter().map(|row| row[i]).collect()).collect()
}

/// Eigenvalues of a symmetric matrix, ascending, by cyclic Jacobi rotations (Golub and Van Loan, section 8.5).
fn jacobi(mut A: Vec<Vec<f64>>) -> Vec<f64> {
    let n = A.len();
    for _ in 0..30 {
        for p in 0..n {
            for q in p + 1..n {
                if A[p][q] == 0.0 {
                    continue;
                }
                let tau = (A[q][q] - A[p][p]) / (2.0 * A[p][q]);
                let t = 1f64.copysign(tau) / (tau.abs() + tau.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                for row in &mut A {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for k in 0..n {
                    (A[p][k], A[q][k]) = (c * A[p][k] - s * A[q][k], s * A[p][k] + c * A[q][k]);
                }
            }
        }
    }
    let mut values: Vec<f64> = (0..n).map(|i| A[i][i]).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// All eigenvalues of `K v = lambda M v` on the free degrees of freedom, ascending; K at a displacement `[n_nodes][3]`.
/// Internal nodes, which have no mass, are eliminated: `K - K_i K_ii^-1 K_i^T`.
fn eigenvalues(body: &Body, displacement: &[f64]) -> Vec<f64> {
    let rows = body.stiffness(displacement).unwrap();
    let n = body.n_dofs();
    let (mut K, mut M) = (vec![vec![0.0; n]; n], vec![vec![0.0; n]; n]);
    for (row, blocks) in rows.iter().enumerate() {
        let masses = &body.mass()[body.pattern().range(row)];
        for ((column, block), mass) in blocks.iter().zip(masses) {
            for (i, j) in (0..9).map(|at| (at / 3, at % 3)) {
                K[3 * row + i][3 * *column as usize + j] = block[3 * i + j];
                M[3 * row + i][3 * *column as usize + j] = if i == j { *mass } else { 0.0 };
            }
        }
    }
    let with_mass = body.mesh().n_dofs();
    // Gaussian elimination from the last internal degree of freedom on.
    for last in (with_mass..n).rev().filter(|&dof| !body.fixed()[dof]) {
        for i in (0..last).filter(|&dof| !body.fixed()[dof]) {
            let factor = K[i][last] / K[last][last];
            (0..last).for_each(|j| K[i][j] -= factor * K[last][j]);
        }
    }
    let free: Vec<usize> = (0..with_mass).filter(|&dof| !body.fixed()[dof]).collect();
    let part = |A: &[Vec<f64>]| -> Vec<Vec<f64>> {
        free.iter().map(|&i| free.iter().map(|&j| 0.5 * (A[i][j] + A[j][i])).collect()).collect()
    };
    let L = cholesky(&part(&M));
    jacobi(forward(&L, transposed(&forward(&L, part(&K)))))
}

/// omega^2, negative for an unstable mode.
fn square(mode: &Mode) -> f64 {
    mode.angular_frequency * mode.angular_frequency.abs()
}

/// Compares the modes of every count with the eigenvalues of the matrices, and the lowest elastic mode with the first
/// one above zero. Both have the rounding of the largest eigenvalue.
fn compare(name: &str, body: &Body) {
    let expected = eigenvalues(body, &vec![0.0; body.n_dofs()]);
    assert_eq!(expected.len(), n_modes(body));
    let largest = expected.last().unwrap().abs();
    for count in 1..=expected.len() {
        let found = modes(body, count).unwrap_or_else(|error| panic!("{name}, {count}: {error}"));
        assert_eq!(found.len(), count);
        for (mode, expected) in found.iter().zip(&expected) {
            let error = (square(mode) - expected).abs();
            assert!(error < 1e-12 * largest, "{name}, {count}: {} is not {expected}", square(mode));
            assert!(mode.residual < 1e-8, "{name}, {count}: {}", mode.residual);
        }
    }
    let zero = 1e-12 * largest;
    let n_rigid = expected.iter().filter(|value| value.abs() <= zero).count();
    match (lowest_elastic_mode(body).unwrap(), expected.iter().find(|value| **value > zero)) {
        (Some((mode, n)), Some(value)) => {
            assert!((square(&mode) - value).abs() < zero && n == n_rigid, "{name}: {value}, {n_rigid} rigid");
        }
        (found, expected) => panic!("{name}: {found:?} is not {expected:?}"),
    }
}

fn rubber(mesh: Mesh, formulation: Formulation, supports: &[Support]) -> Body {
    let material = NeoHooke::from_engineering(1000.0, 0.3).unwrap();
    let region = Region::new(material, 1.0).with_formulation(formulation);
    Body::builder(mesh).region(region).supports(supports).build().unwrap()
}

#[test]
fn rectangles_and_boxes_have_the_modes_of_their_matrices() {
    let standard = Formulation::Standard;
    let sliding = [Support::of_components("y-min", [false, true, false])];
    let held = [Support::fixed("y-min")];
    let none = [];
    for (size, cells) in [
        ([1.0, 2.0], [3, 1]),
        ([0.97, 2.73], [1, 2]),
        ([1.0, 1.0], [1, 1]),
        ([2.0, 0.3], [2, 2]),
        ([5.0, 1.0], [5, 2]),
        ([1.0, 1.0], [4, 6]),
    ] {
        for supports in [&none[..], &sliding, &held] {
            let body = rubber(mesh::rectangle(size, cells).unwrap(), standard, supports);
            compare(&format!("{size:?} {cells:?} {}", supports.len()), &body);
        }
    }
    for (cells, supports) in
        [([1, 1, 1], &none[..]), ([1, 1, 1], &held), ([1, 2, 1], &held), ([2, 2, 1], &none)]
    {
        for formulation in [standard, Formulation::IncompatibleModes] {
            let body = rubber(mesh::block([1.0, 2.0, 0.7], cells).unwrap(), formulation, supports);
            compare(&format!("{cells:?} {formulation:?}"), &body);
        }
    }
}

/// Random networks of springs, most of them mechanisms, with masses and stiffnesses that differ by factors of up
/// to 100.
#[test]
fn networks_of_springs_have_the_modes_of_their_matrices() {
    let mut seed = 7u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    for n in (2..=12).chain([2, 3, 20, 23]) {
        let points: Vec<[f64; 3]> = (0..n).map(|_| [random(), random(), random()]).collect();
        let mut links: Vec<[u32; 2]> = (1..n).map(|i| [(random() * f64::from(i)) as u32, i]).collect();
        for _ in 0..(random() * 2.0 * f64::from(n)) as usize {
            let [a, b] = [0, 1].map(|_| (random() * f64::from(n)) as u32);
            if a != b && !links.iter().any(|link| [[a, b], [b, a]].contains(link)) {
                links.push([a, b]);
            }
        }
        let own: Vec<f64> = (0..n).map(|_| 10f64.powf(2.0 * random())).collect();
        let nodal = PointTerms { masses: masses(&own), ..Default::default() };
        let region = Region::links(Link::spring(10f64.powf(2.0 * random()), None).unwrap(), 0.0);
        let body = Body::builder(network(&points, &links)).region(region).point_terms(nodal).build().unwrap();
        compare(&format!("{n} masses, {} springs", links.len()), &body);
    }
}

/// omega^2 = k (1/m_1 + 1/m_2).
#[test]
fn two_masses_on_a_spring_have_one_elastic_mode() {
    let nodal = PointTerms { masses: masses(&[2.0, 3.0]), ..Default::default() };
    let pair = Body::builder(network(&[[0.0; 3], [1.0, 2.0, 0.5]], &[[0, 1]]))
        .region(Region::links(Link::spring(12.0, None).unwrap(), 0.0))
        .point_terms(nodal)
        .build()
        .unwrap();
    let expected = (12.0f64 * (1.0 / 2.0 + 1.0 / 3.0)).sqrt();
    for count in 1..=6 {
        let found = modes(&pair, count).unwrap();
        assert!(found.iter().take(5).all(|mode| mode.angular_frequency == 0.0), "{found:?}");
        assert!(found.get(5).is_none_or(|mode| (mode.angular_frequency / expected - 1.0).abs() < 1e-13));
    }
    let (mode, n_rigid) = lowest_elastic_mode(&pair).unwrap().unwrap();
    assert!((mode.angular_frequency / expected - 1.0).abs() < 1e-13 && n_rigid == 5, "{mode:?}");
}

/// Values by SciPy's `eigh` with matrices of another program.
#[test]
fn small_bodies_have_the_frequencies_of_another_program() {
    let strip = rubber(
        mesh::rectangle([1.0, 2.0], [3, 1]).unwrap(),
        Formulation::Standard,
        &[Support::of_components("y-min", [false, true, false])],
    );
    for count in 1..=n_modes(&strip) {
        assert_eq!(modes(&strip, count).unwrap()[0].angular_frequency, 0.0);
    }
    let cube = mesh::block([1.0, 2.0, 0.7], [1, 1, 1]).unwrap();
    let cube = rubber(cube, Formulation::Standard, &[Support::fixed("y-min")]);
    for count in 1..=n_modes(&cube) {
        let lowest = modes(&cube, count).unwrap()[0].angular_frequency;
        assert!((lowest - 9.4704).abs() < 5e-5, "{count}: {lowest}");
    }
    let material = NeoHooke::from_engineering(1e7, 0.3).unwrap();
    let free = Body::builder(mesh::rectangle([0.97, 2.73], [1, 2]).unwrap());
    let free = free.region(Region::new(material, 1000.0)).build().unwrap();
    let found = modes(&free, 10).unwrap();
    let frequencies: Vec<f64> = found.iter().map(Mode::frequency).collect();
    assert!(frequencies[..3].iter().all(|frequency| *frequency == 0.0), "{frequencies:?}");
    for (frequency, expected) in frequencies[7..].iter().zip([46.59, 58.64, 66.79]) {
        assert!((frequency - expected).abs() < 5e-3, "{frequencies:?}");
    }
    let (lowest, n_rigid) = lowest_elastic_mode(&free).unwrap().unwrap();
    assert!((lowest.period() - 0.0634).abs() < 5e-5 && n_rigid == 3, "{}", lowest.period());
}

/// A stretched spring between fixed ends holds a mass in its middle across with `4 T/L`, L its stretched length.
#[test]
fn the_lowest_mode_about_a_state_feels_its_tension() {
    let nodal = PointTerms { masses: masses(&[1.0, 0.5, 1.0]), ..Default::default() };
    let string = Body::builder(network(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1], [1, 2]]))
        .region(Region::links(Link::spring(3.0, None).unwrap(), 0.0))
        .point_terms(nodal)
        .supports(&[Support::fixed("0"), Support::fixed("2")])
        .build()
        .unwrap();
    // Both halves are stretched from 1 to 1.1: T = 3 0.1.
    let displacement = vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.2, 0.0, 0.0];
    let state = State { displacement, ..State::initial(&string, 0.0, &[]).unwrap() };
    let expected = (4.0 * 0.3 / 2.2 / 0.5f64).sqrt();
    let (mode, n_rigid) = lowest_elastic_mode_about(&string, &state).unwrap().unwrap();
    assert!((mode.angular_frequency / expected - 1.0).abs() < 1e-12 && n_rigid == 0, "{mode:?}");
    assert_eq!(modes_about(&string, &state, 1).unwrap()[0].angular_frequency, mode.angular_frequency);
    // Without tension nothing holds it across.
    let (mode, n_rigid) = lowest_elastic_mode(&string).unwrap().unwrap();
    assert!((mode.angular_frequency / 12f64.sqrt() - 1.0).abs() < 1e-12 && n_rigid == 2, "{mode:?}");
}
