//! The table of results.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::attack::{Finding, Report};

/// Number of findings of one kind that are shown.
const SHOWN: usize = 3;

/// Trials and findings.
pub fn of(reports: &[Report]) -> String {
    let mut text = format!("{:<14} {:>10} {:>6}  tried\n", "attack", "trials", "found");
    for report in reports {
        let trials = match report.trials {
            (done, Some(all)) if done < all => format!("{done}/{all}"),
            (done, _) => done.to_string(),
        };
        let (attack, found) = (report.attack, report.findings.len());
        let _ = writeln!(text, "{:<14} {trials:>10} {found:>6}  {}", attack.name, attack.what);
    }
    for report in reports.iter().filter(|report| !report.findings.is_empty()) {
        for (kind, findings) in kinds(&report.findings) {
            let _ = writeln!(text, "\n{} times in {}: {kind}", findings.len(), report.attack.name);
            for finding in findings.into_iter().take(SHOWN) {
                let again =
                    format!("emmy-attack {} --seed {} --trials 1", report.attack.name, finding.number);
                let _ = writeln!(text, "  {again}\n  {}\n  {}", finding.kept.display(), finding.fault);
            }
        }
    }
    text
}

/// Findings grouped by the text before the first colon.
fn kinds(findings: &[Finding]) -> BTreeMap<&str, Vec<&Finding>> {
    let mut kinds: BTreeMap<&str, Vec<&Finding>> = BTreeMap::new();
    for finding in findings {
        let kind = finding.fault.split(':').next().unwrap_or_default();
        kinds.entry(kind).or_default().push(finding);
    }
    kinds
}
