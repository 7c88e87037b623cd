//! One input for a choice of features, with the same problem for the reference.

use std::fmt::Write;

use fastrand::Rng;

use crate::features::{AXES, Choice, axis_of};
use crate::reference::body::{
    Attraction, Average, Body, Dead, Element, Formulation, History, Material, STEADY,
};
use crate::reference::cells::Kind;
use crate::reference::energies::Energy;
use crate::reference::mesh::Mesh;
use crate::reference::motion::{Drive, Motion, Scheme, State, Support};
use crate::reference::numbers::{cross, gauss, lobatto};

/// Velocity, angular velocity, and gradient of the velocity at the start.
type Initial = ([f64; 3], [f64; 3], [[f64; 3]; 3]);

/// An input and its reference.
#[derive(Debug)]
pub struct Case {
    choice: Choice,
    /// The mesh.
    pub mesh: Mesh,
    /// The body.
    pub body: Body,
    /// Its supports.
    pub supports: Vec<Support>,
    /// Groups of the supports.
    pub groups: Vec<&'static str>,
    /// The scheme.
    pub scheme: Scheme,
    /// The input.
    pub text: String,
    /// Input of the run that gives the state of the start.
    pub first: Option<(String, Body, Vec<Support>, Vec<f64>)>,
    initial: Option<Initial>,
    density: f64,
    step: f64,
}

/// Increments of an equilibrium.
pub const INCREMENTS: usize = 4;

/// Numbers of a drawn case.
struct Draft<'a> {
    choice: &'a Choice,
    rng: Rng,
    mesh: Mesh,
    body: Body,
    h: f64,
    is_plane: bool,
}

/// A vector as text.
fn vector(v: [f64; 3]) -> String {
    format!("[{:?}, {:?}, {:?}]", v[0], v[1], v[2])
}

/// A number with few digits between two bounds.
fn number(rng: &mut Rng, low: f64, high: f64) -> f64 {
    ((low + (high - low) * rng.f64()) * 1e3).round() * 1e-3
}

fn chosen<'a>(choice: &Choice, axis: &str) -> &'a str {
    let axis = axis_of(axis);
    AXES[axis].values[choice[axis]]
}

impl Case {
    /// The case of a choice, with numbers from a seed.
    pub fn new(choice: &Choice, seed: u64) -> Self {
        Case::with_density(choice, seed, 1.0)
    }

    /// The same with a factor on the density of the first region.
    pub fn with_density(choice: &Choice, seed: u64, factor: f64) -> Self {
        let mut rng = Rng::with_seed(seed);
        let (kind, n) = cells(chosen(choice, "cells"), chosen(choice, "material") == "two");
        let mesh = Mesh::block(kind, n, &mut rng);
        let mut materials = materials(choice, kind, &mut rng);
        let is_two = chosen(choice, "material") == "two";
        materials[..if is_two { 1 } else { 2 }].iter_mut().for_each(|material| material.density *= factor);
        let body = Body::new(&mesh, &materials);
        let is_plane = mesh.is_plane();
        let h = match chosen(choice, "scheme") {
            "central-differences" => 0.0015,
            _ => number(&mut rng, 0.02, 0.035),
        };
        let mut draft = Draft { choice, rng, mesh, body, h, is_plane };
        let regions = regions(choice, &materials, draft.mesh.is_second.contains(&true), draft.mesh.thickness);
        let masses = draft.masses();
        let load = draft.load();
        let (mut supports, groups, support) = draft.supports();
        let initial = draft.initial();
        let (scheme, time) = draft.scheme();
        let head = format!("[mesh]\nfile = \"mesh.msh\"\n\n{regions}{masses}");
        let is_static = chosen(choice, "run") == "static";
        let start = match (is_static, chosen(choice, "start")) {
            (true, _) => String::new(),
            (_, "rest") => String::new(),
            (_, "state") => "[initial]\nstate = \"first\"\n\n".into(),
            _ => initial.as_ref().map_or(String::new(), |(velocity, spin, gradient)| {
                let rows = gradient.map(vector).join(", ");
                let (velocity, spin) = (vector(*velocity), vector(*spin));
                format!(
                    "[initial]\nvelocity = {velocity}\nangular_velocity = {spin}\ngradient = [{rows}]\n\n"
                )
            }),
        };
        let mut text = format!("{head}{load}{support}{start}");
        if is_static || chosen(choice, "start") == "equilibrium" {
            let _ = write!(text, "[equilibrium]\nload_steps = {INCREMENTS}\n\n");
        }
        if !is_static {
            text += &time;
        }
        let _ = write!(text, "[solver]\nkind = \"{}\"\n\n", chosen(choice, "solver"));
        text += &draft.output("run");
        let first = (chosen(choice, "start") == "state").then(|| draft.first(&head));
        if is_static {
            supports.iter_mut().for_each(|support| support.until = f64::INFINITY);
        }
        let (density, step) = (materials[0].density / factor, draft.h);
        let initial = initial.filter(|_| matches!(chosen(choice, "start"), "velocity" | "equilibrium"));
        Case {
            choice: *choice,
            mesh: draft.mesh,
            body: draft.body,
            supports,
            groups,
            scheme,
            text,
            first,
            initial,
            density,
            step,
        }
    }

