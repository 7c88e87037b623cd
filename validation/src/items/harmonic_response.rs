//! Harmonic response: beams and plates of NAFEMS, and a beam in CalculiX.

use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::process::Command;

use emmy::body::{Body, FieldName, Fields, Load, Region, Support};
use emmy::material::NeoHooke;
use emmy::mesh::CellKind;
use emmy::modes::{Excitation, HarmonicResponse, ModalDamping, Mode, Quantity};

use super::Effort;
use super::locking::{Face, Grid};
use crate::case::Case;
use crate::claim::Item;
use crate::picture::{Pictures, Series};

/// Real and imaginary part.
type Complex = [f64; 2];

/// Frequencies, each with displacements of the tip along z: by the forces and by the base.
type Displacements = Vec<(f64, [Complex; 2])>;

/// Number of modes of the deck.
const N_MODES: usize = 40;

/// Frequency, and complex displacements of the tip along z by the forces and by the base, of CalculiX 2.20 with
/// `inputs/spectra/beam.inp`, the seven digits that it prints.
const CALCULIX: [(f64, Complex, Complex); 8] = [
    (5.0, [7.755323e-05, -1.397896e-06], [-1.293212e-03, 3.239149e-05]),
    (10.19532, [1.761126e-04, -1.521438e-05], [-8.920533e-04, 8.910017e-05]),
    (12.79298, [2.103297e-06, -1.5996e-03], [8.958716e-05, 6.017881e-03]),
    (12.83783, [-2.685297e-04, -1.546656e-03], [1.100183e-03, 5.778085e-03]),
    (33.59832, [-8.361671e-06, -2.42825e-07], [2.281316e-05, -3.632138e-07]),
    (75.54652, [-1.259392e-05, -3.917073e-05], [-2.57542e-05, -8.589406e-05]),
    (94.55098, [-3.654835e-06, -2.646661e-07], [-5.143081e-06, -3.114239e-07]),
    (150.0, [-3.23025e-07, -6.417139e-08], [-1.360152e-06, 8.866986e-08]),
];

/// A test of NAFEMS: its body under a load, where its results are, and these: frequency \[Hz\], displacement \[mm\]
/// and stress \[N/mm²\].
struct Nafems {
    name: &'static str,
    kind: CellKind,
    size: [f64; 3],
    cells: [usize; 3],
    /// Force per volume \[N/m³\].
    load: f64,
    supports: fn() -> Vec<Support>,
    expected: [f64; 3],
    /// Densities of displacement \[mm²/Hz\] and stress \[(N/mm²)²/Hz\] under noise of the same size.
    densities: [f64; 2],
}

/// Supports of two end faces across the beam, and of four edges of the plate within it.
fn beam() -> Vec<Support> {
    ["x-min", "x-max"].map(|group| Support::of_components(group, [false, true, true])).to_vec()
}

fn plate() -> Vec<Support> {
    let of_edges = [("x-min", [false, true, true]), ("x-max", [false, true, true])].into_iter();
    let of_others = [("y-min", [true, false, true]), ("y-max", [true, false, true])];
    of_edges.chain(of_others).map(|(group, held)| Support::of_components(group, held)).collect()
}

const NAFEMS: [Nafems; 2] = [
    Nafems {
        name: "deep beam, tests 5H and 5R",
        kind: CellKind::Hex20,
        size: [10.0, 2.0, 2.0],
        cells: [10, 2, 2],
        load: 1e6 / 4.0,
        supports: beam,
        expected: [42.65, 13.45, 241.9],
        densities: [180.9, 58516.0],
    },
    Nafems {
        name: "thin plate, tests 13H and 13R",
        kind: CellKind::Hex27,
        size: [10.0, 10.0, 0.05],
        cells: [10, 10, 1],
        load: 100.0 / 0.05,
        supports: plate,
        // The stress is that of a thin plate with this displacement, E t/(2 (1 - nu)) w pi²/a².
        expected: [2.377, 45.42, 2e5 * 50.0 / 1.4 * 45.42 * PI * PI / 1e8],
        densities: [2063.2, f64::NAN],
    },
];

