//! Contact of surfaces with obstacles, and with each other.

mod near;
mod source;
mod surfaces;

use self::near::NearPoints;
use super::contact_summary::ContactSummary;
use super::integral::Scratch;
use super::interface::{Book, Force, ForceMemory, Side};
use super::step::StepInput;
use super::strain_state::{ContactAtNode, ContactState, StrainState};
use crate::average::{ContactRule, FollowerRule, Request, Rule};
use crate::contact::{MAX_STAGES, NEAR, ObstacleLayer, PointPath, Surface, SurfacePoint};
use crate::error::{Error, Result};
use crate::nodal;
use crate::sparse::{Couplings, RowPart};
use crate::tensor::Mat3;

/// Part of the gap that a correction leaves, at the least.
const LEFT: f64 = 0.2;

/// A layer on a surface that stores energy where an obstacle is near: at the quadrature points of its facets, and, half
/// as thick, at its nodes. These guard against nodes that pass between the points.
#[derive(Debug)]
struct ObstacleContact {
    summary: ContactSummary,
    surface: Surface,
    points: ObstacleLayer,
    guards: ObstacleLayer,
}

/// A point of a surface, a combination of nodes; all positions are relative to the obstacle.
struct ContactPoint<'a> {
    layer: &'a ObstacleLayer,
    surface: &'a Surface,
    point: &'a SurfacePoint,
    obstacle: Option<u32>,
}

impl ContactPoint<'_> {
    /// The nodes of the surface with their reference positions and shares.
    fn own_terms(&self) -> impl Iterator<Item = (u32, [f64; 3], f64)> {
        let Surface { nodes, positions, .. } = self.surface;
        let terms = self.surface.entity(self.point.entity);
        terms.map(|(number, share)| (nodes[number], positions[number], share))
    }

    /// The same, and the node of an obstacle that moves, with the share -1.
    fn terms(&self) -> impl Iterator<Item = (u32, [f64; 3], f64)> {
        self.own_terms().chain(self.obstacle.map(|node| (node, [0.0; 3], -1.0)))
    }

    /// The position at a displacement.
    fn at(&self, displacement: &[f64]) -> [f64; 3] {
        let mut q = [0.0; 3];
        for (node, X, share) in self.terms() {
            let u = nodal::at(displacement, node as usize);
            (0..3).for_each(|d| q[d] += share * (X[d] + u[d]));
        }
        q
    }

    /// The path in a step.
    fn path<'s>(&self, step: &StepInput<'s>, rates: &'s mut [[f64; 3]; MAX_STAGES]) -> PointPath<'s> {
        let (n, k) = (step.displacement.len(), step.rule.degree());
        rates[..k].fill([0.0; 3]);
        for (node, _, share) in self.terms() {
            for (rates, x) in rates.iter_mut().zip(step.rates.chunks_exact(n)) {
                let x = nodal::at(x, node as usize);
                (0..3).for_each(|d| rates[d] += share * x[d]);
            }
        }
        PointPath {
            start: self.at(step.displacement),
            rates: &rates[..k],
            coefficients: step.rule.coefficients(),
            weights: step.rule.weights(),
        }
    }
}

/// Forces of a point per area and their derivatives, as many as any step has.
struct PointForces {
    forces: [[f64; 3]; MAX_STAGES],
    derivatives: [Mat3<f64>; MAX_STAGES * MAX_STAGES],
}

