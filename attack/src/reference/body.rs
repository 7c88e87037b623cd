//! The body: energies, forces of time elements and of single configurations, masses and loads.

use super::cells::Kind;
use super::energies::{Energy, Measure, Tensor};
use super::mesh::{Item, Mesh};
use super::numbers::{
    Matrix, cofactor, contract, cross, determinant, dot, gauss, lagrange, lagrange_integral, plus, product,
    transpose,
};

const UNIT: Tensor = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A function of time.
#[derive(Debug, Clone, PartialEq)]
pub enum History {
    /// 1.
    Constant,
    /// Linear between entries, constant outside.
    Table(Vec<[f64; 2]>),
    /// `factor sin(rate t + phase)`.
    Sine {
        /// Amplitude.
        factor: f64,
        /// Angular frequency.
        rate: f64,
        /// Phase.
        phase: f64,
    },
    /// Double integral of a table, from rest at 0.
    Integrated(Vec<[f64; 2]>),
    /// `factor t^2`.
    Square(f64),
}

impl History {
    /// As Emmy's input has it.
    pub fn text(&self) -> String {
        match self {
            History::Constant => "1".into(),
            History::Table(rows) => format!("{rows:?}"),
            History::Sine { factor, rate, phase } => format!("\"{factor:?}*sin({rate:?}*t + {phase:?})\""),
            History::Integrated(rows) => format!("{rows:?}"),
            History::Square(factor) => format!("\"{factor:?}*t^2\""),
        }
    }

    /// The value; at a jump that after it.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            History::Constant => 1.0,
            History::Sine { factor, rate, phase } => factor * (rate * t + phase).sin(),
            History::Integrated(rows) => integral(rows, t, |s| t - s),
            History::Square(factor) => factor * t * t,
            History::Table(rows) => {
                let after = rows.iter().position(|row| row[0] > t);
                match after {
                    Some(0) => rows[0][1],
                    None => rows[rows.len() - 1][1],
                    Some(i) => {
                        let [[t0, y0], [t1, y1]] = [rows[i - 1], rows[i]];
                        y0 + (y1 - y0) * (t - t0) / (t1 - t0)
                    }
                }
            }
        }
    }

    /// The rate on one side of a time.
    pub fn rate(&self, t: f64, is_before: bool) -> f64 {
        match self {
            History::Constant => 0.0,
            History::Sine { factor, rate, phase } => factor * rate * (rate * t + phase).cos(),
            History::Integrated(rows) => integral(rows, t, |_| 1.0),
            History::Square(factor) => 2.0 * factor * t,
            History::Table(rows) => {
                // The end of a step, which is its start and its size, may lie beside the kink by a rounding.
                let t = rows.iter().map(|row| row[0]).find(|kink| (kink - t).abs() < 1e-13).unwrap_or(t);
                let covers = |pair: &&[[f64; 2]]| match is_before {
                    true => pair[0][0] < t && t <= pair[1][0],
                    false => pair[0][0] <= t && t < pair[1][0],
                };
                let slope = |pair: &[[f64; 2]]| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]);
                rows.windows(2).find(covers).map_or(0.0, slope)
            }
        }
    }

    /// Times at which it has kinks or jumps.
    pub fn kinks(&self) -> Vec<f64> {
        match self {
            History::Table(rows) | History::Integrated(rows) => rows.iter().map(|row| row[0]).collect(),
            _ => Vec::new(),
        }
    }
}

/// Integral of a table with a weight, from 0 to a time.
fn integral(rows: &[[f64; 2]], t: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let table = History::Table(rows.to_vec());
    let sum = pieces(0.0, t.max(1e-300), &table.kinks()).into_iter();
    sum.map(|(a, w)| w * t * table.at(a * t) * weight(a * t)).sum()
}

/// Fractions of a step with weights, for a function that is smooth between kinks.
pub fn pieces(t: f64, h: f64, kinks: &[f64]) -> Vec<(f64, f64)> {
    let inside = kinks.iter().map(|kink| (kink - t) / h).filter(|a| *a > 1e-12 && *a < 1.0 - 1e-12);
    let mut ends: Vec<f64> = [0.0, 1.0].into_iter().chain(inside).collect();
    ends.sort_by(f64::total_cmp);
    let piece = |pair: &[f64]| {
        let (start, length) = (pair[0], pair[1] - pair[0]);
        gauss(14).into_iter().map(move |(a, w)| (start + length * a, length * w)).collect::<Vec<_>>()
    };
    ends.windows(2).flat_map(piece).collect()
}

/// A dead load: nodal forces with a factor over time.
#[derive(Debug, Clone)]
pub struct Dead {
    /// Force at each degree of freedom, at points of the body with their own function of time if it is a wave.
    pub parts: Vec<(Vec<f64>, Wave)>,
    /// Factor over time.
    pub history: History,
}

/// Factor `cos(phase + rate t)` of a part of a load.
#[derive(Debug, Clone, Copy)]
pub struct Wave {
    /// Phase.
    pub phase: f64,
    /// Angular frequency.
    pub rate: f64,
}

/// A wave that is 1.
pub const STEADY: Wave = Wave { phase: 0.0, rate: 0.0 };

impl Dead {
    /// The force at a time; `is_before`: before a jump.
    pub fn at(&self, t: f64, is_before: bool) -> Vec<f64> {
        let t_side = if is_before { t - 1e-12 } else { t };
        let factor = self.history.at(t_side);
        let mut force = vec![0.0; self.parts[0].0.len()];
        for (part, wave) in &self.parts {
            let own = factor * (wave.phase + wave.rate * t).cos();
            force.iter_mut().zip(part).for_each(|(sum, f)| *sum += own * f);
        }
        force
    }
}

/// Attraction of nodes to a point.
#[derive(Debug, Clone)]
pub struct Attraction {
    /// The point.
    pub centre: [f64; 3],
    /// Strength times mass of each node.
    pub strengths: Vec<f64>,
}

/// A point of a cell.
#[derive(Debug, Clone)]
struct Point {
    weight: f64,
    gradients: Vec<[f64; 3]>,
}

/// A cell of the body.
#[derive(Debug, Clone)]
pub struct Cell {
    /// Nodes, then internal ones.
    nodes: Vec<usize>,
    points: Vec<Point>,
    /// Projection of a field at the points.
    projection: Option<Matrix>,
    /// Part of the volume's energy that stays at the points.
    share: f64,
    material: Material,
    /// Whether it is in the group `two`.
    pub is_second: bool,
    /// Points of the mass: weight times density, and shape functions.
    mass_points: Vec<(f64, Vec<f64>)>,
    /// Functions of the lumped mass at the same points: shape functions, or their scaled squares in quadratic cells.
    lumped_shapes: Vec<Vec<f64>>,
}