/// Amplitudes of steady vibrations.
pub(super) fn harmonic_response(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "harmonic-response",
        "Harmonic response",
        "Steady vibrations by superposition of modes. J. Maguire, D. J. Dawswell, L. Gould, Selected Benchmarks for Forced Vibration, NAFEMS \
        R0016 (1989): solid cells beside beams and plates of steel, damping 2 %, the largest amplitudes near the first resonance. Noise with \
        a density of S_0 has the response |H|^2 S_0. CalculiX 2.20: a beam of steel, clamped, of 16 cells of type C3D20, 40 modes with a \
        damping of 2 %. Its dampers hold the modes to a place at rest even if the base moves, those of Emmy to the base; it leaves out the \
        inertia that the consistent mass couples to nodes of the base, and has no static correction for modes that are left out. With these \
        three the same digits follow from the modes of Emmy.",
    );
    let mut table = vec![
        ["", "frequency [Hz]", "", "displacement [mm]", "", "stress [N/mm²]", ""].map(String::from).to_vec(),
    ];
    NAFEMS.iter().try_for_each(|test| nafems(&mut item, &mut table, test))?;
    item.tables.push(table);
    let found = Beam::new()?;
    let digits = CALCULIX.map(|(f, force, base)| (f, [force, base]));
    beside(&mut item, &found, &digits, "the digits of CalculiX 2.20");
    if let Some(program) = effort.ccx {
        let all = calculix(program, &pictures.folder)?;
        beside(&mut item, &found, &all, "CalculiX on this machine");
    }
    show(&mut item, &found, pictures)?;
    item.commands.push("cargo run --release -p emmy-validation -- --only harmonic-response --ccx ccx".into());
    Ok(item)
}

fn text(error: emmy::Error) -> String {
    error.to_string()
}

fn size([re, im]: Complex) -> f64 {
    re.hypot(im)
}

/// The largest amplitudes of a test near its first resonance.
fn nafems(item: &mut Item, table: &mut Vec<Vec<String>>, test: &Nafems) -> Result<(), String> {
    let Nafems { size: [a, b, c], cells, .. } = *test;
    let map = |x: [f64; 3]| std::array::from_fn(|d| test.size[d] * x[d] / cells[d] as f64);
    let near = |x: f64, to: f64| (x - to).abs() < 1e-9 * a;
    let faces: [Face<'_>; 4] = [
        ("x-min", &|x| near(x[0], 0.0)),
        ("x-max", &|x| near(x[0], a)),
        ("y-min", &|x| near(x[1], 0.0)),
        ("y-max", &|x| near(x[1], b)),
    ];
    let mesh = Grid { kind: test.kind, n: cells, map: &map }.mesh(&faces)?;
    let steel = Region::new(NeoHooke::from_engineering(200e9, 0.3).map_err(text)?, 8000.0);
    let body = Body::builder(mesh).region(steel).load(Load::acceleration([0.0, 0.0, test.load / 8000.0]));
    let body = (test.supports)().into_iter().fold(body, |body, support| body.support(support));
    let body = body.build().map_err(text)?;
    let damping = ModalDamping::Ratios(vec![0.02]);
    let found =
        HarmonicResponse::new(&body, None, 12, &damping, &Excitation::Loads(vec![0])).map_err(text)?;
    let excited = found.modal_forces().iter().map(|force| force.abs()).enumerate();
    let first = excited.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(at, _)| at);
    let natural = found.modes()[first].frequency();
    let [node, above] =
        [[0.5 * a, 0.5 * b, 0.5 * c], [0.5 * a, 0.5 * b, c]].map(|at| body.mesh().nearest_node(at));
    let amplitude = |f: &f64| size(found.relative(TAU * f, node, Quantity::Displacement)[2]);
    let frequencies = (0..=2000).map(|i| natural * (0.95 + 5e-5 * f64::from(i)));
    let largest = frequencies.max_by(|a, b| amplitude(a).total_cmp(&amplitude(b))).unwrap_or(natural);
    let fields = Fields::new(&body);
    let nodes = fields.select_nodes(&[above as u32]);
    let change = found.stress(&fields, &nodes, FieldName::CauchyStress).map_err(text)?;
    let stress = 1e-6 * size(found.stress_amplitudes(TAU * largest, &change)[0]);
    let found = [largest, 1e3 * amplitude(&largest), stress];
    let errors = found.iter().zip(test.expected).map(|(found, expected)| (found / expected - 1.0).abs());
    let error = errors.fold(0.0, f64::max);
    item.claim(
        format!("{}: frequency, displacement and stress are within 2 % of the reference", test.name),
        format!("{:.2} %", 100.0 * error),
        error < 0.02,
    );
    let squares = test.densities.iter().zip(&found[1..]).filter(|(expected, _)| expected.is_finite());
    let error = squares.map(|(expected, found)| (found * found / expected - 1.0).abs()).fold(0.0, f64::max);
    item.claim(
        format!(
            "{}: so are the densities of the random response, within 4 %, as they are squares",
            test.name
        ),
        format!("{:.2} %", 100.0 * error),
        error < 0.04,
    );
    let cells = found
        .iter()
        .zip(test.expected)
        .flat_map(|(found, expected)| [format!("{found:.2}"), format!("{expected:.2}")]);
    table.push(std::iter::once(test.name.to_string()).chain(cells).collect());
    Ok(())
}

