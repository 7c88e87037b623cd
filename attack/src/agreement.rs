//! Agreement of Emmy with the reference: histories, summaries, modes and masses.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};

use emmy::adjoint::{Goal, Parameter, Trajectory};
use emmy::team::{Team, Threads};
use emmy_cli::{Host, run_verb};
use emmy_io::input::{self, Overrides};

use crate::case::{Case, INCREMENTS, VALUES};
use crate::features::{Choice, describe, refusals};
use crate::place::Place;
use crate::reference::mesh::Mesh;
use crate::reference::motion::{Motion, Row, Scheme, State};
use crate::reference::numbers::{Factors, Matrix, dot, eigen, plus, product, transpose};

/// Largest difference from the reference, relative to the largest number of its kind.
const TOLERANCE: f64 = 2e-9;

/// A host that keeps all text.
#[derive(Default)]
struct Kept {
    output: Mutex<String>,
    team: Option<Arc<dyn Team>>,
}

impl Host for Kept {
    fn output(&self, text: &str) -> io::Result<()> {
        self.output.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push_str(text);
        Ok(())
    }

    fn message(&self, _: &str) {}

    fn is_interrupted(&self) -> bool {
        false
    }

    fn team(&self) -> Option<&Arc<dyn Team>> {
        self.team.as_ref()
    }
}

/// Runs a verb; its output, or exit code and message.
fn call(arguments: &[&str], ranks: usize) -> Result<String, (u8, String)> {
    let run = |team: Option<Arc<dyn Team>>| {
        let host = Kept { team, ..Kept::default() };
        let ended = run_verb(arguments.iter().copied(), &host)
            .map_err(|failure| (failure.code(), failure.to_string()));
        ended.map(|()| host.output.into_inner().unwrap_or_default())
    };
    if ranks == 1 {
        return run(None);
    }
    let all = Threads::run(ranks, |team| run(Some(team))).map_err(|error| (101, error.to_string()))?;
    all.into_iter().collect::<Result<Vec<String>, _>>().map(|texts| texts.concat())
}

/// Computes a choice of features with Emmy and with the reference, or sees that Emmy refuses it.
///
/// # Errors
/// The first difference, or another end than that of the table.
pub fn agrees(choice: &Choice, seed: u64) -> Result<(), String> {
    let place = Place::new();
    agrees_in(&place, choice, seed).map_err(|fault| format!("{fault} [{}; seed {seed}]", describe(choice)))
}

/// [`agrees`] in a directory.
///
/// # Errors
/// As there.
pub fn agrees_in(place: &Place, choice: &Choice, seed: u64) -> Result<(), String> {
    let case = Case::new(choice, seed);
    place.write("mesh.msh", case.mesh.text());
    let in_place = |text: &str| {
        // Directories of results are relative to the working directory.
        let own = |name: &str| format!("{:?}", place.path(name).display().to_string());
        text.replace("directory = \"run\"", &format!("directory = {}", own("run")))
            .replace("directory = \"first\"", &format!("directory = {}", own("first")))
    };
    place.write("case.toml", in_place(&case.text));
    let path = |name: &str| place.path(name).display().to_string();
    let (input, modes) = (path("case.toml"), path("modes"));
    let words = refusals(choice);
    if let Some((text, ..)) = &case.first {
        place.write("first.toml", in_place(text));
        let ended = call(&["run", &path("first.toml"), "--quiet"], 1);
        if let Err((code, message)) = ended
            && words.is_empty()
        {
            return Err(format!("the first run ends with {code}: {message}"));
        }
    }
    if case.chosen("run") == "gradient" {
        let computed = gradient(&place.path("case.toml"), &case);
        return match (computed, words.is_empty()) {
            (Err(message), false) if words.iter().any(|word| message.contains(word)) => Ok(()),
            (Err(message), false) => Err(format!("refused without any of {words:?}: {message}")),
            (Ok(_), false) => Err("not refused: it was computed".into()),
            (computed, true) => compare_gradient(choice, seed, &computed?),
        };
    }
    let ranks = if case.chosen("run") == "ranks" { 2 } else { 1 };
    let ended = if case.chosen("run") == "resumed" {
        let [part, end] = [2.0, 3.0].map(|steps| format!("{:?}", steps * case.step()));
        let first = call(&["run", &input, "--quiet", "--until", &part], 1);
        first.and_then(|_| call(&["resume", &path("run"), "--quiet", "--until", &end], 1))
    } else {
        call(&["run", &input, "--quiet"], ranks)
    };
    if !words.is_empty() {
        return match ended {
            Err((2, message)) if words.iter().any(|word| message.contains(word)) => Ok(()),
            Err((code, message)) => Err(format!("refused without any of {words:?}: {code}, {message}")),
            Ok(_) => Err("not refused: it was computed".into()),
        };
    }
    let has_collapsed =
        ended.as_ref().is_err_and(|(code, message)| *code == 3 && message.contains("inside out"));
    if let Err((code, message)) = ended
        && !has_collapsed
    {
        return Err(format!("run ends with {code}: {message}"));
    }
    let mut columns = history(&place.path("run/history.csv"))?;
    if has_collapsed {
        return compare_until_collapse(&case, &mut columns);
    }
    let rows = reference_rows(&case, &columns["time"])?;
    compare_history(&case, &columns, &rows)?;
    compare_summary(&place.path("run/summary.json"), &rows)?;
    call(&["modes", &input, "--quiet", "--output", &modes], 1)
        .map_err(|(code, message)| format!("modes ends with {code}: {message}"))?;
    compare_modes(&case, &history(&place.path("modes/modes.csv"))?, &rows[0])?;
    let report = call(&["check", &input], 1);
    let report = report.map_err(|(code, message)| format!("check ends with {code}: {message}"))?;
    compare_masses(&case, &report)
}