/// Formulation of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Formulation {
    /// As it is.
    Standard,
    /// Constant pressure.
    Constant,
    /// Linear pressure.
    Linear,
    /// Incompatible modes.
    Modes,
}

/// Material of a region.
#[derive(Debug, Clone)]
pub struct Material {
    /// Energy.
    pub energy: Energy,
    /// Density.
    pub density: f64,
    /// Viscosity: time, shear, bulk.
    pub viscosity: [f64; 3],
    /// Formulation.
    pub formulation: Formulation,
}

/// How a time element averages forces.
#[derive(Debug, Clone)]
pub enum Average {
    /// At points of the step.
    Points(Vec<(f64, f64)>),
    /// Assumed strain, with a number of inner points.
    Assumed(usize),
    /// Discrete gradient.
    Gradient,
}

/// A time element.
#[derive(Debug, Clone)]
pub struct Element {
    /// Gauss points.
    pub c: Vec<f64>,
    /// Weights.
    pub b: Vec<f64>,
    /// Integrals of the Lagrange polynomials up to the points.
    pub a: Matrix,
    /// Averages of forces.
    pub average: Average,
    /// `(beta, p_i)` of numerical dissipation.
    pub dissipation: Option<(f64, Vec<f64>)>,
}

impl Element {
    /// The element of a degree.
    pub fn new(degree: usize, average: Average, spectral_radius: Option<f64>) -> Self {
        let (c, b): (Vec<f64>, Vec<f64>) = gauss(degree).into_iter().unzip();
        let a = c.iter().map(|&x| (0..degree).map(|j| lagrange_integral(&c, j, x)).collect()).collect();
        let root = ((2 * degree - 1) as f64).sqrt();
        let polynomial = |x: f64| match degree {
            1 => 1.0,
            2 => root * (2.0 * x - 1.0),
            _ => root * (6.0 * x * x - 6.0 * x + 1.0),
        };
        let dissipation = spectral_radius.map(|rho| {
            let chi = (1.0 - rho) / (1.0 + rho);
            (chi / (2 * (2 * degree - 1)) as f64, c.iter().map(|&x| polynomial(x)).collect())
        });
        Element { c, b, a, average, dissipation }
    }

    /// Lagrange polynomial i over its weight.
    fn weighted(&self, i: usize, alpha: f64) -> f64 {
        lagrange(&self.c, i, alpha) / self.b[i]
    }

    /// A path at a fraction of the step.
    pub fn path(&self, start: &[f64], rates: &[Vec<f64>], alpha: f64) -> Vec<f64> {
        let mut at = start.to_vec();
        for (j, rate) in rates.iter().enumerate() {
            let integral = lagrange_integral(&self.c, j, alpha);
            at.iter_mut().zip(rate).for_each(|(sum, x)| *sum += integral * x);
        }
        at
    }
}

/// Forces of a step.
#[derive(Debug, Clone)]
pub struct StageForces {
    /// Forces of cells, springs and attractions at each stage.
    pub internal: Vec<Vec<f64>>,
    /// The part of springs.
    pub springs: Vec<Vec<f64>>,
    /// The part of attractions.
    pub attraction: Vec<Vec<f64>>,
    /// Energy that viscosity and the dissipation of strains take.
    pub dissipated: f64,
}

/// A body.
#[derive(Debug, Clone)]
pub struct Body {
    /// Reference positions of the nodes.
    pub points: Vec<[f64; 3]>,
    /// Number of nodes with internal ones.
    pub n_all: usize,
    /// Whether it is plane.
    pub is_plane: bool,
    /// Thickness of a plane body.
    pub thickness: f64,
    /// Cells.
    pub cells: Vec<Cell>,
    /// Consistent mass, with point masses.
    pub mass: Matrix,
    /// Lumped mass, with point masses.
    pub lumped: Vec<f64>,
    /// Rate of the drag.
    pub drag: f64,
    /// Springs to the ground: matrices between nodes.
    pub springs: Vec<(usize, usize, f64)>,
    /// Attraction to a point.
    pub attraction: Option<Attraction>,
    /// Dead loads.
    pub dead: Vec<Dead>,
    /// Pressure with its history on facets.
    pub pressure: Option<(Vec<Item>, f64, History)>,
}

/// Gradients of shape functions and the volume of a point, from nodes and duals.
fn gradients(kind: Kind, nodes: &[[f64; 3]], at: [f64; 3]) -> (Vec<[f64; 3]>, Tensor, f64) {
    let shapes = kind.shapes(at);
    let mut jacobian = [[0.0; 3]; 3];
    for (shape, node) in shapes.iter().zip(nodes) {
        (0..3).for_each(|i| (0..3).for_each(|j| jacobian[i][j] += node[i] * shape.by[j]));
    }
    if kind.dimension() == 2 {
        jacobian[2][2] = 1.0;
    }
    let volume = determinant(&jacobian);
    let inverse_transpose = cofactor(&jacobian).map(|row| row.map(|x| x / volume));
    let gradient = |by: [f64; 6]| std::array::from_fn(|i| dot(&inverse_transpose[i], &by[..3]));
    (shapes.iter().map(|shape| gradient(shape.by)).collect(), jacobian, volume)
}

fn strain_rate(f: &Tensor, rate: &Tensor) -> Tensor {
    let c = product(&transpose(f), rate);
    std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (c[i][j] + c[j][i])))
}

