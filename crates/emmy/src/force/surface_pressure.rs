//! Pressures on surfaces: loads that rotate and grow with their surface.

use std::sync::Arc;

use super::facets::{FacetOfTable, FacetTable, NodalVectors};
use super::integral::Scratch;
use super::interface::{Book, Force, ForceMemory, OverTime, Side};
use super::source::Site;
use super::step::{Sampling, StepInput, StepStart};
use crate::average::{FollowerRule, Request, Rule};
use crate::error::{Error, Result};
use crate::input::{Load, TimeFunction};
use crate::nodal;
use crate::sparse::RowPart;

/// A pressure on a facet group with its factor over time.
#[derive(Debug, Clone)]
pub(crate) struct SurfacePressure {
    number: usize,
    pressure: f64,
    time_function: TimeFunction,
    tables: Vec<FacetTable>,
}

/// The factors of a step.
#[derive(Debug)]
struct Factors {
    rule: FollowerRule,
    /// Averages of the time function, `[n_points]`.
    averages: Vec<f64>,
    /// Factors p_m at the points of the rule.
    factors: Vec<f64>,
}

impl SurfacePressure {
    /// The pressure.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`], [`Error::PressureInside`].
    pub(super) fn new(
        number: usize,
        load: &Load,
        group: &str,
        pressure: f64,
        site: &Site<'_>,
    ) -> Result<Self> {
        let mesh = site.mesh;
        if !pressure.is_finite() {
            return Err(Error::NotFinite { what: "pressure".into(), value: pressure });
        }
        let facets = mesh.groups().facets(group)?;
        // On a team the rank that owns a node of an inner facet has both of its cells.
        if let Some(facet) = mesh.inner_facet(facets) {
            let nodes: Vec<[f64; 3]> =
                mesh.facet_nodes(facet).map(|node| mesh.points()[node as usize]).collect();
            let at = [0, 1, 2].map(|i| nodes.iter().map(|x| x[i]).sum::<f64>() / nodes.len() as f64);
            return Err(Error::PressureInside { group: group.to_string(), at });
        }
        let tables = FacetTable::of(mesh, site.pattern, facets, site.section);
        Ok(SurfacePressure { number, pressure, time_function: load.time_function.clone(), tables })
    }

