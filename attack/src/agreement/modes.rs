//! Natural frequencies, effective masses, and masses and centres of regions, compared with the reference.

use std::collections::BTreeMap;

use super::Kind;
use crate::case::Case;
use crate::reference::motion::{Motion, Row};
use crate::reference::numbers::{Factors, Matrix, dot, eigen};

/// Frequencies about the start, from the dense eigenproblem without the nodes that have no mass.
pub(super) fn compare_modes(
    case: &Case,
    modes: &BTreeMap<String, Vec<f64>>,
    start: &Row,
) -> Result<(), String> {
    let motion = case.motion();
    let u = match case.chosen("run") {
        "static" => motion.equilibria(&[0.5, 1.0]).map_err(|error| format!("no equilibrium: {error}"))?.pop(),
        _ => None,
    };
    let u = u.as_ref().unwrap_or(&start.displacement);
    // Fibres bear tension only: an undeformed body has the stiffness of its matrix.
    let mut body = case.body.clone();
    if u.iter().all(|u| *u == 0.0) {
        body = body.slack();
    }
    // Modes have the consistent mass, also beside a scheme with a lumped one.
    if case.chosen("scheme") == "central-differences" {
        body = body.attracted_by_row_sums();
    }
    let has_start = case.text.contains("[equilibrium]") || case.chosen("start") == "state";
    let by_width = |h: f64| Motion { body: &body, ..case.motion() }.stiffness(u, h, has_start);
    let stiffness = by_width(1e-5);
    // Where fibres become taut within the width of a difference, it is no derivative, and depends on the width.
    if case.chosen("material") == "fibres" {
        let pairs = stiffness.iter().flatten().zip(by_width(2e-5).into_iter().flatten());
        let (difference, size) = pairs.fold((0.0f64, 0.0f64), |(difference, size), (own, other)| {
            (difference.max((own - other).abs()), size.max(own.abs()))
        });
        if difference > 1e-8 * size {
            return Ok(());
        }
    }
    let heavy_end = 3 * case.body.n_nodes();
    let (heavy, light): (Vec<usize>, Vec<usize>) =
        motion.free(0.0).into_iter().partition(|dof| *dof < heavy_end);
    let part = |rows: &[usize], columns: &[usize]| -> Matrix {
        rows.iter().map(|&i| columns.iter().map(|&j| stiffness[i][j]).collect()).collect()
    };
    let mut condensed = part(&heavy, &heavy);
    let factors = Factors::new(part(&light, &light));
    let coupling = part(&light, &heavy);
    for j in 0..heavy.len() {
        let column: Vec<f64> = coupling.iter().map(|row| row[j]).collect();
        let inner = factors.solve(&column);
        for i in 0..heavy.len() {
            condensed[i][j] -= coupling.iter().zip(&inner).map(|(row, x)| row[i] * x).sum::<f64>();
        }
    }
    // M = L L^T, and the eigenvalues of L^-1 K L^-T.
    let mass = |i: usize, j: usize| match heavy[i] % 3 == heavy[j] % 3 {
        true => case.body.mass[heavy[i] / 3][heavy[j] / 3],
        false => 0.0,
    };
    let n = heavy.len();
    let row_sums = case.body.row_sums();
    let mut lower: Matrix = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum = mass(i, j) - (0..j).map(|m| lower[i][m] * lower[j][m]).sum::<f64>();
            lower[i][j] = if i == j { sum.sqrt() } else { sum / lower[j][j] };
        }
    }
    let forward = |column: &mut [f64]| {
        for i in 0..n {
            column[i] = (column[i] - (0..i).map(|m| lower[i][m] * column[m]).sum::<f64>()) / lower[i][i];
        }
    };
    let turned =
        |matrix: &Matrix| -> Matrix { (0..n).map(|i| (0..n).map(|j| matrix[j][i]).collect()).collect() };
    let mut reduced = turned(&condensed);
    reduced.iter_mut().for_each(|column| forward(column));
    reduced = turned(&reduced);
    reduced.iter_mut().for_each(|row| forward(row));
    let symmetric = (0..n).map(|i| (0..n).map(|j| 0.5 * (reduced[i][j] + reduced[j][i])).collect()).collect();
    let values = eigen(symmetric);
    let own = &modes["angular_frequency"];
    if own.len() != n.min(10) {
        return Err(format!("{} modes of {n} degrees of freedom", own.len()));
    }
    let squares = own.iter().map(|omega| omega * omega.abs()).collect::<Vec<f64>>();
    let expected: Vec<f64> = values.iter().take(own.len()).map(|(value, _)| *value).collect();
    let mut kind = Kind::new(0.0);
    kind.pairs.push(("omega^2 of the modes".into(), squares, expected));
    kind.check(1e-8)?;
    // Effective masses where a frequency stands alone.
    let mut masses = Kind::new(case.body.mass.iter().flatten().sum());
    for (number, (value, vector)) in values.iter().take(own.len()).enumerate() {
        let is_alone = |other: usize| {
            values.get(other).is_none_or(|(next, _)| (next - value).abs() > 1e-3 * value.abs().max(1.0))
        };
        if number > 0 && !is_alone(number - 1) || !is_alone(number + 1) {
            continue;
        }
        for (d, axis) in ["x", "y", "z"].iter().enumerate() {
            // v^T M e with v = L^-T w, so w^T L^-1 M e.
            let mut moved: Vec<f64> =
                heavy.iter().map(|dof| if dof % 3 == d { row_sums[dof / 3] } else { 0.0 }).collect();
            forward(&mut moved);
            let along = dot(vector, &moved);
            let column = &modes[&format!("effective_mass_{axis}")];
            masses.pairs.push((
                format!("effective mass {axis} of mode {}", number + 1),
                vec![column[number]],
                vec![along * along],
            ));
        }
    }
    masses.check(1e-6)
}

/// Mass and centre of the cells of each region, to the digits that `check` shows.
pub(super) fn compare_masses(case: &Case, report: &str) -> Result<(), String> {
    let lines: Vec<&str> = report.lines().filter(|line| line.starts_with("region")).collect();
    let is_two = case.chosen("material") == "two" && case.mesh.is_second.contains(&true);
    if lines.len() != 1 + usize::from(is_two) {
        return Err(format!("check has {} regions", lines.len()));
    }
    for (region, line) in lines.iter().enumerate() {
        let after = |word: &str| line.split(word).nth(1).unwrap_or_default();
        let numbers = |text: &str| -> Vec<f64> {
            let cells = text.split([',', '[', ']', ' ']).filter(|cell| !cell.is_empty());
            cells.map_while(|cell| cell.parse().ok()).collect()
        };
        let cells = || case.body.cells.iter().filter(|cell| !is_two || cell.is_second == (region == 1));
        let volume: f64 = cells().map(|cell| cell.mass_volume()).sum();
        let (mut mass, mut centre) = (0.0, [0.0; 3]);
        for cell in cells() {
            for (own, place) in cell.mass_places(&case.body.points) {
                mass += own;
                (0..3).for_each(|d| centre[d] += own * place[d]);
            }
        }
        let mut kind = Kind::new(0.0);
        let first = |word: &str| numbers(after(word)).first().copied().unwrap_or(f64::NAN);
        kind.pairs.push(("volume of check".into(), vec![first("volume ")], vec![volume]));
        kind.pairs.push(("mass of check".into(), vec![first("mass ")], vec![mass]));
        let expected: Vec<f64> = centre.iter().map(|sum| sum / mass).collect();
        kind.pairs.push(("centre of check".into(), numbers(after("centre [")), expected));
        kind.check(2e-5)?;
    }
    Ok(())
}