impl Cell {
    fn new(item: &Item, mesh: &Mesh, material: &Material, internal: usize, is_second: bool) -> Self {
        let own: Vec<[f64; 3]> = item.nodes.iter().map(|&node| mesh.points[node]).collect();
        let (kind, mut nodes) = (item.kind, item.nodes.clone());
        let rule = kind.strain_rule();
        let n_modes = match material.formulation {
            Formulation::Modes => kind.dimension(),
            _ => 0,
        };
        nodes.extend(internal..internal + n_modes);
        let (_, middle, middle_volume) = gradients(kind, &own, kind.middle());
        let middle_inverse = cofactor(&middle).map(|row| row.map(|x| x / middle_volume));
        let mut places = Vec::new();
        let mut all = Vec::new();
        for (at, weight) in rule {
            let (mut own_gradients, _, volume) = gradients(kind, &own, at);
            for m in 0..n_modes {
                let factor = middle_volume / volume * at[m];
                own_gradients.push(std::array::from_fn(|i| factor * middle_inverse[i][m]));
            }
            let mut place = [0.0; 3];
            for (shape, node) in kind.shapes(at).iter().zip(&own) {
                (0..3).for_each(|d| place[d] += shape.value * node[d]);
            }
            places.push(place);
            all.push(Point { weight: weight * volume * mesh.thickness, gradients: own_gradients });
        }
        let functions = match material.formulation {
            Formulation::Constant => 1,
            Formulation::Linear => 1 + kind.dimension(),
            _ => 0,
        };
        let projection = (functions > 0).then(|| projection(&all, &places, functions));
        let is_tet10 = kind == Kind::Tet10 && functions > 0;
        let share = match material.energy {
            Energy::MooneyRivlin { c10, c01, bulk } if is_tet10 => 4.0 / 3.0 * (c10 + c01) / bulk,
            Energy::Formula { c, bulk, .. } if is_tet10 => 4.0 / 3.0 * c / bulk,
            Energy::Fibres { mu, bulk, .. } if is_tet10 => 2.0 / 3.0 * mu / bulk,
            _ => 0.0,
        };
        let mass_point = |(at, weight): ([f64; 3], f64)| {
            let (_, _, volume) = gradients(kind, &own, at);
            (
                material.density * weight * volume * mesh.thickness,
                kind.shapes(at).iter().map(|shape| shape.value).collect(),
            )
        };
        let mass_points: Vec<(f64, Vec<f64>)> = kind.mass_rule().into_iter().map(mass_point).collect();
        let total: f64 = mass_points.iter().map(|point| point.0).sum();
        let squares: f64 = mass_points.iter().map(|(weight, shapes)| weight * dot(shapes, shapes)).sum();
        let lumped = |(_, shapes): &(f64, Vec<f64>)| match kind.middles().is_empty() {
            true => shapes.clone(),
            false => shapes.iter().map(|shape| shape * shape * total / squares).collect(),
        };
        let lumped_shapes = mass_points.iter().map(lumped).collect();
        let material = material.clone();
        Cell { nodes, points: all, projection, share, material, is_second, mass_points, lumped_shapes }
    }

    /// Points of the mass with the functions by which loads act on it.
    fn load_points(&self, is_lumped: bool) -> impl Iterator<Item = (f64, &Vec<f64>, &Vec<f64>)> {
        let points = self.mass_points.iter().zip(&self.lumped_shapes);
        points
            .map(move |((weight, shapes), lumped)| (*weight, shapes, if is_lumped { lumped } else { shapes }))
    }

    /// Masses with their places.
    pub fn mass_places(&self, points: &[[f64; 3]]) -> Vec<(f64, [f64; 3])> {
        let place = |shapes: &[f64]| {
            std::array::from_fn(|d| {
                shapes.iter().zip(&self.nodes).map(|(s, &node)| s * points[node][d]).sum()
            })
        };
        self.mass_points.iter().map(|(weight, shapes)| (*weight, place(shapes))).collect()
    }

    /// Its volume by the rule of the mass.
    pub fn mass_volume(&self) -> f64 {
        self.mass_points.iter().map(|point| point.0).sum::<f64>() / self.material.density
    }

    /// Its volume by the rule of the strain energy.
    pub fn volume(&self) -> f64 {
        self.points.iter().map(|point| point.weight).sum()
    }

    fn sum(&self, point: &Point, field: &[f64]) -> Tensor {
        let mut sum = [[0.0; 3]; 3];
        for (&node, gradient) in self.nodes.iter().zip(&point.gradients) {
            (0..3).for_each(|i| (0..3).for_each(|j| sum[i][j] += field[3 * node + i] * gradient[j]));
        }
        sum
    }

    fn deformation(&self, point: &Point, displacement: &[f64]) -> Tensor {
        plus(&self.sum(point, displacement), 1.0, &UNIT)
    }

    fn add_force(&self, point: &Point, stress: &Tensor, force: &mut [f64]) {
        for (&node, gradient) in self.nodes.iter().zip(&point.gradients) {
            (0..3).for_each(|i| force[3 * node + i] += point.weight * dot(&stress[i], gradient));
        }
    }

    fn project(&self, field: &[f64]) -> Option<Vec<f64>> {
        let projection = self.projection.as_ref()?;
        Some(projection.iter().map(|row| dot(row, field)).collect())
    }

    /// Energy and stress of the part at a point.
    fn local(&self, c: &Tensor) -> (f64, Tensor) {
        let energy = &self.material.energy;
        if self.projection.is_none() {
            return energy.at(c, false);
        }
        let (rest, stress) = energy.at(c, true);
        if self.share == 0.0 {
            return (rest, stress);
        }
        let (whole, whole_stress) = energy.at(c, false);
        let volume = plus(&whole_stress, -1.0, &stress);
        (rest + self.share * (whole - rest), plus(&stress, self.share, &volume))
    }

    fn volume_energy(&self, theta: f64) -> (f64, f64) {
        let (value, rate) = self.material.energy.volume_energy(theta);
        ((1.0 - self.share) * value, (1.0 - self.share) * rate)
    }

    /// Measure of volume at a strain, and its derivative by C.
    fn measure(&self, c: &Tensor) -> (f64, Tensor) {
        match self.material.energy.measure() {
            Measure::Ratio => {
                let ratio = determinant(c).sqrt();
                (ratio - 1.0, cofactor(c).map(|row| row.map(|x| 0.5 * x / ratio)))
            }
            Measure::Trace => {
                (0.5 * (c[0][0] + c[1][1] + c[2][2] - 3.0), UNIT.map(|row| row.map(|x| 0.5 * x)))
            }
        }
    }

    /// Energy per volume and S at every point, and det F.
    pub fn state(&self, displacement: &[f64]) -> Vec<PointState> {
        let fs: Vec<Tensor> = self.points.iter().map(|point| self.deformation(point, displacement)).collect();
        let cs: Vec<Tensor> = fs.iter().map(|f| product(&transpose(f), f)).collect();
        let measures: Vec<(f64, Tensor)> = cs.iter().map(|c| self.measure(c)).collect();
        let volumes: Vec<f64> = measures.iter().map(|measure| measure.0).collect();
        let energies = self.project(&volumes).map(|projected| {
            let energies: Vec<(f64, f64)> =
                projected.iter().map(|&theta| self.volume_energy(theta)).collect();
            let rates: Vec<f64> = energies.iter().map(|energy| energy.1).collect();
            (energies, self.project(&rates).unwrap_or_default())
        });
        let state = |q: usize| {
            let (mut energy, mut stress) = self.local(&cs[q]);
            let ratio = determinant(&fs[q]);
            if let Some((energies, pressures)) = &energies {
                energy += energies[q].0;
                stress = plus(&stress, 2.0 * pressures[q], &measures[q].1);
            }
            PointState { weight: self.points[q].weight, f: fs[q], energy, stress, ratio }
        };
        (0..fs.len()).map(state).collect()
    }

