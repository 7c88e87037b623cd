//! Newton's iteration on the stage equations converges quadratically for every rule, degree and material.

use super::stage_system::StageSystem;
use super::{State, TimeElement};
use crate::average::AveragingRule;
use crate::body::Body;
use crate::input::{InitialVelocity, Region};
use crate::material::{NeoHooke, SaintVenantKirchhoff};
use crate::newton::{System, Tangent};
use crate::sparse::Solver;

fn spinning(body: &Body) -> State {
    let motion = InitialVelocity {
        angular_velocity: [0.5, 1.0, 1.5],
        gradient: [[0.5, 0.2, 0.0], [0.0, -0.4, 0.1], [0.2, 0.0, 0.3]],
        ..Default::default()
    };
    State::initial(body, 0.0, &[motion]).unwrap()
}

/// Norms of the residuals of Newton's iteration with exact linear solutions, over the first scale.
fn residuals(body: &Body, element: TimeElement) -> Vec<f64> {
    let degree = element.degree;
    let mut system = StageSystem::new(body, element.coefficients(), Solver::Auto).unwrap();
    let state = spinning(body);
    let h = 0.3;
    system.start(&state.displacement, h);
    let n_dofs = body.n_dofs();
    for (row, known) in system.coefficients.mass.chunks(degree).zip(system.known.chunks_mut(n_dofs)) {
        known.iter_mut().zip(&state.momentum).for_each(|(g, p)| *g = row.iter().sum::<f64>() * h * p);
    }
    let n = degree * n_dofs;
    let mut x: Vec<f64> = state.velocity.iter().cycle().take(n).map(|v| h * v).collect();
    let (mut residual, mut dx) = (vec![0.0; n], vec![0.0; n]);
    let mut norms = Vec::new();
    for _ in 0..6 {
        let sizes = system.residual(&x, &mut residual).unwrap();
        norms.push(sizes.residual / sizes.scale);
        system.correction(&x, &residual, 1e-13, Tangent::Exact, &mut dx).unwrap();
        x.iter_mut().zip(&dx).for_each(|(x, dx)| *x += dx);
    }
    norms
}

#[test]
fn newton_converges_quadratically() {
    let mesh = || crate::mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let rubber = Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 1.0);
    let stiff = Region::new(SaintVenantKirchhoff::new(10.0, 5.0).unwrap(), 1.0);
    for region in [rubber, stiff] {
        let body = Body::builder(mesh()).region(region).build().unwrap();
        for degree in 1..=4 {
            let rules = [
                AveragingRule::Standard(degree),
                AveragingRule::Standard(degree + 2),
                AveragingRule::AssumedStrain(degree),
                AveragingRule::AssumedStrain(degree + 3),
                AveragingRule::DiscreteGradient,
                AveragingRule::Lobatto(degree + 1),
            ];
            for rule in rules {
                let element = TimeElement::new(rule, degree).unwrap();
                let norms = residuals(&body, element);
                let last = norms.iter().position(|norm| *norm < 1e-13).expect("six iterations suffice");
                // e_(n+1) <= C e_n^2 in the last iteration above rounding, with C within ten times its previous value.
                let constant = |n: usize| norms[n] / norms[n - 1].powi(2);
                let bound = 10.0 * constant(1).max(constant(2)) * norms[last - 1].powi(2) + 1e-14;
                assert!(last >= 3 && norms[last] < bound, "{element}: {norms:?}");
            }
        }
    }
}
