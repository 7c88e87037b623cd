//! Inf-sup constants of the pairs of displacements and pressures.

#![allow(non_snake_case)]

use emmy::body::PressureSpace::{self, Constant, Linear};
use emmy::internals::element::{element, jacobian};
use emmy::internals::tensor::{cross, det};
use emmy::mesh::{Cell, CellKind, Mesh};
use faer::prelude::Solve;
use faer::{Mat, Side};

use super::grid::{Grid, Map};
use crate::claim::Item;
use crate::items::Effort;
use crate::picture::{Pictures, Series};

/// Largest eigenvalue that counts as zero; beta is its root.
const ZERO: f64 = 1e-13;

/// A pair of displacements and pressures.
struct Pair {
    kind: CellKind,
    space: PressureSpace,
    verdict: Verdict,
    /// Squares or bricks along an edge; the last of them only in the full set.
    n: &'static [usize],
    /// An independent implementation on the first of these meshes, regular cells: three decimals of beta.
    expected: &'static [f64],
}

/// Verdict on a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Verdict {
    /// beta has a bound.
    Stable,
    /// beta falls with the mesh size, or pressures are spurious.
    Unstable,
}

const PLANE: &[usize] = &[4, 8, 16];
const SPACE: &[usize] = &[2, 3, 4, 6];

const PAIRS: [Pair; 22] = {
    use Verdict::{Stable, Unstable};
    const fn pair(
        kind: CellKind,
        space: PressureSpace,
        verdict: Verdict,
        n: &'static [usize],
        expected: &'static [f64],
    ) -> Pair {
        Pair { kind, space, verdict, n, expected }
    }
    [
        pair(CellKind::Quad9, Linear, Stable, PLANE, &[0.506, 0.485, 0.472]),
        pair(CellKind::Quad9, Constant, Stable, PLANE, &[]),
        pair(CellKind::Quad8, Constant, Stable, PLANE, &[]),
        pair(CellKind::Tri6, Constant, Stable, PLANE, &[]),
        pair(CellKind::Hex27, Linear, Stable, SPACE, &[0.395, 0.394, 0.385]),
        pair(CellKind::Hex27, Constant, Stable, SPACE, &[]),
        pair(CellKind::Quad8, Linear, Unstable, PLANE, &[0.161, 0.093, 0.049]),
        pair(CellKind::Tri6, Linear, Unstable, PLANE, &[0.078]),
        pair(CellKind::Quad4, Constant, Unstable, PLANE, &[]),
        pair(CellKind::Tri3, Constant, Unstable, PLANE, &[]),
        pair(CellKind::Hex20, Linear, Unstable, SPACE, &[0.159, 0.125, 0.087, 0.046]),
        pair(CellKind::Hex20, Constant, Unstable, SPACE, &[]),
        pair(CellKind::Hex8, Constant, Unstable, SPACE, &[]),
        pair(CellKind::Wedge15, Linear, Unstable, SPACE, &[]),
        pair(CellKind::Wedge15, Constant, Unstable, SPACE, &[]),
        pair(CellKind::Wedge6, Constant, Unstable, SPACE, &[]),
        pair(CellKind::Pyramid13, Linear, Unstable, &[2, 3, 4], &[]),
        pair(CellKind::Pyramid13, Constant, Unstable, SPACE, &[]),
        pair(CellKind::Pyramid5, Constant, Unstable, SPACE, &[]),
        pair(CellKind::Tet10, Constant, Unstable, SPACE, &[0.100, 0.093, 0.076]),
        pair(CellKind::Tet10, Linear, Unstable, &[2, 3, 4], &[]),
        pair(CellKind::Tet4, Constant, Unstable, SPACE, &[]),
    ]
};

/// Result of a mesh.
#[derive(Debug, Clone, Copy)]
struct InfSup {
    beta: f64,
    /// Pressures without a force, beside the constant.
    spurious: usize,
}

/// The numerical inf-sup test: D. Chapelle, K.-J. Bathe, Comput. Struct. 47 (1993) 537.
///
/// ```math
/// beta^2 = smallest nonzero eigenvalue of  sum_d G_d L^-1 G_d^T,      L_AB = int grad N_A . grad N_B,
/// (G_d)_aA = int psi_a dN_A/dX_d,      int psi_a psi_b = delta_ab
/// ```
///
/// N_A: shape functions of the nodes inside. All integrals take the quadrature of the internal force.
fn inf_sup(mesh: &Mesh, space: PressureSpace) -> Result<InfSup, String> {
    let [L, G @ ..] = matrices(mesh, space);
    let cholesky = L.llt(Side::Lower).map_err(|error| format!("{error:?}"))?;
    let S =
        G.iter().fold(Mat::zeros(G[0].nrows(), G[0].nrows()), |S, G| S + G * cholesky.solve(G.transpose()));
    let mut values = S.self_adjoint_eigenvalues(Side::Lower).map_err(|error| format!("{error:?}"))?;
    values.sort_by(f64::total_cmp);
    let zeros = values.partition_point(|&value| value < ZERO);
    let beta = values.get(zeros).map_or(0.0, |value| value.sqrt());
    Ok(InfSup { beta, spurious: zeros.saturating_sub(1) })
}