    /// Mean of density times v^2/2 and its integral.
    pub fn kinetic_energy(&self, velocity: &[f64]) -> f64 {
        let square = |shapes: &[f64]| {
            let v: [f64; 3] = std::array::from_fn(|d| {
                shapes.iter().zip(&self.nodes).map(|(shape, node)| shape * velocity[3 * node + d]).sum()
            });
            dot(&v, &v)
        };
        self.mass_points.iter().map(|(weight, shapes)| 0.5 * weight * square(shapes)).sum()
    }

    /// Averages of S over a step for the assumed strain.
    fn assumed(&self, element: &Element, displacement: &[f64], rates: &[Vec<f64>]) -> Vec<Vec<Averaged>> {
        let k = element.c.len();
        let starts: Vec<Tensor> =
            self.points.iter().map(|point| self.deformation(point, displacement)).collect();
        let paths: Vec<Path> = self
            .points
            .iter()
            .zip(&starts)
            .map(|(point, f)| self.strain_path(element, point, f, rates))
            .collect();
        let mut all: Vec<Vec<Averaged>> = Vec::new();
        for path in &paths {
            let stresses = self.stresses(element, path);
            let averaged = |i: usize| Averaged {
                f: path.f[i],
                strain_rate: path.rates[i],
                stress: stresses[i],
                volume: None,
            };
            all.push((0..k).map(averaged).collect());
        }
        if self.projection.is_some() {
            self.add_pressures(element, &paths, &mut all);
        }
        all
    }

    fn strain_path(&self, element: &Element, point: &Point, start: &Tensor, rates: &[Vec<f64>]) -> Path {
        let k = element.c.len();
        let f_rates: Vec<Tensor> = rates.iter().map(|rate| self.sum(point, rate)).collect();
        let at = |i: usize| (0..k).fold(*start, |f, j| plus(&f, element.a[i][j], &f_rates[j]));
        let f: Vec<Tensor> = (0..k).map(at).collect();
        let rates: Vec<Tensor> = (0..k).map(|i| strain_rate(&f[i], &f_rates[i])).collect();
        Path { start: product(&transpose(start), start), f, rates }
    }

    /// S of the part at the points.
    fn stresses(&self, element: &Element, path: &Path) -> Vec<Tensor> {
        let k = element.c.len();
        let along = |alpha: f64| self.local(&path.strain(element, alpha)).1;
        match element.average {
            Average::Assumed(n) => {
                let mut stresses = vec![[[0.0; 3]; 3]; k];
                for (alpha, w) in gauss(n) {
                    let stress = along(alpha);
                    for (i, sum) in stresses.iter_mut().enumerate() {
                        *sum = plus(sum, w * element.weighted(i, alpha), &stress);
                    }
                }
                stresses
            }
            _ => {
                let mut stresses: Vec<Tensor> = element.c.iter().map(|&c| along(c)).collect();
                let power = |alpha: f64, stress: &Tensor| {
                    let rate = (0..k).fold([[0.0; 3]; 3], |sum, j| {
                        plus(&sum, lagrange(&element.c, j, alpha), &path.rates[j])
                    });
                    contract(stress, &rate)
                };
                // A fine rule along the path loses no digits where the strain hardly changes.
                let mut gain: f64 = gauss(12).iter().map(|&(alpha, w)| w * power(alpha, &along(alpha))).sum();
                let exact = self.local(&path.strain(element, 1.0)).0 - self.local(&path.start).0;
                if (exact - gain).abs() > 1e-9 * exact.abs() {
                    gain = exact;
                }
                let seen: f64 = (0..k).map(|j| element.b[j] * contract(&stresses[j], &path.rates[j])).sum();
                let square: f64 =
                    (0..k).map(|j| element.b[j] * contract(&path.rates[j], &path.rates[j])).sum();
                let r = if square > 1e-28 { (gain - seen) / square } else { 0.0 };
                stresses.iter_mut().zip(&path.rates).for_each(|(s, rate)| *s = plus(s, r, rate));
                stresses
            }
        }
    }

    /// Adds the averages of the projected pressures: C, det C, J, their projection, the energy of it.
    fn add_pressures(&self, element: &Element, paths: &[Path], all: &mut [Vec<Averaged>]) {
        let k = element.c.len();
        let integral = |i: usize, alpha: f64| lagrange_integral(&element.c, i, alpha);
        let volumes: Vec<(f64, Vec<f64>, Vec<Tensor>)> =
            paths.iter().map(|path| self.volume_path(element, path)).collect();
        let starts: Vec<f64> = volumes.iter().map(|volume| volume.0).collect();
        let starts = self.project(&starts).unwrap_or_default();
        let rates: Vec<Vec<f64>> = (0..k)
            .map(|i| self.project(&volumes.iter().map(|volume| volume.1[i]).collect::<Vec<_>>()))
            .map(Option::unwrap_or_default)
            .collect();
        let mut pressures = vec![vec![0.0; paths.len()]; k];
        for q in 0..paths.len() {
            let theta =
                |alpha: f64| starts[q] + (0..k).map(|j| integral(j, alpha) * rates[j][q]).sum::<f64>();
            let pressure = |alpha: f64| self.volume_energy(theta(alpha)).1;
            if let Average::Assumed(n) = element.average {
                for (alpha, w) in gauss(n) {
                    let own = w * pressure(alpha);
                    (0..k).for_each(|i| pressures[i][q] += element.weighted(i, alpha) * own);
                }
                continue;
            }
            let rate = |alpha: f64| (0..k).map(|j| lagrange(&element.c, j, alpha) * rates[j][q]).sum::<f64>();
            let gain: f64 = gauss(12).iter().map(|&(s, w)| w * pressure(s) * rate(s)).sum();
            let seen: f64 = (0..k).map(|j| element.b[j] * pressure(element.c[j]) * rates[j][q]).sum();
            let square: f64 = (0..k).map(|j| element.b[j] * rates[j][q] * rates[j][q]).sum();
            let r = if square > 1e-28 { (gain - seen) / square } else { 0.0 };
            (0..k).for_each(|i| pressures[i][q] = pressure(element.c[i]) + r * rates[i][q]);
        }
        for i in 0..k {
            let own = self.project(&pressures[i]).unwrap_or_default();
            for q in 0..paths.len() {
                all[q][i].stress = plus(&all[q][i].stress, 2.0 * own[q], &volumes[q].2[i]);
                all[q][i].volume = Some((rates[i][q], volumes[q].2[i]));
            }
        }
    }

