//! Masses, loads and drag.

use std::fmt::Write;

use super::{Draft, chosen, number, vector};
use crate::reference::body::{Attraction, Dead, STEADY};
use crate::reference::history::History;
use crate::reference::mesh::Mesh;

impl Draft<'_> {
    /// A table with kinks inside steps.
    fn table(&self) -> History {
        History::Table(vec![[0.0, 0.4], [1.4 * self.h, 1.0], [2.4 * self.h, 0.3]])
    }

    pub(super) fn masses(&mut self) -> String {
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
    pub(super) fn load(&mut self) -> String {
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
}