/// The beam of the deck under its forces, and shaken by its base.
struct Beam {
    responses: [HarmonicResponse; 2],
    tip: usize,
    /// Forces on the modes by the base in CalculiX.
    base_forces: Vec<f64>,
}

impl Beam {
    fn new() -> Result<Self, String> {
        let problem = Case::new("spectra/beam").problem()?;
        let damping = ModalDamping::Ratios(vec![0.02]);
        let response = |excitation| {
            HarmonicResponse::new(&problem.body, None, N_MODES, &damping, &excitation).map_err(text)
        };
        let responses = [response(Excitation::Loads(vec![0]))?, response(Excitation::Base([0.0, 0.0, 1.0]))?];
        let body = &problem.body;
        let moves = body.mesh().points().iter().flat_map(|point| [0.0, 0.0, f64::from(point[0] > 0.0)]);
        let moves: Vec<f64> = moves.collect();
        let mut inertia = vec![0.0; moves.len()];
        body.mass_product(&moves, &mut inertia);
        let on = |mode: &Mode| -mode.shape.iter().zip(&inertia).map(|(v, f)| v * f).sum::<f64>();
        let base_forces = responses[1].modes().iter().map(on).collect();
        Ok(Beam { tip: problem.quantities.probes[0].node, responses, base_forces })
    }

    /// Displacements of the tip along z, with the motion of the base.
    fn at(&self, f: f64) -> [Complex; 2] {
        [0, 1].map(|of| self.responses[of].absolute(TAU * f, self.tip, Quantity::Displacement)[2])
    }

    /// The same as CalculiX has them: without the static correction, with dampers between the modes and a place at
    /// rest, which a base that moves with the velocity a/(i omega) feels, and without the inertia that a consistent
    /// mass couples to the base.
    fn as_calculix(&self, f: f64) -> [Complex; 2] {
        let omega = TAU * f;
        [(0, 0.0, 0.0), (1, 1.0, -1.0 / (omega * omega))].map(|(of, of_base, base)| {
            let response = &self.responses[of];
            let forces = [response.modal_forces(), &self.base_forces][of];
            let modes = response.modes().iter().zip(response.damping_rates()).zip(forces);
            modes.fold([base, 0.0], |sum, ((mode, c), force)| {
                let v = mode.shape[3 * self.tip + 2] * force;
                let [re, im] = [mode.angular_frequency.powi(2) - omega * omega, omega * c];
                let damped = of_base * c / omega;
                let square = re * re + im * im;
                [sum[0] + v * (re - damped * im) / square, sum[1] - v * (im + damped * re) / square]
            })
        })
    }
}

