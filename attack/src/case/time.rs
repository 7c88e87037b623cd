//! The scheme with its steps, the output, and the run before the start.

use std::fmt::Write;

use super::{Draft, NEWTON, chosen, vector};
use crate::reference::body::{Body, Dead, STEADY};
use crate::reference::element::{Average, Element};
use crate::reference::history::History;
use crate::reference::motion::{Drive, Scheme, Support};
use crate::reference::numbers::{gauss, lobatto};

impl Draft<'_> {
    pub(super) fn scheme(&self) -> (Scheme, String) {
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

    pub(super) fn output(&self, directory: &str) -> String {
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
    pub(super) fn first(&self, head: &str) -> (String, Body, Vec<Support>, Vec<f64>) {
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
             [time]\nscheme = \"FE(1)\"\nsteps = [{{ until = 0.06, size = 0.03 }}]\n\n{NEWTON}[output]\ndirectory = \"first\"\nevery = 0\n",
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