    /// Measure of volume at the start, its rates, and the symmetric tensors N_i with `rate_i = N_i : C'_i`.
    fn volume_path(&self, element: &Element, path: &Path) -> (f64, Vec<f64>, Vec<Tensor>) {
        let k = element.c.len();
        let twice: Vec<Tensor> = path.rates.iter().map(|rate| rate.map(|row| row.map(|x| 2.0 * x))).collect();
        let start = self.measure(&path.start).0;
        if self.material.energy.measure() == Measure::Trace {
            let half = UNIT.map(|row| row.map(|x| 0.5 * x));
            return (start, twice.iter().map(|rate| contract(&half, rate)).collect(), vec![half; k]);
        }
        let mut cofactors = vec![[[0.0; 3]; 3]; k];
        for (alpha, w) in gauss(2 * k) {
            let own = cofactor(&path.strain(element, alpha));
            for (i, sum) in cofactors.iter_mut().enumerate() {
                *sum = plus(sum, w * element.weighted(i, alpha), &own);
            }
        }
        let d: Vec<f64> = cofactors.iter().zip(&twice).map(|(m, rate)| contract(m, rate)).collect();
        let first = determinant(&path.start);
        let at = |i: usize| first + (0..k).map(|j| element.a[i][j] * d[j]).sum::<f64>();
        let phi: Vec<f64> = (0..k).map(|i| 0.5 / at(i).sqrt()).collect();
        let second = first + dot(&element.b, &d);
        let mean = 1.0 / (first.sqrt() + second.sqrt());
        let square: f64 = (0..k).map(|j| element.b[j] * d[j] * d[j]).sum();
        let gap: f64 = (0..k).map(|j| element.b[j] * d[j] * (mean - phi[j])).sum();
        let r = if square < 1e-16 * first * first { 0.0 } else { gap / square };
        let g: Vec<f64> = (0..k).map(|i| phi[i] + r * d[i]).collect();
        let n = (0..k).map(|i| cofactors[i].map(|row| row.map(|x| g[i] * x))).collect();
        (start, (0..k).map(|i| g[i] * d[i]).collect(), n)
    }

    /// Viscous stress of a strain rate per time.
    fn viscous(&self, rate: &Tensor) -> Tensor {
        let [time, shear, bulk] = self.material.viscosity;
        let trace = rate[0][0] + rate[1][1] + rate[2][2];
        let deviator = plus(rate, -trace / 3.0, &UNIT);
        let stress = plus(&self.rest_stress(rate, time), 2.0 * shear, &deviator);
        plus(&stress, bulk * trace, &UNIT)
    }

    /// `factor D_0 : rate`.
    fn rest_stress(&self, rate: &Tensor, factor: f64) -> Tensor {
        if factor == 0.0 {
            return [[0.0; 3]; 3];
        }
        let energy = &self.material.energy;
        let mut stress = energy.elastic_stress(rate, self.projection.is_some());
        if self.share > 0.0 {
            let volume = plus(&energy.elastic_stress(rate, false), -1.0, &stress);
            stress = plus(&stress, self.share, &volume);
        }
        stress.map(|row| row.map(|x| factor * x))
    }
}

/// A point in a deformed cell.
#[derive(Debug, Clone)]
pub struct PointState {
    /// Its volume.
    pub weight: f64,
    /// Deformation gradient.
    pub f: Tensor,
    /// Energy per volume.
    pub energy: f64,
    /// Second stress of Piola and Kirchhoff.
    pub stress: Tensor,
    /// det F.
    pub ratio: f64,
}

/// Path of the assumed strain at a point.
struct Path {
    start: Tensor,
    f: Vec<Tensor>,
    rates: Vec<Tensor>,
}

impl Path {
    fn strain(&self, element: &Element, alpha: f64) -> Tensor {
        let twice = |j: usize| 2.0 * lagrange_integral(&element.c, j, alpha);
        self.rates.iter().enumerate().fold(self.start, |c, (j, rate)| plus(&c, twice(j), rate))
    }
}

/// Average of a stage at a point.
struct Averaged {
    f: Tensor,
    strain_rate: Tensor,
    stress: Tensor,
    /// Rate of the projected volume, and the tensor N of the own volume.
    volume: Option<(f64, Tensor)>,
}

/// Projection on polynomials of the position, as a matrix from point to point.
fn projection(points: &[Point], places: &[[f64; 3]], functions: usize) -> Matrix {
    let n = points.len();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for f in 0..functions {
        let mut own: Vec<f64> = places.iter().map(|place| if f == 0 { 1.0 } else { place[f - 1] }).collect();
        let product = |a: &[f64], b: &[f64]| (0..n).map(|q| points[q].weight * a[q] * b[q]).sum::<f64>();
        for _ in 0..2 {
            for other in &basis {
                let part = product(other, &own);
                own.iter_mut().zip(other).for_each(|(x, y)| *x -= part * y);
            }
        }
        let norm = product(&own, &own).sqrt();
        basis.push(own.iter().map(|x| x / norm).collect());
    }
    let entry = |q: usize, r: usize| basis.iter().map(|f| f[q] * f[r]).sum::<f64>() * points[r].weight;
    (0..n).map(|q| (0..n).map(|r| entry(q, r)).collect()).collect()
}

impl Body {
    /// A body of a mesh; the second material is that of the group `two`.
    pub fn new(mesh: &Mesh, materials: &[Material; 2]) -> Self {
        let n = mesh.points.len();
        let mut n_all = n;
        let mut cells = Vec::new();
        for (item, &is_second) in mesh.cells.iter().zip(&mesh.is_second) {
            let material = &materials[usize::from(is_second)];
            let cell = Cell::new(item, mesh, material, n_all, is_second);
            n_all += cell.nodes.len() - item.nodes.len();
            cells.push(cell);
        }
        let mut mass = vec![vec![0.0; n]; n];
        let mut lumped = vec![0.0; n];
        for cell in &cells {
            for (weight, _, functions) in cell.load_points(true) {
                functions.iter().zip(&cell.nodes).for_each(|(own, &node)| lumped[node] += weight * own);
            }
            for (weight, shapes) in &cell.mass_points {
                for i in 0..shapes.len() {
                    for j in 0..shapes.len() {
                        mass[cell.nodes[i]][cell.nodes[j]] += weight * shapes[i] * shapes[j];
                    }
                }
            }
        }
        Body {
            points: mesh.points.clone(),
            n_all,
            is_plane: mesh.is_plane(),
            thickness: mesh.thickness,
            cells,
            mass,
            lumped,
            drag: 0.0,
            springs: Vec::new(),
            attraction: None,
            dead: Vec::new(),
            pressure: None,
        }
    }

    /// Number of nodes without internal ones.
    pub fn n_nodes(&self) -> usize {
        self.points.len()
    }

    /// Row sums of the consistent mass.
    pub fn row_sums(&self) -> Vec<f64> {
        self.mass.iter().map(|row| row.iter().sum()).collect()
    }

    /// Nodal forces of an acceleration of some cells, on their consistent or lumped mass.
    pub fn mass_load(
        &self,
        is_lumped: bool,
        selected: impl Fn(&Cell) -> bool,
        acceleration: [f64; 3],
    ) -> Vec<f64> {
        let mut load = vec![0.0; 3 * self.n_all];
        for cell in self.cells.iter().filter(|cell| selected(cell)) {
            for (weight, _, functions) in cell.load_points(is_lumped) {
                for (own, node) in functions.iter().zip(&cell.nodes) {
                    (0..3).for_each(|d| load[3 * node + d] += weight * own * acceleration[d]);
                }
            }
        }
        load
    }

