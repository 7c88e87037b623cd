//! The thrown block in CalculiX, a program of static and dynamic finite elements, and in MuJoCo, one of robotics.

use std::path::Path;
use std::process::Command;

use super::data::{Problem, Run};
use super::trace::Trace;
use crate::claim::Item;
use crate::picture::{Pictures, Series};

/// Values of alpha in the method of Hilber, Hughes and Taylor: no dissipation, and the default of CalculiX.
const ALPHAS: [f64; 2] = [0.0, -0.05];

/// Integrators of MuJoCo that take deformable bodies.
const INTEGRATORS: [&str; 3] = ["Euler", "RK4", "discrete"];

/// Energies over time.
type Curve = Vec<(f64, f64)>;

/// Runs of the deck, whose automatic steps are at most as large as those of the run, beside that run with DGM.
///
/// # Errors
/// The message of a run of Emmy that fails, or of a program that cannot be run.
pub(super) fn calculix(
    item: &mut Item,
    (problem, run): (&Problem, &Run),
    program: &Path,
    pictures: &Pictures,
) -> Result<(), String> {
    let own = energy_of_emmy(problem, run)?;
    let start = own[0].1;
    let mut others = Vec::new();
    for alpha in ALPHAS {
        // The energies of a deck begin after the first step, so that of Emmy is the start of both.
        let energies = energies(program, run.size, alpha, &pictures.folder)?;
        others.push((format!("CalculiX, alpha = {alpha}"), over(start, energies)));
    }
    item.commands.push("ccx validation/inputs/contact/block".into());
    compare(item, (problem, "CalculiX"), own, others, pictures)
}

/// The block as a flex of MuJoCo, in steps of the size of the run, beside that run with DGM. Each energy is over its
/// own start: the lumped mass of the flex has 1.137 times that of Emmy's block.
///
/// # Errors
/// The message of a run of Emmy that fails, or of a program that cannot be run.
pub(super) fn mujoco(
    item: &mut Item,
    (problem, run): (&Problem, &Run),
    python: &Path,
    pictures: &Pictures,
) -> Result<(), String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/mujoco_block.py");
    let mut others = Vec::new();
    for integrator in INTEGRATORS {
        let size = run.size.to_string();
        let output = Command::new(python).arg(&script).args([integrator, &size]).output();
        let output = output.map_err(|error| format!("{}: {error}", python.display()))?;
        if !output.status.success() {
            return Err(format!("{}: {}", script.display(), String::from_utf8_lossy(&output.stderr)));
        }
        let text = String::from_utf8_lossy(&output.stdout);
        let line = |line: &str| -> Option<(f64, f64)> {
            let (time, energy) = line.split_once(',')?;
            Some((time.parse().ok()?, energy.parse().ok()?))
        };
        let curve: Curve = text.lines().filter_map(line).collect();
        let start = curve.first().ok_or("MuJoCo printed no energies")?.1;
        others.push((format!("MuJoCo, {integrator}"), over(start, curve)));
    }
    item.commands.push(format!("python validation/peers/mujoco_block.py RK4 {}", run.size));
    compare(item, (problem, "MuJoCo"), energy_of_emmy(problem, run)?, others, pictures)
}

/// The energy of the run with a linear law, which the other programs have.
fn energy_of_emmy(problem: &Problem, run: &Run) -> Result<Curve, String> {
    let run = Run { law: "linear".into(), ..run.clone() };
    let trace = Trace::of(problem, &run, &[])?;
    Ok(trace.records.iter().map(|record| (record.time, record.total_energy)).collect())
}

fn over(start: f64, curve: Curve) -> Curve {
    curve.into_iter().map(|(time, energy)| (time, energy / start)).collect()
}