/// L and the three G_d.
fn matrices(mesh: &Mesh, space: PressureSpace) -> [Mat<f64>; 4] {
    let dimension = mesh.cell(0).kind.dimension();
    let is_inside = |X: &[f64; 3]| X[..dimension].iter().all(|x| (1e-9..1.0 - 1e-9).contains(x));
    let mut n_inside = 0;
    let number = |X| is_inside(X).then(|| (n_inside, n_inside += 1).0);
    let unknowns: Vec<Option<usize>> = mesh.points().iter().map(number).collect();
    let n_functions = space.n_functions(dimension);
    let mut L = Mat::zeros(n_inside, n_inside);
    let mut G = [0, 1, 2].map(|_| Mat::<f64>::zeros(n_functions * mesh.n_cells(), n_inside));
    for (c, cell) in mesh.cells().enumerate() {
        let points = points_of(mesh, cell);
        let psi = pressures(&points, n_functions);
        let inside: Vec<(usize, usize)> =
            cell.nodes.iter().enumerate().filter_map(|(A, &n)| Some((A, unknowns[n as usize]?))).collect();
        for (q, point) in points.iter().enumerate() {
            for &(A, i) in &inside {
                for &(B, j) in &inside {
                    L[(i, j)] += point.weight * dot(point.gradients[A], point.gradients[B]);
                }
                for (a, psi) in psi.iter().enumerate() {
                    for d in 0..3 {
                        G[d][(c * n_functions + a, i)] += point.weight * psi[q] * point.gradients[A][d];
                    }
                }
            }
        }
    }
    let [x, y, z] = G;
    [L, x, y, z]
}

/// A quadrature point of a cell.
struct Point {
    position: [f64; 3],
    weight: f64,
    /// dN_A/dX
    gradients: Vec<[f64; 3]>,
}

fn points_of(mesh: &Mesh, cell: Cell<'_>) -> Vec<Point> {
    let X: Vec<[f64; 3]> = cell.nodes.iter().map(|&node| mesh.points()[node as usize]).collect();
    let point = |(&xi, weight): (&[f64; 3], f64)| {
        let (mut N, mut dN) = (vec![0.0; X.len()], vec![[0.0; 3]; X.len()]);
        element(cell.kind).shape(xi, &mut N);
        element(cell.kind).gradient(xi, &mut dN);
        let J = jacobian(cell.kind, &X, &dN);
        let column = |j: usize| J.map(|row| row[j]);
        let dual = [1, 2, 0].map(|j| cross(column(j), column((j + 1) % 3)));
        let by_position =
            |dN: &[f64; 3]| [0, 1, 2].map(|i| (0..3).map(|j| dN[j] * dual[j][i]).sum::<f64>() / det(&J));
        Point {
            position: [0, 1, 2].map(|i| X.iter().zip(&N).map(|(X, N)| N * X[i]).sum()),
            weight: weight * det(&J),
            gradients: dN.iter().map(by_position).collect(),
        }
    };
    element(cell.kind).quadrature().iter().map(point).collect()
}