    /// Nodal forces of a wave `force cos(number x + rate t)` per volume.
    pub fn wave_load(
        &self,
        is_lumped: bool,
        force: [f64; 3],
        number: f64,
        rate: f64,
    ) -> Vec<(Vec<f64>, Wave)> {
        let mut parts = Vec::new();
        for cell in &self.cells {
            for (weight, shapes, functions) in cell.load_points(is_lumped) {
                let own = shapes.iter().zip(&cell.nodes);
                let x: f64 = own.map(|(shape, &node)| shape * self.points[node][0]).sum();
                let mut load = vec![0.0; 3 * self.n_all];
                for (own, node) in functions.iter().zip(&cell.nodes) {
                    let volume = weight / cell.material.density;
                    (0..3).for_each(|d| load[3 * node + d] += volume * own * force[d]);
                }
                parts.push((load, Wave { phase: number * x, rate }));
            }
        }
        parts
    }

    /// The body with slack fibres.
    pub fn slack(&self) -> Self {
        let mut body = self.clone();
        for cell in &mut body.cells {
            if let Energy::Fibres { k1, .. } = &mut cell.material.energy {
                *k1 = 0.0;
            }
        }
        body
    }

    /// The body whose attraction acts on the row sums of the consistent mass, in place of the lumped mass.
    pub fn attracted_by_row_sums(&self) -> Self {
        let mut body = self.clone();
        let row_sums = self.row_sums();
        if let Some(attraction) = &mut body.attraction {
            for ((strength, lumped), sum) in attraction.strengths.iter_mut().zip(&self.lumped).zip(&row_sums)
            {
                *strength *= sum / lumped;
            }
        }
        body
    }

    /// Integrals of the shape functions over facets in the reference configuration, and their area.
    pub fn facet_shares(&self, facets: &[Item]) -> (Vec<f64>, f64) {
        let mut shares = vec![0.0; self.n_nodes()];
        let mut area = 0.0;
        let zero = vec![0.0; 3 * self.n_all];
        for facet in facets {
            for (weight, shapes, normal) in self.facet_points(facet, &zero) {
                let own = weight * dot(&normal, &normal).sqrt();
                area += own;
                shapes.iter().zip(&facet.nodes).for_each(|(shape, &node)| shares[node] += own * shape);
            }
        }
        (shares, area)
    }

    /// Integrals of products of shape functions over facets.
    pub fn facet_products(&self, facets: &[Item]) -> Vec<(usize, usize, f64)> {
        let zero = vec![0.0; 3 * self.n_all];
        let mut products = Vec::new();
        for facet in facets {
            for (weight, shapes, normal) in self.facet_points(facet, &zero) {
                let own = weight * dot(&normal, &normal).sqrt();
                for (i, &a) in facet.nodes.iter().enumerate() {
                    for (j, &b) in facet.nodes.iter().enumerate() {
                        products.push((a, b, own * shapes[i] * shapes[j]));
                    }
                }
            }
        }
        products
    }

    /// Adds a mass that lies evenly on facets. The lumped one of a facet with nodes inside its edges is in proportion to the
    /// diagonal of its consistent mass.
    pub fn spread_mass(&mut self, facets: &[Item], total: f64) {
        let density = total / self.facet_shares(facets).1;
        for facet in facets {
            let products = self.facet_products(std::slice::from_ref(facet));
            let whole: f64 = products.iter().map(|(.., own)| own).sum();
            let diagonal: f64 = products.iter().filter(|(a, b, _)| a == b).map(|(.., own)| own).sum();
            for (a, b, own) in products {
                self.mass[a][b] += density * own;
                if facet.nodes.len() == facet.kind.corners() {
                    self.lumped[a] += density * own;
                } else if a == b {
                    self.lumped[a] += density * own * whole / diagonal;
                }
            }
        }
    }

    /// Weight, shape functions and current area vector at the points of a facet.
    fn facet_points(&self, facet: &Item, displacement: &[f64]) -> Vec<(f64, Vec<f64>, [f64; 3])> {
        let point = |(at, weight): ([f64; 3], f64)| {
            let shapes = facet.kind.shapes(at);
            let mut tangents = [[0.0; 3]; 2];
            for (shape, &node) in shapes.iter().zip(&facet.nodes) {
                for d in 0..3 {
                    let place = self.points[node][d] + displacement[3 * node + d];
                    tangents[0][d] += shape.by[0] * place;
                    tangents[1][d] += shape.by[1] * place;
                }
            }
            if self.is_plane {
                tangents[1] = [0.0, 0.0, self.thickness];
            }
            (weight, shapes.iter().map(|shape| shape.value).collect(), cross(tangents[0], tangents[1]))
        };
        facet.kind.facet_rule().into_iter().map(point).collect()
    }

