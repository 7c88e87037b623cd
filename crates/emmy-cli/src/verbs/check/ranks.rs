//! Report on the division of a body among the ranks of a team.

use emmy::team::Subdomain;
use emmy_io::input::Problem;

use super::Report;

/// Smallest and largest numbers over all ranks: a call of all of them.
fn range(part: &Subdomain, own: usize) -> [usize; 2] {
    let mut range = [-(own as f64), own as f64];
    part.largest("range", &mut range);
    [-range[0] as usize, range[1] as usize]
}

/// The lines on the ranks; a call of all of them.
pub(super) fn report(problem: &Problem) -> String {
    let part = problem.body.ranks();
    if part.size() == 1 {
        return String::new();
    }
    let n_guests = part.nodes().len() - part.n_own();
    let (own, guests) = (range(part, part.n_own()), range(part, n_guests));
    let neighbours = range(part, part.neighbours().count());
    let mut cells =
        [part.cells().len() as f64, part.counts().iter().filter(|counts| **counts).count() as f64];
    part.sum("cells", &mut cells);
    let again = 100.0 * (cells[0] / cells[1] - 1.0);
    let mut report = Report::default();
    report.line("ranks", &part.size().to_string());
    report.line("of a rank", &format!("{} nodes, and {} of others", text(own), text(guests)));
    report.line("neighbours", &text(neighbours));
    report.line("cells", &format!("{again:.1} % are computed more than once"));
    report.text
}

fn text([least, most]: [usize; 2]) -> String {
    if least == most { most.to_string() } else { format!("{least} to {most}") }
}