/// Smallest det F from which on a material without resistance to compression is about to let a cell turn inside out.
const COLLAPSE: f64 = 0.1;

/// Compares the steps before a cell turns inside out, which ends the motion.
fn compare_until_collapse(case: &Case, columns: &mut BTreeMap<String, Vec<f64>>) -> Result<(), String> {
    let determinants = columns.get("smallest_determinant").ok_or("there are no determinants")?;
    let collapse = determinants.iter().position(|det| *det < COLLAPSE);
    let collapse = collapse.ok_or(format!("a cell is turned inside out after {determinants:?}"))?;
    columns.values_mut().for_each(|column| column.truncate(collapse));
    let rows = reference_rows(case, &columns["time"])?;
    compare_history(case, columns, &rows)
}

/// Derivatives of the place and of the velocity of a node at the end by the density of the first region, and by the
/// displacement and the velocity of a node at the start.
type Derivatives = [[f64; 3]; 2];

/// Node of the goals, at the top, and their direction; all components of the start are those of this node.
const DIRECTION: [f64; 3] = [0.6, -0.8, 0.0];

/// The derivatives by the adjoint of the library.
fn gradient(path: &Path, case: &Case) -> Result<Derivatives, String> {
    let read = |set: Vec<String>| input::read(path, &Overrides { set, ..Overrides::default() });
    let problem = read(Vec::new()).map_err(|error| error.to_string())?;
    let mut motion = problem.motion(&mut []).map_err(|error| error.to_string())?;
    let mut derivatives = || -> emmy::Result<Derivatives> {
        let mut trajectory = Trajectory::new(&motion)?;
        for step in problem.plan.steps() {
            trajectory.record(&motion)?;
            motion.step_of_plan(&step)?;
        }
        trajectory.record(&motion)?;
        let node = goal_node(case);
        let density = case.density();
        let parameter = Parameter::smooth(density, density, |density| {
            let density = read(vec![format!("region.0.density={density:?}")]);
            Ok(density.expect("an input that was read before").body)
        })?;
        let goals = [
            Goal::displacement_at(&problem.body, node, DIRECTION),
            Goal::velocity_at(&problem.body, node, DIRECTION),
        ];
        let mut all = [[0.0; 3]; 2];
        for (goal, own) in goals.iter().zip(&mut all) {
            let gradient = trajectory.gradient(goal, std::slice::from_ref(&parameter))?;
            *own = [gradient.parameters[0], gradient.displacement[3 * node], gradient.velocity[3 * node + 1]];
        }
        Ok(all)
    };
    derivatives().map_err(|error| error.to_string())
}

/// A node at the top.
fn goal_node(case: &Case) -> usize {
    Mesh::nodes_of(&case.mesh.top)[1]
}

/// Compares with differences of the fourth order of motions of the reference.
fn compare_gradient(choice: &Choice, seed: u64, own: &Derivatives) -> Result<(), String> {
    let case = Case::new(choice, seed);
    let node = goal_node(&case);
    let h = case.step();
    let times = [0.0, h, 2.0 * h, 3.0 * h];
    let start = case.start()?;
    let is_equilibrium = case.chosen("start") == "equilibrium";
    let goals = |varied: &Case, state: State| -> Result<[f64; 2], String> {
        let last = varied.motion().rows(state, &times, is_equilibrium)?.pop().ok_or("no rows")?;
        let along = |field: &[f64]| dot(&field[3 * node..3 * node + 3], &DIRECTION);
        Ok([along(&last.displacement), along(&last.velocity)])
    };
    // The nodes of quadratic cells are close to each other.
    let steps = [1e-3, 1e-4, 1e-4];
    let mut expected = [[0.0; 3]; 2];
    for by in 0..3 {
        for (factor, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
            let moved = factor * steps[by];
            let values = match by {
                0 => {
                    let varied = Case::with_density(choice, seed, 1.0 + moved);
                    // A given state does not change with the parameter; an equilibrium does.
                    let state = if is_equilibrium { varied.start()? } else { start.clone() };
                    goals(&varied, state)?
                }
                _ => {
                    let mut state = start.clone();
                    match by {
                        1 => state.u[3 * node] += moved,
                        _ => state.v[3 * node + 1] += moved,
                    }
                    goals(&case, state)?
                }
            };
            let scale = if by == 0 { case.density() } else { 1.0 };
            (0..2).for_each(|goal| expected[goal][by] += weight * values[goal] / (12.0 * steps[by] * scale));
        }
    }
    if case.chosen("formulation") == "incompatible-modes" || case.chosen("material") == "fibres" {
        // The displacements of internal nodes, which are kept, are relative to the cell here, in Emmy to the origin. An
        // undeformed body is where fibres become taut: no difference is accurate there.
        expected.iter_mut().zip(own).for_each(|(expected, own)| expected[1] = own[1]);
    }
    for (goal, name) in ["displacement", "velocity"].iter().enumerate() {
        let mut kind = Kind::new(0.0);
        kind.pairs.push((
            format!("derivatives of a {name} by density, displacement, velocity"),
            own[goal].to_vec(),
            expected[goal].to_vec(),
        ));
        kind.check(1e-7)?;
    }
    Ok(())
}