    /// Value of an axis.
    pub fn chosen(&self, axis: &str) -> &'static str {
        chosen(&self.choice, axis)
    }

    /// Density of the first region, without a factor.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Size of a step.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The motion of the reference.
    pub fn motion(&self) -> Motion<'_> {
        Motion { body: &self.body, supports: &self.supports, scheme: &self.scheme }
    }

    /// The state at the start.
    ///
    /// # Errors
    /// If the reference finds no equilibrium, or no motion before.
    pub fn start(&self) -> Result<State, String> {
        let n = 3 * self.body.n_all;
        let mut state = State { u: vec![0.0; n], v: vec![0.0; n] };
        if let Some((_, body, supports, times)) = &self.first {
            let scheme = Scheme::Element(Element::new(1, Average::Points(gauss(1)), None));
            let motion = Motion { body, supports, scheme: &scheme };
            let last = motion.rows(state, times, false)?.pop().ok_or("no rows")?;
            state = State { u: last.displacement, v: last.velocity };
        }
        if self.chosen("start") == "equilibrium" {
            let parts: Vec<f64> = (1..=INCREMENTS).map(|i| i as f64 / INCREMENTS as f64).collect();
            state.u = self.motion().equilibria(&parts)?.pop().ok_or("no increments")?;
        }
        if let Some((velocity, spin, gradient)) = &self.initial {
            for (node, &point) in self.body.points.iter().enumerate() {
                let turned = cross(*spin, point);
                for d in 0..3 {
                    let stretched: f64 = (0..3).map(|j| gradient[d][j] * point[j]).sum();
                    state.v[3 * node + d] = velocity[d] + turned[d] + stretched;
                }
            }
        }
        Ok(state)
    }
}

fn cells(name: &str, needs_two: bool) -> (Kind, usize) {
    match name {
        "hex8" => (Kind::Hex8, 2),
        "hex20" => (Kind::Hex20, 1 + usize::from(needs_two)),
        "tet4" => (Kind::Tet4, 1),
        "tet10" => (Kind::Tet10, 1),
        "wedge6" => (Kind::Wedge6, 1),
        "quad4" => (Kind::Quad4, 2),
        "quad8" => (Kind::Quad8, 2),
        "hex27" => (Kind::Hex27, 1 + usize::from(needs_two)),
        "wedge15" => (Kind::Wedge15, 1),
        "quad9" => (Kind::Quad9, 2),
        "tri3" => (Kind::Tri3, 2),
        _ => (Kind::Tri6, 1),
    }
}