/// 1 and the reference position, orthonormal in the cell: values at the points.
fn pressures(points: &[Point], n_functions: usize) -> Vec<Vec<f64>> {
    let product =
        |a: &[f64], b: &[f64]| points.iter().zip(a).zip(b).map(|((p, a), b)| p.weight * a * b).sum::<f64>();
    let mut psi: Vec<Vec<f64>> = Vec::new();
    for function in 0..n_functions {
        let raw = |p: &Point| if function == 0 { 1.0 } else { p.position[function - 1] };
        let mut values: Vec<f64> = points.iter().map(raw).collect();
        for known in &psi {
            let part = product(&values, known);
            values.iter_mut().zip(known).for_each(|(value, known)| *value -= part * known);
        }
        let size = product(&values, &values).sqrt();
        psi.push(values.into_iter().map(|value| value / size).collect());
    }
    psi
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Results of a pair on regular and on warped cells.
fn results(pair: &Pair, effort: Effort) -> Result<[Vec<InfSup>; 2], String> {
    let n = if effort.quick { &pair.n[..pair.n.len() - 1] } else { pair.n };
    let result = |n: usize, is_warped: bool| {
        let regular = |x: [f64; 3]| x.map(|x| x / n as f64);
        let distorted = |x| warped(regular(x));
        let map: [Map<'_>; 2] = [&regular, &distorted];
        let mesh = Grid { kind: pair.kind, n: [n; 3], map: map[usize::from(is_warped)] }.mesh(&[])?;
        inf_sup(&mesh, pair.space)
    };
    let all = |is_warped| n.iter().map(|&n| result(n, is_warped)).collect::<Result<Vec<_>, String>>();
    Ok([all(false)?, all(true)?])
}

/// The warped square or cube; its faces stay plane.
fn warped(x: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| x[i] + x[i] * (1.0 - x[i]) * (0.3 * x[(i + 1) % 3] - 0.2 * x[(i + 2) % 3]))
}

/// The pairs of all cells.
pub(in crate::items) fn item(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "inf-sup",
        "Elements that do not lock: inf-sup constants",
        "The numerical inf-sup test of D. Chapelle and K.-J. Bathe (Comput. Struct. 47 (1993) 537) on the unit square and cube, all of its \
        boundary held, with the seminorm of H1: beta for growing numbers of squares or bricks along an edge (4, 8, 16 and 2, 3, 4, 6; \
        fewer in the quick set), and spurious pressures, which have no forces, beside the constant. A stable pair has a beta with a \
        bound on regular and on warped cells, x_i + x_i (1 - x_i) (0.3 x_(i+1) - 0.2 x_(i+2)). Others can show oscillating pressures, \
        and an error of the pressure that grows with the bulk modulus.",
    );
    let header = ["displacement", "pressure", "regular", "spurious", "warped", "spurious", "verdict"];
    let mut table = vec![header.map(String::from).to_vec()];
    let mut curves = Vec::new();
    for pair in &PAIRS {
        let [regular, warped] = results(pair, effort)?;
        judge(&mut item, pair, &regular, &warped);
        table.push(row(pair, &regular, &warped));
        if pair.kind.dimension() == 3 && pair.kind.info().pressures.contains(&pair.space) {
            let points = pair.n.iter().zip(&regular).map(|(&n, result)| (1.0 / n as f64, result.beta));
            curves.push(Series::marked(&pair.name(), points.collect()));
        }
    }
    item.tables.push(table);
    let axes = ["size of a brick".to_string(), "inf-sup constant, regular cells".to_string()];
    item.pictures.push(pictures.log_log("inf-sup", "Inf-sup constants in space", axes, curves, vec![])?);
    item.commands.push("cargo run --release -p emmy-validation -- --only inf-sup".into());
    Ok(item)
}

fn row(pair: &Pair, regular: &[InfSup], warped: &[InfSup]) -> Vec<String> {
    let spurious =
        |all: &[InfSup]| all.iter().map(|one| one.spurious.to_string()).collect::<Vec<_>>().join(" ");
    let verdict = format!("{:?}", pair.verdict).to_lowercase();
    let pair = [pair.kind.to_string(), pair.space.to_string()];
    let results = [constants(regular), spurious(regular), constants(warped), spurious(warped), verdict];
    pair.into_iter().chain(results).collect()
}

fn constants(all: &[InfSup]) -> String {
    let text = |one: &InfSup| match one.beta {
        beta if beta < 1e-3 => format!("{beta:.0e}"),
        beta => format!("{beta:.3}"),
    };
    all.iter().map(text).collect::<Vec<_>>().join(" ")
}

impl Pair {
    fn name(&self) -> String {
        format!("{}, {} pressure", self.kind, self.space)
    }
}

/// A stable pair loses little from mesh to mesh and has no spurious pressures; another one has some, or its constant
/// falls on one of the meshes.
fn judge(item: &mut Item, pair: &Pair, regular: &[InfSup], warped: &[InfSup]) {
    let kept = |all: &[InfSup]| {
        let ratios = all.windows(2).map(|pair| pair[1].beta / pair[0].beta);
        let spurious = all.iter().any(|one| one.spurious > 0);
        if spurious { 0.0 } else { ratios.fold(1.0, f64::min) }
    };
    let is_stable = kept(regular).min(kept(warped)) > 0.9 && warped[0].beta > 0.1;
    let words = match pair.verdict {
        Verdict::Stable => "stable",
        Verdict::Unstable => "not stable",
    };
    item.claim(
        format!("{} is {words}", pair.name()),
        format!("beta {}; warped {}", constants(regular), constants(warped)),
        is_stable == (pair.verdict == Verdict::Stable),
    );
    if !pair.expected.is_empty() {
        let errors = regular.iter().zip(pair.expected).map(|(found, expected)| (found.beta - expected).abs());
        let largest = errors.fold(0.0, f64::max);
        item.claim(
            format!("{}: the constants of an independent implementation", pair.name()),
            format!("largest difference {largest:.1e}"),
            largest < 6e-4,
        );
    }
}