/// Table, claim and picture of the energies of another program beside those of Emmy.
fn compare(
    item: &mut Item,
    (problem, program): (&Problem, &str),
    own: Curve,
    others: Vec<(String, Curve)>,
    pictures: &Pictures,
) -> Result<(), String> {
    let n_steps = own.len() - 1;
    let mut curves = vec![("Emmy, DGM, k = 1".to_string(), over(own[0].1, own))];
    curves.extend(others);
    let header = [&problem.title, "steps", "largest change of H / H", "at the end"];
    let mut table = vec![header.map(String::from).to_vec()];
    let changes = curves.iter().map(|(_, curve)| {
        let largest = curve.iter().map(|own| (own.1 - 1.0).abs()).fold(0.0, f64::max);
        (largest, curve.last().map_or(f64::NAN, |own| own.1) - 1.0)
    });
    let changes: Vec<(f64, f64)> = changes.collect();
    let steps = |curve: &Curve| curve.iter().filter(|(time, _)| *time > 0.0).count();
    for ((label, curve), (largest, end)) in curves.iter().zip(&changes) {
        let row = [steps(curve).to_string(), format!("{largest:.1e}"), format!("{end:+.1e}")];
        table.push(std::iter::once(label.clone()).chain(row).collect());
    }
    item.tables.push(table);
    let theirs: Vec<String> = changes[1..].iter().map(|own| format!("{:.1e}", own.0)).collect();
    item.claim(
        format!("{}: H is kept to 1e-12, in no more steps than {program} takes", problem.title),
        format!("{:.1e}; {program} {}", changes[0].0, theirs.join(", ")),
        changes[0].0 < 1e-12 && curves[1..].iter().all(|(_, curve)| steps(curve) >= n_steps),
    );
    let series = curves.into_iter().map(|(label, curve)| Series::line(&label, curve)).collect();
    let axes = ["t", "H over that at the start"];
    let stem = format!("contact-{}", program.to_lowercase());
    item.pictures.push(pictures.linear(&stem, &problem.title, axes, series)?);
    Ok(())
}

/// Kinetic, strain and contact energy at the ends of the steps of CalculiX.
fn energies(program: &Path, size: f64, alpha: f64, folder: &Path) -> Result<Vec<(f64, f64)>, String> {
    let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/contact/block.inp");
    let text = std::fs::read_to_string(&deck).map_err(|error| format!("{}: {error}", deck.display()))?;
    let text = text.replace("ALPHA=0.0", &format!("ALPHA={alpha:?}"));
    let text = text.replace("0.005, 0.24, 1e-7, 0.005", &format!("{size}, 0.24, 1e-7, {size}"));
    let folder = folder.join("calculix");
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    std::fs::create_dir_all(&folder).map_err(failed)?;
    std::fs::write(folder.join("block.inp"), text).map_err(failed)?;
    let output = Command::new(program).arg("block").current_dir(&folder).output();
    let output = output.map_err(|error| format!("{}: {error}", program.display()))?;
    if !output.status.success() {
        return Err(format!("{}: {}", program.display(), String::from_utf8_lossy(&output.stdout)));
    }
    let text = std::fs::read_to_string(folder.join("block.dat")).map_err(failed)?;
    read(&text).ok_or_else(|| format!("{}: block.dat has no energies", folder.display()))
}

/// The sums of the energies in a printed file: each has a title that ends with its time, and a number two lines below.
fn read(text: &str) -> Option<Vec<(f64, f64)>> {
    let lines: Vec<&str> = text.lines().collect();
    let mut sums: Vec<(f64, f64)> = Vec::new();
    for (i, line) in lines.iter().enumerate().filter(|(_, line)| line.contains(" energy for ")) {
        let time: f64 = line.split_whitespace().last()?.parse().ok()?;
        let energy: f64 = lines.get(i + 2)?.trim().parse().ok()?;
        match sums.last_mut() {
            Some(last) if last.0 == time => last.1 += energy,
            _ => sums.push((time, energy)),
        }
    }
    Some(sums).filter(|sums| !sums.is_empty())
}
