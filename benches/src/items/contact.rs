//! `contact`: a step of two bodies that meet face to face beside the same step without contact, and what the search
//! and the pairs cost.

use std::time::Instant;

use emmy::body::LayerLaw;
use emmy::internals::average::Rule;
use emmy::internals::contact::{
    Candidates, Layer, LayerOf, Surface, SurfaceFacet, SurfaceLayer, SurfaceMemory,
};
use emmy::mesh::FacetKind;

use super::Settings;
use crate::job::Case;
use crate::outcome::median;
use crate::report::{Goal, Limit, Report, Table, number};

/// Cells along the short edges of the bars.
const CELLS: [usize; 3] = [4, 8, 12];
/// Facets along the edges of the plates.
const FACETS: [usize; 4] = [16, 32, 64, 128];
/// Steps of the bars, and the size in which a wave passes a quarter of a cell.
const STEPS: u32 = 40;
/// Limit of a step with contact over one without.
const LIMIT: f64 = 2.5;
/// Limit of the growth of the search for a point where the points are 64 times as many; their logarithm doubles.
const GROWTH: f64 = 3.0;

/// CPU time of steps with and without contact, and times of the search and of the pairs by the number of points.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    Ok(vec![steps(settings)?, search(settings)])
}

/// Two bars with some cells along their short edges, 13/3 as long.
fn bars(n: usize) -> Case {
    let length = 13.0 / 3.0;
    let bar = |name: &str, at: String| {
        let cells = format!("[{n}, {n}, {}]", (length * n as f64).round());
        format!("{{ name = \"{name}\", box = {{ size = [1.0, 1.0, {length:?}], cells = {cells} }}{at} }}")
    };
    let above = format!(", at = [0.02, 0.03, {:?}]", length + 0.006);
    let parts = format!("[{}, {}]", bar("a", String::new()), bar("b", above));
    let size = 0.0005 * 12.0 / n as f64;
    Case::contact().with("mesh.parts", parts).steps(STEPS, size)
}

fn steps(settings: &Settings) -> Result<Report, String> {
    let sizes = settings.session.choose(&CELLS[..1], &CELLS[..]);
    let stretched = "[[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.12]]";
    let vibrating = |n: usize| {
        let still = ["contact", "initial.0.velocity", "initial.1.velocity"];
        let case = still.iter().fold(bars(n), |case, key| case.with(key, ""));
        case.with("initial.0.gradient", stretched).with("initial.1.gradient", stretched)
    };
    let cases: Vec<Case> = sizes.iter().flat_map(|&n| [bars(n), vibrating(n)]).collect();
    let runs = settings.session.cases(&cases)?;
    let mut report = Report::new(
        "Contact of two bodies",
        "Two bars (`benches/contact.toml`) that meet face to face, by DGM of degree 1 in steps in which a wave passes a \
         quarter of a cell, one thread, beside the same bars that vibrate without contact: CPU seconds of a step, \
         corrections, iterations of the linear solver.",
    );
    let heading =
        ["dofs", "CPU s", "without contact", "ratio", "corrections", "without", "linear", "without"];
    let mut table = Table::new(0, &heading);
    let mut last = f64::NAN;
    for pair in runs.chunks_exact(2) {
        let [touching, alone] = [&pair[0], &pair[1]];
        last = touching.ratio(alone, |own| own.cpu_seconds);
        let seconds = [touching, alone].map(|own| own.median(|own| own.cpu_seconds) / f64::from(STEPS));
        let [with, without] = [touching, alone].map(|own| own.last());
        let counts =
            [with.newton_per_step, without.newton_per_step, with.linear_per_step, without.linear_per_step];
        let row = seconds.into_iter().chain([last]).chain(counts).map(number);
        table.push(std::iter::once(with.dofs.to_string()).chain(row).collect());
    }
    report.tables.push(table);
    report.goals.push(Goal::new("a step with contact over one without", Limit::AtMost(LIMIT), last));
    Ok(report)
}