fn materials(choice: &Choice, kind: Kind, rng: &mut Rng) -> [Material; 2] {
    let mu = number(rng, 45.0, 60.0);
    let lambda = number(rng, 60.0, 90.0);
    let neo_hooke = Energy::NeoHooke { lambda, mu };
    let saint_venant = Energy::SaintVenantKirchhoff { lambda, mu };
    let energy = match chosen(choice, "material") {
        "saint-venant-kirchhoff" => saint_venant.clone(),
        "mooney-rivlin" => Energy::MooneyRivlin { c10: 0.35 * mu, c01: 0.15 * mu, bulk: lambda },
        "formula" => Energy::Formula { c: 0.5 * mu, b: 1.5, bulk: lambda },
        "fibres" => {
            let fibre = if kind.dimension() == 2 { [1.0, 2.0, 0.0] } else { [1.0, 2.0, 0.5] };
            Energy::Fibres { mu, k1: 30.0, k2: 1.5, kappa: 0.1, fibre, bulk: lambda }
        }
        _ => neo_hooke,
    };
    let viscosity = match chosen(choice, "damping") {
        "viscous-time" => [0.004, 0.0, 0.0],
        "viscous-shear" => [0.0, 0.3, 0.2],
        _ => [0.0; 3],
    };
    let takes_linear = matches!(kind, Kind::Quad8 | Kind::Quad9 | Kind::Wedge15 | Kind::Hex20 | Kind::Hex27);
    let formulation = match chosen(choice, "formulation") {
        "projected-volume" if takes_linear => Formulation::Linear,
        "projected-volume" => Formulation::Constant,
        "incompatible-modes" => Formulation::Modes,
        _ => Formulation::Standard,
    };
    let first = Material { energy, density: number(rng, 1.0, 1.5), viscosity, formulation };
    let second = match chosen(choice, "material") {
        "two" => Material { energy: saint_venant, density: 0.8 * first.density, ..first.clone() },
        _ => first.clone(),
    };
    [first, second]
}

fn regions(choice: &Choice, materials: &[Material; 2], has_second: bool, thickness: f64) -> String {
    let is_two = chosen(choice, "material") == "two" && has_second;
    let mut text = String::new();
    for (material, group) in materials.iter().zip(["one", "two"]).take(1 + usize::from(is_two)) {
        let _ = writeln!(text, "[[region]]");
        if is_two {
            let _ = writeln!(text, "group = \"{group}\"");
        }
        let _ = writeln!(text, "density = {:?}\nmaterial.{}", material.density, material.energy.text());
        if thickness != 1.0 {
            let _ = writeln!(text, "thickness = {thickness:?}");
        }
        match material.viscosity {
            [0.0, 0.0, 0.0] => {}
            [time, 0.0, 0.0] => text += &format!("viscosity = {{ time = {time:?} }}\n"),
            [_, shear, bulk] => text += &format!("viscosity = {{ shear = {shear:?}, bulk = {bulk:?} }}\n"),
        }
        let _ = writeln!(text, "formulation = \"{}\"\n", chosen(choice, "formulation"));
    }
    text
}

