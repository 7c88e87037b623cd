//! Histories and summaries, compared with rows of the reference.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Kind, TOLERANCE};
use crate::case::{Case, VALUES};
use crate::reference::mesh::Mesh;
use crate::reference::motion::{Row, Scheme};
use crate::reference::numbers::{plus, product, transpose};

pub(super) fn compare_history(
    case: &Case,
    columns: &BTreeMap<String, Vec<f64>>,
    rows: &[Row],
) -> Result<(), String> {
    let is_static = case.chosen("run") == "static";
    let own = |name: &str| columns.get(name).cloned().ok_or(format!("there is no column {name}"));
    let of = |f: &dyn Fn(&Row) -> f64| rows.iter().map(f).collect::<Vec<f64>>();
    let add = |kind: &mut Kind, name: &str, f: &dyn Fn(&Row) -> f64| {
        own(name).map(|values| kind.pairs.push((name.to_string(), values, of(f))))
    };
    let mut places = Kind::new(0.0);
    for (node, point) in case.body.points.iter().enumerate() {
        for (d, axis) in ["x", "y", "z"].iter().enumerate() {
            let name = format!("n{node}_{axis}");
            let shift = own(&name)?.iter().map(|x| x - point[d]).collect();
            places.pairs.push((name, shift, of(&|row| row.displacement[3 * node + d])));
        }
    }
    let norm = |row: &Row, node: usize| {
        row.displacement[3 * node..3 * node + 3].iter().map(|u| u * u).sum::<f64>().sqrt()
    };
    let nodes = case.body.n_nodes();
    add(&mut places, "max_displacement", &|row| (0..nodes).fold(0.0, |m, node| norm(row, node).max(m)))?;
    let mut ratios = Kind::new(1.0);
    add(&mut ratios, "smallest_determinant", &|row| row.determinant)?;
    let mut energies = Kind::new(0.0);
    add(&mut energies, "kinetic_energy", &|row| row.kinetic)?;
    add(&mut energies, "strain_energy", &|row| row.strain)?;
    add(&mut energies, "external_work", &|row| row.work)?;
    if !is_static {
        add(&mut energies, "total_energy", &|row| row.kinetic + row.strain)?;
        add(&mut energies, "energy_residual", &|row| row.energy_residual)?;
    }
    if columns.contains_key("dissipated_energy") {
        add(&mut energies, "dissipated_energy", &|row| row.dissipated)?;
    }
    let speed = rows.iter().flat_map(|row| &row.velocity).fold(0.0f64, |m, v| m.max(v.abs()));
    let momentum = speed * case.body.mass.iter().flatten().sum::<f64>();
    let mut momenta = Kind::new(momentum);
    for (m, name) in ["linear_momentum", "angular_momentum"].iter().enumerate() {
        if is_static {
            continue;
        }
        for (d, axis) in ["x", "y", "z"].iter().enumerate() {
            add(&mut momenta, &format!("{name}_{axis}"), &|row| row.momenta[m][d])?;
        }
        add(&mut momenta, &format!("{name}_residual"), &|row| row.momentum_residuals[m])?;
    }
    let h = rows[1].time - rows[0].time;
    let mut forces = Kind::new(momentum / h);
    for (number, group) in case.groups.iter().enumerate() {
        for (m, name) in ["force", "moment"].iter().enumerate() {
            for (d, axis) in ["x", "y", "z"].iter().enumerate() {
                let reaction = |row: &Row| row.reactions.get(number).map_or(f64::NAN, |own| own[m][d]);
                add(&mut forces, &format!("{group}_{name}_{axis}"), &reaction)?;
            }
        }
    }
    places.check(TOLERANCE)?;
    ratios.check(TOLERANCE)?;
    energies.check(TOLERANCE)?;
    momenta.check(TOLERANCE)?;
    if is_static {
        // The first row of a static analysis has no loads and no reactions.
        forces.pairs.iter_mut().for_each(|(_, own, expected)| (own[0], expected[0]) = (f64::NAN, f64::NAN));
    }
    forces.check(TOLERANCE)?;
    compare_values(case, columns, rows)
}

