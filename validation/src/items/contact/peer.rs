//! The thrown block in CalculiX, a program of static and dynamic finite elements.

use std::path::Path;
use std::process::Command;

use super::data::{Problem, Run};
use super::trace::Trace;
use crate::claim::Item;
use crate::picture::{Pictures, Series};

/// Values of alpha in the method of Hilber, Hughes and Taylor: no dissipation, and the default of CalculiX.
const ALPHAS: [f64; 2] = [0.0, -0.05];

/// Runs of the deck, whose automatic steps are at most as large as those of the run, beside that run with DGM.
///
/// # Errors
/// The message of a run of Emmy that fails, or of a program that cannot be run.
pub(super) fn beside(
    item: &mut Item,
    (problem, run): (&Problem, &Run),
    program: &Path,
    pictures: &Pictures,
) -> Result<(), String> {
    let run = Run { law: "linear".into(), ..run.clone() };
    let trace = Trace::of(problem, &run, &[])?;
    let start = trace.records[0].total_energy;
    let own = trace.records.iter().map(|record| (record.time, record.total_energy / start)).collect();
    let mut curves = vec![("Emmy, DGM, k = 1".to_string(), own)];
    for alpha in ALPHAS {
        let energies = energies(program, run.size, alpha, &pictures.folder)?;
        let over = energies.iter().map(|(time, energy)| (*time, energy / start)).collect();
        curves.push((format!("CalculiX, alpha = {alpha}"), over));
    }
    let header = [&problem.title, "steps", "largest change of H / H", "at the end"];
    let mut table = vec![header.map(String::from).to_vec()];
    let changes = curves.iter().map(|(_, curve): &(String, Vec<(f64, f64)>)| {
        let change = |value: f64| value - 1.0;
        let largest = curve.iter().map(|own| change(own.1).abs()).fold(0.0, f64::max);
        (largest, change(curve.last().map_or(f64::NAN, |own| own.1)))
    });
    let changes: Vec<(f64, f64)> = changes.collect();
    for ((label, curve), (largest, end)) in curves.iter().zip(&changes) {
        let steps = curve.len().saturating_sub(usize::from(curve.first().is_some_and(|own| own.0 == 0.0)));
        table.push(vec![label.clone(), steps.to_string(), format!("{largest:.1e}"), format!("{end:+.1e}")]);
    }
    item.tables.push(table);
    item.claim(
        format!("{}: H is kept to 1e-12, in no more steps than CalculiX takes", problem.title),
        format!("{:.1e}; CalculiX {:.1e} and {:.1e}", changes[0].0, changes[1].0, changes[2].0),
        changes[0].0 < 1e-12 && curves[1..].iter().all(|own| own.1.len() >= trace.forces.len()),
    );
    let series = curves.into_iter().map(|(label, curve)| Series::line(&label, curve)).collect();
    let axes = ["t", "H over that at the start"];
    item.pictures.push(pictures.linear("contact-calculix", &problem.title, axes, series)?);
    item.commands.push("ccx validation/inputs/contact/block".into());
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