impl Draft<'_> {
    /// A random vector in the space of the body.
    fn vector(&mut self, size: f64) -> [f64; 3] {
        let signs: [f64; 3] = std::array::from_fn(|_| if self.rng.bool() { 1.0 } else { -1.0 });
        let mut v = signs.map(|sign| sign * number(&mut self.rng, 0.4 * size, size));
        if self.is_plane {
            v[2] = 0.0;
        }
        v
    }

    /// A table with kinks inside steps.
    fn table(&self) -> History {
        History::Table(vec![[0.0, 0.4], [1.4 * self.h, 1.0], [2.4 * self.h, 0.3]])
    }

    fn masses(&mut self) -> String {
        let top = &self.mesh.top;
        match chosen(self.choice, "masses") {
            "points" => {
                let mass = number(&mut self.rng, 0.03, 0.08);
                for node in Mesh::nodes_of(top) {
                    self.body.mass[node][node] += mass;
                    self.body.lumped[node] += mass;
                }
                format!("[[mass]]\ngroup = \"top\"\nmass = {mass:?}\n\n")
            }
            "spread" => {
                let total = number(&mut self.rng, 0.2, 0.6);
                self.body.spread_mass(top, total);
                format!("[[mass]]\ngroup = \"top\"\ntotal = {total:?}\n\n")
            }
            _ => String::new(),
        }
    }

    /// Adds the loads to the body.
    fn load(&mut self) -> String {
        let mut text = self.own_load();
        if chosen(self.choice, "damping") == "drag" {
            self.body.drag = number(&mut self.rng, 1.0, 3.0);
            let _ = writeln!(text, "[[load]]\ndrag = {:?}\n", self.body.drag);
        }
        text
    }

    fn own_load(&mut self) -> String {
        let top = self.mesh.top.clone();
        let is_lumped = chosen(self.choice, "scheme") == "central-differences";
        let n = 3 * self.body.n_all;
        let spread = |shares: &[f64], force: [f64; 3]| {
            let mut load = vec![0.0; n];
            for (node, share) in shares.iter().enumerate() {
                (0..3).for_each(|d| load[3 * node + d] = share * force[d]);
            }
            load
        };
        let (history, load, text) = match chosen(self.choice, "load") {
            "traction" => {
                let traction = self.vector(9.0);
                let load = spread(&self.body.facet_shares(&top).0, traction);
                (self.table(), load, format!("group = \"top\"\ntraction = {}", vector(traction)))
            }
            "force" => {
                let force = self.vector(5.0);
                let (shares, area) = self.body.facet_shares(&top);
                let load = spread(&shares, force.map(|f| f / area));
                (History::Constant, load, format!("group = \"top\"\nforce = {}", vector(force)))
            }
            "nodal-force" => {
                let force = self.vector(1.0);
                let mut shares = vec![0.0; self.body.n_nodes()];
                Mesh::nodes_of(&top).iter().for_each(|&node| shares[node] = 1.0);
                let history = History::Sine { factor: 1.0, rate: 9.0, phase: 0.5 };
                (history, spread(&shares, force), format!("group = \"top\"\nnodal_force = {}", vector(force)))
            }
            "pressure" => {
                let pressure = number(&mut self.rng, 5.0, 9.0);
                let history = self.table();
                let text = format!(
                    "[[load]]\ngroup = \"top\"\npressure = {pressure:?}\nhistory = {}\n\n",
                    history.text()
                );
                self.body.pressure = Some((top, pressure, history));
                return text;
            }
            "acceleration" => {
                let acceleration = self.vector(9.0);
                let masses = if is_lumped { self.body.lumped.clone() } else { self.body.row_sums() };
                let load = spread(&masses, acceleration);
                (History::Constant, load, format!("acceleration = {}", vector(acceleration)))
            }
            "group-acceleration" => {
                let acceleration = self.vector(9.0);
                let load = self.body.mass_load(is_lumped, |cell| !cell.is_second, acceleration);
                (self.table(), load, format!("group = \"one\"\nacceleration = {}", vector(acceleration)))
            }
            "body-force" => {
                let force = self.vector(9.0);
                let component = |f: f64| match f {
                    0.0 => "0".to_string(),
                    f => format!("\"{f:?}*cos(2*x + 5*t)\""),
                };
                let [x, y, z] = force.map(component);
                let parts = self.body.wave_load(is_lumped, force, 2.0, 5.0);
                self.body.dead.push(Dead { parts, history: History::Constant });
                return format!("[[load]]\nbody_force = [{x}, {y}, {z}]\n\n");
            }
            "attraction" => {
                let centre = if self.is_plane { [2.5, 1.5, 0.0] } else { [2.5, 1.5, 1.0] };
                let strength = number(&mut self.rng, 15.0, 25.0);
                let masses = if is_lumped { self.body.lumped.clone() } else { self.body.row_sums() };
                let strengths = masses.iter().map(|mass| strength * mass).collect();
                self.body.attraction = Some(Attraction { centre, strengths });
                return format!(
                    "[[load]]\nattraction = {{ centre = {}, strength = {strength:?} }}\n\n",
                    vector(centre)
                );
            }
            _ => return String::new(),
        };
        let text = match history {
            History::Constant => format!("[[load]]\n{text}\n\n"),
            _ => format!("[[load]]\n{text}\nhistory = {}\n\n", history.text()),
        };
        self.body.dead.push(Dead { parts: vec![(load, STEADY)], history });
        text
    }

    /// Drives of all components of the nodes at the bottom.
    fn hold(&self, components: &[usize], drive: &Drive) -> Vec<(usize, Drive)> {
        let nodes = Mesh::nodes_of(&self.mesh.bottom).into_iter();
        nodes.flat_map(|node| components.iter().map(move |d| (3 * node + d, drive.clone()))).collect()
    }

    fn supports(&mut self) -> (Vec<Support>, Vec<&'static str>, String) {
        let h = self.h;
        let never = f64::INFINITY;
        let support = |drives: Vec<(usize, Drive)>| Support { drives, has_springs: false, until: never };
        let all = self.hold(&[0, 1, 2], &Drive::Fixed);
        let driven = |axis: usize, history: &History, own: &Self| {
            let others: Vec<usize> = (0..3).filter(|d| *d != axis).collect();
            let mut drives = own.hold(&others, &Drive::Fixed);
            drives.extend(own.hold(&[axis], &Drive::Move(1.0, history.clone())));
            drives
        };
        let (own, text) = match chosen(self.choice, "support") {
            "free" => return (Vec::new(), Vec::new(), String::new()),
            "rollers" => (support(self.hold(&[1], &Drive::Fixed)), "fix = [\"y\"]".into()),
            "symmetry" => (support(self.hold(&[1], &Drive::Fixed)), "symmetry = true".into()),
            "moved" => {
                let history =
                    History::Sine { factor: number(&mut self.rng, 0.03, 0.06), rate: 7.0, phase: 0.0 };
                let text = format!("fix = [\"y\", \"z\"]\nmove = {{ x = {} }}", history.text());
                (support(driven(0, &history, self)), text)
            }
            "kinked" => {
                let history = History::Table(vec![[0.0, 0.0], [1.4 * h, 0.03], [9.0 * h, 0.01]]);
                let text = format!("fix = [\"x\", \"z\"]\nmove = {{ y = {} }}", history.text());
                (support(driven(1, &history, self)), text)
            }
            "accelerated" => {
                let rows = vec![[0.0, 20.0], [1.4 * h, -25.0], [9.0 * h, 10.0]];
                let history = History::Integrated(rows);
                let text = format!("fix = [\"y\", \"z\"]\naccelerate = {{ x = {} }}", history.text());
                (support(driven(0, &history, self)), text)
            }
            "turned" => {
                let (about, angle) = ([0.4, 0.1], History::Square(number(&mut self.rng, 4.0, 8.0)));
                let mut drives = self.hold(&[2], &Drive::Fixed);
                for node in Mesh::nodes_of(&self.mesh.bottom) {
                    let arm = std::array::from_fn(|d| self.mesh.points[node][d] - about[d]);
                    drives.extend((0..2).map(|component| {
                        (3 * node + component, Drive::Turn { arm, component, angle: angle.clone() })
                    }));
                }
                let text = format!(
                    "rotate = {{ axis = [0, 0, 1], about = [{:?}, {:?}, 0], angle = {} }}",
                    about[0],
                    about[1],
                    angle.text()
                );
                (support(drives), text)
            }
            "springs" => {
                let stiffness = number(&mut self.rng, 20.0, 40.0);
                let nodes = Mesh::nodes_of(&self.mesh.bottom).into_iter();
                self.body.springs = nodes.map(|node| (node, node, stiffness)).collect();
                let own = Support { drives: Vec::new(), has_springs: true, until: never };
                let text = format!("[[support]]\ngroup = \"feet\"\nspring = {stiffness:?}\n\n");
                return (vec![own], vec!["feet"], text);
            }
            "bed" => {
                let stiffness = number(&mut self.rng, 100.0, 200.0);
                let products = self.body.facet_products(&self.mesh.bottom).into_iter();
                self.body.springs = products.map(|(a, b, area)| (a, b, stiffness * area)).collect();
                let own = Support { drives: Vec::new(), has_springs: true, until: never };
                (own, format!("spring = {stiffness:?}"))
            }
            "released" => {
                let until = (1.6 * h * 1e5).round() * 1e-5;
                let own = Support { until, ..support(all) };
                (own, format!("fix = [\"x\", \"y\", \"z\"]\nuntil = {until:?}"))
            }
            _ => (support(all), "fix = [\"x\", \"y\", \"z\"]".into()),
        };
        (vec![own], vec!["bottom"], format!("[[support]]\ngroup = \"bottom\"\n{text}\n\n"))
    }

    fn initial(&mut self) -> Option<Initial> {
        let mut spin = self.vector(2.0);
        let mut gradient = [0, 1, 2].map(|_| self.vector(1.6));
        if self.is_plane {
            spin = [0.0, 0.0, 1.7];
            gradient[2] = [0.0; 3];
        }
        Some((self.vector(1.0), spin, gradient))
    }

    fn scheme(&self) -> (Scheme, String) {
        let degree: usize = chosen(self.choice, "degree").parse().unwrap_or(1);
        let name = chosen(self.choice, "scheme");
        let element = |average, rho| Scheme::Element(Element::new(degree, average, rho));
        let alpha = |alpha_m: f64, alpha_f: f64| {
            let sum = 1.0 - alpha_m + alpha_f;
            Scheme::Newmark([alpha_m, alpha_f, 0.25 * sum * sum, sum - 0.5])
        };
        let scheme = match name {
            "FE(k)" => element(Average::Points(gauss(degree)), None),
            "FE(k+2)" => element(Average::Points(gauss(degree + 2)), None),
            "AS(k)" => element(Average::Assumed(degree), None),
            "AS(k+2)" => element(Average::Assumed(degree + 2), None),
            "Lobatto(k+1)" => element(Average::Points(lobatto(degree + 1)), None),
            "trapezoidal" => element(Average::Points(lobatto(2)), None),
            "DGM(0.5)" => element(Average::Gradient, Some(0.5)),
            "AS(k+1,0.3)" => element(Average::Assumed(degree + 1), Some(0.3)),
            "Newmark(0.3,0.6)" => Scheme::Newmark([0.0, 0.0, 0.3, 0.6]),
            "HHT(0.1)" => alpha(0.0, 0.1),
            "generalized-alpha(0.7)" => alpha(0.4 / 1.7, 0.7 / 1.7),
            "Bathe" => Scheme::Bathe,
            "central-differences" => Scheme::Central,
            _ => element(Average::Gradient, None),
        };
        let number = |more: usize| (degree + more).to_string();
        let name =
            name.replace("k+1", &number(1)).replace("k+2", &number(2)).replace("(k", &format!("({degree}"));
        let (h, end) = (self.h, 3.0 * self.h);
        let text = format!(
            "[time]\nscheme = \"{name}\"\ndegree = {degree}\n{}\n",
            match chosen(self.choice, "steps") {
                "adaptive" => format!(
                    "adaptive = {{ tolerance = 1e-2, first_size = {:?}, max_size = {h:?} }}\nuntil = {end:?}\n",
                    0.6 * h
                ),
                _ => format!("steps = [{{ until = {end:?}, size = {h:?} }}]\n"),
            }
        );
        (scheme, text)
    }

    fn output(&self, directory: &str) -> String {
        let mut text = format!(
            "[output]\ndirectory = \"{directory}\"\nevery = 0\nextremes = [\"displacement\"]\nvalues = [\n"
        );
        for (name, group, quantity, measure) in VALUES {
            let _ = writeln!(
                text,
                "  {{ name = \"{name}\", group = \"{group}\", quantity = \"{quantity}\", measure = \"{measure}\" }},"
            );
        }
        text += "]\nprobes = [\n";
        for (node, point) in self.mesh.points.iter().enumerate() {
            let _ = writeln!(text, "  {{ name = \"n{node}\", point = {} }},", vector(*point));
        }
        text + "]\n"
    }

    /// The run whose last state is the start: two steps under a traction, with the bottom held.
    fn first(&self, head: &str) -> (String, Body, Vec<Support>, Vec<f64>) {
        let mut body = self.body.clone();
        (body.springs, body.attraction, body.pressure, body.drag) = (Vec::new(), None, None, 0.0);
        let shares = body.facet_shares(&self.mesh.top).0;
        let traction = [7.0, 5.0, 0.0];
        let mut load = vec![0.0; 3 * body.n_all];
        for (node, share) in shares.iter().enumerate() {
            (0..3).for_each(|d| load[3 * node + d] = share * traction[d]);
        }
        body.dead = vec![Dead { parts: vec![(load, STEADY)], history: History::Constant }];
        let drives = self.hold(&[0, 1, 2], &Drive::Fixed);
        let supports = vec![Support { drives, has_springs: false, until: f64::INFINITY }];
        let text = format!(
            "{head}[[load]]\ngroup = \"top\"\ntraction = {}\n\n[[support]]\ngroup = \"bottom\"\nfix = [\"x\", \"y\", \"z\"]\n\n\
             [time]\nscheme = \"FE(1)\"\nsteps = [{{ until = 0.06, size = 0.03 }}]\n\n[output]\ndirectory = \"first\"\nevery = 0\n",
            vector(traction)
        );
        (text, body, supports, vec![0.0, 0.03, 0.06])
    }
}

/// Values of groups: name, group, quantity, measure.
pub const VALUES: [(&str, &str, &str, &str); 8] = [
    ("energy", "one", "strain_energy_density", "total"),
    ("kinetic", "one", "cell_kinetic_energy_density", "total"),
    ("density", "one", "cell_strain_energy_density", "max"),
    ("stress", "one", "cell_cauchy_stress", "mean"),
    ("piola", "one", "cell_second_piola_kirchhoff_stress", "total"),
    ("mises", "one", "cell_von_mises_stress", "max"),
    ("ratio", "one", "cell_volume_ratio", "mean"),
    ("shift", "top", "displacement", "mean"),
];
