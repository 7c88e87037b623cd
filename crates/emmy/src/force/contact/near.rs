//! The points of a surface that an obstacle can touch in a step.

use super::ObstacleContact;
use crate::average::ContactRule;
use crate::contact::{MAX_STAGES, PointPath};
use crate::force::step::StepInput;

/// Memory of the contact with an obstacle in a stepper: the points that can come into the layer while every node stays
/// within a radius of the place where it was when the list was made. No result depends on this list.
#[derive(Debug)]
pub(super) struct NearPoints {
    pub rule: ContactRule,
    /// Numbers of the points, ascending.
    pub points: Vec<u32>,
    /// Positions of the nodes of the surface; empty before the first list.
    made_at: Vec<[f64; 3]>,
    radius: f64,
}

/// Multiple of the motion in a step for which a list holds.
const AHEAD: f64 = 2.0;

impl NearPoints {
    pub(super) fn new(rule: ContactRule) -> Self {
        NearPoints { rule, points: Vec::new(), made_at: Vec::new(), radius: 0.0 }
    }

    /// Makes the list hold for the paths of a step.
    pub(super) fn cover(&mut self, contact: &ObstacleContact, step: &StepInput<'_>) {
        if !self.made_at.is_empty() && self.farthest(contact, step) <= self.radius {
            return;
        }
        let starts = contact.guards().map(|guard| guard.at(step.displacement));
        self.made_at.clear();
        self.made_at.extend(starts);
        self.radius = contact.points.layer.thickness.max(AHEAD * self.farthest(contact, step));
        let reach = contact.points.layer.thickness + contact.surface.amplification * self.radius;
        let is_far = |gap: f64| gap >= reach;
        let near = (0..).zip(contact.contact_points());
        let near = near.filter(|(_, point)| !is_far(point.layer.surface.gap(point.at(step.displacement))));
        self.points.clear();
        self.points.reserve(contact.surface.points.len());
        self.points.extend(near.map(|(number, _)| number));
    }

    /// Largest distance of a node on its path in a step from its place when the list was made; infinite where it is no
    /// number.
    fn farthest(&self, contact: &ObstacleContact, step: &StepInput<'_>) -> f64 {
        let (mut most, mut rates) = (0.0f64, [[0.0; 3]; MAX_STAGES]);
        for (guard, from) in contact.guards().zip(&self.made_at) {
            let path: PointPath<'_> = guard.path(step, &mut rates);
            let mut visit = |q: [f64; 3]| {
                let square: f64 = (0..3).map(|d| (q[d] - from[d]).powi(2)).sum();
                most = most.max(if square.is_nan() { f64::INFINITY } else { square });
            };
            visit(path.start);
            self.rule.integrals(step.rule).for_each(|integrals| visit(path.at(integrals)));
        }
        most.sqrt()
    }
}
