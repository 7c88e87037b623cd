//! Loads on cells and facets, and their averages over a step.

use super::{Body, Cell, Wave};
use crate::reference::element::{Average, Element};
use crate::reference::energies::Energy;
use crate::reference::history::pieces;
use crate::reference::mesh::Item;
use crate::reference::numbers::{cross, dot, lagrange};

impl Body {
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

    /// Adds a mass that lies evenly on facets. The lumped one of a facet with nodes inside its edges is in proportion
    /// to the diagonal of its consistent mass.
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
}