    /// Adds the stage averages of a facet, whose nodes are those of the part.
    fn add_forces(
        &self,
        (table, facet): (&FacetTable, &FacetOfTable<'_>),
        step: &StepInput<'_>,
        Factors { rule, factors, .. }: &Factors,
        sink: &mut RowPart,
    ) {
        let rows = sink.rows();
        for (m, factor) in factors.iter().enumerate() {
            let f = table.force(&positions(facet, step, rule.integrals(m)));
            for (i, stage_weight) in rule.stage_weights(m).iter().enumerate() {
                let factor = facet.section * self.pressure * factor * stage_weight;
                for (&node, f) in
                    facet.nodes.iter().zip(&f).filter(|(node, _)| rows.contains(&(**node as usize)))
                {
                    sink.add_force(i, node, f.map(|f| factor * f));
                }
            }
        }
    }

    /// Adds the derivatives `- s^2 df_i/dx_j` of a facet.
    fn add_tangent(
        &self,
        (table, facet): (&FacetTable, &FacetOfTable<'_>),
        step: &StepInput<'_>,
        Factors { rule, factors, .. }: &Factors,
        sink: &mut RowPart,
    ) {
        let rows = sink.rows();
        for (m, factor) in factors.iter().enumerate() {
            let (integrals, stage_weights) = (rule.integrals(m), rule.stage_weights(m));
            let c = table.derivative(&positions(facet, step, integrals));
            let (n, k) = (facet.nodes.len(), integrals.len());
            let factor = -step.tangent_factor * facet.section * self.pressure * factor;
            for (A, _) in facet.nodes.iter().enumerate().filter(|(_, node)| rows.contains(&(**node as usize)))
            {
                for (B, stages) in (0..n).flat_map(|B| (0..k * k).map(move |stages| (B, stages))) {
                    let weight = factor * stage_weights[stages / k] * integrals[stages % k];
                    let block = sink.block_mut(facet.pairs[A * n + B] as usize, stages);
                    add_cross_product(block, weight, c[A][B]);
                }
            }
        }
    }
}

impl Force for SurfacePressure {
    fn book(&self) -> Book {
        Book::Work
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        let rule = FollowerRule::new(rule);
        let [averages, factors] = [(); 2].map(|()| vec![0.0; rule.n_points()]);
        ForceMemory::new(Factors { rule, averages, factors })
    }

    fn begin(&self, start: &StepStart<'_>, memory: &mut ForceMemory, _: &mut [f64]) -> Result<bool> {
        let Factors { rule, averages, factors } = memory.of_mut();
        let span = start.span;
        match start.sampling {
            Sampling::Averages => {
                let found = self.time_function.averages(span.start, span.size, rule.fine(), averages);
                found.map_err(|found| self.not_finite(found))?;
                rule.factors(averages, factors);
            }
            Sampling::Points => {
                for (factor, alpha) in factors.iter_mut().zip(rule.alphas()) {
                    *factor = self.factor(span.time(alpha))?;
                }
            }
        }
        Ok(factors.iter().any(|&factor| factor != 0.0))
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        memory: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let factors = memory.of::<Factors>();
        let rows = sink.rows();
        let touches =
            |facet: &FacetOfTable<'_>| facet.nodes.iter().any(|&node| rows.contains(&(node as usize)));
        for table in &self.tables {
            for facet in table.facets().filter(touches) {
                match request {
                    Request::Stress => self.add_forces((table, &facet), step, factors, sink),
                    Request::Tangent => self.add_tangent((table, &facet), step, factors, sink),
                }
            }
        }
        Ok(())
    }

    fn is_symmetric(&self) -> bool {
        false
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("pressures that follow the motion are not covered; dead loads are")
    }

    fn over_time(&self) -> Option<&dyn OverTime> {
        Some(self)
    }
}

impl OverTime for SurfacePressure {
    fn number(&self) -> usize {
        self.number
    }

    fn time_function(&self) -> &TimeFunction {
        &self.time_function
    }

    fn in_proportion(&self, time: f64, _: usize) -> Arc<dyn Force> {
        let time_function = TimeFunction::ramp(self.time_function.value_before(time));
        Arc::new(SurfacePressure { time_function, ..self.clone() })
    }

    fn add_unit_force(&self, force: &mut [f64]) {
        for table in &self.tables {
            for facet in table.facets() {
                let mut q = NodalVectors::default();
                q.iter_mut().zip(facet.points).for_each(|(q, X)| *q = *X);
                for (&node, f) in facet.nodes.iter().zip(table.force(&q)) {
                    let sum = &mut force.as_chunks_mut::<3>().0[node as usize];
                    (0..3).for_each(|i| sum[i] += facet.section * self.pressure * f[i]);
                }
            }
        }
    }
}

/// Adds the matrix of `v -> weight c x v` to a block, row by row.
fn add_cross_product(block: &mut [f64], weight: f64, c: [f64; 3]) {
    let [x, y, z] = c.map(|c| weight * c);
    for (entry, value) in [(1, -z), (2, y), (3, z), (5, -x), (6, -y), (7, x)] {
        block[entry] += value;
    }
}

/// Positions of the nodes of a facet in the step at the point with the integrals L_j of the basis.
fn positions(facet: &FacetOfTable<'_>, step: &StepInput<'_>, integrals: &[f64]) -> NodalVectors {
    let mut q = NodalVectors::default();
    for ((q, X), &node) in q.iter_mut().zip(facet.points).zip(facet.nodes) {
        *q = [0, 1, 2].map(|i| X[i] + step.displacement_at(integrals, nodal::dof(node as usize, i)));
    }
    q
}