impl ObstacleContact {
    /// The guards, in the order of the nodes, and the points of the facets.
    fn contact_points(&self) -> impl Iterator<Item = ContactPoint<'_>> {
        self.surface.points.iter().map(|point| self.contact_point(point))
    }

    /// The guards, in the order of the nodes.
    fn guards(&self) -> impl Iterator<Item = ContactPoint<'_>> {
        self.contact_points().take(self.surface.nodes.len())
    }

    fn contact_point<'a>(&'a self, point: &'a SurfacePoint) -> ContactPoint<'a> {
        ContactPoint {
            layer: if point.is_guard { &self.guards } else { &self.points },
            surface: &self.surface,
            point,
            obstacle: self.summary.obstacle,
        }
    }

    /// The error of a path that leads through the obstacle.
    fn check_path(&self, path: &PointPath<'_>, step: &StepInput<'_>, rule: &ContactRule) -> Result<()> {
        let mut from = path.start;
        let mut visit = |to: [f64; 3]| {
            if self.points.surface.is_passed(from, to) {
                let moved = self
                    .summary
                    .obstacle
                    .map_or([0.0; 3], |node| nodal::at(step.displacement, node as usize));
                let at = [0, 1, 2].map(|d| to[d] + moved[d]);
                return Err(Error::Passed { contact: self.summary.name.clone(), at });
            }
            from = to;
            Ok(())
        };
        rule.integrals(step.rule).try_for_each(|integrals| visit(path.at(integrals)))
    }

    /// Calls a function with the stage averages of the force on each point that has one. Only points with some node
    /// that is wanted are evaluated. The list of near points holds for the step.
    fn for_each_force(
        &self,
        (step, near, request): (&StepInput<'_>, &NearPoints, Request),
        is_wanted: impl Fn(u32) -> bool,
        visit: &mut dyn FnMut(&ContactPoint<'_>, &PointForces),
    ) -> Result<()> {
        let k = step.rule.degree();
        let mut own = PointForces {
            forces: [[0.0; 3]; MAX_STAGES],
            derivatives: [Mat3::default(); MAX_STAGES * MAX_STAGES],
        };
        let (rule, points) = (&near.rule, &self.surface.points);
        let near = near.points.iter().map(|number| self.contact_point(&points[*number as usize]));
        for point in near.filter(|point| point.terms().any(|(node, ..)| is_wanted(node))) {
            let mut rates = [[0.0; 3]; MAX_STAGES];
            let path = point.path(step, &mut rates);
            self.check_path(&path, step, rule)?;
            let forces = &mut own.forces[..k];
            let n_derivatives = if request == Request::Tangent { k * k } else { 0 };
            let derivatives = &mut own.derivatives[..n_derivatives];
            let acts = match rule {
                ContactRule::Conserving => point.layer.conserving_forces(&path, forces, derivatives),
                ContactRule::Points(points) => {
                    set_point_forces(point.layer, (&path, points), forces, derivatives)
                }
            };
            if acts {
                visit(&point, &own);
            }
        }
        Ok(())
    }
}

/// Sets the forces by the gradient of the energy at points of the step. Returns whether one is not zero.
fn set_point_forces(
    layer: &ObstacleLayer,
    (path, points): (&PointPath<'_>, &FollowerRule),
    forces: &mut [[f64; 3]],
    derivatives: &mut [Mat3<f64>],
) -> bool {
    let k = forces.len();
    forces.fill([0.0; 3]);
    derivatives.fill(Mat3::default());
    let mut acts = false;
    for m in 0..points.n_points() {
        let integrals = points.integrals(m);
        let q = path.at(integrals);
        if layer.surface.gap(q) >= layer.layer.thickness {
            continue;
        }
        acts = true;
        let (gradient, stiffness) = layer.gradient(q);
        for (i, weight) in points.stage_weights(m).iter().enumerate() {
            (0..3).for_each(|d| forces[i][d] += weight * gradient[d]);
            // None, if they are not wanted.
            for (derivative, integral) in derivatives.iter_mut().skip(i * k).zip(integrals) {
                let entries = derivative.as_flattened_mut().iter_mut().zip(stiffness.as_flattened());
                entries.for_each(|(sum, entry)| *sum += weight * integral * entry);
            }
        }
    }
    acts
}

impl Force for ObstacleContact {
    fn book(&self) -> Book {
        Book::Stored
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        ForceMemory::new(NearPoints::new(ContactRule::new(rule)))
    }

    fn prepare(&self, (step, _): (&StepInput<'_>, Request), memory: &mut ForceMemory) -> Result<()> {
        memory.of_mut::<NearPoints>().cover(self, step);
        Ok(())
    }

    fn has_couplings(&self) -> bool {
        true
    }

    fn assemble(
        &self,
        (step, _): (&StepInput<'_>, Request),
        memory: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let (k, rows) = (step.rule.degree(), sink.rows());
        let is_wanted = |node: u32| rows.contains(&(node as usize));
        self.for_each_force((step, memory.of(), Request::Stress), is_wanted, &mut |point, own| {
            for (node, _, share) in point.terms().filter(|(node, ..)| is_wanted(*node)) {
                let weight = share * point.point.area;
                (0..k).for_each(|i| sink.add_force(i, node, own.forces[i].map(|f| weight * f)));
            }
        })
    }

    fn add_couplings(&self, step: &StepInput<'_>, memory: &ForceMemory, couplings: &mut Couplings) {
        let k = step.rule.degree();
        let input = (step, memory.of(), Request::Tangent);
        // Forces are evaluated before, so the paths lead through no obstacle.
        let _ = self.for_each_force(input, |_| true, &mut |point, own| {
            for (row, _, share) in point.terms() {
                for (column, _, other) in point.terms() {
                    let weight = step.tangent_factor * point.point.area * share * other;
                    let sums = couplings.block_mut(row, column).iter_mut();
                    let derivatives = own.derivatives[..k * k].as_flattened().as_flattened();
                    sums.zip(derivatives).for_each(|(sum, entry)| *sum += weight * entry);
                }
            }
        });
    }

    fn strain_state(&self, displacement: &[f64], _: &[f64]) -> StrainState {
        let (mut contact, thickness) = (ContactState::NONE, self.points.layer.thickness);
        for point in self.contact_points() {
            let layer = point.layer;
            let gap = layer.surface.gap(point.at(displacement));
            if gap < NEAR * thickness {
                contact.smallest_gap = contact.smallest_gap.min(gap / thickness);
            }
            if gap < layer.layer.thickness {
                contact.n_points += 1;
                contact.energy += point.point.area * layer.by_gap(gap)[0];
            }
        }
        StrainState { contact, ..StrainState::NONE }
    }

    fn for_each_reaction(
        &self,
        (step, memory): (&StepInput<'_>, &ForceMemory),
        stage: usize,
        visit: &mut dyn FnMut(usize, [f64; 3]),
    ) {
        let input = (step, memory.of(), Request::Stress);
        // A step that is solved leads through no obstacle.
        let _ = self.for_each_force(input, |_| true, &mut |point, own| {
            for (node, _, share) in point.own_terms() {
                visit(node as usize, own.forces[stage].map(|f| -share * point.point.area * f));
            }
        });
    }

    fn bounds(&self) -> bool {
        true
    }

    fn largest_part(&self, step: &StepInput<'_>, memory: &ForceMemory, correction: &[f64]) -> f64 {
        let (surface, corrected) = (&self.points.surface, StepInput { rates: correction, ..*step });
        let mut part = 1.0f64;
        for guard in self.guards() {
            let (mut rates, mut changes) = ([[0.0; 3]; MAX_STAGES], [[0.0; 3]; MAX_STAGES]);
            let (path, change) = (guard.path(step, &mut rates), guard.path(&corrected, &mut changes));
            let mut at = |integrals: &[f64]| {
                let (q, moved) = (path.at(integrals), change.at(integrals));
                let n = surface.gradient(q);
                let approach: f64 = (0..3).map(|d| n[d] * (change.start[d] - moved[d])).sum();
                let most = (1.0 - LEFT) * surface.gap(q);
                if approach > most && most > 0.0 {
                    part = part.min(most / approach);
                }
            };
            memory.of::<NearPoints>().rule.integrals(step.rule).for_each(&mut at);
        }
        part
    }

    fn is_sudden(&self, step: &StepInput<'_>, memory: &ForceMemory) -> bool {
        let mut acts = false;
        let input = (step, memory.of(), Request::Stress);
        self.for_each_force(input, |_| true, &mut |_, _| acts = true).is_err() || acts
    }

    fn contact(&self) -> Option<&ContactSummary> {
        Some(&self.summary)
    }

    fn for_each_contact_node(&self, displacement: &[f64], visit: &mut dyn FnMut(usize, ContactAtNode)) {
        let mut pressures: Vec<f64> = vec![0.0; self.surface.n_entities()];
        for own in self.contact_points() {
            pressures[own.point.entity as usize] = own.layer.pressure(own.at(displacement));
        }
        let most = NEAR * self.points.layer.thickness;
        let nodes = self.surface.pressures_at_nodes(|point| pressures[point.entity as usize]);
        for ((guard, node), [pressure, area]) in self.guards().zip(&self.surface.nodes).zip(nodes) {
            let gap = guard.layer.surface.gap(guard.at(displacement));
            let gap = if gap < most { gap } else { f64::NAN };
            visit(*node as usize, ContactAtNode { pressure, area, gap });
        }
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("contact is not covered")
    }
}