/// Columns of a CSV file; an empty cell is NaN.
fn history(path: &Path) -> Result<BTreeMap<String, Vec<f64>>, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    let column = |i: usize| rows.iter().map(|row| row[i]).collect();
    Ok(names.iter().enumerate().map(|(i, name)| (name.to_string(), column(i))).collect())
}

fn reference_rows(case: &Case, times: &[f64]) -> Result<Vec<Row>, String> {
    let fault = |error: String| format!("the reference fails: {error}");
    let motion = case.motion();
    if case.chosen("run") == "static" {
        if times.len() != INCREMENTS + 1 {
            return Err(format!("{} rows of a static analysis", times.len()));
        }
        let path = motion.equilibria(&times[1..]).map_err(fault)?;
        let start = State { u: vec![0.0; 3 * case.body.n_all], v: vec![0.0; 3 * case.body.n_all] };
        let mut rows = motion.rows(start, &[0.0], false).map_err(fault)?;
        rows[0].velocity.fill(0.0);
        (rows[0].kinetic, rows[0].momenta) = (0.0, [[0.0; 3]; 2]);
        for (u, fraction) in path.into_iter().zip(&times[1..]) {
            let (strain, determinant) = case.body.energy(&u);
            let reactions = motion.static_reactions(&u, *fraction);
            rows.push(Row {
                time: *fraction,
                strain,
                determinant,
                work: strain - rows[0].strain,
                reactions,
                displacement: u,
                kinetic: 0.0,
                momenta: [[0.0; 3]; 2],
                ..rows[0].clone()
            });
        }
        return Ok(rows);
    }
    if times.len() < 4 {
        return Err(format!("{} rows", times.len()));
    }
    let is_equilibrium = case.chosen("start") == "equilibrium";
    motion.rows(case.start().map_err(fault)?, times, is_equilibrium).map_err(fault)
}

/// Numbers of one kind, with what they are compared with.
struct Kind {
    scale: f64,
    pairs: Vec<(String, Vec<f64>, Vec<f64>)>,
}

impl Kind {
    fn new(scale: f64) -> Self {
        Kind { scale, pairs: Vec::new() }
    }

    fn check(&self, tolerance: f64) -> Result<(), String> {
        let numbers = self.pairs.iter().flat_map(|(_, own, expected)| own.iter().chain(expected));
        let scale = numbers.filter(|x| x.is_finite()).fold(self.scale, |m, x| m.max(x.abs()));
        for (name, own, expected) in &self.pairs {
            if own.len() != expected.len() {
                return Err(format!("{name}: {} rows for {}", own.len(), expected.len()));
            }
            for (row, (a, b)) in own.iter().zip(expected).enumerate() {
                if a.is_nan() && b.is_nan() {
                    continue;
                }
                let difference = (a - b).abs() / scale.max(1e-300);
                // Numbers that are not finite differ.
                if difference > tolerance || difference.is_nan() {
                    return Err(format!(
                        "{name}: row {row} has {a:e}, the reference {b:e} ({difference:.1e})"
                    ));
                }
            }
        }
        Ok(())
    }
}

fn compare_history(case: &Case, columns: &BTreeMap<String, Vec<f64>>, rows: &[Row]) -> Result<(), String> {
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

fn compare_summary(path: &Path, rows: &[Row]) -> Result<(), String> {
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

/// Frequencies about the start, from the dense eigenproblem without the nodes that have no mass.
fn compare_modes(case: &Case, modes: &BTreeMap<String, Vec<f64>>, start: &Row) -> Result<(), String> {
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
    let stiffness = Motion { body: &body, ..case.motion() }.stiffness(u, has_start);
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
fn compare_masses(case: &Case, report: &str) -> Result<(), String> {
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