/// The beam beside displacements of CalculiX, whose digits these are.
fn beside(item: &mut Item, own: &Beam, all: &[(f64, [Complex; 2])], program: &str) {
    let mut largest = [[0f64; 2]; 2];
    for (f, expected) in all {
        let (as_there, whole) = (own.as_calculix(*f), own.at(*f));
        for of in 0..2 {
            let peak = all.iter().map(|(_, own)| size(own[of])).fold(0.0, f64::max);
            let difference = |found: Complex| size([found[0] - expected[of][0], found[1] - expected[of][1]]);
            largest[of][0] = largest[of][0].max(difference(as_there[of]) / size(expected[of]));
            largest[of][1] = largest[of][1].max(difference(whole[of]) / peak);
        }
    }
    for (what, [as_there, whole]) in
        ["under forces at its end", "on a base that shakes"].into_iter().zip(largest)
    {
        item.claim(
            format!("a beam {what}: the complex displacements of {program}, with its base and without a static correction"),
            format!("largest difference {as_there:.1e} of the amplitude at {} frequencies", all.len()),
            as_there < 1e-4,
        );
        // The damping that acts on the base, too, changes the response by up to 2 zeta.
        item.claim(
            format!("a beam {what}: Emmy's own response is near to it"),
            format!("largest difference {whole:.1e} of the largest amplitude"),
            whole < 0.05,
        );
    }
}

/// Runs the deck: displacements of the tip along z by forces and by the base, at the frequencies of the program.
fn calculix(program: &Path, folder: &Path) -> Result<Displacements, String> {
    let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/spectra/beam.inp");
    let folder = folder.join("calculix");
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    std::fs::create_dir_all(&folder).map_err(failed)?;
    std::fs::copy(&deck, folder.join("beam.inp")).map_err(failed)?;
    let output = Command::new(program).arg("beam").current_dir(&folder).output();
    let output = output.map_err(|error| format!("{}: {error}", program.display()))?;
    if !output.status.success() {
        return Err(format!("{}: {}", program.display(), String::from_utf8_lossy(&output.stdout)));
    }
    let text = std::fs::read_to_string(folder.join("beam.dat")).map_err(failed)?;
    read(&text).ok_or_else(|| format!("{}: beam.dat has no displacements", folder.display()))
}

/// The printed displacements along z: of each frequency the real part, then the imaginary one, first by forces.
fn read(text: &str) -> Option<Displacements> {
    let lines: Vec<&str> = text.lines().collect();
    let mut parts = Vec::new();
    for (i, line) in lines.iter().enumerate().filter(|(_, line)| line.starts_with(" displacements")) {
        let frequency: f64 = line.split_whitespace().last()?.parse().ok()?;
        let number: f64 = lines.get(i + 2)?.split_whitespace().last()?.parse().ok()?;
        parts.push((frequency, number));
    }
    let numbers: Vec<(f64, Complex)> =
        parts.as_chunks().0.iter().map(|[re, im]| (re.0, [re.1, im.1])).collect();
    let (forces, base) = numbers.split_at(numbers.len() / 2);
    (!forces.is_empty())
        .then(|| forces.iter().zip(base).map(|((f, force), (_, base))| (*f, [*force, *base])).collect())
}

/// Amplitudes of the tip over the frequency, with the digits of CalculiX.
fn show(item: &mut Item, own: &Beam, pictures: &Pictures) -> Result<(), String> {
    let curve =
        |of: usize| (0..=1450).map(|i| 5.0 + 0.1 * f64::from(i)).map(|f| (f, size(own.at(f)[of]))).collect();
    let points =
        |of: usize| CALCULIX.iter().map(|(f, force, base)| (*f, size([*force, *base][of]))).collect();
    let series = vec![
        Series::line("by forces, Emmy", curve(0)),
        Series::line("by the base, Emmy", curve(1)),
        Series::points("by forces, CalculiX", points(0)),
        Series::points("by the base, CalculiX", points(1)),
    ];
    let axes = ["frequency [Hz]", "amplitude [m]"];
    item.pictures.push(pictures.log_y("harmonic-response", "The tip of a steel beam", axes, series)?);
    Ok(())
}
