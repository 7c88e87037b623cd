//! One input for a choice of features, with the same problem for the reference.

mod loads;
mod regions;
mod supports;
mod time;

pub use time::VALUES;

use std::fmt::Write;

use fastrand::Rng;

use crate::features::{AXES, Choice, axis_of};
use crate::reference::body::Body;
use crate::reference::element::{Average, Element};
use crate::reference::mesh::Mesh;
use crate::reference::motion::{Motion, Scheme, State, Support};
use crate::reference::numbers::{cross, gauss};
use regions::{cells, materials, regions};

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

/// The tolerance: errors of displacements appear in stresses multiplied by the modulus.
const NEWTON: &str = "[newton]\ntolerance = 1e-12\n\n";

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
        let _ = write!(text, "[solver]\nkind = \"{}\"\n\n{NEWTON}", chosen(choice, "solver"));
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
        Motion { body: &self.body, supports: &self.supports, scheme: &self.scheme, guess: 1.0 }
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
            let motion = Motion { body, supports, scheme: &scheme, guess: 1.0 };
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
}
