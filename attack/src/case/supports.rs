//! Supports, and velocities of the start.

use super::{Draft, Initial, chosen, number};
use crate::reference::history::History;
use crate::reference::mesh::Mesh;
use crate::reference::motion::{Drive, Support};

impl Draft<'_> {
    /// Drives of some components of the nodes at the bottom.
    pub(super) fn hold(&self, components: &[usize], drive: &Drive) -> Vec<(usize, Drive)> {
        let nodes = Mesh::nodes_of(&self.mesh.bottom).into_iter();
        nodes.flat_map(|node| components.iter().map(move |d| (3 * node + d, drive.clone()))).collect()
    }

    pub(super) fn supports(&mut self) -> (Vec<Support>, Vec<&'static str>, String) {
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

    pub(super) fn initial(&mut self) -> Option<Initial> {
        let mut spin = self.vector(2.0);
        let mut gradient = [0, 1, 2].map(|_| self.vector(1.6));
        if self.is_plane {
            spin = [0.0, 0.0, 1.7];
            gradient[2] = [0.0; 3];
        }
        Some((self.vector(1.0), spin, gradient))
    }
}