/// Means, totals and largest values of the cells of the group `one`, and the mean displacement of the top.
fn compare_values(case: &Case, columns: &BTreeMap<String, Vec<f64>>, rows: &[Row]) -> Result<(), String> {
    const COMPONENTS: [(&str, usize, usize); 6] =
        [("xx", 0, 0), ("yy", 1, 1), ("zz", 2, 2), ("xy", 0, 1), ("yz", 1, 2), ("xz", 0, 2)];
    let mut expected: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for row in rows {
        let mut put = |name: String, value: f64| expected.entry(name).or_default().push(value);
        let zero = [[0.0; 3]; 3];
        let (mut energy, mut kinetic, mut density, mut mises) = (0.0, 0.0, f64::NEG_INFINITY, 0.0f64);
        let (mut stress, mut piola, mut ratio, mut volume) = (zero, zero, 0.0, 0.0);
        for cell in case.body.cells.iter().filter(|cell| !cell.is_second) {
            let own_volume = cell.volume();
            let (mut own_energy, mut own_stress) = (0.0, zero);
            for point in cell.state(&row.displacement) {
                own_energy += point.weight * point.energy;
                let pushed = product(&product(&point.f, &point.stress), &transpose(&point.f));
                own_stress = plus(&own_stress, point.weight / point.ratio, &pushed);
                piola = plus(&piola, point.weight, &point.stress);
                ratio += point.weight * point.ratio;
            }
            energy += own_energy;
            kinetic += cell.kinetic_energy(&row.velocity);
            density = density.max(own_energy / own_volume);
            stress = plus(&stress, 1.0, &own_stress);
            let mean = own_stress.map(|row| row.map(|s| s / own_volume));
            let pressure = (mean[0][0] + mean[1][1] + mean[2][2]) / 3.0;
            let mut square = 0.0;
            (0..3).for_each(|i| {
                (0..3).for_each(|j| square += (mean[i][j] - if i == j { pressure } else { 0.0 }).powi(2));
            });
            mises = mises.max((1.5 * square).sqrt());
            volume += own_volume;
        }
        put("energy".into(), energy);
        put("kinetic".into(), kinetic);
        put("density".into(), density);
        put("mises".into(), mises);
        put("ratio".into(), ratio / volume);
        for (name, i, j) in COMPONENTS {
            put(format!("stress_{name}"), stress[i][j] / volume);
            put(format!("piola_{name}"), piola[i][j]);
        }
        let top = Mesh::nodes_of(&case.mesh.top);
        for (d, axis) in ["x", "y", "z"].iter().enumerate() {
            let sum: f64 = top.iter().map(|node| row.displacement[3 * node + d]).sum();
            put(format!("shift_{axis}"), sum / top.len() as f64);
        }
    }
    let energy = rows.iter().fold(0.0f64, |m, row| m.max(row.kinetic).max(row.strain));
    for (name, ..) in VALUES {
        if name == "kinetic" && matches!(case.scheme, Scheme::Central) {
            continue;
        }
        let mut kind = Kind::new(if ["energy", "kinetic", "density"].contains(&name) { energy } else { 0.0 });
        for (own, values) in
            expected.iter().filter(|(own, _)| *own == name || own.starts_with(&format!("{name}_")))
        {
            let column = columns.get(own).ok_or(format!("there is no column {own}"))?;
            kind.pairs.push((own.clone(), column.clone(), values.clone()));
        }
        // Stresses at the start are rounding.
        kind.scale = kind.scale.max(if ["stress", "piola", "mises"].contains(&name) { 1.0 } else { 0.0 });
        kind.check(TOLERANCE)?;
    }
    Ok(())
}

pub(super) fn compare_summary(path: &Path, rows: &[Row]) -> Result<(), String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let summary: serde_json::Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    let largest = |f: &dyn Fn(&Row) -> f64| rows.iter().map(f).fold(0.0, f64::max);
    let displacement = largest(&|row| {
        row.displacement.chunks(3).map(|u| u.iter().map(|u| u * u).sum::<f64>().sqrt()).fold(0.0, f64::max)
    });
    let energy = largest(&|row| row.kinetic + row.strain.abs());
    let last = &rows[rows.len() - 1];
    for (name, expected, scale) in [
        ("largest_displacement", displacement, displacement),
        ("largest_energy", energy, energy),
        ("largest_kinetic_energy", largest(&|row| row.kinetic), energy),
        ("external_work", last.work, energy),
        ("total_energy", last.kinetic + last.strain, energy),
    ] {
        let own = summary[name].as_f64().ok_or(format!("summary.json has no {name}"))?;
        let mut kind = Kind::new(scale);
        kind.pairs.push((format!("{name} of the summary"), vec![own], vec![expected]));
        kind.check(TOLERANCE)?;
    }
    Ok(())
}