    /// Force of a unit pressure at a displacement.
    fn unit_pressure(&self, facets: &[Item], displacement: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.n_all];
        for facet in facets {
            for (weight, shapes, normal) in self.facet_points(facet, displacement) {
                for (shape, node) in shapes.iter().zip(&facet.nodes) {
                    (0..3).for_each(|d| force[3 * node + d] -= weight * shape * normal[d]);
                }
            }
        }
        force
    }

    /// Loads at a displacement and time.
    pub fn loads(&self, displacement: &[f64], t: f64, is_before: bool) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.n_all];
        for dead in &self.dead {
            force.iter_mut().zip(dead.at(t, is_before)).for_each(|(sum, f)| *sum += f);
        }
        let pressure = self.pressure_load(displacement, if is_before { t - 1e-12 } else { t });
        force.iter_mut().zip(pressure).for_each(|(sum, f)| *sum += f);
        force
    }

    /// Load of the pressure at a displacement and time.
    pub fn pressure_load(&self, displacement: &[f64], t: f64) -> Vec<f64> {
        let Some((facets, pressure, history)) = &self.pressure else { return vec![0.0; displacement.len()] };
        let factor = pressure * history.at(t);
        self.unit_pressure(facets, displacement).iter().map(|f| factor * f).collect()
    }

    /// Averages of the loads over the stages of a step.
    pub fn stage_loads(
        &self,
        element: &Element,
        displacement: &[f64],
        rates: &[Vec<f64>],
        (t, h): (f64, f64),
        dead: &[Vec<f64>],
    ) -> Vec<Vec<f64>> {
        let mut loads = dead.to_vec();
        let Some((facets, pressure, history)) = &self.pressure else { return loads };
        let fine = pieces(t, h, &history.kinks());
        // A standard rule takes the surface at its own points, and the factor from the Lagrange polynomials on them.
        let points: Vec<(f64, f64)> = match &element.average {
            Average::Points(points) => {
                let places: Vec<f64> = points.iter().map(|point| point.0).collect();
                let factor = |m: usize| {
                    fine.iter()
                        .map(|(s, w)| w * history.at(t + s * h) * lagrange(&places, m, *s))
                        .sum::<f64>()
                };
                places.iter().enumerate().map(|(m, &alpha)| (alpha, factor(m))).collect()
            }
            _ => fine.iter().map(|&(alpha, w)| (alpha, w * history.at(t + alpha * h))).collect(),
        };
        for (alpha, factor) in points {
            let unit = self.unit_pressure(facets, &element.path(displacement, rates, alpha));
            for (i, load) in loads.iter_mut().enumerate() {
                let own = pressure * factor * element.weighted(i, alpha);
                load.iter_mut().zip(&unit).for_each(|(sum, f)| *sum += own * f);
            }
        }
        loads
    }

    /// Averages of the dead loads over the stages of a step.
    pub fn stage_dead_loads(&self, element: &Element, (t, h): (f64, f64)) -> Vec<Vec<f64>> {
        let mut loads = vec![vec![0.0; 3 * self.n_all]; element.c.len()];
        for dead in &self.dead {
            for (alpha, w) in pieces(t, h, &dead.history.kinks()) {
                let force = dead.at(t + alpha * h, false);
                for (i, load) in loads.iter_mut().enumerate() {
                    let own = w * element.weighted(i, alpha);
                    load.iter_mut().zip(&force).for_each(|(sum, f)| *sum += own * f);
                }
            }
        }
        loads
    }

    /// Forces of springs at a displacement.
    pub fn spring_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.n_all];
        for &(a, b, stiffness) in &self.springs {
            (0..3).for_each(|d| force[3 * a + d] += stiffness * displacement[3 * b + d]);
        }
        force
    }

    /// Arms of the attraction and the factors `dU/d(r^2)` at squared distances.
    fn attraction_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.n_all];
        let Some(attraction) = &self.attraction else { return force };
        for (node, strength) in attraction.strengths.iter().enumerate() {
            let arm = self.arm(attraction, node, displacement);
            let factor = strength * dot(&arm, &arm).powf(-1.5);
            (0..3).for_each(|d| force[3 * node + d] += factor * arm[d]);
        }
        force
    }

    fn arm(&self, attraction: &Attraction, node: usize, displacement: &[f64]) -> [f64; 3] {
        std::array::from_fn(|d| self.points[node][d] + displacement[3 * node + d] - attraction.centre[d])
    }

    /// Averages of the attraction by the rule of a link whose strain is its squared length.
    fn stage_attraction(&self, element: &Element, displacement: &[f64], rates: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let k = element.c.len();
        let mut forces = vec![vec![0.0; 3 * self.n_all]; k];
        let Some(attraction) = &self.attraction else { return forces };
        if let Average::Points(points) = &element.average {
            for &(alpha, w) in points {
                let own = self.attraction_forces(&element.path(displacement, rates, alpha));
                for (i, force) in forces.iter_mut().enumerate() {
                    let factor = w * element.weighted(i, alpha);
                    force.iter_mut().zip(&own).for_each(|(sum, f)| *sum += factor * f);
                }
            }
            return forces;
        }
        let stages: Vec<Vec<f64>> = element.c.iter().map(|&c| element.path(displacement, rates, c)).collect();
        for (node, strength) in attraction.strengths.iter().enumerate() {
            let arms: Vec<[f64; 3]> = stages.iter().map(|u| self.arm(attraction, node, u)).collect();
            let start = self.arm(attraction, node, displacement);
            let start = dot(&start, &start);
            // Rates of the squared distance, and the derivative of -g/sqrt(s).
            let square_rates: Vec<f64> =
                (0..k).map(|i| 2.0 * dot(&arms[i], &rates[i][3 * node..3 * node + 3])).collect();
            let square = |alpha: f64| {
                start + (0..k).map(|j| lagrange_integral(&element.c, j, alpha) * square_rates[j]).sum::<f64>()
            };
            let slope = |alpha: f64| 0.5 * strength * square(alpha).powf(-1.5);
            let slopes: Vec<f64> = match element.average {
                Average::Assumed(n) => (0..k)
                    .map(|i| gauss(n).iter().map(|&(s, w)| w * element.weighted(i, s) * slope(s)).sum())
                    .collect(),
                _ => {
                    let rate =
                        |s: f64| (0..k).map(|j| lagrange(&element.c, j, s) * square_rates[j]).sum::<f64>();
                    let gain: f64 = gauss(12).iter().map(|&(s, w)| w * slope(s) * rate(s)).sum();
                    let seen: f64 =
                        (0..k).map(|j| element.b[j] * slope(element.c[j]) * square_rates[j]).sum();
                    let sum: f64 = (0..k).map(|j| element.b[j] * square_rates[j] * square_rates[j]).sum();
                    let r = if sum > 1e-28 { (gain - seen) / sum } else { 0.0 };
                    (0..k).map(|i| slope(element.c[i]) + r * square_rates[i]).collect()
                }
            };
            for i in 0..k {
                (0..3).for_each(|d| forces[i][3 * node + d] += 2.0 * slopes[i] * arms[i][d]);
            }
        }
        forces
    }

    /// Forces of cells, springs and attractions at a displacement.
    pub fn forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut force = self.cell_forces(displacement);
        let ground = self.spring_forces(displacement).into_iter().zip(self.attraction_forces(displacement));
        force.iter_mut().zip(ground).for_each(|(sum, (spring, attraction))| *sum += spring + attraction);
        force
    }

    /// Forces of attractions at a displacement.
    pub fn ground_attraction(&self, displacement: &[f64]) -> Vec<f64> {
        self.attraction_forces(displacement)
    }

    fn cell_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.n_all];
        for cell in &self.cells {
            for (point, state) in cell.points.iter().zip(cell.state(displacement)) {
                cell.add_force(point, &product(&state.f, &state.stress), &mut force);
            }
        }
        force
    }

    /// Stored energy with springs and attractions, and the smallest det F.
    pub fn energy(&self, displacement: &[f64]) -> (f64, f64) {
        let (mut energy, mut smallest) = (0.0, f64::INFINITY);
        for cell in &self.cells {
            for state in cell.state(displacement) {
                energy += state.weight * state.energy;
                smallest = smallest.min(state.ratio);
            }
        }
        energy += 0.5 * dot(&self.spring_forces(displacement), displacement);
        if let Some(attraction) = &self.attraction {
            for (node, strength) in attraction.strengths.iter().enumerate() {
                let arm = self.arm(attraction, node, displacement);
                energy -= strength / dot(&arm, &arm).sqrt();
            }
        }
        (energy, smallest)
    }

    /// Forces of a step of size h.
    pub fn stage_forces(
        &self,
        element: &Element,
        displacement: &[f64],
        rates: &[Vec<f64>],
        h: f64,
    ) -> StageForces {
        let k = element.c.len();
        let mut internal = vec![vec![0.0; 3 * self.n_all]; k];
        let mut dissipated = 0.0;
        if let Average::Points(points) = &element.average {
            for &(alpha, w) in points {
                let own = self.cell_forces(&element.path(displacement, rates, alpha));
                for (i, force) in internal.iter_mut().enumerate() {
                    let factor = w * element.weighted(i, alpha);
                    force.iter_mut().zip(&own).for_each(|(sum, f)| *sum += factor * f);
                }
            }
        }
        for cell in &self.cells {
            let is_damped = cell.material.viscosity != [0.0; 3] || element.dissipation.is_some();
            let mut averages = match element.average {
                Average::Points(_) if is_damped => cell.paths_only(element, displacement, rates),
                Average::Points(_) => continue,
                _ => cell.assumed(element, displacement, rates),
            };
            if is_damped {
                dissipated += cell.add_damping(element, &mut averages, h);
            }
            if let Average::Points(points) = &element.average {
                for &(alpha, w) in points {
                    let mut own = vec![0.0; 3 * self.n_all];
                    dissipated +=
                        w * cell.add_viscous_pressure(element, displacement, rates, (alpha, h), &mut own);
                    for (i, force) in internal.iter_mut().enumerate() {
                        let factor = w * element.weighted(i, alpha);
                        force.iter_mut().zip(&own).for_each(|(sum, f)| *sum += factor * f);
                    }
                }
            }
            for (point, stages) in cell.points.iter().zip(&averages) {
                for (i, stage) in stages.iter().enumerate() {
                    cell.add_force(point, &product(&stage.f, &stage.stress), &mut internal[i]);
                }
            }
        }
        let at = |i: usize| element.path(displacement, rates, element.c[i]);
        let springs: Vec<Vec<f64>> = (0..k).map(|i| self.spring_forces(&at(i))).collect();
        let attraction = self.stage_attraction(element, displacement, rates);
        for i in 0..k {
            let ground = springs[i].iter().zip(&attraction[i]);
            internal[i].iter_mut().zip(ground).for_each(|(sum, (s, a))| *sum += s + a);
        }
        StageForces { internal, springs, attraction, dissipated }
    }
}