/// Two plates of squares, n by n, above each other by a gap, the upper one shifted.
fn plates(n: usize, gap: f64) -> Surface {
    let shapes = gauss_points();
    let areas = [0.25 / (n * n) as f64; 4];
    let mut facets: Vec<([u32; 4], [[f64; 3]; 4], u32)> = Vec::new();
    for body in 0..2u32 {
        let first = body * ((n + 1) * (n + 1)) as u32;
        let node = |i: usize, j: usize| first + (i * (n + 1) + j) as u32;
        let shift = 0.3 * f64::from(body) / n as f64;
        let at = |i: usize, j: usize| {
            [i as f64 / n as f64 + shift, j as f64 / n as f64 + shift, f64::from(body) * gap]
        };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let mut corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            if body == 1 {
                corners.reverse();
            }
            facets.push((corners.map(|(i, j)| node(i, j)), corners.map(|(i, j)| at(i, j)), body));
        }
    }
    let facets: Vec<SurfaceFacet<'_>> = facets
        .iter()
        .map(|(nodes, positions, body)| SurfaceFacet {
            kind: FacetKind::Quad4,
            nodes,
            positions,
            shapes: &shapes,
            areas: &areas,
            body: *body,
        })
        .collect();
    Surface::new(&facets)
}

/// Shape functions of a square at its four Gauss points.
fn gauss_points() -> [f64; 16] {
    let (near, far) = (0.5 + 0.5 / 3f64.sqrt(), 0.5 - 0.5 / 3f64.sqrt());
    let at = |[a, b]: [f64; 2]| [a * b, (1.0 - a) * b, (1.0 - a) * (1.0 - b), a * (1.0 - b)];
    let rows = [[near, near], [far, near], [far, far], [near, far]].map(at);
    std::array::from_fn(|i| rows[i / 4][i % 4])
}

fn search(settings: &Settings) -> Report {
    let sizes = settings.session.choose(&FACETS[..2], &FACETS[..]);
    let mut report = Report::new(
        "Search and pairs of contact",
        "Two plates of squares on each other, pressed to 0.8 of the layer, all threads: nanoseconds for each point to \
         find the pairs anew, and to evaluate forces and derivatives in a step of degree 1.",
    );
    let mut table = Table::new(0, &["points", "pairs", "search, ns", "forces and derivatives, ns"]);
    let mut times = Vec::new();
    for &n in sizes {
        let layer = Layer { modulus: 1.0, thickness: 0.1 / n as f64, law: LayerLaw::Smooth };
        let layer = SurfaceLayer { surface: plates(n, 0.8 * layer.thickness), layer };
        let surface = &layer.surface;
        let rounds = settings.session.choose(1, 5);
        let reach = |of: LayerOf| layer.layer.of(of).thickness;
        let mut n_pairs = 0;
        let find = || {
            let mut candidates = Candidates::default();
            candidates.cover(surface, reach, &[&surface.positions]);
            n_pairs = candidates.pairs.len();
        };
        let search = time(rounds, find);
        let rule = Rule::discrete_gradient(1);
        let mut memory = SurfaceMemory::new(&layer, &rule);
        let mut rate = 0.0;
        let pairs = time(rounds + 1, || {
            // Other rates each time: the memory keeps what it has.
            rate += 1e-3 * layer.layer.thickness;
            let down =
                |_: usize, node: usize| [0.0, 0.0, if node < surface.nodes.len() / 2 { rate } else { 0.0 }];
            let passed = layer.evaluate(&rule, |node| surface.positions[node], down, true, &mut memory);
            assert!(passed.is_ok(), "plates stay apart");
        });
        let each = |seconds: f64| 1e9 * seconds / surface.points.len() as f64;
        times.push(each(search));
        let row = [each(search), each(pairs)].map(|own| format!("{own:.0}"));
        table.push([surface.points.len().to_string(), n_pairs.to_string()].into_iter().chain(row).collect());
    }
    report.tables.push(table);
    let growth = times[times.len() - 1] / times[0];
    let statement = "time of the search for a point, with 64 times the points over that with the fewest";
    report.goals.push(Goal::new(statement, Limit::AtMost(GROWTH), growth));
    report
}

/// Median of the seconds of some rounds.
fn time(rounds: usize, mut work: impl FnMut()) -> f64 {
    let seconds: Vec<f64> = (0..rounds)
        .map(|_| {
            let begin = Instant::now();
            work();
            begin.elapsed().as_secs_f64()
        })
        .collect();
    median(&seconds)
}
