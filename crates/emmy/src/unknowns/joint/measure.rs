//! Coordinates of joints as functions of the positions.

use super::super::affine::Affine;
use super::super::constraint::{Constraint, Coordinate};
use super::dot3;

/// A coordinate of a joint as a function of the positions.
#[derive(Debug, Clone)]
pub(crate) struct Measure {
    coordinate: Coordinate,
    /// Sums of scalar products: the slide; half the square of the distance; sine and cosine of the angle.
    forms: Vec<Constraint>,
}

impl Measure {
    /// The angle of a vector from the first of two others, towards the second.
    pub(crate) fn angle(own: &Affine, [first, second]: [Affine; 2]) -> Self {
        let form = |other| Constraint::new(vec![(own.clone(), other, 1.0)], 0.0);
        Measure { coordinate: Coordinate::Angle, forms: vec![form(second), form(first)] }
    }

    /// The component of an offset along an axis.
    pub(crate) fn slide(offset: Affine, axis: Affine) -> Self {
        Measure {
            coordinate: Coordinate::Slide,
            forms: vec![Constraint::new(vec![(offset, axis, 1.0)], 0.0)],
        }
    }

    /// The length of an arm.
    pub(crate) fn distance(arm: Affine) -> Self {
        let drawn = dot3(arm.reference, arm.reference).sqrt();
        let form = Constraint::new(vec![(arm.clone(), arm, 0.5)], 0.0);
        Measure { coordinate: Coordinate::Distance(drawn), forms: vec![form] }
    }

    /// The coordinate.
    pub(crate) fn coordinate(&self) -> Coordinate {
        self.coordinate
    }

    /// A constraint that gives it, at the value zero: of an angle `(e_1^A . e_2^B)`, of a slide the slide.
    pub(crate) fn constraint(&self) -> Constraint {
        let mut pairs: Vec<_> = self.forms.iter().rev().flat_map(|form| form.pairs.clone()).collect();
        if self.coordinate == Coordinate::Angle {
            pairs[0].2 = 0.0;
        }
        Constraint::new(pairs, 0.0)
    }

    /// The same on the nodes that tied nodes follow.
    pub(crate) fn on_leaders<'t>(self, leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]> + Copy) -> Self {
        let forms = self.forms.into_iter().map(|form| form.on_leaders(leaders)).collect();
        Measure { forms, ..self }
    }

    /// Its nodes, some of them more than once.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = u32> {
        self.forms.iter().flat_map(Constraint::nodes)
    }

    /// Its value, an angle within half a turn.
    pub(crate) fn value(&self, u: &dyn Fn(usize) -> f64) -> f64 {
        let own = self.forms[0].value(u);
        match self.coordinate {
            Coordinate::Angle => own.atan2(self.forms[1].value(u)),
            Coordinate::Slide => own,
            Coordinate::Distance(_) => (2.0 * own).sqrt(),
        }
    }

    /// Calls a function with each entry of its gradient, some of them more than once.
    ///
    /// ```math
    /// d theta = (c ds - s dc) / (c^2 + s^2),    dL = d(L^2/2) / L
    /// ```
    pub(crate) fn for_each_gradient(&self, u: &dyn Fn(usize) -> f64, visit: &mut dyn FnMut(usize, f64)) {
        for (form, factor) in self.forms.iter().zip(self.factors(u)) {
            form.for_each_gradient(u, &mut |dof, value| visit(dof, factor * value));
        }
    }

    /// Derivatives of the value by those of the forms.
    fn factors(&self, u: &dyn Fn(usize) -> f64) -> [f64; 2] {
        let own = self.forms[0].value(u);
        match self.coordinate {
            Coordinate::Angle => {
                let cos = self.forms[1].value(u);
                let square = cos * cos + own * own;
                [cos / square, -own / square]
            }
            Coordinate::Slide => [1.0, 0.0],
            Coordinate::Distance(_) => [(2.0 * own).sqrt().recip(), 0.0],
        }
    }

    /// A size of the values whose rounding it has.
    pub(crate) fn size(&self) -> f64 {
        match self.coordinate {
            Coordinate::Angle => 1.0,
            Coordinate::Slide => 0.0,
            Coordinate::Distance(drawn) => drawn,
        }
    }

    /// A value counted on from one before: of an angle, with the full turns that bring it within half a turn.
    pub(crate) fn counted(&self, value: f64, before: f64) -> f64 {
        match self.coordinate {
            Coordinate::Angle => value + TURN * ((before - value) / TURN).round(),
            Coordinate::Slide | Coordinate::Distance(_) => value,
        }
    }

    /// Adds its second derivative to a dense table of the degrees of freedom of the nodes that `local` numbers.
    ///
    /// ```math
    /// sum_r dv/dform_r form_r'' + sum_rs d^2v/(dform_r dform_s) form_r' form_s'
    /// ```
    pub(crate) fn add_curvature(
        &self,
        u: &dyn Fn(usize) -> f64,
        local: &dyn Fn(u32) -> usize,
        (table, n): (&mut [f64], usize),
    ) {
        for (form, own) in self.forms.iter().zip(self.factors(u)) {
            form.for_each_curvature(&mut |[a, b], value| {
                for d in 0..3 {
                    table[(3 * local(a) + d) * n + 3 * local(b) + d] += own * value;
                }
            });
        }
        let mut gradients = [[0.0; MAX_DOFS]; 2];
        for (form, gradient) in self.forms.iter().zip(&mut gradients) {
            form.for_each_gradient(u, &mut |dof, value| {
                gradient[3 * local((dof / 3) as u32) + dof % 3] += value;
            });
        }
        let seconds = self.second_derivatives(u);
        for (r, s) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let second = seconds[r][s];
            if second != 0.0 {
                for (a, row) in table.chunks_exact_mut(n).enumerate() {
                    let own = second * gradients[r][a];
                    row.iter_mut().zip(&gradients[s]).for_each(|(sum, g)| *sum += own * g);
                }
            }
        }
    }

    fn second_derivatives(&self, u: &dyn Fn(usize) -> f64) -> [[f64; 2]; 2] {
        let own = self.forms[0].value(u);
        match self.coordinate {
            Coordinate::Angle => {
                let cos = self.forms[1].value(u);
                let square = (cos * cos + own * own).powi(2);
                let (mixed, equal) = ((own * own - cos * cos) / square, 2.0 * own * cos / square);
                [[-equal, mixed], [mixed, equal]]
            }
            Coordinate::Slide => [[0.0; 2]; 2],
            Coordinate::Distance(_) => [[-(2.0 * own).powf(-1.5), 0.0], [0.0; 2]],
        }
    }
}

/// Largest number of degrees of freedom of a coordinate with a force.
pub(crate) const MAX_DOFS: usize = 48;

const TURN: f64 = 2.0 * std::f64::consts::PI;