impl Cell {
    /// Paths without stress.
    fn paths_only(&self, element: &Element, displacement: &[f64], rates: &[Vec<f64>]) -> Vec<Vec<Averaged>> {
        let path = |point: &Point| {
            let path = self.strain_path(element, point, &self.deformation(point, displacement), rates);
            let stage = |(f, rate): (&Tensor, &Tensor)| Averaged {
                f: *f,
                strain_rate: *rate,
                stress: [[0.0; 3]; 3],
                volume: None,
            };
            path.f.iter().zip(&path.rates).map(stage).collect()
        };
        self.points.iter().map(path).collect()
    }

    /// Adds the forces of the viscous pressure of a projected volume at a point of a step, as a standard rule takes them;
    /// returns the power by alpha.
    fn add_viscous_pressure(
        &self,
        element: &Element,
        displacement: &[f64],
        rates: &[Vec<f64>],
        (alpha, h): (f64, f64),
        force: &mut [f64],
    ) -> f64 {
        let factor =
            self.material.viscosity[0] / h * (1.0 - self.share) * self.material.energy.bulk_stiffness();
        if factor == 0.0 || self.projection.is_none() {
            return 0.0;
        }
        let place = element.path(displacement, rates, alpha);
        let mut rate = vec![0.0; displacement.len()];
        for (j, own) in rates.iter().enumerate() {
            let weight = lagrange(&element.c, j, alpha);
            rate.iter_mut().zip(own).for_each(|(sum, x)| *sum += weight * x);
        }
        let at = |point: &Point| {
            let f = self.deformation(point, &place);
            let n = self.measure(&product(&transpose(&f), &f)).1;
            let own = 2.0 * contract(&n, &strain_rate(&f, &self.sum(point, &rate)));
            (f, n, own)
        };
        let states: Vec<(Tensor, Tensor, f64)> = self.points.iter().map(at).collect();
        let own: Vec<f64> = states.iter().map(|state| state.2).collect();
        let projected = self.project(&own).unwrap_or_default();
        let mut power = 0.0;
        for ((point, (f, n, _)), theta) in self.points.iter().zip(&states).zip(projected) {
            let stress = n.map(|row| row.map(|x| 2.0 * factor * theta * x));
            self.add_force(point, &product(f, &stress), force);
            power += point.weight * factor * theta * theta;
        }
        power
    }

    /// Adds viscous stresses and those of a dissipative element; returns the energy that they take.
    fn add_damping(&self, element: &Element, averages: &mut [Vec<Averaged>], h: f64) -> f64 {
        let mut dissipated = 0.0;
        for (point, stages) in self.points.iter().zip(averages) {
            let highest = element.dissipation.as_ref().map(|(beta, p)| {
                let sum = stages.iter().enumerate().fold([[0.0; 3]; 3], |sum, (j, stage)| {
                    plus(&sum, element.b[j] * p[j], &stage.strain_rate)
                });
                (p, self.rest_stress(&sum, *beta))
            });
            let modulus = (1.0 - self.share) * self.material.energy.bulk_stiffness();
            let volume_rate = |stage: &Averaged| stage.volume.map_or(0.0, |volume| volume.0);
            let highest_volume: f64 = element.dissipation.as_ref().map_or(0.0, |(_, p)| {
                stages.iter().enumerate().map(|(j, stage)| element.b[j] * p[j] * volume_rate(stage)).sum()
            });
            for (i, stage) in stages.iter_mut().enumerate() {
                // The volume has its own pressure.
                let mut pressure = self.material.viscosity[0] * modulus * volume_rate(stage) / h;
                if let Some((beta, p)) = &element.dissipation {
                    pressure += beta * p[i] * modulus * highest_volume;
                }
                let per_time = stage.strain_rate.map(|row| row.map(|x| x / h));
                let mut own = self.viscous(&per_time);
                if let Some((p, stress)) = &highest {
                    own = plus(&own, p[i], stress);
                }
                if let Some((_, n)) = &stage.volume {
                    own = plus(&own, 2.0 * pressure, n);
                }
                dissipated += point.weight * element.b[i] * contract(&own, &stage.strain_rate);
                stage.stress = plus(&stage.stress, 1.0, &own);
            }
        }
        dissipated
    }
}
